"""How long `drivesizer size` takes from the shell, beside `import control` on the same machine in the same minute.

Whole processes, taken in turns so that a busy moment hits both; catalogue and modules are
compiled (second start).
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import time
from pathlib import Path

from second_start import second_start

SPEC = Path(__file__).resolve().parent.parent / "examples" / "sps_robot.yaml"
COMMANDS = {
    "drivesizer size": [sys.executable, "-m", "drivesizer", "size", str(SPEC)],
    "import control": [sys.executable, "-c", "import control"],
    "import numpy": [sys.executable, "-c", "import numpy"],
    "bare python": [sys.executable, "-c", ""],
}


def seconds(command: list[str]) -> float:
    start = time.perf_counter()
    subprocess.run(command, check=True, capture_output=True)
    return time.perf_counter() - start


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=10, help="of each command")
    runs = parser.parse_args().runs
    with second_start():
        for command in COMMANDS.values():
            seconds(command)  # compiles the catalogue and fills the disk cache
        taken: dict[str, list[float]] = {name: [] for name in COMMANDS}
        for _ in range(runs):
            for name, command in COMMANDS.items():
                taken[name].append(seconds(command))
    print(f"{'start, ' + str(runs) + ' runs':24}{'best':>10}{'median':>10}")
    for name, times in taken.items():
        print(f"{name:24}{min(times) * 1e3:7.0f} ms{statistics.median(times) * 1e3:7.0f} ms")
    ours, theirs = taken["drivesizer size"], taken["import control"]
    best, middle = min(ours) / min(theirs), statistics.median(ours) / statistics.median(theirs)
    print(f"{'size / control':24}{best:10.2f}{middle:10.2f}   goal: at most 0.50")


if __name__ == "__main__":
    main()
