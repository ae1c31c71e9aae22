"""Peaks and heat over the waveform of candidates, from current and winding at each moment.

Where no more is wanted than which limits are met, of candidates that bounds leave open.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.kernel.drives import drives_of, held
from drivesizer.kernel.evaluate import ENERGY, POWER, evaluate
from drivesizer.kernel.records import Drive
from drivesizer.physics.cycle_at_gearhead import AtGearhead, Peak
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import Feed, of_the_source
from drivesizer.physics.stress import Heat, Parts, Stress, on, replaced, temperature_at_most
from drivesizer.results.ratings import controller_current
from drivesizer.search.columns.limits_over_time import (
    Moments,
    Pair,
    Wanted,
    between_bounds,
    hottest,
    kept_on_the_bus,
    waveform_limits,
)
from drivesizer.search.columns.waveform_bounds import bounds
from drivesizer.spec.robot import RobotSpec

__all__ = ["decided", "exact", "left_open"]

Array = NDArray[np.float64]


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
