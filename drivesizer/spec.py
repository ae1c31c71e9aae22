"""robot.yaml to typed data: the only place where a user's file becomes numbers.

Every quantity is read by the strict reader of ``units`` and is an SI float from here on. The models below are
the file's schema; their descriptions are the documentation that ``drivesizer schema`` prints.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PrivateAttr,
    ValidationError,
    model_validator,
)
from pydantic_core import core_schema

from drivesizer.errors import InputError
from drivesizer.spec_errors import explained
from drivesizer.units import KINDS, label, noun, to_si
from drivesizer.yaml_source import Path_, YamlSource, read

__all__ = ["RobotSpec", "load_spec", "read_spec"]


@dataclass(frozen=True, slots=True)
class Quantity:
    """A field's type: text with unit in, SI float out, inside its range."""

    kind: str
    above: float = -math.inf
    least: float = -math.inf
    most: float = math.inf

    def read(self, text: object) -> float:
        """The SI value of a text; a value outside the range is a ValueError."""
        value = to_si(text, self.kind)
        example = KINDS[self.kind].example
        for bad, words in (
            (not value > self.above, f"above {self.above:g}"),
            (not value >= self.least, f"at least {self.least:g}"),
            (not value <= self.most, f"at most {self.most:g}"),
        ):
            if bad:
                unit = label(KINDS[self.kind].si)
                raise ValueError(f"must be {words} {unit}".rstrip() + f", e.g. {example}")
        return value

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        if self.kind == "dimensionless":
            return {"type": ["number", "string"], "description": "a plain number or percent"}
        return {"type": "string", "description": f"{noun(self.kind)} with unit", "examples": [KINDS[self.kind].example]}


Length = Annotated[float, Quantity("length", above=0.0)]
Thickness = Annotated[float, Quantity("length", least=0.0)]
Mass = Annotated[float, Quantity("mass", above=0.0)]
Inertia = Annotated[float, Quantity("inertia", least=0.0)]
Speed = Annotated[float, Quantity("speed", above=0.0)]
Duration = Annotated[float, Quantity("time", above=0.0)]
Pause = Annotated[float, Quantity("time", least=0.0)]
Gravity = Annotated[float, Quantity("acceleration", above=0.0)]
Slope = Annotated[float, Quantity("angle", least=-math.pi / 3, most=math.pi / 3)]
Angle = Annotated[float, Quantity("angle", above=0.0)]
Density = Annotated[float, Quantity("density", above=0.0)]
Voltage = Annotated[float, Quantity("voltage", above=0.0)]
Current = Annotated[float, Quantity("current", above=0.0)]
Frequency = Annotated[float, Quantity("frequency", above=0.0)]
Temperature = Annotated[float, Quantity("temperature", above=0.0)]
Share = Annotated[float, Quantity("dimensionless", above=0.0, most=1.0)]  # a factor or efficiency
Coefficient = Annotated[float, Quantity("dimensionless", least=0.0)]
Factor = Annotated[float, Quantity("dimensionless", least=1.0)]
Ratio = Annotated[float, Quantity("dimensionless", above=0.0)]
Gain = Annotated[float, Quantity("dimensionless", least=0.0)]
Names = Annotated[list[str], Field(min_length=1), BeforeValidator(lambda value: _listed(value))]


def _listed(value: Any) -> Any:
    """One name or several, as a list of texts; order numbers may be bare."""
    values = value if isinstance(value, list) else [value]
    return [str(v) if isinstance(v, int) and not isinstance(v, bool) else v for v in values]


def _default(text: Any, **more: Any) -> Any:
    """A default as a user would write it; it goes through the same reader."""
    return Field(default=text, **more)


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, validate_default=True)


class Cylinder(_Section):
    """A rotating hollow cylinder, (8) and (9)."""

    density: Density
    outer_diameter: Length
    inner_diameter: Thickness = _default("0 mm", description="0 when solid")
    width: Length

    @model_validator(mode="after")
    def _hollow(self) -> Cylinder:
        if not self.inner_diameter < self.outer_diameter:
            raise ValueError("inner_diameter must be below outer_diameter")
        return self


