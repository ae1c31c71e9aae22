"""Axes with their drives on one supply: one axis is what it was, several are judged by their sum."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from kernel_cycles import motor_power
from refusals import refusal

from drivesizer.catalog import load
from drivesizer.errors import FieldError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases import static_torque
from drivesizer.machine.budgets import machine_budget
from drivesizer.machine.common_bus import AxisPower
from drivesizer.machine.common_supply import common_supply
from drivesizer.machine.problem import problem
from drivesizer.machine.set_cycle import set_cycle
from drivesizer.results.machine import MachinePower
from drivesizer.search.shortlist import load_parts
from drivesizer.sizing import explain
from drivesizer.spec.robot import RobotSpec, read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

AXIS = """
name: a wheel
load: {kind: flywheel, inertia: %s, friction_torque: 1 mN*m}
motion: {speed: 600 rpm, acceleration_time: %s, cruise_time: 1 s, deceleration_time: %s, rest_time: %s}
supply: {nominal: 24 V, %s}
power_stage: {voltage_drop: 0 V}
select: {controller: {part: "541718"}}
"""
PLATFORM = """
name: a base
load: {kind: wheeled_vehicle, mass: 20 kg, driven_wheels: 2, wheel_diameter: 150 mm, rolling_resistance: 0.02,
       inertia: 20 kg*cm^2}
