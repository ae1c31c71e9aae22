"""What a march in closed loop means: every demand against its limit, and the figures that have none.

Each check tells its worst moment. A figure that the catalogue lacks leaves its check unknown; what the spec does not
limit is not checked, but for the tracking itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from drivesizer.catalog import Controller, Encoder
from drivesizer.checks import CheckColumn, at_least, at_most, fits
from drivesizer.control_design import LinearLoop
from drivesizer.loop_warnings import speed_quantum
from drivesizer.machines import WheeledVehicle
from drivesizer.march import FOLLOWS, Peak, Run
from drivesizer.plant import DriveTrain, Mode, Regime
from drivesizer.profile import Profile
from drivesizer.results import Check, DriveSet, Figure
from drivesizer.spec import RobotSpec
from drivesizer.thermal import current_derating, steady_winding_temperature

__all__ = ["METHOD", "Case", "check_of", "checks", "figures", "quantum"]

METHOD = "closed loop"


class Case(NamedTuple):
    """A march and all that it was made of."""

    spec: RobotSpec
    drive_set: DriveSet
    profile: Profile
    train: DriveTrain
    usable_voltage: float  # V, NaN unknown
    loop: LinearLoop
    run: Run
    free: Run  # the same without limits: what following takes; the run itself where that is unstable

    @property
    def rms_current(self) -> float:
        """RMS current over the whole profile, rest included [A]."""
        tally = self.run.motion.tally
        return math.sqrt(sum(tally.square) / self.run.duration)

    @property
    def controller(self) -> Controller:
        """The controller; one of which nothing is known where the set has none."""
        return self.drive_set.controller or Controller()

    @property
    def encoder(self) -> Encoder:
        """The encoder; one of which nothing is known where the set has none."""
        return self.drive_set.encoder or Encoder()


def check_of(column: CheckColumn, title: str, at_time: float | None = None, note: str = "") -> Check:
    """The record of a check of single figures."""
    return column.at((), METHOD, title=title, at_time=at_time, note=note)


def checks(case: Case) -> tuple[Check, ...]:
    """Every demand of a march against its limit; where there is no part, or nothing limits it, there is no check."""
    found = (*_loop(case), *_electrical(case), *_heat(case), *_gearhead(case), *_speed(case), *_load(case))
    return tuple(check for check in found if check.limit != math.inf)


def _loop(case: Case) -> Iterator[Check]:
    """Stability, tracking and bandwidth."""
    loop, run, top = case.loop, case.run, case.profile.top_speed
    margin = "none" if math.isnan(loop.phase_margin) else f"{math.degrees(loop.phase_margin):.3g}°"
    yield check_of(
        fits("stability", loop.stable and not loop.phase_margin <= 0.0, True), "Stability of the linear loop",
        note=f"phase margin {margin}; largest pole {loop.pole_radius:.4g}, stable inside 1",
    )  # fmt: skip
    worst = run.error.value / case.train.motor_per_speed
    yield check_of(
        at_most("tracking_error", worst, FOLLOWS * top if top else math.nan, "speed", "m/s"), "Tracking error",
        run.error.time, f"to follow is to stay within {FOLLOWS:.0%} of the top speed, a convention of this program",
    )  # fmt: skip
    if case.spec.needs.bandwidth is not None:
        yield check_of(
            at_least("bandwidth", case.spec.needs.bandwidth, loop.bandwidth, "frequency", "Hz"), "Closed-loop bandwidth"
        )


def _electrical(case: Case) -> Iterator[Check]:
    """Voltage and current that the controller must give."""
    run, controller, rms = case.run, case.controller, case.rms_current
    voltage, current = case.free.demanded_voltage, case.free.demanded_current
    yield check_of(
        at_most("supply_voltage", voltage.value, case.usable_voltage, "voltage", "V"), "Motor voltage", voltage.time,
        "that following takes; what the controller can give at the lowest supply voltage",
    )  # fmt: skip
    yield check_of(
        at_most("controller_peak_current", current.value, controller.peak_current, "current", "A"),
        "Controller peak current", current.time, "that following takes",
    )  # fmt: skip
    yield check_of(
        at_most("controller_peak_time", _over(case), controller.peak_time, "time", "s"),
        "Time above the continuous current", run.longest_over_at if run.longest_over else None,
    )  # fmt: skip
    yield check_of(
        at_most("controller_continuous_current", rms, controller.continuous_current, "current", "A"),
        "Controller continuous current (RMS)",
    )  # fmt: skip
    if case.spec.supply.current is not None:
        power = run.motion.tally.power * case.spec.load.motors
        drawn = power / case.spec.supply.lowest
        yield check_of(
            at_most("supply_current", drawn, case.spec.supply.current, "current", "A"), "Supply current, all sets",
            run.motion.tally.power_at, "electrical power over the lowest supply voltage",
        )  # fmt: skip


def _over(case: Case) -> float:
    """Longest time above the continuous current [s]; NaN where that is unknown."""
    return math.nan if math.isnan(case.controller.continuous_current) else case.run.longest_over


def _heat(case: Case) -> Iterator[Check]:
    """The motor's RMS current and its winding's temperature."""
    motor, ambient, rms = case.drive_set.motor, case.spec.environment.ambient, case.rms_current
    limit, derating = motor.max_winding_temperature, float(current_derating(ambient, motor.max_winding_temperature))
    yield check_of(
        at_most("motor_nominal_current", rms, motor.nominal_current * derating, "current", "A"),
        "Motor nominal current (RMS)", note="the nominal current in this ambient" if derating != 1.0 else "",
    )  # fmt: skip
    winding = winding_temperature(case)
    runs_away = "runs away: the copper loss grows faster than it is carried off"
    yield check_of(
        at_most("winding_temperature", winding, limit, "temperature", "degC", zero=ambient), "Winding temperature",
        note=runs_away if math.isinf(winding) else "steady mean, copper loss",
    )  # fmt: skip


def winding_temperature(case: Case) -> float:
    """Steady mean temperature of the winding [K]; NaN unknown, infinite when it runs away."""
    motor = case.drive_set.motor
    R_th = motor.thermal_resistance_winding, motor.thermal_resistance_housing
    return float(steady_winding_temperature(case.spec.environment.ambient, motor.resistance, *R_th, case.rms_current))


def _gearhead(case: Case) -> Iterator[Check]:
    """Torque and speed of the gearhead."""
    run, gearhead = case.run, case.drive_set.gearhead
    torque, speed = _peak(case, "gear_torque"), run.motion.tally
    sustained, note = run.sustained, "highest at constant reference"
    if sustained is None:
        sustained, note = Peak(), "the profile has no constant stretch: the peak"
        sustained.see(speed.speed, speed.speed_at)
    rotary = ("rotary_speed", "rpm")
    yield check_of(
        at_most("gearhead_continuous_torque", _running_torque(case), gearhead.continuous_torque, "torque", "N*m"),
        "Gearhead continuous torque (RMS)", note="while running",
    )  # fmt: skip
    yield check_of(
        at_most("gearhead_intermittent_torque", torque.value, gearhead.intermittent_torque, "torque", "N*m"),
        "Gearhead intermittent torque", torque.time,
    )  # fmt: skip
    yield check_of(
        at_most("gearhead_continuous_speed", sustained.value, gearhead.continuous_input_speed, *rotary),
        "Gearhead continuous input speed", sustained.time, note,
    )  # fmt: skip
    yield check_of(
        at_most("gearhead_intermittent_speed", speed.speed, gearhead.intermittent_input_speed, *rotary),
        "Gearhead intermittent input speed", speed.speed_at,
    )  # fmt: skip


def _speed(case: Case) -> Iterator[Check]:
    """The motor's speed and all that counts it."""
    motor, encoder, controller = case.drive_set.motor, case.encoder, case.controller
    speed, when = case.run.motion.tally.speed, case.run.motion.tally.speed_at
    rotary, lines = ("rotary_speed", "rpm"), encoder.lines * speed / (2 * math.pi)
    yield check_of(at_most("motor_speed", speed, motor.max_speed, *rotary), "Motor permissible speed", when)
    yield check_of(at_most("encoder_speed", speed, encoder.max_speed, *rotary), "Encoder speed", when)
    for name, part, limit in (("encoder", "Encoder", encoder.max_frequency),
                              ("controller", "Controller", controller.max_encoder_frequency)):  # fmt: skip
        yield check_of(
            at_most(f"{name}_frequency", lines, limit, "frequency", "kHz"), f"{part} frequency of encoder lines", when
        )
    if motor.kind == "brushless":
        electrical = speed * motor.pole_pairs
        yield check_of(
            at_most("controller_electrical_speed", electrical, controller.max_speed_sine, *rotary),
            "Controller electrical speed", when, "speed times pole pairs, sinusoidal commutation",
        )  # fmt: skip


