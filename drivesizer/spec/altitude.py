r"""Thin air: margins by which thermal ratings must exceed the demand above 1000 m.

Ratings hold up to 1000 m. Above, IEC 60034-1 takes 1 % of the permitted rise per 100 m, to 4000 m:

.. math:: k = 1 - \frac{h - 1000\,\mathrm{m}}{10\,000\,\mathrm{m}}, \qquad
          ΔT \le k \, ΔT_{max}, \quad I_{rms} \le \sqrt{k} \, I_N

Controllers lose 1 % of their continuous current per 100 m, I ≤ k I_N (ABB, ACS880-14 hardware manual, altitude
derating). No rating is changed: the margin m that a check requires becomes (1 + m) / k - 1, or with √k.

Printed: a SIMOTICS S-1FK2 motor has 0.95, 0.89 and 0.84 of its torque at 2000, 3000 and 4000 m in 40 °C (Siemens,
configuration manual A5E46927724B, derating factors); √k is 0.949, 0.894 and 0.837.
"""

from __future__ import annotations

import math
from typing import Any

from drivesizer.spec.sections import Environment

__all__ = ["altitude_words", "controller_needed", "motor_needed", "rise_left", "rise_needed"]

_RATED, _PER_ALL = 1000.0, 10_000.0  # m: up to which ratings hold, and over which all of a rise would be lost


def rise_left(surroundings: Environment) -> float:
    """Share of the permitted rise that is left at an altitude.

    >>> rise_left(Environment(altitude="2000 m")), rise_left(Environment(altitude="500 m"))
    (0.9, 1.0)
    """
    return 1.0 - max(0.0, surroundings.altitude - _RATED) / _PER_ALL


def rise_needed(spec: Any, margin: float | None = None) -> float:
    """Margin that a rise of temperature must leave in a spec's surroundings."""
    return _raised(spec.margins.temperature if margin is None else margin, rise_left(spec.environment))


def motor_needed(spec: Any, margin: float | None = None) -> float:
    """Margin that a motor's RMS current or torque must leave there."""
    return _raised(spec.margins.torque if margin is None else margin, math.sqrt(rise_left(spec.environment)))


def controller_needed(spec: Any, margin: float | None = None) -> float:
    """Margin that a controller's continuous current must leave there."""
    return _raised(spec.margins.torque if margin is None else margin, rise_left(spec.environment))


def _raised(margin: float, left: float) -> float:
    return margin if left == 1.0 else (1.0 + margin) / left - 1.0


def altitude_words(spec: Any) -> tuple[str, ...]:
    """The assumption behind these margins, as a sentence; nothing up to 1000 m."""
    left = rise_left(spec.environment)
    if left == 1.0 or spec.method != "physics":
        return ()
    lost, less = (100.0 * (1.0 - x) for x in (left, math.sqrt(left)))
    return (
        f"at {spec.environment.altitude:g} m the winding's rise must stay {lost:.3g} % below the permitted one and the "
        f"motor's RMS current {less:.3g} % below its nominal one (IEC 60034-1: 1 % of the rise per 100 m above "
        f"1000 m), the controller's {lost:.3g} % (1 % per 100 m); these are in the margins that the checks require",
    )
