"""Where the figures of a motor set lie in the arrays that the compiled simulation works on.

All that a set is lies in an array of parameters, all that changes in an array of state, all that is watched in an array
of tallies, all that is kept of the course in rows. A place is named ``places.K_T`` as a figure is named ``K_T``.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["PARAMETERS", "ROW", "STATE", "TALLY", "Array"]

Array = NDArray[np.float64]


def _places(names: list[str]) -> Iterable[int]:
    """Numbers of places; not Python's own integers, for which numba compiles a function once for every number."""
    found: Any = np.arange(len(names))
    places: Iterable[int] = found
    return places


# the machine; the controller (kp, integral gain per sample, share of the derivative that is kept, derivative gain per
# sample; current and position loop, feedforwards); limits; heat; what is small enough to be at rest
_PARAMETERS = """
    H R25 K_T K_E J_M F_M F_S B_M RATIO DRIVE BRAKE J_L B_L T_F T_B T_0 C DAMP GAP G_0 G_D G_B TWO
    CASCADE N_V N_P KP KI KEEP KD CKP CKI PKP FFV FFF FFA DELAY EDGES WINDOW V_0 R_S SETS DUTY DROP
    RAISES PEAK CONT2 BUDGET HEAT R_1 R_2 C_W C_H R_A ALPHA AMBIENT P_0 P_1 P_2 NODE_0 NODE_D NODES
    MOST SENSE TOL_I TOL_W TOL_U TOL_F TOL_X PROMPT
"""
PARAMETERS = _PARAMETERS.split()
(
    H, R25, K_T, K_E, J_M, F_M, F_S, B_M, RATIO, DRIVE, BRAKE, J_L, B_L, T_F, T_B, T_0, C, DAMP, GAP, G_0, G_D, G_B,
    TWO, CASCADE, N_V, N_P, KP, KI, KEEP, KD, CKP, CKI, PKP, FFV, FFF, FFA, DELAY, EDGES, WINDOW, V_0, R_S, SETS, DUTY,
    DROP,
    RAISES, PEAK, CONT2, BUDGET, HEAT, R_1, R_2, C_W, C_H, R_A, ALPHA, AMBIENT, P_0, P_1, P_2, NODE_0, NODE_D, NODES,
    MOST, SENSE, TOL_I, TOL_W, TOL_U, TOL_F, TOL_X, PROMPT,
) = _places(PARAMETERS)  # fmt: skip

# machine; heat (rises over ambient, copper heat, and what a kelvin at the start makes of them); controller: pending
# voltage, integrals with derivative, last error and its presence, current asked for now and next, what was cut; angle
# of the reference when the cycle started
_STATE = """
    I W F V X Y T_W T_H Q WW WH WQ HW HH HQ CODE I2T PEND OUTER - - - INNER - - -
    I_DEMAND I_NEXT I_CUT U_CUT W_ADD W_NEXT LIMIT STEPS SQUARE RES SEEN TURN
"""
STATE = _STATE.split()
(
    I, W, F, V, X, Y, T_W, T_H, Q, WW, WH, WQ, HW, HH, HQ, CODE, I2T, PEND, OUTER, _, _, _, INNER, _, _, _,
    I_DEMAND, I_NEXT, I_CUT, U_CUT, W_ADD, W_NEXT, LIMIT, STEPS, SQUARE, RES, SEEN, TURN,
) = _places(STATE)  # fmt: skip

# largest magnitudes with their times, then what adds up [s, A^2 s, J, (rad/s)^2 s, rad^2 s], then highest and lowest;
# errors of the motor (W, X) are those at the motor, errors of the load (V, Y) those at the driven shaft
_TALLY = """
    I T_I U_DEMAND T_U_DEMAND U T_U W T_W E_W T_E_W E_X T_E_X E_V T_E_V E_Y T_E_Y G T_G I_AHEAD T_I_AHEAD POWER T_POWER
    BUS T_BUS SQUARE SATURATED LIMITED IN RETURNED E2_W E2_X E2_V E2_Y G_SQUARE RUNNING I2T WINDING HOUSING V_LOW V_HIGH
"""
TALLY = _TALLY.split()
(
    G_I, _, G_U_DEMAND, _, G_U, _, G_W, _, G_E_W, _, G_E_X, _, G_E_V, _, G_E_Y, _, G_G, _, G_AHEAD, _, G_POWER, _,
    G_BUS, _, G_SQUARE, G_SATURATED, G_LIMITED, G_IN, G_RETURNED, G_E2_W, G_E2_X, G_E2_V, G_E2_Y, G_G_SQUARE, G_RUNNING,
    G_I2T, G_WINDING, G_HOUSING, G_V_LOW, G_V_HIGH,
) = _places(TALLY)  # fmt: skip

_ROW = """
    time reference motor_speed current voltage gear_torque load_speed position_error load_position_error current_demand
    winding
"""
ROW = _ROW.split()

FRESH = 0.01  # K by which the winding may move before its resistance is taken anew: 0.004 % of it
STEADY = 14  # figures that are compared to see whether anything changes
VAST = 1e100  # beyond any machine, and small enough that squares stay finite
GOOD, NOT_FINITE, TOO_LONG = 0, 1, 2
