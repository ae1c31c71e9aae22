"""Torque, current and speed that a load cycle requires of every candidate's motor.

The motor's torque is linear in the six functions of time of ``cycle_at_gearhead``, with coefficients that depend on
the candidate alone, so that the RMS current of every candidate is a quadratic form in one matrix.
Symbols: i ratio, e efficiency, J inertia [kg*m^2], T torque [N*m], w speed [rad/s], K total ratio.
"""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np

from drivesizer.physics.cycle_at_gearhead import (
    ACCELERATION,
    AT_REST,
    BRAKING,
    DIRECTION,
    DRIVING,
    SPEED,
    AtGearhead,
    lacking,
)
from drivesizer.physics.drive_train import drive_inertia, lost_in_gearhead, motor_and_gears, through_gears
from drivesizer.physics.figures import Array, Figure, Figures, Mask

_APART = 1e-9  # functions of time that are less apart are one function, but for a factor


class Demands(NamedTuple):
    """Required torque and current of each candidate's motor: SI columns."""

    rms_torque: Array  # N*m, friction of the motor included
    rms_current: Array  # A
    peak_speed: Array  # rad/s
    coefficients: Array  # (candidates, 6): motor torque from the functions
    total_ratio: Array  # of the gearhead
    back_emf: Array  # V*s/rad, of the motor
    left_out: Mask  # (candidates, 6): of which coefficient a part is unknown, that is left out

    @property
    def complete(self) -> Mask:
        """False: lower bounds, as an inertia or friction is unknown that would require more."""
        return ~lacking(self.left_out)

    def surplus(self, k_t: Array) -> Array:
        """Back-EMF constant less torque constant, per speed at the gearhead's output [V*s/rad]."""
        return (self.back_emf - k_t) * self.total_ratio


class Coefficients(NamedTuple):
    """Part of the demands that hangs on the drives alone, and on which functions ever act: columns over candidates."""

    torque: Array  # (candidates, 6): motor torque from the functions, as far as it is known
    left_out: Mask  # (candidates, 6): of which a part is unknown
    back_emf: Array  # V*s/rad, of the motor


def demands(
    at: AtGearhead, motor: Figures, gearhead: Figures, encoder: Figures | None, braking: Figure = 0.0
) -> Demands:
    r"""Torque and current of every candidate's motor.

    .. math:: \tau = \frac{T}{i e} \text{ or } \frac{T e}{i} + (J_m + J_g + J_e) i a + (k_t I_0 + T_0)\, \mathrm{sgn} w

    Parameters
    ----------
    at
        The load cycle at the gearhead's output.
    motor, gearhead, encoder
        Figures of the candidates' parts by field name: columns. An unknown inertia of rotor or gearhead and an unknown
        friction of the motor are taken as whatever makes the RMS torque least, so that the demands are then lower
        bounds. A figure whose function is 0 over the whole cycle has no effect and need not be known. The inertia of
        an encoder, thousands of times smaller than the load's, is left out.
    braking
        Inertia of a brake as the motor's shaft feels it [kg*m^2]; as a rotor's where it is unknown.

    Returns
    -------
    Demands
        Columns over candidates.

    Notes
    -----
    Friction, e and T_0 are those of ``drive_train``.
    """
    i, k_t = gearhead["ratio"], motor["torque_constant"]
    c, left_out, back_emf = coefficients(at.acts, motor, gearhead, encoder, braking)
    rms_torque = np.sqrt(np.maximum(_least_square(at, c, left_out), 0.0))
    return Demands(rms_torque, rms_torque / k_t, at.peak_speed * i, c, i, back_emf, left_out)


