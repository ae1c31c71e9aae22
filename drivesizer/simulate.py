"""Closed-loop validation (figure 3 of the paper): does the chosen drive follow the profile within its limits?

Reference speed - error at the motor shaft - sampled controller - limited voltage - motor - gearhead, belt, load.

PID and DC motor in python-control are ``control.loop_design``: ``dc_motor`` (states i, w), ``pid``, and the loops that
they make. Their poles, margins and steps are there too; ``linear_run`` simulates the profile with
them; its figures stand beside those of the program's own engine, which adds limits, friction, heat and counts.
``loads.profile`` gives the reference motion, ``control.drive_train`` the plant, ``control.closed_loop`` simulation,
checks and figures. This module makes the record, with assumptions and warnings.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from drivesizer.control import devices
from drivesizer.control.closed_loop import ClosedLoop, linear_run, run
from drivesizer.control.closed_loop.checks import checks, columns, figures
from drivesizer.control.gains import COMPUTING, loop_warnings, resolution_warning, resonance_warning
from drivesizer.control.validation import Cascade, ControllerGain, Gains, Remedy, Stepping, Validation
from drivesizer.errors import InputError
from drivesizer.files.text import sentences
from drivesizer.load_cases import load_cycle, profile_of
from drivesizer.load_cases import profile as named
from drivesizer.load_cases.of_machine import grip_warning, load_cases, starts_farther_on
from drivesizer.load_cases.platform import WheelLoad, motion_of
from drivesizer.loads.course import Profile
from drivesizer.loads.motions import SPEED, Move, SCurve, Trapezoid, Triangle
from drivesizer.machine.part_curves import torque_of_drive
from drivesizer.results.check import GRAVEST, Check, units_of, verdict, worst
from drivesizer.results.drive_set import DriveSet, loss_assumptions
from drivesizer.results.problem import SHIFT, for_drive
from drivesizer.results.sizing import SizingResult
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
    curve = SCurve.model_validate(fields, context={"axis": proof.spec.load.axis})
    longer = profile_of(proof.spec.alone(motion=curve)).duration - profile_of(proof.spec).duration
    what = f"rounded ramps, the cycle {show(longer, 's', 'time', 3)} longer"
    entry = ", ".join(f"{name}: {'true' if text is True else text}" for name, text in fields.items())
    yield Change(what, f"motion: {{{entry}}}", _with_motion(spec, before, curve))


def _with_motion(spec: RobotSpec, before: Any, motion: Any) -> RobotSpec:
    """The spec with another motion in the place of one, in all load cases that have it."""
    return spec.changed(lambda case: case.model_copy(update={"motion": motion} if case.motion == before else {}))


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
        def change(case: RobotSpec) -> RobotSpec:
            control, own = case.control, figures
            if control.structure == "cascade":
                own = {"velocity": control.velocity.model_copy(update=figures)}
            return case.model_copy(update={"control": control.model_copy(update=own)})

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

        def change(case: RobotSpec) -> RobotSpec:
            return case.model_copy(update={"control": case.control.model_copy(update={"microsteps": more})})

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
            ramps = before.model_copy(update={"acceleration": to_si(text, kind)})
            yield Change("slower ramps", f"motion.acceleration: {text}", _with_motion(spec, before, ramps))
            continue
        assert before.acceleration_time is not None  # in place of the acceleration
        text = show(factor * before.acceleration_time, "s", "time", 6)
        ramps = before.model_copy(update={"acceleration_time": to_si(text, "time")})
        entry = f"motion.acceleration_time: {text}"
        if before.deceleration_time is not None:
            text = show(factor * before.deceleration_time, "s", "time", 6)
            ramps = ramps.model_copy(update={"deceleration_time": to_si(text, "time")})
            entry += f", motion.deceleration_time: {text}"
        yield Change("slower ramps", entry, _with_motion(spec, before, ramps))


_ALL = 1e-6  # of the duration: a smaller part that was not simulated is not reported
_OTHERS = 2  # drives that are tried where one fails
_SMALL_AT_REST = 0.5  # of the RMS current: a smaller current at rest is not reported


def hardest_case(spec: RobotSpec, drive_set: DriveSet) -> str:
    """The most demanding load case of a drive: that of its tightest limit, of those that a closed loop meets too."""
    spec = for_drive(spec, drive_set.chosen_screw)
    names = [name for _, name, _ in load_cases(spec)]
    met = [c for c in drive_set.every_check if c.name in _MET_BY_THE_LOOP and c.case in {*names, SHIFT}]
    order = {"fail": 0, "unknown": 1, "open": 1, "pass": 1}
    known = [c for c in met if not math.isnan(c.margin)]
    hardest = min(known, key=lambda c: (order[c.status], c.margin)).case if known else names[0]
    if hardest in names:
        return hardest
    peaks = {name: np.abs(load_cycle(case).torque).max() for name, case in _shift_cases(spec).items()}
    return max(peaks, key=lambda name: peaks[name])


def _shift_cases(spec: RobotSpec) -> dict[str, RobotSpec]:
    """Load cases that alternate, by name."""
    names = spec.alternating
    return {name: case for name, case in spec.load_cases if names and (case is spec or name in names)}


_OF_THE_SHIFT = {
    "controller_continuous_current", "motor_nominal_current", "winding_temperature", "gearhead_continuous_torque",
    "gearhead_continuous_speed",
}  # fmt: skip
_MET_BY_THE_LOOP = {
    "gearhead_intermittent_torque", "motor_speed", "motor_nominal_current", "motor_peak_torque", "winding_temperature",
    "supply_voltage", "controller_peak_current", "controller_peak_time", "supply_current", "supply_power",
    "pull_out_torque",
}  # fmt: skip


def validate(
    spec: RobotSpec, drive_set: DriveSet, *, profile: str | Profile | None = None, load_case: str | None = None,
    device: devices.Device | None = None,
) -> Validation:  # fmt: skip
    """Simulate a drive along a profile in closed loop; a stepper behind its pulses.

    Parameters
    ----------
    spec
        The machine.
    drive_set
        The drive.
    profile
        A name such as ``trapezoid``, a CSV file, or a profile; the spec's own motion with ``spec``, or when not given.
    load_case
        Name of the load case to simulate, such as that of :func:`hardest_case`; the first when not given.
    device
        The controller in whose units gains are given too; the drive's own when not given.

    Returns
    -------
    Validation
        ``fail`` when a check fails, ``unknown`` when a missing figure leaves one open, which is reported as well.

    Raises
    ------
    InputError
        When the profile is wrong or too long, the catalogue lacks a figure that the simulation needs, or ``control``
        requires the impossible.
    """
    spec = for_drive(spec, drive_set.chosen_screw)
    cases = {name: case for _, name, case in load_cases(spec)}
    driven = next(iter(cases)) if load_case is None else load_case
    shared, spec, name = driven in _shift_cases(spec), cases[driven], driven if len(cases) > 1 else ""
    if profile is None or profile == "spec":
        motion, farther = motion_of(spec), starts_farther_on(name, spec)  # the spec's own motion repeats
    elif spec.load.of_shaft:
        what = "a platform on a trajectory" if isinstance(spec.load, WheelLoad) else f"a {spec.load.kind} load"
        raise InputError(f"--profile: {what} brings its own motion, on which its torque depends; leave the option out")
    else:
        motion, farther = named(spec, profile) if isinstance(profile, str) else profile, ()
    more = []
    if drive_set.estimated:
        listed = ", ".join(f"{estimate.title} {estimate.text}" for estimate in drive_set.estimated)
        more.append(f"estimated from peers, at the middle of the band: {listed}")
    if others := len(cases) - 1:
        left = "1 further case is" if others == 1 else f"{others} further cases are"
        more.append(f"the load case {driven} is simulated; {left} not simulated")
    if drive_set.steps:  # behind its pulses, on the lowest supply voltage
        from drivesizer.control import open_loop

        lowest = spec.supply.lowest
        ran = open_loop.run(spec, drive_set, motion, lambda speed: torque_of_drive(drive_set, speed, lowest))
        proof = open_loop.record(ran, drive_set, name)
        assumptions, warnings = (*proof.assumptions, *more), (*proof.warnings, *farther)
        return replace(proof, assumptions=assumptions, warnings=warnings)
    case = run(spec, drive_set, motion)
    check_results, recorded, controller = checks(case), columns(case), drive_set.controller
    if shared:
        note = "of this load case alone, informational: it has a share of the time, and `size` checks the whole shift"
        check_results = tuple(
            replace(c, advice=True, title=f"{c.title} (advice)", note=note)
            if c.name in _OF_THE_SHIFT and not c.advice
            else c
            for c in check_results
        )
    own: tuple[ControllerGain, ...] = ()
    lacking: list[str] = []
    known = device or (devices.known(controller.family) if controller else None)
    if known and isinstance(case.controller, Cascade):
        own, lacking = devices.controller_gains(case.controller, case.train, known)
    return Validation(
        spec=spec,
        drive_set=drive_set,
        case=name,
        profile=motion.name,
        status=verdict(check_results),
        checks=check_results,
        figures=figures(case),
        gains=case.controller,
        series=recorded,
        series_units=units_of("series", recorded, rotary=spec.load.shaft_axis == "rotary"),
        assumptions=(*case.assumptions, *_assumptions(case), *more),
        warnings=(*_warnings(case, check_results), *lacking, *farther),
        controller_gains=own,
        loops=case.loops.all,
        linear=linear_run(case),
    )


class Commissioned(NamedTuple):
    """A drive behind a controller of the table: what is written there, and its loops before and after rounding."""

    exact: Validation
    rows: list[devices.Written]
    left_out: list[str]  # with the reason
    rounded: Validation


def commissioned(
    spec: RobotSpec, drive: DriveSet, device: devices.Device, *, settings: Mapping[str, float] | None = None,
    unconfirmed: bool = False, profile: str | Profile | None = None, load_case: str | None = None,
) -> Commissioned:  # fmt: skip
    """A drive's loops for a controller of the table, its parameters as they are written, and the motion with those."""
    controller, (current, velocity, position) = drive.controller, device.rates
    if controller and not drive.steps:
        rated = replace(controller, current_loop=current, speed_loop=velocity, position_loop=position)
        drive = replace(drive, controller=rated)

    def simulated(control: Control, drive_set: DriveSet = drive) -> Validation:
        own = spec.changed(lambda case: case.model_copy(update={"control": control}))
        return validate(own, drive_set, profile=profile, load_case=load_case, device=device)

    proof = simulated(devices.loops_of(device, spec, drive))
    values = devices.figures(proof, device, settings or {})
    if (slower := devices.within_limits(device, proof, values)) is not None:
        proof = simulated(slower)
        values = devices.figures(proof, device, settings or {})
    rows, left_out, refused = devices.written(device, values)
    if refused:
        raise InputError(f"--device: {device.title} cannot express {refused[0]}; expected another bandwidth or gain "
                         "under control in the spec")  # fmt: skip
    recalled = [row for row in rows if row.parameter.confidence == "recalled" and not unconfirmed]
    rows = [row for row in rows if row not in recalled]
    if recalled:
        names = (f"{row.parameter.name} = {row.text} {row.unit}".strip() for row in recalled)
        left_out.append(f"{', '.join(names)}: known from memory alone (--unconfirmed)")
    if not rows:
        raise InputError(f"--device: all that is known of {device.title} is from memory alone; expected --unconfirmed")
    most = float(device.words["pulses"] or math.inf)
    if values.get("rate", 0.0) > most:
        raise InputError(f"--device: {device.title} cannot express {values['rate'] / 1e3:.3g} kHz of pulses: "
                         f"{most / 1e3:.3g} kHz at most; expected fewer control.microsteps")  # fmt: skip
    rounded = simulated(devices.as_written(device, rows, proof, values), devices.with_limit(device, rows, drive))
    note = f"the loop is that of {device.title}, with the gains and limits that are written there, after rounding"
    return Commissioned(proof, rows, left_out, replace(rounded, assumptions=(note, *rounded.assumptions)))


