"""What the tests of studies share: a cheap spec, a study of it, and the program as a process of its own."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = (ROOT / "examples" / "sps_robot.yaml").read_text(encoding="utf-8")
# without battery, platform and requirements the paper's robot takes some milliseconds
CHEAP = re.sub(r"(?ms)^(?:battery|equipment|platform|requirements):.*?(?=^\w|\Z)", "", EXAMPLE)
MANY = """\
spec: robot.yaml
vary:
  load.mass: {from: 20 kg, to: 90 kg, steps: 25}
  motion.speed: {from: 0.5 m/s, to: 2 m/s, steps: 20}
"""
FEW = """\
spec: robot.yaml
vary:
  load.mass: {from: 30 kg, to: 88 lb, steps: 2}
  motion.speed: [1 m/s, 5.4 km/h]
"""


def laid(folder: Path, study: str, spec: str = CHEAP, name: str = "study") -> Path:
    """A study and its spec as files."""
    (folder / "robot.yaml").write_text(spec, encoding="utf-8")
    path = folder / f"{name}.yaml"
    path.write_text(study, encoding="utf-8")
    return path


def command(*words: object) -> list[str]:
    """`drivesizer study` with some words, as a process."""
    return [sys.executable, "-m", "drivesizer", "study", *map(str, words)]


# Keeps so many lines of rows and waits for a file "go": the moment at which it is stopped, however busy the machine is.
HALTED = """
import sys, time
from pathlib import Path
from drivesizer.study.store import Store

def keep(store, part, real=Store.keep, most=int(sys.argv.pop(1))):
    real(store, part)
    if store.path.read_bytes().count(b"\\n") >= most:
        while not Path("go").exists():
            time.sleep(0.05)

Store.keep = keep
from drivesizer.__main__ import main
main()
"""


def halted(points: int, *words: object) -> list[str]:
    """The same, which waits in the middle: when it has kept so many points."""
    return [sys.executable, "-c", HALTED, str(points), "study", *map(str, words)]


def surroundings() -> dict[str, str]:
    """What such a process is started with, wherever the package is."""
    return {**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "80"}


def ran(folder: Path, *words: object) -> subprocess.CompletedProcess[str]:
    """The program in a folder until it ends."""
    return subprocess.run(
        command(*words), cwd=folder, env=surroundings(), capture_output=True, encoding="utf-8", timeout=170, check=False
    )


def results(folder: Path) -> dict[str, bytes]:
    """The files of a study that is done, by name."""
    paths = sorted(path for path in folder.rglob("*") if path.is_file() and path.name not in ("lock", "rows.jsonl"))
    return {str(path.relative_to(folder)): path.read_bytes() for path in paths}
