"""Peaks and heat over the waveform of candidates, from current and winding at each moment."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drivesizer.kernel.drives import drives_of, held
from drivesizer.kernel.evaluate import ENERGY, HEAT, POWER, evaluate
from drivesizer.kernel.records import Drive
from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import Feed, of_the_source
from drivesizer.physics.stress import Heat, Parts, Stress, on, temperature_at_most
from drivesizer.results.ratings import controller_current
from drivesizer.search.columns.limits_over_time import (
    Moments,
    Pair,
    Wanted,
    between_bounds,
    hottest,
    kept_on_the_bus,
)
from drivesizer.spec.robot import RobotSpec

__all__ = ["exact", "time_above"]

Array = NDArray[np.float64]


def exact(
    spec: RobotSpec,
    cycle: AtGearhead,
    demand: Demands,
    heating: Heat,
    stresses: Stress,
    parts: Parts,
    what: Wanted = "all",
) -> Pair:
    """Peaks and heat over the waveform, of candidates or of samples.

    Parameters
    ----------
    spec, cycle, demand, heating, stresses, parts
        The spec, its load cycle at the gearhead, and columns over candidates.
    what
        Which to compute: of the ``winding`` temperature, voltage and heat; its ``power`` and time of overload too;
        whatever has ``limits``, the bus among it; or ``all``, energy too.

    Returns
    -------
    pair of Moments
        The same where heat is known; else the demand with the winding cold, and as warm as it may be.
    """
    ambient, motor, feed = spec.environment.ambient, parts.motor, spec.feed(parts.controller, parts.brake)
    kept = kept_on_the_bus(spec)
    level = {"winding": HEAT, "power": POWER, "limits": ENERGY if np.any(kept > 0.0) else POWER, "all": ENERGY}[what]
    drives = drives_of(
        ambient, cycle, demand, heating, motor, feed, leads=feed.leads if spec.resists else 0.0, kept=kept,
        limit=controller_current(parts.controller, ambient),
    )  # fmt: skip
    rows = np.flatnonzero(drives.course == 0.0)
    if len(rows):
        mean = np.where(np.isfinite(heating.winding), heating.winding, np.nan) - ambient
        drives = drives._replace(held=hottest(spec, cycle, heating, stresses, motor) - ambient, held_mean=mean)
    high = _moments(ambient, cycle, drives, feed, stresses, level)
    if what == "limits" and level == POWER:
        high = high._replace(stored=np.zeros_like(high.power))
    if not len(rows):
        return high, high
    few = feed.broadcast(len(high.power)).on(rows)
    cold = _moments(ambient, cycle.on(rows), held(drives, 0.0, 0.0, rows), few, on(stresses, rows), level)
    if what == "limits" and level == POWER:
        cold = cold._replace(stored=high.stored[rows])
    steady = temperature_at_most(ambient, cycle, heating, stresses, motor)
    return between_bounds(high, cold, rows, heating.winding, steady)


def time_above(spec: RobotSpec, cycle: AtGearhead, demand: Demands, heating: Heat, parts: Parts) -> Array:
    """Longest uninterrupted time above the controller's continuous current, which the current alone decides.

    Parameters
    ----------
    spec, cycle, demand, heating, parts
        As ``exact`` takes them.

    Returns
    -------
    Array
        [s], shape (rows,).
    """
    ambient, feed = spec.environment.ambient, spec.feed(parts.controller, parts.brake)
    limit = controller_current(parts.controller, ambient)
    drives = drives_of(ambient, cycle, demand, heating, parts.motor, feed, limit=limit)
    found: Array = evaluate(held(drives, 0.0, 0.0), cycle.load_cycle, POWER).above
    return found


def _moments(
    ambient: Array | float, cycle: AtGearhead, drives: Drive, feed: Feed, stresses: Stress, level: int
) -> Moments:
    """Figures of the kernel with the voltage of a cold start, standby power and what the source adds."""
    found, cold, standby = evaluate(drives, cycle.load_cycle, level), stresses.cold_voltage, feed.stage.standby
    colder = cold.value > found.voltage
    return Moments(
        winding=found.winding + ambient,
        winding_time=found.winding_time,
        voltage=np.where(colder, cold.value, found.voltage),
        voltage_time=np.where(colder, cold.time, found.voltage_time),
        copper=found.copper,
        power=of_the_source(found.power + standby, feed),
        power_time=found.power_time,
        drawn=found.drawn + found.source_heat + standby * cycle.load_cycle.total,
        returned=found.returned,
        stored=found.stored,
        above=found.above,
    )