def _load(case: Case) -> Iterator[Check]:
    """What the wheels must put on the floor."""
    load = case.spec.load
    assert isinstance(load, WheeledVehicle)  # nothing else is validated
    if load.friction_coefficient is None:
        return
    weight = case.train.mass * case.spec.environment.gravity * math.cos(load.slope)
    force = _peak(case, "traction")
    yield check_of(
        at_most("traction", force.value, load.friction_coefficient * weight, "force", "N"), "Traction per wheel",
        force.time, "the driven wheels carry the whole weight, each the same",
    )  # fmt: skip


def _affine(case: Case, mode: Mode, what: str) -> tuple[float, float]:
    """Gearhead torque [N*m] or traction [N] of a mode: at no current, and per ampere."""
    if what == "gear_torque":
        return mode.gear_torque
    fixed, per_ampere = mode.acceleration
    return mode.resistance_force + case.train.mass * fixed, case.train.mass * per_ampere


def _peak(case: Case, what: str) -> Peak:
    """The largest of what is affine in the current, out of each mode's extreme currents."""
    motion, peak = case.run.motion, Peak()
    tally = motion.tally
    for mode in motion.modes:
        r = mode.regime
        if tally.time[r]:
            fixed, per_ampere = _affine(case, mode, what)
            peak.see(fixed + per_ampere * tally.high[r], tally.high_at[r])
            peak.see(fixed + per_ampere * tally.low[r], tally.low_at[r])
    return peak


