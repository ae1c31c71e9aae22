"""Types of a spec's fields: text with a unit in, SI float out, inside its range.

Every quantity is read by the strict reader of ``units``. A motion is given in the terms of its load: along a line or
about an axis. Which of the two comes with the validation (``context``), so that an error has the line of the wrong
unit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationInfo, WithJsonSchema
from pydantic_core import core_schema

from drivesizer.units import KINDS, Kind, label, noun, to_si

__all__ = [
    "Acceleration", "Allowance", "Altitude", "Angle", "Area", "Axis", "BackEfficiency", "Bearing", "Capacitance",
    "Coefficient", "Consumed", "Counterweight", "Current", "Density", "Distance", "Drop", "Duration", "Energy",
    "Exponent", "Factor", "Force", "Frequency", "Gain", "Gravity", "Incline", "Jerk", "Length", "Mass", "Names",
    "Part", "Pause", "Place", "Power", "Price", "Pull", "Quantity", "Ratio", "Resistance", "Section", "Share",
    "SignedSpeed", "SignedTorque", "SignedVelocity", "Slope", "Speed", "Stiffness", "Temperature",
    "ThermalResistance", "Thickness", "Torque", "TorqueAbove", "Turning", "Velocity", "Voltage", "all_defaults",
    "default",
    "exactly_one", "no_entries",
]  # fmt: skip

Axis = Literal["linear", "rotary"]
_OR_GRADE = ", or a grade such as 5 %"
_WRITTEN = 1e-5  # relative: how far five digits are off


@dataclass(frozen=True, slots=True)
class Quantity:
    """A field's type: text with unit in, SI float out, inside its range."""

    kind: str
    above: float = -math.inf
    least: float = -math.inf
    most: float = math.inf
    rotary: str = ""  # the kind in its place where the load turns about an axis
    grade: bool = False  # an angle that may be written in per cent: rise over distance travelled on the level

    def read(self, text: object, info: ValidationInfo) -> float:
        """The SI value of a text; a value outside the range is a ValueError."""
        turns = bool(self.rotary) and (info.context or {}).get("axis") == "rotary"
        kind = KINDS[self.rotary if turns else self.kind]
        if self.grade and isinstance(text, str) and text.rstrip().endswith("%"):
            value = self._rounded(math.atan(to_si(text, "dimensionless")))
        else:
            value = self._rounded(to_si(text, self.rotary if turns else self.kind))
        if value > self.above and self.least <= value <= self.most:
            return value
        words = f"at most {_limit(self.most, kind)}"
        if not value > self.above:
            words = f"above {_limit(self.above, kind)}"
        elif not value >= self.least:
            words = f"at least {_limit(self.least, kind)}"
        raise ValueError(f"must be {words}, e.g. {self._example(text, value, kind)}")

    def _example(self, text: object, value: float, kind: Kind) -> str:
        """An example of the kind; of a share above 1 without its sign the per cent that are meant."""
        if self.most == 1.0 < value <= 100.0 and not str(text).rstrip().endswith("%"):
            return f"{value / 100:g} or {value:g} %"
        return kind.example

    def _rounded(self, value: float) -> float:
        """An angle as its limit where it is written as that: 1.5708 rad is 90 deg, no more."""
        if self.kind == "angle":
            for limit in (self.least, self.most):
                if abs(value) > abs(limit) and math.isclose(value, limit, rel_tol=_WRITTEN):
                    return limit
        return value

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.with_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        if self.kind == "dimensionless":
            return {"type": ["number", "string"], "description": "a plain number or percent"}
        kinds = [self.kind, self.rotary] if self.rotary else [self.kind]
        return {
            "type": "string",
            "description": f"{' or '.join(noun(kind) for kind in kinds)} with unit{_OR_GRADE * self.grade}",
            "examples": [KINDS[kind].example for kind in kinds],
        }


def _limit(value: float, kind: Kind) -> str:
    """A limit with its unit; of an angle in degrees, as one thinks of it."""
    return f"{math.degrees(value):g} deg" if kind.si == "rad" else f"{value:g} {label(kind.si)}".rstrip()


