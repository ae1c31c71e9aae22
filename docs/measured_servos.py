"""Geared servos MX-64, MX-106 and XL330: speed, torque, current, inertia."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from measured_compared import Axis, Comparison, against, banded, part, predicted, sampled
from measured_data import (
    INERTIA_STS3215,
    LIFT_XL330,
    LOCKED,
    RPM,
    SWING_XL330,
    free_speed,
    lifted,
    lifted_sts3215,
    lifting_sts3215,
)

_VOLTAGE = Axis("voltage", "V")
_SPEED = Axis("free speed", "rpm", 1.0 / RPM)
_TORQUE, _CURRENT = Axis("torque", "N·m"), Axis("current", "A")
_INERTIA = Axis("inertia at the horn", "g·m²", 1e3)


def mx(folder: Path) -> list[Comparison]:
    """MX-64 and MX-106."""
    found = []
    for servo in ("64", "106"):
        V, w = free_speed(folder, f"mx{servo}")
        motor = part("robotis", f"MX-{servo} 12 V")
        bands = predicted(motor, "free_speed", [{"voltage": u} for u in V])
        plain = motor["no_load_speed"] * V / motor["nominal_voltage"]
        found.append(against(f"mx{servo}_speed", V, _VOLTAGE, w, _SPEED, bands, plain))
    return found + _lift() + _locked()


def _lift() -> list[Comparison]:
    motor, (V, I, M) = part("robotis", "MX-106 12 V"), lifted()
    at = [{"voltage": u} for u in V]
    share = V / motor["nominal_voltage"]
    loaded = [{"voltage": motor["nominal_voltage"], "load": m} for m in M]
    no_loss = M / (motor["ratio"] * motor["motor_torque_constant"])
    return [
        against("mx106_stall_torque", V, _VOLTAGE, M, _TORQUE, predicted(motor, "stall_torque", at),
                motor["stall_torque"] * share),
        against("mx106_stall_current", V, _VOLTAGE, I, _CURRENT, predicted(motor, "stall_current", at),
                V / motor["resistance"]),
        against("mx106_load_current", M, _TORQUE, I, _CURRENT, predicted(motor, "load_current", loaded), no_loss),
    ]  # fmt: skip


def _locked() -> list[Comparison]:
    motor, (I, V) = part("robotis", "MX-106 12 V"), LOCKED.T
    bands = predicted(motor, "stall_current", [{"voltage": u} for u in V])
    return [against("mx106_locked", V, _VOLTAGE, I, _CURRENT, bands, V / motor["resistance"])]


def xl330(_: Path) -> list[Comparison]:
    """XL330-M288."""
    motor, (duty, supply, M) = part("robotis", "XL330-M288-T 6 V"), LIFT_XL330.T
    V = duty * supply
    bands = predicted(motor, "stall_torque", [{"voltage": u} for u in V])
    plain = motor["stall_torque"] * V / motor["nominal_voltage"]
    one, _parts = sampled(motor, motor["nominal_voltage"])
    at_horn = banded(lambda _: one.drive.inertia * one.drive.ratio**2, np.zeros(1))
    return [
        against("xl330_torque", V, _VOLTAGE, M, _TORQUE, bands, plain),
        against("xl330_inertia", np.zeros(1), Axis("", ""), np.array([SWING_XL330]), _INERTIA, at_horn, np.nan),
    ]


def sts3215(folder: Path) -> list[Comparison]:
    """STS3215 of 12 V."""
    motor, (V, I, M) = part("feetech", "ST-3215-C018"), lifted_sts3215(folder)
    at, share = [{"voltage": u} for u in V], V / motor["nominal_voltage"]
    one, _parts = sampled(motor, motor["nominal_voltage"])
    at_horn = banded(lambda _: one.drive.inertia * one.drive.ratio**2, np.zeros(1))
    large = M > 1.0  # below, the register shows less than a motor without any loss takes
    no_loss = M[large] / (motor["ratio"] * motor["motor_torque_constant"])
    by_torque = predicted(motor, "load_current", [{"load": m} for m in M[large]])
    V_run, M_run, w = lifting_sts3215(folder)
    running = predicted(motor, "load_speed", [{"voltage": u, "load": m} for u, m in zip(V_run, M_run, strict=True)])
    line = motor["no_load_speed"] * (V_run / motor["nominal_voltage"] - M_run / motor["stall_torque"])
    return [
        against("sts3215_torque", V, _VOLTAGE, M, _TORQUE, predicted(motor, "stall_torque", at),
                motor["stall_torque"] * share),
        against("sts3215_current", M[large], _TORQUE, I[large], _CURRENT, by_torque, no_loss),
        against("sts3215_speed", V_run, _VOLTAGE, w, Axis("speed", "rpm", 1.0 / RPM), running, np.maximum(line, 0.0)),
        against("sts3215_inertia", np.zeros(1), Axis("", ""), np.array([INERTIA_STS3215]), _INERTIA, at_horn, np.nan),
    ]  # fmt: skip
