"""The drive model on columns: what a load cycle asks of every candidate, exactly and at a cost of its own length once.

For one load cycle and one belt the motor's torque is linear in six functions of time at the gearhead's output:
driving torque, braking torque, torque at rest, acceleration, direction and speed, with coefficients that depend on
the candidate alone. So the RMS current of every candidate is a quadratic form in one 6 x 6 matrix of exact segment
integrals, and peaks of current and voltage lie at the ends of segments.
Symbols: i ratio, e efficiency, J inertia [kg*m^2], T torque [N*m], w speed [rad/s], K whole reduction.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.loadcycle import Ends, LoadCycle, integral, mean_product, rms

__all__ = ["AtGearhead", "Demands", "at_gearhead", "demands"]

DRIVING, BRAKING, AT_REST, ACCELERATION, DIRECTION, SPEED = range(6)


class AtGearhead(NamedTuple):
    """A load cycle at the gearhead's output, behind one belt."""

    cycle: LoadCycle
    belt: float  # its ratio
    functions: NDArray[np.float64]  # (segments, 2, 6)
    moments: NDArray[np.float64]  # (6, 6): means of their products over the cycle
    torque: Ends  # N*m
    speed: Ends  # rad/s
    rms_torque: float  # N*m, while running
    peak_torque: float
    peak_speed: float  # rad/s
    sustained_speed: float  # rad/s, the highest at which it stays
    mean_power: float  # W, transmitted in either direction while running
    peak_power: float


class Demands(NamedTuple):
    """What each candidate's motor must do: SI columns."""

    rms_torque: NDArray[np.float64]  # N*m, friction of the motor included
    peak_torque: NDArray[np.float64]
    rms_current: NDArray[np.float64]  # A
    peak_current: NDArray[np.float64]
    peak_time: NDArray[np.float64]  # s, of the peak current
    peak_speed: NDArray[np.float64]  # rad/s
    coefficients: NDArray[np.float64]  # (candidates, 6): motor torque from the functions


def at_gearhead(cycle: LoadCycle, ratio: float, efficiency: float) -> AtGearhead:
    r"""A load cycle through a belt, with the direction of power deciding on which side its loss falls.

    .. math:: T_g = \frac{T}{i e} \; (T w > 0), \quad \frac{T e}{i} \; (T w < 0), \quad \frac{T}{i} \; (w = 0)

    Parameters
    ----------
    cycle
        At the load, split at changes of direction.
    ratio, efficiency
        Of the belt [1]; driven backward its efficiency is taken to be the same.
    """
    power = (cycle.torque.mean(1) * cycle.speed.mean(1))[:, None]
    running = np.any(cycle.speed != 0.0, axis=1)
    torque = cycle.torque / ratio * np.where(~running[:, None], 1.0, np.where(power > 0.0, 1 / efficiency, efficiency))
    speed, acceleration = cycle.speed * ratio, cycle.acceleration * ratio
    none = np.zeros_like(torque)
    functions = np.stack([
        np.where(running[:, None] & (power > 0.0), torque, none),
        np.where(running[:, None] & (power <= 0.0), torque, none),
        np.where(~running[:, None], torque, none),
        acceleration,
        np.broadcast_to(np.sign(speed.mean(1))[:, None], torque.shape),
        speed,
    ], axis=2)  # fmt: skip
    moments = np.array([
        [integral(cycle.duration, functions[:, :, a], functions[:, :, b]) for a in range(6)] for b in range(6)
    ]) / cycle.total  # fmt: skip
    return AtGearhead(cycle, ratio, functions, moments, torque, speed, **_extremes(cycle, torque, speed, running))


def _extremes(cycle: LoadCycle, torque: Ends, speed: Ends, running: NDArray[np.bool_]) -> dict[str, float]:
    time = cycle.duration[running]
    level = running & (speed[:, 0] == speed[:, 1])
    fastest = np.abs(speed).max()
    worked = float(np.sum(time * np.abs(mean_product(torque, speed)[running])))
    return {
        "rms_torque": rms(time, torque[running]),
        "peak_torque": float(np.abs(torque).max()),
        "peak_speed": float(fastest),
        "sustained_speed": float(np.abs(speed[level]).max() if level.any() else fastest),
        "mean_power": worked / time.sum() if time.sum() else 0.0,
        "peak_power": float(np.abs(torque * speed).max()),
    }


def demands(at: AtGearhead, motor: Any, gearhead: Any, encoder: Any) -> Demands:
    r"""Torque and current of every candidate's motor.

    .. math:: \tau = \frac{T}{i e} \text{ or } \frac{T e}{i} + (J_m + J_g + J_e) i a + k_t I_0 \, \mathrm{sgn} w

    Parameters
    ----------
    at
        The load cycle at the gearhead's output.
    motor, gearhead, encoder
        Figures of the candidates' parts by field name: columns. An unknown inertia of the gearhead makes the
        demands unknown; that of an encoder, thousands of times smaller than the load's, is then left out.

    Notes
    -----
    Brushed motors lose k_t I_0 at any speed; of brushless ones the no-load loss is taken to rise with speed, up to
    k_t I_0 at the no-load speed.
    """
    i, e, k_t = gearhead["ratio"], gearhead["efficiency"], motor["torque_constant"]
    friction = k_t * motor["no_load_current"]
    brushed = motor["kind"] == "brushed"
    c = np.stack([
        1 / (i * e),
        e / i,
        1 / i,
        (motor["rotor_inertia"] + gearhead["inertia"] + np.nan_to_num(encoder["inertia"])) * i,
        np.where(brushed, friction, 0.0),
        np.where(brushed, 0.0, friction * i / motor["no_load_speed"]),
    ], axis=1)  # fmt: skip
    points = at.functions.reshape(-1, 6)
    torque = np.abs(c @ points.T)
    worst = np.argmax(np.where(np.isnan(torque), -1.0, torque), axis=1)
    peak = torque[np.arange(len(c)), worst]
    square = np.einsum("ka,ab,kb->k", c, at.moments, c)
    rms_torque = np.sqrt(np.maximum(square, 0.0))
    return Demands(
        rms_torque=rms_torque,
        peak_torque=peak,
        rms_current=rms_torque / k_t,
        peak_current=peak / k_t,
        peak_time=at.cycle.time.reshape(-1)[worst],
        peak_speed=at.peak_speed * i,
        coefficients=c,
    )


def peak_voltage(at: AtGearhead, asked: Demands, motor: Any, gearhead: Any, resistance: Any) -> NDArray[np.float64]:
    r"""Largest voltage that each candidate's motor needs, at a given resistance of its winding [V].

    .. math:: V = R I + k_e K w

    Parameters
    ----------
    at, asked
        The cycle, and what it asks of the candidates.
    motor, gearhead
        Figures of the candidates' parts by field name: columns.
    resistance
        Of each candidate's winding, cold or hot [ohm].
    """
    k_t = motor["torque_constant"]
    c = asked.coefficients * (resistance / k_t)[:, None]
    c[:, SPEED] += k_t * gearhead["ratio"]
    volts: NDArray[np.float64] = np.abs(c @ at.functions.reshape(-1, 6).T).max(1)
    return volts
