"""Figures that the pages show of runs: the closed loop of the tutorial, the paper's robot on its path."""

from __future__ import annotations

from pathlib import Path

__all__ = ["closed_loop", "followed"]


def closed_loop(root: Path) -> bytes:
    """The figure of ``drivesizer validate --figures`` for the robot of the paper."""
    from drivesizer import load_spec, size, validate
    from drivesizer.output.report.figures.all_figures import loop_drawings

    spec = load_spec(root / "examples" / "sps_robot.yaml")
    proof = validate(spec, size(spec, top=1).sets[0])
    return loop_drawings(proof)["closed_loop"]("svg")


def followed(_: Path) -> bytes:
    """The simulated path beside the paper's with soft speed loops, and errors along the path."""
    from following_page import ran

    from drivesizer.control.path_following.runs import FollowingRun
    from drivesizer.output.report.figures.path import path_and_errors

    shown = {"kinematic": ("kinematic", True), "dynamic": ("dynamic", True), "dynamic, misjudged": ("dynamic", False)}
    return path_and_errors(
        {name: ran(FollowingRun(model, False, False, exact)) for name, (model, exact) in shown.items()}
    )
