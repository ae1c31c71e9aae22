"""Starters as specs, with parts of their own."""

from __future__ import annotations

from pathlib import Path

import drivesizer
from drivesizer.files.yaml_source import read
from drivesizer.physics.thermal import TwoBodies
from drivesizer.spec.robot import RobotSpec, read_spec

STARTERS = Path(drivesizer.__file__).parent / "spec" / "starters"

BODIES = TwoBodies(R_25=2.32, R_th1=3.1, R_th2=14.0, tau_w=12.4, tau_h=612.0)


def starter(kind: str, folder: Path) -> RobotSpec:
    path = folder / f"{kind}.yaml"
    path.write_text((STARTERS / f"{kind}.yaml").read_text(encoding="utf-8"), encoding="utf-8")
    return read_spec(read(path))
