"""Braking: energy on a bus and in a brake resistor, a load held and stopped by a brake."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, inf, isnan
from typing import NamedTuple

import numpy as np

from drivesizer.physics.figures import Alike, Array, Figure, Figures

# -- Holding a load by a brake, and stopping it: on figures or columns.
#
# Held at rest, friction helps: the load would have to turn gears and belt backward, so that of its torque T
#
# .. math:: M = T \frac{e_b}{i_b} \frac{e_g}{i_g}
#
# reaches the brake, with the efficiencies that hold wherever the load drives the motor. Static friction is no less
# than that; what vibration may take of it is what a safety factor is for. Friction of the load itself, of guides,
# screws and a further stage is not counted on, but what locks itself passes on nothing. In a stop no friction is
# counted on at all: kinetic energy and weight go to the brake as through gears without loss, and the weight pulls in
# the direction of the motion. Symbols: J inertia [kg*m^2], w speed [rad/s], M torque [N*m], t time [s]; all at the
# brake's shaft.


SLIPPING = 1.0 / 3.0, 1.0
"""Torque of a slipping brake as a share of its static torque, where none is printed: no less than the one, no more than
the other. Printed shares are 0.37 to 0.63 with permanent magnets (11 brakes of Bosch Rexroth MS2E and Siemens 1FK2) and
1.0 with springs (two of Siemens)."""


class Stop(NamedTuple):
    """One stop by a brake that slips until the load stands."""

    energy: Alike  # J, that its linings take; infinite where the load is stronger
    time: Alike  # s, until it stands
    angle: Alike  # rad, that its shaft turns meanwhile


def held_by_brake(torque: Figure, ratio: Figure, efficiency: Figure) -> Alike:
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


def held_by_friction(motor: Figures) -> Alike:
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


def released_power(brake: Figures) -> Alike:
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
    power = np.where(np.isnan(brake["holding_power"]), brake["power"], brake["holding_power"])
    return np.where(np.isnan(power), 0.0, power)


def stop(inertia: Figure, speed: Figure, brake: Figure, load: Figure, engage_time: Figure) -> Stop:
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


# -- Regenerated energy on a bus: what its capacitors store, and what a chopper burns in a resistor.
#
# .. math::
#
#     E_C &= \tfrac12 C (U_{ch}^2 - U_0^2) \qquad (1) \\
#     U_{ch} / I_{ch} &\le R \le U_{ch}^2 / P_{max} \qquad (2), (3) \\
#     P_R &= U_{ch}^2 / R \qquad (4) \\
#     C &\ge 2 E / (U_{lim}^2 - U_0^2) \qquad (5)
#
# A rectifier or power supply takes nothing back: the capacitors store what is regenerated up to (1), give it back
# while the drives draw, and what finds no room is burnt. The chopper switches on and off; while on it burns (4).
#
# Sources: (1), (3), (5) Copley Controls, Xenus Plus User Guide, A.1.6 to A.1.9, and Kollmorgen SERVOSTAR S and CD,
# M-SS-005-03, appendix D, equations 2, 3 and 5; (2), (3), (4) Lenze Drive Solution Designer, DMS 4.2 EN, 12.6.2;
# mean over the cycle, of longer ones over the worst window: Siemens SINAMICS Engineering Manual, November 2015, page
# 370.
#
# Symbols: U_ch voltage at which the chopper switches on, U_0 voltage of the supply, U_lim highest voltage permitted
# [V]; C capacitance of the bus [F]; R resistance [ohm]; I_ch largest current of the chopper [A]; P_max largest
# regenerated power, P_R power of the resistor while it is on [W]; E energy [J].


_E24 = (1.0, 1.1, 1.2, 1.3, 1.5, 1.6, 1.8, 2.0, 2.2, 2.4, 2.7, 3.0, 3.3, 3.6, 3.9, 4.3, 4.7, 5.1, 5.6, 6.2, 6.8,
        7.5, 8.2, 9.1)  # fmt: skip
_NEARLY = 1e-9  # relative


def storable_energy(capacitance: Figure, chopper: Figure, supply: Figure) -> Alike:
    """Energy that the bus takes before its chopper switches on, (1) [J].

    Parameters
    ----------
    capacitance
        Of the bus, C [F].
    chopper, supply
        Voltage at which the chopper switches on, and before [V].

    Returns
    -------
    float or array
        0 where the chopper is on already.

    Examples
    --------
    4.7 mF from 48 V to 56 V:

    >>> round(float(storable_energy(4.7e-3, 56.0, 48.0)), 3)
    1.955
    """
    return np.maximum(0.5 * capacitance * (np.square(chopper) - np.square(supply)), 0.0)


def largest_resistance(chopper: Figure, power: Figure) -> Alike:
    """Largest resistance that burns a power at the chopper's voltage, (3) [ohm]; infinite where there is none to burn.

    Parameters
    ----------
    chopper
        Voltage at which the chopper switches on, U_ch [V].
    power
        Largest regenerated power, P_max [W].

    Returns
    -------
    float or array
        Resistance [ohm].
    """
    with np.errstate(divide="ignore"):
        return np.square(chopper) / np.asarray(power, float)


def smallest_resistance(chopper: Figure, current: Figure) -> Alike:
    """Smallest resistance that a chopper can switch, (2) [ohm].

    Parameters
    ----------
    chopper
        Voltage at which the chopper switches on, U_ch [V].
    current
        Largest current of the chopper, I_ch [A].

    Returns
    -------
    float or array
        Resistance [ohm].

    Examples
    --------
    maxon DSR 50/5 at 56 V and 5 A:

    >>> smallest_resistance(56.0, 5.0)
    11.2
    """
    return chopper / current


def power_while_on(chopper: Figure, resistance: Figure) -> Alike:
    """Power of a resistor while its chopper is on, (4) [W].

    Parameters
    ----------
    chopper
        Voltage across it, U_ch [V].
    resistance
        Of the resistor, R [ohm].

    Returns
    -------
    float or array
        Power [W].

    Examples
    --------
    Roboteq SR2K60V25R prints 125 W at 25 V in its first stage of 5 ohm, and 292 W at 27 V in both, 2.5 ohm:

    >>> power_while_on(25.0, 5.0), round(power_while_on(27.0, 2.5))
    (np.float64(125.0), 292)
    """
    return np.square(chopper) / resistance


def least_bus_capacitance(stored: Figure, limit: Figure, supply: Figure) -> Alike:
    """Capacitance of a bus that stores all that is regenerated, without a resistor, (5) [F].

    Parameters
    ----------
    stored
        Largest energy that is regenerated and not drawn again, E [J].
    limit, supply
        Highest voltage permitted, U_lim, and before, U_0 [V].

    Returns
    -------
    float or array
        Infinite where the limit leaves no room, 0 where nothing is stored.

    Examples
    --------
    >>> round(float(least_bus_capacitance(1.955, 56.0, 48.0)), 5)
    0.0047
    """
    room = np.square(limit) - np.square(supply)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(np.asarray(stored) == 0.0, 0.0, np.where(room <= 0.0, inf, 2.0 * stored / room))


def most_stored(steps: Array) -> float:
    """Largest rise of a running sum over a cycle that repeats: peak of a store that is empty at first.

    Parameters
    ----------
    steps
        What comes in, one step after the other, and below 0 what goes out.

    Returns
    -------
    float
        In their unit.

    Examples
    --------
    >>> most_stored(np.array([8.0, -5.0, 4.0, -9.0]))
    8.0
    """
    sums = np.append(0.0, np.cumsum(np.tile(steps, 2)))
    return float(np.minimum((sums - np.minimum.accumulate(sums)).max(), np.maximum(steps, 0.0).sum()))


def burnt_energy(drawn: Array, returned: Array, capacity: float) -> Array:
    """Energy burnt in each piece of a cycle that repeats, the bus storing what it can [J].

    Within a piece what is drawn goes before what is regenerated, so that no more is stored than may be.

    Parameters
    ----------
    drawn, returned
        Energy to and from the drives in each piece [J], shape (pieces,).
    capacity
        Energy that the bus stores, of ``storable_energy`` [J].

    Returns
    -------
    array
        Shape (pieces,), in periodic steady state: of a cycle that regenerates more than it draws with a full store.

    Examples
    --------
    2 J find room, 3 J are burnt; the store is empty again before the next braking:

    >>> burnt_energy(np.array([6.0, 0.0, 0.0]), np.array([0.0, 4.0, 1.0]), 2.0).tolist()
    [0.0, 2.0, 1.0]
    """
    if not capacity > 0.0:
        return returned.copy()
    stored = capacity if returned.sum() > drawn.sum() else 0.0  # where a periodic store is at some moment of its cycle
    burnt = np.zeros(len(drawn))
    for _ in range(2):  # from that moment on the second time has the periodic course
        for piece, (out, into) in enumerate(zip(drawn.tolist(), returned.tolist(), strict=True)):
            stored = max(stored - out, 0.0) + into
            over = max(stored - capacity, 0.0)
            stored, burnt[piece] = stored - over, over
    return burnt


class Burning(NamedTuple):
    """Power of a resistor over one cycle, in pieces that are cut where it starts and where a power is passed."""

    duration: Array  # s, of each piece
    energy: Array  # J
    peak: float  # W, at any moment


def burning(duration: Array, returned: Array, highest: Array, burnt: Array, power: float = 0.0) -> Burning:
    r"""Course of a resistor's power over a cycle: straight in each piece, from the moment at which the bus is full.

    The regenerated power runs from its highest in a piece to what makes the piece's energy, falling where the next
    piece has less. The bus is full when of that energy E only the burnt one is left, at the power

    .. math:: q = \sqrt{p_1^2 + 2 \frac{p_0 - p_1}{t} E_b}

    Parameters
    ----------
    duration, returned, highest
        Of each piece [s], regenerated energy [J], and its largest power [W].
    burnt
        Of that energy, by ``burnt_energy`` [J].
    power
        Where it is passed, a piece is cut [W].

    Returns
    -------
    Burning
        Of more pieces than the cycle has.

    Examples
    --------
    100 W that fall to 0 in 1 s are 50 J. Where the bus takes 18 J, 32 J are left from 80 W on; above 40 W are 24 J:

    >>> braking = np.array([[1.0, 1.0], [50.0, 0.0], [100.0, 0.0], [32.0, 0.0]])
    >>> found = burning(*braking, 40.0)
    >>> found.peak, found.duration.round(9).tolist(), found.energy.round(9).tolist()
    (80.0, [0.2, 0.4, 0.4, 1.0], [0.0, 24.0, 8.0, 0.0])
    """
    rows = np.flatnonzero(burnt > 0.0)
    mean, out = np.divide(returned, duration, out=np.zeros_like(burnt), where=duration > 0.0), burnt[rows]
    top = np.maximum(highest, mean)
    after, before = np.roll(top * (returned > 0.0), -1)[rows], np.roll(top * (returned > 0.0), 1)[rows]
    top, mean, lasts = top[rows], mean[rows], duration[rows]
    least = np.maximum(2.0 * mean - top, 0.0)
    falls = np.where(after > 0.0, after < top, (before == 0.0) | (before > top))
    braked = np.minimum(lasts, 2.0 * returned[rows] / (top + least))
    start, end = np.where(falls, top, least), np.where(falls, least, top)
    full = np.sqrt(np.maximum(end**2 + 2.0 * (start - end) / braked * out, 0.0))
    on = np.minimum(2.0 * out / (full + end), lasts)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where((full - power) * (end - power) < 0.0, (full - power) / (full - end), 1.0)
    first = np.minimum(share * (full + share * (end - full) / 2.0) * on, out)
    parts = np.stack([lasts - on, share * on, (1.0 - share) * on]), np.stack([np.zeros(len(rows)), first, out - first])
    counts = np.ones(len(duration), np.int64)
    counts[rows] = 3
    columns = np.repeat(duration, counts), np.zeros(int(counts.sum()))
    places = (np.cumsum(counts) - counts)[rows] + np.arange(3)[:, None]
    for column, values in zip(columns, parts, strict=True):
        column[places] = values
    real = columns[0] > _NEARLY * np.repeat(duration, counts)
    return Burning(columns[0][real], columns[1][real], float(np.maximum(full, end).max(initial=0.0)))


def largest_mean(duration: Array, energy: Array, window: float) -> float:
    """Largest mean power over any window of a cycle that repeats [W].

    Parameters
    ----------
    duration, energy
        Of each piece [s], [J]; the power within a piece is even.
    window
        Length of the window [s].

    Returns
    -------
    float
        No less than the mean over the cycle.

    Examples
    --------
    10 J in the first of 4 s, over 2 s and over 5 s:

    >>> cycle = np.array([1.0, 3.0]), np.array([10.0, 0.0])
    >>> largest_mean(*cycle, 2.0), largest_mean(*cycle, 5.0)
    (5.0, 4.0)
    """
    total, per_cycle = float(duration.sum()), float(energy.sum())
    whole = floor(window / total)
    rest = window - whole * total
    ends, sums = (np.append(0.0, np.cumsum(np.tile(x, 2))) for x in (duration, energy))  # over two cycles
    starts = np.concatenate([ends[ends <= total], ends[(ends >= rest) & (ends - rest <= total)] - rest])
    most = float((np.interp(starts + rest, ends, sums) - np.interp(starts, ends, sums)).max())
    return max((whole * per_cycle + most) / window, per_cycle / total)


def largest_pulse(duration: Array, energy: Array, continuous: float = 0.0) -> float:
    """Largest energy of an uninterrupted braking in a cycle that repeats [J].

    Parameters
    ----------
    duration, energy
        Of each piece [s], [J].
    continuous
        Power up to which burning is no pulse, for a resistor withstands it at any time [W].

    Returns
    -------
    float
        Infinite where more than that is burnt all the time.

    Examples
    --------
    The last braking and the first are one, for the cycle repeats:

    >>> largest_pulse(np.ones(5), np.array([3.0, 0.0, 4.0, 0.0, 2.0]))
    5.0
    """
    pulsed = energy > continuous * duration * (1.0 + _NEARLY)
    if pulsed.all():
        return inf
    first = int(np.argmin(pulsed))  # a piece without: no run goes round the end from there
    energy, pulsed = np.roll(energy, -first), np.roll(pulsed, -first)
    sums = np.cumsum(np.where(pulsed, energy, 0.0))
    before = np.maximum.accumulate(np.where(pulsed, 0.0, sums))  # at the last piece without
    return float((sums - before).max())


def derated_power(power: float, ambient: float, rated: float, none: float) -> float:
    """Continuous power of a resistor at an ambient temperature, straight from its rated ambient to where it is none.

    Parameters
    ----------
    power
        At the rated ambient [W].
    ambient, rated, none
        Temperatures [K]; NaN unknown.

    Returns
    -------
    float
        NaN above a rated ambient without a line, the power itself where neither temperature is known.

    Examples
    --------
    maxon DSR 50/5: 10 W at 25 degC, none at 75 degC; at 40 degC:

    >>> round(derated_power(10.0, 313.15, 298.15, 348.15), 3)
    7.0
    """
    if isnan(rated) or ambient <= rated:
        return power
    share = (none - ambient) / (none - rated)
    return 0.0 if share < 0.0 else power * share


def preferred_resistance(most: float, ends: Sequence[float]) -> float:
    """Largest resistance of the series E24 up to a value, within what is made [ohm].

    Parameters
    ----------
    most
        Largest resistance that burns enough [ohm]; infinite: any.
    ends
        Least and greatest resistance that is made [ohm].

    Returns
    -------
    float
        NaN where none is so small.

    Examples
    --------
    >>> preferred_resistance(10.9, (0.01, 10e3)), preferred_resistance(0.5, (1.0, 10.0))
    (10.0, nan)
    """
    below = min(most, ends[1]) * (1.0 + _NEARLY)
    if not below >= ends[0]:
        return float("nan")
    decade = 10.0 ** floor(np.log10(below))
    fitting = [round(step * scale, 12) for scale in (decade, decade / 10.0) for step in _E24 if step * scale <= below]
    return max((value for value in fitting if value >= ends[0]), default=float("nan"))
