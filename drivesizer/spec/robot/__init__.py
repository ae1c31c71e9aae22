"""A robot.yaml as typed data: its model, what is refused in the whole, and how it is read."""

from __future__ import annotations

from drivesizer.spec.robot.model import AS_SPECIFIED, RobotSpec
from drivesizer.spec.robot.reading import load_spec, read_spec

__all__ = ["AS_SPECIFIED", "RobotSpec", "load_spec", "read_spec"]
