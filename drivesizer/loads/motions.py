"""Motions of a load over one cycle: what a spec says of each kind, and the speed over time that it makes.

Linear or rotary as the load is; speeds may be negative, the machine then reverses. Symbols: t time [s], v speed of the
load [m/s, or rad/s where it turns], T_j time of a jerk phase [s].
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import BeforeValidator, Field

from drivesizer.errors import FieldError, InputError
from drivesizer.files import fields
from drivesizer.files.sheets import columns
from drivesizer.loads.course import Profile, columns_of
from drivesizer.physics.figures import Alike
from drivesizer.physics.motion_curves import fastest_ramp, periodic_parabola

SPEED = {"linear": ("speed", "m/s"), "rotary": ("rotary_speed", "rpm")}  # of a load along a line or about an axis
TRAVEL = {"linear": ("length", "mm"), "rotary": ("angle", "deg")}

_ROUNDING = 1e-9  # of a time: ramps that fill it may be rounded
_STILL = 1e-9  # of a cam's largest speed: less is what rounding leaves of a dwell
_STROKE = 128  # pieces of a move
_PIECES = 32  # of a jerk phase
_QUARTER = 64  # pieces of a quarter of a harmonic period: the speed is off by 7.5e-5 of its peak, 1 - cos(pi/256)


# -- Breakpoints of speed over time: straight lines from standstill, and what no profile may be made of.


# field of the motion that gives its time; time [s]; speed at its end
Leg = tuple[str | tuple[str | int, ...], Any, Any]


def _straight(name: str, legs: Sequence[Leg], there_and_back: bool = False) -> Profile:
    """Straight lines from standstill, and their mirror image; a leg without length leaves no breakpoint."""
    paths, durations, speeds = (list(column) for column in zip(*legs, strict=True))
    rows = columns_of([*durations, *speeds])
    step, to = rows[: len(legs)], rows[len(legs) :]
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
    breakpoints = np.append(True, rises.reshape(len(paths), -1).any(axis=1))
    time, speed = time[breakpoints], speed[breakpoints]
    return Profile(name, *(tuple(c.tolist()) if c.ndim == 1 else tuple(c) for c in (time, speed)))


def _checked(profile: Profile, field: str) -> Profile:
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


class _Repeated(fields.Section):
    rest_time: fields.Pause = fields.default("0 s", "standing still at the end of the cycle")
    there_and_back: bool = fields.default(False, "the same motion back, each with its rest")
    payload: fields.Counterweight = fields.default("0 kg", "added to the load's mass, on the way out and in its rest")
    payload_back: fields.Counterweight | None = fields.optional("on the way back; payload where not given")

    def _contradictions(self) -> Iterator[str]:
        if self.payload_back is not None and not self.there_and_back:
            yield "give there_and_back: true beside payload_back"

    @property
    def carries(self) -> bool:
        """Whether a payload is added to the load's mass."""
        return bool(np.any(self.payload)) or (self.payload_back is not None and bool(np.any(self.payload_back)))


class Trapezoid(_Repeated):
    """Accelerate, cruise, decelerate, rest; repeated. Ramps by time or acceleration, the rest by time or distance."""

    profile: Literal["trapezoid"] = "trapezoid"
    speed: fields.Velocity = fields.required("cruising speed; with distance at most, as far as that lets it be reached")
    acceleration_time: fields.Duration | None = fields.optional(
        "from standstill to speed; also the time of deceleration, where that is not given"
    )
    deceleration_time: fields.Duration | None = fields.optional("beside acceleration_time")
    cruise_time: fields.Pause | None = None
    distance: fields.Distance | None = fields.optional("of the whole move, in place of cruise_time")
    acceleration: fields.Acceleration | None = fields.optional("and deceleration, in place of acceleration_time")

    def _contradictions(self) -> Iterator[str]:
        yield from super()._contradictions()
        for name, other in (("acceleration_time", "acceleration"), ("cruise_time", "distance")):
            if (getattr(self, name) is None) == (getattr(self, other) is None):
                yield f"give {name} or {other}{'' if getattr(self, name) is None else ', not both'}"
        if self.deceleration_time is not None and self.acceleration_time is None:
            yield "give acceleration_time beside deceleration_time"

    @property
    def phases(self) -> tuple[Alike, Alike, Alike, Alike]:
        """Times of acceleration, cruise and deceleration [s], and the speed that is reached [m/s or rad/s]."""
        up = self.acceleration_time
        if up is None:
            assert self.acceleration is not None  # one of the two
            up = self.speed / self.acceleration
        down = up if self.deceleration_time is None else self.deceleration_time
        if self.distance is None:
            assert self.cruise_time is not None  # one of the two
            return up, self.cruise_time, down, self.speed
        ramps = self.speed * (up + down) / 2  # distance in which the speed is reached, and left again
        share = np.minimum(1.0, np.sqrt(self.distance / ramps))  # of the speed, as far as the distance lets it
        return share * up, np.maximum(self.distance - ramps, 0.0) / self.speed, share * down, share * self.speed


