"""The torque-speed field of a drive's motor with the load cycle in it, and its efficiency over torque and speed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.parts import OneRow, one_row
from drivesizer.load_cases import load_cycle
from drivesizer.machine.part_curves import torque_of_part
from drivesizer.machine.set_cycle import SetCycle, turned
from drivesizer.physics.cycle_at_gearhead import BRAKING, DIRECTION, DRIVING, SPEED, AtGearhead, CycleAtBelt
from drivesizer.physics.drive_train import friction
from drivesizer.physics.figures import Figures
from drivesizer.physics.load_cycle import Ends
from drivesizer.physics.motor_demand import Demands, demands
from drivesizer.physics.thermal import continuous_current, current_derating, rated_ambient, resistance_25, resistance_at
from drivesizer.physics.winding import heat, housing_loss, volts_of
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.mounting import loss_at_flange, rise_left
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

__all__ = ["OperatingField", "Operation", "field", "hot_winding", "operation", "with_pull_out"]


# -- Efficiency of motor and gearhead over torque and speed at the gearhead's output.
#
# The drive model of ``physics`` at points that no cycle need come by: motor torque and voltage are the same sums of
# its six functions, at constant speed. Power to the load counts the gearhead's loss on the motor's side, power from
# it on the load's.
#
# .. math:: \eta = \frac{T w}{V I} \; (T w > 0), \qquad \eta = \frac{V I}{T w} \; (T w < 0),
#
# the second where the supply gets something back, and 0 where it does not. For a brushed motor without gearhead the
# best that a voltage allows is :math:`(1 - \sqrt{I_0 / I_s})^2` with the stall current I_s [1].
#
# References
# ----------
# .. [1] maxon academy, *Formulae Handbook*, 2nd ed., 2012, section "Motor data": efficiency.


Array = NDArray[np.float64]


class Operation(NamedTuple):
    """Operating points of a drive over torque and speed: arrays of their shape."""

    current: Array  # A
    voltage: Array  # V
    efficiency: Array  # of the direction in which power flows [1]; NaN at rest and without torque


def operation(found: SetCycle, torque: Array, speed: Array) -> Operation:
    """A drive at constant speeds."""
    c, k_t, ambient = found.demands.coefficients[0], found.motor["torque_constant"], found.spec.environment.ambient
    own = c[DIRECTION] * np.sign(speed) + c[SPEED] * speed
    current = (c[DRIVING] * np.maximum(torque, 0.0) + c[BRAKING] * np.minimum(torque, 0.0) + own) / k_t
    hot = resistance_at(resistance_25(found.motor), found.winding if np.isfinite(found.winding) else ambient)
    voltage = hot * current + found.demands.back_emf * found.demands.total_ratio * speed
    surplus = found.demands.surplus(k_t) * speed * current  # what the two constants differ by is lost both ways
    electrical, mechanical = current * voltage + np.maximum(-2.0 * surplus, 0.0), torque * speed
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(mechanical > 0.0, mechanical / electrical, np.maximum(electrical / mechanical, 0.0))
    return Operation(current, voltage, np.where(mechanical == 0.0, np.nan, share))


# -- The torque-speed field of a drive's motor, winding cold and hot, and the load cycle in it: data for figures.
#
# Torque is that at the motor's shaft, its own friction taken off, the rotor's acceleration included:
#
# .. math:: M_V(w) = \frac{k_t (V - k_e w)}{R(T)} - M_f(w), \qquad M_c(w) = k_t I_c(w) - M_f(w),
#
# with the usable voltage V, the continuous current I_c at the motor's own loss at that speed, and the friction M_f
# of the drive model in ``physics``, whose coefficients all of this is made of. Symbols: w speed of the motor
# [rad/s], M torque [N*m], R resistance [ohm], k_t torque constant [N*m/A], k_e back-EMF constant [V*s/rad], i ratio.


_POINTS = 201  # of each line


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingField:
    """Torque limits of a motor over speed, and the load cycle in them; NaN is unknown."""

    voltage: float  # V, usable at the motor when the supply is at its lowest
    ambient: float  # K, also the temperature of the cold winding
    hot: float  # K, permitted winding temperature; where that is unknown, its steady mean in this cycle
    hot_permitted: bool  # whether it is the permitted one
    permissible_speed: float  # rad/s, the least that motor and gearhead permit
    speed: Array  # rad/s, from 0 to the highest of no load and cycle
    voltage_cold: Array  # N*m that the usable voltage gives at these speeds, below 0 beyond the no-load speed
    voltage_hot: Array  # N*m, the same with a hot winding
    continuous: Array  # N*m, continuous torque of the winding
    thermal: bool  # whether that is from thermal data; else the nominal torque, derated to the ambient
    intermittent: Array  # N*m, by the controller's peak current and the gearhead's intermittent torque
    cycle_speed: Ends  # rad/s, at both ends of each segment of the load cycle; straight lines between
    cycle_torque: Ends  # N*m, signed as the speed is
    rms_speed: float  # rad/s
    rms_torque: float  # N*m, constant torque that draws the cycle's RMS current at its RMS speed
    pull_out: Array | None = None  # N*m over the speed, of a stepper
    factor: float = nan  # by which that must exceed the cycle


def hot_winding(found: OperatingField) -> str:
    """Temperature of the hot winding, in words; one that is not the permitted one is named as what it is."""
    temperature = show(found.hot, "degC", "temperature", 3)
    return temperature if found.hot_permitted or np.isnan(found.hot) else f"{temperature}, the cycle's mean"


def field(spec: RobotSpec, drive_set: DriveSet) -> OperatingField:
    """The field of a drive's motor, and the cycle of a spec in it."""
    motor, gearhead, encoder = (one_row(p) for p in (drive_set.motor, drive_set.gearhead, drive_set.encoder))
    cycle = CycleAtBelt(load_cycle(spec), drive_set.belt_efficiency).behind(drive_set.belt_ratio)
    if drive_set.steps:
        demand = turned(spec, drive_set)[1]
    else:
        demand = _known_demand(demands(cycle, motor, gearhead, encoder, drive_set.brake_inertia), motor)
    cycle_speed, cycle_torque = _cycle(cycle, demand)
    rms_speed, rms_torque = _rms(cycle, demand, drive_set)
    return OperatingField(
        **_lines(spec, drive_set, demand, _hot(spec, cycle, demand, motor, gearhead), float(np.abs(cycle_speed).max())),
        hot_permitted=not np.isnan(drive_set.motor.max_winding_temperature),
        permissible_speed=float(np.fmin(drive_set.motor.max_speed, drive_set.gearhead.intermittent_input_speed)),
        cycle_speed=cycle_speed,
        cycle_torque=cycle_torque,
        rms_speed=rms_speed,
        rms_torque=rms_torque,
    )


