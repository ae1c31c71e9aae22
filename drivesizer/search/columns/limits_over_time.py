"""Limits that need the winding or the current of each moment: by bounds where they decide, else exactly."""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import partial
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.kernel.drives import drives_of, held
from drivesizer.kernel.evaluate import ENERGY, POWER, evaluate
from drivesizer.kernel.records import Drive
from drivesizer.physics.cycle_at_gearhead import DIRECTION, SPEED, AtGearhead, Peak
from drivesizer.physics.figures import product
from drivesizer.physics.heat_cycle import coolest_winding, winding_bounds
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import Feed, bus_voltage, least_capacitance, of_the_source
from drivesizer.physics.thermal import resistance_25, resistance_at, two_bodies
from drivesizer.physics.winding import (
    Heat,
    Parts,
    Stress,
    at_a_time,
    behind_one,
    heat_behind_one,
    on,
    replaced,
    temperature_at_most,
)
from drivesizer.results.check_columns import CheckColumn, at_most, between
from drivesizer.results.ratings import controller_current, controller_power_limit
from drivesizer.search.columns.limits import waived, winding_limit
from drivesizer.spec.robot import RobotSpec

__all__ = [
    "WAVEFORM_LIMITS", "Exactly", "Moments", "Pair", "Wanted", "at_source", "bounds", "bus_limit", "decided", "exact",
    "kept_on_the_bus", "least", "left_open", "waveform_limits",
]  # fmt: skip


# -- Limits that need the winding or the current of each moment: temperature, voltage, supply, bus, time of overload.
#
# The winding is as warm as it is at each moment of the cycle in periodic steady state (``kernel``); its voltage is
# checked cold, as it starts, too. Where a figure is missing that this needs, a check passes by the warmest that the
# winding may be and fails by the coldest, so that less data never looks better (``checks.between``). Before the
# waveform come safe bounds from moments and extremes alone (``waveform_bounds``). Symbols: R resistance [ohm], I
# current [A], T temperature [K].


Array = NDArray[np.float64]
_STAYS = "unknown: where it goes: give brake_resistor, supply.capacitance, or supply.accepts: all of a battery"
_HELD = "at the supply's highest voltage: the battery, which takes regenerated energy, is held to it"


class Moments(NamedTuple):
    """Peaks and heat over the waveform, or bounds of them: columns."""

    winding: Array  # K, peak over the periodic cycle
    winding_time: Array  # s
    voltage: Array  # V, the larger of winding cold and as warm as it then is
    voltage_time: Array  # s
    copper: Array  # W, mean heat of the winding
    power: Array  # W, largest out of the source
    power_time: Array  # s
    drawn: Array  # J per cycle, out of the source
    returned: Array  # J per cycle, at the input of the controllers
    stored: Array  # J, the most that is back and not drawn again
    above: Array  # s, longest uninterrupted time above the controller's continuous current

    def agreed(self, other: Moments) -> Moments:
        """Figures on which two bounds agree; unknown where they do not."""
        if self is other:
            return self
        return Moments(*(np.where(a == b, a, np.nan) for a, b in zip(self, other, strict=True)))


WAVEFORM_LIMITS = (
    "winding_temperature", "supply_voltage", "controller_peak_time", "bus_voltage", "common_bus_voltage",
    "controller_power", "supply_current", "supply_power",
)  # fmt: skip
Wanted = Literal["limits", "all"]
# what is computed from the waveform whatever bounds decide, or of which rows; ``bounds``: not even what they leave open
Exactly = Wanted | Literal["bounds"] | bool | NDArray[np.bool_]
Pair = tuple[Moments, Moments]  # bounds: lower and upper bounds


def between_bounds(high: Moments, cold: Moments, rows: Any, mean: Array, steady: Array) -> Pair:
    """Bounds of candidates whose heat is unknown."""
    low = Moments(*(column.copy() for column in high))
    for name in ("voltage", "voltage_time", "power", "power_time"):
        getattr(low, name)[rows] = getattr(cold, name)
    high.stored[rows] = cold.stored  # the more the winding takes, the less is regenerated
    low.winding[rows], high.winding[rows] = mean[rows], steady[rows]
    return low, high


def least(found: Pair, demand: Demands, heating: Heat, stresses: Stress) -> Pair:
    """The same; with incomplete demands only lower bounds are known."""
    if demand.complete.all():
        return found
    low, high = (Moments(*(np.where(demand.complete, column, np.nan) for column in side)) for side in found)
    cold = stresses.cold_voltage
    lowest_known = {"winding": heating.winding, "voltage": cold.value, "voltage_time": cold.time}
    filled = {name: np.where(demand.complete, getattr(low, name), column) for name, column in lowest_known.items()}
    return low._replace(**filled), high


