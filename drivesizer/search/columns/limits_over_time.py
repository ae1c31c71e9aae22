"""Limits that need the winding or the current of each moment: by bounds where they decide, else exactly.

The winding is as warm as it is at each moment of the cycle in periodic steady state (``kernel``); its voltage is
checked cold, as it starts, too. Where a figure is missing that this needs, the winding is between the coldest and
the warmest that it may be, so that less data never looks better. Before the waveform come safe bounds from moments and
extremes alone: a winding in the long run at its RMS current and at its largest one. What they leave open is computed,
as is everything that is shown. Symbols: R resistance [ohm], I current [A], T temperature [K].
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Literal, NamedTuple, Unpack

import numpy as np

from drivesizer.kernel.cycle import ENERGY, POWER
from drivesizer.kernel.evaluate import at_rise, drives_of, evaluate
from drivesizer.kernel.records import Drive
from drivesizer.machine.supply_power import Draw
from drivesizer.physics.cycle_at_gearhead import SPEED, AtGearhead, Peak
from drivesizer.physics.drive_train import COMMUTATION_BAND, commutation
from drivesizer.physics.figures import Alike, Array, Figures, Mask, Range, Whole, on, put
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import Feed, bus_voltage, least_capacitance, of_the_source
from drivesizer.physics.thermal import resistance_25, resistance_at
from drivesizer.physics.winding import Heat, Parts, Stress, temperature_at_most, temperature_of_pulses, volts_of
from drivesizer.results.check_columns import CheckColumn, Options, at_most
from drivesizer.results.problem import Problem
from drivesizer.results.ratings import controller_current, controller_power_limit
from drivesizer.search.columns.limits import unknown_where_doubtful, waived, winding_limit
from drivesizer.spec.robot import RobotSpec

# what is computed from the waveform: nothing, what bounds leave open, peaks and heat of all drives, energies too
Waveform = Literal["bounds", "open", "limits", "all"]
_STAYS = "unknown: where it goes: give brake_resistor, supply.capacitance, or supply.accepts: all of a battery"
_LOSSES_IN_BAND = "at least: what controller and commutation take of the voltage is known within a band"
_AT_HIGHEST_VOLTAGE = "at the supply's highest voltage: the battery, which takes regenerated energy, is held to it"
_ROUNDING = 1e-9  # of a figure
_UNKNOWN_TIME = 1e-100  # s, more than nothing, of a time that is not known yet


class InCase(NamedTuple):
    """Demands of a load case on candidates, as columns."""

    spec: RobotSpec
    cycle: AtGearhead
    demand: Demands
    heating: Heat
    stresses: Stress

    def on(self, rows: Whole | Mask | slice) -> InCase:
        """Of some of them."""
        return InCase(self.spec, *on(self[1:], rows))


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


class Bounds(NamedTuple):
    """Ends between which the figures over a waveform lie."""

    low: Moments
    high: Moments


def cycle_figures(problem: Problem, draws: Sequence[Draw], **others: Array) -> dict[str, Array]:
    """Figures for objectives and records: energy of the first case, power in the hardest one, and others."""
    alike, machines = [case.spec.load.alike for case in problem.cases], problem.machine_cases
    consumption = np.sum([alike[i] * draws[i].drawn for i in machines[0]], 0)
    returned = np.sum([alike[i] * draws[i].returned for i in machines[0]], 0)
    power = [np.sum([alike[i] * draws[i].peak for i in wheels], 0) for wheels in machines]
    energy = consumption - problem.spec.supply.regeneration * returned
    return {"energy": energy, "returned": returned, "power": np.maximum.reduce(power), **others}


def least(pair: Bounds, case: InCase) -> Bounds:
    """The same; with incomplete demands only lower bounds are known: of the power what the load takes."""
    complete, cold = case.demand.complete, case.stresses.cold_voltage
    if complete.all():
        return pair
    low, high = (Moments(*(np.where(complete, column, np.nan) for column in side)) for side in pair)
    power = np.maximum(case.cycle.drawn_power, 0.0)
    lowest_known = {"winding": case.heating.winding, "voltage": cold.value, "voltage_time": cold.time, "power": power}
    filled = {name: np.where(complete, getattr(low, name), column) for name, column in lowest_known.items()}
    return Bounds(low._replace(**filled), high)


def waveform_limits(spec: RobotSpec, low: Moments, high: Moments, parts: Parts) -> list[CheckColumn]:
    """Bounds over the waveform against the limits; all drives draw from one supply."""
    supply, sets, controller = spec.supply, spec.load.motors, parts.controller
    torque = spec.margins.torque
    winding, warmest, above, power, at_power = (
        Range(getattr(low, name), getattr(high, name))
        for name in ("winding", "winding_time", "above", "power", "power_time")
    )
    bus = Range(_bus_voltage(spec, low, controller).low, _bus_voltage(spec, high, controller).high)
    note = _AT_HIGHEST_VOLTAGE if spec.battery and spec.accepts_all else ""
    checks = [
        winding_limit(spec, winding, parts.motor, warmest),
        voltage_limit(spec, low, high, controller),
        waived(spec, at_most("controller_peak_time", above, controller["peak_time"])),
        bus_limit(spec, bus, controller["supply_max"], undecided=_STAYS, note=note),
        controller_power_limit(power, controller, supply.highest, needed=torque, time=at_power),
    ]  # fmt: skip
    if supply.current is not None:
        current = Range(*(end * sets / supply.lowest for end in power))
        checks.append(at_most("supply_current", current, supply.most_current, needed=torque, time=at_power))
    if supply.power is not None:
        checks.append(at_most("supply_power", Range(*(end * sets for end in power)), supply.power, needed=torque,
                              time=at_power))  # fmt: skip
    return checks


def known_limits(case: InCase, pair: Bounds, parts: Parts) -> list[CheckColumn]:
    """The same, unknown where a demand is."""
    return unknown_where_doubtful(waveform_limits(case.spec, *pair, parts), case.demand.complete)


def voltage_limit(spec: RobotSpec, low: Moments, high: Moments, controller: Figures) -> CheckColumn:
    """Bounds of the motor's voltage against what supply and controller leave of it."""
    volts, time = Range(low.voltage, high.voltage), Range(low.voltage_time, high.voltage_time)
    usable = spec.feed(controller).usable_range
    return at_most("supply_voltage", volts, usable, needed=spec.margins.speed, time=time, undecided=_LOSSES_IN_BAND)


