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
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Any, Literal

import numpy as np

from drivesizer.errors import InputError
from drivesizer.platform import equations as eq
from drivesizer.platform.equations import Array

# -- Wheels, casters and the platform on them, as records; all lengths in the robot's frame.
#
# The frame's x points forward, y to the left; its origin, the reference point, is where the posture is counted. A
# wheel that turns forwards (positive speed) rolls along its heading. Its force on the floor depends on its rollers:
#
# - mecanum: rollers at an angle γ, usually 45°. It pulls along the roller's axis only.
# - omni: rollers that let it slide sideways, γ = 0. It pulls along its heading only.
# - fixed, or steered to a given angle: no rollers. It pulls along its heading and holds sideways (``held``).
# - skid: a fixed wheel of a vehicle whose wheels slide sideways as it turns (``slides``): it resists that by sliding
#   friction times its load, whatever the speed. Along its heading it rolls without slip, and the point midway between
#   all of them does not move sideways. Where wheels grip less ahead while they slide, this is the most that turning
#   takes; on the spot on a level floor it is :math:`M = \mu_s \sum N_i |x_i|`, of long tracks :math:`\mu_s W L / 4`
#   (K. Kozłowski, D. Pazderski, Modeling and control of a 4-wheel skid-steering mobile robot, Int. J. Appl. Math.
#   Comput. Sci. 14 (2004) 477; J. Y. Wong, Theory of Ground Vehicles, Wiley, skid-steering).
#
# Symbols of Table 1 of Appl. Sci. 2021, 11, 6631: L, α place the contact point, β turns the wheel against the line
# to it (its heading is α + β − π/2), γ is the roller's angle.


Drive = Literal["motor", "free", "blocked"]  # blocked: by a brake, or a gear that locks itself


@dataclass(frozen=True, slots=True, kw_only=True)
class Wheel:
    """One wheel: where it stands, how it rolls, what turns it."""

    x: float  # m, of the contact point
    y: float  # m
    radius: float  # m
    heading: float = 0.0  # rad, where it rolls when it turns forwards
    roller_angle: float = 0.0  # rad, γ: from the heading to the axis of the roller on the floor
    held: bool = False  # no rollers: does not move sideways
    slides: bool = False  # no rollers: slides sideways as the vehicle turns
    drive: Drive = "motor"
    inertia: float = 0.0  # kg*m^2 about the axle: wheel and shaft
    rotor_inertia: float = 0.0  # kg*m^2 at the wheel: K² (J_m + J_g) of its drive
    rolling_resistance: float = 0.0  # C_rr, of the wheel on its axle [1]
    roller_resistance: float = 0.0  # the same of the roller on its pin, or of sliding sideways [1]
    friction: float = 0.0  # N*m, against the wheel's turning whatever it carries

    @property
    def L(self) -> float:  # noqa: N802 - the paper's symbol
        """Distance of the contact point from the reference point [m]."""
        return math.hypot(self.x, self.y)

    @property
    def alpha(self) -> float:
        """Direction of the contact point [rad]."""
        return math.atan2(self.y, self.x)

    @property
    def beta(self) -> float:
        """Angle of the wheel against the line to its contact point [rad]."""
        return self.heading + math.pi / 2.0 - self.alpha


