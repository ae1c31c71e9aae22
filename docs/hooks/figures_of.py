"""Figures that the pages show of runs: the closed loop of the tutorial."""

from __future__ import annotations

from pathlib import Path

__all__ = ["closed_loop"]


def closed_loop(root: Path) -> bytes:
    """What ``drivesizer validate --figures`` draws of the robot of the paper."""
    from drivesizer import load_spec, size, validate
    from drivesizer.report.drawings import loop_drawings

    spec = load_spec(root / "examples" / "sps_robot.yaml")
    proof = validate(spec, size(spec, top=1).sets[0])
    return loop_drawings(proof)["closed_loop"]("svg")
