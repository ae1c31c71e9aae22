"""Room, footing and grip of a platform against their limits, and the speeds that its drives permit."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import cos, inf, nan, tan
from typing import NamedTuple

import numpy as np

from drivesizer.catalog.parts import one_row
from drivesizer.errors import InputError
from drivesizer.load_cases import driven_shaft_cycle, load_cycle
from drivesizer.load_cases.of_machine import requirement_checks
from drivesizer.load_cases.platform import dynamics_of, ground_of, trajectory_of
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.physics.cycle_at_gearhead import ACCELERATION, BRAKING, DRIVING, SPEED, CycleAtBelt
from drivesizer.physics.drive_train import lost_in_gearhead
from drivesizer.physics.figures import Array, Mask, Whole, bisected
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.physics.motor_demand import coefficients
from drivesizer.physics.thermal import resistance_25, resistance_at, steady_winding
from drivesizer.physics.winding import housing_loss
from drivesizer.platform import envelope, stability
from drivesizer.platform.dynamics import Dynamics, Ground, Moving, contact_loads, wheel_torques
from drivesizer.platform.kinematics import map_columns
from drivesizer.platform.trajectory import Trajectory
from drivesizer.results.check import Check, Figure, figure, worst_of_cases
from drivesizer.results.check_columns import CheckColumn, at_most, fits
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import DriveParts, DriveSet
from drivesizer.results.ratings import continuous_speed_limit, controller_current, nominal_current_limit
from drivesizer.spec.mounting import controller_needed, motor_needed, rise_needed
from drivesizer.spec.platform import Platform
from drivesizer.spec.robot import RobotSpec

# -- Fastest steady motion of a platform in each direction, by what its drives permit.
#
# At a constant velocity :math:`v (\cos φ, \sin φ, 0)` in the robot's frame the wheels turn by (32), and their
# torques are those of resistances and slope, whatever the speed: so each limit of a drive holds up to one speed.
# Looked at are the limits that a motion meets which goes on for long: those of gearhead and motor, the winding's
# temperature and its voltage at the lowest supply, the continuous current of the controller. Supply and battery are
# not.


_DIRECTION_STEP = 5  # deg, between directions; a divisor of 15
_SLOW, _FAST = 1e-6, 1e3  # m/s, between which speeds are looked for
_HALVINGS = 32  # to less than a thousandth of a millimetre per second
_ROUNDING = 1e-9  # of what turns or slides


class PermittedSpeeds(NamedTuple):
    """Highest steady speed in each direction, of the platform as it is and with the motor of each wheel failed."""

    direction: Whole  # deg, in the robot's frame, counterclockwise from ahead
    speed: dict[int, Array]  # m/s, by the failed wheel, 0 for none; NaN: no motion of these wheels, infinite: no limit
    limit: dict[int, list[str]]  # title of the check that a higher speed fails
    unknown: tuple[str, ...]  # titles of checks that are left out, as a figure of them is unknown
    estimated: tuple[str, ...]  # figures of the drive that no data sheet gives, at the middle of their bands
    failed: tuple[int, ...] = ()  # wheels whose motors have failed in all of it
    required: float | None = None  # m/s, in every direction

    def at(self, degrees: int) -> dict[int, tuple[float, str]]:
        """Speed and limit in one of the directions, by the failed wheel."""
        place = degrees // _DIRECTION_STEP
        return {failed: (float(speed[place]), self.limit[failed][place]) for failed, speed in self.speed.items()}


def permitted_speeds(spec: RobotSpec, drive: DriveSet) -> PermittedSpeeds | None:
    """Permitted speeds of a platform in all directions, as it is and with the motor of each driven wheel failed.

    A wheel whose motor has failed turns freely, or is held where the spec has ``blocked``. Its motor and gearhead
    resist nothing.
    """
    if drive.steps:
        return None
    platform, direction = spec.platform, np.arange(0, 360, _DIRECTION_STEP)
    assert platform is not None
    speed, limit, unknown = {}, {}, dict[str, None]()
    for failed in (0, *(place + 1 for place in dynamics_of(spec).kinematics.driven)):
        try:
            without = [*platform.failed, *[failed] * bool(failed)]
            d = dynamics_of(spec.alone(platform=platform.model_copy(update={"failed": without})))
        except InputError:  # the others do not hold the platform
            continue
        speed[failed], limit[failed], lacking = _fastest(spec, drive, d, np.radians(direction))
        unknown |= dict.fromkeys(lacking)
    estimated = (
        estimate.title for estimate in drive.estimated if estimate.kind != "mass" and estimate.part != "encoder"
    )
    required = spec.requirements.speed if spec.requirements else None
    return PermittedSpeeds(
        direction, speed, limit, tuple(unknown), tuple(estimated), tuple(platform.failed),
        platform.limits.speed if required is None else required,
    )  # fmt: skip


def _fastest(
    spec: RobotSpec, drive: DriveParts, d: Dynamics, direction: Array
) -> tuple[Array, list[str], Iterator[str]]:
    """Highest speed in each direction, the check that ends it, and checks that are unknown."""
    eta = np.stack([np.cos(direction), np.sin(direction), np.zeros_like(direction)])
    k = d.kinematics
    moves = (np.abs(map_columns(k.held, eta)) <= _ROUNDING).all(axis=0)
    eta = eta[:, moves]
    turns = map_columns(k.E[list(k.driven)], eta)
    turns[np.abs(turns) <= _ROUNDING * np.abs(turns).max(initial=0.0)] = 0.0
    torque = wheel_torques(d, Moving(eta, np.zeros_like(eta), ground=ground_of(spec)))

    def checks(v: Array) -> list[CheckColumn]:
        return _checks(spec, drive, (turns * v).ravel(), torque.ravel())

    def shortage(v: Array) -> Array:
        """By how much each check falls short, 0 where it passes: shape (checks, wheels, directions)."""
        columns = checks(v)
        shortages = [np.where(columns[n].passed, 0.0, 1.0 - np.nan_to_num(columns[n].margin)) for n in known]
        return np.array(shortages).reshape(-1, *turns.shape)

    low = np.full(turns.shape[1], _SLOW)
    first = checks(low)
    turning = turns.ravel() != 0.0  # a wheel at rest meets any limit of speed, known or not
    known = [number for number, check in enumerate(first) if (check.passed | check.failed)[turning].any()]
    stuck, high = shortage(low).any(axis=(0, 1)), np.full_like(low, _FAST)
    free: Mask = np.logical_not(shortage(high).any(axis=(0, 1)))
    low, high = bisected(low, high, lambda v: shortage(v).any(axis=(0, 1)), _HALVINGS)
    worst = shortage(np.where(stuck, _SLOW, high)).max(axis=1).argmax(axis=0)
    titles = [
        "" if never else CHECKS["physics"][first[known[n]].name].title for n, never in zip(worst, free, strict=True)
    ]
    speed, named = np.full(len(direction), nan), np.full(len(direction), "", dtype=object)
    speed[moves], named[moves] = np.where(free, np.inf, np.where(stuck, 0.0, low)), titles
    return speed, named.tolist(), (CHECKS["physics"][c.name].title for n, c in enumerate(first) if n not in known)


def _checks(spec: RobotSpec, drive: DriveParts, speed: Array, torque: Array) -> list[CheckColumn]:
    """Limits of a drive in steady motion, as columns over speeds and torques at its wheel."""
    speeds, torques = (np.stack([x, x], axis=1) for x in (speed, torque))
    cycle = LoadCycle("steady motion", np.ones_like(speed), speeds, np.zeros_like(speeds), torques)
    at = CycleAtBelt(driven_shaft_cycle(spec, cycle), drive.belt_efficiency).behind(drive.belt_ratio)
    motor, gearhead, controller = one_row(drive.motor), one_row(drive.gearhead), one_row(drive.controller)
    own = coefficients(at.acts, motor, gearhead, one_row(drive.encoder), drive.brake_inertia)
    f, ratio, ambient = at.functions[:, 0], drive.gearhead.ratio, spec.environment.ambient
    output, turning = f[:, :ACCELERATION].sum(axis=1), np.abs(f[:, SPEED])  # N*m and rad/s behind the gearhead
    current = f @ np.where(own.left_out, nan, own.torque)[0] / drive.motor.torque_constant
    rubbing, iron = housing_loss(motor, gearhead["ratio"])
    loss = rubbing * turning + iron * turning**2
    if spec.mounting and spec.mounting.gear_loss_share:
        driving, braking = (f[:, which] * f[:, SPEED] for which in (DRIVING, BRAKING))
        loss = loss + spec.mounting.gear_loss_share * lost_in_gearhead(driving, braking, turning * ratio, gearhead)
    R_25 = resistance_25(motor)
    winding = np.asarray(steady_winding(motor, ambient, np.abs(current), loss))
    warm = np.where(np.isnan(winding), motor["max_winding_temperature"], np.fmin(winding, 1e4))
    feed = spec.feed_of(drive.controller, drive.brake)
    volts = np.max([np.abs(current * (resistance_at(R_25, T) + feed.leads) + own.back_emf * f[:, SPEED] * ratio)
                    for T in (ambient, warm)], axis=0)  # fmt: skip
    margins = spec.margins
    return [
        at_most("gearhead_continuous_torque", np.abs(output), gearhead["continuous_torque"], needed=margins.torque),
        continuous_speed_limit(gearhead, turning, turning, ratio, margins.speed),
        at_most("gearhead_continuous_power", np.abs(output) * turning, gearhead["continuous_power"],
                needed=margins.torque),
        at_most("motor_speed", turning * ratio, motor["max_speed"], needed=margins.speed),
        nominal_current_limit(np.abs(current), motor, ambient, motor_needed(spec)),
        at_most("winding_temperature", winding, motor["max_winding_temperature"], zero=ambient,
                needed=rise_needed(spec)),
        at_most("supply_voltage", volts, feed.usable_range, needed=margins.speed),
        at_most("controller_continuous_current", np.abs(current), controller_current(controller, ambient),
                needed=controller_needed(spec)),
    ]  # fmt: skip


# -- Room, footing and grip of a machine against their limits.
#
# Where a figure is not given that a check needs, such as the height of the centre of mass, the check is unknown and
# says which. Wheels and casters are equally stiff on a stiff frame; the motors share torque by least squares, not as
# would suit the floor best; friction is the same in all directions, at rest and slow.


_NO_HEIGHT = "unknown: height of the centre of mass"
_NO_CASTERS = "unknown: what keeps it upright, its contacts lie on one line"
_NO_FRICTION = "unknown: friction_coefficient"


class PlatformOnFloor(NamedTuple):
    """A platform on its floor, as the checks below take it; ``d`` is that of ``platform_of(section, load)``."""

    section: Platform
    load: WheeledVehicle
    d: Dynamics
    gravity: float  # m/s^2
    needed: float = 0.0  # margin that the spec requires of traction
    trajectory: Trajectory | None = None
    gains: float | None = None  # m/s^2, largest acceleration of its motion, where the limits do not say

    @property
    def faster(self) -> float | None:
        """Largest acceleration that it is held against, in any direction [m/s^2]."""
        return self.section.limits.acceleration or self.gains

    @property
    def ground(self) -> Ground:
        """The floor along the trajectory."""
        return Ground(slope=self.load.slope, uphill=self.section.uphill, gravity=self.gravity)

    @property
    def steepest(self) -> float:
        """The slope, in any orientation of the platform [rad]."""
        return abs(self.load.slope)

    @property
    def upright(self) -> bool:
        """Whether its contacts can keep it upright at all."""
        try:
            return bool(stability.support_polygon(self.d.platform))
        except InputError:
            return False

    @property
    def directions(self) -> tuple[float | None, ...]:
        """Directions in which it gains speed [rad]; None is any."""
        angles = stability.translations(self.d)
        return (None,) if len(angles) > 2 else tuple(float(a) for a in angles)

    def contact(self, number: int) -> str:
        """Name of a wheel or caster by its number."""
        wheels = len(self.d.platform.wheels)
        return f"wheel {number}" if number <= wheels else f"caster {number - wheels}"


def _noted(columns: Sequence[CheckColumn], case: str = "") -> tuple[Check, ...]:
    return tuple(c.at((), "budget", cases=(case,)) for c in columns)


def worst_case_budget(spec: RobotSpec, *, figures: bool = True) -> tuple[tuple[Check, ...], tuple[Figure, ...]]:
    """Requirements of a machine, and room, footing and grip of its platform: limits, and figures that have none."""
    checks = requirement_checks(spec, spec.requirements) if spec.requirements else ()
    if spec.platform is None:
        return checks, ()
    floors = []
    for name, case in spec.load_cases:
        assert case.platform is not None and isinstance(case.load, WheeledVehicle)
        trajectory, gains = trajectory_of(case), None
        if trajectory is None:
            cycle = load_cycle(case)
            gains = cycle.radius * float(np.abs(cycle.acceleration).max())
        conditions = case.environment.gravity, spec.margins.torque, trajectory, gains
        floors.append((name, PlatformOnFloor(case.platform, case.load, dynamics_of(case), *conditions)))
    checks += worst_of_cases([(name, platform_checks(s)) for name, s in floors])
    return checks, tuple(platform_figures(floors[0][1])) if figures else ()


def platform_checks(s: PlatformOnFloor) -> tuple[Check, ...]:
    """Room, footing and grip of a platform, whatever drives it."""
    return envelope_checks(s.section, s.trajectory) + stability_checks(s) + grip_checks(s)


def envelope_checks(section: Platform, trajectory: Trajectory | None = None) -> tuple[Check, ...]:
    """Every passage, in the order of the spec; the passage's name is the check's case."""
    placed = tuple(p.record for p in section.passages if p.x is not None)
    clearance_at, checks = dict[str, envelope.Clearance](), list[Check]()
    if trajectory is not None and section.size is not None:
        clearance_at = {c.passage: c for c in envelope.clearances(trajectory, section.size.record, placed)}
    for passage in section.passages:
        assert section.size is not None
        size, opening = section.size.record, passage.width
        required = envelope.width_at(size, passage.heading_error, passage.aside)
        columns = [at_most("passage_width", required, opening)]
        if passage.height is not None:
            columns.append(at_most("passage_height", size.height, passage.height))
        if passage.turns:
            required = envelope.turning_circle(size) + 2.0 * passage.aside
            columns.append(at_most("passage_turning", required, opening))
        if passage.corner is not None:
            room = envelope.corner_width(size.length, opening, passage.corner)
            columns.append(at_most("passage_corner", size.width, room))
        clearance = clearance_at.get(passage.name)
        if clearance is not None:  # to both sides alike; what hits a jamb takes more than there is
            side = clearance.side
            note = f"nearest to the {side} jamb" if side else "the trajectory does not lead through it"
            required, time = opening - 2.0 * clearance.least, np.asarray(clearance.time)
            columns.append(at_most("passage_clearance", required, opening, note=note, time=time))
        checks += _noted(columns, passage.name)
    return tuple(checks)


def stability_checks(s: PlatformOnFloor) -> tuple[Check, ...]:
    """Whether every wheel stays on the floor, at the limits of the motion on the load's slope, and along a trajectory.

    Gaining speed uphill and standing on the slope go together: their accelerations add up.
    """
    if not s.upright:
        return _noted([fits("centre_of_mass", False, False)._replace(note=_NO_CASTERS)])
    p, known = s.d.platform, s.section.height_known
    at_rest = contact_loads(p, ground=Ground(gravity=s.gravity))
    columns = [fits("centre_of_mass", bool(stability.carrying(at_rest).all()), True)]
    gains, falls = (s.faster or 0.0) / cos(s.steepest), s.gravity * tan(s.steepest)
    required = gains + falls
    for name in ("lift_off", "tipping"):  # worst in the directions of the limits and of the slope
        if not known:
            columns.append(at_most(name, required or nan, nan, note=_NO_HEIGHT))
            continue
        footing = max(
            stability.used_footing(p, ((gains, way), (falls, None)), tips=name == "tipping", gravity=s.gravity)
            for way in s.directions
        )
        columns.append(at_most(name, required, required / footing if footing else inf))
    if s.trajectory is not None:
        least = {
            "wheel_unloading": stability.least_load(p, s.trajectory, s.ground, share=True),
            "tipping_motion": stability.least_margin(p, s.trajectory, s.ground, share=True),
        }
        for name, worst in least.items():
            time, note = (np.asarray(worst.time), s.contact(worst.contact)) if known else (None, _NO_HEIGHT)
            columns.append(at_most(name, 1.0 - worst.value if known else nan, 1.0, time=time, note=note))
    return _noted(columns)


def grip_checks(s: PlatformOnFloor) -> tuple[Check, ...]:
    """Whether the floor transmits what the driven wheels must put on it: on the slope, gaining speed, on the path.

    Where the height of the centre of mass is unknown, wheels are taken to carry what they do at rest: a check may then
    fail, but not pass.
    """
    lacking = _NO_FRICTION if s.load.friction_coefficient is None else "" if s.upright else _NO_CASTERS
    friction, columns = nan if lacking else float(s.load.friction_coefficient or 0.0), list[CheckColumn]()
    if s.steepest:
        limit = nan if lacking else stability.grip_slope(s.d, friction)
        columns.append(at_most("grip_slope", s.steepest, limit, needed=s.needed))
    if s.faster is not None:
        slope, ways = s.steepest, () if lacking else s.directions
        limits = [stability.grip_acceleration(s.d, friction, way, slope=slope, gravity=s.gravity) for way in ways]
        columns.append(at_most("grip_acceleration", s.faster, min(limits, default=nan), needed=s.needed))
    if s.trajectory is not None:
        worst = stability.worst_friction(s.d, s.trajectory, s.ground)
        note, time = s.contact(worst.contact), np.asarray(worst.time)
        columns.append(at_most("grip_motion", worst.value, friction, needed=s.needed, note=note, time=time))
    if lacking:
        columns = [c._replace(note=lacking) for c in columns]
    elif not s.section.height_known:
        columns = [c._replace(passed=c.passed & False, note="" if c.failed else _NO_HEIGHT) for c in columns]
    return _noted(columns)


def platform_figures(s: PlatformOnFloor) -> Iterator[Figure]:
    """Figures of room, footing and grip that have no limit."""
    section, p, known = s.section, s.d.platform, s.section.height_known
    if section.size is not None:
        size = section.size.record
        yield figure("turning_circle", envelope.turning_circle(size))
        for passage in section.passages:
            tolerance = envelope.heading_tolerance(size, passage.width, passage.aside)
            driving = envelope.heading_tolerance_driving(size, passage.width, passage.depth, passage.aside)
            yield figure("heading_held", tolerance, passage=passage.name)
            yield figure("heading_driving", driving, passage=passage.name)
    if not s.upright:
        return
    distance = stability.tipping_edges(p)[0].distance
    lifts, tips = (f(p) if known else nan for f in (stability.lift_off_slope, stability.tipping_slope))
    brakes = min(stability.lift_off_acceleration(p, way, s.gravity) for way in s.directions) if known else nan
    yield figure("tipping_distance", distance)
    yield figure("lift_off_slope", lifts)
    yield figure("tipping_slope", tips)
    yield figure("lift_off_acceleration", brakes)
    if s.trajectory is not None and known:
        load, margin = (f(p, s.trajectory, s.ground) for f in (stability.least_load, stability.least_margin))
        yield figure("wheel_load", load.value, load.time)
        yield figure("tipping_margin", margin.value, margin.time)
    if s.load.friction_coefficient is not None:
        slope = gains = nan
        if known:
            friction = s.load.friction_coefficient
            slope = stability.grip_slope(s.d, friction)
            gains = min(stability.grip_acceleration(s.d, friction, way, gravity=s.gravity) for way in s.directions)
        yield figure("grip_slope", slope)
        yield figure("grip_acceleration", gains)