def with_remedies(
    proof: Validation,
    spec: RobotSpec,
    others: Sequence[DriveSet],
    *,
    profile: str | Profile | None = None,
    axis: str = "",
    sized: Callable[[RobotSpec, DriveSet], DriveSet] = lambda _, drive: drive,
) -> Validation:
    """A simulation that fails with what helps: finer steps, smoother ramps, another bandwidth, another drive.

    Of each kind changes are tried until one passes; of an axis of a machine they are entered under it. ``sized`` is a
    drive with the checks of ``size`` in a changed spec: one that fails there is not simulated, and fails for that.
    """
    if proof.status != "fail":
        return proof
    mine = proof.drive_set
    kinds: list[Iterable[Change]] = [finer_steps(spec, proof), other_gains(spec, proof)]
    if profile is None or profile == "spec":
        kinds.insert(1, rounded_ramps(spec, proof))
        kinds += [slower_ramps(spec, proof)] * mine.steps
    option = f"--axis {axis} --set" if axis else "--set"
    next_drives = [other for other in others if other.label != mine.label][:_OTHERS]
    drives = [
        (f"another drive{_heavier(mine, other) if axis else ''}", f"{option} {other.order_numbers}", spec, other)
        for other in next_drives
    ]
    under, remedies = f"axes.{axis}." if axis else "", list[Remedy]()
    for kind in (*([(c.what, under + c.entry, c.spec, mine) for c in kind] for kind in kinds), drives):
        for what, entry, changed, drive in kind:
            try:
                resized = drive if changed is spec else sized(changed, drive)
                status, checks = resized.status, resized.deciding
                if status != "fail":
                    run_again = validate(changed, resized, profile=profile, load_case=proof.case or None)
                    status, checks = run_again.status, run_again.checks
            except InputError:  # as a bandwidth that the loop's delay does not allow
                continue
            remedies.append(Remedy(what, entry, status, worst(checks)))
            if status != "fail":
                break
    return replace(proof, tried=tuple(remedies))


