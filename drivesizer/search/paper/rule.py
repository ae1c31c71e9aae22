"""The paper's selection rule (section 3.1.3): its conditions on gearhead and motor as checks on columns."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer import equations as eq
from drivesizer.catalog import Catalog
from drivesizer.physics.figures import Figures
from drivesizer.results.check_columns import CheckColumn, at_least, at_most
from drivesizer.results.requirement import Requirement
from drivesizer.search.paper.derivation import BRAKING, vehicle
from drivesizer.spec.robot import RobotSpec

__all__ = ["FEW", "hopeless", "largest_allowed", "largest_torque_at_motor", "rule"]

FEW = 4096  # candidates that are kept: variants of a spec have them in common, and more of them take room


def largest_torque(wheel: Mapping[str, Requirement]) -> Any:
    """The largest torque at one wheel by magnitude [N*m]: (11), or downhill that of braking."""
    return wheel.get(BRAKING, wheel["maximum_torque_per_motor"]).value


def largest_torque_at_motor(shaft: Mapping[str, Requirement]) -> Any:
    """The same at the motor, by (18) [N*m]."""
    return shaft.get(f"{BRAKING}_at_motor", shaft["maximum_torque_at_motor"]).value


def _speed_constant(shaft: Mapping[str, Requirement], motor: Figures) -> Any:
    """Least speed constant by (19) and (20): at the end of acceleration or where braking begins.

    Uphill and on level ground it is the first, as printed.
    """
    printed, first = shaft["speed_constant"].value, shaft["no_load_speed"].inputs
    if f"{BRAKING}_at_motor" not in shaft:
        return printed
    braked = eq.no_load_speed(**first | {"M_max_m0": -largest_torque_at_motor(shaft)})
    return np.maximum(np.abs(printed), np.abs(eq.speed_constant(braked, motor["nominal_voltage"])))


def rule(
    spec: RobotSpec,
    wheel: Mapping[str, Requirement],
    shaft: Mapping[str, Requirement],
    motor: Figures,
    gearhead: Figures,
    belt: Any,
) -> list[CheckColumn]:
    """The paper's conditions on gearhead and motor (section 3.1.3), as columns over the candidates."""
    at_gearhead = belt * spec.belt_efficiency
    n_motor = _motor_speed(wheel, gearhead["ratio"], belt)
    torque = wheel["rms_torque_per_motor"].value / at_gearhead, largest_torque(wheel) / at_gearhead
    rms, peak = shaft["rms_torque_at_motor"].value, largest_torque_at_motor(shaft)
    checks = [
        at_most("gearhead_continuous_torque", torque[0], gearhead["continuous_torque"]),
        at_most("gearhead_intermittent_torque", torque[1], gearhead["intermittent_torque"]),
        _input_speed(n_motor, gearhead["continuous_input_speed"]),
        at_least("motor_speed", n_motor, motor["no_load_speed"]),
        at_most("motor_continuous_torque", rms, motor["nominal_torque"]),
        at_most("motor_maximum_torque", peak, motor["stall_torque"]),
        _power(wheel, motor),
        at_least("speed_constant", _speed_constant(shaft, motor), motor["speed_constant"]),
    ]
    if spec.needs.backlash_at_load is not None:
        lost = gearhead["backlash"] / belt
        checks.append(at_most("backlash_at_load", lost, spec.needs.backlash_at_load))
    return checks


def _motor_speed(wheel: Mapping[str, Requirement], ratio: Any, belt: Any) -> Any:
    return wheel["nominal_speed"].value * ratio * belt


def _input_speed(n_motor: Any, limit: Any) -> CheckColumn:
    return at_most("gearhead_input_speed", n_motor, limit)


def _power(wheel: Mapping[str, Requirement], motor: Figures) -> CheckColumn:
    return at_most("motor_power", wheel["rms_power_per_motor"].value, motor["assigned_power"])


def hopeless(
    spec: RobotSpec, catalog: Catalog, motor: NDArray[Any], gearhead: NDArray[Any], belt: NDArray[Any]
) -> NDArray[np.bool_]:
    """Candidates that the rule rejects by figures of one part: no motor for this machine, or a gearhead too fast.

    Without them the others pass and fail as with them: the reductions of a family are compared for each motor, and one
    that turns too fast is none that is allowed.
    """
    wheel, gears = vehicle(spec, catalog.motors["rotor_inertia"]).steps, catalog.gearheads
    found: NDArray[np.bool_] = _power(wheel, catalog.motors).failed[motor]
    left = np.flatnonzero(~found)
    row = gearhead[left]
    n_motor = _motor_speed(wheel, gears["ratio"][row], belt[left])
    found[left] = _input_speed(n_motor, gears["continuous_input_speed"][row]).failed
    return found


def _groups(catalog: Catalog, motor: NDArray[Any], gearhead: NDArray[Any]) -> NDArray[np.int64]:
    """Number of each candidate's motor and gearhead family among those that there are, from 0."""
    families = catalog.once("families", lambda: np.unique(catalog.gearheads["family"], return_inverse=True)[1])
    group = motor.astype(np.int64) * (families.max(initial=0) + 1) + families[gearhead]
    found: NDArray[np.int64] = np.unique(group, return_inverse=True)[1]
    return found


def largest_allowed(
    catalog: Catalog, motor: NDArray[Any], gearhead: NDArray[Any], total: NDArray[Any], gear: list[CheckColumn]
) -> CheckColumn:
    """The rule that one reduction remains per motor and gearhead family: the largest that is allowed."""
    allowed = np.logical_and.reduce([check.passed for check in gear])
    possible = ~np.logical_or.reduce([check.failed for check in gear])
    key, of = "families of candidates", (motor, gearhead)
    group = catalog.once(key, lambda: _groups(catalog, *of), of) if len(motor) <= FEW else _groups(catalog, *of)
    largest = np.full(group.max(initial=-1) + 1, -np.inf)
    np.maximum.at(largest, group[allowed], total[allowed])
    doubtful = possible & ~np.isfinite(largest[group])
    np.maximum.at(largest, group[doubtful], total[doubtful])
    required = np.where(np.isfinite(largest[group]), largest[group], total)
    return at_least("largest_reduction", required, total, by_choice=True)
