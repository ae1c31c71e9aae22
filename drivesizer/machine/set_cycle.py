"""One drive over one load cycle: current, voltage and heat over time, for figures and the energy balance.

The kernel that judges candidates, called with one. The winding is as warm as it is at each moment of the cycle in
periodic steady state, one of unknown time constants as in the long run; where that is unknown, so is the voltage.
Symbols: I current [A], V voltage [V], w speed [rad/s], P_h loss at the housing [W].
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import OneRow, one_row
from drivesizer.kernel.drives import drives_of
from drivesizer.kernel.evaluate import pieces
from drivesizer.kernel.records import Drive, Figures, Piece
from drivesizer.kernel.supply import mean_square
from drivesizer.load_cases import load_cycle
from drivesizer.physics.cycle_at_gearhead import AtGearhead, at_gearhead
from drivesizer.physics.motor_demand import Demands, demands
from drivesizer.physics.power_stage import Feed
from drivesizer.physics.stress import Heat, Stress, heat, stress, volts_of
from drivesizer.physics.thermal import resistance_25, resistance_at
from drivesizer.physics.waveform import Wave
from drivesizer.results.drive_set import DriveParts
from drivesizer.spec.mounting import loss_at_flange
from drivesizer.spec.robot import RobotSpec

__all__ = ["SetCycle", "Warming", "driven", "set_cycle", "turned", "warming", "waveform"]

Array = NDArray[np.float64]


class SetCycle(NamedTuple):
    """A drive's parts as columns of one row, and their demands, heat and stress over a load cycle."""

    spec: RobotSpec
    feed: Feed  # its power stage and supply
    motor: OneRow
    gearhead: OneRow
    cycle: AtGearhead
    demands: Demands
    heat: Heat
    drive: Drive  # as the kernel takes it
    figures: Figures  # columns of one
    pieces: Piece  # the cycle in pieces of which a winding follows the mean
    released: float = 0.0  # W, that keeps its brake released

    @property
    def known(self) -> bool:
        """Whether the motor's current is known, and not only a least one."""
        return bool(self.demands.complete.all() and np.isfinite(self.demands.rms_current).all())

    @property
    def stress(self) -> Stress:
        """Largest torque and current, and largest voltage while the winding is cold."""
        return stress(self.spec.environment.ambient, self.cycle, self.demands, self.motor, self.feed.leads)

    @property
    def winding(self) -> Array:
        """Mean temperature of the winding [K]; NaN unknown."""
        return np.asarray(self.spec.environment.ambient + self.figures.winding_mean)

    @property
    def hot(self) -> Array:
        """Resistance of the winding at its mean temperature [ohm]; cold, where that is unknown."""
        T = np.where(np.isfinite(self.winding), self.winding, self.spec.environment.ambient)
        return np.asarray(resistance_at(resistance_25(self.motor), T))

    @property
    def volts(self) -> Array:
        """Coefficients of the voltage from the six functions, winding hot."""
        return volts_of(self.demands, self.motor["torque_constant"], self.hot)


class Warming(NamedTuple):
    """Heat sources of a motor: pieces of the cycle in order."""

    duration: Array  # s
    square: Array  # A^2, mean square current
    loss: Array  # W, at the housing


def set_cycle(spec: RobotSpec, drive_set: DriveParts, base: Any = None) -> SetCycle:
    """A drive over the load cycle of a spec."""
    drive, cycle, demand, heating = driven(spec, drive_set, base)
    return SetCycle(
        spec,
        spec.feed_of(drive_set.controller, drive_set.brake),
        one_row(drive_set.motor),
        one_row(drive_set.gearhead),
        cycle,
        demand,
        heating,
        drive,
        *pieces(drive, cycle.load_cycle),
        drive_set.released_power * spec.brake_released,
    )


def driven(spec: RobotSpec, drive_set: DriveParts, base: Any = None) -> tuple[Drive, AtGearhead, Demands, Heat]:
    """A drive as the kernel takes it, torque and speed over the load cycle of a spec, and its losses."""
    motor, gearhead = one_row(drive_set.motor), one_row(drive_set.gearhead)
    cycle, demand = turned(spec, drive_set, base)
    at_flange = loss_at_flange(spec, cycle, gearhead)
    ambient, feed = spec.environment.ambient, spec.feed_of(drive_set.controller, drive_set.brake)
    heating = heat(ambient, cycle, demand, motor, from_gearhead=at_flange)
    rise = np.where(np.isfinite(heating.winding), heating.winding, np.nan) - ambient
    drive = drives_of(ambient, cycle, demand, heating, motor, feed)._replace(held=rise, held_mean=rise)
    return drive, cycle, demand, heating


def turned(spec: RobotSpec, drive_set: DriveParts, base: Any = None) -> tuple[AtGearhead, Demands]:
    """Torque and speed of a drive over the load cycle of a spec; a stepper's own friction is in its pull-out torque."""
    turning = drive_set.motor
    if drive_set.steps:
        turning = replace(turning, friction_torque=0.0, viscous_friction=0.0)
    if base is None:  # cut as the search cut it
        base = at_gearhead(load_cycle(spec), drive_set.belt_efficiency, drive_set.quickest)
    cycle = base.behind(drive_set.belt_ratio)
    motor, gearhead, encoder = (one_row(part) for part in (turning, drive_set.gearhead, drive_set.encoder))
    return cycle, demands(cycle, motor, gearhead, encoder, drive_set.brake_inertia)


def waveform(found: SetCycle) -> Wave:
    """Current and voltage over the pieces of the cycle, of one candidate."""
    d, p = found.drive, found.pieces
    current, speed, rises = (np.stack(x, axis=-1) for x in ((p.I_0, p.I_1), (p.w_0, p.w_1), (p.rise_0, p.rise_1)))
    return Wave(p.duration, current[None], (d.emf * speed + (d.R + d.R_rise * rises) * current)[None])


def warming(found: SetCycle) -> Warming:
    """Mean square current and loss at the housing over the pieces of which a winding feels the mean."""
    d, p = found.drive, found.pieces
    loss = d.friction * (np.abs(p.w_0) + np.abs(p.w_1)) / 2.0 + d.iron * mean_square(p.w_0, p.w_1)
    square: Array = np.asarray(mean_square(p.I_0, p.I_1))
    return Warming(p.duration, square, loss)
