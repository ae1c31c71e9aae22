"""Sections of a spec on its platform: wheels, passages, mass budget, path following, errors of the robot model."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from drivesizer.files.fields import (
    Angle,
    Bearing,
    Coefficient,
    Counterweight,
    Duration,
    Inertia,
    InertiaAbove,
    Length,
    Mass,
    Part,
    Place,
    Price,
    Quantity,
    Section,
    Speed,
    Thickness,
    TorqueAbove,
    Turning,
    all_defaults,
    default,
    no_entries,
)
from drivesizer.platform.envelope import Passage, Size
from drivesizer.platform.wheels import Misjudged, Payload, Wheel, table_wheel
from drivesizer.platform.wheels import Platform as Record

__all__ = ["Budget", "Following", "Limits", "PassageSection", "Platform"]


# -- Section of a spec on the wheels of a platform: one by one, or by a layout.
#
# A wheel is placed by x and y, or by the columns of the paper's Table 1. All places are in the robot's frame: x
# forward, y to the left, the reference point at the origin.


RollerAngle = Annotated[float, Quantity("angle", least=-math.radians(85.0), most=math.radians(85.0))]
Kind = Literal["mecanum", "omni", "fixed"]


class WheelPlace(Section):
    """One wheel: its place, its direction of rolling, and whether it is driven."""

    kind: Kind = Field(description="fixed: no rollers, held sideways; also one that is steered to an angle")
    x: Place | None = Field(default=None, description="of the contact point; or give distance and alpha")
    y: Place | None = None
    heading: Bearing | None = Field(default=None, description="where it rolls; forward where not given")
    distance: Length | None = Field(default=None, description="L of Table 1")
    alpha: Bearing | None = Field(default=None, description="α of Table 1")
    beta: Bearing | None = Field(default=None, description="β of Table 1; forward where not given")
    roller_angle: RollerAngle | None = Field(default=None, description="γ, of a mecanum wheel")
    driven: bool = True

    @model_validator(mode="after")
    def _placed(self) -> Self:
        by_table, by_place = (self.distance, self.alpha, self.beta), (self.x, self.y, self.heading)
        given = (by_place, by_table) if self.distance is None else (by_table, by_place)
        if given[0][0] is None or given[0][1] is None or any(v is not None for v in given[1]):
            raise ValueError("give x and y with heading, or distance and alpha with beta, one of both")
        if (self.roller_angle is not None) != (self.kind == "mecanum"):
            raise ValueError("give roller_angle for a mecanum wheel, such as 45 deg or -45 deg, and for no other")
        return self

    def record(self, radius: float, **more: float) -> Wheel:
        """The wheel of a radius [m], with further figures of all wheels."""
        gamma = self.roller_angle or 0.0
        kind = {"held": self.kind == "fixed", "drive": "motor" if self.driven else "free"}
        if self.distance is not None and self.alpha is not None:
            beta = math.pi / 2 - self.alpha if self.beta is None else self.beta
            return table_wheel(self.distance, self.alpha, beta, gamma, radius, **kind, **more)
        assert self.x is not None and self.y is not None
        heading = self.heading or 0.0
        return Wheel(x=self.x, y=self.y, radius=radius, heading=heading, roller_angle=gamma, **kind, **more)  # type: ignore[arg-type]


class Mecanum(Section):
    """Four mecanum wheels in a rectangle: front right, front left, rear left, rear right."""

    kind: Literal["mecanum"]
    wheelbase: Length = Field(description="between the axles")
    track: Length = Field(description="between the contact points of an axle")
    roller_angle: RollerAngle = default("45 deg", description="γ of the front right and the rear left wheel")

    @property
    def places(self) -> list[WheelPlace]:
        """The wheels one by one."""
        x, y, gamma = self.wheelbase / 2, self.track / 2, self.roller_angle
        corners = ((x, -y, gamma), (x, y, -gamma), (-x, y, gamma), (-x, -y, -gamma))
        return [_place("mecanum", *corner) for corner in corners]

    @model_validator(mode="after")
    def _crossed(self) -> Self:
        if self.roller_angle <= 0.0:
            raise ValueError("expected roller_angle above 0: other rollers hold the platform badly in turning")
        return self


class Differential(Section):
    """Two fixed wheels on one axle, right and left; casters carry the rest."""

    kind: Literal["differential"]
    track: Length = Field(description="between the contact points")
    x: Place = default("0 mm", description="of the axle")

    @property
    def places(self) -> list[WheelPlace]:
        """The wheels one by one."""
        return [_place("fixed", self.x, y) for y in (-self.track / 2, self.track / 2)]


class Omni(Section):
    """Omni wheels on a circle, each rolling along it; the first in front."""

    kind: Literal["omni"]
    radius: Length = Field(description="of the circle, from the reference point to a contact point")
    number: Annotated[int, Field(ge=3, le=12)] = 3

    @property
    def places(self) -> list[WheelPlace]:
        """The wheels one by one."""
        angles = (2 * math.pi * i / self.number for i in range(self.number))
        return [
            _place("omni", self.radius * math.cos(a), self.radius * math.sin(a), heading=a + math.pi / 2)
            for a in angles
        ]


def _place(kind: Kind, x: float, y: float, gamma: float | None = None, heading: float = 0.0) -> WheelPlace:
    return WheelPlace.model_construct(kind=kind, x=x, y=y, roller_angle=gamma, heading=heading)


Layout = Annotated[Mecanum | Differential | Omni, Field(discriminator="kind")]


class CasterPlace(Section):
    """A caster."""

    x: Place
    y: Place
    rolling_resistance: Part | None = Field(default=None, description="C_rr; that of the wheels if not given")


# -- Section of a spec on errors of the robot model of a platform.


Off = Annotated[float, Quantity("dimensionless", least=-0.9, most=9.0)]
Each = Annotated[list[Off], Field(min_length=1, max_length=100)]


class UnknownPayload(Section):
    """Something on the platform that the robot model does not know."""

    mass: Mass
    x: Place = default("0 mm")
    y: Place = default("0 mm")
    height: Thickness = default("0 mm")


class Unknown(Section):
    """Differences of the true platform from its robot model, for path following."""

    radius: Off | Each = Field(default=0, description="share by which wheels are larger, of all or of each")
    lever: Off = Field(default=0, description="share by which the wheels stand farther out")
    toe: Bearing = default("0 deg", description="added to the heading of the wheels")
    mass: Off = Field(default=0, description="share by which it is heavier")
    inertia: Off = 0.0
    payload: UnknownPayload | None = None
    rolling_resistance: Off = Field(default=0, description="added to C_rr")
    roller_resistance: Off = Field(default=0, description="added to that of the rollers")
    motor: Off | Each = Field(default=0, description="share by which motors are stronger; -5 % is weak")

    @property
    def record(self) -> Misjudged:
        """The same as a plain record, as the simulation takes it."""
        given = {name: getattr(self, name) for name in type(self).model_fields if name != "payload"}
        errors: dict[str, Any] = {
            name: tuple(value) if isinstance(value, list) else value for name, value in given.items()
        }
        carried = self.payload
        load = Payload(mass=carried.mass, x=carried.x, y=carried.y, height=carried.height) if carried else None
        return Misjudged(**errors, payload=load)


# -- Sections of a spec on path following: controllers, floor and measured errors.


Damping = Annotated[float, Quantity("damping", above=0.0)]
Restoring = Annotated[float, Quantity("torsional_stiffness", least=0.0)]
Name = Annotated[str, Field(min_length=1, max_length=60)]


class Measured(Section):
    """Largest errors measured with a real robot on the path, printed beside the simulated ones."""

    name: Name
    position: Length
    heading: Angle


class Following(Section):
    """Controllers, floor and comparisons for `drivesizer drive --follow`."""

    speed_loop: Literal["PI", "P"] = Field(default="PI", description="of each driven wheel")
    speed_gain: Damping | None = Field(default=None, description="at a wheel; designed where not given")
    speed_integral: Restoring | None = Field(default=None, description="at a wheel, of PI; designed where not given")
    period: Duration = default("1 ms", description="of the speed loops")
    pose_period: Duration = default("50 ms", description="between two poses that are fed back")
    torque_limit: TorqueAbove | None = Field(
        default=None,
        description="at a wheel; what the controller's peak current and the gearhead give, where not given",
    )
    rotor_inertia: Inertia | None = Field(
        default=None, description="of motor and gearhead at a wheel; that of the drive where not given"
    )
    slip_speed: Speed = default("10 mm/s", description="at which a wheel's slip would meet the grip, at rest")
    creep: Coefficient = Field(default=0, description="what rolling adds to it, as a share of the rolling speed")
    compare: bool = Field(
        default=False, description="whether both models are driven with either loop, with and without what is misjudged"
    )
    measured: Annotated[list[Measured], Field(max_length=20)] = no_entries()

    @model_validator(mode="after")
    def _of_its_loop(self) -> Self:
        if self.speed_loop == "P" and self.speed_integral is not None and not self.compare:
            raise ValueError("speed_integral: a speed_loop P has none; leave it out, or take PI")
        if self.pose_period < self.period:
            raise ValueError("pose_period: expected no less than period, that of the speed loops")
        return self


# -- Sections of a spec on its platform, the passages it must fit through, and its mass budget.
#
# Places are in the robot's frame: x forward, y to the left, the reference point at the origin; those of passages are
# in the world.


AccelerationLimit = Annotated[float, Quantity("acceleration", above=0.0)]
JerkLimit = Annotated[float, Quantity("jerk", above=0.0)]
TurningAcceleration = Annotated[float, Quantity("angular_acceleration", above=0.0)]
TurningJerk = Annotated[float, Quantity("angular_jerk", above=0.0)]
Slip = Annotated[float, Quantity("dimensionless", least=0.0, most=0.9)]
Small = Annotated[float, Quantity("angle", least=0.0, most=math.pi / 2)]


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
