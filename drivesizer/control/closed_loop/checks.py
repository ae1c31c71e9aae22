"""A simulation in closed loop judged: checks with their worst moments, figures seen from the load, remedies."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Controller, Encoder
from drivesizer.control.closed_loop.run import FOLLOWS, ClosedLoop
from drivesizer.control.loop_design import stated_margin
from drivesizer.control.validation import Validation
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform import floor_friction
from drivesizer.load_cases.profile import SPEED, profile_of
from drivesizer.loads.course import Profile, course
from drivesizer.loads.recorded import Recorded
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.physics.battery import current_of_power
from drivesizer.physics.counted_speed import speed_quantum
from drivesizer.physics.load_cycle import lasting_speeds, rms
from drivesizer.physics.power_stage import of_the_source
from drivesizer.physics.thermal import (
    DATA_TEMPERATURE,
    rated_ambient,
    resistance_25,
    resistance_at,
    steady_winding,
    two_bodies,
)
from drivesizer.results.check_columns import PROPOSAL, CheckColumn, at_least, at_most, between, fits
from drivesizer.results.drive_set import voltage_assumption
from drivesizer.results.ratings import continuous_speed_limit, controller_current, nominal_current_limit, unless_printed
from drivesizer.results.sizing import Check, Figure
from drivesizer.spec.drive import Control, VelocityLoop
from drivesizer.spec.motions import Move, SCurve, Trapezoid, Triangle
from drivesizer.spec.mounting import controller_needed, motor_needed, rise_needed
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show, to_si

__all__ = ["checks", "electrical_checks", "figures", "other_gains", "rounded_ramps", "series", "series_units"]


# -- Figures and time series of a closed-loop simulation, seen from the load.


_TRAVEL = {"linear": ("length", "mm"), "rotary": ("angle", "deg")}
_SHARE, _CURRENT, _VOLTAGE = ("dimensionless", "%"), ("current", "A"), ("voltage", "V")
_HERTZ, _HEAT, _ENERGY = ("frequency", "Hz"), ("temperature", "degC"), ("energy", "W*h")
_Row = tuple[str, str, float, tuple[str, str], float | None]


def figures(case: ClosedLoop) -> tuple[Figure, ...]:
    """Figures of a simulation, without limits of their own."""
    rows = [*_tracking(case), *_loop_rows(case), *_electrical_rows(case)]
    if case.task.cycles > 1:
        rows.append(("mission", "Simulated time", case.figure("time"), ("time", "min"), None))
    return tuple(Figure(name=n, title=t, value=v, kind=k, unit=u, at_time=at) for n, t, v, (k, u), at in rows)


def quantum(case: ClosedLoop) -> float:
    """Smallest step of the counted speed over its counting time [rad/s]; NaN unknown."""
    encoder, periods = case.drive_set.encoder, max(case.controller.counted_over, 1)
    return speed_quantum(encoder.lines, case.velocity_period, periods) if encoder else math.nan


def _tracking(case: ClosedLoop) -> list[_Row]:
    """Errors of the load against the reference; of two masses also those of the motor, as at the load."""
    radius, time, top = case.train.radius, case.figure("time"), case.profile.top_speed
    speed, travel, of_top = SPEED[case.spec.load.axis], _TRAVEL[case.spec.load.axis], 1.0 / top if top else math.nan
    peak, when = case.figure("load_speed_error") * radius, case.figure("load_speed_error_time")
    rms = math.sqrt(case.figure("load_speed_error_square") / time) * radius
    left = case.profile.distance * case.task.cycles - case.figure("load_angle") * radius
    rows: list[_Row] = [
        ("tracking_error_peak", "Tracking error, peak", peak, speed, when),
        ("tracking_error_peak_share", "Tracking error, peak, of top speed", peak * of_top, _SHARE, when),
        ("tracking_error_rms", "Tracking error, RMS", rms, speed, None),
        ("tracking_error_rms_share", "Tracking error, RMS, of top speed", rms * of_top, _SHARE, None),
        ("position_error_peak", "Position error at the load, peak", case.figure("load_angle_error") * radius, travel,
         case.figure("load_angle_error_time")),
        ("distance_error", "Final position error, load", left, travel, None),
        *(_motor_errors(case) if case.train.flexible else ()),
        ("voltage_saturation", "Time at the voltage limit", case.figure("time_at_voltage_limit") / time, _SHARE, None),
        ("current_limitation", "Time at the current limit", case.figure("time_at_current_limit") / time, _SHARE, None),
        ("speed_quantum", "One encoder count, at the load",
         quantum(case) / case.train.motor_per_speed, speed, None),
    ]  # fmt: skip
    return rows if top else [row for row in rows if not row[0].endswith("_share")]


def _motor_errors(case: ClosedLoop) -> list[_Row]:
    """The same errors of the motor's shaft, through the total ratio as if the shaft were stiff."""
    per_speed, time = case.train.motor_per_speed, case.figure("time")
    speed, travel = SPEED[case.spec.load.axis], _TRAVEL[case.spec.load.axis]
    left = case.profile.distance * case.task.cycles - case.figure("angle") / per_speed
    return [
        ("motor_tracking_error_peak", "Tracking error of the motor, as at the load, peak",
         case.figure("speed_error") / per_speed, speed, case.figure("speed_error_time")),
        ("motor_tracking_error_rms", "Tracking error of the motor, as at the load, RMS",
         math.sqrt(case.figure("speed_error_square") / time) / per_speed, speed, None),
        ("motor_position_error_peak", "Position error of the motor, as at the load, peak",
         case.figure("angle_error") / per_speed, travel, case.figure("angle_error_time")),
        ("motor_distance_error", "Final position error, motor, as at the load", left, travel, None),
    ]  # fmt: skip


