r"""Screws: buckling, critical speed, life, friction and inertia of ball screws and trapezoidal screws.

Symbols: d nominal diameter, d_r core diameter, L free length, P lead [m]; F axial force, C_a dynamic and C_0a static
load rating [N]; f_w load factor; w speed [rad/s].

Sources: THK General Catalogue, A-688 to A-745; HIWIN Ballscrews BS-08-2-EN, 3.7; Bosch Rexroth R310 3301, design
calculation; NBS Components for linear motion; Thomson, critical speed and column buckling; ISO 3408-5.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from math import pi
from typing import Literal, NamedTuple, get_args

import numpy as np

from drivesizer.physics import gear_life
from drivesizer.physics.figures import Alike, Array, Figure

Fixity = Literal["fixed-fixed", "fixed-supported", "supported-supported", "fixed-free"]
Design = Literal["beam", "THK", "HIWIN", "Rexroth", "NBS", "Thomson"]
ENDS: tuple[str, ...] = get_args(Fixity)

_STEEL = 7850.0  # kg/m^3
_ELASTICITY = 2.06e11  # Pa, as THK A-694 has it
_STRESS = 147e6  # Pa, permissible in the core by THK A-694
_FLANK = math.radians(15.0)  # of a trapezoidal thread
_ROLLING = 0.05  # of the preload's torque, by THK A-688


class Rules(NamedTuple):
    """A maker's way from a core of steel to the permissible load and speed, by end fixity, and its safety."""

    buckling: Mapping[str, float]  # k of F = k 1e4 d_r^4 / L^2 [N, mm]
    critical_speed: Mapping[str, float]  # k of n = k 1e7 d_r / L^2 [rpm, mm]
    safety: tuple[float, float]  # by which buckling load and critical speed are multiplied to be permissible


def _by_ends(*values: float) -> dict[str, float]:
    return dict(zip(ENDS, values, strict=True))


def _beam() -> Rules:
    """Euler's column and the bending wave of a bar: exact factors, in the units of the catalogues."""
    column = pi**3 * _ELASTICITY / 64.0 / 1e10
    wave = math.sqrt(_ELASTICITY / _STEEL) / 4.0 * 60.0 / (2.0 * pi) / 1e4
    return Rules(
        _by_ends(*(column * n for n in (4.0, 2.0457, 1.0, 0.25))),
        _by_ends(*(wave * x**2 for x in (4.7300, 3.9266, pi, 1.8751))),
        (0.5, 0.8),
    )


_INCH = 6894.757e-10 * 14.03e6, 4.76e6 * 25.4 / 1e7  # of 1 lbf and 1 rpm, by inches, in the units of the others
# THK's printed factors hold both safeties; it prints no buckling load of a shaft with two loose ends.
DESIGNS: dict[str, Rules] = {
    "beam": _beam(),
    "THK": Rules(_by_ends(20.0, 10.0, math.nan, 1.3), _by_ends(21.9, 15.1, 9.7, 3.4), (1.0, 1.0)),
    "HIWIN": Rules(
        _by_ends(40.72, 20.36, 10.18, 2.545), _by_ends(27.1, 27.1 * 0.692, 27.1 * 0.446, 27.1 * 0.147), (0.5, 0.8)
    ),
    "Rexroth": Rules(_by_ends(40.6, 20.4, 10.2, 2.6), _by_ends(27.4, 18.9, 12.1, 4.3), (0.5, 0.8)),
    "NBS": Rules(_by_ends(40.6, 20.4, 10.2, 2.6), _by_ends(27.4, 18.9, 12.1, 4.3), (0.5, 0.8)),
    "Thomson": Rules(
        _by_ends(*(_INCH[0] * k for k in (4.0, 2.0, 1.0, 0.25))),
        _by_ends(*(_INCH[1] * k for k in (2.23, 1.47, 1.0, 0.36))),
        (0.8, 0.8),
    ),
}


def buckling_load(root_diameter: Figure, length: Figure, ends: str, design: str = "beam") -> Alike:
    r"""Permissible axial load against buckling.

    .. math:: F = s \, k \, 10^4 \, d_r^4 / L^2 \quad [N, mm]

    Parameters
    ----------
    root_diameter
        Core diameter d_r [m].
    length
        Free length L, from nut to bearing at most [m].
    ends
        One of ``ENDS``.
    design
        Whose factors k and safety s, a key of ``DESIGNS``.

    Returns
    -------
    float or array
        Load [N]; NaN where the maker prints no factor.

    Examples
    --------
    THK, A-726: d_r 17.5 mm, 1100 mm, fixed-fixed: 15 500 N.

    >>> round(buckling_load(17.5e-3, 1.1, "fixed-fixed", "THK"), -2)
    15500.0
    """
    rules = DESIGNS[design]
    return rules.safety[0] * rules.buckling[ends] * 1e10 * root_diameter**4 / length**2