def with_pull_out(found: OperatingField, spec: RobotSpec, catalog: Catalog, part: str) -> OperatingField:
    """The field of a stepper with its pull-out torque, up to half more than the highest speed of the cycle."""
    speed = 1.5 * found.speed
    torque = torque_of_part(catalog, part, speed, spec.supply.lowest)
    return replace(found, speed=speed, pull_out=torque, factor=spec.margins.pull_out)


def _known_demand(demand: Demands, motor: Figures) -> Demands:
    """The motor's demand; where it is incomplete, or friction is unknown, NaN."""
    c = np.where(demand.left_out, np.nan, demand.coefficients)
    for place, figure in zip((DIRECTION, SPEED), friction(motor), strict=True):
        c[np.isnan(figure), place] = np.nan
    if demand.complete.all():
        return demand._replace(coefficients=c)
    unknown = np.full_like(demand.rms_current, np.nan)
    return demand._replace(coefficients=c, rms_torque=unknown, rms_current=unknown)


def _lines(spec: RobotSpec, drive_set: DriveSet, demand: Demands, hot: float, fastest: float) -> dict[str, Any]:
    """Torque of the motor at speeds from 0 to no load, or to the fastest of the cycle [rad/s]."""
    voltage, ambient = _voltage(spec, drive_set), spec.environment.ambient
    (cold_at_rest, cold_slope), (at_rest, slope) = (_line(spec, demand, drive_set, voltage, T) for T in (ambient, hot))
    no_load = -cold_at_rest / cold_slope if cold_slope < 0.0 else 0.0
    w = np.linspace(0.0, np.fmax(no_load, fastest), _POINTS)  # as far as the cycle goes where friction is unknown
    continuous, thermal = _continuous(spec, demand, one_row(drive_set.motor), w)
    return {
        "voltage": voltage,
        "ambient": ambient,
        "hot": hot,
        "speed": w,
        "voltage_cold": cold_at_rest + cold_slope * w,
        "voltage_hot": at_rest + slope * w,
        "continuous": continuous,
        "thermal": thermal,
        "intermittent": _intermittent(demand, drive_set, w),
    }


