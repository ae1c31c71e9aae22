"""Sections of a spec on its platform: wheels, passages, mass budget, path following, errors of the robot model."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache
from typing import Annotated, Any, Literal

from pydantic import Field

from drivesizer.files import fields
from drivesizer.platform.envelope import Passage, Size
from drivesizer.platform.kinematics import Misjudged, Payload, Wheel, kinematics, table_wheel
from drivesizer.platform.kinematics import Platform as Record

# -- Section of a spec on the wheels of a platform: one by one, or by a layout.
#
# A wheel is placed by x and y, or by the columns of the paper's Table 1. All places are in the robot's frame: x
# forward, y to the left, the reference point at the origin.


RollerAngle = Annotated[float, fields.Quantity("angle", least=-math.radians(85.0), most=math.radians(85.0))]
Kind = Literal["mecanum", "omni", "fixed", "skid"]


class WheelPlace(fields.Section):
    """One wheel: its place, its direction of rolling, and whether it is driven."""

    kind: Kind = fields.required(
        "fixed: no rollers, held sideways; also one that is steered to an angle. skid: fixed, and slides in turning"
    )
    x: fields.Place | None = fields.optional("of the contact point; or give distance and alpha", example="300 mm")
    y: fields.Place | None = fields.optional(example="-250 mm")
    heading: fields.Bearing | None = fields.optional("where it rolls; forward where not given", example="90 deg")
    distance: fields.Length | None = fields.optional("L of Table 1", example="400 mm")
    alpha: fields.Bearing | None = fields.optional("α of Table 1", example="45 deg")
    beta: fields.Bearing | None = fields.optional("β of Table 1; forward where not given", example="45 deg")
    roller_angle: RollerAngle | None = fields.optional("γ, of a mecanum wheel", example="45 deg")
    driven: bool = True

    def _contradictions(self) -> Iterator[str]:
        by_table, by_place = (self.distance, self.alpha, self.beta), (self.x, self.y, self.heading)
        places = (by_place, by_table) if self.distance is None else (by_table, by_place)
        if places[0][0] is None or places[0][1] is None or any(v is not None for v in places[1]):
            yield "give x and y with heading, or distance and alpha with beta, one of both"
        if (self.roller_angle is not None) != (self.kind == "mecanum"):
            yield "give roller_angle for a mecanum wheel, such as 45 deg or -45 deg, and for no other"

    def record(self, radius: float, **more: float) -> Wheel:
        """The wheel of a radius [m], with further figures of all wheels."""
        gamma = self.roller_angle or 0.0
        kind = {
            "held": self.kind == "fixed",
            "slides": self.kind == "skid",
            "drive": "motor" if self.driven else "free",
        }
        if self.distance is not None and self.alpha is not None:
            beta = math.pi / 2 - self.alpha if self.beta is None else self.beta
            return table_wheel(self.distance, self.alpha, beta, gamma, radius, **kind, **more)
        assert self.x is not None and self.y is not None
        heading = self.heading or 0.0
        return Wheel(x=self.x, y=self.y, radius=radius, heading=heading, roller_angle=gamma, **kind, **more)  # type: ignore[arg-type]


_CORNERS = ((1, -1), (1, 1), (-1, 1), (-1, -1))  # front right, front left, rear left, rear right


class Mecanum(fields.Section):
    """Four mecanum wheels in a rectangle: front right, front left, rear left, rear right."""

    kind: Literal["mecanum"]
    wheelbase: fields.Length = fields.required("between the axles", example="600 mm")
    track: fields.Length = fields.required("between the contact points of an axle", example="500 mm")
    roller_angle: RollerAngle = fields.default("45 deg", "γ of the front right and the rear left wheel")

    @property
    def places(self) -> list[WheelPlace]:
        """The wheels one by one."""
        x, y, gamma = self.wheelbase / 2, self.track / 2, self.roller_angle
        return [_place("mecanum", i * x, j * y, -i * j * gamma) for i, j in _CORNERS]

    def _contradictions(self) -> Iterator[str]:
        if self.roller_angle <= 0.0:
            yield "expected roller_angle above 0: other rollers hold the platform badly in turning"


class Differential(fields.Section):
    """Two fixed wheels on one axle, right and left; casters carry the rest."""

    kind: Literal["differential"]
    track: fields.Length = fields.required("between the contact points", example="500 mm")
    x: fields.Place = fields.default("0 mm", "of the axle")

    @property
    def places(self) -> list[WheelPlace]:
        """The wheels one by one."""
        return [_place("fixed", self.x, y) for y in (-self.track / 2, self.track / 2)]


class Skid(fields.Section):
    """Four fixed wheels in a rectangle that slide sideways as the vehicle turns."""

    kind: Literal["skid"]
    wheelbase: fields.Length = fields.required("between the axles", example="400 mm")
    track: fields.Length = fields.required("between the contact points of an axle", example="500 mm")

    @property
    def places(self) -> list[WheelPlace]:
        """The wheels one by one."""
        return [_place("skid", i * self.wheelbase / 2, j * self.track / 2) for i, j in _CORNERS]


class Omni(fields.Section):
    """Omni wheels on a circle, each rolling along it; the first in front."""

    kind: Literal["omni"]
    radius: fields.Length = fields.required(
        "of the circle, from the reference point to a contact point", example="250 mm"
    )
    number: Annotated[int, Field(ge=3, le=12)] = 3

    @property
    def places(self) -> list[WheelPlace]:
        """The wheels one by one."""
        r, angles = self.radius, (2 * math.pi * i / self.number for i in range(self.number))
        return [_place("omni", r * math.cos(a), r * math.sin(a), heading=a + math.pi / 2) for a in angles]


@lru_cache(maxsize=64)
def _place(kind: Kind, x: float, y: float, gamma: float | None = None, heading: float = 0.0) -> WheelPlace:
    return WheelPlace.model_construct(kind=kind, x=x, y=y, roller_angle=gamma, heading=heading)


Layout = Annotated[Mecanum | Differential | Omni | Skid, Field(discriminator="kind")]


class CasterPlace(fields.Section):
    """A caster."""

    x: fields.Place = fields.required(example="-300 mm")
    y: fields.Place = fields.required(example="0 mm")
    rolling_resistance: fields.Part | None = fields.optional("C_rr; that of the wheels if not given")


# -- Section of a spec on errors of the robot model of a platform.


Off = Annotated[float, fields.Quantity("dimensionless", least=-0.9, most=9.0)]
OffPerWheel = Annotated[list[Off], Field(min_length=1, max_length=100)]


class UnknownPayload(fields.Section):
    """Something on the platform that the robot model does not know."""

    mass: fields.Mass
    x: fields.Place = fields.default("0 mm")
    y: fields.Place = fields.default("0 mm")
    height: fields.Thickness = fields.default("0 mm")


class Unknown(fields.Section):
    """Differences of the true platform from its robot model, for path following."""

    radius: Off | OffPerWheel = fields.default(0, "share by which wheels are larger, of all or of each")
    lever: Off = fields.default(0, "share by which the wheels stand farther out")
    toe: fields.Bearing = fields.default("0 deg", "added to the heading of the wheels")
    mass: Off = fields.default(0, "share by which it is heavier")
    inertia: Off = 0.0
    payload: UnknownPayload | None = None
    rolling_resistance: Off = fields.default(0, "added to C_rr")
    roller_resistance: Off = fields.default(0, "added to that of the rollers")
    motor: Off | OffPerWheel = fields.default(0, "share by which motors are stronger; -5 % is weak")

    @property
    def record(self) -> Misjudged:
        """The same as a plain record, as the simulation takes it."""
        figures: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in self}
        return Misjudged(**figures | {"payload": Payload(**dict(self.payload)) if self.payload else None})


# -- Sections of a spec on path following: controllers, floor and measured errors.


Damping = Annotated[float, fields.Quantity("damping", above=0.0)]
Restoring = Annotated[float, fields.Quantity("torsional_stiffness", least=0.0)]
Name = Annotated[str, Field(min_length=1, max_length=60)]


class Measured(fields.Section):
    """Largest errors measured with a real robot on the path, printed beside the simulated ones."""

    name: Name
    position: fields.Length = fields.required(example="20 mm")
    heading: fields.Angle


class Following(fields.Section):
    """Controllers, floor and comparisons for `drivesizer drive --follow`."""

    speed_loop: Literal["PI", "P"] = fields.default("PI", "of each driven wheel")
    speed_gain: Damping | None = fields.optional("at a wheel; designed where not given", example="5 N*m*s")
    speed_integral: Restoring | None = fields.optional(
        "at a wheel, of PI; designed where not given", example="50 N*m/rad"
    )
    period: fields.Duration = fields.default("1 ms", "of the speed loops")
    pose_period: fields.Duration = fields.default("50 ms", "between two poses that are fed back")
    torque_limit: fields.TorqueAbove | None = fields.optional(
        "at a wheel; what the controller's peak current and the gearhead give, where not given", example="5 N*m"
    )
    rotor_inertia: fields.Inertia | None = fields.optional(
        "of motor and gearhead at a wheel; that of the drive where not given"
    )
    slip_speed: fields.Speed = fields.default("10 mm/s", "at which a wheel's slip would meet the grip, at rest")
    creep: fields.Coefficient = fields.default(0, "what rolling adds to it, as a share of the rolling speed")
    compare: bool = fields.default(
        False, "whether both models are driven with either loop, with and without what is misjudged"
    )
    measured: Annotated[list[Measured], Field(max_length=20)] = fields.no_entries()

    def _contradictions(self) -> Iterator[str]:
        if self.speed_loop == "P" and self.speed_integral is not None and not self.compare:
            yield "speed_integral: a speed_loop P has none; leave it out, or take PI"
        if self.pose_period < self.period:
            yield "pose_period: expected no less than period, that of the speed loops"


# -- Sections of a spec on its platform, the passages it must fit through, and its mass budget.
#
# Places are in the robot's frame: x forward, y to the left, the reference point at the origin; those of passages are
# in the world.


AccelerationLimit = Annotated[float, fields.Quantity("acceleration", above=0.0)]
JerkLimit = Annotated[float, fields.Quantity("jerk", above=0.0)]
TurningAcceleration = Annotated[float, fields.Quantity("angular_acceleration", above=0.0)]
TurningJerk = Annotated[float, fields.Quantity("angular_jerk", above=0.0)]
Slip = Annotated[float, fields.Quantity("dimensionless", least=0.0, most=0.9)]
Small = Annotated[float, fields.Quantity("angle", least=0.0, most=math.pi / 2)]


# --- mass and size ----------------------------------------------------------------------------------------------------


class CentreOfMass(fields.Section):
    """Of the robot without its payloads."""

    x: fields.Place = fields.default("0 mm")
    y: fields.Place = fields.default("0 mm")
    height: fields.Thickness | None = fields.optional("above the floor; unknown where not given", example="250 mm")


class PayloadSection(fields.Section):
    """Something that the load's mass includes, where it is carried."""

    name: Name
    mass: fields.Mass
    x: fields.Place = fields.default("0 mm", "of its centre of mass")
    y: fields.Place = fields.default("0 mm")
    height: fields.Thickness | None = fields.optional("above the floor; unknown where not given", example="600 mm")
    inertia: fields.Inertia = fields.default("0 kg*m^2", "about the vertical through its centre of mass")


