"""What every benchmark of whole processes starts them with: caches of their own, which the first start fills.

Python keeps its compiled modules there too, whatever the surroundings say: installed packages have theirs from the
installer, a checkout's would be compiled anew at every start.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

__all__ = ["second_start"]


@contextmanager
def second_start() -> Iterator[Path]:
    """A folder, and in the environment of processes the caches in it."""
    with tempfile.TemporaryDirectory() as place:
        os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
        os.environ |= {"DRIVESIZER_CACHE": f"{place}/cache", "PYTHONPYCACHEPREFIX": f"{place}/modules"}
        yield Path(place)
