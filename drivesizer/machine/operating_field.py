"""The torque-speed field of a drive's motor with the load cycle in it, and its efficiency over torque and speed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isfinite, isnan, nan
from typing import NamedTuple

import numpy as np

from drivesizer.catalog.parts import one_row
from drivesizer.load_cases import load_cycle
from drivesizer.machine.part_curves import torque_of_drive
from drivesizer.machine.set_cycle import SetCycle, turned
from drivesizer.physics.at_voltage import Winding, operating_point
from drivesizer.physics.cycle_at_gearhead import BRAKING, DIRECTION, DRIVING, SPEED, CycleAtBelt
from drivesizer.physics.drive_train import commutation, friction
from drivesizer.physics.figures import Alike, Array
from drivesizer.physics.load_cycle import Ends
from drivesizer.physics.thermal import continuous_current, current_derating, rated_ambient, resistance_25, resistance_at
from drivesizer.physics.winding import heat, housing_loss
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.mounting import loss_at_flange, rise_left
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

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


class Operation(NamedTuple):
    """Operating points of a drive over torque and speed: arrays of their shape."""

    current: Array  # A
    voltage: Array  # V
    efficiency: Array  # of the direction in which power flows [1]; NaN at rest and without torque


def operation(set_cycle: SetCycle, torque: Array, speed: Array) -> Operation:
    """A drive at constant speeds."""
    c, k_t, ambient = (
        set_cycle.demands.coefficients[0],
        set_cycle.motor["torque_constant"],
        set_cycle.spec.environment.ambient,
    )
    own = c[DIRECTION] * np.sign(speed) + c[SPEED] * speed
    current = (c[DRIVING] * np.maximum(torque, 0.0) + c[BRAKING] * np.minimum(torque, 0.0) + own) / k_t
    hot = resistance_at(
        resistance_25(set_cycle.motor), set_cycle.winding if np.isfinite(set_cycle.winding) else ambient
    )
    turning = set_cycle.demands.total_ratio * speed
    voltage = hot * current + set_cycle.demands.back_emf * turning
    surplus = set_cycle.demands.surplus(k_t) * speed * current  # what the two constants differ by is lost both ways
    electrical, mechanical = current * voltage + np.maximum(-2.0 * surplus, 0.0), torque * speed
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(mechanical > 0.0, mechanical / electrical, np.maximum(electrical / mechanical, 0.0))
    drop = commutation(set_cycle.motor) * np.abs(turning) * np.where(turning * current > 0.0, current, 0.0)
    return Operation(current, voltage + drop, np.where(mechanical == 0.0, np.nan, share))


# -- The torque-speed field of a drive's motor, winding cold and hot, and the load cycle in it: data for figures.
#
# Torque is that at the motor's shaft, its own friction taken off, the rotor's acceleration included:
#
# .. math:: M_V(w) = \frac{k_t (V - k_e w)}{R(T) + X w} - M_f(w), \qquad M_c(w) = k_t I_c(w) - M_f(w),
#
# with the usable voltage V, the continuous current I_c at the motor's own loss at that speed, and the friction M_f
# of the drive model in ``physics``, whose coefficients all of this is made of. Symbols: w speed of the motor
# [rad/s], M torque [N*m], R resistance [ohm], k_t torque constant [N*m/A], k_e back-EMF constant [V*s/rad], i ratio,
# X what commutation takes (``drive_train.commutation``) [V*s/(A*rad)].


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


def hot_winding(field: OperatingField) -> str:
    """Temperature of the hot winding, in words; one that is not the permitted one is named as what it is."""
    temperature = show(field.hot, "degC", "temperature", 3)
    return temperature if field.hot_permitted or np.isnan(field.hot) else f"{temperature}, the cycle's mean"


def field(spec: RobotSpec, drive_set: DriveSet) -> OperatingField:
    """The field of a drive's motor, and the cycle of a spec in it.

    That of a stepper has its pull-out torque, up to half more than the highest speed of the cycle.

    The hot winding is the permitted one, for a line that is valid in any permitted cycle; where that is unknown it is
    the mean of this cycle in the long run, and the line is this cycle's alone.
    """
    motor, gearhead = one_row(drive_set.motor), one_row(drive_set.gearhead)
    cycle, demand = turned(spec, drive_set, CycleAtBelt(load_cycle(spec), drive_set.belt_efficiency))
    ambient, feed, k_t = spec.environment.ambient, spec.feed_of(drive_set.controller), drive_set.motor.torque_constant
    if not drive_set.steps:  # where it is incomplete, or friction is unknown, NaN
        c = np.where(demand.left_out, nan, demand.coefficients)
        for place, figure in zip((DIRECTION, SPEED), friction(motor), strict=True):
            c[np.isnan(figure), place] = nan
        rms_current = np.where(demand.complete, demand.rms_current, nan)
        demand = demand._replace(coefficients=c, rms_current=rms_current)
    c, ratio = demand.coefficients[0], float(demand.total_ratio[0])

    def rubbed(w: Alike) -> Alike:
        """Friction torque of the motor itself at a speed, turning [N*m]."""
        return c[DIRECTION] + c[SPEED] / ratio * w

    hot, voltage = float(motor["max_winding_temperature"][0]), feed.applied
    hot_permitted = not isnan(hot)
    if not hot_permitted:
        at_flange = loss_at_flange(spec, cycle, gearhead)
        steady = float(heat(ambient, cycle, demand, motor, from_gearhead=at_flange).winding[0])
        hot = steady if isfinite(steady) else hot
    k_e, X = float(demand.back_emf[0]), float(commutation(motor)[0])
    cold, warm = (float(resistance_at(resistance_25(drive_set.motor), T) + feed.leads) for T in (ambient, hot))

    def by_voltage(R: float, w: Alike) -> Alike:
        """Torque at the shaft that the voltage gives behind stage and supply [N*m]."""
        return k_t * (voltage - k_e * w) / (R + X * w) - rubbed(w)

    at_shaft = c.copy()
    at_shaft[[DIRECTION, SPEED]] = 0.0
    cycle_speed, cycle_torque = cycle.functions[:, :, SPEED] * ratio, cycle.line(at_shaft)
    no_load, _ = operating_point(Winding(cold, nan, k_t, k_e, X), voltage, c[DIRECTION], c[SPEED] / ratio)
    fastest = float(np.abs(cycle_speed).max())
    farthest = np.fmax(max(float(no_load), 0.0), fastest)  # as far as the cycle goes where friction is unknown
    w = np.linspace(0.0, farthest, _POINTS)
    rubbing, iron = housing_loss(motor, np.ones(1))
    R_th = motor["thermal_resistance_winding"], motor["thermal_resistance_housing"]
    permitted, left = motor["max_winding_temperature"], rise_left(spec.environment)
    if left < 1.0:
        permitted = ambient + left * (permitted - ambient)
    current = continuous_current(resistance_25(motor), *R_th, permitted, ambient, rubbing * w + iron * w**2)
    continuous = np.asarray(np.maximum(motor["torque_constant"] * current - rubbed(w), 0.0))
    thermal = not np.isnan(continuous).any()
    if not thermal:
        share = current_derating(ambient, motor["max_winding_temperature"], rated_ambient(motor)) * np.sqrt(left)
        continuous = np.broadcast_to(motor["nominal_torque"] * share, w.shape).copy()
    peak = drive_set.controller.peak_current if drive_set.controller else nan
    rms_speed = float(np.sqrt(cycle.moment(SPEED, SPEED)) * ratio)
    record = OperatingField(
        voltage=voltage,
        ambient=ambient,
        hot=hot,
        hot_permitted=hot_permitted,
        permissible_speed=float(np.fmin(drive_set.motor.max_speed, drive_set.gearhead.intermittent_input_speed)),
        speed=w,
        voltage_cold=by_voltage(cold, w),
        voltage_hot=by_voltage(warm, w),
        continuous=continuous,
        thermal=thermal,
        intermittent=np.fmin(k_t * peak - rubbed(w), drive_set.gearhead.intermittent_torque * c[DRIVING]),
        cycle_speed=cycle_speed,
        cycle_torque=cycle_torque,
        rms_speed=rms_speed,
        rms_torque=float(np.maximum(k_t * demand.rms_current[0] - rubbed(rms_speed), 0.0)),
    )
    if not drive_set.steps:
        return record
    torque = torque_of_drive(drive_set, 1.5 * w, spec.supply.lowest)
    return replace(record, speed=1.5 * w, pull_out=torque, factor=spec.margins.pull_out)
