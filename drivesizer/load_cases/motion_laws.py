r"""Laws of motion from rest to rest over a distance in a time, as transfer functions of unit stroke and unit time.

With x the share of the time, speed is :math:`v = f'(x) s / T` and acceleration :math:`a = f''(x) s / T^2`; their
largest values are the coefficients :math:`C_v` and :math:`C_a` of VDI 2143 part 1, and :math:`C_{rms}` is that of the
RMS acceleration, by which the RMS torque of a load that is inertia alone goes.

=================  ==============  ===================  =============  ===============================================
law                C_v             C_a                  C_rms          f'(x)
=================  ==============  ===================  =============  ===============================================
triangle           2               4                    4              straight lines; the least peak acceleration
trapezoid          1.5             4.5                  3.674          straight lines, a third each
parabola           1.5             6                    3.464          6 x (1 - x); the least RMS acceleration
sine               π/2             π²/2                 3.489          π/2 sin πx
poly5              1.875           5.7735               4.140          30 x² (1 - x)²
cycloidal          2               2π                   4.443          1 - cos 2πx
modified_sine      4π/(4 + π)      4π²/(4 + π)          3.909          sines of x at the ends and of x/3 between
modified_trapezoid 2               8π/(2 + π)           4.233          constant acceleration between sines
=================  ==============  ===================  =============  ===============================================

Acceleration jumps at both ends of the first four; the others start and end without a jump.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

__all__ = ["LAWS", "Law"]

_Point = tuple[float, float]  # f' and f'' at a share of the time


class Law(NamedTuple):
    """Transfer function of a law that is no straight line."""

    at: Callable[[float], _Point]  # f' and f'' at a share of the time
    peaks: tuple[float, ...] = ()  # shares at which it peaks, beside eighths of the time


def _parabola(x: float) -> _Point:
    return 6.0 * x * (1.0 - x), 6.0 - 12.0 * x


def _sine(x: float) -> _Point:
    return math.pi / 2 * math.sin(math.pi * x), math.pi**2 / 2 * math.cos(math.pi * x)


def _poly5(x: float) -> _Point:
    return 30.0 * x**2 * (1.0 - x) ** 2, 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x)


def _cycloidal(x: float) -> _Point:
    return 1.0 - math.cos(2 * math.pi * x), 2 * math.pi * math.sin(2 * math.pi * x)


def _modified_sine(x: float) -> _Point:
    turn, share = 4 * math.pi * x, math.pi / (4 + math.pi)
    if 0.125 < x < 0.875:
        turn = (math.pi + turn) / 3
        return share * (1.0 - 3.0 * math.cos(turn)), 4 * math.pi * share * math.sin(turn)
    return share * (1.0 - math.cos(turn)), 4 * math.pi * share * math.sin(turn)


def _modified_trapezoid(x: float) -> _Point:
    if x > 0.5:  # the way down mirrors the way up
        speed, acceleration = _modified_trapezoid(1.0 - x)
        return speed, -acceleration
    top, share = 8 * math.pi / (2 + math.pi), 2 / (2 + math.pi)
    if x < 0.125:
        return share * (1.0 - math.cos(4 * math.pi * x)), top * math.sin(4 * math.pi * x)
    if x <= 0.375:
        return share + top * (x - 0.125), top
    turn = 4 * math.pi * (x - 0.375)
    return share + top / 4 + share * math.sin(turn), top * math.cos(turn)


LAWS: dict[str, Law] = {
    "parabola": Law(_parabola),
    "sine": Law(_sine),
    "poly5": Law(_poly5, ((3 - math.sqrt(3)) / 6, (3 + math.sqrt(3)) / 6)),
    "cycloidal": Law(_cycloidal),
    "modified_sine": Law(_modified_sine),
    "modified_trapezoid": Law(_modified_trapezoid),
}
