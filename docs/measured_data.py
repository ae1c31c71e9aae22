"""What others measured on drives: read from a folder, or typed here where it is a short list.

Sources, with licence where one is stated:
Rhoban/bam (Apache-2.0), a6f2671b7f08524f6bb308ce3d2016a30faac61e: Dynamixel MX-64 and MX-106;
the same, af2260462471ff45ac18af159b1327ea51d8db15: XL330 (``bam/data.bak/raw``, short list);
GrahamWhyte/Motor-Project, 6f453f32f06559be0c7ed05c4f7815795f5178a6: Jameco motors (short list);
karthikurs/actuator-dynamometer, 1ab6e56f6f9dbedd90398ccdfc05a4728ed38e03: two RI50 motors shaft to shaft;
pvandervelde/electrical-motor-data (Apache-2.0), 39f685fa37431265f6d8cd7e12bc520f611e54a7: motors of robot contests;
kscalelabs/sysid, 6b78737007c8741c6db3e50f8f05f048c16b68d2, no licence stated: Feetech STS3215 12 V;
Capo01/odrive_based_electric_motor_dynamometer (GPL-3), 6dd779a2e6fa051afdd1029ffeb238182de755a8: ODrive D5065.

Temperatures in the records are degrees Celsius and become kelvin here; everything is SI. The current of a brushless
motor is that of the DC motor with the same loss and torque: sqrt(3)/2 of the amplitude in a phase (the q current).
"""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from itertools import pairwise
from math import sqrt
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "COAST", "CONTEST_MOTORS", "DC", "INERTIA_STS3215", "LIFT", "LIFT_XL330", "LOCKED", "RECORDS", "SPEEDS", "STEPS",
    "SWING_XL330", "Course", "Held", "Mapped", "course", "duty_curves", "free_speed", "held", "lifted",
    "lifted_sts3215", "lifting_sts3215", "mapped", "record", "steps",
]  # fmt: skip

Array = NDArray[np.float64]

CELSIUS = 273.15  # K
RPM = np.pi / 30.0  # rad/s
DC = sqrt(3.0) / 2.0  # current of the equivalent DC motor by amplitude in a phase
_SPAN = 0.25  # s, over which temperatures are averaged

# bam, atomic/stall.py: MX-106 with 3.55 kg on an arm of 0.105 m; voltage [V], current [A], arm above horizontal [deg]
LIFT = np.array([
    (3.0, 1.37, 58.0), (3.5, 1.62, 50.0), (4.0, 1.80, 41.0), (4.5, 2.08, 33.0), (5.0, 2.21, 24.0), (5.5, 2.46, 10.0),
])  # fmt: skip
WEIGHT, ARM = 3.55 * 9.81, 0.105  # N, m

# bam, atomic/R_identification.py: MX-106, rotor locked, the unit that the authors call good; current [A], voltage [V]
LOCKED = np.array([
    (0.6, 1.25), (0.9, 1.88), (1.2, 2.46), (1.5, 3.13), (1.8, 3.7), (2.1, 4.4), (2.4, 5.15), (2.7, 5.35), (3.0, 6.4),
])  # fmt: skip

# bam, XL330: duty [1], supply [V], torque at which the arm stops [N*m]; inertia of the free swing at the horn [kg*m^2]
INERTIA_STS3215 = 0.0278  # kg*m^2 at the horn, as its authors identified it
LIFT_XL330 = np.array([(0.3436, 7.37, 0.175), (0.51, 7.23, 0.239), (0.79, 7.33, 0.368), (0.98, 7.08, 0.371)])
SWING_XL330 = 2.3e-3

# Motor-Project: speed over supply [V], [rad/s]; time constants of steps to 10 V [s]; coast-down from 10 V [rad/s^2]
SPEEDS = {
    "red": np.array([(5, 212.1), (6, 278.0), (7, 341.1), (8, 402.3), (9, 468.6), (10, 529.4), (11, 596.7), (12, 656.2),
                     (13, 721.5), (14, 784.7)]),
    "white": np.array([(7, 331.8), (9, 458.8), (11, 581.7), (13, 706.4), (15, 831.1), (18, 1014.0)]),
}  # fmt: skip
STEPS = {"red": (0.0264, 0.0310), "white": (0.0346,)}
COAST = 771.0  # the red motor, 517 to 301 rad/s
DISC = 15.18e-7  # kg*m^2, of the encoder

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
    "w": "a1 velocity [rad/s]",
    "M": "trs605-5 torque [Nm]",
    "winding": "motor temp [C]",
    "P_1": "ina1 power [W]",
    "P_2": "ina2 power [W]",
}
_COMMANDS = ("a1 q-axis cmd [A]", "a1 velocity cmd [Hz]")

# electrical-motor-data: file, and the motor's catalogue and number; whether the catalogue has its figures from these
# very measurements at 12 V
CONTEST_MOTORS = {
    "rev-neo": ("rev", "NEO V1.1", False),
    "rev-neo-550": ("rev", "NEO 550", False),
    "vex-falcon-500": ("vex", "Falcon 500", True),
}
_DUTIES = (4, 6, 8, 10, 12)  # V of 12 V
_SUPPLY = 12.0  # V
_LEAST = 3.0  # A of d current, from which on the voltage limits the drive of the D5065
_SLOWEST = 5.0  # rad/s