def bus_limit(spec: RobotSpec, bus: Alike, limit: Alike, **more: Unpack[Options]) -> CheckColumn:
    """Highest voltage of the bus against the controller's limit."""
    if spec.on_common_bus:
        return at_most("common_bus_voltage", bus, limit, by_choice=True)
    return at_most("bus_voltage", bus, limit, **more)


def kept_on_the_bus(spec: RobotSpec) -> Alike:
    """Share of the returned energy that the supply does not accept: it has to stay on the bus."""
    share = 1.0 - np.asarray(spec.supply.regeneration)
    return 0.0 * share if spec.accepts_all else share


def _bus_voltage(spec: RobotSpec, moments: Moments, controller: Figures) -> Range:
    """Highest voltage of the bus, with the energy that the supply does not accept in its capacitance [V].

    Where the supply accepts all, it stays at its highest: a battery is held to that at the largest return, with the
    charge of the start (``energy_checks``). An unknown capacitance is at least that of the controller: a voltage that
    passes with so little is certain, one that does not is unknown. A chopper lets it rise to its own voltage at most.
    """
    supply, chopper = spec.supply, spec.chopper_voltage
    if supply.capacitance is not None:
        raised: Array = bus_voltage(supply.highest, moments.stored * spec.load.motors, supply.capacitance)
        raised = raised if chopper is None else np.minimum(raised, np.maximum(chopper, supply.highest))
        return Range(raised, raised)
    if chopper is not None:
        voltage = np.where(moments.stored == 0.0, supply.highest, np.maximum(chopper, supply.highest))
        voltage = np.where(np.isnan(moments.stored), np.nan, voltage)
        return Range(voltage, voltage)
    least = least_capacitance(controller["continuous_current"], supply.highest)
    with np.errstate(divide="ignore", invalid="ignore"):
        bound = bus_voltage(supply.highest, moments.stored, least)  # each controller stores its own motor's return
    return Range(np.where(moments.stored == 0.0, supply.highest, np.nan),
                 np.where(moments.stored == 0.0, supply.highest, bound))  # fmt: skip


