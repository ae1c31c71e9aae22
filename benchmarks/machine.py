"""The sizing of a six-joint arm with its drives' own masses, beside one of a single joint of it.

Over the whole maxon catalogue, in turns, catalogues compiled; a joint is sized as the spec that it is with the drives
on it. And the largest memory of a machine of twelve axes beside that of one, whole processes.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from goals import line
from second_start import second_start

from drivesizer.multi_axis import size_machine
from drivesizer.sizing import size
from drivesizer.spec.machine import load_machine

ARM = Path(__file__).resolve().parent.parent / "examples" / "six_joint_arm.yaml"
SIZE = [sys.executable, "-m", "drivesizer", "size"]
_AXIS = """\
  a{n}:
    load: {{kind: belt_axis, mass: {mass} kg, pulley_diameter: 40 mm}}
    motion: {{speed: 0.5 m/s, acceleration_time: 0.3 s, cruise_time: 0.5 s, rest_time: 0.5 s, there_and_back: true}}
{carries}"""


def seconds(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def machine(axes: int) -> str:
    """Axes that carry one another in a row."""
    rows = (
        _AXIS.format(n=n, mass=3 + n, carries=f"    carries: [a{n - 1}]\n" if n else "") for n in reversed(range(axes))
    )
    return f"name: row\nsupply: {{nominal: 48 V, current: 60 A, accepts: all}}\naxes:\n{''.join(rows)}"


def memory(command: list[str]) -> float:
    """Largest memory of a process [MB], measured by one that starts no other."""
    code = (
        "import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True, capture_output=True);"
        "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
    )
    return int(subprocess.check_output([sys.executable, "-c", code, *command])) / 1024


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=3, help="of each command")
    runs = parser.parse_args().runs
    with second_start() as folder:
        for axes in (1, 12):
            (folder / f"{axes}.yaml").write_text(machine(axes), encoding="utf-8")
        arm = load_machine(ARM)
        joints = [axis.spec for axis in size_machine(arm).axes]
        taken = [
            (seconds(lambda: size_machine(arm)), [seconds(lambda one=one: size(one)) for one in joints])
            for _ in range(runs)
        ]
        whole = min(arm for arm, _ in taken)
        single = [min(each) for each in zip(*(each for _, each in taken), strict=True)]
        mean = sum(single) / len(single)
        print(f"six joints {whole:.2f} s, one of them {mean:.2f} s in the mean")
        print(line("machine", whole / mean))
        one, twelve = (memory([*SIZE, str(folder / f"{axes}.yaml")]) for axes in (1, 12))
        print(f"largest memory of twelve axes {twelve:.0f} MB, of one {one:.0f} MB: {twelve / one:.2f}")


if __name__ == "__main__":
    main()
