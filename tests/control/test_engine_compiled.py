"""What of the engine and of a platform's simulation is machine code, and where it is kept."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from drivesizer.control import open_loop
from drivesizer.control.engine import Task
from drivesizer.control.open_loop import kernel as stepper
from drivesizer.files import machine_code
from drivesizer.files.machine_code import SlowWarning, all_kernels

KERNELS = {one.functions[-1].__name__: one for one in all_kernels()}
MOTION = Task(time=(0.0, 0.01, 0.02), speed=(0.0, 8.0, 0.0))


@pytest.fixture(params=KERNELS)
def kernel(request):
    return KERNELS[request.param]


def moved():
    """Figures of a stepper's short move."""
    one = open_loop.Stepper(
        teeth=50.0, torque=np.array([0.5, 0.3, 0.1]), top_speed=90.0, microsteps=3.0, damping_ratio=0.1,
        motor_inertia=3e-6,
    )  # fmt: skip
    return open_loop.simulate(one, MOTION).figures


def test_every_kernel_is_translated_as_its_sources_are(kernel):
    assert kernel.kept
    name = kernel.functions[-1].__name__
    assert list(kernel.library.parent.glob(f"{name}-*.so")) == [kernel.library]


def test_no_compiler_is_loaded_to_run_it():
    code = "import sys; from drivesizer.control import engine; engine.machine_code(engine.KERNEL); print(*sys.modules)"
    loaded = subprocess.check_output([sys.executable, "-c", code], text=True).split()
    assert not {"numba", "llvmlite"} & set(loaded)


def test_without_machine_code_it_is_the_same_and_said_to_be_slow(monkeypatch):
    by_machine_code = moved()
    monkeypatch.setattr(machine_code.Kernel, "kept", False)
    monkeypatch.setitem(sys.modules, "numba", None)
    with pytest.warns(SlowWarning, match="a stepper runs some hundred times slower, for there is no machine code"):
        plain = machine_code.machine_code.__wrapped__(stepper.KERNEL)
    monkeypatch.setattr(open_loop, "machine_code", lambda _: plain)
    assert moved() == pytest.approx(by_machine_code, rel=1e-9)


def test_what_has_changed_is_translated_anew(tmp_path, monkeypatch):
    last = stepper.KERNEL.functions[-1].__name__
    (tmp_path / f"{last}-of-before.so").write_text("")
    library = tmp_path / f"{last}-of-now.so"
    monkeypatch.setattr(machine_code.Kernel, "library", library)
    by_machine_code, anew = moved(), machine_code.machine_code.__wrapped__(stepper.KERNEL)
    assert list(tmp_path.iterdir()) == [library]
    monkeypatch.setattr(open_loop, "machine_code", lambda _: anew)
    assert moved() == by_machine_code
