"""machine.yaml to typed data: named axes on one supply, and which of them ride on one another.

A plain spec is a machine of one axis.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from graphlib import CycleError, TopologicalSorter
from math import fsum
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, Protocol, TypeVar

from pydantic import Field, ValidationError, field_validator

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files import fields
from drivesizer.files.yaml_source import OfFile, Path_, YamlSource, overlay, read, source_of
from drivesizer.loads import Load
from drivesizer.loads.motions import Cam, Harmonic
from drivesizer.spec.drive import Select
from drivesizer.spec.messages import explained
from drivesizer.spec.platform import Budget
from drivesizer.spec.robot import RobotSpec, read_spec
from drivesizer.spec.robot_section import RobotSection
from drivesizer.spec.sections import (
    Battery,
    BrakeResistor,
    Consumer,
    Design,
    Environment,
    Margins,
    Mission,
    Supply,
    TitleBlock,
)
from drivesizer.spec.tolerances import split_tolerances


class Carried(NamedTuple):
    """An axis whose drives ride on another one."""

    name: str
    distance: float | None  # m, from the carrying axis; None along a line


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisSpec:
    """An axis of a machine."""

    name: str
    spec: RobotSpec  # it alone, all shared sections in it
    carries: tuple[Carried, ...] = ()
    start: float = 0.0  # s, of its motion in the machine's cycle
    repeats: bool | None = None  # its motion, at once; None: where it is not at rest at both ends of it
    own_supply: bool = False  # whether it is not on the machine's
    is_joint: bool = False  # of the robot, whose description gives its load


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineSpec(OfFile):
    """A machine.yaml: named axes, and what they share."""

    name: str
    axes: tuple[AxisSpec, ...]  # in the order of the file
    order: tuple[str, ...]  # names, carried axes before those that carry them
    synchronised: bool = True
    cycle_time: float | None = None  # s
    whole: bool = True  # whether carried drives are chosen for the best sum
    few_kinds: float | None = None  # share of that sum that common drives may cost more; None: none are preferred
    supply: Supply
    environment: Environment
    margins: Margins
    mission: Mission | None
    battery: Battery | None
    equipment: Sequence[Consumer]
    budget: Budget | None
    brake_resistor: BrakeResistor | None
    report: TitleBlock
    robot: RobotSection | None = None  # whose joints are axes as well
    source: YamlSource
    changes: tuple[Callable[[RobotSpec], RobotSpec], ...] = ()  # that joints have yet to undergo

    def axis(self, name: str) -> AxisSpec:
        """The axis of a name."""
        return axis_of(self.axes, name)

    def carried(self, name: str) -> dict[str, float | None]:
        """All whose drives ride on an axis, on others that ride on it too, each with its distance from this one."""
        direct = {carried.name: carried.distance for carried in self.axis(name).carries}
        distances = dict(direct)
        for other, distance in direct.items():
            for further, beyond in self.carried(other).items():
                distances.setdefault(further, None if distance is None else distance + (beyond or 0.0))
        return distances

    def changed(self, change: Callable[[RobotSpec], RobotSpec]) -> MachineSpec:
        """The machine with the same change in the specs of all its axes."""
        axes = tuple(replace(axis, spec=axis.spec.changed(change)) for axis in self.axes)
        return replace(self, axes=axes, changes=(*self.changes, change))

    @property
    def is_several(self) -> bool:
        """Whether there is more than one axis, or a robot with joints."""
        return len(self.axes) > 1 or self.robot is not None


class _Named(Protocol):
    @property
    def name(self) -> str: ...


Axis = TypeVar("Axis", bound=_Named)


def axis_of(axes: Sequence[Axis], name: str) -> Axis:
    """The axis of a name, of a machine's spec or of its sizing."""
    axis = next((axis for axis in axes if axis.name == name), None)
    if axis is None:
        names = [axis.name for axis in axes]
        listed = f"{', '.join(names)}{nearest(name, names)}"
        raise InputError(f"--axis: there is no axis {quoted(name)}; expected {listed}")
    return axis


