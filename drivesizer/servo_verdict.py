"""What a march of the cascade means: every demand against its limit, the figures that have none, and warnings."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.checks import at_least, at_most, fits
from drivesizer.loop_warnings import loop_warnings, resolution_warning, resonance_warning
from drivesizer.march import FOLLOWS
from drivesizer.results import Check, Figure, Status, Validation
from drivesizer.servo import ServoCase, own_units
from drivesizer.thermal import current_derating
from drivesizer.units import show
from drivesizer.verdict import check_of

__all__ = ["validation"]

_UNITS = {
    "time": ("time", "s"),
    "speed_reference": ("speed", "m/s"),
    "speed": ("speed", "m/s"),
    "error": ("speed", "m/s"),
    "position_error": ("length", "mm"),
    "motor_speed": ("rotary_speed", "rpm"),
    "current": ("current", "A"),
    "voltage": ("voltage", "V"),
    "motor_torque": ("torque", "mN*m"),
    "gearhead_torque": ("torque", "N*m"),
    "winding_temperature": ("temperature", "degC"),
    "supply_power": ("power", "W"),
}


def validation(case: ServoCase) -> Validation:
    """The proof as a record."""
    found = tuple(check for check in _checks(case) if check.limit != math.inf)
    status: Status = "fail" if any(check.status == "fail" for check in found) else "pass"
    gains, lacking = own_units(case)
    return Validation(
        spec=case.spec,
        drive_set=case.drive_set,
        profile=case.profile.name,
        status=status,
        checks=found,
        figures=_figures(case),
        gains=case.cascade,
        series=_series(case),
        series_units=dict(_UNITS),
        assumptions=(*case.said, *_assumptions(case)),
        warnings=_warnings(case, found, lacking),
        loops=case.loops.all,
        controller_gains=gains,
    )


def _checks(case: ServoCase) -> Iterator[Check]:
    yield from _loop(case)
    yield from _electrical(case)
    yield from _heat(case)
    yield from _moving(case)


def _loop(case: ServoCase) -> Iterator[Check]:
    """Stability, tracking and bandwidth."""
    loops, top = case.loops, case.profile.top_speed
    worst = max(loops.all, key=lambda loop: loop.pole_radius)
    margins = ", ".join(f"{loop.name} {math.degrees(loop.phase_margin):.3g}°" for loop in loops.all)
    yield check_of(
        fits("stability", all(loop.stable for loop in loops.all), True), "Stability of the linear loops",
        note=f"phase margins: {margins}; largest pole {worst.pole_radius:.4g}, stable inside 1",
    )  # fmt: skip
    error = case.figure("speed_error") / case.train.motor_per_speed
    yield check_of(
        at_most("tracking_error", error, FOLLOWS * top if top else math.nan, "speed", "m/s"), "Tracking error",
        case.figure("speed_error_time"), f"to follow is to stay within {FOLLOWS:.0%} of the top speed, our convention",
    )  # fmt: skip
    if case.spec.needs.bandwidth is not None:
        got = loops.velocity.bandwidth
        yield check_of(at_least("bandwidth", case.spec.needs.bandwidth, got, "frequency", "Hz"), "Velocity bandwidth")


def _electrical(case: ServoCase) -> Iterator[Check]:
    """Voltage and current that the controller must give."""
    spec, controller = case.spec, case.drive_set.controller

    def own(name: str) -> float:
        return getattr(controller, name) if controller else math.nan

    yield check_of(
        at_most("supply_voltage", case.figure("voltage_asked"), case.usable_voltage, "voltage", "V"), "Motor voltage",
        case.figure("voltage_asked_time"), "that the current loop asks for, against what the lowest supply leaves",
    )  # fmt: skip
    yield check_of(
        at_most("controller_peak_current", case.figure("current_asked"), own("peak_current"), "current", "A"),
        "Controller peak current", case.figure("current_asked_time"), "that the velocity loop asks for",
    )  # fmt: skip
    if not math.isnan(own("peak_time")):
        share = case.figure("i2t_share")
        yield check_of(
            at_most("controller_i2t", share, 1.0, "dimensionless", "%"), "I²t of the peak current",
            note="its highest state: at 100 % the controller falls back to the continuous current",
        )  # fmt: skip
    yield check_of(
        at_most("controller_continuous_current", case.figure("rms_current"), own("continuous_current"), "current", "A"),
        "Controller continuous current (RMS)",
    )  # fmt: skip
    if spec.supply.current is not None:
        yield check_of(
            at_most("supply_current", case.figure("bus_current"), spec.supply.current, "current", "A"),
            "Supply current, all sets", case.figure("bus_current_time"),
        )  # fmt: skip


def _heat(case: ServoCase) -> Iterator[Check]:
    """The motor's RMS current, and the winding at its highest in the cycle repeated for ever."""
    motor, ambient = case.drive_set.motor, case.spec.environment.ambient
    derating = float(current_derating(ambient, motor.max_winding_temperature))
    yield check_of(
        at_most("motor_nominal_current", case.figure("rms_current"), motor.nominal_current * derating, "current", "A"),
        "Motor nominal current (RMS)",
    )  # fmt: skip
    winding = case.periodic.get("winding", math.nan)
    note = "runs away" if math.isinf(winding) else "highest over the cycle repeated for ever"
    limit = motor.max_winding_temperature
    yield check_of(
        at_most("winding_temperature", winding, limit, "temperature", "degC", zero=ambient), "Winding temperature",
        note=note,
    )  # fmt: skip