class Cylinders(_Section):
    """The cylinders that turn with each driven wheel."""

    wheel: Cylinder
    shaft: Cylinder | None = None


class WheeledVehicle(_Section):
    """A vehicle on driven wheels, each with its own motor set."""

    kind: Literal["wheeled_vehicle"]
    mass: Mass = Field(description="whole vehicle, payload included")
    driven_wheels: Annotated[int, Field(ge=1, le=100)] = Field(description="wheels with a motor set")
    wheel_diameter: Length
    rolling_resistance: Coefficient | None = Field(default=None, description="C_rr; or give sinkage")
    sinkage: Thickness | None = Field(default=None, description="sinking depth z of (4); or give rolling_resistance")
    friction_coefficient: Coefficient | None = Field(default=None, description="between wheel and floor, for traction")
    slope: Slope = _default("0 deg", description="uphill positive")
    cylinders: Cylinders | None = Field(default=None, description="wheel and shaft; or give inertia")
    inertia: Inertia | None = Field(default=None, description="of one wheel with its shaft; or give cylinders")

    @model_validator(mode="after")
    def _one_of_each(self) -> WheeledVehicle:
        _exactly_one(self, "rolling_resistance", "sinkage")
        _exactly_one(self, "cylinders", "inertia")
        if self.sinkage is not None and self.sinkage >= self.wheel_diameter:
            raise ValueError("sinkage must be below wheel_diameter")
        return self


def _exactly_one(section: BaseModel, first: str, second: str) -> None:
    given = [name for name in (first, second) if getattr(section, name) is not None]
    if len(given) != 1:
        both = "both are given" if given else "neither is given"
        raise ValueError(f"give {first} or {second}, exactly one of them; {both}")


class Trapezoid(_Section):
    """Accelerate, cruise, decelerate in the same time, rest; repeated."""

    profile: Literal["trapezoid"] = "trapezoid"
    speed: Speed = Field(description="cruising speed")
    acceleration_time: Duration = Field(description="also the time of deceleration")
    cruise_time: Pause
    rest_time: Pause = _default("0 s")


class GearheadStage(_Section):
    """A gearhead out of the catalogues: searched."""

    kind: Literal["gearhead"]


class BeltStage(_Section):
    """A belt between gearhead and load: one ratio, or several to search."""

    kind: Literal["belt"]
    ratio: Ratio | None = Field(default=None, description="gearhead turns per turn of the load; or give ratios")
    ratios: Annotated[list[Ratio], Field(min_length=1, max_length=1000)] | None = None
    efficiency: Share

    @model_validator(mode="after")
    def _one_of_each(self) -> BeltStage:
        _exactly_one(self, "ratio", "ratios")
        return self


Stage = Annotated[GearheadStage | BeltStage, Field(discriminator="kind")]


class PaperFactors(_Section):
    """The paper's factors; it gives no values for them."""

    speed_reserve: Share = Field(default=1, description="η of (1)")
    bearing: Share = Field(default=1, description="δ of (2)")
    robot_efficiency: Share = Field(default=1, description="η of (10)")
    confidence: Share = Field(default=1, description="κ of (7)")
    oversize: Factor = Field(default=1, description="PF of (7) and (10)")


class Supply(_Section):
    """The electrical supply of the motor controllers."""

    nominal: Voltage
    min: Voltage | None = Field(default=None, description="lowest voltage; nominal where not given")
    max: Voltage | None = Field(default=None, description="highest voltage; nominal where not given")
    current: Current | None = Field(default=None, description="what the supply can give to all motor sets")

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


class Environment(_Section):
    """Where the machine works."""

    ambient: Temperature = _default("25 degC")
    gravity: Gravity = _default("9.80665 m/s^2")


class Needs(_Section):
    """What the drive must offer beyond moving the load."""

    encoder_counts: Annotated[int, Field(ge=1)] | None = Field(default=None, description="counts per motor turn")
    backlash_at_load: Angle | None = Field(default=None, description="lost motion of the gearhead, seen at the load")
    bandwidth: Frequency | None = Field(default=None, description="of the closed velocity loop")


