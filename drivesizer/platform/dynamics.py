"""Forces of the floor on a platform, torques of its wheels, and a trajectory as the robot itself sees it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from operator import itemgetter
from typing import Any

import numpy as np

from drivesizer.errors import InputError
from drivesizer.platform import equations as eq
from drivesizer.platform.equations import Array
from drivesizer.platform.kinematics import (
    Kinematics,
    Platform,
    check_allowed,
    columns,
    kinematics,
    map_columns,
    row_sizes,
)
from drivesizer.platform.trajectory import Trajectory

# -- Forces of the floor on a platform: its slope pulls, and its wheels share the weight.
#
# The floor is a plane with a slope; uphill has a direction in the world. Wheels and casters are taken as equally
# stiff on a stiff frame: loads lie on a plane over the contact points, :math:`N_i = a + b x_i + c y_i`, in balance
# with the weight, the forces at the floor and the height of the centre of mass.


@dataclass(frozen=True, slots=True, kw_only=True)
class Ground:
    """The floor: figures, or columns over samples."""

    slope: Any = 0.0  # rad
    uphill: Any = 0.0  # rad, direction in the world
    gravity: float = 9.80665  # m/s^2


LEVEL = Ground()


@dataclass(slots=True, eq=False)
class Moving:
    """A platform's motion as it sees it itself: at one moment, or columns over any axes of samples."""

    eta: Any  # velocity in the robot's frame [m/s, m/s, rad/s], shape (3, ...)
    eta_dot: Any  # its rate of change [m/s^2, m/s^2, rad/s^2]
    theta: Any = 0.0  # rad, heading in the world; one, or one per sample
    ground: Ground = LEVEL
    towards: Any = None  # velocity whose direction the resistances take: at rest, where it is about to go; else ``eta``

    def __post_init__(self) -> None:
        self.eta = columns(self.eta, 3, "velocity of the platform")
        self.eta_dot = columns(self.eta_dot, 3, "acceleration of the platform")
        self.towards = self.eta if self.towards is None else columns(self.towards, 3, "direction of rolling")

    @property
    def facing(self) -> Any:
        """The heading where it counts: 0 on a level floor."""
        return self.theta if np.any(self.ground.slope) else 0.0


def _downhill(theta: Any, ground: Ground) -> tuple[Array, Array]:
    """Gravity along the floor, forwards and to the left [m/s^2]."""
    pull = ground.gravity * np.sin(ground.slope)
    towards = np.asarray(ground.uphill, dtype=float) - np.asarray(theta, dtype=float)
    return -pull * np.cos(towards), -pull * np.sin(towards)


def weight_along(platform: Platform, theta: Any = 0.0, ground: Ground = LEVEL) -> Array:
    """Force and moment of the weight along the floor [N, N, N*m], in the robot's axes."""
    x, y = (platform.mass * g for g in _downhill(theta, ground))
    return np.array(np.broadcast_arrays(x, y, platform.x * y - platform.y * x))


def centre_acceleration(platform: Platform, m: Moving) -> Array:
    """Acceleration of the centre of mass, in the robot's axes [m/s^2]; shape (2, ...)."""
    (forward, aside, turn), (gain_x, gain_y, spin) = m.eta, m.eta_dot
    x, y = platform.x, platform.y
    return np.stack([
        gain_x - turn * aside - spin * y - turn**2 * x,
        gain_y + turn * forward + spin * x - turn**2 * y,
    ])  # fmt: skip


