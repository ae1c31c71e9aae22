"""Forces on the output shaft of gearhead or motor over a load cycle.

The force follows the torque at that shaft, moment by moment; where the load drives, the losses of what the shaft
carries lie between, and the force is larger than by the torque. Further forces of ``needs`` are added in the worst
direction. They are the same for all candidates behind one belt; ``shaft_limits`` has their makers' limits.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from drivesizer.catalog.belt_drive import BeltDrive
from drivesizer.loads.kinds import MODULES
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.physics.cycle_at_gearhead import AT_REST, BRAKING, DRIVING, AtGearhead
from drivesizer.physics.elements.belt import pitch_diameter, wrap_angle
from drivesizer.physics.elements.gear_life import mean_load, turned_load
from drivesizer.physics.elements.shaft_load import (
    ROLLER,
    bevel_share,
    pulley_load,
    tooth_shares,
)
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.transmission import BeltStage, GearStage

if TYPE_CHECKING:
    from drivesizer.spec.shaft import Shaft

__all__ = ["THRUST", "Carried", "ShaftLoads", "carried", "shaft_loads"]

THRUST = "screw_axial_force"  # of a load's own limits the one that is no check by itself

Force = Callable[[Any], Any]


class Carried(NamedTuple):
    """Forces of what a shaft carries, by the tangential force [N] that its torque makes."""

    diameter: Any  # m, on which that force acts; NaN unknown
    back: Any = 1.0  # efficiency between torque and force where the load drives
    radial: Force = np.abs
    axial_share: Any = 0.0  # of the tangential force
    thrust: Any = 0.0  # N, at any torque
    least: bool = False  # the radial force is at least this, not known


class ShaftLoads(NamedTuple):
    """Loads of a shaft over one cycle."""

    radial: Any  # N, the largest
    axial: Any  # N
    moment: Any  # N*m, beside that of the radial force
    least: bool  # the radial force is at least this, not known
    forces: tuple[Force, ...]  # these three by the tangential force
    along: Any  # N, tangential force at both ends of each segment
    duration: Any  # s
    speed: Any  # rad/s, at both ends of each segment

    @property
    def mean_speed(self) -> Any:
        """Mean of the amount of the speed, rests included [rad/s]."""
        return turned_load(self.duration, self.along, self.speed, 0.0)

    @property
    def means(self) -> list[Any]:
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


def _strands(shaft: Shaft, angle: float = 0.0) -> dict[str, Any]:
    """Radial force of a belt: without its pretension that of torque alone, which is the least."""
    if shaft.belt_pretension is None:
        return {"radial": np.abs, "least": True}
    pretension = shaft.belt_pretension
    return {"radial": lambda effective: pulley_load(effective, pretension, angle)}


def _pulley(shaft: Shaft, belt: BeltStage, ratio: Any, drive: BeltDrive | None) -> Carried:
    if drive is None:
        diameter = math.nan if belt.pulley_diameter is None else belt.pulley_diameter / ratio
        return Carried(diameter, belt.efficiency, **_strands(shaft))
    teeth, pitch = (drive.driving.teeth, drive.driven.teeth), drive.driving.pitch
    angle = math.pi - float(wrap_angle(*teeth, pitch, drive.centre_distance))
    return Carried(float(pitch_diameter(teeth[0], pitch)), belt.efficiency, **_strands(shaft, angle))


def _teeth(shaft: Shaft, diameter: Any, back: Any, shares: tuple[Any, Any] | None = None) -> Carried:
    radial, axial = shares or tooth_shares(shaft.pressure_angle, shaft.helix_angle)
    return Carried(diameter, back, lambda tangential: radial * tangential, axial)


def _pinion(shaft: Shaft, gear: GearStage) -> Carried:
    diameter = math.nan if gear.pinion_diameter is None else gear.pinion_diameter
    back: Any = gear.fixed_gear().back_efficiency
    back = np.where(np.asarray(back) > 0.0, back, 1.0)
    if gear.kind == "bevel":
        return _teeth(shaft, diameter, back, bevel_share(shaft.pressure_angle, gear.ratio))
    return Carried(diameter, back) if gear.kind == "chain" else _teeth(shaft, diameter, back)


def _of_the_load(spec: RobotSpec, shaft: Shaft, cycle: AtGearhead) -> Carried | None:
    """Pinion, pulley, drum, wheel or screw of the load itself."""
    load: Any = spec.load
    home = MODULES[load.kind]
    if home == "rack_pinion":
        return _teeth(shaft, load.pinion_diameter, load.efficiency)
    if home == "belt_axis":
        return Carried(load.pulley_diameter, load.efficiency, **_strands(shaft))
    if home == "hoist":
        return Carried(load.drum_diameter, load.rope_efficiency)
    if home == "screw":
        thrust = next(one.demand for one in cycle.load_cycle.own if one.name == THRUST)
        return Carried(math.inf, thrust=thrust)
    vehicle: Any = load if isinstance(load, WheeledVehicle) else None
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
    one = carried(spec, cycle, drive) or Carried(math.inf, radial=lambda _: 0.0)
    along = _tangential(cycle, one)
    further = (needs.radial_load, needs.axial_load, needs.tilting_moment)
    forces = _forces(one, *(0.0 if x is None else x for x in further))
    largest = along.max(axis=(0, 1))
    duration, speed = cycle.load_cycle.duration, cycle.base.speed * cycle.belt
    radial, axial, moment = (force(largest) for force in forces)
    return ShaftLoads(radial, axial, moment, one.least, forces, along, duration, speed)


def _tangential(cycle: AtGearhead, one: Carried) -> Any:
    """Force that the torque makes at both ends of each segment; where the load drives, that before the losses."""
    functions = cycle.base.functions
    each = np.moveaxis(functions, 2, 0) if functions.ndim == 3 else functions
    torque = np.abs(each[DRIVING]) + np.abs(each[BRAKING]) / one.back + np.abs(each[AT_REST])
    return torque / cycle.belt / (one.diameter / 2.0)


def _forces(one: Carried, radial: Any, axial: Any, moment: Any) -> tuple[Force, ...]:
    """Radial and axial force, and moment beside the radial force's, by the tangential force and what is added."""
    share, arm = one.axial_share, one.axial_share * one.diameter / 2.0 if np.any(one.axial_share) else 0.0
    return (
        lambda along: one.radial(along) + radial,
        lambda along: share * along + one.thrust + axial,
        lambda along: arm * along + moment,
    )
