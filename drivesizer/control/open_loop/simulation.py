"""Open-loop simulation of a stepper along a motion, and the share of its pull-out torque that it needs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.open_loop import layout as at
from drivesizer.control.open_loop.kernel import compiled
from drivesizer.errors import InputError
from drivesizer.physics.stepper.starting import natural_frequency

__all__ = ["DAMPING_RATIO", "Motion", "Stepper", "Turned", "least_share", "simulate"]

Array = NDArray[np.float64]

# low: a single step of hybrid steppers is damped by 0.3 to 0.4 of the critical damping, of variable reluctance ones by
# 0.1 (A. Hughes, Electric Motors and Drives, chapter on stepping motors: step response)
DAMPING_RATIO = 0.1
_PER_SWING = 64  # steps of the integration in a period of the natural frequency
_PER_TURN = 16  # the same in an electrical turn at the highest speed
_RAMP = 256.0  # pulses in such a period, from which on they are a ramp
_FINE = math.pi / 32.0 + 1e-9  # of a microstep that may be a ramp, electrical [rad]
_MOST = 20_000_000  # steps of a simulation: some 5 s
_ROWS = 20_000
_WHOLE = 2.0 * math.pi
_DOWN, _LEAST = 0.85, 0.01  # shares of the torque that are tried: each of the last, and the smallest
_HALVINGS = 4  # between the last two: to 1 % of it


@dataclass(frozen=True, slots=True, kw_only=True)
class Stepper:
    """One stepper on its driver, its gears and its share of the load, SI."""

    teeth: float
    torque: Array  # N*m, pull-out torque at even steps of the speed from 0
    top_speed: float  # rad/s at the motor, that of the last of them
    microstep: float  # rad at the motor
    damping_ratio: float
    motor_inertia: float  # kg*m^2 at the motor's shaft
    load_inertia: float = 0.0  # kg*m^2 at the driven shaft
    ratio: float = 1.0
    efficiency: float = 1.0
    friction: float = 0.0  # N*m at the motor, of idle gears
    forward_torque: float = 0.0  # N*m at the driven shaft, resistance when the load moves forward
    backward_torque: float = 0.0
    rest_torque: float = 0.0  # N*m at the driven shaft, weight alone

    @property
    def inertia(self) -> float:
        """Inertia at the motor's shaft [kg*m^2]."""
        return self.motor_inertia + self.load_inertia / self.ratio**2

    @property
    def natural_frequency(self) -> float:
        """Frequency of small swings about a held position, by the pull-out torque at rest [Hz]."""
        return float(natural_frequency(self.teeth, self.torque[0], self.inertia))


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """Speed of the driven shaft over time, and its torque beyond inertia and direction: straight lines between."""

    time: Sequence[float]
    speed: Sequence[float]  # rad/s
    load_time: Sequence[float] = ()
    load_torque: Sequence[float] = ()  # N*m


@dataclass(frozen=True, slots=True, kw_only=True)
class Turned:
    """A simulated stepper."""

    figures: dict[str, float]  # by the names of ``layout.TALLY``
    series: dict[str, Array]  # by the names of ``layout.ROW``

    @property
    def lost(self) -> int:
        """Full steps that the rotor was behind or ahead of its pulses, at the most."""
        return 4 * math.floor(self.figures["lag"] / _WHOLE + 0.5)

    @property
    def lost_at_end(self) -> int:
        """Full steps lost at the end, negative ones too many."""
        return 4 * math.floor(self.figures["end_lag"] / _WHOLE + 0.5)


def simulate(
    stepper: Stepper,
    motion: Motion,
    *,
    share: float = 1.0,
    ends: float = math.inf,
    at_rest: bool = False,
    per_swing: int = _PER_SWING,
) -> Turned:
    """Simulate a stepper along a motion, from the balance with its load."""
    p = _parameters(stepper, share, ends, per_swing)
    pieces = _pieces(motion, stepper.ratio)
    p[at.EVERY] = max(pieces[:, 0].sum() / (_ROWS - 2), 0.25 * p[at.H])
    rows = np.zeros((_ROWS, len(at.ROW))) if math.isinf(ends) else np.zeros((0, len(at.ROW)))
    g = np.zeros(len(at.TALLY))
    g[at.G_SLIPPED] = -1.0
    w = 0.0 if at_rest else pieces[0, 1]
    x = -_balance(stepper, pieces[0], share)
    if compiled()(p, np.ascontiguousarray(stepper.torque), pieces, g, rows, x, w, float(_MOST)):
        raise InputError(
            f"the motion of {pieces[:, 0].sum():.4g} s takes more than {_MOST} steps of a stepper's simulation; "
            "expected a shorter one by --profile"
        )
    figures = dict(zip(at.TALLY, g.tolist(), strict=True))
    kept = rows[: int(g[at.G_ROWS])]
    series = {name: kept[:, n].copy() for n, name in enumerate(at.ROW)}
    series["time"] += motion.time[0]
    return Turned(figures=figures, series=series)