def trapezoid(motion: Trapezoid) -> Profile:
    """Accelerate, cruise, decelerate, rest; and the same back with ``there_and_back``.

    >>> trapezoid(Trapezoid(speed="1.5 m/s", acceleration_time="2 s", cruise_time="3 s", rest_time="1 s")).time
    (0.0, 2.0, 5.0, 7.0, 8.0)
    """
    up, cruise, down, top = motion.phases
    ramp = "acceleration" if motion.acceleration_time is None else "acceleration_time"
    names = (ramp, "cruise_time" if motion.distance is None else "distance",
             ramp if motion.deceleration_time is None else "deceleration_time")  # fmt: skip
    legs = (*zip(names, (up, cruise, down), (top, top, 0.0), strict=True), ("rest_time", motion.rest_time, 0.0))
    return _straight("trapezoid", legs, motion.there_and_back)


class Segment(fields.Section):
    """A straight piece: to another speed, or at the same."""

    time: fields.Duration
    to: fields.SignedVelocity | None = fields.optional("speed at its end; the present one where not given")
    payload: fields.Counterweight | None = fields.optional(
        "added to the load's mass; that of the piece before where not given"
    )


class Segments(fields.Section):
    """Straight pieces one after the other, from standstill to standstill; those at speed 0 are dwells."""

    profile: Literal["segments"]
    segments: Annotated[list[Segment], Field(min_length=1, max_length=10_000)]

    def _contradictions(self) -> Iterator[str]:
        speeds = [s.to for s in self.segments if s.to is not None]
        if speeds and speeds[-1] != 0.0:
            yield "expected the last speed to be 0: a cycle starts and ends at standstill"

    @property
    def carries(self) -> bool:
        """Whether a payload is added to the load's mass."""
        return any(piece.payload is not None and np.any(piece.payload) for piece in self.segments)


def segments(motion: Segments) -> Profile:
    """Straight pieces as they are listed."""
    legs: list[Leg] = []
    for number, segment in enumerate(motion.segments):
        speed = segment.to if segment.to is not None else legs[-1][2] if legs else 0.0
        legs.append((("segments", number, "time"), segment.time, speed))
    return _straight("segments", legs)


# -- Ramps with rounded ends.
#
# Such a ramp raises its acceleration in T_j, holds it, and takes it back in T_j. Its speed is a parabola where there is
# jerk j, and straight lines between points h apart stay within
#
# .. math:: |\Delta v| \le j h^2 / 8, \qquad h = T_j / 32,
#
# of it: 1/4096 of what the speed changes in that phase at first, j T_j^2 / 2. Its distance is exact all the same:
# what the straight lines add where the curve is hollow, they take away where it bulges.


_Ramp = list[tuple[float, float, float]]


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
    return _checked(Profile("s-curve", *zip(*points, strict=True)), field)


def _ramp(speed: float, jerk_time: float, hold: float) -> _Ramp:
    """From standstill to a speed: time, speed and acceleration at the breakpoints of a rounded ramp."""
    top = speed / (jerk_time + hold)
    end = 2 * jerk_time + hold
    rise = [(jerk_time * k / _PIECES, top * k / _PIECES) for k in range(_PIECES + 1)]
    first = [(t, a * t / 2, a) for t, a in rise]
    last = [(end - t, speed - a * t / 2, a) for t, a in reversed(rise)]
    return first + last[bool(np.all(last[0][0] <= first[-1][0])) :]


class SCurve(_Repeated):
    """From rest to rest over a distance, as fast as limits of speed, acceleration and jerk allow."""

    profile: Literal["s_curve"]
    distance: fields.Distance
    speed: fields.Velocity = fields.required("limit")
    acceleration: fields.Acceleration = fields.required("limit, for deceleration too")
    jerk: fields.Jerk = fields.required("limit")


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


def rounded(motion: Trapezoid) -> Profile:
    """A trapezoid with rounded ramps: the same distance, times and top speed.

    Each ramp is all jerk, up and back: in the time T of a straight one the acceleration reaches 2 v / T at its middle,
    twice that of the straight one, with the jerk 4 v / T^2.
    """
    up, cruise, down, top = motion.phases
    rising, falling = (_ramp(top, time / 2, 0.0) for time in (up, down))
    return _curve(rising, cruise, falling, motion, "speed")


