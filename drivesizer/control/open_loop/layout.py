"""Layout of the arrays of a stepper's simulation; SI, angles and speeds at the motor's shaft.

``p`` are figures of the drive, ``table`` its pull-out torque at even steps of the speed from 0, ``pieces`` the motion:
rows of duration, speed, its slope, load torque at the driven shaft beyond inertia and direction, its slope. ``g`` are
tallies, ``rows`` the time series.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["PARAMETERS", "ROW", "TALLY", "Array"]

Array = NDArray[np.float64]


def _places(names: list[str]) -> Iterable[int]:
    """Numbers of places; not Python integers, for which numba would compile a function once for every number."""
    found: Any = np.arange(len(names))
    places: Iterable[int] = found
    return places


# inertia of motor and load; ratio and efficiency of the gears; friction at the motor; load forward, backward, at rest;
# teeth; damping, and speed at which it has faded, per root of the torque; a microstep; speed from which pulses are a
# ramp; longest step; step of the speed in the table; share of the pull-out torque, of that at rest, and present share;
# whether anything rubs; lag at which it ends; interval of the rows
_PARAMETERS = """
    J_M J_L RATIO EFF FRICTION T_F T_B T_0 TEETH DAMP FADES MICRO RAMP H V_STEP SHARE IDLE NOW
    RUBS ENDS EVERY
"""
PARAMETERS = _PARAMETERS.split()
(
    J_M, J_L, RATIO, EFF, FRICTION, T_F, T_B, T_0, TEETH, DAMP, FADES, MICRO, RAMP, H, V_STEP, SHARE, IDLE, NOW,
    RUBS, ENDS, EVERY,
) = _places(PARAMETERS)  # fmt: skip

# largest magnitudes with their times: lag of the rotor behind the field (electrical), distance from the profile,
# torque of the driven shaft, speed of the motor; when the lag first passed half a turn; at the end lag, distance from
# the profile, time; steps taken; rows kept
_TALLY = """
    lag lag_time error error_time gear gear_time speed speed_time slipped end_lag end_error time steps rows
"""
TALLY = _TALLY.split()
(
    G_LAG, G_LAG_TIME, G_ERROR, G_ERROR_TIME, G_GEAR, G_GEAR_TIME, G_SPEED, G_SPEED_TIME, G_SLIPPED, G_END_LAG,
    G_END_ERROR, G_TIME, G_STEPS, G_ROWS,
) = _places(TALLY)  # fmt: skip

_ROW = "time reference motor_speed position_error load_angle motor_torque gear_torque"
ROW = _ROW.split()

HALVINGS = 24  # until a moment of rest is known
NONE = 1e-9  # of a microstep: no distance from a pulse