def hottest(spec: RobotSpec, cycle: AtGearhead, heating: Heat, stresses: Stress, motor: Any) -> Array:
    """Temperature that a winding of unknown heat does not exceed, or must not: the demand then is a safe bound."""
    found = temperature_at_most(spec.environment.ambient, cycle, heating, stresses, motor)
    bound: Array = np.fmin(np.where(np.isfinite(found), found, np.nan), motor["max_winding_temperature"])
    return bound


def warmest_passing(
    spec: RobotSpec, cycle: AtGearhead, heating: Heat, stresses: Stress, motor: Any, peak: Array
) -> Array:
    """Temperature that a winding does not exceed, or fails by its heat."""
    bound = hottest(spec, cycle, heating, stresses, motor)
    found = np.fmin(np.where(np.isnan(peak), bound, peak), motor["max_winding_temperature"])
    return np.where(np.isfinite(found), found, np.nan)


def waveform_limits(spec: RobotSpec, low: Moments, high: Moments, parts: Parts) -> list[CheckColumn]:
    """Bounds over the waveform against the limits; all drives draw from one supply."""
    if low is high:
        return _limits(spec, high, parts)
    return [between(*both) for both in zip(*(_limits(spec, side, parts) for side in (low, high)), strict=True)]


def _limits(spec: RobotSpec, found: Moments, parts: Parts) -> list[CheckColumn]:
    supply, sets, controller = spec.supply, spec.load.motors, parts.controller
    torque, speed, power = spec.margins.torque, spec.margins.speed, found.power * sets
    bus = _bus_voltage(spec, found, controller)
    usable = spec.feed(controller).usable_for(found.voltage * (1.0 + speed))
    held = _HELD if spec.battery and spec.accepts_all else ""
    checks = [
        winding_limit(spec, found.winding, parts.motor, found.winding_time),
        at_most("supply_voltage", found.voltage, usable, needed=speed, time=found.voltage_time),
        waived(spec, at_most("controller_peak_time", found.above, controller["peak_time"])),
        bus_limit(spec, bus, controller["supply_max"], undecided=_STAYS, note=held),
        controller_power_limit(found.power, controller, supply.highest, needed=torque, time=found.power_time),
    ]
    if supply.current is not None:
        drawn = power / supply.lowest
        checks.append(at_most("supply_current", drawn, supply.most_current, needed=torque,
                              time=found.power_time))  # fmt: skip
    if supply.power is not None:
        checks.append(at_most("supply_power", power, supply.power, needed=torque, time=found.power_time))
    return checks


def bus_limit(spec: Any, bus: Any, limit: Any, **more: Any) -> CheckColumn:
    """Highest voltage of the bus against the controller's limit."""
    if spec.on_common_bus:
        return at_most("common_bus_voltage", bus, limit, by_choice=True)
    return at_most("bus_voltage", bus, limit, **more)


def kept_on_the_bus(spec: Any) -> Any:
    """Share of the returned energy that the supply does not accept: it has to stay on the bus."""
    share = 1.0 - np.asarray(spec.supply.regeneration)
    return 0.0 * share if spec.accepts_all else share


def _bus_voltage(spec: RobotSpec, found: Moments, controller: Any) -> Array:
    """Highest voltage of the bus, with the energy that the supply does not accept in its capacitance [V].

    Where the supply accepts all, it stays at its highest: a battery is held to that at the largest return, with the
    charge of the start (``energy_checks``). An unknown capacitance is at least that of the controller: a voltage that
    passes with so little is certain, one that does not is unknown. A chopper lets it rise to its own voltage at most.
    """
    supply, chopper = spec.supply, spec.chopper_voltage
    if supply.capacitance is not None:
        raised: Array = bus_voltage(supply.highest, found.stored * spec.load.motors, supply.capacitance)
        return raised if chopper is None else np.minimum(raised, np.maximum(chopper, supply.highest))
    if chopper is not None:
        held = np.where(found.stored == 0.0, supply.highest, np.maximum(chopper, supply.highest))
        return np.where(np.isnan(found.stored), np.nan, held)
    least = least_capacitance(controller["continuous_current"], supply.highest)
    with np.errstate(divide="ignore", invalid="ignore"):
        bound = bus_voltage(supply.highest, found.stored, least)  # each controller stores its own motor's return
    bound = np.where(found.stored == 0.0, supply.highest, bound)
    return np.where((bound <= controller["supply_max"]) | (found.stored == 0.0), bound, np.nan)


