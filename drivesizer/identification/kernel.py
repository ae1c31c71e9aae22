"""Response of a drive train to a logged voltage, by the step of the closed loop's engine."""

from __future__ import annotations

import sys

import drivesizer.control.engine.kernel as engine
import drivesizer.control.engine.layout as at
from drivesizer.control.engine.kernel import advance, mode_of
from drivesizer.control.engine.layout import Array
from drivesizer.files.machine_code import Kernel, defined_in
from drivesizer.kernel import heat as law_of_heat


def respond(
    p: Array, s: Array, g: Array, M: Array, work: Array, stamp: Array, z: Array, u: Array, l: Array, start: Array,
    out: Array,
) -> int:  # fmt: skip
    """Current, speed and angle at each sample under voltages held over the two parts of a period.

    Parameters, matrices and voltages are of the part before a late voltage changes and of that behind; ``start``: a
    speed to start anew from.
    """
    for k in range(u.shape[0]):
        t, slope = k * (p[0, at.H] + p[1, at.H]), (l[k + 1] - l[k]) / (p[0, at.H] + p[1, at.H])
        if start[k] == start[k]:
            s[at.W] = start[k]
            s[at.V] = start[k] / p[0, at.RATIO]
            s[at.I] = (u[k, 0] - p[0, at.K_E] * start[k]) / p[0, at.R25]
            s[at.CODE] = mode_of(p[0], s[at.I], s[at.W], 0.0, s[at.V], l[k])
        out[k, 0], out[k, 1], out[k, 2] = s[at.I], s[at.W], s[at.X]
        load = l[k]
        for n in range(2):
            advance(p[n], s, g, M[n], work[n], stamp[n], z, u[k, n], load, slope, t)
            load, t = load + slope * p[n, at.H], t + p[n, at.H]
        if not abs(s[at.I] + s[at.W]) < at.VAST:
            return at.NOT_FINITE
    return at.GOOD


_THIS = sys.modules[__name__]
KERNEL = Kernel(
    functions=defined_in((law_of_heat, engine, _THIS)),
    modules=(at, law_of_heat, engine, _THIS),
    inline=True,
    slow="the fit to a log runs some hundred times slower",
    arguments="d2 d1 d1 d6 d5 d3 d1 d2 d1 d1 d2",
)
