"""Layout of the arrays of the compiled simulation.

``p`` parameters, ``s`` state and ``g`` tallies of one drive have a place for every figure, named here and read as
``p[at.K_T]``. ``M`` holds the matrices of ``drive_train.discretised`` by node of temperature, mode and level (the last
is a whole period), ``work`` those at the winding's present temperature, ``stamp`` the temperatures of ``work``. ``z``
is scratch: a step's state is in its second half. ``mind`` keeps figures of the last sample to detect a steady state.
``ring`` holds the counts of the last velocity periods. ``rows`` is the time series; ``kept`` marks the rows that are
never thinned out, ``size`` is (rows, stride, spare rows, samples after a corner that are kept). Units are SI; speeds
and angles are those of the motor shaft unless marked as the load's.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def places(names: list[str]) -> Iterable[int]:
    """Numbers of places; not Python integers, for which numba would compile a function once for every number."""
    numbers: Any = np.arange(len(names))
    return numbers


def numbered(names: str, before: str = "") -> list[str]:
    """Names of places, each with its number as a constant of this module, as in ``p[at.K_T]``."""
    listed = names.split()
    globals().update({before + name: number for name, number in zip(listed, places(listed), strict=True)})
    return listed


if TYPE_CHECKING:

    def __getattr__(name: str) -> int:
        """Number of the place of a figure."""


# the machine; the controller (kp, integral gain per sample, share of the derivative that is kept, derivative gain per
# sample; current and position loop, feedforwards); limits; heat; tolerances of a steady state
PARAMETERS = numbered("""
    H R25 K_T K_E J_M F_M B_M RATIO DRIVE BRAKE J_L T_F T_B T_0 C DAMP GAP G_0 G_D G_B TWO
    CASCADE N_V N_P KP KI KEEP KD CKP CKI PKP FFV FFF FFA EDGES WINDOW V_0 R_S SETS DUTY DROP
    PEAK CONT2 BUDGET HEAT R_A ALPHA AMBIENT P_1 P_2 NODE_0 NODE_D NODES MOST
    TOL_I TOL_W TOL_U TOL_F TOL_X PROMPT LOSS R_B STANDBY LEADS X_C KEPT RESTS HEAT_PERIODS
    FEEDBACK A_WW A_WH A_HW A_HH BY_SQUARE BY_LOSS AHEAD SOON
""")

# machine; heat (rises over ambient, copper heat, and what a kelvin at the start makes of them); controller: pending
# voltage, integrals with derivative, last error and its presence, current demand now and next, excess over the limits;
# angle of the reference at the start of the cycle
STATE = numbered("""
    I W F V X Y T_W T_H Q WW WH WQ HW HH HQ CODE I2T PEND OUTER - - - INNER - - -
    I_DEMAND I_NEXT I_CUT U_CUT W_ADD W_NEXT LIMIT STEPS SQUARE RES SEEN TURN
""")

# largest magnitudes with their times, then sums [s, A^2 s, J, (rad/s)^2 s, rad^2 s], then highest and lowest;
# errors of the motor (W, X) are those at the motor, errors of the load (V, Y) those at the driven shaft
TALLY = numbered(
    """
    I T_I U_DEMAND T_U_DEMAND U T_U W T_W E_W T_E_W E_X T_E_X E_V T_E_V E_Y T_E_Y G T_G I_AHEAD T_I_AHEAD POWER T_POWER
    BUS T_BUS U_STAGE T_U_STAGE SQUARE SATURATED LIMITED IN RETURNED RESISTED E2_W E2_X E2_V E2_Y G_SQUARE
    RUNNING I2T WINDING HOUSING V_LOW
    """,
    before="G_",
)

_ROW = """
    time reference motor_speed current voltage gear_torque load_speed position_error load_position_error current_demand
    winding
"""
ROW = _ROW.split()

FRESH = 0.01  # K by which the winding may warm before its resistance is updated: 0.004 % of it
AMPLE = 1.001  # times what the peak current fills in a period: with so much left that alone is the limit
STEADY = 14  # figures that are compared to detect a steady state
VAST = 1e100  # beyond any machine, and small enough that squares stay finite
GOOD, NOT_FINITE, TOO_LONG = 0, 1, 2
