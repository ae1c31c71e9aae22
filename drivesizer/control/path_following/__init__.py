"""A platform that follows a trajectory: its controllers, the actual platform, its deviation, and the runs of a spec."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np

from drivesizer.control.gains import LATE, pole_placement, symmetrical_optimum
from drivesizer.control.path_following import kernel as at
from drivesizer.errors import InputError
from drivesizer.files.machine_code import machine_code
from drivesizer.files.text import sentences
from drivesizer.load_cases.platform import Driving, dynamics_of, ground_of
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.platform import equations as eq
from drivesizer.platform.dynamics import (
    LEVEL,
    Dynamics,
    Ground,
    Moving,
    contact_loads,
    dynamics,
    wheel_space,
    wheel_torques,
)
from drivesizer.platform.equations import Array
from drivesizer.platform.kinematics import (
    EXACT,
    Kinematics,
    Misjudged,
    Platform,
    actual,
    check_allowed,
    columns,
    map_columns,
    per_wheel,
    seen_by_robot,
)
from drivesizer.platform.stability import least_margin
from drivesizer.platform.trajectory import Trajectory
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.platform import Following
from drivesizer.spec.platform import Platform as PlatformSection
from drivesizer.units import show

# -- Controllers of a platform: a speed loop for each driven wheel, and a pose loop.
#
# Speed loops are PI on the wheel, with the torque (current) limit. Their gain is that of the symmetrical optimum
# [1]_ for the least inertia of a wheel, its own and its rotor's, as when it slips or lifts off. Their integral is so
# slow that with the largest inertia, with its share of the platform, both poles are real and equal [2]_: :math:`k_i
# = k_p^2 / 4 J`.
#
# The pose is held at a slower period. Where the wheels allow all motions, each error in the robot's frame is an
# integrator behind the lag :math:`T = J/k_p + 1.5\,T_{pose}` and gets a PI by the symmetrical optimum with a = 3,
# whose damping is 1. A platform that only moves ahead and turns gets the law of [3]_, its natural frequency at the
# speed of travel the same 1/(3 T), damping 1; its lateral error has no integral.
#
# .. [1] C. Kessler, "Das symmetrische Optimum", Regelungstechnik 6 (1958) 395-400, 432-436.
# .. [2] K. J. Åström, T. Hägglund, *PID Controllers: Theory, Design, and Tuning*, 2nd ed., ISA 1995: pole placement.
# .. [3] Y. Kanayama, Y. Kimura, F. Miyazaki, T. Noguchi, "A stable tracking control method for an autonomous mobile
#    robot", Proc. IEEE International Conference on Robotics and Automation (1990) 384-389.


_APERIODIC = 3.0  # a of the symmetrical optimum whose damping (a - 1) / 2 is 1
_PERIODS = (1e-5, 1.0)  # s, shortest and longest


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedLoop:
    """PI speed controllers of the driven wheels."""

    period: float  # s
    proportional: tuple[float, ...]  # N*m*s/rad
    integral: tuple[float, ...]  # N*m/rad; 0 of a plain proportional one
    limit: tuple[float, ...]  # N*m at the wheel; infinite: none


@dataclass(frozen=True, slots=True, kw_only=True)
class PoseLoop:
    """Pose feedback: of three degrees of freedom by k_p and k_i, of a unicycle by k_p, k_i (along) and a distance."""

    period: float  # s, between two poses
    proportional: float  # 1/s
    integral: float  # 1/s^2
    unicycle: bool = False
    distance: float = math.inf  # m, of a unicycle: a lateral error y decays with the distance s as (1 + s/d) exp(-s/d)


def _within(what: str, period: float) -> float:
    """A period of a loop as it is, if it can be simulated."""
    low, high = _PERIODS
    if not low <= period <= high:
        raise InputError(f"{what}: period must lie between {low:g} s and {high:g} s, got {period!r}")
    return period


def inertias(d: Dynamics) -> tuple[tuple[float, ...], float]:
    """Least inertia of each driven wheel, its own and its rotor's, and the largest of any [kg*m^2].

    The latter is the largest eigenvalue of (57): of four mecanum wheels r² m / 4 and its own, unless turning has more.
    """
    own = tuple(d.platform.wheels[i].inertia + d.platform.wheels[i].rotor_inertia for i in d.kinematics.driven)
    return own, float(np.linalg.eigvals(wheel_space(d)[0]).real.max())


def speed_loop(
    d: Dynamics, *, period: float = 1e-3, limit: float | Sequence[float] = math.inf, integral: bool = True
) -> SpeedLoop:
    """Speed controllers designed for the robot model."""
    own, most = inertias(d)
    if not min(own) > 0.0:
        raise InputError("speed loop: a driven wheel has no inertia; give inertia or rotor_inertia")
    gains = tuple(symmetrical_optimum(j, 1.0, LATE * period)[0] for j in own)
    sums = tuple(pole_placement(most, 1.0, k / (2.0 * most), 1.0)[1] if integral else 0.0 for k in gains)
    limits = per_wheel(limit, len(own), "torque limit")
    return SpeedLoop(period=_within("speed loop", period), proportional=gains, integral=sums, limit=limits)


def pose_loop(d: Dynamics, inner: SpeedLoop, *, period: float = 0.05, speed: float = 1.0) -> PoseLoop:
    """Pose feedback around speed loops."""
    lag = inertias(d)[1] / min(inner.proportional) + LATE * _within("pose loop", period)
    k_p, k_i = symmetrical_optimum(1.0, 1.0, lag, _APERIODIC)
    if d.kinematics.mobility == 3:
        return PoseLoop(period=period, proportional=k_p, integral=k_i)
    if not is_unicycle(d.kinematics):
        raise InputError("pose loop: expected a platform that allows all motions, or forwards and turning only")
    return PoseLoop(period=period, proportional=k_p, integral=k_i, unicycle=True, distance=abs(speed) / k_p)


def is_unicycle(k: Kinematics) -> bool:
    """Whether a set of wheels allows forwards and turning, and nothing else."""
    return k.mobility == 2 and not np.abs(k.motions[1]).max() > 0.0


# -- A platform and its floor as the arrays of the simulation.


@dataclass(frozen=True, slots=True, kw_only=True)
class Contact:
    """Contact of wheels and floor; defaults are those of rubber or polyurethane on a smooth hard floor."""

    friction: float = 0.6  # μ [1]
    slip_speed: float = 0.01  # m/s, s_0
    creep: float = 0.0  # c [1]: slip over rolling speed at which the straight line meets μN
    turnround: float = 1e-3  # m/s, in which dry friction of axles, rollers and casters reverses


_KINDS = {"motor": 0.0, "free": 1.0, "blocked": 2.0}


@dataclass(frozen=True, slots=True, eq=False)
class Arrays:
    """Wheels, casters, platform and floor as in ``kernel``; inertia and Coriolis matrix without the wheels."""

    W: Array
    K: Array
    B: Array
    M: Array  # (3, 3) kg, kg*m, kg*m^2
    C: Array  # (3, 3), at 1 rad/s
    lever: float  # m, farthest contact point


def arrays(platform: Platform, misjudged: Misjudged, contact: Contact, ground: Ground) -> Arrays:
    """The actual platform and its floor as arrays.

    Wheel loads are those without a force at the floor [N], less what forces ahead and to the left at 1 m take [1/m].
    """
    if np.ndim(ground.slope) or np.ndim(ground.uphill):
        raise InputError("following: expected one slope for the whole path")
    p, n, weight = platform, len(platform.wheels), platform.mass * ground.gravity
    pull = ground.gravity * math.sin(ground.slope)
    free = -pull * math.cos(ground.uphill), -pull * math.sin(ground.uphill)  # sliding down: the floor holds nothing
    N0 = contact_loads(p, ground=ground, accelerated=free)
    S = [(N0 - contact_loads(p, ground=ground, accelerated=(free[0] + (k == 0), free[1] + (k == 1))))
         / (p.mass * p.height or math.inf) for k in range(2)]  # fmt: skip
    strength = per_wheel(misjudged.motor, n, "misjudged motor")
    W, K = np.zeros((n, at.COLUMNS)), np.zeros((len(p.casters), at.CASTER_COLUMNS))
    for i, w in enumerate(p.wheels):
        inertia, along = w.inertia + w.rotor_inertia, w.heading + w.roller_angle
        if w.drive != "blocked" and not inertia > 0.0:
            raise InputError(f"following: wheel {i + 1} has no inertia; give inertia or rotor_inertia")
        if w.slides:
            raise InputError("following: paths of skid wheels are not followed; expected mecanum, omni or fixed wheels")
        if not w.held and not w.roller_resistance < contact.friction:
            raise InputError(
                f"following: the rollers of wheel {i + 1} resist by {w.roller_resistance:g} of the load, "
                f"no less than the floor's friction, {contact.friction:g}"
            )
        c, s = math.cos(along), math.sin(along)
        W[i] = (
            c, s, w.x * s - w.y * c, -s, c, w.x * c + w.y * s,
            w.radius * math.cos(w.roller_angle), w.radius * math.sin(w.roller_angle), w.radius, inertia or 1.0,
            w.rolling_resistance, w.roller_resistance, w.friction, float(w.held), _KINDS[w.drive],
            N0[i], S[0][i], S[1][i], 1.0 + strength[i],
        )  # fmt: skip
    for j, caster in enumerate(p.casters):
        loads = N0[n + j], S[0][n + j], S[1][n + j]
        K[j, : at.CASTER_FX] = caster.x, caster.y, caster.rolling_resistance, *loads
    B = np.zeros(at.TURNROUND + 1)
    B[: at.HEIGHT + 1] = p.x, p.y, weight, weight * math.sin(ground.slope), ground.uphill, p.height
    B[at.FRICTION :] = contact.friction, contact.slip_speed, contact.creep, contact.turnround
    M = eq.mass_matrix(p.mass, p.inertia + p.mass * (p.x**2 + p.y**2), p.x, p.y)
    C = eq.coriolis_matrix(1.0, p.mass, p.x, p.y)
    return Arrays(W, K, B, np.asarray(M, float), np.asarray(C, float), max(math.hypot(*q) for q in p.contacts))


def first_state(a: Arrays, posture: Array, velocity: Array) -> Array:
    """The state of a platform that rolls without slip."""
    turning = a.W[:, at.AX : at.AT + 1] @ velocity / a.W[:, at.RA] * (a.W[:, at.KIND] != 2.0)
    return np.concatenate([posture, velocity, turning, np.zeros(at.TALLIES)])


# -- Simulation of a platform that follows a trajectory: planner, robot model, wheel controllers, actual platform.
#
# The robot model turns the trajectory into wheel speeds, (32), and when it is the dynamic one into torques as well,
# (49)-(59), that are fed forward; the kinematic one leaves torque to the speed loops. Poses are fed back where a
# pose loop is given; else the platform runs open-loop on its wheels' reference speeds. The plant is a rigid body
# with three degrees of freedom on wheels that turn and slip (see ``kernel``), with the figures that the model
# misjudges. Wheel loads follow the forces at the floor at every instant.
#
# Assumed: current loops are ideal, encoders and poses exact; a torque responds to the sample of one period before;
# rollers have no inertia and no gaps; the floor is flat; wheels are equally stiff (see ``platform.contact_loads``).


Model = Literal["kinematic", "dynamic"]

_MOST = 1_000_000  # samples
_TOLERANCE = 1e-5  # m/s, of a step in time
_WITHIN = 0.3  # of the speeds in which friction reverses: a coarser step could oscillate across them
_FED = 1.5  # periods from a sample to the middle of the period in which its torque acts


@dataclass(frozen=True, slots=True, eq=False)
class Planned:
    """A trajectory at k instants."""

    time: Array  # (k,) s
    posture: Array  # (3, k): m, m, rad
    velocity: Array  # (3, k), in the world: m/s, m/s, rad/s
    acceleration: Array  # (3, k), in the world

    def in_robot(self) -> tuple[Array, Array]:
        """Velocity and its rate of change in the robot's frame, (3, k) both."""
        return seen_by_robot(self.posture[2], self.velocity, self.acceleration)


