"""machine.yaml to typed data: the only place where its text becomes numbers.

Sections at the top are defaults of every axis; an axis has them field by field over these, as load cases have theirs
over a spec's. Battery, equipment, budget and brake resistor are of the whole machine: of one axis they are its own.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import reduce
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, field_validator

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files.fields import Allowance, Duration, Pause, Place, Section, all_defaults, default, no_entries
from drivesizer.files.yaml_overlay import overlay
from drivesizer.files.yaml_source import Path_, YamlSource, read, written
from drivesizer.spec.battery import Battery, Consumer
from drivesizer.spec.brake_resistor import BrakeResistor
from drivesizer.spec.messages import explained
from drivesizer.spec.motions import Cam, Harmonic
from drivesizer.spec.platform import Budget
from drivesizer.spec.robot import RobotSpec, read_spec
from drivesizer.spec.robot_section import RobotSection
from drivesizer.spec.sections import Environment, Margins, Mission, Supply, TitleBlock
from drivesizer.spec.several_axes.carried import check_carrier
from drivesizer.spec.several_axes.machine import AxisSpec, Carried, MachineSpec
from drivesizer.spec.tolerance_text import split_tolerances

__all__ = [
    "WHOLE",
    "AxisFields",
    "MachineFields",
    "joint_axis",
    "load_machine",
    "read_machine",
    "sizing_order",
    "with_common_bus",
]

_OWN = ("axes", "timing", "cycle_time", "total", "few_kinds", "robot")  # fields of a machine that no axis has
WHOLE = ("battery", "equipment", "budget", "brake_resistor")  # of several axes the machine's, of one its own
_COMPUTED = {"kind": "recorded", "file": "of the description"}  # the load of a joint, until it is computed
Both = tuple[dict[str, Any], dict[str, Any]]  # sections of an axis as written, and without tolerances
_NAME = re.compile(r"[^\W_][\w .-]{0,59}")  # of an axis, which names files of exports too


class CarriedPlace(Section):
    """Place of a carried drive."""

    at: Place | None = Field(
        default=None,
        description="distance of its drive from the carrying axis, where that turns; distances add along the chain",
    )


class AxisFields(Section):
    """Fields of an axis that a robot.yaml lacks."""

    carries: list[str] | dict[str, CarriedPlace] = no_entries(
        description="axes whose drives ride on this one; where it turns, each with its distance"
    )

    @field_validator("carries", mode="before")
    @classmethod
    def _names(cls, given: Any) -> Any:
        if not isinstance(given, list | dict) or not all(isinstance(name, str) for name in given):
            raise ValueError("expected names of axes, e.g. [wrist], or each with its distance, {wrist: {at: 300 mm}}")
        twice = next((name for place, name in enumerate(given) if name in list(given)[:place]), None)
        if twice is not None:
            raise ValueError(f"{quoted(twice)} is there twice; expected each axis once")
        return given

    start: Pause = default("0 s", description="of its motion, after that of the machine's cycle")
    repeats: bool | None = Field(
        default=None,
        description="its motion at once, with a period of its own; false: it waits at rest until the machine's cycle "
        "is over, as by default all do that begin and end at rest, but for harmonic and cam",
    )


class MachineFields(Section):
    """Fields of a machine beside the sections that are defaults of its axes."""

    name: str = Field(min_length=1, max_length=200)
    axes: Annotated[dict[str, dict[str, Any]], Field(max_length=100)] = all_defaults(
        description="by name, each with sections of a robot.yaml over those of the machine"
    )
    robot: RobotSection | None = Field(default=None, description="joints of a description, each an axis by its name")
    timing: Literal["synchronised", "independent"] = Field(
        default="synchronised", description="common start of the axes' motions; or each at any time"
    )
    cycle_time: Duration | None = Field(
        default=None, description="of the machine; that of its longest axis if not given"
    )
    total: Literal["best", "axis_by_axis"] = Field(
        default="best", description="whether carried drives are chosen so that the sum over all axes is best"
    )
    few_kinds: Allowance | None = Field(
        default=None,
        description="by how much the sum of the objective may grow for common motors and gearheads",
    )
    supply: Supply
    environment: Environment = all_defaults()
    margins: Margins = all_defaults()
    mission: Mission | None = None
    battery: Battery | None = None
    equipment: Annotated[list[Consumer], Field(max_length=100)] = no_entries()
    budget: Budget | None = None
    brake_resistor: BrakeResistor | None = None
    report: TitleBlock = all_defaults()

    @field_validator("axes", mode="before")
    @classmethod
    def _named(cls, given: Any) -> Any:
        if not isinstance(given, dict):
            raise ValueError("expected axes by name, each a group of fields, e.g. {lift: {load: ..., motion: ...}}")
        for name, sections in given.items():
            if not isinstance(sections, dict):
                raise ValueError(f"{quoted(name)}: expected a group of fields such as load, motion, carries")
        return given


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
    """A machine from YAML source."""
    head = _head(source)
    if not head.axes and head.robot is None:
        raise InputError(
            f"{source.where(('axes',))}: expected at least one axis by name, or robot: {{description: ...}}"
        )
    alone = len(head.axes) == 1 and head.robot is None
    shared = _shared(source, alone=alone)
    written_axes = source.data.get("axes") or {}  # with the tolerances of their figures
    axes = tuple(_axis(source, shared, name, (written_axes[name], own), alone) for name, own in head.axes.items())
    if not alone:
        _check_whole(source, head)
        axes = tuple(with_common_bus(axis, head.brake_resistor) for axis in axes)
    machine = MachineSpec(
        name=head.name,
        axes=axes,
        order=(),
        synchronised=head.timing == "synchronised",
        cycle_time=head.cycle_time,
        whole=head.total == "best",
        few_kinds=head.few_kinds,
        supply=head.supply,
        environment=head.environment,
        margins=head.margins,
        mission=head.mission,
        battery=head.battery,
        equipment=tuple(head.equipment),
        budget=head.budget,
        brake_resistor=head.brake_resistor,
        report=head.report,
        robot=head.robot,
        source=source,
    )
    return machine if head.robot else sizing_order(machine)


def _check_whole(source: YamlSource, head: MachineFields) -> None:
    """Refuse sections of the machine that do not go together: each as it is refused of a single axis."""
    name, own = next(iter(head.axes.items()), (head.name, {}))
    sections = {field: value for field, value in own.items() if field not in (*AxisFields.model_fields, "supply")}
    if head.robot is not None and "load" not in sections:
        sections["load"] = _COMPUTED
    read_spec(overlay(source, ("axes", name), {**_shared(source, alone=True), "name": name}, sections))


def with_common_bus(axis: AxisSpec, resistor: BrakeResistor | None) -> AxisSpec:
    """The axis on a bus that rises to its chopper's voltage, for the choice of its controllers."""
    volts = resistor.chopper_voltage if resistor else None
    if volts is None or axis.own_supply:
        return axis

    def raised(spec: RobotSpec) -> RobotSpec:
        highest = max(volts, spec.supply.highest)
        return spec.model_copy(update={"supply": spec.supply.model_copy(update={"max": highest})})

    return replace(axis, spec=axis.spec.changed(raised))


