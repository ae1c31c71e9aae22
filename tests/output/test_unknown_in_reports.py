"""What reports say where a figure is unknown: no 0 for it, no figure beside its own "unknown", no name for a number."""

import json
from dataclasses import replace
from math import isnan, nan

import numpy as np
import pytest
from conftest import ROOT
from specs import estimates_off
from synthetic_validation import labels

from drivesizer.catalog import Catalog
from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine.operating_field import field
from drivesizer.machine.problem import problem
from drivesizer.output.report.figures.all_figures import Behaviour
from drivesizer.output.report.figures.field import Panel, torque_speed
from drivesizer.output.report.figures.picture import on_paper
from drivesizer.results.drive_set import DriveSet
from drivesizer.simulate import hardest_case, validate
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import RobotSpec, read_spec

STARTER = (ROOT / "drivesizer" / "spec" / "starters" / "wheeled_vehicle.yaml").read_text(encoding="utf-8")
LOADED = """
cases:
  - {name: light, load: {mass: 20 kg}}
  - {name: loaded, load: {mass: 45 kg}}
  - {name: empty battery, supply: {min: 22 V}}
"""


@pytest.fixture(scope="module")
def chosen(spec: RobotSpec, catalog: Catalog) -> DriveSet:
    """The paper's set."""
    return size(spec, catalog=catalog, top=1).sets[0]


@pytest.fixture(scope="module")
def rubs_unknown(chosen: DriveSet) -> DriveSet:
    """The same with a motor whose no-load current nobody prints: its friction is unknown."""
    return replace(chosen, motor=replace(chosen.motor, no_load_current=nan, friction_torque=nan))


def test_an_unknown_rms_current_is_no_point_of_the_field(spec, rubs_unknown):
    found = field(spec, rubs_unknown)
    assert isnan(found.rms_torque) and not np.isnan(found.cycle_torque).any()
    said = labels(on_paper(torque_speed(Panel(cases=((0, "", found),)))))
    assert "load cycle" in said and not any("nan" in text or "RMS" in text for text in said)


def test_least_figures_are_unknown_in_every_table(spec, rubs_unknown, catalog):
    """What heat and energy a set takes at least is not what it takes: each table says unknown, none a figure."""
    motors = catalog.motors
    row = motors.rows["118752"]
    columns = {**motors.columns, "no_load_current": motors["no_load_current"].copy()}
    columns["no_load_current"][row] = nan
    poorer = replace(catalog, motors=replace(motors, columns=columns))
    (found,) = explain(estimates_off(spec.model_copy(update={"method": "physics"})), "118752", "406764", catalog=poorer)
    figures = {f.name: f.value for f in found.figures}
    for name in ("energy", "returned", "power", "joule_heat", "peak_current", "winding_temperature"):
        assert isnan(figures[name]), name
    does = Behaviour(problem(spec, catalog), rubs_unknown)
    assert does.cost == "unknown" and (does.heat[0].title, does.heat[0].text) == ("Copper loss, mean", "unknown")


@pytest.fixture(scope="module")
def several() -> tuple[RobotSpec, DriveSet]:
    slow = STARTER.replace("control:\n", "control:\n  rate: 1 kHz\n", 1)  # its loops are designed in no time
    spec = read_spec(YamlSource(slow + LOADED, "robot.yaml"))
    return spec, size(spec, top=1).sets[0]


def test_the_closed_loop_drives_the_hardest_case(several):
    """Of cases that differ in mass alone the heaviest takes most torque, by Newton's second law."""
    spec, best = several
    assert hardest_case(spec, best) == "loaded"
    proofs = {name: validate(spec, best, load_case=name) for name, _ in spec.load_cases[:3]}
    peaks = {name: np.abs(proof.series["current"]).max() for name, proof in proofs.items()}
    assert peaks["loaded"] > peaks["as specified"] > peaks["light"]
    assert [proof.case for proof in proofs.values()] == ["as specified", "light", "loaded"]
    assert "the load case loaded is simulated; 3 further cases are not simulated" in proofs["loaded"].assumptions


def test_a_set_that_no_loop_can_drive_is_reported_without(tmp_path, monkeypatch, run):
    """Pololu prints no rotor inertia: everything but the closed loop is reported, and why it is missing."""
    text = STARTER.replace("mass: 30 kg", "mass: 6 kg").replace("speed: 1 m/s", "speed: 0.3 m/s")
    text = text.replace("nominal: 24 V", "nominal: 12 V")
    text = text.replace("catalogs: [maxon]", "catalogs: [pololu]\n  estimates: off")
    (tmp_path / "robot.yaml").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    status, _, err = run("report", "-o", "report.json", "-o", "report.html")
    assert status == 0 and "rotor inertia not in the catalogue" in err
    (axis,) = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))["axes"]
    assert axis["validation"] is None
    assert any(said.startswith("not simulated in closed loop: motor") for said in axis["result"]["warnings"])
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "not simulated in closed loop: motor" in page and "from from" not in page


LIFT = """
name: lift
load: {kind: belt_axis, mass: 18 kg, pulley_diameter: 50.93 mm, efficiency: 0.94, incline: 90 deg, friction_force: 25 N}
motion: {profile: s_curve, distance: 900 mm, speed: 0.9 m/s, acceleration: 3 m/s^2, jerk: 30 m/s^3, rest_time: 8 s,
  there_and_back: true, payload: 7 kg, payload_back: 0 kg}
supply: {nominal: 48 V, max: 50 V, kind: power_supply}
brake_resistor: {resistance: 8 ohm, power: 20 W, chopper_voltage: 54 V}
select: {catalogs: [maxon]}
"""


@pytest.fixture(scope="module")
def lift(catalog):
    return explain(read_spec(YamlSource(LIFT, "lift.yaml")), "614949", "223084", catalog=catalog)[0]


def test_a_load_that_its_weight_would_move_is_not_advised_to_be_without_power(lift):
    """Friction keeps the integral where lifting left it; only a brake may relieve the motor of a load that hangs."""
    friction = LIFT.replace("friction_force: 25 N", "friction_force: 90 N").replace(
        ", payload: 7 kg, payload_back: 0 kg", ""
    )
    (warning,) = (w for w in warned(friction, lift) if w.startswith("at rest the integral"))
    held = 18.0 * 9.80665 * 0.05093 / 2 / lift.gearhead.ratio / lift.motor.torque_constant
    assert f"where holding the load needs {held:.3g} A: a brake" in warning
    assert warning.endswith("a brake that holds at rest saves that heat; with the power stage off alone the load moves")


def test_what_a_payload_needs_at_rest_is_not_kept_by_the_integral(lift):
    """With 7 kg more above, 7.8 A hold the load there, not the 5.6 A of the empty one."""
    assert not [w for w in warned(LIFT, lift) if w.startswith("at rest the integral")]


def warned(text, drive):
    return validate(read_spec(YamlSource(text, "lift.yaml")), drive).warnings
