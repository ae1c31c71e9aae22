"""machine.yaml to typed data: named axes on one supply, each of them a robot.yaml of its own.

Sections at the top are defaults of every axis; an axis has them field by field over these, as load cases have theirs
over a spec's. Battery, equipment, budget and brake resistor are of the whole machine: of one axis they are its own.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Field, ValidationError, field_validator

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files.fields import Duration, Pause, Place, Section, default
from drivesizer.files.yaml_overlay import overlay
from drivesizer.files.yaml_source import Path_, YamlSource, read, written
from drivesizer.spec.battery import Battery, Consumer
from drivesizer.spec.brake_resistor import BrakeResistor
from drivesizer.spec.carried import check_carrier
from drivesizer.spec.messages import explained
from drivesizer.spec.platform import Budget
from drivesizer.spec.robot import RobotSpec, read_spec
from drivesizer.spec.sections import Supply, TitleBlock

__all__ = ["AxisSpec", "Carried", "MachineSpec", "is_machine", "load_any", "load_machine", "read_machine"]

_OWN = ("axes", "timing", "cycle_time", "total")  # fields of a machine that no axis has
_WHOLE = ("battery", "equipment", "budget", "brake_resistor")  # of several axes the machine's, of one its own
_NAME = re.compile(r"[^\W_][\w .-]{0,59}")  # of an axis, which names files of exports too


class _Carried(Section):
    """A carried axis with its place."""

    at: Place | None = Field(default=None, description="distance of its drive from the carrying axis, where that turns")


class _Axis(Section):
    """Fields of an axis that a robot.yaml lacks."""

    carries: list[str] | dict[str, _Carried] = Field(
        default_factory=list, description="axes whose drives ride on this one; where it turns, each with its distance"
    )

    @field_validator("carries", mode="before")
    @classmethod
    def _names(cls, given: Any) -> Any:
        if not isinstance(given, list | dict) or not all(isinstance(name, str) for name in given):
            raise ValueError("expected names of axes, e.g. [wrist], or each with its distance, {wrist: {at: 300 mm}}")
        return given

    start: Pause = default("0 s", description="of its motion, after that of the machine's cycle")


class _Machine(Section):
    """Fields of a machine beside the sections that are defaults of its axes."""

    name: str = Field(min_length=1, max_length=200)
    axes: Annotated[dict[str, dict[str, Any]], Field(min_length=1, max_length=100)]
    timing: Literal["synchronised", "independent"] = Field(
        default="synchronised", description="common start of the axes' motions; or each at any time"
    )
    cycle_time: Duration | None = Field(
        default=None, description="of the machine; that of its longest axis if not given"
    )
    total: Literal["best", "axis_by_axis"] = Field(
        default="best", description="whether carried drives are chosen so that the sum over all axes is best"
    )
    supply: Supply
    battery: Battery | None = None
    equipment: Annotated[list[Consumer], Field(max_length=100)] = Field(default_factory=list)
    budget: Budget | None = None
    brake_resistor: BrakeResistor | None = None
    report: TitleBlock = Field(default_factory=TitleBlock)


class Carried(NamedTuple):
    """An axis whose drives ride on another one."""

    name: str
    distance: float | None  # m, from the carrying axis; None along a line


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisSpec:
    """An axis of a machine."""

    name: str
    spec: RobotSpec  # it alone, all shared sections in it
    carries: tuple[Carried, ...]
    start: float  # s, of its motion in the machine's cycle
    own_supply: bool  # whether it is not on the machine's


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineSpec:
    """A machine.yaml: named axes, and what they share."""

    name: str
    axes: tuple[AxisSpec, ...]  # in the order of the file
    order: tuple[str, ...]  # names, carried axes before those that carry them
    synchronised: bool
    cycle_time: float | None  # s
    whole: bool  # whether carried drives are chosen for the best sum
    supply: Supply
    battery: Battery | None
    equipment: tuple[Consumer, ...]
    budget: Budget | None
    brake_resistor: BrakeResistor | None
    report: TitleBlock
    source: YamlSource

    def axis(self, name: str) -> AxisSpec:
        """The axis of a name.

        Parameters
        ----------
        name
            As in the file.

        Returns
        -------
        AxisSpec
            That axis.

        Raises
        ------
        InputError
            When there is none.
        """
        found = next((axis for axis in self.axes if axis.name == name), None)
        if found is None:
            names = [axis.name for axis in self.axes]
            raise InputError(f"--axis: there is no axis {quoted(name)}{nearest(name, names)}")
        return found

    def carried(self, name: str) -> dict[str, float | None]:
        """All whose drives ride on an axis, on others that ride on it too, each with its distance from this one.

        Parameters
        ----------
        name
            Of the carrying axis.

        Returns
        -------
        dict[str, float or None]
            Distance by name [m], None along a line: where not given, that of the one on which it rides.
        """
        direct = {one.name: one.distance for one in self.axis(name).carries}
        found = dict(direct)
        for other, distance in direct.items():
            found |= {further: distance for further in self.carried(other) if further not in found}
        return found

    def with_axes(self, change: Mapping[str, RobotSpec]) -> MachineSpec:
        """The machine with other specs of some axes."""
        axes = (replace(axis, spec=change.get(axis.name, axis.spec)) for axis in self.axes)
        return replace(self, axes=tuple(axes))

    @property
    def file(self) -> str:
        """Name of the file."""
        return self.source.name

    @property
    def entered(self) -> dict[str, Any]:
        """The machine as the user wrote it."""
        return dict(self.source.data)

    @property
    def text(self) -> str:
        """The file as the user wrote it."""
        return self.source.text

    def where(self, path: Path_) -> str:
        """File, line and name of a field, for a message."""
        return self.source.where(path)


def is_machine(source: YamlSource) -> bool:
    """Whether a document has axes, and is no spec of a single one."""
    return isinstance(source.data, dict) and "axes" in source.data


def load_any(path: str | Path) -> RobotSpec | MachineSpec:
    """The spec of one axis or of a machine, as the file has one or the other.

    Parameters
    ----------
    path
        Of the file.

    Returns
    -------
    RobotSpec or MachineSpec
        A machine where there are ``axes``.

    Raises
    ------
    InputError
        As of ``load_spec``.
    """
    source = read(Path(path))
    return read_machine(source) if is_machine(source) else read_spec(source)


def load_machine(given: str | Path | Mapping[str, Any]) -> MachineSpec:
    """A machine from a file, or from the same fields as a dict.

    Parameters
    ----------
    given
        As of ``load_spec``.

    Returns
    -------
    MachineSpec
        The machine.

    Raises
    ------
    InputError
        When the file cannot be read or something in it is wrong: one line with place and reason.
    """
    return read_machine(written(given, "machine") if isinstance(given, Mapping) else read(Path(given)))


def read_machine(source: YamlSource) -> MachineSpec:
    """A machine from YAML source.

    Parameters
    ----------
    source
        The document.

    Returns
    -------
    MachineSpec
        Its axes in the order of the file.

    Raises
    ------
    InputError
        One line with file, line, field, what was found and what is expected.
    """
    data = source.data
    shared = {name: value for name, value in data.items() if name not in _OWN}
    head = _head(source)
    alone = len(head.axes) == 1
    if not alone:
        shared = {name: value for name, value in shared.items() if name not in _WHOLE}
    axes = tuple(_axis(source, shared, name, own, alone) for name, own in head.axes.items())
    if not alone:
        _check_whole(source, head)
        axes = tuple(_on_common_bus(axis, head.brake_resistor) for axis in axes)
    machine = MachineSpec(
        name=head.name,
        axes=axes,
        order=(),
        synchronised=head.timing == "synchronised",
        cycle_time=head.cycle_time,
        whole=head.total == "best",
        supply=head.supply,
        battery=head.battery,
        equipment=tuple(head.equipment),
        budget=head.budget,
        brake_resistor=head.brake_resistor,
        report=head.report,
        source=source,
    )
    return replace(machine, order=_order(machine))


def _check_whole(source: YamlSource, head: _Machine) -> None:
    """Refuse sections of the machine that do not go together: each as it is refused of a single axis."""
    name, own = next(iter(head.axes.items()))
    shared = {field: value for field, value in source.data.items() if field not in _OWN}
    sections = {field: value for field, value in own.items() if field not in (*_Axis.model_fields, "supply")}
    read_spec(overlay(source, ("axes", name), {**shared, "name": name}, sections))


def _on_common_bus(axis: AxisSpec, resistor: BrakeResistor | None) -> AxisSpec:
    """The axis on a bus that rises to its chopper's voltage, for the choice of its controllers."""
    volts = resistor.chopper_voltage if resistor else None
    if volts is None or axis.own_supply:
        return axis

    def raised(spec: RobotSpec) -> RobotSpec:
        highest = max(volts, spec.supply.highest)
        return spec.model_copy(update={"supply": spec.supply.model_copy(update={"max": highest})})

    return replace(axis, spec=axis.spec.changed(raised))


