"""A load cycle looked through as machine code; see ``machine_code``."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from drivesizer.files.machine_code import Kernel, defined_in, machine_code
from drivesizer.physics.groups import layout, look

__all__ = ["KERNEL", "compiled"]

KERNEL = Kernel(
    functions=defined_in((look,)),
    modules=(layout, look),
    inline=True,
    slow="long load cycles take some times longer",
    arguments="d0 d0 d1 d1 d1 d1 q1 d2 d3 q1 d3 d1",
)


@cache
def compiled() -> Callable[..., int] | None:
    """``look.look_through`` as machine code; None where it is not at hand."""
    return machine_code(KERNEL) if KERNEL.kept else None
