"""Sections of a spec on its platform, the passages it must fit through, and its mass budget.

Places are in the robot's frame: x forward, y to the left, the reference point at the origin; those of passages are in
the world.
"""

import math
from collections.abc import Sequence
from typing import Annotated, Self

from pydantic import Field, model_validator

from drivesizer.files.fields import (
    Bearing,
    Coefficient,
    Counterweight,
    Length,
    Mass,
    Place,
    Price,
    Quantity,
    Section,
    Speed,
    Thickness,
    Turning,
    all_defaults,
    default,
    no_entries,
)
from drivesizer.files.inertia import Inertia, InertiaAbove
from drivesizer.platform.envelope import Passage, Size
from drivesizer.platform.wheels import Platform as Record
from drivesizer.spec.following import Following
from drivesizer.spec.misjudged import Unknown
from drivesizer.spec.wheels import CasterPlace, Layout, WheelPlace

__all__ = ["Budget", "CentreOfMass", "Item", "Limits", "PassageSection", "PayloadSection", "Platform", "SizeSection"]

AccelerationLimit = Annotated[float, Quantity("acceleration", above=0.0)]
JerkLimit = Annotated[float, Quantity("jerk", above=0.0)]
TurningAcceleration = Annotated[float, Quantity("angular_acceleration", above=0.0)]
TurningJerk = Annotated[float, Quantity("angular_jerk", above=0.0)]
Slip = Annotated[float, Quantity("dimensionless", least=0.0, most=0.9)]
Small = Annotated[float, Quantity("angle", least=0.0, most=math.pi / 2)]
Name = Annotated[str, Field(min_length=1, max_length=60)]


# --- mass and size ----------------------------------------------------------------------------------------------------


class CentreOfMass(Section):
    """Of the robot without its payloads."""

    x: Place = default("0 mm")
    y: Place = default("0 mm")
    height: Thickness | None = Field(default=None, description="above the floor; unknown where not given")


class PayloadSection(Section):
    """Something that the load's mass includes, where it is carried."""

    name: Name
    mass: Mass
    x: Place = default("0 mm", description="of its centre of mass")
    y: Place = default("0 mm")
    height: Thickness | None = Field(default=None, description="above the floor; unknown where not given")
    inertia: Inertia = default("0 kg*m^2", description="about the vertical through its centre of mass")


class SizeSection(Section):
    """The box that the robot takes up."""

    length: Length = Field(description="along its heading")
    width: Length
    height: Length = Field(description="above the floor, payload included")
    x: Place = default("0 mm", description="of the box's middle")
    y: Place = default("0 mm")

    @property
    def record(self) -> Size:
        """The same as the platform's geometry takes it."""
        return Size(length=self.length, width=self.width, height=self.height, x=self.x, y=self.y)


class PassageSection(Section):
    """A door or corridor that the robot must fit through."""

    name: Name
    width: Length = Field(description="between the jambs")
    height: Length | None = Field(default=None, description="open above where not given")
    depth: Thickness = default("0 mm", description="in the direction of passage; 0 is a thin wall")
    heading_error: Small = default("0 deg", description="with which the robot must still fit")
    aside: Thickness = default("0 mm", description="by which it may run beside the middle")
    turns: bool = Field(default=False, description="whether it turns on the spot there")
    corner: Length | None = Field(default=None, description="width of a corridor at right angles into which it turns")
    x: Place | None = Field(default=None, description="of its middle in the world, for a trajectory")
    y: Place | None = None
    direction: Bearing = default("0 deg", description="of passage, in the world")

    @model_validator(mode="after")
    def _somewhere(self) -> Self:
        if (self.x is None) != (self.y is None):
            raise ValueError("give both x and y, or none")
        return self

    @property
    def record(self) -> Passage:
        """The same as the platform's geometry takes it."""
        place = {"x": self.x or 0.0, "y": self.y or 0.0, "direction": self.direction}
        return Passage(name=self.name, width=self.width, height=self.height, depth=self.depth, **place)


class Limits(Section):
    """Limits of a motion of the robot."""

    speed: Speed | None = None
    acceleration: AccelerationLimit | None = None
    jerk: JerkLimit | None = None
    turning_speed: Turning | None = None
    turning_acceleration: TurningAcceleration | None = None
    turning_jerk: TurningJerk | None = None


# --- the sections -----------------------------------------------------------------------------------------------------


def _distinct(names: Sequence[str], what: str) -> None:
    if len(set(names)) != len(names):
        raise ValueError(f"expected {what} with names of their own")


