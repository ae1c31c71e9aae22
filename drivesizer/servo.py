"""The closed loop of a servo cascade: a set driven through a profile by current, velocity and position loops.

Puts together ``cascade_design`` (gains), ``loop_analysis`` (what linear theory says), ``engine`` (the march: sampled,
limited, warming) and ``servo_verdict`` (what it means). What is taken for granted is said with the result.
"""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from typing import Any, NamedTuple

import numpy as np

from drivesizer.cascade import Cascade, controller_gains, rates
from drivesizer.cascade_design import Wanted, design_cascade
from drivesizer.catalog import EDGES
from drivesizer.choose import usable_in
from drivesizer.engine import CurrentLimit, Drive, Encoder, Heat, Marched, Supply, Task, march
from drivesizer.errors import InputError
from drivesizer.linear_modes import Machine, machine_of
from drivesizer.loop_analysis import analyse_cascade
from drivesizer.loop_plant import Shaft
from drivesizer.loops import Loops
from drivesizer.physics_limits import housing_loss
from drivesizer.plant import DriveTrain, drive_train, within_reach
from drivesizer.profile import Profile
from drivesizer.results import DriveSet
from drivesizer.spec import RobotSpec
from drivesizer.thermal import TwoBodies, two_bodies

__all__ = ["ServoCase", "own_units", "run"]

_ROUNDS = 3  # of the search for the periodic temperatures
_NUDGE = 1.0  # K, by which starts differ to see what a cycle makes of them
_FOUND = 0.05  # K


class ServoCase(NamedTuple):
    """A march in closed loop and all that it was made of."""

    spec: RobotSpec
    drive_set: DriveSet
    profile: Profile
    train: DriveTrain
    cascade: Cascade
    shaft: Shaft | None
    loops: Loops
    usable_voltage: float  # V, NaN unknown
    out: Marched  # from cold
    periodic: dict[str, float]  # highest temperatures over the cycle repeated for ever [K]; empty: unknown
    said: tuple[str, ...]  # what was assumed on the way

    def figure(self, name: str) -> float:
        """A figure of the march, SI."""
        return float(self.out.figures[name][0])


def run(spec: RobotSpec, drive_set: DriveSet, asked: Profile) -> ServoCase:
    """Design a cascade for a set, analyse its loops and march it along a profile.

    Raises
    ------
    InputError
        When gains exclude each other, the bandwidth is out of reach, a figure that the model needs is missing, or the
        loop leaves the range of numbers.
    """
    every, said = rates(drive_set.controller)
    train, assumed = drive_train(spec, drive_set, every.current)
    within_reach(train, asked)
    cascade, designed = design_cascade(train, every, _wanted(spec), where=lambda field: spec.where(_path(field)))
    shaft = _shaft(spec, train)
    usable = usable_in(spec, drive_set.controller)
    machine = _machine(spec, drive_set, train, shaft)
    heat = _heat(spec, drive_set, asked.top_speed * train.motor_per_speed) if spec.plant.warming else None
    drive = _drive(spec, drive_set, machine, cascade, heat, usable)
    task = Task(time=asked.time, speed=tuple(v / train.radius for v in asked.speed))
    out = march(drive, task)
    if out.problems[0]:
        wanted = "a shorter profile" if "steps" in out.problems[0] else "other gains"
        raise InputError(f"profile {asked.name}: {out.problems[0]}; expected {wanted}")
    return ServoCase(
        spec, drive_set, asked, train, cascade, shaft, analyse_cascade(train, cascade, shaft), usable, out,
        _periodic(drive, task, out), (*said, *assumed, *designed),
    )  # fmt: skip


def _wanted(spec: RobotSpec) -> Wanted:
    """What the spec gives of the cascade."""
    c = spec.control
    given: dict[str, Any] = {f"current_{name}": getattr(c.current, name) for name in ("kp", "ki")}
    given |= {f"velocity_{name}": getattr(c.velocity, name) for name in ("kp", "ki", "kd")}
    given |= {name: getattr(c.velocity, name) for name in ("filter_time", "bandwidth", "damping", "phase_margin")}
    given |= {f"feedforward_{name}": value for name, value in c.feedforward.model_dump().items()}
    return Wanted(position=c.position is not None, position_kp=c.position.kp if c.position else None, **given)


def _path(field: str) -> tuple[str, ...]:
    """Where a field of ``Wanted`` stands in the spec."""
    section, _, name = field.partition("_")
    if section in ("current", "velocity", "position", "feedforward"):
        return "control", section, name
    return "control", "velocity", field


