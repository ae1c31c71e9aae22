"""Winding and housing over a piece of constant mean square current and loss; arrays as in ``layout``.

The equations are those of ``heat_step``: rises x' = A x + b. Pieces are short, so the series of the exponential is
summed as a polynomial of A, which by Cayley and Hamilton is of first degree: phi_2(A t) = q_0 + q_1 A.
"""

from __future__ import annotations

import drivesizer.physics.one_pass.layout as at
from drivesizer.physics.one_pass.layout import Array

__all__: list[str] = []  # compiled into ``kernel``


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


def follow(d: Array, g: Array, square: float, loss: float, t: float) -> None:
    """The map of the block so far, less one, with a piece after it: on the winding, on the housing, and constant."""
    ww = d[at.FEEDBACK] * square + d[at.W_W]
    wh, hw, hh = d[at.W_H], d[at.H_W], d[at.H_H]
    trace, determinant = ww + hh, ww * hh - wh * hw
    q_0, q_1 = series(d, trace, determinant, reach(d, square, t), t)
    p_0, p_1 = (1.0 - q_1 * determinant * t) * t, (q_0 + q_1 * trace) * t * t
    for k in range(3):
        w, h = g[at.BLOCK + 2 * k] + (k == 0), g[at.BLOCK + 2 * k + 1] + (k == 1)
        slope_w, slope_h = ww * w + wh * h, hw * w + hh * h
        if k == 2:
            slope_w, slope_h = slope_w + d[at.HEAT_W] * square, slope_h + d[at.HEAT_H] * loss
        g[at.BLOCK + 2 * k] += p_0 * slope_w + p_1 * (ww * slope_w + wh * slope_h)
        g[at.BLOCK + 2 * k + 1] += p_0 * slope_h + p_1 * (hw * slope_w + hh * slope_h)


def put_before(g: Array) -> None:
    """The map of all later blocks with the block before them; the block's begins anew."""
    for k in range(3):
        w, h = g[at.BLOCK + 2 * k], g[at.BLOCK + 2 * k + 1]
        g[at.BLOCK + 2 * k] = w + (g[at.MAP] * w + g[at.MAP + 2] * h)
        g[at.BLOCK + 2 * k + 1] = h + (g[at.MAP + 1] * w + g[at.MAP + 3] * h)
    for k in range(6):
        g[at.MAP + k], g[at.BLOCK + k] = g[at.MAP + k] + g[at.BLOCK + k], 0.0