@dataclass(frozen=True, slots=True, eq=False)
class Followed:
    """Motion of a platform at k instants, N wheels; torques and limits of wheels without a motor are 0."""

    planned: Planned
    posture: Array  # (3, k), in the world: m, m, rad
    velocity: Array  # (3, k), in the robot's frame: m/s, m/s, rad/s
    speeds: Array  # (N, k) rad/s, of the wheels
    torque: Array  # (N, k) N*m, of the motors at the wheels, from each instant to the next
    slip: Array  # (N, k) m/s
    load: Array  # (N, k) N
    traction: Array  # (N, k) N, size of the force on the floor
    limited: Array  # (N,): share of the samples at which the controller was at its limit
    work: Array  # (k,) J, done by motors and weight
    lost: Array  # (4, k) J: by slip, wheels' and rollers' resistance, casters
    kinetic: Array  # (k,) J
    friction: float  # μ


def sampled(trajectory: Trajectory, time: Any) -> Planned:
    """A trajectory at instants; at rest before its start and after its end.

    Velocity and acceleration are linear within a piece, the posture a cubic by its ends and their velocities.
    """
    instants: Array = np.asarray(time, dtype=np.float64)
    n, q = trajectory.places(instants)
    q = np.clip(q, 0.0, 1.0)
    v, w = np.moveaxis(trajectory.velocity[:, n], -1, 0)
    inside = (instants <= trajectory.time[-1, 1]) & (instants >= 0.0)
    rates = [v + q * (w - v), (1.0 - q) * trajectory.acceleration[:, n, 0] + q * trajectory.acceleration[:, n, 1]]
    return Planned(instants, trajectory.at(instants), *(np.where(inside, rate, 0.0) for rate in rates))


