"""robot.yaml to typed data: the only place where a user's file becomes numbers.

Every quantity is read by the strict reader of ``units`` and is an SI float from here on. The models here, in
``machines`` (what is moved) and in ``motions`` (how) are the file's schema; their descriptions are the documentation
that ``drivesizer schema`` prints.
"""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, PrivateAttr, ValidationError, field_validator, model_validator

from drivesizer.choices import Select
from drivesizer.errors import InputError
from drivesizer.fields import (
    Allowance,
    Angle,
    Capacitance,
    Current,
    Duration,
    Factor,
    Force,
    Frequency,
    Gravity,
    Length,
    Mass,
    Part,
    Power,
    Price,
    Ratio,
    Resistance,
    Section,
    Share,
    Temperature,
    Voltage,
    default,
)
from drivesizer.loop_schema import Control, Plant
from drivesizer.machines import AXES, Load, WheeledVehicle
from drivesizer.motions import Motion, Trapezoid
from drivesizer.spec_errors import explained
from drivesizer.transmission import BeltStage, Offer, Stage
from drivesizer.yaml_source import Path_, YamlSource, read

__all__ = ["AS_SPECIFIED", "RobotSpec", "load_spec", "read_spec"]


class PaperFactors(Section):
    """The paper's factors; it gives no values for them."""

    speed_reserve: Share = Field(default=1, description="η of (1)")
    bearing: Share = Field(default=1, description="δ of (2)")
    robot_efficiency: Share = Field(default=1, description="η of (10)")
    confidence: Share = Field(default=1, description="κ of (7)")
    oversize: Factor = Field(default=1, description="PF of (7) and (10)")


class Supply(Section):
    """The electrical supply of the motor controllers."""

    nominal: Voltage
    min: Voltage | None = Field(default=None, description="lowest voltage; nominal where not given")
    max: Voltage | None = Field(default=None, description="highest voltage; nominal where not given")
    resistance: Resistance | None = Field(default=None, description="of source and cables, in the closed loop")
    current: Current | None = Field(default=None, description="what the supply can give to all motor sets")
    power: Power | None = Field(default=None, description="what the supply can give to all motor sets")
    regeneration: Part = Field(default=0, description="share of returned energy that the supply takes back; 0 none")
    capacitance: Capacitance | None = Field(default=None, description="of the bus, where returned energy has to stay")

    @model_validator(mode="after")
    def _ordered(self) -> Supply:
        if not (self.min or self.nominal) <= self.nominal <= (self.max or self.nominal):
            raise ValueError("expected min <= nominal <= max")
        return self

    @property
    def lowest(self) -> float:
        """Lowest supply voltage [V]."""
        return float(self.min or self.nominal)

    @property
    def highest(self) -> float:
        """Highest supply voltage [V]."""
        return float(self.max or self.nominal)


class Environment(Section):
    """Where the machine works."""

    ambient: Temperature = default("25 degC")
    gravity: Gravity = default("9.80665 m/s^2")


class Margins(Section):
    """How much every limit must exceed what is asked, by physics; the paper has its own factors."""

    torque: Allowance = Field(default=0, description="of gearhead torques, motor and controller currents, traction")
    speed: Allowance = Field(default=0, description="of motor, gearhead and encoder speeds, and of voltage")
    temperature: Allowance = Field(default=0, description="of the winding's permitted rise over the ambient")


class Mission(Section):
    """What is done with the motion, for the closed loop."""

    duration: Duration = Field(description="for which the cycle is repeated, rounded up to whole cycles")


class Needs(Section):
    """What the drive must offer beyond moving the load."""

    encoder_counts: Annotated[int, Field(ge=1)] | None = Field(default=None, description="counts per motor turn")
    backlash_at_load: Angle | None = Field(default=None, description="lost motion of the gearhead, seen at the load")
    bandwidth: Frequency | None = Field(default=None, description="of the closed velocity loop")
    resolution_at_load: Angle | None = Field(default=None, description="angle of the load per edge of the encoder")
    inertia_ratio: Ratio | None = Field(default=None, description="load's inertia over the motor's, at most")
    resonance: Frequency | None = Field(default=None, description="of motor and load on the belt, at least")
    hold_unpowered: bool = Field(default=False, description="the load must stay where it is without power")
    radial_load: Force | None = Field(default=None, description="on the gearhead's shaft, such as a belt's pull")
    diameter: Length | None = Field(default=None, description="of motor and gearhead, at most")
    length: Length | None = Field(default=None, description="of motor and gearhead together, at most")
    mass: Mass | None = Field(default=None, description="of motor and gearhead together, at most")
    price: Price | None = Field(default=None, description="of motor and gearhead together, at most")


class Case(Section):
    """What differs in another load case; everything else is as the spec says."""

    name: str = Field(min_length=1, max_length=60)
    load: dict[str, Any] = Field(default_factory=dict)
    motion: dict[str, Any] = Field(default_factory=dict)
    supply: dict[str, Any] = Field(default_factory=dict)
    environment: dict[str, Any] = Field(default_factory=dict)


AS_SPECIFIED = "as specified"  # the name of the first load case where there are others
_VARIED = ("load", "motion", "supply", "environment")


