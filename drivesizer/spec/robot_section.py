"""Section ``robot`` of a machine: joints of a description, their trajectory, payloads, and where their drives are.

A figure of a joint is an angle where it turns and a length where it slides; which of the two is known with the
description, so that the reader takes either and keeps its kind.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Field, field_validator
from pydantic_core import core_schema

from drivesizer.errors import InputError
from drivesizer.files import fields
from drivesizer.loads.model import Count
from drivesizer.loads.springs import Springs
from drivesizer.units import KINDS, label, to_si


class JointFigure(NamedTuple):
    """A figure of a joint in SI, and its kind of quantity."""

    value: float
    kind: str


@dataclass(frozen=True, slots=True)
class Either:
    """Type of a field that takes a figure of a joint that turns, or of one that slides."""

    rotary: str
    linear: str
    above: float = -math.inf

    def read(self, text: object, info: Any) -> JointFigure:
        """The SI value of a text with its kind; one outside the range is a ValueError."""
        try:
            figure = JointFigure(to_si(text, self.rotary), self.rotary)
        except InputError as refused:
            try:
                figure = JointFigure(to_si(text, self.linear), self.linear)
            except InputError:
                raise InputError(f"{refused}, or {KINDS[self.linear].example} of a joint that slides") from None
        if not figure.value > self.above:
            kind = KINDS[figure.kind]
            raise ValueError(f"must be above {self.above:g} {label(kind.si)}, e.g. {kind.example}")
        return figure

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.with_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return fields.text_of((self.rotary, self.linear))


Position = Annotated[JointFigure, Either("angle", "length")]
Fastest = Annotated[JointFigure, Either("rotary_speed", "speed", above=0.0)]
Quickest = Annotated[JointFigure, Either("angular_acceleration", "acceleration", above=0.0)]
Jerkiest = Annotated[JointFigure, Either("angular_jerk", "jerk", above=0.0)]
Name = Annotated[str, Field(min_length=1, max_length=200)]
Point = Annotated[list[fields.Place], Field(min_length=3, max_length=3)]


_ORIGIN = ["0 mm", "0 mm", "0 mm"]


class JointLimits(fields.Section):
    """Limits of one joint for moves between waypoints."""

    speed: Fastest | None = fields.optional("that of the description where not given")
    acceleration: Quickest | None = None
    jerk: Jerkiest | None = fields.optional("unlimited where not given")


class JointWaypoint(fields.Section):
    """Positions of joints at which the robot is at rest."""

    positions: dict[Name, Position] = fields.required("by joint; one that is not named stays where it was")
    pause: fields.Pause = fields.default("0 s", "at this waypoint")


class Hold(fields.Section):
    """A pose that the drives hold, as a load case."""

    name: Name
    positions: dict[Name, Position] = fields.required("by joint; one that is not named is where the trajectory starts")
    time: fields.Duration = fields.default("60 s", "for which it is held")
    payload: fields.Counterweight | None = fields.optional("that of the robot where not given", example="2 kg")


class PointMass(fields.Section):
    """A payload as a mass at a point of a link."""

    mass: fields.Mass
    link: Name | None = fields.optional("that it hangs on; the last one where there is one only")
    at: Point = fields.default(_ORIGIN, "x, y, z in the frame of the link")


class PayloadCase(fields.Section):
    """Another payload at the same point, as a load case of the whole trajectory."""

    name: Name
    mass: fields.Counterweight


class Mounting(fields.Section):
    """Turns of the robot's base against the world, whose z points up: about its fixed axes x, y and z, one by one."""

    roll: fields.Bearing = fields.default("0 deg")
    pitch: fields.Bearing = fields.default("0 deg")
    yaw: fields.Bearing = fields.default("0 deg")


class DrivePlace(fields.Section):
    """Place of the drive of one joint, whose mass the joints before it carry."""

    on: Literal["link_before", "base", "link"] = fields.default(
        "link_before",
        "link_before: at the joint, on the link before it; base: no joint carries it; link: as named, "
        "also one that the joint moves: then the drive is load of its own joint",
    )
    link: Name | None = fields.optional("with on: link")
    at: Point | None = fields.optional("x, y, z in the frame of its link; on the joint's axis else")
    belt_passes: bool = fields.default(
        False, "whether a belt over the axes between makes it turn by the sum of their angles and its joint's"
    )
    travel_per_turn: fields.Length | None = fields.optional(
        "of a joint that slides, per turn of the shaft that the drive turns", example="10 mm"
    )

    motors: Count = fields.default(1, "drives that share the joint equally")

    def _contradictions(self) -> Iterator[str]:
        if (self.link is not None) != (self.on == "link"):
            yield "give link with on: link, and with no other"
        if self.belt_passes and self.on == "link_before":
            yield "belt_passes: at its joint a drive has none between; expected on: base, or on: link"
        if self.at is not None and self.on == "base":
            yield "at: no joint carries a drive on the base; leave it out"