class Harmonic(fields.Section):
    """To and fro in a sine: position = -amplitude cos(2 pi t / period)."""

    profile: Literal["harmonic"]
    amplitude: fields.Distance = fields.required("half the travel from end to end")
    period: fields.Duration


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
    return _checked(Profile("harmonic", time, speed, slope), "period")


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
# Acceleration jumps at both ends of the first four; the others start and end without a jump. A curved law is divided
# into 128 pieces: speed and acceleration are exact at their ends and meet their peaks there; the straight lines of
# speed between make the distance of a parabola or a sine short by 6e-5 of it, of the others by 1e-8, and those of
# acceleration the RMS acceleration by 6e-4 at most.


_Point = tuple[Any, Any]  # f' and f'' at a share of the time


class Law(NamedTuple):
    """Transfer function of a law that is no straight line."""

    at: Callable[[Any], _Point]
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


class Move(_Repeated):
    """From rest to rest over a distance in a time, by a law of motion.

    Largest speed and acceleration are C_v distance / time and C_a distance / time²: triangle 2 and 4, the least
    acceleration; trapezoid, a third of the time each, 1.5 and 4.5; parabola 1.5 and 6, the least RMS torque of inertia;
    sine 1.57 and 4.93; poly5 1.875 and 5.77; cycloidal 2 and 6.28; modified_sine 1.76 and 5.53; modified_trapezoid 2
    and 4.89. The last four are without a jump of acceleration.
    """

    profile: Literal["move"]
    distance: fields.Distance
    time: fields.Duration = fields.required("of the whole move")
    law: Literal[
        "trapezoid", "triangle", "parabola", "sine", "poly5", "cycloidal", "modified_sine", "modified_trapezoid"
    ] = fields.default("trapezoid", "shape of the speed over time")
    acceleration_time: fields.Duration | None = fields.optional(
        "of law: trapezoid; a third of the time where not given"
    )
    deceleration_time: fields.Duration | None = fields.optional("acceleration_time where not given")

    def _contradictions(self) -> Iterator[str]:
        yield from super()._contradictions()
        if self.law != "trapezoid" and (self.acceleration_time or self.deceleration_time):
            yield "expected acceleration_time and deceleration_time with law: trapezoid only"
        if sum(self.ramps) > self.time * (1.0 + _ROUNDING):
            yield "expected acceleration_time and deceleration_time of no more than time together"

    @property
    def ramps(self) -> tuple[float, float]:
        """Times of acceleration and deceleration of straight lines [s]."""
        share = 2.0 if self.law == "triangle" else 3.0
        up = self.time / share if self.acceleration_time is None else self.acceleration_time
        return up, up if self.deceleration_time is None else self.deceleration_time


class Triangle(_Repeated):
    """Accelerate over half the distance, decelerate over the other half, rest."""

    law: ClassVar[str] = "triangle"
    profile: Literal["triangle"]
    distance: fields.Distance
    time: fields.Duration = fields.required("of the whole move")

    @property
    def ramps(self) -> tuple[float, float]:
        """Times of acceleration and deceleration [s]."""
        return self.time / 2.0, self.time / 2.0


