r"""Life of gears: mean torque by speed and time, nominal life by rated life, speed and exponent.

Symbols: T output torque [N*m], n speed [rad/s], t time [s], p exponent of the life: 3 of the ball bearing of a wave
generator, 10/3 of roller bearings (ISO 281). Index r is of the rating, av of the mean.

Sources: Harmonic Drive CSF and CSG component sets, equation 8 and rated lives; Harmonic Drive 1021387 (12/2018),
equations 30.2, 30.5, 32.2 and 32.3; ISO 281 for the exponents.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.elements.quadrature import FIVE

__all__ = ["MEDIAN", "gear_life", "mean_load", "turned_load"]

Array = NDArray[np.float64]
MEDIAN = 5.0  # L_50 over L_10, Harmonic Drive 1021387, equation 32.3
_NODES, _WEIGHTS = FIVE


def turned_load(
    duration: Array, load: Array, speed: Array, exponent: float, force: Callable[[Array], Array] = np.abs
) -> Any:
    r"""Mean over the cycle of a load to an exponent, times speed: what wears a bearing out.

    .. math:: \frac{1}{t_c} \int F^p \, |n| \, dt

    Parameters
    ----------
    duration
        Of each segment [s], shape (segments,) or (segments, cycles).
    load, speed
        At both ends of each segment, straight between them and without change of sign, shape (segments, 2) or
        (segments, 2, cycles); speed in [rad/s].
    exponent
        p.
    force
        Load that counts, as a function of that which is straight over time.

    Returns
    -------
    float or array
        In the unit of the load to the p, times [rad/s]; rests are part of the cycle and add nothing.

    Examples
    --------
    2 N·m at 3 rad/s for 1 s, then 3 s at rest: 8 · 3 / 4.

    >>> turned_load(np.array([1.0, 3.0]), np.full((2, 2), 2.0), np.array([[3.0, 3.0], [0.0, 0.0]]), 3.0).item()
    6.0
    """
    share = ((_NODES + 1.0) / 2.0).reshape(1, -1, *[1] * (load.ndim - 2))

    def at(ends: Array) -> Array:
        return ends[:, :1] + (ends[:, 1:] - ends[:, :1]) * share

    weights = (_WEIGHTS / 2.0).reshape(share.shape)
    each = (force(at(load)) ** exponent * np.abs(at(speed)) * weights).sum(axis=1)
    return (duration * each).sum(axis=0) / duration.sum(axis=0)


def mean_load(turned: Any, mean_speed: Any, exponent: float) -> Any:
    r"""Equivalent mean of a load by speed and time.

    .. math:: T_{av} = \left( \frac{\sum |n_i| \, t_i \, |T_i|^p}{\sum |n_i| \, t_i} \right)^{1/p}

    Parameters
    ----------
    turned
        Of ``turned_load``.
    mean_speed
        Mean of the amount of the speed over the cycle, rests included [rad/s].
    exponent
        p.

    Returns
    -------
    float or array
        In the unit of the load; 0 where nothing turns.

    Examples
    --------
    150 N·m for 0.2 s at 10 rpm, 82 N·m for 3 s at 20 rpm, 130 N·m for 0.3 s at 10 rpm, 0.2 s of rest (Honpine,
    selection of harmonic reduction gears): 89 N·m.

    >>> time, torque = np.array([0.2, 3.0, 0.3, 0.2]), np.array([150.0, 82.0, 130.0, 0.0])
    >>> speed = np.array([10.0, 20.0, 10.0, 0.0]) * np.pi / 30.0
    >>> turned = turned_load(time, np.stack([torque] * 2, 1), np.stack([speed] * 2, 1), 3.0)
    >>> round(mean_load(turned, time @ speed / time.sum(), 3.0).item())
    89
    """
    return np.where(mean_speed > 0.0, (turned / np.where(mean_speed > 0.0, mean_speed, 1.0)) ** (1.0 / exponent), 0.0)


def gear_life(rated_life: Any, rated_torque: Any, rated_speed: Any, turned: Any, exponent: Any) -> Any:
    r"""Nominal life of a gear, rests of the cycle included.

    .. math:: L = L_r \left( \frac{T_r}{T_{av}} \right)^p \frac{n_r}{n_{av}}
                = \frac{L_r \, T_r^p \, n_r}{\frac{1}{t_c} \int |T|^p |n| \, dt}

    Parameters
    ----------
    rated_life
        L_r at rated torque and speed [s].
    rated_torque
        T_r at the output [N*m].
    rated_speed
        n_r at the input [rad/s].
    turned
        Of ``turned_load``: output torque, times speed at the input.
    exponent
        p.

    Returns
    -------
    float or array
        Life [s]; infinite where nothing turns.

    Notes
    -----
    Harmonic Drive CSF and CSG, equation 8; 1021387, equation 32.2. The mean speed of the maker has the pauses in it
    (equation 30.5), so that the hours are those of the machine and not of the gear alone.

    Examples
    --------
    A rated life of 7000 h at 294 N·m and 2000 rpm, a mean of 319 N·m and 1440 rpm: 7610 h (Harmonic Drive, selection
    example of CSF-40-120, figures as remembered).

    >>> rpm = np.pi / 30.0
    >>> round(gear_life(7000.0, 294.0, 2000.0 * rpm, 319.0**3 * 1440.0 * rpm, 3.0), -1)
    7610.0
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return rated_life * (rated_torque**exponent * rated_speed / turned)