def follow(
    trajectory: Trajectory,
    platform: Platform,
    *,
    model: Model = "dynamic",
    misjudged: Misjudged = EXACT,
    contact: Contact | None = None,
    speeds: SpeedLoop | None = None,
    poses: PoseLoop | None = None,
    ground: Ground = LEVEL,
    tolerance: float = _TOLERANCE,
) -> Followed:
    """Simulate a platform along a trajectory.

    Parameters
    ----------
    trajectory
        Of the planner; the platform starts on it, at its velocity.
    platform
        As the robot model knows it.
    model
        Kinematic: wheel speeds. Dynamic: torques fed forward as well.
    misjudged
        Figures of the actual platform that differ.
    contact
        Floor and wheels.
    speeds, poses
        Controllers; by default speed loops of 1 ms without a limit, and no pose feedback.
    ground
        The floor; one slope for the whole path.
    tolerance
        Of a step in time [m/s].

    Returns
    -------
    Followed
        At the samples of the speed loops.

    Raises
    ------
    InputError
        When the wheels do not allow the trajectory, a figure cannot be computed with, or a loop is unstable.
    """
    d, contact = dynamics(platform), contact or Contact()
    for rates, what in zip(trajectory.in_robot(), ("velocity", "acceleration"), strict=True):
        check_allowed(d.kinematics, columns(rates, 3, f"{what} of the trajectory"), f"{what} of the trajectory")
    speeds = speeds or speed_loop(d)
    if len(speeds.proportional) != (n := len(d.kinematics.driven)):
        raise InputError(f"speed loop: expected gains of {n} driven wheels, got {len(speeds.proportional)}")
    if poses and not (is_unicycle(d.kinematics) if poses.unicycle else d.kinematics.mobility == 3):
        raise InputError("pose loop: it does not fit the motions that this platform allows")
    a = arrays(actual(platform, misjudged), misjudged, contact, ground)
    count = math.floor(trajectory.total / speeds.period + 1e-9) + 1
    if not 2 <= count <= _MOST:
        raise InputError(f"following: expected 2 to {_MOST} samples, got {count} of {speeds.period:g} s in "
                         f"{trajectory.total:g} s")  # fmt: skip
    plan = sampled(trajectory, np.arange(count) * speeds.period)
    fed = np.zeros((count + 1, len(platform.wheels)))
    if model == "dynamic":
        late = np.concatenate([plan.time[:1] - speeds.period, plan.time]) + _FED * speeds.period
        ahead, allowed = sampled(trajectory, late), d.kinematics.motions @ np.linalg.pinv(d.kinematics.motions)
        # between the ends of a piece a held wheel would slide by rounding
        eta, rate = (map_columns(allowed, motion) for motion in ahead.in_robot())
        fed[:, d.kinematics.driven] = wheel_torques(d, Moving(eta, rate, ahead.posture[2], ground)).T
    start = first_state(a, plan.posture[:, 0], plan.in_robot()[0][:, 0])
    return simulated(a, d, plan, speeds, poses, fed, start, tolerance)


