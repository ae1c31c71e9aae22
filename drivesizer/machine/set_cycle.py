"""One drive over one load cycle: current, voltage and heat over time, for figures and the energy balance.

The same functions that judge candidates by columns, called with columns of one. The winding is as warm as it is at each
moment of the cycle in periodic steady state; where that is unknown, so is the voltage.
Symbols: I current [A], V voltage [V], w speed [rad/s], P_h loss at the housing [W].
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import OneRow, one_row
from drivesizer.load_cases import load_cycle
from drivesizer.physics.cycle_at_gearhead import AtGearhead, at_gearhead
from drivesizer.physics.motor_demand import Demands, demands
from drivesizer.physics.power_stage import Feed
from drivesizer.physics.stress import Heat, Stress, heat, stress, volts_of
from drivesizer.physics.thermal import resistance_25, resistance_at
from drivesizer.physics.waveform import Wave, balanced, lost, mean_square
from drivesizer.physics.winding_course import WindingCourse, current_and_winding
from drivesizer.results.drive_set import DriveParts
from drivesizer.spec.mounting import loss_at_flange
from drivesizer.spec.robot import RobotSpec

__all__ = [
    "SetCycle", "Warming", "heated", "lost_in_winding", "set_cycle", "supplied", "supplied_in_parts", "turned",
    "warming", "waveform",
]  # fmt: skip

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
    flows: Wave  # current, and the voltage that the motion induces, over the pieces that a winding feels
    course: WindingCourse  # how warm the winding is over these
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
    def hot(self) -> Array:
        """Resistance of the winding at its mean temperature [ohm]; cold, where that is unknown."""
        T = np.where(np.isfinite(self.course.mean), self.course.mean, self.spec.environment.ambient)
        return np.asarray(resistance_at(resistance_25(self.motor), T))

    @property
    def volts(self) -> Array:
        """Coefficients of the voltage from the six functions, winding hot."""
        return volts_of(self.demands, self.motor["torque_constant"], self.hot)

    @property
    def copper(self) -> float:
        """Mean heat of the winding [W], its resistance that of each moment; NaN unknown."""
        resistance = np.asarray(resistance_at(resistance_25(self.motor), self.course.means[0]))
        return float((resistance * mean_square(self.flows)[0]) @ self.flows.duration / self.flows.duration.sum())


class Warming(NamedTuple):
    """Heat sources of a motor: pieces of the cycle in order."""

    duration: Array  # s
    square: Array  # A^2, mean square current
    loss: Array  # W, at the housing


def set_cycle(spec: RobotSpec, drive_set: DriveParts, base: Any = None) -> SetCycle:
    """A drive over the load cycle of a spec.

    Parameters
    ----------
    spec
        The machine, or one of its load cases.
    drive_set
        What drives it.
    base
        Its load cycle before a belt's ratio, of ``at_gearhead``, where it is at hand.

    Returns
    -------
    SetCycle
        Its demands, heat and stress, each of one row.

    Raises
    ------
    InputError
        When the load cycle's figures leave the range of numbers that can be computed with, or a recording is wrong.
    """
    cycle, demand, heating = heated(spec, drive_set, base)
    motor, gearhead = one_row(drive_set.motor), one_row(drive_set.gearhead)
    flows, course = current_and_winding(spec.environment.ambient, cycle, demand, heating, motor)
    feed = spec.feed_of(drive_set.controller, drive_set.brake)
    return SetCycle(
        spec,
        feed,
        motor,
        gearhead,
        cycle,
        demand,
        heating,
        flows,
        course,
        drive_set.released_power * spec.brake_released,
    )


def heated(spec: RobotSpec, drive_set: DriveParts, base: Any = None) -> tuple[AtGearhead, Demands, Heat]:
    """Torque and speed of a drive over the load cycle of a spec, and its losses.

    Parameters
    ----------
    spec, drive_set, base
        As ``set_cycle`` takes them.

    Returns
    -------
    tuple
        The load cycle at the gearhead's output, the demand and the heat, of one row.
    """
    motor, gearhead = one_row(drive_set.motor), one_row(drive_set.gearhead)
    cycle, demand = turned(spec, drive_set, base)
    at_flange = loss_at_flange(spec, cycle, gearhead)
    return cycle, demand, heat(spec.environment.ambient, cycle, demand, motor, from_gearhead=at_flange)


def turned(spec: RobotSpec, drive_set: DriveParts, base: Any = None) -> tuple[AtGearhead, Demands]:
    """Torque and speed of a drive over the load cycle of a spec; a stepper's own friction is in its pull-out torque.

    Parameters
    ----------
    spec, drive_set, base
        As ``set_cycle`` takes them.

    Returns
    -------
    tuple
        The load cycle at the gearhead's output, and the demand, of one row.
    """
    turning = drive_set.motor
    if drive_set.steps:
        turning = replace(turning, friction_torque=0.0, viscous_friction=0.0)
    if base is None:  # cut as the search cut it
        base = at_gearhead(load_cycle(spec), drive_set.belt_efficiency, drive_set.quickest)
    cycle = base.behind(drive_set.belt_ratio)
    motor, gearhead, encoder = (one_row(part) for part in (turning, drive_set.gearhead, drive_set.encoder))
    return cycle, demands(cycle, motor, gearhead, encoder, drive_set.brake_inertia)


def waveform(found: SetCycle, *, mean: bool = False) -> Wave:
    """Current and voltage over the pieces of the cycle, of one candidate.

    Parameters
    ----------
    found
        The drive over its cycle.
    mean
        Take the winding in each piece at its mean temperature, which makes its energy; else as it is at its ends.

    Returns
    -------
    Wave
        Voltage [V] and current [A] of one candidate, piece by piece.
    """
    T = found.course.means[:, :, None] if mean else found.course.ends
    resistance = resistance_at(resistance_25(found.motor), T)
    return found.flows._replace(voltage=found.flows.voltage + resistance * found.flows.current)


def supplied(found: SetCycle, *, mean: bool = True) -> Wave:
    """Current, and the voltage that gives with it the electrical power of the motor, over the cycle's pieces.

    Parameters
    ----------
    found
        The drive over its cycle.
    mean
        As ``waveform`` takes it.

    Returns
    -------
    Wave
        Its product of current and voltage is the power drawn [W].
    """
    return _of_one(balanced(waveform(found, mean=mean), *_surplus(found)))


def _of_one(taken: Wave) -> Wave:
    return taken if taken.duration.ndim == 1 else taken._replace(duration=taken.duration[0])


def supplied_in_parts(found: SetCycle, most: int) -> Iterator[tuple[Wave, Wave]]:
    """Results of ``supplied`` with mean temperatures and with those at the ends, some pieces of the cycle at a time.

    Parameters
    ----------
    found
        The drive over its cycle.
    most
        Pieces at a time.

    Yields
    ------
    tuple of Wave
        Of consecutive pieces.
    """
    differ, speed = _surplus(found)
    for k in (slice(first, first + most) for first in range(0, len(found.flows.duration), most)):
        flows = Wave(found.flows.duration[k], found.flows.current[:, k], found.flows.voltage[:, k])
        course = found.course._replace(ends=found.course.ends[:, k], means=found.course.means[:, k])
        part = found._replace(flows=flows, course=course)
        mean, as_warm = (_of_one(balanced(waveform(part, mean=x), differ, speed[k])) for x in (True, False))
        yield mean, as_warm


def lost_in_winding(found: SetCycle) -> float:
    """Energy lost over the cycle as the winding's two constants differ [J]."""
    return float(lost(waveform(found, mean=True), *_surplus(found))[0])


def _surplus(found: SetCycle) -> tuple[Array, Array]:
    differ, count = found.demands.surplus(found.motor["torque_constant"]), len(found.flows.duration)
    if not (np.abs(differ) > 0.0).any():  # no speed counts: that of a long cycle takes time and room
        return differ, np.broadcast_to(0.0, (count, 2))
    return differ, found.cycle.turning.speed


def warming(found: SetCycle) -> Warming:
    """Mean square current and loss at the housing over the pieces of which a winding feels the mean."""
    turning, square = found.cycle.turning, mean_square(found.flows)[0]
    loss = found.heat.friction[0] * turning.mean + found.heat.iron[0] * turning.square
    return Warming(found.flows.duration, square, loss)
