"""Wheels, casters and the platform on them, as records; and a platform as it is, against its robot model."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Literal

from drivesizer.errors import InputError

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
    def contacts(self) -> list[tuple[float, float]]:
        """Contact points of wheels, then of casters [m]."""
        return [(w.x, w.y) for w in self.wheels] + [(c.x, c.y) for c in self.casters]


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
    """The platform after a motor has failed: its wheel turns freely with the rotor, or not at all.

    Parameters
    ----------
    platform
        With all motors.
    wheel
        Which one, counted from 1 as in Table 1.
    blocked
        Whether brake or gear hold the wheel.

    Returns
    -------
    Platform
        With that wheel free or blocked.

    Raises
    ------
    InputError
        When there is no such wheel, or no driven one is left.
    """
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
            for one in value if isinstance(value, tuple) else (value,):
                if not abs(one) < _LARGEST_ERROR:  # written so that NaN fails too
                    raise InputError(f"misjudged: {f.name} must be a number below {_LARGEST_ERROR:g}, got {one!r}")
        if not 1.0 + min(per_wheel(self.motor, 0, "motor")) >= 0.0:
            raise InputError(f"misjudged: motor must be -1 or more, got {self.motor!r}")


def per_wheel(value: float | Sequence[float], wheels: int, what: str) -> tuple[float, ...]:
    """A figure for each wheel; 0 wheels: as many as there are.

    Parameters
    ----------
    value
        One figure for all wheels, or one for each.
    wheels
        How many there are; 0 where that is not known.
    what
        Name of the figure, for a message.

    Returns
    -------
    tuple of float
        One for each wheel.

    Raises
    ------
    InputError
        When there are as many figures as neither one nor wheels.
    """
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
    >>> from drivesizer.platform.wheels import Wheel
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
