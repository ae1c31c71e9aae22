"""Limits of gearheads and shafts that wear or break: shaft loads, life and shocks, as columns over candidates."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import DIRECT
from drivesizer.catalog.belt_drive import BeltDrive
from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.elements.gear_life import gear_life
from drivesizer.physics.elements.shaft_load import bearing_life, dynamic_load, permissible_radial, static_load
from drivesizer.physics.extremes import distinct
from drivesizer.physics.figures import Figures
from drivesizer.results.check_columns import CheckColumn, at_most, between
from drivesizer.search.columns.shaft_loads import ShaftLoads, shaft_loads
from drivesizer.spec.lives import required_life
from drivesizer.spec.robot import RobotSpec

if TYPE_CHECKING:
    from drivesizer.spec.shaft import Shaft

__all__ = ["life_of_gearheads", "loads_on_gearheads", "loads_on_motors", "shock_limits"]

STRAIN_WAVE = "strain wave"  # kind of the gears whose teeth can jump
_SLACK = "unknown: the belt's pretension"


def _known(check: CheckColumn, loads: ShaftLoads) -> CheckColumn:
    """A check of radial force: where that is a lower bound it may fail but not pass."""
    if not loads.least:
        return check
    return replace(check, passed=check.passed & np.isposinf(check.limit), undecided=_SLACK)


def loads_on_gearheads(
    spec: RobotSpec, cycle: AtGearhead, drive: BeltDrive | None, gearhead: Figures
) -> list[CheckColumn]:
    """Radial and axial load, tilting moment and output bearing of gearheads, as far as the spec requires them."""
    loads = shaft_loads(spec, cycle, drive)
    if loads is None:
        return []
    needed, needs = spec.margins.torque, spec.needs
    found = []
    if spec.shaft is not None or needs.radial_load is not None:
        limit = _radial_limit(spec, gearhead)
        found.append(_known(at_most("gearhead_radial_load", loads.radial, limit, needed=needed), loads))
    if _has_thrust(spec, loads):
        found.append(at_most("gearhead_axial_load", loads.axial, gearhead["max_axial_load"], needed=needed))
    if (spec.shaft is not None and spec.shaft.distance is not None) or needs.tilting_moment is not None:
        found.append(_known(_tilting(spec, loads, gearhead), loads))
    return found + _bearing(spec, spec.shaft, loads, gearhead) if spec.shaft else found


def _has_thrust(spec: RobotSpec, loads: ShaftLoads) -> bool:
    return spec.needs.axial_load is not None or bool(np.any(loads.axial != 0.0))


def _distance(spec: RobotSpec, part: Any) -> Any:
    """Distance of the radial force: the spec's, or that of the printed limit."""
    given = spec.shaft.distance if spec.shaft else None
    return part["radial_load_distance"] if given is None else given


def _behind_the_face(gearhead: Figures) -> Any:
    """Distance of the bearing: printed, or by a tilting moment and the radial load that makes it."""
    by_both = gearhead["max_tilting_moment"] / gearhead["max_radial_load"] - gearhead["radial_load_distance"]
    by_both = np.where(by_both >= 0.0, by_both, np.nan)
    return np.where(np.isnan(gearhead["bearing_distance"]), by_both, gearhead["bearing_distance"])


@np.errstate(divide="ignore", invalid="ignore")
def _radial_limit(spec: RobotSpec, gearhead: Figures) -> Any:
    """Permissible radial load at the distance; none of its own where the tilting moment decides."""
    limit, moment = gearhead["max_radial_load"], gearhead["max_tilting_moment"]
    if spec.shaft is None or spec.shaft.distance is None:
        return limit
    at, bearing = gearhead["radial_load_distance"], _behind_the_face(gearhead)
    moved = permissible_radial(limit, at, spec.shaft.distance, bearing)
    moved = np.where(np.isnan(at) & ~np.isnan(moment), limit, moved)
    return np.where(np.isnan(limit) & ~np.isnan(moment), np.inf, moved)


def _turned(force: Any, lever: Any) -> Any:
    """Moment of a force; none without a force, wherever it is."""
    return np.where(np.asarray(force) == 0.0, 0.0, force * lever)