def bounds(case: InCase, parts: Parts) -> Bounds:
    """Lower and upper bounds over the waveform; upper ones of windings that pass."""
    spec, cycle, demand, heating, stresses = case
    motor, feed, ambient = parts.motor, spec.feed(parts.controller, parts.brake), spec.environment.ambient
    warmest = temperature_at_most(ambient, cycle, heating, stresses, motor)
    warmest = np.minimum(warmest, temperature_of_pulses(ambient, cycle, demand, heating, motor))
    hot = _hottest_resistance(warmest, motor)
    low = lowest(case, parts)
    k_t, current = motor["torque_constant"], stresses.current.value
    at_hot = np.maximum(cycle.peak(volts_of(demand, k_t, hot), demand.left_out).value, low.voltage)
    volts = at_hot
    if spec.resists:
        volts = np.maximum(at_hot, cycle.peak(volts_of(demand, k_t, hot + feed.leads), demand.left_out).value)
    limit, total = controller_current(parts.controller, ambient), cycle.load_cycle.total
    with np.errstate(divide="ignore", invalid="ignore"):  # what is exceeded so long has that mean square
        longest = total * np.minimum(np.square(demand.rms_current / limit) * (1.0 + _ROUNDING), 1.0)
    volts = volts + COMMUTATION_BAND[1] * commutation(motor) * demand.total_ratio * cycle.peak_speed * current
    beyond = 2.0 * np.abs(demand.surplus(k_t)) * cycle.peak_speed * current  # where two constants differ
    power = current * at_hot + np.where(np.isnan(beyond), np.inf, beyond)
    high = low._replace(
        winding=warmest, voltage=volts, above=np.where(low.above > 0.0, longest, low.above),
        power=of_the_source(power + feed.lost(current) + feed.stage.standby, feed),
        stored=_most_kept(case, motor),
    )  # fmt: skip
    return Bounds(low, high)


def _hottest_resistance(warmest: Array, motor: Figures) -> Array:
    """Resistance of a winding as warm as it may be, or as warm as it fails by its heat."""
    return np.asarray(resistance_at(resistance_25(motor), _permitted(warmest, motor)))


def lowest(case: InCase, parts: Parts) -> Moments:
    """Lower bounds over the waveform, of candidates with their controllers, or with each of a column of controllers."""
    current = case.stresses.current.value
    limit = controller_current(parts.controller, case.spec.environment.ambient)
    unknown = np.full_like(current, np.nan)
    return Moments(*[unknown] * len(Moments._fields))._replace(
        winding=case.heating.winding,
        voltage=case.stresses.cold_voltage.value,
        above=np.where(current > limit, _UNKNOWN_TIME, np.where(np.isnan(current) | np.isnan(limit), np.nan, 0.0)),
        power=np.zeros_like(current),
        stored=_least_kept(case, parts),
    )


