"""Torque, current and speed that a load cycle requires of every candidate's motor.

The motor's torque is linear in the six functions of time of ``cycle_at_gearhead``, with coefficients that depend on
the candidate alone, so that the RMS current of every candidate is a quadratic form in one matrix.
Symbols: i ratio, e efficiency, J inertia [kg*m^2], T torque [N*m], w speed [rad/s], K total ratio.
"""

from __future__ import annotations

from itertools import combinations
from math import isnan, nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.back_emf import back_emf_constant
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
from drivesizer.physics.figures import once_per_part

__all__ = [
    "DRY_SHARE", "SLOTLESS", "Coefficients", "Demands", "coefficients", "demands", "drive_inertia", "flange_loss",
    "friction", "gear_loss", "lost_in_gearhead", "mean_gear_loss", "nominal_friction",
]  # fmt: skip

SLOTLESS = "slotless"  # a winding without iron teeth
DRY_SHARE = {SLOTLESS: 0.37, "": 0.55}  # of a brushless motor's no-load torque, by its winding; sources: ``friction``
Array = NDArray[np.float64]
_APART = 1e-9  # functions of time that are less apart are one function, but for a factor


class Demands(NamedTuple):
    """Required torque and current of each candidate's motor: SI columns."""

    rms_torque: Array  # N*m, friction of the motor included
    rms_current: Array  # A
    peak_speed: Array  # rad/s
    coefficients: Array  # (candidates, 6): motor torque from the functions
    total_ratio: Array  # of the gearhead
    back_emf: Array  # V*s/rad, of the motor
    left_out: NDArray[np.bool_]  # (candidates, 6): of which coefficient a part is unknown, that is left out

    @property
    def complete(self) -> NDArray[np.bool_]:
        """False: lower bounds, as an inertia or friction is unknown that would require more."""
        return ~lacking(self.left_out)

    def surplus(self, k_t: Array) -> Array:
        """Back-EMF constant less torque constant, per speed at the gearhead's output [V*s/rad]."""
        found: Array = (self.back_emf - k_t) * self.total_ratio
        return found


class Coefficients(NamedTuple):
    """Part of the demands that hangs on the drives alone, and on which functions ever act: columns over candidates."""

    torque: Array  # (candidates, 6): motor torque from the functions, as far as it is known
    left_out: NDArray[np.bool_]  # (candidates, 6): of which a part is unknown
    back_emf: Array  # V*s/rad, of the motor