def move(motion: Move | Triangle) -> Profile:
    """A distance in a time by a law; speed and acceleration are exact at breakpoints and meet their peaks there.

    >>> move(Triangle(profile="triangle", distance="3 m", time="2 s")).speed
    (0.0, 3.0, 0.0)
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
        return _straight(motion.profile, legs, motion.there_and_back)
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
    return _checked(Profile("move", tuple(time), tuple(speed), ends=tuple(ends)), "time")


class Cam(fields.Section):
    """A cam table: position over the angle of a master that turns evenly, one run of the table after the other."""

    profile: Literal["cam"]
    file: str = fields.required("CSV: columns angle and position, then a row of units", min_length=1)
    master_speed: fields.Turning = fields.required("at which the angle runs", example="60 rpm")
    smoothing: fields.Pause = fields.default(
        "0 s", "width of the window in which the position is smoothed", example="20 ms"
    )


def cam(path: str | Path, motion: Cam, kind: str = "length") -> Profile:
    """Speed of a cam table: the slope of a local parabola through its positions, times the speed of the master.

    Parameters
    ----------
    path
        The table: angle and position.
    motion
        Speed of the master, and smoothing.
    kind
        Of the position: ``length``, or ``angle`` of a load that turns.

    Returns
    -------
    Profile
        Speed of the load over one run of the table.
    """
    sheet = columns(Path(path), {"angle": "angle", "position": kind})
    time, position = (sheet["angle"] - sheet["angle"][0]) / motion.master_speed, sheet["position"]
    if len(time) < 4:
        raise InputError(f"{path}: rows: {len(time)} found; expected at least 4, to take a slope of")
    if motion.smoothing > time[-1]:
        raise FieldError(
            ("motion", "smoothing"),
            f"{motion.smoothing:g} s is longer than the table of {time[-1]:g} s; expected at most that, e.g. 2 ms",
        )
    slope = periodic_parabola(time, position, motion.smoothing)[1]
    speed = np.where(np.abs(slope) <= _STILL * np.abs(slope).max(), 0.0, slope)
    return _checked(Profile(str(path), tuple(time.tolist()), tuple(speed.tolist())), "master_speed")


class Hold(fields.Section):
    """Standing still under load; repeated, so that it lasts."""

    profile: Literal["hold"]
    time: fields.Duration = fields.required(
        "for which energy and, in closed loop, control are computed", example="10 s"
    )


class Csv(fields.Section):
    """A recorded speed: a CSV file with the columns time and speed."""

    profile: Literal["csv"]
    file: str = fields.required("CSV: columns time and speed, then a row of units", min_length=1)


def from_csv(path: str | Path, kind: str = "speed") -> Profile:
    """A recorded profile: a file with the columns time and speed, see :func:`drivesizer.files.sheets.columns`.

    Parameters
    ----------
    path
        The file.
    kind
        Of the speed: ``speed``, or ``rotary_speed`` of a load that turns.

    Returns
    -------
    Profile
        As it was recorded.
    """
    sheet = columns(Path(path), {"time": "time", "speed": kind})
    return Profile(str(path), tuple(sheet["time"].tolist()), tuple(sheet["speed"].tolist()))


class Track(fields.Section):
    """A trajectory of the platform from a file: each driven wheel's load cycle follows from it."""

    profile: Literal["trajectory"] = "trajectory"
    trajectory: str = fields.required(
        "CSV: columns t, x, y, heading; or waypoints without t; then a row of units", min_length=1
    )
    smoothing: fields.Pause = fields.default(
        "0 s", "distance of the knots of the spline through a noisy track", example="50 ms"
    )


class Waypoint(fields.Section):
    """A posture at which the platform stops, with or without a pause."""

    x: fields.Place = fields.required(example="2.5 m")
    y: fields.Place = fields.required(example="1 m")
    heading: fields.Bearing | None = fields.optional("along the path where not given", example="90 deg")
    pause: fields.Pause = fields.default("0 s")


class Waypoints(fields.Section):
    """A path of the platform from point to point, as fast as the platform's limits allow."""

    profile: Literal["waypoints"] = "waypoints"
    waypoints: Annotated[list[Waypoint], Field(min_length=2, max_length=10_000)]


PROFILES: dict[str, Callable[[Any], Profile]] = {
    "trapezoid": trapezoid,
    "triangle": move,
    "move": move,
    "s_curve": s_curve,
    "harmonic": harmonic,
    "hold": lambda motion: _straight("hold", [("time", motion.time, 0.0)]),
    "segments": segments,
}


def over_time(motion: Any) -> Profile:
    """The profile of a motion that is no file's, with the payload of each of its pieces."""
    return carrying(PROFILES[motion.profile](motion), motion)


def carrying(profile: Profile, motion: Any) -> Profile:
    """The profile with the payload of each of its pieces, where the motion has one.

    Parameters
    ----------
    profile
        The motion's profile.
    motion
        The motion, that may have a payload.

    Returns
    -------
    Profile
        The profile, with a payload on each of its pieces.
    """
    if not getattr(motion, "carries", False):
        return profile
    if isinstance(motion, Segments):
        carried: list[float] = []
        for piece in motion.segments:
            carried.append(piece.payload if piece.payload is not None else carried[-1] if carried else 0.0)
        return replace(profile, payload=tuple(carried))
    pieces = len(profile.time) - 1
    back = motion.payload if motion.payload_back is None else motion.payload_back
    out = pieces // 2 if motion.there_and_back else pieces
    return replace(profile, payload=(motion.payload,) * out + (back,) * (pieces - out))


def _named(motion: Any) -> Any:
    """Add the profile of a motion that names none: by its fields, else a trapezoid."""
    if not isinstance(motion, dict):
        return motion
    own = next((key for key in ("trajectory", "waypoints") if key in motion), "trapezoid")
    if {"distance", "time"} <= motion.keys():
        own = "move"
    return {"profile": own, **motion}


Motion = Annotated[
    Annotated[
        Trapezoid | Triangle | Move | SCurve | Harmonic | Hold | Segments | Csv | Cam | Track | Waypoints,
        Field(discriminator="profile"),
    ],
    BeforeValidator(_named),
]
