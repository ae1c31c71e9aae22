"""The command line as a user meets it: output, exit status, one-line errors, nothing written when wrong."""

import json
import math
import os
import subprocess
import sys
from dataclasses import fields

import pytest
from conftest import ROOT
from rich.cells import cell_len

from drivesizer import cli
from drivesizer.results.check import Check

ARM, PLATFORM = (f"{ROOT}/examples/{name}.yaml" for name in ("cords_arm", "sps_platform"))


@pytest.fixture
def run(run, monkeypatch, tmp_path):
    """Run the program in an empty folder; its status, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    return run


def test_size_prints_the_papers_drive(run, example):
    status, out, err = run("size", example, "-v")
    assert status == 0
    for words in ("RE 25", "118752", "GP 26 A 27:1", "406764", "225778", "EPOS4 Compact 50/5", "541718", "1.1"):
        assert words in out
    assert "208.9 rpm" in out
    assert "(13)" in out
    assert "by physics pass" in " ".join(out.split())  # by both methods, as the paper concludes
    assert "derived: length" in " ".join(out.split())
    assert "by the paper's equations and rule" in out
    assert "the whole catalogue gives" in " ".join(out.split())
    *printed, _, _, _ = out.splitlines()  # commands to copy do not wrap
    assert max(len(line.rstrip()) for line in printed) <= 80
    assert "note: " in err


def test_robot_yaml_is_the_default(run, example):
    status, _, err = run("size")
    assert (status, err.count("\n")) == (2, 1)
    assert "drivesizer init" in err
    assert run("init")[0] == 0
    assert run("size")[0] == 0
    status, _, err = run("init")
    assert status == 2
    assert "exists" in err


def test_json_contract(run, example):
    status, out, _ = run("size", example, "--json", "--top", "2")
    document = json.loads(out, parse_constant=lambda c: pytest.fail(f"{c} in the JSON"))
    assert status == 0
    assert document["schema"] == 2
    (axis,) = document["axes"]
    assert document["machine"] == axis["result"]["spec"]
    document = axis["result"]
    requirements = {one["name"]: one for one in document["requirements"]}
    assert document["method"] == "paper"
    assert document["spec"]["load"]["mass"] == "45 kg"
    assert list(requirements) == [
        "nominal_speed", "rolling_resistance_coefficient", "nominal_force", "nominal_torque",
        "nominal_torque_per_motor", "acceleration", "nominal_power_per_motor", "mechanical_power_per_motor",
        "wheel_mass", "wheel_inertia", "shaft_mass", "shaft_inertia", "acceleration_torque", "maximum_torque",
        "maximum_torque_per_motor", "deceleration_torque", "rms_torque", "rms_torque_per_motor",
        "maximum_power_per_motor", "rms_speed", "rms_power_per_motor",
    ]  # fmt: skip
    rms = requirements["rms_torque_per_motor"]
    assert (rms["symbol"], rms["equation"], rms["unit"]) == ("M_rms/m", 14, "N*m")
    assert rms["value"] == pytest.approx(0.211, abs=5e-4)
    assert (requirements["rms_speed"]["equation"], requirements["rms_speed"]["unit"]) == (None, "rad/s")
    best = document["sets"][0]
    assert {c["status"] for c in best["beside"]} == {"pass"}
    assert best["estimated"] == []  # no check rests on an estimate
    methods = {name: {c["method"] for c in best[name]} for name in ("checks", "beside", "budget")}
    assert methods == {"checks": {"paper"}, "beside": {"physics"}, "budget": {"budget"}}
    assert (best["rank"], best["status"], best["motor"]["part"]) == (1, "pass", "118752")
    assert best["motor"]["price"] is None
    assert best["mass_of"] == ["motor", "gearhead", "encoder", "controller"]
    assert best["total_ratio"] == pytest.approx(3249 / 121 * 1.1)
    names = {one["name"] for one in best["requirements"]}
    assert {"rms_torque_at_motor", "maximum_torque_at_motor", "speed_constant", "no_load_speed"} <= names
    assert set(best["checks"][0]) >= {field.name for field in fields(Check)} - {"origins", "turns_on"}
    counts = document["counts"]
    assert counts["considered"] == 18
    assert counts["feasible"] == 1
    assert counts["failed_by"]["gearhead_input_speed"] == 12


def test_nothing_fits_is_status_1(run, example_text, tmp_path):
    heavy = example_text.replace("mass: 45 kg", "mass: 450 kg").replace("select:\n", "select:\n  estimates: off\n")
    (tmp_path / "heavy.yaml").write_text(heavy)
    status, out, _ = run("size", "heavy.yaml")
    assert status == 1
    assert "No drive meets all limits" in out
    assert "load › mass 450 kg" in " ".join(out.split())
    status, out, _ = run("size", "heavy.yaml", "--json")
    document = json.loads(out)["axes"][0]["result"]
    assert (status, document["sets"]) == (1, [])
    assert document["misses"][0]["status"] == "fail"


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (["size", "nothing.yaml"], "cannot be read"),
        (["size", "EXAMPLE", "--objective", "beauty"], "expected mass"),
        (["size", "EXAMPLE", "--top", "0"], "--top"),
        (["size", "EXAMPLE", "--nonsense"], "--nonsense"),
        (["sizee"], "sizee"),
        (["explain", "EXAMPLE", "--motor", "118752"], "--gearhead"),
        (["explain", "EXAMPLE", "--motor", "nix", "--gearhead", "406764"], "in no catalogue"),
        (["equations", "60"], "1 to 59"),
        (["equations", "0"], "1 to 59"),
        (["equations", "33", ARM], "cords_arm.yaml: no section platform; expected one"),
        (["equations", "4", "EXAMPLE"], "sps_robot.yaml: equation (4) is no step of the derivation"),
        (["equations", "1", PLATFORM], "sps_platform.yaml: the paper treats a wheeled_vehicle without wind"),
        (["equations", "33", "nothing.yaml"], "nothing.yaml: cannot be read"),
        (["equations", "60", "nothing.yaml"], "1 to 59"),
        (["init", "--kind", "spaceship"], "wheeled_vehicle"),
        (["init", "-o", "no/such/folder.yaml"], "cannot be written"),
        (["validate", "EXAMPLE", "--set", "118752/406764/1.1"], "MOTOR/GEARHEAD"),
        (["validate", "EXAMPLE", "--set", "118752"], "needs one; expected a part number, or direct"),
        (["validate", "EXAMPLE", "--profile", "nothing.csv"], "nothing.csv"),
        (["validate", "EXAMPLE", "--profile", "zigzag"], "trapezoid"),
        (["report", "EXAMPLE", "-o", "report.doc"], ".pdf"),
        (["report", "EXAMPLE", "-o", "no/such/folder/report.csv"], "no/such"),
        (["report", "EXAMPLE"], "--output"),
    ],
)
def test_wrong_calls_are_one_line_and_write_nothing(run, example, tmp_path, args, words):
    status, out, err = run(*[str(example) if a == "EXAMPLE" else a for a in args])
    assert status == 2
    assert out == ""
    assert words in err
    assert err.count("\n") == 1
    assert err.startswith("drivesizer: ")
    assert list(tmp_path.iterdir()) == []


def test_explain_shows_why(run, example):
    status, out, _ = run("explain", example, "--motor", "118743", "--gearhead", "406764")
    text = " ".join(out.split())
    assert status == 1
    assert "Motor speed (no-load speed) 6169 rpm 4860 rpm −21 % FAIL" in text
    status, out, _ = run("explain", example, "--motor", "118752", "--gearhead", "406764", "--json")
    assert (status, json.loads(out)["axes"][0]["sets"][0]["status"]) == (0, "pass")
    direct = ("--set", "transmission=[{kind: direct}]", "--set", "select={catalogs: [maxon]}")
    _, alone, _ = run("explain", example, "--motor", "118752", *direct)
    assert alone.startswith("RE 25 118752 without gearhead")


def test_equations_listed_and_shown(run):
    status, out, _ = run("equations")
    assert status == 0
    assert all(f"({n})" in out for n in range(1, 21))
    _, out, _ = run("equations", "20")
    text = " ".join(out.split())
    assert "V_0 = V_nom + τ M_max/m0" in text
    assert "m/s cannot be added to rad/s" in text
    assert "V_0 = n_nom K + τ M_max/m0" in text
    _, out, _ = run("equations", "1")
    assert "unit check passes" in " ".join(out.split())


def test_equations_with_the_numbers_of_a_spec(run, example):
    """By hand: 2 · 1.5 / (0.1524 · 0.9) rad/s; 1 / 76.2 mm, and (238.5 + 135.0) / 76.2 of the wheels' places."""
    status, out, _ = run("equations", "1", example)
    assert (status, "n_nom = 2 · 1.5 m/s / (0.1524 m · 0.9) = 208.9 rpm" in out) == (0, True)
    status, out, _ = run("equations", "9", example)
    assert "Inertia of a wheel\nJ_w = " in out and "Inertia of a shaft\nJ_s = " in out
    assert "RE 25 118752" in out
    status, out, _ = run("equations", "33", PLATFORM)
    rows = [line.split() for line in out.splitlines()]
    assert status == 0 and "its largest" not in out and "Inertias" not in out  # no drive is sized for it
    assert ["E", "x", "(1/m)", "y", "(1/m)", "θ"] in rows and ["wheel", "3", "13.12", "13.12", "-4.901"] in rows
    assert ["l_1", "0.2385", "m"] in rows and ["l_2", "0.135", "m"] in rows
    status, out, _ = run("equations", "51", PLATFORM)
    assert "with motor and gearhead of" in out and "where wheel 1 has its largest torque" in " ".join(out.split())
    assert max(map(cell_len, out.splitlines())) <= 80


