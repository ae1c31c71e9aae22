"""Tipping, lifting off and slipping of a platform, and a trajectory as load cycles of its driven wheels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from drivesizer.errors import InputError
from drivesizer.physics.load_cycle import LoadCycle, OwnLimit, end_times
from drivesizer.platform import dynamics
from drivesizer.platform import equations as eq
from drivesizer.platform.dynamics import (
    LEVEL,
    Dynamics,
    Ground,
    Moving,
    centre_acceleration,
    contact_loads,
    weight_along,
)
from drivesizer.platform.equations import Array
from drivesizer.platform.kinematics import Platform, map_columns
from drivesizer.platform.trajectory import Trajectory, finer

# -- Distance of a platform from tipping over, and from lifting a wheel.
#
# It tips about an edge of the hull of its contact points, casters among them, when the line of weight and inertia
# from the centre of mass meets the floor beyond it. That point is :math:`x_c - h f / N` (zero moment point), f the
# force along the floor that the motion needs and N the weight across it. A wheel of a stiff frame on a stiff floor
# may lift before: ``contact_loads`` falls straight with the acceleration. Standing on a slope s is as accelerating
# uphill with :math:`g \tan s` on a level floor. What turns with the wheels is not counted; its moment is small
# beside m a h.


_GRID = 10**9  # lines in the platform's size, on which its contacts are put to find their hull
_FLAT = 1e-6  # of the platform's size: contact points that lie nearer to one line hold nothing up


class TippingEdge(NamedTuple):
    """A line about which the platform can tip."""

    contacts: tuple[int, int]  # wheels, then casters, counted from 1
    distance: float  # m, of the centre of mass from the vertical plane over it; below 0 it has tipped
    angle: float  # rad, of a slope at which it tips about it
    outward: float  # rad, direction in the robot's frame


# --- support polygon --------------------------------------------------------------------------------------------------


def support_polygon(platform: Platform) -> tuple[int, ...]:
    """The contacts that are the hull of all, counterclockwise; places from 0."""
    return _hull(platform.contacts)


@lru_cache(maxsize=8)
def _hull(contacts: tuple[tuple[float, float], ...]) -> tuple[int, ...]:
    scale = max(math.dist(a, b) for a in contacts for b in contacts) or 1.0
    places = [(round(x / scale * _GRID), round(y / scale * _GRID)) for x, y in contacts]
    order = sorted(range(len(places)), key=lambda i: places[i])
    lower, upper = _chain(places, order), _chain(places, order[::-1])
    hull = tuple(lower[:-1] + upper[:-1])
    area = sum(_turn(places[hull[0]], places[i], places[j]) for i, j in pairwise(hull)) if hull else 0
    if area <= _FLAT * _GRID**2:
        raise InputError("platform: its contact points lie on one line, so nothing keeps it upright; give its casters")
    return hull


def _chain(places: list[tuple[int, int]], order: list[int]) -> list[int]:
    """One half of the hull (Andrew's monotone chain), on a grid, where no turn is lost to rounding."""
    hull: list[int] = []
    for i in order:
        while len(hull) > 1 and _turn(places[hull[-2]], places[hull[-1]], places[i]) <= 0:
            hull.pop()
        hull.append(i)
    return hull


def _turn(a: tuple[int, int], b: tuple[int, int], c: tuple[int, int]) -> int:
    """Above 0 where the way from a over b to c turns to the left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


@lru_cache(maxsize=8)
def _outward(contacts: tuple[tuple[float, float], ...]) -> tuple[tuple[int, ...], Array, Array]:
    """Hull, a unit vector outward of each edge (k, 2), and how far out the edge is along it (k,)."""
    hull = _hull(contacts)
    here = np.array(contacts)[list(hull)]
    along = np.roll(here, -1, axis=0) - here
    normal = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.hypot(along[:, 0], along[:, 1])[:, None]
    return hull, normal, (normal * here).sum(axis=1)


def edge_distances(platform: Platform, point: Any) -> Array:
    """Distances of a point inside each edge of the support polygon [m]; shape (edges, ...), below 0 outside."""
    _, normal, out = _outward(platform.contacts)
    place = np.asarray(point, dtype=float)
    return np.asarray(out.reshape(-1, *[1] * (place.ndim - 1)) - np.tensordot(normal, place, axes=1))


def tipping_edges(platform: Platform) -> tuple[TippingEdge, ...]:
    """The edges about which a platform can tip on a level floor, the nearest first."""
    hull, normal, _ = _outward(platform.contacts)
    distance = edge_distances(platform, (platform.x, platform.y))
    edges = zip(hull, (*hull[1:], hull[0]), distance, normal, strict=True)
    tipping = [
        TippingEdge(
            (i + 1, j + 1), float(d), math.atan2(float(d), platform.height), math.atan2(float(n[1]), float(n[0]))
        )
        for i, j, d, n in edges
    ]
    return tuple(sorted(tipping, key=lambda e: e.distance))


# --- the largest that it stands ---------------------------------------------------------------------------------------


def tipping_acceleration(platform: Platform, direction: float | None = None, gravity: float = LEVEL.gravity) -> float:
    """Largest acceleration on a level floor before the platform tips over [m/s^2]; infinite where none does.

    Parameters
    ----------
    platform
        Contact points, mass and centre of mass.
    direction
        Of the acceleration in the robot's frame [rad]; π is braking. The worst of all where it is not given.
    gravity
        [m/s^2].

    Returns
    -------
    float
        Acceleration [m/s^2].

    Raises
    ------
    InputError
        When the contact points lie on one line.

    Examples
    --------
    A box of half length b and height h of the centre of mass, b / h:

    >>> from drivesizer.platform.kinematics import Wheel
    >>> wheels = tuple(Wheel(x=x, y=y, radius=0.1) for x in (-0.3, 0.3) for y in (-0.2, 0.2))
    >>> round(tipping_acceleration(Platform(wheels=wheels, mass=50.0, inertia=3.0, height=0.6), 0.0, 10.0), 9)
    5.0
    """
    return _largest(*_tipping(platform, gravity), direction)


def lift_off_acceleration(platform: Platform, direction: float | None = None, gravity: float = LEVEL.gravity) -> float:
    """Largest acceleration on a level floor before a wheel or caster carries nothing [m/s^2].

    On three contacts both are the same.
    """
    return _largest(*_lifting(platform, gravity), direction)


def _tipping(platform: Platform, gravity: float) -> tuple[Array, Array]:
    """Distance of the platform inside each edge, times gravity, and the share that an acceleration takes off it."""
    _, normal, _ = _outward(platform.contacts)
    inside = edge_distances(platform, (platform.x, platform.y))
    return inside * gravity, platform.height * normal


@lru_cache(maxsize=8)
def _lifting(platform: Platform, gravity: float) -> tuple[Array, Array]:
    """Load of each contact at rest, and the share that an acceleration takes off it."""
    support_polygon(platform)  # on one line nothing keeps it upright
    forward_and_left = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    loads = contact_loads(platform, ground=Ground(gravity=gravity), accelerated=forward_and_left)
    return loads[:, 0], loads[:, 1:] - loads[:, :1]


def carrying(at_rest: Array) -> Array:
    """Whether each contact carries, or each edge of the footing lies outside the centre of mass, beyond rounding."""
    return np.asarray(at_rest > _FLAT * np.abs(at_rest).max())


def used_footing(
    platform: Platform,
    together: Sequence[tuple[float, float | None]],
    *,
    tips: bool = False,
    gravity: float = LEVEL.gravity,
) -> float:
    """Share of what keeps a platform on its wheels that several accelerations take together; above 1 it does not."""
    at_rest, change = (_tipping if tips else _lifting)(platform, gravity)
    fall = sum((size * _falls(change, direction) for size, direction in together), 0.0 * at_rest)
    if not carrying(at_rest).all():
        return math.inf
    return max(float((fall / at_rest).max()), 0.0)


def _falls(change: Array, direction: float | None) -> Array:
    """Decrease of each figure by 1 m/s² in a direction; in the worst direction where none is given."""
    if direction is None:
        return np.asarray(np.hypot(change[:, 0], change[:, 1]))
    return np.asarray(-change @ np.array([math.cos(direction), math.sin(direction)]))


def _largest(at_rest: Array, change: Array, direction: float | None) -> float:
    """From where one of the figures ``at_rest + a change · (cos, sin)`` is below 0, a along or in any direction."""
    falls = _falls(change, direction)
    falling = falls > 1e-12 * np.abs(change).max()
    if (at_rest < -_FLAT * np.abs(at_rest).max()).any():
        return 0.0
    return float(np.maximum(at_rest[falling] / falls[falling], 0.0).min(initial=math.inf))


def tipping_slope(platform: Platform, uphill: float | None = None) -> float:
    """Steepest slope on which a platform at rest does not tip over [rad]."""
    return math.atan(tipping_acceleration(platform, uphill, 1.0))


def lift_off_slope(platform: Platform, uphill: float | None = None) -> float:
    """Steepest slope on which every wheel and caster still carries something [rad]."""
    return math.atan(lift_off_acceleration(platform, uphill, 1.0))


def zero_moment_point(
    platform: Platform, theta: Any = 0.0, ground: Ground = LEVEL, accelerated: Any = (0.0, 0.0)
) -> Array:
    """Point where the floor must push so that the platform does not tip, in the robot's frame [m]; shape (2, ...)."""
    pull = weight_along(platform, theta, ground)[:2]
    lever = platform.height / (platform.mass * ground.gravity * np.cos(ground.slope))
    needed = [platform.mass * np.asarray(a) - p for a, p in zip(accelerated, pull, strict=True)]
    return np.array(
        np.broadcast_arrays(*(c - lever * f for c, f in zip((platform.x, platform.y), needed, strict=True)))
    )


# -- The moments of a trajectory at which a platform is nearest to tipping over, or to lifting a wheel.


class Moment(NamedTuple):
    """The worst moment of a trajectory."""

    value: float
    time: float  # s
    contact: int  # wheel or caster, counted from 1; of an edge its first


def least_load(platform: Platform, trajectory: Trajectory, ground: Ground = LEVEL, *, share: bool = False) -> Moment:
    """The least load of a wheel or caster over a trajectory [N], or as a share of that at rest [1]; when and where."""
    support_polygon(platform)
    fine = finer(trajectory)
    loads = contact_loads(platform, fine.posture[2], ground, centre_acceleration(platform, Moving(*fine.in_robot())))
    at_rest = contact_loads(platform, ground=Ground(gravity=ground.gravity)) if share else None
    return _worst(loads, at_rest, fine, tuple(range(len(loads))))


def least_margin(platform: Platform, trajectory: Trajectory, ground: Ground = LEVEL, *, share: bool = False) -> Moment:
    """The least distance of the zero moment point from the edge of the support polygon, where, and when."""
    fine = finer(trajectory)
    point = zero_moment_point(
        platform, fine.posture[2], ground, centre_acceleration(platform, Moving(*fine.in_robot()))
    )
    at_rest = edge_distances(platform, (platform.x, platform.y)) if share else None
    return _worst(edge_distances(platform, point), at_rest, fine, support_polygon(platform))


def _worst(figures: Array, at_rest: Array | None, trajectory: Trajectory, contacts: tuple[int, ...]) -> Moment:
    """The least of figures over (row, piece, end), or of them as shares of those at rest."""
    if at_rest is not None:
        carries = carrying(at_rest)[:, None, None]
        figures = np.where(carries, figures / np.where(carries, at_rest[:, None, None], 1.0), -math.inf)
    row, piece, side = (int(i) for i in np.unravel_index(figures.argmin(), figures.shape))
    return Moment(float(figures[row, piece, side]), float(trajectory.time[piece, side]), contacts[row] + 1)


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
    """
    rolling = dynamics.rolling(d, m.towards, m.facing, m.ground)
    k, wheels, force = d.kinematics, d.kinematics.wheels, dynamics.required_force(d, m, rolling)
    driven, torque = list(k.driven), map_columns(d.distribution, force)
    rest = force - map_columns(k.E[driven].T, torque)  # what is held, and does no work
    own: Array = np.array([[w.inertia + w.rotor_inertia] for w in wheels])
    net = -map_columns(np.asarray(own * k.E), np.asarray(np.broadcast_to(m.eta_dot, rest.shape)))
    net[driven] += torque
    net -= rolling[1]
    across = (slice(None),) + (None,) * (net.ndim - 1)
    cos = np.array([math.cos(w.roller_angle) for w in wheels])
    forces = np.stack([net / (np.array([w.radius for w in wheels]) * cos)[across], np.zeros_like(net)])
    if len(k.held):
        sideways = [i for i, w in enumerate(wheels) if w.held]
        blocked = [i for i, w in enumerate(wheels) if w.drive == "blocked"]
        holding = map_columns(np.asarray(np.linalg.pinv(k.held.T)), rest)
        forces[1, sideways] = holding[: len(sideways)]
        forces[0, blocked] = holding[len(sideways) :][: len(blocked)] / cos[blocked][across]
    return forces


def worst_friction(d: Dynamics, trajectory: Trajectory, ground: Ground = LEVEL) -> Moment:
    """The largest coefficient of friction that a trajectory needs, at which wheel, and when."""
    fine = finer(trajectory)
    m = Moving(*fine.in_robot(), fine.posture[2], ground)
    force = np.hypot(*floor_forces(d, m))
    carried = contact_loads(d.platform, m.facing, ground, centre_acceleration(d.platform, m), samples=force.shape[1:])
    load, pulls = carried[: len(force)], force > _NOTHING * d.platform.mass * ground.gravity
    needed = np.where(load > 0.0, force / np.where(load > 0.0, load, 1.0), math.inf)  # none carried: no friction does
    friction = np.where(pulls, needed, 0.0)
    wheel, piece, side = (int(i) for i in np.unravel_index(friction.argmax(), friction.shape))
    return Moment(float(friction[wheel, piece, side]), float(fine.time[piece, side]), wheel + 1)


# --- the largest that the floor transmits -----------------------------------------------------------------------------


def translations(d: Dynamics) -> Array:
    """Angles in which a platform can move without turning [rad]: all around in steps of 1°, or to and fro."""
    constraints = d.kinematics.held[:, :2]
    values, vectors = (
        np.linalg.svd(constraints, full_matrices=True)[1:] if len(constraints) else (np.zeros(0), np.eye(2))
    )
    left = vectors[int((values > 1e-6).sum()) :]
    if len(left) == 2:
        return np.asarray(np.arange(_DIRECTIONS) * (2.0 * math.pi / _DIRECTIONS))
    if len(left) == 0:
        raise InputError("platform: its wheels let it move in no direction without turning")
    angle = math.atan2(left[0, 1], left[0, 0])
    return np.array([angle, angle + math.pi])


@lru_cache(maxsize=1024)
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

    # at rest, then gaining speed
    facing, towards, gains = np.tile(-angles, 2), np.tile(unit, 2), np.concatenate([0.0 * unit, unit], axis=1)
    force = floor_forces(d, Moving(0.0 * towards, gains, facing, floor, towards))
    loads = contact_loads(d.platform, facing, floor, gains[:2])[: force.shape[1]]
    before, after = zip(*(np.split(x, 2, axis=-1) for x in (force, loads)), strict=True)
    anywhere = len(angles) == _DIRECTIONS
    level = min(lift_off_acceleration(d.platform, None if anywhere else float(a), gravity) for a in angles[:2])
    lifts = max(level * math.cos(slope) - gravity * math.sin(slope), 0.0)
    return min(_first_slip(before, after, friction), lifts)


@lru_cache(maxsize=1024)
def grip_slope(d: Dynamics, friction: float, uphill: float | None = None) -> float:
    """Steepest slope that a platform climbs at a steady speed before a wheel slips, or something lifts off [rad]."""
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
    """The load cycle of each driven wheel, in the order of the wheels."""
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
    inertia, time, cycles = effective_inertia(d), end_times(duration).reshape(-1), []
    for i, place in enumerate(k.driven):
        torque, speed, gain, carried, force = columns[:, i]
        with np.errstate(divide="ignore", invalid="ignore"):
            worst = int(np.nan_to_num(force / carried, nan=0.0, posinf=np.inf).argmax())
        friction_limit = math.nan if friction is None else friction * float(carried.reshape(-1)[worst])
        grip = OwnLimit("traction", float(force.reshape(-1)[worst]), friction_limit, float(time[worst]))
        radius, name = k.wheels[place].radius, f"wheel {place + 1}"
        cycles.append(LoadCycle(name, duration, speed, gain, torque, float(inertia[i]), (grip,), radius).split())
    return tuple(cycles)


def effective_inertia(d: Dynamics) -> Array:
    """Torque over acceleration of each driven wheel where all act together, without rotors [kg*m^2]; shape (n,)."""
    k, driven = d.kinematics, list(d.kinematics.driven)
    E = k.E[driven]
    M = d.M - E.T @ (np.array([k.wheels[i].rotor_inertia for i in driven])[:, None] * E)
    values, modes = np.linalg.eigh(k.K_plus.T @ M @ k.K_plus)
    modes = modes[:, values > _NOTHING * values[-1]]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = (eq.wheel_space_inertia(d.distribution, M, k.K_plus) @ modes) / modes
    turns = np.abs(modes) > _TAKES_PART * np.abs(modes).max(axis=0)
    most: Array = np.where(turns, ratio, -np.inf).max(axis=1)
    return np.asarray(np.where(most > 0.0, most, math.nan))
