"""Limits that need the current of each moment: winding temperature at its peak, supply, bus voltage, overload time.

Safe bounds come first, from moments and extremes alone: they decide most candidates. What they leave undecided is
computed from the waveform itself, as is everything that is shown. A bound never passes what the waveform would fail.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.checks import CheckColumn, at_most
from drivesizer.extremes import Envelope, envelope
from drivesizer.heat_blocks import blocks, bracket
from drivesizer.heat_columns import periodic_winding, winding_bounds
from drivesizer.loadcycle import mean_product
from drivesizer.physics import DIRECTION, SPEED, AtGearhead, Demands
from drivesizer.physics_limits import Heat, Parts, Stress, on, volts_of, winding_limit
from drivesizer.spec import RobotSpec
from drivesizer.thermal import two_bodies
from drivesizer.waveform import balanced, energy, largest_power, longest_above, longest_run, mean_square, wave

__all__ = [
    "Moments",
    "above_bounds",
    "bounds",
    "bracketed",
    "exact",
    "kept_on_the_bus",
    "peak_winding",
    "time_above",
    "waveform_limits",
]

Array = NDArray[np.float64]
_AT_ONCE = 400_000  # candidates times segments that are held at a time
_PIECES = 256  # of a cycle, that bound the time of overload at first
_FASTEST_CHOPPING = 100e3  # Hz, of controllers for small motors
_RIPPLE = 0.1  # of the supply's voltage, at most
_SOME = 1e-300  # more than nothing, of an amount that is not known yet


class Moments(NamedTuple):
    """What the waveform asks of one motor set: columns."""

    winding: Array  # K, peak over the periodic cycle
    winding_time: Array  # s
    power: Array  # W, largest that the motor draws
    power_time: Array  # s
    drawn: Array  # J per cycle
    returned: Array  # J per cycle
    stored: Array  # J, the most that is back and not drawn again
    above: Array  # s, longest time on end above the controller's continuous current

    def least(self, sure: NDArray[np.bool_], mean: Array) -> Moments:
        """The same; where demands are least ones the winding's steady mean, no more, and what they leave open."""
        if sure.all():
            return self
        open_ = {name: np.where(sure, column, np.nan) for name, column in self._asdict().items()}
        return Moments(**(open_ | {"winding": np.where(sure, self.winding, mean)}))


def exact(spec: RobotSpec, at: AtGearhead, asked: Demands, warm: Heat, under: Stress, parts: Parts) -> Moments:
    """From the current and voltage of each moment; some candidates at a time."""
    found = [
        _block(spec, at, on(asked, k), on(warm, k), under.hot[k], parts.on(k)) for k in _slices(at, len(under.hot))
    ]
    return Moments(*(np.concatenate(columns) for columns in zip(*found, strict=True)))


def bracketed(
    at: AtGearhead, asked: Demands, warm: Heat, parts: Parts, ambient: float, count: int
) -> tuple[Array, Array]:
    """Bounds of the winding's peak from a long cycle in so many blocks [K]: closer than those of ``bounds``."""
    store, name = at.base.coarse, ("blocks", count)
    if name not in store:
        store[name] = blocks(at.cycle.duration, at.base.functions, count)
    current = asked.coefficients / parts.motor["torque_constant"][:, None]
    coarse = store[name].behind(at.scale)
    found = bracket(two_bodies(parts.motor), ambient, coarse, current, warm.friction, warm.iron)
    no_constants = _no_constants(parts.motor)
    low, high = (np.where(no_constants, warm.winding, bound) for bound in found)
    return low, high


def _no_constants(motor: Any) -> NDArray[np.bool_]:
    """Whether the time constants are unknown: then only the steady mean can be told."""
    found: NDArray[np.bool_] = np.isnan(motor["winding_time_constant"]) | np.isnan(motor["motor_time_constant"])
    return found


def peak_winding(
    spec: RobotSpec, at: AtGearhead, asked: Demands, warm: Heat, under: Stress, parts: Parts
) -> tuple[Array | None, ...]:
    """The exact peak of the winding's temperature alone, in the place that it has in :class:`Moments`."""
    found = [
        _peak_winding(spec, at, asked.coefficients[k], on(warm, k), parts.motor.on(k))
        for k in _slices(at, len(under.hot))
    ]
    winding, time = (np.concatenate(columns) for columns in zip(*found, strict=True))
    return (winding, time, *[None] * (len(Moments._fields) - 2))


def time_above(
    spec: RobotSpec, at: AtGearhead, asked: Demands, warm: Heat, under: Stress, parts: Parts
) -> tuple[Array | None, ...]:
    """The exact time on end above the continuous current alone, in the place that it has in :class:`Moments`."""
    found = [
        longest_above(
            wave(at.cycle.duration, at.functions, c := asked.coefficients[k], c, parts.motor["torque_constant"][k]),
            parts.controller["continuous_current"][k],
        )
        for k in _slices(at, len(under.hot))
    ]
    return (*[None] * (len(Moments._fields) - 1), np.concatenate(found))


