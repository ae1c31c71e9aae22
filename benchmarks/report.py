"""How long `drivesizer report` takes from the shell, beside `import control` on the same machine in the same minute.

Whole processes, taken in turns so that a busy moment hits both; catalogue and closed loop are compiled (second start).
Wall clock is what the reader waits for; processor time is what it costs, children included.
"""

from __future__ import annotations

import argparse
import resource
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

from goals import line
from second_start import second_start

CONTROL = "import control"
REPORTS = {"pdf": (".pdf",), "html": (".html",), "xlsx": (".xlsx",), "all reports": (".pdf", ".html", ".xlsx", ".csv")}
SPEC = Path(__file__).resolve().parent.parent / "examples" / "sps_robot.yaml"


class Taken(NamedTuple):
    """What a process took."""

    wall: float  # s
    processor: float  # s


def seconds(command: list[str]) -> Taken:
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(command, check=True, capture_output=True)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return Taken(wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=7, help="of each command")
    runs = parser.parse_args().runs
    with second_start() as place:
        commands = {name: report(place, suffixes) for name, suffixes in REPORTS.items()}
        commands[CONTROL] = [sys.executable, "-c", "import control"]
        for command in commands.values():
            seconds(command)  # compiles the catalogue and the page's template, and fills the disk cache
        taken: dict[str, list[Taken]] = {name: [] for name in commands}
        for _ in range(runs):
            for name, command in commands.items():
                taken[name].append(seconds(command))
    print_times(taken, runs)


def report(place: Path, suffixes: tuple[str, ...]) -> list[str]:
    """The command that writes reports of some kinds in one run."""
    files = [f"{place}/report{suffix}" for suffix in suffixes]
    return [sys.executable, "-m", "drivesizer", "report", str(SPEC), *(word for file in files for word in ("-o", file))]


def print_times(taken: dict[str, list[Taken]], runs: int) -> None:
    heads = ("wall best", "median", "CPU best", "median")
    print(f"{'report, ' + str(runs) + ' runs':24}" + "".join(f"{head:>12}" for head in heads))
    found = {
        name: [pick(column) for column in zip(*times, strict=True) for pick in (min, statistics.median)]
        for name, times in taken.items()
    }
    for name, row in found.items():
        print(f"{name:24}" + "".join(f"{value * 1e3:9.0f} ms" for value in row))
    for name in REPORTS:  # by processor time: wall clock hangs on what else the machine does
        print(line(name, found[name][-1] / found[CONTROL][-1]))


if __name__ == "__main__":
    main()
