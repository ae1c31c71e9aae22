"""Brushless motor RI50: torque per ampere, power at stall, current and power without load."""

from __future__ import annotations

from math import pi, sqrt
from pathlib import Path
from typing import NamedTuple

import numpy as np
from measured_data import PHASE_RESISTANCE, V_PER_HZ, Held, held, record
from measured_figures import Curve, Panel, panels
from measured_models import DC, driver_loss, hot, idle_current, part, saturating, signed_line
from measured_tables import Array, Findings, Row, percent, rms, span

from drivesizer.physics.back_emf import back_emf_constant
from drivesizer.physics.thermal import COPPER, DATA_TEMPERATURE

OWN = "resistance and a loss by current fitted"


class Stall(NamedTuple):
    """A motor held at standstill, at some currents; all of the equivalent DC motor."""

    I: Array  # A, root of the mean square
    T: Array  # K
    P: Array  # W, electrical, of the driven motor and its drive, less standby
    P_other: Array  # W, of the other motor and its drive
    I_other: Array  # A
    standby: float  # W, of one drive


def findings(folder: Path) -> Findings:
    """All of the motor but its heat."""
    torque, values = _torque(held(record(folder, "stall")))
    stall = _stalled(held(record(folder, "stall with power")))
    power, power_values = _power(stall)
    idle = [x for x in held(record(folder, "no load")) if x.w > 1.0]
    current, current_values = _idle(idle)
    running, running_values = _running(held(record(folder, "no load with power")), stall)
    drawings = {"stall-power": _stall_figure(stall), "no-load-current": _idle_figure(idle)}
    found = values | power_values | current_values | running_values
    return Findings([*torque, *power, *current, *running], drawings, found)


def _torque(steps: list[Held]) -> tuple[list[Row], dict[str, str]]:
    driven = [x for x in steps if abs(x.command) > 1.0]
    I, M = DC * np.array([x.I for x in driven]), np.array([x.M for x in driven])
    k_t, off = signed_line(I, M)
    through_zero = float(I @ M / (I @ I))
    motor, emf = part("cubemars", "RI50 KV100"), sqrt(3.0) * V_PER_HZ[0] / (2.0 * pi)
    sheet, k_e = motor["torque_constant"], float(back_emf_constant(motor))
    rows = [
        Row("RI50, torque per ampere (stall, slope)", f"{1e3 * sheet:.1f} mN·m/A", f"{1e3 * k_t:.1f} mN·m/A",
            percent(sheet / k_t - 1.0)),
        Row("RI50, voltage per speed (the drive's calibration)", f"{1e3 * k_e:.1f} mV·s", f"{1e3 * emf:.1f} mV·s",
            percent(k_e / emf - 1.0)),
    ]  # fmt: skip
    return rows, {"k_t": f"{1e3 * k_t:.1f}", "k_t_q": f"{1e3 * k_t * DC:.1f}", "k_t_off": f"{1e3 * off:.0f}",
                  "k_t_zero": f"{1e3 * through_zero:.1f}", "emf": f"{1e3 * emf:.1f}",
                  "emf_other": f"{1e3 * sqrt(3.0) * V_PER_HZ[1] / (2.0 * pi):.1f}",
                  "sheet_k_t": f"{1e3 * sheet:.0f}", "sheet_k_e": f"{1e3 * k_e:.1f}",
                  "rms_k_t": f"{1e3 * sheet / sqrt(1.5):.0f}",
                  "rms_error": percent(sheet / sqrt(1.5) / k_t - 1.0)}  # fmt: skip


def _stalled(steps: list[Held]) -> Stall:
    """The supply of the first instrument feeds both drives, the second instrument sees the other one."""
    rest, *driven = steps[:5]
    standby = rest.P_1 - rest.P_2
    return Stall(
        DC * np.sqrt([x.I2 for x in driven]), np.array([x.winding for x in driven]),
        np.array([x.P_1 - x.P_2 for x in driven]) - standby, np.array([x.P_2 for x in driven]) - rest.P_2,
        DC * np.sqrt([x.I2_other for x in driven]), standby,
    )  # fmt: skip


