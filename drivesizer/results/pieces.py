"""The motor piece by piece of the motion: a record that every output prints."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["MotorPiece"]


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorPiece:
    """Torque and current of the motor in one piece of the motion, SI; NaN unknown."""

    case: str  # load case; empty where there is only one
    name: str  # accelerate, run, brake, rest, or the whole cycle
    start: float  # s, of its first moment
    duration: float  # s, of all pieces alike where they are several
    speed: float  # rad/s, largest of the motor
    load_torque: float  # N*m at the driven shaft of one drive, the largest with its sign
    motor_torque: float  # N*m, the largest with its sign
    rms_torque: float  # N*m of the motor
    current: float  # A, largest
    rms_current: float  # A
