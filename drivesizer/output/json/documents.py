"""Results as JSON: the records themselves, by the names of their fields, in SI; null where a figure is unknown.

A field that is added to a record is in the document, and in its schema, without a line here. ``_LEFT_OUT`` has the
fields that no document has, ``_COMPUTED_FIELDS`` what stands beside the others or in place of one.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from math import isfinite
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from drivesizer.control.validation import LinearRun, Loop, Validation
from drivesizer.output.loop_table import settled
from drivesizer.output.parts import SharedLine, machine_parts_of_axes
from drivesizer.output.thinning import curve_points
from drivesizer.results.check import LoopShare, Reliability
from drivesizer.results.check_kinds import missing_figures
from drivesizer.results.drive_set import DriveParts, DriveSet, EnergyBudget, MassRow, Requirement
from drivesizer.results.identification import Comparison, Identification, IdentifiedFigure
from drivesizer.results.machine import AxisSizing, Course, MachinePower, MachineSizing
from drivesizer.results.sizing import SizingResult
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import KINDS
from drivesizer.version import __version__

if TYPE_CHECKING:
    from drivesizer.control.path_following import Extreme, Followed
    from drivesizer.load_cases.platform import Driving
    from drivesizer.machine.platform_budget import PermittedSpeeds
    from drivesizer.output.platform import PlatformNumbers


SCHEMA: Final = 2
MOST_SAMPLES = 2000  # of the time series: finer than a screen
_MOST_POINTS = 200  # of a curve
_BODE = {"frequency": "Hz", "open_magnitude": "1", "open_phase": "rad", "closed_magnitude": "1", "closed_phase": "rad"}


def as_text(document: Any) -> str:
    """A document as JSON text: the version of this contract and of the program, then what it is of."""
    head = {"schema": SCHEMA, "drivesizer": __version__}
    return json.dumps(head | plain(document), allow_nan=False, ensure_ascii=False, indent=2)


def plain(value: Any) -> Any:
    """A record, or several, as plain data; a figure that is unknown or unbounded is None."""
    if isinstance(value, float):
        return float(value) if isfinite(value) else None
    if value is None or isinstance(value, str | int):
        return value
    if isinstance(value, complex):
        return [value.real, value.imag]
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, Mapping):
        return {str(key): plain(inner) for key, inner in value.items()}
    if is_dataclass(value) or hasattr(value, "_fields"):
        record: type = value.__class__
        return {key: plain(of(value)) for key, of in keys(record).items()}
    return [plain(inner) for inner in value]


@cache
def keys(record: type) -> dict[str, Callable[[Any], Any]]:
    """The keys of a record, each with what it is of the record; the unit of a figure is SI as the figure is."""
    names: tuple[str, ...] = getattr(record, "_fields", ()) or tuple(field.name for field in fields(record))
    left_out = {name for of, out in _LEFT_OUT.items() if issubclass(record, of) for name in out}
    entries: dict[str, Callable[[Any], Any]] = {name: attrgetter(name) for name in names if name not in left_out}
    if {"kind", "unit"} <= entries.keys():
        entries["unit"] = lambda figure: figure.unit if figure.kind == "price" else KINDS[figure.kind].si
    return entries | added_keys(record)


def added_keys(record: type) -> dict[str, Callable[[Any], Any]]:
    """The keys of a record that are none of its fields, or stand in place of one."""
    additions: dict[str, Callable[[Any], Any]] = {}
    for base, entries in _COMPUTED_FIELDS.items():
        additions |= entries if issubclass(record, base) else {}
    return additions


# -- What stands beside the fields of a record, or in place of one; the type that a function returns is in the schema.


class Columns(NamedTuple):
    """Curves over the first of the columns: fewer points than were computed, with their peaks."""

    thinned_from: int  # so many points
    units: dict[str, str]  # SI, by column
    columns: dict[str, list[float]]


def _bode(loop: Loop) -> Columns:
    """Response over the frequency, open and closed."""
    rows = curve_points((loop.bode.open_magnitude, loop.bode.closed_magnitude), _MOST_POINTS)
    return Columns(len(loop.bode.frequency), _BODE, {name: getattr(loop.bode, name)[rows].tolist() for name in _BODE})


def _step(loop: Loop) -> Columns | None:
    """Response to a unit step until it has settled; null: of an unstable loop."""
    if not len(loop.step):
        return None
    rows = curve_points((loop.step[: settled(loop)],), _MOST_POINTS)
    curves = {"time": [float(n * loop.period) for n in rows], "response": loop.step[rows].tolist()}
    return Columns(len(loop.step), {"time": "s", "response": "1"}, curves)


def _entered(of: SizingResult | Validation) -> dict[str, Any]:
    """The spec as it was written."""
    return of.spec.entered


def _machine(sizing: MachineSizing) -> dict[str, Any]:
    """The machine's spec as it was written."""
    return sizing.machine.entered


def _catalogs(result: SizingResult) -> dict[str, str]:
    """Digest of each catalogue that was searched, by name."""
    return dict(result.catalog.digests)


def _value(requirement: Requirement) -> float:
    """SI."""
    return float(requirement.value)


def _missing(drive: DriveSet) -> list[str]:
    """Parts, and figures of parts, that unknown checks lack."""
    return missing_figures(drive)


