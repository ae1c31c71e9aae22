"""Curves of one part: torque over speed, continuous region, a gear's efficiency, pull-out torque of steppers."""

from __future__ import annotations

from math import isnan, nan
from typing import Any, NamedTuple, Protocol

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.catalog.parts import NO_PULL_OUTS, PullOuts
from drivesizer.catalog.view import STEPPER
from drivesizer.kernel.warming import State, overload_time, steady_state
from drivesizer.physics.drive_train import ELECTRONICS, back_emf_constant, gear_loss
from drivesizer.physics.figures import Alike, Array, Figures, Whole
from drivesizer.physics.stepper import pull_out_torque, rescaled_torque
from drivesizer.physics.thermal import (
    DATA_TEMPERATURE,
    continuous_current,
    current_derating,
    rated_ambient,
    resistance_25,
    two_bodies,
)
from drivesizer.physics.winding import housing_loss
from drivesizer.results.drive_set import DriveParts

# -- Pull-out torque of steppers out of the catalogue: by their printed curves, else by the model and its share.


_FIGURES = ("holding_torque", "nominal_current", "resistance", "inductance", "pole_pairs", "pull_out_share")


def curves_of(catalog: Catalog, row: int) -> PullOuts:
    """Printed curves of one stepper, as a record of its drive keeps them."""
    if STEPPER not in catalog.motors.columns:
        return NO_PULL_OUTS
    own = catalog.pull_outs.on(catalog.pull_outs.stepper == catalog.motors[STEPPER][row])
    return own._replace(stepper=np.zeros_like(own.stepper))


def torque_of_drive(drive: DriveParts, speed: Array, voltage: float) -> Array:
    """Pull-out torque of the stepper of a drive."""
    figures: dict[str, Any] = {name: np.array([getattr(drive.motor, name)]) for name in _FIGURES}
    return available_torque(figures | {STEPPER: np.zeros(1, int)}, drive.pull_outs, speed[None], voltage)[0]


def available_torque(motor: Figures, curves: PullOuts, speed: Array, voltage: Alike) -> Array:
    """Pull-out torque of steppers: by the printed curve where there is one, else the model's times its share.

    Of several curves that of the highest voltage that the supply reaches counts, else that of the lowest.
    """
    figures = {
        name: motor[column][:, None]
        for name, column in (("holding_torque", "holding_torque"), ("phase_current", "nominal_current"),
                             ("resistance", "resistance"), ("inductance", "inductance"), ("teeth", "pole_pairs"))
    }  # fmt: skip
    volts = np.broadcast_to(voltage, len(speed))
    torque: Array = motor["pull_out_share"][:, None] * pull_out_torque(speed, volts[:, None], **figures)
    if not len(curves.speed):
        return torque
    which = _curves_of(curves, volts, motor[STEPPER])
    rows = np.flatnonzero(which >= 0)
    if len(rows):
        at_speed, at_torque, at_voltage = (column[which[rows]] for column in _as_rows(curves))
        torque[rows] = rescaled_torque(speed[rows], volts[rows], at_speed, at_torque, at_voltage)
    return torque


def _curves_of(curves: PullOuts, voltage: Array, steppers: Whole) -> Whole:
    """Number of the curve of each stepper on its voltage; -1 where it has none."""
    count = int(steppers.max(initial=0)) + 1
    reached = np.searchsorted(np.unique(curves.voltage), voltage, side="right")  # between charts the choice is the same
    numbers = np.full(len(steppers), -1)
    for level in np.unique(reached):
        rows = np.flatnonzero(reached == level)
        numbers[rows] = _curve_of(curves, float(voltage[rows[0]]), count)[steppers[rows]]
    return numbers


def _curve_of(curves: PullOuts, voltage: float, count: int) -> Whole:
    """For each stepper the number of its curve for a supply voltage, -1 where it has none."""
    _, first = np.unique(curves.curve, return_index=True)
    volts = curves.voltage[first]
    nearness = np.where(volts <= voltage, volts, -volts)  # the highest below, else the lowest above
    numbers = np.full(count, -1)
    for number in np.argsort(nearness, kind="stable").tolist():
        if curves.stepper[first[number]] < count:
            numbers[curves.stepper[first[number]]] = number
    return numbers


def _as_rows(curves: PullOuts) -> tuple[Array, Array, Array]:
    """Speeds and torques of the curves, a row each, filled up with the last point; and their voltages."""
    _, first, number = np.unique(curves.curve, return_index=True, return_counts=True)
    place = first[:, None] + np.minimum(np.arange(number.max()), number[:, None] - 1)
    return curves.speed[place], curves.torque[place], curves.voltage[first]


# -- Curves of one part: torque over speed at nominal voltage, continuous region, permitted current, a gear's
# efficiency.
#
# The straight line at nominal voltage is that of the winding at the temperature of the data sheet. Its ends are the
# maker's; one that is unknown follows from
#
# .. math:: \omega_0 = \frac{V - R I_0}{k_e}, \qquad M_H = \frac{k_t k_e}{R} \omega_0,
#
# with k_e that of ``back_emf``; that of an actuator is its motor's at the output, where k_t has the gear's losses in
# it. Symbols: w speed [rad/s], M torque [N*m], V voltage [V], I current [A], R resistance [ohm], k_t torque constant
# [N*m/A], k_e voltage per speed [V*s/rad].


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


