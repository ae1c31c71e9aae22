r"""Motor, gearhead and what turns with them, seen at the motor's shaft: ratio, inertia, friction and losses of a drive.

Whoever computes a drive has these from here: search, closed and open loop, prediction, platform and exports. All
functions take figures by field name, of one part or columns of them.

The voltage that a winding makes by turning is another figure than its torque per ampere. In an ideal machine k_e and
k_t are one figure, since power is conserved. Makers' figures differ: the torque per ampere is mostly that of stall,
where iron saturates and brushes lose some (brushed motors 13 to 33 % below k_e), or rests on a stall current that a
controller cut (k_t above k_e). The no-load speed at a voltage gives k_e itself:

.. math:: k_e = \frac{V - R I_0}{w_0}

Symbols: i ratio, e efficiency, J inertia [kg*m^2], M torque [N*m], w speed [rad/s], V nominal voltage [V], R resistance
[ohm], I_0 no-load current [A], w_0 no-load speed [rad/s], k_t torque constant [N*m/A], k_e back-EMF constant [V*s/rad].
"""

from __future__ import annotations

from math import isnan, nan
from typing import Generic, NamedTuple, TypeVar

import numpy as np

from drivesizer.physics.figures import Alike, Array, Figure, Figures, once_per_part

Column = TypeVar("Column")  # of candidates, or one figure
SLOTLESS = "slotless"  # a winding without iron teeth
SERVO = "geared servo"  # brushed, inside an actuator: its friction is that of the gear as well
DRY_SHARE = {"brushed": 0.65, SERVO: 0.45, "brushless": 0.55, SLOTLESS: 0.37}  # of the no-load torque; see ``friction``
ELECTRONICS = "integrated electronics"  # the commutation of a motor that has its controller inside
IDLE = {  # friction of gearheads without load: of the continuous torque, per stage, and the band, a factor either way
    "planetary": (0.02, 3.0), "spur": (0.02, 3.0), "strain wave": (0.09, 2.5),
}  # fmt: skip
_SAME = 0.0101  # two figures of three digits each, each off by half of its last one: 0.5 %, and 1 % between them
_OTHER = 2.0  # times k_t or a part of it: then w_0 and V are not of one winding


class MotorAndGears(NamedTuple, Generic[Column]):
    """A drive at its motor's shaft, as far as its parts say: columns, or figures of one; NaN unknown."""

    ratio: Column  # of the gearhead
    efficiency: Column  # of the torque that it transmits
    coulomb: Column  # N*m, friction of the motor at any speed
    idle: Column  # N*m, of the gearhead without load
    viscous: Column  # N*m*s/rad
    inertia: Column  # kg*m^2, see ``drive_inertia``
    k_t: Column  # N*m/A
    k_e: Column  # V*s/rad


def motor_and_gears(
    motor: Figures, gearhead: Figures, encoder: Figures | None = None, braking: Array | float = 0.0
) -> MotorAndGears[Array]:
    """Motors and gearheads as drives at the motor's shaft.

    Parameters
    ----------
    motor, gearhead, encoder, braking
        As for ``drive_inertia``.

    Returns
    -------
    MotorAndGears
        Of each candidate.
    """
    efficiency, idle = gear_loss(gearhead)
    coulomb, viscous = nominal_friction(motor)
    inertia = drive_inertia(motor, gearhead, encoder, braking)
    k_t, k_e = motor["torque_constant"], back_emf_constant(motor)
    return MotorAndGears(gearhead["ratio"], efficiency, coulomb, idle, viscous, inertia, k_t, k_e)


def through_gears(ratio: Figure, efficiency: Figure) -> tuple[Alike, Alike]:
    r"""Torque at the motor per torque at the output, where it drives the load and where the load drives it.

    .. math:: \frac{1}{i e} \; (T w > 0), \qquad \frac{e}{i} \; (T w < 0)

    Parameters
    ----------
    ratio, efficiency
        Of all gears between [1].

    Returns
    -------
    tuple
        Driving and braking [1].

    References
    ----------
    .. [1] H. Giberti, S. Cinquemani, G. Legnani, Effects of transmission mechanical characteristics on the choice of a
       motor-reducer, Mechatronics 20 (2010) 604-610.

    Examples
    --------
    >>> through_gears(20.0, 0.8)
    (0.0625, 0.04)
    """
    return 1 / (ratio * efficiency), efficiency / ratio


