"""A machine.yaml with its power: sized, judged on its supply, printed, in its document and its parts list."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import jsonschema
import numpy as np
import pytest
from refusals import refusal

from drivesizer.errors import InputError
from drivesizer.machine.common_supply import machine_power, shared_sections
from drivesizer.multi_axis import size_machine
from drivesizer.multi_axis.several import laden
from drivesizer.output.json.documents import as_text
from drivesizer.output.json.schema import report_schema
from drivesizer.output.parts import machine_parts_of_axes
from drivesizer.output.terminal.sizing import machine_sizing
from drivesizer.results.check import tightest
from drivesizer.results.machine import MachineSizing
from drivesizer.spec.machine import load_machine
from drivesizer.spec.robot import RobotSpec

pytestmark = pytest.mark.usefixtures("no_further_searches")

MOTION = {"speed": "0.6 m/s", "acceleration_time": "80 ms", "deceleration_time": "40 ms", "cruise_time": "100 ms",
          "rest_time": "0.2 s", "there_and_back": True}  # fmt: skip
SMALL = {"motor": {"part": "DCX22L01EBKL570"}, "gearhead": {"family": "GPX 22"}, "catalogs": ["maxon"]}
RESISTOR = {"resistance": "20 ohm", "power": "20 W", "peak_power": "200 W", "pulse_energy": "30 J",
            "chopper_voltage": "55 V", "chopper_current": "5 A"}  # fmt: skip


def axis(mass: str, **more: Any) -> dict[str, Any]:
    return {"load": {"kind": "belt_axis", "mass": mass, "pulley_diameter": "20 mm"}, "motion": MOTION, **more}


MACHINE: dict[str, Any] = {
    "name": "two axes",
    "supply": {"nominal": "48 V", "current": "3 A"},
    "brake_resistor": RESISTOR,
    "select": SMALL,
    "axes": {"x": axis("2 kg"), "y": axis("1.8 kg", start="100 ms")},
}


@pytest.fixture(scope="module")
def sizing() -> MachineSizing:
    return size_machine(load_machine(MACHINE), top=1)


def test_a_machine_is_judged_on_its_supply(sizing):
    power, checks = sizing.power, {check.name: check for check in sizing.checks}
    assert power is not None and sizing.checks == power.checks and power.axes == ("x", "y")
    assert {"supply_current", "bus_voltage", "resistor_mean_power", "chopper_bus_voltage"} <= set(checks)
    own = [next(c for c in axis.best.checks if c.name == "supply_current").demand for axis in sizing.axes]
    assert max(own) * 0.8 < checks["supply_current"].demand <= sum(own) * (1 + 1e-9)
    assert checks["bus_voltage"].limit >= checks["bus_voltage"].demand == 55.0  # controllers withstand the chopper
    assert sizing.status == "pass" and power.time[-1] == pytest.approx(2 * 0.42 + 0.1)
    assert power.energy_left > 0.0 and "x, y: at rest after the motion" in " ".join(power.assumptions)
    weak = load_machine({**MACHINE, "supply": {"nominal": "48 V", "current": "30 mA"}})
    assert {check.name for check in machine_power(weak, sizing.axes).checks if check.status == "fail"} == {
        "supply_current"
    }


def test_its_document_obeys_the_schema_and_has_its_course(sizing):
    document = json.loads(as_text(sizing))
    validator = jsonschema.Draft202012Validator(report_schema())
    validator.check_schema(report_schema())
    validator.validate(document)
    for key, wrong in (("axes", [{}]), ("total", "1 kg"), ("status", "good"), ("further", 1)):
        assert not validator.is_valid({**document, key: wrong})
    power, course = sizing.power, document["power"]["course"]
    lasting = np.diff(course["time"])
    assert course["total"] @ lasting == pytest.approx(power.total @ np.diff(power.time))
    short = power.course(50)
    assert len(short.total) <= 50 and short.time[-1] == power.time[-1]
    assert short.drawn @ np.diff(short.time) == pytest.approx(power.drawn @ np.diff(power.time))


SWINGING = """<robot name="swing"><link name="base"/><link name="rod"><inertial><origin xyz="0.457414 0 0"/>
<mass value="1.8"/><inertia ixx="0.043" iyy="0.043" izz="0.043"/></inertial></link><joint name="hinge" type="revolute">
<parent link="base"/><child link="rod"/><axis xyz="0 -1 0"/>
<limit lower="-3" upper="3" effort="99" velocity="50"/></joint></robot>"""


@pytest.mark.parametrize(
    ("period", "middle", "half"), [(0.9364064239, -0.1087718095, 0.4550220548), (1.0575864, -0.19791, 0.47315)]
)
def test_a_swing_that_turns_between_two_samples_has_a_course_without_gaps(period, middle, half, tmp_path):
    """A speed of rounding alone at an end cuts a piece shorter than the last digit of its time; JSON ended on it."""
    time = np.linspace(0.0, period, 801)
    rows = zip(time, middle - half * np.cos(2.0 * np.pi * time / period), strict=True)
    (tmp_path / "swing.csv").write_text("time,hinge\ns,rad\n" + "".join(f"{t:.9f},{q:.12f}\n" for t, q in rows))
    (tmp_path / "swing.urdf").write_text(SWINGING)
    robot = {"description": str(tmp_path / "swing.urdf"), "trajectory": str(tmp_path / "swing.csv")}
    given = {"name": "swing", "robot": robot, "supply": {"nominal": "24 V", "accepts": "all"},
             "select": {"catalogs": ["damiao"]}}  # fmt: skip
    sizing = size_machine(load_machine(given), top=1)
    power, course = sizing.power, json.loads(as_text(sizing))["power"]["course"]
    assert len(power.total) > 801 and len(course["total"]) == len(course["time"]) - 1
    assert None not in course["total"] and np.diff(course["time"]).min() > 0.0
    assert course["total"] @ np.diff(course["time"]) == pytest.approx(power.total @ np.diff(power.time))


def test_its_resistor_is_bought_once_and_printed(sizing, capsys):
    (line,) = [one for one in machine_parts_of_axes(sizing) if one.line.role == "brake resistor"]
    assert line.axes == ("x", "y") and line.line.quantity == 1 and "20" in line.line.said
    machine_sizing(sizing, spec="m.yaml")
    printed = capsys.readouterr().out
    assert "\n  supply: " in printed and "regenerated per cycle: " in printed and "Brake resistor peak power" in printed
    machine_sizing(sizing, spec="m.yaml", checks=True)
    assert "All axes on one supply" in capsys.readouterr().out


def test_motors_have_their_voltage_while_all_axes_draw(sizing):
    """R I at the peak comes off what the controllers can apply; where that is too much it is unknown."""
    own = {axis.name: next(c for c in axis.best.checks if c.name == "supply_voltage") for axis in sizing.axes}
    for ohm, status in ((0.2, "pass"), (40.0, "unknown")):
        soft = load_machine({**MACHINE, "supply": {**MACHINE["supply"], "resistance": f"{ohm} ohm"}})
        power = machine_power(soft, sizing.axes)
        found = next(c for c in power.checks if c.name == "supply_voltage")
        assert found.status == status and found.demand in {c.demand for c in own.values()}
        if status == "pass":
            tightest = min(own.values(), key=lambda c: (c.limit - ohm * power.peak / 48.0) / c.demand)
            assert found.limit == pytest.approx(tightest.limit - ohm * power.peak / 48.0) and found.margin > 0.0
    assert not [c for c in sizing.checks if c.name == "supply_voltage"]


def test_an_axis_on_a_supply_of_its_own_is_left_out(sizing):
    alone = {**MACHINE, "axes": {**MACHINE["axes"], "y": {**MACHINE["axes"]["y"], "supply": {"nominal": "24 V"}}}}
    assert machine_power(load_machine(alone), sizing.axes).axes == ("x",)


def test_one_bus_is_judged_once_against_the_controller_of_each_axis(sizing):
    """An axis holds its controller against the voltage of the common bus, not against what it returns alone."""
    assert not any(check.name == "bus_voltage" for axis in sizing.axes for check in axis.best.checks)
    for one in sizing.axes:
        own = next(check for check in one.best.checks if check.name == "common_bus_voltage")
        assert (own.demand, own.limit, own.status) == (55.0, one.best.controller.supply_max, "pass")
        assert own not in tightest(one.best.deciding, 99)
    assert next(c for c in sizing.checks if c.name == "bus_voltage").note == "least limit: x, y"
    x, y = sizing.axes
    weak = replace(y.best, controller=replace(y.best.controller, supply_max=54.0))
    weak = replace(y, result=replace(y.result, sets=(weak,)))
    found = next(c for c in machine_power(sizing.machine, (x, weak)).checks if c.name == "bus_voltage")
    assert (found.status, found.limit) == ("fail", 54.0)
    assert found.note == "more than the controllers of y withstand"
    own = {**MACHINE["axes"], "y": {**MACHINE["axes"]["y"], "supply": {"nominal": "24 V"}}}
    axes = load_machine({**MACHINE, "axes": own}).axes
    assert [axis.spec.on_common_bus for axis in axes] == [True, False]


def shared(axes: dict[str, dict[str, Any]], **top: Any) -> RobotSpec:
    """Sections of the machine with some of the axes' own."""
    given = {name: {**MACHINE["axes"][name], **axes.get(name, {})} for name in MACHINE["axes"]}
    machine = load_machine({**MACHINE, **top, "axes": given})
    return shared_sections(machine, [axis.spec for axis in machine.axes])


