"""The march as machine code; see ``machine_code``."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import drivesizer.engine.controllers as controllers
import drivesizer.engine.limits as limits
import drivesizer.engine.loop as loop
import drivesizer.engine.modes as modes
import drivesizer.engine.places as places
import drivesizer.engine.steady as steady
import drivesizer.engine.steps as steps
import drivesizer.engine.tallies as tallies
import drivesizer.engine.warming as warming
from drivesizer.machine_code import Kernel, defined_in, machine_code

__all__ = ["KERNEL", "compiled", "kept"]

_COMPILED = (modes, tallies, steps, warming, limits, controllers, steady, loop)  # each calls only those before it
_LAST = loop.march_one
KERNEL = Kernel(
    functions=(*(f for f in defined_in(_COMPILED) if f is not _LAST), _LAST),
    modules=(places, *_COMPILED),
    inline=True,
    slow="numba is not installed: the closed loop runs some hundred times slower",
)


@cache
def compiled() -> Callable[..., int]:
    """``loop.march_one`` as machine code, kept in the user's cache folder; as plain Python without numba."""
    return machine_code(KERNEL)


def kept() -> bool:
    """Whether the march was compiled before by this numba; without numba it never is."""
    return KERNEL.kept
