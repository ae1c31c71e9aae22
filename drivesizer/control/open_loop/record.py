"""The record of a stepper's simulation: checks, figures and time series, seen from the load."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.open_loop.run import OpenLoop
from drivesizer.control.validation import Stepping, Validation
from drivesizer.load_cases.profile import SPEED
from drivesizer.results.check import Check, Figure, verdict
from drivesizer.results.check_columns import CheckColumn, at_most, between, fits
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.ratings import unless_printed
from drivesizer.units import show

__all__ = ["METHOD", "record"]

METHOD = "open loop"
_RULE = "pulses along the profile, open-loop"
_SOURCE = "P. Acarnley, Stepping Motors: a guide to theory and practice, 4th ed., IET, 2002, chapters 3 and 4"
_SLIP, _CREST = math.pi, math.pi / 2.0  # electrical: half a tooth pitch, and where the torque is largest
_TRAVEL = {"linear": ("length", "mm"), "rotary": ("angle", "deg")}
_CRESTS = "electrical: 90° is a full step, where the torque is largest; beyond 180° steps are lost: informational"
_OWN = {"microsteps", "damping_ratio"}  # fields of ``control`` that a stepper has


def record(case: OpenLoop, drive_set: DriveSet, name: str) -> Validation:
    """The simulation of a stepper as a record."""
    found = tuple(check for check in _checks(case, drive_set) if check.limit != math.inf)
    stepper = case.stepper
    rate = float(np.abs(case.out.series["reference"]).max()) / stepper.microstep
    return Validation(
        spec=case.spec,
        drive_set=drive_set,
        case=name,
        profile=case.profile.name,
        status=verdict(found),
        checks=found,
        figures=_figures(case),
        gains=Stepping(
            microsteps=case.microsteps, pulse_rate=rate, damping_ratio=stepper.damping_ratio, rule=_RULE, source=_SOURCE
        ),
        series=_series(case),
        series_units=_units(case),
        assumptions=(*case.assumptions, *_assumptions(case)),
        warnings=tuple(_warnings(case, found)),
    )


# --- checks


def _check(column: CheckColumn, at_time: float | None = None, note: str = "") -> Check:
    return column.at((), METHOD, at_time=at_time, note=note)


def _checks(case: OpenLoop, drive_set: DriveSet) -> Iterator[Check]:
    out, gearhead = case.out, case.drive_set.gearhead
    seen = out.figures
    when = seen["slipped"] if seen["slipped"] >= 0.0 else None
    kept = f"{out.lost} lost, {out.lost_at_end} at the end" if out.lost else "none is lost"
    yield _check(fits("lost_steps", not out.lost, True), when, kept)
    low, high, guessed = _band(drive_set)
    yield _check(_share("pull_out_share", case.share, low, high), note=_said(case.share, guessed))
    if not math.isnan(case.start):
        yield _check(_share("start_share", case.start, low, high), note=_said(case.start, guessed))
    yield _check(at_most("load_angle", seen["lag"], _CREST, advice=True), seen["lag_time"], _CRESTS)
    belt = case.drive_set.belt_ratio * case.drive_set.belt_efficiency
    if not out.lost:
        yield _check(
            unless_printed(
                at_most("gearhead_intermittent_torque", seen["gear"] / belt, gearhead.intermittent_torque),
                "peak_torque",
                drive_set,
            ),
            seen["gear_time"],
            "with the swings of the rotor",
        )
    yield _check(
        at_most("gearhead_intermittent_speed", seen["speed"], gearhead.intermittent_input_speed), seen["speed_time"]
    )


def _share(name: str, share: float, low: float, high: float) -> CheckColumn:
    """The share against all of the torque; of an estimated one against both ends of its band."""
    if low == high:
        return at_most(name, share, 1.0)
    return between(at_most(name, share, high), at_most(name, share, low))


def _said(share: float, guessed: str) -> str:
    return f"steps are lost below it, found by halving{guessed}" if math.isfinite(share) else "lost at any torque"


def _band(drive_set: DriveSet) -> tuple[float, float, str]:
    """Ends of the band of the pull-out torque over the simulated one, and words on it."""
    for one in drive_set.estimated:
        if (one.part, one.figure) == ("motor", "pull_out_share"):
            low, high = one.low / one.value, one.high / one.value
            return low, high, f"; the torque is estimated, {low:.0%} to {high:.0%} of the simulated one"
    return 1.0, 1.0, ""


# --- figures and series


def _figures(case: OpenLoop) -> tuple[Figure, ...]:
    seen, stepper = case.out.figures, case.stepper
    travel, per = _TRAVEL[case.spec.load.axis], case.per_travel
    peak = float(np.abs(case.out.series["motor_torque"]).max())
    rows: tuple[tuple[str, str, float, tuple[str, str], float | None], ...] = (
        ("lost_steps", "Full steps lost, largest", float(case.out.lost), ("dimensionless", "1"), None),
        ("lost_at_end", "Full steps lost at the end", float(case.out.lost_at_end), ("dimensionless", "1"), None),
        ("load_angle_to_slip", "Load angle left before a step is lost", max(_SLIP - seen["lag"], 0.0),
         ("angle", "deg"), None),
        ("position_error_peak", "Position error at the load, peak", seen["error"] * per, travel, seen["error_time"]),
        ("distance_error", "Final position error, load", seen["end_error"] * per, travel, None),
        ("microstep", "One microstep, at the load", stepper.microstep * per, travel, None),
        ("natural_frequency", "Natural frequency with the load, by the pull-out torque at rest",
         stepper.natural_frequency, ("frequency", "Hz"), None),
        ("motor_torque_peak", "Motor torque, peak", peak, ("torque", "N*m"), None),
    )  # fmt: skip
    return tuple(Figure(name=n, title=t, value=v, kind=k, unit=u, at_time=at) for n, t, v, (k, u), at in rows)


def _series(case: OpenLoop) -> dict[str, NDArray[np.float64]]:
    rows, per = case.out.series, case.per_travel
    belt = case.drive_set.belt_ratio * case.drive_set.belt_efficiency
    reference, speed = rows["reference"] * per, rows["motor_speed"] * per
    return {
        "time": rows["time"],
        "speed_reference": reference,
        "speed": speed,
        "error": reference - speed,
        "position_error": rows["position_error"] * per,
        "load_angle": rows["load_angle"],
        "motor_speed": rows["motor_speed"],
        "motor_torque": rows["motor_torque"],
        "gearhead_torque": rows["gear_torque"] / belt,
    }


def _units(case: OpenLoop) -> dict[str, tuple[str, str]]:
    speed, travel = SPEED[case.spec.load.axis], _TRAVEL[case.spec.load.axis]
    return {
        "time": ("time", "s"), "speed_reference": speed, "speed": speed, "error": speed, "position_error": travel,
        "load_angle": ("angle", "deg"), "motor_speed": ("rotary_speed", "rpm"), "motor_torque": ("torque", "mN*m"),
        "gearhead_torque": ("torque", "N*m"),
    }  # fmt: skip


# --- words


def _assumptions(case: OpenLoop) -> list[str]:
    ratio, given = case.stepper.damping_ratio, case.spec.control.damping_ratio is not None
    damped = "as given" if given else "low, for hybrid steppers are damped by 0.3 to 0.4; control.damping_ratio sets it"
    return [
        "all drives share the load equally; one is simulated",
        "the motor's torque is its pull-out torque at the speed of the pulses times the sine of the load angle; its "
        "own friction is in it, detent torque and electrical transients are not: no instability at mid speed",
        f"swings are damped by {ratio:.3g} of the critical damping, {damped}",
        "rotor and load turn as one body, and the driver gives its rated current at rest too",
        "a gear's efficiency is the catalogue's maximum, at any torque and in either direction of power",
        "pulses follow the profile to the nearest microstep, and start in equilibrium; one cycle is simulated, held "
        "for some swings after its end where that is at rest",
    ]


def _warnings(case: OpenLoop, found: tuple[Check, ...]) -> Iterator[str]:
    seen, swings = case.out.figures, case.stepper.natural_frequency
    if case.out.lost:
        cure = (
            f"with control: {{microsteps: {case.finer}}} none is, in a driver that has them"
            if case.finer
            else "less acceleration, speed or inertia, a higher supply voltage, or a larger motor"
        )
        yield f"steps are lost from {seen['slipped']:.4g} s on: {cure}"
    ignored = sorted(case.spec.control.model_fields_set - _OWN)
    if ignored:
        yield f"control.{ignored[0]}: a stepper runs open-loop; of control only microsteps and damping_ratio are used"
    if case.spec.plant.model != "rigid":
        yield "plant.model two_mass: a stepper is simulated with a rigid shaft"
    rates = abs(np.log(_steady_rates(case) / swings))
    if len(rates) and rates.min() < math.log(2.0) / 2.0:
        near = show(swings, "Hz", "frequency", 3)
        yield f"pulses at a steady speed come close to the natural frequency of {near}: other microsteps, or speed"
    unknown = [check.title for check in found if check.status == "unknown" and not check.advice]
    if unknown:
        yield f"unknown: {', '.join(unknown)}"


def _steady_rates(case: OpenLoop) -> NDArray[np.float64]:
    """Rates of pulses [Hz] where the speed is constant and not 0."""
    speed = np.abs(np.array(case.profile.speed)) / case.per_travel
    steady = speed[1:][(speed[1:] == speed[:-1]) & (speed[1:] > 0.0)]
    found: NDArray[np.float64] = np.unique(steady) / case.stepper.microstep
    return found