def _warmth(T: Array) -> Array:
    return 1.0 + COPPER * (T - DATA_TEMPERATURE)


def _power(x: Stall) -> tuple[list[Row], dict[str, str]]:
    R_25 = part("cubemars", "RI50 KV100")["resistance"]
    cold, warm = R_25 * x.I**2, hot(R_25, x.T) * x.I**2
    R_own, by_current = driver_loss(x.I, x.P, _warmth(x.T))
    own = hot(R_own, x.T) * x.I**2 + by_current * x.I
    rows = [Row(f"RI50, power at stall, {i / DC:.0f} A, winding at {T - 273.15:.0f} °C", f"{p:.1f} W", f"{m:.1f} W",
                percent(p / m - 1.0), percent(o / m - 1.0), OWN)
            for i, T, p, m, o in zip(x.I, x.T, warm, x.P, own, strict=True)]  # fmt: skip
    rows.append(Row(f"RI50, the same with the cold resistance, {x.I[-1] / DC:.0f} A", f"{cold[-1]:.1f} W",
                    f"{x.P[-1]:.1f} W", percent(cold[-1] / x.P[-1] - 1.0), percent(warm[-1] / x.P[-1] - 1.0),
                    "the winding's measured temperature"))  # fmt: skip
    both = warm + hot(R_25, x.T) * x.I_other**2
    measured = x.P + x.P_other
    rows.append(Row("RI50, both motors at stall, 4 to 8 A", f"{both[1]:.1f} to {both[-1]:.1f} W",
                    f"{measured[1]:.1f} to {measured[-1]:.1f} W", span((both / measured - 1.0)[1:])))  # fmt: skip
    return rows, {
        "sheet_R": f"{R_25:.2f}", "R_fit": f"{R_own:.2f}", "by_current": f"{by_current:.2f}",
        "by_current_q": f"{by_current * DC:.2f}",
        "standby": f"{x.standby:.2f}", "cold_error": percent(cold[-1] / x.P[-1] - 1.0),
        "hot_error": percent(warm[-1] / x.P[-1] - 1.0),
        "R_drive": f"{2.0 * PHASE_RESISTANCE[0]:.2f} and {2.0 * PHASE_RESISTANCE[1]:.2f}",
        "R_drive_error": percent(2.0 * PHASE_RESISTANCE[0] / R_own - 1.0),
        "power_other": percent(float((hot(R_25, x.T) * x.I_other**2 / x.P_other)[-1]) - 1.0),
    }  # fmt: skip


def _idle_models(steps: list[Held]) -> tuple[Array, Array, dict[str, Array]]:
    """Speed, no-load current, and what the ways to read one no-load current make of it."""
    w, I = np.array([x.w for x in steps]), DC * np.array([x.I for x in steps])
    k_t = part("cubemars", "RI50 KV100")["torque_constant"]
    slope, rest = np.polyfit(w, I, 1)
    a, b, at = saturating(w, I)
    return w, I, {
        "flat": idle_current(w, k_t, I[-1], w[-1], "brushed"),
        "proportional": idle_current(w, k_t, I[-1], w[-1], "brushless"),
        "line": rest + slope * w,
        "saturating": a + b * (1.0 - np.exp(-w / at)),
    }  # fmt: skip