def simulated(a: Arrays, d: Dynamics, plan: Planned, speeds: SpeedLoop, poses: PoseLoop | None, fed: Array,
              start: Array, tolerance: float) -> Followed:  # fmt: skip
    """Run the machine code, and name its results."""
    least = _WITHIN * min(a.B[at.SLIP_SPEED], a.B[at.TURNROUND])
    n, count, wheels = len(a.W), len(plan.time), list(d.kinematics.driven)
    gains, P = np.zeros((n, 3)), np.zeros(7)
    gains[wheels] = np.array([speeds.proportional, speeds.integral, speeds.limit]).T
    if poses is not None:
        P[:4] = 2.0 if poses.unicycle else 1.0, round(poses.period / speeds.period), poses.proportional, poses.integral
        P[at.K_X], P[at.K_Y], P[at.APERIODIC] = poses.proportional, poses.distance**-2, 2.0 / poses.distance
    rows, floor, applied = np.zeros((count, len(start))), np.zeros((count, 3, n)), np.zeros((count, n))
    limited, torque = np.zeros(n), np.clip(fed[0], -gains[:, 2], gains[:, 2])
    S = d.kinematics.motions
    eta = np.ascontiguousarray(map_columns(S @ np.linalg.pinv(S), plan.in_robot()[0]).T)
    done = machine_code(at.KERNEL)(
        a.W, a.K, a.B, a.C, a.M, gains, d.kinematics.E, P, np.ascontiguousarray(plan.posture.T), eta, fed[1:], start,
        torque, speeds.period, a.lever, min(tolerance, least), np.zeros((n, at.WORK)), np.zeros((3, 3)),
        np.zeros((7, len(start))), np.zeros(9 + 2 * n), rows, floor, applied, limited,
    )  # fmt: skip
    if done < count:
        raise InputError(f"following: speeds diverge at {plan.time[done]:.6g} s; check torques, gains and periods")
    y = rows.T
    velocity, turned = y[3:6], y[6 : 6 + n]
    kinetic = (np.einsum("ik,ij,jk->k", velocity, a.M, velocity) + a.W[:, at.J] @ turned**2) / 2.0
    slip, load, traction = floor.transpose(1, 2, 0)
    return Followed(plan, y[:3], velocity, turned, applied.T, slip, load, traction, limited / (count - 1), y[6 + n],
                    y[7 + n :], kinetic, float(a.B[at.FRICTION]))  # fmt: skip


