"""Environment of benchmarks of whole processes: caches of their own, filled by the first start.

Python keeps its compiled modules there too: installed packages have theirs from the installer, those of a checkout
would be compiled at every start.
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
