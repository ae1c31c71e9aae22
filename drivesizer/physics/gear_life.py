"""Life of gears, and forces on an overhung shaft."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from drivesizer.physics.figures import Alike, Array, Figure

# -- Gauss and Legendre's rules, as ``np.polynomial.legendre.leggauss`` has them: loading that takes milliseconds.
#
# Nodes lie between -1 and 1; the weights are of an interval of length 2.


FIVE = (
    np.array([-0.906179845938664, -0.5384693101056831, 0.0, 0.5384693101056831, 0.906179845938664]),
    np.array([0.23692688505618928, 0.4786286704993663, 0.5688888888888887, 0.4786286704993663, 0.23692688505618928]),
)
SIX = (
    np.array([-0.9324695142031519, -0.6612093864662645, -0.2386191860831969,
              0.2386191860831969, 0.6612093864662645, 0.9324695142031519]),
    np.array([0.17132449237917027, 0.3607615730481387, 0.46791393457269104,
              0.46791393457269104, 0.3607615730481387, 0.17132449237917027]),
)  # fmt: skip


# -- Life of gears: mean torque by speed and time, nominal life by rated life, speed and exponent.
#
# Symbols: T output torque [N*m], n speed [rad/s], t time [s], p exponent of the life: 3 of the ball bearing of a
# wave generator, 10/3 of roller bearings (ISO 281). Index r is of the rating, av of the mean.
#
# Sources: Harmonic Drive CSF and CSG component sets, equation 8 and rated lives; Harmonic Drive 1021387 (12/2018),
# equations 30.2, 30.5, 32.2 and 32.3; ISO 281 for the exponents.


MEDIAN = 5.0  # L_50 over L_10, Harmonic Drive 1021387, equation 32.3
_NODES, _WEIGHTS = FIVE


def turned_load(
    duration: Array, load: Array, speed: Array, exponent: float, force: Callable[[Array], Array] = np.abs
) -> Alike:
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
    wear = (force(at(load)) ** exponent * np.abs(at(speed)) * weights).sum(axis=1)
    return (duration * wear).sum(axis=0) / duration.sum(axis=0)


def mean_load(turned: Figure, mean_speed: Figure, exponent: float) -> Alike:
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


def gear_life(rated_life: Figure, rated_torque: Figure, rated_speed: Figure, turned: Figure, exponent: Figure) -> Alike:
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


# -- Forces on an overhung shaft: belt, teeth, permissible radial force by its distance, output bearing.
#
# Symbols: F_t tangential force, F_r radial, F_a axial [N]; M tilting moment [N*m]; x distance of the radial force
# from the mounting face, a of the bearing behind that face [m]; α pressure angle, β helix angle [rad].
#
# Sources: Machine Design, Tension in timing-belt drives (7 June 2001); Control Engineering, ServoSoft help, belt
# forces; DIN 3960 and ISO 21771 for the teeth; SEW-Eurodrive, project planning for gear units, overhung loads (off-
# centre force application); Harmonic Drive CSF and CSG catalogue, output bearing ratings, equations 11 to 13, and
# FHA-C manual, equations 5 to 10; ISO 281, ISO 76.


ROLLER = 10.0 / 3.0  # exponent of the life of rollers, ISO 281
_THRUST = 1.5  # F_a over the rest, above which thrust leads


def pulley_load(effective: Figure, pretension: Figure, angle: Figure = 0.0) -> Alike:
    r"""Force of a belt on the shaft of its pulley.

    .. math:: F_1 = \max(F_v + F_t / 2, \, F_t), \quad F_2 = \max(F_v - F_t / 2, \, 0), \quad
              F = \sqrt{F_1^2 + F_2^2 + 2 F_1 F_2 \cos γ}

    With fixed centres the sum of both strands stays as tensioned until the slack one hangs through.

    Parameters
    ----------
    effective
        F_t, the difference of the strands [N].
    pretension
        F_v of each strand at rest [N].
    angle
        γ between the strands [rad].

    Returns
    -------
    float or array
        Force [N].

    Examples
    --------
    Tight side 700 N and slack side 0 and two parallel strands of 700 N each: twice the pretension, or the effective
    tension where that is more.

    >>> [float(pulley_load(500.0, 700.0)), float(pulley_load(1500.0, 700.0))]
    [1400.0, 1500.0]
    """
    tight = np.maximum(pretension + effective / 2.0, effective)
    slack = np.maximum(pretension - effective / 2.0, 0.0)
    return np.sqrt(tight**2 + slack**2 + 2.0 * tight * slack * np.cos(angle))


def tooth_shares(pressure: Figure, helix: Figure = 0.0) -> tuple[Alike, Alike]:
    r"""Radial and axial force of a spur or helical pinion per tangential force.

    .. math:: \frac{F_r}{F_t} = \sqrt{1 + \left( \frac{\tan α}{\cos β} \right)^2}, \qquad \frac{F_a}{F_t} = \tan β

    Parameters
    ----------
    pressure
        α, in the normal section [rad].
    helix
        β [rad].

    Returns
    -------
    tuple
        The resultant of tangential and separating force, and the axial one [1].

    Examples
    --------
    >>> round(float(tooth_shares(np.radians(20.0))[0]), 4)  # 1 / cos 20°
    1.0642
    """
    return np.hypot(1.0, np.tan(pressure) / np.cos(helix)), np.tan(helix)


def bevel_share(pressure: Figure, ratio: Figure) -> tuple[Alike, Alike]:
    r"""Radial and axial force of a straight bevel pinion per tangential force at its mean diameter, shafts at 90°.

    .. math:: \frac{F_r}{F_t} = \sqrt{1 + (\tan α \cos δ)^2}, \quad \frac{F_a}{F_t} = \tan α \sin δ, \quad
              \tan δ = \frac{1}{i}

    Parameters
    ----------
    pressure
        α [rad].
    ratio
        i, turns of the pinion per turn of the wheel.

    Returns
    -------
    tuple
        As ``tooth_shares``.
    """
    cone = np.arctan(1.0 / ratio)
    return np.hypot(1.0, np.tan(pressure) * np.cos(cone)), np.tan(pressure) * np.sin(cone)


def permissible_radial(limit: Figure, printed_at: Figure, distance: Figure, bearing: Figure) -> Alike:
    r"""Permissible radial force at another distance than the printed one.

    .. math:: F(x) = F(l_0) \, \frac{l_0 + a}{x + a}; \quad
              F(x) = F(l_0) \, \min\left( 1, \frac{l_0}{x} \right) \text{ where a is not known}

    Parameters
    ----------
    limit
        F(l_0) [N].
    printed_at
        l_0 [m].
    distance
        x [m].
    bearing
        a [m]; NaN where it is not known: then the moment about the face is kept beyond l_0, which is never too much,
        and nothing is added before it.

    Returns
    -------
    float or array
        Force [N]; NaN where l_0 is not known, unless there is no limit.

    Notes
    -----
    SEW-Eurodrive: F_xL = F_Ra a / (b + x), by the life of the bearing.

    Examples
    --------
    >>> [round(float(permissible_radial(900.0, 0.015, 0.03, a))) for a in (0.03, np.nan)]
    [675, 450]
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        by_lever = np.where(distance > printed_at, printed_at / distance, 1.0) + 0.0 * printed_at
        share = np.where(np.isnan(bearing), by_lever, (printed_at + bearing) / (distance + bearing))
        return np.where(np.isposinf(limit), limit, limit * share)