class SizeSection(fields.Section):
    """The box that the robot takes up."""

    length: fields.Length = fields.required("along its heading", example="800 mm")
    width: fields.Length = fields.required(example="600 mm")
    height: fields.Length = fields.required("above the floor, payload included", example="500 mm")
    x: fields.Place = fields.default("0 mm", "of the box's middle")
    y: fields.Place = fields.default("0 mm")

    @property
    def record(self) -> Size:
        """The same as the platform's geometry takes it."""
        return Size(**dict(self))


class PassageSection(fields.Section):
    """A door or corridor that the robot must fit through."""

    name: Name
    width: fields.Length = fields.required("between the jambs", example="900 mm")
    height: fields.Length | None = fields.optional("open above where not given", example="2 m")
    depth: fields.Thickness = fields.default("0 mm", "in the direction of passage; 0 is a thin wall")
    heading_error: Small = fields.default("0 deg", "with which the robot must still fit")
    aside: fields.Thickness = fields.default("0 mm", "by which it may run beside the middle")
    turns: bool = fields.default(False, "whether it turns on the spot there")
    corner: fields.Length | None = fields.optional(
        "width of a corridor at right angles into which it turns", example="1.2 m"
    )
    x: fields.Place | None = fields.optional("of its middle in the world, for a trajectory", example="5 m")
    y: fields.Place | None = fields.optional(example="0 m")
    direction: fields.Bearing = fields.default("0 deg", "of passage, in the world")

    def _contradictions(self) -> Iterator[str]:
        if (self.x is None) != (self.y is None):
            yield "give both x and y, or none"

    @property
    def record(self) -> Passage:
        """The same as the platform's geometry takes it."""
        place = {"x": self.x or 0.0, "y": self.y or 0.0, "direction": self.direction}
        return Passage(name=self.name, width=self.width, height=self.height, depth=self.depth, **place)


