"""Samples of a set, one by one: a machine and a catalogue of its own, by the evaluation that knows no samples."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.machine.problem import problem
from drivesizer.physics.drive_train import COMMUTATION_BAND, back_emf_constant
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.columns.evaluation import Evaluation, evaluate
from drivesizer.search.uncertainty.sampled_drive import SetRows
from drivesizer.search.uncertainty.uncertain_figures import applied, case_paths
from drivesizer.spec.drive import ControllerChoice
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.tolerances import ControllerTolerances, GearheadTolerances, MotorTolerances

FACTORS = {"motor": MotorTolerances, "gearhead": GearheadTolerances, "controller": ControllerTolerances}


def machine_of(spec: RobotSpec, given: Any, values: Any) -> RobotSpec:
    """The machine of one sample."""
    return applied(spec, {path: float(values[k]) - given[k].nominal for k, path in case_paths(spec, None).items()})


def scaled(table: Any, row: int, factors: dict[str, float]) -> Any:
    """A table with some figures of a row times factors."""
    columns = dict(table.columns)
    for name, factor in factors.items():
        columns[name] = columns[name].copy()
        columns[name][row] *= factor
    return replace(table, columns=columns)


def with_shares(motors: Any, row: int, factor: float) -> Any:
    """A table with the friction of a motor printed in two parts."""
    brushed = 0.45 if motors["inside"][row] else 0.65
    nominal = brushed if motors["kind"][row] == "brushed" else 0.37 if motors["winding"][row] == "slotless" else 0.55
    share = 1.0 if np.isnan(motors["no_load_speed"][row]) else min(nominal * factor, 1.0)
    lost = motors["torque_constant"][row] * motors["no_load_current"][row]
    columns = {name: motors[name].copy() for name in ("friction_torque", "viscous_friction")}
    columns["friction_torque"][row] = share * lost
    columns["viscous_friction"][row] = 0.0 if share == 1.0 else (1.0 - share) * lost / motors["no_load_speed"][row]
    return replace(motors, columns=motors.columns | columns)


def peaks_at_stall(parts: Catalog, gearhead: int) -> bool:
    """Whether a gearhead is inside an actuator whose peak torque is its stall torque."""
    row = parts.actuators.rows.get(str(parts.gearheads["inside"][gearhead]), -1)
    return row >= 0 and parts.actuators["peak_torque"][row] == parts.actuators["stall_torque"][row]


def _losing(spec: RobotSpec, table: Any, row: int, factor: float) -> Any:
    """Controllers of which one loses so many times as much: by drop and efficiency, or 1 V where it has neither."""
    one = {name: table[name][row] for name in ("voltage_drop", "max_efficiency", "max_duty", "supply_max", "inside")}
    lost = (1.0 / one["max_efficiency"] - 1.0) * factor
    if np.isnan([one["voltage_drop"], one["max_efficiency"]]).all():
        known = spec.select.estimates == "on" and not one["inside"]
        lost = factor / (one["supply_max"] * np.nan_to_num(one["max_duty"], nan=1.0)) if known else np.nan
    columns = dict(table.columns) | {name: table[name].copy() for name in ("voltage_drop", "max_efficiency")}
    columns["voltage_drop"][row] *= factor
    columns["max_efficiency"][row] = 1.0 / (1.0 + lost)
    return replace(table, columns=columns)


def evaluated(
    spec: RobotSpec, parts: Catalog, one: SetRows, given: Any, values: Any, *, passes: bool = True
) -> tuple[Evaluation, Catalog]:
    """One sample of a set by the plain evaluation: a spec and a catalogue of its own.

    A voltage passes with the most that commutation may take and fails with the least, and the check shows it with that:
    the inductance is such that this end of the band is what the sample takes.
    """
    v = {f"{part}.{figure}": 1.0 for part, section in FACTORS.items() for figure in section.model_fields}
    v |= {assumption.name: value for assumption, value in zip(given, values, strict=True)}
    heats, rubs, k = v["motor.thermal_resistance"], v["motor.friction"], v["motor.torque_constant"]
    e = parts.gearheads["efficiency"][one.gearhead]
    told = np.where(np.arange(len(parts.motors)) == one.motor, back_emf_constant(parts.motors.columns), np.nan)
    motors = replace(parts.motors, columns=parts.motors.columns | {"back_emf_constant": told})
    if np.isnan(motors["friction_torque"][one.motor]):
        motors = with_shares(motors, one.motor, v["motor.dry_friction"])
    catalog = replace(
        parts,
        ends=(),  # at the figures of the sample, not over the bands of what is estimated
        motors=scaled(motors, one.motor, {
            "back_emf_constant": k, "resistance": v["motor.resistance"], "torque_constant": k,
            "no_load_current": rubs / k, "friction_torque": rubs, "viscous_friction": rubs,
            "inductance": v["motor.commutation"] / COMMUTATION_BAND[passes],
            "rotor_inertia": v["motor.rotor_inertia"], "thermal_resistance_winding": heats,
            "thermal_resistance_housing": heats, "winding_time_constant": heats, "motor_time_constant": heats,
        }),
        gearheads=scaled(parts.gearheads, one.gearhead, {
            "efficiency": 1.0 / (1.0 + (1.0 / e - 1.0) * v["gearhead.efficiency"]) / e,
            "intermittent_torque": v["gearhead.peak_torque"] if peaks_at_stall(parts, one.gearhead) else 1.0,
            "no_load_torque": v["gearhead.efficiency"], "inertia": v["gearhead.inertia"],
        }),
        controllers=_losing(spec, parts.controllers, one.controller, v["controller.losses"]),
    )  # fmt: skip
    moved = machine_of(spec, given, values)
    mine = ControllerChoice(part=[str(parts.controllers["part"][one.controller])])
    moved = moved.model_copy(update={"select": moved.select.model_copy(update={"controller": mine})})
    only = Candidates(np.array([one.motor]), np.array([one.gearhead]), np.array([one.belt]), np.array([True]))
    only = only._replace(brake=np.array([one.brake]), encoder=np.array([one.encoder]))
    return evaluate(problem(moved, catalog), only), catalog


def held_alike(plainly: Evaluation, got: dict[str, Any], row: int, size: int) -> None:
    """Demand, limit and verdict of every check: the same to 1e-5, of windings to 1e-3.

    A bus holds what braking leaves of the losses, to 2e-3: both take a winding's resistance as constant over a piece.
    """
    for check in plainly.checks:
        if check.name not in got:
            assert check.name in ("compatibility", "encoder_counts")
            continue
        mine = got[check.name]
        near = {"winding_temperature": 1e-3, "bus_voltage": 2e-3}.get(check.name, 1e-5)
        named = ("limit",) if check.name == "controller_power" and check.limit[0] == np.inf else ("demand", "limit")
        for name in named:  # no sample has a power that nothing limits
            column = np.broadcast_to(getattr(mine, name), size)
            largest = np.abs(column[np.isfinite(column)]).max(initial=0.0)
            np.testing.assert_allclose(
                column[row], getattr(check, name)[0], rtol=near, atol=near * largest, err_msg=check.name
            )
        if not abs(check.margin[0]) < 10 * near:  # else rounding decides
            for name in ("passed", "failed"):
                assert np.broadcast_to(getattr(mine, name), size)[row] == getattr(check, name)[0], check.name
