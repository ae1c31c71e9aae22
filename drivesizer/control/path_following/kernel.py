"""Simulation of a platform as machine code; see ``machine_code``."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import drivesizer.control.path_following.kernel_layout as kernel_layout
import drivesizer.control.path_following.kernel_loop as kernel_loop
import drivesizer.control.path_following.slip as slip
from drivesizer.control.path_following import kernel_layout as at
from drivesizer.files.machine_code import Kernel, defined_in, machine_code

__all__ = ["KERNEL", "at", "compiled"]

KERNEL = Kernel(
    functions=(slip.grip, slip.grip_slope, *defined_in((kernel_loop,))),
    modules=(kernel_layout, slip, kernel_loop),
    inline=False,
    slow="the simulation of a platform runs some hundred times slower",
    arguments="d2 d2 d1 d2 d2 d2 d2 d1 d2 d2 d2 d1 d1 d0 d0 d0 d2 d2 d2 d1 d2 d3 d2 d1",
)


@cache
def compiled() -> Callable[..., int]:
    """``kernel_loop.follow_one`` as machine code."""
    return machine_code(KERNEL)
