"""A platform's mass, room, footing, grip and permitted speed with a drive, against their limits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import cos, inf, nan, tan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import one_row
from drivesizer.errors import InputError
from drivesizer.load_cases import driven_shaft_cycle, load_cycle
from drivesizer.load_cases.of_machine import requirement_checks
from drivesizer.load_cases.platform import dynamics_of, ground_of, platform_assumptions, trajectory_of
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.machine.mass_budget import MassBudget, mass_budget
from drivesizer.physics.cycle_at_gearhead import ACCELERATION, BRAKING, DRIVING, SPEED, CycleAtBelt
from drivesizer.physics.drive_train import lost_in_gearhead
from drivesizer.physics.figures import no_less
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.physics.motor_demand import coefficients
from drivesizer.physics.thermal import resistance_25, resistance_at, steady_winding
from drivesizer.physics.winding import housing_loss
from drivesizer.platform.dynamics import Dynamics, Ground, contact_loads, wheel_torques
from drivesizer.platform.envelope import (
    Clearance,
    clearances,
    corner_width,
    heading_tolerance,
    heading_tolerance_driving,
    turning_circle,
    width_at,
)
from drivesizer.platform.grip import grip_acceleration, grip_slope, translations, worst_friction
from drivesizer.platform.kinematics import map_columns
from drivesizer.platform.stability import (
    Moment,
    carrying,
    least_load,
    least_margin,
    lift_off_acceleration,
    lift_off_slope,
    support_polygon,
    tipping_edges,
    tipping_slope,
    used_footing,
)
from drivesizer.platform.trajectory import Trajectory
from drivesizer.results.check import worst_of_cases
from drivesizer.results.check_columns import CheckColumn, at_most, fits, over_band
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import DriveParts, DriveSet, MassRow
from drivesizer.results.ratings import continuous_speed_limit, controller_current, nominal_current_limit
from drivesizer.results.sizing import Check, Figure, Status, verdict
from drivesizer.spec.mounting import controller_needed, motor_needed, rise_needed
from drivesizer.spec.platform import Budget, Platform
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

__all__ = [
    "MechanicalBudget", "PermittedSpeeds", "PlatformOnFloor", "envelope_checks", "grip_checks", "machine_mass",
    "mass_checks", "mass_columns", "mass_part", "permitted_speeds", "platform_part", "stability_checks",
    "worst_case_budget",
]  # fmt: skip


# -- Fastest steady motion of a platform in each direction, by what its drives permit.
#
# At a constant velocity :math:`v (\cos φ, \sin φ, 0)` in the robot's frame the wheels turn by (32), and their
# torques are those of resistances and slope, whatever the speed: so each limit of a drive holds up to one speed.
# Looked at are the limits that a motion meets which goes on for long: those of gearhead and motor, the winding's
# temperature and its voltage at the lowest supply, the continuous current of the controller. Supply and battery are
# not.


Array = NDArray[np.float64]
_EVERY = 5  # deg, between directions; a divisor of 15
_SLOW, _FAST = 1e-6, 1e3  # m/s, between which speeds are looked for
_HALVINGS = 32  # to less than a thousandth of a millimetre per second
_ROUNDING = 1e-9  # of what turns or slides


class PermittedSpeeds(NamedTuple):
    """Highest steady speed in each direction, of the platform as it is and with the motor of each wheel failed."""

    direction: NDArray[np.int64]  # deg, in the robot's frame, counterclockwise from ahead
    speed: dict[int, Array]  # m/s, by the failed wheel, 0 for none; NaN: no motion of these wheels, infinite: no limit
    limit: dict[int, list[str]]  # title of the check that a higher speed fails
    unknown: tuple[str, ...]  # titles of checks that are left out, as a figure of them is unknown
    estimated: tuple[str, ...]  # figures of the drive that no data sheet gives, at the middle of their bands
    failed: tuple[int, ...] = ()  # wheels whose motors have failed in all of it
    required: float | None = None  # m/s, in every direction

    def at(self, degrees: int) -> dict[int, tuple[float, str]]:
        """Speed and limit in one of the directions, by the failed wheel."""
        place = degrees // _EVERY
        return {failed: (float(speed[place]), self.limit[failed][place]) for failed, speed in self.speed.items()}


def permitted_speeds(spec: RobotSpec, drive: DriveSet) -> PermittedSpeeds | None:
    """Permitted speeds of a platform in all directions, as it is and with the motor of each driven wheel failed.

    A wheel whose motor has failed turns freely, or is held where the spec has ``blocked``. Its motor and gearhead
    resist nothing.
    """
    if drive.steps:
        return None
    platform, direction = spec.platform, np.arange(0, 360, _EVERY)
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
    estimated = (one.title for one in drive.estimated if one.kind != "mass" and one.part != "encoder")
    wanted = spec.requirements.speed if spec.requirements else None
    return PermittedSpeeds(
        direction, speed, limit, tuple(unknown), tuple(estimated), tuple(platform.failed),
        platform.limits.speed if wanted is None else wanted,
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
    torque = wheel_torques(d, eta, np.zeros_like(eta), ground=ground_of(spec))

    def checks(v: Array) -> list[CheckColumn]:
        return _checks(spec, drive, (turns * v).ravel(), torque.ravel())

    def shortage(v: Array) -> Array:
        """By how much each check falls short, 0 where it passes: shape (checks, wheels, directions)."""
        every = checks(v)
        found = [np.where(every[n].passed, 0.0, 1.0 - np.nan_to_num(every[n].margin)) for n in known]
        return np.array(found).reshape(-1, *turns.shape)

    low = np.full(turns.shape[1], _SLOW)
    first = checks(low)
    turning = turns.ravel() != 0.0  # a wheel at rest meets any limit of speed, known or not
    known = [number for number, check in enumerate(first) if (check.passed | check.failed)[turning].any()]
    held, high = shortage(low).any(axis=(0, 1)), np.full_like(low, _FAST)
    free: NDArray[np.bool_] = np.logical_not(shortage(high).any(axis=(0, 1)))
    for _ in range(_HALVINGS):
        middle = (low + high) / 2.0
        over = shortage(middle).any(axis=(0, 1))
        low, high = np.where(over, low, middle), np.where(over, middle, high)
    worst = shortage(np.where(held, _SLOW, high)).max(axis=1).argmax(axis=0)
    titles = [
        "" if never else CHECKS["physics"][first[known[n]].name].title for n, never in zip(worst, free, strict=True)
    ]
    speed, named = np.full(len(direction), nan), np.full(len(direction), "", dtype=object)
    speed[moves], named[moves] = np.where(free, np.inf, np.where(held, 0.0, low)), titles
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


# -- A machine's mass, room, footing and grip against their limits. Margins are made in ``checks``.
#
# Where a figure is not given that a check needs, such as the height of the centre of mass, the check is unknown and
# says which.


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
            return bool(support_polygon(self.d.platform))
        except InputError:
            return False

    @property
    def directions(self) -> tuple[float | None, ...]:
        """Directions in which it gains speed [rad]; None is any."""
        angles = translations(self.d)
        return (None,) if len(angles) > 2 else tuple(float(a) for a in angles)


def _noted(columns: Sequence[CheckColumn], case: str = "") -> tuple[Check, ...]:
    return tuple(c.at((), "budget", cases=(case,)) for c in columns)


# --- mass -------------------------------------------------------------------------------------------------------------


def machine_mass(
    budget: Budget, drive: Sequence[MassRow], *, platform: Platform | None = None, battery: float | None = None
) -> MassBudget:
    """The mass budget of a machine with given rows of its drives."""
    carried = [(item.name if item.number == 1 else f"{item.number} x {item.name}", item.mass * item.number)
               for item in budget.others]  # fmt: skip
    carried += [(payload.name, payload.mass) for payload in (platform.payloads if platform else ())]
    return mass_budget(drive, structure=budget.structure, battery=battery, others=carried, limit=budget.mass)


def mass_checks(found: MassBudget, sized_for: float | None = None) -> tuple[Check, ...]:
    """The known mass against the limit, and against the mass that the drive is sized for."""
    low, high = found.ends
    middle, *ends = (
        mass_columns(np.array([mass]), bool(found.unknown), found.limit, sized_for) for mass in (found.known, low, high)
    )
    if found.estimated:
        one = np.array([0])
        middle = [over_band(mid, pair, one) for mid, *pair in zip(middle, *ends, strict=True)]
    return tuple(_mass_check(found, column) for column in middle)


def _mass_check(found: MassBudget, column: CheckColumn) -> Check:
    """One limit of the mass; where estimated masses decide, from where on and how probable it is that it holds."""
    check = column.at(0, "budget")
    if check.status == "unknown":
        return replace(check, note=f"unknown: {', '.join(dict.fromkeys(found.unknown))}")
    if check.status != "open":
        return check
    parts = ", ".join(dict.fromkeys(found.estimated))
    room = show(check.limit / (1.0 + check.needed) - (found.known - found.guessed), check.unit, "mass", 2)
    return replace(check, probability=found.probability(check.limit),
                   note=f"passes where {parts}, which are estimated, have at most {room} together")  # fmt: skip


def mass_columns(known: Any, lacking: Any, limit: float | None, sized_for: float | None) -> list[CheckColumn]:
    """The known mass against the limits, as columns."""
    limits = {"mass": nan if limit is None else limit, "mass_sized_for": nan if sized_for is None else sized_for}
    mass = no_less(known, ~np.asarray(lacking, bool))
    return [at_most(name, mass, most) for name, most in limits.items() if most == most]


# --- room -------------------------------------------------------------------------------------------------------------


def envelope_checks(section: Platform, trajectory: Trajectory | None = None) -> tuple[Check, ...]:
    """Every passage, in the order of the spec; the passage's name is the check's case."""
    placed = tuple(p.record for p in section.passages if p.x is not None)
    clearance_at, found = dict[str, Clearance](), list[Check]()
    if trajectory is not None and section.size is not None:
        clearance_at = {c.passage: c for c in clearances(trajectory, section.size.record, placed)}
    for passage in section.passages:
        assert section.size is not None
        size, opening = section.size.record, passage.width
        columns = [at_most("passage_width", width_at(size, passage.heading_error, passage.aside), opening)]
        if passage.height is not None:
            columns.append(at_most("passage_height", size.height, passage.height))
        if passage.turns:
            columns.append(at_most("passage_turning", turning_circle(size) + 2.0 * passage.aside, opening))
        if passage.corner is not None:
            room = corner_width(size.length, opening, passage.corner)
            columns.append(at_most("passage_corner", size.width, room))
        clearance = clearance_at.get(passage.name)
        if clearance is not None:  # to both sides alike; what hits a jamb takes more than there is
            side = clearance.side
            note = f"nearest to the {side} jamb" if side else "the trajectory does not lead through it"
            taken, time = opening - 2.0 * clearance.least, np.asarray(clearance.time)
            columns.append(at_most("passage_clearance", taken, opening, note=note, time=time))
        found += _noted(columns, passage.name)
    return tuple(found)


# --- footing ----------------------------------------------------------------------------------------------------------

_NO_HEIGHT = "unknown: height of the centre of mass"
_NO_CASTERS = "unknown: what keeps it upright, its contacts lie on one line"
_NO_FRICTION = "unknown: friction_coefficient"


def stability_checks(s: PlatformOnFloor) -> tuple[Check, ...]:
    """Whether every wheel stays on the floor, at the limits of the motion on the load's slope, and along a trajectory.

    Acceleration and slope may point anywhere that the wheels allow, and are held together against what both may be at
    the same ratio.
    """
    if not s.upright:
        return _noted([replace(fits("centre_of_mass", False, False), note=_NO_CASTERS)])
    at_rest = contact_loads(s.d.platform, ground=Ground(gravity=s.gravity))
    found = [fits("centre_of_mass", bool(carrying(at_rest).all()), True), _limit(s, "lift_off"), _limit(s, "tipping")]
    if s.trajectory is not None:
        found.append(_off(s, "wheel_unloading", least_load(s.d.platform, s.trajectory, s.ground, share=True)))
        found.append(_off(s, "tipping_motion", least_margin(s.d.platform, s.trajectory, s.ground, share=True)))
    return _noted(found)


def _limit(s: PlatformOnFloor, name: str) -> CheckColumn:
    """The acceleration of the limits and that of the slope, worst in their directions."""
    gains, falls = (s.faster or 0.0) / cos(s.steepest), s.gravity * tan(s.steepest)
    required = gains + falls
    if not s.section.height_known:
        return at_most(name, required or nan, nan, note=_NO_HEIGHT)
    used = max(
        used_footing(s.d.platform, ((gains, direction), (falls, None)), tips=name == "tipping", gravity=s.gravity)
        for direction in s.directions
    )
    return at_most(name, required, required / used if used else inf)


def _off(s: PlatformOnFloor, name: str, least: Moment) -> CheckColumn:
    """Largest loss of load or margin over the motion, as a share."""
    if not s.section.height_known:
        return at_most(name, nan, 1.0, note=_NO_HEIGHT)
    time = np.asarray(least.time)
    return at_most(name, 1.0 - least.value, 1.0, time=time, note=_contact(s, least.contact))


def _contact(s: PlatformOnFloor, number: int) -> str:
    wheels = len(s.d.platform.wheels)
    return f"wheel {number}" if number <= wheels else f"caster {number - wheels}"


# --- grip -------------------------------------------------------------------------------------------------------------


def grip_checks(s: PlatformOnFloor) -> tuple[Check, ...]:
    """Whether the floor transmits what the driven wheels must put on it: on the slope, gaining speed, on the path.

    Without the height of the centre of mass a check may fail, but does not pass.
    """
    lacking = _NO_FRICTION if s.load.friction_coefficient is None else "" if s.upright else _NO_CASTERS
    friction, columns = nan if lacking else float(s.load.friction_coefficient or 0.0), list[CheckColumn]()
    if s.steepest:
        limit = nan if lacking else grip_slope(s.d, friction)
        columns.append(at_most("grip_slope", s.steepest, limit, needed=s.needed))
    if s.faster is not None:
        slope, gravity = s.steepest, s.gravity
        ways = () if lacking else s.directions
        limits = [grip_acceleration(s.d, friction, way, slope=slope, gravity=gravity) for way in ways]
        columns.append(at_most("grip_acceleration", s.faster, min(limits, default=nan), needed=s.needed))
    if s.trajectory is not None:
        worst = worst_friction(s.d, s.trajectory, s.ground)
        note, time = _contact(s, worst.contact), np.asarray(worst.time)
        columns.append(at_most("grip_motion", worst.value, friction, needed=s.needed, note=note, time=time))
    if lacking:
        columns = [replace(c, note=lacking) for c in columns]
    elif not s.section.height_known:
        columns = [replace(c, passed=c.passed & False, note="" if c.failed else _NO_HEIGHT) for c in columns]
    return _noted(columns)


# -- Mass, clearance, stability and grip of a machine with one drive.
#
# Checks are made in ``platform_checks``; here they are put together with the figures that have no limit, and what
# was assumed.


@dataclass(frozen=True, slots=True, kw_only=True)
class MechanicalBudget:
    """Mass, room, footing and grip of a machine with one drive."""

    mass: MassBudget | None  # None without a budget section
    status: Status
    checks: tuple[Check, ...]
    figures: tuple[Figure, ...]
    assumptions: tuple[str, ...]


def mass_part(mass: MassBudget, sized_for: float | None = None) -> MechanicalBudget:
    """Mass of a machine against its limits."""
    checks, counted = mass_checks(mass, sized_for), "known or estimated" if mass.estimated else "known"
    figures = [_figure("mass_known", f"Mass, sum of what is {counted}", mass.known, "mass", "kg")]
    if mass.limit == mass.limit:
        figures.append(_figure("mass_left", "Mass left of what is allowed", mass.left, "mass", "kg"))
    without = ", ".join(dict.fromkeys(mass.unknown))
    return MechanicalBudget(
        mass=mass, status=verdict(checks), checks=checks, figures=tuple(figures),
        assumptions=(f"The machine's mass is without {without}: unknown.",) if without else (),
    )  # fmt: skip


def worst_case_budget(spec: RobotSpec) -> MechanicalBudget:
    """Requirements of a machine, and room, footing and grip of its platform."""
    checks = requirement_checks(spec, spec.requirements) if spec.requirements else ()
    if spec.platform is None:
        return MechanicalBudget(mass=None, status=verdict(checks), checks=checks, figures=(), assumptions=())
    found = [(name, platform_part(_floor_budget(case, spec.margins.torque))) for name, case in spec.load_cases]
    checks += worst_of_cases([(name, part.checks) for name, part in found])
    return replace(found[0][1], checks=checks, status=verdict(checks))


def _floor_budget(case: RobotSpec, needed: float) -> PlatformOnFloor:
    assert case.platform is not None and isinstance(case.load, WheeledVehicle)
    trajectory, gains = trajectory_of(case), None
    if trajectory is None:
        cycle = load_cycle(case)
        gains = cycle.radius * float(np.abs(cycle.acceleration).max())
    return PlatformOnFloor(
        case.platform, case.load, dynamics_of(case), case.environment.gravity, needed, trajectory, gains
    )


def platform_part(s: PlatformOnFloor) -> MechanicalBudget:
    """Room, footing and grip of a platform, whatever drives it."""
    checks = envelope_checks(s.section, s.trajectory) + stability_checks(s) + grip_checks(s)
    figures = (*_envelope_checks(s.section), *_footing_checks(s), *_grip_checks(s))
    assumptions = [
        *platform_assumptions(s.section, s.load),
        "Wheels and casters are equally stiff on a stiff frame.",
        "The motors share torque by least squares, not as would suit the floor best.",
    ]
    if s.load.friction_coefficient is not None:
        assumptions.append("Friction is the same in all directions, at rest and slow.")
    return MechanicalBudget(
        mass=None, status=verdict(checks), checks=checks, figures=figures, assumptions=tuple(assumptions)
    )


# --- figures that have no limit ---------------------------------------------------------------------------------------


def _figure(name: str, title: str, value: float, kind: str, unit: str, time: float | None = None) -> Figure:
    return Figure(name=name, title=title, value=value, kind=kind, unit=unit, at_time=time)


def _envelope_checks(section: Platform) -> Iterator[Figure]:
    if section.size is None:
        return
    size = section.size.record
    yield _figure("turning_circle", "Turning circle, diameter", turning_circle(size), "length", "mm")
    for p in section.passages:
        held = heading_tolerance(size, p.width, p.aside)
        driving = heading_tolerance_driving(size, p.width, p.depth, p.aside)
        yield _figure("heading_held", f"Heading error in {p.name}, held", held, "angle", "deg")
        yield _figure("heading_driving", f"Heading error in {p.name}, driving along it", driving, "angle", "deg")


def _footing_checks(s: PlatformOnFloor) -> Iterator[Figure]:
    p = s.d.platform
    if not s.upright:
        return
    known = s.section.height_known
    edge = tipping_edges(p)[0]
    braking = min(lift_off_acceleration(p, direction, s.gravity) for direction in s.directions)
    yield _figure("tipping_distance", "Centre of mass from the nearest tipping edge", edge.distance, "length", "mm")
    yield _figure("lift_off_slope", "Slope that lifts a wheel", lift_off_slope(p) if known else nan, "angle", "deg")
    yield _figure("tipping_slope", "Slope that tips it over", tipping_slope(p) if known else nan, "angle", "deg")
    value = braking if known else nan
    yield _figure("lift_off_acceleration", "Braking that lifts a wheel", value, "acceleration", "m/s^2")
    if s.trajectory is not None and known:
        load, margin = (f(p, s.trajectory, s.ground) for f in (least_load, least_margin))
        yield _figure("wheel_load", "Least load of a wheel on the path", load.value, "force", "N", load.time)
        yield _figure("tipping_margin", "Least way to the tipping edge", margin.value, "length", "mm", margin.time)


def _grip_checks(s: PlatformOnFloor) -> Iterator[Figure]:
    if s.load.friction_coefficient is None or not s.upright:
        return
    friction, known = s.load.friction_coefficient, s.section.height_known
    slope = grip_slope(s.d, friction) if known else nan
    faster = (
        min(grip_acceleration(s.d, friction, direction, gravity=s.gravity) for direction in s.directions)
        if known
        else nan
    )
    yield _figure("grip_slope", "Slope that the floor's grip holds, worst direction", slope, "angle", "deg")
    yield _figure(
        "grip_acceleration",
        "Acceleration that the floor transmits, level, worst direction",
        faster,
        "acceleration",
        "m/s^2",
    )