def test_margins_and_surroundings_are_the_machine_s_else_the_strictest_of_the_axes(sizing):
    hot, cold = {"ambient": "50 degC"}, {"ambient": "10 degC", "altitude": "2000 m"}
    axes = {
        "x": {"margins": {"torque": "5 %"}, "environment": cold, "mission": {"duration": "2 h"}},
        "y": {"margins": {"torque": "20 %", "speed": "10 %"}, "environment": hot, "mission": {"duration": "3 h"}},
    }
    for given in (axes, {"x": axes["y"], "y": axes["x"]}):
        own = shared(given)
        assert (own.margins.torque, own.margins.speed, own.mission.duration) == (0.2, 0.1, 3 * 3600.0)
        assert (own.environment.ambient, own.environment.altitude) == (323.15, 2000.0)
        top = shared(given, margins={"torque": "10 %"}, environment={"ambient": "30 degC"}, mission={"duration": "1 h"})
        assert (top.margins.torque, top.margins.speed, top.mission.duration) == (0.1, 0.1, 3600.0)
        assert (top.environment.ambient, top.environment.altitude) == (303.15, 2000.0)
    plain = shared({"y": {}})
    assert (plain.margins.torque, plain.mission, plain.environment.ambient) == (0.0, None, 298.15)
    power = machine_power(load_machine({**MACHINE, "margins": {"torque": "10 %"}}), sizing.axes)
    assert next(c for c in power.checks if c.name == "supply_current").needed == 0.1


