"""The required motion of the load over one cycle: speed over time as straight lines."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drivesizer.errors import FieldError, InputError, quoted
from drivesizer.files.csv_columns import columns, path_from_spec
from drivesizer.loads.course import Profile, columns_of
from drivesizer.physics.figures import Alike, Figure
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.physics.motion_curves import fastest_ramp, local_parabola
from drivesizer.spec.motions import Cam, Csv, Harmonic, Move, SCurve, Segments, Trapezoid, Triangle
from drivesizer.spec.robot import RobotSpec

# -- Breakpoints of speed over time: straight lines from standstill, and what no profile may be made of.


Leg = tuple[
    str | tuple[str | int, ...], Any, Any
]  # field of the motion that gives its time; time [s]; speed at its end


def straight(name: str, legs: Sequence[Leg], there_and_back: bool = False) -> Profile:
    """Straight lines from standstill, and their mirror image; a leg without length leaves no breakpoint."""
    paths, durations, speeds = (list(column) for column in zip(*legs, strict=True))
    both = columns_of([*durations, *speeds])
    step, to = both[: len(legs)], both[len(legs) :]
    if there_and_back:
        paths, step, to = paths * 2, np.concatenate([step, step]), np.concatenate([to, -to])
    start = np.zeros_like(step[:1])
    time, speed = np.cumsum(np.concatenate([start, step]), axis=0), np.concatenate([start, to])
    rises, change = np.diff(time, axis=0) > 0.0, np.diff(speed, axis=0)
    with np.errstate(all="ignore"):
        slope = np.where(step > 0.0, change / step, 0.0)
        far = ~np.isfinite(time[1:] + slope + (speed[:-1] + to) * step)
    for number in np.flatnonzero((far | (~rises & (change != 0.0))).reshape(len(paths), -1).any(axis=1)):
        path, lasting, end = paths[number], np.max(step[number]), np.max(time[number + 1])
        wrong = f"is too short beside the {end:g} s before it"
        if far[number].any():
            wrong = "leads beyond the range of numbers to compute with"
        raise FieldError(("motion", *([path] if isinstance(path, str) else path)), f"{lasting:g} s {wrong}")
    kept = np.append(True, rises.reshape(len(paths), -1).any(axis=1))
    time, speed = time[kept], speed[kept]
    return Profile(name, *(tuple(c.tolist()) if c.ndim == 1 else tuple(c) for c in (time, speed)))


def checked(profile: Profile, field: str) -> Profile:
    """The profile, when its numbers can be computed with."""
    time, speed = columns_of(profile.time), columns_of(profile.speed)
    sloped = columns_of([*(profile.acceleration or ()), *itertools.chain.from_iterable(profile.ends or ())])
    if not all(np.isfinite(c).all() for c in (time, speed, sloped)) or not np.abs(speed).max(axis=0).all():
        raise FieldError(("motion", field), "leads beyond the range of numbers to compute with")
    step = np.diff(time, axis=0)
    if ((step <= 0.0) if step.ndim == 1 else (step < 0.0)).any():
        lasting = np.max(profile.duration)
        raise FieldError(("motion", field), f"a part of the motion is too short beside its {lasting:g} s")
    return profile


# -- Laws of motion from rest to rest over a distance in a time, as transfer functions of unit stroke and unit time.
#
# With x the share of the time, speed is :math:`v = f'(x) s / T` and acceleration :math:`a = f''(x) s / T^2`; their
# largest values are the coefficients :math:`C_v` and :math:`C_a` of VDI 2143 part 1, and :math:`C_{rms}` is that of
# the RMS acceleration, by which the RMS torque of a load that is inertia alone goes.
#
# | law | C_v | C_a | C_rms | f'(x) |
# |---|---|---|---|---|
# | triangle | 2 | 4 | 4 | straight lines; the least peak acceleration |
# | trapezoid | 1.5 | 4.5 | 3.674 | straight lines, a third each |
# | parabola | 1.5 | 6 | 3.464 | 6 x (1 - x); the least RMS acceleration |
# | sine | π/2 | π²/2 | 3.489 | π/2 sin πx |
# | poly5 | 1.875 | 5.7735 | 4.140 | 30 x² (1 - x)² |
# | cycloidal | 2 | 2π | 4.443 | 1 - cos 2πx |
# | modified_sine | 4π/(4 + π) | 4π²/(4 + π) | 3.909 | sines of x at the ends and of x/3 between |
# | modified_trapezoid | 2 | 8π/(2 + π) | 4.233 | constant acceleration between sines |
#
# Acceleration jumps at both ends of the first four; the others start and end without a jump.


_Point = tuple[float, float]  # f' and f'' at a share of the time


class Law(NamedTuple):
    """Transfer function of a law that is no straight line."""

    at: Callable[[float], _Point]  # f' and f'' at a share of the time
    peaks: tuple[float, ...] = ()  # shares at which it peaks, beside eighths of the time


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
    "parabola": Law(lambda x: (6.0 * x * (1.0 - x), 6.0 - 12.0 * x)),
    "sine": Law(lambda x: (math.pi / 2 * math.sin(math.pi * x), math.pi**2 / 2 * math.cos(math.pi * x))),
    "poly5": Law(
        lambda x: (30.0 * x**2 * (1.0 - x) ** 2, 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x)),
        ((3 - math.sqrt(3)) / 6, (3 + math.sqrt(3)) / 6),
    ),
    "cycloidal": Law(lambda x: (1.0 - math.cos(2 * math.pi * x), 2 * math.pi * math.sin(2 * math.pi * x))),
    "modified_sine": Law(_modified_sine),
    "modified_trapezoid": Law(_modified_trapezoid),
}


# -- Moves by a law of motion, and cam tables, as breakpoints of speed over time.
#
# A curved law is divided into 128 pieces. Speed and acceleration are exact at their ends and meet their peaks there;
# the straight lines of speed between make the distance of a parabola or a sine short by 6e-5 of it, of the others by
# 1e-8, and those of acceleration the RMS acceleration by 6e-4 at most.


_STROKE = 128  # pieces of a move
_STILL = 1e-9  # of a cam's largest speed: less is what rounding leaves of a dwell


def move(motion: Move) -> Profile:
    """A distance in a time by a law; speed and acceleration are exact at breakpoints and meet their peaks there.

    >>> move(Move(profile="move", distance="3 m", time="3 s")).speed
    (0.0, 1.5, 1.5, 0.0)
    """
    span, stroke = motion.time, motion.distance
    if motion.law not in LAWS:
        up, down = motion.ramps
        cruise = span - up - down
        level = np.where(cruise > _STILL * span, cruise, 0.0)  # of ramps that fill the time, not what rounding leaves
        top = stroke / (span - (up + down) / 2)
        legs = (("time", up, top), ("time", level, top), ("time", down, 0.0), ("rest_time", motion.rest_time, 0.0))
        return straight("move", legs, motion.there_and_back)
    law = LAWS[motion.law]
    shares = sorted({k / _STROKE for k in range(_STROKE + 1)} | set(law.peaks))
    points = [(x * span, *law.at(x)) for x in shares]
    time = [t for t, _, _ in points]
    speed = [v * stroke / span for _, v, _ in points]
    speed[0] = speed[-1] = 0.0  # not what rounding makes of it
    ends = [(a * stroke / span**2, b * stroke / span**2) for (_, _, a), (_, _, b) in itertools.pairwise(points)]
    if np.any(motion.rest_time):
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


# -- An axis that waits at rest, its motion done, until the cycle of its machine is over: the rest at the end of its
# own.
#
# A load with a motion is held as its law says of a rest; a recording, or a load that comes with its cycle, by the
# torque of the rest that ends it, or by what its last moment leaves without the torque that decelerates it, friction
# included.


_NO_TIME = 1e-9  # of the cycle


def static_torque(cycle: LoadCycle) -> Alike:
    """Torque that holds a load at the end of its motion [N*m]; NaN where an inertia that decelerates is unknown."""
    torque, acceleration = cycle.torque[-1, 1], cycle.acceleration[-1, 1]
    slowing = np.where(acceleration == 0.0, 0.0, cycle.inertia * acceleration)
    return float(torque - slowing) if cycle.duration.ndim == 1 else torque - slowing


def with_rest(cycle: LoadCycle, until: float | None, held: Figure) -> LoadCycle:
    """A load cycle with a rest at its end."""
    rest = rest_left(cycle.total, until)
    if not np.any(rest) or np.any(np.isnan(held)):
        return cycle
    still = np.zeros_like(cycle.speed[:1])
    return replace(
        cycle,
        duration=np.concatenate([cycle.duration, np.reshape(rest, cycle.duration[:1].shape)]),
        speed=np.concatenate([cycle.speed, still]),
        acceleration=np.concatenate([cycle.acceleration, np.zeros_like(cycle.acceleration[:1])]),
        torque=np.concatenate([cycle.torque, np.zeros_like(cycle.torque[:1]) + held]),
    )


def resting(profile: Profile, until: float | None) -> Profile:
    """A motion with a rest at its end, the payload still that of its last piece.

    >>> resting(Profile("x", (0.0, 1.0, 3.0), (0.0, 2.0, 0.0)), 5.0)
    Profile(name='x', time=(0.0, 1.0, 3.0, 5.0), speed=(0.0, 2.0, 0.0, 0.0), acceleration=None, payload=None, ends=None)
    """
    rest = rest_left(profile.duration, until)
    if until is None or not np.any(rest):
        return profile
    end = profile.time[0] + until
    ends, slope = profile.ends, profile.acceleration
    if ends is None and slope is not None:
        ends = tuple(pairwise(slope))
    return replace(
        profile,
        time=(*profile.time, np.maximum(end, profile.time[-1]) if np.ndim(rest) else end),
        speed=(*profile.speed, 0.0),
        acceleration=None,
        ends=None if ends is None else (*ends, (0.0, 0.0)),
        payload=None if profile.payload is None else (*profile.payload, profile.payload[-1]),
    )


def rest_left(total: Figure, until: float | None) -> Alike:
    """Time that an axis waits."""
    if until is None:
        return 0.0
    rest = np.where(until - total <= _NO_TIME * until, 0.0, until - total)
    return rest if rest.ndim else float(rest)


# -- Speed profiles: the required motion of the load over one cycle, as breakpoints with straight lines between.
#
# A profile comes from the spec's motion or from a recorded CSV file. Speeds may be negative (the machine reverses).
# Symbols: t time [s], v speed of the load [m/s, or rad/s where it turns], T_j time of a jerk phase [s].
#
# A ramp with rounded ends raises its acceleration in T_j, holds it, and takes it back in T_j. Its speed is a
# parabola where there is jerk j, and straight lines between points h apart stay within
#
# .. math:: |\Delta v| \le j h^2 / 8, \qquad h = T_j / 32,
#
# of it: 1/4096 of what the speed changes in that phase at first, j T_j^2 / 2. Its distance is exact all the same:
# what the straight lines add where the curve is hollow, they take away where it bulges.


SPEED = {"linear": ("speed", "m/s"), "rotary": ("rotary_speed", "rpm")}  # of a load along a line or about an axis
TRAVEL = {"linear": ("length", "mm"), "rotary": ("angle", "deg")}

_PIECES = 32  # of a jerk phase
_QUARTER = 64  # pieces of a quarter of a harmonic period: the speed is off by 7.5e-5 of its peak, 1 - cos(pi/256)
_Ramp = list[tuple[float, float, float]]


def trapezoid(motion: Trapezoid) -> Profile:
    """Accelerate, cruise, decelerate, rest; and the same back with ``there_and_back``.

    >>> trapezoid(Trapezoid(speed="1.5 m/s", acceleration_time="2 s", cruise_time="3 s", rest_time="1 s")).time
    (0.0, 2.0, 5.0, 7.0, 8.0)
    """
    up, cruise, down, top = motion.phases
    slowing = "acceleration_time" if motion.deceleration_time is None else "deceleration_time"
    names = ("acceleration_time", "cruise_time", slowing)
    if motion.distance is not None:
        names = ("acceleration", "distance", "acceleration")
    legs = (*zip(names, (up, cruise, down), (top, top, 0.0), strict=True), ("rest_time", motion.rest_time, 0.0))
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
        limits = motion.distance, motion.speed, motion.acceleration, motion.jerk
        ramp_of = np.vectorize(fastest_ramp, otypes=[float] * 3) if any(map(np.ndim, limits)) else fastest_ramp
        jerk_time, hold, cruise = ramp_of(*limits)
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
    up, cruise, down, top = motion.phases
    rising, falling = (_ramp(top, time / 2, 0.0) for time in (up, down))
    return _curve(rising, cruise, falling, motion, "speed")


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


def _curve(rising: _Ramp, cruise: float, down: _Ramp, motion: SCurve | Trapezoid, field: str) -> Profile:
    """A ramp, a cruise, a ramp seen from its end, a rest; the return if specified."""
    falling = down[::-1]
    start = rising[-1][0] + cruise
    meets = bool(np.all(start == rising[-1][0]))
    points = rising + [(start + (falling[0][0] - t), v, -a) for t, v, a in falling[meets:]]
    end = points[-1][0] + motion.rest_time
    if np.any(end > points[-1][0]):
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
    return first + last[bool(np.all(last[0][0] <= first[-1][0])) :]


_MADE: dict[str, Callable[[Any], Profile]] = {
    "trapezoid": trapezoid,
    "triangle": triangle,
    "move": move,
    "s_curve": s_curve,
    "harmonic": harmonic,
    "hold": lambda motion: straight("hold", [("time", motion.time, 0.0)]),
    "segments": segments,
}


def profile_of(spec: RobotSpec) -> Profile:
    """The spec's motion as a profile, with the rest in which it waits for other axes of its machine."""
    motion = spec.motion
    if motion is None:
        raise InputError(f"motion: a {spec.load.kind} load brings its own; there is no profile of it")
    with located(spec):
        if isinstance(motion, Csv | Cam):
            path = path_from_spec(spec.file, motion.file, spec.where(("motion", "file")))
            if isinstance(motion, Csv):
                made = from_csv(path, SPEED[spec.load.axis][0])
            else:
                made = cam(path, motion, "angle" if spec.load.axis == "rotary" else "length")
            made = replace(made, name=motion.file)
        else:
            made = _carrying(_MADE[motion.profile](motion), motion)
    return resting(made, spec.waits_until)


@contextmanager
def located(spec: RobotSpec) -> Iterator[None]:
    """Errors of a field with its file and line, raised within."""
    try:
        yield
    except FieldError as error:
        raise InputError(f"{spec.where(error.field)}: {error}") from None


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
    names = [kind.replace("_", "-") for kind in _MADE]
    own = (spec.motion.profile if spec.motion else spec.load.kind).replace("_", "-")
    if name_or_file.lower().endswith(".csv"):
        return from_csv(name_or_file, SPEED[spec.load.axis][0])
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
