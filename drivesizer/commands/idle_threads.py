"""Threads of the linear algebra sleep while they have nothing to do.

OpenBLAS, which NumPy brings, starts a thread for every further core as it is loaded. Each of them then looks for work
in a loop, for 2**26 ticks of the processor's clock, before it sleeps: some 30 ms of processor time a core, more than a
twentieth of a ``drivesizer size`` on two of them, which has no work for them at all.
"""

from __future__ import annotations

import os

__all__ = ["let_idle_threads_sleep"]

_SOONEST = "4"  # power of two of ticks, the least that it takes


def let_idle_threads_sleep() -> None:
    """Have threads of OpenBLAS sleep at once when they are done, in this process and those that it starts.

    Before NumPy is loaded. They are as many as before and compute the same; what the environment says of it is left.
    """
    os.environ.setdefault("OPENBLAS_THREAD_TIMEOUT", _SOONEST)