def _loop_rows(case: ClosedLoop) -> list[_Row]:
    loops, velocity = case.loops, case.loops.velocity
    rows: list[_Row] = [
        ("bandwidth", "Velocity loop, bandwidth (-3 dB)", velocity.bandwidth, _HERTZ, None),
        ("phase_margin", "Velocity loop, phase margin", velocity.phase_margin, ("angle", "deg"), None),
        ("gain_margin", "Velocity loop, gain margin (factor)", velocity.gain_margin, ("dimensionless", "1"), None),
        ("overshoot", "Velocity loop, overshoot of a step", velocity.overshoot, _SHARE, None),
    ]
    if loops.current:
        rows.insert(0, ("current_bandwidth", "Current loop, bandwidth (-3 dB)", loops.current.bandwidth, _HERTZ, None))
    if case.train.flexible:
        rows.append(("resonance", "Resonance of motor and load", loops.resonance, _HERTZ, None))
    return rows


def _electrical_rows(case: ClosedLoop) -> list[_Row]:
    motors, seen, feed = (
        case.spec.load.motors,
        case.figure,
        case.spec.feed_of(case.drive_set.controller, case.drive_set.brake),
    )
    standby = float(feed.stage.standby)
    peak = float(of_the_source(seen("power") + standby, feed)) * motors
    taken = (seen("energy_in") + standby * seen("time")) * motors + seen("energy_resisted")
    rows: list[_Row] = [
        ("rms_current", "Motor current, RMS", seen("rms_current"), _CURRENT, None),
        ("peak_current", "Motor current, peak", seen("current"), _CURRENT, seen("current_time")),
        ("bus_lowest", "Supply voltage, lowest", seen("bus_lowest"), _VOLTAGE, None),
        (
            "peak_power",
            "Electrical power, peak, all drives",
            peak,
            ("power", "W"),
            seen("power_time"),
        ),
        ("energy_in", "Electrical energy taken, all drives", taken, _ENERGY, None),
        ("energy_returned", "Electrical energy returned, all drives", seen("energy_returned") * motors, _ENERGY, None),
    ]
    if case.periodic:
        rows.insert(2, ("winding_end", "Winding at the end, from ambient", seen("winding"), _HEAT, None))
    return rows


def series_units(case: ClosedLoop) -> dict[str, tuple[str, str]]:
    """Kind and unit of the trade of each column of the series."""
    speed, travel = SPEED[case.spec.load.axis], _TRAVEL[case.spec.load.axis]
    units = {
        "time": ("time", "s"),
        "speed_reference": speed,
        "speed": speed,
        "error": speed,
        "motor_error": speed,
        "position_error": travel,
        "motor_position_error": travel,
        "motor_speed": ("rotary_speed", "rpm"),
        "current": _CURRENT,
        "voltage": _VOLTAGE,
        "motor_torque": ("torque", "mN*m"),
        "gearhead_torque": ("torque", "N*m"),
        "winding_temperature": _HEAT,
        "supply_power": ("power", "W"),
    }
    return {name: unit for name, unit in units.items() if name in series(case)}


