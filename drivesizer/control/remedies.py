"""Changes of a spec that may let a drive pass in its loop: smoother ramps, another bandwidth, finer steps.

Each is written as one enters it, and made of what is written: what is tried is what is printed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

from drivesizer.control.validation import Stepping, Validation
from drivesizer.load_cases.profile import profile_of
from drivesizer.loads.motions import Move, SCurve, Trapezoid, Triangle
from drivesizer.spec.drive import Control, VelocityLoop
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show, to_si

CALM = 16  # microsteps with which a stepper's swings are small
_JERK_TIME = 0.25  # of a straight ramp
_FOLLOWING = {"tracking_error", "bandwidth"}  # checks that a faster loop may pass; the others a slower one
_GAINS = ("kp", "ki", "kd")
_UNITS = {
    "linear": {
        "distance": ("length", "m"), "speed": ("speed", "m/s"), "acceleration": ("acceleration", "m/s^2"),
        "jerk": ("jerk", "m/s^3"),
    },
    "rotary": {
        "distance": ("angle", "deg"), "speed": ("rotary_speed", "rpm"),
        "acceleration": ("angular_acceleration", "rad/s^2"), "jerk": ("angular_jerk", "rad/s^3"),
    },
}  # fmt: skip


class Change(NamedTuple):
    """A change of a spec."""

    what: str
    entry: str  # as one writes it
    spec: RobotSpec


def rounded_ramps(spec: RobotSpec, proof: Validation) -> Iterator[Change]:
    """The motion as an S-curve of the same distance, speed and acceleration, or with half its jerk."""
    before = proof.spec.motion
    if not isinstance(before, SCurve | Trapezoid | Triangle | Move) or (figures := _limits(before)) is None:
        return
    units = _UNITS[proof.spec.load.axis]
    fields: dict[str, Any] = {"profile": "s_curve"}
    for name, figure in figures.items():
        kind, unit = units[name]
        fields[name] = show(figure, unit, kind, 3 if name == "jerk" else 6)
    if before.rest_time:
        fields["rest_time"] = show(before.rest_time, "s", "time", 6)
    if before.there_and_back:
        fields["there_and_back"] = True
    for name in ("payload", "payload_back"):
        if getattr(before, name):
            fields[name] = show(getattr(before, name), "kg", "mass", 6)
    made = SCurve.model_validate(fields, context={"axis": proof.spec.load.axis})
    longer = profile_of(proof.spec.alone(motion=made)).duration - profile_of(proof.spec).duration
    what = f"rounded ramps, the cycle {show(longer, 's', 'time', 3)} longer"
    entry = ", ".join(f"{name}: {'true' if text is True else text}" for name, text in fields.items())
    yield Change(what, f"motion: {{{entry}}}", _with_motion(spec, before, made))


def _with_motion(spec: RobotSpec, before: Any, made: Any) -> RobotSpec:
    """The spec with another motion in the place of one, in all load cases that have it."""
    return spec.changed(lambda one: one.model_copy(update={"motion": made} if one.motion == before else {}))


def _limits(motion: SCurve | Trapezoid | Triangle | Move) -> dict[str, float] | None:
    """Distance, speed, acceleration and jerk of an S-curve in the place of a motion."""
    if isinstance(motion, SCurve):
        return {name: getattr(motion, name) for name in _UNITS["linear"]} | {"jerk": motion.jerk / 2}
    if isinstance(motion, Trapezoid):
        up, cruise, down, speed = motion.phases
        ramps, distance = (up, down), speed * ((up + down) / 2 + cruise)
    elif isinstance(motion, Triangle):
        ramps, distance = (motion.time / 2, motion.time / 2), motion.distance
        speed = 2 * distance / motion.time
    elif motion.law in ("trapezoid", "triangle"):
        ramps, distance = motion.ramps, motion.distance
        speed = distance / (motion.time - sum(ramps) / 2)
    else:  # its ramps are rounded
        return None
    acceleration = speed / max(ramps)
    jerk = acceleration / (_JERK_TIME * max(ramps))
    return {"distance": distance, "speed": speed, "acceleration": acceleration, "jerk": jerk}


def other_gains(spec: RobotSpec, proof: Validation) -> Iterator[Change]:
    """Gains that are designed where some are given, and those of other bandwidths."""
    velocity = next((loop for loop in proof.loops if loop.name == "velocity"), None)
    if velocity is None:
        return
    cascade = spec.control.structure == "cascade"
    place, own = ("control.velocity", spec.control.velocity) if cascade else ("control", spec.control)
    blank: Control | VelocityLoop = VelocityLoop() if cascade else Control()
    without = {name: getattr(blank, name) for name in (*_GAINS, *(("phase_margin",) if cascade else ()))}

    def with_figures(figures: dict[str, Any]) -> RobotSpec:
        def change(one: RobotSpec) -> RobotSpec:
            control, own = one.control, figures
            if control.structure == "cascade":
                own = {"velocity": control.velocity.model_copy(update=figures)}
            return one.model_copy(update={"control": control.model_copy(update=own)})

        return spec.changed(change)

    if own.kp is not None:
        yield Change("gains as they are designed", f"{place} without {', '.join(_GAINS)}", with_figures(without))
    if math.isnan(velocity.bandwidth):
        return
    failed = {check.name for check in proof.checks if check.status == "fail"}
    for factor in (2.0, 0.5) if failed & _FOLLOWING else (0.5, 0.25):
        text = show(factor * velocity.bandwidth, "Hz", "frequency", 3)
        what = f"a {'higher' if factor > 1.0 else 'lower'} bandwidth of the velocity loop"
        changed = with_figures(without | {"bandwidth": to_si(text, "frequency")})
        yield Change(what, f"{place}.bandwidth: {text}", changed)


def finer_steps(spec: RobotSpec, proof: Validation) -> Iterator[Change]:
    """More microsteps of a stepper's driver: those with which swings are small, or the finest that it has."""
    driver = proof.drive_set.controller
    finest = driver.microsteps if driver else math.nan
    more = int(min(CALM, finest)) if finest >= 1.0 else CALM
    if isinstance(proof.gains, Stepping) and more > proof.gains.microsteps:

        def change(one: RobotSpec) -> RobotSpec:
            return one.model_copy(update={"control": one.control.model_copy(update={"microsteps": more})})

        what = "finer steps" if finest >= more else "finer steps, of a driver that has them"
        yield Change(what, f"control.microsteps: {more}", spec.changed(change))


def slower_ramps(spec: RobotSpec, proof: Validation) -> Iterator[Change]:
    """Ramps of a trapezoid twice and four times as long."""
    before = proof.spec.motion
    if not isinstance(before, Trapezoid):
        return
    for factor in (2.0, 4.0):
        if before.acceleration is not None:
            kind, unit = _UNITS[proof.spec.load.axis]["acceleration"]
            text = show(before.acceleration / factor, unit, kind, 6)
            made = before.model_copy(update={"acceleration": to_si(text, kind)})
            yield Change("slower ramps", f"motion.acceleration: {text}", _with_motion(spec, before, made))
            continue
        text = show(factor * before.phases[0], "s", "time", 6)
        made = before.model_copy(update={"acceleration_time": to_si(text, "time")})
        entry = f"motion.acceleration_time: {text}"
        if before.deceleration_time is not None:
            text = show(factor * before.deceleration_time, "s", "time", 6)
            made = made.model_copy(update={"deceleration_time": to_si(text, "time")})
            entry += f", motion.deceleration_time: {text}"
        yield Change("slower ramps", entry, _with_motion(spec, before, made))
