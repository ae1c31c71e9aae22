"""A platform along some 90 m in periods of 1 ms, four wheels that slip: as machine code, and as plain Python.

Route and robot are those of the example; the kinematic model has nothing to work out beforehand, the dynamic one all
torques. Plain Python is timed on the first part of the way.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from drivesizer.platform import following, march_loop
from drivesizer.platform.following import Followed, Model, follow
from drivesizer.platform.following_example import FLOOR, OFF, paper_robot, paper_route
from drivesizer.platform.trajectory import Trajectory


def timed(act: Callable[[], Any], runs: int) -> tuple[float, Any]:
    best, found = np.inf, None
    for _ in range(runs):
        start = time.perf_counter()
        found = act()
        best = min(best, time.perf_counter() - start)
    return best, found


def driven(way: Trajectory, model: Model) -> Followed:
    return follow(way, paper_robot(), model=model, misjudged=OFF, contact=FLOOR)


def beginning(way: Trajectory, pieces: int) -> Trajectory:
    parts = (way.posture[:, :pieces], way.velocity[:, :pieces], way.acceleration[:, :pieces])
    return Trajectory(way.duration[:pieces], *parts)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--pieces", type=int, default=50, help="of the way, in plain Python")
    options = parser.parse_args()
    way = paper_route()
    first, found = timed(lambda: driven(way, "kinematic"), 1)
    print(f"{'first call, machine code made or read':40}{first:10.2f} s")
    for model in ("kinematic", "dynamic"):
        seconds, found = timed(lambda model=model: driven(way, model), options.runs)
        print(f"{f'{model} model, {len(found.planned.time):,} periods':40}{seconds:10.2f} s    goal: well under 1 s")
    part = beginning(way, options.pieces)
    fast, mine = timed(lambda: driven(part, "kinematic"), options.runs)
    following.compiled = lambda: march_loop.follow_one
    slow, plain = timed(lambda: driven(part, "kinematic"), 1)
    off = np.abs(mine.posture - plain.posture).max()
    print(f"{f'plain Python / machine code, {part.total:g} s':40}{slow / fast:10.0f}      they differ by {off:.0e}")


if __name__ == "__main__":
    main()