def _head(source: YamlSource) -> _Machine:
    """Fields of the machine itself; sections that only axes have are left to these."""
    data = source.data
    given = {name: value for name, value in data.items() if name in _Machine.model_fields}
    unknown = next((name for name in data if name not in _Machine.model_fields | RobotSpec.model_fields), None)
    if unknown is not None:
        names = {*_Machine.model_fields, *RobotSpec.model_fields}
        raise InputError(f"{source.where((unknown,))}: unknown key{nearest(unknown, names)}")
    try:
        return _Machine.model_validate(given)
    except ValidationError as error:
        raise explained(error, source, _Machine, given) from None


def _axis(source: YamlSource, shared: dict[str, Any], name: str, own: dict[str, Any], alone: bool) -> AxisSpec:
    """An axis of the file."""
    at: Path_ = ("axes", name)
    if not _NAME.fullmatch(name):
        raise InputError(f"{source.where(at)}: {quoted(name)} names no axis; expected letters and digits, e.g. lift")
    given = {field: own[field] for field in _Axis.model_fields if field in own}
    try:
        head = _Axis.model_validate(given)
    except ValidationError as error:
        raise explained(error, source, _Axis, given, at) from None
    sections = {field: value for field, value in own.items() if field not in _Axis.model_fields}
    lacking = next((field for field in _WHOLE if field in sections and not alone), None)
    unknown = next((field for field in sections if field not in RobotSpec.model_fields), None)
    if unknown is not None:
        names = [*_Axis.model_fields, *RobotSpec.model_fields]
        raise InputError(f"{source.where((*at, unknown))}: unknown key{nearest(unknown, names)}")
    if lacking:
        raise InputError(f"{source.where((*at, lacking))}: it is of the machine; expected at the top of the file")
    spec = read_spec(overlay(source, at, shared if alone else {**shared, "name": name}, sections))
    own_supply = not alone and "nominal" in sections.get("supply", ())
    carries = head.carries if isinstance(head.carries, dict) else dict.fromkeys(head.carries, _Carried())
    axis = AxisSpec(
        name=name,
        spec=spec if alone or own_supply else _on_common_supply(spec),
        carries=tuple(Carried(other, place.at) for other, place in carries.items()),
        start=head.start,
        own_supply=own_supply,
    )
    _check_carried(source, at, axis)
    return axis


