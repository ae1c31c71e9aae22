"""Sections of a spec on path following: controllers, floor and measured errors."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from drivesizer.files.fields import (
    Angle,
    Coefficient,
    Duration,
    Length,
    Quantity,
    Section,
    Speed,
    TorqueAbove,
    default,
    no_entries,
)
from drivesizer.files.inertia import Inertia

__all__ = ["Following", "Measured"]

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