Place = Annotated[float, Quantity("length")]  # with its sign
Length = Annotated[float, Quantity("length", above=0.0)]
Altitude = Annotated[float, Quantity("length", least=-500.0, most=4000.0)]
Thickness = Annotated[float, Quantity("length", least=0.0)]
Mass = Annotated[float, Quantity("mass", above=0.0)]
Counterweight = Annotated[float, Quantity("mass", least=0.0)]
Speed = Annotated[float, Quantity("speed", above=0.0)]
SignedSpeed = Annotated[float, Quantity("speed")]
Turning = Annotated[float, Quantity("rotary_speed", above=0.0)]
Duration = Annotated[float, Quantity("time", above=0.0)]
Pause = Annotated[float, Quantity("time", least=0.0)]
Gravity = Annotated[float, Quantity("acceleration", above=0.0)]
Slope = Annotated[float, Quantity("angle", least=-math.pi / 3, most=math.pi / 3, grade=True)]
Incline = Annotated[float, Quantity("angle", least=-math.pi / 2, most=math.pi / 2, grade=True)]
Angle = Annotated[float, Quantity("angle", above=0.0)]
Bearing = Annotated[float, Quantity("angle", least=-2 * math.pi, most=2 * math.pi)]
Area = Annotated[float, Quantity("area", least=0.0)]
Density = Annotated[float, Quantity("density", above=0.0)]
Force = Annotated[float, Quantity("force", least=0.0)]
Pull = Annotated[float, Quantity("force")]  # with its sign
Torque = Annotated[float, Quantity("torque", least=0.0)]
TorqueAbove = Annotated[float, Quantity("torque", above=0.0)]
SignedTorque = Annotated[float, Quantity("torque")]
Stiffness = Annotated[float, Quantity("torsional_stiffness", above=0.0)]
Voltage = Annotated[float, Quantity("voltage", above=0.0)]
Drop = Annotated[float, Quantity("voltage", least=0.0)]
Current = Annotated[float, Quantity("current", above=0.0)]
Power = Annotated[float, Quantity("power", above=0.0)]
Consumed = Annotated[float, Quantity("power", least=0.0)]
Energy = Annotated[float, Quantity("energy", above=0.0)]
Resistance = Annotated[float, Quantity("resistance", above=0.0)]
ThermalResistance = Annotated[float, Quantity("thermal_resistance", above=0.0)]
Capacitance = Annotated[float, Quantity("capacitance", above=0.0)]
Frequency = Annotated[float, Quantity("frequency", above=0.0)]
Temperature = Annotated[float, Quantity("temperature", above=0.0)]
Price = Annotated[float, Quantity("price", above=0.0)]
BackEfficiency = Annotated[float, Quantity("dimensionless", most=1.0)]  # below 0 of what is self-locking
Share = Annotated[float, Quantity("dimensionless", above=0.0, most=1.0)]  # a factor or efficiency
Part = Annotated[float, Quantity("dimensionless", least=0.0, most=1.0)]
Exponent = Annotated[float, Quantity("dimensionless", least=0.0, most=4.0)]
Coefficient = Annotated[float, Quantity("dimensionless", least=0.0)]
Allowance = Annotated[float, Quantity("dimensionless", least=0.0, most=100.0)]
Factor = Annotated[float, Quantity("dimensionless", least=1.0)]
Ratio = Annotated[float, Quantity("dimensionless", above=0.0)]
Gain = Annotated[float, Quantity("dimensionless", least=0.0)]
# of a motion, along a line or about an axis
Velocity = Annotated[float, Quantity("speed", above=0.0, rotary="rotary_speed")]
SignedVelocity = Annotated[float, Quantity("speed", rotary="rotary_speed")]
Distance = Annotated[float, Quantity("length", above=0.0, rotary="angle")]
Acceleration = Annotated[float, Quantity("acceleration", above=0.0, rotary="angular_acceleration")]
Jerk = Annotated[float, Quantity("jerk", above=0.0, rotary="angular_jerk")]

_NAME = {"type": ["string", "integer"]}
Names = Annotated[
    list[str],
    Field(min_length=1),
    BeforeValidator(lambda value: _listed(value)),
    WithJsonSchema({"anyOf": [_NAME, {"type": "array", "items": _NAME, "minItems": 1}]}),
]


def _listed(value: Any) -> Any:
    """One name or several, as a list of texts; order numbers may be bare."""
    values = value if isinstance(value, list) else [value]
    return [str(v) if isinstance(v, int) and not isinstance(v, bool) else v for v in values]


def default(text: Any, **more: Any) -> Any:
    """A default as a user would write it; it goes through the same reader."""
    return Field(default=text, **more)


def all_defaults(**more: Any) -> Any:
    """A group of fields, or of entries by name, of which a file may give none: fields are then at their defaults."""
    return Field(default_factory=_no_fields, **more)


def no_entries(**more: Any) -> Any:
    """A list that a file may leave out: it has no entries then."""
    return Field(default_factory=_no_list, **more)


# functions, and not ``dict`` and ``list``: pydantic looks how each is called, which of these takes it milliseconds
def _no_fields() -> dict[str, Any]:
    return {}


def _no_list() -> list[Any]:
    return []


class Section(BaseModel):
    """A group of fields: no unknown keys, nothing converted, nothing changed later.

    Its module has no ``from __future__ import annotations``: pydantic would compile the text of each annotation, a
    quarter of the time that a class takes.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, validate_default=True, defer_build=True)


def exactly_one(section: BaseModel, *names: str) -> None:
    """Refuse a section that gives none or several of some fields."""
    given = [name for name in names if getattr(section, name) is not None]
    if len(given) != 1:
        found = "neither is given" if not given and len(names) == 2 else "none is given" if not given else (
            "both are given" if len(names) == 2 else f"{'both ' * (len(given) == 2)}{' and '.join(given)} are given"
        )  # fmt: skip
        raise ValueError(f"give {' or '.join(names)}, exactly one of them; {found}")