def _heavier(mine: DriveSet, other: DriveSet) -> str:
    """Mass by which another drive is heavier for an axis that carries it, in words; its controller rides on none."""

    def of_turning(drive: DriveSet) -> float:
        return math.fsum(part.mass for role, part in drive.parts.items() if part is not None and role != "controller")

    more = of_turning(other) - of_turning(mine)
    return f", {show(more, 'g', 'mass', 3)} heavier" if more > 0.0 else ""


def validate_all(
    result: SizingResult, *, profile: str | Profile | None = None, load_case: str | None = None
) -> tuple[list[Validation], list[str]]:
    """The drives of a sizing in closed loop: those that pass first, each group in the order of the sizing.

    Parameters
    ----------
    result
        The sizing.
    profile
        As :func:`validate`.
    load_case
        Name of the load case to simulate; for each drive its hardest when not given.

    Returns
    -------
    tuple
        The proofs, and why others could not be simulated: a figure that the model needs is unknown.

    Raises
    ------
    InputError
        As :func:`validate`, where no drive can be simulated.
    """
    proofs: list[Validation] = []
    errors: list[str] = []
    for drive in result.sets:
        try:
            driven = hardest_case(result.spec, drive) if load_case is None else load_case
            proofs.append(validate(result.spec, drive, profile=profile, load_case=driven))
        except InputError as error:
            errors.append(f"{drive.label}: {error}")
    if not proofs:
        raise InputError(errors[0])
    return sorted(proofs, key=lambda proof: GRAVEST[::-1].index(proof.status)), errors


