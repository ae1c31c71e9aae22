"""Memory that large arrays left goes back to the system, where a process keeps what it freed (``commands.memory``)."""

from __future__ import annotations

import ctypes
import sys

__all__ = ["give_back"]


def give_back() -> None:
    """Give back what is free, wherever it lies between what is in use; where glibc allocates."""
    if sys.platform == "linux":
        trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
        if trim is not None:
            trim(ctypes.c_size_t(0))
