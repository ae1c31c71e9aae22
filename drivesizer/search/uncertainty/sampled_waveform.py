"""Figures that need the current of each moment, of one drive over many samples, and their bounds without it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.engine import MotorHeat, Simulation
from drivesizer.physics.cycle_at_gearhead import SPEED
from drivesizer.physics.heat_cycle import coolest_winding, winding_bounds
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import Feed
from drivesizer.physics.thermal import COPPER, TwoBodies, resistance_at, two_bodies
from drivesizer.physics.winding import Heat, Parts, Stress
from drivesizer.results.ratings import controller_current
from drivesizer.results.sizing import Check
from drivesizer.search.columns.limits_over_time import Moments, at_source, kept_on_the_bus
from drivesizer.search.uncertainty.sampled_battery import AtSamples, Draw

__all__ = ["Judged", "Side", "alike", "sampled_bounds", "warm_at_most", "weakest"]


# -- Samples in closed loop without a cycle that begins warm: figures that such a cycle does not exceed, without a run.
#
# A current that loops keep needs more voltage in a warmer winding, by the resistance that it gains. Twice the
# product of that and of the largest current is taken, and some per cent for what loops do otherwise around another
# resistance: ``tests/search/test_tolerances_loop.py`` holds simulations against it.


_TIMES = 2.0  # of the voltage that the gained resistance takes of the largest current
_VOLTAGE, _CURRENT = 1.02, 1.1  # by which voltage and current may differ besides


def warm_at_most(heat: MotorHeat, cold: Simulation, free: Simulation, start: Sequence[float]) -> Simulation:
    """A simulation from cold with figures that a cycle does not exceed which begins warm."""
    figures = free.figures
    hottest = max(start) + figures["winding_highest"] - heat.ambient  # as if nothing of the start were dissipated
    volts = figures["stage_voltage"]
    more = _TIMES * COPPER * heat.bodies.R_25 * (hottest - heat.ambient) * figures["current"]
    with_more = _VOLTAGE * volts + more
    drawn = _CURRENT * cold.figures["bus_current"] * (1.0 + more / np.where(volts > 0.0, volts, 1.0))
    changed = {"stage_voltage": with_more, "current_demand": _CURRENT * figures["current_demand"], "bus_current": drawn}
    return replace(free, figures={**figures, **changed})


class Judged(NamedTuple):
    """One machine against its limits in closed loop; each check passes or fails as with all simulations."""

    checks: tuple[Check, ...]  # with margins that are no smaller
    least: tuple[Check, ...]  # with margins that are no larger


def alike(checks: tuple[Check, ...]) -> Judged:
    """Checks with the margins of all simulations."""
    return Judged(checks, checks)


def weakest(found: Sequence[Judged]) -> str | None:
    """The check that fails most often, else that with the smallest margin in the mean."""
    failed = Counter(check.title for one in found for check in one.checks if check.status == "fail")
    if failed:
        return failed.most_common(1)[0][0]
    means, least = _mean_margins(one.checks for one in found), _mean_margins(one.least for one in found)
    title = min(means, key=lambda name: means[name], default="")
    sure = all(one.least is one.checks for one in found)
    return title if sure or all(means[title] < mean for name, mean in least.items() if name != title) else None


def _mean_margins(found: Iterable[tuple[Check, ...]]) -> dict[str, float]:
    """Mean of the margins of each check, by its title."""
    margins: dict[str, list[float]] = {}
    for several in found:
        for check in several:
            if check.margin == check.margin:
                margins.setdefault(check.title, []).append(check.margin)
    return {title: float(np.mean(some)) for title, some in margins.items()}


# -- Bounds of peaks and energy of one drive over many samples, without the winding's course.
#
# They decide whether a check passes in most samples; the kernel has the figures themselves. What a motor takes
# in the mean is
#
# .. math:: P = \overline{R I^2} + \overline{k_t w I} + |k_e - k_t|\,\overline{|w I|} + V_l \overline{|I|}
#
# with its winding nowhere cooler and nowhere warmer than it may be, or is permitted to be: of one that may fail by
# its heat the upper bounds say nothing, and its temperature does not pass. What it returns is no more than
# :math:`-k_e w I` wherever current and speed may be against each other in a segment. Symbols: R resistance [ohm], I
# current [A], w speed [rad/s], V_l loss of the stage per ampere [V].


Array = NDArray[np.float64]
_ROUNDING = 1e-9  # of a figure


class Side(NamedTuple):
    """Lower or upper bounds over the samples of one load case."""

    found: Moments
    draw: Draw  # of all drives together; of what is returned nothing, since what is drawn is the balance of both


def sampled_bounds(
    spec: Any, at: AtSamples, demand: Demands, heating: Heat, stresses: Stress, parts: Parts
) -> tuple[Side, Side] | None:
    """Lower and upper bounds of a drive in one load case."""
    motor, bodies = parts.motor, two_bodies(parts.motor)
    if spec.resists or not (demand.complete.all() and np.all(bodies.known)):
        return None
    feed, (T_low, T_high, coolest) = (
        spec.feed(parts.controller, parts.brake),
        _winding(spec, at, demand, heating, stresses, bodies),
    )
    warmest = np.fmin(T_high, motor["max_winding_temperature"])  # or it fails by its heat
    cold, cool, hot = (np.asarray(resistance_at(bodies.R_25, T)) for T in (spec.environment.ambient, coolest, warmest))
    current = at.line(demand.coefficients) / motor["torque_constant"]
    induced = at.speeds * (demand.back_emf * demand.total_ratio)
    volts = [np.abs(induced + ohm * current).max(axis=(0, 1)) for ohm in (cold, hot)]
    returned = _returned(at, current, induced)
    energy = _balance(spec, at, demand, motor, feed, (cool, hot), (current, returned))
    power = _power_at_most(at, demand, stresses, motor, feed, np.maximum(*volts))
    nothing = np.full(len(returned), np.nan)
    none = Moments(*[nothing] * len(Moments._fields))
    least = none._replace(winding=T_low * (1.0 - _ROUNDING), voltage=volts[0] * (1.0 - _ROUNDING))
    most = none._replace(winding=T_high * (1.0 + _ROUNDING), voltage=np.maximum(*volts) * (1.0 + _ROUNDING))
    most = most._replace(
        above=_above_at_most(at, current, controller_current(parts.controller, spec.environment.ambient))
    )
    stored = _stored_at_most(spec, energy[0], returned)
    idle = np.where(stored == 0.0, 0.0, np.nan)  # of more a bus of unknown capacitance is unknown, and does not fail
    sets, zero = spec.load.alike, np.zeros_like(nothing)
    return (
        Side(least._replace(stored=idle), Draw(energy[0] * sets, zero, zero)),
        Side(most._replace(stored=stored, power=power), Draw(energy[1] * sets, zero, power * sets)),
    )


def _winding(
    spec: Any, at: AtSamples, demand: Demands, heating: Heat, stresses: Stress, bodies: TwoBodies
) -> tuple[Array, Array, Array]:
    """Bounds of the winding's peak, and a temperature below which it is at no moment [K]."""
    ambient, total, fast = spec.environment.ambient, at.load_cycle.total, at.peak_speed
    loss = heating.friction * fast + heating.iron * fast**2
    rms, peak = demand.rms_current, stresses.current.value
    low, high = winding_bounds(bodies, ambient, rms, peak, total, heating.mean, loss)
    return low, high, coolest_winding(bodies, ambient, rms, total, heating.mean, low)


