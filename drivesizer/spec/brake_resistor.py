"""Section of a spec on the brake resistor of its bus."""

from typing import Annotated, Any, Self

from pydantic import Field, PrivateAttr, model_validator

from drivesizer.files.fields import (
    Current,
    Duration,
    Names,
    Power,
    Quantity,
    Resistance,
    Section,
    Voltage,
    default,
)

__all__ = ["BrakeResistor"]

_ANY = "any"  # out of the catalogues
Energy = Annotated[float, Quantity("energy", above=0.0)]
_OWN = ("resistance", "power", "peak_power", "pulse_energy")


class BrakeResistor(Section):
    """Resistor that burns regenerated energy: its figures, or out of a catalogue; `any`: the smallest that suffices."""

    family: Names | None = Field(default=None, description="of a catalogue: the smallest that suffices")
    part: Names | None = Field(default=None, description="of a catalogue, one or several")
    resistance: Resistance | None = Field(default=None, description="of a resistor that no catalogue lists")
    power: Power | None = Field(default=None, description="continuous")
    peak_power: Power | None = Field(default=None, description="for as long as a braking lasts")
    pulse_energy: Energy | None = Field(default=None, description="of a single braking")
    chopper_voltage: Voltage | None = Field(
        default=None, description="at which the chopper switches on; that of a shunt regulator where not given"
    )
    chopper_current: Current | None = Field(default=None, description="that the chopper can switch")
    averaging_time: Duration = default("60 s", description="over which the mean power counts, at its worst")

    _may_be_none: bool = PrivateAttr(default=False)

    @property
    def may_be_none(self) -> bool:
        """Whether none need be taken: no part and no figures of it are given."""
        return self._may_be_none or (self.resistance is None and not self.part)

    def among(self, parts: list[str], voltage: float) -> Self:
        """The section with the parts that are left to choose from, and the lowest voltage of their choppers [V]."""
        free = self.may_be_none
        made = self.model_copy(update={"part": parts, "family": None, "chopper_voltage": voltage})
        made._may_be_none = free
        return made

    @model_validator(mode="before")
    @classmethod
    def _any(cls, given: Any) -> Any:
        return {} if given == _ANY else given

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if self.resistance is None:
            lone = [name for name in _OWN[1:] if getattr(self, name) is not None]
            if lone:
                raise ValueError(f"give {lone[0]} with the resistance of a resistor of your own; a part has its own")
            return self
        if self.family or self.part:
            raise ValueError("give family or part of a catalogue, or resistance, not both")
        if self.chopper_voltage is None:
            raise ValueError("give chopper_voltage with resistance: at which the chopper switches it on")
        if self.power and self.peak_power and self.peak_power < self.power:
            raise ValueError("expected peak_power >= power")
        return self
