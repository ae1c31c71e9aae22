"""Places of figures of blocks of a load cycle, and of what is worked out of one segment; all in SI."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.groups.layout import OF_ACCELERATION, OF_SPEED, OF_TORQUE

__all__ = ["OF_ACCELERATION", "OF_SPEED", "OF_TORQUE"]  # beside constants, all used as ``at.NAME``

Array = NDArray[np.float64]

# --- what is wanted of each block
EXTREMES, DEVIATIONS, SIGNALS = 0.0, 1.0, 2.0

# --- a block: rows of figures
MEAN, ABOVE, BELOW = 0, 1, 2  # of products of the functions two by two, row by row of a triangle, as of ``heat_bounds``
HIGHEST, LOWEST = 3, 4  # of the functions
ROWS = 5
FUNCTIONS, ENTRIES = 6, 21
SQUARES = 4  # integrals of the squares by which blocks are chosen, in row 0; in row 1 their sums over segments

# --- a segment, and the block so far, in one array
LEFT, RIGHT, MOST, LEAST = 0, 8, 16, 24  # the six functions at its ends, and what they reach
PLACES = 24  # of products, the last three unused: so many are computed by few instructions
MEANS, SIZE, INNER = 32, 56, 80  # integrals, then means; sum of amounts; how far they deviate within a segment
WALK, HIGH, LOW = 104, 128, 152  # integral of what remains, and how far it goes
CELLS = 176
ROUNDING = 1e-12  # share of a sum that rounding may take