def _course(power: MachinePower) -> Course:
    """Mean powers of pieces of time [W], of each axis in the order of ``axes`` and of all."""
    return power.course()


def _platform(result: SizingResult) -> PlatformNumbers | None:
    """Kinematics and dynamics of a platform; null: there is none."""
    if result.spec.platform is None:
        return None
    from drivesizer.output.platform import platform_numbers  # with what a spec without one need not load

    return platform_numbers(result.spec, result.reported)


def _si_unit(figure: IdentifiedFigure) -> str:
    """SI; of a kind without a name as it is shown."""
    return KINDS[figure.kind].si if figure.kind in KINDS else figure.unit


def _properties(record: type, *names: str) -> dict[str, Callable[[Any], Any]]:
    """Properties of a record that are keys too."""
    return {name: getattr(record, name).fget for name in names}


_LEFT_OUT: dict[type, set[str]] = {
    SizingResult: {"problem", "choices"},
    DriveParts: {"quickest", "pull_outs"},
    DriveSet: {"comparison"},
    Requirement: {"declared", "inputs"},
    EnergyBudget: {"duration", "power"},
    MachinePower: {"time", "drawn", "returned", "total", "left"},
    Validation: {"series", "series_units"},
    LinearRun: {"train", "series"},
    Identification: {"time", "traces"},
    Comparison: {"time", "traces"},
}
_COMPUTED_FIELDS: dict[type, dict[str, Callable[[Any], Any]]] = {
    MachineSizing: {"machine": _machine, **_properties(MachineSizing, "status", "total")},
    AxisSizing: _properties(AxisSizing, "drives"),
    SizingResult: {"spec": _entered, "catalogs": _catalogs, "platform_numbers": _platform},
    DriveSet: {"missing": _missing, **_properties(DriveSet, "label")},
    Requirement: {"value": _value, **_properties(Requirement, "equation")},
    MassRow: _properties(MassRow, "total"),
    Reliability: _properties(Reliability, "passing"),
    LoopShare: _properties(LoopShare, "passing"),
    MachinePower: {"course": _course},
    Validation: {"spec": _entered},
    Loop: {"bode": _bode, "step": _step},
    IdentifiedFigure: {"unit": _si_unit},
}


# -- Reports, and a platform on its path.


class MeasuredErrors(NamedTuple):
    """Largest errors of a real robot on the path."""

    name: str
    position: float  # m
    heading: float  # rad


class Run(NamedTuple):
    """Simulated path following."""

    largest: tuple[Extreme, ...]
    time_at_torque_limit: float  # share of the time, of the wheel that is at its limit longest


class OnPath(NamedTuple):
    """A platform on its path: steady speeds that its drives permit, and path following beside measured errors."""

    permitted_speeds: PermittedSpeeds | None
    measured: list[MeasuredErrors]
    following: dict[str, Run]  # by the name of the run


class Report(NamedTuple):
    """The part of a report beside the document of a sizing."""

    parts_list: list[SharedLine]  # of the whole machine


class ReportedAxis(NamedTuple):
    """The part of an axis of a report beside its sizing."""

    validation: Validation | None  # null: no drive passes, or it cannot be simulated
    series: Columns | None  # of this simulation, over time
    path: OnPath | None  # of a platform


def report(
    sizing: MachineSizing, proofs: Mapping[str, Validation], paths: Mapping[str, OnPath] | None = None
) -> dict[str, Any]:
    """A sizing with its parts list and the closed loop of the drive of each axis."""
    document: dict[str, Any] = plain(sizing) | plain(Report(machine_parts_of_axes(sizing)))
    for axis in document["axes"]:
        proof = proofs.get(axis["name"])
        more = ReportedAxis(proof, series(proof) if proof else None, (paths or {}).get(axis["name"]))
        axis |= plain(more)
    return document


def series(proof: Validation) -> Columns:
    """Columns over time of a simulation."""
    rows = curve_points(tuple(proof.series.values()), MOST_SAMPLES)
    units = {name: KINDS[kind].si for name, (kind, _) in proof.series_units.items()}
    return Columns(len(proof.series["time"]), units, {name: of[rows].tolist() for name, of in proof.series.items()})


def on_path(spec: RobotSpec, speeds: PermittedSpeeds | None, runs: Mapping[str, Followed]) -> OnPath:
    """Permitted speeds, and simulated path following beside measured errors."""
    from drivesizer.control.path_following import extremes

    measured = spec.platform.following.measured if spec.platform else []
    errors = [MeasuredErrors(robot.name, robot.position, robot.heading) for robot in measured]
    return OnPath(speeds, errors, {name: Run(extremes(run), float(run.limited.max())) for name, run in runs.items()})


def driving(
    platform: Driving, drive: DriveSet | None, runs: Mapping[str, Followed], speeds: PermittedSpeeds | None = None
) -> dict[str, Any]:
    """The document of ``drivesizer drive --json``: a platform on its path, its drive, and simulated path following."""
    wheels = [
        {"number": wheel.number, "requirements": wheel.requirements, "grip": wheel.grip} for wheel in platform.wheels
    ]
    return {
        "spec": platform.spec.entered,
        "trajectory": getattr(platform.spec.motion, "trajectory", None),
        "length": platform.trajectory.length,
        "time": platform.trajectory.total,
        "wheels": wheels,
        "drive_set": drive,
        **on_path(platform.spec, speeds, runs)._asdict(),
    }