def line(part: PartFigures) -> Line:
    """No load and stall of a motor, or of an actuator's output, with a cold winding."""
    voltage, R, k_t = part["nominal_voltage"], part["resistance"], _torque_constant(part)
    if part.section == "actuators":
        inside, own = part["motor_torque_constant"], part["motor_back_emf_constant"]
        k_e = (inside if isnan(own) else own) * part["ratio"]
    else:
        k_e = float(back_emf_constant(part))
    speed, torque = part["no_load_speed"], part["stall_torque"]
    computed = isnan(speed) or isnan(torque)
    if isnan(speed) and k_e > 0.0:
        speed = (voltage - R * part["no_load_current"]) / k_e
    if isnan(torque) and R > 0.0:
        torque = k_t * k_e / R * speed
    known = speed > 0.0 and torque > 0.0
    return Line(speed, torque, computed) if known else Line(nan, nan, computed)


def _torque_constant(part: PartFigures) -> float:
    """Of a motor, or of an actuator at its output, losses of the gear included [N*m/A]."""
    k_t = float(part["torque_constant"])
    if part.section == "actuators" and isnan(k_t):
        return float(part["motor_torque_constant"] * part["ratio"] * part["efficiency"])
    return k_t


def nominal_voltage_curves(part: PartFigures, torque: Array) -> tuple[Array, ...]:
    r"""Speed, current and efficiency on the straight line at nominal voltage.

    .. math:: w = w_0 \left(1 - \frac{M}{M_H}\right), \qquad I = I_0 + \frac{M}{k_t}, \qquad \eta = \frac{M w}{V I}

    Above the permitted speed, where the voltage must be lower, all three are unknown. Of a motor with its controller
    inside, which limits the no-load speed, current and efficiency are unknown.
    """
    ends = line(part)
    speed = ends.speed * (1.0 - torque / ends.torque)
    speed = np.where(speed > part["max_speed"], np.nan, speed)
    own = part["no_load_current"] if part.section == "actuators" or part["commutation"] != ELECTRONICS else np.nan
    current = own + torque / _torque_constant(part) + 0.0 * speed
    return speed, current, torque * speed / (part["nominal_voltage"] * current)


def gear_efficiency(part: PartFigures, torque: Array) -> Array:
    r"""Efficiency of a gearhead over the torque at its output, its losses without load apart (``gear_loss``).

    .. math:: \frac{1}{\eta} = \frac{1}{e'} + \frac{i\,T_0}{T}
    """
    efficiency, _ = gear_loss(part)
    return np.asarray(1.0 / (1.0 / efficiency + part["ratio"] * part["no_load_torque"] / torque))


def continuous_curve(part: PartFigures) -> tuple[list[float], list[float]]:
    """Continuous torque [N*m] and speed [rad/s] through the maker's three points; nothing where one is unknown.

    Iron losses at speed reduce the permitted copper losses: the square of the torque falls with a power of the speed.
    """
    if part.section != "motors":
        return [], []
    top, torques = part["max_speed"], [part[f"{at}_torque"] for at in ("standstill", "half_speed", "top_speed")]
    if isnan(top + sum(torques)):
        return [], []
    rest, half, end = (torque**2 for torque in torques)
    if not rest > half > end:  # no power law goes through them
        return torques, [0.0, top / 2.0, top]
    share = np.linspace(0.0, 1.0, 41)
    squares = rest - (rest - end) * share ** np.log2((rest - end) / (rest - half))
    return np.sqrt(squares).tolist(), (share * top).tolist()


def permitted_current(part: PartFigures, ambient: float) -> float:
    """Continuous current in an ambient [K]: the nominal one, derated; else by heat alone, at standstill [A].

    NaN above the permitted ambient, and where a figure is unknown.
    """
    limit = part["max_winding_temperature"]
    if ambient > part["ambient_max"]:
        return nan
    if not isnan(part["nominal_current"]):
        return float(part["nominal_current"] * current_derating(ambient, limit, rated_ambient(part)))
    R_th1, R_th2 = (part[name] for name in HEAT[2:])
    return float(continuous_current(resistance_25(part), R_th1, R_th2, limit, ambient))


def warm_housing(motor: Figures, ambient: float) -> float:
    """Temperature of the housing of one motor in the long run at its nominal point [K]; NaN unknown."""
    rubbing, iron = housing_loss(motor, np.ones(1))
    loss = float(rubbing[0] * motor["nominal_speed"] + iron[0] * motor["nominal_speed"] ** 2)
    return float(steady_state(two_bodies(motor), ambient, motor["nominal_current"], loss).housing)


def overload_times(part: PartFigures, current: float) -> tuple[float, float]:
    """Time for which the winding withstands a current at standstill in 25 degC [s], from cold and from warm.

    Warm is winding and housing as warm as the housing gets at the nominal point in the long run: a motor that has just
    been running. An actuator's loss of friction and iron is not known, so that its warmth is not.
    """
    bodies, limit = two_bodies(part), part["max_winding_temperature"]
    housing = warm_housing(part, DATA_TEMPERATURE) if part.section == "motors" else nan
    from_cold, from_warm = (
        overload_time(bodies, DATA_TEMPERATURE, State(T, T), limit, current) for T in (DATA_TEMPERATURE, housing)
    )
    return from_cold, from_warm