# -- Deviation of a platform from its desired posture.
#
# Position and heading are compared at the same time. Along and across are relative to the direction of the desired
# motion; at rest, the last one.


@dataclass(frozen=True, slots=True, eq=False)
class Deviation:
    """Actual less desired posture at k instants."""

    time: Array  # (k,) s
    travel: Array  # (k,) m, along the desired path
    turned: Array  # (k,) rad, desired, all turns added up
    position: Array  # (k,) m, distance
    along: Array  # (k,) m, above 0: ahead
    across: Array  # (k,) m, above 0: to the left
    heading: Array  # (k,) rad


@dataclass(frozen=True, slots=True)
class Extreme:
    """A largest magnitude, with its time and place."""

    title: str
    value: float  # SI
    kind: str
    unit: str  # of the trade
    time: float  # s
    travel: float  # m, along the desired path


def deviation(f: Followed) -> Deviation:
    """Deviation of a platform from its desired posture."""
    planned, off = f.planned.posture, f.posture - f.planned.posture
    steps = np.abs(np.diff(planned[2], prepend=planned[2, 0]))
    travel = np.cumsum(np.hypot(*np.diff(planned[:2], axis=1, prepend=planned[:2, :1])))
    velocity = f.planned.velocity
    size = np.hypot(velocity[0], velocity[1])
    moves, x, y = size > 1e-9 * (size.max() or 1.0), np.ones_like(size), np.zeros_like(size)
    if moves.any():  # at rest the last direction, before all motion the first, and x where there is none
        last = np.maximum.accumulate(np.where(moves, np.arange(len(size)), -1))
        last[last < 0] = int(moves.argmax())
        x, y = velocity[:2, last] / size[last]
    along, across = x * off[0] + y * off[1], x * off[1] - y * off[0]
    return Deviation(f.planned.time, travel, np.cumsum(steps), np.hypot(off[0], off[1]), along, across, off[2])


