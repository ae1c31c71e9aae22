r"""Curves of one part: torque over speed at nominal voltage, continuous region, permitted current, a gear's efficiency.

The straight line at nominal voltage is that of the winding at the temperature of the data sheet. Its ends are the
maker's; one that is unknown follows from

.. math:: \omega_0 = \frac{V - R I_0}{k_e}, \qquad M_H = \frac{k_t k_e}{R} \omega_0,

with k_e that of ``back_emf``; that of an actuator is its motor's at the output, where k_t has the gear's losses in it.
Symbols: w speed [rad/s], M torque [N*m], V voltage [V], I current [A], R resistance [ohm], k_t torque constant
[N*m/A], k_e voltage per speed [V*s/rad].
"""

from __future__ import annotations

from math import isnan, nan
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.drive_train import ELECTRONICS, back_emf_constant, gear_loss
from drivesizer.physics.overload import State, cold, overload_time, steady_state
from drivesizer.physics.stress import housing_loss
from drivesizer.physics.thermal import (
    DATA_TEMPERATURE,
    continuous_current,
    current_derating,
    rated_ambient,
    resistance_25,
    two_bodies,
)

__all__ = [
    "HEAT",
    "Line",
    "PartFigures",
    "continuous_curve",
    "gear_efficiency",
    "line",
    "nominal_voltage_curves",
    "overload_times",
    "permitted_current",
]  # fmt: skip

HEAT = ("max_winding_temperature", "resistance", "thermal_resistance_winding", "thermal_resistance_housing")


class PartFigures(Protocol):
    """A part: figures by field name, NaN unknown, and the section of the catalogue that it is in."""

    @property
    def section(self) -> str:
        """Of the catalogue, such as motors."""

    def __getitem__(self, name: str) -> Any:
        """A figure."""


class Line(NamedTuple):
    """The ends of the straight line at nominal voltage; NaN is unknown."""

    speed: float  # rad/s, at no torque
    torque: float  # N*m, at no speed
    computed: bool  # whether an end is not the maker's


def line(hit: PartFigures) -> Line:
    """No load and stall of a motor, or of an actuator's output, with a cold winding."""
    voltage, R, k_t = hit["nominal_voltage"], hit["resistance"], _torque_constant(hit)
    if hit.section == "actuators":
        inside, own = hit["motor_torque_constant"], hit["motor_back_emf_constant"]
        k_e = (inside if isnan(own) else own) * hit["ratio"]
    else:
        k_e = float(back_emf_constant(hit))
    speed, torque = hit["no_load_speed"], hit["stall_torque"]
    computed = isnan(speed) or isnan(torque)
    if isnan(speed) and k_e > 0.0:
        speed = (voltage - R * hit["no_load_current"]) / k_e
    if isnan(torque) and R > 0.0:
        torque = k_t * k_e / R * speed
    known = speed > 0.0 and torque > 0.0
    return Line(speed, torque, computed) if known else Line(nan, nan, computed)


def _torque_constant(hit: PartFigures) -> float:
    """Of a motor, or of an actuator at its output, losses of the gear included [N*m/A]."""
    k_t = float(hit["torque_constant"])
    if hit.section == "actuators" and isnan(k_t):
        return float(hit["motor_torque_constant"] * hit["ratio"] * hit["efficiency"])
    return k_t


def nominal_voltage_curves(hit: PartFigures, torque: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    r"""Speed, current and efficiency on the straight line at nominal voltage.

    .. math:: w = w_0 \left(1 - \frac{M}{M_H}\right), \qquad I = I_0 + \frac{M}{k_t}, \qquad \eta = \frac{M w}{V I}

    Above the permitted speed, where the voltage must be lower, all three are unknown. Of a motor with its controller
    inside, which limits the no-load speed, current and efficiency are unknown.
    """
    ends = line(hit)
    speed = ends.speed * (1.0 - torque / ends.torque)
    speed = np.where(speed > hit["max_speed"], np.nan, speed)
    own = hit["no_load_current"] if hit.section == "actuators" or hit["commutation"] != ELECTRONICS else np.nan
    current = own + torque / _torque_constant(hit) + 0.0 * speed
    return speed, current, torque * speed / (hit["nominal_voltage"] * current)


def gear_efficiency(hit: PartFigures, torque: NDArray[np.float64]) -> NDArray[np.float64]:
    r"""Efficiency of a gearhead over the torque at its output, its losses without load apart (``gear_loss``).

    .. math:: \frac{1}{\eta} = \frac{1}{e'} + \frac{i\,T_0}{T}
    """
    efficiency, _ = gear_loss(hit)
    return np.asarray(1.0 / (1.0 / efficiency + hit["ratio"] * hit["no_load_torque"] / torque))


def continuous_curve(hit: PartFigures) -> tuple[list[float], list[float]]:
    """Continuous torque [N*m] and speed [rad/s] through the maker's three points; nothing where one is unknown.

    Iron losses at speed reduce the permitted copper losses: the square of the torque falls with a power of the speed.
    """
    if hit.section != "motors":
        return [], []
    top, torques = hit["max_speed"], [hit[f"{at}_torque"] for at in ("standstill", "half_speed", "top_speed")]
    if isnan(top + sum(torques)):
        return [], []
    rest, half, end = (torque**2 for torque in torques)
    if not rest > half > end:  # no power law goes through them
        return torques, [0.0, top / 2.0, top]
    share = np.linspace(0.0, 1.0, 41)
    squares = rest - (rest - end) * share ** np.log2((rest - end) / (rest - half))
    return np.sqrt(squares).tolist(), (share * top).tolist()


def permitted_current(hit: PartFigures, ambient: float) -> float:
    """Continuous current in an ambient [K]: the nominal one, derated; else by heat alone, at standstill [A].

    NaN above the permitted ambient, and where a figure is unknown.
    """
    limit = hit["max_winding_temperature"]
    if ambient > hit["ambient_max"]:
        return nan
    if not isnan(hit["nominal_current"]):
        return float(hit["nominal_current"] * current_derating(ambient, limit, rated_ambient(hit)))
    R_th1, R_th2 = (hit[name] for name in HEAT[2:])
    return float(continuous_current(resistance_25(hit), R_th1, R_th2, limit, ambient))


def overload_times(hit: PartFigures, current: float) -> tuple[float, float]:
    """Time for which the winding withstands a current at standstill in 25 degC [s], from cold and from warm.

    Warm is winding and housing as warm as the housing gets at the nominal point in the long run: a motor that has just
    been running. An actuator's loss of friction and iron is not known, so that its warmth is not.
    """
    bodies, limit = two_bodies(hit), hit["max_winding_temperature"]
    loss = nan
    if hit.section == "motors":
        rubbing, iron = housing_loss(hit, np.ones(1))
        loss = float(rubbing[0] * hit["nominal_speed"] + iron[0] * hit["nominal_speed"] ** 2)
    housing = steady_state(bodies, DATA_TEMPERATURE, hit["nominal_current"], loss).housing
    starts = (cold(DATA_TEMPERATURE), State(housing, housing))
    from_cold, from_warm = (overload_time(bodies, DATA_TEMPERATURE, at, limit, current) for at in starts)
    return from_cold, from_warm
