"""A file that may have the spec of a single axis or a machine: what a machine needs is loaded where there is one."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from drivesizer.files.yaml_source import YamlSource, read
from drivesizer.spec.robot import RobotSpec, read_spec

if TYPE_CHECKING:
    from drivesizer.spec.machine import MachineSpec

__all__ = ["is_machine", "load_any", "read_any"]


def is_machine(source: YamlSource) -> bool:
    """Whether a document has axes or joints, and is no spec of a single one."""
    return isinstance(source.data, dict) and ("axes" in source.data or "robot" in source.data)


def load_any(path: str | Path) -> RobotSpec | MachineSpec:
    """The spec of one axis or of a machine, as the file has one or the other."""
    return read_any(read(Path(path)))


def read_any(source: YamlSource) -> RobotSpec | MachineSpec:
    """The spec of one axis or of a machine from YAML source; see :func:`load_any`."""
    if not is_machine(source):
        return read_spec(source)
    from drivesizer.spec.machine import read_machine

    return read_machine(source)
