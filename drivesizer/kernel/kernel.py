"""The loops over cycles as machine code; see ``machine_code``."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from drivesizer.files.machine_code import Kernel, defined_in, machine_code
from drivesizer.kernel import cycle, heat, records

KERNEL = Kernel(
    functions=defined_in((heat, cycle)),
    modules=(records, heat, cycle),
    inline=True,
    slow="sizing takes some hundred times longer",
    arguments="d2 d2 d1 d1 d1 d1 q2 q1 q1 d2",
)


@cache
def compiled() -> Callable[..., int]:
    """``cycle.evaluate_rows`` as machine code."""
    return machine_code(KERNEL)
