"""Figures of a drive's parts that no data sheet gives, as they were estimated from peers."""

from __future__ import annotations

from typing import NamedTuple

from drivesizer.units import show

__all__ = ["EstimatedFigure"]


class EstimatedFigure(NamedTuple):
    """One figure of one part."""

    part: str  # motor, gearhead, encoder, controller, actuator
    figure: str  # column of the catalogue, or ``loss_voltage`` of a controller
    value: float  # SI
    low: float  # 5th percentile
    high: float  # 95th percentile
    kind: str
    unit: str  # of the trade
    law: str  # terms and peers, in words

    @property
    def title(self) -> str:
        """Part and figure.

        >>> EstimatedFigure("motor", "rotor_inertia", 1e-6, 7e-7, 2e-6, "inertia", "g*cm^2", "").title
        'motor rotor inertia'
        """
        return f"{self.part} {self.figure.replace('_', ' ')}"

    @property
    def text(self) -> str:
        """Value and band as they are printed."""
        value, low, high = (show(figure, self.unit, self.kind, 2) for figure in (self.value, self.low, self.high))
        return f"{value} ({low} to {high})"
