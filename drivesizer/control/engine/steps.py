"""One period under a held voltage: exact steps of the machine, halved where its mode changes.

Arrays as in ``layout``. Symbols as in ``linear_modes``; f twist [rad], T torque of the driven shaft [N*m].
"""

from __future__ import annotations

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.layout import Array
from drivesizer.control.engine.modes import load_torque, matrix_of, mode_of
from drivesizer.control.engine.tallies import add_energy, add_square, keep_peak, record_gear_torque, square_of

__all__: list[str] = []  # compiled into ``kernel``


def update_matrix(p: Array, s: Array, M: Array, work: Array, stamp: Array, mode: int, level: int) -> None:
    """Interpolate a mode's matrix at the winding's temperature: a cubic through four nodes."""
    place = (s[at.T_W] - p[at.NODE_0]) / p[at.NODE_D]
    n = min(max(int(place) - 1, 0), int(p[at.NODES]) - 4)
    x = min(max(place - n, 0.0), 3.0)
    a, b = -(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0, x * (x - 2.0) * (x - 3.0) / 2.0
    c, d = -x * (x - 1.0) * (x - 3.0) / 2.0, x * (x - 1.0) * (x - 2.0) / 6.0
    for r in range(M.shape[3]):
        for m in range(M.shape[4]):
            work[mode, level, r, m] = (
                a * M[n, mode, level, r, m] + b * M[n + 1, mode, level, r, m]
                + c * M[n + 2, mode, level, r, m] + d * M[n + 3, mode, level, r, m]
            )  # fmt: skip
    stamp[mode, level] = s[at.T_W]


def step(p: Array, s: Array, M: Array, work: Array, stamp: Array, z: Array, code: int, level: int, u: float, l: float,
         dl: float, rows: int) -> None:  # fmt: skip
    """State after a step, in the second half of z: the current alone, or all rows."""
    side, load = code % 3 - 1, code // 3 % 3 - 1
    mode = matrix_of(p, code)
    if p[at.HEAT] != 0.0 and not abs(s[at.T_W] - stamp[mode, level]) <= at.FRESH:
        update_matrix(p, s, M, work, stamp, mode, level)
    m = work[mode, level]
    i, w, friction, resistance = s[at.I], s[at.W], -side * p[at.F_M], load_torque(p, load) + l
    if p[at.TWO] == 0.0:
        for r in range(rows):
            z[8 + r] = (
                m[r, 0] * i + m[r, 1] * w + m[r, 2] * u + m[r, 3] * friction + m[r, 4] * resistance + m[r, 5] * dl
            )
        return
    offset = (code // 9 - 1) * 0.5 * p[at.GAP]
    f, v = s[at.F] - offset, s[at.V]
    for r in range(rows + 2 if rows > 1 else 1):
        z[8 + r] = (
            m[r, 0] * i + m[r, 1] * w + m[r, 2] * f + m[r, 3] * v + m[r, 4] * u + m[r, 5] * friction
            + m[r, 6] * resistance + m[r, 7] * dl
        )  # fmt: skip
    z[10] += offset


def accept(p: Array, s: Array, g: Array, z: Array, code: int, u: float, t: float, dt: float) -> None:
    """Record a step that ends at a time, and move the state to its end."""
    two = p[at.TWO] != 0.0
    q, x = (z[12], z[13]) if two else (z[10], z[11])
    first, last = s[at.I], z[8]
    square = square_of(first, last, q, dt)
    add_square(p, s, g, square, dt)
    add_energy(p, g, u * q, q, square)
    keep_peak(g, at.G_I, last, t)
    keep_peak(g, at.G_W, z[9], t)
    most = first if (first > last) == (u > 0.0) else last
    power = u * most + p[at.LOSS] * abs(most) + p[at.R_B] * most * most
    if power > g[at.G_POWER]:
        keep_peak(g, at.G_POWER, power, t)
    if two:
        s[at.Y] += x / p[at.RATIO] - (z[10] - s[at.F])
        s[at.F], s[at.V] = z[10], z[11]
    else:
        s[at.Y] += x / p[at.RATIO]
        s[at.V] = z[9] / p[at.RATIO]
    s[at.I], s[at.W] = last, z[9]
    s[at.X] += x


def stop_at_reversal(p: Array, s: Array, w: float, v: float) -> None:
    """Pass a reversal through rest, where friction may hold."""
    if w * s[at.W] < 0.0:
        s[at.W] = 0.0
        if p[at.TWO] == 0.0:
            s[at.V] = 0.0
    if v * s[at.V] < 0.0:
        s[at.V] = 0.0


def advance(p: Array, s: Array, g: Array, M: Array, work: Array, stamp: Array, z: Array, u: float, l: float, dl: float,
            t: float) -> None:  # fmt: skip
    """Advance one period under a held voltage and a linear load torque."""
    top = work.shape[1] - 1
    left, level, unit = 1 << top, top, p[at.H] / (1 << top)
    code = int(s[at.CODE])
    while left > 0:
        while (1 << level) > left:
            level -= 1
        dt, end = unit * (1 << level), unit * ((1 << top) - left + (1 << level))
        step(p, s, M, work, stamp, z, code, level, u, l + dl * (end - dt), dl, 4)
        after = mode_of(p, z[8], z[9], z[10], z[11], l + dl * end)
        if after != code and level > 0:
            level -= 1
            continue
        before_w, before_v = s[at.W], s[at.V]
        accept(p, s, g, z, code, u, t + end, dt)
        record_gear_torque(p, s, g, code, l + dl * end, t + end, dt)
        if after != code:
            stop_at_reversal(p, s, before_w, before_v)
            code = mode_of(p, s[at.I], s[at.W], s[at.F], s[at.V], l + dl * end)
            record_gear_torque(p, s, g, code, l + dl * end, t + end, 0.0)
        left -= 1 << level
        s[at.STEPS] += 1.0
        level = min(level + 1, top)
    s[at.CODE] = code