def _supply_power(case: ClosedLoop, voltage: Any, current: Any) -> Any:
    """Power out of the source, of all drives [W]: losses of power stages and of the supply's resistance included."""
    feed = case.spec.feed_of(case.drive_set.controller, case.drive_set.brake)
    at_stage = voltage * current + feed.lost(current) + feed.stage.standby
    return of_the_source(at_stage, feed) * case.spec.load.motors


def series(case: ClosedLoop) -> dict[str, NDArray[np.float64]]:
    """Recorded rows of the first cycle as columns, seen from the load and from the supply."""
    rows: Any = case.out.series
    per_speed = case.train.motor_per_speed
    reference, speed = rows["reference"] / per_speed, rows["load_speed"] * case.train.radius
    found = {
        "time": rows["time"],
        "speed_reference": reference,
        "speed": speed,
        "error": reference - speed,
        "motor_error": reference - rows["motor_speed"] / per_speed,
        "position_error": rows["load_position_error"] * case.train.radius,
        "motor_position_error": rows["position_error"] / per_speed,
        "motor_speed": rows["motor_speed"],
        "current": rows["current"],
        "voltage": rows["voltage"],
        "motor_torque": case.train.torque_constant * rows["current"],
        "gearhead_torque": rows["gear_torque"],
        "winding_temperature": rows["winding"],
        "supply_power": _supply_power(case, rows["voltage"], rows["current"]),
    }
    if not case.periodic:
        del found["winding_temperature"]  # it is held at 25 degC
    if not case.train.flexible:  # rigid, the motor's errors are the load's
        del found["motor_error"], found["motor_position_error"]
    return found


# -- Checks of a simulation in closed loop: every demand against its limit, with its worst moment.
#
# A figure that the catalogue lacks leaves its check unknown; a figure that the spec does not limit is not checked,
# except for the tracking error.


METHOD = "closed loop"


def checks(case: ClosedLoop) -> tuple[Check, ...]:
    """Every demand of a simulation against its limit; no check where there is no part or no limit."""
    found = (*_loop(case), *_electrical(case), *_heat(case), *_gearhead(case), *_speed(case), *_load(case))
    return tuple(check for check in found if check.limit != math.inf)


def electrical_checks(case: ClosedLoop) -> tuple[Check, ...]:
    """Those of what the controller must supply alone: of the others none hangs on the periodic steady state's cycle."""
    return tuple(check for check in _electrical(case) if check.limit != math.inf)


def _check(column: CheckColumn, at_time: float | None = None, note: str = "", *, rotary: bool = False) -> Check:
    """The record of a check of single figures."""
    return column.at((), METHOD, at_time=at_time, note=note, rotary=rotary)


def _most(case: ClosedLoop, name: str, check: Callable[[float], CheckColumn], *, required: bool = False) -> CheckColumn:
    """A check of the largest value of a figure; for a long motion unknown where it fails only with its allowance."""
    value = case.required(name) if required else case.figure(name)
    return _allowed(check, value, case.allowance(name, required=required))


def _allowed(check: Callable[[float], CheckColumn], value: float, more: float) -> CheckColumn:
    return check(value) if more == 1.0 else between(check(value), check(more * value))


def _resisted(case: ClosedLoop, name: str, check: Callable[[float], CheckColumn], power: bool = False) -> CheckColumn:
    """A check of a figure that grows with the winding's resistance, between bounds for a motor of unknown heat.

    The simulation has the winding at 25 °C; it may be as cold as the ambient, and as warm as its largest current heats
    it in the steady state, up to its permitted temperature.
    """
    motor, ambient = case.drive_set.motor, case.spec.environment.ambient
    read = case.drawn if power else case.required
    value, more = read(name), case.allowance(name, required=not power)
    if two_bodies(motor).known or not case.spec.plant.warming:
        return _allowed(check, value, more)
    current = read("current")
    R_25, hottest = (
        resistance_25(motor),
        np.fmin(steady_winding(motor, ambient, current), motor.max_winding_temperature),
    )
    cooler, warmer = (float(resistance_at(R_25, T) - R_25) for T in (min(ambient, DATA_TEMPERATURE), hottest))
    more_of = _bus_current if power else _volts
    return between(check(more_of(case, value, cooler, current)), check(more_of(case, more * value, warmer, current)))


