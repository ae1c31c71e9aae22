"""Force that the floor must transmit at each wheel, its limit, and a trajectory as load cycles of the driven wheels."""

from __future__ import annotations

import math
from math import nan

import numpy as np

from drivesizer.errors import InputError
from drivesizer.physics.load_cycle import LoadCycle, OwnLimit, end_times
from drivesizer.platform import dynamics
from drivesizer.platform import equations as eq
from drivesizer.platform.dynamics import LEVEL, Dynamics, Ground, Moving, centre_acceleration, contact_loads
from drivesizer.platform.kinematics import map_columns
from drivesizer.platform.matrix_equation import Array
from drivesizer.platform.stability import Moment, lift_off_acceleration
from drivesizer.platform.trajectory import Trajectory, finer

# -- Force that the floor must transmit at each wheel, and its limit.
#
# A wheel's torque reaches the floor as a force along its roller's axis, :math:`F = (τ - J \ddot ϕ - C_{rr} N_0 r -
# T_f) / (r \cos γ)`: what is left after the wheel and its rotor have gained speed and it has rolled, N_0 being its
# load without acceleration. A wheel without rollers also holds sideways, and both forces together are a wheel's. It
# slips when they exceed μ times what it carries at that moment. A wheel without motor, and a caster, carry weight
# and transmit nothing of the drive; so two driven wheels of four have half of the grip.
#
# The torques are those of ``wheel_torques``: shared as the motors are taken to share, not as would suit the floor
# best. What several wheels hold sideways together is shared by least squares.
#
# With the motion fixed, force and load are straight in an acceleration, and over :math:`\cos s` in :math:`\tan s` of
# a slope; so the limit is a root of a quadratic.


_DIRECTIONS = 360  # of the worst: forces are off by 1 - cos 0.5°, 4e-5, at most
_NOTHING = 1e-9  # of the largest force: rounding


def floor_forces(d: Dynamics, m: Moving) -> Array:
    """Force of the floor on each wheel along its roller's axis, and sideways where it is held [N]; shape (2, N, ...).

    A positive torque pulls in the positive direction of the axis.

    Parameters
    ----------
    d
        The platform.
    m
        Its motion.

    Returns
    -------
    array
        Along the roller's axis, and sideways [N], shape (2, N, ...).

    Raises
    ------
    InputError
        When the wheels do not allow the motion.
    """
    k, wheels, force = d.kinematics, d.kinematics.wheels, dynamics.required_force(d, m)
    driven, torque = list(k.driven), map_columns(d.distribution, force)
    rest = force - map_columns(k.E[driven].T, torque)  # what is held, and does no work
    own: Array = np.array([[w.inertia + w.rotor_inertia] for w in wheels])
    net = -map_columns(np.asarray(own * k.E), np.asarray(np.broadcast_to(m.eta_dot, rest.shape)))
    net[driven] += torque
    carried = contact_loads(d.platform, m.facing, m.ground, samples=m.towards.shape[1:])
    net -= dynamics.own_rolling(d, carried) * dynamics.signs(k.E, m.towards, k.reach)
    across = (slice(None),) + (None,) * (net.ndim - 1)
    cos = np.array([math.cos(w.roller_angle) for w in wheels])
    found = np.stack([net / (np.array([w.radius for w in wheels]) * cos)[across], np.zeros_like(net)])
    if len(k.held):
        sideways = [i for i, w in enumerate(wheels) if w.held]
        blocked = [i for i, w in enumerate(wheels) if w.drive == "blocked"]
        holding = map_columns(np.asarray(np.linalg.pinv(k.held.T)), rest)
        found[1, sideways] = holding[: len(sideways)]
        found[0, blocked] = holding[len(sideways) :][: len(blocked)] / cos[blocked][across]
    return found


def worst_friction(d: Dynamics, trajectory: Trajectory, ground: Ground = LEVEL) -> Moment:
    """The largest coefficient of friction that a trajectory needs, at which wheel, and when.

    Parameters
    ----------
    d
        The platform.
    trajectory
        In the world.
    ground
        The floor, the same everywhere.

    Returns
    -------
    Moment
        Coefficient [1], time [s] and number of the wheel.

    Raises
    ------
    InputError
        When the wheels do not allow the motion.
    """
    fine = finer(trajectory)
    m = Moving(*fine.in_robot(), fine.posture[2], ground)
    force = np.hypot(*floor_forces(d, m))
    carried = contact_loads(d.platform, m.facing, ground, centre_acceleration(d.platform, m), samples=force.shape[1:])
    load, pulls = carried[: len(force)], force > _NOTHING * d.platform.mass * ground.gravity
    needed = np.where(load > 0.0, force / np.where(load > 0.0, load, 1.0), math.inf)  # none carried: no friction does
    found = np.where(pulls, needed, 0.0)
    wheel, piece, side = (int(i) for i in np.unravel_index(found.argmax(), found.shape))
    return Moment(float(found[wheel, piece, side]), float(fine.time[piece, side]), wheel + 1)


