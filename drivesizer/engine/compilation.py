"""The march as machine code, where numba is installed, and where that code is kept."""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Callable
from functools import cache
from importlib import metadata
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

import drivesizer.engine.controllers as controllers
import drivesizer.engine.limits as limits
import drivesizer.engine.loop as loop
import drivesizer.engine.modes as modes
import drivesizer.engine.places as places
import drivesizer.engine.steady as steady
import drivesizer.engine.steps as steps
import drivesizer.engine.tallies as tallies
import drivesizer.engine.warming as warming
from drivesizer.catalog.cache import digest_of, folder

__all__ = ["SlowWarning", "compiled", "kept"]

_COMPILED = (modes, tallies, steps, warming, limits, controllers, steady, loop)  # each calls only those before it


class SlowWarning(UserWarning):
    """The closed loop runs uncompiled."""


@cache
def compiled() -> Callable[..., int]:
    """``loop.march_one`` as machine code, kept in the user's cache folder; as plain Python without numba.

    Notes
    -----
    Compiled code is kept in a folder named by the digest of all files that it is made from and numba's version, so that
    old code is never met; where that cannot be written it is compiled in memory at every start. It runs without the
    interpreter's lock: threads run beside each other.

    Warns
    -----
    SlowWarning
        When numba is not installed.
    """
    try:
        import numba
    except ImportError:
        warnings.warn(
            "numba is not installed: the closed loop runs some hundred times slower", SlowWarning, stacklevel=2
        )
        return loop.march_one
    config: Any = numba.config
    place, before = _folder(numba.__version__), config.CACHE_DIR
    try:
        config.CACHE_DIR = str(place or before)
        march: Callable[..., int] = _translated(numba.njit, keep=place is not None)
    finally:
        config.CACHE_DIR = before
    return march


def _translated(njit: Any, keep: bool) -> Any:
    """Every function as numba compiles it; in a space of names of their own they see each other, not the plain ones."""
    names: dict[str, Any] = {}
    for module in _COMPILED:
        names |= vars(module)
    # nothing is allocated inside: without counting references (_nrt) a call costs less than its work
    options: dict[str, Any] = {"nogil": True, "error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True}
    for function in (f for module in _COMPILED for f in _own(module)):
        whole = function is loop.march_one
        more = {"cache": keep} if whole else {"forceinline": True, "no_cpython_wrapper": True}
        alike = FunctionType(function.__code__, names, function.__name__)
        names[function.__name__] = njit(**options, **more)(alike)
    return names["march_one"]


def _own(module: ModuleType) -> list[FunctionType]:
    """Functions that a module defines, in their order."""
    return [f for f in vars(module).values() if isinstance(f, FunctionType) and f.__module__ == module.__name__]


def _sources() -> list[Path]:
    """Files that machine code is made from."""
    return [Path(str(module.__file__)) for module in (places, *_COMPILED)]


def kept() -> bool:
    """Whether the march was compiled before by this numba; without numba it never is."""
    try:
        place = _place(metadata.version("numba"))
    except metadata.PackageNotFoundError:
        return False
    return place.is_dir() and any(place.rglob("*.nbc"))


def _place(version: str) -> Path:
    """Folder of the compiled code, named by all that it is made from."""
    made_from = (path.read_bytes() for path in _sources())
    return folder() / "kernels" / digest_of(version.encode(), *made_from)


def _folder(version: str) -> Path | None:
    """Where compiled code is kept; None where nothing can be written."""
    place = _place(version)
    try:
        place.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=place):
            return place
    except OSError:
        return None
