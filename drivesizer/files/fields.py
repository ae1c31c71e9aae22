"""Types of a spec's fields: text with a unit in, SI float out; inertia of bodies; sections that few files have."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    ModelWrapValidatorHandler,
    PlainSerializer,
    Tag,
    ValidationInfo,
    WithJsonSchema,
    model_validator,
)
from pydantic_core import core_schema

from drivesizer.units import KINDS, Kind, label, noun, number, to_si

# -- Types of a spec's fields: text with a unit in, SI float out, inside its range.
#
# Every quantity is read by the strict reader of ``units``. A motion is given in the terms of its load: along a line
# or about an axis. Which of the two comes with the validation (``context``), so that an error has the line of the
# wrong unit.


Axis = Literal["linear", "rotary"]
_OR_GRADE = ", or a grade such as 5 %"
_WRITTEN = 1e-5  # relative: how far five digits are off


class Money(float):
    """An amount of money, which stays in its currency."""

    currency: str = ""


def money(text: object) -> Money:
    """An amount with its currency.

    >>> money("300 EUR"), money("300 EUR").currency
    (300.0, 'EUR')
    """
    amount = Money(to_si(text, "price"))
    unit = number(str(text))[1]
    amount.currency = next(code for code, others in KINDS["price"].units.items() if unit in (code, *others.split()))
    return amount


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
        elif self.kind == "price":
            value = money(text)
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
        return text_of([self.kind, self.rotary] if self.rotary else [self.kind], _OR_GRADE * self.grade)


def text_of(kinds: Sequence[str], more: str = "") -> dict[str, Any]:
    """JSON Schema of a text that is a figure of one of some kinds."""
    words = f"{' or '.join(noun(kind) for kind in kinds)} with unit{more}"
    return {"type": "string", "description": words, "examples": [KINDS[kind].example for kind in kinds]}


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
ForceAbove = Annotated[float, Quantity("force", above=0.0)]
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
Price = Annotated[float, Quantity("price", above=0.0)]  # a ``Money``
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


def required(description: str | None = None, example: str | None = None, **more: Any) -> Any:
    """A field that a file must give, with its help text, and an example where that of its kind is out of place."""
    return Field(description=description, examples=[example] if example else None, **more)


def optional(description: str | None = None, example: str | None = None, **more: Any) -> Any:
    """A field that a file may leave out: unknown then, or as its help text says."""
    return Field(default=None, description=description, examples=[example] if example else None, **more)


def default(value: Any, description: str | None = None, example: str | None = None, **more: Any) -> Any:
    """A field with a default as a user would write it; it goes through the same reader."""
    return Field(default=value, description=description, examples=[example] if example else None, **more)


def all_defaults(description: str | None = None, **more: Any) -> Any:
    """A group of fields, or of entries by name, of which a file may give none: fields are then at their defaults."""
    return Field(default_factory=dict, description=description, **more)


def no_entries(description: str | None = None, **more: Any) -> Any:
    """A list that a file may leave out: it has no entries then."""
    return Field(default_factory=list, description=description, **more)


def or_else(another: dict[str, Any]) -> Callable[[dict[str, Any]], None]:
    """Let the schema of a section that may be left out take something else in its place."""
    return lambda schema: schema["anyOf"].insert(0, another)


class Section(BaseModel):
    """A group of fields: no unknown keys, nothing converted, nothing changed later."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, validate_default=True, defer_build=True)

    def _contradictions(self) -> Iterator[str]:
        """Faults of its fields together, of which the first is reported."""
        yield from ()

    @model_validator(mode="wrap")
    @classmethod
    def _agreeing(cls, value: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        if isinstance(value, cls):  # read before
            return value
        section = handler(value)
        for fault in section._contradictions():
            raise ValueError(fault)
        return section


def exactly_one(section: BaseModel, *names: str) -> Iterator[str]:
    """Fault of a section that gives none or several of some fields."""
    present = [name for name in names if getattr(section, name) is not None]
    if len(present) != 1:
        fault = "neither is given" if not present and len(names) == 2 else "none is given" if not present else (
            "both are given" if len(names) == 2 else f"{'both ' * (len(present) == 2)}{' and '.join(present)} are given"
        )  # fmt: skip
        yield f"give {' or '.join(names)}, exactly one of them; {fault}"


def apart(named: Iterable[Any], what: str) -> Iterator[str]:
    """Fault of sections of which two have the same name."""
    names = [section.name for section in named]
    if len(set(names)) != len(names):
        yield f"expected {what} with names of their own"


# -- Moment of inertia in a spec: a figure, or a body with its dimensions, or several that turn together.
#
# A cylinder of diameter D, bore d, length l and density ρ about its own axis, a block of a times b across the axis,
# and a mass at a distance r:
#
# .. math:: m = \frac{π}{4} ρ l (D^2 - d^2), \quad J = \frac{m (D^2 + d^2)}{8}, \qquad
#           J = \frac{m (a^2 + b^2)}{12}, \qquad J = m r^2
#
# For a solid cylinder that is π ρ l D⁴ / 32. A centre at a distance e from the axis adds m e² (Steiner). Densities
# are nominal ones of standards: steel of EN 1993-1-1, aluminium of EN 1999-1-1, stainless steel 1.4301 of EN
# 10088-1, the others means of the ranges that their standards give.
#
# Worked example: a ball screw of steel, 7800 kg/m³, of 40 mm by 1000 mm has 19.6 kg·cm² (Mitsubishi Electric,
# MELDAS MDS-B-SVJ2 series, selection, example of servo selection).


DENSITIES = {  # kg/m^3
    "steel": 7850.0, "stainless_steel": 7900.0, "cast_iron": 7200.0, "aluminium": 2700.0, "brass": 8400.0,
    "bronze": 8800.0, "titanium": 4430.0, "pom": 1410.0, "polyamide": 1140.0,
}  # fmt: skip
Material = Literal[
    "steel", "stainless_steel", "cast_iron", "aluminium", "brass", "bronze", "titanium", "pom", "polyamide"
]

_NEEDS = {"cylinder": ("diameter",), "block": ("length", "width"), "point": ("offset",)}
_ALONG = {"cylinder": "length", "block": "thickness", "point": "mass"}  # what makes a density a mass
_OTHERS = {
    "cylinder": ("width", "thickness"), "block": ("diameter",),
    "point": ("diameter", "length", "width", "thickness", "material", "density"),
}  # fmt: skip


class Solid(Section):
    """A body in place of a figure of inertia: by its dimensions and material, or its dimensions and mass."""

    shape: Literal["cylinder", "block", "point"] = default(
        "cylinder", "cylinder about its own axis, block, or a mass at a distance: `offset`"
    )
    diameter: Length | None = optional("of a cylinder; of a screw or gear its pitch diameter")
    inner_diameter: Thickness = default("0 mm", "of a hollow cylinder")
    length: Length | None = optional("of a cylinder along the axis; of a block across it")
    width: Length | None = optional("of a block, across the axis")
    thickness: Length | None = optional("of a block, along the axis", "20 mm")
    material: Material | None = optional("or give density or mass")
    density: Density | None = None
    mass: Mass | None = optional("of one body")
    offset: Thickness = default("0 mm", "of its centre from the axis that it turns about")
    count: Annotated[int, Field(ge=1, le=1000)] = default(1, "bodies alike")

    def _contradictions(self) -> Iterator[str]:
        for name in _OTHERS[self.shape]:
            if getattr(self, name) is not None:
                yield f"expected shape: {self.shape} without {name}"
        yield from exactly_one(self, "material", "density", "mass")
        needs = _NEEDS[self.shape] + (() if self.mass is not None else (_ALONG[self.shape],))
        missing = [name for name in needs if not getattr(self, name)]
        if missing:
            yield f"give {missing[0]} of the {self.shape}, e.g. {missing[0]}: 40 mm"
        if self.diameter is None and self.inner_diameter:
            yield f"expected shape: {self.shape} without inner_diameter"
        if self.diameter is not None and not self.inner_diameter < self.diameter:
            yield "inner_diameter must be below diameter"

    @property
    def moment(self) -> float:
        """Moment of inertia of all ``count`` bodies about the axis [kg*m^2]."""
        mass, across = self._mass(), 0.0
        if self.diameter is not None:
            across = (self.diameter**2 + self.inner_diameter**2) / 8
        elif self.length is not None and self.width is not None:
            across = (self.length**2 + self.width**2) / 12
        return self.count * mass * (across + self.offset**2)

    def _mass(self) -> float:
        """Of one body [kg]: given, or volume times density."""
        if self.mass is not None:
            return self.mass
        density = self.density if self.material is None else DENSITIES[self.material]
        length, width, thickness = (0.0 if x is None else x for x in (self.length, self.width, self.thickness))
        if self.diameter is not None:
            area, along = math.pi / 4 * (self.diameter**2 - self.inner_diameter**2), length
        else:
            area, along = length * width, thickness
        return (0.0 if density is None else density) * area * along


class OfSolids(float):
    """An inertia [kg*m^2] that follows from bodies, which it keeps for samples of their dimensions."""

    solids: Solid | list[Any]

    def __new__(cls, solids: Solid | list[Any]) -> Self:
        """The inertia of one body, or of several and figures together."""
        inertia = super().__new__(cls, moment(solids))
        inertia.solids = solids
        return inertia

    def __getnewargs__(self) -> tuple[Any]:
        return (self.solids,)


def moment(inertia: Any) -> Any:
    """Inertia of a figure, a body, or several together [kg*m^2].

    >>> moment([Solid(diameter="40 mm", length="1 m", density="7800 kg/m^3"), 1e-4])
    0.0020603
    """
    if isinstance(inertia, list):
        return sum(moment(part) for part in inertia)
    return inertia.moment if isinstance(inertia, Solid) else inertia


def _form(inertia: Any) -> str:
    """The form in which an inertia is given."""
    return "a body" if isinstance(inertia, dict | Solid) else "bodies" if isinstance(inertia, list) else "a figure"


def _inertia(**limits: float) -> Any:
    """Type of an inertia as a text, as a body, or as a list of either."""
    figure = Annotated[float, Quantity("inertia", **limits), Tag("a figure")]
    either = Annotated[
        figure | Annotated[Solid, Tag("a body")],
        Discriminator(lambda inertia: "a body" if _form(inertia) == "a body" else "a figure"),
    ]
    several = Annotated[list[either], Field(min_length=1, max_length=100), AfterValidator(OfSolids), Tag("bodies")]
    return Annotated[
        figure | Annotated[Solid, AfterValidator(OfSolids), Tag("a body")] | several,
        Discriminator(_form),
        PlainSerializer(float),
    ]


if TYPE_CHECKING:
    Inertia = float
    InertiaAbove = float
else:
    Inertia, InertiaAbove = _inertia(least=0.0), _inertia(above=0.0)