class Control(_Section):
    """The velocity controller of the validation; gains are designed where none are given."""

    kp: Gain | None = Field(default=None, description="proportional gain [V per rad/s at the motor]")
    ki: Gain = Field(default=0, description="integral gain [V per rad]")
    kd: Gain = Field(default=0, description="derivative gain [V per rad/s^2]")
    bandwidth: Frequency | None = Field(default=None, description="closed-loop bandwidth to design for")

    @model_validator(mode="after")
    def _whole(self) -> Control:
        if self.kp is None and (self.ki or self.kd):
            raise ValueError("ki and kd need kp")
        if self.kp is not None and self.bandwidth is not None:
            raise ValueError("give kp or bandwidth, not both")
        return self


class Choice(_Section):
    """Restricts a kind of part to some families or part numbers."""

    family: Names | None = None
    part: Names | None = None


class EncoderChoice(Choice):
    """Restricts the encoder."""

    min_counts: Annotated[int, Field(ge=1)] | None = Field(default=None, description="counts per turn at least")


class ControllerChoice(Choice):
    """Restricts the controller."""

    bus: str | None = Field(default=None, description="such as CANopen or EtherCAT")


Objective = Literal["mass", "price", "power", "length", "margin"]


class Select(_Section):
    """Which parts may be chosen, and what makes one set better than another."""

    catalogs: Names = Field(default=["maxon"])
    motor: Choice = Field(default_factory=Choice)
    gearhead: Choice = Field(default_factory=Choice)
    encoder: EncoderChoice = Field(default_factory=EncoderChoice)
    controller: ControllerChoice = Field(default_factory=ControllerChoice)
    objective: Objective = "mass"
    unknown: Literal["allow", "reject"] = Field(default="allow", description="sets with a check that is unknown")

    @property
    def is_restricted(self) -> bool:
        """Whether families or parts are named."""
        return any(c.family or c.part for c in (self.motor, self.gearhead, self.encoder, self.controller))


class RobotSpec(_Section):
    """A robot.yaml: the load, its motion, and what the drive may be made of."""

    name: str = Field(min_length=1, max_length=200)
    method: Literal["paper", "physics"] = Field(
        default="paper", description="what ranks: the paper's equations and rule, or the whole load cycle"
    )
    load: WheeledVehicle
    motion: Trapezoid
    transmission: Annotated[list[Stage], Field(min_length=1, max_length=2)] = _default(
        [{"kind": "gearhead"}], description="from the motor to the load"
    )
    paper_factors: PaperFactors = Field(default_factory=PaperFactors)
    supply: Supply
    environment: Environment = Field(default_factory=Environment)
    needs: Needs = Field(default_factory=Needs)
    control: Control = Field(default_factory=Control)
    select: Select = Field(default_factory=Select)

    _source: YamlSource | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _chain(self) -> RobotSpec:
        kinds = [stage.kind for stage in self.transmission]
        if kinds not in (["gearhead"], ["gearhead", "belt"]):
            raise ValueError("transmission must be a gearhead, or a gearhead and then a belt")
        return self

    @property
    def belt(self) -> BeltStage | None:
        """The belt stage, where there is one."""
        return next((stage for stage in self.transmission if isinstance(stage, BeltStage)), None)

    @property
    def belt_ratios(self) -> list[float]:
        """The belt ratios to search; 1 without a belt."""
        belt = self.belt
        if belt is None:
            return [1.0]
        return [belt.ratio] if belt.ratio is not None else sorted(set(belt.ratios or []))

    @property
    def belt_efficiency(self) -> float:
        """Efficiency of the belt; 1 without one."""
        return self.belt.efficiency if self.belt else 1.0

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
    try:
        spec = RobotSpec.model_validate(source.data)
    except ValidationError as error:
        raise InputError(explained(error, source, RobotSpec)) from None
    spec._source = source
    return spec


def load_spec(path: str | Path) -> RobotSpec:
    """A spec from a file.

    Raises
    ------
    InputError
        When the file cannot be read or something in it is wrong: one line that says where and what.
    """
    return read_spec(read(Path(path)))