# -- Bounds over the waveform, from moments and extremes alone: they decide most candidates.
#
# What they leave open is computed from the waveform itself (``exactly``), as is everything that is shown. A bound
# never passes what the waveform would fail. Voltage and power grow with the winding's temperature wherever current
# and voltage point the same way, and are straight in it: a winding that is nowhere cooler and nowhere warmer bounds
# them. Symbols: R resistance [ohm], T temperature [K].


_CELLS = 1 << 16  # candidates times points at a time: what stays in the processor's cache
_ROUNDING = 1e-9  # of a figure
_SOME = 1e-100  # s, more than nothing, of a time that is not known yet


def bounds(spec: RobotSpec, cycle: AtGearhead, demand: Demands, heating: Heat, stresses: Stress, parts: Parts) -> Pair:
    """Lower and upper bounds over the waveform; upper ones of windings that pass."""
    heating, (cycle, demand) = heat_behind_one(cycle, heating), behind_one(cycle, demand)
    motor, feed, ambient = parts.motor, spec.feed(parts.controller, parts.brake), spec.environment.ambient
    low, high = winding_limits(spec, cycle, demand, heating, stresses, motor)
    bodies, total = two_bodies(motor), cycle.load_cycle.total
    coolest = coolest_winding(bodies, ambient, demand.rms_current, total, heating.mean, low)
    warmest = warmest_passing(spec, cycle, heating, stresses, motor, high)
    k_t, R_25 = motor["torque_constant"], resistance_25(motor)
    cool, hot = (np.asarray(resistance_at(R_25, T)) for T in (coolest, warmest))
    leads = np.broadcast_to(feed.leads if spec.resists else 0.0, k_t.shape)
    volts, least_power = _each(cycle, _least_at_points, k_t, demand, cool, leads, feed.broadcast(len(k_t)))
    at_hot = most_volts = np.maximum(_each(cycle, _most_at_points, k_t, demand, hot), stresses.cold_voltage.value)
    if spec.resists:
        most_volts = np.maximum(at_hot, _each(cycle, _most_at_points, k_t, demand, hot + leads))
    nothing = np.full_like(k_t, np.nan)
    none, (shortest, longest) = Moments(*[nothing] * len(Moments._fields)), _above(spec, cycle, demand, stresses, parts)
    least = none._replace(
        winding=low, above=shortest, voltage=np.maximum(volts, stresses.cold_voltage.value), stored=np.zeros_like(k_t)
    )
    most = none._replace(winding=high, above=longest, voltage=most_volts, stored=_most_kept(spec, cycle, demand, motor))
    if spec.supply.current or spec.supply.power:
        power = np.minimum(_each(cycle, _most_power, k_t, demand, hot), stresses.current.value * at_hot)
        power = at_source(power + _most_beyond(cycle, demand, stresses, k_t), stresses, feed)
        least = least._replace(power=of_the_source(least_power + feed.stage.standby, feed))
        most = most._replace(power=power)
    return least, most