def table_wheel(L: float, alpha: float, beta: float, gamma: float, radius: float, **more: Any) -> Wheel:
    """A wheel by the columns of the paper's Table 1.

    Parameters
    ----------
    L, alpha
        Distance [m] and direction [rad] of the contact point.
    beta
        Of the wheel against the line to it [rad]; π/2 − α rolls forward.
    gamma
        Angle of the rollers [rad].
    radius
        Of the wheel [m].
    more
        Further fields of a wheel.

    Returns
    -------
    Wheel
        In the robot's frame.

    Examples
    --------
    >>> table_wheel(0.3, 0.5, math.pi / 2 - 0.5, 0.7, 0.08).heading
    0.0
    """
    heading = alpha + beta - math.pi / 2.0
    return Wheel(
        x=L * math.cos(alpha), y=L * math.sin(alpha), radius=radius, heading=heading, roller_angle=gamma, **more
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Caster:
    """A wheel that carries and follows: it neither drives nor holds."""

    x: float  # m
    y: float  # m
    rolling_resistance: float = 0.0  # C_rr [1]


@dataclass(frozen=True, slots=True, kw_only=True)
class Payload:
    """Load that is put on the platform."""

    mass: float  # kg
    x: float = 0.0  # m, of its centre of mass
    y: float = 0.0  # m
    height: float = 0.0  # m above the floor
    inertia: float = 0.0  # kg*m^2 about the vertical through its centre of mass


@dataclass(frozen=True, slots=True, kw_only=True)
class Platform:
    """Wheels and the mass on them, the wheels' own included."""

    wheels: tuple[Wheel, ...]
    mass: float  # kg
    inertia: float  # kg*m^2 about the vertical through the centre of mass
    x: float = 0.0  # m, of the centre of mass
    y: float = 0.0  # m
    height: float = 0.0  # m above the floor
    casters: tuple[Caster, ...] = ()

    def __post_init__(self) -> None:
        for name in ("mass", "inertia"):  # of one that its robot model misjudges
            if not getattr(self, name) > 0.0:
                raise InputError(f"platform: {name} must be above 0, got {getattr(self, name)!r}")
        if not any(w.drive == "motor" for w in self.wheels):
            raise InputError("platform: no wheel is driven; expected one with a motor at least")
        places = self.contacts
        scale = max(math.hypot(*p) for p in places) or 1.0
        for i, here in enumerate(places):
            for j, there in enumerate(places[:i]):
                if math.dist(here, there) < 1e-6 * scale:
                    raise InputError(
                        f"platform: wheels {j + 1} and {i + 1} stand in one place, ({here[0]:g}, {here[1]:g}) m"
                    )

    @property
    def contacts(self) -> tuple[tuple[float, float], ...]:
        """Contact points of wheels, then of casters [m]."""
        return (*((w.x, w.y) for w in self.wheels), *((c.x, c.y) for c in self.casters))


def loaded(platform: Platform, *payloads: Payload) -> Platform:
    """The platform with payloads on it: mass, centre of mass and inertia of all together.

    >>> flat = Platform(wheels=(Wheel(x=0.0, y=0.3, radius=0.1),), mass=30.0, inertia=2.0)
    >>> both = loaded(flat, Payload(mass=10.0, x=0.2, inertia=0.1))
    >>> both.mass, both.x, both.inertia  # 2.1 and 30 * 10 / 40 * 0.2²
    (40.0, 0.05, 2.4)
    """
    for p in payloads:
        total = platform.mass + p.mass
        share = p.mass / total
        apart = math.hypot(p.x - platform.x, p.y - platform.y)
        platform = replace(
            platform,
            mass=total,
            x=platform.x + share * (p.x - platform.x),
            y=platform.y + share * (p.y - platform.y),
            height=platform.height + share * (p.height - platform.height),
            inertia=platform.inertia + p.inertia + platform.mass * share * apart**2,
        )
    return platform


def without_motor(platform: Platform, wheel: int, *, blocked: bool = False) -> Platform:
    """The platform after a motor has failed: its wheel turns freely with the rotor, or not at all."""
    if not 1 <= wheel <= len(platform.wheels):
        raise InputError(f"platform: there is no wheel {wheel}; expected 1 to {len(platform.wheels)}")
    wheels = list(platform.wheels)
    wheels[wheel - 1] = replace(wheels[wheel - 1], drive="blocked" if blocked else "free")
    return replace(platform, wheels=tuple(wheels))


# -- A platform as it is, against its robot model.


_LARGEST_ERROR = 10.0  # of a relative error, m or rad


@dataclass(frozen=True, slots=True, kw_only=True)
class Misjudged:
    """Differences, true against believed; one figure for all wheels, or one for each."""

    radius: float | tuple[float, ...] = 0.0  # true over believed, less 1
    lever: float = 0.0  # the same of the wheels' places, x and y: of l1 + l2, of the track
    toe: float | tuple[float, ...] = 0.0  # rad, added to the heading of a wheel
    mass: float = 0.0  # true over believed, less 1
    inertia: float = 0.0  # the same
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0)  # m, added to place and height of the centre of mass
    payload: Payload | None = None  # that the model does not know
    rolling_resistance: float | tuple[float, ...] = 0.0  # added to C_rr [1]
    roller_resistance: float | tuple[float, ...] = 0.0  # added to that of the rollers [1]
    motor: float | tuple[float, ...] = 0.0  # torque over required torque, less 1: -0.1 is weak by 10 %

    def __post_init__(self) -> None:
        for f in fields(self):
            value = getattr(self, f.name)
            if value is None or isinstance(value, Payload):
                continue
            for entry in value if isinstance(value, tuple) else (value,):
                if not abs(entry) < _LARGEST_ERROR:  # written so that NaN fails too
                    raise InputError(f"misjudged: {f.name} must be a number below {_LARGEST_ERROR:g}, got {entry!r}")
        if not 1.0 + min(per_wheel(self.motor, 0, "motor")) >= 0.0:
            raise InputError(f"misjudged: motor must be -1 or more, got {self.motor!r}")


