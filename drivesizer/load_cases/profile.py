r"""Speed profiles: the required motion of the load over one cycle, as breakpoints with straight lines between.

A profile comes from the spec's motion or from a recorded CSV file. Speeds may be negative (the machine reverses).
Symbols: t time [s], v speed of the load [m/s, or rad/s where it turns], T_j time of a jerk phase [s].

A ramp with rounded ends raises its acceleration in T_j, holds it, and takes it back in T_j. Its speed is a parabola
where there is jerk j, and straight lines between points h apart stay within

.. math:: |\Delta v| \le j h^2 / 8, \qquad h = T_j / 32,

of it: 1/4096 of what the speed changes in that phase at first, j T_j^2 / 2. Its distance is exact all the same: what
the straight lines add where the curve is hollow, they take away where it bulges.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from drivesizer.errors import FieldError, InputError, quoted
from drivesizer.files.csv_columns import columns, path_from_spec
from drivesizer.load_cases.breakpoints import Leg, checked, straight
from drivesizer.load_cases.moves import cam, move
from drivesizer.load_cases.waiting import resting
from drivesizer.loads.course import Profile
from drivesizer.physics.motion_curves import fastest_ramp
from drivesizer.spec.motions import Cam, Csv, Harmonic, Hold, SCurve, Segments, Trapezoid, Triangle
from drivesizer.spec.robot import RobotSpec

__all__ = [
    "SPEED", "from_csv", "harmonic", "hold", "located", "profile", "profile_of",
    "s_curve", "segments", "trapezoid", "triangle",
]  # fmt: skip

SPEED = {"linear": ("speed", "m/s"), "rotary": ("rotary_speed", "rpm")}  # of a load along a line or about an axis

_PIECES = 32  # of a jerk phase
_QUARTER = 64  # pieces of a quarter of a harmonic period: the speed is off by 7.5e-5 of its peak, 1 - cos(pi/256)
_Ramp = list[tuple[float, float, float]]


def trapezoid(motion: Trapezoid) -> Profile:
    """Accelerate, cruise, decelerate, rest; and the same back with ``there_and_back``.

    >>> trapezoid(Trapezoid(speed="1.5 m/s", acceleration_time="2 s", cruise_time="3 s", rest_time="1 s")).time
    (0.0, 2.0, 5.0, 7.0, 8.0)
    """
    legs = (
        ("acceleration_time", motion.acceleration_time, motion.speed),
        ("cruise_time", motion.cruise_time, motion.speed),
        (*_deceleration(motion), 0.0),
        ("rest_time", motion.rest_time, 0.0),
    )
    return straight("trapezoid", legs, motion.there_and_back)


def triangle(motion: Triangle) -> Profile:
    """Half the time of speeding up, half of slowing down.

    >>> triangle(Triangle(profile="triangle", distance="3 m", time="2 s")).speed
    (0.0, 3.0, 0.0)
    """
    top, half = 2 * motion.distance / motion.time, motion.time / 2
    legs = (("time", half, top), ("time", half, 0.0), ("rest_time", motion.rest_time, 0.0))
    return straight("triangle", legs, motion.there_and_back)


def segments(motion: Segments) -> Profile:
    """Straight pieces as they are listed."""
    legs: list[Leg] = []
    for number, segment in enumerate(motion.segments):
        speed = segment.to if segment.to is not None else legs[-1][2] if legs else 0.0
        legs.append((("segments", number, "time"), segment.time, speed))
    return straight("segments", legs)


def s_curve(motion: SCurve) -> Profile:
    """The fastest motion from rest to rest within limits of speed, acceleration and jerk; and back, if specified.

    >>> limits = {"distance": "2 m", "speed": "1 m/s", "acceleration": "2 m/s^2", "jerk": "10 m/s^3"}
    >>> s_curve(SCurve(profile="s_curve", **limits)).duration
    2.7
    """
    try:
        jerk_time, hold, cruise = fastest_ramp(motion.distance, motion.speed, motion.acceleration, motion.jerk)
        speed = motion.distance / (2 * jerk_time + hold + cruise)  # from the times, so that the distance is exact
        ramp = _ramp(speed, jerk_time, hold)
    except ArithmeticError:
        raise InputError("motion.jerk: distance and limits lead beyond the range of numbers to compute with") from None
    return _curve(ramp, cruise, ramp, motion, "jerk")


def _rounded(motion: Trapezoid) -> Profile:
    """A trapezoid with rounded ramps: the same distance, times and top speed.

    Each ramp is all jerk, up and back: in the time T of a straight one the acceleration reaches 2 v / T at its middle,
    twice that of the straight one, with the jerk 4 v / T^2.
    """
    field, down = _deceleration(motion)
    ramps = [_ramp(motion.speed, time / 2, 0.0) for time in (motion.acceleration_time, down)]
    return _curve(ramps[0], motion.cruise_time, ramps[1], motion, field)


def harmonic(motion: Harmonic) -> Profile:
    """One period of a sine, from one end; speed and acceleration meet their peaks at breakpoints.

    The travel between the ends is short by 5e-5 of it (a chord lies below its arc); over the period it is 0.
    """
    omega, n = 2 * math.pi / motion.period, _QUARTER
    rising = [math.sin(math.pi / 2 * k / n) for k in range(n)]
    half = [*rising, 1.0, *rising[:0:-1]]  # mirrored, so that the load stands exactly where it turns round
    sine = [*half, *(-s for s in half)]
    time = tuple(motion.period * k / (4 * n) for k in range(4 * n + 1))
    speed = tuple(motion.amplitude * omega * sine[k % (4 * n)] for k in range(4 * n + 1))
    slope = tuple(motion.amplitude * omega * omega * sine[(k + n) % (4 * n)] for k in range(4 * n + 1))
    return checked(Profile("harmonic", time, speed, slope), "period")


def hold(motion: Hold) -> Profile:
    """At rest all the time.

    >>> hold(Hold(profile="hold", time="1 min"))
    Profile(name='hold', time=(0.0, 60.0), speed=(0.0, 0.0), acceleration=None, payload=None, ends=None)
    """
    return straight("hold", [("time", motion.time, 0.0)])


def _deceleration(motion: Trapezoid) -> tuple[str, float]:
    """The field that gives the time of deceleration, and the time [s]."""
    if motion.deceleration_time is None:
        return "acceleration_time", motion.acceleration_time
    return "deceleration_time", motion.deceleration_time


def _curve(rising: _Ramp, cruise: float, down: _Ramp, motion: SCurve | Trapezoid, field: str) -> Profile:
    """A ramp, a cruise, a ramp seen from its end, a rest; the return if specified."""
    falling = down[::-1]
    start = rising[-1][0] + cruise
    points = rising + [(start + (falling[0][0] - t), v, -a) for t, v, a in falling[start == rising[-1][0] :]]
    end = points[-1][0] + motion.rest_time
    if end > points[-1][0]:
        points.append((end, 0.0, 0.0))
    if motion.there_and_back:
        points += [(points[-1][0] + t, -v, -a) for t, v, a in points[1:]]
    return checked(Profile("s-curve", *zip(*points, strict=True)), field)


def _ramp(speed: float, jerk_time: float, hold: float) -> _Ramp:
    """From standstill to a speed: time, speed and acceleration at the breakpoints of a rounded ramp."""
    top = speed / (jerk_time + hold)
    end = 2 * jerk_time + hold
    rise = [(jerk_time * k / _PIECES, top * k / _PIECES) for k in range(_PIECES + 1)]
    first = [(t, a * t / 2, a) for t, a in rise]
    last = [(end - t, speed - a * t / 2, a) for t, a in reversed(rise)]
    return first + last[last[0][0] <= first[-1][0] :]


_MADE: dict[str, Callable[[Any], Profile]] = {
    "trapezoid": trapezoid,
    "triangle": triangle,
    "move": move,
    "s_curve": s_curve,
    "harmonic": harmonic,
    "hold": hold,
    "segments": segments,
}


def profile_of(spec: RobotSpec) -> Profile:
    """The spec's motion as a profile, with the rest in which it waits for other axes of its machine."""
    return resting(_own_motion(spec), spec.waits_until)


