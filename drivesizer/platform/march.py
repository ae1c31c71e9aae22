"""The march of a platform as machine code, where numba is installed; as plain Python without it."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import drivesizer.platform.march_forces as march_forces
import drivesizer.platform.march_loop as march_loop
import drivesizer.platform.march_places as march_places
import drivesizer.platform.march_step as march_step
import drivesizer.platform.slip as slip
from drivesizer.machine_code import Kernel, defined_in, machine_code
from drivesizer.platform import march_places as at

__all__ = ["KERNEL", "at", "compiled"]

KERNEL = Kernel(
    functions=(slip.grip, slip.grip_slope, *defined_in((march_forces, march_step, march_loop))),
    modules=(march_places, slip, march_forces, march_step, march_loop),
    inline=False,
    slow="numba is not installed: a platform's march runs some hundred times slower",
)


@cache
def compiled() -> Callable[..., int]:
    """``march_loop.follow_one`` as machine code, kept in the user's cache folder; as plain Python without numba."""
    return machine_code(KERNEL)
