"""robot.yaml to typed data: the only place where a user's file becomes numbers."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, PrivateAttr, ValidationError, field_validator

from drivesizer.catalog import Brake, Controller
from drivesizer.catalog.typed import Typed
from drivesizer.errors import InputError, quoted
from drivesizer.files import fields
from drivesizer.files.yaml_source import OfFile, Path_, YamlSource, changed, source_of
from drivesizer.loads import AXES, Load
from drivesizer.loads.motions import Motion, Trapezoid
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.physics.braking import released_power
from drivesizer.physics.figures import Figures, once_per_part
from drivesizer.physics.power_stage import Feed, power_stage
from drivesizer.physics.power_stage import PowerStage as StageFigures
from drivesizer.spec import drive, sections
from drivesizer.spec.messages import contradictions, explained
from drivesizer.spec.mounting import Mounting, OwnBrake, Shaft
from drivesizer.spec.platform import Budget, Platform
from drivesizer.spec.sections import Battery, BrakeResistor, Consumer, Design
from drivesizer.spec.tolerances import Toleranced, Tolerances, split_tolerances

# -- Power stages between the supply and the motors: of one controller, and with what keeps a brake released.


@lru_cache(maxsize=64)
def stage_of(controller: Controller | None, volts: float, stage: sections.PowerStage, assume: bool) -> StageFigures:
    """The power stage of one controller: of those of late as before."""
    return power_stage(controller or Controller(), volts, stage, assume=assume)


@lru_cache(maxsize=64)
def _stages(volts: float, stage: sections.PowerStage, assume: bool) -> Callable[[Figures], StageFigures]:
    """The power stages of many controllers, once for each."""
    return once_per_part(lambda part: power_stage(part, volts, stage, assume=assume))


# -- robot.yaml to typed data: the only place where a user's file becomes numbers.
#
# Every quantity is read by the strict reader of ``units`` and is an SI float from here on. Models are the file's
# schema; their descriptions are the documentation that ``drivesizer schema`` prints.


AS_SPECIFIED = "as specified"  # the name of the first load case where there are others


_NO_SOURCE = YamlSource("{}", "")


class RobotSpec(fields.Section, OfFile):
    """A robot.yaml: the load, its motion, and what the drive may be made of."""

    name: str = Field(min_length=1, max_length=200)
    method: Literal["paper", "physics"] = fields.default(
        "physics", "what ranks: the whole load cycle, or the paper's equations and rule"
    )
    load: Load
    motion: Motion | None = fields.optional("one cycle, repeated; a recorded load brings its own")
    once: bool = fields.default(
        False, "the motion is run once, from cold, such as a climb or a match: its heat and short limits count"
    )
    transmission: Annotated[list[drive.Stage], Field(min_length=1, max_length=5)] = fields.default(
        [{"kind": "gearhead"}], "from the motor to the load"
    )
    paper_factors: sections.PaperFactors = fields.all_defaults()
    margins: sections.Margins = fields.all_defaults()
    supply: sections.Supply
    brake_resistor: BrakeResistor | None = fields.optional(
        "that burns what is regenerated; none where not given",
        json_schema_extra=fields.or_else({"const": "any", "type": "string"}),
    )
    power_stage: sections.PowerStage = fields.all_defaults()
    shaft: Shaft | None = fields.optional("output shaft of the gearhead, or motor, and what it carries")
    environment: sections.Environment = fields.all_defaults()
    mounting: Mounting | None = fields.optional("of the motor; as printed where not given")
    needs: sections.Needs = fields.all_defaults()
    requirements: sections.Requirements | None = fields.optional("of the machine, for a table of its own")
    brake: OwnBrake | None = fields.optional("out of the catalogues where not given")
    mission: sections.Mission | None = fields.optional("for the closed loop; one cycle where not given")
    battery: Battery | None = fields.optional("that feeds the machine; only the supply where not given")
    equipment: Annotated[list[Consumer], Field(max_length=100)] = fields.no_entries("further consumers on the battery")
    platform: Platform | None = fields.optional("of a wheeled vehicle: wheels, mass, room, limits")
    budget: Budget | None = fields.optional("of the machine's mass")
    control: drive.Control = fields.all_defaults()
    plant: drive.Plant = fields.all_defaults()
    select: drive.Select = fields.all_defaults()
    tolerances: Tolerances = fields.all_defaults()
    design: Design | None = fields.optional("of its free figures, for `drivesizer design`")
    report: sections.TitleBlock = fields.all_defaults("for the head of reports")
    cases: Annotated[list[sections.Case], Field(max_length=100)] = fields.no_entries(
        "further load cases; a drive must pass all"
    )

    _source: YamlSource = PrivateAttr(default_factory=lambda: _NO_SOURCE)
    _toleranced: tuple[Toleranced, ...] = PrivateAttr(default=())
    _typed: tuple[Typed, ...] = PrivateAttr(default=())
    _cases: tuple[tuple[str, RobotSpec], ...] = PrivateAttr(default=())
    _on_common_bus: bool = PrivateAttr(default=False)
    _waits_until: float | None = PrivateAttr(default=None)
    _brake_released: float = PrivateAttr(default=1.0)
    _machine_price: fields.Money | None = PrivateAttr(default=None)

    @property
    def source(self) -> YamlSource:
        """The file that it was read from; an empty one where there is none."""
        return self._source

    def _contradictions(self) -> Iterator[str]:
        yield from contradictions(self)

    @field_validator("cases")
    @classmethod
    def _named_apart(cls, cases: list[sections.Case]) -> list[sections.Case]:
        for fault in fields.apart(cases, "cases"):
            raise ValueError(fault)
        return cases

    @property
    def typed(self) -> tuple[Typed, ...]:
        """Parts with figures of their own, which no catalogue has."""
        return self._typed

    @property
    def parts_key(self) -> tuple[Hashable, ...]:
        """All of the spec that the parts to search hang on."""
        select = self.select
        names = repr(select.named) if self._typed else ""
        prices = tuple(select.rates.items()), tuple(limit.currency for limit in self.price_limits), self.load.motors
        return (*select.catalogs, Path(self.file).parent, select.motor.kind, select.estimates,
                self.control.phase_current, self._typed, names, prices)  # fmt: skip

    @property
    def wants_brake(self) -> bool:
        """Whether the drive has a holding brake, unless it holds by itself."""
        return self.names_brake or self.needs.hold_unpowered

    @property
    def names_brake(self) -> bool:
        """Whether there is a brake whatever the load: by its figures, family or part, or to stop the machine with."""
        return bool(self.brake or self.select.brake.named or self.needs.emergency_stops)

    @property
    def paper_applies(self) -> bool:
        """Whether the paper's equations (1)-(20) treat this load and motion."""
        load, motion = self.load, self.motion
        return (
            isinstance(load, WheeledVehicle)
            and isinstance(motion, Trapezoid)
            and motion.phases[0] == motion.phases[2]
            and not motion.there_and_back
            and load.drag_area == 0.0
            and load.efficiency == 1.0
            and not self.cases
            and self.gear is None
            and not self.carries
            and not self.steps
        )

    @property
    def steps(self) -> bool:
        """Whether the motor is to be a stepper."""
        return self.select.motor.kind == "stepper"

    @property
    def wants_encoder(self) -> bool:
        """Whether counts, resolution, family or part of an encoder are required; else the encoder is a proposal."""
        needs, choice = self.needs, self.select.encoder
        return bool(needs.encoder_counts or needs.resolution_at_load is not None or choice.min_counts or choice.named)

    @property
    def accepts_all(self) -> bool:
        """Whether all regenerated energy leaves the bus: stored, or lost in a battery or a brake resistor.

        One out of the catalogues, whose voltage is not known yet, is chosen so that it keeps the bus below the limits.
        """
        if self.brake_resistor is not None:
            return self.brake_resistor.chopper_voltage is None
        on_battery = self.battery is not None or self.supply.kind == "battery"
        return (self.supply.accepts or ("all" if on_battery else "share")) == "all"

    @property
    def on_common_bus(self) -> bool:
        """Whether it is an axis on the supply of its machine, where what all axes regenerate is judged together."""
        return self._on_common_bus

    @property
    def slip(self) -> float:
        """Share of their turns by which the wheels of a platform slip; 0 of what has none."""
        return self.platform.slip if self.platform else 0.0

    @property
    def chopper_voltage(self) -> float | None:
        """Voltage above which a chopper does not let the bus rise [V]; None where there is none, or it is not known."""
        return self.brake_resistor.chopper_voltage if self.brake_resistor else None

    @property
    def limits_the_bus(self) -> bool:
        """Whether a brake resistor, or a power supply's peak or trip, is to be checked in the machine."""
        supply = self.supply
        peaks = supply.peak_current is not None or supply.overvoltage_trip is not None
        return self.brake_resistor is not None or peaks or supply.part is not None

    def feed(self, controller: Figures, brake: Figures | None = None) -> Feed:
        """The power stages of controllers, columns by field name, and what feeds as many as there are drives.

        A brake counts with what keeps it released: it draws that at any time, as a stage draws its standby power.
        """
        arguments = self.supply.nominal, self.power_stage, self.select.estimates == "on"
        try:
            stages = _stages(*arguments)
        except TypeError:  # figures over samples, which are not kept
            stages = _stages.__wrapped__(*arguments)
        return self._fed(stages(controller), brake)

    def feed_of(self, controller: Controller | None, brake: Brake | None = None) -> Feed:
        """The same of one controller and maybe a brake; of one whose figures are unknown where there is none."""
        stage = stage_of(controller, self.supply.nominal, self.power_stage, self.select.estimates == "on")
        return self._fed(stage, brake)

    def _fed(self, stage: StageFigures, brake: Figures | None) -> Feed:
        if brake is not None:
            stage = stage._replace(standby=stage.standby + self._brake_released * released_power(brake))
        resistance = 0.0 if self.supply.resistance is None else self.supply.resistance
        return Feed(stage, self.supply.lowest, resistance, self.load.motors)

    @property
    def resists(self) -> bool:
        """Whether a resistance of the supply or of power stages lowers the motors' voltage."""
        return self.supply.resistance is not None or self.power_stage.resistance is not None

    @property
    def load_cases(self) -> tuple[tuple[str, RobotSpec], ...]:
        """The spec itself and its further cases, by name."""
        further = self._cases
        return ((AS_SPECIFIED if further else "", self), *further)

    @property
    def alternating(self) -> tuple[str, ...]:
        """Names of the load cases that alternate with the one as specified: those with a share of the time."""
        return tuple(case.name for case in self.cases if case.share is not None)

    @property
    def shift(self) -> tuple[tuple[float, float, RobotSpec], ...]:
        """Load cases that alternate: share of the time, how long each goes on [s], spec; the one as specified first.

        Empty where no case has a share; 0 s is one cycle.
        """
        own, specs = [case for case in self.cases if case.name in self.alternating], dict(self._cases)
        if not own:
            return ()
        shared = tuple((case.share or 0.0, case.lasting or 0.0, specs[case.name]) for case in own)
        return (1.0 - sum(share for share, _, _ in shared), 0.0, self), *shared

    @property
    def is_direct(self) -> bool:
        """Whether the transmission is without a gearhead."""
        return self.transmission[0].kind == drive.DIRECT

    def behind(self, gearhead: str) -> RobotSpec:
        """The spec with the first stage that a gearhead of that part number is, or the lack of one."""
        first = drive.DirectStage(kind="direct") if gearhead == drive.DIRECT else drive.GearheadStage(kind="gearhead")
        return self.model_copy(update={"transmission": [first, *self.transmission[1:]]})

    @property
    def belt(self) -> drive.BeltStage | None:
        """The belt stage, where there is one."""
        for stage in self.transmission:
            if type(stage) is drive.BeltStage:  # quicker than ``isinstance``, which of models is a function of theirs
                return stage
        return None

    @property
    def carries(self) -> bool:
        """Whether the motion adds a payload to the load's mass."""
        return bool(getattr(self.motion, "carries", False))

    @property
    def gear(self) -> drive.GearStage | None:
        """The further stage of fixed ratio, where there is one; several in series as one."""
        stages = self.gears
        return drive.in_series(stages) if len(stages) > 1 else next(iter(stages), None)

    @property
    def gears(self) -> tuple[drive.GearStage, ...]:
        """The further stages of fixed ratio, from the motor to the load."""
        return tuple(stage for stage in self.transmission if isinstance(stage, drive.GearStage))

    @property
    def gear_before_belt(self) -> bool:
        """Whether the gear drives the belt, and not the load."""
        return (
            self.belt is not None and len(self.transmission) > 2 and isinstance(self.transmission[1], drive.GearStage)
        )

    @property
    def belt_stiffness(self) -> float:
        """Stiffness of the belt at the driven shaft [N*m/rad]; NaN where it is unknown."""
        stiffness = self.belt.stiffness if self.belt else None
        if stiffness is None:
            return math.nan
        return stiffness / self.gear.ratio**2 if self.gear and self.gear_before_belt else stiffness

    @property
    def belt_ratios(self) -> list[float]:
        """The belt ratios to search, the smallest first; 1 without a belt. Those of pulleys are in the catalogues."""
        ratio, several = (self.belt.ratio, self.belt.ratios) if self.belt else (1.0, None)
        return sorted(set(several or [])) if ratio is None else [ratio]

    @property
    def belt_efficiency(self) -> float:
        """Efficiency of the belt; 1 without one."""
        return self.belt.efficiency if self.belt else 1.0

    def changed(self, change: Callable[[RobotSpec], RobotSpec]) -> RobotSpec:
        """The spec and its further load cases with the same change."""
        spec = change(self)
        spec._cases = tuple((name, change(case)) for name, case in self._cases)
        return spec

    @property
    def price_limits(self) -> list[fields.Money]:
        """Prices that the spec gives, as far as they have a currency."""
        own = (self.needs.price, self.budget and self.budget.price, self.brake and self.brake.price)
        prices = (*own, self._machine_price)
        return [price for price in prices if isinstance(price, fields.Money)]

    def in_machine(self, price: float | None) -> RobotSpec:
        """The spec of an axis of a machine whose price is limited."""
        spec = self.model_copy()
        spec._machine_price = price if isinstance(price, fields.Money) else None
        return spec

    @property
    def counts_price(self) -> bool:
        """Whether prices rank drives or are limited."""
        return "price" in self.select.weights or bool(self.price_limits)

    def with_select(self, select: drive.Select) -> RobotSpec:
        """The spec with other permitted parts or another objective, in all load cases."""
        return self if select is self.select else self.changed(lambda spec: spec.model_copy(update={"select": select}))

    def alone(self, **sections: Any) -> RobotSpec:
        """The spec without further load cases, some of its sections changed."""
        spec = self.model_copy(update={"cases": [], **sections})
        spec._cases = ()
        return spec

    def on_supply_of_machine(self) -> RobotSpec:
        """The spec as an axis of several: what it regenerates is judged with the others', in the machine."""
        shared = {"accepts": "all", "overvoltage_trip": None, "part": None}

        def marked(spec: RobotSpec) -> RobotSpec:
            on_bus = spec.model_copy(update={"supply": spec.supply.model_copy(update=shared)})
            on_bus._on_common_bus = True
            return on_bus

        return self.changed(marked)

    @property
    def brake_released(self) -> float:
        """Share of the time in which a holding brake is kept released."""
        return self._brake_released

    def with_brake_released(self, share: float) -> RobotSpec:
        """The spec with a brake that is kept released for a share of the time."""
        spec = self.model_copy()
        spec._brake_released = share
        return spec

    @property
    def waits_until(self) -> float | None:
        """End of the machine's cycle, for which an axis of several waits at rest [s]; None: it does not."""
        return self._waits_until

    def waiting(self, until: Mapping[str, float | None]) -> RobotSpec:
        """The spec as an axis that waits at rest for the end of the machine's cycle [s], by load case."""
        spec = self.model_copy()
        spec._waits_until = until.get(self.load_cases[0][0])
        spec._cases = tuple((name, case.waiting({"": until.get(name)})) for name, case in self._cases)
        return spec

    def with_cases(self, further: Iterable[tuple[str, RobotSpec]]) -> RobotSpec:
        """The spec with more load cases behind its own, by name."""
        spec = self.model_copy()
        spec._cases = (*self._cases, *further)
        return spec

    @property
    def toleranced(self) -> tuple[Toleranced, ...]:
        """The figures that carry a tolerance, in the order of the file; those of load cases among them."""
        return self._toleranced


