"""A file that may have the spec of a single axis or a machine: what a machine needs is loaded where there is one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from drivesizer.files.yaml_source import YamlSource, read
from drivesizer.spec.machine_record import MachineSpec, machine_of
from drivesizer.spec.robot import RobotSpec, read_spec


def is_machine(source: YamlSource) -> bool:
    """Whether a document has axes or joints, and is no spec of a single one."""
    return isinstance(source.data, dict) and ("axes" in source.data or "robot" in source.data)


def load_any(path: str | Path, change: Callable[[YamlSource], YamlSource] | None = None) -> MachineSpec:
    """The machine of a file, whose text may be changed first; a plain spec is one of a single axis."""
    source = read(Path(path))
    found = read_any(change(source) if change else source)
    return machine_of(found) if isinstance(found, RobotSpec) else found


def read_any(source: YamlSource) -> RobotSpec | MachineSpec:
    """The spec of one axis or of a machine from YAML source, as it has one or the other."""
    if not is_machine(source):
        return read_spec(source)
    from drivesizer.spec.machine import read_machine

    return read_machine(source)
