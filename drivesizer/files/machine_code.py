"""Plain functions on arrays as machine code: translated beforehand, else compiled by numba; and the cache of that.

What numba compiled is kept in a folder named by the digest of all its source files and numba's version, so that
outdated code is never used; where that folder cannot be written it is compiled in memory at every start. It runs
without the interpreter's lock: threads run in parallel.
"""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Callable, Sequence
from importlib import metadata
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, NamedTuple

from drivesizer.errors import reason_of
from drivesizer.files.cache import CacheWarning, digest_of, folder
from drivesizer.files.translation import linked, usable

__all__ = ["Kernel", "SlowWarning", "defined_in", "files_of", "machine_code", "translated"]


class SlowWarning(UserWarning):
    """Something runs uncompiled."""


class Kernel(NamedTuple):
    """Functions that are compiled together to one piece of machine code."""

    functions: tuple[Callable[..., Any], ...]  # each calls only those before it; the last one is called from outside
    modules: tuple[ModuleType, ...]  # that define them and their constants
    inline: bool  # whether each is inlined where it is called: faster, and longer to compile
    slow: str  # the warning without numba
    arguments: str  # of the last one: a word each, type and dimensions, as ``translation.linked`` takes them

    @property
    def sources(self) -> str:
        """Digest of all that it is made from."""
        return digest_of(self.arguments.encode(), *(path.read_bytes() for path in files_of(self)))

    @property
    def translation(self) -> Path:
        """File of what it was translated to beforehand."""
        last = self.functions[-1]
        return Path(last.__code__.co_filename).with_name(f"{last.__name__}.bitcode")

    @property
    def kept(self) -> bool:
        """Whether nothing has to be compiled by numba: translated beforehand, or compiled before by this numba."""
        if usable(self.translation, self.sources) is not None:
            return True
        try:
            place = self._place(metadata.version("numba"))
        except metadata.PackageNotFoundError:
            return False
        return place.is_dir() and any(place.rglob("*.nbc"))

    def _place(self, version: str) -> Path:
        made_from = (path.read_bytes() for path in files_of(self))
        return folder() / "kernels" / digest_of(version.encode(), *made_from)

    def folder(self, version: str) -> Path | None:
        """Folder of compiled code; None where nothing can be written."""
        place = self._place(version)
        try:
            place.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=place):
                return place
        except OSError:
            return None


def files_of(kernel: Kernel) -> list[Path]:
    """Files that machine code is made from."""
    return [Path(str(module.__file__)) for module in kernel.modules]


def defined_in(modules: Sequence[ModuleType]) -> tuple[FunctionType, ...]:
    """The functions that modules define, in their order."""
    return tuple(
        f for m in modules for f in vars(m).values() if isinstance(f, FunctionType) and f.__module__ == m.__name__
    )


def machine_code(kernel: Kernel) -> Callable[..., int]:
    """The last function of a kernel as machine code; as plain Python without numba.

    Warns
    -----
    SlowWarning
        When numba is not installed.
    CacheWarning
        Once it is compiled, when it cannot be kept.
    """
    if (ready := linked(kernel.translation, kernel.sources, kernel.arguments)) is not None:
        return ready
    try:
        import numba
    except ImportError:
        warnings.warn(kernel.slow, SlowWarning, stacklevel=3)
        plain: Callable[..., int] = kernel.functions[-1]
        return plain
    config: Any = numba.config
    place, before = kernel.folder(numba.__version__), config.CACHE_DIR
    try:
        config.CACHE_DIR = str(place or before)
        made = translated(kernel, numba.njit, keep=place is not None)
    finally:
        config.CACHE_DIR = before
    if place is not None:
        _warn_where_not_stored(made._cache, place)
    compiled: Callable[..., int] = made
    return compiled


def _warn_where_not_stored(cache: Any, place: Path) -> None:
    """Warn where numba cannot store its code, such as on a full disk, instead of stopping the run."""
    save = cache.save_overload

    def save_or_warn(*given: Any) -> None:
        try:
            save(*given)
        except OSError as error:
            warnings.warn(f"the compiled code is not kept in {place} ({reason_of(error)})", CacheWarning, stacklevel=2)

    cache.save_overload = save_or_warn


def translated(kernel: Kernel, njit: Any, keep: bool) -> Any:
    """Compile every function; in a namespace of their own they call each other, not the plain ones.

    Parameters
    ----------
    kernel
        What is compiled.
    njit
        numba's, or a stand-in.
    keep
        Whether the last one is kept in the cache folder.

    Returns
    -------
    Callable
        The last function, compiled.
    """
    names: dict[str, Any] = {}
    for module in kernel.modules:
        names |= vars(module)
    # nothing is allocated inside: without counting references (_nrt) a call costs less than its work
    options: dict[str, Any] = {"nogil": True, "error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True}
    inner: dict[str, Any] = {"no_cpython_wrapper": True} | ({"forceinline": True} if kernel.inline else {})
    for function in kernel.functions:
        more = {"cache": keep} if function is kernel.functions[-1] else inner
        copy = FunctionType(function.__code__, names, function.__name__)
        names[function.__name__] = njit(**options, **more)(copy)
    return names[kernel.functions[-1].__name__]
