"""Winding and housing over a piece of constant mean square current and loss; arrays as in ``layout``.

The equations are those of ``heat_step``: rises x' = A x + b. Pieces are short, so the series of the exponential is
summed as a polynomial of A, which by Cayley and Hamilton is of first degree: phi_2(A t) = q_0 + q_1 A.
What a piece adds to the rises is linear in them; of short pieces that is worked out of many before it is summed up.
"""

from __future__ import annotations

import drivesizer.physics.one_pass.layout as at
from drivesizer.physics.one_pass.layout import Array

__all__: list[str] = []  # compiled into ``kernel``

Factors = tuple[float, float, float, float, float, float, float, float]
Map = tuple[float, float, float, float, float, float]  # w and h by the winding's rise, by the housing's, and constant


def rates(d: Array, square: float) -> tuple[float, float, float, float]:
    """The matrix A of a piece, row by row [1/s]."""
    return d[at.FEEDBACK] * square + d[at.W_W], d[at.W_H], d[at.H_W], d[at.H_H]


def reach(d: Array, square: float, t: float) -> float:
    """Bound of the exponent over a piece [1]."""
    found: float = (abs(d[at.FEEDBACK] * square + d[at.W_W]) + d[at.W_H] + d[at.H_W] + abs(d[at.H_H])) * t
    return found


def series(d: Array, trace: float, determinant: float, size: float, t: float) -> tuple[float, float]:
    """q_0 [1] and q_1 [s] of phi_2 over a piece."""
    a, b = 0.5, 0.0
    q_0, q_1 = a, b
    for k in range(3, at.MOST):
        share = t * d[at.INVERSE + k]
        a, b = -b * determinant * share, (a + b * trace) * share
        q_0, q_1 = q_0 + a, q_1 + b
        if abs(a) * t + abs(b) * size < at.NEGLIGIBLE * t:
            break
    return q_0, q_1


def warmed(
    d: Array, square: float, loss: float, t: float, w: float, h: float
) -> tuple[float, float, float, float, float]:
    """Rises of winding and housing after a piece, mean of the winding over it [K], its slopes at both ends [K/s]."""
    ww = d[at.FEEDBACK] * square + d[at.W_W]
    wh, hw, hh = d[at.W_H], d[at.H_W], d[at.H_H]
    trace, determinant = ww + hh, ww * hh - wh * hw
    q_0, q_1 = series(d, trace, determinant, reach(d, square, t), t)
    p_0, p_1 = 1.0 - q_1 * determinant * t, (q_0 + q_1 * trace) * t
    heat = d[at.HEAT_W] * square
    slope_w, slope_h = ww * w + wh * h + heat, hw * w + hh * h + d[at.HEAT_H] * loss
    pull_w, pull_h = ww * slope_w + wh * slope_h, hw * slope_w + hh * slope_h
    mean = w + t * (q_0 * slope_w + q_1 * pull_w)
    after, housing = w + t * (p_0 * slope_w + p_1 * pull_w), h + t * (p_0 * slope_h + p_1 * pull_h)
    return after, housing, mean, slope_w, ww * after + wh * housing + heat


def top_within(
    d: Array, square: float, loss: float, t: float, w: float, h: float, first: float, last: float
) -> tuple[float, float]:
    """Highest rise of the winding within a piece at whose ends it rises and falls [K], and after which time [s]."""
    low, high, when, top = 0.0, t, t * first / (first - last), w
    for _ in range(40):  # the slope is zero once; its zero lies between these
        top, _, _, _, slope = warmed(d, square, loss, when, w, h)
        if slope > 0.0:
            low, first = when, slope
        else:
            high, last = when, slope
        if high - low <= 1e-9 * t or slope == 0.0:
            break
        chord = low + (high - low) * first / (first - last)
        inner = 0.01 * (high - low)  # so that both ends close in
        when = min(max(chord, low + inner), high - inner)
    return top, when


def moved(
    d: Array, m: tuple[float, float], more: tuple[float, float], ww: float, p_0: float, p_1: float
) -> tuple[float, float]:
    """Change over a piece of rises that a map gives; ``more``: slopes that come to theirs."""
    wh, hw, hh = d[at.W_H], d[at.H_W], d[at.H_H]
    slope_w, slope_h = ww * m[0] + wh * m[1] + more[0], hw * m[0] + hh * m[1] + more[1]
    pull_w, pull_h = ww * slope_w + wh * slope_h, hw * slope_w + hh * slope_h
    return p_0 * slope_w + p_1 * pull_w, p_0 * slope_h + p_1 * pull_h


