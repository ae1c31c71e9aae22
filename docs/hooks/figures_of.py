"""Figures that the pages show of runs: a closed loop, a set at the bench, the paper's robot on its path."""

from __future__ import annotations

from pathlib import Path

__all__ = ["at_the_bench", "closed_loop", "followed"]


def closed_loop(root: Path) -> bytes:
    """The figure of ``drivesizer validate --figures`` for the robot of the paper."""
    from drivesizer import load_spec, size, validate
    from drivesizer.output.report.figures.all_figures import loop_drawings

    spec = load_spec(root / "examples" / "sps_robot.yaml")
    proof = validate(spec, size(spec, top=1).sets[0])
    return loop_drawings(proof)["closed_loop"]("svg")


def at_the_bench(_: Path) -> bytes:
    """The figure of ``drivesizer predict --figure`` for the set of its page."""
    from math import nan

    from drivesizer.catalog import load
    from drivesizer.catalog.query import Hit
    from drivesizer.output.report.figures.prediction import bench
    from drivesizer.prediction.predict import completed, predict
    from drivesizer.results.prediction import Conditions

    maxon, parts = load(["maxon"]), {"motors": "DCX22S01EBKL598", "gearheads": "GPX22HPKLSL44D0CPLW"}
    motor, gearhead = (Hit("maxon", maxon, name, maxon.table(name).rows[part]) for name, part in parts.items())
    given = Conditions(voltage=nan, ambient=298.15, load=0.4, hold=nan, inertia=0.0, duration=3600.0, warm=nan,
                       resistance=0.0)  # fmt: skip
    return bench(predict(motor, gearhead, None, completed(given, motor, gearhead)))


def followed(_: Path) -> bytes:
    """The simulated path beside the paper's with soft speed loops, and errors along the path."""
    from following_page import ran

    from drivesizer.control.path_following.runs import FollowingRun
    from drivesizer.output.report.figures.path import path_and_errors

    shown = {"kinematic": ("kinematic", True), "dynamic": ("dynamic", True), "dynamic, misjudged": ("dynamic", False)}
    return path_and_errors(
        {name: ran(FollowingRun(model, False, False, exact)) for name, (model, exact) in shown.items()}
    )
