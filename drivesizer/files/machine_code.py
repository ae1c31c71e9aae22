"""Plain functions on arrays as machine code: a shared library beside their sources, made when drivesizer is installed.

numba reads the Python functions and optimises them, LLVM makes an object file for any processor of the system, and
the C compiler links it, or zig where there is none. Nothing of numba or LLVM is loaded to call it. A library carries
the digest of all that it is made of in its name: where sources have changed it is made anew at first use.
"""

from __future__ import annotations

import ctypes
import importlib
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import warnings
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, NamedTuple

from drivesizer.files.cache import digest_of

_ELEMENTS = {"d": "float64", "b": "int8", "q": "int64"}  # of arrays, by their letter


class SlowWarning(UserWarning):
    """Something runs uncompiled."""


class Kernel(NamedTuple):
    """Functions that are compiled together to one piece of machine code."""

    functions: tuple[Callable[..., Any], ...]  # each calls only those before it; the last one is called from outside
    modules: tuple[ModuleType, ...]  # that define them and their constants
    inline: bool  # whether each is inlined where it is called: faster, and longer to compile
    slow: str  # what is slow without machine code
    arguments: str  # of the last one: a word each, type and dimensions: ``d2`` rows of floats, ``d0`` a float

    @property
    def library(self) -> Path:
        """File of its machine code, beside its last function."""
        last = self.functions[-1]
        made_of = (path.read_bytes() for path in (*files_of(self), Path(__file__)))
        digest = digest_of(sysconfig.get_platform().encode(), self.arguments.encode(), *made_of)
        return Path(last.__code__.co_filename).with_name(f"{last.__name__}-{digest}.so")

    @property
    def translated(self) -> bool:
        """Whether it has been translated as its sources are now."""
        return self.library.is_file()


def files_of(kernel: Kernel) -> list[Path]:
    """Files that machine code is made from."""
    return [Path(str(module.__file__)) for module in kernel.modules]


def defined_in(modules: Sequence[ModuleType]) -> tuple[FunctionType, ...]:
    """The functions that modules define, in their order."""
    return tuple(
        f for m in modules for f in vars(m).values() if isinstance(f, FunctionType) and f.__module__ == m.__name__
    )


@cache
def machine_code(kernel: Kernel) -> Callable[..., int]:
    """The last function of a kernel as machine code, which runs without the interpreter's lock."""
    try:
        if not kernel.translated:
            translate(kernel)
        return _callable(kernel)
    except (ImportError, OSError, subprocess.CalledProcessError):
        warnings.warn(f"{kernel.slow}, for there is no machine code here; install it anew", SlowWarning, stacklevel=3)
        return kernel.functions[-1]


def _callable(kernel: Kernel) -> Callable[..., int]:
    """A function of arrays and floats out of a library."""
    native = getattr(ctypes.CDLL(str(kernel.library)), kernel.functions[-1].__name__)
    signature = [(_ELEMENTS[word[0]], int(word[1])) for word in kernel.arguments.split()]
    native.argtypes = [ctypes.c_void_p] * 2
    for _, dimensions in signature:
        native.argtypes += [ctypes.c_int64] * (5 + 2 * dimensions) if dimensions else [ctypes.c_double]

    def call(*values: Any) -> int:
        slots: list[Any] = []
        for (kind, dimensions), value in zip(signature, values, strict=True):
            if not dimensions:
                slots.append(value)
            elif value.dtype == kind and value.ndim == dimensions and value.flags.c_contiguous:
                # as numba hands an array over: owner, parent, items, bytes of one, address, shape, strides
                slots += (0, 0, value.size, value.itemsize, value.ctypes.data, *value.shape, *value.strides)
            else:
                raise TypeError(f"an array of {value.dtype.name}, {value.shape}; expected {kind} and {dimensions}")
        answer, raised = ctypes.c_int64(), ctypes.c_void_p()
        if native(ctypes.byref(answer), ctypes.byref(raised), *slots):
            raise RuntimeError("the machine code raised an exception")
        return answer.value

    return call


def translate(kernel: Kernel) -> None:
    """Make the library of a kernel; those of its earlier sources are removed."""
    from llvmlite import binding as llvm

    library, compiled = kernel.library, _compiled(kernel)
    module = llvm.parse_assembly(compiled.library.get_llvm_str())
    module.get_function(compiled.fndesc.llvm_func_name).name = kernel.functions[-1].__name__
    target = llvm.Target.from_default_triple().create_target_machine(cpu="", opt=3, reloc="pic", codemodel="default")
    linker = ["cc"] if sys.platform == "linux" and shutil.which("cc") else [sys.executable, "-m", "ziglang", "cc"]
    with tempfile.TemporaryDirectory(dir=library.parent) as place:
        item, shared_object = Path(place) / "kernel.o", Path(place) / "kernel.so"
        item.write_bytes(target.emit_object(module))
        subprocess.run([*linker, "-shared", item, "-lm", "-o", shared_object], check=True, capture_output=True)  # noqa: S603
        for old in library.parent.glob(f"{kernel.functions[-1].__name__}-*.so"):
            old.unlink(missing_ok=True)
        shared_object.replace(library)


def _compiled(kernel: Kernel) -> Any:
    """A kernel as numba compiles it for any processor of the system."""
    import numba

    config: Any = numba.config
    config.CPU_NAME, config.CPU_FEATURES = "generic", ""
    names: dict[str, Any] = {}  # in a namespace of their own the functions call each other, not the plain ones
    for module in kernel.modules:
        names |= vars(module)
    # nothing is allocated inside: without counting references (_nrt) a call costs less than its work
    options: dict[str, Any] = {
        "nogil": True, "error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True, "no_cpython_wrapper": True,
        "forceinline": kernel.inline,
    }  # fmt: skip
    for function in kernel.functions:
        copy = FunctionType(function.__code__, names, function.__name__)
        names[function.__name__] = numba.njit(**options)(copy)
    last = names[kernel.functions[-1].__name__]
    types = {letter: getattr(numba, kind) for letter, kind in _ELEMENTS.items()}
    words = [(types[word[0]], int(word[1])) for word in kernel.arguments.split()]
    last.compile(tuple(numba.types.Array(kind, n, "C") if n else kind for kind, n in words))
    (compiled,) = last.overloads.values()
    return compiled


def all_kernels() -> list[Kernel]:
    """Those of the package: in its modules of the name ``kernel``."""
    package = Path(__file__).parent.parent
    paths = sorted(path.relative_to(package.parent).with_suffix("") for path in package.rglob("kernel.py"))
    modules = [importlib.import_module(".".join(path.parts)) for path in paths]
    return [kernel for module in modules for kernel in vars(module).values() if isinstance(kernel, Kernel)]


def translate_all() -> None:
    """Make every library that is not there yet."""
    for kernel in all_kernels():
        if not kernel.translated:
            sys.stderr.write(f"translating {kernel.functions[-1].__name__} to machine code ...\n")
            translate(kernel)
