"""Sections of a spec that contradict each other: what is refused where each of them by itself is right."""

from __future__ import annotations

from typing import Any

from drivesizer.loads.kinds import MODULES
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.spec.lives import Lives
from drivesizer.spec.motions import Track, Waypoints
from drivesizer.spec.transmission import DIRECT, DirectStage, GearheadStage

__all__ = ["PAPER_TREATS", "refuse_contradictions"]

PAPER_TREATS = (
    "the paper treats a wheeled_vehicle without wind on a trapezoid that decelerates as it accelerates, in one case"
)

_MOST_SHARED = 0.999  # of the time, that load cases may take of the machine as specified
_OVERHUNG = ("wheeled_vehicle", "rack_pinion", "belt_axis", "hoist", "lead_screw", "ball_screw")


def refuse_contradictions(spec: Any) -> None:
    """Raise the first contradiction between sections of a ``RobotSpec`` as a ValueError that names the field."""
    for agree in (
        _chained, _mounted, _moved, _motor_kind_conflicts, _wheel_conflicts,
        _burning, _overhung, _lasting, _equipped, _braked, _alternating, _required,
    ):  # fmt: skip
        agree(spec)


def _chained(spec: Any) -> None:
    """Stages behind each other as machines have them."""
    kinds = [stage.kind for stage in spec.transmission]
    behind = ["belt" if kind == "belt" else "gear" for kind in kinds[1:]]
    if (
        not isinstance(spec.transmission[0], GearheadStage | DirectStage)
        or len(set(behind)) != len(behind)
        or ({"gearhead", DIRECT} & set(kinds[1:]))
    ):
        raise ValueError(
            "transmission must be a gearhead or direct, or one of them and then a belt, a gear, or one of each"
        )
    _check_gear(spec)
    named = spec.select.gearhead.named.values()
    if spec.is_direct and {name for names in named for name in names} - {DIRECT}:
        raise ValueError(f"select: with kind: {DIRECT} as transmission there is none; leave gearhead out")


def _check_gear(spec: Any) -> None:
    """Refuse a gear where nothing behind it would know of it."""
    gear, belt = spec.gear, spec.belt
    if gear is None:
        return
    if spec.platform is not None:
        raise ValueError(f"transmission: a {gear.kind} drives no wheel of a platform; expected a gearhead or belt")
    if not spec.gear_before_belt or belt is None:
        return
    if gear.has_own_torque and belt.ratio is None:
        raise ValueError(
            f"transmission: inertia and friction of a {gear.kind} before a belt need the one ratio of the belt; "
            "expected ratio, or the belt before it"
        )
    if belt.pulleys is not None and (belt.max_tension or belt.max_speed):
        raise ValueError(
            f"transmission: max_tension and max_speed of pulleys behind a {gear.kind} are not checked; expected "
            "the belt before it, or ratio with pulley_diameter"
        )


def _mounted(spec: Any) -> None:
    """A mounting where heat is computed."""
    if spec.mounting is not None and spec.steps:
        raise ValueError("mounting: the heat of steppers is not computed; leave it out")
    if spec.mounting is not None and spec.method == "paper":
        raise ValueError("mounting: the paper's method knows no heat; leave it out, or method: physics")


def _moved(spec: Any) -> None:
    """A motion that the load takes."""
    recorded = spec.load.kind == "recorded"
    if recorded and spec.motion is not None:
        raise ValueError("motion: a recorded load brings its own motion; leave this one out")
    if not recorded and spec.motion is None:
        raise ValueError("motion is missing; expected fields such as speed, acceleration_time, cruise_time")
    if spec.carries and (spec.platform is not None or not spec.load.takes_payload):
        what = "platform" if spec.platform else spec.load.kind
        raise ValueError(f"motion: a {what} takes no payload that changes; expected load cases")


def _motor_kind_conflicts(spec: Any) -> None:
    """Fields of steppers and of the paper's method where they are."""
    if spec.needs.start_speed is not None and not spec.steps:
        raise ValueError("needs.start_speed: it is of steppers; expected select: {motor: {kind: stepper}}")
    own = {"microsteps", "phase_current", "idle_current", "damping_ratio"} & spec.control.model_fields_set
    if own and not spec.steps:
        raise ValueError(f"control.{min(own)}: it is of steppers; expected select: {{motor: {{kind: stepper}}}}")
    if foreign := spec.tolerances.foreign(steps=spec.steps):
        raise ValueError(foreign)
    if spec.method == "paper" and spec.steps:
        raise ValueError("method: the paper treats DC motors, no steppers; expected method: physics")
    if spec.method == "paper" and not spec.paper_applies:
        raise ValueError(f"method: {PAPER_TREATS}; expected method: physics")


