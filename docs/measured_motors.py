"""Motors without a gear: Jameco (brushed), motors of robot contests, ODrive D5065 (brushless)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from measured_compared import OWN_PARTS, Axis, Comparison, against, banded, part, predicted, sampled
from measured_data import COAST, CONTEST_MOTORS, DISC, RPM, SPEEDS, STEPS, duty_curves, mapped

from drivesizer.catalog.query import PartRow
from drivesizer.physics.thermal import resistance_at

_VOLTAGE, _DUTY = Axis("voltage", "V"), Axis("duty times 12 V", "V")
_SPEED = Axis("free speed", "rpm", 1.0 / RPM)
_TORQUE, _CURRENT, _POWER = Axis("torque", "N·m"), Axis("current", "A"), Axis("power", "W")
_STEP = 10.0  # V
_COAST = 517.0  # rad/s, at the start of the coast-down


def jameco(_: Path) -> list[Comparison]:
    """The red and the white motor, on a bridge of which nothing is printed."""
    bridge = part(OWN_PARTS, "brushed bridge")
    found = []
    for colour in ("red", "white"):
        motor, (V, w) = part(OWN_PARTS, f"Jameco {colour}"), SPEEDS[colour].T
        bands = predicted(motor, "free_speed", [{"voltage": u} for u in V], bridge)
        plain = motor["no_load_speed"] * V / motor["nominal_voltage"]
        found.append(against(f"{colour}_speed", V, _VOLTAGE, w, _SPEED, bands, plain))
    for colour, times in STEPS.items():
        motor, tau = part(OWN_PARTS, f"Jameco {colour}"), np.array(times)
        bands = predicted(motor, "step_time_63", [{"voltage": _STEP, "inertia": DISC}], bridge) * len(tau)
        plain = motor["resistance"] * (motor["rotor_inertia"] + DISC) / motor["torque_constant"] ** 2
        found.append(against(f"{colour}_step", np.arange(1.0, len(tau) + 1.0), Axis("run", ""), tau,
                             Axis("time to 63 %", "ms", 1e3), bands, plain))  # fmt: skip
    return [*found, _by_the_sheet(bridge), _coast()]


def _by_the_sheet(bridge: PartRow) -> Comparison:
    """The steps of both motors, with what the sheet prints and no more: the rotor inertia is estimated."""
    motor, tau = part(OWN_PARTS, "Jameco sheet"), np.array([*STEPS["red"], *STEPS["white"]])
    bands = predicted(motor, "step_time_63", [{"voltage": _STEP, "inertia": DISC}], bridge) * len(tau)
    runs = np.arange(1.0, len(tau) + 1.0)
    return against("sheet_step", runs, Axis("run", ""), tau, Axis("time to 63 %", "ms", 1e3), bands, np.nan)


def _coast() -> Comparison:
    """From the same speed as was measured: the voltage that makes it, without a bridge."""
    motor = part(OWN_PARTS, "Jameco red")
    speeds = predicted(motor, "free_speed", [{"voltage": u} for u in (8.0, 10.0)])
    voltage = float(np.interp(_COAST, [one.nominal for one in speeds], [8.0, 10.0]))
    bands = predicted(motor, "coast_time_half", [{"voltage": voltage, "inertia": DISC}])
    friction = motor["no_load_current"] * motor["torque_constant"]
    plain = (motor["rotor_inertia"] + DISC) * _COAST / 2.0 / friction
    return against("red_coast", np.zeros(1), Axis("", ""), np.array([_COAST / 2.0 / COAST]), Axis("time to half", "s"),
                   bands, plain)  # fmt: skip


def contest(folder: Path) -> list[Comparison]:
    """NEO, NEO 550 and Falcon 500: free and stalled, at duties."""
    found = []
    for file, (catalogue, name, source) in CONTEST_MOTORS.items():
        points = duty_curves(folder, file)
        V, speed, idle, torque, stall = points[points[:, 0] < 12.0].T if source else points.T
        motor, at = part(catalogue, name), [{"voltage": u} for u in V]
        key, share = file.replace("-", "_"), V / motor["nominal_voltage"]
        rows = (("free_speed", speed, _SPEED, motor["no_load_speed"] * share),
                ("no_load_current", idle, Axis("no-load current", "A"), motor["no_load_current"]),
                ("stall_torque", torque, Axis("stall torque", "N·m"), motor["stall_torque"] * share),
                ("stall_current", stall, Axis("stall current", "A"), V / motor["resistance"]))  # fmt: skip
        for figure, y, axis, plain in rows:
            found.append(against(f"{key}_{figure}", V, _DUTY, y, axis, predicted(motor, figure, at), plain))
    return found


def d5065(folder: Path) -> list[Comparison]:
    """ODrive D5065 over its map, from measured torque and speed."""
    motor, points = part("odrive", "D5065 270KV"), mapped(folder)
    one, _ = sampled(motor, motor["nominal_voltage"], part(OWN_PARTS, "brushless bridge"))
    assert one.feed is not None
    feed, R = one.feed, resistance_at(one.bodies.R_25, 300.0)

    def current(M: float, w: float) -> np.ndarray:
        return np.asarray((one.motor_torque(M) + one.drive.viscous * w) / one.drive.k_t)

    def power(M: float, w: float) -> np.ndarray:
        I = current(M, w)
        return np.asarray(R * I**2 + one.drive.k_e * I * w + feed.lost(I))

    plain_I = points.M / motor["torque_constant"]
    plain = motor["resistance"] * plain_I**2 + motor["torque_constant"] * plain_I * points.w
    at = (points.M, points.w)
    bands = {"current": banded(current, *at), "power": banded(power, *at),
             "loss": banded(lambda M, w: power(M, w) - M * w, *at)}  # fmt: skip
    return [
        against("d5065_current", points.M, _TORQUE, points.I, _CURRENT, bands["current"], plain_I),
        against("d5065_power", points.M, _TORQUE, points.P, _POWER, bands["power"], plain),
        against("d5065_loss", points.M, _TORQUE, points.P - points.M * points.w, Axis("loss", "W"), bands["loss"],
                plain - points.M * points.w),
    ]  # fmt: skip