def _assumptions(case: ClosedLoop) -> list[str]:
    """Assumptions of the model, as sentences."""
    simulated, lasts = case.figure("time_simulated"), case.figure("time")
    terms: dict[str, Any] = {
        "case": case, "cascade": isinstance(case.controller, Cascade), "over": case.controller.counted_over,
        "computing": COMPUTING, "unlimited": math.isnan(case.usable_voltage), "simulated": simulated, "lasts": lasts,
        "repeated": simulated < (1.0 - _ALL) * lasts,
        "lag": case.figure("load_angle_error"),  # rad: an error of the sine of as much at most
    }  # fmt: skip
    return [
        *sentences("drivesizer.control", "closed loop", **terms),
        *loss_assumptions(case.spec, case.drive_set.controller),
        *sentences("drivesizer.control", "closed loop, as it was simulated", **terms),
    ]


def _warnings(case: ClosedLoop, checks: tuple[Check, ...]) -> list[str]:
    """Warnings, each with its remedy where there is one."""
    warnings = loop_warnings(case.loops.all, case.profile)
    if case.train.flexible:
        warnings += resonance_warning(case.loops, case.train.stiffness)
    encoder, controller, c = case.drive_set.encoder, case.drive_set.controller, case.controller
    if encoder is not None:
        time = c.velocity_period * max(c.counted_over, 1)
        if isinstance(c, Gains):
            limit = case.spec.feed_of(controller).applied
            warnings += resolution_warning(encoder.lines, time, c.kp, limit, "voltage")
        else:
            peak = controller.peak_current if controller else math.nan
            warnings += resolution_warning(encoder.lines, time, c.velocity_kp, peak)
    warnings += [*_rest_current_note(case), *grip_warning(case.spec)]
    failed = {check.name for check in checks if check.status == "fail" and not check.advice}
    if "stability" in failed:
        warnings.append("the loop is unstable with these gains: lower them, or leave them out to have them designed")
    if "tracking_error" in failed:
        error, top = case.figure("load_speed_error") * case.train.radius, case.profile.top_speed
        kind, unit = SPEED[case.spec.load.shaft_axis]
        share = f", {error / top:.0%} of its top speed" if top else ""
        limits = {"time_at_voltage_limit": "voltage", "time_at_current_limit": "current"}
        why = next((f": {what} limit reached" for name, what in limits.items() if case.figure(name)), "")
        warnings.append(f"the drive does not follow the profile: error {show(error, unit, kind, 3)}{share}{why}")
    if math.isinf(next(check.demand for check in checks if check.name == "winding_temperature")):
        warnings.append("thermal runaway of the winding at this current")
    unknown = [check.title for check in checks if check.status == "unknown" and not check.advice]
    if unknown:
        warnings.append(f"unknown: {', '.join(unknown)}")
    return warnings


