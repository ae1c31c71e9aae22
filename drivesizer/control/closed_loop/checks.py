"""Checks of a simulation in closed loop: every demand against its limit, with its worst moment.

A figure that the catalogue lacks leaves its check unknown; a figure that the spec does not limit is not checked, except
for the tracking error.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import lru_cache
from typing import Any

import numpy as np

from drivesizer.catalog import Controller, Encoder
from drivesizer.control.closed_loop.run import ClosedLoop
from drivesizer.control.closed_loop.set_up import FOLLOWS
from drivesizer.control.loop_design import stated_margin
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform_wheels import floor_friction
from drivesizer.loads.course import Profile, course
from drivesizer.loads.recorded import Recorded
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.physics.battery import current_of_power
from drivesizer.physics.lasting_speed import lasting_speeds
from drivesizer.physics.load_cycle import rms
from drivesizer.physics.thermal import (
    DATA_TEMPERATURE,
    rated_ambient,
    resistance_25,
    resistance_at,
    steady_winding,
    two_bodies,
)
from drivesizer.results.check_columns import PROPOSAL, CheckColumn, at_least, at_most, between, fits
from drivesizer.results.losses import voltage_assumption
from drivesizer.results.ratings import (
    continuous_speed_limit,
    controller_current,
    nominal_current_limit,
    unless_printed,
)
from drivesizer.results.sizing import Check
from drivesizer.spec.altitude import controller_needed, motor_needed, rise_needed

__all__ = ["METHOD", "checks", "electrical_checks"]

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
