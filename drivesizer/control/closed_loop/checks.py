"""A simulation in closed loop judged: figures and series seen from the load, checks with their worst moments."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Controller, Encoder
from drivesizer.control.closed_loop import FOLLOWS, LOOP_FIGURES, ClosedLoop
from drivesizer.control.loop_design import stated_margin
from drivesizer.control.validation import Gains
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform import floor_friction
from drivesizer.loads.course import Profile, course
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.physics import thermal
from drivesizer.physics.battery import current_of_power
from drivesizer.physics.counted_speed import speed_quantum
from drivesizer.physics.figures import Range
from drivesizer.physics.load_cycle import lasting_speeds, rms
from drivesizer.physics.power_stage import of_the_source
from drivesizer.results import ratings
from drivesizer.results.check import Band, Check, Figure, figure
from drivesizer.results.check_columns import PROPOSAL, CheckColumn, at_least, at_most, fits
from drivesizer.results.drive_set import voltage_assumption
from drivesizer.spec.mounting import controller_needed, motor_needed, rise_needed
from drivesizer.units import show

# -- Figures and time series of a closed-loop simulation, seen from the load.


def figures(case: ClosedLoop) -> tuple[Figure, ...]:
    """Figures of a simulation, without limits of their own, seen from the load.

    Of two masses also the errors of the motor, as at the load: through the total ratio as if the shaft were stiff.
    """
    seen, time, loops, motors = case.figure, case.figure("time"), case.loops, case.spec.load.motors
    top, radius, per_speed = case.profile.top_speed or math.nan, case.train.radius, case.train.motor_per_speed
    distance, encoder, counted = case.profile.distance * case.task.cycles, case.drive_set.encoder, case.controller
    peak, when = seen("load_speed_error") * radius, seen("load_speed_error_time")
    mean, quantum = math.sqrt(seen("load_speed_error_square") / time) * radius, math.nan
    if encoder:  # smallest step of the counted speed over its counting time
        quantum = speed_quantum(encoder.lines, counted.velocity_period, max(counted.counted_over, 1))
    feed = case.spec.feed_of(case.drive_set.controller, case.drive_set.brake)
    standby = float(feed.stage.standby)
    values: dict[str, tuple[float, float | None]] = {
        "tracking_error_peak": (peak, when),
        "tracking_error_peak_share": (peak / top, when),
        "tracking_error_rms": (mean, None),
        "tracking_error_rms_share": (mean / top, None),
        "position_error_peak": (seen("load_angle_error") * radius, seen("load_angle_error_time")),
        "distance_error": (distance - seen("load_angle") * radius, None),
        "motor_tracking_error_peak": (seen("speed_error") / per_speed, seen("speed_error_time")),
        "motor_tracking_error_rms": (math.sqrt(seen("speed_error_square") / time) / per_speed, None),
        "motor_position_error_peak": (seen("angle_error") / per_speed, seen("angle_error_time")),
        "motor_distance_error": (distance - seen("angle") / per_speed, None),
        "voltage_saturation": (seen("time_at_voltage_limit") / time, None),
        "current_limitation": (seen("time_at_current_limit") / time, None),
        "speed_quantum": (quantum / per_speed, None),
        "current_bandwidth": (loops.current.bandwidth if loops.current else math.nan, None),
        **{name: (getattr(loops.velocity, name), None) for name in LOOP_FIGURES},
        "resonance": (loops.resonance, None),
        "rms_current": (seen("rms_current"), None),
        "peak_current": (seen("current"), seen("current_time")),
        "winding_end": (seen("winding"), None),
        "bus_lowest": (seen("bus_lowest"), None),
        "peak_power": (float(of_the_source(seen("power") + standby, feed)) * motors, seen("power_time")),
        "energy_in": ((seen("energy_in") + standby * time) * motors + seen("energy_resisted"), None),
        "energy_returned": (seen("energy_returned") * motors, None),
        "mission": (time, None),
    }
    needs = dict.fromkeys(("tracking_error_peak_share", "tracking_error_rms_share"), case.profile.top_speed) | {
        "current_bandwidth": loops.current, "winding_end": case.periodic, "mission": case.task.cycles > 1,
        **dict.fromkeys([*(name for name in values if name.startswith("motor_")), "resonance"], case.train.flexible),
    }  # fmt: skip
    rotary = case.spec.load.shaft_axis == "rotary"
    return tuple(figure(name, *values[name], rotary=rotary) for name in values if needs.get(name, True))


def columns(case: ClosedLoop) -> dict[str, NDArray[np.float64]]:
    """Recorded rows of the first cycle, seen from the load and from the supply of all drives."""
    rows: Any = case.out.series
    train, feed = case.train, case.spec.feed_of(case.drive_set.controller, case.drive_set.brake)
    reference, speed = rows["reference"] / train.motor_per_speed, rows["load_speed"] * train.radius
    at_stage = rows["voltage"] * rows["current"] + feed.lost(rows["current"]) + feed.stage.standby
    series = {
        "time": rows["time"],
        "speed_reference": reference,
        "speed": speed,
        "error": reference - speed,
        "motor_error": reference - rows["motor_speed"] / train.motor_per_speed,
        "position_error": rows["load_position_error"] * train.radius,
        "motor_position_error": rows["position_error"] / train.motor_per_speed,
        "motor_speed": rows["motor_speed"],
        "current": rows["current"],
        "voltage": rows["voltage"],
        "motor_torque": train.torque_constant * rows["current"],
        "gearhead_torque": rows["gear_torque"],
        "winding_temperature": rows["winding"],
        "supply_power": of_the_source(at_stage, feed) * case.spec.load.motors,
    }
    if not case.periodic:
        del series["winding_temperature"]  # it is held at 25 degC
    if not train.flexible:  # rigid, the motor's errors are the load's
        del series["motor_error"], series["motor_position_error"]
    return series


# -- Checks of a simulation in closed loop: every demand against its limit, with its worst moment.
#
# A figure that the catalogue lacks leaves its check unknown; a figure that the spec does not limit is not checked,
# except for the tracking error.


def checks(case: ClosedLoop) -> tuple[Check, ...]:
    """Every demand of a simulation against its limit; no check where there is no part or no limit."""
    all_checks = (*_loop(case), *_electrical(case), *_heat(case), *_gearhead(case), *_speed(case), *_traction(case))
    limited = tuple(check for check in all_checks if check.limit != math.inf)
    return tuple(_allowing(case, check) for check in limited) if case.slow else limited


# share of a largest value that a current loop at the velocity loop's rate may be off: beside whole simulations of
# motions without a repetition currents, torques and powers were off by up to 8 %, errors of the speed by up to 28 %,
# which is 39 % of theirs
_BETWEEN_SAMPLES = {"tracking_error": 0.5} | dict.fromkeys(
    ("supply_voltage", "controller_peak_current", "supply_current", "gearhead_intermittent_torque", "traction"), 0.1
)


def _allowing(case: ClosedLoop, check: Check) -> Check:
    """A check with an allowance for what lies between two samples: open where that decides.

    The voltage jumps by the current loop's own gain when its demand does, from one peak to the other at the most.
    """
    share = _BETWEEN_SAMPLES.get(check.name, 0.0)
    if not share or check.status not in ("pass", "fail") or isinstance(case.controller, Gains):
        return check
    low, high, allowed = (1.0 - share) * check.demand, (1.0 + share) * check.demand, f"{share:.0%}"
    if check.name == "supply_voltage":
        jump = 2.0 * case.controller.current_kp * case.required("current_demand")
        high, allowed = check.demand + jump, show(jump, "V", "voltage", 3)
    lower, higher = (
        at_most(check.name, x, check.limit, needed=check.needed).at((), "closed loop") for x in (low, high)
    )
    return replace(
        check,
        status=check.status if lower.status == higher.status == check.status else "open",
        band=Band(low, high, higher.margin),
        note=f"{check.note}{'; ' if check.note else ''}{allowed} more is allowed for between two samples",
    )


def _check(column: CheckColumn, at_time: float | None = None, note: str = "", *, rotary: bool = False) -> Check:
    """The record of a check of single figures."""
    return column.at((), "closed loop", at_time=at_time, note=note, rotary=rotary)


def _loop(case: ClosedLoop) -> Iterator[Check]:
    """Stability, margins, tracking and bandwidth; an unstable loop has no margin, and fails for that."""
    loops, top = case.loops.all, case.profile.top_speed
    worst, stable = max(loops, key=lambda loop: loop.pole_radius), all(loop.stable for loop in loops)
    margins = ", ".join(
        f"{loop.name} {'none' if math.isnan(loop.phase_margin) else f'{math.degrees(loop.phase_margin):.3g}°'}"
        for loop in loops
    )
    yield _check(
        fits("stability", stable, True),
        note=f"phase margin: {margins}; largest pole {worst.pole_radius:.4g}, stable inside 1",
    )
    known = [loop for loop in loops if not math.isnan(loop.phase_margin)]
    if known and stable:
        least = min(known, key=lambda loop: loop.phase_margin)
        yield _check(
            at_least("phase_margin", stated_margin(case.spec), least.phase_margin),
            note=f"of the sampled {least.name} loop, delays and counts as they are",
        )
    if top:
        yield _check(
            at_most("tracking_error", case.figure("load_speed_error") * case.train.radius, FOLLOWS * top),
            case.figure("load_speed_error_time"),
            f"to follow is to stay within {FOLLOWS:.0%} of the top speed, a convention of this program",
            rotary=case.spec.load.shaft_axis == "rotary",
        )
    if case.spec.needs.bandwidth is not None:
        yield _check(at_least("bandwidth", case.spec.needs.bandwidth, case.loops.velocity.bandwidth))


def _resisted(case: ClosedLoop, name: str, power: bool = False) -> Range:
    """A figure that grows with the winding's resistance, between bounds for a motor of unknown heat.

    The simulation has the winding at 25 °C; it may be as cold as the ambient, and as warm as its largest current heats
    it in the steady state, up to its permitted temperature.
    """
    motor, ambient, supply = case.drive_set.motor, case.spec.environment.ambient, case.spec.supply
    read = case.peak if power else case.required
    value, current = read(name), read("current")
    if thermal.two_bodies(motor).known or not case.spec.plant.warming:
        return Range(value, value)
    R_25 = thermal.resistance_25(motor)
    hottest = np.fmin(thermal.steady_winding(motor, ambient, current), motor.max_winding_temperature)

    def with_winding(at: Any) -> float:
        more = float(thermal.resistance_at(R_25, at) - R_25)
        if not power:
            return value + more * current
        ohm = supply.resistance or 0.0
        watts = value * (supply.lowest - ohm * value) + case.spec.load.motors * more * current**2
        return float(current_of_power(watts, supply.lowest, ohm))  # NaN where the supply cannot give that

    return Range(with_winding(min(ambient, thermal.DATA_TEMPERATURE)), with_winding(hottest))


def _electrical(case: ClosedLoop) -> Iterator[Check]:
    """Voltage and current that the controller must supply."""
    controller, supply = case.drive_set.controller or Controller(), case.spec.supply
    actuator = case.drive_set.actuator
    inside = controller.part == (actuator.part if actuator else None)

    def printed(column: CheckColumn, figure: str) -> CheckColumn:
        return ratings.unless_printed(column, figure, case.drive_set) if inside else column

    ideal = "required to follow the profile without limits"
    usable: Any = case.usable_voltage
    if math.isnan(usable):
        usable = case.spec.feed_of(case.drive_set.controller).usable_range
    volts = at_most("supply_voltage", _resisted(case, "stage_voltage"), usable)
    decided = volts.passed or volts.failed
    assumed = voltage_assumption(case.spec, case.drive_set.controller) if decided else ""
    yield _check(
        volts,
        case.required("stage_voltage_time"),
        f"{ideal}; limit: output of the controller at the lowest supply voltage"
        + (", with what resistances before the motor take of it" if case.spec.resists else "")
        + (f"; {assumed}" if assumed else ""),
    )
    peak = at_most("controller_peak_current", case.required("current_demand"), controller.peak_current)
    yield _check(printed(peak, "peak_current"), case.required("current_demand_time"), ideal)
    lasting = float(ratings.controller_current(controller, case.spec.environment.ambient))
    if not case.figure("current") <= lasting:  # else the sum of squares stays empty; NaN where a figure is unknown
        share = case.figure("i2t_share") if controller.peak_time > 0.0 else math.nan
        if share != 0.0:
            note = "highest state: at 100 % the controller limits to the continuous current"
            yield _check(at_most("controller_i2t", share, 1.0), note=note)
    needed = controller_needed(case.spec, 0.0)
    mean = at_most("controller_continuous_current", case.figure("rms_current"), lasting, needed=needed)
    yield _check(printed(mean, "nominal_current"))
    if supply.current is not None:
        yield _check(
            at_most("supply_current", _resisted(case, "bus_current", power=True), supply.current),
            case.peak("bus_current_time"),
            "electrical power over the supply's voltage",
        )


def _heat(case: ClosedLoop) -> Iterator[Check]:
    """The motor's RMS current, and the winding's highest temperature in the periodic steady state."""
    motor, ambient, mean = case.drive_set.motor, case.spec.environment.ambient, case.figure("rms_current")
    current = ratings.nominal_current_limit(mean, motor, ambient, motor_needed(case.spec, 0.0))
    if case.spec.once and case.periodic:
        current = current._replace(limit=np.full_like(current.limit, math.inf), failed=current.failed & False)
    yield _check(
        ratings.unless_printed(current, "nominal_current", case.drive_set),
        note="the nominal current in this ambient" if ambient != thermal.rated_ambient(motor) else "",
    )
    if case.periodic:
        when = "run once from cold" if case.spec.once else "in the periodic steady state"
        winding, note = case.periodic["winding"], f"highest {when}"
    else:
        winding, note = float(thermal.steady_winding(motor, ambient, mean)), "steady mean, copper loss"
    if math.isinf(winding):
        note = "thermal runaway: the copper loss grows faster than the heat is dissipated"
    limit, needed = motor["max_winding_temperature"], rise_needed(case.spec, 0.0)
    yield _check(at_most("winding_temperature", winding, limit, zero=ambient, needed=needed), note=note)


@lru_cache(maxsize=1)  # of samples on one motion it is the same
def _lasting(profile: Profile) -> tuple[Any, ...]:
    """Mean speed of a profile and the one that it sustains."""
    motion = course(profile)
    return tuple(lasting_speeds(motion.duration, motion.speed).values())


def _gearhead(case: ClosedLoop) -> Iterator[Check]:
    """Torque and speed of the gearhead; of a load that never moves a belt passes the torque on without loss."""
    gearhead, speed, when = case.drive_set.gearhead, case.figure("speed"), case.figure("speed_time")
    if case.profile.top_speed:
        torque, note = case.figure("rms_gear_torque_running") if speed else 0.0, "while running"
    else:
        cycle = load_cycle(case.spec, None if case.spec.load.of_shaft else case.profile)
        torque, note = float(rms(cycle.duration, cycle.torque)) / case.drive_set.belt_ratio, "of the load at rest"
    lasting = at_most("gearhead_continuous_torque", torque, gearhead.continuous_torque)
    yield _check(ratings.unless_printed(lasting, "nominal_torque", case.drive_set), note=note)
    peak = at_most("gearhead_intermittent_torque", case.figure("gear_torque"), gearhead.intermittent_torque)
    yield _check(ratings.unless_printed(peak, "peak_torque", case.drive_set), case.figure("gear_torque_time"))
    mean, sustained = _lasting(case.profile)
    yield _check(
        ratings.continuous_speed_limit(gearhead, mean, sustained, case.train.motor_per_speed),
        note="of the reference: the lasting speed by the maker's rule, or the mean",
    )
    yield _check(at_most("gearhead_intermittent_speed", speed, gearhead.intermittent_input_speed), when)


def _speed(case: ClosedLoop) -> Iterator[Check]:
    """The motor's speed, and the counting frequencies of encoder and controller."""
    motor, encoder = case.drive_set.motor, case.drive_set.encoder or Encoder()
    controller, speed, when = case.drive_set.controller or Controller(), case.figure("speed"), case.figure("speed_time")
    proposed: Any = {} if case.spec.wants_encoder else PROPOSAL
    counts = encoder.lines / (2 * math.pi) * speed
    yield _check(ratings.motor_speed_limit(speed, motor), when)
    yield _check(at_most("encoder_speed", speed, encoder.max_speed, **proposed), when)
    yield _check(at_most("encoder_frequency", counts, encoder.max_frequency, **proposed), when)
    yield _check(at_most("controller_frequency", counts, controller.max_encoder_frequency, **proposed), when)
    if motor.kind == "brushless":
        turns = speed * motor.pole_pairs
        electrical = ratings.electrical_speed_limit("controller_electrical_speed", turns, motor.kind, controller)
        note = "" if electrical.on_basis else "speed times pole pairs, sinusoidal commutation"
        yield _check(electrical, when, note)


def _traction(case: ClosedLoop) -> Iterator[Check]:
    """Traction that the floor must transmit."""
    load = case.spec.load
    if isinstance(load, WheeledVehicle) and load.friction_coefficient is not None:
        belt = case.drive_set.belt_ratio * case.drive_set.belt_efficiency
        force = case.figure("gear_torque") * belt / case.train.radius
        yield _check(
            at_most("traction", force, floor_friction(case.spec, force)),
            case.figure("gear_torque_time"),
            "with the torque that accelerates the wheel itself",
        )