def test_a_cycle_that_is_too_short_is_refused_where_it_stands(sizing):
    with pytest.raises(
        InputError, match=r'^machine: cycle_time: axis "x" moves for 0.84 s; expected no less, not 0.5 s'
    ):
        machine_power(load_machine({**MACHINE, "cycle_time": "0.5 s"}), sizing.axes)


def test_controllers_withstand_the_chopper_of_a_resistor_out_of_the_catalogues():
    """maxon's shunt regulators switch on at 56 V, where controllers for 50 V are no more."""
    machine = load_machine({**MACHINE, "brake_resistor": "any"})
    controllers = [axis.best.controller for axis in size_machine(machine, top=1).axes]
    volts = laden(machine, "x").supply.max
    assert volts > 56.0 and all(one.supply_max > volts for one in controllers)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"battery": {"nominal_voltage": "48 V", "capacity": "1 A*h"}}, "brake_resistor: the battery takes what is"),
        ({"brake_resistor": {**RESISTOR, "chopper_voltage": "40 V"}}, "expected chopper_voltage above nominal, 48 V"),
        ({"equipment": [{"name": "lamp", "power": "1 W"}]}, "equipment: it draws from a battery"),
    ],
)
def test_sections_that_do_not_go_together_are_refused_in_a_line(given, said):
    assert said in refusal(lambda: load_machine({**MACHINE, **given}))
