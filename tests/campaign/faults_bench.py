"""Commands in a folder of their own, run with something amiss, and what may be said of how they ended."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import yaml

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "helpers"))
from documents import URDF  # noqa: E402
from small_catalogue import CATALOGUE, MAP, TABLE  # noqa: E402
from starters import STARTERS  # noqa: E402

__all__ = [
    "COMMANDS",
    "INPUTS",
    "Command",
    "Run",
    "complaints",
    "ended",
    "fresh",
    "laid",
    "outputs",
    "program",
    "references",
    "started",
    "surroundings",
]

WAIT = 120.0  # s, after which a command hangs
STUDY = """\
spec: robot.yaml
vary:
  load.inertia: {from: 60 kg*cm^2, to: 90 kg*cm^2, steps: 3}
  motion.speed: [1000 rpm, 1200 rpm]
objectives: [mass]
"""


class Command(NamedTuple):
    """Words of a command, and the files or folders that it writes."""

    words: str
    outputs: tuple[str, ...] = ()


OWN = "--catalog own.yaml"
COMMANDS: dict[str, Command] = {
    "help": Command("--help"),
    "no words": Command(""),
    "init": Command("init --kind hoist -o new.yaml", ("new.yaml",)),
    "init urdf": Command("init --from-urdf robot.urdf -o new.yaml", ("new.yaml",)),
    "size": Command("size --csv out.csv", ("out.csv",)),
    "size json": Command("size --json"),
    "size machine": Command("size machine.yaml --csv out.csv --pdf out.pdf", ("out.csv", "out.pdf")),
    "explain": Command("explain robot.yaml --motor m1 --gearhead g1"),
    "validate": Command("validate --set m1/g1 --csv out.csv", ("out.csv",)),
    "validate figures": Command(
        "validate --set m1/g1 --figures drawn", ("drawn/closed_loop.svg", "drawn/closed_loop.png", "drawn/step.svg")
    ),
    "drive": Command("drive platform.yaml --csv out.csv", ("out.csv",)),
    "report": Command("report -o out.html -o out.csv", ("out.html", "out.csv")),
    "report pdf": Command("report -o out.pdf", ("out.pdf",)),
    "report xlsx": Command("report -o out.xlsx -o out.json", ("out.xlsx", "out.json")),
    "report machine": Command("report machine.yaml -o out.html", ("out.html",)),
    "predict": Command(f"predict m1 {OWN} --voltage 24V --figure out.svg", ("out.svg",)),
    "export": Command("export --format mjcf -o out.xml", ("out.xml",)),
    "export fmu": Command("export --format fmu -o out.fmu", ("out.fmu",)),
    "study": Command("study --processes 1 -o results", ("results/results.csv",)),
    "equations": Command("equations"),
    "schema": Command("schema"),
    "doctor": Command("doctor"),
    "catalog": Command("catalog"),
    "catalog list": Command(f"catalog list motors {OWN}"),
    "catalog show": Command(f"catalog show m1 {OWN}"),
    "catalog compare": Command(f"catalog compare m1 m2 {OWN}"),
    "catalog search": Command(f"catalog search m1 {OWN}"),
    "catalog stats": Command(f"catalog stats {OWN}"),
    "catalog check": Command(f"catalog check {OWN}"),
    "catalog export": Command(f"catalog export motors {OWN} -o out.csv", ("out.csv",)),
    "catalog import": Command("catalog import parts.csv --section motors --map map.yaml -o new.yaml", ("new.yaml",)),
}


def _machine(spec: str) -> str:
    """A machine of two axes, each with the load of a spec."""
    shared = yaml.safe_load(spec)
    axes = {name: {key: yaml.safe_load(spec)[key] for key in ("load", "motion", "transmission")} for name in "ab"}
    return yaml.safe_dump({**{key: shared[key] for key in shared.keys() - axes["a"].keys()}, "axes": axes})


def laid(folder: Path) -> Path:
    """A folder with all that the commands read."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, starter in {"robot": "flywheel", "platform": "mecanum_platform"}.items():
        spec = yaml.safe_load((STARTERS / f"{starter}.yaml").read_text(encoding="utf-8"))
        spec["select"] = {"catalogs": ["own.yaml"]}
        if name == "platform":
            spec["motion"] = {"waypoints": [{"x": "0 m", "y": "0 m", "heading": "0 deg"},
                                            {"x": "1 m", "y": "0 m", "heading": "0 deg"}]}  # fmt: skip
        (folder / f"{name}.yaml").write_text(yaml.safe_dump(spec, sort_keys=False), encoding="utf-8")
    texts = {"own.yaml": CATALOGUE, "map.yaml": MAP, "parts.csv": TABLE, "study.yaml": STUDY, "robot.urdf": URDF}
    texts["machine.yaml"] = _machine((folder / "robot.yaml").read_text(encoding="utf-8"))
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder


