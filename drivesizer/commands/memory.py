"""Memory of arrays that are done with is kept for the next ones.

Of sampled figures arrays of some megabytes come and go thousands of times. The C library returns each to the system,
which clears every page again before the next: half of the processor's time of a platform over tolerances.
"""

from __future__ import annotations

import os
import sys

__all__ = ["keep_freed_memory"]

# number of glibc's mallopt, its variable in the environment, bytes: the most that it takes, by its version
_LIMITS = (
    (-3, "MALLOC_MMAP_THRESHOLD_", (256 << 20, 32 << 20)),
    (-1, "MALLOC_TRIM_THRESHOLD_", (512 << 20,)),
)


def keep_freed_memory() -> None:
    """Have this process, and those that it starts, keep up to 512 MiB that they freed; where glibc allocates.

    What the environment says of it is left as it is.
    """
    if sys.platform != "linux":
        return
    import ctypes  # numpy loads it too

    library = ctypes.CDLL(None)
    for number, variable, sizes in _LIMITS if hasattr(library, "mallopt") else ():
        if variable not in os.environ:
            taken = next((size for size in sizes if library.mallopt(number, size)), None)
            os.environ |= {} if taken is None else {variable: str(taken)}
