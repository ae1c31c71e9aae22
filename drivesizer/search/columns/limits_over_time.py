"""Limits that need the winding or the current of each moment: temperature, voltage, supply, bus, time of overload.

The winding is as warm as it is at each moment of the cycle in periodic steady state (``kernel``); its voltage
is checked cold, as it starts, too. Where a figure is missing that this needs, a check passes by the warmest that the
winding may be and fails by the coldest, so that less data never looks better (``checks.between``).
Before the waveform come safe bounds from moments and extremes alone (``waveform_bounds``).
Symbols: R resistance [ohm], I current [A], T temperature [K].
"""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import bus_voltage, least_capacitance
from drivesizer.physics.stress import Heat, Parts, Stress, temperature_at_most
from drivesizer.results.check_columns import CheckColumn, at_most, between
from drivesizer.results.ratings import controller_power_limit
from drivesizer.search.columns.limits import waived, winding_limit
from drivesizer.spec.robot import RobotSpec

__all__ = [
    "WAVEFORM_LIMITS",
    "Exactly",
    "Moments",
    "Pair",
    "Wanted",
    "between_bounds",
    "bus_limit",
    "hottest",
    "kept_on_the_bus",
    "least",
    "warmest_passing",
    "waveform_limits",
]

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
