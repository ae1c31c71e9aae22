"""Sections of a spec on the closed loop: the controller's structure and gains, and the model of the machine."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from drivesizer.files.fields import (
    Angle,
    Current,
    Duration,
    Frequency,
    Gain,
    Part,
    Section,
    Share,
    Stiffness,
    all_defaults,
)

__all__ = ["Control", "Plant"]


class CurrentLoop(Section):
    """Gains of the current loop; designed where none is given."""

    kp: Gain | None = Field(default=None, description="proportional gain [V/A]")
    ki: Gain | None = Field(default=None, description="integral gain [V/(A s)]")


class VelocityLoop(Section):
    """Gains of the velocity loop, or targets of their design."""

    kp: Gain | None = Field(default=None, description="proportional gain [A per rad/s at the motor]")
    ki: Gain | None = Field(default=None, description="integral gain [A per rad]")
    kd: Gain | None = Field(default=None, description="derivative gain [A per rad/s^2]")
    filter_time: Duration | None = Field(default=None, description="of the derivative")
    bandwidth: Frequency | None = Field(default=None, description="to place the poles for")
    damping: Gain | None = Field(default=None, description="of the placed poles; 0.707 where not given")
    phase_margin: Angle | None = Field(default=None, description="for the symmetrical optimum; 37 deg where not given")


class PositionLoop(Section):
    """The position loop; without this section there is none."""

    kp: Gain | None = Field(default=None, description="speed demand per position error [1/s]")


class Feedforward(Section):
    """Current added to the velocity loop's; from the model where not given, 0 for none."""

    velocity: Gain | None = Field(default=None, description="[A per rad/s at the motor]")
    friction: Gain | None = Field(default=None, description="[A] in the direction of the speed")
    acceleration: Gain | None = Field(default=None, description="[A per rad/s^2 at the motor]")


class Control(Section):
    """The controller of the validation; gains are designed where none are given."""

    structure: Literal["voltage_pid", "cascade"] = Field(
        default="voltage_pid", description="one velocity loop on the voltage, or current, velocity and position loops"
    )
    kp: Gain | None = Field(default=None, description="proportional gain of voltage_pid [V per rad/s at the motor]")
    ki: Gain = Field(default=0, description="integral gain of voltage_pid [V per rad]")
    kd: Gain = Field(default=0, description="derivative gain of voltage_pid [V per rad/s^2]")
    bandwidth: Frequency | None = Field(default=None, description="closed-loop bandwidth to design voltage_pid for")
    current: CurrentLoop = all_defaults()
    velocity: VelocityLoop = all_defaults()
    position: PositionLoop | None = None
    feedforward: Feedforward = all_defaults()
    rate: Frequency | None = Field(
        default=None, description="at which the velocity loop runs; the controller's own where not given"
    )
    speed_from: Literal["exact", "counts"] = Field(
        default="counts", description="how speed is measured: by the encoder's counts where it has one, or exactly"
    )
    at_rest: Literal["drain", "hold", "brake"] = Field(
        default="drain",
        description="integral of the velocity loop at rest where friction alone holds the load: drained to no current, "
        "or kept as braking left it; or the holding brake closes at every rest: no current holds the load there, none "
        "keeps the brake released (the closed loop is simulated without the brake)",
    )
    count_time: Duration | None = Field(
        default=None, description="over which counts are taken for a speed; designed where not given"
    )
    microsteps: Annotated[int, Field(ge=1)] | None = Field(
        default=None,
        description="of a stepper's driver, to a full step, in size and validate; its finest where not given",
    )
    phase_current: Current | None = Field(
        default=None, description="that a stepper's driver is set to; the stepper's rated current where not given"
    )
    idle_current: Share | None = Field(
        default=None,
        description="of a stepper's current at rest, as a share of that in motion; all of it where not given",
    )
    damping_ratio: Part | None = Field(
        default=None, description="of the swings of a stepper's rotor; 0.1 where not given"
    )

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if self.kp is None and (self.ki or self.kd):
            raise ValueError("ki and kd need kp")
        if self.count_time is not None and self.speed_from == "exact":
            raise ValueError("count_time belongs to speed_from: counts")
        if self.kp is not None and self.bandwidth is not None:
            raise ValueError("give kp or bandwidth, not both")
        own = {"current", "velocity", "position", "feedforward"} & self.model_fields_set
        if self.structure == "voltage_pid" and own:
            raise ValueError(f"{min(own)} belongs to structure: cascade")
        if self.structure == "cascade" and {"kp", "ki", "kd", "bandwidth"} & self.model_fields_set:
            raise ValueError("kp, ki, kd and bandwidth belong under current or velocity in structure: cascade")
        return self


class Plant(Section):
    """Model of the machine in closed loop; rigid where not given."""

    model: Literal["rigid", "two_mass"] = Field(default="rigid", description="two_mass: motor, shaft, load")
    stiffness: Stiffness | None = Field(default=None, description="of the shaft, seen at the load; else the belt's")
    damping_ratio: Part = Field(default=0.02, description="of the load on its shaft, the motor held")
    backlash: Angle | None = Field(default=None, description="at the load; else the gearhead's")
    warming: bool = Field(default=True, description="whether the winding warms along the run")

    @model_validator(mode="after")
    def _of_two_masses(self) -> Self:
        if self.model == "rigid" and {"stiffness", "damping_ratio", "backlash"} & self.model_fields_set:
            raise ValueError("stiffness, damping_ratio and backlash belong to model: two_mass")
        return self
