"""Sections of a spec on its battery, further consumers, and the brake resistor of its bus."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, PrivateAttr, model_validator

from drivesizer.files.fields import (
    Allowance,
    Current,
    Duration,
    Factor,
    Length,
    Mass,
    Names,
    Part,
    Power,
    Quantity,
    Resistance,
    Section,
    Share,
    Voltage,
    default,
)

__all__ = ["Battery", "BrakeResistor", "Consumer"]


# -- Sections of a spec on its battery and on further consumers.


Charge = Annotated[float, Quantity("charge", above=0.0)]
Count = Annotated[int, Field(ge=1, le=10_000)]


class Run(Section):
    """One line of a discharge table: a constant current or power, and how long it lasts."""

    current: Current | None = None
    power: Power | None = None
    time: Duration

    @model_validator(mode="after")
    def _one_held(self) -> Self:
        if (self.current is None) == (self.power is None):
            raise ValueError("give current or power, exactly one of them")
        return self


class OpenCircuit(Section):
    """Voltage of a cell or block at rest; straight between full and empty."""

    full: Voltage
    empty: Voltage

    @model_validator(mode="after")
    def _falling(self) -> Self:
        if self.empty > self.full:
            raise ValueError("expected empty <= full")
        return self


class Polarisation(Section):
    """Polarisation of a cell or block under lasting current: one RC pair."""

    resistance: Resistance
    time_constant: Duration


class Charger(Section):
    """Charger of the whole battery, at a constant current."""

    current: Current
    efficiency: Share = Field(default=1, description="share of the charge that stays in it")


class Battery(Section):
    """Cells or blocks in series and parallel: a part of a catalogue, its own figures, or both. Figures are of one."""

    part: str | None = Field(default=None, min_length=1, description="cell or block of a catalogue")
    series: Count = Field(default=1, description="cells or blocks in series")
    parallel: Count = Field(default=1, description="parallel strings")
    chemistry: Literal["lead-acid", "Li-ion", "LiFePO4"] | None = None
    nominal_voltage: Voltage | None = None
    charge_voltage: Voltage | None = None
    cutoff_voltage: Voltage | None = Field(default=None, description="at which a discharge ends")
    capacity: Charge | None = Field(default=None, description="drawn in the rated time")
    rated_time: Duration | None = Field(default=None, description="in which the capacity is drawn, e.g. 20 h")
    peukert_exponent: Factor | None = None
    discharge: Annotated[list[Run], Field(min_length=2)] | None = Field(
        default=None, description="how long constant currents, or powers, last"
    )
    resistance: Resistance | None = Field(default=None, description="to direct current")
    polarisation: Polarisation | None = None
    open_circuit: OpenCircuit | None = Field(default=None, description="voltage at rest; the nominal where not given")
    continuous_current: Current | None = None
    peak_current: Current | None = None
    max_charge_current: Current | None = None
    charger: Charger | None = Field(default=None, description="of the whole battery, for the time of charging")
    mass: Mass | None = None
    start: Share = Field(default=1, description="share of the charge at the start of the mission")
    usable: Share = Field(default=1, description="share of the charge that may be drawn")
    health: Share = Field(default=1, description="share of the rated capacity that age and cold leave")
    autonomy: Duration | None = Field(default=None, description="that is required; the mission's where not given")
    range: Length | None = Field(default=None, description="that is required, of a vehicle")
    reserve: Allowance = Field(default=0, description="by which autonomy and range must exceed what is required")

    @model_validator(mode="after")
    def _known(self) -> Self:
        lacking = [n for n in ("nominal_voltage", "capacity") if getattr(self, n) is None]
        if self.part is None and lacking:
            raise ValueError(f"give a part of a catalogue, or {' and '.join(lacking)} as well")
        if len({run.power is None for run in self.discharge or ()}) > 1:
            raise ValueError("give currents or powers in discharge, not both")
        nominal, charge = self.nominal_voltage, self.charge_voltage
        if nominal is not None and charge is not None and charge < nominal:
            raise ValueError("expected charge_voltage >= nominal_voltage; both are of one cell or block")
        if self.start + self.usable <= 1.0:
            raise ValueError("expected start above the share that may not be drawn, 1 - usable")
        return self


class Consumer(Section):
    """Consumer beside the drive that draws from the battery."""

    name: str = Field(min_length=1, max_length=60)
    power: Power = Field(description="of one, while it is on")
    number: Count = 1
    duty: Part | None = Field(default=None, description="share of the time for which it is on; 1 where not given")
    time: Duration | None = Field(default=None, description="for which it is on in the mission, instead of duty")
    peak_power: Power | None = Field(default=None, description="of one; its power where not given")
    efficiency: Share = Field(default=1, description="of the converter that supplies it")
    assumed: bool = Field(default=False, description="whether its figures are assumed, and reported so")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.duty is not None and self.time is not None:
            raise ValueError("give duty or time, not both")
        if self.peak_power is not None and self.peak_power < self.power:
            raise ValueError("expected peak_power >= power")
        return self

    def share(self, mission: float | None) -> float:
        """Share of a mission's time [s] for which it is on [1]."""
        if self.time is None:
            return 1.0 if self.duty is None else self.duty
        if mission is None:
            raise ValueError(f"expected mission.duration for the time of {self.name}; else give its duty")
        if np.all(self.time > mission):
            raise ValueError(f"expected the time of {self.name} not to be longer than the mission")
        return np.minimum(self.time / mission, 1.0)  # type: ignore[no-any-return]  # a column where it is sampled

    def drawn(self, mission: float | None) -> tuple[float, float]:
        """Power out of the battery in the mean over a mission's time [s] and at most [W]."""
        each = self.number / self.efficiency
        highest = self.power if self.peak_power is None else self.peak_power
        return each * self.power * self.share(mission), each * highest


# -- Section of a spec on the brake resistor of its bus.


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