def _moving(case: ServoCase) -> Iterator[Check]:
    """Gearhead torque and the speeds."""
    gearhead, motor = case.drive_set.gearhead, case.drive_set.motor
    speed, when, rotary = case.figure("speed"), case.figure("speed_time"), ("rotary_speed", "rpm")
    running, peak = case.figure("rms_gear_torque_running"), case.figure("gear_torque")
    yield check_of(
        at_most("gearhead_continuous_torque", running, gearhead.continuous_torque, "torque", "N*m"),
        "Gearhead continuous torque (RMS)", note="while running",
    )  # fmt: skip
    yield check_of(
        at_most("gearhead_intermittent_torque", peak, gearhead.intermittent_torque, "torque", "N*m"),
        "Gearhead intermittent torque", case.figure("gear_torque_time"),
    )  # fmt: skip
    for name, title, limit in (
        ("gearhead_intermittent_speed", "Gearhead intermittent input speed", gearhead.intermittent_input_speed),
        ("motor_speed", "Motor permissible speed", motor.max_speed),
    ):
        yield check_of(at_most(name, speed, limit, *rotary), title, when)


def _figures(case: ServoCase) -> tuple[Figure, ...]:
    """What the loop did, where nothing limits it."""
    per_speed, time, top = case.train.motor_per_speed, case.figure("time"), case.profile.top_speed
    rms = math.sqrt(case.figure("speed_error_square") / time) / per_speed
    velocity, sets = case.loops.velocity, case.spec.load.motors
    speed, share, heat, energy = ("speed", "m/s"), ("dimensionless", "%"), ("temperature", "degC"), ("energy", "W*h")
    length = ("length", "mm")
    rows: list[tuple[str, str, float, str, str, float | None]] = [
        ("tracking_error_peak", "Tracking error, peak", case.figure("speed_error") / per_speed, *speed,
         case.figure("speed_error_time")),
        ("tracking_error_rms", "Tracking error, RMS", rms, *speed, None),
        ("tracking_error_rms_share", "Tracking error, RMS, of top speed", rms / top if top else math.nan, *share, None),
        ("position_error_peak", "Position error at the load, peak", case.figure("angle_error") / per_speed, *length,
         case.figure("angle_error_time")),
        ("voltage_saturation", "Time at the voltage limit", case.figure("time_at_voltage_limit") / time, *share, None),
        ("current_limitation", "Time at the current limit", case.figure("time_at_current_limit") / time, *share, None),
        ("current_bandwidth", "Current loop, bandwidth (-3 dB)", case.loops.all[0].bandwidth, "frequency", "Hz", None),
        ("bandwidth", "Velocity loop, bandwidth (-3 dB)", velocity.bandwidth, "frequency", "Hz", None),
        ("phase_margin", "Velocity loop, phase margin", velocity.phase_margin, "angle", "deg", None),
        ("gain_margin", "Velocity loop, gain margin (factor)", velocity.gain_margin, "dimensionless", "1", None),
        ("overshoot", "Velocity loop, overshoot of a step", velocity.overshoot, *share, None),
        ("rms_current", "Motor current, RMS", case.figure("rms_current"), "current", "A", None),
        ("peak_current", "Motor current, peak", case.figure("current"), "current", "A", case.figure("current_time")),
        ("winding_end", "Winding at the end, from cold", case.figure("winding"), *heat, None),
        ("bus_lowest", "Supply voltage, lowest", case.figure("bus_lowest"), "voltage", "V", None),
        ("energy_in", "Electrical energy taken, all sets", case.figure("energy_in") * sets, *energy, None),
        ("energy_returned", "Electrical energy returned, all sets", case.figure("energy_back") * sets, *energy, None),
    ]  # fmt: skip
    if case.shaft:
        rows.append(("resonance", "Resonance of motor and load", case.loops.resonance, "frequency", "Hz", None))
    return tuple(Figure(name=n, title=t, value=v, kind=k, unit=u, at_time=at) for n, t, v, k, u, at in rows)