def extremes(f: Followed) -> tuple[Extreme, ...]:
    """Largest deviations, slip, torque and use of the grip, with their times and places."""
    d = deviation(f)
    grip_use = np.divide(f.traction, f.friction * f.load, out=np.zeros_like(f.load), where=f.load > 0.0)
    rows = (
        ("position", d.position, "length", "m"),
        ("along the path", d.along, "length", "m"),
        ("across the path", d.across, "length", "m"),
        ("heading", d.heading, "angle", "deg"),
        ("slip", f.slip, "speed", "mm/s"),
        ("torque of a wheel", f.torque, "torque", "N*m"),
        ("use of the floor's grip", grip_use, "dimensionless", "%"),
    )
    largest = []
    for title, values, kind, unit in rows:
        worst = values if values.ndim == 1 else values[np.abs(values).argmax(axis=0), np.arange(values.shape[1])]
        k = int(np.abs(worst).argmax())
        largest.append(Extreme(title, float(worst[k]), kind, unit, float(d.time[k]), float(d.travel[k])))
    return tuple(largest)


class FollowingRun(NamedTuple):
    """Robot model and controllers of one simulation."""

    model: Model
    integral: bool  # speed loops PI, or plain P
    poses: bool  # fed back
    exact: bool  # the model knows the platform

    @property
    def words(self) -> tuple[str, str, str, str]:
        """Robot model, speed loops, poses, and knowledge of the model."""
        loop, poses = "PI" if self.integral else "P", "fed back" if self.poses else "open loop"
        return self.model, loop, poses, "all" if self.exact else "not all"


_MODELS: tuple[Model, ...] = ("kinematic", "dynamic")
_COMPARED = (
    *(FollowingRun(model, integral, False, exact) for exact in (True, False) for integral in (True, False)
      for model in _MODELS),
    *(FollowingRun(model, True, True, False) for model in _MODELS),
)  # fmt: skip


def follow_runs(driving: Driving, drive: DriveSet | None) -> dict[str, Followed]:
    """The runs by name: kinematic and dynamic model, open-loop, and the dynamic one with pose feedback where possible.

    Where the spec compares, also both models with P and PI loops, with and without misjudged figures. A path on which
    the platform tips over is refused: contact is simulated for wheels on the floor.
    """
    d, section = dynamics_of(driving.spec), _section(driving)
    if section.height_known:
        least = least_margin(d.platform, driving.trajectory, ground_of(driving.spec))
        if least.value < 0.0:
            raise InputError(
                f"{driving.spec.where(('platform', 'centre_of_mass'))}: the platform tips over at "
                f"{show(least.time, 's', 'time')} of its path, {show(-least.value, 'mm', 'length')} beyond its wheels; "
                "expected one that can be followed: a lower centre of mass, or smaller platform.limits"
            )
    following, k = section.following, d.kinematics
    steered, integral = k.mobility == 3 or is_unicycle(k), following.speed_loop == "PI"
    if following.compare:
        cases = {", ".join(case.words): case for case in _COMPARED if steered or not case.poses}
    else:
        cases = {f"{model} model": FollowingRun(model, integral, False, False) for model in _MODELS}
        if steered:
            cases["poses fed back"] = FollowingRun("dynamic", integral, True, False)
    return {name: follow_case(driving, drive, case) for name, case in cases.items()}


