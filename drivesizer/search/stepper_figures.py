"""Figures of a stepper with its load that have no limit of their own."""

from __future__ import annotations

from math import pi

import numpy as np

from drivesizer.machine.pull_out import torque_of_part
from drivesizer.physics.stepper.starting import natural_frequency, start_speed_with
from drivesizer.results.check import Figure
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.problem import Problem

__all__ = ["STEPPER_ASSUMPTIONS", "stepper_figures"]

STEPPER_ASSUMPTIONS = (
    "gear and belt keep their catalogue efficiency, the maximum, at any torque, and driven backward as well",
    "a stepper's driver gives the current that it is set to, the rated one where control.phase_current gives none, and "
    "that of control.idle_current from the beginning of a rest; it loses 2 R I^2, at high speed less; holding and "
    "pull-out torque go with it, at high speed, where the voltage limits, they fall less",
    "pull-out torque is that of the printed curve of the highest voltage that the lowest supply reaches, compressed "
    "along the speed to a lower one; without a curve that of the ideal two-phase model times an estimated share",
    "a stepper's own friction is in its pull-out torque; losses of its driver are not counted",
    "rotor and load turn as one body: neither lost steps at a resonance nor a soft coupling are in the checks",
)

_TABLE = (
    ("energy", "Energy per cycle, all drives", "energy", "J"),
    ("returned", "Regenerated energy per cycle", "energy", "J"),
    ("power", "Largest supply power, all drives", "power", "W"),
    ("joule_heat", "Heat of both windings, mean", "power", "W"),
    ("peak_current", "Amplitude of the phase current to set", "current", "A"),
    ("winding_temperature", "Winding temperature, peak", "temperature", "degC"),
    ("pull_out_at_rest", "Pull-out torque at low speed", "torque", "N*m"),
    ("pull_out_at_speed", "Pull-out torque at the highest speed", "torque", "N*m"),
    ("step_rate", "Full steps per second at the highest speed", "frequency", "Hz"),
    ("natural_frequency", "Natural frequency with the load, held", "frequency", "Hz"),
    ("start_rate", "Full steps per second without a ramp, no load torque", "frequency", "Hz"),
)


def stepper_figures(problem: Problem, parts: DriveParts, values: dict[str, float]) -> tuple[Figure, ...]:
    """Figures of a drive with a stepper: what it draws, its step rates and how it swings with its load."""
    motor, cycle = parts.motor, problem.cases[0].cycle
    steps, total = 4.0 * motor.pole_pairs, parts.total_ratio
    rotor = motor.rotor_inertia
    inertia = parts.inertia() + float(cycle.inertia) / total**2
    fastest = float(np.abs(cycle.speed).max()) * total
    speeds, volts = np.array([0.0, fastest]), problem.spec.supply.lowest
    at_rest, at_speed = torque_of_part(problem.catalog, motor.part, speeds, volts).tolist()
    starts = start_speed_with(motor.start_speed, rotor, inertia, 0.0, motor.holding_torque)
    own = {
        "pull_out_at_rest": at_rest,
        "pull_out_at_speed": at_speed,
        "step_rate": fastest * steps / (2.0 * pi),
        "natural_frequency": float(natural_frequency(motor.pole_pairs, motor.holding_torque, inertia)),
        "start_rate": float(starts) * steps / (2.0 * pi),
    }
    found = values | own
    return tuple(Figure(name=n, title=t, value=found[n], kind=k, unit=u) for n, t, k, u in _TABLE)