def least_share(stepper: Stepper, motion: Motion, *, at_rest: bool = False) -> float:
    """Smallest share of the pull-out torque down to which no step is lost.

    Less torque swings more slowly, and a ramp as long as a swing shakes less than a shorter one: so shares are tried
    from 1 down one after another until one loses steps, and then halved between the last two.
    """

    def keeps(share: float) -> bool:
        return not simulate(stepper, motion, share=share, ends=math.pi, at_rest=at_rest).lost

    high = 1.0
    while not keeps(high):
        high /= _DOWN
        if high > 8.0:
            return math.inf
    low = _DOWN * high
    while low > _LEAST and keeps(low):
        low, high = _DOWN * low, low
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if keeps(middle) else (middle, high)
    return high


def _parameters(stepper: Stepper, share: float, ends: float, per_swing: int) -> Array:
    p, pulses = np.zeros(len(at.PARAMETERS)), stepper.natural_frequency
    fine = stepper.teeth * stepper.microstep <= _FINE
    turn = _WHOLE / (stepper.teeth * stepper.top_speed * _PER_TURN) if stepper.top_speed else math.inf
    rubs = stepper.friction or stepper.efficiency != 1.0 or stepper.forward_torque != stepper.backward_torque
    figures = {
        at.J_M: stepper.motor_inertia, at.J_L: stepper.load_inertia, at.RATIO: stepper.ratio,
        at.EFF: stepper.efficiency, at.FRICTION: stepper.friction, at.T_F: stepper.forward_torque,
        at.T_B: stepper.backward_torque, at.T_0: stepper.rest_torque, at.TEETH: stepper.teeth,
        at.DAMP: 2.0 * stepper.damping_ratio * math.sqrt(stepper.teeth * stepper.inertia),
        at.FADES: 2.0 / math.sqrt(stepper.teeth * stepper.inertia),
        at.MICRO: stepper.microstep, at.RAMP: _RAMP * pulses * stepper.microstep if fine else math.inf,
        at.H: min(1.0 / (per_swing * pulses), turn * _PER_SWING / per_swing),
        at.V_STEP: (stepper.top_speed or 1.0) / (len(stepper.torque) - 1), at.SHARE: share, at.RUBS: float(bool(rubs)),
        at.ENDS: ends,
    }  # fmt: skip
    for place, value in figures.items():
        p[place] = value
    return p


def _balance(stepper: Stepper, first: Array, share: float) -> float:
    """Angle of the rotor behind the field at the start [rad], where load and motor balance; most where they do not."""
    speed, load = first[1], first[3]
    rests = {1.0: stepper.forward_torque, -1.0: stepper.backward_torque, 0.0: stepper.rest_torque}
    drag = rests[float(np.sign(speed))] + load
    power = float(np.sign(drag * speed))
    needed = drag / stepper.ratio * stepper.efficiency**-power + np.sign(speed) * stepper.friction
    grid = np.linspace(0.0, stepper.top_speed or 1.0, len(stepper.torque))
    held = share * float(np.interp(abs(speed), grid, stepper.torque))
    return math.asin(min(max(needed / held, -1.0), 1.0)) / stepper.teeth if held > 0.0 else 0.0


def _pieces(motion: Motion, ratio: float) -> Array:
    """Pieces over which speed and load torque are straight lines, as ``layout`` has them."""
    time, speed = (np.asarray(x, float) for x in (motion.time, motion.speed))
    torque = np.array(motion.load_torque or (0.0, 0.0), float)
    when = np.array(motion.load_time, float) if len(motion.load_time) else time[[0, -1]]
    edges = np.unique(np.concatenate([time, when[(when > time[0]) & (when < time[-1])]]))
    lasts, middle = np.diff(edges), 0.5 * (edges[1:] + edges[:-1])
    columns = [lasts]
    for t, y, factor in ((time, speed, ratio), (when, torque, 1.0)):
        k = np.clip(np.searchsorted(t, middle) - 1, 0, len(t) - 2)
        gaps = np.where(t[k + 1] > t[k], t[k + 1] - t[k], 1.0)
        slope = np.where(t[k + 1] > t[k], (y[k + 1] - y[k]) / gaps, 0.0)
        columns += [factor * (y[k] + slope * (edges[:-1] - t[k])), factor * slope]
    return np.ascontiguousarray(np.column_stack(columns))
