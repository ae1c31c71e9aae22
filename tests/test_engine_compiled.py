"""What of the engine is compiled, and where it is kept."""

from __future__ import annotations

import builtins
import math

import pytest
from test_engine import figure, gains, machine

from drivesizer.engine import Drive, Supply, Task, batch, compilation, march


def test_an_unwritable_folder_keeps_nothing(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("DRIVESIZER_CACHE", str(tmp_path / "file" / "below"))
    assert compilation._folder("1.0") is None
    told = []

    def njit(**options):
        told.append(options)
        return lambda function: function

    loop = compilation._translated(njit, keep=False)
    assert not any(options.get("cache") for options in told)
    assert len(told) > 30
    # in their own space of names the functions find each other
    drive = Drive(machine=machine(friction=1e-3), controller=gains(kp=0.02, ki=0.3), supply=Supply(voltage=12.0))
    task = Task(time=(0.0, 0.02, 0.04), speed=(0.0, 10.0, 0.0))
    compiled = march(drive, task)
    monkeypatch.setattr(batch, "compiled", lambda: loop)
    assert figure(march(drive, task), "rms_current") == pytest.approx(figure(compiled, "rms_current"), rel=1e-9)


def test_the_folder_s_name_is_made_of_every_file_and_the_version(tmp_path, monkeypatch):
    monkeypatch.setenv("DRIVESIZER_CACHE", str(tmp_path))
    sources = compilation._sources()
    names = {compilation._folder("1.0"), compilation._folder("1.1")}
    for n, path in enumerate(sources):
        changed = tmp_path / f"{n}.py"
        changed.write_text(path.read_text() + "#")
        monkeypatch.setattr(compilation, "_sources", lambda n=n, path=changed: [*sources[:n], path, *sources[n + 1 :]])
        names.add(compilation._folder("1.0"))
    assert len(sources) == 9
    assert len(names) == 2 + len(sources)


def test_every_function_that_is_called_is_in_a_file_that_is_compiled():
    seen = []

    def njit(**_):
        return lambda function: seen.append(function.__code__) or function

    compilation._translated(njit, keep=False)
    called = {name for code in seen for name in code.co_names}
    ours = {code.co_name for code in seen}
    files = {code.co_filename for code in seen} | {str(compilation.places.__file__)}
    assert files == {str(path) for path in compilation._sources()}
    known = {*dir(builtins), *dir(math), *dir(compilation.places), "math", "at", "shape"}
    assert called - ours <= known