def _rest_current_note(case: ClosedLoop) -> list[str]:
    """Warning of a current that the loop's integral holds at rest, against friction.

    Beyond that which holds the load, with its payload then and without friction.
    """
    rows: Any = case.out.series
    machine, task = case.train, case.task
    still = (rows["reference"] == 0.0) & (rows["motor_speed"] == 0.0)
    still[:-1] &= still[1:]  # what begins with the next motion, as another payload, is no rest
    if not case.profile.top_speed or not still.any():
        return []
    moments = rows["time"][still]
    more = np.zeros(len(moments))
    if len(task.load_time):
        more = np.interp(moments % case.profile.duration, task.load_time, task.load_torque)
    current = np.abs(rows["current"][still])
    holding = np.abs(machine.rest_torque + more) / machine.ratio / machine.torque_constant
    worst = int(np.argmax(current - holding))
    at_rest, needed = float(current[worst]), float(holding[worst])
    if not at_rest > needed + _SMALL_AT_REST * case.figure("rms_current"):
        return []
    cure = "switch the power stage off at rest to save that heat"
    if needed:  # the weight would move the load
        cure = "a brake that holds at rest saves that heat; with the power stage off alone the load moves"
    return [
        f"at rest the integral of the loop holds up to {show(at_rest, 'A', 'current', 3)} against friction, where "
        f"holding the load needs {show(needed, 'A', 'current', 3)}: {cure}"
    ]