def follow_case(
    driving: Driving, drive: DriveSet | None, case: FollowingRun, misjudged: Misjudged | None = None
) -> Followed:
    """Simulate one run; its speed loops are designed, with the gains that the spec gives."""
    section, load = _section(driving), driving.spec.load
    assert isinstance(load, WheeledVehicle)
    following, wheel = section.following, wheel_drive(section.following, drive)
    d = dynamics_of(driving.spec, wheel.inertia)
    speeds = speed_loop(d, period=following.period, limit=wheel.torque, integral=case.integral)
    if following.speed_gain is not None:
        speeds = replace(speeds, proportional=(following.speed_gain,) * len(speeds.proportional))
    if following.speed_integral is not None and case.integral:
        speeds = replace(speeds, integral=(following.speed_integral,) * len(speeds.integral))
    x, y, _ = driving.trajectory.velocity
    fastest = float((x**2 + y**2).max() ** 0.5)
    floor = Contact(slip_speed=following.slip_speed, creep=following.creep)
    if load.friction_coefficient is not None:
        floor = replace(floor, friction=load.friction_coefficient)
    return follow(
        driving.trajectory,
        d.platform,
        model=case.model,
        misjudged=EXACT if case.exact else misjudged or section.misjudged.record,
        contact=floor,
        speeds=speeds,
        poses=pose_loop(d, speeds, period=following.pose_period, speed=fastest) if case.poses else None,
        ground=ground_of(driving.spec),
    )


def runs_of_figure(runs: Mapping[str, Followed]) -> dict[str, Followed]:
    """The runs that one figure shows: of several loops both models with plain ones, poses not fed back."""
    names = {(case.model, case.exact): ", ".join(case.words) for case in _COMPARED if not (case.integral or case.poses)}
    if not set(names.values()) <= set(runs):
        return dict(runs)
    return {f"{model}, knows {'all' if exact else 'not all'}": runs[name] for (model, exact), name in names.items()}


def _section(driving: Driving) -> PlatformSection:
    section = driving.spec.platform
    assert section is not None
    return section


class AtWheel(NamedTuple):
    """A drive as its wheel has it."""

    inertia: float  # kg*m^2, of its rotor
    torque: float  # N*m, the largest; infinite: none is known


def wheel_drive(following: Following, drive: DriveSet | None) -> AtWheel:
    """Inertia and largest torque of a drive at its wheel: as the spec gives them, else of the drive as far as known."""
    inertia, torque = 0.0, math.inf
    if drive is not None:
        inertia = drive.rotors_at_load
        peak = drive.controller.peak_current if drive.controller else math.inf
        by_motor = peak * drive.motor.torque_constant * drive.gearhead.ratio * drive.gearhead.efficiency
        limits = [limit for limit in (by_motor, drive.gearhead.intermittent_torque) if limit == limit]
        torque = min(limits, default=math.inf) * drive.belt_ratio * drive.belt_efficiency
    return AtWheel(
        inertia if following.rotor_inertia is None else following.rotor_inertia,
        torque if following.torque_limit is None else following.torque_limit,
    )


def assumed(driving: Driving, drive: DriveSet | None) -> list[str]:
    """Assumptions of the runs, as sentences."""
    following = _section(driving).following
    wheel = wheel_drive(following, drive)
    limited = math.isfinite(wheel.torque)
    return sentences("drivesizer.control", "path following", given=following, wheel=wheel, limited=limited)
