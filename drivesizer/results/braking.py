"""The bus while the drives brake: what is regenerated, the brake resistor and the power supply, as records."""

from __future__ import annotations

from dataclasses import dataclass

from drivesizer.catalog import BrakeResistor
from drivesizer.results.check import Check, Figure

__all__ = ["BrakingBudget"]


@dataclass(frozen=True, slots=True, kw_only=True)
class BrakingBudget:
    """Regenerated energy, and what becomes of it; of the load case in which most is burnt."""

    resistor: BrakeResistor | None  # chosen, or as the spec has it; None where none is wanted or needed
    checks: tuple[Check, ...]  # of resistor, chopper and power supply
    figures: tuple[Figure, ...]
    assumptions: tuple[str, ...]

    @property
    def name(self) -> str:
        """The resistor in words; empty without one."""
        return " ".join(filter(None, (self.resistor.manufacturer, self.resistor.part))) if self.resistor else ""
