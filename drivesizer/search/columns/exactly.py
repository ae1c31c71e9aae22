"""Peaks and heat over the waveform of candidates: of a short cycle as columns, of a long one drive by drive.

Both give the same figures; of a long cycle sums are added in another order.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.one_pass.drives import Figures, figures, is_long, through
from drivesizer.physics.power_stage import Feed, of_the_source
from drivesizer.physics.stress import Heat, Parts, Stress, on, temperature_at_most
from drivesizer.results.ratings import controller_current
from drivesizer.search.columns import limits_over_time
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
_LEVELS = {"winding": 0, "power": 1, "limits": 1, "all": 2}


def exact(
    spec: RobotSpec,
    cycle: AtGearhead,
    demand: Demands,
    heating: Heat,
    stresses: Stress,
    parts: Parts,
    what: Wanted = "all",
) -> Pair:
    """From the current of each moment and the winding's temperature then.

    Parameters
    ----------
    spec, cycle, demand, heating, stresses, parts, what
        As ``limits_over_time.exact`` takes them.

    Returns
    -------
    pair of Moments
        As ``limits_over_time.exact`` gives them.
    """
    if not is_long(cycle):
        return limits_over_time.exact(spec, cycle, demand, heating, stresses, parts, what)
    ambient, motor = spec.environment.ambient, parts.motor
    feed, kept = spec.feed(parts.controller, parts.brake), float(kept_on_the_bus(spec))
    wanted = 2 if what == "limits" and kept > 0.0 else _LEVELS[what]
    drives = figures(
        ambient, cycle, demand, heating, motor, feed, leads=feed.leads if spec.resists else 0.0, kept=kept,
        limit=controller_current(parts.controller, ambient), wanted=wanted,
    )  # fmt: skip
    feed = feed.broadcast(len(drives.table))
    high = _of_all(cycle, drives, feed, stresses, motor)
    if what in ("limits", "all") and not kept > 0.0:
        high = high._replace(stored=np.zeros(len(drives.table)))
    rows = np.flatnonzero(~drives.known)
    if not len(rows):
        return high, high
    mean = np.where(np.isfinite(heating.winding), heating.winding, np.nan)[rows]
    warm = drives.held(rows, hottest(spec, cycle, heating, stresses, motor)[rows], mean)
    cold = np.full(len(rows), ambient)
    few, of = feed.on(rows), on(stresses, rows)
    for name, found in _moments(cycle, warm, few, of)._asdict().items():
        if kept > 0.0 or name != "stored":
            getattr(high, name)[rows] = found
    low = _moments(cycle, drives.held(rows, cold, cold), few, of)
    if not kept > 0.0:
        low = low._replace(stored=high.stored[rows])
    steady = temperature_at_most(ambient, cycle, heating, stresses, motor)
    return between_bounds(high, low, rows, heating.winding, steady)


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
    if not is_long(cycle):
        return limits_over_time.time_above(spec, cycle, demand, parts)
    limit = controller_current(parts.controller, spec.environment.ambient)
    drives = figures(
        spec.environment.ambient, cycle, demand, heating, parts.motor, spec.feed(parts.controller, parts.brake),
        leads=0.0, kept=0.0, limit=limit, wanted=-1,
    )  # fmt: skip
    nothing = np.zeros(len(drives.table))
    return through(cycle, drives.held(slice(None), nothing, nothing)).above


def _of_all(cycle: AtGearhead, drives: Figures, feed: Feed, stresses: Stress, motor: object) -> Moments:
    """Of drives with a known course of temperatures; what runs away is as warm as permitted. NaN of the others."""
    count, known = len(drives.table), np.flatnonzero(drives.known)
    every = Moments(*np.full((len(Moments._fields), count), np.nan))
    some = drives._replace(table=drives.table[known], known=drives.known[known])
    found = _moments(cycle, some, feed.on(known), on(stresses, known))
    away = np.flatnonzero(np.isinf(found.winding))
    if len(away):
        permitted = np.asarray(motor["max_winding_temperature"])[known[away]]  # type: ignore[index]
        held = some.held(away, permitted, permitted)
        besides = _moments(cycle, held, feed.on(known[away]), on(stresses, known[away]))
        for name, column, values in zip(Moments._fields, found, besides, strict=True):
            if not name.startswith("winding"):
                column[away] = values
    for whole, column in zip(every, found, strict=True):
        whole[known] = column
    return every


def _moments(cycle: AtGearhead, drives: Figures, feed: Feed, stresses: Stress) -> Moments:
    """Figures that the pass finds, with the voltage of a cold start, standby power and what the source adds."""
    found, cold, standby = through(cycle, drives), stresses.cold_voltage, feed.stage.standby
    colder = cold.value > found.voltage
    return Moments(
        winding=found.winding,
        winding_time=found.winding_time,
        voltage=np.where(colder, cold.value, found.voltage),
        voltage_time=np.where(colder, cold.time, found.voltage_time),
        copper=found.copper,
        power=of_the_source(found.power + standby, feed),
        power_time=found.power_time,
        drawn=found.drawn + standby * cycle.load_cycle.total,
        returned=found.returned,
        stored=found.stored,
        above=found.above,
    )
