"""Limits of gearheads and shafts that wear or break: shaft loads, life and shocks, as columns over candidates."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from drivesizer.catalog import DIRECT
from drivesizer.catalog.parts import BeltDrive
from drivesizer.loads import MODULES
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.physics.belt import pitch_diameter, wrap_angle
from drivesizer.physics.cycle_at_gearhead import AT_REST, BRAKING, DRIVING, AtGearhead
from drivesizer.physics.extremes import distinct
from drivesizer.physics.figures import Alike, Array, Figures, Range
from drivesizer.physics.gear_life import (
    ROLLER,
    bearing_life,
    bevel_share,
    dynamic_load,
    gear_life,
    mean_load,
    permissible_radial,
    pulley_load,
    static_load,
    tooth_shares,
    turned_load,
)
from drivesizer.results.check_columns import CheckColumn, at_most
from drivesizer.spec.drive import BeltStage, GearStage
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.sections import required_life

if TYPE_CHECKING:
    from drivesizer.spec.mounting import Shaft


# -- Forces on the output shaft of gearhead or motor over a load cycle.
#
# The force follows the torque at that shaft, moment by moment; where the load drives, the losses of what the shaft
# carries lie between, and the force is larger than by the torque. Further forces of ``needs`` are added in the worst
# direction. They are the same for all candidates behind one belt; ``shaft_limits`` has their makers' limits.


THRUST = "screw_axial_force"  # of a load's own limits the one that is no check by itself

Force = Callable[[Alike], Alike]


class Carried(NamedTuple):
    """Forces of what a shaft carries, by the tangential force [N] that its torque makes."""

    diameter: Alike  # m, on which that force acts; NaN unknown
    back: Alike = 1.0  # efficiency between torque and force where the load drives
    radial: Force = np.abs
    axial_share: Alike = 0.0  # of the tangential force
    thrust: Alike = 0.0  # N, at any torque
    least: bool = False  # the radial force is at least this, not known


class ShaftLoads(NamedTuple):
    """Loads of a shaft over one cycle."""

    radial: Alike  # N, the largest
    axial: Alike  # N
    moment: Alike  # N*m, beside that of the radial force
    least: bool  # the radial force is at least this, not known
    forces: tuple[Force, ...]  # these three by the tangential force
    along: Alike  # N, tangential force at both ends of each segment
    duration: Alike  # s
    speed: Alike  # rad/s, at both ends of each segment

    @property
    def mean_speed(self) -> Alike:
        """Mean of the amount of the speed, rests included [rad/s]."""
        return turned_load(self.duration, self.along, self.speed, 0.0)

    @property
    def means(self) -> list[Alike]:
        """Equivalent means of the three by speed and time, for the life of rollers."""
        mean_speed = self.mean_speed
        return [
            mean_load(turned_load(self.duration, self.along, self.speed, ROLLER, force), mean_speed, ROLLER)
            for force in self.forces
        ]


def carried(spec: RobotSpec, cycle: AtGearhead, drive: BeltDrive | None) -> Carried | None:
    """Forces of what the shaft carries: pulley or pinion of the next stage, or the load; None where none is known."""
    shaft = spec.shaft
    if shaft is None:
        return None
    stage = spec.transmission[1] if len(spec.transmission) > 1 else None
    if isinstance(stage, BeltStage):
        return _pulley(shaft, stage, cycle.belt, drive)
    if isinstance(stage, GearStage):
        return _pinion(shaft, stage)
    return _of_the_load(spec, shaft, cycle) if shaft.carries_load else None


def _strands(shaft: Shaft, angle: float = 0.0) -> dict[str, Alike]:
    """Radial force of a belt: without its pretension that of torque alone, which is the least."""
    if shaft.belt_pretension is None:
        return {"radial": np.abs, "least": True}
    pretension = shaft.belt_pretension
    return {"radial": lambda effective: pulley_load(effective, pretension, angle)}


def _pulley(shaft: Shaft, belt: BeltStage, ratio: Alike, drive: BeltDrive | None) -> Carried:
    if drive is None:
        diameter = math.nan if belt.pulley_diameter is None else belt.pulley_diameter / ratio
        return Carried(diameter, belt.efficiency, **_strands(shaft))
    teeth, pitch = (drive.driving.teeth, drive.driven.teeth), drive.driving.pitch
    angle = math.pi - float(wrap_angle(*teeth, pitch, drive.centre_distance))
    return Carried(float(pitch_diameter(teeth[0], pitch)), belt.efficiency, **_strands(shaft, angle))


def _teeth(shaft: Shaft, diameter: Alike, back: Alike, shares: tuple[Alike, Alike] | None = None) -> Carried:
    radial, axial = shares or tooth_shares(shaft.pressure_angle, shaft.helix_angle)
    return Carried(diameter, back, lambda tangential: radial * tangential, axial)


def _pinion(shaft: Shaft, gear: GearStage) -> Carried:
    diameter = math.nan if gear.pinion_diameter is None else gear.pinion_diameter
    back: Alike = gear.fixed_gear().back_efficiency
    back = np.where(np.asarray(back) > 0.0, back, 1.0)
    if gear.kind == "bevel":
        return _teeth(shaft, diameter, back, bevel_share(shaft.pressure_angle, gear.ratio))
    return Carried(diameter, back) if gear.kind == "chain" else _teeth(shaft, diameter, back)


def _of_the_load(spec: RobotSpec, shaft: Shaft, cycle: AtGearhead) -> Carried | None:
    """Pinion, pulley, drum, wheel or screw of the load itself."""
    load: Alike = spec.load
    home = MODULES[load.kind]
    if home == "rack_pinion":
        return _teeth(shaft, load.pinion_diameter, load.efficiency)
    if home == "belt_axis":
        return Carried(load.pulley_diameter, load.efficiency, **_strands(shaft))
    if home == "hoist":
        return Carried(load.drum_diameter, load.rope_efficiency)
    if home == "screw":
        thrust = next(limit.demand for limit in cycle.load_cycle.own if limit.name == THRUST)
        return Carried(math.inf, thrust=thrust)
    vehicle: Alike = load if isinstance(load, WheeledVehicle) else None
    on_wheel = shaft.wheel_load
    if on_wheel is None and vehicle is not None:
        share = 1.0 if vehicle.driven_share is None else vehicle.driven_share
        on_wheel = share * vehicle.mass * spec.environment.gravity * math.cos(vehicle.slope) / vehicle.driven_wheels
    return Carried(
        2.0 * cycle.load_cycle.radius, radial=lambda along: np.hypot(along, math.nan if on_wheel is None else on_wheel)
    )


def shaft_loads(spec: RobotSpec, cycle: AtGearhead, drive: BeltDrive | None) -> ShaftLoads | None:
    """Loads of the output shaft, of what it carries and of what the spec adds."""
    needs = spec.needs
    if spec.shaft is None and needs.radial_load is needs.axial_load is needs.tilting_moment is None:
        return None
    load = carried(spec, cycle, drive) or Carried(math.inf, radial=lambda _: 0.0)
    along = _tangential(cycle, load)
    further = (needs.radial_load, needs.axial_load, needs.tilting_moment)
    forces = _forces(load, *(0.0 if x is None else x for x in further))
    largest = along.max(axis=(0, 1))
    duration, speed = cycle.load_cycle.duration, cycle.base.speed * cycle.belt
    radial, axial, moment = (force(largest) for force in forces)
    return ShaftLoads(radial, axial, moment, load.least, forces, along, duration, speed)


def _tangential(cycle: AtGearhead, load: Carried) -> Alike:
    """Force that the torque makes at both ends of each segment; where the load drives, that before the losses."""
    functions = cycle.base.functions
    by_function = np.moveaxis(functions, 2, 0) if functions.ndim == 3 else functions
    torque = np.abs(by_function[DRIVING]) + np.abs(by_function[BRAKING]) / load.back + np.abs(by_function[AT_REST])
    return torque / cycle.belt / (load.diameter / 2.0)


def _forces(load: Carried, radial: Alike, axial: Alike, moment: Alike) -> tuple[Force, ...]:
    """Radial and axial force, and moment beside the radial force's, by the tangential force and what is added."""
    share, arm = load.axial_share, load.axial_share * load.diameter / 2.0 if np.any(load.axial_share) else 0.0
    return (
        lambda along: load.radial(along) + radial,
        lambda along: share * along + load.thrust + axial,
        lambda along: arm * along + moment,
    )


