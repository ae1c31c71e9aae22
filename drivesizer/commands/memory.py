"""Memory of arrays that are done with is kept for the next ones.

Of sampled figures arrays of some megabytes come and go thousands of times. The C library returns each to the system,
which clears every page again before the next: half of the processor's time of a platform over tolerances.
"""

from __future__ import annotations

import os
import sys

__all__ = ["keep_freed_memory"]

# number of glibc's mallopt, its variable in the environment, bytes: as large as it lets the second grow by itself
_LIMITS = ((-1, "MALLOC_TRIM_THRESHOLD_", 128 << 20), (-3, "MALLOC_MMAP_THRESHOLD_", 32 << 20))


def keep_freed_memory() -> None:
    """Have this process, and those that it starts, keep up to 128 MiB that they freed; where glibc allocates.

    What the environment says of it is left as it is.
    """
    if sys.platform != "linux":
        return
    import ctypes  # numpy loads it too

    library = ctypes.CDLL(None)
    for number, variable, size in _LIMITS if hasattr(library, "mallopt") else ():
        if variable not in os.environ:
            library.mallopt(number, size)
            os.environ[variable] = str(size)