def _volts(_: ClosedLoop, volts: float, ohms: float, current: float) -> float:
    """Largest voltage at so much more resistance."""
    return volts + ohms * current


def _bus_current(case: ClosedLoop, current: float, ohms: float, largest: float) -> float:
    """Largest current of the supply at so much more resistance in each motor; NaN where it cannot give that."""
    supply = case.spec.supply
    ohm = supply.resistance or 0.0
    power = current * (supply.lowest - ohm * current) + case.spec.load.motors * ohms * largest**2
    return float(current_of_power(power, supply.lowest, ohm))


def _controller(case: ClosedLoop) -> Controller:
    """The controller; one of unknown figures where the drive has none."""
    return case.drive_set.controller or Controller()


def _loop(case: ClosedLoop) -> Iterator[Check]:
    """Stability, tracking and bandwidth."""
    loops, top = case.loops.all, case.profile.top_speed
    worst = max(loops, key=lambda loop: loop.pole_radius)
    margins = ", ".join(
        f"{loop.name} {'none' if math.isnan(loop.phase_margin) else f'{math.degrees(loop.phase_margin):.3g}°'}"
        for loop in loops
    )
    yield _check(
        fits("stability", all(loop.stable for loop in loops), True),
        note=f"phase margin: {margins}; largest pole {worst.pole_radius:.4g}, stable inside 1",
    )
    yield from _phase_margin(case)
    if top:
        yield _check(
            _most(case, "load_speed_error", lambda x: at_most("tracking_error", x * case.train.radius, FOLLOWS * top)),
            case.figure("load_speed_error_time"),
            f"to follow is to stay within {FOLLOWS:.0%} of the top speed, a convention of this program",
            rotary=case.spec.load.axis == "rotary",
        )
    if case.spec.needs.bandwidth is not None:
        got = case.loops.velocity.bandwidth
        yield _check(at_least("bandwidth", case.spec.needs.bandwidth, got))


def _phase_margin(case: ClosedLoop) -> Iterator[Check]:
    """The least phase margin of all loops; an unstable one has none, and fails for that."""
    known = [loop for loop in case.loops.all if not math.isnan(loop.phase_margin)]
    if known and all(loop.stable for loop in case.loops.all):
        least = min(known, key=lambda loop: loop.phase_margin)
        yield _check(
            at_least("phase_margin", stated_margin(case.spec), least.phase_margin),
            note=f"of the sampled {least.name} loop, delays and counts as they are",
        )


def _electrical(case: ClosedLoop) -> Iterator[Check]:
    """Voltage and current that the controller must supply."""
    controller, supply = _controller(case), case.spec.supply
    ideal = "required to follow the profile without limits"

    def peak(x: float) -> CheckColumn:
        found = at_most("controller_peak_current", x, controller.peak_current)
        return unless_printed(found, "peak_current", case.drive_set) if _is_inside(case) else found

    volts = _resisted(case, "stage_voltage", lambda x: at_most("supply_voltage", x, case.usable_for(x)))
    assumed = voltage_assumption(case.spec, case.drive_set.controller, float(volts.limit))
    yield _check(
        volts,
        case.required("stage_voltage_time"),
        f"{ideal}; limit: output of the controller at the lowest supply voltage"
        + (", with what resistances before the motor take of it" if case.spec.resists else "")
        + (f"; {assumed}" if assumed else ""),
    )
    yield _check(_most(case, "current_demand", peak, required=True), case.required("current_demand_time"), ideal)
    share = _peak_share(case)
    if share != 0.0:
        yield _check(
            between(*(at_most("controller_i2t", x, 1.0) for x in (share, share * case.allowance("i2t_share")))),
            note="highest state: at 100 % the controller limits to the continuous current",
        )
    needed = controller_needed(case.spec, 0.0)
    lasting = _most(
        case, "rms_current",
        lambda x: at_most("controller_continuous_current", x, _lasting_current(case), needed=needed),
    )  # fmt: skip
    yield _check(unless_printed(lasting, "nominal_current", case.drive_set) if _is_inside(case) else lasting)
    if supply.current is not None:
        yield _check(
            _resisted(case, "bus_current", lambda x: at_most("supply_current", x, supply.current), power=True),
            case.drawn("bus_current_time"),
            "electrical power over the supply's voltage",
        )


