"""A platform's trajectory as the load of its drives: against the sizing part, by hand, and what is refused."""

import csv
import io
import json
import math

import numpy as np
import pytest

from drivesizer.cli import main
from drivesizer.control.path_following import FollowingRun, follow_case
from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases.of_machine import load_cases
from drivesizer.load_cases.platform import driving, with_trajectory
from drivesizer.machine.platform_budget import permitted_speeds
from drivesizer.machine.supply_power import drive_power, together
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import RobotSpec, read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

VEHICLE = """
name: cart
load: {kind: wheeled_vehicle, mass: 45 kg, driven_wheels: 4, wheel_diameter: 152.4 mm, rolling_resistance: 0.02,
       friction_coefficient: 0.6, inertia: 40 kg*cm^2, slope: 2 deg}
transmission: [{kind: gearhead}, {kind: belt, ratio: 1.1, efficiency: 0.95}]
supply: {nominal: 24 V, min: 22 V, max: 29 V, current: 40 A, regeneration: 0.7}
margins: {torque: 10 %}
select: {catalogs: [maxon], motor: {family: [RE 25, RE 30, RE 40]}, gearhead: {family: [GP 26 A, GP 32 C, GP 42 C]}}
"""
PLATFORM = """
platform:
  layout: {kind: mecanum, wheelbase: 477 mm, track: 270 mm}
  centre_of_mass: {height: 0 mm}
  inertia: 2.3 kg*m^2
  uphill: 0 deg
  limits: {speed: 1.4 m/s, acceleration: 0.7 m/s^2, turning_speed: 60 deg/s, turning_acceleration: 60 deg/s^2}
"""
STRAIGHT = "motion: {speed: 1.4 m/s, acceleration_time: 2 s, cruise_time: 8 s}\n"


def waypoints(*points: str) -> str:
    return f"motion: {{waypoints: [{', '.join(f'{{{p}}}' for p in points)}]}}\n"


START = "x: 0 m, y: 0 m, heading: 0 deg"
AHEAD = waypoints(START, "x: 14 m, y: 0 m, heading: 0 deg")  # 1.4 m/s · (8 + 2) s


def spec_of(*parts: str) -> RobotSpec:
    return read_spec(YamlSource("".join(parts), "robot.yaml"))


# --- the same machine twice -----------------------------------------------------------------------------------------


def test_the_same_drives_pass_for_the_path_and_for_the_trapezoid():
    """Straight ahead and all wheels alike: every check that both have is the same, but for traction."""
    one, other = (size(spec_of(VEHICLE, *parts)) for parts in ((STRAIGHT,), (PLATFORM, AHEAD)))
    assert [s.label for s in one.sets] == [s.label for s in other.sets] and len(one.sets) > 2
    counts = [(found.counts.considered, found.counts.feasible, found.counts.failed_by) for found in (one, other)]
    assert counts[0] == counts[1]
    for a, b in zip(one.sets, other.sets, strict=True):
        mine, theirs = ({c.name: c for c in s.checks if c.name != "traction"} for s in (a, b))
        assert mine.keys() == theirs.keys()
        for name, check in mine.items():
            assert theirs[name].demand == pytest.approx(check.demand, rel=1e-6, nan_ok=True), name
            assert theirs[name].status == check.status


# --- the command's pieces ---------------------------------------------------------------------------------------------

TURNING = waypoints(
    "x: 0 m, y: 0 m, heading: 0 deg", "x: 6 m, y: 0 m, heading: 90 deg, pause: 2 s", "x: 6 m, y: -3 m, heading: 0 deg"
)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "robot.yaml").write_text(VEHICLE + PLATFORM + TURNING, encoding="utf-8")
    (tmp_path / "track.csv").write_text("x,y,heading\nm,m,deg\n0,0,0\n0,2,0\n", encoding="utf-8")
    return tmp_path


@pytest.fixture
def drive(folder, monkeypatch, capsys):
    def call(*arguments: str):
        monkeypatch.setattr("sys.argv", ["drivesizer", "drive", *arguments])
        with pytest.raises(SystemExit) as ended:
            main()
        return ended.value.code, *capsys.readouterr()

    return call