def _friction(demand: Demands, w: Any) -> Any:
    """Friction torque of the motor itself at a speed [N*m], turning."""
    return demand.coefficients[0, DIRECTION] + demand.coefficients[0, SPEED] / demand.total_ratio[0] * w


def _hot(spec: RobotSpec, cycle: AtGearhead, demand: Demands, motor: OneRow, gearhead: OneRow) -> float:
    """Temperature of the hot winding [K]: the permitted one, for a line that is valid in any permitted cycle.

    Where that is unknown it is the mean of this cycle in the long run, and the line is this cycle's alone.
    """
    permitted = float(motor["max_winding_temperature"][0])
    at_flange = loss_at_flange(spec, cycle, gearhead)
    steady = float(heat(spec.environment.ambient, cycle, demand, motor, from_gearhead=at_flange).winding[0])
    return steady if np.isnan(permitted) and np.isfinite(steady) else permitted


def _voltage(spec: RobotSpec, drive_set: DriveSet) -> float:
    """Usable voltage [V]; all that the supply has where the controller's share is unknown."""
    lowest, usable = spec.supply.lowest, float(spec.feed_of(drive_set.controller).usable)
    return lowest if np.isnan(usable) else usable


def _line(
    spec: RobotSpec, demand: Demands, drive_set: DriveSet, voltage: float, temperature: float
) -> tuple[float, float]:
    """Torque at standstill [N*m] and its change with speed [N*m s/rad] at a voltage behind stage and supply."""
    k_t = drive_set.motor.torque_constant
    leads = spec.feed_of(drive_set.controller).leads
    resistance = float(resistance_at(resistance_25(drive_set.motor), temperature) + leads)
    volts = volts_of(demand, np.array([k_t]), np.array([resistance]))[0]
    per_volt = k_t / resistance
    return float((voltage - volts[DIRECTION]) * per_volt), float(-volts[SPEED] / demand.total_ratio[0] * per_volt)


def _continuous(spec: RobotSpec, demand: Demands, motor: OneRow, w: Array) -> tuple[Array, bool]:
    """Continuous torque over speed [N*m], and whether it is from thermal data."""
    rubbing, iron = housing_loss(motor, np.ones(1))
    R_th = motor["thermal_resistance_winding"], motor["thermal_resistance_housing"]
    permitted, ambient = motor["max_winding_temperature"], spec.environment.ambient
    left = rise_left(spec.environment)
    if left < 1.0:
        permitted = ambient + left * (permitted - ambient)
    current = continuous_current(resistance_25(motor), *R_th, permitted, ambient, rubbing * w + iron * w**2)
    torque = np.asarray(np.maximum(motor["torque_constant"] * current - _friction(demand, w), 0.0))
    if not np.isnan(torque).any():
        return torque, True
    share = current_derating(ambient, motor["max_winding_temperature"], rated_ambient(motor)) * np.sqrt(left)
    return np.broadcast_to(motor["nominal_torque"] * share, w.shape).copy(), False


def _intermittent(demand: Demands, drive_set: DriveSet, w: Array) -> Array:
    """The lesser of what controller and gearhead permit for a while [N*m]; one of them where the other is unknown."""
    controller = drive_set.controller
    peak = controller.peak_current if controller else nan
    by_controller = drive_set.motor.torque_constant * peak - _friction(demand, w)
    found: Array = np.fmin(by_controller, drive_set.gearhead.intermittent_torque * demand.coefficients[0, DRIVING])
    return found


def _cycle(cycle: AtGearhead, demand: Demands) -> tuple[Ends, Ends]:
    """Speed [rad/s] and torque [N*m] at the motor's shaft at both ends of each segment."""
    at_shaft = demand.coefficients[0].copy()
    at_shaft[[DIRECTION, SPEED]] = 0.0
    return cycle.functions[:, :, SPEED] * demand.total_ratio[0], cycle.functions @ at_shaft


def _rms(cycle: AtGearhead, demand: Demands, drive_set: DriveSet) -> tuple[float, float]:
    """RMS speed [rad/s], and the torque there that draws the RMS current [N*m]."""
    w = float(np.sqrt(cycle.moment(SPEED, SPEED)) * demand.total_ratio[0])
    torque = drive_set.motor.torque_constant * demand.rms_current[0] - _friction(demand, w)
    return w, float(np.maximum(torque, 0.0))
