"""Machine code of a function that was translated beforehand: LLVM's bitcode in a file beside the function's sources.

numba takes some seconds to read Python; LLVM alone makes machine code of the bitcode in a quarter of a second. The
bitcode has no figure of the processor in it, is what numba makes, and is used where it is of the sources as they are,
on the system that it is for; ``tests/tools/translate_kernels.py`` writes it. Machine code is kept in the cache folder.
"""

from __future__ import annotations

import contextlib
import ctypes
import struct
import sysconfig
import zlib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from drivesizer.files.cache import digest_of, folder, keep, kept

__all__ = ["ENTRY", "FAILED", "OF_C", "linked", "made_for", "usable"]

ENTRY = "entry"  # function of the bitcode: a pointer to slots of 8 bytes in, an integer out
FAILED = -(2**63)  # what it gives where the function raised an exception
OF_C = ("atan2", "copysign", "cos", "floor", "memset", "sin", "sqrt", "tanh")  # functions that bitcode may call
_TYPES = {"d": "float64", "b": "int8", "q": "int64"}  # of arrays, by their letter


def made_for(sources: str) -> bytes:
    """Head of a file of bitcode: digest of the sources, system, and oldest llvmlite that reads it.

    Parameters
    ----------
    sources
        Digest of all that the function is made from.

    Returns
    -------
    bytes
        A line.
    """
    return f"{sources} {sysconfig.get_platform()} {_version_here()}".encode()


def usable(path: Path, sources: str) -> bytes | None:
    """The bitcode of a file as packed; None where it is of other sources, for another system or a newer llvmlite.

    Parameters
    ----------
    path
        Of the file.
    sources
        Digest of all that the function is made from.

    Returns
    -------
    bytes or None
        What follows the head.
    """
    try:
        head, _, packed = path.read_bytes().partition(b"\n")
        made_from, system, oldest = head.decode().split()
        here = _version_here()
    except (OSError, ValueError, ImportError, AttributeError):
        return None
    if made_from != sources or system != sysconfig.get_platform() or _release(here) < _release(oldest):
        return None
    return packed


def _version_here() -> str:
    """Of the installed llvmlite, as it says itself: to search the installer's records takes longer than to load it."""
    from llvmlite import __version__

    return str(__version__)


def _release(version: str) -> list[int]:
    """First two numbers of a version."""
    return [int(part) if part.isdecimal() else 0 for part in version.split(".")[:2]]


def linked(path: Path, sources: str, arguments: str) -> Callable[..., int] | None:
    """The function of a file of bitcode, ready to be called.

    Parameters
    ----------
    path
        Of the file; its stem names the machine code in the cache folder.
    sources
        Digest of all that the function is made from.
    arguments
        A word each: type letter and dimensions, such as ``d2`` for rows of floats and ``d0`` for a float.

    Returns
    -------
    Callable or None
        The function, which runs without the interpreter's lock; None where the file is not usable here.
    """
    packed = usable(path, sources)
    if packed is None:
        return None
    try:
        engine = _engine(path.stem, packed)
    except (ImportError, AttributeError, TypeError, RuntimeError, zlib.error):
        return None  # another llvmlite, or a damaged file
    return _callable(engine, arguments.split())


def _engine(name: str, packed: bytes) -> Any:
    """LLVM's engine with the machine code of some bitcode."""
    import llvmlite.binding as llvm

    process = ctypes.CDLL(None)
    for one in OF_C:
        llvm.add_symbol(one, ctypes.cast(getattr(process, one), ctypes.c_void_p).value)
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    cpu, features = llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()
    target = llvm.Target.from_default_triple().create_target_machine(
        cpu=cpu, features=features, opt=3, codemodel="jitdefault", jit=True
    )
    versions = f"{_version_here()} {cpu} {features}".encode()
    place = folder() / "kernels" / f"{name}-{digest_of(versions, packed)}.object"
    code = kept(place)
    if code is None:
        code = target.emit_object(llvm.parse_bitcode(zlib.decompress(packed)))
        with contextlib.suppress(OSError):  # the next run makes it anew
            keep(place, code)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), target)
    engine.add_object_file(llvm.object_file.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return engine


def _callable(engine: Any, arguments: Sequence[str]) -> Callable[..., int]:
    """A function of an engine as a function of arrays and floats."""
    native = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p)(engine.get_function_address(ENTRY))
    wanted = [(_TYPES[word[0]], int(word[1])) for word in arguments]

    def call(*given: Any) -> int:
        slots: list[int] = []
        for (kind, dimensions), value in zip(wanted, given, strict=True):
            if not dimensions:
                slots += struct.unpack("q", struct.pack("d", value))
            elif value.dtype.name == kind and value.ndim == dimensions and value.flags.c_contiguous:
                # as numba hands an array over: owner, parent, items, bytes of one, address, shape, strides
                slots += (0, 0, value.size, value.itemsize, value.ctypes.data, *value.shape, *value.strides)
            else:
                raise TypeError(f"an array of {value.dtype.name}, {value.shape}; expected {kind} and {dimensions}")
        found = native((ctypes.c_int64 * len(slots))(*slots))
        if found == FAILED:
            raise RuntimeError("the machine code raised an exception")
        return int(found)

    call.engine = engine  # type: ignore[attr-defined]  # which frees the code with its end
    return call
