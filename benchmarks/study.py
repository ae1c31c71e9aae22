"""Variants of a study per second, with one process and with two, beside `drivesizer size` once for each variant.

Whole processes in turns, so that a busy moment hits all; starting them is counted, maps are not. A study takes its
variants from the SPS robot as the paper has it, and a few from the whole catalogue. Read ratios, not seconds.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import time
from pathlib import Path

from goals import line
from second_start import second_start

SPEC = Path(__file__).resolve().parent.parent / "examples" / "sps_robot.yaml"
PROGRAM = [sys.executable, "-m", "drivesizer"]


def seconds(words: list[str], folder: Path) -> float:
    start = time.perf_counter()
    done = subprocess.run([*PROGRAM, *words], cwd=folder, capture_output=True, encoding="utf-8", check=False)
    if done.returncode > 1:  # 1: no drive passes
        raise SystemExit(done.stderr)
    return time.perf_counter() - start


def laid(folder: Path, variants: int, whole: bool) -> None:
    text = SPEC.read_text(encoding="utf-8")
    if whole:
        text = text[: text.index("select:")].replace("method: paper", "method: physics")
    (folder / "robot.yaml").write_text(text, encoding="utf-8")
    study = f"spec: robot.yaml\nvary: {{load.mass: {{from: 30 kg, to: 60 kg, steps: {variants}}}}}\n"
    (folder / "study.yaml").write_text(study, encoding="utf-8")


def rates(folder: Path, variants: int, single: int, runs: int) -> dict[str, float]:
    """Variants per second, the best of some runs of each."""
    best: dict[str, float] = {}
    for _ in range(runs):
        for processes in (1, 2):
            shutil.rmtree(folder / "study", ignore_errors=True)
            taken = seconds(["study", "--no-maps", "--processes", str(processes)], folder)
            name = f"study, {processes} process{'es' * (processes > 1)}"
            best[name] = max(best.get(name, 0.0), variants / taken)
        taken = sum(seconds(["size", "--quiet", "--top", "1"], folder) for _ in range(single))
        best["size, one by one"] = max(best.get("size, one by one", 0.0), single / taken)
    return best


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--variants", type=int, default=2000, help="of the small study")
    parser.add_argument("--large", type=int, default=40, help="variants over the whole catalogue")
    parser.add_argument("--runs", type=int, default=2, help="of each")
    given = parser.parse_args()
    with second_start() as folder:
        for title, variants, whole in (("the paper's robot", given.variants, False),
                                       ("whole catalogue", given.large, True)):  # fmt: skip
            laid(folder, variants, whole)
            seconds(["size", "--quiet"], folder)  # compiles the catalogue
            found = rates(folder, variants, 4, given.runs)
            for what, rate in found.items():
                ratio = rate / found["size, one by one"]
                print(f"{title + ', ' + str(variants):28}{what:22}{rate:9.2f} variants/s{ratio:8.1f}")
            if not whole:
                one, two = found["study, 1 process"], found["study, 2 processes"]
                print(line("variants", one), line("two processes", two / one), sep="\n")


if __name__ == "__main__":
    main()