def _is_inside(case: ClosedLoop) -> bool:
    """Whether the controller is that of an actuator."""
    return _controller(case).part == (case.drive_set.actuator.part if case.drive_set.actuator else None)


def _lasting_current(case: ClosedLoop) -> float:
    """Continuous current of the controller in the case's ambient [A]."""
    return float(controller_current(_controller(case), case.spec.environment.ambient))


def _peak_share(case: ClosedLoop) -> float:
    """Highest state of the I²t sum; 0 where the continuous current is never exceeded, NaN where a figure is unknown."""
    controller, peak = _controller(case), case.figure("current")
    if case.allowance("current") * peak <= _lasting_current(case):
        return 0.0
    return case.figure("i2t_share") if controller.peak_time > 0.0 else math.nan


def _heat(case: ClosedLoop) -> Iterator[Check]:
    """The motor's RMS current, and the winding's highest temperature in the periodic steady state."""
    figures, ambient = case.drive_set.motor, case.spec.environment.ambient
    limit = figures["max_winding_temperature"]
    rms_current = _most(
        case, "rms_current", lambda x: nominal_current_limit(x, figures, ambient, motor_needed(case.spec, 0.0))
    )
    yield _check(
        unless_printed(rms_current, "nominal_current", case.drive_set),
        note="the nominal current in this ambient" if ambient != rated_ambient(figures) else "",
    )
    winding, note = _winding(case)
    if math.isinf(winding):
        note = "thermal runaway: the copper loss grows faster than the heat is dissipated"
    warmer = ambient + (winding - ambient) * case.allowance("rms_current") ** 2
    yield _check(
        between(
            *(
                at_most("winding_temperature", T, limit, zero=ambient, needed=rise_needed(case.spec, 0.0))
                for T in (winding, warmer)
            )
        ),
        note=note,
    )


def _winding(case: ClosedLoop) -> tuple[float, str]:
    """Temperature of the winding [K], NaN unknown, and its kind in words."""
    if case.periodic:
        return case.periodic["winding"], "highest in the periodic steady state"
    motor, rms = case.drive_set.motor, case.figure("rms_current")
    return float(steady_winding(motor, case.spec.environment.ambient, rms)), "steady mean, copper loss"


def _gearhead(case: ClosedLoop) -> Iterator[Check]:
    """Torque and speed of the gearhead."""
    gearhead, speed, when = case.drive_set.gearhead, case.figure("speed"), case.figure("speed_time")

    def torque(x: float) -> CheckColumn:
        found = at_most("gearhead_continuous_torque", x, gearhead.continuous_torque)
        return unless_printed(found, "nominal_torque", case.drive_set)

    def peak(x: float) -> CheckColumn:
        found = at_most("gearhead_intermittent_torque", x, gearhead.intermittent_torque)
        return unless_printed(found, "peak_torque", case.drive_set)

    if case.profile.top_speed:
        yield _check(
            _most(case, "rms_gear_torque_running", lambda x: torque(x if speed else 0.0)), note="while running"
        )
    else:
        yield _check(torque(_static_torque(case)), note="of the load at rest")
    yield _check(_most(case, "gear_torque", peak), case.figure("gear_torque_time"))
    mean, sustained = _lasting(case.profile)
    yield _check(
        continuous_speed_limit(gearhead, mean, sustained, case.train.motor_per_speed),
        note="of the reference: the lasting speed by the maker's rule, or the mean",
    )
    yield _check(
        _most(case, "speed", lambda x: at_most("gearhead_intermittent_speed", x, gearhead.intermittent_input_speed)),
        when,
    )


@lru_cache(maxsize=1)  # of samples on one motion it is the same
def _lasting(profile: Profile) -> tuple[Any, ...]:
    """Mean speed of a profile and the one that it sustains."""
    moved = course(profile)
    return tuple(lasting_speeds(moved.duration, moved.speed).values())