def _own_motion(spec: RobotSpec) -> Profile:
    """The motion as it is written."""
    motion = spec.motion
    if motion is None:
        raise InputError(f"motion: a {spec.load.kind} load brings its own; there is no profile of it")
    with located(spec):
        return _motion_profile(spec, motion)


@contextmanager
def located(spec: RobotSpec) -> Iterator[None]:
    """Errors of a field with its file and line, raised within."""
    try:
        yield
    except FieldError as error:
        raise InputError(f"{spec.where(error.field)}: {error}") from None


def _motion_profile(spec: RobotSpec, motion: Any) -> Profile:
    if isinstance(motion, Csv):
        path = path_from_spec(spec.file, motion.file, spec.where(("motion", "file")))
        return replace(from_csv(path, _kind(spec)), name=motion.file)
    if isinstance(motion, Cam):
        path = path_from_spec(spec.file, motion.file, spec.where(("motion", "file")))
        return replace(cam(path, motion, "angle" if spec.load.axis == "rotary" else "length"), name=motion.file)
    return _carrying(_MADE[motion.profile](motion), motion)


def _carrying(made: Profile, motion: Any) -> Profile:
    """The profile with the payload of each of its pieces, where the motion has one."""
    if not getattr(motion, "carries", False):
        return made
    if isinstance(motion, Segments):
        carried: list[float] = []
        for piece in motion.segments:
            carried.append(piece.payload if piece.payload is not None else carried[-1] if carried else 0.0)
        return replace(made, payload=tuple(carried))
    pieces = len(made.time) - 1
    back = motion.payload if motion.payload_back is None else motion.payload_back
    out = pieces // 2 if motion.there_and_back else pieces
    return replace(made, payload=(motion.payload,) * out + (back,) * (pieces - out))