def machine_of(spec: RobotSpec) -> MachineSpec:
    """A plain spec as a machine of one axis."""
    shared: dict[str, Any] = {name: getattr(spec, name) for name in _SHARED}
    return MachineSpec(axes=(AxisSpec(name=spec.name, spec=spec),), order=(spec.name,), source=spec.source, **shared)


def is_machine(source: YamlSource) -> bool:
    """Whether a document has axes or joints, and is no spec of a single one."""
    return isinstance(source.data, dict) and ("axes" in source.data or "robot" in source.data)


def load_any(path: str | Path, change: Callable[[YamlSource], YamlSource] | None = None) -> MachineSpec:
    """The machine of a file, whose text may be changed first."""
    source = read(Path(path))
    return read_any(change(source) if change else source)


def read_any(source: YamlSource) -> MachineSpec:
    """The machine of YAML source; a plain spec is one of a single axis."""
    return read_machine(source) if is_machine(source) else machine_of(read_spec(source))


def named_catalogs(data: Any) -> list[str]:
    """Catalogues that a document names for all its axes; the default ones where it has none or a field is malformed."""
    axes, by_section = data.get("axes") if isinstance(data, dict) else None, list[list[str]]()
    for section in (data, *(axes.values() if isinstance(axes, dict) else ())):
        select = section.get("select") if isinstance(section, dict) else None
        field = select.get("catalogs") if isinstance(select, dict) else None
        names = field if isinstance(field, list) else [field]
        by_section.append([str(name) for name in names if isinstance(name, str | int)])
    catalogs = [name for names in by_section for name in names]
    return list(dict.fromkeys(catalogs if by_section[0] else [*Select().catalogs, *catalogs]))


# -- Loads with the drives of other axes on them.
#
# Along a line a carried mass adds to that of the load. About an axis it is a point at a distance, the housing's own
# inertia about its centre left out:
#
# .. math:: m' = m + m_c, \qquad r' = (m r + m_c a) / m', \qquad J' = J + m_c a^2


_LEVERS = {"arm": "length", "rotary_table": "eccentricity"}  # kinds that turn, and what is from axis to centre


def check_carrier(load: Load, distances: Iterable[float | None]) -> None:
    """Refuse a load that carries no drives, and a distance that its kind lacks or does not have."""
    turning = load.kind in _LEVERS
    if not turning and not load.takes_payload:
        raise InputError(f"a {load.kind} carries no drives; expected an axis with a mass, an arm or a rotary_table")
    for distance in distances:
        if turning and distance is None:
            raise InputError(f"a {load.kind} carries them at a distance; expected e.g. {{wrist: {{at: 300 mm}}}}")
        if not turning and distance is not None:
            raise InputError(f"a {load.kind} moves along a line; expected the name alone, without at")


def carrying(load: Load, masses: Iterable[tuple[float, float | None]]) -> Load:
    """A load with the drives of other axes on it."""
    carried = [(mass, distance or 0.0) for mass, distance in masses if mass]
    if not carried:
        return load
    total, moment, inertia = (fsum(mass * distance**power for mass, distance in carried) for power in (0, 1, 2))
    own: Any = load
    update = {"mass": own.mass + total}
    if name := _LEVERS.get(load.kind):
        lever = getattr(load, name)
        about = own.mass * lever**2 if own.inertia is None else own.inertia
        update |= {name: (own.mass * lever + moment) / update["mass"], "inertia": about + inertia}
    return load.model_copy(update=update)


# -- machine.yaml to typed data: the only place where its text becomes numbers.
#
# Sections at the top are defaults of every axis; an axis has them field by field over these, as load cases have
# theirs over a spec's. Battery, equipment, budget and brake resistor are of the whole machine: of one axis they are
# its own.


WHOLE = ("battery", "equipment", "budget", "brake_resistor")  # of several axes the machine's, of one its own
_COMPUTED = {"kind": "recorded", "file": "of the description"}  # the load of a joint, until it is computed
AxisSections = tuple[dict[str, Any], dict[str, Any]]  # sections of an axis as written, and without tolerances
_NAME = re.compile(r"[^\W_][\w .-]{0,59}")  # of an axis, which names files of exports too


