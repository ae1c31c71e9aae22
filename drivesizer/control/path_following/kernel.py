"""Simulation of a platform as machine code; see ``machine_code``."""

from __future__ import annotations

from drivesizer.control.path_following import kernel_layout, kernel_loop, slip
from drivesizer.files.machine_code import Kernel, defined_in

__all__ = ["KERNEL"]

KERNEL = Kernel(
    functions=(slip.grip, slip.grip_slope, *defined_in((kernel_loop,))),
    modules=(kernel_layout, slip, kernel_loop),
    inline=False,
    slow="the simulation of a platform runs some hundred times slower",
    arguments="d2 d2 d1 d2 d2 d2 d2 d1 d2 d2 d2 d1 d1 d0 d0 d0 d2 d2 d2 d1 d2 d3 d2 d1",
)