def contact_loads(
    platform: Platform,
    theta: Any = 0.0,
    ground: Ground = LEVEL,
    accelerated: Any = (0.0, 0.0),
    samples: tuple[int, ...] = (),
) -> Array:
    """Loads of wheels, then casters [N]; below 0 where one would lift off.

    Parameters
    ----------
    platform
        Contact points, mass and centre of mass.
    theta, ground
        Heading in the world [rad], and the floor.
    accelerated
        Acceleration of the centre of mass in the robot's axes [m/s^2], forwards and to the left; braking loads the
        front.
    samples
        Shape to fill where nothing above has it.

    Returns
    -------
    Array
        Shape (wheels and casters, ...). Contact points on one line cannot carry a moment about it; it is left out.

    Examples
    --------
    >>> from drivesizer.platform.kinematics import Wheel
    >>> cart = Platform(wheels=tuple(Wheel(x=x, y=0.0, radius=0.1) for x in (-0.2, 0.3)), mass=50.0, inertia=1.0)
    >>> contact_loads(cart, ground=Ground(gravity=10.0))  # levers 0.3 and 0.2 of 0.5
    array([300., 200.])
    """
    middle, share = _tilting(platform.contacts)
    normal = platform.mass * ground.gravity * np.cos(ground.slope)
    floor = [platform.mass * (np.asarray(a) - g) for a, g in zip(accelerated, _downhill(theta, ground), strict=True)]
    lever = [c - m for c, m in zip((platform.x, platform.y), middle, strict=True)]
    tilt = [normal * c - platform.height * f for c, f in zip(lever, floor, strict=True)]
    lean = np.array(np.broadcast_arrays(*tilt, np.zeros(samples)))[:2]
    return np.asarray(normal / len(share) + np.tensordot(share, lean, axes=1))


@lru_cache(maxsize=64)
def _tilting(contacts: tuple[tuple[float, float], ...]) -> tuple[Array, Array]:
    """Middle of contact points, and the load of each over the two moments that tilt the platform about it [1/m]."""
    places = np.array(contacts)
    middle = places.mean(axis=0)
    apart = places - middle
    return middle, apart @ np.linalg.pinv(apart.T @ apart, rcond=1e-12, hermitian=True)


# -- Torques of a platform's wheels, and the motion that they make.
#
# In the robot's frame, (49): :math:`\bar M \dot η + \bar C η = E^T τ + F`, with
#
# - :math:`\bar M = M_R + E^T M_ϕ E` (50): platform and wheels, rotors among them; the centre of mass may lie off the
#   reference point, which couples turning and moving;
# - :math:`\bar C` (51), skew-symmetric: it does no work;
# - F: weight on a slope, and what resists at the wheels and casters.
#
# Where the set of wheels does not allow every motion, η = S ν and the equation is taken along S: what the wheels
# hold does no work. n driven wheels and m motions leave n − m torques open; of all that make the motion, those with
# the least sum of squares are given, :math:`τ = D (\bar M \dot η + \bar C η - F)`, by
# the Moore-Penrose inverse :math:`D = (S^T E^T)^+ S^T`. In the wheels' own space this is (57)-(59).
#
# Rolling resistance is against each wheel's turning and nothing at rest, C_rr N r; N is what the wheel carries at
# rest. Its direction at a start is that of ``towards``; what turns no faster than a billionth of the platform's
# speed stands. No efficiency is in here: that is the drive's.


_ROUNDING = 1e-9  # of the platform's speed: what turns or rolls no faster stands


@dataclass(frozen=True, slots=True, eq=False)
class Dynamics:
    """The matrices of a platform."""

    platform: Platform
    kinematics: Kinematics
    M: Array  # (3, 3), (50): inertia of platform and wheels
    C: Array  # (3, 3), (51) at 1 rad/s
    distribution: Array  # (n, 3), D: torques of the driven wheels over force and moment on the platform


@lru_cache(maxsize=256)
def dynamics(platform: Platform) -> Dynamics:
    """The matrices of a platform."""
    k, p = kinematics(platform.wheels), platform
    M_R = eq.mass_matrix(p.mass, p.inertia + p.mass * (p.x**2 + p.y**2), p.x, p.y)
    M_phi = eq.wheel_inertias(np.array([w.inertia + w.rotor_inertia for w in p.wheels]))
    M, C = eq.inertia_matrix(M_R, k.E, M_phi), eq.coriolis_matrix(1.0, p.mass, p.x, p.y)
    return Dynamics(p, k, M, C, _distribution(k))


@lru_cache(maxsize=256)
def _distribution(k: Kinematics) -> Array:
    """Torques of the driven wheels over force and moment on a platform, whatever its mass."""
    return np.linalg.pinv((k.E[list(k.driven)] @ k.motions).T) @ k.motions.T


