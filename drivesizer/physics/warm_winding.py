"""Current over a load cycle, and how warm the winding is meanwhile, on columns."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.heat_course import WindingCourse, winding_course
from drivesizer.physics.motor_demand import AtGearhead, Demands
from drivesizer.physics.several_belts import behind_each
from drivesizer.physics.stress import Heat, volts_of
from drivesizer.physics.thermal import two_bodies
from drivesizer.physics.waveform import Wave, mean_square, wave

__all__ = ["warming"]

Array = NDArray[np.float64]


def warming(ambient: float, at: AtGearhead, asked: Demands, warm: Heat, motor: Any) -> tuple[Wave, WindingCourse]:
    """Current and the voltage that the motion induces over the pieces of the cycle, and how warm the winding is.

    A winding that runs away is taken at its permitted temperature, where it fails; one of unknown time constants
    at its mean in the long run, as a cycle makes it that is short against them.
    """
    duration = at.base.warming.duration
    flowing, loss = behind_each(at, _flowing, asked, warm, motor["torque_constant"])
    flows = Wave(duration, *flowing)
    course = winding_course(two_bodies(motor), ambient, duration, mean_square(flows), loss, at.turning.steady)
    mean = np.where(np.isfinite(warm.winding), warm.winding, np.nan)
    for rows, T in ((np.isinf(course.peak), motor["max_winding_temperature"]), (np.isnan(course.peak), mean)):
        for x in (course.mean, course.ends, course.means):
            x[rows] = T[rows].reshape(-1, *[1] * (x.ndim - 1))
    return flows, course


def _flowing(at: AtGearhead, asked: Demands, warm: Heat, k_t: Array) -> tuple[tuple[Array, Array], Array]:
    """Current and voltage behind one belt, and what is lost at the housing [W]."""
    (duration, functions), turning = at.warming, at.turning
    flows = wave(duration, functions, asked.coefficients, volts_of(asked, k_t, np.zeros_like(k_t)), k_t)
    loss = np.outer(warm.friction, turning.mean) + np.outer(warm.iron, turning.square)
    return (flows.current, flows.voltage), loss