def drive_inertia(
    motor: Figures, gearhead: Figures, encoder: Figures | None = None, braking: Figure = 0.0, *, unknown: float = nan
) -> Alike:
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
    inertias = [motor["rotor_inertia"], gearhead["inertia"], braking]
    if not isnan(unknown):
        inertias = [np.nan_to_num(x, nan=unknown) for x in inertias]
    own = 0.0 if encoder is None else np.nan_to_num(encoder["inertia"])
    return inertias[1] + own + inertias[0] + inertias[2]


@once_per_part
def nominal_friction(motor: Figures) -> tuple[Array, Array]:
    """``friction`` of motors as they are in the catalogue."""
    return friction(motor)


def friction(motor: Figures, dry: Figure = 1.0) -> tuple[Array, Array]:
    r"""Friction torque of motors at any speed [N*m], and per speed of theirs [N*m*s/rad].

    The catalogue's own, where it has both; where it has one, the other is what :math:`k_t I_0` leaves, the torque lost
    at the no-load speed :math:`w_0`. Where it has neither, the share s of that is dry:

    .. math:: M_c = s\, k_t I_0, \qquad b = (1 - s)\, k_t I_0 / w_0

    s is 1 where :math:`w_0` is unknown, else :data:`DRY_SHARE` by what rubs:

    - brushed, 0.65: brushes and bearings; 0.70 of a Jameco that coasts, 0.48, 0.51, 0.66 and 0.68 of maxon's DCX 16 L,
      19 S, 16 S and 32 L by the no-load currents of their windings, which turn at 5 800 to 13 200 rpm;
    - brushed inside an actuator, 0.45, where grease and many wheels come to it: identified of servos 0.14 to 0.20
      (XL330), 0.24 (STS3215), 0.43 (XL-320), 0.62 to 0.69 (MX-106), 0.96 (MX-64);
    - brushless without slots, 0.37: the median of 70 Faulhaber motors that print both (5-95 %: 0.14 to 0.55);
    - brushless otherwise, 0.55, where cogging and the iron's hysteresis come to it: measured 0.80 (REV NEO), 0.57 to
      0.68 (NEO 550), 0.75 and more (Falcon 500), 0.5 to 0.7 (ODrive D5065, by the voltage), 0.14 to 0.7 (RI50),
      0.13 (U8).

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
    coulomb, viscous, w_0 = motor["friction_torque"], motor["viscous_friction"], motor["no_load_speed"]
    share = np.minimum(dry_share(motor) * dry, 1.0)
    share = np.where(np.isnan(w_0), 1.0, share)
    left = np.where(np.isnan(viscous), share * loss, np.maximum(loss - viscous * w_0, 0.0))
    rest = np.where(share < 1.0, (1.0 - share) * loss / w_0, 0.0)
    rest = np.where(np.isnan(coulomb), rest, np.maximum(loss - coulomb, 0.0) / w_0)
    return np.where(np.isnan(coulomb), left, coulomb), np.where(np.isnan(viscous), rest, viscous)


def dry_share(motor: Figures) -> Array:
    """Share of motors' no-load torque that is dry, by what rubs: see ``friction``.

    Parameters
    ----------
    motor
        Figures of motors by field name: columns.

    Returns
    -------
    array
        [1].
    """
    brushed = np.where(np.asarray(motor["inside"]) == "", DRY_SHARE["brushed"], DRY_SHARE[SERVO])
    brushless = np.where(np.asarray(motor["winding"]) == SLOTLESS, DRY_SHARE[SLOTLESS], DRY_SHARE["brushless"])
    return np.where(np.asarray(motor["kind"]) == "brushed", brushed, brushless)


@once_per_part
def gear_loss(gearhead: Figures) -> tuple[Array, Array]:
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


def usual_idle(gearhead: Figures) -> tuple[Array, Array, Array]:
    r"""Torque that turns gearheads without load as others of their kind have it: least, usual and most.

    .. math:: T_0 = s\, n\, T_N / i

    with n stages and :data:`IDLE` s: 157 gearheads of Wittenstein, sealed and preloaded, print 2 to 17 % of the
    continuous torque T_N over the ratio, of 42 strain wave actuators the no-load current takes 6 to 23 %; what
    small planetary gearheads lose at T_N, 4 to 16 % a stage, has the rest in proportion to torque.

    Parameters
    ----------
    gearhead
        Figures of gearheads by field name: columns.

    Returns
    -------
    tuple of arrays
        At the input [N*m]; NaN of other kinds, and without a continuous torque.

    Examples
    --------
    >>> [round(float(x), 4) for x in usual_idle({"kind": "spur", "stages": 2, "continuous_torque": 3.0, "ratio": 40.0})]
    [0.001, 0.003, 0.009]
    """
    kind, stages = np.asarray(gearhead["kind"]), np.asarray(gearhead["stages"])
    kinds = [kind == name for name in IDLE]
    share, spread = (np.select(kinds, [band[n] for band in IDLE.values()], nan) for n in (0, 1))
    stages = np.where((stages > 0.0) & (kind != "strain wave"), stages, 1.0)
    usual = share * stages * gearhead["continuous_torque"] / gearhead["ratio"]
    return usual / spread, usual, usual * spread


def lost_in_gearhead(driving: Figure, braking: Figure, speed: Figure, gearhead: Figures) -> Array:
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
    return driving * (1.0 / e - 1.0) - braking * (1.0 - e) + idle * speed


_SIX_STEPS = 3.0 / (2.0 * np.pi)  # six commutations in an electrical period, each through half of L
COMMUTATION_BAND = 0.4, 1.15  # of X, 5 to 95 %: sinusoidal currents take less than half, see ``commutation``


def commutation(motor: Figures) -> Array:
    r"""Voltage that commutation takes of brushless motors, per current and speed [V*s/(A*rad)]; 0 where unknown.

    Six times in an electrical period a current I passes from one phase to the next. With the inductance L of two phases
    in series that takes of the voltage what it takes of a rectifier whose currents overlap:

    .. math:: X = \frac{3}{2 \pi} p L, \qquad \Delta V = X w I

    Of 338 maxon motors the printed nominal speeds show 0.96 of it in the median, 0.76 to 1.15 in four of five; without
    it the line through no load and stall is up to 17 % too fast. Sinusoidal currents need p L w I at a right angle to
    the rest: less than half of it, while that is small.

    Parameters
    ----------
    motor
        Figures of motors by field name: columns.

    Returns
    -------
    array
        [V*s/(A*rad)].

    References
    ----------
    .. [1] N. Mohan, T. Undeland, W. Robbins, Power Electronics, 3rd ed., Wiley 2003, chapter 6: 3 w L_s I / pi.
    """
    drop = _SIX_STEPS * np.asarray(motor["pole_pairs"]) * motor["inductance"]
    return np.where(np.asarray(motor["kind"]) == "brushless", np.nan_to_num(drop), 0.0)


@once_per_part
def back_emf_constant(motor: Figures) -> Array:
    """Voltage per speed of motors [V*s/rad]; the first of these that is known.

    1. The maker's ``back_emf_constant``, or 1 over its ``speed_constant``.
    2. (V - R I_0)/w_0. Not of a motor with its controller inside, which limits the no-load speed;
       and not beyond half to twice k_t, where the two figures are of different windings or voltages. An unknown I_0
       leaves the bound V/w_0: k_e is k_t then, and no more than that.
    3. k_t.

    A result within the rounding of three digits of k_t is k_t: one constant, printed twice.

    Parameters
    ----------
    motor
        Figures of motors by field name: columns.
    """
    k_t, own = np.asarray(motor["torque_constant"]), np.asarray(motor["back_emf_constant"])
    with np.errstate(divide="ignore", invalid="ignore"):
        k_e = np.where(np.isnan(own), np.divide(1.0, motor["speed_constant"]), own)
        if (unprinted := np.isnan(k_e)).any():
            k_e = np.where(unprinted, _by_no_load_speed(motor, k_t), k_e)
        return np.where(np.abs(k_e / k_t - 1.0) < _SAME, k_t, k_e)


def _by_no_load_speed(motor: Figures, k_t: Array) -> Array:
    """The constant by (V - R I_0)/w_0 where that is likely, else k_t."""
    voltage, no_load = np.asarray(motor["nominal_voltage"]), np.asarray(motor["no_load_speed"])
    lost = np.asarray(motor["resistance"] * motor["no_load_current"])
    idle = np.where(np.isnan(lost), np.fmin(k_t, voltage / no_load), (voltage - lost) / no_load)
    likely = (idle > k_t / _OTHER) & (idle < k_t * _OTHER) & (np.asarray(motor["commutation"]) != ELECTRONICS)
    return np.where(likely, idle, k_t)
