"""Simulation of a stepper as machine code; see ``machine_code``."""

from __future__ import annotations

from drivesizer.control.open_loop import layout, rotor
from drivesizer.files.machine_code import Kernel, defined_in

__all__ = ["KERNEL"]

KERNEL = Kernel(
    functions=defined_in((rotor,)),
    modules=(layout, rotor),
    inline=False,
    slow="the simulation of a stepper runs some hundred times slower",
    arguments="d1 d1 d2 d1 d2 d0 d0 d0",
)
