"""The march of a platform as machine code, where numba is installed; as plain Python without it."""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any

import drivesizer.platform.march_forces as march_forces
import drivesizer.platform.march_loop as march_loop
import drivesizer.platform.march_places as march_places
import drivesizer.platform.march_step as march_step
import drivesizer.platform.slip as slip
from drivesizer.catalog.cache import digest_of, folder
from drivesizer.engine.compilation import SlowWarning
from drivesizer.platform import march_places as at

__all__ = ["at", "compiled"]

_COMPILED: tuple[Any, ...] = (
    slip.grip,
    slip.grip_slope,
    march_forces.rolling,
    march_forces.gripping,
    march_forces.grips,
    march_forces.casters,
    march_forces.loads,
    march_forces.wheel_forces,
    march_forces.forces,
    march_step.assemble,
    march_step.close,
    march_step.solve,
    march_step.arrow,
    march_step.moved,
    march_step.off,
    march_step.once,
    march_step.advance,
    march_loop.correct,
    march_loop.command,
    march_loop.hold,
    march_loop.note,
    march_loop.follow_one,
)  # fmt: skip  - each calls only those before it
_SOURCES = (march_places, slip, march_forces, march_step, march_loop)


@cache
def compiled() -> Callable[..., int]:
    """``march_loop.follow_one`` as machine code, kept in the user's cache folder; as plain Python without numba.

    Warns
    -----
    SlowWarning
        When numba is not installed.
    """
    try:
        import numba
    except ImportError:
        warnings.warn(
            "numba is not installed: a platform's march runs some hundred times slower", SlowWarning, stacklevel=2
        )
        return march_loop.follow_one
    config: Any = numba.config
    place, before = _folder(numba.__version__), config.CACHE_DIR
    try:
        config.CACHE_DIR = str(place or before)
        return _translated(numba.njit, keep=place is not None)
    finally:
        config.CACHE_DIR = before


def _translated(njit: Any, keep: bool) -> Callable[..., int]:
    """Every function as numba compiles it, in a space of names of their own, where they see each other."""
    names: dict[str, Any] = {}
    for module in _SOURCES:
        names |= vars(module)
    options: dict[str, Any] = {"nogil": True, "error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True}
    for function in _COMPILED:
        whole = function is march_loop.follow_one
        alike = FunctionType(function.__code__, names, function.__name__)
        more = {"cache": keep} if whole else {"no_cpython_wrapper": True}
        names[function.__name__] = njit(**options, **more)(alike)
    found: Callable[..., int] = names["follow_one"]
    return found


def _folder(version: str) -> Path | None:
    """Where compiled code is kept, named by all that it is made from; None where nothing can be written."""
    made_from = (Path(str(module.__file__)).read_bytes() for module in _SOURCES)
    place = folder() / "kernels" / digest_of(version.encode(), *made_from)
    try:
        place.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=place):
            return place
    except OSError:
        return None
