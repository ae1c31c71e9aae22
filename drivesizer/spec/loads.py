"""The loads that a spec may name: what is moved, as a user writes it.

One model per kind, named in the union ``Load`` alone; what it asks of the driven shaft is in ``loads``, a file by the
model's name. A load moves along a line or about an axis (``axis``), its way may have an end or lead on
(``has_end``), and ``motors`` alike motor sets share it.
"""

from __future__ import annotations

import re
from typing import Annotated, Any, ClassVar, Literal, get_args

from pydantic import Field, model_validator

from drivesizer.spec.fields import (
    Area,
    Axis,
    Bearing,
    Coefficient,
    Counterweight,
    Density,
    Exponent,
    Force,
    Incline,
    Inertia,
    Length,
    Mass,
    Pause,
    Pull,
    Quantity,
    Section,
    Share,
    SignedSpeed,
    SignedTorque,
    Slope,
    Thickness,
    Torque,
    Turning,
    default,
    exactly_one,
)

__all__ = [
    "AXES",
    "MODULES",
    "Arm",
    "Conveyor",
    "Cylinder",
    "Cylinders",
    "Fan",
    "Hoist",
    "Load",
    "RackPinion",
    "Recorded",
    "RotaryTable",
    "Screw",
    "WheeledVehicle",
]

Count = Annotated[int, Field(ge=1, le=100)]
BackEfficiency = Annotated[float, Quantity("dimensionless", most=1.0)]


class Cylinder(Section):
    """A rotating hollow cylinder, (8) and (9)."""

    density: Density
    outer_diameter: Length
    inner_diameter: Thickness = default("0 mm", description="0 when solid")
    width: Length

    @model_validator(mode="after")
    def _hollow(self) -> Cylinder:
        if not self.inner_diameter < self.outer_diameter:
            raise ValueError("inner_diameter must be below outer_diameter")
        return self


class Cylinders(Section):
    """The cylinders that turn with each driven wheel."""

    wheel: Cylinder
    shaft: Cylinder | None = None


class WheeledVehicle(Section):
    """A vehicle on driven wheels, each with its own motor set."""

    axis: ClassVar[Axis] = "linear"
    has_end: ClassVar[bool] = False
    kind: Literal["wheeled_vehicle"]
    mass: Mass = Field(description="whole vehicle, payload included")
    driven_wheels: Count = Field(description="wheels with a motor set")
    wheel_diameter: Length
    rolling_resistance: Coefficient | None = Field(default=None, description="C_rr; or give sinkage")
    sinkage: Thickness | None = Field(default=None, description="sinking depth z of (4); or give rolling_resistance")
    friction_coefficient: Coefficient | None = Field(default=None, description="between wheel and floor, for traction")
    driven_share: Share | None = Field(
        default=None,
        description="of the weight that the driven wheels carry, for traction; all of it where not given. Casters and "
        "other wheels carry the rest. A platform tells it by its places",
    )
    slope: Slope = default("0 deg", description="uphill positive")
    drag_area: Area = default("0 m^2", description="drag coefficient times frontal area")
    headwind: SignedSpeed = default("0 m/s", description="against the forward motion positive")
    air_density: Density = default("1.2 kg/m^3")
    cylinders: Cylinders | None = Field(default=None, description="wheel and shaft; or give inertia")
    inertia: Inertia | None = Field(default=None, description="of one wheel with its shaft; or give cylinders")

    @model_validator(mode="after")
    def _one_of_each(self) -> WheeledVehicle:
        exactly_one(self, "rolling_resistance", "sinkage")
        exactly_one(self, "cylinders", "inertia")
        if self.sinkage is not None and self.sinkage >= self.wheel_diameter:
            raise ValueError("sinkage must be below wheel_diameter")
        return self

    @property
    def motors(self) -> int:
        """How many motor sets share the load."""
        return self.driven_wheels

    @property
    def alike(self) -> int:
        """How many motor sets are asked for what the load cycle says: all."""
        return self.driven_wheels


