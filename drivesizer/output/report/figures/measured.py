"""Measured against model over time: figures of a log."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from drivesizer.output.report.figures.picture import DASHED, Curve, Diagram, Plot
from drivesizer.results.identification import Trace
from drivesizer.units import from_si

_POINTS = 3000  # of a curve


def measured_and_model(time: NDArray[np.float64], traces: Sequence[Trace]) -> Plot:
    """Each quantity of a log as it was measured and as the model has it.

    Parameters
    ----------
    time
        Of their values [s].
    traces
        The quantities; moves behind one another count on.

    Returns
    -------
    Plot
        A diagram of each.
    """
    apart = np.diff(time)
    usual = float(np.median(apart)) if len(apart) else 1.0
    along = np.concatenate([[0.0], np.cumsum(np.where((apart > 0.0) & (apart < 20.0 * usual), apart, usual))])
    some = slice(None, None, max(1, len(along) // _POINTS))

    def curves(one: Trace) -> list[Curve]:
        made = [("measured", one.measured, "grey", "solid", 1.4), ("model", one.modelled, "vermillion", DASHED, 1.0)]
        return [Curve(name=name, x=along[some], y=from_si(y, one.unit, one.kind)[some], colour=colour, dashes=dashes,
                      width=width) for name, y, colour, dashes, width in made]  # fmt: skip

    diagrams = [Diagram(name=one.name, unit=one.unit, curves=curves(one), height=1.3) for one in traces]
    return Plot(diagrams=diagrams, across="time", unit="s", ends=(0.0, float(along[-1])))
