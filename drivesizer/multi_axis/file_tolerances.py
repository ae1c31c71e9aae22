"""Figures of a machine's file that have a tolerance: which axis takes which, and which nothing takes."""

from __future__ import annotations

from collections.abc import Mapping

from drivesizer.files.yaml_source import Path_
from drivesizer.spec.several_axes.machine import MachineSpec
from drivesizer.spec.tolerance_text import Toleranced, split_tolerances

__all__ = ["OF_THE_SUPPLY", "place_of", "toleranced", "without_effect"]

OF_THE_SUPPLY = ("supply", "battery", "equipment", "brake_resistor", "environment")  # sections that its checks take


def toleranced(machine: MachineSpec) -> dict[Path_, Toleranced]:
    """Figures with a tolerance by their places in the file."""
    return {one.path: one for one in split_tolerances(machine.source)[1]}


def place_of(figures: Mapping[Path_, Toleranced], axis: str, path: Path_) -> Path_:
    """Place of an axis' figure in the file."""
    own = ("axes", axis, *path)
    return own if own in figures else path


def without_effect(machine: MachineSpec) -> tuple[str, ...]:
    """Figures with a tolerance that neither an axis nor the supply takes."""
    figures = toleranced(machine)
    used = {place_of(figures, axis.name, one.path) for axis in machine.axes for one in axis.spec.toleranced}
    used |= {("axes", axis.name, "start") for axis in machine.axes}
    lost = (path for path in figures if path not in used and path[0] not in OF_THE_SUPPLY)
    return tuple("".join(f"[{n + 1}]" if isinstance(n, int) else f".{n}" for n in path).lstrip(".") for path in lost)