def demands(
    at: AtGearhead,
    motor: Any,
    gearhead: Any,
    encoder: Any,
    braking: Any = 0.0,
    known: Coefficients | None = None,
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
    known
        What ``coefficients`` gives of the same parts, where it is at hand.

    Returns
    -------
    Demands
        Columns over candidates.

    Notes
    -----
    Friction is that of ``friction``, e and T_0 are those of ``gear_loss``.
    """
    i, k_t = gearhead["ratio"], motor["torque_constant"]
    c, left_out, back_emf = known or coefficients(at.acts, motor, gearhead, encoder, braking)
    rms_torque = np.sqrt(np.maximum(_least_square(at, c, left_out), 0.0))
    return Demands(rms_torque, rms_torque / k_t, at.peak_speed * i, c, i, back_emf, left_out)


def _least_square(at: AtGearhead, c: Array, left_out: NDArray[np.bool_]) -> Array:
    """Mean square of c f(t), with of what is left out the amounts, 0 or more, that make it least.

    It is a convex function of the amounts: the least is met where the slope by some of them is 0 and the others are 0.
    """
    slope = at.slope(c)
    found: Array = (slope * c).sum(1)
    places = [k for k in (ACCELERATION, DIRECTION, SPEED) if left_out[:, k].any()]
    if not (left_out & (slope < 0.0))[:, places].any():  # more of any of them only adds
        return found
    rows = np.flatnonzero((left_out & (slope < 0.0))[:, places].any(axis=1))
    squares = {k: at.slope(np.broadcast_to(np.eye(6)[k], c.shape))[rows] for k in places}
    least = found[rows]
    for some in (list(some) for n in range(len(places)) for some in combinations(places, n + 1)):
        matrix, s = np.stack([squares[k][:, some] for k in some], axis=1), slope[rows][:, some]
        size = np.sqrt(np.einsum("rkk->rk", matrix))
        own = left_out[rows][:, some].all(axis=1) & (size > 0.0).all(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            matrix, s = matrix / (size[:, :, None] * size[:, None, :]), s / size
        own[own] = np.linalg.det(matrix[own]) > _APART
        amounts = -np.linalg.solve(matrix[own], s[own][:, :, None])[:, :, 0]
        of = np.flatnonzero(own)[(amounts >= 0.0).all(axis=1)]
        amounts = amounts[(amounts >= 0.0).all(axis=1)]
        least[of] = np.minimum(least[of], found[rows[of]] + (s[of] * amounts).sum(axis=1))
    found[rows] = least
    return found


def coefficients(acts: NDArray[np.bool_], motor: Any, gearhead: Any, encoder: Any, braking: Any = 0.0) -> Coefficients:
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
    i = gearhead["ratio"]
    e, idle = gear_loss(gearhead)
    coulomb, viscous = nominal_friction(motor)
    c = np.empty((len(i), 6))
    left_out = np.zeros(c.shape, np.bool_)
    inertia = drive_inertia(motor, gearhead, encoder, braking)
    unknown = {ACCELERATION: inertia, DIRECTION: coulomb, SPEED: viscous}
    for place, figure in unknown.items():
        left_out[:, place] = np.isnan(figure) & acts[place]
    c[:, DRIVING] = 1 / (i * e)
    c[:, BRAKING] = e / i
    c[:, AT_REST] = 1 / i
    known = drive_inertia(motor, gearhead, encoder, braking, unknown=0.0) if left_out.any() else inertia
    c[:, ACCELERATION] = known * i
    c[:, DIRECTION] = np.nan_to_num(coulomb) + idle
    c[:, SPEED] = np.nan_to_num(viscous) * i
    for place in np.flatnonzero(~acts).tolist():
        c[np.isnan(c[:, place]), place] = 0.0
    return Coefficients(c, left_out, back_emf_constant(motor))


def drive_inertia(motor: Any, gearhead: Any, encoder: Any = None, braking: Any = 0.0, *, unknown: float = nan) -> Any:
    r"""Inertia of a drive at its motor's shaft, :math:`J_m + J_g + J_e + J_b` [kg*m^2].

    Parameters
    ----------
    motor, gearhead, encoder
        Figures by field name, of one or columns; None without an encoder. An unknown inertia of an encoder, thousands
        of times smaller than a load's, counts 0.
    braking
        Of a brake as the motor's shaft feels it [kg*m^2].
    unknown
        What an unknown inertia of the others counts [kg*m^2].

    Returns
    -------
    float or array
        NaN where one is unknown, unless that counts.

    Examples
    --------
    >>> motor, gearhead, encoder = {"rotor_inertia": 10e-7}, {"inertia": 0.8e-7}, {"inertia": 0.1e-7}
    >>> round(float(drive_inertia(motor, gearhead, encoder, 1.3e-7)), 12)
    1.22e-06
    >>> round(float(drive_inertia(motor, {"inertia": nan}, encoder, unknown=0.0)), 12)
    1.01e-06
    """
    found = [motor["rotor_inertia"], gearhead["inertia"], braking]
    if not isnan(unknown):
        found = [np.nan_to_num(x, nan=unknown) for x in found]
    own = 0.0 if encoder is None else np.nan_to_num(encoder["inertia"])
    return found[1] + own + found[0] + found[2]


@once_per_part
def nominal_friction(motor: Any) -> tuple[Array, Array]:
    """``friction`` of motors as they are in the catalogue."""
    return friction(motor)


def friction(motor: Any, dry: Any = 1.0) -> tuple[Array, Array]:
    r"""Friction torque of motors at any speed [N*m], and per speed of theirs [N*m*s/rad].

    The catalogue's own, where it has both; where it has one, the other is what :math:`k_t I_0` leaves, the torque lost
    at the no-load speed :math:`w_0`. Where it has neither, the share s of that is dry:

    .. math:: M_c = s\, k_t I_0, \qquad b = (1 - s)\, k_t I_0 / w_0

    s is 1 of a brushed motor, and where :math:`w_0` is unknown. Of a brushless one it is that of bearings and
    hysteresis, :data:`DRY_SHARE`: 0.37 without slots, the median of 70 Faulhaber motors that print both (5-95 %: 0.14
    to 0.55); 0.55 otherwise, where cogging and the iron's hysteresis come to it: measured 0.80 (REV NEO), 0.57 to 0.68
    (NEO 550), 0.75 and more (Falcon 500), 0.5 to 0.7 (ODrive D5065, by the voltage), 0.14 to 0.7 (RI50), 0.13 (U8).

    Parameters
    ----------
    motor
        Figures of motors by field name: columns.
    dry
        Factor of s, which stays at most 1: that of a sample [1].

    Returns
    -------
    tuple of arrays
        The two, of each motor [N*m], [N*m*s/rad].
    """
    loss = motor["torque_constant"] * motor["no_load_current"]
    share = np.where(motor["winding"] == SLOTLESS, DRY_SHARE[SLOTLESS], DRY_SHARE[""]) * dry
    coulomb, viscous, w_0 = motor["friction_torque"], motor["viscous_friction"], motor["no_load_speed"]
    share = np.where((motor["kind"] == "brushed") | np.isnan(w_0), 1.0, np.minimum(share, 1.0))
    left = np.where(np.isnan(viscous), share * loss, np.maximum(loss - viscous * w_0, 0.0))
    rest = np.where(share < 1.0, (1.0 - share) * loss / w_0, 0.0)
    rest = np.where(np.isnan(coulomb), rest, np.maximum(loss - coulomb, 0.0) / w_0)
    return np.where(np.isnan(coulomb), left, coulomb), np.where(np.isnan(viscous), rest, viscous)


@once_per_part
def gear_loss(gearhead: Any) -> tuple[Array, Array]:
    r"""Losses of a gearhead: efficiency of the transmitted torque, and torque at its input without load [N*m].

    Without a no-load torque T_0 in the catalogue the efficiency e has all of it, that at continuous torque T_N. With
    one, the rest is proportional to torque, so that both make e at T_N; nothing where T_0 alone is more than that.

    .. math:: \frac{1}{e'} = \max\!\left(\frac{1}{e} - \frac{i\,T_0}{T_N},\ 1\right)

    Parameters
    ----------
    gearhead
        Figures of gearheads by field name: columns.

    Returns
    -------
    tuple of arrays
        Efficiency [1] and torque at the input [N*m], of each gearhead.
    """
    e, idle = gearhead["efficiency"], gearhead["no_load_torque"]
    known = ~np.isnan(idle + gearhead["continuous_torque"])
    share = 1 / e - gearhead["ratio"] * idle / gearhead["continuous_torque"]
    return np.where(known, 1 / np.maximum(share, 1.0), e), np.where(known, idle, 0.0)


def mean_gear_loss(at: AtGearhead, gearhead: Any) -> Array:
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
    driving, braking = at.moments[DRIVING, SPEED], at.moments[BRAKING, SPEED]
    return lost_in_gearhead(driving, braking, at.moments[DIRECTION, SPEED] * gearhead["ratio"], gearhead)


def lost_in_gearhead(driving: Any, braking: Any, speed: Any, gearhead: Any) -> Array:
    """Power that gearheads lose by that at their output, as ``mean_gear_loss`` prints it.

    Parameters
    ----------
    driving, braking
        Power that drives the load, above 0, and that brakes it, below 0 [W].
    speed
        Of the motor, without sign [rad/s].
    gearhead
        Figures of gearheads by field name: columns.

    Returns
    -------
    array
        [W].
    """
    e, idle = gear_loss(gearhead)
    found: Array = driving * (1.0 / e - 1.0) - braking * (1.0 - e) + idle * speed
    return found


def flange_loss(at: AtGearhead, gearhead: Any) -> Array:
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
    found: Array = mean_gear_loss(at, gearhead) / at.moments[DIRECTION, SPEED]
    return found
