"""Power and energy that steppers draw: torque times speed, and the loss of a current that always flows."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["copper_loss", "electrical_energy", "idle_loss"]

Array = NDArray[np.float64]


def copper_loss(phase_current: Any, resistance: Any) -> Any:
    """Loss of both windings at rated current [W], at any speed at most, at rest too.

    Parameters
    ----------
    phase_current
        Rated [A].
    resistance
        Of a phase [ohm].

    Returns
    -------
    float or array
        [W].

    >>> copper_loss(2.0, 1.6)
    12.8
    """
    return 2.0 * resistance * phase_current**2


def idle_loss(speed: Array, idle: float | None) -> Array:
    """Share of the copper loss in each segment: where the motor rests, that of its idle current.

    Parameters
    ----------
    speed
        At both ends of each segment, shape (segments, 2).
    idle
        Idle current, as a share of the current in motion [1]; None: all of it flows at rest.

    Returns
    -------
    array
        Shape (segments,) [1].

    Examples
    --------
    >>> idle_loss(np.array([[0.0, 5.0], [0.0, 0.0]]), 0.5).tolist()
    [1.0, 0.25]
    """
    return np.where(speed.any(axis=1), 1.0, 1.0 if idle is None else idle**2)


def electrical_energy(duration: Array, torque: Array, speed: Array, loss: Array) -> tuple[Array, Array, Array]:
    """Energy that motors with a constant loss draw and return over a cycle, and their largest power.

    Parameters
    ----------
    duration
        Of each segment [s], shape (segments,), or of each motor's own (motors, segments).
    torque, speed
        Of the motors at both ends of each segment, straight lines within, shape (motors, segments, 2) [N*m], [rad/s].
    loss
        Of each motor, or of each in each segment, shape (motors, segments) [W].

    Returns
    -------
    tuple of arrays
        Drawn and returned [J], largest power drawn [W], each of shape (motors,).

    Examples
    --------
    A brake that takes 20 W at first and nothing at last, of a motor that loses 5 W: (20 - 5)²/(2·20) J are returned.

    >>> one = np.array([[[-2.0, -2.0]]]), np.array([[[10.0, 0.0]]])
    >>> [float(x[0]) for x in electrical_energy(np.array([1.0]), *one, np.array([5.0]))]
    [0.625, 5.625, 5.0]
    """
    (t0, t1), (w0, w1) = np.moveaxis(torque, 2, 0), np.moveaxis(speed, 2, 0)
    a, b = (t1 - t0) * (w1 - w0), t0 * (w1 - w0) + w0 * (t1 - t0)
    c = t0 * w0 + (loss if loss.ndim > 1 else loss[:, None])
    with np.errstate(divide="ignore", invalid="ignore"):
        q = -0.5 * (b + np.copysign(np.sqrt(b**2 - 4.0 * a * c), b))
        cuts = [np.nan_to_num(np.clip(x, 0.0, 1.0), nan=1.0) for x in (q / a, c / q)]
        top = np.nan_to_num(np.clip(-b / (2.0 * a), 0.0, 1.0), nan=0.0)
    edges = np.sort(np.stack([np.zeros_like(c), *cuts, np.ones_like(c)], axis=2), axis=2)
    work = ((a[..., None] * edges / 3.0 + b[..., None] / 2.0) * edges + c[..., None]) * edges
    parts = duration[..., None] * np.diff(work, axis=2)
    peak = np.maximum(np.maximum(c, a + b + c), (a * top + b) * top + c).max(axis=1)
    unknown = np.where(np.isnan(c).any(axis=1), np.nan, 0.0)
    drawn, returned = (np.maximum(side, 0.0).sum((1, 2)) + unknown for side in (parts, -parts))
    return drawn, returned, np.maximum(peak, 0.0) + unknown
