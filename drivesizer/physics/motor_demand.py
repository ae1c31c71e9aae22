"""The drive model on columns: what a load cycle asks of every candidate, exactly and at a cost of its own length once.

For one load cycle and one belt the motor's torque is linear in six functions of time at the gearhead's output:
driving torque, braking torque, torque at rest, acceleration, direction and speed, with coefficients that depend on
the candidate alone. So the RMS current of every candidate is a quadratic form in one 6 x 6 matrix of exact segment
integrals; peaks of current and voltage lie at the few ends of segments that ``extremes`` keeps. Another belt ratio
scales the functions, so that nothing is integrated twice.
Symbols: i ratio, e efficiency, J inertia [kg*m^2], T torque [N*m], w speed [rad/s], K whole reduction.
"""

from __future__ import annotations

from functools import cached_property
from math import inf
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.back_emf import back_emf_constant
from drivesizer.physics.extremes import Extremes, extremes
from drivesizer.physics.lasting_speed import lasting_speeds
from drivesizer.physics.load_cycle import Ends, LoadCycle, integral, mean_product, rms
from drivesizer.physics.products import product

__all__ = [
    "ACCELERATION",
    "AT_REST",
    "BRAKING",
    "DIRECTION",
    "DRIVING",
    "SPEED",
    "AtGearhead",
    "Demands",
    "Peak",
    "Pieces",
    "Turning",
    "at_gearhead",
    "bounded",
    "demands",
    "friction",
    "gear_loss",
    "peak",
]

_FINEST = 200  # pieces of a segment at most
DRIVING, BRAKING, AT_REST, ACCELERATION, DIRECTION, SPEED = range(6)
Array = NDArray[np.float64]


class AtGearhead:
    """A load cycle at the gearhead's output, behind one belt."""

    def __init__(self, base: _Base, ratio: float) -> None:
        self.base, self.belt = base, ratio
        self.scale = np.array([1 / ratio, 1 / ratio, 1 / ratio, ratio, 1.0, ratio])  # of the functions
        self.moments = base.moments * np.outer(self.scale, self.scale)  # means of products over the cycle
        self.rms_torque = base.rms_torque / ratio  # N*m, while running
        self.peak_torque = base.peak_torque / ratio  # N*m
        self.peak_speed = base.peak_speed * ratio  # rad/s
        self.mean_speed = base.mean_speed * ratio  # rad/s, while running; where more, what it exceeds for long
        self.sustained_speed = base.sustained_speed * ratio  # rad/s, what it exceeds for longer than shortly
        self.mean_power = base.mean_power  # W, transmitted in either direction while running
        self.peak_power = base.peak_power  # W

    @property
    def cycle(self) -> LoadCycle:
        """The load cycle at the load."""
        return self.base.cycle

    @property
    def extremes(self) -> Extremes:
        """The points of the functions at which anything linear in them is largest or smallest."""
        return self.base.extremes

    @cached_property
    def functions(self) -> Array:
        """The six functions at both ends of each segment: shape (segments, 2, 6)."""
        scaled: Array = self.base.functions * self.scale
        return scaled

    @property
    def load_torque(self) -> Any:
        """Largest torque at the load [N*m]."""
        return np.abs(self.cycle.torque).max()

    @property
    def load_speed(self) -> Any:
        """Highest speed of the load [rad/s]."""
        return np.abs(self.cycle.speed).max()

    @property
    def standing_torque(self) -> Any:
        """Largest torque at the gearhead's output while at rest [N*m]; unknown where the cycle never rests."""
        rests = (self.cycle.speed == 0.0).all(axis=1).any()
        return np.abs(self.base.functions[:, :, AT_REST]).max() / self.belt if rests else np.nan

    def on(self, rows: Any) -> AtGearhead:
        """Of some of the candidates, which all are behind this belt (``several_belts`` has those of several)."""
        return self

    def slope(self, c: Array) -> Array:
        """Half of the slope of the mean square of what is linear in the functions, by each coefficient."""
        found: Array = c @ self.moments
        return found

    @property
    def acts(self) -> NDArray[np.bool_]:
        """Which of the functions are ever more than nothing."""
        found: NDArray[np.bool_] = self.base.acts
        return found

    def peak(self, coefficients: Array, left_out: NDArray[np.bool_] | None = None) -> Peak:
        """Largest absolute value of what is linear in the functions, as ``peak`` takes it."""
        high, low = (points * self.scale for points in (self.extremes.high, self.extremes.low))
        values = np.concatenate([product(coefficients, high.T), -product(coefficients, low.T)], axis=1)
        if left_out is not None and len(rows := np.flatnonzero(_any(left_out))):
            against = np.concatenate([high < 0.0, low > 0.0]).astype(float)
            values[rows] = np.where(left_out[rows] @ against.T > 0.0, -np.inf, values[rows])
        worst = values.argmax(axis=1)
        time = np.concatenate([self.extremes.high_time, self.extremes.low_time])
        return bounded(values[np.arange(len(values)), worst], time[worst], left_out)

    @cached_property
    def warming(self) -> Pieces:
        """The cycle in pieces of which a winding feels the mean."""
        pieces = self.base.warming
        return Pieces(pieces.duration, pieces.functions * self.scale)

    @cached_property
    def turning(self) -> Turning:
        """What friction and iron lose by in each of those pieces."""
        functions = self.warming.functions
        speed = functions[:, :, SPEED]
        steady = (functions[:, 0] == functions[:, 1]).all(axis=1)
        return Turning(speed, np.abs(speed).mean(1), mean_product(speed, speed), steady)