def per_wheel(value: float | Sequence[float], wheels: int, what: str) -> tuple[float, ...]:
    """A figure for each wheel; 0 wheels: as many as there are."""
    if isinstance(value, (int, float)):
        return (float(value),) * max(wheels, 1)
    if wheels and len(value) != wheels:
        raise InputError(f"{what}: expected one figure, or {wheels}, got {len(value)}")
    return tuple(float(v) for v in value)


EXACT = Misjudged()


def actual(believed: Platform, misjudged: Misjudged) -> Platform:
    """The platform that is there.

    Parameters
    ----------
    believed
        By the robot model.
    misjudged
        How it differs.

    Returns
    -------
    Platform
        With the true figures.

    Raises
    ------
    InputError
        When what comes out is no platform: a mass that is not above 0, say, or figures for another number of wheels.

    Examples
    --------
    >>> from drivesizer.platform.kinematics import Wheel
    >>> flat = Platform(wheels=(Wheel(x=0.0, y=0.3, radius=0.1),), mass=30.0, inertia=2.0)
    >>> actual(flat, Misjudged(radius=0.01, mass=0.1)).wheels[0].radius
    0.101
    """
    n, m = len(believed.wheels), misjudged
    radius, toe = per_wheel(m.radius, n, "misjudged radius"), per_wheel(m.toe, n, "misjudged toe")
    crr = per_wheel(m.rolling_resistance, n, "misjudged rolling_resistance")
    roller = per_wheel(m.roller_resistance, n, "misjudged roller_resistance")
    wheels = tuple(
        replace(
            w,
            x=w.x * (1.0 + m.lever),
            y=w.y * (1.0 + m.lever),
            radius=w.radius * (1.0 + radius[i]),
            heading=w.heading + toe[i],
            rolling_resistance=w.rolling_resistance + crr[i],
            roller_resistance=w.roller_resistance if w.held else w.roller_resistance + roller[i],
        )
        for i, w in enumerate(believed.wheels)
    )
    x, y, up = m.centre
    there = replace(
        believed,
        wheels=wheels,
        mass=believed.mass * (1.0 + m.mass),
        inertia=believed.inertia * (1.0 + m.inertia),
        x=believed.x + x,
        y=believed.y + y,
        height=max(believed.height + up, 0.0) if math.isfinite(up) else up,
    )
    return there if m.payload is None else loaded(there, m.payload)


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
    return _kinematics(tuple(wheels))


@lru_cache(maxsize=64)
def _kinematics(wheels: tuple[Wheel, ...]) -> Kinematics:
    """The same, once for the many masses that wheels carry."""
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
    constraints = exact(np.concatenate([across[sideways], r[turning, None] * E[turning], middle]))
    scale = np.array([1.0, 1.0, 1.0 / reach])
    motions = scale[:, None] * _null_space(constraints * scale)
    motions /= motions[(motions != 0.0).argmax(axis=0), range(motions.shape[1])]  # the first entry of each is 1
    driven = tuple(i for i, w in enumerate(wheels) if w.drive == "motor")
    if motions.shape[1] == 0:
        raise InputError("platform: its wheels hold one another, no motion is left; check headings and places")
    _seen(E[list(driven)] * r[list(driven), None], motions, scale)
    K_plus = motions @ np.linalg.pinv(E[list(driven)] @ motions)
    rollers = exact(across + (r * np.sin(gamma))[:, None] * E)
    return Kinematics(wheels, driven, J1, J2, E, rollers, constraints, motions, K_plus, reach)


def row_sizes(rows: Array, reach: float) -> Array:
    """Largest values of rows times velocity, of a motion of 1 m/s in any direction, shape (n,)."""
    return np.asarray(np.hypot(np.hypot(rows[:, 0], rows[:, 1]), rows[:, 2] / reach))


def _holders(wheels: Sequence[Wheel]) -> tuple[list[int], list[int]]:
    """Places of the wheels that hold sideways, and of those that do not turn."""
    sideways = [i for i, w in enumerate(wheels) if w.held]
    return sideways, [i for i, w in enumerate(wheels) if w.drive == "blocked"]


