r"""Winding and housing over a piece of constant mean square current and loss at the housing.

.. math::

    C_w \dot w &= (R + R' w) I^2 - (w - h) / R_{th1} \\
    C_h \dot h &= P_h + (w - h) / R_{th1} - h / R_{th2}

with w and h rises of winding and housing over ambient: x' = A x + b. What a piece of duration t adds is
:math:`t\,\varphi_1(A t)(A x + b)`, its mean over the piece is off the start by :math:`t\,\varphi_2(A t)(A x + b)`,
and a function of a 2 x 2 matrix is :math:`f_0 + f_1 A`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

BRIEF, BRIEFER = 0.06, 4e-3  # exponents up to which eight and six terms of a series do
SMALL = 0.5  # and up to which fourteen do
COOLER = -1e-3  # K: what losses heat is no cooler but by rounding; a stretch in which it grows beyond all figures
LARGEST = 700.0  # whose function is a number


class Bodies(NamedTuple):
    """The constants of the equations."""

    feedback: float  # 1/(A^2 s), by which copper that warms up heats more
    ww: float  # 1/s, without current
    wh: float
    hw: float
    hh: float
    by_square: float  # K/(A^2 s)
    by_loss: float  # K/J


class Law(NamedTuple):
    """The equations over a piece: matrix, row by row, and constant."""

    ww: float
    wh: float
    hw: float
    hh: float
    w: float
    h: float


class Spread(NamedTuple):
    """phi_1 = p_0 + p_1 A and phi_2 = q_0 + q_1 A over a piece."""

    p_0: float
    p_1: float
    q_0: float
    q_1: float


class Change(NamedTuple):
    """Additions of a stretch of the cycle to both rises: linear in them."""

    ww: float
    wh: float
    hw: float
    hh: float
    w: float
    h: float


def mean_square(a: float, b: float) -> float:
    """Mean of the square of a line."""
    return (a * a + a * b + b * b) * (1.0 / 3.0)


def bodies_of(R: float, R_rise: float, R_th1: float, R_th2: float, C_w: float, C_h: float) -> Bodies:
    """Winding and housing; resistance at ambient temperature [ohm] and its rise [ohm/K]."""
    return Bodies(
        R_rise / C_w, -1.0 / (R_th1 * C_w), 1.0 / (R_th1 * C_w), 1.0 / (R_th1 * C_h),
        -(1.0 / R_th1 + 1.0 / R_th2) / C_h, R / C_w, 1.0 / C_h,
    )  # fmt: skip


def law_of(b: Bodies, square: float, loss: float) -> Law:
    """The equations at a mean square current [A^2] and a loss at the housing [W]."""
    return Law(b.feedback * square + b.ww, b.wh, b.hw, b.hh, b.by_square * square, b.by_loss * loss)


def phi_2(x: float) -> float:
    """(e^x - 1 - x) / x^2."""
    if abs(x) > SMALL:
        return (math.expm1(min(x, LARGEST)) - x) / (x * x)
    series = 1.0 / 2.0
    term = series
    for k in range(3, 16):
        term *= x / k
        series += term
    return series


def spread(law: Law, t: float) -> Spread:
    """Both functions of the matrix times a duration [s]."""
    trace, determinant = law.ww + law.hh, law.ww * law.hh - law.wh * law.hw
    size = (abs(law.ww) + law.wh + law.hw + abs(law.hh)) * t
    if size <= BRIEF:
        T, D = trace * t, determinant * t * t
        a, b = 1.0 / 720.0, 1.0 / 5040.0
        if size > BRIEFER:
            a, b = 1.0 / 40320.0, 1.0 / 362880.0
            a, b = 1.0 / 5040.0 - b * D, a + b * T
            a, b = 1.0 / 720.0 - b * D, a + b * T
        a, b = 1.0 / 120.0 - b * D, a + b * T
        a, b = 1.0 / 24.0 - b * D, a + b * T
        a, b = 1.0 / 6.0 - b * D, a + b * T
        q_0, q_1 = 1.0 / 2.0 - b * D, (a + b * T) * t
        return Spread(1.0 - q_1 * determinant * t, (q_0 + q_1 * trace) * t, q_0, q_1)
    slow, fast = exponents(law)
    q_slow, q_fast = phi_2(slow * t), phi_2(fast * t)
    p_slow, p_fast = 1.0 + slow * t * q_slow, 1.0 + fast * t * q_fast
    p_1, q_1 = (p_slow - p_fast) / (slow - fast), (q_slow - q_fast) / (slow - fast)
    return Spread(p_slow - p_1 * slow, p_1, q_slow - q_1 * slow, q_1)


def exponents(law: Law) -> tuple[float, float]:
    """The slow and the fast eigenvalue [1/s]; they are real, for heat goes to the cooler body."""
    half = math.sqrt((law.ww - law.hh) * (law.ww - law.hh) / 4.0 + law.wh * law.hw)
    middle = (law.ww + law.hh) / 2.0
    if middle > 0.0:
        return middle + half, middle - half
    fast = middle - half
    return (law.ww * law.hh - law.wh * law.hw) / fast, fast


def slopes(law: Law, w: float, h: float) -> tuple[float, float]:
    """Slopes of both rises [K/s]."""
    return law.ww * w + law.wh * h + law.w, law.hw * w + law.hh * h + law.h


def added(law: Law, s: Spread, t: float, w: float, h: float) -> tuple[float, float, float]:
    """Additions of a piece to both rises, and by how much the winding's mean over it is above its start [K]."""
    slope_w, slope_h = slopes(law, w, h)
    pull_w, pull_h = law.ww * slope_w + law.wh * slope_h, law.hw * slope_w + law.hh * slope_h
    mean = t * (s.q_0 * slope_w + s.q_1 * pull_w)
    return t * (s.p_0 * slope_w + s.p_1 * pull_w), t * (s.p_0 * slope_h + s.p_1 * pull_h), mean


