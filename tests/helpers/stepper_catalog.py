"""An invented catalogue of steppers with drivers, and a brute-force check of them in plain Python."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

TEXT = Path(__file__).with_name("steppers.yaml").read_text(encoding="utf-8")


def written(folder: Path) -> Path:
    """The catalogue as a file."""
    path = folder / "steps.yaml"
    path.write_text(TEXT, encoding="utf-8")
    return path


def ideal_torque(w: float, volts: float, motor: Mapping[str, float]) -> float:
    """The largest torque of the two-phase model, of currents along the edge of what driver and supply allow."""
    p, I_m = motor["full_steps"] / 4.0, math.sqrt(2.0) * motor["phase_current"]
    k, R, X = motor["holding_torque"] / I_m, motor["resistance"], p * w * motor["inductance"]
    best, steps = 0.0, 720
    for step in range(steps):
        angle = 2.0 * math.pi * step / steps
        x, y = I_m * math.cos(angle), I_m * math.sin(angle)  # all of the current
        if (R * x - X * y + k * w) ** 2 + (R * y + X * x) ** 2 <= volts**2:
            best = max(best, x)
        ux, uy = volts * math.cos(angle) - k * w, volts * math.sin(angle)  # or all of the voltage
        x, y = (R * ux + X * uy) / (R * R + X * X), (R * uy - X * ux) / (R * R + X * X)
        if math.hypot(x, y) <= I_m:
            best = max(best, x)
    return k * best


def printed_torque(w: float, volts: float, curves: Mapping[float, list[tuple[float, float]]]) -> float:
    """Torque of the curve of the highest voltage that the supply reaches, else of the lowest; NaN beyond its end."""
    below = [at for at in curves if at <= volts]
    at = max(below) if below else min(curves)
    w, points, least = w * max(1.0, at / volts), curves[at], math.inf
    for n, (speed, torque) in enumerate(points):
        if w <= speed:
            if n == 0:
                return torque
            (a, low), b = points[n - 1], speed
            before = least
            least = min(least, torque)
            return before + (least - before) * (w - a) / (b - a) if low >= 0 else math.nan
        least = min(least, torque)
    return math.nan


def worst_share(cycle: Any, torque_at: Any, available: Any, pieces: int = 32) -> float:
    """Largest share of the available torque at fine steps of every segment."""
    worst = 0.0
    for n in range(len(cycle.duration)):
        for step in range(pieces + 1):
            share = step / pieces
            ends = [getattr(cycle, name)[n] for name in ("torque", "speed", "acceleration")]
            here = [float(a + (b - a) * share) for a, b in ends]
            torque, speed = torque_at(*here)
            worst = max(worst, abs(torque) / available(abs(speed)))
    return worst