class CarriedPlace(fields.Section):
    """Place of a carried drive."""

    at: fields.Place | None = fields.optional(
        "distance of its drive from the carrying axis, where that turns; distances add along the chain",
        example="300 mm",
    )


class AxisFields(fields.Section):
    """Fields of an axis that a robot.yaml lacks."""

    carries: list[str] | dict[str, CarriedPlace] = fields.no_entries(
        "axes whose drives ride on this one; where it turns, each with its distance"
    )

    @field_validator("carries", mode="before")
    @classmethod
    def _names(cls, axes: Any) -> Any:
        if not isinstance(axes, list | dict) or not all(isinstance(name, str) for name in axes):
            raise ValueError("expected names of axes, e.g. [wrist], or each with its distance, {wrist: {at: 300 mm}}")
        twice = next((name for place, name in enumerate(axes) if name in list(axes)[:place]), None)
        if twice is not None:
            raise ValueError(f"{quoted(twice)} is there twice; expected each axis once")
        return axes

    start: fields.Pause = fields.default("0 s", "of its motion, after that of the machine's cycle")
    repeats: bool | None = fields.optional(
        "its motion at once, with a period of its own; false: it waits at rest until the machine's cycle "
        "is over, as by default all do that begin and end at rest, but for harmonic and cam"
    )


class MachineFields(fields.Section):
    """Fields of a machine beside the sections that are defaults of its axes."""

    name: str = Field(min_length=1, max_length=200)
    axes: Annotated[dict[str, dict[str, Any]], Field(max_length=100)] = fields.all_defaults(
        "by name, each with sections of a robot.yaml over those of the machine"
    )
    robot: RobotSection | None = fields.optional("joints of a description, each an axis by its name")
    timing: Literal["synchronised", "independent"] = fields.default(
        "synchronised", "common start of the axes' motions; or each at any time"
    )
    cycle_time: fields.Duration | None = fields.optional(
        "of the machine; that of its longest axis if not given", example="20 s"
    )
    total: Literal["best", "axis_by_axis"] = fields.default(
        "best", "whether carried drives are chosen so that the sum over all axes is best"
    )
    few_kinds: fields.Allowance | None = fields.optional(
        "by how much the sum of the objective may grow for common motors and gearheads"
    )
    supply: Supply
    environment: Environment = fields.all_defaults()
    margins: Margins = fields.all_defaults()
    mission: Mission | None = None
    battery: Battery | None = None
    equipment: Annotated[list[Consumer], Field(max_length=100)] = fields.no_entries()
    budget: Budget | None = None
    brake_resistor: BrakeResistor | None = None
    report: TitleBlock = fields.all_defaults()
    design: Design | None = None

    @field_validator("axes", mode="before")
    @classmethod
    def _named(cls, axes: Any) -> Any:
        if not isinstance(axes, dict):
            raise ValueError("expected axes by name, each a group of fields, e.g. {lift: {load: ..., motion: ...}}")
        for name, sections in axes.items():
            if not isinstance(sections, dict):
                raise ValueError(f"{quoted(name)}: expected a group of fields such as load, motion, carries")
        return axes


# fields of a machine that no axis has, and sections that it has as it is given, as a plain spec has them
_OWN = ("design", *(name for name in MachineFields.model_fields if name not in RobotSpec.model_fields))
_SHARED = tuple(name for name in MachineFields.model_fields if name not in _OWN)


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
    return read_machine(source_of(given, "machine"))


