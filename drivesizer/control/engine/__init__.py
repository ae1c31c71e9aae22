"""Simulation of drives in closed loop along a reference: one with its time series, or many at once.

Data in, data out: a ``Drive`` is a drive train with its controller and limits; a ``Task`` is the required motion and
load. A drive starts in equilibrium at the first speed. Between samples the drive train is exact (see ``linear_modes``);
temperatures move with the loss of each period, and the winding's resistance follows to 0.01 K.
Assumed: a corner of reference or load between two samples takes effect at the next one. Two reversals of power within
one sample are not seen; the bus sags by the current at the sample.

A repeated cycle is simulated until it ends as it began, to 1e-7 of full scale (1e-3 while the winding warms), and the
cycles after it are added; with heat, the last one is simulated again at its temperatures. With counts, or where
friction keeps a loop hunting, no cycle ends as it began: then until the sums of at least 4 cycles equal those before,
to 2e-3. So the current's mean square, energies and heat are met to 5e-3, the temperatures at the end to 5e-3 of their
rise, and the largest values are those of the simulated cycles. A position error that grows from cycle to cycle is
extrapolated. A stretch of some 260 000 samples and more at one speed and load is treated likewise, or carried exactly
where it settles; so is a motion that a task has written out 8 times and more in a row (see ``blocks``).
Symbols: I current [A], U voltage [V], w motor speed [rad/s], T temperature [K].
"""

from __future__ import annotations

from drivesizer.control.engine.batch import FIGURES, Simulation, simulate, simulate_many
from drivesizer.control.engine.kernel import is_compiled
from drivesizer.control.engine.task import CurrentLimit, Drive, MotorHeat, Resolution, Supply, Task

__all__ = [
    "FIGURES",
    "CurrentLimit",
    "Drive",
    "MotorHeat",
    "Resolution",
    "Simulation",
    "Supply",
    "Task",
    "is_compiled",
    "simulate",
    "simulate_many",
]  # fmt: skip