def _static_torque(case: ClosedLoop) -> float:
    """RMS torque at the gearhead of a load that never moves [N*m]: at rest a belt passes it on without loss."""
    recorded = isinstance(case.spec.load, Recorded)
    cycle = load_cycle(case.spec, None if recorded else case.profile)
    return float(rms(cycle.duration, cycle.torque)) / case.drive_set.belt_ratio


def _speed(case: ClosedLoop) -> Iterator[Check]:
    """The motor's speed, and the counting frequencies of encoder and controller."""
    motor, encoder, controller = case.drive_set.motor, case.drive_set.encoder or Encoder(), _controller(case)
    when, per_turn = case.figure("speed_time"), encoder.lines / (2 * math.pi)
    encoder_check = {} if case.spec.wants_encoder else PROPOSAL

    def limited(name: str, factor: float, limit: float, **more: Any) -> CheckColumn:
        return _most(case, "speed", lambda x: at_most(name, x * factor, limit, **more))

    yield _check(limited("motor_speed", 1.0, motor.max_speed), when)
    yield _check(limited("encoder_speed", 1.0, encoder.max_speed, **encoder_check), when)
    for name, limit in (("encoder", encoder.max_frequency), ("controller", controller.max_encoder_frequency)):
        yield _check(limited(f"{name}_frequency", per_turn, limit, **encoder_check), when)
    if motor.kind == "brushless":
        yield _check(
            limited("controller_electrical_speed", motor.pole_pairs, controller.max_speed_sine),
            when,
            "speed times pole pairs, sinusoidal commutation",
        )


def _load(case: ClosedLoop) -> Iterator[Check]:
    """Traction that the floor must transmit."""
    load = case.spec.load
    if not isinstance(load, WheeledVehicle) or load.friction_coefficient is None:
        return
    belt = case.drive_set.belt_ratio * case.drive_set.belt_efficiency

    def held(torque: float) -> CheckColumn:
        force = torque * belt / case.train.radius
        return at_most("traction", force, floor_friction(case.spec, force))

    yield _check(
        _most(case, "gear_torque", held),
        case.figure("gear_torque_time"),
        "with the torque that accelerates the wheel itself",
    )


# -- Changes of a spec that may let a drive pass in closed loop: rounded ramps, and another bandwidth.
#
# Each is written as one enters it, and made of what is written: what is tried is what is printed.


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

    def change(one: RobotSpec) -> RobotSpec:
        return one.model_copy(update={"motion": made} if one.motion == before else {})

    yield Change(what, f"motion: {{{entry}}}", spec.changed(change))


def _limits(motion: SCurve | Trapezoid | Triangle | Move) -> dict[str, float] | None:
    """Distance, speed, acceleration and jerk of an S-curve in the place of a motion."""
    if isinstance(motion, SCurve):
        return {name: getattr(motion, name) for name in _UNITS["linear"]} | {"jerk": motion.jerk / 2}
    if isinstance(motion, Trapezoid):
        ramps = (motion.acceleration_time, motion.deceleration_time or motion.acceleration_time)
        speed, distance = motion.speed, motion.speed * (sum(ramps) / 2 + motion.cruise_time)
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
    if own.kp is not None:
        yield Change(
            "gains as they are designed", f"{place} without {', '.join(_GAINS)}", _with_velocity_loop(spec, without)
        )
    if math.isnan(velocity.bandwidth):
        return
    failed = {check.name for check in proof.checks if check.status == "fail"}
    for factor in (2.0, 0.5) if failed & _FOLLOWING else (0.5, 0.25):
        text = show(factor * velocity.bandwidth, "Hz", "frequency", 3)
        bandwidth = to_si(text, "frequency")
        what = f"a {'higher' if factor > 1.0 else 'lower'} bandwidth of the velocity loop"
        yield Change(what, f"{place}.bandwidth: {text}", _with_velocity_loop(spec, without | {"bandwidth": bandwidth}))


def _with_velocity_loop(spec: RobotSpec, figures: dict[str, Any]) -> RobotSpec:
    """The spec with other figures of its velocity loop, in all load cases."""

    def change(one: RobotSpec) -> RobotSpec:
        control = one.control
        if control.structure == "cascade":
            figured = {"velocity": control.velocity.model_copy(update=figures)}
        else:
            figured = figures
        return one.model_copy(update={"control": control.model_copy(update=figured)})

    return spec.changed(change)
