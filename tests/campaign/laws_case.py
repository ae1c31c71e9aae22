"""What the laws compare: a random machine with its sizing and some of its drives, and where two drives differ."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from math import isclose, isnan
from pathlib import Path
from typing import Any, NamedTuple
from unittest.mock import patch

import yaml
from laws_machines import WHOLE, Plain, catalogue, machine, robot

from drivesizer import sizing
from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.multi_axis import size_machine
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import SizingResult
from drivesizer.spec.machine import load_machine
from drivesizer.spec.robot import RobotSpec, read_spec

__all__ = [
    "DRIVES",
    "SAME",
    "Case",
    "alike",
    "brief",
    "case_of",
    "differences",
    "joints_of",
    "parts_of",
    "same_everywhere",
    "spec_of",
]

DRIVES = 3  # of a machine that are looked at, best ones and closest rejected
SAME = 1e-8  # of a figure, within which it is the same


class Case(NamedTuple):
    """A machine, its sizing, and its first drives, each explained alone."""

    data: Plain
    folder: Path
    found: SizingResult
    explained: tuple[DriveSet, ...]
    drives: tuple[DriveSet, ...]  # of these the one that most laws look at; which, is the machine's number

    def again(self, data: Plain, drive: DriveSet) -> DriveSet:
        """The same motor, gearhead and belt for another spec."""
        spec = spec_of(data, self.folder)
        parts = catalogue(*spec.select.catalogs)
        return explained(spec, drive, parts)


@contextmanager
def brief() -> Iterator[None]:
    """Sizing without what would let a drive pass: nineteen twentieths of an explanation, and no law looks at it."""
    with patch.object(sizing, "changes_for", lambda *_: ()), patch.object(sizing, "relaxations", lambda *_: ()):
        yield


def spec_of(data: Plain, folder: Path) -> RobotSpec:
    return read_spec(YamlSource(yaml.safe_dump(data, sort_keys=False), str(folder / "robot.yaml")))


def explained(spec: RobotSpec, drive: DriveSet, parts: Any) -> DriveSet:
    made = sizing.explain(spec, drive.motor.part, "" if drive.actuator else drive.gearhead.part, catalog=parts)
    return min(made, key=lambda one: abs(one.belt_ratio - drive.belt_ratio))


def case_of(number: int, folder: Path, *, whole: bool = False, alone: bool = True) -> Case | None:
    """The machine of a number, with all catalogues or its own; None where no drive is to be looked at.

    ``alone``: explain its first drives too. Without that a machine with all catalogues costs a second: its objective is
    mass but for each fifth, for energy needs the waveform of each drive.
    """
    data = machine(number, folder)
    if whole:
        data["select"]["catalogs"] = WHOLE
        if not alone and number % 5:
            data["select"]["objective"] = "mass"
    try:
        spec = spec_of(data, folder)
        parts = catalogue(*spec.select.catalogs)
        found = sizing.size(spec, catalog=parts, top=DRIVES, detail="full" if alone else "drives")
    except InputError:
        return None
    some = (*found.sets, *found.misses)[:DRIVES]
    each = tuple(explained(spec, one, parts) for one in some) if alone else some
    return Case(data, folder, found, each, (each[number % len(each)],)) if each else None


def joints_of(number: int, folder: Path) -> list[Case]:
    """The sizing of each joint of the robot of a number; none where it is refused."""
    (folder / "arm.yaml").write_text(yaml.safe_dump(robot(number, folder), sort_keys=False), encoding="utf-8")
    try:
        sized = size_machine(load_machine(folder / "arm.yaml"), top=DRIVES)
    except InputError:
        return []
    return [Case({}, folder, one.result, (), ()) for one in sized.axes]


def parts_of(drive: DriveSet) -> tuple[str, ...]:
    return tuple(
        part.part if part else "none"
        for part in (drive.motor, drive.gearhead, drive.encoder, drive.controller, drive.brake)
    )


def alike(one: float, other: float) -> bool:
    return (isnan(one) and isnan(other)) or one == other or isclose(one, other, rel_tol=SAME, abs_tol=1e-12)


def differences(one: DriveSet, other: DriveSet) -> Iterator[str]:
    """What two drives that should be one and the same have different: parts, checks, demands, limits, verdicts."""
    if parts_of(one) != parts_of(other):
        yield f"parts {parts_of(one)} / {parts_of(other)}"
    first, second = ({c.name: c for c in drive.own_checks} for drive in (one, other))
    if first.keys() != second.keys():
        yield f"checks {sorted(first.keys() ^ second.keys())}"
    for name in first.keys() & second.keys():
        a, b = first[name], second[name]
        if a.status != b.status and not (alike(a.demand, b.demand) and isclose(a.demand, a.limit, rel_tol=1e-7)):
            yield f"{name} {a.status} / {b.status} ({a.demand:.6g} of {a.limit:.6g} / {b.demand:.6g} of {b.limit:.6g})"
        elif not (alike(a.demand, b.demand) and alike(a.limit, b.limit)):
            yield f"{name} {a.demand!r} of {a.limit!r} / {b.demand!r} of {b.limit!r}"


def same_everywhere(case: Case, other: Plain) -> Iterator[str]:
    for drive in case.drives:
        for text in differences(drive, case.again(other, drive)):
            yield f"{drive.label}: {text}"