def _shared(source: YamlSource, *, alone: bool) -> dict[str, Any]:
    """Sections of the machine that are defaults of its axes."""
    left = _OWN if alone else (*_OWN, *WHOLE)
    return {name: value for name, value in source.data.items() if name not in left}


def _head(source: YamlSource) -> MachineFields:
    """Fields of the machine itself; sections that only axes have are left to these."""
    data, _ = split_tolerances(source)
    given = {name: value for name, value in data.items() if name in MachineFields.model_fields}
    unknown = next((name for name in data if name not in MachineFields.model_fields | RobotSpec.model_fields), None)
    if unknown is not None:
        names = {*MachineFields.model_fields, *RobotSpec.model_fields}
        raise InputError(f"{source.where((unknown,))}: unknown key{nearest(unknown, names)}")
    try:
        return MachineFields.model_validate(given)
    except ValidationError as error:
        raise explained(error, source, MachineFields, given) from None


def joint_axis(machine: MachineSpec, name: str, carried: Iterable[str]) -> AxisSpec:
    """A joint of a machine's robot as an axis, which the file need not name."""
    axis = next((axis for axis in machine.axes if axis.name == name), None)
    if axis is not None and not axis.is_joint:
        where = machine.where(("axes", name, "load"))
        raise InputError(f"{where}: the description has a joint of this name; expected no load, or another name")
    if axis is None:
        axis = _axis(machine.source, _shared(machine.source, alone=False), name, ({}, {}), alone=False)
        axis = with_common_bus(axis, machine.brake_resistor)
        axis = replace(axis, spec=reduce(lambda one, change: one.changed(change), machine.changes, axis.spec))
    return replace(axis, carries=tuple(Carried(other, None) for other in carried))