# --- the largest that the floor transmits -----------------------------------------------------------------------------


def translations(d: Dynamics) -> Array:
    """Angles in which a platform can move without turning [rad]: all around in steps of 1°, or to and fro.

    Raises
    ------
    InputError
        When it can in none.
    """
    held = d.kinematics.held[:, :2]
    values, vectors = np.linalg.svd(held, full_matrices=True)[1:] if len(held) else (np.zeros(0), np.eye(2))
    left = vectors[int((values > 1e-6).sum()) :]
    if len(left) == 2:
        return np.asarray(np.arange(_DIRECTIONS) * (2.0 * math.pi / _DIRECTIONS))
    if len(left) == 0:
        raise InputError("platform: its wheels let it move in no direction without turning")
    angle = math.atan2(left[0, 1], left[0, 0])
    return np.array([angle, angle + math.pi])


def grip_acceleration(
    d: Dynamics, friction: float, direction: float | None = None, *, slope: float = 0.0, gravity: float = 9.80665
) -> float:
    """Largest acceleration from rest, up a slope, before a wheel slips or something lifts off [m/s^2].

    Parameters
    ----------
    d
        The platform.
    friction
        Coefficient between wheels and floor, μ.
    direction
        Of the acceleration in the robot's frame [rad]; the worst of all that the wheels allow where it is not given.
    slope
        Of the floor, rising in that direction [rad].
    gravity
        [m/s^2].

    Returns
    -------
    float
        Acceleration [m/s^2].

    Raises
    ------
    InputError
        When the wheels do not allow the direction, or none.
    """
    angles = translations(d) if direction is None else np.array([direction])
    unit = np.array([np.cos(angles), np.sin(angles), 0.0 * angles])
    floor = Ground(slope=slope, gravity=gravity)  # uphill is where the platform goes: turned to it by its heading

    def at(share: float) -> tuple[Array, Array]:
        force = floor_forces(d, Moving(0.0 * unit, share * unit, -angles, floor, unit))
        return force, contact_loads(d.platform, -angles, floor, share * unit[:2])[: force.shape[1]]

    anywhere = len(angles) == _DIRECTIONS
    level = min(lift_off_acceleration(d.platform, None if anywhere else float(a), gravity) for a in angles[:2])
    lifts = max(level * math.cos(slope) - gravity * math.sin(slope), 0.0)
    return min(_first_slip(at(0.0), at(1.0), friction), lifts)


def grip_slope(d: Dynamics, friction: float, uphill: float | None = None) -> float:
    """Steepest slope that a platform climbs at a steady speed before a wheel slips, or something lifts off [rad].

    Parameters
    ----------
    d
        The platform.
    friction
        Coefficient between wheels and floor, μ.
    uphill
        In the robot's frame [rad]; the worst of all directions where it is not given. Where its wheels do not allow
        that direction it is at rest.

    Returns
    -------
    float
        Slope [rad]; 0 where none is held.
    """
    angles = np.arange(_DIRECTIONS) * (2.0 * math.pi / _DIRECTIONS) if uphill is None else np.array([uphill])
    unit = np.array([np.cos(angles), np.sin(angles), 0.0 * angles])
    climbs = np.where(
        (np.abs(d.kinematics.held @ unit) < 1e-6).all(axis=0), unit, 0.0
    )  # in directions that wheels allow
    lifts = lift_off_acceleration(d.platform, uphill, 1.0)
    reference = min(0.1, lifts / 2.0)  # any slope on which every contact carries will do

    def at(tangent: float) -> tuple[Array, Array]:
        floor = Ground(slope=math.atan(tangent))
        force = floor_forces(d, Moving(0.0 * unit, 0.0 * unit, -angles, floor, climbs))
        loads = contact_loads(d.platform, -angles, floor)[: force.shape[1]]
        return force / math.cos(floor.slope), loads / math.cos(floor.slope)

    if reference == 0.0:
        return 0.0
    return math.atan(min(reference * _first_slip(at(0.0), at(reference), friction), lifts))


def _first_slip(before: tuple[Array, Array], after: tuple[Array, Array], friction: float) -> float:
    """Place where force first exceeds μ times load: both straight from ``before`` at 0 to ``after`` at 1; 0: at once.

    |A + B t| <= C + D t is a quadratic; its first root beyond 0 in the form that stays finite when it is none.
    """
    A, C = before[0], friction * before[1]
    B, D = after[0] - A, friction * after[1] - C
    q0, q1, q2 = (A * A).sum(axis=0) - C * C, (A * B).sum(axis=0) - C * D, (B * B).sum(axis=0) - D * D
    scale = np.abs(C).max()
    pulls = np.hypot(*A) + np.hypot(*B) > _NOTHING * scale
    if friction == 0.0 and pulls.any():
        return 0.0
    if (pulls & ((q0 > _NOTHING * scale**2) | (C < 0.0))).any():
        return 0.0
    root = q1 + np.sqrt(np.maximum(q1 * q1 - q2 * q0, 0.0))
    ends = pulls & (root > 0.0) & (q1 * q1 - q2 * q0 >= 0.0)
    return float((np.maximum(-q0[ends], 0.0) / root[ends]).min(initial=math.inf))


