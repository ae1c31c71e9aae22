r"""Moment of inertia in a spec: a figure, or a body with its dimensions, or several that turn together.

A cylinder of diameter D, bore d, length l and density ρ about its own axis, a block of a times b across the axis, and
a mass at a distance r:

.. math:: m = \frac{π}{4} ρ l (D^2 - d^2), \quad J = \frac{m (D^2 + d^2)}{8}, \qquad
          J = \frac{m (a^2 + b^2)}{12}, \qquad J = m r^2

For a solid cylinder that is π ρ l D⁴ / 32. A centre at a distance e from the axis adds m e² (Steiner). Densities are
nominal ones of standards: steel of EN 1993-1-1, aluminium of EN 1999-1-1, stainless steel 1.4301 of EN 10088-1, the
others means of the ranges that their standards give.

Worked example: a ball screw of steel, 7800 kg/m³, of 40 mm by 1000 mm has 19.6 kg·cm² (Mitsubishi Electric,
MELDAS MDS-B-SVJ2 series, selection, example of servo selection).
"""

import math
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, model_validator
from pydantic_core import core_schema

from drivesizer.files.fields import Density, Length, Mass, Quantity, Section, Thickness, default, exactly_one

__all__ = ["DENSITIES", "Inertia", "InertiaAbove", "OfSolids", "Solid", "moment"]

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

    shape: Literal["cylinder", "block", "point"] = Field(
        default="cylinder", description="cylinder about its own axis, block, or a mass at a distance: `offset`"
    )
    diameter: Length | None = Field(default=None, description="of a cylinder; of a screw or gear its pitch diameter")
    inner_diameter: Thickness = default("0 mm", description="of a hollow cylinder")
    length: Length | None = Field(default=None, description="of a cylinder along the axis; of a block across it")
    width: Length | None = Field(default=None, description="of a block, across the axis")
    thickness: Length | None = Field(default=None, description="of a block, along the axis")
    material: Material | None = Field(default=None, description="or give density or mass")
    density: Density | None = None
    mass: Mass | None = Field(default=None, description="of one body")
    offset: Thickness = default("0 mm", description="of its centre from the axis that it turns about")
    count: Annotated[int, Field(ge=1, le=1000)] = Field(default=1, description="bodies alike")

    @model_validator(mode="after")
    def _whole(self) -> Self:
        for name in _OTHERS[self.shape]:
            if getattr(self, name) is not None:
                raise ValueError(f"expected shape: {self.shape} without {name}")
        exactly_one(self, "material", "density", "mass")
        needs = _NEEDS[self.shape] + (() if self.mass is not None else (_ALONG[self.shape],))
        missing = [name for name in needs if not getattr(self, name)]
        if missing:
            raise ValueError(f"give {missing[0]} of the {self.shape}, e.g. {missing[0]}: 40 mm")
        if self.diameter is None and self.inner_diameter:
            raise ValueError(f"expected shape: {self.shape} without inner_diameter")
        if self.diameter is not None and not self.inner_diameter < self.diameter:
            raise ValueError("inner_diameter must be below diameter")
        return self

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
        made = super().__new__(cls, moment(solids))
        made.solids = solids
        return made

    def __getnewargs__(self) -> tuple[Any]:
        return (self.solids,)


def moment(given: Any) -> Any:
    """Inertia of a figure, a body, or several together [kg*m^2].

    >>> moment([Solid(diameter="40 mm", length="1 m", density="7800 kg/m^3"), 1e-4])
    0.0020603
    """
    if isinstance(given, list):
        return sum(moment(one) for one in given)
    return given.moment if isinstance(given, Solid) else given


class InertiaQuantity(Quantity):
    """An inertia as a text, as a body, or as a list of either."""

    models: ClassVar[tuple[type[Section], ...]] = (Solid,)  # for messages

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        text = core_schema.with_info_plain_validator_function(
            self.read, metadata={"pydantic_js_functions": [lambda _schema, _handler: self._as_text()]}
        )
        body = handler.generate_schema(Solid)
        either = core_schema.tagged_union_schema({"a figure": text, "a body": body}, _tag_within)
        several = core_schema.list_schema(either, min_length=1, max_length=100)
        return core_schema.tagged_union_schema(
            {
                "a figure": text,
                "a body": core_schema.no_info_after_validator_function(OfSolids, body),
                "bodies": core_schema.no_info_after_validator_function(OfSolids, several),
            },
            _tag,
            serialization=core_schema.plain_serializer_function_ser_schema(float),
        )

    def _as_text(self) -> dict[str, Any]:
        return Quantity.__get_pydantic_json_schema__(self, None, None)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return handler(schema)


def _tag(given: Any) -> str:
    """The form in which an inertia is given."""
    return "a body" if isinstance(given, dict | Solid) else "bodies" if isinstance(given, list) else "a figure"


def _tag_within(given: Any) -> str:
    """The same of an entry of a list, which is no list itself."""
    return "a figure" if isinstance(given, list) else _tag(given)


Inertia = Annotated[float, InertiaQuantity("inertia", least=0.0)]
InertiaAbove = Annotated[float, InertiaQuantity("inertia", above=0.0)]
