"""Stepper motors on chopper drivers: pull-out torque, starting, and what they draw."""

from __future__ import annotations

import numpy as np

from drivesizer.physics.figures import Alike, Array, Figure

# -- Power and energy that steppers draw: torque times speed, and the loss of a current that always flows.


def copper_loss(phase_current: Figure, resistance: Figure) -> Alike:
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


def electrical_energy(duration: Array, torque: Array, speed: Array, loss: Array) -> tuple[Array, ...]:
    """Energy that motors with a constant loss draw and return over a cycle, and their largest and least power.

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
        Drawn and returned [J], largest and least power drawn [W], each of shape (motors,).

    Examples
    --------
    A brake that takes 20 W at first and nothing at last, of a motor that loses 5 W: (20 - 5)²/(2·20) J are returned.

    >>> one = np.array([[[-2.0, -2.0]]]), np.array([[[10.0, 0.0]]])
    >>> [float(x[0]) for x in electrical_energy(np.array([1.0]), *one, np.array([5.0]))]
    [0.625, 5.625, 5.0, -15.0]
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
    ends = np.stack([c, a + b + c, (a * top + b) * top + c], axis=2)
    unknown = np.where(np.isnan(c).any(axis=1), np.nan, 0.0)
    drawn, returned = (np.maximum(side, 0.0).sum((1, 2)) + unknown for side in (parts, -parts))
    return drawn, returned, ends.max(axis=(1, 2)), ends.min(axis=(1, 2))


# -- Pull-out torque of two-phase stepper motors over speed: by the ideal model, and of printed curves.
#
# Symbols: p rotor teeth, a quarter of the full steps of a turn; I rated current of a phase, with which in both
# phases the holding torque T_h is printed; k torque of a phase per ampere; w speed [rad/s]; V supply voltage of a
# chopper driver.
#
# A phase's torque is sinusoidal, so that with I in both, 45 degrees apart from either,
#
# .. math:: k = \frac{T_h}{\sqrt{2}\, I}
#
# and sinusoidal currents of the amplitude :math:`I_m = \sqrt{2}\, I`, which heat as much, have that torque too. In
# the frame of the rotor, x in quadrature to its flux and y along it, the amplitude of the current is held at most at
# I_m by the driver and that of the voltage at V:
#
# .. math:: i_x^2 + i_y^2 \le I_m^2, \quad (R i_x - p w L i_y + k w)^2 + (R i_y + p w L i_x)^2 \le V^2, \quad T = k
# i_x
#
# The load angle is free. The largest :math:`i_x` is the top of the intersection of two discs: of the current's, I_m;
# of the voltage's, :math:`V/Z - k w R/Z^2` with :math:`Z^2 = R^2 + (p w L)^2`; or of their crossing, with :math:`c =
# (V^2 - (k w)^2 - Z^2 I_m^2) / (2 k w)`
#
# .. math:: i_x = \frac{R c + p w L \sqrt{Z^2 I_m^2 - c^2}}{Z^2}
#
# Not here: iron loss, saturation, the rise of the resistance, resonance. Printed curves lie at 0.51 to 0.95 of it
# (:data:`PULL_OUT_SHARE`).
#
# References ---------- .. [1] P. Acarnley, *Stepping Motors: a guide to theory and practice*, 4th ed., IET, 2002,
# chapter 5 (pull-out torque of hybrid motors by phasors of the fundamental). .. [2] T. Kenjo and A. Sugawara,
# *Stepping Motors and their Microprocessor Controls*, 2nd ed., Oxford, 1994.


# share of the model's torque, and factor of its band either way: 7 printed curves of 5 steppers by 54 points, of which
# 5 to 95 % lie at 0.52 to 0.89; widened for a motor that is not among the five (Student's t, 4 degrees of freedom)
PULL_OUT_SHARE = (0.67, 1.5)


def rotor_teeth(full_steps: Figure) -> Alike:
    """Teeth of the rotor of a two-phase hybrid stepper: electrical turns per turn.

    >>> rotor_teeth(200.0)
    50.0
    """
    return full_steps / 4.0


def amplitude(phase_current: Figure) -> Alike:
    """Amplitude of sinusoidal phase currents that heat as the rated current in both phases does [A]."""
    return np.sqrt(2.0) * phase_current


def pull_out_torque(
    speed: Figure,
    voltage: Figure,
    *,
    holding_torque: Figure,
    phase_current: Figure,
    resistance: Figure,
    inductance: Figure,
    teeth: Figure,
) -> Array:
    """Largest torque at a speed on a chopper driver, by the ideal two-phase model.

    Parameters
    ----------
    speed
        Of the motor [rad/s], of either sign.
    voltage
        Of the driver's supply [V].
    holding_torque
        At rated current in both phases [N*m].
    phase_current
        Rated current of a phase [A].
    resistance, inductance
        Of a phase [ohm], [H].
    teeth
        Of the rotor.

    Returns
    -------
    array
        [N*m], 0 from where the back-EMF leaves none; shape of the arguments broadcast.

    Examples
    --------
    >>> float(pull_out_torque(0.0, 24.0, holding_torque=0.59, phase_current=2.0, resistance=1.6, inductance=3e-3,
    ...                       teeth=50.0).round(3))
    0.59
    """
    w = np.abs(np.asarray(speed, float))
    I_m = amplitude(phase_current)
    k = holding_torque / I_m
    e, X = k * w, teeth * w * inductance
    Z2 = resistance**2 + X**2
    with np.errstate(divide="ignore", invalid="ignore"):
        top = voltage / np.sqrt(Z2) - e * resistance / Z2
        of_voltage = top**2 + (e * X / Z2) ** 2 <= I_m**2
        of_current = (resistance * I_m + e) ** 2 + (X * I_m) ** 2 <= voltage**2
        c = (voltage**2 - e**2 - Z2 * I_m**2) / (2.0 * e)
        crossing = (resistance * c + X * np.sqrt(np.maximum(Z2 * I_m**2 - c**2, 0.0))) / Z2
        i_x = np.where(of_current, I_m, np.where(of_voltage, top, crossing))
    known = np.isnan(voltage + I_m + k + Z2 + 0.0 * w)
    return np.where(known, np.nan, k * np.maximum(i_x, 0.0))


def rescaled_torque(speed: Figure, voltage: Figure, at_speed: Array, at_torque: Array, at_voltage: Figure) -> Array:
    r"""Torque of a printed curve at another supply voltage: no more at a higher one, compressed at a lower.

    .. math:: T(w, V_2) = T(w \max(1, V_1 / V_2), V_1)

    Without resistance the model's torque is a function of V/w alone. So stretched to a higher voltage, charts of two
    voltages lie up to 51 % above the printed ones (iron loss grows with speed), so none of that is counted. Compressed
    to a lower one they lie 32 % below to 10 % above, over 14 points of 6 pairs of charts.

    Parameters
    ----------
    speed
        Shape (curves, points) [rad/s].
    voltage
        Of the supply, of all or of each, shape (curves,) [V].
    at_speed, at_torque
        Points of each curve, rising in speed, shape (curves, most points); the last repeated where there are fewer.
    at_voltage
        Of each curve [V], shape (curves,).

    Returns
    -------
    array
        [N*m], shape (curves, points): the least up to that speed, for a dip is no torque to rely on; below the first
        point that of the first, above the last unknown.
    """
    w = np.abs(speed) * np.maximum(at_voltage / voltage, 1.0)[:, None]
    least = np.minimum.accumulate(at_torque, axis=1)
    torque_there = np.repeat(least[:, :1], w.shape[1], axis=1)
    for left in range(at_speed.shape[1] - 1):
        (a, b), (low, high) = at_speed[:, left : left + 2].T[:, :, None], least[:, left : left + 2].T[:, :, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            between = low + (high - low) * (w - a) / (b - a)
        torque_there = np.where((w > a) & (b > a), between, torque_there)
    return np.where(w > at_speed[:, -1:] * (1.0 + 1e-9), np.nan, np.where(np.isnan(w), np.nan, torque_there))


DETENT_SHARE = 0.05  # of the holding torque that a rotor's own friction and detent take; NEMA 17 and 23 print 3 to 6 %


def torque_at_current(torque: Figure, share: Figure, own: Figure) -> Alike:
    r"""Pull-out torque of a printed curve where the driver gives a share of the rated current.

    .. math:: T = s (T_1 + T_0) - T_0

    The torque of the field goes with the current, what the rotor's own friction and detent take of it does not. At
    speeds where the voltage limits the current there is more: none of that is counted.

    Parameters
    ----------
    torque
        Printed, at rated current [N*m].
    share
        Current that is set over the rated one.
    own
        Friction and detent torque of the rotor [N*m].

    Returns
    -------
    float or array
        [N*m]; 0 at least.

    Examples
    --------
    Half the current leaves less than half of the torque:

    >>> float(torque_at_current(0.40, 0.5, 0.02))
    0.19
    """
    return np.maximum(share * (torque + own) - own, 0.0)


# -- Starting of steppers without a ramp, and their natural frequency.
#
# References
# ----------
# .. [1] P. Acarnley, *Stepping Motors: a guide to theory and practice*, 4th ed., IET, 2002, chapter 4.


START_BAND = 1.5  # of the speed at which a rotor starts without a ramp: one printed figure, 1.37 of the ideal


def natural_frequency(teeth: Figure, holding_torque: Figure, inertia: Figure) -> Alike:
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


def start_speed(teeth: Figure, torque: Figure, inertia: Figure, load_torque: Figure = 0.0) -> Alike:
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


def start_speed_with(
    alone: Figure, rotor_inertia: Figure, inertia: Figure, load_torque: Figure, torque: Figure
) -> Alike:
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