def core_load(root_diameter: Figure) -> Alike:
    """Permissible tensile and compressive load of the core [N], at 147 MPa: 116 d_r² of THK, A-694.

    >>> round(core_load(17.5e-3), -2)
    35400.0
    """
    return _STRESS * pi / 4.0 * root_diameter**2


def critical_speed(root_diameter: Figure, length: Figure, ends: str, design: str = "beam") -> Alike:
    r"""Permissible speed below the first bending resonance.

    .. math:: n = s \, k \, 10^7 \, d_r / L^2 \quad [rpm, mm]

    Parameters
    ----------
    root_diameter
        Core diameter d_r [m].
    length
        Free length L between the bearings [m].
    ends
        One of ``ENDS``.
    design
        Whose factors k and safety s, a key of ``DESIGNS``.

    Returns
    -------
    float or array
        Speed [rad/s].

    Examples
    --------
    THK, A-727: d_r 26.4 mm, 1100 mm, fixed-supported: 3294 rpm.

    >>> round(critical_speed(26.4e-3, 1.1, "fixed-supported", "THK") * 30.0 / pi)
    3295
    """
    rules = DESIGNS[design]
    return rules.safety[1] * rules.critical_speed[ends] * 1e4 * root_diameter / length**2 * pi / 30.0


class MeanLoad(NamedTuple):
    """Mean axial loads of the two flanks of the thread, over the whole distance."""

    forward: Alike  # N, of the flank that is loaded by a force above 0
    backward: Alike  # N


def mean_load(duration: Array, speed: Array, force: Array, preload: Figure = 0.0) -> MeanLoad:
    r"""Mean axial load of a nut by the distance, for its life.

    .. math:: F_m = \left( \frac{\sum F_i^3 \, l_i}{\sum l_i} \right)^{1/3}, \quad
              F_i = F_{pr} \left( 1 + \frac{F}{2^{3/2} F_{pr}} \right)^{3/2} \; (|F| < 2^{3/2} F_{pr})

    Each flank has its own: a force below 0 loads the other one. A preload loads both until the force is
    :math:`2^{3/2}` of it.

    Parameters
    ----------
    duration
        Of each segment [s].
    speed, force
        At both ends of each segment [m/s], [N], straight between them; shape (segments, 2), or with samples along
        a last axis. No segment turns round.
    preload
        Of the nut [N].

    Returns
    -------
    MeanLoad
        0 where nothing moves.

    Notes
    -----
    THK A-705 and A-729 with each direction by itself; HIWIN F 3.6 to F 3.10 with the preload.
    """
    speed, force = np.broadcast_arrays(speed, force)
    limit = 2.0**1.5 * preload
    with np.errstate(divide="ignore", invalid="ignore"):
        rise = force[:, 1] - force[:, 0]
        kinks = [np.clip(np.nan_to_num((f - force[:, 0]) / rise, posinf=1.0, neginf=0.0), 0.0, 1.0)
                 for f in (-limit, 0.0 * limit, limit)]  # fmt: skip
    edges = np.stack([0.0 * kinks[0], *np.sort(kinks, axis=0), 0.0 * kinks[0] + 1.0], axis=1)
    ends = (x[:, :1] + (x[:, 1:] - x[:, :1]) * edges for x in (speed, force))
    v, F = (np.stack([x[:, :-1], x[:, 1:]], axis=2).reshape(-1, 2, *x.shape[2:]) for x in ends)
    t = (duration[:, None] * np.diff(edges, axis=1)).reshape(-1, *edges.shape[2:])
    distance = gear_life.turned_load(t, F, v, 0.0)

    def flank(sign: float) -> Alike:
        cubes = gear_life.turned_load(t, F, v, 3.0, lambda force: _on_flank(sign * force, preload))
        return gear_life.mean_load(cubes, distance, 3.0)

    return MeanLoad(flank(1.0), flank(-1.0))


def _on_flank(force: Array, preload: Figure) -> Array:
    """Load of the flank that a force above 0 loads, preload included [N]."""
    limit = 2.0**1.5 * preload
    with np.errstate(divide="ignore", invalid="ignore"):  # without a preload the limit is 0
        within = np.where(np.greater(preload, 0.0), preload * np.maximum(1.0 + force / limit, 0.0) ** 1.5, 0.0)
    return np.where(force >= limit, force, within)