# -- A robot.yaml, or the same fields as a dict, to a ``RobotSpec`` with its load cases and tolerances.


_SHAPING = ("load", "motion", "transmission", "platform", "cases")  # the load cycles
_VARIED = ("load", "motion", "supply", "environment", "platform")


def read_spec(source: YamlSource) -> RobotSpec:
    """A spec from YAML source.

    Parameters
    ----------
    source
        The file.

    Returns
    -------
    RobotSpec
        The spec, checked as a whole.

    Raises
    ------
    InputError
        One line with file, line, field, what was found and what is expected.
    """
    if not isinstance(source.data, dict):
        raise InputError(f"{source.name}: expected fields such as name, load, motion; see `drivesizer init`")
    data, toleranced = split_tolerances(source)
    data, typed = drive.split_typed(source, data)
    spec = _read(source, data)
    for case in (spec, *(case for _, case in spec._cases)):
        case._typed = typed
    spec._toleranced = toleranced
    shaping = next((figure for figure in toleranced if spec.shift and figure.path[0] in _SHAPING), None)
    if shaping is not None:
        text = "cases that alternate by their shares are at nominal figures; expected it without a tolerance"
        raise InputError(f"{source.where(shaping.path)}: {text}")
    for figure in toleranced:  # both ends must be values that the field may have
        for end, value in (("lowest", figure.distribution.low), ("highest", figure.distribution.high)):
            _reached(source, data, figure, end, value)
    spec._toleranced = tuple(figure.as_angle() if _is_grade(spec, figure) else figure for figure in toleranced)
    return spec


