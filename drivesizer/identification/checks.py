"""Checks of a log, and factors by which a column would fit the data sheet."""

from __future__ import annotations

from collections.abc import Iterator
from math import isnan, pi, sqrt

import numpy as np

from drivesizer.identification.log import Log
from drivesizer.results.identification import LogFinding
from drivesizer.units import show

_JITTER = 0.05  # of the interval
_COARSE = 0.01  # of the largest speed
_LIMITED = 0.02  # of the moments
_SAG = 0.05
_WARMER = 10.0  # K
_NEAR = 0.06  # of a factor
_OFF = 0.12  # of a constant, from which on a factor is looked for
_FAR = 0.5  # and from which on it is said that there is none
_FACTORS = (  # times the column, and what it would be
    (2.0 * pi, "turns per second taken as rad/s"), (1.0 / (2.0 * pi), "rad/s taken as turns per second"),
    (pi / 30.0, "rpm taken as rad/s"), (30.0 / pi, "rad/s taken as rpm"), (60.0, "per second taken as per minute"),
    (1.0 / 60.0, "per minute taken as per second"), (sqrt(3.0) / 2.0, "amplitude of a phase against two in series"),
    (2.0 / sqrt(3.0), "two in series against the amplitude of a phase"), (sqrt(2.0), "effective value of an amplitude"),
    (1.0 / sqrt(2.0), "amplitude of an effective value"), (sqrt(3.0), "a phase against two in series"),
    (1.0 / sqrt(3.0), "two in series against a phase"), (2.0, "a phase against two in series"),
    (0.5, "two in series against a phase"), (1e-3, "thousandths"), (1e3, "thousands"),
)  # fmt: skip


def log_findings(log: Log, *, pulled: bool) -> Iterator[LogFinding]:
    """Sampling, steps, limits, sag and warming of a log; ``pulled``: a load is known to pull one way."""
    columns = log.columns
    if not log.steady:
        apart = np.diff(columns["time"])
        apart = apart[(apart > 0.0) & (apart < 10.0 * np.median(apart))]
        usual, spread = float(np.median(apart)), float(apart.std())
        if spread > _JITTER * usual:
            every = f"{show(usual, 'ms', 'time', 3)} ± {show(spread, 'ms', 'time', 2)}"
            yield LogFinding("jitter", f"samples every {every}: they are put on an even grid")
    if "speed" in columns:
        steps = np.diff(np.unique(columns["speed"]))
        top = float(np.abs(columns["speed"]).max())
        if len(steps) and float(steps.min()) > _COARSE * top:
            yield LogFinding(
                "quantisation", f"the speed comes in steps of {float(steps.min()) / top:.1%} of its largest"
            )
    if not pulled and {"current", "speed"} <= set(columns):
        current, speed = columns["current"], columns["speed"]
        if current.min() >= 0.0 < current.max() and speed.max() > -0.2 * speed.min() > 0.0:
            text = f"{log.heads['current']} has no direction: it is never below 0 while the speed reverses"
            yield LogFinding("direction", text, severe=True)
    for name in ("voltage", "current", "duty"):
        if name in columns:
            size = np.abs(columns[name])
            share = float((size >= size.max() * (1.0 - 1e-6)).mean())
            if share > _LIMITED and size.max() > 1.5 * np.median(size):
                yield LogFinding(
                    "saturation", f"{log.heads[name]} is at its largest value {share:.0%} of the time: a limit"
                )
    if "supply" in columns:
        low, high = float(columns["supply"].min()), float(columns["supply"].max())
        if high - low > _SAG * high:
            yield LogFinding("sag", f"the supply sags from {high:.4g} to {low:.4g} V")
    if "winding" in columns and (rise := float(np.ptp(columns["winding"]))) > _WARMER:
        yield LogFinding(
            "warming", f"the winding's temperature changes by {rise:.3g} K: resistance by {0.39 * rise:.2g} %"
        )


def unit_findings(of: str, column: str, found: float, printed: float, ratio: float) -> Iterator[LogFinding]:
    """A factor that would make a constant that of the data sheet, where it is far from it.

    Parameters
    ----------
    of, column
        The constant in words, and the column that it is blamed on.
    found, printed
        The constant by the log, and on the data sheet [SI].
    ratio
        Of the gears: a speed may be that of the other side.
    """
    if isnan(printed) or not found > 0.0 or not printed > 0.0:
        return
    off = found / printed
    if abs(off - 1.0) < _OFF:
        return
    gears = [] if ratio == 1.0 else [(ratio, "the speed of the output"), (1.0 / ratio, "the speed of the motor")]
    factor, meaning = min((*_FACTORS, *gears), key=lambda one: abs(np.log(off / one[0])))
    near = abs(off / factor - 1.0) < _NEAR
    if not near and abs(off - 1.0) < _FAR:
        return  # a deviation, which its own row shows
    said = f"{of} is {off:.4g} times that of the data sheet"
    more = f": {column} times {factor:.5g} would fit it ({meaning})" if near else ": no usual factor explains it"
    yield LogFinding("units", said + more, factor if near else float("nan"), severe=True)