def _least_square(at: AtGearhead, c: Array, left_out: Mask) -> Array:
    """Mean square of c f(t), with of what is left out the amounts, 0 or more, that make it least.

    It is a convex function of the amounts: the least is met where the slope by some of them is 0 and the others are 0.
    """
    slope = at.slope(c)
    mean_square: Array = (slope * c).sum(1)
    places = [k for k in (ACCELERATION, DIRECTION, SPEED) if left_out[:, k].any()]
    if not (left_out & (slope < 0.0))[:, places].any():  # more of any of them only adds
        return mean_square
    rows = np.flatnonzero((left_out & (slope < 0.0))[:, places].any(axis=1))
    squares = {k: at.slope(np.broadcast_to(np.eye(6)[k], c.shape))[rows] for k in places}
    least = mean_square[rows]
    for functions in (list(functions) for n in range(len(places)) for functions in combinations(places, n + 1)):
        matrix, s = np.stack([squares[k][:, functions] for k in functions], axis=1), slope[rows][:, functions]
        size = np.sqrt(np.einsum("rkk->rk", matrix))
        own = left_out[rows][:, functions].all(axis=1) & (size > 0.0).all(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            matrix, s = matrix / (size[:, :, None] * size[:, None, :]), s / size
        own[own] = np.linalg.det(matrix[own]) > _APART
        amounts = -np.linalg.solve(matrix[own], s[own][:, :, None])[:, :, 0]
        of = np.flatnonzero(own)[(amounts >= 0.0).all(axis=1)]
        amounts = amounts[(amounts >= 0.0).all(axis=1)]
        least[of] = np.minimum(least[of], mean_square[rows[of]] + (s[of] * amounts).sum(axis=1))
    mean_square[rows] = least
    return mean_square


def coefficients(
    acts: Mask, motor: Figures, gearhead: Figures, encoder: Figures | None, braking: Figure = 0.0
) -> Coefficients:
    """Torque of every candidate's motor by the six functions, whatever the load cycle.

    Parameters
    ----------
    acts
        Which of the functions are ever not 0, shape (6,).
    motor, gearhead, encoder, braking
        As for ``demands``.

    Returns
    -------
    Coefficients
        Columns over candidates.
    """
    own = motor_and_gears(motor, gearhead, encoder, braking)
    i = own.ratio
    c = np.empty((len(i), 6))
    left_out = np.zeros(c.shape, np.bool_)
    unknown = {ACCELERATION: own.inertia, DIRECTION: own.coulomb, SPEED: own.viscous}
    for place, figure in unknown.items():
        left_out[:, place] = np.isnan(figure) & acts[place]
    c[:, DRIVING], c[:, BRAKING] = through_gears(i, own.efficiency)
    c[:, AT_REST] = 1 / i
    known = drive_inertia(motor, gearhead, encoder, braking, unknown=0.0) if left_out.any() else own.inertia
    c[:, ACCELERATION] = known * i
    c[:, DIRECTION] = np.nan_to_num(own.coulomb) + own.idle
    c[:, SPEED] = np.nan_to_num(own.viscous) * i
    for place in np.flatnonzero(~acts).tolist():
        c[np.isnan(c[:, place]), place] = 0.0
    return Coefficients(c, left_out, own.k_e)


def mean_gear_loss(at: AtGearhead, gearhead: Figures) -> Array:
    r"""Power that gearheads lose, mean over a cycle.

    .. math:: P_g = P_+ (1/e - 1) + P_- (1 - e) + T_0 \overline{|w|}

    with the mean power at the output that drives the load, P_+, and that which brakes it, P_-, and the speed w of the
    motor; e and T_0 are those of ``gear_loss``.

    Parameters
    ----------
    at
        The load cycle at the gearhead's output.
    gearhead
        Figures of gearheads by field name: columns.

    Returns
    -------
    array
        [W], of each gearhead.
    """
    driving, braking, speed = (at.moment(k, SPEED) for k in (DRIVING, BRAKING, DIRECTION))
    return lost_in_gearhead(driving, braking, speed * gearhead["ratio"], gearhead)


def flange_loss(at: AtGearhead, gearhead: Figures) -> Array:
    """Loss of gearheads over a cycle, per speed of their output, so that its mean is theirs.

    Parameters
    ----------
    at
        The load cycle at the gearhead's output.
    gearhead
        Columns over candidates by field name.

    Returns
    -------
    Array
        [W*s/rad]; 0 of a cycle at rest, NaN where the efficiency is unknown.
    """
    if not at.acts[SPEED]:
        return np.zeros(len(gearhead["ratio"]))
    return mean_gear_loss(at, gearhead) / at.moment(DIRECTION, SPEED)
