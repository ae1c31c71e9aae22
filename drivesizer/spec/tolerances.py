"""Section ``tolerances`` of a spec: required confidence, samples, and tolerances of catalogue figures."""

from typing import Annotated

from pydantic import BeforeValidator, Field

from drivesizer.catalog.tolerances.classes import NOT_OF_STEPPERS, OF_STEPPERS
from drivesizer.catalog.tolerances.factors import share
from drivesizer.files.fields import Section, Share, all_defaults

__all__ = ["FEWEST", "MOST", "ControllerTolerances", "GearheadTolerances", "MotorTolerances", "Tolerances"]

FEWEST, MOST = 64, 1_000_000  # samples of a drive


def _readable(text: object) -> object:
    if isinstance(text, str):
        share(text)  # an InputError is a ValueError
    return text


Factor = Annotated[str, BeforeValidator(_readable)]
_FACTOR = "+- 7 %, -10 %..30 %, normal(5 %) or none"


class MotorTolerances(Section):
    """Of a motor's figures, as shares of what the catalogue prints; the default class where not given."""

    resistance: Factor | None = Field(default=None, description=_FACTOR)
    torque_constant: Factor | None = Field(default=None, description=_FACTOR)
    friction: Factor | None = Field(default=None, description=f"of friction and iron loss: {_FACTOR}")
    dry_friction: Factor | None = Field(
        default=None, description=f"of the dry share of a brushless motor's no-load torque: {_FACTOR}"
    )
    rotor_inertia: Factor | None = Field(default=None, description=_FACTOR)
    thermal_resistance: Factor | None = Field(default=None, description=f"of both: {_FACTOR}")
    pull_out: Factor | None = Field(default=None, description=f"of a stepper's pull-out torque at any speed: {_FACTOR}")
    holding_torque: Factor | None = Field(default=None, description=f"of a stepper without a printed curve: {_FACTOR}")
    inductance: Factor | None = Field(default=None, description=f"of a stepper without a printed curve: {_FACTOR}")
    start_speed: Factor | None = Field(default=None, description=f"of a stepper without a ramp: {_FACTOR}")


class GearheadTolerances(Section):
    """Of a gearhead's figures; the default class where not given."""

    peak_torque: Factor | None = Field(
        default=None, description=f"of an actuator's peak torque that is its stall torque: {_FACTOR}"
    )
    efficiency: Factor | None = Field(default=None, description=f"of its losses: {_FACTOR}")
    inertia: Factor | None = Field(default=None, description=_FACTOR)


class ControllerTolerances(Section):
    """Of a controller's figures; the default class where not given."""

    losses: Factor | None = Field(default=None, description=f"per ampere: {_FACTOR}")
    phase_current: Factor | None = Field(default=None, description=f"of what a stepper's driver sets: {_FACTOR}")


class Tolerances(Section):
    """Required confidence, and its sampling."""

    confidence: Share | None = Field(default=None, description="probability that no check fails, at least")
    samples: Annotated[int, Field(ge=FEWEST, le=MOST)] = Field(default=8192, description="of each drive")
    loop_samples: Annotated[int, Field(ge=0, le=10_000)] = Field(
        default=64, description="of the best drives in closed loop, where a confidence is required; 0 for none"
    )
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] = Field(default=1, description="the same seed, the same figures")
    motor: MotorTolerances = all_defaults()
    gearhead: GearheadTolerances = all_defaults()
    controller: ControllerTolerances = all_defaults()

    @property
    def given(self) -> dict[tuple[str, str], str]:
        """Tolerances in place of the default classes, by part and figure."""
        parts = {"motor": self.motor, "gearhead": self.gearhead, "controller": self.controller}
        return {
            (part, figure): text
            for part, section in parts.items()
            for figure in type(section).model_fields
            if (text := getattr(section, figure)) is not None
        }

    def foreign(self, *, steps: bool) -> str:
        """The first tolerance of a figure that motors of this kind have not, as in a message; empty without one."""
        for part, figure in self.given:
            if (part, figure) in OF_STEPPERS and not steps:
                return f"tolerances.{part}.{figure}: it is of steppers; expected select: {{motor: {{kind: stepper}}}}"
            if (part, figure) in NOT_OF_STEPPERS and steps:
                return f"tolerances.{part}.{figure}: no check of a stepper depends on it; leave it out"
        return ""
