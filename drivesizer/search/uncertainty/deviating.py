"""A drive with the figures of one sample."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from drivesizer.physics.drive_train import back_emf_constant
from drivesizer.physics.power_stage import with_stage_losses
from drivesizer.results.drive_set import DriveParts
from drivesizer.search.uncertainty.sampled_parts import motor_factors, with_dry_share, with_losses
from drivesizer.spec.robot import RobotSpec

__all__ = ["deviating_drive"]

Factors = Mapping[str, Mapping[str, float]]  # by part, then by figure; 1 where one is missing


def deviating_drive(one: DriveParts, spec: RobotSpec, factors: Factors) -> DriveParts:
    """A drive whose figures deviate from those of the catalogue."""
    of_gearhead = factors["gearhead"]
    losses, gains = (of_gearhead.get(name, 1.0) for name in ("efficiency", "inertia"))
    gearhead = replace(
        one.gearhead, **_times(one.gearhead, {"inertia": gains, "no_load_torque": losses}),
        efficiency=with_losses(one.gearhead.efficiency, losses),
    )  # fmt: skip
    motor = _stepper(one, factors) if one.steps else _motor(one, factors["motor"])
    controller = _controller(one, spec, factors["controller"])
    return replace(one, motor=motor, gearhead=gearhead, controller=controller, belt_efficiency=spec.belt_efficiency)


def _motor(one: DriveParts, factors: Mapping[str, float]) -> Any:
    bought = replace(one.motor, back_emf_constant=float(back_emf_constant(one.motor)))
    varied = _times(bought, motor_factors(factors)) | with_dry_share(bought, factors)
    return replace(bought, **varied)


def _stepper(one: DriveParts, factors: Factors) -> Any:
    """A stepper with the current that its driver really gives."""
    times = {name: factors["motor"].get(name, 1.0) for name in ("resistance", "inductance", "rotor_inertia")}
    times["nominal_current"] = factors["controller"].get("phase_current", 1.0)
    return replace(one.motor, **_times(one.motor, times))


def _controller(one: DriveParts, spec: RobotSpec, factors: Mapping[str, float]) -> Any:
    controller, more = one.controller, factors.get("losses")
    if not controller or not more:
        return controller
    stage = with_stage_losses(controller, more, assume=spec.select.estimates == "on")
    volts, efficiency = float(stage["voltage_drop"]), float(stage["max_efficiency"])
    return replace(controller, voltage_drop=volts, max_efficiency=efficiency)


def _times(part: Any, factors: Mapping[str, float]) -> dict[str, Any]:
    return {name: getattr(part, name) * factor for name, factor in factors.items()}