def _null_space(rows: Array) -> Array:
    """Columns whose sums are all that the rows turn to 0, with as many zeros and ones as can be."""
    _, values, vectors = np.linalg.svd(rows) if len(rows) else (None, np.zeros(0), np.eye(3))
    rank = int((values > _NOTHING).sum())
    basis, place = vectors[rank:].copy(), 0
    for column in range(3):  # Gauss and Jordan
        rest = np.abs(basis[place:, column])
        if not rest.size or rest.max() < _NOTHING:
            continue
        pivot = place + int(rest.argmax())
        basis[[place, pivot]] = basis[[pivot, place]]
        basis[place] /= basis[place, column]
        others = np.arange(len(basis)) != place
        basis[others] -= basis[others, column : column + 1] * basis[place]
        place += 1
    basis[np.abs(basis) < _NOTHING] = 0.0
    return basis.T


def _seen(rolling: Array, motions: Array, scale: Array) -> None:
    """No motion that the set allows leaves all driven wheels at rest."""
    plain = motions / scale[:, None]
    _, values, vectors = np.linalg.svd(rolling * scale @ plain)
    if len(values) == plain.shape[1] and values[-1] > _LEAST * values[0]:
        return
    motion = scale * (plain @ vectors[-1])
    x, y, turn = motion * np.sign(motion[np.abs(motion).argmax()])
    sliding = {"forwards": x, "to the left": y}
    words = [f"{v:.3g} m/s {name}" for name, v in sliding.items() if abs(v) > _LEAST]
    words += [f"{turn:.3g} rad/s turning"] if abs(turn) > _LEAST else []
    raise InputError(f"platform: it can move with its driven wheels at rest ({', '.join(words)}); check their angles")


def columns(values: Any, entries: int, what: str) -> Array:
    """Figures as columns of floats."""
    rows = np.asarray(values, dtype=float)
    if rows.ndim == 0 or rows.shape[0] != entries:
        raise InputError(f"{what}: expected {entries} rows, got an array of shape {rows.shape}")
    if not np.isfinite(rows).all():
        place = np.argwhere(~np.isfinite(rows))[0]
        at = f" at sample {', '.join(str(k) for k in place[1:])}" if rows.ndim > 1 else ""
        raise InputError(f"{what}: row {place[0] + 1}{at} is not a finite number")
    return rows


def map_columns(matrix: Array, values: Array) -> Array:
    """A matrix times columns with any number of axes of samples."""
    if values.ndim <= 2:
        return matrix @ values
    return (matrix @ values.reshape(len(values), -1)).reshape(-1, *values.shape[1:])


def to_robot(theta: Any, xi_dot: Any) -> Array:
    """Velocity in the robot's frame, (22)."""
    return eq.robot_velocity(np.asarray(theta, dtype=float), *columns(xi_dot, 3, "velocity in the world"))


def seen_by_robot(theta: Any, velocity: Array, acceleration: Array) -> tuple[Array, Array]:
    """Velocity and its rate of change in the robot's frame, of those in the world: dη/dt = R ξ̈ + Ṙ ξ̇.

    What the robot's own axes see of the acceleration changes as they turn.
    """
    eta, rate = to_robot(theta, velocity), to_robot(theta, acceleration)
    rate[0] += velocity[2] * eta[1]
    rate[1] -= velocity[2] * eta[0]
    return eta, rate


def to_world(theta: Any, eta: Any) -> Array:
    """Velocity in the world, (31); the other way round of ``to_robot``."""
    return eq.world_velocity(np.asarray(theta, dtype=float), *columns(eta, 3, "velocity of the platform"))


def wheel_speeds(k: Kinematics, eta: Any) -> Array:
    """Speeds of all wheels [rad/s], (32); shape (N, ...)."""
    velocity = columns(eta, 3, "velocity of the platform")
    check_allowed(k, velocity, "velocity of the platform")
    return map_columns(k.E, velocity)


def check_allowed(k: Kinematics, eta: Array, what: str, unit: str = "m/s") -> None:
    """Refuse a velocity, or an acceleration, that would slide a held wheel or turn a blocked one."""
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
    """Velocity of the platform from the speeds of its driven wheels, (54); shape (3, ...)."""
    return map_columns(k.K_plus, columns(speeds, len(k.driven), "speeds of the driven wheels"))