class Platform(Section):
    """A robot on wheels: where they stand, where the mass is, and what it must fit through."""

    wheels: Annotated[list[WheelPlace], Field(min_length=1, max_length=100)] | None = None
    layout: Layout | None = Field(default=None, description="of the wheels, instead of one by one")
    casters: Annotated[list[CasterPlace], Field(max_length=100)] = no_entries()
    roller_resistance: Coefficient = Field(default=0, description="C_rr of rollers on their pins")
    slip: Slip = Field(
        default=0, description="share of the wheels' travel that is lost by slip on the floor: of the battery's energy"
    )
    inertia: InertiaAbove | None = Field(
        default=None,
        description="about the vertical through the centre of mass, without payloads; of a homogeneous box of the "
        "size where not given",
    )
    centre_of_mass: CentreOfMass = all_defaults()
    payloads: Annotated[list[PayloadSection], Field(max_length=100)] = no_entries(
        description="part of the load's mass; inertia and centre_of_mass are without them"
    )
    size: SizeSection | None = None
    passages: Annotated[list[PassageSection], Field(max_length=100)] = no_entries()
    limits: Limits = all_defaults()
    uphill: Bearing = default("0 deg", description="direction of the load's slope in the world")
    failed: Annotated[list[Annotated[int, Field(ge=1)]], Field(max_length=100)] = no_entries(
        description="wheels whose motor has failed, by number: for a load case"
    )
    blocked: bool = Field(
        default=False, description="whether those are held by brake or gear; they turn freely otherwise"
    )
    misjudged: Unknown = all_defaults(description="for `drivesizer drive --follow`")
    following: Following = all_defaults(description="for `drivesizer drive --follow`")

    @model_validator(mode="after")
    def _moves(self) -> Self:
        if (self.wheels is None) == (self.layout is None):
            raise ValueError("give wheels or layout, exactly one of them")
        if self.inertia is None and self.size is None:
            raise ValueError("give inertia, or size: a homogeneous box of it is taken then")
        if self.passages and self.size is None:
            raise ValueError("give size for the passages")
        wrong = [number for number in self.failed if number > len(self.places)]
        if wrong:
            raise ValueError(f"expected failed wheels of {len(self.places)}, there is no wheel {wrong[0]}")
        _distinct([passage.name for passage in self.passages], "passages")
        _distinct([payload.name for payload in self.payloads], "payloads")
        return self

    @model_validator(mode="after")
    def _held(self) -> Self:
        """Two wheels in one place, and wheels that do not hold the robot, are known before its mass is."""
        from drivesizer.platform.kinematics import kinematics  # a spec without a platform does not wait for it

        wheels = tuple(place.record(0.1) for place in self.places)
        casters = tuple(WheelPlace.model_construct(kind="omni", x=c.x, y=c.y).record(0.1) for c in self.casters)
        Record(wheels=(*wheels, *casters), mass=1.0, inertia=1.0)
        kinematics(wheels)
        return self

    @property
    def places(self) -> list[WheelPlace]:
        """The wheels one by one."""
        return self.layout.places if self.layout else list(self.wheels or ())

    @property
    def height_known(self) -> bool:
        """Whether the height of all masses is given."""
        return self.centre_of_mass.height is not None and all(p.height is not None for p in self.payloads)


class Item(Section):
    """Something that is carried and has a mass."""

    name: Name
    mass: Counterweight = Field(description="of one")
    number: Annotated[int, Field(ge=1, le=10_000)] = 1


class Budget(Section):
    """Permitted mass and price of the machine, and masses beside the drive's parts and the payloads."""

    mass: Mass | None = Field(default=None, description="permitted total")
    price: Price | None = Field(
        default=None,
        description="permitted, of all drives, power supply and brake resistor together",
    )
    structure: Mass | None = Field(default=None, description="frame, wheels, covers; unknown where not given")
    others: Annotated[list[Item], Field(max_length=1000)] = no_entries(description="equipment")
    drive_counts: bool = Field(
        default=False, description="whether the moved mass follows from the budget, including the drive's own"
    )

    @property
    def weighs(self) -> bool:
        """Whether masses are summed: not where the price alone is limited."""
        return self.model_fields_set != {"price"}

    @model_validator(mode="after")
    def _summed(self) -> Self:
        _distinct([item.name for item in self.others], "others")
        if self.drive_counts and self.structure is None:
            raise ValueError("give structure where drive_counts: the mass without the drive must be known")
        return self
