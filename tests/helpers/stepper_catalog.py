"""An invented catalogue of steppers with drivers, and a brute-force check of them in plain Python."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

TEXT = """\
catalog: 1
manufacturer: Steps
sources:
  sheet: {document: "sheet", confidence: quoted}
steppers:
- family: A
  source: sheet
  common: {full_steps: 200, ambient_min: -20 degC, ambient_max: 50 degC}
  columns: [part, phase_current (A), holding_torque (N*m), resistance (ohm), inductance (mH), rotor_inertia (g*cm^2),
    start_speed (rpm), mass (g), price (EUR)]
  rows:
  - [A1, 1.5, 0.42, 2.3, 4.0, 57, 420, 280, 12]
  - [A2, 2, 0.59, 1.6, 3.0, 82, 400, 390, 15]
  - [A3, 2.8, 1.26, 1.1, 3.6, 300, 330, 700, 22]
  - [A4, 4.2, 3.0, 0.9, 3.8, 800, 300, 1800, 34]
- family: B
  source: sheet
  common: {full_steps: 400, ambient_min: -20 degC, ambient_max: 50 degC, supply_max: 30 V}
  columns: [part, phase_current (A), holding_torque (N*m), resistance (ohm), inductance (mH), rotor_inertia (g*cm^2),
    start_speed (rpm), shaft_diameter (mm), mass (g)]
  rows:
  - [B1, 1.7, 0.44, 1.65, 4.1, 68, 200, 5, 380]
  - [B2, 3, 0.9, 1.1, 3.5, 130, 180, 8, 560]
pull_outs:
- {stepper: A2, source: sheet, voltage: 24 V, columns: [speed (rpm), torque (N*m)],
   rows: [[60, 0.42], [400, 0.43], [700, 0.32], [1200, 0.17]]}
- {stepper: A2, source: sheet, voltage: 48 V, columns: [speed (rpm), torque (N*m)],
   rows: [[60, 0.44], [900, 0.40], [1500, 0.28], [2400, 0.15]]}
gearheads:
- family: G
  source: sheet
  common: {kind: planetary, mounting: clamping hub, max_motor_shaft: 8 mm, stages: 1, efficiency: 95 %,
    continuous_torque: 6 N*m, intermittent_torque: 10 N*m, continuous_input_speed: 4000 rpm,
    intermittent_input_speed: 6000 rpm, continuous_power: 200 W, intermittent_power: 400 W, temperature_min: -20 degC,
    temperature_max: 60 degC}
  columns: [part, reduction, ratio, inertia (g*cm^2), mass (g)]
  rows: [[G4, "4:1", 4, 5, 300], [G7, "7:1", 7, 4, 300]]
controllers:
- family: D
  source: sheet
  common: {drives: stepper, buses: step and direction}
  columns: [part, supply_min (V), supply_max (V), continuous_current (A), peak_current (A), microsteps]
  rows:
  - [D2, 12, 30, 2.2, 3.1, 16]
  - [D4, 18, 50, 4.3, 6.0, 128]
- family: S
  source: sheet
  common: {drives: both, buses: CANopen}
  columns: [part, supply_min (V), supply_max (V), continuous_current (A), peak_current (A)]
  rows: [[S9, 10, 60, 9, 20]]
"""


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