def _idle(steps: list[Held]) -> tuple[list[Row], dict[str, str]]:
    w, I, models = _idle_models(steps)
    error = {name: found / I - 1.0 for name, found in models.items()}
    a, b, at = saturating(w, I)
    slope, rest = np.polyfit(w, I, 1)
    one, measured = "one no-load current at 126 rad/s", f"{I[0]:.2f} to {I[-1]:.2f} A"
    rows = [
        Row("RI50, no-load current, 16 to 126 rad/s", "unknown: none printed", measured, "none"),
        Row("RI50, the same, flat (as of a brushed motor)", one, measured, span(error["flat"]),
            span(error["line"]), "friction at rest and by speed, two figures"),
        Row("RI50, the same, in proportion to speed (as of a brushless one)", one, measured,
            span(error["proportional"]), span(error["saturating"]), "a rise that levels off, three figures"),
    ]  # fmt: skip
    return rows, {
        "idle_rms_" + name: f"{100 * rms(found):.0f}" if rms(found) > 0.1 else f"{100 * rms(found):.1f}"
        for name, found in error.items()
    } | {
        "idle_rest": f"{a:.2f}", "idle_rise": f"{b:.2f}", "idle_speed": f"{at:.0f}",
        "idle_first": f"{I[0]:.2f}", "idle_last": f"{I[-1]:.2f}", "line_rest": f"{rest:.2f}",
        "line_slope": f"{1e3 * slope:.1f}", "idle_least": f"{steps[0].I:.2f}", "idle_most": f"{steps[-1].I:.2f}",
    }  # fmt: skip


def _running(steps: list[Held], stall: Stall) -> tuple[list[Row], dict[str, str]]:
    """Electrical power without load, from the measured current."""
    motor, rest = part("cubemars", "RI50 KV100"), steps[0]
    moving = [x for x in steps if x.w > 1.0]
    w, I, T = (np.array(x) for x in ([m.w for m in moving], [DC * m.I for m in moving], [m.winding for m in moving]))
    I2 = DC**2 * np.array([m.I2 for m in moving])
    measured = np.array([m.P_1 - m.P_2 for m in moving]) - (rest.P_1 - rest.P_2)
    sheet = hot(motor["resistance"], T) * I2 + motor["torque_constant"] * I * w
    R_own, by_current = driver_loss(stall.I, stall.P, _warmth(stall.T))
    own = hot(R_own, T) * I2 + motor["torque_constant"] * I * w + by_current * I
    share = "resistance and loss by current of the stall"
    rows = [Row("RI50, power without load, 16 to 94 rad/s", f"{sheet[0]:.2f} to {sheet[-1]:.2f} W",
                f"{measured[0]:.2f} to {measured[-1]:.2f} W", span(sheet / measured - 1.0),
                span(own / measured - 1.0), share)]  # fmt: skip
    return rows, {
        "running_standby": f"{rest.P_1 - rest.P_2:.2f}", "running_off": f"{rest.P_2:.2f}",
        "running_both": f"{rest.P_1:.2f}", "running_sheet": span(sheet / measured - 1.0),
        "running_own": span(own / measured - 1.0),
        "running_rms": f"{100 * rms(sheet / measured - 1.0):.0f}",
        "running_rms_own": f"{100 * rms(own / measured - 1.0):.0f}",
    }  # fmt: skip


def _stall_figure(x: Stall) -> bytes:
    R_25 = part("cubemars", "RI50 KV100")["resistance"]
    I = np.linspace(0.0, 7.0, 50)
    T = np.interp(I, x.I, x.T)
    R_own, by_current = driver_loss(x.I, x.P, _warmth(x.T))
    return panels(Panel("RI50 at stall, standby taken off", "current, of the equivalent DC motor [A]", "power [W]", [
        Curve(x.I, x.P, "measured, driven motor", "measured"),
        Curve(x.I_other, x.P_other, "measured, the other one (temperature unknown)", "other"),
        Curve(I, R_25 * I**2, "data sheet, R at 25 °C", "sheet"),
        Curve(I, hot(R_25, T) * I**2, "data sheet, R at the measured temperature", "second"),
        Curve(I, hot(R_own, T) * I**2 + by_current * I, OWN, "third"),
    ]))  # fmt: skip


def _idle_figure(steps: list[Held]) -> bytes:
    w, I, models = _idle_models(steps)
    return panels(Panel("RI50 without load, the other motor dragged along", "speed [rad/s]", "no-load current [A]", [
        Curve(w, I, "measured", "measured"),
        Curve(w, models["flat"], "flat: a brushed motor's sheet", "sheet"),
        Curve(np.append(0.0, w), np.append(0.0, models["proportional"]), "in proportion: a brushless one's", "second"),
        Curve(w, models["saturating"], "rising, levelling off (fit)", "third"),
    ]))  # fmt: skip
