"""Motor sets in closed loop along a reference: one with its course over time, or many at once.

Data in, data out: a ``Drive`` is a machine, a controller and what holds it back; a ``Task`` is what it is asked for. A
set starts in equilibrium at the first speed. Between samples the machine is exact (see ``linear_modes``); temperatures
move with the loss of each period, and the winding's resistance follows to 0.01 K.
Assumed: a reference or a load that has a corner between two samples takes it at the next one. Where the power turns
round twice within one sample, that is not seen; the bus sags by the current at the sample.

A cycle that is repeated is simulated until it ends as it began, to 1e-7 of full scale (1e-3 while the winding warms),
and those after it are added; a heated set's last is simulated again at its temperatures. With counts, or where
friction keeps a loop hunting, no cycle ends as it began: then until the sums of at least 4 cycles are those of the ones
before, to 2e-3. So the current's mean square, energies and heat are met to 5e-3, the temperatures at the end to 5e-3 of
their rise, and the largest values are those of the cycles that were simulated. A position's error that grows
from cycle to cycle goes on growing as it did. A stretch at one speed and load of some 260 000 samples and more is
simulated in the same way, unless it comes to rest: then it is carried exactly. So is a motion of which a task has as
long a stretch written out, 8 times and more in a row (see ``blocks``).
Symbols: I current [A], U voltage [V], w motor speed [rad/s], T temperature [K].
"""

from __future__ import annotations

from drivesizer.control.engine.batch import simulate, simulate_many
from drivesizer.control.engine.figures import FIGURES, Simulation
from drivesizer.control.engine.kernel import kept
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
    "kept",
    "simulate",
    "simulate_many",
]  # fmt: skip