class Pieces(NamedTuple):
    """A cycle in pieces, and the functions at both ends of each."""

    duration: Array  # s
    functions: Array  # (pieces, 2, 6)


class Turning(NamedTuple):
    """The speed over those pieces."""

    speed: Array  # rad/s, at both ends: (pieces, 2)
    mean: Array  # rad/s, of its amount
    square: Array  # rad^2/s^2, mean
    steady: NDArray[np.bool_]  # nothing changes within the piece


class _Base(NamedTuple):
    """The same without a belt's ratio, its efficiency included."""

    cycle: LoadCycle
    functions: Array
    acts: NDArray[np.bool_]
    moments: Array
    extremes: Extremes
    warming: Pieces
    coarse: dict[tuple[str, int], Any]  # the cycle in few pieces, by what for and how many: made when asked for
    rms_torque: float
    peak_torque: float
    peak_speed: float
    mean_speed: float
    sustained_speed: float
    mean_power: float
    peak_power: float

    def behind(self, ratio: float) -> AtGearhead:
        """The cycle behind a belt of a ratio."""
        return AtGearhead(self, ratio)


class Demands(NamedTuple):
    """What each candidate's motor must do: SI columns."""

    rms_torque: Array  # N*m, friction of the motor included
    rms_current: Array  # A
    peak_speed: Array  # rad/s
    coefficients: Array  # (candidates, 6): motor torque from the functions
    total_ratio: Array  # of the gearhead
    back_emf: Array  # V*s/rad, of the motor
    left_out: NDArray[np.bool_]  # (candidates, 6): of which coefficient a part is unknown, that is left out

    @property
    def sure(self) -> NDArray[np.bool_]:
        """False: least ones, as an inertia or friction is unknown that would ask for more."""
        return ~_any(self.left_out)

    def surplus(self, k_t: Array) -> Array:
        """What the back-EMF constant is above the torque constant, by the speed at the gearhead's output [V*s/rad]."""
        found: Array = (self.back_emf - k_t) * self.total_ratio
        return found


class Peak(NamedTuple):
    """The largest absolute value of something over the cycle, and when."""

    value: Array
    time: Array  # s


