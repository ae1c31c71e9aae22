"""A requirement: what a load needs of a part, with the equation that it comes from."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.equation import Equation
from drivesizer.units import from_si, show

__all__ = ["Requirement"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirement:
    """A quantity that the load requires, with the equation and the numbers it came from."""

    name: str
    title: str
    symbol: str
    value: Any  # SI; one figure, or a column while the search runs
    kind: str
    unit: str  # of the trade
    declared: Equation | None = None  # None: given in the spec
    inputs: dict[str, Any] = field(default_factory=dict)  # SI, by the equation's own names
    note: str = ""

    @property
    def equation(self) -> int | None:
        """The paper's number, None for what it does not number."""
        return self.declared.number if self.declared else None

    @property
    def shown(self) -> float:
        """The value in the unit of the trade."""
        return float(from_si(self.value, self.unit, self.kind))

    @property
    def text(self) -> str:
        """The value as it is printed."""
        return show(self.value, self.unit, self.kind)

    def at(self, index: int) -> Requirement:
        """The figure of one candidate out of a column."""

        def pick(value: Any) -> Any:
            return float(value[index]) if getattr(value, "ndim", 0) else value

        return replace(self, value=pick(self.value), inputs={k: pick(v) for k, v in self.inputs.items()})

    def on(self, rows: NDArray[np.int64]) -> Requirement:
        """The figures of some candidates out of a column."""

        def pick(value: Any) -> Any:
            return value[rows] if getattr(value, "ndim", 0) else value

        return replace(self, value=pick(self.value), inputs={k: pick(v) for k, v in self.inputs.items()})
