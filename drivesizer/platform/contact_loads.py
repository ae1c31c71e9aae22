r"""Forces of the floor on a platform: its slope pulls, and its wheels share the weight.

The floor is a plane with a slope; uphill has a direction in the world. Wheels and casters are taken as equally stiff
on a stiff frame: loads lie on a plane over the contact points, :math:`N_i = a + b x_i + c y_i`, in balance with the
weight, the forces at the floor and the height of the centre of mass.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from drivesizer.errors import InputError
from drivesizer.platform.matrix_equation import Array
from drivesizer.platform.wheels import Platform

__all__ = ["LEVEL", "Ground", "centre_acceleration", "contact_loads", "weight_along"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Ground:
    """The floor: figures, or columns over samples."""

    slope: Any = 0.0  # rad
    uphill: Any = 0.0  # rad, direction in the world
    gravity: float = 9.80665  # m/s^2

    def __post_init__(self) -> None:
        for name in ("slope", "uphill", "gravity"):
            if not np.isfinite(getattr(self, name)).all():
                raise InputError(f"ground: {name} must be a finite number")
        if not (np.abs(self.slope) < np.pi / 2.0).all():
            raise InputError("ground: slope must lie between -90 deg and 90 deg")


LEVEL = Ground()


def _downhill(theta: Any, ground: Ground) -> tuple[Array, Array]:
    """Gravity along the floor, forwards and to the left [m/s^2]."""
    pull = ground.gravity * np.sin(ground.slope)
    towards = np.asarray(ground.uphill, dtype=float) - np.asarray(theta, dtype=float)
    return -pull * np.cos(towards), -pull * np.sin(towards)


def weight_along(platform: Platform, theta: Any = 0.0, ground: Ground = LEVEL) -> Array:
    """Force and moment of the weight along the floor [N, N, N*m], in the robot's axes.

    Parameters
    ----------
    platform
        Its mass and where it is.
    theta
        Heading in the world [rad]; one, or one per sample.
    ground
        The floor.

    Returns
    -------
    Array
        Shape (3, ...); (3,) where it is the same for all samples.
    """
    x, y = (platform.mass * g for g in _downhill(theta, ground))
    return np.array(np.broadcast_arrays(x, y, platform.x * y - platform.y * x))


def centre_acceleration(platform: Platform, eta: Array, eta_dot: Array) -> Array:
    """Acceleration of the centre of mass, in the robot's axes [m/s^2]; shape (2, ...).

    Parameters
    ----------
    platform
        Where its centre of mass is.
    eta, eta_dot
        Velocity and acceleration of the reference point as the robot sees them, shape (3, ...) [m/s, m/s, rad/s and
        per second]; the axes turn, so the velocity counts.

    Returns
    -------
    array
        Along and across the robot [m/s^2], shape (2, ...).
    """
    (forward, aside, turn), (gain_x, gain_y, spin) = eta, eta_dot
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
    >>> from drivesizer.platform.wheels import Wheel
    >>> cart = Platform(wheels=tuple(Wheel(x=x, y=0.0, radius=0.1) for x in (-0.2, 0.3)), mass=50.0, inertia=1.0)
    >>> contact_loads(cart, ground=Ground(gravity=10.0))  # levers 0.3 and 0.2 of 0.5
    array([300., 200.])
    """
    places = np.array(platform.contacts)
    middle = places.mean(axis=0)
    apart = places - middle
    normal = platform.mass * ground.gravity * np.cos(ground.slope)
    floor = [platform.mass * (np.asarray(a) - g) for a, g in zip(accelerated, _downhill(theta, ground), strict=True)]
    lever = [c - m for c, m in zip((platform.x, platform.y), middle, strict=True)]
    tilt = [normal * c - platform.height * f for c, f in zip(lever, floor, strict=True)]
    lean = np.array(np.broadcast_arrays(*tilt, np.zeros(samples)))[:2]
    share = apart @ np.linalg.pinv(apart.T @ apart, rcond=1e-12, hermitian=True)
    return np.asarray(normal / len(places) + np.tensordot(share, lean, axes=1))