STRAIN_WAVE = "strain wave"  # kind of the gears whose teeth can jump
_SLACK = "unknown: the belt's pretension"


def _known(check: CheckColumn, loads: ShaftLoads) -> CheckColumn:
    """A check of radial force: where that is a lower bound it may fail but not pass."""
    if not loads.least:
        return check
    return check.where_known(False)._replace(undecided=_SLACK)


def loads_on_gearheads(
    spec: RobotSpec, cycle: AtGearhead, drive: BeltDrive | None, gearhead: Figures
) -> list[CheckColumn]:
    """Radial and axial load, tilting moment and output bearing of gearheads, as far as the spec requires them."""
    loads = shaft_loads(spec, cycle, drive)
    if loads is None:
        return []
    needed, needs = spec.margins.torque, spec.needs
    checks = []
    if spec.shaft is not None or needs.radial_load is not None:
        limit = _radial_limit(spec, gearhead)
        checks.append(_known(at_most("gearhead_radial_load", loads.radial, limit, needed=needed), loads))
    if _has_thrust(spec, loads):
        checks.append(at_most("gearhead_axial_load", loads.axial, gearhead["max_axial_load"], needed=needed))
    if (spec.shaft is not None and spec.shaft.distance is not None) or needs.tilting_moment is not None:
        checks.append(_known(_tilting(spec, loads, gearhead), loads))
    return checks + _bearing(spec, spec.shaft, loads, gearhead) if spec.shaft else checks