class Coupling(fields.Section):
    """Two drives that move two joints together: a differential wrist, or a CoreXY gantry."""

    kind: Literal["differential", "corexy"]
    joints: Annotated[list[Name], Field(min_length=2, max_length=2)] = fields.required(
        "that which both drives move when they turn alike, and that which they move against one another"
    )
    ratio: fields.Ratio = fields.default(
        1, "angle of either drive, or travel of its belt, per angle or travel of the second joint alone"
    )


class LinkForce(fields.Section):
    """A force that acts on a link, such as of the floor on a foot or of the work on a tool."""

    link: Name
    at: Point = fields.default(_ORIGIN, "x, y, z in the frame of the link")
    force: Annotated[list[fields.Pull], Field(min_length=3, max_length=3)] | None = fields.optional(
        "x, y, z of the world, whose z points up, at any time and in poses that are held", example="[0 N, 0 N, 200 N]"
    )
    file: str | None = fields.optional(
        "CSV over the trajectory: columns time, x, y, z; then a row of units", min_length=1
    )

    def _contradictions(self) -> Iterator[str]:
        yield from fields.exactly_one(self, "force", "file")


class RobotSection(fields.Section):
    """Joints of a robot description, each an axis of the machine."""

    description: str = fields.required("URDF or MJCF file", min_length=1)
    trajectory: str | None = fields.optional("CSV: columns time and joints by name; then a row of units", min_length=1)
    smoothing: fields.Pause = fields.default(
        "0 s", "least time between knots of the curve through the trajectory", example="20 ms"
    )
    waypoints: Annotated[list[JointWaypoint], Field(min_length=2, max_length=10_000)] | None = None
    law: Literal["fastest", "poly5"] = fields.default(
        "fastest", "of moves between waypoints: fastest within limits, or a polynomial of 5th order"
    )
    limits: dict[Name, JointLimits] = fields.all_defaults(
        "of moves between waypoints, by joint; `all` for those that are not named"
    )
    held: dict[Name, Position] = fields.all_defaults("positions of joints that do not move; 0 where not given")
    payload: PointMass | None = fields.optional(
        "or its mass alone", json_schema_extra=fields.or_else({"type": "string", "examples": ["1 kg"]})
    )
    payloads: Annotated[list[PayloadCase], Field(max_length=100)] = fields.no_entries(
        "other payloads at the same point, as load cases"
    )
    holds: Annotated[list[Hold], Field(max_length=100)] = fields.no_entries("poses that are held, as load cases")
    mounting: Mounting = fields.all_defaults("of the base; upright where not given")
    friction: Literal["keep", "leave"] = fields.default(
        "keep", "of the joints in the description: kept as that of bearings, or left out"
    )
    springs: dict[Name, Springs] = fields.all_defaults("beside the drives of joints, by joint; counted from the start")
    gravcomp: Literal["keep", "leave"] = fields.default(
        "keep", "of links in an MJCF file: weight taken off the drives as by counterweights, or left out"
    )
    couplings: Annotated[list[Coupling], Field(max_length=100)] = fields.no_entries(
        "of two drives each, named as their joints: the first by the sum of both joints, the second by the difference"
    )
    forces: Annotated[list[LinkForce], Field(max_length=100)] = fields.no_entries("on links beside their weight")
    masses: Literal["without", "with_drives"] = fields.default(
        "without", "of the links: without the drives, which are added where they ride, or with_drives already"
    )
    drives: dict[Name, DrivePlace] = fields.all_defaults("by joint; at the joint on the link before it where not given")

    @field_validator("payload", mode="before")
    @classmethod
    def _mass_alone(cls, value: Any) -> Any:
        """A mass as text stands for a payload at the origin of the last link."""
        return {"mass": value} if isinstance(value, str) else value

    def _contradictions(self) -> Iterator[str]:
        yield from fields.exactly_one(self, "trajectory", "waypoints")
        if self.payloads and self.payload is None:
            yield "payloads: they hang where payload does; expected payload with its link"
        if self.payload is None and any(hold.payload is not None for hold in self.holds):
            yield "holds: a payload hangs where that of the robot does; expected payload with its link"
        yield from fields.apart([*self.payloads, *self.holds], "payloads and holds")
        if self.trajectory is None and self.smoothing:
            yield "smoothing: it is of a recorded trajectory; leave it out"
