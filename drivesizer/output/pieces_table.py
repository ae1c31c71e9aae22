"""The motor piece by piece, as cells that terminal and reports print."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from drivesizer.results.pieces import MotorPiece

__all__ = ["FIGURES", "by_case"]

FIGURES = (  # head, field, unit and kind of each figure
    ("from", "start", "s", "time"),
    ("for", "duration", "s", "time"),
    ("speed", "speed", "rpm", "rotary_speed"),
    ("load torque", "load_torque", "N*m", "torque"),
    ("motor torque", "motor_torque", "mN*m", "torque"),
    ("RMS", "rms_torque", "mN*m", "torque"),
    ("current", "current", "A", "current"),
    ("RMS current", "rms_current", "A", "current"),
)


def by_case(pieces: Sequence[MotorPiece]) -> list[tuple[str, list[MotorPiece]]]:
    """Pieces of each load case, in order."""
    return [(case, list(of)) for case, of in groupby(pieces, key=lambda one: one.case)]
