"""The drive of every closed loop under a log's own voltage or current: response by figures, and a start by regression.

A current that is the input is a winding of 1 ohm without back-EMF whose current follows at once. Without a known rotor
all inertia counts at the motor; a load that is known to be weight or was measured goes through the gears with their
losses. Symbols as in ``control.drive_train``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isnan, nan, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

import drivesizer.control.engine.layout as at
from drivesizer.control.drive_train import DriveTrain, columns, discretised
from drivesizer.control.engine.layout import PARAMETERS, STATE
from drivesizer.control.engine.start import mechanical, tally
from drivesizer.files.machine_code import machine_code
from drivesizer.identification.kernel import KERNEL
from drivesizer.physics.drive_train import through_gears
from drivesizer.physics.motion_curves import local_parabola

Array = NDArray[np.float64]
Figures = dict[str, float]

FIGURES = ("R", "L", "k_e", "k_t", "J", "M_c", "b", "e", "e_back", "delay")
_QUICK = 1e-3  # electrical time constant in samples, where there is none to speak of
_LEAST = 1e-6  # of a sample, that a part of it is
_SMOOTHED = 9.0  # samples around each of which a parabola is fitted
_FEW = 10  # samples of a known direction, with fewer than which all count
_CERTAIN = 4.0  # times the noise of the speed, above which its direction is known
_FASTEST = 5.0  # per cent of the top speed: below it the direction of friction is unknown


@dataclass(frozen=True, slots=True, kw_only=True)
class TwoWayTrain(DriveTrain):
    """A drive train whose gears lose another share where the load drives the motor."""

    back_efficiency: float

    @property
    def shares(self) -> tuple[float, float]:
        """Torque at the motor per torque at the driven shaft, driving and braking."""
        return through_gears(self.ratio, self.efficiency)[0], through_gears(self.ratio, self.back_efficiency)[1]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Record:
    """A log on an even grid, as the model takes it."""

    h: float  # s between samples
    driven: str  # voltage or current
    u: Array  # V or A, held from each sample to the next
    load: Array  # N*m at the output of the gears, against forward motion; as many and the end's
    outputs: Mapping[str, Array]  # current, speed: as measured
    start: Array  # rad/s where a stretch starts, else NaN
    ratio: float = 1.0  # of the gears
    rotor: float = nan  # kg*m^2 at the motor that is known to lie before the gears
    warm: Array | None = None  # share by which the winding's resistance is above that at 25 degC, where that is logged

    @property
    def loaded(self) -> bool:
        """Whether a load at the output is known."""
        return bool(np.any(self.load != 0.0))

    @property
    def lead(self) -> NDArray[np.bool_]:
        """Whether a sample follows a start so closely that it says little."""
        return np.asarray(~np.isnan(self.start), bool)


def train_of(x: Figures, one: Record) -> TwoWayTrain:
    """The drive train of some figures; of a current that is the input a winding that follows at once."""
    of_current = one.driven == "current"
    R = 1.0 if of_current else x["R"]
    rotor = x["J"] if isnan(one.rotor) else min(one.rotor, x["J"])
    return TwoWayTrain(
        resistance=R, inductance=max(0.0 if of_current else x["L"], _QUICK * one.h * R),
        torque_constant=x["k_t"], back_emf_constant=0.0 if of_current else x["k_e"], viscous=x["b"], friction=x["M_c"],
        motor_inertia=rotor, load_inertia=(x["J"] - rotor) * one.ratio**2, gear_ratio=one.ratio,
        gear_efficiency=x["e"], back_efficiency=x["e_back"],
    )  # fmt: skip


def response(x: Figures, one: Record) -> dict[str, Array]:
    """Current, speed and angle at each sample; each voltage begins so late, within a sample too."""
    train, out = train_of(x, one), np.zeros((len(one.u), 3))
    whole = int(np.floor(x["delay"]))
    share = min(max(x["delay"] - whole, _LEAST), 1.0 - _LEAST)
    parts = one.h * np.array([share, 1.0 - share])
    M = discretised(columns([train, train]), np.full((2, 1), train.resistance), parts)
    named = mechanical(train) | {
        "R25": train.resistance, "K_T": train.torque_constant, "K_E": train.back_emf_constant, "B_M": train.viscous,
        "G_0": 1.0, "G_D": 1.0, "G_B": 1.0, "V_0": 1.0, "DUTY": 1.0,
    }  # fmt: skip
    p = np.tile([float(named.get(name, 0.0)) for name in PARAMETERS], (2, 1))
    p[:, at.H] = parts
    s, z, stamp = np.zeros(len(STATE)), np.zeros(16), np.full((2, *M.shape[2:4]), nan)
    s[at.RES] = train.resistance
    place, last = np.arange(len(one.u)) - whole, len(one.u) - 1
    given = one.u if one.warm is None else one.u - x["R"] * one.warm * one.outputs["current"]
    u = np.column_stack([given[np.clip(place - n, 0, last)] for n in (1, 0)])
    wrong = machine_code(KERNEL)(p, s, tally(), M, M[:, 0].copy(), stamp, z, u, one.load, one.start, out)
    if wrong:
        out[:] = 1e30
    return {"current": out[:, 0], "speed": out[:, 1], "angle": out[:, 2]}


def noise_of(values: Array, h: float) -> float:
    """Standard deviation of what is no parabola over nine samples, with that of the steps that a column is read in."""
    time = h * np.arange(len(values), dtype=float)
    rest = values - local_parabola(time, values, _SMOOTHED * h)[0]
    spread = 1.4826 * float(np.median(np.abs(rest - np.median(rest))))
    steps = np.diff(np.unique(values))
    step = float(np.min(steps)) if len(steps) else 0.0
    return max(1.3 * spread, step / sqrt(12.0), 1e-4 * float(np.ptp(values)), 1e-12)


# -- A start by weighted regression, of signals smoothed alike.


def regression(one: Record, known: Figures) -> Figures:
    """Figures by linear regression on smoothed signals and their slopes; what has no column is as known.

    The voltage is R i + k_e w + L i' where the current was measured; the current, or a voltage alone, is in proportion
    to inertia, friction, speed and, where one is known, load.
    """
    h, n = one.h, len(one.u)
    time, window = h * np.arange(n, dtype=float), _SMOOTHED * h
    w, dw = local_parabola(time, one.outputs["speed"], window)
    u = local_parabola(time, np.append(one.u[0], (one.u[1:] + one.u[:-1]) / 2.0), window)[0]
    x = {"R": known.get("R", 1.0), "L": known.get("L", 0.0), "e": known.get("e", 1.0), "delay": 0.0,
         "k_e": known.get("k_e", 1.0), "k_t": known.get("k_t", 1.0)}  # fmt: skip
    x["e_back"] = x["e"]
    fast = np.abs(w) > max(_CERTAIN * noise_of(one.outputs["speed"], h) / 3.0, _FASTEST / 100.0 * np.abs(w).max())
    fast &= ~one.lead
    if fast.sum() < _FEW:
        fast = ~one.lead
    driving, braking = through_gears(one.ratio, x["e"])
    load = one.load[:-1] * np.where(one.load[:-1] * w > 0.0, driving, braking)
    push = u  # voltage or current that moves it
    if one.driven == "voltage" and "current" in one.outputs:
        push, slope = local_parabola(time, one.outputs["current"], window)
        warm = 1.0 if one.warm is None else 1.0 + one.warm
        x["R"], x["k_e"], x["L"] = _positive(np.column_stack([push * warm, w, slope]), u)
        x["k_t"] = known.get("k_t", x["k_e"])
    table = np.column_stack([dw, np.sign(w), w, *([load] if one.loaded else [])])[fast]
    a, s, b, *per_torque = _positive(table, push[fast])
    of_voltage = one.driven == "voltage" and "current" not in one.outputs
    if per_torque and per_torque[0] > 0.0 and "k_t" not in known:
        x["k_t"] = (x["R"] if of_voltage else 1.0) / per_torque[0]
    scale = x["k_t"] / x["R"] if of_voltage else x["k_t"]
    if of_voltage:
        x["k_e"], b = max(b, 1e-9), 0.0
        x["L"] = max(x["L"], x["R"] * h)  # to go on from: at 0 a delay would do for it
    least = 1e-4 * float(np.abs(push).max()) / (float(np.abs(dw).max()) or 1.0)
    return x | {"J": max(a, least, 1e-15) * scale, "M_c": s * scale, "b": b * scale}


def _positive(table: Array, right: Array) -> Array:
    """Non-negative least squares with columns of one size."""
    size = np.sqrt((table**2).mean(axis=0)) + 1e-300
    found = lsq_linear(table / size, right, bounds=(0.0, np.inf))
    return np.asarray(found.x / size)
