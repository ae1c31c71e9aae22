"""Closed-loop validation (figure 3 of the paper): does the chosen drive follow the profile within its limits?

Reference speed - error at the motor shaft - sampled PID - limited voltage - DC motor - gearhead, belt, wheel - robot.
The parts: ``profile`` what is asked, ``plant`` and ``motion`` the machine, ``control_design`` the controller,
``march`` the loop, ``verdict`` what it means. This module puts them together.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from drivesizer.choose import usable_in
from drivesizer.control_design import COMPUTING, analyse, design
from drivesizer.errors import InputError
from drivesizer.loop_analysis import analyse_voltage
from drivesizer.machines import WheeledVehicle
from drivesizer.march import Limits, Run, march
from drivesizer.plant import DriveTrain, drive_train, within_reach
from drivesizer.profile import Profile, profile_of
from drivesizer.profile import profile as named
from drivesizer.results import Check, DriveSet, Gains, SizingResult, Status, Validation
from drivesizer.spec import RobotSpec
from drivesizer.units import show
from drivesizer.verdict import Case, checks, figures, quantum

__all__ = ["applies", "validate", "validate_all"]

_PERIOD = 1e-3  # s, where the controller's is unknown

_UNITS = {
    "time": ("time", "s"),
    "speed_reference": ("speed", "m/s"),
    "speed": ("speed", "m/s"),
    "error": ("speed", "m/s"),
    "motor_speed": ("rotary_speed", "rpm"),
    "current": ("current", "A"),
    "voltage": ("voltage", "V"),
    "motor_torque": ("torque", "mN*m"),
    "gearhead_torque": ("torque", "N*m"),
    "supply_power": ("power", "W"),
}


def validate(spec: RobotSpec, drive_set: DriveSet, *, profile: str | Profile | None = None) -> Validation:
    """Drive a set through a profile in closed loop.

    Parameters
    ----------
    spec
        The robot.
    drive_set
        The parts that drive each of its wheels.
    profile
        A name such as ``trapezoid``, a CSV file, or a profile; the spec's own motion when not given.

    Returns
    -------
    Validation
        ``fail`` when a check fails; unknown ones are told among the warnings.

    Raises
    ------
    InputError
        When the profile is wrong or too long, the catalogue lacks what the motor's motion needs, or
        ``control`` asks for what no controller can do.
    """
    if not applies(spec):
        raise InputError("the closed loop is for a wheeled_vehicle without wind; `drivesizer size` checks this load")
    asked = profile_of(spec) if profile is None else named(spec, profile) if isinstance(profile, str) else profile
    if spec.control.structure == "cascade":
        from drivesizer import servo, servo_verdict

        return servo_verdict.validation(servo.run(spec, drive_set, asked))
    period, said = _period(drive_set)
    train, assumed = drive_train(spec, drive_set, period)
    within_reach(train, asked)
    gains = design(spec, train, period)
    usable = usable_in(spec, drive_set.controller)
    loop = analyse(train, gains)
    run = march(train, gains, _limits(spec, drive_set, usable), asked)
    free = _without_limits(run, train, gains, asked) if loop.stable else run
    case = Case(spec, drive_set, asked, train, usable, loop, run, free)
    found = checks(case)
    status: Status = "fail" if any(check.status == "fail" for check in found) else "pass"
    return Validation(
        spec=spec,
        drive_set=drive_set,
        profile=asked.name,
        status=status,
        checks=found,
        figures=figures(case),
        gains=gains,
        series=_series(run, train, spec.load.motors),
        series_units=dict(_UNITS),
        assumptions=(*said, *assumed, *_assumptions(case)),
        warnings=_warnings(case, found),
        loops=(analyse_voltage(train, gains),),
    )


def validate_all(result: SizingResult, *, profile: str | Profile | None = None) -> tuple[list[Validation], list[str]]:
    """The sets of a sizing in closed loop: those that pass first, each group in the order of the sizing.

    Returns
    -------
    tuple
        The proofs, and why others could not be driven: a figure that the model needs is unknown.

    Raises
    ------
    InputError
        As :func:`validate`, where no set can be driven.
    """
    found: list[Validation] = []
    said: list[str] = []
    for one in result.sets:
        try:
            found.append(validate(result.spec, one, profile=profile))
        except InputError as error:
            said.append(f"{one.label}: {error}")
    if not found:
        raise InputError(said[0])
    return sorted(found, key=lambda proof: proof.status != "pass"), said


def applies(spec: RobotSpec) -> bool:
    """Whether the closed loop knows the spec's load."""
    return isinstance(spec.load, WheeledVehicle) and spec.load.drag_area == 0.0


