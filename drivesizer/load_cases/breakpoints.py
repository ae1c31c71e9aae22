"""Breakpoints of speed over time: straight lines from standstill, and what no profile may be made of."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

from drivesizer.errors import FieldError
from drivesizer.loads.course import Profile

__all__ = ["Leg", "checked", "straight"]

_Field = str | tuple[str | int, ...]  # of the motion
Leg = tuple[_Field, float, float]  # field that gives its time; time [s]; speed at its end


def straight(name: str, legs: Sequence[Leg], there_and_back: bool = False) -> Profile:
    """Straight lines from standstill, and their mirror image; a leg without length leaves no breakpoint."""
    back = [(field, duration, -to) for field, duration, to in legs if there_and_back]
    time, speed = [0.0], [0.0]
    for field, duration, to in (*legs, *back):
        end, change = time[-1] + duration, to - speed[-1]
        slope = change / duration if duration else 0.0
        if not all(map(math.isfinite, (end, slope, (speed[-1] + to) * duration))):
            raise FieldError(
                _motion_breakpoints(field), f"{duration:g} s leads beyond the range of numbers to compute with"
            )
        if end > time[-1]:
            time.append(end)
            speed.append(to)
        elif change:
            raise FieldError(_motion_breakpoints(field), f"{duration:g} s is too short beside the {end:g} s before it")
    if not any(speed) and any(to for _, _, to in legs):
        raise FieldError(_motion_breakpoints(legs[0][0]), "the speed is too small a number to compute with")
    return Profile(name, tuple(time), tuple(speed))


def _motion_breakpoints(field: _Field) -> tuple[str | int, ...]:
    return ("motion", field) if isinstance(field, str) else ("motion", *field)


def checked(profile: Profile, field: str) -> Profile:
    """The profile, when its numbers can be computed with."""
    sloped = (*(profile.acceleration or ()), *itertools.chain.from_iterable(profile.ends or ()))
    figures = (*profile.time, *profile.speed, *sloped)
    if not all(map(math.isfinite, figures)) or not profile.top_speed > 0.0:
        raise FieldError(("motion", field), "leads beyond the range of numbers to compute with")
    if any(t1 <= t0 for t0, t1, _, _ in profile.pieces()):
        raise FieldError(("motion", field), f"a part of the motion is too short beside its {profile.duration:g} s")
    return profile