def signs(rows: Array, eta: Array, reach: float) -> Array:
    """Signs of rows times velocities; 0 where that is nothing beside what so fast a motion makes."""
    flat = eta.reshape(3, -1)
    value, least = rows @ flat, np.outer(_ROUNDING * row_sizes(rows, reach), _speed(flat, reach))
    value[np.abs(value) <= least] = 0.0
    return np.sign(value, out=value).reshape(-1, *eta.shape[1:])


def _speed(eta: Array, reach: float) -> Array:
    """Of the platform, of its driving and its turning together [m/s]."""
    return np.asarray(np.hypot(eta[0], eta[1]) + reach * np.abs(eta[2]))


def own_rolling(d: Dynamics, loads: Array) -> Array:
    """Torque that each wheel itself takes to roll on, about its own axis [N*m], shape (wheels, ...)."""
    wheels = d.platform.wheels
    C_rr, r, friction = np.array([(w.rolling_resistance, w.radius, w.friction) for w in wheels]).T
    across = (slice(None),) + (None,) * (loads.ndim - 1)
    return np.asarray((C_rr * r)[across] * np.maximum(loads[: len(wheels)], 0.0) + friction[across])


def rolling(d: Dynamics, towards: Array, theta: Any = 0.0, ground: Ground = LEVEL) -> tuple[Array, Array]:
    """Load of each wheel and caster [N], and torque that each wheel itself takes to roll on [N*m]."""
    loads = np.maximum(contact_loads(d.platform, theta, ground, samples=towards.shape[1:]), 0.0)
    return loads, own_rolling(d, loads) * signs(d.kinematics.E, towards, d.kinematics.reach)


def resistance(
    d: Dynamics,
    towards: Array,
    theta: Any = 0.0,
    ground: Ground = LEVEL,
    known: tuple[Array, Array] | None = None,
) -> Array:
    """Force and moment that wheels, rollers and casters need to roll on [N, N, N*m]; shape (3, ...).

    ``known``: what ``rolling`` gives, where it is at hand.
    """
    wheels, casters, k = d.platform.wheels, d.platform.casters, d.kinematics
    C_rr, C_roller, friction = np.array([(w.rolling_resistance, w.roller_resistance, w.friction) for w in wheels]).T
    crawl = np.array([c.rolling_resistance for c in casters])
    if not (C_rr.any() or C_roller.any() or friction.any() or crawl.any()):
        return np.zeros_like(towards)
    loads, torque = known or rolling(d, towards, theta, ground)
    carried, across = loads[: len(wheels)], (slice(None),) + (None,) * (towards.ndim - 1)
    total = map_columns(k.E.T, torque)
    if C_roller.any():
        total = total + map_columns(k.rollers.T, C_roller[across] * carried * signs(k.rollers, towards, k.reach))
    for c, load in zip(casters, loads[len(wheels) :], strict=True):
        x, y = towards[0] - c.y * towards[2], towards[1] + c.x * towards[2]
        size = np.hypot(x, y)
        rolls = size > _ROUNDING * _speed(towards, k.reach + math.hypot(c.x, c.y))
        pull = c.rolling_resistance * load * rolls / np.where(rolls, size, 1.0)
        total = total + pull * np.array([x, y, c.x * y - c.y * x])
    return np.asarray(total)


def required_force(d: Dynamics, m: Moving, known: tuple[Array, Array] | None = None) -> Array:
    """Force and moment that the driven wheels must make for a motion [N, N, N*m], in the robot's axes; (3, ...).

    ``known``: what ``rolling`` gives, where it is at hand.
    """
    check_allowed(d.kinematics, m.eta, "velocity of the platform")
    check_allowed(d.kinematics, m.eta_dot, "acceleration of the platform", "m/s^2")
    rate, turned = np.broadcast_arrays(m.eta_dot, m.eta[2] * m.eta)  # C is of 1 rad/s
    force = eq.operational_force(d.M, rate.reshape(3, -1), d.C, turned.reshape(3, -1)).reshape(rate.shape)
    weight = weight_along(d.platform, m.facing, m.ground)
    weight = weight.reshape(3, *[1] * (force.ndim - 1)) if weight.ndim == 1 else weight
    return np.asarray(force - weight + resistance(d, m.towards, m.facing, m.ground, known))