def _shaft(spec: RobotSpec, train: DriveTrain) -> Shaft | None:
    """What is elastic between motor and load, as the spec says; none of a rigid model."""
    if spec.plant.model == "rigid":
        return None
    stiffness = spec.plant.stiffness or (spec.belt.stiffness if spec.belt else None)
    if stiffness is None:
        where = spec.where(("plant", "model"))
        raise InputError(f"{where}: two_mass needs plant.stiffness or the belt's, e.g. stiffness: 500 N*m/rad")
    damping = 2.0 * spec.plant.damping_ratio * math.sqrt(stiffness * train.load_inertia)
    return Shaft(stiffness=stiffness, damping=damping)


def _drive(
    spec: RobotSpec, drive_set: DriveSet, machine: Machine, cascade: Cascade, heat: Heat | None, usable: float
) -> Drive:
    """The set as the engine takes it; an unknown limit is none there, and unknown in its check."""
    controller, known = drive_set.controller, not math.isnan(usable)

    def limit(name: str) -> float:
        value = getattr(controller, name) if controller else math.nan
        return math.inf if math.isnan(value) else float(value)

    counted = spec.control.speed_from == "counts" and drive_set.encoder is not None
    lines = drive_set.encoder.lines if counted and drive_set.encoder else math.nan
    return Drive(
        machine=machine,
        controller=cascade,
        supply=Supply(
            voltage=spec.supply.lowest, resistance=spec.supply.resistance or 0.0, sets=spec.load.motors,
            max_duty=controller.max_duty if controller and known else 1.0,
            voltage_drop=controller.voltage_drop if controller and known else 0.0,
        ),
        current=CurrentLimit(
            peak=limit("peak_current"), continuous=limit("continuous_current"), peak_time=limit("peak_time")
        ),
        encoder=Encoder(edges=0 if math.isnan(lines) else round(EDGES * lines)),
        heat=heat,
    )  # fmt: skip


def _machine(spec: RobotSpec, drive_set: DriveSet, train: DriveTrain, shaft: Shaft | None) -> Machine:
    machine = machine_of(train)
    if shaft is None:
        return machine
    own = drive_set.gearhead.backlash / drive_set.belt_ratio
    gap = spec.plant.backlash if spec.plant.backlash is not None else own
    return replace(
        machine, stiffness=shaft.stiffness, damping=shaft.damping, gap=0.0 if math.isnan(gap) else float(gap)
    )


def _heat(spec: RobotSpec, drive_set: DriveSet, top: float) -> Heat | None:
    """Winding and housing; None where a thermal figure is unknown.

    What friction and iron lose warms the housing: by the speed; what grows with its square counts as at the motor's
    top speed [rad/s].
    """
    figures = asdict(drive_set.motor)
    bodies: TwoBodies = two_bodies(figures)
    if not bodies.known:
        return None
    rubbing, iron = (float(x[0]) for x in housing_loss(figures, np.ones(1)))
    loss = rubbing + iron * top
    return Heat(bodies=bodies, ambient=spec.environment.ambient, loss_torque=loss if loss > 0.0 else 0.0)


def _periodic(drive: Drive, task: Task, out: Marched) -> dict[str, float]:
    """Highest temperatures over the cycle repeated for ever [K].

    A cycle makes of two starting temperatures two at its end, nearly affinely: its fixed point is sought by Newton's
    method, with differences of 1 K.
    """
    if drive.heat is None:
        return {}
    heat, end = drive.heat, _ends(out)
    start = np.array([heat.ambient, heat.ambient])
    for _ in range(_ROUNDS):
        slopes = np.column_stack([
            (_ends(march(_from(drive, start + _NUDGE * unit), task, rows=0)) - end) / _NUDGE for unit in np.eye(2)
        ])  # fmt: skip
        step = np.linalg.solve(np.eye(2) - slopes, end - start)
        start = start + step
        if not np.isfinite(start).all() or start.max() > 2000.0 or np.abs(np.linalg.eigvals(slopes)).max() >= 1.0:
            return {"winding": math.inf, "housing": math.inf}  # it runs away
        last = march(_from(drive, start), task, rows=0)
        end = _ends(last)
        if np.abs(end - start).max() < _FOUND:
            break
    return {name: float(last.figures[f"{name}_highest"][0]) for name in ("winding", "housing")}


def _from(drive: Drive, start: Any) -> Drive:
    assert drive.heat is not None
    return replace(drive, heat=replace(drive.heat, winding=float(start[0]), housing=float(start[1])))


def _ends(out: Marched) -> Any:
    return np.array([out.figures["winding"][0], out.figures["housing"][0]])


def own_units(case: ServoCase) -> tuple[tuple[Any, ...], list[str]]:
    """The gains as the chosen controller takes them, where its units are known."""
    controller = case.drive_set.controller
    return controller_gains(case.cascade, controller.family) if controller else ((), [])
