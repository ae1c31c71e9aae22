"""Geared servos MX-64 and MX-106: free speed, resistance, current, torque."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from measured_data import LOCKED, free_speed, lifted
from measured_figures import Curve, Panel, panels
from measured_models import part, sheet_free_speed, sheet_lift, through_zero, with_offset
from measured_tables import Array, Findings, Row, percent, rms, span

RPM = np.pi / 30.0  # rad/s
SERVOS = {"mx64": "MX-64", "mx106": "MX-106"}
LINE = "the unit's own slope, and the voltage that friction takes"


def findings(folder: Path) -> Findings:
    """All of the servos."""
    speeds = {servo: free_speed(folder, servo) for servo in SERVOS}
    rows: list[Row] = []
    values: dict[str, str] = {}
    for servo, (V, w) in speeds.items():
        more, found = _speed(servo, V, w)
        rows += more
        values |= {f"{servo}_{name}": value for name, value in found.items()}
    drawings = {"free-speed": panels(*(_speed_panel(servo, *data) for servo, data in speeds.items()))}
    lift_rows, lift_values = _lift(*speeds["mx106"])
    return Findings(rows + lift_rows, drawings | {"lift": _lift_figure()}, values | lift_values)


def _speed(servo: str, V: Array, w: Array) -> tuple[list[Row], dict[str, str]]:
    name = SERVOS[servo]
    rows: list[Row] = []
    slope, offset = with_offset(V, w)
    for voltage in (12.0, 14.8):
        sheet = float(sheet_free_speed(part("robotis", f"{name} {voltage:g} V"), np.array([voltage]))[0])
        at = float(np.interp(voltage, V, w))
        refined = slope * (voltage - offset) / at - 1.0
        rows.append(Row(f"{name}, free speed at {voltage:g} V", f"{sheet / RPM:.1f} rpm", f"{at / RPM:.1f} rpm",
                        percent(sheet / at - 1.0), percent(refined), LINE))  # fmt: skip
    range_ = V >= 3.0
    error = sheet_free_speed(part("robotis", f"{name} 12 V"), V)[range_] / w[range_] - 1.0
    left = slope * (V - offset)[range_] / w[range_] - 1.0
    rows.append(Row(f"{name}, free speed over 3 to 15 V", "straight through zero", f"{int(range_.sum())} voltages",
                    span(error), span(left), LINE))  # fmt: skip
    residual = float(np.abs(slope * (V - offset) - w)[range_].max())
    return rows, {"slope": f"{slope:.4f}", "offset": f"{offset:.2f}", "k_e": f"{1 / slope:.3f}",
                  "residual": f"{residual:.3f}"}  # fmt: skip


def _speed_panel(servo: str, V: Array, w: Array) -> Panel:
    slope, offset = with_offset(V, w)
    x = np.array([0.0, 15.0])
    y = np.array([offset, 15.0])
    return Panel(SERVOS[servo], "supply voltage [V]", "free speed [rpm]", [
        Curve(V, w / RPM, "measured", "measured"),
        Curve(x, sheet_free_speed(part("robotis", f"{SERVOS[servo]} 12 V"), x) / RPM, "data sheet at 12 V", "sheet"),
        Curve(y, slope * (y - offset) / RPM, "own slope and offset", "second"),
    ])  # fmt: skip


def _lift(V_free: Array, w: Array) -> tuple[list[Row], dict[str, str]]:
    """Rows of the lift, as the sheet at 12 V says it."""
    servo, (V, I, M) = part("robotis", "MX-106 12 V"), lifted()
    I_sheet, M_sheet = sheet_lift(servo, V)
    R_locked, R_lift = float(np.polyfit(LOCKED[:, 0], LOCKED[:, 1], 1)[0]), float(np.polyfit(I, V, 1)[0])
    R_own, per_ampere = through_zero(I, V), float(np.mean(M / I))
    at_output = servo["ratio"] * servo["motor_torque_constant"]  # N*m/A before losses
    k_sheet, k_e = at_output * servo["efficiency"], 1.0 / with_offset(V_free, w)[0]
    own = "resistance and torque per ampere of the lift itself"
    rows = [
        Row("MX-106, resistance, rotor locked", f"{servo['resistance']:.2f} Ω", f"{R_locked:.2f} Ω",
            percent(servo["resistance"] / R_locked - 1.0), "", "nothing: the two measurements differ as much"),
        Row("MX-106, resistance, slope while lifting", f"{servo['resistance']:.2f} Ω", f"{R_lift:.2f} Ω",
            percent(servo["resistance"] / R_lift - 1.0)),
        Row("MX-106, current while lifting, 3 to 5.5 V", f"{I_sheet[0]:.2f} to {I_sheet[-1]:.2f} A",
            f"{I[0]:.2f} to {I[-1]:.2f} A", span(I_sheet / I - 1.0), span(V / R_own / I - 1.0), own),
        Row("MX-106, lifted torque, 3 to 5.5 V", f"{M_sheet[0]:.2f} to {M_sheet[-1]:.2f} N·m",
            f"{M[0]:.2f} to {M[-1]:.2f} N·m", span(M_sheet / M - 1.0), span(per_ampere * V / R_own / M - 1.0), own),
        Row("MX-106, torque per ampere", f"{k_sheet:.3f} N·m/A", f"{per_ampere:.3f} N·m/A",
            percent(k_sheet / per_ampere - 1.0), "0 by fit", own),
        Row("MX-106, the same without the gear's efficiency", f"{at_output:.3f} N·m/A", f"{per_ampere:.3f} N·m/A",
            percent(at_output / per_ampere - 1.0), percent(k_sheet / per_ampere - 1.0), "efficiency from the sheet"),
        Row("MX-106, gear efficiency", f"{100 * servo['efficiency']:.1f} %", f"{100 * per_ampere / k_e:.1f} %",
            percent(servo["efficiency"] * k_e / per_ampere - 1.0)),
    ]  # fmt: skip
    return rows, {
        "R_locked": f"{R_locked:.2f}", "R_lift": f"{R_lift:.2f}", "R_own": f"{R_own:.2f}",
        "per_ampere": f"{per_ampere:.3f}", "per_ampere_least": f"{(M / I).min():.2f}",
        "per_ampere_most": f"{(M / I).max():.2f}", "k_sheet": f"{k_sheet:.3f}", "at_output": f"{at_output:.3f}",
        "efficiency": f"{100 * per_ampere / k_e:.1f}", "sheet_efficiency": f"{100 * servo['efficiency']:.1f}",
        "lossless": percent(at_output / per_ampere - 1.0), "lossless_k_e": percent(k_e / per_ampere - 1.0),
        "k_e_error": percent(at_output / k_e - 1.0), "k_error": percent(k_sheet / per_ampere - 1.0),
        "lift_rms": f"{100 * rms(M_sheet / M - 1.0):.1f}",
        "lift_rms_own": f"{100 * rms(per_ampere * V / R_own / M - 1.0):.1f}",
        "mx64_efficiency": f"{100 * part('robotis', 'MX-64 12 V')['efficiency']:.1f}",
    }  # fmt: skip


def _lift_figure() -> bytes:
    servo, (V, I, M) = part("robotis", "MX-106 12 V"), lifted()
    volts = np.array([0.0, 6.0])
    amperes, torque = sheet_lift(servo, volts)
    return panels(
        Panel("MX-106 lifts: torque over current", "current [A]", "torque [N·m]", [
            Curve(I, M, "measured", "measured"),
            Curve(amperes, torque, "data sheet", "sheet"),
            Curve(amperes, torque / servo["efficiency"], "data sheet, no gear loss", "second"),
            Curve(amperes, float(np.mean(M / I)) * amperes, "mean of the measured", "third"),
        ]),
        Panel("current over voltage", "supply voltage [V]", "current [A]", [
            Curve(V, I, "measured", "measured"),
            Curve(volts, amperes, "data sheet", "sheet"),
            Curve(volts, volts / through_zero(I, V), "resistance of the lift", "third"),
        ]),
    )  # fmt: skip
