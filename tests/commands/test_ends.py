"""How commands end: one line and a status whatever fails, nothing replaced that is no file or that was read."""

import errno
import io
import os
import stat
import subprocess
import sys
import warnings
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml
from small_catalogue import CATALOGUE
from starters import STARTERS

from drivesizer import cli
from drivesizer.errors import InputError
from drivesizer.files.writing import check_targets, new, write_files
from drivesizer.output.export import files, one_axis

pytestmark = pytest.mark.skipif(os.name == "nt", reason="devices, pipes and signals of another kind")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to work in, with a spec and a small catalogue."""
    spec = yaml.safe_load((STARTERS / "flywheel.yaml").read_text(encoding="utf-8"))
    spec["select"] = {"catalogs": ["own.yaml"]}
    (tmp_path / "own.yaml").write_text(CATALOGUE)
    (tmp_path / "robot.yaml").write_text(yaml.safe_dump(spec))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def run(folder, monkeypatch, capfd):
    """Run a command in that folder; its status, stdout and stderr."""

    def call(*args):
        monkeypatch.setattr(sys, "argv", ["drivesizer", *map(str, args)])
        with pytest.raises(SystemExit) as end, warnings.catch_warnings():
            cli.main()
        out = capfd.readouterr()
        return end.value.code, out.out, out.err

    return call


# --- outputs ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["robot.yaml", "./robot.yaml", "link.csv", "hard.csv", "own.yaml"])
@pytest.mark.parametrize(
    "command",
    [
        ["size", "-q", "--csv"],
        ["validate", "--set", "m1/g1", "--csv"],
        ["report", "-o"],
        ["catalog", "export", "motors"],
    ],
)
def test_an_input_is_never_an_output(run, folder, command, name):
    os.link("robot.yaml", "hard.csv")
    (folder / "link.csv").symlink_to("robot.yaml")
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    if command[0] == "catalog":
        command = ["catalog", "export", "motors", "--catalog", "own.yaml", "-o"]
        if not name.endswith(".csv"):
            name = "own.csv"
            (folder / name).symlink_to("own.yaml")
            before[name] = (folder / "own.yaml").read_bytes()
        elif name != "own.csv":
            return  # it reads no spec
    status, _, err = run(*command, name)
    assert (status, err.count("\n")) == (2, 1)
    assert "is read in the same run" in err or "does not say which kind of report" in err
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    assert (folder / "link.csv").is_symlink()


def test_devices_and_pipes_are_written_into_and_stay_what_they_are(folder):
    os.mkfifo("pipe.csv")
    (folder / "nowhere.csv").symlink_to(os.devnull)
    with subprocess.Popen(["cat", "pipe.csv"], stdout=subprocess.PIPE) as reader:
        held = os.open("pipe.csv", os.O_WRONLY)  # waits until somebody reads
        write_files({Path("pipe.csv"): b"through", Path("nowhere.csv"): b"away", Path("file.csv"): b"kept"})
        os.close(held)
        assert reader.communicate(timeout=30)[0] == b"through"
    assert stat.S_ISFIFO(Path("pipe.csv").stat().st_mode)
    assert stat.S_ISCHR(Path("nowhere.csv").stat().st_mode) and Path("nowhere.csv").is_symlink()
    assert Path("file.csv").read_bytes() == b"kept"


def test_a_pipe_that_nobody_reads_is_refused_and_nothing_else_is_written(folder):
    os.mkfifo("pipe.csv")
    with pytest.raises(InputError, match=r"pipe\.csv: cannot be written"):
        write_files({Path("file.csv"): b"new", Path("pipe.csv"): b"new"})
    assert not Path("file.csv").exists() and not list(folder.glob(".drivesizer*"))


def test_standard_output_as_a_file_name(folder):
    command = [sys.executable, "-m", "drivesizer", "size", "-q", "--csv", "/dev/stdout"]
    with Path("out.txt").open("wb") as out:
        subprocess.run(command, stdout=out, check=True)
    lines = Path("out.txt").read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith("list,rank,status")
    assert "M 25" in lines[1] and len(lines) > 6  # the drives, and the text after them


@pytest.mark.parametrize(
    "command",
    [["size", "-q"], ["validate", "--set", "m1/g1"], ["explain", "--motor", "m1", "--gearhead", "g1"],
     ["report", "-o", "out.csv"], ["export", "--format", "json", "-o", "out.json"]],
)  # fmt: skip
def test_a_spec_through_a_pipe(run, folder, command):
    """What a pipe has can be read once: size, validate, explain and report read it twice, and found no fields."""
    spec = Path("robot.yaml").read_text().replace("own.yaml", str(folder / "own.yaml"))
    end, begin = os.pipe()
    os.write(begin, spec.encode())
    os.close(begin)
    status, _, err = run(*command, f"/dev/fd/{end}")
    os.close(end)
    assert status == 0, err


def test_what_is_protected_or_no_place_for_a_file_is_refused(folder, monkeypatch):
    Path("kept.csv").write_text("older")
    monkeypatch.setattr(os, "access", lambda path, mode: Path(path).name != "kept.csv")  # root may write everywhere
    Path("loop.csv").symlink_to("loop.csv")
    Path("astray.csv").symlink_to("nothing/there.csv")
    for name in ("kept.csv", "loop.csv", "astray.csv", "a" * 300 + ".csv", "a\0.csv", "no/file.csv", "."):
        with pytest.raises(InputError, match="cannot be written"):
            write_files({Path(name): b"new"})
    assert Path("kept.csv").read_text() == "older"
    Path("a.csv").symlink_to("b.csv")
    with pytest.raises(InputError, match=r"written twice, as a\.csv too"):
        check_targets([Path("a.csv"), Path("b.csv")])


def test_a_file_keeps_its_permissions(folder):
    """A report that only its owner may read stays so."""
    Path("private.csv").write_text("older")
    Path("private.csv").chmod(0o600)
    write_files({Path("private.csv"): b"new"})
    assert stat.S_IMODE(Path("private.csv").stat().st_mode) == 0o600


def test_a_new_file_is_whole_or_not_there(folder):
    (folder / "full.yaml").symlink_to("/dev/full")
    with pytest.raises(InputError, match="exists and is left alone"):
        new(Path("full.yaml"), b"x")
    with pytest.raises(InputError, match="exists and is left alone"):
        new(Path("robot.yaml"), b"x")
    new(Path("new.yaml"), b"x")
    assert Path("new.yaml").read_bytes() == b"x"


# --- ends -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("error", "status", "said"),
    [
        (ZeroDivisionError("float division by zero"), 70, "a fault of drivesizer itself (ZeroDivisionError: float div"),
        (RecursionError("deep"), 70, "a fault of drivesizer itself (RecursionError: deep); please report it; "),
        (OSError(errno.ENOSPC, "No space left on device", "a.csv"), 2, "a.csv: cannot be read or written (no space"),
        (OSError(errno.ENOSPC, "No space left on device"), 2, "the output cannot be written (no space left on device)"),
        (MemoryError(), 2, "more memory"),
        (InputError("f.yaml:1: a\x1b[31m\u202e\x85b\nc"), 2, r"drivesizer: f.yaml:1: a\x1b[31m\u202e b c"),
        (KeyboardInterrupt(), 130, ""),
        (BrokenPipeError(), 0, ""),
    ],
)  # fmt: skip
def test_whatever_fails_is_one_line_and_a_status(error, status, said, capsys, monkeypatch):
    def failing():
        raise error

    monkeypatch.delenv(cli.TRACEBACK, raising=False)
    assert cli.ended(failing) == status
    err = capsys.readouterr().err
    assert said in err
    assert err.count("\n") == bool(said) and err.rstrip("\n").isprintable()
    monkeypatch.setenv(cli.TRACEBACK, "1")
    cli.ended(failing)
    assert "Traceback" in capsys.readouterr().err


def test_letters_that_a_stream_lacks_are_written_out(monkeypatch):
    """In the locale C without UTF-8 mode Python's streams refuse them, and do not say "strict"."""
    for errors in ("strict", "surrogateescape"):
        out = io.TextIOWrapper(io.BytesIO(), encoding="ascii", errors=errors)
        monkeypatch.setattr(sys, "stdout", out)
        assert cli.ended(lambda: print("20 °C")) == 0
        assert out.buffer.getvalue().decode() == "20 \\xb0C\n"


def test_an_fmu_in_a_year_that_zip_files_do_not_know_is_one_line(monkeypatch):
    monkeypatch.setattr("time.time", lambda: 86_400.0)
    train = SimpleNamespace(motor_inertia=1e-6)
    drive = SimpleNamespace(name="x", gravity=9.81, stepper=False, train=train)
    with pytest.raises(InputError, match="no dates before 1980; set this machine's clock"):
        files(one_axis(drive), "fmu", Path("drive.fmu"))


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device of Linux")
@pytest.mark.parametrize("command", [["size"], ["size", "--json"], ["--help"]])
def test_a_full_standard_output_is_one_line(folder, command):
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(
            [sys.executable, "-m", "drivesizer", *command], stdout=full, stderr=-1, text=True, check=False
        )
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1] == "drivesizer: the output cannot be written (no space left on device)"
    assert "Traceback" not in done.stderr and "Exception" not in done.stderr


def test_ctrl_c_while_the_command_line_loads_is_quiet():
    code = """
import os, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job ignores it
class Impatient:
    def find_spec(self, name, *_):
        if name == "drivesizer.cli":
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Impatient())
from drivesizer.__main__ import main
main()
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "")