def at_gearhead(cycle: LoadCycle, efficiency: float, quickest: float = inf) -> _Base:
    r"""A load cycle through a belt, with the direction of power deciding on which side its loss falls.

    .. math:: T_g = \frac{T}{i e} \; (T w > 0), \quad \frac{T e}{i} \; (T w < 0), \quad \frac{T}{i} \; (w = 0)

    Parameters
    ----------
    cycle
        At the load, split at changes of direction.
    efficiency
        Of the belt [1]; driven backward its efficiency is taken to be the same. Its ratio comes with ``behind``.
    quickest
        Shortest time constant of the windings that it is for [s].
    """
    power = (cycle.torque.mean(1) * cycle.speed.mean(1))[:, None]
    running = np.any(cycle.speed != 0.0, axis=1)
    torque = cycle.torque * np.where(~running[:, None], 1.0, np.where(power > 0.0, 1 / efficiency, efficiency))
    speed = cycle.speed
    none = np.zeros_like(torque)
    functions = np.stack([
        np.where(running[:, None] & (power > 0.0), torque, none),
        np.where(running[:, None] & (power <= 0.0), torque, none),
        np.where(~running[:, None], torque, none),
        cycle.acceleration,
        np.broadcast_to(np.sign(speed.mean(1))[:, None], torque.shape),
        speed,
    ], axis=2)  # fmt: skip
    return _Base(
        cycle, functions, np.asarray(functions.any(axis=(0, 1))), _moments(cycle, functions),
        extremes(functions, cycle.time), _warming(cycle.duration, functions, quickest), {},
        **_scalars(cycle, torque, speed, running),
    )  # fmt: skip


def _warming(duration: Array, functions: Array, quickest: float) -> Pieces:
    """The cycle so fine that a winding follows the mean of each piece: to 0.1 % of what the change within it would do.

    The mean of a changing square of the current heats the end of a piece of length x time constants by x/12 of the
    change too little; in n pieces by x/12n².
    """
    changing = (functions[:, 0] != functions[:, 1]).any(axis=1)
    count = np.where(changing, np.ceil(np.sqrt(duration / quickest / 0.012)), 1.0)
    count = np.clip(count, 1, _FINEST).astype(np.int64)
    if count.max() == 1:
        return Pieces(duration, functions)
    owner = np.repeat(np.arange(len(count)), count)
    share = (np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)) / count[owner]
    left, rise = functions[owner, 0], functions[owner, 1] - functions[owner, 0]
    ends = [left + rise * (share + step / count[owner])[:, None] for step in (0, 1)]
    return Pieces(duration[owner] / count[owner], np.stack(ends, axis=1))


def _moments(cycle: LoadCycle, functions: Array) -> Array:
    """Means of products of the functions over the cycle."""
    found = np.empty((6, 6))
    for a in range(6):
        for b in range(a + 1):
            found[a, b] = found[b, a] = integral(cycle.duration, functions[:, :, a], functions[:, :, b]) / cycle.total
    return found


def _scalars(cycle: LoadCycle, torque: Ends, speed: Ends, running: NDArray[np.bool_]) -> dict[str, float]:
    time = cycle.duration[running]
    fastest = np.abs(speed).max()
    worked = float(np.sum(time * np.abs(mean_product(torque, speed)[running])))
    return {
        "rms_torque": rms(time, torque[running]),
        "peak_torque": float(np.abs(torque).max()),
        "peak_speed": float(fastest),
        **{name: float(one) for name, one in lasting_speeds(cycle.duration, speed).items()},
        "mean_power": worked / time.sum() if time.sum() else 0.0,
        "peak_power": float(np.abs(torque * speed).max()),
    }


