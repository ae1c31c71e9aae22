"""The mode of a drive train and its torques: directions of motor and load, contact, direction of power.

Arrays as in ``layout``. Symbols as in ``linear_modes``; f twist [rad], T torque of the driven shaft [N*m].
"""

from __future__ import annotations

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.layout import Array

__all__ = ["friction_holds", "holding_torque", "load_torque", "mode_of"]


def direction(speed: float, push: float, up: float, down: float) -> int:
    """Direction of motion: that of the speed; at rest that in which a torque overcomes the holding torque."""
    if speed != 0.0:
        return 1 if speed > 0.0 else -1
    return 1 if push > up else -1 if push < down else 0


def shaft_torque(p: Array, contact: float, w: float, f: float, v: float) -> float:
    """Torque of a flexible shaft in contact."""
    return float(p[at.C] * (f - contact * 0.5 * p[at.GAP]) + p[at.DAMP] * (w / p[at.RATIO] - v))


def contact_side(p: Array, w: float, f: float, v: float) -> int:
    """Side of the backlash that is in contact under pressure; without backlash the sign of the torque."""
    if p[at.GAP] == 0.0:
        return 1 if shaft_torque(p, 0.0, w, f, v) >= 0.0 else -1
    side = 1 if f > 0.0 else -1
    beyond = abs(f) > 0.5 * p[at.GAP] and side * shaft_torque(p, float(side), w, f, v) > 0.0
    return side if beyond else 0


def holding_torque(p: Array, T: float, side: float) -> float:
    """Torque at the motor that overcomes stiction and a load's torque."""
    return float(side * p[at.F_S] + T * (p[at.DRIVE] if T * side > 0.0 else p[at.BRAKE]))


def mode_code(motor: int, load: int, power: int) -> int:
    """A mode as one number: directions of motor and load, and of the shaft's torque."""
    return motor + 1 + 3 * (load + 1) + 9 * (power + 1)


def mode_of(p: Array, i: float, w: float, f: float, v: float, l: float) -> int:
    """The mode of a state."""
    push = p[at.K_T] * i
    if p[at.TWO] != 0.0:
        c = contact_side(p, w, f, v)
        T = shaft_torque(p, float(c), w, f, v) if c != 0 else 0.0
        motor = direction(w, push, holding_torque(p, T, 1.0), holding_torque(p, T, -1.0))
        return mode_code(motor, direction(v, T - l, p[at.T_F], p[at.T_B]), c)
    side = direction(w, push, holding_torque(p, p[at.T_F] + l, 1.0), holding_torque(p, p[at.T_B] + l, -1.0))
    if side == 0:
        return mode_code(side, side, side)
    T = (p[at.T_F] if side > 0 else p[at.T_B]) + l + p[at.B_L] * w / p[at.RATIO]
    M = push - side * p[at.F_M] - p[at.B_M] * w
    return mode_code(side, side, 1 if T * p[at.RATIO] * p[at.J_M] + p[at.J_L] * M > 0.0 else -1)


def friction_holds(p: Array, f: float, l: float) -> bool:
    """Whether friction alone holds a motor at rest."""
    code = mode_of(p, 0.0, 0.0, f, 0.0, l)
    return code % 3 == 1 and code // 3 % 3 == 1


def load_torque(p: Array, side: int) -> float:
    """Constant torque of the load by direction of motion."""
    return float(p[at.T_F] if side > 0 else p[at.T_B] if side < 0 else p[at.T_0])


def driven_torque(p: Array, code: int, i: float, w: float, f: float, v: float, l: float) -> float:
    """Torque of the driven shaft in a mode."""
    side, c = code % 3 - 1, code // 9 - 1
    if p[at.TWO] != 0.0:
        return shaft_torque(p, float(c), w, f, v) if c != 0 or p[at.GAP] == 0.0 else 0.0
    T = load_torque(p, side) + l
    if side == 0:
        return T
    share = p[at.DRIVE] if c * side > 0 else p[at.BRAKE]
    M = p[at.K_T] * i - side * p[at.F_M] - p[at.B_M] * w
    across = p[at.RATIO] * p[at.J_M]
    return float(((T + p[at.B_L] * w / p[at.RATIO]) * across + p[at.J_L] * M) / (across + p[at.J_L] * share))


def gear_torque(p: Array, code: int, i: float, w: float, f: float, v: float, l: float) -> float:
    """Torque at the gearhead's output: the driven shaft's through the belt."""
    power = (code % 3 - 1) * (code // 9 - 1)
    share = p[at.G_D] if power > 0 else p[at.G_B] if power < 0 else p[at.G_0]
    return float(driven_torque(p, code, i, w, f, v, l) * share)


def matrix_of(p: Array, code: int) -> int:
    """Number of a mode's matrix in ``linear_modes.generators``."""
    side, load, c = code % 3 - 1, code // 3 % 3 - 1, code // 9 - 1
    drives = 1 if c * side >= 0 else 2
    if p[at.TWO] == 0.0:
        return 0 if side == 0 else drives
    return abs(side) + 2 * abs(load) + 4 * (drives if c != 0 else 0)