def _least_kept(case: InCase, parts: Parts) -> Array:
    r"""Less than the energy that stays on the bus [J]: what a stretch of hard braking leaves of it.

    .. math:: E \ge -(1 - s) W_- - \int k_t w I + R I^2 + R_b I^2 + V_l |I| + |k_t - k_e| |w I| \, dt

    with a winding as warm as it may be, the share s that is kept, and work W_- of all that brakes.
    """
    spec, cycle, demand, heating, stresses = case
    share, energy = kept_on_the_bus(spec), np.zeros_like(demand.rms_current)
    if not share > 0.0 or not cycle.base.hardest_braking:
        return energy
    motor, stage = parts.motor, spec.feed(parts.controller).stage
    hot = _hottest_resistance(temperature_at_most(spec.environment.ambient, cycle, heating, stresses, motor), motor)
    c, ratio = demand.coefficients * cycle.scale, demand.total_ratio * cycle.belt
    apart = np.abs(demand.surplus(motor["torque_constant"])) * cycle.belt
    for together, against, total in cycle.base.hardest_braking:
        square = np.maximum(((c @ together) * c).sum(axis=1), 0.0) / motor["torque_constant"] ** 2  # A^2*s
        lost = (hot + stage.resistance) * square + stage.least_loss * np.sqrt(total * square)
        lost = lost + apart * np.sqrt(together[SPEED, SPEED] * square)
        E = -ratio * (c @ together[:, SPEED]) - lost - (1.0 - share) * ratio * (c @ against)
        energy = np.fmax(E * (1.0 - _ROUNDING), energy)
    return energy


def _permitted(temperature: Array, motor: Figures) -> Array:
    """Temperature that a winding does not exceed, or fails by its heat: with it a demand is a safe bound."""
    return np.fmin(np.where(np.isfinite(temperature), temperature, np.nan), motor["max_winding_temperature"])


def _most_kept(case: InCase, motor: Figures) -> Array:
    """More than the energy that stays on the bus [J]: all that is returned over a cycle and not accepted.

    Infinite where more may be returned than is drawn, or that is unknown.
    """
    (spec, cycle, demand, *_), share = case, kept_on_the_bus(case.spec)
    if not share > 0.0:
        return np.zeros_like(demand.rms_current)
    ratio, c, acting = demand.total_ratio, demand.coefficients, np.flatnonzero(cycle.base.braked)
    returned = ratio * cycle.belt * ((c * cycle.scale)[:, acting] @ cycle.base.braked[acting])
    heat = np.asarray(resistance_at(resistance_25(motor), spec.environment.ambient)) * demand.rms_current**2
    work = ratio * cycle.mean_with(c, SPEED)
    draws = heat + work > _ROUNDING * (heat + np.abs(work))  # mean power at least
    return np.where(draws, share * returned * (1.0 + _ROUNDING), np.inf)


def exact(
    case: InCase,
    parts: Parts,
    what: Waveform = "all",
    error: float = 1e-3,
    band: tuple[float, float] = COMMUTATION_BAND,
) -> Bounds:
    """Peaks and heat over the waveform, of candidates over one cycle or of samples each over its own.

    A winding of unknown heat is between one as cold as the ambient and one as warm as it may be. Commutation takes of
    the voltage what lies in a band; of samples, which have a factor each, that alone.
    """
    spec, cycle, demand, heating, stresses = case
    ambient, motor, feed = spec.environment.ambient, parts.motor, spec.feed(parts.controller, parts.brake)
    share = kept_on_the_bus(spec)
    level = ENERGY if what == "all" or np.any(share > 0.0) else POWER
    drives = drives_of(
        ambient, cycle, demand, heating, motor, feed, leads=feed.leads if spec.resists else 0.0, bus_share=share,
        limit=controller_current(parts.controller, ambient), error=error, band=band, cold=spec.once,
    )  # fmt: skip
    all_rows, rows = np.arange(len(drives.course)), np.flatnonzero(drives.course == 0.0)
    if not len(rows):
        return _moments(ambient, cycle, drives, feed, stresses.cold_voltage, level, all_rows)
    warmest = np.broadcast_to(temperature_at_most(ambient, cycle, heating, stresses, motor), all_rows.shape)
    mean = np.broadcast_to(heating.winding, all_rows.shape)
    held_mean = np.where(np.isfinite(mean), mean, np.nan) - ambient
    drives = drives._replace(rise=_permitted(warmest, motor) - ambient, mean_rise=held_mean)
    least_of, high = _moments(ambient, cycle, drives, feed, stresses.cold_voltage, level, all_rows)
    cold, _ = _moments(ambient, cycle, at_rise(drives, 0.0, 0.0), feed, stresses.cold_voltage, level, rows)
    low = Moments(*(column.copy() for column in least_of))
    for name in ("voltage", "voltage_time", "power", "power_time"):
        getattr(low, name)[rows] = getattr(cold, name)
    high.stored[rows] = cold.stored  # the more the winding takes, the less is regenerated
    low.winding[rows], high.winding[rows] = mean[rows], warmest[rows]
    return Bounds(low, high)