def demands(at: AtGearhead, motor: Any, gearhead: Any, encoder: Any) -> Demands:
    r"""Torque and current of every candidate's motor.

    .. math:: \tau = \frac{T}{i e} \text{ or } \frac{T e}{i} + (J_m + J_g + J_e) i a + (k_t I_0 + T_0)\, \mathrm{sgn} w

    Parameters
    ----------
    at
        The load cycle at the gearhead's output.
    motor, gearhead, encoder
        Figures of the candidates' parts by field name: columns. An unknown inertia of rotor or gearhead and an unknown
        friction of the motor are left out where more of them could only ask for more RMS torque, and the demands are
        then least ones; else they are unknown. A figure whose function is nothing over the whole cycle has no part in
        it, and need not be known. The inertia of an encoder, thousands of times smaller than the load's, is left out.

    Notes
    -----
    Friction is what ``friction`` tells, e and T_0 what ``gear_loss`` does.
    """
    i, k_t = gearhead["ratio"], motor["torque_constant"]
    e, idle = gear_loss(gearhead)
    coulomb, viscous = friction(motor)
    c = np.empty((len(i), 6))
    left_out = np.zeros(c.shape, np.bool_)
    lacking = {ACCELERATION: gearhead["inertia"] + motor["rotor_inertia"], DIRECTION: coulomb, SPEED: viscous}
    for place, figure in lacking.items():
        left_out[:, place] = np.isnan(figure) & at.acts[place]
    c[:, DRIVING] = 1 / (i * e)
    c[:, BRAKING] = e / i
    c[:, AT_REST] = 1 / i
    c[:, ACCELERATION] = sum(np.nan_to_num(part["inertia"]) for part in (gearhead, encoder)) * i
    c[:, ACCELERATION] += np.nan_to_num(motor["rotor_inertia"]) * i
    c[:, DIRECTION] = np.nan_to_num(coulomb) + idle
    c[:, SPEED] = np.nan_to_num(viscous) * i
    for place in np.flatnonzero(~at.acts).tolist():
        c[np.isnan(c[:, place]), place] = 0.0
    slope = at.slope(c)
    for place in (ACCELERATION, DIRECTION, SPEED):
        c[left_out[:, place] & (slope[:, place] < 0.0), place] = np.nan
    rms_torque = np.sqrt(np.maximum((slope * c).sum(1), 0.0))
    return Demands(rms_torque, rms_torque / k_t, at.peak_speed * i, c, i, back_emf_constant(motor), left_out)


def friction(motor: Any) -> tuple[Array, Array]:
    """Friction torque of motors at any speed [N*m], and per speed of theirs [N*m*s/rad].

    The catalogue's own, where it tells both. Else what the no-load current makes: brushed motors lose k_t I_0 at any
    speed; of brushless ones the no-load loss is taken to rise with speed, up to k_t I_0 at the no-load speed.
    """
    loss = motor["torque_constant"] * motor["no_load_current"]
    brushed = motor["kind"] == "brushed"
    told = ~np.isnan(motor["friction_torque"]) & ~np.isnan(motor["viscous_friction"])
    coulomb = np.where(told, motor["friction_torque"], np.where(brushed, loss, 0.0))
    viscous = np.where(told, motor["viscous_friction"], np.where(brushed, 0.0, loss / motor["no_load_speed"]))
    return coulomb, viscous


def gear_loss(gearhead: Any) -> tuple[Array, Array]:
    r"""What a gearhead takes: the efficiency of what goes through it, and the torque at its input to turn it [N*m].

    Without a no-load torque T_0 in the catalogue it is all in the efficiency e, that at continuous torque T_N. With
    one, the rest is proportional to torque, so that both make e at T_N; nothing where T_0 alone is more than that.

    .. math:: \frac{1}{e'} = \max\!\left(\frac{1}{e} - \frac{i\,T_0}{T_N},\ 1\right)
    """
    e, idle = gearhead["efficiency"], gearhead["no_load_torque"]
    told = ~np.isnan(idle + gearhead["continuous_torque"])
    share = 1 / e - gearhead["ratio"] * idle / gearhead["continuous_torque"]
    return np.where(told, 1 / np.maximum(share, 1.0), e), np.where(told, idle, 0.0)


def peak(at: AtGearhead, coefficients: Array, left_out: NDArray[np.bool_] | None = None) -> Peak:
    """Largest absolute value over the cycle of what is linear in the functions, with coefficients of 0 or more.

    Parameters
    ----------
    at
        The load cycle at the gearhead's output.
    coefficients
        Of the six functions for each candidate; NaN unknown: the peak is then unknown.
    left_out
        Coefficients that are too small by something unknown, if any. The peak is then a least one: of the moments at
        which more of them makes it no smaller; unknown where there are none.
    """
    return at.peak(coefficients, left_out)


def bounded(value: Array, time: Array, left_out: NDArray[np.bool_] | None) -> Peak:
    """A peak; unknown where something was left out and no moment is a bound."""
    if left_out is None:
        return Peak(value, time)
    return Peak(np.where(_any(left_out) & ~(value > 0.0), np.nan, value), time)


def _any(left_out: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether anything was left out of a candidate's coefficients: of the three that may lack a part."""
    found: NDArray[np.bool_] = left_out[:, ACCELERATION] | left_out[:, DIRECTION] | left_out[:, SPEED]
    return found