def _above_at_most(at: AtSamples, current: Array, limit: Array) -> Array:
    """No less than the time above a current [s]: all segments in which it is exceeded; NaN where it is unknown."""
    above = np.abs(current).max(axis=1) > limit
    lasting = (above * at.load_cycle.duration).sum(axis=0) if above.any() else np.zeros(current.shape[-1])
    return np.where(np.isnan(limit), np.nan, lasting)


def _power_at_most(at: AtSamples, demand: Demands, stresses: Stress, motor: Any, feed: Feed, volts: Array) -> Array:
    """No less than the largest power out of the source [W]: largest voltage and current, as if they coincided."""
    current = stresses.current.value
    beyond = 2.0 * np.abs(demand.surplus(motor["torque_constant"])) * at.peak_speed * current
    return at_source(current * volts * (1.0 + _ROUNDING) + beyond, stresses, feed)


def _stored_at_most(spec: Any, least: Array, returned: Array) -> Array:
    """No less than the energy that stays on the bus [J]; infinite where more may be returned than is drawn."""
    kept = np.broadcast_to(kept_on_the_bus(spec), returned.shape)
    return np.where(kept > 0.0, np.where(least > 0.0, kept * returned, np.inf), 0.0)


def _returned(at: AtSamples, current: Array, induced: Array) -> Array:
    """No less than what is returned over a cycle: by the ends of each segment at which both are most opposed [J]."""
    (a, b), (v, w) = current.swapaxes(0, 1), induced.swapaxes(0, 1)
    opposed = np.minimum(np.minimum(a * v, a * w), np.minimum(b * v, b * w))
    found: Array = (np.maximum(-opposed, 0.0) * at.load_cycle.duration).sum(axis=0) * (1.0 + _ROUNDING)
    return found


def _balance(
    spec: Any,
    at: AtSamples,
    demand: Demands,
    motor: Any,
    feed: Feed,
    R: tuple[Array, Array],
    flows: tuple[Array, Array],
) -> tuple[Array, Array]:
    """Energy that one drive draws less what its supply takes back, over a cycle [J]: bounds."""
    current, returned = flows
    duration, total = at.load_cycle.duration, at.load_cycle.total
    work = total * demand.total_ratio * at.mean_with(demand.coefficients, SPEED)
    square = total * demand.rms_current**2
    lasting = feed.stage.resistance * square + feed.stage.standby * total
    ends = np.abs(current[:, 0] + current[:, 1]), np.abs(current[:, 0]) + np.abs(current[:, 1])
    lost = [feed.stage.loss * (x * duration).sum(axis=0) / 2.0 for x in ends]
    low, high = (ohm * square + work + lasting + x for ohm, x in zip(R, lost, strict=True))
    high = high + _beyond(at, demand, motor["torque_constant"], current)
    high = high + (1.0 - np.asarray(spec.supply.regeneration)) * returned
    slack = _ROUNDING * (R[1] * square + np.abs(work) + lasting + lost[1])
    return low - slack, high + slack


def _beyond(at: AtSamples, demand: Demands, k_t: Array, current: Array) -> Array | float:
    """Energy lost by the difference of the windings' two constants, at most [J]."""
    surplus = np.abs(demand.surplus(k_t))
    if not (surplus > 0.0).any():
        return 0.0
    most = np.abs(at.speeds).max(axis=1) * np.abs(current).max(axis=1) * at.load_cycle.duration
    found: Array = surplus * most.sum(axis=0)
    return found