class _Shared(Section):
    """A load that one motor set moves, or several alike."""

    motors: Count = Field(default=1, description="motor sets that share the load alike; all figures are of the whole")

    @property
    def alike(self) -> int:
        """How many motor sets are asked for what the load cycle says: all."""
        return self.motors


class Conveyor(_Shared):
    """A belt conveyor, level or inclined, driven at a drum."""

    axis: ClassVar[Axis] = "linear"
    has_end: ClassVar[bool] = False
    kind: Literal["conveyor"]
    mass: Mass = Field(description="goods on the belt")
    belt_mass: Counterweight = default("0 kg", description="of the belt itself")
    drum_diameter: Length
    friction_coefficient: Coefficient = Field(description="of belt and goods on the bed, or of the rollers")
    friction_force: Force = default("0 N", description="of scrapers and seals, against the motion")
    efficiency: Share = Field(default=1, description="of belt and drums, in either direction of power")
    incline: Incline = default("0 deg", description="upward positive")
    force: Pull = default("0 N", description="further force against the forward motion, at rest too")
    inertia: Inertia = default("0 kg*m^2", description="of all drums, seen at the driven one")


class Hoist(_Shared):
    """A rope drum that lifts a mass, with or without a counterweight."""

    axis: ClassVar[Axis] = "linear"
    has_end: ClassVar[bool] = True
    kind: Literal["hoist"]
    mass: Mass = Field(description="of what is lifted, its carrier included")
    counterweight: Counterweight = default("0 kg", description="hung against the mass, with as many falls")
    drum_diameter: Length
    falls: Count = Field(default=1, description="rope parts that carry the mass; the rope runs so many times faster")
    rope_efficiency: Share = Field(default=1, description="of rope and sheaves, in either direction of power")
    friction_force: Force = default("0 N", description="of the guides, against the motion")
    inertia: Inertia = default("0 kg*m^2", description="of drum and sheaves, seen at the drum")


class Screw(_Shared):
    """A lead screw or ball screw that moves a slide, level to upright."""

    axis: ClassVar[Axis] = "linear"
    has_end: ClassVar[bool] = True
    kind: Literal["lead_screw", "ball_screw"]
    mass: Mass = Field(description="of the slide and what is on it")
    lead: Length = Field(description="way per turn")
    efficiency: Share = Field(description="of screw and nut when it drives the slide")
    back_efficiency: BackEfficiency | None = Field(
        default=None, description="when the slide drives it; 2 - 1/efficiency where not given, below 0 is self-locking"
    )
    incline: Incline = default("0 deg", description="of the forward motion, upward positive; 90 deg lifts")
    friction_coefficient: Coefficient = Field(default=0, description="of the guide")
    friction_force: Force = default("0 N", description="of the guide's seals, against the motion")
    force: Pull = default("0 N", description="further force against the forward motion, at rest too")
    preload_torque: Torque = default("0 N*m", description="drag of a preloaded nut and its bearings")
    inertia: Inertia = Field(description="of screw and coupling")


class RackPinion(_Shared):
    """A rack that a pinion moves, or a carriage that runs along a rack, level to upright."""

    axis: ClassVar[Axis] = "linear"
    has_end: ClassVar[bool] = True
    kind: Literal["rack_pinion"]
    mass: Mass
    pinion_diameter: Length = Field(description="of its pitch circle")
    efficiency: Share = Field(default=1, description="of the toothing, in either direction of power")
    incline: Incline = default("0 deg", description="of the forward motion, upward positive")
    friction_coefficient: Coefficient = Field(default=0, description="of the guide")
    friction_force: Force = default("0 N", description="of the guide's seals, against the motion")
    force: Pull = default("0 N", description="further force against the forward motion, at rest too")
    inertia: Inertia = default("0 kg*m^2", description="of pinion and shaft")


def _at_least(inertia: float, mass: float, lever: float, name: str) -> None:
    """About an axis off the centre no mass has less inertia than if it were in its centre; 2 % for rounded figures."""
    least = mass * lever * lever
    if inertia < 0.98 * least:
        raise ValueError(f"inertia must be at least mass times {name} squared, {least:.4g} kg·m²")


