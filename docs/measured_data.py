"""What others measured on drives: read from a folder, or typed here where it is a short list.

Sources: Rhoban/bam at commit a6f2671b7f08524f6bb308ce3d2016a30faac61e (Dynamixel servos, Apache-2.0) and
karthikurs/actuator-dynamometer at commit 1ab6e56f6f9dbedd90398ccdfc05a4728ed38e03 (two RI50 motors shaft to shaft).
Temperatures in the records are degrees Celsius and become kelvin here; everything is SI.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["LIFT", "LOCKED", "RECORDS", "V_PER_HZ", "Held", "Record", "free_speed", "held", "record", "steps"]

Array = NDArray[np.float64]

CELSIUS = 273.15  # K

# bam, atomic/stall.py: MX-106 with 3.55 kg on an arm of 0.105 m; voltage [V], current [A], arm above horizontal [deg]
LIFT = np.array([
    (3.0, 1.37, 58.0), (3.5, 1.62, 50.0), (4.0, 1.80, 41.0), (4.5, 2.08, 33.0), (5.0, 2.21, 24.0), (5.5, 2.46, 10.0),
])  # fmt: skip
WEIGHT, ARM = 3.55 * 9.81, 0.105  # N, m

# bam, atomic/R_identification.py: MX-106, rotor locked, the unit that the authors call good; current [A], voltage [V]
LOCKED = np.array([
    (0.6, 1.25), (0.9, 1.88), (1.2, 2.46), (1.5, 3.13), (1.8, 3.7), (2.1, 4.4), (2.4, 5.15), (2.7, 5.35), (3.0, 6.4),
])  # fmt: skip

# actuator-dynamometer, logs of the drives' calibration of 2021-05-24: amplitude of a phase's voltage by frequency of
# rotation [V/Hz], resistance of a phase [ohm]
V_PER_HZ = (0.39794, 0.40252)
PHASE_RESISTANCE = (0.5218, 0.5748)

# actuator-dynamometer, futek_data: what each record is
RECORDS = {
    "stall": "futek_test_12_05_2021_11-32-30.csv",
    "stall with power": "futek_test_24_05_2021_16-20-14.csv",
    "no load": "futek_test_27_04_2021_17-39-20.csv",
    "no load with power": "futek_test_17_05_2021_17-17-56.csv",
}
_COLUMNS = {  # ours: theirs
    "t": "time [s]",
    "I": "a1 q-axis [A]",
    "I_other": "a2 q-axis [A]",
    "w": "a1 velocity [rad/s]",
    "M": "trs605-5 torque [Nm]",
    "winding": "motor temp [C]",
    "housing": "housing temp [C]",
    "P_1": "ina1 power [W]",
    "P_2": "ina2 power [W]",
}
_COMMANDS = ("a1 q-axis cmd [A]", "a1 velocity cmd [Hz]")

Record = dict[str, Array]


class Held(NamedTuple):
    """Means over the second half of one step of a staircase."""

    command: float  # A, or Hz
    I: float  # A, q current of the driven motor, amplitude in a phase
    I2: float  # A^2, mean of its square
    I2_other: float  # A^2, of the other motor
    w: float  # rad/s
    M: float  # N*m
    winding: float  # K
    P_1: float  # W, at the supply of both motors
    P_2: float  # W, of the other motor alone; NaN where not recorded


def _found(folder: Path, name: str) -> Path:
    """The one file of that name somewhere below a folder."""
    paths = sorted(folder.rglob(name))
    if not paths:
        raise SystemExit(f"{folder}: no file {name} in it; the head of measured_data.py names the repositories")
    return paths[0]


def free_speed(folder: Path, servo: str) -> tuple[Array, Array]:
    """Supply voltage [V] and speed of the free horn [rad/s] of a servo, ``mx64`` or ``mx106``."""
    pairs = json.loads(_found(folder, f"velocity_{servo}.json").read_text(encoding="utf-8"))
    return np.array([float(v) for v in pairs]), np.array(list(pairs.values()))


def lifted() -> tuple[Array, Array, Array]:
    """Voltage [V], current [A] and torque of the arm where it stops [N*m]."""
    voltage, current, angle = LIFT.T
    return voltage, current, WEIGHT * ARM * np.cos(np.radians(angle))


def record(folder: Path, name: str) -> Record:
    """The columns of one record; rows that were cut off are left out."""
    with _found(folder, RECORDS[name]).open(encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(line for line in file if not line.startswith("#"))
    place = {title.strip(): k for k, title in enumerate(head)}
    wanted = {ours: place[theirs] for ours, theirs in _COLUMNS.items() if theirs in place}
    wanted["command"] = next(place[title] for title in _COMMANDS if title in place)
    whole = [row for row in rows if len(row) >= len(place) - 1]
    found = {ours: np.array([float(row[k]) for row in whole]) for ours, k in wanted.items()}
    for body in ("winding", "housing"):
        found[body] = found[body] + CELSIUS
    return found


def steps(found: Record) -> Iterator[slice]:
    """The second half of each step of a staircase; a step of less than 60 rows is the end of a record."""
    edges = np.flatnonzero(np.diff(found["command"]) != 0.0) + 1
    for first, last in pairwise([0, *edges.tolist(), len(found["t"])]):
        if last - first >= 60:
            yield slice(first + (last - first) // 2, last)


def held(found: Record) -> list[Held]:
    """The steps of a staircase as means."""
    unknown = np.full_like(found["t"], np.nan)
    power = [found.get(name, unknown) for name in ("P_1", "P_2")]
    columns = (found["command"], found["I"], found["I"] ** 2, found["I_other"] ** 2, found["w"], found["M"],
               found["winding"], *power)  # fmt: skip
    return [Held(*(float(column[at].mean()) for column in columns)) for at in steps(found)]
