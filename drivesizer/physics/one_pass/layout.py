"""Places of figures in the arrays that the pass over a long cycle takes and fills; all in SI."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.groups.layout import (
    ACCELERATION,
    AT_REST,
    BRAKING,
    DIRECTION,
    DRIVING,
    OF_ACCELERATION,
    OF_SPEED,
    OF_TORQUE,
    SPEED,
)  # fmt: skip

__all__ = [
    "ACCELERATION",
    "AT_REST",
    "BRAKING",
    "DIRECTION",
    "DRIVING",
    "OF_ACCELERATION",
    "OF_SPEED",
    "OF_TORQUE",
    "SPEED",
]  # beside constants, all used as ``at.NAME``; fmt: skip

Array = NDArray[np.float64]

# --- a drive; the first six places are the current by torque (power to the load, from it, at rest), acceleration,
# direction and speed
EMF = 6  # V*s/rad, induced voltage per speed of the load
SURPLUS = 7  # V*s/rad, of it what the back-EMF constant is above the torque constant
FEEDBACK = 8  # 1/(A^2 s), by which copper that warms up heats more
W_W, W_H, H_W, H_H = 9, 10, 11, 12  # 1/s, exchange of heat between winding and housing, without current
HEAT_W, HEAT_H = 13, 14  # K/(A^2 s) of the winding, K/J of the housing
FRICTION, IRON = 15, 16  # W*s/rad, W*s^2/rad^2: loss at the housing by the speed of the load and its square
R_AMBIENT, R_RISE = 17, 18  # ohm at ambient temperature, and per K of rise
FIXED, AT_ENDS, MEANS = 19, 20, 21  # 1: no course of temperatures; rises instead, at ends and over pieces [K]
QUICKEST = 22  # s, what pieces of a segment are cut for
LEADS = 23  # ohm, that take of the voltage
LOSS, LEAST_LOSS, OHM, STANDBY = 24, 25, 26, 27  # V, V, ohm, W of the power stage
SOURCE, RESISTANCE, DRIVES = 28, 29, 30  # V without load, ohm of source and cables, that it feeds
KEPT = 31  # share of what is returned that stays on the bus
LIMIT = 32  # A, of which the time above is wanted
WANTED = 33  # -1 only time above, 0 of the winding, 1 power and time above too, 2 energy too; piece by piece,
# 3 those in a row that return nothing as one, or 4 each
PERIODIC_W, PERIODIC_H = 34, 35  # K, rises at the cycle's start
INVERSE = 36  # 1 / k of the whole numbers up to the most
MOST = 40  # terms of a series
NODES = INVERSE + MOST + 1  # nodes and weights of a quadrature from 0 to 1
POINTS = 6
FACTORS = NODES + 2 * POINTS  # 1 / k! of the whole numbers up to the last term of a short series
TERMS = 9
FIGURES = FACTORS + TERMS + 1

# --- what is found: three places of a peak are its value, and value and time of the first that is no less but rounding
WINDING, VOLTAGE, POWER = 0, 3, 6  # K of rise, V, W into the stage without standby power
COPPER = 9  # J
DRAWN, RETURNED = 10, 11  # J per cycle; standby power is not in it
SUM, LOWEST, HIGHEST, RISEN, CAME = 12, 13, 14, 15, 16  # J, of a store that is empty at the start
RUN, FIRST, BEGIN = 17, 18, 19  # s: longest above the limit so far, end of what is above at first, begin of the last
TIME, NOW_W, NOW_H = 20, 21, 22  # s, and rises [K], where the pass is
MAP = 23  # what a cycle adds to rises: by that of the winding, of the housing, and a constant; w and h of each
LEVEL = 29  # J, in the store
TOOK, GAVE, OUT, BACK = 30, 31, 32, 33  # of a piece: J drawn and returned; W, largest into the stage and out of it
KEPT_PIECES = 34  # 1, of which these are kept, each with its duration [s]
FOUND = 35

ALIKE = 1e-9  # share by which values differ that are alike, as in ``extremes``
FINEST, CLOSE = 200, 12e-3  # pieces of a segment at most; as in ``cycle_at_gearhead.piece_counts``
BRIEF = 0.06  # exponent up to which so many terms of a series do
NEGLIGIBLE = 1e-18  # first term that a series leaves out
FORGOTTEN = 1e-15  # share of a rise that is left when what was before is of no effect
AT_ONCE = 4096  # segments of a block
BEYOND = 1e9  # K: a winding that is warmer has run away

# --- pieces at a time, a stretch of ROOM places for each figure: one loop over them after the other. That all stretches
# are of one array, so far apart that none reaches another, lets several pieces be computed by one instruction
ROOM = 2 * FINEST
T, I_0, I_1, W_0, W_1 = 0, 1 * ROOM, 2 * ROOM, 3 * ROOM, 4 * ROOM  # s, A, A, rad/s, rad/s at the load
A_0, A_1, LOAD_0, LOAD_1 = 5 * ROOM, 6 * ROOM, 7 * ROOM, 8 * ROOM  # rad/s^2, N*m
SQUARE, HOUSING = 9 * ROOM, 10 * ROOM  # A^2, W at the housing: means
STEADY, LONG = 11 * ROOM, 12 * ROOM  # 1: nothing changes within it; 1: too long for a short series
Q_0, Q_1 = 13 * ROOM, 14 * ROOM  # 1, s: phi_2 over it
BY_W_W, BY_H_W, MORE_W = 15 * ROOM, 16 * ROOM, 17 * ROOM  # what it adds to the winding's rise: by both rises, and K
BY_W_H, BY_H_H, MORE_H = 18 * ROOM, 19 * ROOM, 20 * ROOM  # and to the housing's
START, END, MEAN = 21 * ROOM, 22 * ROOM, 23 * ROOM  # K, rises of the winding as voltages take them
SLOPE_0, SLOPE_1 = 24 * ROOM, 25 * ROOM  # K/s, slopes of the winding's rise at the ends
W, H = 26 * ROOM, 28 * ROOM  # K, rises of winding and housing at the start of each, and behind the last
COUNT = 30 * ROOM  # pieces of a segment
CELLS = 31 * ROOM