@np.errstate(divide="ignore", invalid="ignore")
def _tilting(spec: RobotSpec, loads: ShaftLoads, gearhead: Figures) -> CheckColumn:
    """Moment about the output bearing; its distance is within bounds where it is not printed."""
    limit, radial = gearhead["max_tilting_moment"], gearhead["max_radial_load"]
    limit = np.where(np.isnan(limit) & ~np.isnan(radial), np.inf, limit)
    bearing, outside = _behind_the_face(gearhead), _distance(spec, gearhead)
    known = ~np.isnan(bearing) | (np.asarray(loads.radial) == 0.0)
    ends = (np.where(known, np.nan_to_num(bearing), far) for far in (0.0, gearhead["max_tilting_moment"] / radial))
    turning = (_turned(loads.radial, outside + end) + loads.moment for end in ends)
    checks = [at_most("gearhead_tilting_moment", x, limit, needed=spec.margins.torque) for x in turning]
    return checks[0] if known.all() else between(*checks)


@np.errstate(divide="ignore", invalid="ignore")
def _bearing(spec: RobotSpec, shaft: Shaft, loads: ShaftLoads, gearhead: Figures) -> list[CheckColumn]:
    """Static load and life of a printed output bearing; of others the printed radial load or moment stands for it."""
    rated = ~np.isnan(gearhead["max_radial_load"]) | ~np.isnan(gearhead["max_tilting_moment"])
    lever, diameter = _distance(spec, gearhead) + _behind_the_face(gearhead), gearhead["bearing_diameter"]

    def limit(figure: str) -> Any:
        return np.where(np.isnan(gearhead[figure]) & rated, np.inf, gearhead[figure])

    turning = _turned(loads.radial, lever) + loads.moment
    still = static_load(loads.radial, loads.axial, turning, diameter) * shaft.static_safety
    static, dynamic = limit("bearing_static_load"), limit("bearing_dynamic_load")
    still = np.where(np.isposinf(static), 0.0, still)
    found = [_known(at_most("gearhead_bearing_static", still, static), loads)]
    required = required_life(spec.needs.life, "output_bearing")
    if required is not None:
        radial, axial, moment = loads.means
        load = dynamic_load(radial, axial, _turned(radial, lever) + moment, diameter) * shaft.load_factor
        life = bearing_life(dynamic, np.where(np.isposinf(dynamic), 0.0, load), loads.mean_speed)
        found.append(_known(at_most("gearhead_bearing_life", required, life), loads))
    return found


def loads_on_motors(
    spec: RobotSpec, cycle: AtGearhead, drive: BeltDrive | None, motor: Figures, gearhead: Figures
) -> list[CheckColumn]:
    """Radial and axial load of motors' shafts where no gearhead is between them and the load."""
    loads = shaft_loads(spec, cycle, drive)
    if loads is None:
        return []
    direct, needed, found = gearhead["kind"] == DIRECT, spec.margins.torque, []
    if spec.shaft is not None or spec.needs.radial_load is not None:
        limit = motor["max_radial_load"]
        if spec.shaft is not None and spec.shaft.distance is not None:
            limit = permissible_radial(limit, motor["radial_load_distance"], spec.shaft.distance, np.nan)
        limit = np.where(direct, limit, np.inf)
        found.append(_known(at_most("motor_radial_load", loads.radial, limit, needed=needed), loads))
    if _has_thrust(spec, loads):
        limit = np.where(direct, motor["max_axial_load"], np.inf)
        found.append(at_most("motor_axial_load", loads.axial, limit, needed=needed))
    return found


def life_of_gearheads(cycle: AtGearhead, gearhead: Figures, rated: str = "rated_life") -> NDArray[np.float64]:
    """Nominal life of gearheads by their rated life, at rated torque and speed."""
    life, exponent = gearhead[rated], gearhead["life_exponent"]
    speed = np.where(np.isnan(gearhead["rated_speed"]), gearhead["continuous_input_speed"], gearhead["rated_speed"])
    found = np.full(np.shape(life), np.nan)
    for p in distinct(exponent[~np.isnan(exponent)]).tolist():
        turned = cycle.turned(p) * gearhead["ratio"]
        found = np.where(exponent == p, gear_life(life, gearhead["continuous_torque"], speed, turned, p), found)
    return np.where(np.isposinf(life), np.inf, found)


def shock_limits(spec: RobotSpec, torque: float, cycle: AtGearhead, gearhead: Figures) -> list[CheckColumn]:
    """Torque of an emergency stop or a collision against what gearheads withstand a few times in their life."""
    at_output = torque / (cycle.belt * (spec.gear.ratio if spec.gear else 1.0))
    jumps = np.where(gearhead["kind"] == STRAIN_WAVE, gearhead["ratcheting_torque"], np.inf)
    needed = spec.margins.torque
    return [
        at_most("gearhead_emergency_torque", at_output, gearhead["emergency_torque"], needed=needed),
        at_most("gearhead_ratcheting", at_output, jumps, needed=needed),
    ]
