"""Places of figures in the arrays of a load cycle that is looked through; all in SI."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__: list[str] = []  # constants, used as ``at.NAME``

Array = NDArray[np.float64]

DRIVING, BRAKING, AT_REST, ACCELERATION, DIRECTION, SPEED = range(6)  # the functions of ``cycle_at_gearhead``

# --- strides: step from segment to segment and from end to end, of speed, acceleration and torque
OF_SPEED, OF_ACCELERATION, OF_TORQUE = 0, 2, 4

# --- groups of segments: three directions of power, seven kinds of motion; sums and largest amounts of each
MOTIONS, GROUPS = 7, 21
LASTS, STARTS = 0, 1  # s, in all, and when it is first met
PRODUCTS = 2  # integrals of products of torque, acceleration, direction and speed: the upper triangle, row by row
BRAKED_A = 12  # acceleration times speed as far as these are against each other
MOST_W, MOST_A, MOST_LOAD, MOST_POWER = 13, 14, 15, 16
SUMS = 17
LONGEST, IN_ALL, FIRST, BEGAN, NOW = range(5)  # s, of the time above a level, in the place of sums
BLOCK = 64  # segments that are looked at together for that
BINS = 64  # of acceleration and of speed
WIDE = 32  # points of a group that are looked at together