def dynamic_load(radial: Figure, axial: Figure, moment: Figure, diameter: Figure) -> Alike:
    r"""Dynamic equivalent load of a cross roller bearing.

    .. math:: P = X \left( F_r + \frac{2 M}{d_p} \right) + Y F_a

    X = 1, Y = 0.45 up to :math:`F_a = 1.5 (F_r + 2 M / d_p)`, X = Y = 0.67 beyond.

    Parameters
    ----------
    radial, axial
        Mean forces F_r and F_a [N].
    moment
        Tilting moment M about the bearing [N*m].
    diameter
        Pitch circle d_p [m].

    Returns
    -------
    float or array
        P [N].
    """
    turning = radial + 2.0 * moment / diameter
    thrust = axial > _THRUST * turning
    return np.where(thrust, 0.67, 1.0) * turning + np.where(thrust, 0.67, 0.45) * axial


def static_load(radial: Figure, axial: Figure, moment: Figure, diameter: Figure) -> Alike:
    r"""Static equivalent load of a cross roller bearing, :math:`P_0 = F_r + 2 M / d_p + 0.44 F_a` [N].

    Parameters
    ----------
    radial, axial, moment, diameter
        As for ``dynamic_load``, at the worst moment.

    Returns
    -------
    float or array
        P_0 [N].
    """
    return radial + 2.0 * moment / diameter + 0.44 * axial


def bearing_life(rating: Figure, load: Figure, speed: Figure, exponent: float = ROLLER) -> Alike:
    r"""Nominal life of a rolling bearing.

    .. math:: L_{10} = \frac{10^6 \cdot 2 π}{n} \left( \frac{C}{P} \right)^p

    Parameters
    ----------
    rating
        Dynamic rating C [N].
    load
        Dynamic equivalent load, times the factor f_w of impacts [N].
    speed
        Mean speed n, rests included [rad/s].
    exponent
        p.

    Returns
    -------
    float or array
        Life [s]; infinite without load or speed.

    Examples
    --------
    C = P: a million turns, 500 h at 33 1/3 rpm (ISO 281).

    >>> round(float(bearing_life(9600.0, 9600.0, 100.0 / 3.0 * np.pi / 30.0)) / 3600.0, 6)
    500.0
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        idle = np.where(np.isnan(rating), np.nan, np.inf)
        return np.where(load * speed == 0.0, idle, np.divide(2e6 * np.pi, speed) * np.divide(rating, load) ** exponent)
