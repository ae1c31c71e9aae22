"""A log of a small motor, by Euler's method."""

from __future__ import annotations

import numpy as np


def motor_log(separator: str = "\t") -> str:
    """Time, voltage, current and speed of a motor of 2 ohm and 0.05 V*s/rad without inductance that follows steps."""
    R, k, J, dry, h, w = 2.0, 0.05, 2e-5, 0.004, 2e-3, 0.0
    rows = [separator.join(["time (s)", "motor voltage (V)", "current (A)", "motor speed (rpm)"])]
    for n, v in enumerate(np.repeat(np.tile([12.0, 4.0, -8.0, 10.0, -12.0], 4), 25).tolist()):
        rows.append(separator.join(f"{x:.8g}" for x in (n * h, v, (v - k * w) / R, w * 30.0 / np.pi)))
        for _ in range(50):
            w += h / 50.0 * (k * (v - k * w) / R - dry * np.sign(w or v)) / J
    return "\n".join(rows) + "\n"