def _is_grade(spec: RobotSpec, figure: Toleranced) -> bool:
    """Whether a figure in per cent became the angle of a slope."""
    if figure.unit != "%":
        return False
    of_case = figure.path[0] == "cases"
    place: Any = spec._cases[int(figure.path[1])][1] if of_case else spec
    for step in figure.path[2:] if of_case else figure.path:
        place = getattr(place, step) if isinstance(step, str) and not isinstance(place, dict) else place[step]
    return bool(place == math.atan(figure.value) != figure.value)


def _read(source: YamlSource, data: dict[str, Any]) -> RobotSpec:
    spec = _validated(source, data)
    spec._cases = tuple((case.name, _case(source, data, number)) for number, case in enumerate(spec.cases))
    return spec


def _reached(source: YamlSource, data: dict[str, Any], figure: Toleranced, end: str, value: float) -> None:
    """Refuse a tolerance with an end outside the range of the field."""
    try:
        _read(source, changed(data, figure.path, figure.as_text(value)))
    except InputError as error:
        reason = re.sub(r'^\S+:\d+: (\S+: )?("[^"]*" )?', "", str(error))
        text = f"{quoted(figure.text)} is {figure.with_unit(value)} at its {end}: {reason}"
        raise InputError(f"{source.where(figure.path)}: {text}") from None