platform: {layout: {kind: differential, track: 400 mm}, inertia: 1 kg*m^2, slip: %s}
motion: {speed: 0.3 m/s, acceleration_time: 1 s, cruise_time: 2 s, rest_time: 1 s}
supply: {nominal: 24 V, min: 20 V, max: 30 V}
power_stage: {voltage_drop: 0 V}
select: {controller: {part: "541718"}}
"""
LIMITS = "current: 0.5 A, peak_current: 1 A, peak_time: 2 s, part: SDR-240-24"
RESISTOR = "brake_resistor: {family: [HS, DSR*], chopper_voltage: 28 V, chopper_current: 5 A}\n"
BATTERY = """
battery: {chemistry: LiFePO4, series: 8, nominal_voltage: 3.2 V, capacity: 5 A*h, resistance: 20 mohm, autonomy: 2 h}
equipment: [{name: computer, power: 5 W}]
"""


@pytest.fixture(scope="module")
def shelf():
    return load(["maxon", "mean_well", "te_connectivity"])


@pytest.fixture(scope="module")
def drive(shelf):
    (one,) = explain(wheel(), "110940", "406764", catalog=shelf)
    return one


def wheel(inertia="3e-4 kg*m^2", up="1 s", down="100 ms", rest="1 s", supply="accepts: all", more="") -> RobotSpec:
    return read_spec(YamlSource(AXIS % (inertia, up, down, rest, supply) + more, "wheel.yaml"))


def axis(shelf, drive, name, start=0.0, repeats=None, **given) -> AxisPower:
    spec = wheel(**given)
    return AxisPower(name, problem(spec, load_parts(spec, shelf)), drive, start, repeats)


def shared(more=RESISTOR, supply=LIMITS) -> RobotSpec:
    return wheel(supply=supply, more=more).alone()


def status(power: MachinePower) -> dict[str, str]:
    return {check.name: check.status for check in power.checks}


def check(power: MachinePower, name: str):
    return next(one for one in power.checks if one.name == name)


def test_two_axes_exchange_energy_and_share_a_resistor(shelf, drive):
    x = axis(shelf, drive, "x", up="0.5 s", rest="2 s")
    y = axis(shelf, drive, "y", start=1.45, inertia="5e-4 kg*m^2", down="300 ms")  # accelerates while x brakes
    single = [common_supply(shared(), shelf, [one._replace(start=0.0)]) for one in (x, y)]
    both = common_supply(shared(), shelf, [x, y])
    assert both.synchronised and both.axes == ("x", "y") and both.time[-1] == pytest.approx(1.45 + 3.3)
    assert both.drawn.shape == both.returned.shape == (2, len(both.total)) and len(both.time) == len(both.total) + 1
    assert 0.0 < both.exchanged < sum(one.energy_left for one in single)
    assert both.energy_left < sum(one.energy_left for one in single)
    assert max(one.peak for one in single) * 0.99 <= both.peak <= sum(one.peak for one in single)
    drawn, back = (rows.sum(axis=0) @ np.diff(both.time) for rows in (both.drawn, both.returned))
    assert drawn - back == pytest.approx((both.total - both.left) @ np.diff(both.time))
    figures = {
        f.name: f.value for one in (both,) for f in (*one.figures, *(one.braking.figures if one.braking else ()))
    }
    assert figures["energy_regenerated"] == pytest.approx(both.energy_left)
    assert both.braking is not None and both.braking.resistor is not None
    assert status(both)["bus_voltage"] == "pass" and check(both, "bus_voltage").demand == 28.0
    swapped = common_supply(shared(), shelf, [y, x])
    assert swapped.energy_left == pytest.approx(both.energy_left) and swapped.peak == pytest.approx(both.peak)
    assert swapped.peak_axis == both.peak_axis and swapped.status == both.status


def test_sums_are_those_of_the_drives_waveforms(shelf, drive):
    """Current times voltage of both motors at the middle of a thousand steps of each segment, added up by time."""
    x = axis(shelf, drive, "x", rest="0.9 s", supply="accepts: all, capacitance: 0.1 mF")
    y = axis(shelf, drive, "y", start=1.1, up="0.9 s", down="200 ms", rest="0.9 s")
    power = common_supply(shared(), shelf, [x, y], cycle_time=3.0)
    assert power.time[-1] == pytest.approx(3.0)
    at = (np.arange(60_000) + 0.5) * 3.0 / 60_000
    net = _waveform(x, at) + _waveform(y, (at - 1.1) % 3.0)
    step, piece = 3.0 / 60_000, 0.06  # a sixteenth of what the power of a segment changes by
    assert net.max() <= power.peak * (1 + 1e-4) and power.peak <= net.max() * (1 + piece)
    left = np.maximum(-net, 0.0).sum() * step
    assert left * 0.999 <= power.energy_left <= left * 1.02
    assert power.mean == pytest.approx(np.maximum(net, 0.0).sum() / 60_000, rel=0.01)
    back = sum(np.maximum(-_waveform(one, at), 0.0).sum() * step for one in (x, y))
    assert power.exchanged == pytest.approx(back - left, rel=0.05) and power.exchanged > 0.05 * back


def _waveform(one: AxisPower, time: np.ndarray) -> np.ndarray:
    """Electrical power of the motor at moments of its cycle; its controller loses nothing."""
    found = set_cycle(one.problem.spec, one.drive, one.problem.cases[0].at_belt)
    duration, ends = found.pieces.duration, np.cumsum(found.pieces.duration)
    place = np.minimum(np.searchsorted(ends, time), len(ends) - 1)
    share = np.clip((time - ends[place] + duration[place]) / duration[place], 0.0, 1.0)
    return motor_power(found, place, share) + float(found.feed.stage.standby)


def test_an_axis_that_is_done_waits_at_rest(shelf, drive):
    """The same energies in a longer cycle, standby alone while it waits; a lift goes on to hold its load."""
    short, long = axis(shelf, drive, "x", rest="0 s"), axis(shelf, drive, "y", up="3 s")
    power = common_supply(shared(), shelf, [short, long])
    waits = power.time[:-1] > 2.2
    assert power.time[-1] == pytest.approx(5.1) and (power.drawn[0][waits] == power.drawn[0][waits][0]).all()
    resting = common_supply(shared(), shelf, [axis(shelf, drive, "x", rest="3 s")])
    drawn, own = (one.drawn[0] @ np.diff(one.time) for one in (power, resting))
    assert drawn == pytest.approx(own, rel=1e-12)  # nothing holds friction, as in a rest of its own
    lift = "name: x\nload: {kind: hoist, mass: 2 kg, drum_diameter: 20 mm}\nsupply: {nominal: 24 V}\nmotion: "
    motion = "{speed: 0.1 m/s, acceleration_time: 0.1 s, cruise_time: 1 s, rest_time: %s}"
    for rest in ("0 s", "1 s"):
        spec = read_spec(YamlSource(lift + motion % rest, "x.yaml"))
        held = static_torque(problem(spec, load_parts(spec, shelf)).cases[0].cycle)
        assert held == pytest.approx(2.0 * 9.80665 * 0.01, rel=1e-6)
    cycle = problem(spec, load_parts(spec, shelf)).cases[0].cycle
    for acceleration, found in ((0.0, 0.3), (-1.0, math.nan)):  # at the end of a recording, whose inertia is unknown
        one = replace(cycle, inertia=math.nan, torque=cycle.torque * 0.0 + 0.3, acceleration=cycle.acceleration * 0.0)
        one.acceleration[-1, 1] = acceleration
        assert static_torque(one) == pytest.approx(found, nan_ok=True)


def test_at_random_phases_the_peaks_add_up_and_the_share_of_time_is_told(shelf, drive):
    axes = [axis(shelf, drive, "x"), axis(shelf, drive, "y", up="0.5 s", rest="1.5 s")]
    single = [common_supply(shared(), shelf, [one]) for one in axes]
    power = common_supply(shared(), shelf, axes, synchronised=False)
    assert not power.synchronised and power.peak == pytest.approx(sum(one.peak for one in single))
    assert power.energy_left <= sum(one.energy_left for one in single) * (1 + 1e-9)
    assert len(power.phases) == 2 and power.peak == pytest.approx(float(_at_moment(power)), rel=0.1)
    one = next(one for one in power.exceeded if one.check == "supply_continuous_current")
    assert one.limit == 12.0 and 0.0 < one.least <= one.most < 0.2
    assert "at the worst phase; exceeded for" in check(power, "supply_current").note
    names = {figure.name for figure in power.figures}
    assert {"supply_current_exceeded", "supply_continuous_current_exceeded"} <= names


def _at_moment(power: MachinePower) -> float:
    """Sum of the axes' means where the peak is: the moment to which the phases bring all of them."""
    return power.drawn[:, np.searchsorted(power.time, power.peak_time + 1e-9) - 1].sum()


