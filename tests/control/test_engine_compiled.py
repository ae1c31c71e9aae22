"""What of the engine and of a platform's simulation is compiled, and where it is kept."""

from __future__ import annotations

import builtins
import math

import pytest
from engine_tasks import figure, gains, machine

from drivesizer.control.engine import Drive, Supply, Task, batch, simulate
from drivesizer.control.engine import kernel as of_the_drive
from drivesizer.control.open_loop import kernel as stepper
from drivesizer.control.path_following import kernel as following
from drivesizer.files import machine_code
from drivesizer.files.machine_code import files_of, translated

KERNELS = {"engine": (of_the_drive.KERNEL, 9), "platform": (following.KERNEL, 5), "stepper": (stepper.KERNEL, 2)}


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
