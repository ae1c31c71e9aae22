r"""Moves by a law of motion, and cam tables, as breakpoints of speed over time.

A curved law is divided into 128 pieces. Speed and acceleration are exact at their ends and meet their peaks there; the
straight lines of speed between make the distance of a parabola or a sine short by 6e-5 of it, of the others by 1e-8,
and those of acceleration the RMS acceleration by 6e-4 at most.
"""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np

from drivesizer.errors import FieldError, InputError
from drivesizer.files.csv_columns import columns
from drivesizer.load_cases.breakpoints import checked, straight
from drivesizer.load_cases.motion_laws import LAWS
from drivesizer.loads.course import Profile
from drivesizer.physics.motion_curves import local_parabola
from drivesizer.spec.motions import Cam, Move

__all__ = ["cam", "move"]

_STROKE = 128  # pieces of a move
_STILL = 1e-9  # of a cam's largest speed: less is what rounding leaves of a dwell


def move(motion: Move) -> Profile:
    """A distance in a time by a law; speed and acceleration are exact at breakpoints and meet their peaks there.

    >>> move(Move(profile="move", distance="3 m", time="3 s")).speed
    (0.0, 1.5, 1.5, 0.0)
    """
    span, (up, down) = motion.time, motion.ramps
    if motion.law in LAWS:
        return _curved_move(motion)
    cruise = span - up - down
    level = cruise if cruise > _STILL * span else 0.0  # of ramps that fill the time, not what rounding leaves
    top = motion.distance / (span - (up + down) / 2)
    legs = (("time", up, top), ("time", level, top), ("time", down, 0.0), ("rest_time", motion.rest_time, 0.0))
    return straight("move", legs, motion.there_and_back)


def _curved_move(motion: Move) -> Profile:
    """A move by a curved law, its rest, and the same back."""
    law, span, stroke = LAWS[motion.law], motion.time, motion.distance
    shares = sorted({k / _STROKE for k in range(_STROKE + 1)} | set(law.peaks))
    points = [(x * span, *law.at(x)) for x in shares]
    time = [t for t, _, _ in points]
    speed = [v * stroke / span for _, v, _ in points]
    speed[0] = speed[-1] = 0.0  # not what rounding makes of it
    ends = [(a * stroke / span**2, b * stroke / span**2) for (_, _, a), (_, _, b) in itertools.pairwise(points)]
    if motion.rest_time:
        time, speed, ends = [*time, span + motion.rest_time], [*speed, 0.0], [*ends, (0.0, 0.0)]
    if motion.there_and_back:
        time += [time[-1] + t for t in time[1:]]
        speed += [-v for v in speed[1:]]
        ends += [(-a, -b) for a, b in ends]
    return checked(Profile("move", tuple(time), tuple(speed), ends=tuple(ends)), "time")


def cam(path: str | Path, motion: Cam, kind: str = "length") -> Profile:
    """Speed of a cam table: the slope of a local parabola through its positions, times the speed of the master."""
    found = columns(Path(path), {"angle": "angle", "position": kind})
    time, position = (found["angle"] - found["angle"][0]) / motion.master_speed, found["position"]
    if len(time) < 4:
        raise InputError(f"{path}: rows: {len(time)} found; expected at least 4, to take a slope of")
    if motion.smoothing > time[-1]:
        raise FieldError(
            ("motion", "smoothing"),
            f"{motion.smoothing:g} s is longer than the table of {time[-1]:g} s; expected at most that, e.g. 2 ms",
        )
    around = [np.append(c[:-1] - c[-1] + c[0], np.append(c, c[1:] + c[-1] - c[0])) for c in (time, position)]
    slope = local_parabola(around[0], around[1], motion.smoothing)[1][len(time) - 1 : 2 * len(time) - 1]
    speed = np.where(np.abs(slope) <= _STILL * np.abs(slope).max(), 0.0, slope)
    return checked(Profile(str(path), tuple(time.tolist()), tuple(speed.tolist())), "master_speed")