class Limits(fields.Section):
    """Limits of a motion of the robot."""

    speed: fields.Speed | None = None
    acceleration: AccelerationLimit | None = None
    jerk: JerkLimit | None = None
    turning_speed: fields.Turning | None = fields.optional(example="60 deg/s")
    turning_acceleration: TurningAcceleration | None = None
    turning_jerk: TurningJerk | None = None


# --- the sections -----------------------------------------------------------------------------------------------------


class Platform(fields.Section):
    """A robot on wheels: where they stand, where the mass is, and what it must fit through."""

    wheels: Annotated[list[WheelPlace], Field(min_length=1, max_length=100)] | None = None
    layout: Layout | None = fields.optional("of the wheels, instead of one by one")
    casters: Annotated[list[CasterPlace], Field(max_length=100)] = fields.no_entries()
    roller_resistance: fields.Coefficient = fields.default(0, "C_rr of rollers on their pins")
    sliding_friction: fields.Coefficient | None = fields.optional(
        "of skid wheels that slide sideways, at most that of traction; 0.3 to 0.9 by floor and tyre"
    )
    slip: Slip = fields.default(
        0, "share of the wheels' travel that is lost by slip on the floor: of the battery's energy"
    )
    inertia: fields.InertiaAbove | None = fields.optional(
        "about the vertical through the centre of mass, without payloads; of a homogeneous box of the "
        "size where not given"
    )
    centre_of_mass: CentreOfMass = fields.all_defaults()
    payloads: Annotated[list[PayloadSection], Field(max_length=100)] = fields.no_entries(
        "part of the load's mass; inertia and centre_of_mass are without them"
    )
    size: SizeSection | None = None
    passages: Annotated[list[PassageSection], Field(max_length=100)] = fields.no_entries()
    limits: Limits = fields.all_defaults()
    uphill: fields.Bearing = fields.default("0 deg", "direction of the load's slope in the world")
    failed: Annotated[list[Annotated[int, Field(ge=1)]], Field(max_length=100)] = fields.no_entries(
        "wheels whose motor has failed, by number: for a load case"
    )
    blocked: bool = fields.default(False, "whether those are held by brake or gear; they turn freely otherwise")
    misjudged: Unknown = fields.all_defaults("for `drivesizer drive --follow`")
    following: Following = fields.all_defaults("for `drivesizer drive --follow`")

    def _contradictions(self) -> Iterator[str]:
        if (self.wheels is None) == (self.layout is None):
            yield "give wheels or layout, exactly one of them"
        if self.inertia is None and self.size is None:
            yield "give inertia, or size: a homogeneous box of it is taken then"
        if self.passages and self.size is None:
            yield "give size for the passages"
        wrong = [number for number in self.failed if number > len(self.places)]
        if wrong:
            yield f"expected failed wheels of {len(self.places)}, there is no wheel {wrong[0]}"
        skids = any(place.kind == "skid" for place in self.places)
        if skids != (self.sliding_friction is not None):
            needed = "give sliding_friction of the skid wheels, e.g. 0.6" if skids else (
                "sliding_friction: it is of skid wheels; leave it out, or layout: {kind: skid}"
            )  # fmt: skip
            yield needed
        yield from fields.apart(self.passages, "passages")
        yield from fields.apart(self.payloads, "payloads")
        # two wheels in one place, and wheels that do not hold the robot, are known before its mass is
        wheels = tuple(place.record(0.1) for place in self.places)
        casters = tuple(WheelPlace.model_construct(kind="omni", x=c.x, y=c.y).record(0.1) for c in self.casters)
        Record(wheels=(*wheels, *casters), mass=1.0, inertia=1.0)
        kinematics(wheels)

    @property
    def places(self) -> list[WheelPlace]:
        """The wheels one by one."""
        return self.layout.places if self.layout else list(self.wheels or ())

    @property
    def height_known(self) -> bool:
        """Whether the height of all masses is given."""
        return self.centre_of_mass.height is not None and all(p.height is not None for p in self.payloads)


class Item(fields.Section):
    """Something that is carried and has a mass."""

    name: Name
    mass: fields.Counterweight = fields.required("of one")
    number: Annotated[int, Field(ge=1, le=10_000)] = 1


class Budget(fields.Section):
    """Permitted mass and price of the machine, and masses beside the drive's parts and the payloads."""

    mass: fields.Mass | None = fields.optional("permitted total")
    price: fields.Price | None = fields.optional("permitted, of all drives, power supply and brake resistor together")
    structure: fields.Mass | None = fields.optional("frame, wheels, covers; unknown where not given")
    others: Annotated[list[Item], Field(max_length=1000)] = fields.no_entries("equipment")
    drive_counts: bool = fields.default(
        False, "whether the moved mass follows from the budget, including the drive's own"
    )

    @property
    def weighs(self) -> bool:
        """Whether masses are summed: not where the price alone is limited."""
        return self.model_fields_set != {"price"}

    def _contradictions(self) -> Iterator[str]:
        yield from fields.apart(self.others, "others")
        if self.drive_counts and self.structure is None:
            yield "give structure where drive_counts: the mass without the drive must be known"