def _on_common_supply(spec: RobotSpec) -> RobotSpec:
    """An axis of several: what it regenerates is judged with the others', in the machine."""
    shared = {"accepts": "all", "overvoltage_trip": None, "part": None}
    return spec.changed(lambda one: one.model_copy(update={"supply": one.supply.model_copy(update=shared)}))


def _check_carried(source: YamlSource, at: Path_, axis: AxisSpec) -> None:
    if not axis.carries:
        return
    try:
        for _, case in axis.spec.load_cases:
            check_carrier(case.load, (one.distance for one in axis.carries))
    except InputError as error:
        raise InputError(f"{source.where((*at, 'carries'))}: {error}") from None


def _order(machine: MachineSpec) -> tuple[str, ...]:
    """Carried axes before those that carry them; the order of the file where nothing is carried."""
    names = [axis.name for axis in machine.axes]
    for axis in machine.axes:
        for other in axis.carries:
            if other.name not in names:
                where = machine.where(("axes", axis.name, "carries"))
                raise InputError(f"{where}: there is no axis {quoted(other.name)}{nearest(other.name, names)}")
    sorter = TopologicalSorter({axis.name: [one.name for one in axis.carries] for axis in machine.axes})
    try:
        return tuple(sorter.static_order())
    except CycleError as error:
        ring = error.args[1]
        where = machine.where(("axes", ring[1], "carries"))
        text = f"{' carries '.join(ring[::-1])}: no order to size them in; expected axes that do not carry each other"
        raise InputError(f"{where}: {text}") from None
