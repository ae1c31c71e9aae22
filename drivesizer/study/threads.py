"""Threads of a study's processes: one each, for there is one process for each core.

Loaded before NumPy, whose linear algebra takes as many threads as the environment says when it is loaded.
"""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["can_be_copied", "one_thread_each"]

_SINGLE = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


@contextmanager
def one_thread_each() -> Iterator[None]:
    """Let processes that start inside compute on one thread each, and this one where it has not loaded NumPy yet."""
    before = {name: os.environ.get(name) for name in _SINGLE}
    os.environ.update(dict.fromkeys(_SINGLE, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})


def can_be_copied() -> bool:
    """Whether this process can be copied: it has one thread, and its system copies what it has loaded.

    It is so inside of a ``one_thread_each`` that was there before NumPy.
    """
    single = all(os.environ.get(name) == "1" for name in _SINGLE)
    return sys.platform == "linux" and single and threading.active_count() == 1
