"""The simulation as machine code; see ``machine_code``."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import drivesizer.control.engine.layout as layout
import drivesizer.control.engine.sample_loop as sample_loop
import drivesizer.control.engine.steps as steps
from drivesizer.files.machine_code import Kernel, defined_in, machine_code

__all__ = ["KERNEL", "compiled", "is_compiled"]

_COMPILED = (steps, sample_loop)  # each calls only those before it
_LAST = sample_loop.simulate_one
KERNEL = Kernel(
    functions=(*(f for f in defined_in(_COMPILED) if f is not _LAST), _LAST),
    modules=(layout, *_COMPILED),
    inline=True,
    slow="the closed loop runs some hundred times slower",
    arguments="d1 d1 d1 d5 d4 d2 d1 d1 d2 d1 d2 b1 q1",
)


@cache
def compiled() -> Callable[..., int]:
    """``sample_loop.simulate_one`` as machine code."""
    return machine_code(KERNEL)


def is_compiled() -> bool:
    """Whether the simulation is at hand as machine code."""
    return KERNEL.kept
