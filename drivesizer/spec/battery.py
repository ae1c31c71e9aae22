"""Sections of a spec on its battery, further consumers, and the brake resistor of its bus."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, PrivateAttr, model_validator

from drivesizer.files import fields

# -- Sections of a spec on its battery and on further consumers.


Charge = Annotated[float, fields.Quantity("charge", above=0.0)]
Count = Annotated[int, Field(ge=1, le=10_000)]


class Run(fields.Section):
    """One line of a discharge table: a constant current or power, and how long it lasts."""

    current: fields.Current | None = fields.optional(example="5 A")
    power: fields.Power | None = None
    time: fields.Duration = fields.required(example="1 h")

    def _contradictions(self) -> Iterator[str]:
        if (self.current is None) == (self.power is None):
            yield "give current or power, exactly one of them"


class OpenCircuit(fields.Section):
    """Voltage of a cell or block at rest; straight between full and empty."""

    full: fields.Voltage = fields.required(example="4.2 V")
    empty: fields.Voltage = fields.required(example="3.2 V")

    def _contradictions(self) -> Iterator[str]:
        if self.empty > self.full:
            yield "expected empty <= full"


class Polarisation(fields.Section):
    """Polarisation of a cell or block under lasting current: one RC pair."""

    resistance: fields.Resistance = fields.required(example="10 mohm")
    time_constant: fields.Duration = fields.required(example="30 s")


class Charger(fields.Section):
    """Charger of the whole battery, at a constant current."""

    current: fields.Current = fields.required(example="10 A")
    efficiency: fields.Share = fields.default(1, "share of the charge that stays in it")


class Battery(fields.Section):
    """Cells or blocks in series and parallel: a part of a catalogue, its own figures, or both. Figures are of one."""

    part: str | None = fields.optional("cell or block of a catalogue", min_length=1)
    series: Count = fields.default(1, "cells or blocks in series")
    parallel: Count = fields.default(1, "parallel strings")
    chemistry: Literal["lead-acid", "Li-ion", "LiFePO4"] | None = None
    nominal_voltage: fields.Voltage | None = fields.optional(example="3.6 V")
    charge_voltage: fields.Voltage | None = fields.optional(example="4.2 V")
    cutoff_voltage: fields.Voltage | None = fields.optional("at which a discharge ends", example="3 V")
    capacity: Charge | None = fields.optional("drawn in the rated time")
    rated_time: fields.Duration | None = fields.optional("in which the capacity is drawn, e.g. 20 h", example="20 h")
    peukert_exponent: fields.Factor | None = None
    discharge: Annotated[list[Run], Field(min_length=2)] | None = fields.optional(
        "how long constant currents, or powers, last"
    )
    resistance: fields.Resistance | None = fields.optional("to direct current", example="20 mohm")
    polarisation: Polarisation | None = None
    open_circuit: OpenCircuit | None = fields.optional("voltage at rest; the nominal where not given")
    continuous_current: fields.Current | None = fields.optional(example="20 A")
    peak_current: fields.Current | None = fields.optional(example="60 A")
    max_charge_current: fields.Current | None = fields.optional(example="10 A")
    charger: Charger | None = fields.optional("of the whole battery, for the time of charging")
    mass: fields.Mass | None = None
    start: fields.Share = fields.default(1, "share of the charge at the start of the mission")
    usable: fields.Share = fields.default(1, "share of the charge that may be drawn")
    health: fields.Share = fields.default(1, "share of the rated capacity that age and cold leave")
    autonomy: fields.Duration | None = fields.optional("that is required; the mission's where not given", example="4 h")
    range: fields.Length | None = fields.optional("that is required, of a vehicle", example="20 km")
    reserve: fields.Allowance = fields.default(0, "by which autonomy and range must exceed what is required")

    def _contradictions(self) -> Iterator[str]:
        lacking = [n for n in ("nominal_voltage", "capacity") if getattr(self, n) is None]
        if self.part is None and lacking:
            yield f"give a part of a catalogue, or {' and '.join(lacking)} as well"
        if len({run.power is None for run in self.discharge or ()}) > 1:
            yield "give currents or powers in discharge, not both"
        nominal, charge = self.nominal_voltage, self.charge_voltage
        if nominal is not None and charge is not None and charge < nominal:
            yield "expected charge_voltage >= nominal_voltage; both are of one cell or block"
        if self.start + self.usable <= 1.0:
            yield "expected start above the share that may not be drawn, 1 - usable"


class Consumer(fields.Section):
    """Consumer beside the drive that draws from the battery."""

    name: str = Field(min_length=1, max_length=60)
    power: fields.Power = fields.required("of one, while it is on")
    number: Count = 1
    duty: fields.Part | None = fields.optional("share of the time for which it is on; 1 where not given")
    time: fields.Duration | None = fields.optional(
        "for which it is on in the mission, instead of duty", example="30 min"
    )
    peak_power: fields.Power | None = fields.optional("of one; its power where not given")
    efficiency: fields.Share = fields.default(1, "of the converter that supplies it")
    assumed: bool = fields.default(False, "whether its figures are assumed, and reported so")

    def _contradictions(self) -> Iterator[str]:
        if self.duty is not None and self.time is not None:
            yield "give duty or time, not both"
        if self.peak_power is not None and self.peak_power < self.power:
            yield "expected peak_power >= power"

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
_OWN = ("resistance", "power", "peak_power", "pulse_energy")


class BrakeResistor(fields.Section):
    """Resistor that burns regenerated energy: its figures, or out of a catalogue; `any`: the smallest that suffices."""

    family: fields.Names | None = fields.optional("of a catalogue: the smallest that suffices")
    part: fields.Names | None = fields.optional("of a catalogue, one or several")
    resistance: fields.Resistance | None = fields.optional("of a resistor that no catalogue lists", example="10 ohm")
    power: fields.Power | None = fields.optional("continuous", example="50 W")
    peak_power: fields.Power | None = fields.optional("for as long as a braking lasts", example="500 W")
    pulse_energy: fields.Energy | None = fields.optional("of a single braking", example="200 J")
    chopper_voltage: fields.Voltage | None = fields.optional(
        "at which the chopper switches on; that of a shunt regulator where not given", example="56 V"
    )
    chopper_current: fields.Current | None = fields.optional("that the chopper can switch")
    averaging_time: fields.Duration = fields.default("60 s", "over which the mean power counts, at its worst")

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

    def _contradictions(self) -> Iterator[str]:
        if self.resistance is None:
            lone = [name for name in _OWN[1:] if getattr(self, name) is not None]
            if lone:
                yield f"give {lone[0]} with the resistance of a resistor of your own; a part has its own"
            return
        if self.family or self.part:
            yield "give family or part of a catalogue, or resistance, not both"
        if self.chopper_voltage is None:
            yield "give chopper_voltage with resistance: at which the chopper switches it on"
        if self.power and self.peak_power and self.peak_power < self.power:
            yield "expected peak_power >= power"
