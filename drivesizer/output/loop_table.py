"""What linear theory says of loops as figures in one order: what each is called, its kind and unit of the trade."""

from __future__ import annotations

from math import isnan, nan

from drivesizer.control.loop_records import Loop
from drivesizer.results.sizing import Figure
from drivesizer.units import show

__all__ = ["NONE", "cell", "loop_figures", "loop_name", "settled"]

NONE = "–"  # of a figure that does not exist: an unstable loop has no margins, some gains may rise without end

_COLUMNS = (  # attribute of a loop, title, kind, unit
    ("bandwidth", "bandwidth", "frequency", "Hz"),
    ("phase_margin", "phase margin", "angle", "deg"),
    ("gain_margin", "gain margin", "dimensionless", "1"),
    ("overshoot", "overshoot", "dimensionless", "%"),
    ("settling_time", "settling time", "time", "ms"),
    ("pole_radius", "largest pole", "dimensionless", "1"),
    ("crossover", "crossover", "frequency", "Hz"),
    ("rise_time", "rise time", "time", "ms"),
    ("sensitivity", "sensitivity", "dimensionless", "1"),
    ("period", "period", "time", "ms"),
)


def loop_figures(loop: Loop) -> tuple[Figure, ...]:
    """The figures of a loop, the most asked for first; NaN where one does not exist.

    The sensitivity of an unstable loop is left NaN: its distance to -1 is no measure of robustness.
    """
    found = {name: float(getattr(loop, name)) for name, *_ in _COLUMNS}
    if not loop.stable:
        found["sensitivity"] = nan
    return tuple(Figure(name=name, title=title, value=found[name], kind=k, unit=u) for name, title, k, u in _COLUMNS)


def loop_name(loop: Loop) -> str:
    """What a loop is called, with the direction of power that its record is of.

    >>> from types import SimpleNamespace
    >>> loop_name(SimpleNamespace(name="velocity", direction="braking"))
    'velocity, braking'
    """
    return ", ".join(filter(None, (loop.name, loop.direction)))


def cell(figure: Figure) -> str:
    """A figure of a loop as it stands in a table: three digits, the pole's modulus with four; a dash where none is."""
    if isnan(figure.value):
        return NONE
    return show(figure.value, figure.unit, figure.kind, 4 if figure.name == "pole_radius" else 3)


def settled(loop: Loop) -> int:
    """How many samples of a step tell all: to twice the settling time; all of them where it does not settle."""
    if isnan(loop.settling_time):
        return len(loop.step)
    return min(max(round(2.0 * loop.settling_time / loop.period), _LEAST) + 1, len(loop.step))


_LEAST = 10  # samples, of a loop that settles at once
