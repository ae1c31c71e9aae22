"""A drive by the names of ``layout``: drive train, controller, limits, heat."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import drivesizer.control.engine.layout as at
from drivesizer.control.engine.layout import PARAMETERS, Array
from drivesizer.control.engine.task import Drive, MotorHeat
from drivesizer.control.engine.task_checks import multiples
from drivesizer.control.validation import Gains
from drivesizer.physics.thermal import COPPER, DATA_TEMPERATURE

__all__ = ["STILL", "STILL_WARM", "resistances", "table"]

STILL, STILL_WARM = 1e-12, 1e-9  # change over a sample that is neglected, of full scale; while the resistance changes
_RESTS = 1e-4  # of full speed, below which a motor counts as at rest: what is left is a loop settling
_EVERY, _SLOW = 16.0, 1e4  # periods, and their number in a winding's time constant: steps are met to 2e-9 of a rise
_NODES, _NODE = 24, 20.0  # nodes of temperature, and K between them: the modes are met to 4e-6 of themselves


def table(drive: Drive, top: float, most: int) -> list[float]:
    """A drive as parameters of the simulation."""
    named = parameters(drive, top, most) | controller(drive) | thermal(drive.heat)
    scale = named.get("PKP", 0.0)
    named["TOL_X"] = named["TOL_W"] / scale if scale else math.inf
    named["EVERY"] = _periods(drive.heat, named["H"] * named["N_V"])
    return [named.get(name, 0.0) for name in PARAMETERS]


def _periods(heat: MotorHeat | None, period: float) -> float:
    """Periods after which derivatives of the temperatures follow; one where each is computed in full."""
    brief = heat is not None and heat.brief and heat.bodies.tau_w > _SLOW * period
    return _EVERY if brief else 1.0


def parameters(drive: Drive, top: float, most: int) -> dict[str, float]:
    """Drive train, supply and limits by the names of ``layout``."""
    m, supply, limit = drive.train, drive.supply, drive.current
    volts = supply.voltage if supply.voltage < math.inf else 2.0 * m.back_emf_constant * m.ratio * max(top, 1.0)
    full_i, full_w = volts / m.resistance, volts / m.back_emf_constant
    tight = STILL if drive.heat is None else STILL_WARM
    square = limit.continuous**2
    budget = (limit.peak**2 - square) * limit.peak_time if math.isfinite(square) else math.inf
    return {
        "R25": m.resistance, "K_T": m.torque_constant, "K_E": m.back_emf_constant,
        "J_M": m.motor_inertia, "F_M": m.friction, "F_S": max(m.friction, m.stiction), "B_M": m.viscous,
        "RATIO": m.ratio, "DRIVE": 1.0 / (m.ratio * m.efficiency), "BRAKE": m.efficiency / m.ratio,
        "J_L": m.load_inertia, "B_L": m.load_viscous, "T_F": m.forward_torque, "T_B": m.backward_torque,
        "T_0": m.rest_torque,
        "C": m.stiffness if m.flexible else 0.0, "DAMP": m.damping, "GAP": m.gap, "G_0": 1.0 / m.belt_ratio,
        "G_D": 1.0 / (m.belt_ratio * m.belt_efficiency), "G_B": m.belt_efficiency / m.belt_ratio,
        "TWO": float(m.flexible), "EDGES": drive.encoder.edges, "WINDOW": max(drive.encoder.periods, 1),
        "V_0": supply.voltage, "R_S": supply.resistance, "SETS": supply.sets, "DUTY": supply.max_duty,
        "DROP": supply.voltage_drop, "LOSS": supply.loss, "R_B": supply.stage_resistance, "STANDBY": supply.standby,
        "LEADS": supply.leads, "RAISES": float(supply.raises), "PEAK": limit.peak, "CONT2": square,
        "BUDGET": max(budget, 0.0) if not math.isnan(budget) else math.inf, "MOST": most,
        "TOL_I": tight * full_i, "TOL_W": tight * full_w, "TOL_U": tight * volts, "RESTS": _RESTS * full_w,
        "TOL_F": tight * m.ratio * m.torque_constant * full_i / m.stiffness if m.flexible else math.inf,
    }  # fmt: skip


def controller(drive: Drive) -> dict[str, float]:
    """A controller by the names of ``layout``: gains per sample."""
    c = drive.controller
    if isinstance(c, Gains):
        filtered = c.filter_time + c.period
        return {"H": c.period, "N_V": 1.0, "KP": c.kp, "KI": c.ki * c.period, "KD": c.kd / filtered,
                "KEEP": c.filter_time / filtered, "KEPT": math.exp(-c.period / drive.drain_time)}  # fmt: skip
    n_v, n_p = multiples(c)
    filtered = c.filter_time + c.velocity_period
    return {
        "CASCADE": 1.0, "H": c.current_period, "N_V": n_v, "N_P": n_p, "KP": c.velocity_kp,
        "KI": c.velocity_ki * c.velocity_period, "KD": c.velocity_kd / filtered, "KEEP": c.filter_time / filtered,
        "CKP": c.current_kp, "CKI": c.current_ki * c.current_period, "PKP": c.position_kp if n_p else 0.0,
        "FFV": c.feedforward_velocity, "FFF": c.feedforward_friction, "FFA": c.feedforward_acceleration,
        "DELAY": float(drive.delay), "PROMPT": float(drive.prompt),
        "KEPT": math.exp(-c.velocity_period / drive.drain_time),
    }  # fmt: skip


def thermal(heat: MotorHeat | None) -> dict[str, float]:
    """Winding and housing by the names of ``layout``."""
    if heat is None:
        return {"AMBIENT": DATA_TEMPERATURE}
    b: Any = heat.bodies
    low = min(heat.ambient, *(x for x in (heat.winding, heat.housing) if not math.isnan(x)), heat.ambient)
    return {
        "HEAT": 1.0, "R_1": b.R_th1, "R_2": b.R_th2, "C_W": b.capacity_w, "C_H": b.capacity_h,
        "R_A": b.R_25 * (1.0 + COPPER * (heat.ambient - DATA_TEMPERATURE)), "ALPHA": COPPER * b.R_25,
        "AMBIENT": heat.ambient, "P_0": heat.loss, "P_1": heat.loss_torque, "P_2": heat.loss_viscous,
        "G_1": 1.0 / b.R_th1, "G_2": 1.0 / b.R_th2, "BY_W": 1.0 / b.capacity_w, "BY_H": 1.0 / b.capacity_h,
        "NODE_0": low - heat.ambient - _NODE, "NODE_D": _NODE, "NODES": _NODES,
    }  # fmt: skip


def resistances(p: Array) -> Array:
    """The winding at the nodes of temperature [ohm]; a single one where it does not warm."""
    if not p[at.HEAT]:
        return np.array([p[at.R25]])
    return np.asarray(p[at.R_A] + p[at.ALPHA] * (p[at.NODE_0] + p[at.NODE_D] * np.arange(_NODES)))