def program(command: str) -> list[str]:
    """Words that run a command with this Python."""
    return [sys.executable, "-m", "drivesizer", *COMMANDS[command].words.split()]


def surroundings(cache: Path | None, **changed: str | None) -> dict[str, str]:
    """The environment of a command: this tree's program, and a cache folder; None takes a variable away."""
    env: dict[str, str | None] = {**os.environ, "PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"}
    env |= {"DRIVESIZER_CACHE": None if cache is None else str(cache), "DRIVESIZER_TRACEBACK": None, **changed}
    return {name: value for name, value in env.items() if value is not None}


class Run(NamedTuple):
    """How a command ended: its status, None where it hung; what it printed."""

    status: int | None
    out: bytes
    err: bytes


def started(command: str, folder: Path, env: dict[str, str], words: list[str] | None = None,
            **more: Any) -> subprocess.Popen[bytes]:  # fmt: skip
    """A command as a process of a group of its own."""
    streams: dict[str, Any] = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen(
        words or program(command), cwd=folder, env=env, start_new_session=True, **{**streams, **more}
    )


def ended(process: subprocess.Popen[bytes], patience: float = WAIT) -> Run:
    """Wait for a process; one that hangs is killed with its group."""
    try:
        out, err = process.communicate(timeout=patience)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, 9)
        out, err = process.communicate()
        return Run(None, out or b"", err or b"")
    return Run(process.returncode, out or b"", err or b"")


def outputs(command: str, folder: Path) -> dict[str, bytes]:
    """Content of the files that a command writes, as far as they are there."""
    return {name: (folder / name).read_bytes() for name in COMMANDS[command].outputs if (folder / name).is_file()}


def references(cache: Path, names: list[str]) -> dict[str, tuple[Run, dict[str, bytes]]]:
    """Each command as it ends with nothing amiss, and its files."""
    found = {}
    for name in names:
        with fresh() as folder:
            run = ended(started(name, folder, surroundings(cache)))
            found[name] = run, outputs(name, folder)
            assert run.status in (0, 1), (name, run)
    return found


@contextmanager
def fresh() -> Iterator[Path]:
    """A folder with all inputs, for one run."""
    place = Path(tempfile.mkdtemp(prefix="faults-"))
    try:
        yield laid(place / "work")
    finally:
        shutil.rmtree(place, ignore_errors=True)


INPUTS = (
    "robot.yaml", "machine.yaml", "robot.urdf", "platform.yaml", "own.yaml", "map.yaml", "parts.csv", "study.yaml",
)  # fmt: skip


def complaints(command: str, run: Run, folder: Path, whole: dict[str, bytes], before: dict[str, bytes],
               allowed: Callable[[int], bool] = lambda status: status in (0, 1, 2)) -> list[str]:  # fmt: skip
    """All that is wrong with how a command ended.

    Parameters
    ----------
    command, run, folder
        What ended, how, and where.
    whole
        Its files as they are with nothing amiss.
    before
        Content of its files before the run, where it replaces any.
    allowed
        Whether an exit status is one that may be.

    Returns
    -------
    list[str]
        A line for each; empty where it ended as it should.
    """
    err = run.err.decode("utf-8", "replace")
    found = []
    if run.status is None:
        found.append("hangs")
    elif not allowed(run.status):
        found.append(f"status {run.status}")
    for word in ("Traceback", "Exception ignored", "a fault of drivesizer", "Fatal Python", "Error in sys"):
        if word in err or word.encode() in run.out:
            found.append(f"prints {word!r}")
    said = [line for line in err.splitlines() if not line.startswith("note: ") and not line.endswith(" written")]
    if run.status == 2 and run.err and len(said) != 1:
        found.append(f"{len(err.splitlines())} lines at status 2")
    for name, content in outputs(command, folder).items():
        if content not in (whole.get(name), before.get(name)):
            found.append(f"{name} is half written: {len(content)} of {len(whole.get(name, b''))} bytes")
    if run.status in (0, 1) and outputs(command, folder).keys() < whole.keys():
        found.append("files are missing at status 0")
    found += [f"leaves {path.name}" for path in folder.rglob(".*") if path.name.endswith(".part")]
    return found
