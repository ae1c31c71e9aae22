"""What of the engine and of a platform's simulation is compiled, and where it is kept."""

from __future__ import annotations

import builtins
import math
import sysconfig
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest
from engine_tasks import figure, gains, machine
from packaging.version import Version

from drivesizer.control.engine import Drive, Supply, Task, batch, simulate
from drivesizer.control.engine import kernel as of_the_drive
from drivesizer.control.open_loop import kernel as stepper
from drivesizer.control.path_following import kernel as following
from drivesizer.files import csv_numbers, machine_code, translation
from drivesizer.files.machine_code import files_of, translated
from drivesizer.files.translation import linked, usable
from drivesizer.physics.groups import kernel as groups
from drivesizer.physics.one_pass import kernel as one_pass

KERNELS = {
    "engine": (of_the_drive.KERNEL, 9), "one pass": (one_pass.KERNEL, 6), "platform": (following.KERNEL, 5),
    "groups": (groups.KERNEL, 2), "blocks": (groups.BLOCKS, 2), "rows of a file": (csv_numbers.KERNEL, 1),
    "stepper": (stepper.KERNEL, 2),
}  # fmt: skip
OLDEST = stepper.KERNEL.translation.read_bytes().partition(b"\n")[0].decode().split()[-1]


def _suits() -> bool:
    try:
        here = Version(metadata.version("llvmlite"))
    except metadata.PackageNotFoundError:
        return False
    return sysconfig.get_platform() == "linux-x86_64" and here.release[:2] >= Version(OLDEST).release[:2]


on_its_system = pytest.mark.skipif(
    not _suits(), reason=f"bitcode is for one system and llvmlite {OLDEST} or later; elsewhere numba compiles"
)


@pytest.fixture(params=KERNELS)
def kernel(request):
    return KERNELS[request.param][0]


