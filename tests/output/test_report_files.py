"""A report is whole or not there: whatever stops it, an older file keeps every byte, and nothing is left behind."""

import os
import select
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from drivesizer.errors import InputError
from drivesizer.files.writing import write_files
from drivesizer.output.report import KNOWN
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec

# Writes half of a file, says so, and waits: the moment at which it is stopped. The next file when a line says so.
WRITER = """
import sys, time
from pathlib import Path
from drivesizer import load_spec, size
from drivesizer.output.report import write

class Slow:
    def __init__(self, stream): self.stream = stream
    def __enter__(self): return self
    def __exit__(self, *_): self.stream.close()
    def write(self, content):
        self.stream.write(content[: len(content) // 2])
        self.stream.flush()
        print("half", flush=True)
        time.sleep(60)

real = Path.open
Path.open = lambda path, *a, **k: Slow(real(path, *a, **k)) if path.suffix == ".part" else real(path, *a, **k)
result = size(load_spec(sys.argv[1]), top=1)
for target in sys.argv[2:]:
    sys.stdin.readline()
    try:
        write(result, None, [Path(target)])
    except KeyboardInterrupt:
        print("stopped", flush=True)
"""


@pytest.fixture(scope="module")
def result(spec: RobotSpec):
    return size(spec, top=1)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


@contextmanager
def writer(example: Path, *targets: Path) -> Iterator[subprocess.Popen[str]]:
    """A run that writes reports one after the other; it is killed where it still runs at the end."""
    command = [sys.executable, "-c", WRITER, str(example), *map(str, targets)]
    streams = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
    with subprocess.Popen(command, text=True, **streams) as run:
        try:
            yield run
        finally:
            run.kill()


def half_written(run: subprocess.Popen[str], folder: Path) -> bool:
    """Let a run write its next file, and wait for the moment at which half of it is on the disk."""
    assert run.stdin is not None and run.stdout is not None
    run.stdin.write("next\n")
    run.stdin.flush()
    said = run.stdout.readline()
    return said == "half\n" and any(p.suffix == ".part" and p.stat().st_size > 0 for p in folder.iterdir())


def interrupted(run: subprocess.Popen[str]) -> bool:
    """Interrupt a run until it says that it was."""
    assert run.stdout is not None
    for _ in range(3):  # Python loses an interruption that falls into its collection of garbage
        run.send_signal(signal.SIGINT)
        if select.select([run.stdout], [], [], 15)[0]:
            return run.stdout.readline() == "stopped\n"
    return False


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="signals of another kind")
def test_an_interrupted_report_leaves_the_older_one_and_nothing_else(example, tmp_path):
    targets = [tmp_path / f"report{suffix}" for suffix in KNOWN]
    for target in targets:
        target.write_bytes(b"older")
    with writer(example, *targets) as run:
        for target in targets:
            assert half_written(run, tmp_path), target
            assert interrupted(run), target
            assert target.read_bytes() == b"older"
            assert names(tmp_path) == sorted(path.name for path in targets)
        assert run.wait(60) == 0


def test_a_name_that_a_killed_run_left_is_passed_over(tmp_path):
    left = tmp_path / f".drivesizer-{os.getpid()}-0.part"
    left.write_bytes(b"half of an older one")
    write_files({tmp_path / "a.csv": b"new"})
    assert (tmp_path / "a.csv").read_bytes() == b"new"
    assert left.read_bytes() == b"half of an older one"


def test_a_full_disk_changes_no_file(tmp_path, monkeypatch):
    real = Path.open

    class Full:
        def __init__(self, stream):
            self.stream = stream

        def __enter__(self):
            return self

        def __exit__(self, *_):
            self.stream.close()

        def write(self, content):
            self.stream.write(content[:1])
            raise OSError(28, "No space left on device")

    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_bytes(b"older")
    monkeypatch.setattr(
        Path, "open", lambda p, *a, **k: Full(real(p, *a, **k)) if "-1.part" in p.name else real(p, *a, **k)
    )
    with pytest.raises(InputError, match=r"b\.csv: cannot be written \(no space left on device\)"):
        write_files({tmp_path / "a.csv": b"new", tmp_path / "b.csv": b"new"})
    assert {path.read_bytes() for path in tmp_path.iterdir()} == {b"older"}
    assert names(tmp_path) == ["a.csv", "b.csv"]


@pytest.mark.parametrize(("at", "content"), [(0, b"older"), (1, b"older"), (2, b"new"), (3, b"new")])
def test_files_of_one_report_are_all_of_one_run(at, content, tmp_path, monkeypatch):
    """Interrupted before the last content is complete, none changes; while they take their places, all do."""
    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_bytes(b"older")
    real_open, real_replace, steps = Path.open, Path.replace, iter(range(9))

    def step(real):
        def stepped(path, *args, **options):
            if path.suffix == ".part" and next(steps) == at:
                raise KeyboardInterrupt
            return real(path, *args, **options)

        return stepped

    monkeypatch.setattr(Path, "open", step(real_open))
    monkeypatch.setattr(Path, "replace", step(real_replace))
    with pytest.raises(KeyboardInterrupt):
        write_files({tmp_path / "a.csv": b"new", tmp_path / "b.csv": b"new"})
    monkeypatch.undo()
    assert {path.read_bytes() for path in tmp_path.iterdir()} == {content}
    assert names(tmp_path) == ["a.csv", "b.csv"]