def read_machine(source: YamlSource) -> MachineSpec:
    """A machine from YAML source."""
    data, _ = split_tolerances(source)
    names = MachineFields.model_fields | RobotSpec.model_fields  # sections that only axes have are left to these
    for name in data:
        if name not in names:
            raise InputError(f"{source.where((name,))}: unknown key{nearest(name, names)}")
    values = {name: value for name, value in data.items() if name in MachineFields.model_fields}
    try:
        head = MachineFields.model_validate(values)
    except ValidationError as error:
        raise explained(error, source, MachineFields, values) from None
    if not head.axes and head.robot is None:
        raise InputError(
            f"{source.where(('axes',))}: expected at least one axis by name, or robot: {{description: ...}}"
        )
    alone = len(head.axes) == 1 and head.robot is None
    shared = _shared(source, alone=alone)
    written_axes = source.data.get("axes") or {}  # with the tolerances of their figures
    axes = tuple(_axis(source, shared, name, (written_axes[name], own), alone) for name, own in head.axes.items())
    if not alone:  # sections of the machine that do not go together are refused as those of a single axis
        name, own = next(iter(head.axes.items()), (head.name, {}))
        sections = {field: value for field, value in own.items() if field not in (*AxisFields.model_fields, "supply")}
        if head.robot is not None and "load" not in sections:
            sections["load"] = _COMPUTED
        read_spec(overlay(source, ("axes", name), {**_shared(source, alone=True), "name": name}, sections))
        axes = tuple(with_common_bus(axis, head.brake_resistor) for axis in axes)
    values = {name: getattr(head, name) for name in (*_SHARED, "cycle_time", "few_kinds", "robot")}
    synchronised, whole = head.timing == "synchronised", head.total == "best"
    machine = MachineSpec(axes=axes, order=(), synchronised=synchronised, whole=whole, source=source, **values)
    return machine if head.robot else sizing_order(machine)


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


def joint_axis(machine: MachineSpec, name: str, carried: Iterable[str]) -> AxisSpec:
    """A joint of a machine's robot as an axis, which the file need not name."""
    axis = next((axis for axis in machine.axes if axis.name == name), None)
    if axis is not None and not axis.is_joint:
        where = machine.where(("axes", name, "load"))
        raise InputError(f"{where}: the description has a joint of this name; expected no load, or another name")
    if axis is None:
        axis = _axis(machine.source, _shared(machine.source, alone=False), name, ({}, {}), alone=False)
        axis = with_common_bus(axis, machine.brake_resistor)
        axis = replace(axis, spec=reduce(lambda spec, change: spec.changed(change), machine.changes, axis.spec))
    return replace(axis, carries=tuple(Carried(other, None) for other in carried))


def _axis(source: YamlSource, shared: dict[str, Any], name: str, given_as: AxisSections, alone: bool) -> AxisSpec:
    """An axis of the file."""
    at: Path_ = ("axes", name)
    own, nominal = given_as
    if not _NAME.fullmatch(name):
        raise InputError(f"{source.where(at)}: {quoted(name)} names no axis; expected letters and digits, e.g. lift")
    values = {field: nominal[field] for field in AxisFields.model_fields if field in nominal}
    try:
        head = AxisFields.model_validate(values)
    except ValidationError as error:
        raise explained(error, source, AxisFields, values, at) from None
    sections = {field: value for field, value in own.items() if field not in AxisFields.model_fields}
    for field in sections:
        if field not in RobotSpec.model_fields:
            names = [*AxisFields.model_fields, *RobotSpec.model_fields]
            raise InputError(f"{source.where((*at, field))}: unknown key{nearest(field, names)}")
    whole = next((field for field in WHOLE if field in sections and not alone), None)
    if whole:
        raise InputError(f"{source.where((*at, whole))}: it is of the machine; expected at the top of the file")
    is_joint = source.data.get("robot") is not None and "load" not in sections
    if is_joint and head.carries:
        raise InputError(f"{source.where((*at, 'carries'))}: it is in the description; leave it out")
    if is_joint:
        sections["load"] = _COMPUTED
    spec = read_spec(overlay(source, at, shared if alone else {**shared, "name": name}, sections))
    places = head.carries if isinstance(head.carries, dict) else dict.fromkeys(head.carries, CarriedPlace())
    try:
        for _, case in spec.load_cases if places else ():
            check_carrier(case.load, (place.at for place in places.values()))
    except InputError as error:
        raise InputError(f"{source.where((*at, 'carries'))}: {error}") from None
    own_supply = not alone and "nominal" in (sections.get("supply") or ())
    return AxisSpec(
        name=name,
        spec=spec if alone or own_supply else spec.on_supply_of_machine(),
        carries=tuple(Carried(other, place.at) for other, place in places.items()),
        start=head.start,
        repeats=True if head.repeats is None and isinstance(spec.motion, Harmonic | Cam) else head.repeats,
        own_supply=own_supply,
        is_joint=is_joint,
    )


