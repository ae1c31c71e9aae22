"""Specs with one setting changed."""

from __future__ import annotations

from typing import Any

from drivesizer.spec.robot import RobotSpec

__all__ = ["estimates_off", "selecting"]


def selecting(spec: RobotSpec, **settings: Any) -> RobotSpec:
    """The spec with other settings of its selection."""
    return spec.model_copy(update={"select": spec.select.model_copy(update=settings)})


def estimates_off(spec: RobotSpec) -> RobotSpec:
    """The spec with figures that no data sheet gives unknown."""
    return selecting(spec, estimates="off")
