"""Section of a spec on permitted parts and the objective of the ranking."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, field_validator

from drivesizer.files.fields import Names, Ratio, Section, all_defaults

__all__ = [
    "ASSUMABLE", "BOUGHT", "OBJECTIVES", "Choice", "ControllerChoice", "EncoderChoice", "MotorChoice", "Objective",
    "ObjectiveKind", "Select", "Weighted",
]  # fmt: skip


@dataclass(frozen=True, slots=True)
class ObjectiveKind:
    """An objective of ranking: a sum of catalogue figures, or a figure of the load cycle."""

    title: str
    kind: str  # of quantity
    unit: str  # of the trade
    figure: str = ""  # of the parts, that is summed; none: what ``search.columns.powered`` computes under this name
    over: tuple[str, ...] = ()  # roles of the parts that it is summed over
    note: str = ""  # beside a value that is no sum: its meaning
    more_is_better: bool = False
    by_waveform: bool = False  # needs the current over time, not moments and extremes alone


_TURNING = ("motor", "gearhead", "brake")
BOUGHT = (*_TURNING, "encoder", "controller")
"""Roles of the parts that mass and price are summed over: an actuator has some of them inside."""
OBJECTIVES: dict[str, ObjectiveKind] = {
    "mass": ObjectiveKind("mass", "mass", "g", "mass", BOUGHT),
    "price": ObjectiveKind("price", "price", "EUR", "price", BOUGHT),
    "length": ObjectiveKind("length", "length", "mm", "length", _TURNING),
    "power": ObjectiveKind("assigned power", "power", "W", "assigned_power", ("motor",)),
    "energy": ObjectiveKind("energy per cycle", "energy", "J", note="all drives, per cycle", by_waveform=True),
    "joule_heat": ObjectiveKind(
        "heat of the winding", "power", "W", note="of the motor's winding, mean", by_waveform=True
    ),
    "peak_current": ObjectiveKind("peak current", "current", "A", note="the motor's, in the worst case"),
    "winding_temperature": ObjectiveKind(
        "winding temperature", "temperature", "degC", note="peak over the periodic cycle, in the worst case",
        by_waveform=True,
    ),
    "margin": ObjectiveKind(
        "smallest margin", "dimensionless", "%", note="smallest margin of all checks", more_is_better=True,
        by_waveform=True,
    ),
}  # fmt: skip


ASSUMABLE: dict[str, tuple[str, ...]] = {  # checks that pass where a figure is missing, if the spec says so
    "ambient_range": ("motor_temperature_range", "gearhead_temperature_range"),
    "backlash": ("backlash_at_load",),
    "peak_time": ("controller_peak_time",),
}


class Choice(Section):
    """Restricts a kind of part to some families or part numbers; * stands for any text."""

    family: Names | None = Field(default=None, description='such as "EC 45 flat" or "EC*"')
    part: Names | None = None

    @property
    def named(self) -> dict[str, list[str]]:
        """Names or patterns by the catalogue's column, as far as given."""
        return {key: names for key, names in (("family", self.family), ("part", self.part)) if names}


class MotorChoice(Choice):
    """Restricts the motor."""

    kind: Literal["brushed", "brushless", "stepper"] | None = Field(
        default=None, description="stepper: of the catalogues' steppers; else they are left out"
    )


class EncoderChoice(Choice):
    """Restricts the encoder."""

    min_counts: Annotated[int, Field(ge=1)] | None = Field(default=None, description="counts per turn at least")


class ControllerChoice(Choice):
    """Restricts the controller."""

    bus: str | None = Field(default=None, description="such as CANopen or EtherCAT")


if TYPE_CHECKING:
    Objective = str
else:
    Objective = Literal[tuple(OBJECTIVES)]


class Weighted(Section):
    """One of several objectives, weighted relative to the smallest value of all drives."""

    objective: Objective
    weight: Ratio


class Select(Section):
    """Permitted parts, and the objective of the ranking."""

    catalogs: Names = Field(default=["maxon"])
    motor: MotorChoice = all_defaults()
    gearhead: Choice = all_defaults()
    encoder: EncoderChoice = all_defaults()
    controller: ControllerChoice = all_defaults()
    brake: Choice = all_defaults()
    objective: Objective | Annotated[list[Weighted], Field(min_length=1, max_length=8)] = "mass"
    unknown: Literal["allow", "reject"] = Field(default="allow", description="drives with a check that is unknown")
    assume: list[Literal["ambient_range", "backlash", "peak_time"]] = Field(
        default=[], description="checks that pass where their figure is missing, shown as assumed"
    )

    estimates: Literal["on", "off"] = Field(
        default="on", description="figures that data sheets leave out, from those of their peers"
    )

    @field_validator("objective")
    @classmethod
    def _each_once(cls, given: Objective | list[Weighted]) -> Objective | list[Weighted]:
        names = [one.objective for one in given] if isinstance(given, list) else []
        if twice := [name for name in names if names.count(name) > 1]:
            raise ValueError(f"expected each objective once; {twice[0]} is given twice")
        return given

    @property
    def is_restricted(self) -> bool:
        """Whether families or parts are named."""
        return any(c.named for c in (self.motor, self.gearhead, self.encoder, self.controller, self.brake))