def _wheel_conflicts(spec: Any) -> None:
    """A platform on the wheels of its load."""
    if spec.platform is None:
        if isinstance(spec.motion, Track | Waypoints):
            raise ValueError("motion: a trajectory moves a platform; expected a section platform with its wheels")
        return
    if not isinstance(spec.load, WheeledVehicle):
        raise ValueError("platform: it stands on the wheels of a load of kind wheeled_vehicle; leave it out")
    driven, wanted = sum(place.driven for place in spec.platform.places), spec.load.driven_wheels
    if driven != wanted:
        raise ValueError(
            f"platform: {driven} of its wheels are driven; expected as many as load.driven_wheels, {wanted}"
        )
    if spec.load.driven_share is not None:
        raise ValueError("load.driven_share: each wheel's share follows from the platform; leave it out")
    if not sum(payload.mass for payload in spec.platform.payloads) < spec.load.mass:
        raise ValueError("platform: expected payloads that leave some of load.mass, which includes them")


def _burning(spec: Any) -> None:
    """A brake resistor that burns what nothing else takes."""
    section = spec.brake_resistor
    if section is None:
        return
    if spec.battery is not None or spec.supply.kind == "battery":
        raise ValueError("brake_resistor: the battery takes what is regenerated; leave one of them out")
    if section.chopper_voltage is not None and section.chopper_voltage <= spec.supply.nominal:
        raise ValueError(
            f"brake_resistor: a chopper at {section.chopper_voltage:g} V burns what the supply delivers; "
            f"expected chopper_voltage above nominal, {spec.supply.nominal:g} V"
        )


def _overhung(spec: Any) -> None:
    """A shaft on which something acts."""
    shaft, stages, needs = spec.shaft, spec.transmission, spec.needs
    if shaft is None:
        return
    carries = shaft.carries_load
    if carries and len(stages) > 1:
        raise ValueError(f"shaft.carries_load: the {stages[1].kind} is on this shaft, not the load; leave it out")
    if carries and spec.load.kind not in _OVERHUNG:
        raise ValueError(
            f"shaft.carries_load: a {spec.load.kind} has no known force on its shaft; expected needs.radial_load"
        )
    if carries and spec.platform is not None and shaft.wheel_load is None:
        raise ValueError("shaft: expected wheel_load, for loads on the wheels of a platform differ")
    if not carries and len(stages) == 1 and needs.radial_load is needs.axial_load is needs.tilting_moment is None:
        raise ValueError("shaft: nothing acts on it; expected carries_load, a belt or gear, or needs.radial_load")


def _lasting(spec: Any) -> None:
    """Lives of what there is."""
    lives, load = spec.needs.life, spec.load
    if not isinstance(lives, Lives):
        return
    if lives.screw is not None and MODULES[load.kind] != "screw":
        raise ValueError(f"needs.life.screw: a {load.kind} has no screw; leave it out")
    if lives.screw is not None and getattr(load, "screw", None) is getattr(load, "dynamic_load", None) is None:
        raise ValueError("needs.life.screw: it follows from a ball screw's rating; expected load.dynamic_load")
    if spec.is_direct and (lives.gearhead or lives.output_bearing) is not None:
        raise ValueError(f"needs.life: with kind: {DIRECT} as transmission there is no gearhead; leave it out")
    if lives.output_bearing is not None and spec.shaft is None:
        raise ValueError("needs.life.output_bearing: nothing is known to load it; expected a section shaft")


def _equipped(spec: Any) -> None:
    """Equipment on a battery."""
    if spec.equipment and spec.battery is None:
        raise ValueError("equipment: it draws from a battery; expected a section battery")
    for one in spec.equipment:
        try:
            one.share(spec.mission.duration if spec.mission else None)
        except ValueError as error:
            raise ValueError(f"equipment: {error}") from None


def _braked(spec: Any) -> None:
    """One brake, and one that closes at rest where there is one."""
    if spec.control.at_rest == "brake" and not spec.wants_brake:
        raise ValueError("control.at_rest: there is no brake; expected needs: {hold_unpowered: true}, or a brake")
    if spec.brake and spec.select.brake.named:
        raise ValueError("brake: it has figures of its own; expected brake or select.brake, not both")


def _alternating(spec: Any) -> None:
    """Load cases that share the time."""
    shares = [case.share for case in spec.cases if case.share is not None]
    if not shares:
        return
    if sum(shares) > _MOST_SHARED:
        raise ValueError(f"cases: their shares are {100.0 * sum(shares):g} % together; expected less than 100 %")
    motions = [motion for case in spec.cases if case.share is not None for motion in case.motion]
    if isinstance(spec.motion, Track | Waypoints) or {"trajectory", "waypoints"} & {*motions}:
        raise ValueError("cases: wheels of a platform on a trajectory do not alternate; leave share out")


def _required(spec: Any) -> None:
    """A distance of what travels."""
    if spec.requirements and spec.requirements.travel and not isinstance(spec.load, WheeledVehicle):
        raise ValueError(f"requirements.travel: a {spec.load.kind} does not travel; leave it out, or give speed")