def _axis(source: YamlSource, shared: dict[str, Any], name: str, given_as: Both, alone: bool) -> AxisSpec:
    """An axis of the file."""
    at: Path_ = ("axes", name)
    own, nominal = given_as
    if not _NAME.fullmatch(name):
        raise InputError(f"{source.where(at)}: {quoted(name)} names no axis; expected letters and digits, e.g. lift")
    given = {field: nominal[field] for field in AxisFields.model_fields if field in nominal}
    try:
        head = AxisFields.model_validate(given)
    except ValidationError as error:
        raise explained(error, source, AxisFields, given, at) from None
    sections = _sections(source, at, own, alone)
    is_joint = source.data.get("robot") is not None and "load" not in sections
    if is_joint and head.carries:
        raise InputError(f"{source.where((*at, 'carries'))}: it is in the description; leave it out")
    if is_joint:
        sections["load"] = _COMPUTED
    spec = read_spec(overlay(source, at, shared if alone else {**shared, "name": name}, sections))
    own_supply = not alone and "nominal" in (sections.get("supply") or ())
    axis = AxisSpec(
        name=name,
        spec=spec if alone or own_supply else spec.on_supply_of_machine(),
        carries=_carries(head),
        start=head.start,
        repeats=True if head.repeats is None and isinstance(spec.motion, Harmonic | Cam) else head.repeats,
        own_supply=own_supply,
        is_joint=is_joint,
    )
    _check_carried(source, at, axis)
    return axis


def _sections(source: YamlSource, at: Path_, own: dict[str, Any], alone: bool) -> dict[str, Any]:
    """Sections of an axis that a robot.yaml has too."""
    sections = {field: value for field, value in own.items() if field not in AxisFields.model_fields}
    unknown = next((field for field in sections if field not in RobotSpec.model_fields), None)
    if unknown is not None:
        names = [*AxisFields.model_fields, *RobotSpec.model_fields]
        raise InputError(f"{source.where((*at, unknown))}: unknown key{nearest(unknown, names)}")
    whole = next((field for field in WHOLE if field in sections and not alone), None)
    if whole:
        raise InputError(f"{source.where((*at, whole))}: it is of the machine; expected at the top of the file")
    return sections


def _carries(head: AxisFields) -> tuple[Carried, ...]:
    """Carried axes, with their distances where these are given."""
    places = head.carries if isinstance(head.carries, dict) else dict.fromkeys(head.carries, CarriedPlace())
    return tuple(Carried(other, place.at) for other, place in places.items())


def _check_carried(source: YamlSource, at: Path_, axis: AxisSpec) -> None:
    if not axis.carries:
        return
    try:
        for _, case in axis.spec.load_cases:
            check_carrier(case.load, (one.distance for one in axis.carries))
    except InputError as error:
        raise InputError(f"{source.where((*at, 'carries'))}: {error}") from None


def sizing_order(machine: MachineSpec) -> MachineSpec:
    """The machine with the order in which its axes are sized: carried ones before those that carry them."""
    names = [axis.name for axis in machine.axes]
    for axis in machine.axes:
        for other in axis.carries:
            if other.name not in names:
                where = machine.where(("axes", axis.name, "carries"))
                raise InputError(f"{where}: there is no axis {quoted(other.name)}{nearest(other.name, names)}")
    sorter = TopologicalSorter({axis.name: [one.name for one in axis.carries] for axis in machine.axes})
    try:
        return replace(machine, order=tuple(sorter.static_order()))
    except CycleError as error:
        ring = error.args[1]
        where = machine.where(("axes", ring[1], "carries"))
        text = f"{' carries '.join(ring[::-1])}: no order to size them in; expected axes that do not carry each other"
        raise InputError(f"{where}: {text}") from None
