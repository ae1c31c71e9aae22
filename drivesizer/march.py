"""The closed loop marched along a profile: sampled controller, limits, machine, and what is kept of it.

Every sample: the speed is measured, the voltage that answers the sample before is applied within the limits, the
controller asks for the next one. Where the reference is constant and nothing changes any more, the state is carried
to the next corner at once, which is exact.
Symbols: e error at the motor shaft [rad/s], u voltage [V], i current [A], w motor speed [rad/s].
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from drivesizer.control_design import Pid
from drivesizer.errors import InputError
from drivesizer.motion import Motion
from drivesizer.plant import DriveTrain
from drivesizer.profile import Profile
from drivesizer.results import Gains

__all__ = ["FOLLOWS", "Limits", "Peak", "Run", "march"]

FOLLOWS = 0.1  # of the top speed: a drive whose error grows beyond a tenth is not said to follow (our convention)
_MOST_STEPS = 10_000_000  # an hour without a steady moment at 2.5 kHz: a minute of computing
_MOST_ROWS = 20_000  # of the series that is kept
_STEADY = 1e-12  # change over a sample, as a share of the full scale, below which a state is at rest
_WHOLE = 1e-9  # a corner this near to a sample, in periods, is on it


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """What the loop is held to; infinite where there is no limit, or none is known."""

    supply: float  # V, beside which a change of voltage is large or small
    voltage: float  # V
    peak_current: float  # A
    continuous_current: float  # A, only watched


class Peak:
    """The largest magnitude of something, and when."""

    __slots__ = ("time", "value")

    def __init__(self) -> None:
        self.value, self.time = 0.0, 0.0

    def see(self, value: float, t: float) -> None:
        """Keep the value when it is the largest so far."""
        if value > self.value or -value > self.value:
            self.value, self.time = abs(value), t


class _Piece(NamedTuple):
    """A straight piece of the reference in samples: first, end, start [s], motor speed there, and its slope."""

    first: int
    end: int
    start: float
    speed: float
    slope: float


class Recorder:
    """Rows of the series: all of them while they are few, else evenly thinned, those after a corner always."""

    def __init__(self, corners: int) -> None:
        self.rows = array("d")
        self.kept = array("b")  # per row, whether thinning leaves it
        self.stride = 1
        self.near = _MOST_ROWS // (2 * corners)  # samples after a corner that are kept
        self.spare = _MOST_ROWS // 2  # how many rows may be kept for good

    def add(self, k: int, since_corner: int, row: tuple[float, ...]) -> None:
        """Take a row, or leave it out."""
        always = since_corner < self.near and self.spare > 0
        if not always and k % self.stride:
            return
        self.spare -= always
        self.rows.extend(row)
        self.kept.append(always)
        if len(self.kept) > _MOST_ROWS:
            self._thin(len(row))

    def _thin(self, width: int) -> None:
        """Leave out every second row that need not be kept."""
        rows, kept, odd = array("d"), array("b"), False
        for n, always in enumerate(self.kept):
            odd = odd if always else not odd
            if always or odd:
                rows.extend(self.rows[n * width : (n + 1) * width])
                kept.append(always)
        self.rows, self.kept, self.stride = rows, kept, self.stride * 2


class Run:
    """A march along a profile and everything that was watched on the way."""

    WIDTH = 6  # columns of a row: time, reference, motor speed, current, voltage, torque of the gearhead

    def __init__(self, train: DriveTrain, gains: Gains, limits: Limits, profile: Profile) -> None:
        per_speed = train.motor_per_speed
        self.limits, self.period = limits, gains.period
        self.origin = profile.time[0]
        self.pieces = _pieces(profile, gains.period, per_speed)
        self.duration = self.pieces[-1].end * gains.period
        self.motion = Motion(train, gains.period, speed=profile.speed[0] * per_speed)
        volts = train.resistance * self.motion.i + train.torque_constant * self.motion.w
        self.pending = volts if gains.ki else 0.0  # what the integral holds is what was asked for last
        self.pid = Pid(gains, self.pending)
        self.recorder = Recorder(len(self.pieces))
        self.demanded_voltage, self.demanded_current, self.error = Peak(), Peak(), Peak()
        self.error_square = 0.0  # (rad/s)^2 s
        self.saturated, self.current_limited = 0.0, 0.0  # s
        self.over, self.longest_over, self.longest_over_at = 0.0, 0.0, 0.0  # s above the continuous current
        self.sustained: Peak | None = None  # motor speed at the ends of constant pieces
        self.volts = 0.0
        volts, speed, current = limits.supply, limits.supply / train.torque_constant, limits.supply / train.resistance
        self._tolerance = tuple(_STEADY * full for full in (current, speed, volts, volts, volts))

    def sample(self, k: int, reference: float, since_corner: int, weight: float) -> None:
        """One control period: measure, apply, ask, march; with a weight above the period, a steady state is carried."""
        t, motion, limits = self.origin + k * self.period, self.motion, self.limits
        error = reference - motion.w
        wanted = self.pending
        u = self._limited(wanted, t, weight)
        self.volts = u
        self.pending = self.pid.demand(error, wanted - u)
        self.error.see(error, t)
        self.error_square += error * error * weight
        if abs(motion.i) > limits.continuous_current:
            self.over += weight
            if self.over > self.longest_over:
                self.longest_over, self.longest_over_at = self.over, t + weight
        else:
            self.over = 0.0
        self.recorder.add(k, since_corner, (t, reference, motion.w, motion.i, u, motion.gear_torque()))

    def _limited(self, wanted: float, t: float, weight: float) -> float:
        """The voltage that the limits leave of what is wanted: first the supply's, then the current's."""
        self.demanded_voltage.see(wanted, t)
        most = self.limits.voltage
        u = most if wanted > most else -most if wanted < -most else wanted
        if u != wanted:
            self.saturated += weight
        idle, per_volt = self.motion.ahead()
        current = idle + per_volt * u
        self.demanded_current.see(current, t + self.period)
        peak = self.limits.peak_current
        if -peak <= current <= peak:
            return u
        self.current_limited += weight
        u = ((peak if current > 0.0 else -peak) - idle) / per_volt
        return most if u > most else -most if u < -most else u

    def state(self) -> tuple[float, float, float, float, float]:
        """Everything that the next sample depends on, but for the reference."""
        return self.motion.i, self.motion.w, self.pending, self.pid.integral, self.pid.derivative

    def steady(self, before: tuple[float, ...]) -> bool:
        """Whether nothing changes any more."""
        return all(abs(a - b) <= tol for a, b, tol in zip(self.state(), before, self._tolerance, strict=True))

    def finish(self) -> None:
        """The last row, at the end of the profile, and a look at whether all is finite."""
        last = self.pieces[-1]
        k, motion = last.end, self.motion
        reference = last.speed + last.slope * (k * self.period - last.start)
        row = (self.origin + k * self.period, reference, motion.w, motion.i, self.volts, motion.gear_torque())
        self.recorder.rows.extend(row)
        tally = motion.tally
        watched = (*row, *tally.square, *tally.charge, tally.energy_in, tally.energy_back, self.error_square, motion.x)
        if not all(math.isfinite(value) for value in watched):
            raise InputError(
                "the closed loop leaves the range of numbers that can be computed with; expected other gains"
            )


def _pieces(profile: Profile, period: float, per_speed: float) -> list[_Piece]:
    """The profile in samples; pieces between two samples leave none."""
    if not profile.duration / period < 2.0**53:
        raise InputError(f"profile {profile.name}: {profile.duration:g} s is too long to be sampled every {period:g} s")
    origin, found, ramps = profile.time[0], [], 0
    for t0, t1, v0, v1 in profile.pieces():
        first, end = (math.ceil((t - origin) / period - _WHOLE) for t in (t0, t1))
        if end > first:
            slope = (v1 - v0) / (t1 - t0) * per_speed
            found.append(_Piece(first, end, t0 - origin, v0 * per_speed, slope))
            ramps += end - first if v0 != v1 else 0
    if ramps > _MOST_STEPS:
        raise _too_long(profile)
    seen = max(
        (abs(p.speed + p.slope * (k * period - p.start)) for p in found for k in (p.first, p.end - 1)), default=0
    )
    if not seen >= (1.0 - FOLLOWS) * profile.top_speed * per_speed:
        raise InputError(
            f"profile {profile.name}: its top speed lies between two samples of the controller, {period:g} s apart; "
            "expected a slower change"
        )
    return found


def _too_long(profile: Profile) -> InputError:
    return InputError(
        f"profile {profile.name}: more than {_MOST_STEPS} control periods in which something changes; "
        "expected a shorter profile, or one that is constant for longer"
    )


def march(train: DriveTrain, gains: Gains, limits: Limits, profile: Profile) -> Run:
    """Drive a machine along a profile in closed loop.

    Parameters
    ----------
    train, gains, limits
        The machine, its controller, and what that is held to.
    profile
        The speed that the robot is asked for.

    Raises
    ------
    InputError
        When it would take too many steps, or the figures leave the range of floats.
    """
    run = Run(train, gains, limits, profile)
    for piece in run.pieces:
        for k, reference, weight in _samples(run, piece):
            carried = weight != run.period
            run.sample(k, reference, 0 if carried else k - piece.first, weight)
            if carried:
                run.motion.hold(run.volts, run.origin + k * run.period, weight)
            else:
                run.motion.advance(run.volts, run.origin + k * run.period)
            if run.motion.steps > _MOST_STEPS:
                raise _too_long(profile)
        if piece.slope == 0.0 and piece.speed:  # rest is no speed to sustain
            run.sustained = run.sustained or Peak()
            run.sustained.see(run.motion.w, run.origin + piece.end * run.period)
    run.finish()
    return run


def _samples(run: Run, piece: _Piece) -> Iterator[tuple[int, float, float]]:
    """Sample number, reference and weight [s] along a piece; the rest of a steady one comes as one."""
    period = run.period
    if piece.slope:
        offset = piece.speed - piece.slope * piece.start
        for k in range(piece.first, piece.end):
            yield k, offset + piece.slope * (k * period), period
        return
    for k in range(piece.first, piece.end):
        before = run.state()
        yield k, piece.speed, period
        if run.steady(before):
            if piece.end > k + 1:
                yield k + 1, piece.speed, (piece.end - k - 1) * period
            return
