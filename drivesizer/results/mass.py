"""A line of a mass budget."""

from __future__ import annotations

from dataclasses import dataclass

from drivesizer.units import show

__all__ = ["MassRow"]


@dataclass(frozen=True, slots=True, kw_only=True)
class MassRow:
    """One line of a mass budget."""

    name: str
    each: float  # kg; NaN is unknown
    number: int = 1
    band: tuple[float, float] | None = None  # kg, 5th and 95th percentile where it is estimated

    @property
    def total(self) -> float:
        """Of all of them [kg]."""
        return self.number * self.each

    @property
    def ends(self) -> tuple[float, float]:
        """Of all of them at both ends of the band [kg]; twice the same where it is known."""
        low, high = self.band or (self.each, self.each)
        return self.number * low, self.number * high

    def text(self, mass: float, unit: str) -> str:
        """A mass of the row as it is printed, with the band where it is estimated.

        >>> MassRow(name="encoder", each=0.02, band=(0.005, 0.08)).text(0.02, "g")
        '20 g (5 to 80 g)'
        """
        if self.band is None or not self.each > 0.0:
            return show(mass, unit, "mass")
        value, low, high = (show(mass * end / self.each, unit, "mass", 2) for end in (self.each, *self.band))
        return f"{value} ({low.removesuffix(f' {unit}')} to {high})"
