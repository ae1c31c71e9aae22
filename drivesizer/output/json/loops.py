"""A loop in the JSON document: linear analysis with its curves."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, cast

from drivesizer.control.loop_records import Bode, Loop
from drivesizer.output.loop_table import settled
from drivesizer.output.thinning import curve_points

if TYPE_CHECKING:
    from drivesizer.output.json import schema

__all__ = ["loop_document", "number"]


def number(value: float) -> float | None:
    """A figure as JSON has it: None where it is unknown or unbounded."""
    return float(value) if isfinite(value) else None


_LOOP = (  # key of the document, attribute of a loop; SI, the unit in the key
    ("period_s", "period"),
    ("pole_radius", "pole_radius"),
    ("gain_margin", "gain_margin"),
    ("gain_reduction", "gain_reduction"),
    ("phase_margin_rad", "phase_margin"),
    ("crossover_Hz", "crossover"),
    ("sensitivity", "sensitivity"),
    ("bandwidth_Hz", "bandwidth"),
    ("rise_time_s", "rise_time"),
    ("overshoot", "overshoot"),
    ("settling_time_s", "settling_time"),
)
_MOST_POINTS = 200  # of a curve


def loop_document(loop: Loop) -> schema.Loop:
    """A loop with its poles in the z plane as [re, im]; null where a figure does not exist."""
    found = {
        "name": loop.name,
        "direction": loop.direction or None,
        "stable": loop.stable,
        **{key: number(getattr(loop, name)) for key, name in _LOOP},
        "poles": [[number(pole.real), number(pole.imag)] for pole in loop.poles],
        "bode": _bode(loop.bode),
        "step": _step(loop),
    }
    return cast("schema.Loop", found)


def _bode(bode: Bode) -> schema.Bode:
    """Curves over the frequency; ``thinned_from`` says how many points were computed, peaks are kept."""
    rows = curve_points((bode.open_magnitude, bode.closed_magnitude), _MOST_POINTS)
    columns = {
        "frequency_Hz": bode.frequency,
        "open_magnitude": bode.open_magnitude,
        "open_phase_rad": bode.open_phase,
        "closed_magnitude": bode.closed_magnitude,
        "closed_phase_rad": bode.closed_phase,
    }
    thinned = {k: [number(x) for x in v[rows]] for k, v in columns.items()}
    return cast("schema.Bode", {"thinned_from": len(bode.frequency), **thinned})


def _step(loop: Loop) -> schema.Step | None:
    """Response to a unit step until it has settled, thinned as the curves are; None of an unstable loop."""
    if not len(loop.step):
        return None
    rows = curve_points((loop.step[: settled(loop)],), _MOST_POINTS)
    return {
        "thinned_from": len(loop.step),
        "time_s": [number(n * loop.period) for n in rows],
        "response": [number(x) for x in loop.step[rows]],
    }
