"""One set over one load cycle: what the drive model says of each moment, for figures and the energy's account.

The same functions that judge candidates by columns, called with columns of one. The winding is at its steady mean
temperature, as it is where checks and energy are computed.
Symbols: I current [A], V voltage [V], w speed [rad/s], P_h loss at the housing [W].
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.loadcycle import mean_product
from drivesizer.loads import load_cycle
from drivesizer.one_row import OneRow
from drivesizer.physics import SPEED, AtGearhead, Demands, at_gearhead, demands
from drivesizer.physics_limits import Heat, Stress, heat, stress, volts_of
from drivesizer.results import DriveSet
from drivesizer.spec import RobotSpec
from drivesizer.waveform import Wave, balanced, lost, mean_square, wave

__all__ = ["SetCycle", "Warming", "lost_in_winding", "set_cycle", "supplied", "warming", "waveform"]

Array = NDArray[np.float64]


class SetCycle(NamedTuple):
    """A set's parts as columns of one, and what its load cycle asks of them."""

    spec: RobotSpec
    motor: OneRow
    gearhead: OneRow
    at: AtGearhead
    asked: Demands
    warm: Heat
    under: Stress

    @property
    def known(self) -> bool:
        """Whether the motor's current is known, and not only a least one."""
        return bool(self.asked.sure.all() and np.isfinite(self.asked.rms_current).all())

    @property
    def volts(self) -> Array:
        """Coefficients of the voltage from the six functions, winding hot."""
        return volts_of(self.asked, self.motor["torque_constant"], self.under.hot)


class Warming(NamedTuple):
    """What warms a motor: pieces of the cycle in order."""

    duration: Array  # s
    square: Array  # A^2, mean square current
    loss: Array  # W, at the housing


def set_cycle(spec: RobotSpec, drive_set: DriveSet) -> SetCycle:
    """What the cycle of a spec asks of a set.

    Parameters
    ----------
    spec
        The machine, or one of its load cases.
    drive_set
        What drives it.

    Raises
    ------
    InputError
        When the load cycle's figures leave the range of numbers that can be computed with, or a recording is wrong.
    """
    motor, gearhead, encoder = (OneRow(part) for part in (drive_set.motor, drive_set.gearhead, drive_set.encoder))
    quickest = drive_set.motor.winding_time_constant
    base = at_gearhead(load_cycle(spec), drive_set.belt_efficiency, quickest if quickest > 0.0 else np.inf)
    at = base.behind(drive_set.belt_ratio)
    asked = demands(at, motor, gearhead, encoder)
    warm = heat(spec, at, asked, motor)
    return SetCycle(spec, motor, gearhead, at, asked, warm, stress(spec, at, asked, warm, motor))


def waveform(found: SetCycle) -> Wave:
    """Current and voltage over the segments of the cycle, of one candidate."""
    at = found.at
    return wave(at.cycle.duration, at.functions, found.asked.coefficients, found.volts, found.motor["torque_constant"])


def supplied(found: SetCycle) -> Wave:
    """Current, and the voltage that makes of it the power that the motor takes, over the cycle's pieces."""
    taken = balanced(waveform(found), *_surplus(found))
    return taken if taken.duration.ndim == 1 else taken._replace(duration=taken.duration[0])


def lost_in_winding(found: SetCycle) -> float:
    """What is lost over the cycle as the winding's two constants differ [J]."""
    return float(lost(waveform(found), *_surplus(found))[0])


def _surplus(found: SetCycle) -> tuple[Array, Array]:
    return found.asked.surplus(found.motor["torque_constant"]), found.at.functions[:, :, SPEED]


def warming(found: SetCycle) -> Warming:
    """Mean square current and loss at the housing over the pieces of which a winding feels the mean."""
    duration, functions = found.at.warming
    c, speed = found.asked.coefficients, functions[:, :, SPEED]
    square = mean_square(wave(duration, functions, c, c, found.motor["torque_constant"]))[0]
    loss = found.warm.friction[0] * np.abs(speed).mean(1) + found.warm.iron[0] * mean_product(speed, speed)
    return Warming(duration, square, loss)