def over_waveform(
    case: InCase, parts: Parts, what: Waveform, alive: Mask, exact_checks: Collection[str] = ()
) -> Bounds:
    """Peaks and heat over the waveform, of what is ``alive``: by bounds, and as far as that is wanted computed."""
    if what in ("limits", "all"):
        return least(exact(case, parts, what), case)
    pair, spec = bounds(case, parts), case.spec
    if what == "open":
        limits = waveform_limits(spec, *pair, parts)
        in_full = not {check.name for check in limits}.isdisjoint(exact_checks)
        eligible = case.demand.complete & (alive | in_full)  # else it stays unknown whatever the waveform says
        decided = np.logical_and.reduce([check.passed for check in limits])
        if not in_full:  # what fails by its bounds is left as it is
            decided |= np.logical_or.reduce([check.failed for check in limits])
        rows = np.flatnonzero(eligible & ~decided)
        few, own = parts.on(rows), on(pair, rows)
        left = left_open(spec, own, few) & alive[rows]
        if in_full:
            left |= ~np.logical_and.reduce([check.passed for check in waveform_limits(spec, own.high, own.high, few)])
        if left.any():
            pair = put(pair, rows[left], exact(case.on(rows[left]), few.on(left), "limits"))
    return least(pair, case)


def left_open(spec: RobotSpec, pair: Bounds, parts: Parts) -> Mask:
    """Candidates that fail on no limit of the waveform by their bounds, and of which one may be met or not."""
    ends = list(zip(*(waveform_limits(spec, side, side, parts) for side in pair), strict=True))
    fails = np.logical_or.reduce([a.failed & b.failed for a, b in ends])
    left = np.logical_or.reduce([(a.passed != b.passed) | (a.failed != b.failed) for a, b in ends])
    return np.asarray(left & ~fails, bool)


def _moments(
    ambient: Alike, cycle: AtGearhead, drives: Drive, feed: Feed, cold: Peak, level: int, rows: Whole
) -> Bounds:
    """Figures of some rows, with the voltage of a cold start, standby power and what the source adds.

    Commutation takes the least and the most of the voltage.
    """
    count, total = len(drives.course), cycle.load_cycle.total
    feed = feed.broadcast(count).on(rows)
    ambient, total, volts, when = (np.broadcast_to(x, count)[rows] for x in (ambient, total, *cold))
    figures, standby = evaluate(drives, cycle.load_cycle, level, rows), feed.stage.standby
    ends = (figures.least_voltage, figures.least_voltage_time), (figures.voltage, figures.voltage_time)
    (low, when_low), (top, when_high) = (
        (np.where(volts > V, volts, V), np.where(volts > V, when, t)) for V, t in ends
    )  # fmt: skip
    high = Moments(
        winding=figures.winding + ambient,
        winding_time=figures.winding_time,
        voltage=top,
        voltage_time=when_high,
        copper=figures.copper,
        power=of_the_source(figures.power + standby, feed),
        power_time=figures.power_time,
        drawn=figures.drawn + figures.source_heat + standby * total,
        returned=figures.returned,
        stored=np.zeros_like(figures.power) if level == POWER else figures.stored,
        above=figures.above,
    )
    return Bounds(high._replace(voltage=low, voltage_time=when_low), high)
