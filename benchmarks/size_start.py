"""How long a command takes from the shell, beside `import control` on the same machine in the same minute.

Whole processes, taken in turns so that a busy moment hits all of them; catalogue and modules are compiled (second
start). Then the first commands on a new machine, which has modules but neither a compiled catalogue nor machine code.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from goals import line
from second_start import second_start

SPEC = str(Path(__file__).resolve().parent.parent / "examples" / "sps_robot.yaml")
RUN = [sys.executable, "-m", "drivesizer"]
# as the installed script, whose name the shell's request carries
SCRIPT = "import sys; sys.argv[0] = 'drivesizer'; from drivesizer.__main__ import main; main()"
REQUEST = {"_DRIVESIZER_COMPLETE": "complete_bash", "COMP_WORDS": "drivesizer val", "COMP_CWORD": "1"}
COMMANDS: dict[str, list[str]] = {
    "size": [*RUN, "size", SPEC],
    "help": [*RUN, "--help"],
    "version": [*RUN, "--version"],
    "completion": [sys.executable, "-c", SCRIPT],
    "import control": [sys.executable, "-c", "import control"],
    # what size cannot do without: below that it cannot come
    "its packages alone": [sys.executable, "-c", "import numpy, pydantic.types, yaml, typer"],
    "import numpy": [sys.executable, "-c", "import numpy"],
    "bare python": [sys.executable, "-c", ""],
}
FIRST = {"size": [*RUN, "size", SPEC], "validate": [*RUN, "validate", SPEC]}


def seconds(command: list[str], **environment: str) -> float:
    start = time.perf_counter()
    done = subprocess.run(command, capture_output=True, check=False, env=os.environ | environment)
    taken = time.perf_counter() - start
    if done.returncode or (environment.get("COMP_WORDS") and b"validate" not in done.stdout):
        raise SystemExit(f"{' '.join(command)}: exit status {done.returncode}, {done.stderr.decode()}")
    return taken


def of(name: str) -> float:
    return seconds(COMMANDS[name], **(REQUEST if name == "completion" else {}))


def first(command: list[str]) -> float:
    """A command with an empty cache."""
    with tempfile.TemporaryDirectory() as empty:
        return seconds(command, DRIVESIZER_CACHE=empty)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=10, help="of each command")
    runs = parser.parse_args().runs
    with second_start():
        for name in COMMANDS:
            of(name)  # compiles the catalogue and fills the disk cache
        seconds(FIRST["validate"])
        taken: dict[str, list[float]] = {name: [] for name in COMMANDS}
        new: dict[str, list[float]] = {name: [] for name in FIRST}
        later: list[float] = []
        for n in range(runs):
            for name in COMMANDS:
                taken[name].append(of(name))
            if n < 3:
                for name, command in FIRST.items():
                    new[name].append(first(command))
                later.append(seconds(FIRST["validate"]))
    taken |= {f"first {name}": times for name, times in new.items()} | {"later validate": later}
    beside = min(taken["import control"])
    print(f"{'start, ' + str(runs) + ' runs':24}{'best':>10}{'median':>10}{'best / control':>16}")
    for name, times in taken.items():
        best = min(times)
        print(f"{name:24}{best * 1e3:7.0f} ms{statistics.median(times) * 1e3:7.0f} ms{best / beside:16.2f}")
    for name in ("size", "help", "version", "completion"):
        print(line(name, min(taken[name]) / beside))
    print(line("first validate", min(taken["first validate"])))


if __name__ == "__main__":
    main()
