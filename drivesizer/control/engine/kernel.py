"""The simulation as machine code; see ``machine_code``."""

from __future__ import annotations

from drivesizer.control.engine import layout, sample_loop
from drivesizer.files.machine_code import Kernel, defined_in
from drivesizer.kernel import heat

__all__ = ["KERNEL"]

_LAST = sample_loop.simulate_one
KERNEL = Kernel(
    functions=(*(f for f in defined_in((heat, sample_loop)) if f is not _LAST), _LAST),
    modules=(layout, heat, sample_loop),  # each calls only those before it
    inline=True,
    slow="the closed loop runs some hundred times slower",
    arguments="d1 d1 d1 d5 d4 d2 d1 d1 d2 d1 d2 b1 q1",
)
