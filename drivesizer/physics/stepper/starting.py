"""Starting of steppers without a ramp, and their natural frequency.

References
----------
.. [1] P. Acarnley, *Stepping Motors: a guide to theory and practice*, 4th ed., IET, 2002, chapter 4.
"""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["START_BAND", "natural_frequency", "start_speed", "start_speed_with"]

START_BAND = 1.5  # of the speed at which a rotor starts without a ramp: one printed figure, 1.37 of the ideal


def natural_frequency(teeth: Any, holding_torque: Any, inertia: Any) -> Any:
    r"""Frequency of small swings about a held position [Hz], [1] section 4.3.

    .. math:: f = \frac{1}{2\pi} \sqrt{\frac{p\, T_h}{J}}

    Parameters
    ----------
    teeth
        Of the rotor.
    holding_torque
        [N*m].
    inertia
        Of rotor and load at the motor's shaft [kg*m^2].

    Returns
    -------
    float or array
        [Hz].

    Examples
    --------
    >>> round(float(natural_frequency(50.0, 0.59, 82e-7)), 1)
    301.9
    """
    return np.sqrt(teeth * holding_torque / inertia) / (2.0 * np.pi)


def start_speed(teeth: Any, torque: Any, inertia: Any, load_torque: Any = 0.0) -> Any:
    r"""Largest speed to which the field may jump for a rotor at rest to follow, undamped.

    Seen from the field the rotor moves backward; it may not reach the unstable balance of torque T and load T_L:

    .. math:: \tfrac{1}{2} J w^2 = \tfrac{1}{p} \left[2 T \cos\delta - T_L (\pi - 2\delta)\right],
        \quad \sin\delta = T_L / T

    Parameters
    ----------
    teeth
        Of the rotor.
    torque
        Largest at low speed [N*m].
    inertia
        Of rotor and load at the motor's shaft [kg*m^2].
    load_torque
        Against the motion [N*m].

    Returns
    -------
    float or array
        [rad/s]; 0 where the load is more than the torque. Unloaded p w is twice the natural frequency.

    Examples
    --------
    >>> swing = 2.0 * np.pi * natural_frequency(50.0, 0.59, 82e-7)
    >>> float((50.0 * start_speed(50.0, 0.59, 82e-7) / swing).round(9))
    2.0
    """
    ratio = np.clip(load_torque / torque, 0.0, 1.0)
    angle = np.arcsin(ratio)
    work = 2.0 * np.cos(angle) - ratio * (np.pi - 2.0 * angle)
    return np.sqrt(2.0 * torque * np.maximum(work, 0.0) / (teeth * inertia))


def start_speed_with(alone: Any, rotor_inertia: Any, inertia: Any, load_torque: Any, torque: Any) -> Any:
    r"""Speed at which a motor starts with its load, from that at which its rotor alone does.

    .. math:: w = \frac{w_0}{\sqrt{1 + J_L / J_r}}

    as makers print it, times what the load's torque leaves of it by ``start_speed``.

    Parameters
    ----------
    alone
        Of the rotor, unloaded [rad/s].
    rotor_inertia, inertia
        Of the rotor, and of rotor and load together at its shaft [kg*m^2].
    load_torque, torque
        Against the motion, and the motor's at low speed [N*m].

    Returns
    -------
    float or array
        [rad/s].

    Examples
    --------
    >>> float(start_speed_with(100.0, 1e-5, 4e-5, 0.0, 0.5))
    50.0
    """
    left = start_speed(1.0, torque, 1.0, load_torque) / start_speed(1.0, torque, 1.0)
    return alone * np.sqrt(rotor_inertia / inertia) * left
