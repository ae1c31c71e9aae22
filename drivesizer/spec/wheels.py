"""Section of a spec on the wheels of a platform: one by one, or by a layout.

A wheel is placed by x and y, or by the columns of the paper's Table 1. All places are in the robot's frame: x forward,
y to the left, the reference point at the origin.
"""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from drivesizer.files.fields import Bearing, Length, Part, Place, Quantity, Section, default
from drivesizer.platform.wheels import Wheel, table_wheel

__all__ = ["CasterPlace", "Differential", "Layout", "Mecanum", "Omni", "WheelPlace"]

RollerAngle = Annotated[float, Quantity("angle", least=-math.radians(85.0), most=math.radians(85.0))]
Kind = Literal["mecanum", "omni", "fixed"]


class WheelPlace(Section):
    """One wheel: its place, its direction of rolling, and whether it is driven."""

    kind: Kind = Field(description="fixed: no rollers, held sideways; also one that is steered to an angle")
    x: Place | None = Field(default=None, description="of the contact point; or give distance and alpha")
    y: Place | None = None
    heading: Bearing | None = Field(default=None, description="where it rolls; forward where not given")
    distance: Length | None = Field(default=None, description="L of Table 1")
    alpha: Bearing | None = Field(default=None, description="α of Table 1")
    beta: Bearing | None = Field(default=None, description="β of Table 1; forward where not given")
    roller_angle: RollerAngle | None = Field(default=None, description="γ, of a mecanum wheel")
    driven: bool = True

    @model_validator(mode="after")
    def _placed(self) -> Self:
        by_table, by_place = (self.distance, self.alpha, self.beta), (self.x, self.y, self.heading)
        given = (by_place, by_table) if self.distance is None else (by_table, by_place)
        if given[0][0] is None or given[0][1] is None or any(v is not None for v in given[1]):
            raise ValueError("give x and y with heading, or distance and alpha with beta, one of both")
        if (self.roller_angle is not None) != (self.kind == "mecanum"):
            raise ValueError("give roller_angle for a mecanum wheel, such as 45 deg or -45 deg, and for no other")
        return self

    def record(self, radius: float, **more: float) -> Wheel:
        """The wheel of a radius [m], with further figures of all wheels."""
        gamma = self.roller_angle or 0.0
        kind = {"held": self.kind == "fixed", "drive": "motor" if self.driven else "free"}
        if self.distance is not None and self.alpha is not None:
            beta = math.pi / 2 - self.alpha if self.beta is None else self.beta
            return table_wheel(self.distance, self.alpha, beta, gamma, radius, **kind, **more)
        assert self.x is not None and self.y is not None
        heading = self.heading or 0.0
        return Wheel(x=self.x, y=self.y, radius=radius, heading=heading, roller_angle=gamma, **kind, **more)  # type: ignore[arg-type]


class Mecanum(Section):
    """Four mecanum wheels in a rectangle: front right, front left, rear left, rear right."""

    kind: Literal["mecanum"]
    wheelbase: Length = Field(description="between the axles")
    track: Length = Field(description="between the contact points of an axle")
    roller_angle: RollerAngle = default("45 deg", description="γ of the front right and the rear left wheel")

    @property
    def places(self) -> list[WheelPlace]:
        """The wheels one by one."""
        x, y, gamma = self.wheelbase / 2, self.track / 2, self.roller_angle
        corners = ((x, -y, gamma), (x, y, -gamma), (-x, y, gamma), (-x, -y, -gamma))
        return [_place("mecanum", *corner) for corner in corners]

    @model_validator(mode="after")
    def _crossed(self) -> Self:
        if self.roller_angle <= 0.0:
            raise ValueError("expected roller_angle above 0: other rollers hold the platform badly in turning")
        return self


class Differential(Section):
    """Two fixed wheels on one axle, right and left; casters carry the rest."""

    kind: Literal["differential"]
    track: Length = Field(description="between the contact points")
    x: Place = default("0 mm", description="of the axle")

    @property
    def places(self) -> list[WheelPlace]:
        """The wheels one by one."""
        return [_place("fixed", self.x, y) for y in (-self.track / 2, self.track / 2)]


class Omni(Section):
    """Omni wheels on a circle, each rolling along it; the first in front."""

    kind: Literal["omni"]
    radius: Length = Field(description="of the circle, from the reference point to a contact point")
    number: Annotated[int, Field(ge=3, le=12)] = 3

    @property
    def places(self) -> list[WheelPlace]:
        """The wheels one by one."""
        angles = (2 * math.pi * i / self.number for i in range(self.number))
        return [
            _place("omni", self.radius * math.cos(a), self.radius * math.sin(a), heading=a + math.pi / 2)
            for a in angles
        ]


def _place(kind: Kind, x: float, y: float, gamma: float | None = None, heading: float = 0.0) -> WheelPlace:
    return WheelPlace.model_construct(kind=kind, x=x, y=y, roller_angle=gamma, heading=heading)


Layout = Annotated[Mecanum | Differential | Omni, Field(discriminator="kind")]


class CasterPlace(Section):
    """A caster."""

    x: Place
    y: Place
    rolling_resistance: Part | None = Field(default=None, description="C_rr; that of the wheels if not given")