def _running_torque(case: Case) -> float:
    """RMS torque at the gearhead's output while the motor turns [N*m]."""
    motion = case.run.motion
    tally, square, time = motion.tally, 0.0, 0.0
    for mode in motion.modes:
        if mode.regime != Regime.STANDING:
            r, (a, b) = mode.regime, mode.gear_torque
            square += a * a * tally.time[r] + 2 * a * b * tally.charge[r] + b * b * tally.square[r]
            time += tally.time[r]
    return math.sqrt(max(square, 0.0) / time) if time else 0.0


def figures(case: Case) -> tuple[Figure, ...]:
    """What the closed loop did, where nothing limits it."""
    run, per_speed, top = case.run, case.train.motor_per_speed, case.profile.top_speed
    tally, sets = run.motion.tally, case.spec.load.motors
    peak, rms = run.error.value / per_speed, math.sqrt(run.error_square / run.duration) / per_speed
    speed, share, energy = ("speed", "m/s"), ("dimensionless", "%"), ("energy", "W*h")
    loop, when, of_top = case.loop, run.error.time, 1.0 / top if top else math.nan
    distance = case.profile.distance - run.motion.x / per_speed
    rows: list[tuple[str, str, float, str, str, float | None]] = [
        ("tracking_error_peak", "Tracking error, peak", peak, *speed, when),
        ("tracking_error_peak_share", "Tracking error, peak, of top speed", peak * of_top, *share, when),
        ("tracking_error_rms", "Tracking error, RMS", rms, *speed, None),
        ("tracking_error_rms_share", "Tracking error, RMS, of top speed", rms * of_top, *share, None),
        ("distance_error", "Distance left at the end", distance, "length", "mm", None),
        ("voltage_saturation", "Time at the voltage limit", run.saturated / run.duration, *share, None),
        ("current_limitation", "Time at the current limit", run.current_limited / run.duration, *share, None),
        ("bandwidth", "Closed-loop bandwidth (-3 dB)", loop.bandwidth, "frequency", "Hz", None),
        ("phase_margin", "Phase margin", loop.phase_margin, "angle", "deg", None),
        ("gain_margin", "Gain margin (factor)", loop.gain_margin, "dimensionless", "1", None),
        ("rms_current", "Motor current, RMS", case.rms_current, "current", "A", None),
        ("speed_quantum", "One encoder count per period, at the load", quantum(case) / per_speed, *speed, None),
        ("peak_power", "Electrical power, peak, all sets", tally.power * sets, "power", "W", tally.power_at),
        ("energy_in", "Electrical energy taken, all sets", tally.energy_in * sets, *energy, None),
        ("energy_returned", "Electrical energy returned, all sets", tally.energy_back * sets, *energy, None),
    ]  # fmt: skip
    return tuple(Figure(name=n, title=t, value=v, kind=k, unit=u, at_time=at) for n, t, v, k, u, at in rows)


def quantum(case: Case) -> float:
    """Smallest step of a speed that is counted over one control period [rad/s]."""
    return speed_quantum(case.encoder.lines, case.run.period)
