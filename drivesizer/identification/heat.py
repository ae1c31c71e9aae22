"""Winding and housing out of logged temperatures: thermal resistances and time constants by output error.

The two bodies are those of ``kernel.heat``, warmed by copper loss at the logged current; what heats them besides is in
the log's housing alone. Less than two time constants of the housing give lower bounds of what lies behind it.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from drivesizer.identification import declared
from drivesizer.identification.fit import BAND, spreads, widest
from drivesizer.identification.log import Log
from drivesizer.kernel.heat import added, bodies_of, law_of, spread
from drivesizer.physics.thermal import COPPER, resistance_at
from drivesizer.results.identification import IdentifiedFigure, Inseparable, Trace

Array = NDArray[np.float64]

_SPANS = 300  # of constant mean square current
_LEAST_RISE = 3.0  # K, below which temperatures say nothing
_SIGMA = 0.3  # K, of a sensor
_LONG = 2.0  # time constants of the housing
BOUND = "lower bound"
_CERTAIN = 0.5  # of a figure, standard deviation
_NEEDS = "temperatures of winding and housing over two time constants of the housing, while it warms and cools"


class Heat(NamedTuple):
    """Figures out of temperatures."""

    figures: tuple[IdentifiedFigure, ...] = ()
    inseparable: tuple[Inseparable, ...] = ()
    time: Array = np.zeros(0)
    traces: tuple[Trace, ...] = ()


def heated(log: Log, current: Array | None, R_25: float) -> Heat:
    """Fit the two bodies to a log's temperatures."""
    names = [name for name in ("winding", "housing") if name in log.columns]
    rises = [name for name in names if float(np.ptp(log.columns[name])) > _LEAST_RISE]
    if "winding" not in rises or log.steady:
        return Heat()
    if current is None or not R_25 > 0.0:
        lacks = "current" if current is None else "resistance"
        return Heat(inseparable=(Inseparable("thermal figures", f"the {lacks} is unknown", f"the motor's {lacks}"),))
    time = log.columns["time"] - log.columns["time"][0]
    edges = np.unique(np.linspace(0, len(time) - 1, min(_SPANS, len(time) - 1) + 1).astype(int))
    spans = np.diff(time[edges])
    square = np.array([float((current[a:b] ** 2).mean()) for a, b in pairwise(edges)])
    measured = np.array([log.columns[name][edges] for name in rises])
    ambient = float(min(column[0] for column in measured))
    start = [float(log.columns[name][0]) - ambient for name in names]
    start = [start[0], start[1] if "housing" in rises else start[0]]
    places = [("winding", "housing").index(name) for name in rises]

    def course(x: Array) -> Array:
        R_th1, tau_w, R_th2, tau_h = np.exp(x).tolist()
        b = bodies_of(float(resistance_at(R_25, ambient)), COPPER * R_25, R_th1, R_th2, tau_w / R_th1, tau_h / R_th2)
        w, h = start
        found = [(w, h)]
        for dt, I2 in zip(spans.tolist(), square.tolist(), strict=True):
            law = law_of(b, I2, 0.0)
            more_w, more_h, _ = added(law, spread(law, dt), dt, w, h)
            w, h = min(max(w + more_w, -300.0), 3000.0), min(max(h + more_h, -300.0), 3000.0)
            found.append((w, h))
        return np.array(found).T[places] + ambient

    def rest(x: Array) -> Array:
        return np.asarray((course(x) - measured).ravel() / _SIGMA)

    total = float(time[-1])
    least, most = np.log([1e-3, 1e-2, 1e-3, 1.0]), np.log([1e3, 1e5, 1e4, 1e7])
    tries = [np.clip(np.log([2.0, total / a, 6.0, total * c]), least + 0.01, most - 0.01)
             for a in (20.0, 4.0) for c in (0.5, 3.0)]  # fmt: skip
    best = min((least_squares(rest, x, bounds=(least, most), x_scale=1.0, max_nfev=60) for x in tries),
               key=lambda one: float(one.cost))  # fmt: skip
    r = best.fun.reshape(len(rises), -1)
    size = max(float(np.sqrt((r**2).mean())), 1.0)
    three = spreads(best.jac.reshape(len(rises), r.shape[1], 4) / size, r / size)
    first = _SIGMA / float(np.ptp(measured, axis=1).min())  # of the readings that it all starts from
    values, sigma = np.exp(best.x), np.hypot(three.max(axis=0), first)
    figures, open_ones, kinds = [], [], widest(three)
    for k, (name, title, kind, unit) in enumerate(declared("heat")):
        bound = k >= 2 and (total < _LONG * values[3] or sigma[k] > _CERTAIN)
        if k < 2 and sigma[k] > _CERTAIN:
            open_ones.append(title)
            continue
        grows, value = float(np.exp(BAND * min(sigma[k], 5.0))), float(values[k])
        low, high = value / grows, np.inf if bound else value * grows
        open_ones += [title] if bound else []
        basis = BOUND if bound else kinds[k]
        figures.append(IdentifiedFigure(name, title, kind, unit, low if bound else value, low, high, basis))
    tied = (Inseparable(", ".join(open_ones), f"the log lasts {total:.3g} s", _NEEDS),) if open_ones else ()
    made = course(best.x)
    traces = tuple(Trace(name, "temperature", "degC", measured[k], made[k]) for k, name in enumerate(rises))
    return Heat(tuple(figures), tied, time[edges], traces)
