r"""Holding a load by a brake, and stopping it: on figures or columns.

Held at rest, friction helps: the load would have to turn gears and belt backward, so that of its torque T

.. math:: M = T \frac{e_b}{i_b} \frac{e_g}{i_g}

reaches the brake, with the efficiencies that hold wherever the load drives the motor. Static friction is no less than
that; what vibration may take of it is what a safety factor is for. Friction of the load itself, of guides, screws
and a further stage is not counted on, but what locks itself passes on nothing. In a stop no friction is counted on at
all: kinetic energy and weight go to the brake as through gears without loss, and the weight pulls in the direction of
the motion.
Symbols: J inertia [kg*m^2], w speed [rad/s], M torque [N*m], t time [s]; all at the brake's shaft.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["SLIPPING", "Stop", "held_by_brake", "held_by_friction", "released_power", "stop"]

SLIPPING = 1.0 / 3.0, 1.0
"""Torque of a slipping brake as a share of its static torque, where none is printed: no less than the one, no more than
the other. Printed shares are 0.37 to 0.63 with permanent magnets (11 brakes of Bosch Rexroth MS2E and Siemens 1FK2) and
1.0 with springs (two of Siemens)."""

Array = NDArray[np.float64]


class Stop(NamedTuple):
    """One stop by a brake that slips until the load stands."""

    energy: Any  # J, that its linings take; infinite where the load is stronger
    time: Any  # s, until it stands
    angle: Any  # rad, that its shaft turns meanwhile


def held_by_brake(torque: Any, ratio: Any, efficiency: Any) -> Any:
    """Torque that reaches a brake at the motor's shaft from a load at rest [N*m].

    Parameters
    ----------
    torque
        That holds the load at the gearhead's output [N*m].
    ratio, efficiency
        Of the gearhead [1]; the efficiency where the load drives the motor.

    Returns
    -------
    float or array

    Examples
    --------
    >>> held_by_brake(12.0, 20.0, 0.75)
    0.45
    """
    return torque * efficiency / ratio


def held_by_friction(motor: Any) -> Any:
    """Torque at a motor's shaft that its own friction and detent hold without current [N*m].

    Parameters
    ----------
    motor
        Figures by field name: ``friction_torque``, static, and ``detent_torque`` where it has one [N*m]; NaN unknown.

    Returns
    -------
    float or array
        The printed ones; 0 of what no data sheet gives.

    Examples
    --------
    >>> float(held_by_friction({"friction_torque": 0.02, "detent_torque": float("nan")}))
    0.02
    """
    return np.nan_to_num(motor["friction_torque"]) + np.nan_to_num(motor["detent_torque"])


def released_power(brake: Any) -> Any:
    """Power that keeps a brake released [W]: the lowered one where it is printed; 0 where it is unknown.

    Parameters
    ----------
    brake
        Figures by field name, ``power`` and ``holding_power`` [W]; NaN unknown.

    Returns
    -------
    float or array

    Examples
    --------
    >>> float(released_power({"power": 12.0, "holding_power": 3.0}))
    3.0
    """
    kept = np.where(np.isnan(brake["holding_power"]), brake["power"], brake["holding_power"])
    return np.where(np.isnan(kept), 0.0, kept)


def stop(inertia: Any, speed: Any, brake: Any, load: Any, engage_time: Any) -> Stop:
    r"""Energy, time and angle of an emergency stop from a speed, the motor without current.

    .. math::
        w_1 = w + \frac{M_L}{J} t_e, \quad \dot w = \frac{M_B - M_L}{J}, \quad
        W = \frac{J w_1^2}{2} \frac{M_B}{M_B - M_L}, \quad t = t_e + \frac{w_1}{\dot w}

    Until the brake has its torque, at :math:`t_e`, the load drives alone.

    Parameters
    ----------
    inertia
        Of all that turns, the load's part over the square of the ratio [kg*m^2].
    speed
        When power is lost [rad/s].
    brake
        Torque while it slips, M_B [N*m].
    load
        Torque of the load's weight in the direction of the motion, M_L, 0 or more [N*m].
    engage_time
        Until the brake has its torque [s]; NaN unknown, which leaves the time open, and all where a load drives.

    Returns
    -------
    Stop
        Infinite where the brake is no stronger than the load.

    References
    ----------
    .. [1] VDI 2241 part 1, as makers of spring-applied brakes print it: :math:`Q = J n^2 / 182.5 \cdot
       M_K / (M_K - M_L)`, with n in rpm and :math:`182.5 = 2 (60 / 2 \pi)^2`.

    Examples
    --------
    >>> found = stop(0.02, 100.0, 10.0, 0.0, 0.05)
    >>> found.energy, found.time, found.angle
    (100.0, 0.25, 15.0)
    """
    free = np.where(np.asarray(load) == 0.0, 0.0, load * engage_time)  # N*m*s
    with np.errstate(divide="ignore", invalid="ignore"):
        first = speed + free / inertia
        net = np.where(brake > load, brake - load, np.where(np.isnan(brake + load), np.nan, 0.0))
        moving = np.asarray(speed) > 0.0
        energy = np.where(moving, 0.5 * inertia * first**2 * brake / net, 0.0)
        slowing = inertia * first / net
        angle = speed * engage_time + 0.5 * free / inertia * engage_time + 0.5 * first * slowing
    time = np.where(moving, engage_time + slowing, 0.0)
    return Stop(*(x.item() if x.ndim == 0 else x for x in (energy, time, np.where(moving, angle, 0.0))))