def test_the_command(folder, drive):
    status, out, _ = drive()
    assert status == 0 and "wheel" in out and "9 m in" in out and "Friction needed" in out
    status, out, _ = drive("robot.yaml", "track.csv", "--csv", "over.csv", "--json")
    document = json.loads(out)
    assert status in (0, 1) and document["length"] == pytest.approx(2.0)
    assert [w["number"] for w in document["wheels"]] == [1, 2, 3, 4]
    rows = list(csv.reader(io.StringIO((folder / "over.csv").read_text())))
    assert rows[0][:4] == ["time (s)", "x (m)", "y (m)", "heading (deg)"]
    assert float(rows[-1][2]) == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        ({"robot.yaml": VEHICLE + STRAIGHT}, "no section platform"),
        ({"robot.yaml": VEHICLE + PLATFORM + STRAIGHT}, "TRAJECTORY.CSV is missing"),
        (
            {"robot.yaml": VEHICLE + PLATFORM.replace("mecanum, wheelbase: 477 mm, ", "differential, ") + TURNING},
            "driven",
        ),
        ({"robot.yaml": VEHICLE.replace("45 kg", "-45 kg") + PLATFORM + TURNING}, "load.mass"),
        ({"robot.yaml": VEHICLE + TURNING}, "expected a section platform"),
        (
            {"robot.yaml": VEHICLE + PLATFORM.replace("speed: 1.4 m/s, acceleration: 0.7 m/s^2, ", "") + TURNING},
            "limits",
        ),
        ({"robot.yaml": VEHICLE + PLATFORM.replace("limits", "limit") + TURNING}, "platform.limit"),
        ({"robot.yaml": VEHICLE + PLATFORM.replace("track: 270 mm", "track: 0 mm") + TURNING}, "track"),
        ({"track.csv": "x,z\nm,m\n0,0\n"}, "track.csv:1: header"),
        ({"track.csv": "t,x,y,heading\ns,m,m,deg\n0,0,0,0\n1,0,0,0\n2,90,0,0\n3,90,0,0\n4,90,0,0\n"}, "track.csv"),
        ({"track.csv": "t,x,y\ns,m,m\n0,0,0\n"}, "track.csv:1: header"),
    ],
)
def test_what_is_wrong_is_one_line(folder, drive, changed, expected):
    for name, text in changed.items():
        (folder / name).write_text(text, encoding="utf-8")
    arguments = ("robot.yaml", "track.csv") if "track.csv" in changed else ("robot.yaml",)
    before = sorted(p.name for p in folder.iterdir())
    status, out, err = drive(*arguments, "--csv", "out.csv")
    assert status == 2 and out == "" and err.count("\n") == 1 and expected in err, err
    assert sorted(p.name for p in folder.iterdir()) == before


WALKER = """
  wheels:
    - {kind: fixed, x: 0 m, y: 0.3 m}
    - {kind: fixed, x: 0.5 m, y: 0 m, heading: 90 deg}
"""


def test_wheels_that_cannot_hold_a_platform_are_refused():
    """Two fixed wheels at right angles allow turning about one point only: no path leads anywhere."""
    text = VEHICLE.replace("driven_wheels: 4", "driven_wheels: 2") + PLATFORM.replace(
        "\n  layout: {kind: mecanum, wheelbase: 477 mm, track: 270 mm}", WALKER.rstrip()
    )
    with pytest.raises(InputError, match="slides"):
        load_cases(spec_of(text, AHEAD))
    same = text.replace("x: 0.5 m, y: 0 m", "x: 0 m, y: 0.3 m")
    with pytest.raises(InputError, match="stand in one place"):
        spec_of(same, AHEAD)


# --- the machine's mass -----------------------------------------------------------------------------------------------

OWN = "budget: {structure: 30 kg, drive_counts: true, mass: 60 kg}\n"


def test_a_drive_that_carries_itself():
    """The mass that it was sized for is structure and drive to the gram, estimated masses at the upper end."""
    result = size(spec_of(VEHICLE, PLATFORM, AHEAD, OWN), top=1)
    (best,) = result.sets
    drive = sum(row.ends[1] for row in best.masses if row.name != "structure" and row.each == row.each)
    load = result.spec.load
    assert load.mass == pytest.approx(30.0 + drive, abs=1e-3)
    again = size(spec_of(VEHICLE.replace("45 kg", f"{load.mass:.9f} kg"), PLATFORM, AHEAD), top=1)
    assert again.sets[0].label == best.label
    assert any("Settled" in said for said in result.warnings)