# -- A trajectory of a platform as load cycles, one for each driven wheel.
#
# Torques are those of ``dynamics`` without the wheels' own rotors, which the drive model adds. Resistances turn
# round with each wheel and roller, so pieces are cut where one does; within a piece they have the sign of the motion
# in it.
#
# A limit of the load's own is traction: what the floor must transmit, see ``grip``, against μ N; N is what the wheel
# carries at that moment, acceleration and slope included.
#
# The inertia of a cycle is torque over acceleration where all wheels act together: of the motions that turn the
# wheels alike in torque and acceleration (eigenvectors of the inertia in the wheels' space), the largest in which
# the wheel turns. Straight ahead on N equal wheels it is :math:`J_w + m r^2 / N`, as of a vehicle.


_ROUNDING = 1e-9  # of the largest speed or torque of all wheels: below it there is none
_TAKES_PART = 1e-3  # of the wheel that turns most


def wheel_cycles(
    d: Dynamics, trajectory: Trajectory, ground: Ground = LEVEL, *, friction: float | None = None
) -> tuple[LoadCycle, ...]:
    """The load cycle of each driven wheel, in the order of the wheels.

    Parameters
    ----------
    d
        The platform.
    trajectory
        Its motion; one that is repeated starts and ends at rest.
    ground
        The floor; where its slope is a column, at both ends of each piece, shape (n, 2).
    friction
        Coefficient μ between wheel and floor [1]; without it the limit of traction is unknown.

    Returns
    -------
    tuple of LoadCycle
        One for each driven wheel.

    Raises
    ------
    InputError
        When the wheels do not allow the motion, or a figure cannot be computed with.
    """
    k, top, driven = d.kinematics, dynamics.largest(trajectory), list(d.kinematics.driven)
    dynamics.allowed(k, trajectory)
    durations, parts = [], []
    for part, floor in dynamics.blocks(trajectory, ground):
        m = dynamics.seen(d, part, floor, top)
        torque = dynamics.wheel_torques(d, m, rotors=False)
        speed, gain = (map_columns(k.E[driven], column) for column in (m.eta, m.eta_dot))
        load = contact_loads(d.platform, m.facing, m.ground, centre_acceleration(d.platform, m))[driven]
        force = floor_forces(d, m)
        durations.append(m.duration)
        parts.append(np.stack([torque, speed, gain, np.maximum(load, 0.0), np.hypot(*force)[driven]]))
    duration, columns = np.concatenate(durations), np.concatenate(parts, axis=2)
    for column in columns[:2]:  # torque and speed without what rounding leaves where there is nothing
        column[np.abs(column) <= _ROUNDING * np.abs(column).max(initial=0.0)] = 0.0
    inertia, time, made = effective_inertia(d), end_times(duration).reshape(-1), []
    for i, place in enumerate(k.driven):
        torque, speed, gain, carried, force = columns[:, i]
        with np.errstate(divide="ignore", invalid="ignore"):
            worst = int(np.nan_to_num(force / carried, nan=0.0, posinf=np.inf).argmax())
        held = nan if friction is None else friction * float(carried.reshape(-1)[worst])
        grip = OwnLimit("traction", float(force.reshape(-1)[worst]), held, float(time[worst]))
        radius, name = k.wheels[place].radius, f"wheel {place + 1}"
        made.append(LoadCycle(name, duration, speed, gain, torque, float(inertia[i]), (grip,), radius).split())
    return tuple(made)


def effective_inertia(d: Dynamics) -> Array:
    """Torque over acceleration of each driven wheel where all act together, without their rotors [kg*m^2]; shape (n,).

    Parameters
    ----------
    d
        The platform.
    """
    k, driven = d.kinematics, list(d.kinematics.driven)
    E = k.E[driven]
    M = d.M - E.T @ (np.array([k.wheels[i].rotor_inertia for i in driven])[:, None] * E)
    values, modes = np.linalg.eigh(k.K_plus.T @ M @ k.K_plus)
    modes = modes[:, values > _NOTHING * values[-1]]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = (eq.wheel_space_inertia(d.distribution, M, k.K_plus) @ modes) / modes
    turns = np.abs(modes) > _TAKES_PART * np.abs(modes).max(axis=0)
    most: Array = np.where(turns, ratio, -np.inf).max(axis=1)
    return np.asarray(np.where(most > 0.0, most, nan))
