"""Fields that all kinds of load have in common, and loads that gravity turns."""

from __future__ import annotations

from typing import Annotated, ClassVar, NamedTuple

from pydantic import Field

from drivesizer.files.fields import Axis, Section

__all__ = ["Count", "Lever", "LoadModel", "SharedLoad", "check_inertia"]


# -- Loads that gravity turns: a mass on a lever about an axis that does not stand upright.


_LEVEL = 1e-5  # of the weight: what gets through a smaller share of it is none; files round 90 degrees to 1.5708 rad


class Lever(NamedTuple):
    """A mass away from the axis that it turns about."""

    mass: float  # kg
    length: float  # m, from the axis to its centre
    share: float  # of its weight that the axis' tilt leaves across it: 1 for a level axis
    start: float  # rad, of the lever above the level line when the cycle starts

    def moment(self, gravity: float) -> float:
        """Torque of the weight when the lever lies level, M [N*m]; 0 where it turns level but for rounding."""
        return self.mass * gravity * self.length * self.share if abs(self.share) > _LEVEL else 0.0


def check_inertia(inertia: float, mass: float, length: float, name: str) -> None:
    """Refuse an inertia below that of all the mass in its centre, 2 % apart for rounded figures.

    Parameters
    ----------
    inertia
        About the axis [kg*m^2].
    mass
        That turns about it [kg].
    length
        From the axis to its centre [m].
    name
        Of the field that gives the length.

    Raises
    ------
    ValueError
        When no such mass has so small an inertia.
    """
    least = mass * length * length
    if inertia < 0.98 * least:
        raise ValueError(f"inertia must be at least mass times {name} squared, {least:.4g} kg·m²")


# -- Fields that the models of all kinds of load have in common.


Count = Annotated[int, Field(ge=1, le=100)]


class LoadModel(Section):
    """A load as a user writes it; its file also has the torque law."""

    axis: ClassVar[Axis]  # of its motion: along a line or about an axis
    takes_payload: ClassVar[bool] = False  # whether a motion may add one to its mass
    is_wheel: ClassVar[bool] = False  # whether it is of driven wheels of a platform, their cycle computed
    has_end: ClassVar[bool] = False  # whether its travel is limited, so that a cycle has to end where it starts

    @property
    def lever(self) -> Lever | None:
        """The mass that gravity turns about the axis, of the whole load; None where there is none."""
        return None


class SharedLoad(LoadModel):
    """A load that one drive moves, or several that share it equally."""

    kind: str
    motors: Count = Field(default=1, description="drives that share the load equally; all figures are of the whole")

    @property
    def alike(self) -> int:
        """Number of drives that the load cycle applies to: all."""
        return self.motors