def _slices(at: AtGearhead, count: int) -> list[slice]:
    """Pieces of so many candidates; of none one piece without any, so that columns stay columns."""
    size = max(1, _AT_ONCE // len(at.base.warming.duration))
    return [slice(start, start + size) for start in range(0, max(count, 1), size)]


def _block(spec: RobotSpec, at: AtGearhead, asked: Demands, warm: Heat, hot: Array, parts: Parts) -> Moments:
    k_t, cycle = parts.motor["torque_constant"], at.cycle
    found = wave(cycle.duration, at.functions, asked.coefficients, volts_of(asked, k_t, hot), k_t)
    taken = balanced(found, asked.surplus(k_t), at.functions[:, :, SPEED])
    power, when = largest_power(taken)
    kept = kept_on_the_bus(spec.supply)
    sums = energy(taken, kept, storing=kept > 0.0)
    winding, time = _peak_winding(spec, at, asked.coefficients, warm, parts.motor)
    return Moments(
        winding=winding,
        winding_time=time,
        power=power,
        power_time=when,
        drawn=sums.drawn,
        returned=sums.returned,
        stored=sums.stored if kept > 0.0 else np.zeros_like(sums.drawn),
        above=longest_above(found, parts.controller["continuous_current"]),
    )


def _peak_winding(spec: RobotSpec, at: AtGearhead, c: Array, warm: Heat, motor: Any) -> tuple[Array, Array]:
    """Peak over the periodic cycle and when; the steady mean where the time constants are unknown."""
    duration, functions = at.warming
    square = mean_square(wave(duration, functions, c, c, motor["torque_constant"]))
    speed = functions[:, :, SPEED]
    loss = np.outer(warm.friction, np.abs(speed).mean(1)) + np.outer(warm.iron, mean_product(speed, speed))
    found = periodic_winding(two_bodies(motor), spec.environment.ambient, duration, square, loss)
    no_constants = _no_constants(motor)
    return np.where(no_constants, warm.winding, found.peak), np.where(no_constants, np.nan, found.peak_time)


def bounds(
    spec: RobotSpec, at: AtGearhead, asked: Demands, warm: Heat, under: Stress, parts: Parts
) -> tuple[Moments, Moments]:
    """Below and above what the waveform asks, from moments and extremes alone."""
    current, k_t = under.current.value, parts.motor["torque_constant"]
    nothing = np.full_like(current, np.nan)
    most = least = nothing
    keeps = kept_on_the_bus(spec.supply) > 0.0
    if spec.supply.current or spec.supply.power or keeps:
        most, least = _corner_power(at, asked, under.hot, k_t)
    stored_low = stored_high = np.zeros_like(current)
    if keeps:
        braked = braking_torque(at, asked.coefficients)
        least = np.where(asked.surplus(k_t) == 0.0, least, np.nan)  # power is not V I where two constants differ
        stored_low, stored_high = np.where(least < 0.0, _SOME, 0.0), np.where(braked, np.inf, 0.0)
    heat_low, heat_high = _winding_bounds(spec, at, asked, warm, under, parts.motor)
    shortest, longest = above_bounds(at, asked, under, parts)
    low = Moments(heat_low, nothing, most, nothing, nothing, nothing, stored_low, shortest)
    power = nothing
    if spec.supply.current or spec.supply.power:
        power = np.minimum(_power_bound(at, asked, under.hot, k_t), current * under.hot_voltage)
        power = np.where(asked.surplus(k_t) == 0.0, power, np.inf)
    high = Moments(heat_high, nothing, power, nothing, nothing, nothing, stored_high, longest)
    return low, high


def above_bounds(
    at: AtGearhead, asked: Demands, under: Stress, parts: Parts, pieces: int = _PIECES
) -> tuple[Array, Array]:
    """Bounds of the time on end above the continuous current, from a cycle in so many pieces at most [s].

    That of the pieces that surely are above, and of those that may be.
    """
    store, name = at.base.coarse, ("envelope", pieces)
    if name not in store:
        store[name] = envelope(at.cycle.duration, at.base.functions, pieces)
    found: Envelope = store[name]
    peak = under.current.value
    k_t, limit = parts.motor["torque_constant"], parts.controller["continuous_current"]
    low = np.where(np.isnan(peak) | np.isnan(limit), np.nan, 0.0)
    high = low.copy()
    rows = np.flatnonzero(peak > limit)
    if len(rows):
        c = asked.coefficients[rows] / k_t[rows, None] * at.scale
        top, bottom, bound = c @ found.high.T, c @ found.low.T, limit[rows, None]
        none, whole = np.zeros_like(top), np.broadcast_to(found.duration, top.shape)
        surely, perhaps = np.maximum(bottom, -top) > bound, np.maximum(top, -bottom) > bound
        low[rows] = np.maximum(longest_run(found.duration, none, whole, surely), _SOME)
        high[rows] = longest_run(found.duration, none, whole, perhaps)
    return low, high


def braking_torque(at: AtGearhead, coefficients: Array) -> NDArray[np.bool_]:
    """Whether the motor's torque is ever against its motion: otherwise nothing comes back."""
    against = np.zeros(len(coefficients), bool)
    for points, sign in ((at.extremes.low, +1.0), (at.extremes.high, -1.0)):
        moving = points[points[:, DIRECTION] == sign] * at.scale
        if len(moving):
            against |= (sign * (coefficients @ moving.T) < 0.0).any(axis=1)
    return against


def _corner_power(at: AtGearhead, asked: Demands, hot: Array, k_t: Array) -> tuple[Array, Array]:
    """Largest and smallest electrical power at the extreme points [W]: between them it may be more and less."""
    points = np.concatenate([at.extremes.high, at.extremes.low]) * at.scale
    power = (asked.coefficients / k_t[:, None] @ points.T) * (volts_of(asked, k_t, hot) @ points.T)
    return power.max(axis=1), power.min(axis=1)


def _power_bound(at: AtGearhead, asked: Demands, hot: Array, k_t: Array) -> Array:
    """More than the electrical power ever is [W]: where current and voltage are both positive, or both negative."""
    current, volts = asked.coefficients / k_t[:, None] * at.scale, volts_of(asked, k_t, hot) * at.scale
    found = np.zeros(len(hot))
    for points, sign in ((at.extremes.above, 1.0), (at.extremes.below, -1.0)):
        both = [np.maximum(sign * (c @ points.T), 0.0) for c in (current, volts)]
        found = np.maximum(found, (both[0] * both[1]).max(axis=1))
    return found


def _winding_bounds(
    spec: RobotSpec, at: AtGearhead, asked: Demands, warm: Heat, under: Stress, motor: Any
) -> tuple[Array, Array]:
    fast = at.peak_speed
    loss_peak = warm.friction * fast + warm.iron * fast**2
    low, high = winding_bounds(
        two_bodies(motor), spec.environment.ambient, asked.rms_current, under.current.value, at.cycle.total,
        warm.mean, loss_peak,
    )  # fmt: skip
    no_constants = _no_constants(motor)
    return np.where(no_constants, warm.winding, low), np.where(no_constants, warm.winding, high)


def waveform_limits(spec: RobotSpec, found: Moments, parts: Parts) -> list[CheckColumn]:
    """What the waveform asks against its limits; all motor sets draw from one supply."""
    supply, sets, controller = spec.supply, spec.load.motors, parts.controller
    torque, power = spec.margins.torque, found.power * sets
    checks = [
        winding_limit(spec, found.winding, parts.motor, found.winding_time),
        at_most("controller_peak_time", found.above, controller["peak_time"], "time", "s"),
        at_most("bus_voltage", _bus_voltage(spec, found, controller), controller["supply_max"], "voltage", "V"),
    ]
    if supply.current is not None:
        drawn = power / supply.lowest
        checks.append(at_most("supply_current", drawn, supply.current, "current", "A", needed=torque,
                              time=found.power_time))  # fmt: skip
    if supply.power is not None:
        checks.append(at_most("supply_power", power, supply.power, "power", "W", needed=torque, time=found.power_time))
    return checks


def kept_on_the_bus(supply: Any) -> Any:
    """Share of the returned energy that the supply does not take, as far as it is judged.

    Without a capacitance a supply that takes a share is taken to lose the rest, as a battery does inside.
    """
    if supply.capacitance is None:
        return np.where(np.asarray(supply.regeneration) > 0.0, 0.0, 1.0)
    return 1.0 - np.asarray(supply.regeneration)


def _bus_voltage(spec: RobotSpec, found: Moments, controller: Any) -> Array:
    r"""Highest voltage of the bus: what its capacitance makes of the energy that the supply does not take [V].

    Where the capacitance is unknown it is no less than the controller's own: a power stage that chops its continuous
    current I at a frequency f holds the ripple of its supply U within a share s by :math:`C \ge I / (4 f s U)` (buck
    converter at half duty; D. W. Hart, *Power Electronics*, 2011, chapter 6). That bound passes what even so little
    bears, such as 1 mJ; what it does not bear is unknown.
    """
    supply = spec.supply
    if supply.capacitance is not None:
        raised: Array = np.sqrt(supply.highest**2 + 2.0 * found.stored * spec.load.motors / supply.capacitance)
        return raised
    least = controller["continuous_current"] / (4.0 * _FASTEST_CHOPPING * _RIPPLE * supply.highest)
    with np.errstate(divide="ignore", invalid="ignore"):
        bound = np.sqrt(supply.highest**2 + 2.0 * found.stored / least)  # each controller bears its own motor's return
    bound = np.where(found.stored == 0.0, supply.highest, bound)
    return np.where((bound <= controller["supply_max"]) | (found.stored == 0.0), bound, np.nan)
