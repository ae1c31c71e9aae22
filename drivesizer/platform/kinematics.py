r"""Speeds of a platform's wheels from its motion, and its motion from theirs.

Every wheel rolls along its roller's axis, (26): :math:`J_1 η + J_2 \dot ϕ = 0`, so :math:`\dot ϕ = E η`,
:math:`E = -J_2^{-1} J_1` (32). A wheel without rollers does not move sideways and one that is blocked does not turn;
of wheels that slide as the vehicle turns the point midway does not. Those rows, A η = 0, leave the motions η = S ν that
the set of wheels allows: three for an omnidirectional platform,
two for a differential drive, one for a car. The driven wheels must distinguish each of these motions, or the platform
could move while they stand: such a set is refused. Back from the wheels, (54), by least squares over the
allowed motions, :math:`η = S (E S)^+ \dot ϕ`.

Symbols: η velocity in the robot's frame (forwards [m/s], to the left [m/s], turning [rad/s]), ξ posture in the world.
Velocities are columns: the first axis has the three entries, or a row for each wheel; further axes are samples.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drivesizer.errors import InputError
from drivesizer.platform import equations as eq
from drivesizer.platform.matrix_equation import Array
from drivesizer.platform.wheels import Wheel

_ROUNDING = 1e-12  # of what a row makes of a motion in any direction: an entry below it is 0
_NOTHING = 1e-9  # a singular value below it, with lengths in units of the platform, is rounding
_LEAST = 1e-6  # of the largest: below it a motion takes a million times the wheel speed or torque of another
_ALLOWED = 1e-6  # of the speed: a motion that slides a wheel by less is taken as allowed


@dataclass(frozen=True, slots=True, eq=False)
class Kinematics:
    """The matrices of a set of wheels; N wheels, n of them driven, m motions that the set allows."""

    wheels: tuple[Wheel, ...]
    driven: tuple[int, ...]  # places of the driven wheels, from 0
    J1: Array  # (N, 3), (28)
    J2: Array  # (N, N), (29)
    E: Array  # (N, 3), (32): wheel speeds over velocity
    rollers: Array  # (N, 3): surface speed of the rollers over velocity, second row of (25)
    held: Array  # (k, 3): what must be 0, sideways at wheels without rollers (or midway), rolling at blocked ones
    motions: Array  # (3, m): S; the velocities that the set allows are their sums
    K_plus: Array  # (3, n), (54): velocity over the speeds of the driven wheels
    reach: float  # m, distance of the farthest wheel, or the largest radius: what turning is compared with driving by

    @property
    def mobility(self) -> int:
        """Number of motions that the set of wheels allows: 3 is omnidirectional."""
        return int(self.motions.shape[1])


def kinematics(wheels: Sequence[Wheel]) -> Kinematics:
    """The matrices of a set of wheels.

    Parameters
    ----------
    wheels
        Any number and kinds.

    Raises
    ------
    InputError
        When the set allows no motion, or allows one that the driven wheels do not see.

    Examples
    --------
    >>> pair = [Wheel(x=0.0, y=y, radius=0.1, held=True) for y in (-0.25, 0.25)]
    >>> kinematics(pair).motions.T  # forwards, and turning on the spot
    array([[1., 0., 0.],
           [0., 0., 1.]])
    """
    L, alpha, beta, gamma, r = np.array([(w.L, w.alpha, w.beta, w.roller_angle, w.radius) for w in wheels]).T
    phi, delta = alpha + beta + gamma, beta + gamma
    J1, J2 = eq.rolling_rows(phi, delta, L), eq.wheel_matrix(r, gamma)
    reach = max(w.L for w in wheels) or max(w.radius for w in wheels)

    def exact(rows: Array) -> Array:
        """Rows over velocity without what the sine of a right angle leaves where there is nothing."""
        entries = np.abs(rows * np.array([1.0, 1.0, 1.0 / reach]))
        return np.where(entries <= _ROUNDING * row_sizes(rows, reach)[:, None], 0.0, rows)

    E = exact(eq.wheel_map(J1, J2))
    _, across = np.moveaxis(eq.roller_frame_rows(phi, delta, L), -1, 1)
    sideways, turning = _holders(wheels)
    sliding = [i for i, w in enumerate(wheels) if w.slides]
    middle = across[sliding].mean(axis=0, keepdims=True) if sliding else across[:0]
    held = exact(np.concatenate([across[sideways], r[turning, None] * E[turning], middle]))
    scale = np.array([1.0, 1.0, 1.0 / reach])
    motions = scale[:, None] * _null_space(held * scale)
    motions /= motions[(motions != 0.0).argmax(axis=0), range(motions.shape[1])]  # the first entry of each is 1
    driven = tuple(i for i, w in enumerate(wheels) if w.drive == "motor")
    if motions.shape[1] == 0:
        raise InputError("platform: its wheels hold one another, no motion is left; check headings and places")
    _seen(E[list(driven)] * r[list(driven), None], motions, scale)
    K_plus = motions @ np.linalg.pinv(E[list(driven)] @ motions)
    rollers = exact(across + (r * np.sin(gamma))[:, None] * E)
    return Kinematics(tuple(wheels), driven, J1, J2, E, rollers, held, motions, K_plus, reach)


def row_sizes(rows: Array, reach: float) -> Array:
    """Largest values of rows times velocity, of a motion of 1 m/s in any direction, shape (n,).

    Parameters
    ----------
    rows
        Such as E of a set of wheels, shape (n, 3).
    reach
        Of the platform [m]: turning by 1/reach rad/s is a motion of 1 m/s.

    Returns
    -------
    array
        Shape (n,).
    """
    return np.asarray(np.hypot(np.hypot(rows[:, 0], rows[:, 1]), rows[:, 2] / reach))


def _holders(wheels: Sequence[Wheel]) -> tuple[list[int], list[int]]:
    """Places of the wheels that hold sideways, and of those that do not turn."""
    sideways = [i for i, w in enumerate(wheels) if w.held]
    return sideways, [i for i, w in enumerate(wheels) if w.drive == "blocked"]


def _null_space(rows: Array) -> Array:
    """Columns whose sums are all that the rows turn to 0, with as many zeros and ones as can be."""
    _, values, vectors = np.linalg.svd(rows) if len(rows) else (None, np.zeros(0), np.eye(3))
    rank = int((values > _NOTHING).sum())
    found, place = vectors[rank:].copy(), 0
    for column in range(3):  # Gauss and Jordan
        rest = np.abs(found[place:, column])
        if not rest.size or rest.max() < _NOTHING:
            continue
        pivot = place + int(rest.argmax())
        found[[place, pivot]] = found[[pivot, place]]
        found[place] /= found[place, column]
        others = np.arange(len(found)) != place
        found[others] -= found[others, column : column + 1] * found[place]
        place += 1
    found[np.abs(found) < _NOTHING] = 0.0
    return found.T


def _seen(rolling: Array, motions: Array, scale: Array) -> None:
    """No motion that the set allows leaves all driven wheels at rest."""
    plain = motions / scale[:, None]
    _, values, vectors = np.linalg.svd(rolling * scale @ plain)
    if len(values) == plain.shape[1] and values[-1] > _LEAST * values[0]:
        return
    found = scale * (plain @ vectors[-1])
    x, y, turn = found * np.sign(found[np.abs(found).argmax()])
    sliding = {"forwards": x, "to the left": y}
    words = [f"{v:.3g} m/s {name}" for name, v in sliding.items() if abs(v) > _LEAST]
    words += [f"{turn:.3g} rad/s turning"] if abs(turn) > _LEAST else []
    raise InputError(f"platform: it can move with its driven wheels at rest ({', '.join(words)}); check their angles")


def columns(values: Any, entries: int, what: str) -> Array:
    """Figures as columns of floats.

    Parameters
    ----------
    values
        One figure or an array per entry.
    entries
        Length of the first axis.
    what
        Name of the figures, for a message.

    Returns
    -------
    array
        Shape (entries, ...).

    Raises
    ------
    InputError
        When the first axis has another length, or a figure is not finite.
    """
    found = np.asarray(values, dtype=float)
    if found.ndim == 0 or found.shape[0] != entries:
        raise InputError(f"{what}: expected {entries} rows, got an array of shape {found.shape}")
    if not np.isfinite(found).all():
        place = np.argwhere(~np.isfinite(found))[0]
        at = f" at sample {', '.join(str(k) for k in place[1:])}" if found.ndim > 1 else ""
        raise InputError(f"{what}: row {place[0] + 1}{at} is not a finite number")
    return found


def map_columns(matrix: Array, values: Array) -> Array:
    """A matrix times columns with any number of axes of samples.

    Parameters
    ----------
    matrix
        Shape (m, n).
    values
        Shape (n, ...).

    Returns
    -------
    array
        Shape (m, ...).
    """
    if values.ndim <= 2:
        return matrix @ values
    return (matrix @ values.reshape(len(values), -1)).reshape(-1, *values.shape[1:])


def to_robot(theta: Any, xi_dot: Any) -> Array:
    """Velocity in the robot's frame, (22).

    Parameters
    ----------
    theta
        Heading [rad]; one, or one per sample.
    xi_dot
        Velocity in the world [m/s, m/s, rad/s], shape (3, ...).

    Returns
    -------
    array
        [m/s, m/s, rad/s], shape (3, ...).
    """
    found: Array = eq.robot_velocity(np.asarray(theta, dtype=float), *columns(xi_dot, 3, "velocity in the world"))
    return found


def to_world(theta: Any, eta: Any) -> Array:
    """Velocity in the world, (31); the other way round of ``to_robot``.

    Parameters
    ----------
    theta
        Heading [rad]; one, or one per sample.
    eta
        Velocity in the robot's frame [m/s, m/s, rad/s], shape (3, ...).

    Returns
    -------
    array
        [m/s, m/s, rad/s], shape (3, ...).
    """
    found: Array = eq.world_velocity(np.asarray(theta, dtype=float), *columns(eta, 3, "velocity of the platform"))
    return found


def wheel_speeds(k: Kinematics, eta: Any) -> Array:
    """Speeds of all wheels [rad/s], (32); shape (N, ...).

    Parameters
    ----------
    k
        The set of wheels.
    eta
        Velocity in the robot's frame [m/s, m/s, rad/s], shape (3, ...).

    Returns
    -------
    array
        Speeds [rad/s], shape (N, ...).

    Raises
    ------
    InputError
        When the set does not allow the motion.
    """
    found = columns(eta, 3, "velocity of the platform")
    check_allowed(k, found, "velocity of the platform")
    return map_columns(k.E, found)


def check_allowed(k: Kinematics, eta: Array, what: str, unit: str = "m/s") -> None:
    """Refuse a velocity, or an acceleration, that would slide a held wheel or turn a blocked one.

    Parameters
    ----------
    k
        The wheels.
    eta
        Velocity or acceleration in the robot's frame, shape (3, ...).
    what, unit
        Name and unit of it, for a message.

    Raises
    ------
    InputError
        When the set does not allow it.
    """
    if not len(k.held):
        return
    off = np.abs(map_columns(k.held, eta)).reshape(len(k.held), -1)
    largest = np.abs(eta).reshape(3, -1).max(axis=1)
    size = math.hypot(largest[0], largest[1]) + max(w.L for w in k.wheels) * largest[2]
    wrong = np.where(off > _ALLOWED * size, off, 0.0)
    if wrong.any():
        row, sample = (int(i) for i in np.unravel_index(wrong.argmax(), off.shape))
        sideways, turning = _holders(k.wheels)
        places = [*sideways, *turning, *(i for i, w in enumerate(k.wheels) if w.slides)]
        turns = len(sideways) <= row < len(sideways) + len(turning)
        does, wheel = "turns the blocked" if turns else "slides", places[row] + 1
        raise InputError(f"{what}: it {does} wheel {wheel} by {off[row, sample]:.3g} {unit}, at sample {sample}")


def velocity(k: Kinematics, speeds: Any) -> Array:
    """Velocity of the platform from the speeds of its driven wheels, (54); shape (3, ...).

    Parameters
    ----------
    k
        The set of wheels.
    speeds
        Of the driven wheels [rad/s], shape (n, ...).

    Returns
    -------
    array
        [m/s, m/s, rad/s], shape (3, ...).
    """
    return map_columns(k.K_plus, columns(speeds, len(k.driven), "speeds of the driven wheels"))
