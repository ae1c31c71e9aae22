"""Simulation of a stepper as machine code, where numba is installed; as plain Python without it."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from drivesizer.control.open_loop import layout, rotor
from drivesizer.files.machine_code import Kernel, defined_in, machine_code

__all__ = ["KERNEL", "compiled"]

KERNEL = Kernel(
    functions=defined_in((rotor,)),
    modules=(layout, rotor),
    inline=False,
    slow="numba is not installed: the simulation of a stepper runs some hundred times slower",
    arguments="d1 d1 d2 d1 d2 d0 d0 d0",
)


@cache
def compiled() -> Callable[..., int]:
    """``rotor.turn_rotor`` as machine code, kept in the user's cache folder; as plain Python without numba."""
    return machine_code(KERNEL)