def test_validate_the_papers_set(run, example):
    status, out, err = run("validate", example)
    text = " ".join(out.split())
    assert status == 0
    assert "118752" in text
    assert "FAIL" not in text
    assert "unknown" not in text + err
    status, out, _ = run("validate", example, "--json", "--set", "118752/406764")
    (document,) = json.loads(out)["axes"][0]["validations"]
    by_name = {c["name"]: c["status"] for c in document["checks"]}
    assert status == 0
    assert document["status"] == "pass"  # the motor does not reach its limits, as the paper concludes
    assert set(by_name.values()) == {"pass"}
    limits = {c["name"]: c["limit"] for c in document["checks"]}
    assert (limits["motor_speed"], limits["winding_temperature"]) == pytest.approx((14000 * math.pi / 30, 125 + 273.15))


def test_files_of_size_validate_and_report(run, example, tmp_path):
    assert run("size", example, "--csv", "sets.csv")[0] == 0
    assert run("validate", example, "--csv", "loop.csv")[0] == 0
    status, out, _ = run("report", example, "-o", "report.csv")
    assert status == 0
    assert "report.csv" in out
    assert "406764" in (tmp_path / "sets.csv").read_text()
    assert (tmp_path / "loop.csv").stat().st_size > 1000
    assert "208.8" in (tmp_path / "report.csv").read_text()