def _has_thrust(spec: RobotSpec, loads: ShaftLoads) -> bool:
    return spec.needs.axial_load is not None or bool(np.any(loads.axial != 0.0))


def _distance(spec: RobotSpec, part: Alike) -> Alike:
    """Distance of the radial force: the spec's, or that of the printed limit."""
    distance = spec.shaft.distance if spec.shaft else None
    return part["radial_load_distance"] if distance is None else distance


def _behind_the_face(gearhead: Figures) -> Alike:
    """Distance of the bearing: printed, or by a tilting moment and the radial load that makes it."""
    by_both = gearhead["max_tilting_moment"] / gearhead["max_radial_load"] - gearhead["radial_load_distance"]
    by_both = np.where(by_both >= 0.0, by_both, np.nan)
    return np.where(np.isnan(gearhead["bearing_distance"]), by_both, gearhead["bearing_distance"])


@np.errstate(divide="ignore", invalid="ignore")
def _radial_limit(spec: RobotSpec, gearhead: Figures) -> Alike:
    """Permissible radial load at the distance; none of its own where the tilting moment decides."""
    limit, moment = gearhead["max_radial_load"], gearhead["max_tilting_moment"]
    if spec.shaft is None or spec.shaft.distance is None:
        return limit
    at, bearing = gearhead["radial_load_distance"], _behind_the_face(gearhead)
    at_distance = permissible_radial(limit, at, spec.shaft.distance, bearing)
    at_distance = np.where(np.isnan(at) & ~np.isnan(moment), limit, at_distance)
    return np.where(np.isnan(limit) & ~np.isnan(moment), np.inf, at_distance)


def _turned(force: Alike, lever: Alike) -> Alike:
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
    turning = Range(*(_turned(loads.radial, outside + end) + loads.moment for end in ends))
    demand = turning.low if known.all() else turning
    return at_most("gearhead_tilting_moment", demand, limit, needed=spec.margins.torque)


