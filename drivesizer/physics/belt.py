"""Geometry of a toothed belt round two pulleys, and the resonance of motor and load on an elastic shaft or belt.

Everything is along the pitch line, where the belt keeps its length. Teeth are counts, lengths are in m, angles in rad;
a figure is a float or a column. Which pulley drives makes no difference. Sources: SDP/SI, Handbook of Timing Belts,
Pulleys, Chains and Sprockets (Technical Section), and Gates, PowerGrip Drive Design Manual 17195; where they print an
approximation the exact open belt is computed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from drivesizer.physics.figures import Alike, Figure

LEAST_IN_MESH = 6.0  # teeth, from where a belt's rating counts in full: SDP/SI handbook, section 13.3
_STEPS = 30  # of Newton's method, at most: five do for pulleys that nearly touch, 8 teeth beside 200
_NEAR_ENOUGH = 1e-12  # of the centre distance


def pitch_diameter(teeth: Figure, pitch: Figure) -> Alike:
    r"""Diameter at which the belt runs [m], :math:`d = z p / \pi`.

    Parameters
    ----------
    teeth
        Of the pulley [1].
    pitch
        Of the belt [m].

    Returns
    -------
    float or array
        Diameter [m].

    Examples
    --------
    >>> round(1e3 * pitch_diameter(18, 5e-3), 2)
    28.65
    """
    return teeth * pitch / np.pi


def _lean(teeth: Figure, other: Figure, pitch: Figure, distance: Figure) -> Alike:
    r"""Angle of the spans to the line of centres [rad], :math:`\sin \varphi = (d_2 - d_1) / 2a`; not negative."""
    apart = np.abs(pitch_diameter(teeth, pitch) - pitch_diameter(other, pitch))
    return np.arcsin(apart / (2.0 * distance))


def wrap_angle(teeth: Figure, other: Figure, pitch: Figure, distance: Figure) -> Alike:
    r"""Angle over which the belt lies on the small pulley [rad], :math:`\beta = \pi - 2 \varphi`.

    Parameters
    ----------
    teeth, other
        Teeth of the two pulleys [1].
    pitch
        Of the belt [m].
    distance
        Between the centres [m].

    Returns
    -------
    float or array
        Angle [rad].
    """
    return np.pi - 2.0 * _lean(teeth, other, pitch, distance)


def teeth_in_mesh(teeth: Figure, other: Figure, pitch: Figure, distance: Figure) -> Alike:
    r"""Teeth of the small pulley that the belt holds, :math:`z_1 \beta / 2\pi`; makers round it down.

    Parameters
    ----------
    teeth, other
        Teeth of the two pulleys [1].
    pitch
        Of the belt [m].
    distance
        Between the centres [m].

    Returns
    -------
    float or array
        Teeth [1], not rounded.
    """
    return np.minimum(teeth, other) * wrap_angle(teeth, other, pitch, distance) / (2.0 * np.pi)


def belt_length(teeth: Figure, other: Figure, pitch: Figure, distance: Figure) -> Alike:
    r"""Length of the belt [m]: two spans and two arcs.

    :math:`L = 2 a \cos\varphi + \pi (d_1 + d_2) / 2 + \varphi (d_2 - d_1)`. The form that handbooks print,
    :math:`2 a + \pi (d_1 + d_2) / 2 + (d_2 - d_1)^2 / 4a`, is its beginning in :math:`\varphi`.

    Parameters
    ----------
    teeth, other
        Teeth of the two pulleys [1].
    pitch
        Of the belt [m].
    distance
        Between the centres [m].

    Returns
    -------
    float or array
        Length along the pitch line [m].
    """
    d_1, d_2 = pitch_diameter(teeth, pitch), pitch_diameter(other, pitch)
    lean = _lean(teeth, other, pitch, distance)
    return 2.0 * distance * np.cos(lean) + np.pi * (d_1 + d_2) / 2.0 + lean * np.abs(d_2 - d_1)


def centre_distance(teeth: Figure, other: Figure, pitch: Figure, belt_teeth: Figure) -> Alike:
    r"""Centre distance at which a belt is neither slack nor stretched [m]; NaN where it is too short for any.

    By Newton's method with :math:`dL/da = 2 \cos\varphi`. The length is convex in the distance and never less than
    :math:`2 a + \pi (d_1 + d_2) / 2`, so that from the distance which makes it that the steps come down to the answer.
    A belt is too short when the pulleys would lie inside each other's pitch circles.

    Parameters
    ----------
    teeth, other
        Teeth of the two pulleys [1].
    pitch
        Of the belt [m].
    belt_teeth
        Teeth of the belt [1].

    Returns
    -------
    float or array
        Distance [m].
    """
    teeth, other, belt_teeth = np.broadcast_arrays(*(np.asarray(z, float) for z in (teeth, other, belt_teeth)))
    touching = (pitch_diameter(teeth, pitch) + pitch_diameter(other, pitch)) / 2.0
    long_enough = belt_teeth * pitch >= belt_length(teeth, other, pitch, touching)
    distance = np.where(long_enough, pitch * (belt_teeth - (teeth + other) / 2.0) / 2.0, touching)
    for _ in range(_STEPS):
        off = belt_length(teeth, other, pitch, distance) - belt_teeth * pitch
        step = off / (2.0 * np.cos(_lean(teeth, other, pitch, distance)))
        distance = np.where(long_enough, np.maximum(distance - step, touching), distance)
        if not (np.abs(step) > _NEAR_ENOUGH * distance)[long_enough].any():
            break
    return np.where(long_enough, distance, np.nan)[()]


def shortest_recommended(teeth: Figure, other: Figure, pitch: Figure) -> Alike:
    """Least centre distance that is recommended for a new drive [m], 0.2 p (z_1 + z_2).

    Autodesk Inventor, Engineer's Handbook, "Calculation of synchronous belt"; a quarter more than where the pulleys
    would touch.

    Parameters
    ----------
    teeth, other
        Teeth of the two pulleys [1].
    pitch
        Of the belt [m].

    Returns
    -------
    float or array
        Distance [m].
    """
    return 0.2 * pitch * (teeth + other)


class TwoMasses(NamedTuple):
    """Undamped frequencies of motor and load on a spring between them."""

    anti_resonance: Alike  # Hz, at which the load swings against a motor at rest
    resonance: Alike  # Hz


def resonance(stiffness: Figure, load_inertia: Figure, ratio: Figure) -> TwoMasses:
    r"""Anti-resonance and resonance of two masses, :math:`\omega_a = \sqrt{c / J_L}, \omega_r = \omega_a \sqrt{r}`.

    Parameters
    ----------
    stiffness
        Of shaft or belt, c, seen at the load [N*m/rad].
    load_inertia
        J_L [kg*m^2].
    ratio
        Inertia of motor and load over that of the motor, both at the same shaft, r [1].

    Returns
    -------
    TwoMasses
        Frequencies [Hz].

    References
    ----------
    .. [1] D. Schröder, *Elektrische Antriebe - Regelung von Antriebssystemen*, Springer: the elastic two-mass system.

    Examples
    --------
    >>> [round(float(f), 3) for f in resonance(400.0, 1.0, 4.0)]
    [3.183, 6.366]
    """
    anti = np.sqrt(stiffness / load_inertia)
    return TwoMasses(anti / (2.0 * np.pi), anti * np.sqrt(ratio) / (2.0 * np.pi))
