"""Figures of drives that the kernel takes and gives: columns outside, one drive's floats inside."""

from __future__ import annotations

from math import nan
from typing import NamedTuple

from drivesizer.physics.figures import Alike


class Drive(NamedTuple):
    """A drive as the kernel takes it; speed, acceleration and torque are the load's."""

    # current of the motor
    driving: Alike  # A/(N*m), by a torque that drives
    braking: Alike  # A/(N*m), by one that brakes
    resting: Alike  # A/(N*m), by one at rest
    accelerating: Alike  # A*s^2/rad
    direction: Alike  # A, dry friction
    turning: Alike  # A*s/rad
    # winding
    emf: Alike  # V*s/rad, induced
    surplus: Alike  # V*s/rad, of it what the back-EMF constant is above the torque constant
    R: Alike  # ohm, at ambient temperature
    R_rise: Alike  # ohm/K
    # heat
    R_th1: Alike  # K/W, winding to housing
    R_th2: Alike  # K/W, housing to ambient
    C_w: Alike  # J/K
    C_h: Alike  # J/K
    friction: Alike  # W*s/rad, loss at the housing
    iron: Alike  # W*s^2/rad^2
    permitted: Alike  # K, rise at which a winding that runs away is held
    course: Alike  # 1: the winding's course is computed; 0: it is held at a rise
    rise: Alike  # K, that rise
    mean_rise: Alike  # K, of it for the mean loss
    finest: Alike  # s: a segment in which anything changes is cut into sqrt(duration / finest) pieces
    # supply
    leads: Alike  # ohm, that take of the voltage before the winding
    loss: Alike  # V, of the power stage per ampere
    least_loss: Alike  # V, of it for what is stored
    R_stage: Alike  # ohm
    standby: Alike  # W
    V_0: Alike  # V, of the source without load
    R_source: Alike  # ohm, with cables
    drives: Alike  # 1, alike at this source
    bus_share: Alike  # 1, share of what is returned that stays on the bus
    limit: Alike  # A, of which the time above counts
    commutation: Alike  # V*s/(A*rad), that commutation takes of a motor that drives, at most
    least_commutation: Alike  # V*s/(A*rad), at least
    winding_start: Alike = nan  # K, rises with which a cycle begins; NaN: those with which it ends, too
    housing_start: Alike = nan


class Figures(NamedTuple):
    """Figures of a drive over a cycle, without standby power."""

    I_rms: Alike  # A
    I_peak: Alike  # A
    I_peak_time: Alike  # s
    winding: Alike  # K, highest rise; infinite: it runs away; NaN: it is held
    winding_time: Alike  # s
    winding_mean: Alike  # K, over time
    winding_least: Alike  # K, at ends of pieces
    winding_start: Alike  # K, where the cycle begins
    housing_start: Alike  # K
    winding_end: Alike  # K, where it ends
    housing_end: Alike  # K
    voltage: Alike  # V, largest, the winding as warm as it then is, with the most that commutation takes
    voltage_time: Alike  # s
    least_voltage: Alike  # V, with the least
    least_voltage_time: Alike  # s
    copper: Alike  # W, mean heat of the winding
    above: Alike  # s, longest without a break above the limit
    above_in_all: Alike  # s, all such time
    power: Alike  # W, largest into the stage
    power_time: Alike  # s
    drawn: Alike  # J, at the stage
    returned: Alike  # J
    source_heat: Alike  # J
    stored: Alike  # J, the most that is back and not drawn again; infinite: more with every cycle
    motor: Alike  # J, net into the motor
    unlike: Alike  # J, of it what its two constants differ by
    pieces: Alike  # 1, of its course over time


class Piece(NamedTuple):
    """A part of a cycle in which the winding follows the mean."""

    duration: Alike  # s
    I_0: Alike  # A, at both ends
    I_1: Alike
    w_0: Alike  # rad/s, of the load
    w_1: Alike
    rise_0: Alike  # K, of the winding as voltages take it
    rise_1: Alike
    rise_mean: Alike  # K
    winding: Alike  # K, rises at its start
    housing: Alike  # K
    drawn: Alike  # J, at the stage without standby power
    returned: Alike  # J
    source_heat: Alike  # J
    motor_drawn: Alike  # J
    motor_returned: Alike  # J
    most: Alike  # W, largest power into the stage
    least: Alike  # W, smallest: below 0 what is returned