def top_within(law: Law, t: float, w: float, h: float) -> tuple[float, float]:
    """Highest rise from where a winding turns within a piece at whose start it rises [K], and after which time [s].

    At the end where it does not. The slope is a sum of two exponentials, so that it is zero once.
    """
    slow, fast = exponents(law)
    slope_w, slope_h = slopes(law, w, h)
    pull = law.ww * slope_w + law.wh * slope_h
    lasting = pull - fast * slope_w  # below 0: it falls in the end
    when = math.log1p((fast - slow) * slope_w / lasting) / (slow - fast) if lasting < 0.0 else t
    when = min(when, t)
    return w + added(law, spread(law, when), when, w, h)[0], when


def change_of(law: Law, s: Spread, t: float) -> Change:
    """Additions of a piece to both rises."""
    w, h = t * (s.p_0 + s.p_1 * law.ww), t * (s.p_0 + s.p_1 * law.hh)
    from_h, from_w = t * s.p_1 * law.wh, t * s.p_1 * law.hw
    return Change(
        w * law.ww + from_h * law.hw, w * law.wh + from_h * law.hh,
        from_w * law.ww + h * law.hw, from_w * law.wh + h * law.hh,
        w * law.w + from_h * law.h, from_w * law.w + h * law.h,
    )  # fmt: skip


def in_sequence(first: Change, then: Change) -> Change:
    """Additions of one stretch and another after it."""
    return Change(
        first.ww + then.ww + (then.ww * first.ww + then.wh * first.hw),
        first.wh + then.wh + (then.ww * first.wh + then.wh * first.hh),
        first.hw + then.hw + (then.hw * first.ww + then.hh * first.hw),
        first.hh + then.hh + (then.hw * first.wh + then.hh * first.hh),
        first.w + then.w + (then.ww * first.w + then.wh * first.h),
        first.h + then.h + (then.hw * first.w + then.hh * first.h),
    )


def left_over(c: Change) -> float:
    """Largest share of a rise that is left after a stretch."""
    return max(abs(1.0 + c.ww), abs(c.wh), abs(c.hw), abs(1.0 + c.hh))


def periodic(c: Change) -> tuple[float, float]:
    """Rises that a cycle ends with as it began; infinite where there are none."""
    determinant = c.ww * c.hh - c.wh * c.hw
    if not (determinant > 0.0 and c.ww < 0.0 and math.isfinite(determinant + c.h)):
        return math.inf, math.inf
    w, h = (c.wh * c.h - c.hh * c.w) / determinant, (c.hw * c.w - c.ww * c.h) / determinant
    return (w, h) if min(w, h) > COOLER else (math.inf, math.inf)