def life_turns(dynamic_load: Figure, mean: MeanLoad, load_factor: float = 1.0) -> Alike:
    r"""Nominal life L_10 in turns.

    .. math:: L_{1,2} = \left( \frac{C_a}{f_w F_{m1,2}} \right)^3 10^6, \quad
              L = \left( L_1^{-10/9} + L_2^{-10/9} \right)^{-9/10}

    Parameters
    ----------
    dynamic_load
        Dynamic load rating C_a [N].
    mean
        Mean loads of both flanks.
    load_factor
        f_w of impacts, 1.2 to 1.5 up to 1 m/s (THK A-704); f_p of HIWIN.

    Returns
    -------
    float or array
        Turns that 90 % survive; infinite without load.

    Notes
    -----
    ISO 3408-5, as HIWIN F 3.11. THK takes one flank alone where both are alike, 1.87 times the turns.

    Examples
    --------
    THK, A-742: 9800 N, 492 N, f_w 1.5: 2.34e9 turns.

    >>> f"{life_turns(9800.0, MeanLoad(492.0, 0.0), 1.5):.3g}"
    '2.34e+09'
    """
    fatigue = sum((load_factor * load / dynamic_load) ** (10.0 / 3.0) for load in mean)  # of 10^6 turns, to 10/9
    with np.errstate(divide="ignore"):
        return 1e6 * np.float_power(fatigue, -0.9)


def _lead_angle(lead: Figure, diameter: Figure) -> Alike:
    return np.arctan(lead / (pi * diameter))


def thread_efficiency(lead: Figure, diameter: Figure, friction: Figure, flank: float = _FLANK) -> Alike:
    r"""Efficiency of a sliding thread that drives its nut.

    .. math:: e = \frac{\tan λ}{\tan(λ + ρ)}, \quad \tan λ = \frac{P}{π d_2}, \quad \tan ρ = \frac{μ}{\cos φ}

    Parameters
    ----------
    lead
        P [m].
    diameter
        Pitch diameter d_2 [m].
    friction
        Coefficient μ.
    flank
        Angle φ of the flank, 15° of a trapezoidal thread, 0 of a square one [rad].

    Returns
    -------
    float or array
        Efficiency.

    Examples
    --------
    THK, A-666: a lead angle of 5°30' and μ 0.2 give 32 %, without the flank's angle.

    >>> round(float(thread_efficiency(10e-3, 33e-3, 0.2, 0.0)), 2)
    0.32
    """
    angle = _lead_angle(lead, diameter)
    return np.tan(angle) / np.tan(angle + np.arctan(friction / math.cos(flank)))


def back_driving_efficiency(lead: Figure, diameter: Figure, friction: Figure, flank: float = _FLANK) -> Alike:
    r"""Efficiency of a sliding thread that its nut drives: tan(λ - ρ) / tan λ, below 0 where it locks itself.

    Parameters
    ----------
    lead, diameter, friction, flank
        As for ``thread_efficiency``.

    Returns
    -------
    float or array
        Efficiency.
    """
    angle = _lead_angle(lead, diameter)
    return np.tan(angle - np.arctan(friction / math.cos(flank))) / np.tan(angle)


def preload_torque(preload: Figure, lead: Figure, diameter: Figure) -> Alike:
    r"""Drag of a preloaded ball nut.

    .. math:: T = 0.05 \, (\tan β)^{-1/2} \, \frac{F_{pr} P}{2 π}

    Parameters
    ----------
    preload
        F_pr [N].
    lead
        P [m].
    diameter
        Of the ball centres, which gives the lead angle β [m].

    Returns
    -------
    float or array
        Torque [N*m].

    Examples
    --------
    THK, A-689: 3000 N, lead 10 mm, 41.75 mm: 865 N·mm.

    >>> round(float(preload_torque(3000.0, 10e-3, 41.75e-3)), 3)
    0.865
    """
    return _ROLLING / np.sqrt(lead / (pi * diameter)) * preload * lead / (2.0 * pi)


def shaft_inertia(diameter: Figure, length: Figure) -> Alike:
    r"""Inertia of a solid steel shaft, J = π ρ d⁴ L / 32.

    Parameters
    ----------
    diameter
        Nominal diameter d: makers' printed inertia is that of a smooth shaft of it [m].
    length
        L [m].

    Returns
    -------
    float or array
        Inertia [kg*m^2].

    Examples
    --------
    THK, BLK1510: 3.9e-4 kg·cm²/mm.

    >>> round(shaft_inertia(15e-3, 1e-3) * 1e4, 6)
    0.00039
    """
    return pi * _STEEL * diameter**4 * length / 32.0


def shaft_mass(diameter: Figure, length: Figure) -> Alike:
    """Mass of a solid steel shaft of the nominal diameter: its thread takes some of it away.

    Parameters
    ----------
    diameter, length
        [m].

    Returns
    -------
    float or array
        Mass [kg].
    """
    return pi / 4.0 * _STEEL * diameter**2 * length
