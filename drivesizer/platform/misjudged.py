"""A platform as it is, against its robot model."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

from drivesizer.errors import InputError
from drivesizer.platform.wheels import Payload, Platform, loaded

__all__ = ["EXACT", "Misjudged", "actual", "per_wheel"]

_LARGEST = 10.0  # of a relative error, m or rad


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
                if not abs(one) < _LARGEST:  # written so that NaN fails too
                    raise InputError(f"misjudged: {f.name} must be a number below {_LARGEST:g}, got {one!r}")
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
