"""A file that may have the spec of a single axis or a machine: what a machine needs is loaded where there is one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from drivesizer.files.yaml_source import YamlSource, read
from drivesizer.spec.drive import Select
from drivesizer.spec.machine_record import MachineSpec, machine_of
from drivesizer.spec.robot import read_spec


def is_machine(source: YamlSource) -> bool:
    """Whether a document has axes or joints, and is no spec of a single one."""
    return isinstance(source.data, dict) and ("axes" in source.data or "robot" in source.data)


def load_any(path: str | Path, change: Callable[[YamlSource], YamlSource] | None = None) -> MachineSpec:
    """The machine of a file, whose text may be changed first."""
    source = read(Path(path))
    return read_any(change(source) if change else source)


def read_any(source: YamlSource) -> MachineSpec:
    """The machine of YAML source; a plain spec is one of a single axis."""
    if not is_machine(source):
        return machine_of(read_spec(source))
    from drivesizer.spec.machine import read_machine

    return read_machine(source)


def named_catalogs(data: Any) -> list[str]:
    """Catalogues that a document names for all its axes; the default ones where it has none or a field is malformed."""
    axes, found = data.get("axes") if isinstance(data, dict) else None, list[list[str]]()
    for section in (data, *(axes.values() if isinstance(axes, dict) else ())):
        select = section.get("select") if isinstance(section, dict) else None
        given = select.get("catalogs") if isinstance(select, dict) else None
        names = given if isinstance(given, list) else [given]
        found.append([str(name) for name in names if isinstance(name, str | int)])
    every = [name for names in found for name in names]
    return list(dict.fromkeys(every if found[0] else [*Select().catalogs, *every]))