def sizing_order(machine: MachineSpec) -> MachineSpec:
    """The machine with the order in which its axes are sized: carried ones before those that carry them."""
    names = [axis.name for axis in machine.axes]
    for axis in machine.axes:
        for other in axis.carries:
            if other.name not in names:
                where = machine.where(("axes", axis.name, "carries"))
                raise InputError(f"{where}: there is no axis {quoted(other.name)}{nearest(other.name, names)}")
    sorter = TopologicalSorter({axis.name: [carried.name for carried in axis.carries] for axis in machine.axes})
    try:
        return replace(machine, order=tuple(sorter.static_order()))
    except CycleError as error:
        ring = error.args[1]
        where = machine.where(("axes", ring[1], "carries"))
        text = f"{' carries '.join(ring[::-1])}: no order to size them in; expected axes that do not carry each other"
        raise InputError(f"{where}: {text}") from None


# -- JSON Schema of machine.yaml, out of those of a spec, of the machine's own fields and of the robot's section.
#
# A section that an axis lays over the machine's need not be whole: there no field of it is required.


_REF = "#/$defs/"
_ROBOT = "Robot"  # before the models of the robot's section, two of which a spec has by the same name
_PARTIAL = "Axis"  # before models of which no field is required


def machine_schema() -> dict[str, Any]:
    """The JSON Schema of machine.yaml."""
    spec, head, axis = (model.model_json_schema() for model in (RobotSpec, MachineFields, AxisFields))
    robot = RobotSection.model_json_schema(ref_template=f"{_REF}{_ROBOT}{{model}}")
    models = spec["$defs"] | {f"{_ROBOT}{name}": definition for name, definition in robot.pop("$defs").items()}
    models |= axis["$defs"] | {"RobotSection": robot}
    sections = {name: _partial(field, models) for name, field in spec["properties"].items()}
    own = {name: field for name, field in head["properties"].items() if name not in spec["properties"]}
    whole = {name: spec["properties"][name] for name in head["properties"] if name in spec["properties"]}
    models["Axis"] = {
        "title": "Axis",
        "description": "An axis: sections of a spec, over those of the machine, and what of it others carry.",
        "type": "object",
        "additionalProperties": False,
        "properties": axis["properties"] | {name: section for name, section in sections.items() if name not in WHOLE},
    }
    own["axes"] |= {"additionalProperties": {"$ref": f"{_REF}Axis"}}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "drivesizer machine",
        "description": head["description"],
        "type": "object",
        "additionalProperties": False,
        "required": head["required"],
        "anyOf": [{"required": ["axes"]}, {"required": ["robot"]}],
        "properties": {"name": head["properties"]["name"]} | own | sections | whole,
        "$defs": models,
    }


def _partial(field: dict[str, Any], models: dict[str, Any]) -> dict[str, Any]:
    """A section of which no field is required; the models that it needs are added."""
    if "$ref" in field:
        name = field["$ref"].removeprefix(_REF)
        if not models[name].get("required"):
            return field
        models[_PARTIAL + name] = {key: value for key, value in models[name].items() if key != "required"}
        return field | {"$ref": f"{_REF}{_PARTIAL}{name}"}
    options = field.get("oneOf", field.get("anyOf"))
    if options is None:
        return field
    rest = {key: value for key, value in field.items() if key not in ("oneOf", "anyOf", "discriminator")}
    # without its kind a section may be one of several
    return rest | {"anyOf": [_partial(option, models) for option in options]}
