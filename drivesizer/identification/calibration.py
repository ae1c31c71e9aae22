r"""Files of a controller's own calibration, held against themselves: moteus (constants, d-axis sweeps) and ODrive.

A sweep is y = w (lambda + L_d i_d) with the voltage y = u_q - R i_q at electrical speeds w and currents i_d; the flux
linkage stands in v_per_hz too, :math:`\lambda = v / (\pi n)` of n poles, and the maker's own fit has a term of
saturation besides. Currents are amplitudes of the q axis: :math:`k_t = 3/2 \cdot n/2 \cdot \lambda`.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from math import isnan, nan, pi
from pathlib import Path
from typing import Any

import numpy as np

from drivesizer.errors import InputError
from drivesizer.identification.fit import BAND, of_points, widest
from drivesizer.identification.log import in_its_form
from drivesizer.results.identification import Identification, IdentifiedFigure, Inseparable, LogFinding, Trace

_CONTRADICT = 0.1  # of two figures of one file
_KV = 30.0  # rpm/V times V/Hz of one motor, of amplitude to half of the supply
_INDUCTANCES = 2e-6, 4e-3  # H, that ODrive accepts
_MODEL = 0.03  # of the flux linkage, that another term for saturation moves it by at least
_RESULTS = Inseparable(
    "any band", "the file has results alone", "a log of voltage, current, speed, stalled and running"
)


def calibration(path: Path, raw: bytes) -> Identification | None:
    """Figures of a calibration file with cross-checks; None of any other file."""
    if path.suffix not in (".json", ".log"):
        return None
    if raw.lstrip()[:1] != b"{":
        return None
    try:
        data = json.loads(raw)
    except (ValueError, RecursionError):
        return None
    with in_its_form(path, "a calibration as its program wrote it"):
        if isinstance(data.get("raw"), dict) and isinstance(data.get("params"), dict):
            return _sweep(data, path)
        if "v_per_hz" in data and "calibration" in data:
            return _constants(data, path)
        flat = dict(_flat(data))
        if any(name.endswith("phase_resistance") for name in flat):
            return _odrive(flat, path)
    return None


def _flat(data: Mapping[str, Any], above: str = "", depth: int = 0) -> Iterator[tuple[str, float]]:
    for name, value in data.items():
        if isinstance(value, dict) and depth < 8:
            yield from _flat(value, f"{above}{name}.", depth + 1)
        elif isinstance(value, int | float):
            yield f"{above}{name}", float(value)


def _printed(name: str, title: str, kind: str, unit: str, value: float) -> IdentifiedFigure:
    return IdentifiedFigure(name, title, kind, unit, value, nan, nan, "as the file has it")


def _sweep(data: Mapping[str, Any], path: Path) -> Identification:
    rows = [
        (float(d), float(point["omega"]), float(point["y"])) for d, points in data["raw"].items() for point in points
    ]
    if len(rows) < 8:
        raise InputError(f"{path}: raw: {len(rows)} points; expected at least 8")
    i_d, w, y = np.array(rows).T
    params = data["params"]
    poles, v_per_hz, R = (float(params[name]) for name in ("poles", "v_per_hz", "R"))
    table = np.column_stack([w, w * i_d])
    (flux, L_d), three = of_points(table, y)
    by_file = float(data.get("fit", {}).get("lambda_m", nan))
    by_hz = v_per_hz / (pi * poles)
    reach = [BAND * float(x) for x in three.max(axis=0)]
    reach[0] = max(reach[0], abs(by_file - flux) if by_file > 0.0 else 0.0, _MODEL * flux)
    k = 0.75 * poles
    figures = (
        IdentifiedFigure("flux_linkage", "flux linkage", "plain", "V*s", flux, flux - reach[0], flux + reach[0],
                         "with and without saturation", by_file, nan),
        IdentifiedFigure("k_t", "torque constant, of the q axis' amplitude", "torque_constant", "mN*m/A", k * flux,
                         k * (flux - reach[0]), k * (flux + reach[0]), "with and without saturation", k * by_hz, nan),
        IdentifiedFigure("L_d", "inductance of the d axis", "inductance", "mH", L_d, L_d - reach[1], L_d + reach[1],
                         widest(three)[1]),
        _printed("R", "resistance of a phase", "resistance", "ohm", R),
    )  # fmt: skip
    findings = [*_contradictions("v_per_hz over poles", by_hz, "the flux linkage of the sweep", flux)]
    traces = (Trace("voltage", "voltage", "V", y, table @ np.array([flux, L_d])),)
    return _identification(path, figures, findings, len(rows), w, traces,
                 Inseparable("inertia and friction", "it has steady points alone", "a log of a move"))  # fmt: skip


def _contradictions(source: str, a: float, other: str, b: float) -> Iterator[LogFinding]:
    if not (isnan(a) or isnan(b)) and abs(a / b - 1.0) > _CONTRADICT:
        text = f"{source} gives {a:.4g}, {other} {b:.4g}: a contradiction of {abs(a / b - 1.0):.0%} within the file"
        yield LogFinding("contradiction", text, b / a, severe=True)


def _constants(data: Mapping[str, Any], path: Path) -> Identification:
    poles, v_per_hz = float(data["calibration"]["poles"]), float(data["v_per_hz"])
    flux = v_per_hz / (pi * poles)
    findings = [*_contradictions("kv times v_per_hz", float(data.get("kv", nan)) * v_per_hz, "30 rpm/Hz", _KV)]
    figures = (
        _printed("flux_linkage", "flux linkage", "plain", "V*s", flux),
        _printed("k_t", "torque constant, of the q axis' amplitude", "torque_constant", "mN*m/A", 0.75 * poles * flux),
        _printed("R", "resistance of a phase", "resistance", "ohm", float(data["winding_resistance"])),
    )
    return _identification(path, figures, findings, 1, np.zeros(0), (), _RESULTS)


def _odrive(flat: Mapping[str, float], path: Path) -> Identification:
    """Figures of each axis that a configuration has."""
    figures, findings, end = list[IdentifiedFigure](), list[LogFinding](), "phase_resistance"
    stems = sorted(name.removesuffix(end) for name in flat if name.endswith(end))
    for stem in stems:
        R, L, k_t = (flat.get(f"{stem}{name}", nan) for name in (end, "phase_inductance", "torque_constant"))
        axis, of = (f"{stem.split('.')[0]}.", f"{stem.split('.')[0]}: ") if len(stems) > 1 else ("", "")
        if not (isnan(L) or _INDUCTANCES[0] <= L <= _INDUCTANCES[1]):
            text = f"{of}an inductance of {L:.3g} H is outside 2 uH to 4 mH"
            findings.append(LogFinding("range", text, severe=True))
        rows = (
            ("R", "resistance, terminal to terminal", "resistance", "ohm", 2.0 * R),
            ("L", "inductance, terminal to terminal", "inductance", "mH", 2.0 * L),
            ("k_t", "torque constant, of the q axis' amplitude", "torque_constant", "mN*m/A", k_t),
        )
        figures += [_printed(f"{axis}{name}", f"{of}{title}", *rest) for name, title, *rest in rows]  # type: ignore[arg-type]
    return _identification(path, figures, findings, 1, np.zeros(0), (), _RESULTS)


def _identification(
    path: Path, figures: Any, findings: Any, samples: int, time: Any, traces: Any, tied: Inseparable
) -> Identification:
    return Identification(log=path.name, samples=samples, figures=tuple(figures), inseparable=(tied,),
                          findings=tuple(findings), time=time, traces=traces)  # fmt: skip