def test_a_battery_feeds_all_axes(shelf, drive):
    axes = [axis(shelf, drive, "x"), axis(shelf, drive, "y", start=1.0)]
    power = common_supply(shared(BATTERY, "max: 30 V, min: 20 V"), shelf, axes)
    assert power.energy is not None
    names = [line.name for line in power.energy.consumers]
    assert {"x: drive", "y: drive", "computer"} <= set(names)
    assert sum(line.mean for line in power.energy.consumers) == pytest.approx(power.energy.mean_power)
    assert power.energy.mean_power == pytest.approx(power.mean + 5.0)
    assert status(power)["battery_autonomy"] == "pass"


@pytest.mark.parametrize("slip", [0.0, 0.1])
def test_wheels_among_other_axes_slip_as_they_do_alone(shelf, drive, slip):
    spec = read_spec(YamlSource(PLATFORM % slip + BATTERY, "base.yaml"))
    base = AxisPower("base", problem(spec, load_parts(spec, shelf)), drive)
    alone, among = machine_budget(base.problem, drive).energy, common_supply(spec.alone(), shelf, [base]).energy
    assert alone and among and (among.mean_power, among.autonomy) == (alone.mean_power, alone.autonomy)
    lines = {line.name: line.mean for line in among.consumers}
    assert sum(lines.values()) == pytest.approx(alone.mean_power)
    assert lines.get("base: slip of the wheels", 0.0) == pytest.approx(slip * (lines["base: drive"] / (1.0 - slip)))


def test_a_battery_that_no_catalogue_lists_is_refused_by_its_field(shelf, drive):
    with pytest.raises(FieldError, match='"NOPE" is not in maxon') as refused:
        common_supply(shared("battery: {part: NOPE}\n", "max: 30 V, min: 20 V"), shelf, [axis(shelf, drive, "x")])
    assert refused.value.field == ("battery", "part")


def test_a_motion_longer_than_the_cycle_is_refused_in_a_line(shelf, drive):
    assert (
        refusal(lambda: common_supply(shared(), shelf, [axis(shelf, drive, "x")] * 2, cycle_time=2.0))
        == 'axis "x" moves for 3.1 s; expected no less, not 2 s'
    )
