"""A line of a mass budget."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["MassRow"]


@dataclass(frozen=True, slots=True, kw_only=True)
class MassRow:
    """One line of a mass budget."""

    name: str
    each: float  # kg; NaN is unknown
    number: int = 1

    @property
    def total(self) -> float:
        """Of all of them [kg]."""
        return self.number * self.each