@np.errstate(divide="ignore", invalid="ignore")
def _bearing(spec: RobotSpec, shaft: Shaft, loads: ShaftLoads, gearhead: Figures) -> list[CheckColumn]:
    """Static load and life of a printed output bearing; of others the printed radial load or moment stands for it."""
    rated = ~np.isnan(gearhead["max_radial_load"]) | ~np.isnan(gearhead["max_tilting_moment"])
    lever, diameter = _distance(spec, gearhead) + _behind_the_face(gearhead), gearhead["bearing_diameter"]

    def limit(figure: str) -> Alike:
        return np.where(np.isnan(gearhead[figure]) & rated, np.inf, gearhead[figure])

    turning = _turned(loads.radial, lever) + loads.moment
    still = static_load(loads.radial, loads.axial, turning, diameter) * shaft.static_safety
    static, dynamic = limit("bearing_static_load"), limit("bearing_dynamic_load")
    still = np.where(np.isposinf(static), 0.0, still)
    checks = [_known(at_most("gearhead_bearing_static", still, static), loads)]
    required = required_life(spec.needs.life, "output_bearing")
    if required is not None and not spec.once:
        radial, axial, moment = loads.means
        load = dynamic_load(radial, axial, _turned(radial, lever) + moment, diameter) * shaft.load_factor
        life = bearing_life(dynamic, np.where(np.isposinf(dynamic), 0.0, load), loads.mean_speed)
        checks.append(_known(at_most("gearhead_bearing_life", required, life), loads))
    return checks


def loads_on_motors(
    spec: RobotSpec, cycle: AtGearhead, drive: BeltDrive | None, motor: Figures, gearhead: Figures
) -> list[CheckColumn]:
    """Radial and axial load of motors' shafts where no gearhead is between them and the load."""
    loads = shaft_loads(spec, cycle, drive)
    if loads is None:
        return []
    direct, needed, checks = gearhead["kind"] == DIRECT, spec.margins.torque, []
    if spec.shaft is not None or spec.needs.radial_load is not None:
        limit = motor["max_radial_load"]
        if spec.shaft is not None and spec.shaft.distance is not None:
            limit = permissible_radial(limit, motor["radial_load_distance"], spec.shaft.distance, np.nan)
        limit = np.where(direct, limit, np.inf)
        checks.append(_known(at_most("motor_radial_load", loads.radial, limit, needed=needed), loads))
    if _has_thrust(spec, loads):
        limit = np.where(direct, motor["max_axial_load"], np.inf)
        checks.append(at_most("motor_axial_load", loads.axial, limit, needed=needed))
    return checks


def life_of_gearheads(cycle: AtGearhead, gearhead: Figures, rated: str = "rated_life") -> Array:
    """Nominal life of gearheads by their rated life, at rated torque and speed."""
    life, exponent = gearhead[rated], gearhead["life_exponent"]
    speed = np.where(np.isnan(gearhead["rated_speed"]), gearhead["continuous_input_speed"], gearhead["rated_speed"])
    lives = np.full(np.shape(life), np.nan)
    for p in distinct(exponent[~np.isnan(exponent)]).tolist():
        turned = cycle.turned(p) * gearhead["ratio"]
        lives = np.where(exponent == p, gear_life(life, gearhead["continuous_torque"], speed, turned, p), lives)
    return np.where(np.isposinf(life), np.inf, lives)


def shock_limits(spec: RobotSpec, torque: float, cycle: AtGearhead, gearhead: Figures) -> list[CheckColumn]:
    """Torque of an emergency stop or a collision against what gearheads withstand a few times in their life."""
    at_output = torque / (cycle.belt * (spec.gear.ratio if spec.gear else 1.0))
    jumps = np.where(gearhead["kind"] == STRAIN_WAVE, gearhead["ratcheting_torque"], np.inf)
    needed = spec.margins.torque
    return [
        at_most("gearhead_emergency_torque", at_output, gearhead["emergency_torque"], needed=needed),
        at_most("gearhead_ratcheting", at_output, jumps, needed=needed),
    ]
