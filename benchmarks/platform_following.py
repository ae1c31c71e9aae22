"""A platform along some 90 m in periods of 1 ms, four wheels that slip: as machine code, and as plain Python.

Route and robot are those of the example; the kinematic model needs no preparation, the dynamic one all
torques. Plain Python is timed on the first part of the path.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from drivesizer import load_spec
from drivesizer.control import path_following
from drivesizer.control.path_following import Followed, FollowingRun, Model, follow_case, kernel
from drivesizer.load_cases.platform import Driving, driving, with_trajectory
from drivesizer.platform.trajectory import Trajectory

EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "sps_following.yaml"


def timed(act: Callable[[], Any], runs: int) -> tuple[float, Any]:
    best, found = np.inf, None
    for _ in range(runs):
        start = time.perf_counter()
        found = act()
        best = min(best, time.perf_counter() - start)
    return best, found


def driven(found: Driving, model: Model) -> Followed:
    return follow_case(found, None, FollowingRun(model, integral=True, poses=False, exact=False))


def beginning(found: Driving, pieces: int) -> Driving:
    path = found.trajectory
    parts = (path.posture[:, :pieces], path.velocity[:, :pieces], path.acceleration[:, :pieces])
    return replace(found, trajectory=Trajectory(path.duration[:pieces], *parts))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--pieces", type=int, default=50, help="of the path, in plain Python")
    options = parser.parse_args()
    route = driving(with_trajectory(load_spec(EXAMPLE), None))
    first, found = timed(lambda: driven(route, "kinematic"), 1)
    print(f"{'first call, machine code made or read':40}{first:10.2f} s")
    for model in ("kinematic", "dynamic"):
        seconds, found = timed(lambda model=model: driven(route, model), options.runs)
        print(f"{f'{model} model, {len(found.planned.time):,} periods':40}{seconds:10.2f} s    goal: well under 1 s")
    part = beginning(route, options.pieces)
    fast, mine = timed(lambda: driven(part, "kinematic"), options.runs)
    path_following.machine_code = lambda _: kernel.follow_one
    slow, plain = timed(lambda: driven(part, "kinematic"), 1)
    off = np.abs(mine.posture - plain.posture).max()
    print(
        f"{f'plain Python / machine code, {part.trajectory.total:g} s':40}{slow / fast:10.0f}"
        f"      they differ by {off:.0e}"
    )


if __name__ == "__main__":
    main()