Record = dict[str, Array]


class Held(NamedTuple):
    """Means over the second half of one step of a staircase."""

    command: float  # A, or Hz
    I: float  # A, of the driven motor
    I2: float  # A^2, mean of its square
    w: float  # rad/s
    M: float  # N*m
    winding: float  # K
    P_1: float  # W, at the supply of both motors
    P_2: float  # W, of the other motor alone; NaN where not recorded


class Course(NamedTuple):
    """A record in spans."""

    t: Array  # s, end of each
    I2: Array  # A^2, mean square
    winding: Array  # K


class Mapped(NamedTuple):
    """Points of a map: one motor over speed and torque."""

    I: Array  # A
    M: Array  # N*m
    w: Array  # rad/s
    P: Array  # W, of the supply


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


def lifted_sts3215(folder: Path) -> tuple[Array, Array, Array]:
    """The same of an STS3215 of 12 V: medians over the runs with each of eight pendulums."""
    rows = _table(folder, "sts3215_lift.csv")
    pendulums = sorted({(row["mass_kg"], row["length_m"]) for row in rows})
    own = [[row for row in rows if (row["mass_kg"], row["length_m"]) == one] for one in pendulums]
    names = ("motor_V", "register_current_A", "torque_Nm")
    voltage, current, torque = (np.array([np.median([row[name] for row in some]) for some in own]) for name in names)
    return voltage, current, torque


def lifting_sts3215(folder: Path) -> tuple[Array, Array, Array]:
    """The same servo while it lifts: voltage [V], torque [N*m] and speed of the horn [rad/s]."""
    rows = _table(folder, "sts3215_lifting_speed.csv")
    voltage, torque, speed = (np.array([row[name] for row in rows]) for name in ("motor_V", "torque_Nm", "speed_rad_s"))
    return voltage, torque, speed


def _table(folder: Path, name: str) -> list[dict[str, float]]:
    """Rows of numbers by their heads; what is no number is left out."""
    with _found(folder, name).open(encoding="utf-8", newline="") as file:
        return [{head: float(x) for head, x in row.items() if head != "file"} for row in csv.DictReader(file)]


def record(folder: Path, name: str) -> Record:
    """The columns of one record; rows that were cut off are left out."""
    with _found(folder, RECORDS[name]).open(encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(line for line in file if not line.startswith("#"))
    place = {title.strip(): k for k, title in enumerate(head)}
    wanted = {ours: place[theirs] for ours, theirs in _COLUMNS.items() if theirs in place}
    wanted["command"] = next(place[title] for title in _COMMANDS if title in place)
    whole = [row for row in rows if len(row) >= len(place) - 1]
    found = {ours: np.array([float(row[k]) for row in whole]) for ours, k in wanted.items()}
    return found | {"I": DC * found["I"], "winding": found["winding"] + CELSIUS}


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
    columns = (found["command"], found["I"], found["I"] ** 2, found["w"], found["M"], found["winding"], *power)
    return [Held(*(float(column[at].mean()) for column in columns)) for at in steps(found)]


def course(folder: Path, name: str) -> Course:
    """A record averaged over spans."""
    found = record(folder, name)
    at = np.floor(found["t"] / _SPAN).astype(np.intp)
    count = np.bincount(at)
    I2, winding = (np.bincount(at, x).astype(np.float64) / count for x in (found["I"] ** 2, found["winding"]))
    return Course(_SPAN * np.arange(1, len(count) + 1, dtype=np.float64), I2, winding)


def duty_curves(folder: Path, motor: str) -> Array:
    """Voltage, free speed, current there, stall torque, current there; SI, shape (duties, 5).

    Each file is a straight line between its ends. Its current is that of the supply of 12 V; at a duty V/12 the
    motor's is 12/V times as large.
    """
    points = []
    for voltage in _DUTIES:
        text = _found(folder, f"{motor}_MotorCurve-{voltage}V.csv").read_text(encoding="latin-1")
        rows = [[float(x) for x in row[:3]] for row in list(csv.reader(text.splitlines()))[1:]]
        (_, torque, stall), (speed, _, idle) = rows[0], rows[-1]
        share = _SUPPLY / voltage
        points.append((float(voltage), speed * RPM, idle * share, torque, stall * share))
    return np.array(points)


def mapped(folder: Path) -> Mapped:
    """The D5065 over its map; points where the voltage limits the drive are left out."""
    with _found(folder, "odrive_data.csv").open(encoding="utf-8", newline="") as file:
        rows = [[float(x) for x in row] for row in csv.reader(file) if len(row) == 19 and _number(row[0])]
    table = np.array(rows)
    table = table[np.abs(table[:, 6]) < _LEAST]
    found = Mapped(-DC * table[:, 5], -table[:, 9] / 1e3, -table[:, 10], table[:, 0] * table[:, 7])
    driving = (found.M > _TORQUE) & (found.w > _SLOWEST)
    return Mapped(*(column[driving] for column in found))


_TORQUE = 0.1  # N*m, below which what the load cell shows is mostly the friction of the rig


def _number(text: str) -> bool:
    return text.strip().replace(".", "", 1).isdigit()