def _series(case: ServoCase) -> dict[str, NDArray[np.float64]]:
    """The kept rows as columns, seen from the load and from the supply."""
    rows: Any = case.out.series
    per_speed = case.train.motor_per_speed
    return {
        "time": rows["time"],
        "speed_reference": rows["reference"] / per_speed,
        "speed": rows["load_speed"] * case.train.radius,
        "error": rows["reference"] / per_speed - rows["load_speed"] * case.train.radius,
        "position_error": rows["position_error"] / per_speed,
        "motor_speed": rows["motor_speed"],
        "current": rows["current"],
        "voltage": rows["voltage"],
        "motor_torque": case.train.torque_constant * rows["current"],
        "gearhead_torque": rows["gear_torque"],
        "winding_temperature": rows["winding"],
        "supply_power": rows["voltage"] * rows["current"] * case.spec.load.motors,
    }


def _assumptions(case: ServoCase) -> list[str]:
    """What the model takes for granted, as sentences."""
    measured = "counted by the encoder" if case.spec.control.speed_from == "counts" else "measured exactly"
    said = [
        "the wheel turns at speed over radius; all driven wheels share the load alike; one motor set is simulated",
        "a gear's efficiency is the catalogue's maximum, at any torque; driven backward it is the same",
        f"the no-load current is Coulomb friction of the motor; the motor's angle is {measured}",
        "each loop answers one period of its own late; currents are those of a DC motor between two terminals",
        "the profile starts in equilibrium at its first speed and at the ambient temperature, and runs once",
        "what friction and iron lose warms the housing; what grows with the square of the speed counts as at top speed",
    ]
    if not case.periodic:
        said.append("the winding's resistance is that at 25 °C: a thermal figure is unknown, or plant.warming is off")
    if case.shaft:
        said.append(f"motor and load are two masses on {case.shaft.stiffness:.4g} N·m/rad at the load's shaft")
    return said


def _warnings(case: ServoCase, found: tuple[Check, ...], lacking: list[str]) -> tuple[str, ...]:
    """What the reader must know, and what to change."""
    said = [*loop_warnings(case.loops.all, case.profile), *lacking]
    if case.shaft:
        said += resonance_warning(case.loops, case.shaft)
    encoder, controller = case.drive_set.encoder, case.drive_set.controller
    if encoder and controller:
        period = case.cascade.velocity_period
        said += resolution_warning(encoder.lines, period, case.cascade.velocity_kp, controller.peak_current)
    if "tracking_error" in {check.name for check in found if check.status == "fail"}:
        why = (
            "voltage"
            if case.figure("time_at_voltage_limit")
            else "current"
            if case.figure("time_at_current_limit")
            else ""
        )
        error = show(case.figure("speed_error") / case.train.motor_per_speed, "m/s", "speed", 3)
        said.append(
            f"the drive does not follow the profile: off by {error}" + (f"; the {why} does not suffice" * bool(why))
        )
    unknown = [check.title for check in found if check.status == "unknown"]
    if unknown:
        said.append(f"unknown: {', '.join(unknown)}")
    return tuple(said)
