"""Batteries: run time and voltage under load, and the capacity that a run time requires.

Functions of floats or arrays, SI throughout: charge in A*s, time in s. An unknown figure (NaN) gives an unknown result.
Peukert's law and a printed discharge table are two answers to the same question; the table is the maker's own, and
holds inside its range only. Both are of one constant draw from a full battery: applied to the mean of a load that
varies within minutes they ignore both the harder wear of its peaks and the recovery in its pauses.

Sources: W. Peukert, Elektrotechnische Zeitschrift 20 (1897) 287; with the rated hours, and where it ends:
D. Doerffel, S. Abu-Sharkh, J. Power Sources 155 (2006) 395, doi:10.1016/j.jpowsour.2005.04.030; N. Omar et al.,
Energies 6 (2013) 5625, doi:10.3390/en6115625. Circuit of one RC pair: G. Plett, Battery Management Systems, vol. 1,
Artech House 2015, ch. 2.

Symbols: I current [A], P power [W], V voltage [V], R resistance [ohm], C charge [A*s], H rated time [s], k exponent.
"""

from __future__ import annotations

import numpy as np

from drivesizer.physics.figures import Alike, Array, Figure


def peukert_time(current: Figure, capacity: Figure, rated_time: Figure, exponent: Figure) -> Alike:
    """Run time of a full battery at a constant current [s]: t = H (C / (H I))^k.

    At a current below the rated one it is C / I: no more charge is counted than the rated one, whatever the exponent
    says of slower discharges. Without a draw it is infinite.

    Parameters
    ----------
    current
        Constant, above 0 [A]; at 0 or while charging there is no end.
    capacity, rated_time
        Charge [A*s] that is drawn in the rated time [s].
    exponent
        Peukert's, 1 or more [1].

    Returns
    -------
    float or array
        Run time [s].

    Examples
    --------
    7 A h in 20 h; at 2.4 A and k = 1.2 it lasts 20 h (7 / (20 * 2.4))^1.2:

    >>> float(round(peukert_time(2.4, 7 * 3600.0, 20 * 3600.0, 1.2) / 3600.0, 3))
    1.985
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.asarray(capacity / rated_time / np.maximum(current, 0.0), float)
        time = rated_time * np.where(ratio < 1.0, ratio ** np.asarray(exponent, float), ratio + 0.0 * exponent)
    return time[()]


def capacity_for(time: Figure, current: Figure, rated_time: Figure, exponent: Figure) -> Alike:
    """Rated capacity for a run time at a constant current [A*s]: the inverse of :func:`peukert_time`.

    C = H I (t/H)^(1/k), and I t where the time is longer than the rated one.

    Parameters
    ----------
    time
        Required run time [s].
    current
        Constant [A].
    rated_time, exponent
        Of the battery [s], [1].

    Returns
    -------
    float or array
        Rated capacity [A*s].
    """
    share = np.asarray(time, float) / rated_time
    charge = current * rated_time * np.where(share < 1.0, share ** (1.0 / np.asarray(exponent, float)), share)
    return (charge + 0.0 * exponent)[()]


def table_time(draw: Figure, draws: Figure, times: Figure) -> Alike:
    """Run time at a draw by a discharge table, interpolated in logarithms [s].

    Outside the table, and with a table that does not fall, unknown: NaN.

    Parameters
    ----------
    draw
        Constant current [A] or power [W].
    draws, times
        The table: draws of that kind, and the run time at each [s], in any order.

    Returns
    -------
    float or array
        Run time [s].

    Examples
    --------
    >>> table_time(np.array([2.0, 8.0]), [1.0, 4.0], [16.0, 1.0])
    array([ 4., nan])
    """
    x, y = _falling(draws, times)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = np.log(np.asarray(draw, float))
    return np.exp(np.interp(at, x, y, left=np.nan, right=np.nan))[()] if len(x) else np.full_like(at, np.nan)[()]


def table_draw(time: Figure, draws: Figure, times: Figure) -> Alike:
    """Draw of a run time by a discharge table [A or W]: the inverse of :func:`table_time`.

    Parameters
    ----------
    time
        Required run time [s].
    draws, times
        The table, as in :func:`table_time`.

    Returns
    -------
    float or array
        Constant current [A] or power [W]; NaN outside the table.
    """
    return table_time(time, times, draws)  # a falling line either way


def _falling(draws: Figure, times: Figure) -> tuple[Array, Array]:
    """Logarithms of a table by rising draw; nothing where more draw does not last shorter."""
    order = np.argsort(np.asarray(draws, float))
    x, y = (np.log(np.asarray(column, float)[order]) for column in (draws, times))
    steady = bool((np.diff(x) > 0.0).all() and (np.diff(y) < 0.0).all())
    return (x, y) if steady else (x[:0], y[:0])


def terminal_voltage(current: Figure, emf: Figure, resistance: Figure) -> Alike:
    """Voltage at the terminals [V]: V = E - R I.

    Parameters
    ----------
    current
        Drawn; negative while charging [A].
    emf
        Open-circuit voltage [V].
    resistance
        Internal, to direct current [ohm].

    Returns
    -------
    float or array
        Voltage [V].
    """
    return emf - resistance * current


def current_of_power(power: Figure, emf: Figure, resistance: Figure) -> Alike:
    """Current at which a battery gives a power [A]: the smaller root of R I^2 - E I + P = 0.

    Written as 2 P / (E + sqrt(E^2 - 4 R P)), which holds without resistance and while charging (P < 0). More than
    E^2 / (4 R) no current gives: NaN.

    Parameters
    ----------
    power
        At the terminals; negative while charging [W].
    emf, resistance
        Open-circuit voltage [V] and internal resistance [ohm].

    Returns
    -------
    float or array
        Current [A]; NaN beyond the largest power.

    Examples
    --------
    >>> float(round(current_of_power(110.0, 12.0, 0.1), 9))  # 10 A at 11 V
    10.0
    """
    with np.errstate(invalid="ignore"):
        root = np.sqrt(np.asarray(emf * emf - 4.0 * resistance * power, float))
    return (2.0 * power / (emf + root))[()]


def largest_power(emf: Figure, resistance: Figure, least_voltage: Figure = 0.0) -> Alike:
    """Largest power at a battery's terminals [W]: V (E - V) / R at the least voltage, E^2 / (4 R) at E / 2.

    Parameters
    ----------
    emf, resistance
        Open-circuit voltage [V] and internal resistance [ohm].
    least_voltage
        Least permitted at the terminals [V].

    Returns
    -------
    float or array
        Power [W].
    """
    volts = np.maximum(np.asarray(least_voltage, float), 0.5 * np.asarray(emf, float))
    with np.errstate(divide="ignore"):
        return (volts * np.maximum(emf - volts, 0.0) / resistance)[()]


def state_of_charge(duration: Figure, current: Figure, capacity: Figure, start: float = 1.0) -> Array:
    """Charge left at the start and after every piece of a load, as a share of what is drawn at that load in all [1].

    Parameters
    ----------
    duration, current
        Of each piece [s], mean [A]; negative while charging. The last axis runs over the pieces.
    capacity
        Charge that the battery gives at this load's mean current [A*s].
    start
        Share at the beginning [1].

    Returns
    -------
    array
        One more value than pieces along the last axis [1]; not cut at 0 or 1.
    """
    discharged = np.cumsum(np.asarray(duration, float) * current, axis=-1) / capacity
    return start - np.concatenate([np.zeros((*discharged.shape[:-1], 1)), discharged], axis=-1)


def polarised_voltage(
    duration: Figure,
    current: Figure,
    emf: Figure,
    resistance: Figure,
    polarisation: Figure,
    time_constant: Figure,
    *,
    rested: bool = False,
) -> tuple[Array, Array]:
    """Terminal voltage before and after each piece of constant current, with one RC pair behind the resistance [V].

    u' = (R1 I - u) / T, V = E - R I - u, solved in each piece exactly; u in periodic steady state.

    Parameters
    ----------
    duration, current
        Of each piece of one cycle [s], [A].
    emf, resistance
        Open-circuit voltage [V] and resistance that acts at once [ohm].
    polarisation, time_constant
        Resistance R1 [ohm] and time constant T = R1 C1 [s] of the pair.
    rested
        Compute the first cycle instead, before which the battery was at rest: u = 0.

    Returns
    -------
    tuple of arrays
        Voltage at the left and the right end of each piece [V].
    """
    decay = np.exp(-np.asarray(duration, float) / time_constant)
    to = polarisation * np.asarray(current, float)
    whole, end = float(np.prod(decay)), 0.0
    for share, final in zip(decay.tolist(), to.tolist(), strict=True):
        end = final + (end - final) * share
    u = 0.0 if rested else end / (1.0 - whole)  # where a cycle begins as it ends
    left, right = np.empty_like(to), np.empty_like(to)
    for place, (share, final) in enumerate(zip(decay.tolist(), to.tolist(), strict=True)):
        left[place], u = u, final + (u - final) * share
        right[place] = u
    ohmic = emf - resistance * np.asarray(current, float)
    return ohmic - left, ohmic - right