def test_the_energy_of_a_path_is_summed_over_its_wheels():
    """The energy of a cycle in the sizing is what the battery's side adds up from each wheel."""
    spec = spec_of(VEHICLE, PLATFORM, TURNING)
    result = size(spec, top=1)
    (best,) = result.sets
    parts = [case.spec for case in result.problem.cases]
    power = together([drive_power(case, best) for case in parts])
    drawn, returned = (power.total * power.mean(column) for column in (power.drawn, power.returned))
    figures = {f.name: f.value for f in best.figures}
    assert len(parts) == 4
    assert figures["energy"] == pytest.approx(drawn - 0.7 * returned, rel=1e-3)
    assert figures["returned"] == pytest.approx(returned, rel=1e-3)


# --- a motor that has failed ------------------------------------------------------------------------------------------


def test_three_motors_of_four_still_drive_the_path():
    """Straight on without wheel 2: t1 + t3 = t4 for no force aside, t1 + t4 = t3 for no moment: by the rear axle."""
    level = VEHICLE.replace("slope: 2 deg", "slope: 0 deg").replace("rolling_resistance: 0.02", "rolling_resistance: 0")
    spec = spec_of(level, PLATFORM, AHEAD)
    whole, left = (driving(with_trajectory(spec, None, failed)) for failed in ((), (2,)))
    assert [w.number for w in left.wheels] == [1, 3, 4]
    most = {w.number: float(np.abs(w.cycle.torque).max()) for w in left.wheels}
    usual = float(np.abs(whole.wheels[0].cycle.torque).max())
    assert most[3] == pytest.approx(2.0 * usual) and most[4] == pytest.approx(2.0 * usual)
    assert most[1] == pytest.approx(0.0, abs=1e-9)


def test_a_load_case_with_a_failed_motor_is_sized_for():
    """Torque doubles in the case without one motor, and the drives are sized for it; all four are still bought."""
    text = VEHICLE + PLATFORM + AHEAD
    plain, spare = (
        size(spec_of(text, case), top=1) for case in ("", "cases: [{name: lost, platform: {failed: [2]}}]\n")
    )
    torques = [
        next(r.value for r in result.requirements if r.name == "maximum_torque_per_motor") for result in (plain, spare)
    ]
    assert torques[1] == pytest.approx(2.0 * torques[0], rel=0.02)
    assert spare.spec.load.motors == 4


@pytest.mark.parametrize(
    ("failed", "expected"),
    [((5,), "there is no wheel 5"), ((2, 3), "with its driven wheels at rest"), ((1, 2, 3, 4), "no wheel is driven")],
)
def test_what_cannot_be_driven_any_more(failed, expected):
    with pytest.raises(InputError, match=expected):
        driving(with_trajectory(spec_of(VEHICLE, PLATFORM, TURNING), None, failed))


@pytest.mark.slow
def test_the_spec_says_how_soft_the_loops_are(folder):
    """A proportional loop lags by torque over gain, 0.168 N·m over 2 N·m·s/rad, for 12 s; an integral takes it away."""
    level = VEHICLE.replace("slope: 2 deg", "slope: 0 deg")
    soft = "  following: {speed_loop: P, speed_gain: 2 N*m*s/rad, slip_speed: 0.1 mm/s}\n"
    lag = 0.02 * 45.0 * 9.80665 * 0.0762 / 4 / 2.0 * 0.0762 * 12.0
    for more, behind in ((soft, lag), (soft.replace("P,", "PI,"), 0.0)):
        found = driving(with_trajectory(spec_of(level, PLATFORM, more, AHEAD), None))
        assert found.trajectory.total == pytest.approx(12.0)
        run = follow_case(found, None, FollowingRun("kinematic", "PI" in more, False, False))
        assert run.planned.posture[0, -1] - run.posture[0, -1] == pytest.approx(behind, rel=0.02, abs=lag / 10)
    with pytest.raises(InputError, match="speed_integral: a speed_loop P has none"):
        spec_of(level, PLATFORM, soft.replace("P,", "P, speed_integral: 1 N*m/rad,"), AHEAD)


# --- the speed that a drive permits in each direction -----------------------------------------------------------------

