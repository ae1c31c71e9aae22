"""RI50 motor, stalled: how warm its winding gets, on the record that is fitted and on another day's."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from measured_data import CELSIUS, record
from measured_figures import Curve, Panel, panels
from measured_models import DC, Thermal, fit_thermal, followed, part, settled_start
from measured_tables import Array, Findings, Row, rms
from numpy.typing import NDArray

DT = 0.25  # s, span over which records are averaged
HOLDS = (30.25, 55.5)  # s, when the rotor goes to the next place in the fitted record
REST = 5.0  # s without current at the start of the carried record
_TWO, _THREE = (np.array([12.0, 400.0]), np.array([1.6])), (np.array([10.0, 40.0, 200.0]), np.array([1.5, 5.0]))
GUESSES = {
    "two": Thermal(*_TWO, 0.0, ()),
    "three": Thermal(*_THREE, 0.0, ()),
    "lag": Thermal(*_TWO, 2.0, ()),
    "lag_shares": Thermal(*_TWO, 2.0, (0.8, 0.6)),
    "full": Thermal(*_THREE, 2.0, (0.8, 0.6)),
}
KELVIN = {"two": "two bodies", "three": "three bodies (iron)", "lag": "two bodies, sensor's lag",
          "lag_shares": "two bodies, lag, shares of the phases", "full": "three bodies, lag, shares"}  # fmt: skip


class Course(NamedTuple):
    """A record in spans."""

    t: Array  # s, end of each
    I2: Array  # A^2, mean square of the equivalent DC current
    winding: Array  # K
    housing: Array  # K


class Followed(NamedTuple):
    """A model on both records."""

    model: Thermal
    fitted: Array  # K
    carried: Array  # K


def course(folder: Path, name: str) -> Course:
    """A record averaged over spans."""
    found = record(folder, name)
    at = np.floor(found["t"] / DT).astype(np.intp)
    count = np.bincount(at)
    columns = ((DC * found["I"]) ** 2, found["winding"], found["housing"])
    I2, winding, housing = (np.bincount(at, x).astype(np.float64) / count for x in columns)
    end = DT * np.arange(1, len(count) + 1, dtype=np.float64)
    return Course(end, I2, winding, housing)


def follow(guess: Thermal, fitted: Course, carried: Course, R_25: float) -> Followed:
    """Fit a model on one record and carry it to the other, from the temperatures that it rests at there."""
    hold: NDArray[np.intp] = np.searchsorted(HOLDS, fitted.t)
    model = fit_thermal(guess, R_25, DT, fitted.I2, hold, fitted.winding, fitted.housing)
    share = np.array([1.0, *model.shares])[hold] if model.shares else np.ones_like(fitted.I2)
    start = np.full(len(model.C), fitted.winding[0])
    own, _ = followed(model, R_25, float(fitted.housing[0]), DT, fitted.I2 * share, start)
    rest = carried.t <= REST
    start = settled_start(model, R_25, DT, carried.I2[rest], carried.winding[rest])
    other, _ = followed(model, R_25, start[-1], DT, carried.I2, start)
    return Followed(model, own, other)


def findings(folder: Path) -> Findings:
    """All of heat."""
    fitted, carried = course(folder, "stall"), course(folder, "stall with power")
    R_25 = part("cubemars", "RI50 KV100")["resistance"]
    found = {name: follow(guess, fitted, carried, R_25) for name, guess in GUESSES.items()}
    values: dict[str, str] = {}
    for name, one in found.items():
        values |= {f"heat_{name}_{key}": text for key, text in _numbers(one, fitted, carried).items()}
    return Findings(_rows(found, fitted, carried, values), {"winding": _figure(found, fitted, carried)}, values)


def _numbers(one: Followed, fitted: Course, carried: Course) -> dict[str, str]:
    model = one.model
    return {
        "rms": f"{rms(one.fitted - fitted.winding):.1f}",
        "peak": f"{one.fitted.max() - fitted.winding.max():+.1f}".replace("-", "−"),
        "carried_rms": f"{rms(one.carried - carried.winding):.1f}",
        "carried_peak": f"{one.carried.max() - carried.winding.max():+.1f}".replace("-", "−"),
        "C": f"{model.C[0]:.1f}", "R": f"{model.R_th[0]:.2f}", "tau": f"{model.C[0] * model.R_th[0]:.0f}",
        "C_2": f"{model.C[1]:.0f}", "lag": f"{model.lag:.1f}",
        "shares": " and ".join(f"{share:.2f}" for share in model.shares),
    }  # fmt: skip


def _rows(found: dict[str, Followed], fitted: Course, carried: Course, values: dict[str, str]) -> list[Row]:
    def error(name: str, kind: str) -> str:
        prefix = "carried_" if kind else ""
        return f"{values[f'heat_{name}_{prefix}rms']} K rms, peak {values[f'heat_{name}_{prefix}peak']} K"

    def over(x: Course) -> str:
        return f"{x.winding[0] - CELSIUS:.0f} to {x.winding.max() - CELSIUS:.0f} °C"

    rows = [Row("RI50, winding temperature in 72 s", "unknown: no thermal figure", over(fitted), "none")]
    rows += [Row(f"RI50, the same, {KELVIN['two']} fitted to it", "fit", over(fitted), error("two", ""),
                 error(name, ""), KELVIN[name]) for name in ("three", "lag", "lag_shares", "full")]  # fmt: skip
    rows += [Row("RI50, carried to another day, warm start", "fit of the first", over(carried), error("two", "c"),
                 error(name, "c"), KELVIN[name]) for name in ("three", "full")]  # fmt: skip
    return rows


def _figure(found: dict[str, Followed], fitted: Course, carried: Course) -> bytes:
    kinds = {"two": "sheet", "three": "second", "full": "third"}

    def panel(title: str, data: Course, which: str) -> Panel:
        curves = [Curve(data.t, data.winding - CELSIUS, "measured", "record")]
        curves += [Curve(data.t, getattr(found[name], which) - CELSIUS, KELVIN[name], kind)
                   for name, kind in kinds.items()]  # fmt: skip
        return Panel(title, "time [s]", "winding [°C]", curves)

    return panels(panel("the record that is fitted", fitted, "fitted"), panel("carried over", carried, "carried"),
                  height=2.7)  # fmt: skip