def profile(spec: RobotSpec, name_or_file: str) -> Profile:
    """The profile that a name or a file stands for.

    Parameters
    ----------
    spec
        What is moved, and its motion.
    name_or_file
        The kind of the spec's motion, such as ``trapezoid``; ``s-curve`` also for a trapezoid, which then
        has rounded ramps; or a file that ends in ``.csv``.

    Returns
    -------
    Profile
        Speed of the load over one cycle.

    Raises
    ------
    InputError
        When it is none of them, or the file is wrong.
    """
    names, own = [_shown(kind) for kind in _MADE], _shown(spec.motion.profile if spec.motion else spec.load.kind)
    if name_or_file.lower().endswith(".csv"):
        return from_csv(name_or_file, _kind(spec))
    if name_or_file not in names:
        raise InputError(
            f"profile {quoted(name_or_file)} is not known; expected {', '.join(names)} or a file that ends in .csv"
        )
    if name_or_file == own:
        return profile_of(spec)
    if name_or_file == "s-curve" and isinstance(spec.motion, Trapezoid):
        with located(spec):
            return resting(_carrying(_rounded(spec.motion), spec.motion), spec.waits_until)
    raise InputError(f"profile {quoted(name_or_file)}: the spec's motion is {own}; expected that or a file (.csv)")


def from_csv(path: str | Path, kind: str = "speed") -> Profile:
    """A recorded profile: a file with the columns time and speed, see :func:`drivesizer.files.csv_columns.columns`."""
    found = columns(Path(path), {"time": "time", "speed": kind})
    return Profile(str(path), tuple(found["time"].tolist()), tuple(found["speed"].tolist()))


def _shown(kind: str) -> str:
    """The name of a kind of motion on the command line."""
    return kind.replace("_", "-")


def _kind(spec: RobotSpec) -> str:
    return "rotary_speed" if spec.load.axis == "rotary" else "speed"