def _each(cycle: AtGearhead, compute: Callable[..., Any], *columns: Any) -> Any:
    """A function of the cycle's extreme points and candidates, of so many of these at a time as stay in the cache."""
    points = len(cycle.extremes.high) + len(cycle.extremes.low)
    return at_a_time(len(columns[0]), max(_CELLS // points, 1), partial(compute, cycle), *columns)


def at_source(power: Array, stresses: Stress, feed: Feed) -> Array:
    """Upper bound of the power out of the source, of one of the motor's power."""
    found: Array = of_the_source(power + feed.lost(stresses.current.value) + feed.stage.standby, feed)
    return found


def _most_beyond(cycle: AtGearhead, demand: Demands, stresses: Stress, k_t: Array) -> Array:
    """Bound of the power above V I [W] where two constants differ (``waveform.balanced``); infinite if unknown."""
    found = 2.0 * np.abs(demand.surplus(k_t)) * cycle.peak_speed * stresses.current.value
    return np.where(np.isnan(found), np.inf, found)


def _least_at_points(
    cycle: AtGearhead, k_t: Array, demand: Demands, cool: Array, leads: Array, feed: Feed
) -> tuple[Array, Array]:
    """Less than the largest voltage [V], by points where warmth only raises it, and power into the stage there [W]."""
    points = np.concatenate([cycle.extremes.high, cycle.extremes.low])
    current, volts = _current_and_induced(points, k_t, demand)
    volts += cool * current
    power = (current * volts + feed.lost(current)).max(axis=0)
    volts += leads * current
    return np.where(current * volts > 0.0, np.abs(volts), 0.0).max(axis=0), power


def _most_at_points(cycle: AtGearhead, k_t: Array, demand: Demands, hot: Array) -> Array:
    """The largest voltage with a winding of one resistance [V]: peaks of what is linear in the functions lie there."""
    points = np.concatenate([cycle.extremes.high, cycle.extremes.low])
    current, volts = _current_and_induced(points, k_t, demand)
    volts += hot * current
    found: Array = np.abs(volts).max(axis=0)
    return found


def _current_and_induced(points: Array, k_t: Array, demand: Demands) -> tuple[Array, Array]:
    """Current [A] and induced voltage [V] at points of the functions: shape (points, candidates), few long rows."""
    current = product(points, (demand.coefficients / k_t[:, None]).T)
    return current, points[:, SPEED, None] * (demand.back_emf * demand.total_ratio)


def winding_limits(
    spec: RobotSpec, cycle: AtGearhead, demand: Demands, heating: Heat, stresses: Stress, motor: Any
) -> tuple[Array, Array]:
    """Bounds of the winding's peak [K]; without time constants the mean, and what the largest current would make."""
    fast = cycle.peak_speed
    loss_peak = heating.friction * fast + heating.iron * fast**2
    found = winding_bounds(
        two_bodies(motor), spec.environment.ambient, demand.rms_current, stresses.current.value,
        cycle.load_cycle.total, heating.mean, loss_peak,
    )  # fmt: skip
    without = np.isnan(motor["winding_time_constant"]) | np.isnan(motor["motor_time_constant"])
    most = temperature_at_most(spec.environment.ambient, cycle, heating, stresses, motor)
    low, high = (np.where(without, x, bound) for x, bound in zip((heating.winding, most), found, strict=True))
    return low, high


def _most_power(cycle: AtGearhead, k_t: Array, demand: Demands, hot: Array) -> Array:
    """More than the electrical power ever is [W]: where current and voltage are both positive, or both negative."""
    found = np.zeros(len(hot))
    for points, sign in ((cycle.extremes.above, 1.0), (cycle.extremes.below, -1.0)):
        current, volts = _current_and_induced(sign * points, k_t, demand)
        volts += hot * current
        found = np.maximum(found, (np.maximum(current, 0.0) * np.maximum(volts, 0.0)).max(axis=0))
    return found


def _above(spec: RobotSpec, cycle: AtGearhead, demand: Demands, stresses: Stress, parts: Parts) -> tuple[Array, Array]:
    """Bounds of the time above the controller's current [s]: what is exceeded so long has that mean square."""
    peak, limit = stresses.current.value, controller_current(parts.controller, spec.environment.ambient)
    none, total = np.where(np.isnan(peak) | np.isnan(limit), np.nan, 0.0), cycle.load_cycle.total
    with np.errstate(divide="ignore", invalid="ignore"):
        most = total * np.minimum(np.square(demand.rms_current / limit) * (1.0 + _ROUNDING), 1.0)
    exceeded = peak > limit
    return np.where(exceeded, _SOME, none), np.where(exceeded, most, none)


def _most_kept(spec: RobotSpec, cycle: AtGearhead, demand: Demands, motor: Any) -> Array:
    """More than the energy that stays on the bus [J]: all that is returned over a cycle and not accepted.

    Infinite where more may be returned than is drawn, or that is unknown.
    """
    kept, nothing = kept_on_the_bus(spec), np.zeros_like(demand.rms_current)
    if not kept > 0.0:
        return nothing
    ratio, c, acting = demand.total_ratio, demand.coefficients, np.flatnonzero(cycle.braked)
    returned = ratio * product(c[:, acting], cycle.braked[acting, None])[:, 0]
    heat = np.asarray(resistance_at(resistance_25(motor), spec.environment.ambient)) * demand.rms_current**2
    work = ratio * product(c, cycle.moments[:, SPEED, None])[:, 0]
    draws = heat + work > _ROUNDING * (heat + np.abs(work))  # mean power at least, see ``least_drawn``
    most = np.where(draws, kept * returned * (1.0 + _ROUNDING), np.inf)
    return np.where(_brakes(cycle, c), most, nothing)


def _brakes(cycle: AtGearhead, coefficients: Array) -> NDArray[np.bool_]:
    """Whether the motor's torque is ever against its motion: otherwise nothing is regenerated."""
    against = np.zeros(len(coefficients), bool)
    for points, sign in ((cycle.extremes.low, +1.0), (cycle.extremes.high, -1.0)):
        moving = points[points[:, DIRECTION] == sign] * cycle.scale
        if len(moving):
            against |= (sign * product(coefficients, moving.T) < 0.0).any(axis=1)
    return against


# -- Peaks and heat over the waveform of candidates, from current and winding at each moment.
#
# Where no more is wanted than which limits are met, of candidates that bounds leave open.


def exact(
    spec: RobotSpec,
    cycle: AtGearhead,
    demand: Demands,
    heating: Heat,
    stresses: Stress,
    parts: Parts,
    what: Wanted = "all",
    error: float = 1e-3,
) -> Pair:
    """Peaks and heat over the waveform, of candidates over one cycle or of samples each over its own."""
    ambient, motor, feed = spec.environment.ambient, parts.motor, spec.feed(parts.controller, parts.brake)
    kept = kept_on_the_bus(spec)
    level = ENERGY if what == "all" or np.any(kept > 0.0) else POWER
    drives = drives_of(
        ambient, cycle, demand, heating, motor, feed, leads=feed.leads if spec.resists else 0.0, kept=kept,
        limit=controller_current(parts.controller, ambient), error=error,
    )  # fmt: skip
    rows = np.flatnonzero(drives.course == 0.0)
    if len(rows):
        mean = np.where(np.isfinite(heating.winding), heating.winding, np.nan) - ambient
        drives = drives._replace(held=hottest(spec, cycle, heating, stresses, motor) - ambient, held_mean=mean)
    every = np.arange(len(drives.course))
    high = _moments(ambient, cycle, drives, feed, stresses.cold_voltage, level, every)
    if level == POWER:
        high = high._replace(stored=np.zeros_like(high.power))
    if not len(rows):
        return high, high
    low = held(drives, 0.0, 0.0)
    cold = _moments(ambient, cycle, low, feed, stresses.cold_voltage, level, rows)
    if level == POWER:
        cold = cold._replace(stored=high.stored[rows])
    steady = temperature_at_most(ambient, cycle, heating, stresses, motor)
    mean, steady = (np.broadcast_to(x, every.shape) for x in (heating.winding, steady))
    return between_bounds(high, cold, rows, mean, steady)


def decided(
    spec: RobotSpec,
    cycle: AtGearhead,
    demand: Demands,
    heating: Heat,
    stresses: Stress,
    parts: Parts,
    alive: NDArray[np.bool_],
    each: Collection[str] = (),
) -> Pair:
    """By bounds, and computed where these leave a limit open."""
    low, high = bounds(spec, cycle, demand, heating, stresses, parts)
    left = left_open(spec, (low, high), parts) & alive
    limits = waveform_limits(spec, high, high, parts)
    if {check.name for check in limits} & {*each}:
        left |= np.logical_or.reduce([~check.passed for check in limits])
    rows = np.flatnonzero(left & demand.complete)  # else it stays unknown whatever the waveform says
    if not len(rows):
        return low, high
    columns = on(demand, rows), on(heating, rows), on(stresses, rows), parts.on(rows)
    few = exact(spec, cycle.on(rows), *columns, "limits")
    return replaced(low, rows, few[0]), replaced(high, rows, few[1])


def left_open(spec: RobotSpec, found: Pair, parts: Parts) -> NDArray[np.bool_]:
    """Candidates that fail on no limit of the waveform by their bounds, and of which one may be met or not."""
    both = list(zip(*(waveform_limits(spec, side, side, parts) for side in found), strict=True))
    fails = np.logical_or.reduce([a.failed & b.failed for a, b in both])
    left = np.logical_or.reduce([(a.passed != b.passed) | (a.failed != b.failed) for a, b in both])
    return np.asarray(left & ~fails, bool)


def _moments(
    ambient: Any, cycle: AtGearhead, drives: Drive, feed: Feed, cold: Peak, level: int, rows: NDArray[np.int64]
) -> Moments:
    """Figures of some rows, with the voltage of a cold start, standby power and what the source adds."""
    count, total = len(drives.course), cycle.load_cycle.total
    feed = feed.broadcast(count).on(rows)
    ambient, total, volts, when = (np.broadcast_to(x, count)[rows] for x in (ambient, total, *cold))
    found, standby = evaluate(drives, cycle.load_cycle, level, rows), feed.stage.standby
    colder = volts > found.voltage
    return Moments(
        winding=found.winding + ambient,
        winding_time=found.winding_time,
        voltage=np.where(colder, volts, found.voltage),
        voltage_time=np.where(colder, when, found.voltage_time),
        copper=found.copper,
        power=of_the_source(found.power + standby, feed),
        power_time=found.power_time,
        drawn=found.drawn + found.source_heat + standby * total,
        returned=found.returned,
        stored=found.stored,
        above=found.above,
    )