def followed(d: Array, m: Map, square: float, loss: float, t: float) -> Map:
    """A map less one with a piece after it: what it does to the winding's rise, to the housing's, and adds to both."""
    ww = d[at.FEEDBACK] * square + d[at.W_W]
    trace, determinant = ww + d[at.H_H], ww * d[at.H_H] - d[at.W_H] * d[at.H_W]
    q_0, q_1 = series(d, trace, determinant, reach(d, square, t), t)
    p_0, p_1 = (1.0 - q_1 * determinant * t) * t, (q_0 + q_1 * trace) * t * t
    a, b = moved(d, (m[0] + 1.0, m[1]), (0.0, 0.0), ww, p_0, p_1)
    c, e = moved(d, (m[2], m[3] + 1.0), (0.0, 0.0), ww, p_0, p_1)
    more = d[at.HEAT_W] * square, d[at.HEAT_H] * loss
    x, y = moved(d, (m[4], m[5]), more, ww, p_0, p_1)
    return m[0] + a, m[1] + b, m[2] + c, m[3] + e, m[4] + x, m[5] + y


def short_series(c: Factors, T: float, D: float) -> tuple[float, float]:
    """q_0 and q_1 / t of a piece so short that a few terms do, by trace and determinant of A t."""
    q_0, q_1 = c[6], c[7]
    q_0, q_1 = c[5] - q_1 * D, q_0 + q_1 * T
    q_0, q_1 = c[4] - q_1 * D, q_0 + q_1 * T
    q_0, q_1 = c[3] - q_1 * D, q_0 + q_1 * T
    q_0, q_1 = c[2] - q_1 * D, q_0 + q_1 * T
    q_0, q_1 = c[1] - q_1 * D, q_0 + q_1 * T
    return c[0] - q_1 * D, q_0 + q_1 * T


def transition(
    c: Factors, rates: tuple[float, float, float, float], t: float, heat: float, loss: float
) -> tuple[float, float, float, float, float, float, float, float]:
    """phi_2 over a short piece, and what it adds to both rises: t (p_0 + p_1 A) (A x + b)."""
    ww, wh, hw, hh = rates
    trace, determinant = ww + hh, ww * hh - wh * hw
    q_0, q_1 = short_series(c, trace * t, determinant * (t * t))
    q_1 *= t
    p_0, p_1 = (1.0 - q_1 * determinant * t) * t, (q_0 + q_1 * trace) * t * t
    own_w, own_h, from_h, from_w = p_0 + p_1 * ww, p_0 + p_1 * hh, p_1 * wh, p_1 * hw
    return (
        q_0, q_1, own_w * ww + from_h * hw, own_w * wh + from_h * hh, own_w * heat + from_h * loss,
        from_w * ww + own_h * hw, from_w * wh + own_h * hh, from_w * heat + own_h * loss,
    )  # fmt: skip


def joined(m: Map, s: Array, k: int) -> Map:
    """A map less one with a short piece after it."""
    a, c, more_w = s[at.BY_W_W + k], s[at.BY_H_W + k], s[at.MORE_W + k]
    b, e, more_h = s[at.BY_W_H + k], s[at.BY_H_H + k], s[at.MORE_H + k]
    return (
        m[0] + (a + (a * m[0] + c * m[1])), m[1] + (b + (b * m[0] + e * m[1])),
        m[2] + (c + (a * m[2] + c * m[3])), m[3] + (e + (b * m[2] + e * m[3])),
        m[4] + (more_w + (a * m[4] + c * m[5])), m[5] + (more_h + (b * m[4] + e * m[5])),
    )  # fmt: skip


def put_before(g: Array, m: Map) -> None:
    """The map of all later blocks with that of the block before them."""
    a, b, c, e = g[at.MAP], g[at.MAP + 1], g[at.MAP + 2], g[at.MAP + 3]
    for k in range(3):
        w, h = m[2 * k], m[2 * k + 1]
        g[at.MAP + 2 * k] += w + (a * w + c * h)
        g[at.MAP + 2 * k + 1] += h + (b * w + e * h)
