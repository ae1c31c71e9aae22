"""The pass over a long cycle as machine code; see ``machine_code``."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from drivesizer.files.machine_code import Kernel, defined_in, machine_code
from drivesizer.physics.groups import look
from drivesizer.physics.one_pass import feeding, heating, layout, pieces, through

__all__ = ["KERNEL", "compiled"]

KERNEL = Kernel(
    functions=(look.below, *defined_in((heating, feeding, pieces, through))),
    modules=(layout, look, heating, feeding, pieces, through),
    inline=True,
    slow="long load cycles take some times longer",
    arguments="d1 d1 d1 d2 d1 d1 d1 d1 q1",
)


@cache
def compiled() -> Callable[..., int] | None:
    """``through.pass_over`` as machine code; None where it is not at hand."""
    return machine_code(KERNEL) if KERNEL.kept else None
