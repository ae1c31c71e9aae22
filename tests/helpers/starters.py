"""Starters as specs, with changes and parts of their own."""

from __future__ import annotations

from pathlib import Path

import drivesizer
from drivesizer.files.yaml_source import read
from drivesizer.spec.robot import RobotSpec, read_spec

STARTERS = Path(drivesizer.__file__).parent / "spec" / "starters"
CYCLE = "time,speed,torque\ns,rpm,N*m\n0,0,0.2\n0.5,40,1.4\n2.5,40,0.9\n3,0,-0.3\n4,0,0\n"


def changed(text: str, folder: Path, *pairs: tuple[str, str]) -> RobotSpec:
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    path = folder / "robot.yaml"
    path.write_text(text, encoding="utf-8")
    return read_spec(read(path))


def starter(kind: str, folder: Path, *pairs: tuple[str, str], more: str = "") -> RobotSpec:
    (folder / "cycle.csv").write_text(CYCLE)
    return changed((STARTERS / f"{kind}.yaml").read_text(encoding="utf-8") + more, folder, *pairs)
