"""Translate the kernels to LLVM's bitcode, in files beside their sources: ``python tests/tools/translate_kernels.py``.

To be run after a change of a function that is compiled; until then numba compiles at the first run of each machine.
"""

from __future__ import annotations

import os
import sys
import zlib
from pathlib import Path
from typing import Any

# before numba is there: as many figures at once as most processors take; others take them in halves, to the same bits
os.environ |= {"NUMBA_CPU_NAME": "haswell", "NUMBA_CPU_FEATURES": ""}

import llvmlite.binding as llvm
import numba

from drivesizer.control.engine.kernel import KERNEL as DRIVE
from drivesizer.control.open_loop.kernel import KERNEL as STEPPER
from drivesizer.control.path_following.kernel import KERNEL as PLATFORM
from drivesizer.files.csv_numbers import KERNEL as ROWS
from drivesizer.files.machine_code import Kernel, translated
from drivesizer.files.translation import ENTRY, FAILED, OF_C, made_for
from drivesizer.physics.groups.kernel import BLOCKS
from drivesizer.physics.groups.kernel import KERNEL as GROUPS
from drivesizer.physics.one_pass.kernel import KERNEL as PASS

__all__ = ["KERNELS", "bitcode"]

KERNELS = (BLOCKS, DRIVE, GROUPS, PASS, PLATFORM, ROWS, STEPPER)
_SCALARS = {"d": numba.float64, "b": numba.int8, "q": numba.int64}


def _types(arguments: str) -> tuple[Any, ...]:
    return tuple(
        _SCALARS[word[0]] if word[1] == "0" else numba.types.Array(_SCALARS[word[0]], int(word[1]), "C")
        for word in arguments.split()
    )


def _slots(arguments: str) -> list[str]:
    """LLVM's types of what numba's functions take, in order."""
    slots: list[str] = []
    for word in arguments.split():
        slots += ["ptr", "ptr", "i64", "i64", "ptr", *["i64"] * 2 * int(word[1])] if word[1] != "0" else ["double"]
    return slots


def _entry(name: str, slots: list[str]) -> str:
    """A function that takes all of them out of one array."""
    lines = []
    for n, kind in enumerate(slots):
        lines += [f"%p{n} = getelementptr i64, ptr %slots, i64 {n}", f"%a{n} = load {kind}, ptr %p{n}"]
    given = ", ".join(f"{kind} %a{n}" for n, kind in enumerate(slots))
    return "\n".join([
        f"declare i32 @{name}(ptr, ptr, {', '.join(slots)})",
        f"define i64 @{ENTRY}(ptr %slots) {{",
        "%found = alloca i64", "%raised = alloca ptr", *lines,
        f"%status = call i32 @{name}(ptr %found, ptr %raised, {given})",
        "%value = load i64, ptr %found", "%failed = icmp ne i32 %status, 0",
        f"%out = select i1 %failed, i64 {FAILED}, i64 %value", "ret i64 %out", "}",
    ])  # fmt: skip


def bitcode(kernel: Kernel) -> bytes:
    """The content of the file of a kernel."""
    made = translated(kernel, numba.njit, keep=False)
    made.compile(_types(kernel.arguments))
    (compiled,) = made.overloads.values()
    name = kernel.functions[-1].__name__
    module = llvm.parse_assembly(compiled.library.get_llvm_str())
    module.get_function(compiled.fndesc.llvm_func_name).name = name
    module.link_in(llvm.parse_assembly(_entry(name, _slots(kernel.arguments))))
    for one in (*module.functions, *module.global_variables):
        if not one.is_declaration and one.name != ENTRY:
            one.linkage = "internal"  # so that what nothing calls is left out
    module.name = name
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.run(module, llvm.create_pass_builder(_machine(), llvm.create_pipeline_tuning_options()))
    called = {f.name for f in module.functions if f.is_declaration and not f.name.startswith("llvm.")}
    assert called <= set(OF_C), called
    return made_for(kernel.sources) + b"\n" + zlib.compress(module.as_bitcode(), 9)


def _machine() -> Any:
    return llvm.Target.from_default_triple().create_target_machine(cpu="", features="", opt=3)


def main() -> None:
    for kernel in KERNELS:
        body = bitcode(kernel)
        kernel.translation.write_bytes(body)
        sys.stdout.write(f"{Path(kernel.translation).name}: {len(body)} bytes\n")


if __name__ == "__main__":
    main()
