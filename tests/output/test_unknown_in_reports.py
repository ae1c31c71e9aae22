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
from drivesizer.output.document.candidates import gearhead_words
from drivesizer.output.document.records import Small
from drivesizer.output.document.summary import parts_table
from drivesizer.output.parts import parts_list
from drivesizer.output.report.figures.field import Panel, paper_points, torque_speed
from drivesizer.output.report.figures.set_behaviour import Behaviour
from drivesizer.results.check_kinds import unknown_figures
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
    said = labels(torque_speed([Panel(cases=((0, "", found),))]))
    assert "load cycle" in said and not any("nan" in text or "RMS" in text for text in said)


def test_a_requirement_that_is_unknown_is_no_point_either(spec, catalog, chosen):
    known = size(spec, catalog=catalog, top=1).requirements
    lacking = tuple(replace(r, value=nan) if r.name == "maximum_torque_per_motor" else r for r in known)
    assert len(paper_points(chosen, known)) == 4
    names = {point.name for point in paper_points(chosen, lacking)}
    assert names == {"cruise", "RMS"}


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


def test_a_mass_that_a_data_sheet_has_is_not_called_unknown(chosen, catalog):
    weighed = replace(chosen, controller=replace(chosen.controller, mass=0.33))
    rows = parts_table(parts_list(weighed, catalog, 1), "one", "").rows[:-1]
    masses = {row.cells["role"]: row.cells["masses"].text for row in rows}
    assert (masses["encoder"], masses["controller"]) == ("unknown", "330 g")


def test_a_name_that_the_catalogue_made_up_is_no_order_number(chosen, catalog):
    made_up = catalog.encoders.record(catalog.encoders.rows["ENC 30 HEDL 5540"])
    lines = parts_list(replace(chosen, encoder=made_up), catalog, 1)
    cells = {row.cells["role"]: row.cells for row in parts_table(lines, "one", "").rows[:-1]}
    assert cells["encoder"]["order_number"] == "" and cells["motor"]["order_number"] == "118752"
    assert cells["encoder"]["named"][-1] == Small("no order number")


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
    document = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    assert document["validation"] is None
    assert any(said.startswith("not simulated in closed loop: motor") for said in document["warnings"])
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


def test_a_resistor_of_unknown_pulse_energy_lacks_that_alone(lift):
    lacks = dict(unknown_figures(lift))
    assert lacks["Brake resistor pulse energy"] == "brake resistor pulse energy"


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


def test_a_part_number_that_is_family_and_reduction_is_printed_once(lift):
    same = replace(lift.gearhead, family="38A", reduction="25:1", part="38A 25:1")
    assert gearhead_words(replace(lift, gearhead=same)) == "38A 25:1"
    assert gearhead_words(lift) == "GP 52 C 15:1 223084"


def test_a_part_that_no_catalogue_lists_is_so_in_the_report_too(lift, catalog):
    lines = parts_list(replace(lift, encoder=None), catalog, 1)
    (row,) = (row for row in parts_table(lines, "one", "").rows if row.cells["role"] == "encoder")
    assert row.cells["named"] == "none is listed for this motor"
