"""Motions of a spec: one cycle, repeated, linear or rotary as the load is."""

from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from drivesizer.files import fields
from drivesizer.physics.figures import Alike

_ROUNDING = 1e-9  # of a time: ramps that fill it may be rounded


class _Repeated(fields.Section):
    rest_time: fields.Pause = fields.default("0 s", "standing still at the end of the cycle")
    there_and_back: bool = fields.default(False, "the same motion back, each with its rest")
    payload: fields.Counterweight = fields.default("0 kg", "added to the load's mass, on the way out and in its rest")
    payload_back: fields.Counterweight | None = fields.optional("on the way back; payload where not given")

    @model_validator(mode="after")
    def _back(self) -> Self:
        if self.payload_back is not None and not self.there_and_back:
            raise ValueError("give there_and_back: true beside payload_back")
        return self

    @property
    def carries(self) -> bool:
        """Whether a payload is added to the load's mass."""
        return bool(np.any(self.payload)) or (self.payload_back is not None and bool(np.any(self.payload_back)))


class Trapezoid(_Repeated):
    """Accelerate, cruise, decelerate, rest; repeated: by the times of its parts, or by distance and acceleration."""

    profile: Literal["trapezoid"] = "trapezoid"
    speed: fields.Velocity = fields.required("cruising speed; with distance at most, as far as that lets it be reached")
    acceleration_time: fields.Duration | None = fields.optional(
        "also the time of deceleration, where that is not given"
    )
    deceleration_time: fields.Duration | None = None
    cruise_time: fields.Pause | None = None
    distance: fields.Distance | None = fields.optional("of the whole move, with acceleration in place of the times")
    acceleration: fields.Acceleration | None = fields.optional("and deceleration, with distance")

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        times = (self.acceleration_time, self.cruise_time)
        if self.distance is None and self.acceleration is None:
            if None in times:
                lacking = "acceleration_time" if times[0] is None else "cruise_time"
                raise ValueError(f"give {lacking}, or distance and acceleration in place of the times")
        elif any(time is not None for time in (*times, self.deceleration_time)):
            raise ValueError("give distance and acceleration, or acceleration_time and cruise_time, not both")
        elif self.distance is None or self.acceleration is None:
            raise ValueError(f"give {'distance' if self.distance is None else 'acceleration'} as well, or the times")
        return self

    @property
    def phases(self) -> tuple[Alike, Alike, Alike, Alike]:
        """Times of acceleration, cruise and deceleration [s], and the speed that is reached [m/s or rad/s]."""
        if self.distance is not None and self.acceleration is not None:
            top = np.minimum(self.speed, np.sqrt(self.distance * self.acceleration))
            ramp = top / self.acceleration
            level: Any = np.where(top < self.speed, 0.0, self.distance / top - ramp)[()]
            return ramp, level, ramp, top
        up, cruise = self.acceleration_time, self.cruise_time
        assert up is not None and cruise is not None  # refused above
        return up, cruise, up if self.deceleration_time is None else self.deceleration_time, self.speed


class Triangle(_Repeated):
    """Accelerate over half the distance, decelerate over the other half, rest."""

    profile: Literal["triangle"]
    distance: fields.Distance
    time: fields.Duration = fields.required("of the whole move")


class SCurve(_Repeated):
    """From rest to rest over a distance, as fast as limits of speed, acceleration and jerk allow."""

    profile: Literal["s_curve"]
    distance: fields.Distance
    speed: fields.Velocity = fields.required("limit")
    acceleration: fields.Acceleration = fields.required("limit, for deceleration too")
    jerk: fields.Jerk = fields.required("limit")


class Move(_Repeated):
    """From rest to rest over a distance in a time, by a law of motion.

    Largest speed and acceleration are C_v distance / time and C_a distance / time²: triangle 2 and 4, the least
    acceleration; trapezoid, a third of the time each, 1.5 and 4.5; parabola 1.5 and 6, the least RMS torque of inertia;
    sine 1.57 and 4.93; poly5 1.875 and 5.77; cycloidal 2 and 6.28; modified_sine 1.76 and 5.53; modified_trapezoid 2
    and 4.89. The last four are without a jump of acceleration.
    """

    profile: Literal["move"]
    distance: fields.Distance
    time: fields.Duration = fields.required("of the whole move")
    law: Literal[
        "trapezoid", "triangle", "parabola", "sine", "poly5", "cycloidal", "modified_sine", "modified_trapezoid"
    ] = fields.default("trapezoid", "shape of the speed over time")
    acceleration_time: fields.Duration | None = fields.optional(
        "of law: trapezoid; a third of the time where not given"
    )
    deceleration_time: fields.Duration | None = fields.optional("acceleration_time where not given")

    @model_validator(mode="after")
    def _shaped(self) -> Self:
        if self.law != "trapezoid" and (self.acceleration_time or self.deceleration_time):
            raise ValueError("expected acceleration_time and deceleration_time with law: trapezoid only")
        if sum(self.ramps) > self.time * (1.0 + _ROUNDING):
            raise ValueError("expected acceleration_time and deceleration_time of no more than time together")
        return self

    @property
    def ramps(self) -> tuple[float, float]:
        """Times of acceleration and deceleration of straight lines [s]."""
        share = 2.0 if self.law == "triangle" else 3.0
        up = self.time / share if self.acceleration_time is None else self.acceleration_time
        return up, up if self.deceleration_time is None else self.deceleration_time