def wheel_torques(d: Dynamics, m: Moving, *, rotors: bool = True) -> Array:
    """Torques of the driven wheels that make a motion [N*m], shape (n, ...)."""
    torque = map_columns(d.distribution, required_force(d, m))
    if rotors:
        return torque
    driven = list(d.kinematics.driven)
    own = np.array([d.platform.wheels[i].rotor_inertia for i in driven])
    return torque - map_columns(own[:, None] * d.kinematics.E[driven], m.eta_dot)


def energy(d: Dynamics, eta: Any) -> Array:
    """Kinetic energy of platform, wheels and rotors, (41) [J]; shape (...)."""
    eta, p = columns(eta, 3, "velocity of the platform"), d.platform
    inertias = np.array([w.inertia + w.rotor_inertia for w in p.wheels]).reshape(-1, *[1] * (eta.ndim - 1))
    x, y = eta[0] - p.y * eta[2], eta[1] + p.x * eta[2]  # of the centre of mass
    speeds = map_columns(d.kinematics.E, eta)
    return np.asarray(eq.kinetic_energy(p.mass, x, y, p.inertia, eta[2], inertias, speeds))


def wheel_space(d: Dynamics) -> tuple[Array, Array]:
    """Inertia [kg*m^2] and, at a turning speed of 1 rad/s, Coriolis matrix [kg*m^2/s] of (57)-(59), both (n, n).

    M ϕ̈ + θ̇ C ϕ̇ = τ for speeds of the driven wheels that a motion makes; θ̇ is the third entry of ``velocity``. Their
    rank is the number of motions at most, never n where wheels are redundant: do not invert them.
    """
    D, K_plus = d.distribution, d.kinematics.K_plus
    return eq.wheel_space_inertia(D, d.M, K_plus), eq.wheel_space_coriolis(D, d.C, K_plus)


# -- A trajectory as the robot itself sees it: what ``dynamics`` makes torques of.
#
# Resistances turn round with each wheel and roller, so pieces are cut where one does, and within a piece their
# direction is that of the motion in it. Where the wheels do not allow every motion, a trajectory that was sampled
# slides them a little all the same; that little is left out: the platform goes as its driven wheels do on the
# trajectory.


_SHORT = 1e-9  # of a piece: none is cut shorter
_TOWARDS = 1e-3  # how far a direction of rolling goes from that at an end of a piece to that of its middle
_BLOCK = 8192  # pieces
_SLIDING = 0.02  # of the largest speed, by which a trajectory may be off what the wheels allow


@dataclass(slots=True, eq=False)
class Motion(Moving):
    """A trajectory as the robot sees it, cut where wheels and rollers that resist turn round; n pieces, two ends."""

    duration: Any = None  # (n,) s


def motion(d: Dynamics, trajectory: Trajectory, ground: Ground = LEVEL) -> Motion:
    """Motion of a platform on a trajectory, for ``dynamics`` to make torques of."""
    allowed(d.kinematics, trajectory)
    return seen(d, trajectory, ground, largest(trajectory))


def largest(trajectory: Trajectory) -> Array:
    """The largest speed in each of the robot's axes [m/s, m/s, rad/s], whatever its heading."""
    x, y, turn = trajectory.velocity
    along = np.hypot(x, y).max()
    return np.array([along, along, np.abs(turn).max()])


def allowed(k: Kinematics, trajectory: Trajectory) -> None:
    """Refuse a trajectory that slides wheels by more than a share of its largest speed: sampled tracks need some."""
    if not len(k.held):
        return
    along, _, turning = largest(trajectory)
    eta, _ = trajectory.in_robot()
    off = np.abs(map_columns(k.held, eta)).max(axis=0)
    if not off.max() <= _SLIDING * (along + max(w.L for w in k.wheels) * turning):
        at = trajectory.time.reshape(-1)[int(off.argmax())]
        check_allowed(k, eta, f"trajectory at {at:.4g} s")
        raise InputError(f"trajectory at {at:.4g} s: it slides a wheel by {off.max():.3g} m/s, more than permitted")


