"""Cycles for the kernel out of losses alone, and the power of a motor over the pieces of its cycle."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from drivesizer.kernel.cycle import HEAT
from drivesizer.kernel.evaluate import evaluate
from drivesizer.kernel.records import Drive
from drivesizer.physics import thermal


def warmed(motors, ambient, dt, squares, losses):
    """Peak, its time and least of windings [K] by mean square currents and losses at the housing: (motors, pieces)."""
    t, squares, losses = np.broadcast_arrays(np.asarray(dt, float), squares, losses)
    ends = {"speed": losses, "acceleration": 0.0 * losses, "torque": np.sqrt(squares)}  # 1 A/(N*m), 1 W*s/rad
    cycle = SimpleNamespace(duration=t.T, **{name: np.stack([x.T, x.T], axis=1) for name, x in ends.items()})
    known = motors.known & ~np.isnan(squares.sum(axis=1) + losses.sum(axis=1))
    with np.errstate(divide="ignore", invalid="ignore"):
        drive = Drive(**dict.fromkeys(Drive._fields, 0.0))._replace(
            driving=1.0, braking=1.0, resting=1.0, friction=1.0, permitted=np.nan, rise=np.nan, mean_rise=np.nan,
            winding_start=np.nan, housing_start=np.nan,
            R=thermal.resistance_at(motors.R_25, ambient), R_rise=motors.R_25 * thermal.COPPER,
            R_th1=motors.R_th1, R_th2=motors.R_th2, C_w=motors.capacity_w, C_h=motors.capacity_h,
            course=known.astype(float), finest=np.inf, V_0=1.0,
        )  # fmt: skip
    found = evaluate(drive, cycle, HEAT)
    return SimpleNamespace(
        peak=found.winding + ambient, peak_time=found.winding_time, least=found.winding_least + ambient
    )


def motor_power(found, piece, share):
    """Power of a motor after shares of pieces of its cycle, its winding with the mean resistance of the piece [W]."""
    d, p = found.drive, found.pieces
    i, w = (a[piece] + share * (b[piece] - a[piece]) for a, b in ((p.I_0, p.I_1), (p.w_0, p.w_1)))
    volts = d.emf * w + (d.R + d.R_rise * p.rise_mean[piece]) * i
    return volts * i + np.maximum(-2.0 * d.surplus * w * i, 0.0)
