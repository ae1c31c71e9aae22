"""A day's recording at 100 Hz, 10 million noisy samples, read and sized: processor seconds and largest memory.

Whole processes over recordings of one seed, of a thousand samples and of many. What each further sample takes is
carried on to 10 million where these are more: what is printed then is no measured day, and says so.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

import numpy as np
from goals import line
from second_start import second_start

DAY = 10_000_000  # samples
FEW = 1000
_LONG = 40_000
_AT_ONCE = 100_000
_STEP = 0.01  # s
SPEC = """\
name: a day
load: {kind: recorded, file: day.csv, smoothing: 1 s}
transmission: [{kind: gearhead}]
supply: {nominal: 24 V, min: 22 V, max: 26 V, regeneration: 0}
select: {catalogs: [maxon], objective: mass}
"""
# runs a command, and prints what it took [s], [MB]; by a process that starts no other
MEASURED = """\
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True, capture_output=True)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_utime + used.ru_stime, used.ru_maxrss / 1024)
"""


def written(folder: Path, samples: int) -> Path:
    """The spec, and so many samples of a load that goes to and fro, never twice alike."""
    noise = np.random.default_rng(1)
    with (folder / "day.csv").open("w", encoding="utf-8") as file:
        file.write("time,speed,torque\ns,rad/s,N*m\n")
        for first in range(0, samples, _AT_ONCE):
            t = np.arange(first, min(first + _AT_ONCE, samples)) * _STEP
            speed = 8.0 * np.sin(2.0 * np.pi * t / 12.0) * (1.0 + 0.3 * np.sin(2.0 * np.pi * t / 3600.0))
            torque = 1.5 * np.cos(2.0 * np.pi * t / 12.0) + np.sign(speed) + 0.1 * noise.normal(size=len(t))
            file.writelines(f"{a:.2f},{b:.4f},{c:.4f}\n" for a, b, c in zip(t, speed, torque, strict=True))
    spec = folder / "day.yaml"
    spec.write_text(SPEC, encoding="utf-8")
    return spec


def taken(folder: Path, samples: int) -> tuple[float, float]:
    """Processor time [s] and largest memory [MB] of a process that sizes so many."""
    size = [sys.executable, "-m", "drivesizer", "size", str(written(folder, samples))]
    seconds, megabytes = subprocess.check_output([sys.executable, "-c", MEASURED, *size]).split()
    return float(seconds), float(megabytes)


def carried_on(few: float, many: float, samples: int) -> float:
    """A day's figure, from those of few samples and of many."""
    return many + (many - few) / (samples - FEW) * (DAY - samples)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=int, default=200_000, help="that are sized, at most a day's 10 million")
    samples = parser.parse_args().samples
    with second_start() as folder:
        taken(folder, _LONG)  # compiles the catalogue and the modules, and makes the machine code
        few, many = taken(folder, FEW), taken(folder, samples)
    for count, (seconds, megabytes) in ((FEW, few), (samples, many)):
        print(f"{count:12,} samples{seconds:12.1f} s of the processor{megabytes:12,.0f} MB")
    print(f"each further sample{(many[0] - few[0]) / (samples - FEW) * 1e6:13.1f} us")
    if samples < DAY:
        print(f"a day, carried on from {samples:,} samples:")
    for name, low, high in zip(("day", "day's memory"), few, many, strict=True):
        print(line(name, carried_on(low, high, samples)))


if __name__ == "__main__":
    main()