def _validated(source: YamlSource, data: dict[str, Any], at: Path_ = ()) -> RobotSpec:
    load = data["load"] if isinstance(data.get("load"), dict) else {}
    axis = AXES.get(str(load.get("kind")), "linear")  # in which units the motion is given
    known, values = source.sections, dict(data)
    for name in RobotSpec.model_fields:
        if (name, axis) in known and known[name, axis][0] is data.get(name):
            values[name] = known[name, axis][1]
    try:
        spec = RobotSpec.model_validate(values, context={"axis": axis})
    except ValidationError as error:
        raise explained(error, source, RobotSpec, data, at) from None
    spec.model_fields_set.intersection_update(data)
    of_spec = ((name, getattr(spec, name)) for name in RobotSpec.model_fields)
    known |= {
        (name, axis): (data.get(name), section)
        for name, section in of_spec
        if isinstance(section, fields.Section | list)
    }
    spec._source = source
    return spec


def _case(source: YamlSource, whole: dict[str, Any], number: int) -> RobotSpec:
    """The spec changed by one of its cases, validated as a spec of its own."""
    case, data = whole["cases"][number], {name: value for name, value in whole.items() if name != "cases"}
    for section in _VARIED:
        if section in case:
            another = "kind" in case[section] or "profile" in case[section]  # another load or motion altogether
            data[section] = {**({} if another else data.get(section) or {}), **case[section]}
    if case.get("once") is not None:
        data["once"] = case["once"]
    return _validated(source, data, ("cases", number))


def load_spec(given: str | Path | Mapping[str, Any]) -> RobotSpec:
    """A spec from a file, or from the same fields as a dict.

    Parameters
    ----------
    given
        Path of the file, or fields: texts with units, numbers, lists and dicts, as a file has them.

    Returns
    -------
    RobotSpec
        The spec; paths in a dict count from the current folder.

    Raises
    ------
    InputError
        When the file cannot be read or something in it is wrong: one line with place and reason.

    Examples
    --------
    >>> spec = load_spec({
    ...     "name": "turntable",
    ...     "load": {"kind": "flywheel", "inertia": "0.2 kg*m^2"},
    ...     "motion": {"speed": "60 rpm", "acceleration_time": "1 s", "cruise_time": "5 s"},
    ...     "supply": {"nominal": "24 V", "current": "10 A"},
    ... })
    >>> round(spec.motion.speed, 3)
    6.283
    """
    return read_spec(source_of(given))