class Cam(fields.Section):
    """A cam table: position over the angle of a master that turns evenly, one run of the table after the other."""

    profile: Literal["cam"]
    file: str = fields.required("CSV: columns angle and position, then a row of units", min_length=1)
    master_speed: fields.Turning = fields.required("at which the angle runs", example="60 rpm")
    smoothing: fields.Pause = fields.default(
        "0 s", "width of the window in which the position is smoothed", example="20 ms"
    )


class Harmonic(fields.Section):
    """To and fro in a sine: position = -amplitude cos(2 pi t / period)."""

    profile: Literal["harmonic"]
    amplitude: fields.Distance = fields.required("half the travel from end to end")
    period: fields.Duration


class Hold(fields.Section):
    """Standing still under load; repeated, so that it lasts."""

    profile: Literal["hold"]
    time: fields.Duration = fields.required(
        "for which energy and, in closed loop, control are computed", example="10 s"
    )


class Segment(fields.Section):
    """A straight piece: to another speed, or at the same."""

    time: fields.Duration
    to: fields.SignedVelocity | None = fields.optional("speed at its end; the present one where not given")
    payload: fields.Counterweight | None = fields.optional(
        "added to the load's mass; that of the piece before where not given"
    )


class Segments(fields.Section):
    """Straight pieces one after the other, from standstill to standstill; those at speed 0 are dwells."""

    profile: Literal["segments"]
    segments: Annotated[list[Segment], Field(min_length=1, max_length=10_000)]

    @model_validator(mode="after")
    def _ends_at_rest(self) -> Self:
        speeds = [s.to for s in self.segments if s.to is not None]
        if speeds and speeds[-1] != 0.0:
            raise ValueError("expected the last speed to be 0: a cycle starts and ends at standstill")
        return self

    @property
    def carries(self) -> bool:
        """Whether a payload is added to the load's mass."""
        return any(piece.payload is not None and np.any(piece.payload) for piece in self.segments)


class Csv(fields.Section):
    """A recorded speed: a CSV file with the columns time and speed."""

    profile: Literal["csv"]
    file: str = fields.required("CSV: columns time and speed, then a row of units", min_length=1)


class Track(fields.Section):
    """A trajectory of the platform from a file: each driven wheel's load cycle follows from it."""

    profile: Literal["trajectory"] = "trajectory"
    trajectory: str = fields.required(
        "CSV: columns t, x, y, heading; or waypoints without t; then a row of units", min_length=1
    )
    smoothing: fields.Pause = fields.default(
        "0 s", "distance of the knots of the spline through a noisy track", example="50 ms"
    )


class Waypoint(fields.Section):
    """A posture at which the platform stops, with or without a pause."""

    x: fields.Place = fields.required(example="2.5 m")
    y: fields.Place = fields.required(example="1 m")
    heading: fields.Bearing | None = fields.optional("along the path where not given", example="90 deg")
    pause: fields.Pause = fields.default("0 s")


class Waypoints(fields.Section):
    """A path of the platform from point to point, as fast as the platform's limits allow."""

    profile: Literal["waypoints"] = "waypoints"
    waypoints: Annotated[list[Waypoint], Field(min_length=2, max_length=10_000)]


def _named(motion: Any) -> Any:
    """Add the profile of a motion that names none: by its fields, else a trapezoid."""
    if not isinstance(motion, dict):
        return motion
    own = next((key for key in ("trajectory", "waypoints") if key in motion), "trapezoid")
    if {"distance", "time"} <= motion.keys():
        own = "move"
    return {"profile": own, **motion}


Motion = Annotated[
    Annotated[
        Trapezoid | Triangle | Move | SCurve | Harmonic | Hold | Segments | Csv | Cam | Track | Waypoints,
        Field(discriminator="profile"),
    ],
    BeforeValidator(_named),
]