class RobotSpec(Section):
    """A robot.yaml: the load, its motion, and what the drive may be made of."""

    name: str = Field(min_length=1, max_length=200)
    method: Literal["paper", "physics"] = Field(
        default="physics", description="what ranks: the whole load cycle, or the paper's equations and rule"
    )
    load: Load
    motion: Motion | None = Field(default=None, description="one cycle, repeated; a recorded load brings its own")
    transmission: Annotated[list[Stage], Field(min_length=1, max_length=2)] = default(
        [{"kind": "gearhead"}], description="from the motor to the load"
    )
    paper_factors: PaperFactors = Field(default_factory=PaperFactors)
    margins: Margins = Field(default_factory=Margins)
    supply: Supply
    environment: Environment = Field(default_factory=Environment)
    needs: Needs = Field(default_factory=Needs)
    mission: Mission | None = Field(default=None, description="for the closed loop; one cycle where not given")
    control: Control = Field(default_factory=Control)
    plant: Plant = Field(default_factory=Plant)
    select: Select = Field(default_factory=Select)
    cases: Annotated[list[Case], Field(max_length=100)] = Field(
        default_factory=list, description="further load cases; a set must pass all"
    )

    _source: YamlSource | None = PrivateAttr(default=None)
    _cases: tuple[RobotSpec, ...] = PrivateAttr(default=())

    @model_validator(mode="after")
    def _chain(self) -> RobotSpec:
        kinds = [stage.kind for stage in self.transmission]
        if kinds not in (["gearhead"], ["gearhead", "belt"]):
            raise ValueError("transmission must be a gearhead, or a gearhead and then a belt")
        return self

    @field_validator("cases")
    @classmethod
    def _named_apart(cls, cases: list[Case]) -> list[Case]:
        names = [case.name for case in cases]
        if len(set(names)) != len(names):
            raise ValueError("expected cases with names of their own")
        return cases

    @model_validator(mode="after")
    def _moved(self) -> RobotSpec:
        recorded = self.load.kind == "recorded"
        if recorded and self.motion is not None:
            raise ValueError("motion: a recorded load brings its own motion; leave this one out")
        if not recorded and self.motion is None:
            raise ValueError("motion is missing; expected fields such as speed, acceleration_time, cruise_time")
        if self.method == "paper" and not self.paper_applies:
            raise ValueError(
                "method: the paper treats a wheeled_vehicle without wind on a trapezoid that decelerates as it "
                "accelerates, in one case; expected method: physics"
            )
        return self

    @property
    def paper_applies(self) -> bool:
        """Whether the paper's equations (1)-(20) treat this load and motion."""
        load, motion = self.load, self.motion
        return (
            isinstance(load, WheeledVehicle)
            and isinstance(motion, Trapezoid)
            and motion.deceleration_time in (None, motion.acceleration_time)
            and not motion.there_and_back
            and load.drag_area == 0.0
            and not self.cases
        )

    @property
    def load_cases(self) -> tuple[tuple[str, RobotSpec], ...]:
        """The spec itself and its further cases, by name."""
        first = AS_SPECIFIED if self._cases else ""
        return ((first, self), *((case.name, spec) for case, spec in zip(self.cases, self._cases, strict=True)))

    @property
    def belt(self) -> BeltStage | None:
        """The belt stage, where there is one."""
        return next((stage for stage in self.transmission if isinstance(stage, BeltStage)), None)

    @property
    def belt_ratios(self) -> list[float]:
        """The belt ratios to search; 1 without a belt, those that the catalogues offer for pulleys."""
        return self.belt.to_search if self.belt else [1.0]

    @property
    def belt_efficiency(self) -> float:
        """Efficiency of the belt; 1 without one."""
        return self.belt.efficiency if self.belt else 1.0

    def with_offer(self, offer: Offer) -> RobotSpec:
        """The spec and its cases with what the catalogues offer for the belt."""
        stages = [s.with_offer(offer) if isinstance(s, BeltStage) else s for s in self.transmission]
        changed = self.model_copy(update={"transmission": stages})
        changed._cases = tuple(case.with_offer(offer) for case in self._cases)
        return changed

    @property
    def entered(self) -> dict[str, Any]:
        """The spec as the user wrote it."""
        return dict(self._source.data) if self._source else {}

    @property
    def text(self) -> str:
        """The file as the user wrote it, comments included."""
        return self._source.text if self._source else ""

    @property
    def file(self) -> str:
        """Name of the file."""
        return self._source.name if self._source else ""

    def where(self, path: Path_) -> str:
        """File, line and name of a field, for a message."""
        return self._source.where(path) if self._source else ".".join(str(step) for step in path)


def read_spec(source: YamlSource) -> RobotSpec:
    """A spec from YAML that was read already.

    Raises
    ------
    InputError
        One line with file, line, field, what was found and what is expected.
    """
    if not isinstance(source.data, dict):
        raise InputError(f"{source.name}: expected fields such as name, load, motion; see `drivesizer init`")
    spec = _validated(source, source.data)
    spec._cases = tuple(_case(source, number) for number in range(len(spec.cases)))
    return spec


def _validated(source: YamlSource, data: dict[str, Any], at: Path_ = ()) -> RobotSpec:
    kind = data["load"].get("kind") if isinstance(data.get("load"), dict) else None
    try:
        spec = RobotSpec.model_validate(data, context={"axis": AXES.get(str(kind), "linear")})
    except ValidationError as error:
        raise InputError(explained(error, source, RobotSpec, data, at)) from None
    spec._source = source
    return spec


def _case(source: YamlSource, number: int) -> RobotSpec:
    """The spec as one of its cases changes it, read as a spec of its own."""
    case, data = source.data["cases"][number], deepcopy(source.data)
    del data["cases"]
    for section in _VARIED:
        if section in case:
            another = "kind" in case[section] or "profile" in case[section]  # another load or motion altogether
            data[section] = {**({} if another else data.get(section) or {}), **case[section]}
    return _validated(source, data, ("cases", number))


def load_spec(path: str | Path) -> RobotSpec:
    """A spec from a file.

    Raises
    ------
    InputError
        When the file cannot be read or something in it is wrong: one line that says where and what.
    """
    return read_spec(read(Path(path)))
