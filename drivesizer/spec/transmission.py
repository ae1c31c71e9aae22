"""The stages between motor and load that a spec may name."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from drivesizer.files.fields import (
    Angle,
    BackEfficiency,
    Force,
    Length,
    Mass,
    Ratio,
    Section,
    Share,
    Speed,
    Stiffness,
    Thickness,
    Torque,
    default,
    exactly_one,
)
from drivesizer.files.inertia import Inertia
from drivesizer.loads.fixed_gear import FixedGear

__all__ = ["DIRECT", "BeltStage", "DirectStage", "GearStage", "GearheadStage", "Pulleys", "Stage"]

DIRECT = "direct"  # the kind of stage, and the name of direct drive in catalogues


class GearheadStage(Section):
    """A gearhead out of the catalogues: searched; none where the catalogues list a motor for direct drive."""

    kind: Literal["gearhead"]


class DirectStage(Section):
    """No gearhead: any motor may drive the load directly, or the belt."""

    kind: Literal["direct"]


class Pulleys(Section):
    """A toothed belt and its two pulleys out of the catalogues: every ratio that they give is searched."""

    profile: str = Field(min_length=1, max_length=60, description="of the teeth, as catalogues name it: HTD, GT2")
    pitch: Length
    width: Length = Field(description="of the belt; pulleys take it or a wider one")
    ratio_min: Ratio = Field(description="teeth of the load's pulley per tooth of the gearhead's, at least")
    ratio_max: Ratio = Field(description="and at most; below 1 the load turns faster")
    centre_distance: Length | None = Field(default=None, description="of the shafts; any where not given")
    adjustable: Thickness = default("3 mm", description="by how much the shafts may be moved, either way")

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.ratio_min <= self.ratio_max:
            raise ValueError("expected ratio_min <= ratio_max")
        return self


class BeltStage(Section):
    """A belt between gearhead, or motor, and load: one ratio, several to search, or pulleys out of the catalogues."""

    kind: Literal["belt"]
    ratio: Ratio | None = Field(default=None, description="gearhead turns per turn of the load; or ratios, or pulleys")
    ratios: Annotated[list[Ratio], Field(min_length=1, max_length=1000)] | None = None
    pulleys: Pulleys | None = None
    efficiency: Share = Field(description="in either direction of power")
    inertia: Inertia = default("0 kg*m^2", description="of belt and pulleys, seen at the load's shaft")
    friction_torque: Torque = default("0 N*m", description="of its bearings at any load, seen at the load's shaft")
    stiffness: Stiffness | None = Field(default=None, description="of the belt, seen at the load's shaft")
    mass: Mass | None = Field(
        default=None, description="of belt and pulleys, where these are not out of the catalogues"
    )
    pulley_diameter: Length | None = Field(
        default=None, description="of the load's pulley; with pulleys it follows from the teeth"
    )
    max_tension: Force | None = Field(default=None, description="permitted effective tension, with a known pulley")
    max_speed: Speed | None = Field(default=None, description="permitted belt speed, with a known pulley")

    @model_validator(mode="after")
    def _one_of_each(self) -> Self:
        exactly_one(self, "ratio", "ratios", "pulleys")
        if self.pulleys is not None and self.pulley_diameter is not None:
            raise ValueError("give pulleys or pulley_diameter, not both: diameters of pulleys follow from their teeth")
        if self.pulleys is None and self.pulley_diameter is None and (self.max_tension or self.max_speed):
            raise ValueError("give pulley_diameter beside max_tension and max_speed")
        return self

    @property
    def to_search(self) -> list[float]:
        """The ratios that the stage names, the smallest first; those of pulleys are out of the catalogues."""
        return [self.ratio] if self.ratio is not None else sorted(set(self.ratios or []))


class GearStage(Section):
    """One further stage of fixed ratio, behind or before the belt: spur or bevel gears, a chain, or a worm."""

    kind: Literal["gear", "bevel", "chain", "worm"]
    ratio: Ratio = Field(description="turns of its input shaft per turn of its output shaft; below 1 it steps up")
    efficiency: Share = Field(description="when the input shaft drives")
    back_efficiency: BackEfficiency | None = Field(
        default=None,
        description="when the output shaft drives; where not given as efficiency, of a worm 2 - 1/efficiency. 0 or "
        "below is self-locking",
    )
    pinion_inertia: Inertia = default("0 kg*m^2", description="of what turns with its input shaft: pinion or worm")
    wheel_inertia: Inertia = default("0 kg*m^2", description="of what turns with its output shaft: wheel or sprocket")
    pinion_friction: Torque = default("0 N*m", description="of bearings and seals of the input shaft, at any load")
    wheel_friction: Torque = default("0 N*m", description="of bearings and seals of the output shaft, at any load")
    pinion_diameter: Length | None = Field(
        default=None, description="pitch circle of pinion or sprocket, for its force on the shaft; bevels: the mean one"
    )
    backlash: Angle | None = Field(default=None, description="at its output shaft; unknown where not given")
    mass: Mass | None = Field(default=None, description="of the whole stage; unknown where not given")

    @model_validator(mode="after")
    def _forces(self) -> Self:
        if self.kind == "worm" and self.pinion_diameter is not None:
            raise ValueError("forces of a worm are not computed; leave pinion_diameter out, see needs.radial_load")
        return self

    def fixed_gear(self, behind: float = 1.0) -> FixedGear:
        """Its figures, with inertia and friction as seen where a belt of a ratio is behind it."""
        back = self.back_efficiency
        if back is None:
            back = 2.0 - 1.0 / self.efficiency if self.kind == "worm" else self.efficiency
        return FixedGear(
            self.ratio, self.efficiency, back,
            self.pinion_inertia * behind**2, self.wheel_inertia * behind**2,
            self.pinion_friction * behind, self.wheel_friction * behind,
        )  # fmt: skip

    @property
    def has_own_torque(self) -> bool:
        """Whether inertia or friction at any load is given."""
        return any((self.pinion_inertia, self.wheel_inertia, self.pinion_friction, self.wheel_friction))


Stage = Annotated[GearheadStage | DirectStage | BeltStage | GearStage, Field(discriminator="kind")]