def test_version_help_and_schema(run):
    import drivesizer

    assert run("--version")[1].strip() == f"drivesizer {drivesizer.__version__}"
    status, out, _ = run("--help")
    assert status == 0
    for command in ("size", "validate", "report", "explain", "equations", "init", "schema"):
        assert command in out
        assert "Example: drivesizer" in run(command, "--help")[1]
    assert json.loads(run("schema")[1])["title"] == "RobotSpec"


def test_a_reader_that_goes_away_is_no_error(example):
    command = f"{sys.executable} -m drivesizer equations | head -1"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=60, check=False)
    assert "Traceback" not in done.stderr


def test_the_list_of_commands_fits_80_columns_and_each_has_an_example(run, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    _, listed, _ = run("--help")
    assert "..." not in listed[listed.index("Commands:") :]
    for command in cli.app.registered_commands:
        name = command.name or command.callback.__name__
        status, out, _ = run(name, "--help")
        assert status == 0
        assert f"Example: drivesizer {name}" in " ".join(out.split())


def test_colour_is_for_a_terminal_that_wants_it(run, example, monkeypatch):
    """What goes into a file or a pipe has no colours, whatever; FORCE_COLOR gives them and NO_COLOR takes them."""
    monkeypatch.setenv("TERM", "xterm")
    for given, coloured in (({}, False), ({"FORCE_COLOR": "1"}, True), ({"FORCE_COLOR": "1", "NO_COLOR": "1"}, False)):
        for name in ("NO_COLOR", "FORCE_COLOR"):
            monkeypatch.delenv(name, raising=False)
        for name, value in given.items():
            monkeypatch.setenv(name, value)
        _, out, _ = run("explain", example, "--motor", "118752", "--gearhead", "406764")
        assert ("\x1b[32m" in out or "\x1b[1;32m" in out) == coloured


@pytest.mark.parametrize(
    ("typed", "offered"),
    [("drivesizer val", "validate"), ("drivesizer size --obj", "--objective"), ("drivesizer catalog sh", "show")],
)
def test_a_shell_completes_commands_groups_and_options(typed, offered):
    request = {"_DRIVESIZER_COMPLETE": "complete_bash", "COMP_WORDS": typed, "COMP_CWORD": str(typed.count(" "))}
    script = "import sys; sys.argv[0] = 'drivesizer'; from drivesizer.__main__ import main; main()"
    done = subprocess.run([sys.executable, "-c", script], env=os.environ | request, capture_output=True, check=False)
    assert done.stdout.decode().split() == [offered]
