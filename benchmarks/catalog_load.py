"""Time to load all shipped catalogues: from YAML (cold), and from the compiled files (warm)."""

from __future__ import annotations

import argparse
import os
import statistics
import tempfile
import time
from pathlib import Path

from drivesizer.catalog import load


def seconds() -> float:
    start = time.perf_counter()
    load(["all"])
    return time.perf_counter() - start


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=5, help="of each kind")
    runs = parser.parse_args().runs
    taken: dict[str, list[float]] = {"cold, from YAML": [], "warm, compiled": []}
    with tempfile.TemporaryDirectory() as cache:
        os.environ["DRIVESIZER_CACHE"] = cache
        seconds()  # imports
        for _ in range(runs):
            for file in Path(cache).iterdir():
                file.unlink()
            taken["cold, from YAML"].append(seconds())
            taken["warm, compiled"].append(seconds())
        size = sum(file.stat().st_size for file in Path(cache).iterdir())
    print(f"{'catalogue, ' + str(runs) + ' runs':24}{'best':>10}{'median':>10}")
    for name, times in taken.items():
        print(f"{name:24}{min(times) * 1e3:7.1f} ms{statistics.median(times) * 1e3:7.1f} ms")
    print(f"{'compiled files':24}{size / 1e6:7.1f} MB")


if __name__ == "__main__":
    main()