def _period(drive_set: DriveSet) -> tuple[float, list[str]]:
    """The controller's period [s]."""
    rate = drive_set.controller.speed_loop if drive_set.controller else math.nan
    if rate > 0.0:
        return 1.0 / rate, []
    return _PERIOD, [f"the controller's rate is unknown: it runs every {show(_PERIOD, 'ms', 'time')}"]


def _limits(spec: RobotSpec, drive_set: DriveSet, usable: float) -> Limits:
    """What holds in the march; without known limits only the supply's voltage does."""
    peak = drive_set.controller.peak_current if drive_set.controller else math.nan
    continuous = drive_set.controller.continuous_current if drive_set.controller else math.nan
    return Limits(
        supply=spec.supply.lowest,
        voltage=spec.supply.lowest if math.isnan(usable) else usable,
        peak_current=math.inf if math.isnan(peak) else peak,
        continuous_current=math.inf if math.isnan(continuous) else continuous,
    )


def _without_limits(run: Run, train: DriveTrain, gains: Gains, asked: Profile) -> Run:
    """The march with nothing in its way: what it would take to follow. The same march where no limit was met."""
    if not run.saturated and not run.current_limited:
        return run
    try:
        return march(train, gains, replace(run.limits, voltage=math.inf, peak_current=math.inf), asked)
    except InputError:  # it does not come to an end: what the limited march asked for has to do
        return run


def _series(run: Run, train: DriveTrain, sets: int) -> dict[str, NDArray[np.float64]]:
    """The kept rows as columns, seen from the load and from the supply."""
    rows = np.array(run.recorder.rows).reshape(-1, Run.WIDTH)
    time, reference, speed, current, voltage, gear = rows.T.copy()
    return {
        "time": time,
        "speed_reference": reference / train.motor_per_speed,
        "speed": speed / train.motor_per_speed,
        "error": (reference - speed) / train.motor_per_speed,
        "motor_speed": speed,
        "current": current,
        "voltage": voltage,
        "motor_torque": train.torque_constant * current,
        "gearhead_torque": gear,
        "supply_power": voltage * current * sets,
    }


def _assumptions(case: Case) -> list[str]:
    """What the model takes for granted, as sentences."""
    said = [
        "the wheel turns at speed over radius: no speed reserve of (1), no oversize of (7) and (10)",
        "all driven wheels share the load alike; one motor set is simulated",
        "a gear's efficiency is the catalogue's maximum, at any torque; driven backward it is the same",
        "the bearing factor of (2) is a friction torque against the motion in either direction",
        "the no-load current is Coulomb friction of the motor, at rest and at any speed",
        "resistance and torque constant are those at 25 °C",
        f"the voltage answers the measurement of {COMPUTING:g} control period before; the speed is measured exactly",
        "the current limit is ideal: the controller's current loop is much faster than its speed loop",
        "the profile starts in equilibrium at its first speed and runs once; supply power is that of the motors, "
        "without the controllers' own losses",
    ]
    if math.isnan(case.usable_voltage):
        said.append("the controller's voltage limit is unknown: the motor gets up to the lowest supply voltage")
    return said


def _warnings(case: Case, found: tuple[Check, ...]) -> tuple[str, ...]:
    """What the reader must know, in plain words."""
    run, loop, said = case.run, case.loop, []
    failed = {check.name for check in found if check.status == "fail"}
    if "stability" in failed:
        said.append("the loop is unstable with these gains: lower them, or leave them out to have them designed")
    if "tracking_error" in failed:
        share = run.error.value / case.train.motor_per_speed / case.profile.top_speed
        why = _why_not(case)
        said.append(f"the drive does not follow the profile: off by {share:.0%} of its top speed{why}")
    if math.isinf(next(check.demand for check in found if check.name == "winding_temperature")):
        said.append("the winding runs away thermally at this current")
    step = quantum(case) * run.pid.kp
    if step > run.limits.voltage and loop.stable:
        said.append(
            f"one encoder count per control period is {show(quantum(case), 'rpm', 'rotary_speed', 3)}, which these "
            f"gains answer with {show(step, 'V', 'voltage', 3)}: measure over more periods, or ask for less "
            "control.bandwidth"
        )
    unknown = [check.title for check in found if check.status == "unknown"]
    if unknown:
        said.append(f"unknown: {', '.join(unknown)}")
    return tuple(said)


def _why_not(case: Case) -> str:
    """What keeps the drive from following, where it is a limit."""
    if case.run.saturated:
        return ": the voltage does not suffice"
    return ": the current does not suffice" if case.run.current_limited else ""