def seen(d: Dynamics, trajectory: Trajectory, ground: Ground, top: Array) -> Motion:
    """A trajectory in the robot's frame, cut; what the wheels do not allow of it is left out."""
    k, (eta, eta_dot) = d.kinematics, trajectory.in_robot()
    if len(k.held):
        projector = k.K_plus @ k.E[list(k.driven)]  # the motion of wheels that turn as in one that slides
        eta, eta_dot = map_columns(projector, eta), map_columns(projector, eta_dot)
    still = _ROUNDING * (top[0] + k.reach * top[2])  # m/s
    eta = np.where(np.abs(eta) <= still / np.array([1.0, 1.0, k.reach])[:, None, None], 0.0, eta)
    wheels = [i for i, w in enumerate(k.wheels) if w.rolling_resistance or w.friction]
    rows = np.concatenate([k.E[wheels], k.rollers[[i for i, w in enumerate(k.wheels) if w.roller_resistance]]])
    turning = map_columns(rows, eta)
    turning[np.abs(turning) <= (still * row_sizes(rows, k.reach))[:, None, None]] = 0.0
    owner, start, end = _cuts(turning)
    if len(owner) == len(trajectory.duration):
        return Motion(eta, eta_dot, trajectory.posture[2], ground, _towards(eta), trajectory.duration)

    def cut(column: Array) -> Array:
        left, right = column[..., owner, 0], column[..., owner, 1]
        ends = [left + (right - left) * start, np.where(end < 1.0, left + (right - left) * end, right)]
        return np.stack(ends, axis=-1)

    duration = trajectory.duration[owner] * (end - start)
    eta, eta_dot = cut(eta), cut(eta_dot)
    return Motion(eta, eta_dot, cut(trajectory.posture[2]), _over(ground, cut), _towards(eta), duration)


def _towards(eta: Array) -> Array:
    """The velocity at each end, turned a little to that of the piece: at rest, it is where the piece goes."""
    return np.asarray(eta + _TOWARDS * (eta.mean(axis=2, keepdims=True) - eta))


def _cuts(turning: Array) -> tuple[Any, Array, Array]:
    """Parts of pieces in which no row changes sign: the piece of each, and where in it the part starts and ends [1]."""
    pieces = turning.shape[1]
    left, right = turning[..., 0], turning[..., 1]
    row, owner = np.nonzero(left * right < 0.0)
    share = left[row, owner] / (left[row, owner] - right[row, owner])
    inside = (share > _SHORT) & (share < 1.0 - _SHORT)
    owner, share = owner[inside], share[inside]
    order = np.lexsort((share, owner))
    owner, share = owner[order], share[order]
    first = np.ones(len(owner), dtype=bool)
    first[1:] = (np.diff(owner) > 0) | (np.diff(share) > _SHORT)
    owner = np.concatenate([np.arange(pieces), owner[first]])
    start = np.concatenate([np.zeros(pieces), share[first]])
    order = np.lexsort((start, owner))
    owner, start = owner[order], start[order]
    end = np.append(np.where(np.diff(owner) > 0, 1.0, start[1:]), 1.0)
    return owner, start, end


def blocks(trajectory: Trajectory, ground: Ground) -> Iterator[tuple[Trajectory, Ground]]:
    """So many pieces at a time that their columns stay in the processor's cache.

    Parameters are those of ``motion``.
    """
    for first in range(0, len(trajectory.duration), _BLOCK):
        here = slice(first, first + _BLOCK)
        t, floor = trajectory, _over(ground, itemgetter(here))
        yield Trajectory(t.duration[here], t.posture[:, here], t.velocity[:, here], t.acceleration[:, here]), floor


def _over(ground: Ground, change: Callable[[Array], Array]) -> Ground:
    """The floor with its columns changed, and its plain figures as they are."""
    slope, uphill = (change(np.asarray(c)) if np.ndim(c) else c for c in (ground.slope, ground.uphill))
    return replace(ground, slope=slope, uphill=uphill)