PAPER = """
name: the paper's platform
load: {kind: wheeled_vehicle, mass: 45 kg, driven_wheels: 4, wheel_diameter: 152.4 mm, rolling_resistance: 0.02,
       friction_coefficient: 0.6, inertia: 40 kg*cm^2}
transmission: [{kind: gearhead}, {kind: belt, ratio: 1.1, efficiency: 0.95}]
supply: {nominal: 48 V, min: 22 V, max: 50 V, current: 40 A, regeneration: 0.7}
power_stage: {voltage_drop: 1 V}
select: {catalogs: [maxon], motor: {family: RE 25}, gearhead: {family: GP 26 A},
         controller: {family: EPOS4 Compact 50/5, bus: CANopen}}
platform:
  wheels:
    - {kind: mecanum, distance: 274.06 mm, alpha: -29.5 deg, roller_angle: 45 deg}
    - {kind: mecanum, distance: 274.06 mm, alpha: 29.5 deg, roller_angle: -45 deg}
    - {kind: mecanum, distance: 274.06 mm, alpha: 150.5 deg, roller_angle: 45 deg}
    - {kind: mecanum, distance: 274.06 mm, alpha: 209.5 deg, roller_angle: -45 deg}
  inertia: 2.34 kg*m^2
  centre_of_mass: {height: 90 mm}
  limits: {speed: 1.5 m/s, acceleration: 0.75 m/s^2}
motion: {waypoints: [{x: 0 m, y: 0 m, heading: 0 deg}, {x: 3 m, y: 3 m, heading: 0 deg}]}
"""
SET = "118752", "406764"  # 42.73 rad/s/V or 0.0234 N*m/A, 2.32 ohm, 36.9 mA, 3.1 and 14 K/W; 27:1 at 80 %, 8000 rpm
RATIO = 1.1 * 3249 / 121
DIAGONAL = math.sqrt(2.0) / 0.0762  # rad/m of the two wheels that turn at 45 degrees
ROLLING = 0.02 * 45.0 * 9.80665 / 4 * 0.0762  # N*m, of a wheel


def speeds_of(text: str, *parts: str):
    spec = spec_of(text)
    (drive,) = explain(spec, *parts)
    return permitted_speeds(spec, drive)


def by_hand(torque: float, usable: float) -> float:
    """Speed of the motor [rad/s] at which a steady torque at the wheel takes the usable voltage, the winding warm."""
    current, speed, kelvin = torque / (RATIO * 0.8 * 0.95) / 0.0234 + 0.0369, 700.0, 0.0
    for _ in range(50):
        kelvin = 17.1 * 2.32 * (1.0 + 0.00392 * kelvin) * current**2 + 14.0 * 0.0234 * 0.0369 * speed
        speed = (usable - 2.32 * (1.0 + 0.00392 * kelvin) * current) / 0.0234
    return speed


def test_the_papers_drive_on_the_diagonal():
    """1.5 m/s at 45 degrees are 265.8 rpm of two wheels, 7852 rpm of their motors: 8000 rpm permit 1.528 m/s."""
    assert 1.5 * DIAGONAL * 30.0 / math.pi == pytest.approx(265.8, abs=0.05)
    assert 1.5 * DIAGONAL * 30.0 / math.pi * RATIO == pytest.approx(7852.0, abs=1.0)
    strong = speeds_of(PAPER.replace("min: 22 V", "min: 30 V"), *SET)
    assert strong.at(45)[0] == (pytest.approx(1.528, abs=5e-4), "Gearhead continuous input speed")
    weak = speeds_of(PAPER, *SET)  # 0.9 (22 V - 1 V)
    speed, limit = weak.at(45)[0]
    assert speed == pytest.approx(by_hand(ROLLING, 18.9) / RATIO / DIAGONAL, rel=1e-3)
    assert speed < 1.5 < weak.at(0)[0][0] and limit == "Motor voltage, cold and hot"
    assert weak.at(0)[0][0] == pytest.approx(speed * math.sqrt(2.0), rel=1e-6)  # the same torque, wheels turn at v / r
    assert set(weak.unknown) <= {"Motor permissible speed"}


def test_a_long_path_at_the_permitted_speed_takes_the_whole_voltage():
    """By the checks of a load cycle: 850 m on the diagonal that hardly gain speed."""
    speed = speeds_of(PAPER, *SET).at(45)[0][0]
    text = PAPER.replace("{x: 3 m, y: 3 m", "{x: 600 m, y: 600 m")
    (drive,) = explain(spec_of(text.replace("1.5 m/s, acceleration: 0.75", f"{speed} m/s, acceleration: 0.01")), *SET)
    check = next(c for c in drive.checks if c.name == "supply_voltage")
    assert check.margin == pytest.approx(0.0, abs=0.02) and check.limit == pytest.approx(18.9)