def test_an_unwritable_folder_keeps_nothing(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("DRIVESIZER_CACHE", str(tmp_path / "file" / "below"))
    assert of_the_drive.KERNEL.folder("1.0") is None
    compiled_with = []

    def njit(**options):
        compiled_with.append(options)
        return lambda function: function

    loop = translated(of_the_drive.KERNEL, njit, keep=False)
    assert not any(options.get("cache") for options in compiled_with)
    assert len(compiled_with) > 30
    # in their own space of names the functions find each other
    drive = Drive(train=machine(friction=1e-3), controller=gains(kp=0.02, ki=0.3), supply=Supply(voltage=12.0))
    task = Task(time=(0.0, 0.02, 0.04), speed=(0.0, 10.0, 0.0))
    compiled = simulate(drive, task)
    monkeypatch.setattr(batch, "compiled", lambda: loop)
    assert figure(simulate(drive, task), "rms_current") == pytest.approx(figure(compiled, "rms_current"), rel=1e-9)


def test_the_folder_s_name_is_made_of_every_file_and_the_version(kernel, tmp_path, monkeypatch):
    monkeypatch.setenv("DRIVESIZER_CACHE", str(tmp_path))
    sources = files_of(kernel)
    names = {kernel.folder("1.0"), kernel.folder("1.1")}
    for n, path in enumerate(sources):
        changed = tmp_path / f"{n}.py"
        changed.write_text(path.read_text() + "#")
        now = [*sources[:n], changed, *sources[n + 1 :]]
        monkeypatch.setattr(machine_code, "files_of", lambda _, now=now: now)
        names.add(kernel.folder("1.0"))
    assert len(sources) == dict(KERNELS.values())[kernel]
    assert len(names) == 2 + len(sources)


def test_every_function_that_is_called_is_in_a_file_that_is_compiled(kernel):
    seen = []

    def njit(**_):
        return lambda function: seen.append(function.__code__) or function

    translated(kernel, njit, keep=False)
    places = kernel.modules[0]
    called = {name for code in seen for name in code.co_names}
    ours = {code.co_name for code in seen}
    files = {code.co_filename for code in seen} | {str(places.__file__)}
    assert files == {str(path) for path in files_of(kernel)}
    known = {*dir(builtins), *dir(math), *dir(places), "math", "at", "shape"}
    assert called - ours <= known


@on_its_system
def test_the_bitcode_is_of_the_sources_as_they_are(kernel):
    remedy = "after a change of what is compiled: python tests/tools/translate_kernels.py"
    assert usable(kernel.translation, kernel.sources) is not None, remedy
    assert kernel.kept


@on_its_system
def test_bitcode_of_other_sources_of_another_system_or_too_new_is_left(tmp_path, monkeypatch):
    path, sources = stepper.KERNEL.translation, stepper.KERNEL.sources
    assert usable(path, sources[::-1]) is None
    assert usable(tmp_path / "none.bitcode", sources) is None
    head, _, packed = path.read_bytes().partition(b"\n")
    for n, line in enumerate((head.replace(b"linux", b"macos"), head[:-5] + b"99.1.0", head + b" ?", b"")):
        other = tmp_path / f"{n}.bitcode"
        other.write_bytes(line + b"\n" + packed)
        assert usable(other, sources) is None
    damaged = tmp_path / "damaged.bitcode"
    damaged.write_bytes(head + b"\n" + packed[:-40])
    monkeypatch.setenv("DRIVESIZER_CACHE", str(tmp_path))
    assert linked(damaged, sources, stepper.KERNEL.arguments) is None


def _moved():
    drive = Drive(train=machine(friction=1e-3), controller=gains(kp=0.02, ki=0.3), supply=Supply(voltage=12.0))
    found = simulate(drive, Task(time=(0.0, 0.02, 0.04), speed=(0.0, 10.0, 0.0)))
    return {name: np.asarray(column).tobytes() for name, column in found.figures.items()}


@on_its_system
def test_machine_code_of_bitcode_is_plain_python_to_the_last_bit_wherever_it_is_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(batch, "compiled", lambda: of_the_drive.KERNEL.functions[-1])
    plain = _moved()
    (tmp_path / "file").write_text("")
    for folder in ("new", "new", "new", "file/below"):  # made, kept, made anew as damaged, not to be kept
        monkeypatch.setenv("DRIVESIZER_CACHE", str(tmp_path / folder))
        loop = linked(of_the_drive.KERNEL.translation, of_the_drive.KERNEL.sources, of_the_drive.KERNEL.arguments)
        monkeypatch.setattr(batch, "compiled", lambda loop=loop: loop)
        assert _moved() == plain
        for path in Path(tmp_path / "new").rglob("*.object"):
            assert path.stat().st_size > 10_000
            path.write_bytes(path.read_bytes()[:-100])
    assert len(list(tmp_path.rglob("*.object"))) == 1


@on_its_system
def test_an_array_of_another_kind_is_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("DRIVESIZER_CACHE", str(tmp_path))
    turn = linked(stepper.KERNEL.translation, stepper.KERNEL.sources, stepper.KERNEL.arguments)
    for wrong in (np.zeros(3, np.int64), np.zeros((3, 2)), np.zeros(6)[::2]):
        with pytest.raises(TypeError, match=r"expected float64 and 1"):
            turn(wrong, *[np.zeros(3)] * 4, 0.0, 0.0, 1.0)


@pytest.mark.slow
def test_without_bitcode_numba_compiles_the_same(tmp_path, monkeypatch):
    from drivesizer.control.open_loop import simulation

    one = simulation.Stepper(
        teeth=50.0, torque=np.array([0.5, 0.3, 0.1]), top_speed=90.0, microstep=0.01, damping_ratio=0.1,
        motor_inertia=3e-6,
    )  # fmt: skip
    motion = simulation.Motion(time=(0.0, 0.01, 0.02), speed=(0.0, 8.0, 0.0))
    monkeypatch.setenv("DRIVESIZER_CACHE", str(tmp_path))
    found = simulation.simulate(one, motion).figures
    monkeypatch.setattr(machine_code, "linked", lambda *_: None)
    monkeypatch.setattr(translation, "usable", lambda *_: None)
    compiled = machine_code.machine_code(stepper.KERNEL)
    monkeypatch.setattr(simulation, "compiled", lambda: compiled)
    assert simulation.simulate(one, motion).figures == found
    assert list(tmp_path.rglob("*.nbc"))