class RotaryTable(_Shared):
    """An indexing or turning table, level or tilted, balanced or not."""

    axis: ClassVar[Axis] = "rotary"
    has_end: ClassVar[bool] = False
    kind: Literal["rotary_table"]
    inertia: Inertia = Field(description="of table and load about the axis")
    friction_torque: Torque = default("0 N*m", description="of the bearing, against the motion")
    torque: SignedTorque = default("0 N*m", description="further torque against the forward motion")
    mass: Counterweight = default("0 kg", description="of what turns, where its centre is off the axis")
    eccentricity: Thickness = default("0 mm", description="of that centre")
    tilt: Incline = default("0 deg", description="of the axis from the vertical; 90 deg lies level")
    start_angle: Bearing = default("0 deg", description="of the centre from the level line, when the cycle starts")

    @model_validator(mode="after")
    def _heavy_enough(self) -> RotaryTable:
        _at_least(self.inertia, self.mass, self.eccentricity, "eccentricity")
        return self


class Arm(_Shared):
    """A joint that swings an arm against gravity."""

    axis: ClassVar[Axis] = "rotary"
    has_end: ClassVar[bool] = True
    kind: Literal["arm"]
    mass: Mass = Field(description="of arm and payload")
    length: Length = Field(description="from the joint to their centre of mass")
    inertia: Inertia | None = Field(default=None, description="about the joint; mass times length squared if not given")
    start_angle: Bearing = default("0 deg", description="above the level line, when the cycle starts")
    tilt: Incline = default("0 deg", description="of the joint's axis from level; 90 deg feels no gravity")
    friction_torque: Torque = default("0 N*m", description="of the joint, against the motion")

    @model_validator(mode="after")
    def _heavy_enough(self) -> Arm:
        if self.inertia is not None:
            _at_least(self.inertia, self.mass, self.length, "length")
        return self


class Fan(_Shared):
    """A fan, pump or flywheel: torque that grows with a power of speed, and inertia."""

    axis: ClassVar[Axis] = "rotary"
    has_end: ClassVar[bool] = False
    kind: Literal["fan", "flywheel"]
    inertia: Inertia
    rated_torque: Torque = default("0 N*m", description="at rated_speed")
    rated_speed: Turning | None = Field(default=None, description="where rated_torque is taken")
    exponent: Exponent = Field(default=2, description="2 for fans and pumps, 1 for an eddy current brake")
    friction_torque: Torque = default("0 N*m", description="at any speed, against the motion")

    @model_validator(mode="after")
    def _rated(self) -> Fan:
        if self.rated_torque and self.rated_speed is None:
            raise ValueError("give rated_speed beside rated_torque")
        if self.exponent < 1.0:
            raise ValueError("exponent must be at least 1; torque that is the same at any speed is friction_torque")
        return self


class Recorded(_Shared):
    """A recording of speed or position and of torque at the driven shaft."""

    axis: ClassVar[Axis] = "rotary"
    has_end: ClassVar[bool] = False
    kind: Literal["recorded"]
    file: str = Field(min_length=1, description="CSV: columns time, speed or position, torque; then a row of units")
    smoothing: Pause = default("0 s", description="width of the window in which position or speed is smoothed")
    inertia: Inertia = default("0 kg*m^2", description="that turns with the shaft and is not in the torque")

    @property
    def shaft_inertia(self) -> float:
        """Of what one motor set moves, as far as it is known, at the shaft [kg*m^2]."""
        return self.inertia / self.motors


Load = Annotated[
    WheeledVehicle | Conveyor | Hoist | Screw | RackPinion | RotaryTable | Arm | Fan | Recorded,
    Field(discriminator="kind"),
]
_MODELS: dict[str, Any] = {
    kind: model for model in get_args(get_args(Load)[0]) for kind in get_args(model.model_fields["kind"].annotation)
}
AXES: dict[str, Axis] = {kind: model.axis for kind, model in _MODELS.items()}
MODULES = {  # of ``loads``, with a function of the same name: that of RackPinion is rack_pinion
    kind: re.sub(r"(?<=.)(?=[A-Z])", "_", model.__name__).lower() for kind, model in _MODELS.items()
}
