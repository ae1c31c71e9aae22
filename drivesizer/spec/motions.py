"""Motions of a spec: one cycle, repeated, linear or rotary as the load is."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from drivesizer.files.fields import (
    Acceleration,
    Bearing,
    Distance,
    Duration,
    Jerk,
    Pause,
    Place,
    Section,
    SignedVelocity,
    Velocity,
    default,
)

__all__ = [
    "Csv", "Harmonic", "Hold", "Motion", "SCurve", "Segment", "Segments", "Track", "Trapezoid", "Triangle", "Waypoint",
    "Waypoints",
]  # fmt: skip


class _Repeated(Section):
    rest_time: Pause = default("0 s", description="standing still at the end of the cycle")
    there_and_back: bool = Field(default=False, description="the same motion back, each with its rest")


class Trapezoid(_Repeated):
    """Accelerate, cruise, decelerate, rest; repeated."""

    profile: Literal["trapezoid"] = "trapezoid"
    speed: Velocity = Field(description="cruising speed")
    acceleration_time: Duration = Field(description="also the time of deceleration, where that is not given")
    deceleration_time: Duration | None = None
    cruise_time: Pause


class Triangle(_Repeated):
    """Accelerate over half the distance, decelerate over the other half, rest."""

    profile: Literal["triangle"]
    distance: Distance
    time: Duration = Field(description="of the whole move")


class SCurve(_Repeated):
    """From rest to rest over a distance, as fast as limits of speed, acceleration and jerk allow."""

    profile: Literal["s_curve"]
    distance: Distance
    speed: Velocity = Field(description="limit")
    acceleration: Acceleration = Field(description="limit, for deceleration too")
    jerk: Jerk = Field(description="limit")


class Harmonic(Section):
    """To and fro in a sine: position = -amplitude cos(2 pi t / period)."""

    profile: Literal["harmonic"]
    amplitude: Distance = Field(description="half the travel from end to end")
    period: Duration


class Hold(Section):
    """Standing still under load; repeated, so that it lasts."""

    profile: Literal["hold"]
    time: Duration = Field(description="for which energy and, in closed loop, control are computed")


class Segment(Section):
    """A straight piece: to another speed, or at the same."""

    time: Duration
    to: SignedVelocity | None = Field(default=None, description="speed at its end; the present one where not given")


class Segments(Section):
    """Straight pieces one after the other, from standstill to standstill; those at speed 0 are dwells."""

    profile: Literal["segments"]
    segments: Annotated[list[Segment], Field(min_length=1, max_length=10_000)]

    @model_validator(mode="after")
    def _ends_at_rest(self) -> Segments:
        speeds = [s.to for s in self.segments if s.to is not None]
        if speeds and speeds[-1] != 0.0:
            raise ValueError("expected the last speed to be 0: a cycle starts and ends at standstill")
        return self


class Csv(Section):
    """A recorded speed: a CSV file with the columns time and speed."""

    profile: Literal["csv"]
    file: str = Field(min_length=1, description="CSV: columns time and speed, then a row of units")


class Track(Section):
    """A trajectory of the platform from a file: each driven wheel's load cycle follows from it."""

    profile: Literal["trajectory"] = "trajectory"
    trajectory: str = Field(
        min_length=1, description="CSV: columns t, x, y, heading; or waypoints without t; then a row of units"
    )
    smoothing: Pause = default("0 s", description="distance of the knots of the spline through a noisy track")


class Waypoint(Section):
    """A posture at which the platform stops, with or without a pause."""

    x: Place
    y: Place
    heading: Bearing | None = Field(default=None, description="along the path where not given")
    pause: Pause = default("0 s")


class Waypoints(Section):
    """A path of the platform from point to point, as fast as the platform's limits allow."""

    profile: Literal["waypoints"] = "waypoints"
    waypoints: Annotated[list[Waypoint], Field(min_length=2, max_length=10_000)]


def _named(motion: Any) -> Any:
    """Add the profile of a motion that names none: by its field trajectory or waypoints, else a trapezoid."""
    if not isinstance(motion, dict):
        return motion
    own = next((key for key in ("trajectory", "waypoints") if key in motion), "trapezoid")
    return {"profile": own, **motion}


Motion = Annotated[
    Annotated[
        Trapezoid | Triangle | SCurve | Harmonic | Hold | Segments | Csv | Track | Waypoints,
        Field(discriminator="profile"),
    ],
    BeforeValidator(_named),
]
