"""Figures of drives that the kernel takes and gives: columns outside, one drive's floats inside."""

from __future__ import annotations

from math import nan
from typing import Any, NamedTuple


class Drive(NamedTuple):
    """A drive as the kernel takes it; speed, acceleration and torque are the load's."""

    # current of the motor
    driving: Any  # A/(N*m), by a torque that drives
    braking: Any  # A/(N*m), by one that brakes
    resting: Any  # A/(N*m), by one at rest
    accelerating: Any  # A*s^2/rad
    direction: Any  # A, dry friction
    turning: Any  # A*s/rad
    # winding
    emf: Any  # V*s/rad, induced
    surplus: Any  # V*s/rad, of it what the back-EMF constant is above the torque constant
    R: Any  # ohm, at ambient temperature
    R_rise: Any  # ohm/K
    # heat
    R_th1: Any  # K/W, winding to housing
    R_th2: Any  # K/W, housing to ambient
    C_w: Any  # J/K
    C_h: Any  # J/K
    friction: Any  # W*s/rad, loss at the housing
    iron: Any  # W*s^2/rad^2
    permitted: Any  # K, rise at which a winding that runs away is held
    course: Any  # 1: the winding's course is computed; 0: it is held at a rise
    held: Any  # K, that rise
    held_mean: Any  # K, of it for the mean loss
    finest: Any  # s: a segment in which anything changes is cut into sqrt(duration / finest) pieces
    # supply
    leads: Any  # ohm, that take of the voltage before the winding
    loss: Any  # V, of the power stage per ampere
    least_loss: Any  # V, of it for what is stored
    R_stage: Any  # ohm
    standby: Any  # W
    V_0: Any  # V, of the source without load
    R_source: Any  # ohm, with cables
    drives: Any  # 1, alike at this source
    kept: Any  # 1, share of what is returned that stays on the bus
    limit: Any  # A, of which the time above counts
    commutation: Any  # V*s/(A*rad), that commutation takes of a motor that drives, at most
    least_commutation: Any  # V*s/(A*rad), at least
    winding_start: Any = nan  # K, rises with which a cycle begins; NaN: those with which it ends, too
    housing_start: Any = nan


class Figures(NamedTuple):
    """Figures of a drive over a cycle, without standby power."""

    I_rms: Any  # A
    I_peak: Any  # A
    I_peak_time: Any  # s
    winding: Any  # K, highest rise; infinite: it runs away; NaN: it is held
    winding_time: Any  # s
    winding_mean: Any  # K, over time
    winding_least: Any  # K, at ends of pieces
    winding_start: Any  # K, where the cycle begins
    housing_start: Any  # K
    winding_end: Any  # K, where it ends
    housing_end: Any  # K
    voltage: Any  # V, largest, the winding as warm as it then is, with the most that commutation takes
    voltage_time: Any  # s
    least_voltage: Any  # V, with the least
    least_voltage_time: Any  # s
    copper: Any  # W, mean heat of the winding
    above: Any  # s, longest without a break above the limit
    above_in_all: Any  # s, all such time
    power: Any  # W, largest into the stage
    power_time: Any  # s
    drawn: Any  # J, at the stage
    returned: Any  # J
    source_heat: Any  # J
    stored: Any  # J, the most that is back and not drawn again; infinite: more with every cycle
    motor: Any  # J, net into the motor
    unlike: Any  # J, of it what its two constants differ by
    pieces: Any  # 1, of its course over time


class Piece(NamedTuple):
    """A part of a cycle in which the winding follows the mean."""

    duration: Any  # s
    I_0: Any  # A, at both ends
    I_1: Any
    w_0: Any  # rad/s, of the load
    w_1: Any
    rise_0: Any  # K, of the winding as voltages take it
    rise_1: Any
    rise_mean: Any  # K
    winding: Any  # K, rises at its start
    housing: Any  # K
    drawn: Any  # J, at the stage without standby power
    returned: Any  # J
    source_heat: Any  # J
    motor_drawn: Any  # J
    motor_returned: Any  # J
    most: Any  # W, largest power into the stage
    least: Any  # W, smallest: below 0 what is returned
