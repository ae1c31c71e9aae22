"""Drives that a battery certainly cannot feed for long enough, by a lower bound of their power without a waveform.

A motor's mean power is no less than with its winding at the ambient's temperature all the time,

.. math:: P \\ge R_{cold} I_{rms}^2 + \\overline{\\tau w}

for a winding in use is warmer, and what the makers' two constants differ by is lost (``waveform.balanced``). A
controller draws no less than it passes on and gives back no more than it is given, of which no more than all is kept.
So whatever the controller is, the battery gives that power in the mean. Both terms follow from the moments of the load
cycle, over as many drives as there are.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drivesizer.load_cases.trip import distance_of
from drivesizer.physics.cycle_at_gearhead import SPEED
from drivesizer.physics.motor_demand import demands
from drivesizer.physics.stress import Parts, heat
from drivesizer.physics.thermal import resistance_25, resistance_at
from drivesizer.results.check_kinds import BATTERY_LASTING
from drivesizer.results.problem import Problem
from drivesizer.search.columns.candidates import Candidates, Rows
from drivesizer.search.columns.offers import Offers, offers
from drivesizer.search.columns.stages import brakes_of, encoders_of, felt
from drivesizer.search.uncertainty.sampled_battery import Draw, columns_of, feeding
from drivesizer.spec.mounting import loss_at_flange

__all__ = ["battery_failures", "least_power"]

Array = NDArray[np.float64]
_ROUNDING = 1e-9  # of a figure


def battery_failures(problem: Problem, sets: Candidates) -> dict[str, NDArray[np.bool_]]:
    """The drives that certainly fail on autonomy or range of the battery; empty where neither is required."""
    found = dict[str, NDArray[np.bool_]]()
    battery = problem.spec.battery
    if battery is None:
        return found
    for numbers in problem.machine_cases:
        case, cycle = problem.cases[numbers[0]].spec, problem.cases[numbers[0]].cycle
        least = np.sum([problem.cases[n].spec.load.alike * least_power(problem, n, sets) for n in numbers], axis=0)
        energy = cycle.total * (least - _ROUNDING * np.abs(least))
        draw, alone = Draw(energy, np.zeros_like(energy), np.full_like(energy, np.nan)), np.ones_like(energy)
        speed = alone * distance_of(case, cycle) / cycle.total
        feeds = feeding(case, battery, problem.catalog)
        for check in columns_of(case, feeds, cycle.total, speed, [draw]):
            if check.name in BATTERY_LASTING:
                found[check.name] = found.get(check.name, False) | check.failed
    return found


def least_power(problem: Problem, number: int, sets: Candidates) -> Array:
    """Lower bound of a motor's mean power over a load case [W]; NaN where the waveform's power is unknown."""
    found, offered = np.empty(len(sets.motor)), offers(problem)
    for belt in np.unique(sets.belt).tolist():
        rows = np.flatnonzero(sets.belt == belt)
        found[rows] = _behind(problem, offered, number, belt, sets.on(rows))
    return found


def _behind(problem: Problem, offered: Offers, number: int, belt: float, sets: Candidates) -> Array:
    """The same of drives behind one belt."""
    cycles = [case.at_belt.behind(belt) for case in problem.cases]
    catalog, ambient = problem.catalog, problem.cases[number].spec.environment.ambient
    motor, gearhead = Rows(catalog.motors, sets.motor), Rows(catalog.gearheads, sets.gearhead)
    encoder = Rows(catalog.encoders, encoders_of(problem, offered, cycles, sets.motor, gearhead["ratio"]))
    brake = brakes_of(problem, offered, cycles, Parts(motor, gearhead, encoder, None), sets.brake)
    braked = felt(cycles[number], Parts(motor, gearhead, encoder, None, brake))
    demand = demands(cycles[number], motor, gearhead, encoder, braked)
    cold = np.asarray(resistance_at(resistance_25(motor), ambient))
    turning = demand.total_ratio * (demand.coefficients @ cycles[number].moments[:, SPEED])
    at_flange = loss_at_flange(problem.cases[number].spec, cycles[number], gearhead)
    winding = heat(ambient, cycles[number], demand, motor, from_gearhead=at_flange).winding
    known = demand.complete & np.isfinite(winding) & np.isfinite(motor["max_winding_temperature"])
    return np.where(known, cold * demand.rms_current**2 + turning, np.nan)
