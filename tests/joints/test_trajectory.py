"""Trajectories of joints: recorded and planned, inside limits, each fault one line."""

from __future__ import annotations

import math
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from refusals import refusal

from drivesizer.errors import FieldError, InputError
from drivesizer.joints.mass_columns import joint_torques
from drivesizer.joints.trajectory import motion_of, moves_of
from drivesizer.spec.description import Robot, read_description
from drivesizer.spec.robot_section import RobotSection

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>'
ROBOT = f"""<robot name="r"><link name="base"/>
<link name="a">{INERTIAL}</link><link name="b">{INERTIAL}</link><link name="c">{INERTIAL}</link>
<joint name="turn" type="revolute"><parent link="base"/><child link="a"/>
  <limit lower="-2" upper="2" velocity="3"/></joint>
<joint name="slide" type="prismatic"><parent link="a"/><child link="b"/>
  <limit lower="0" upper="0.5" velocity="1"/></joint>
<joint name="spin" type="continuous"><parent link="b"/><child link="c"/></joint>
</robot>
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("robot")
    (made / "robot.urdf").write_text(ROBOT, encoding="utf-8")
    return made


@pytest.fixture(scope="module")
def robot(folder: Path) -> Robot:
    return read_description(folder / "robot.urdf")


def section(**fields: Any) -> RobotSection:
    return RobotSection.model_validate({"description": "robot.urdf", **fields})


def between(*stops: dict[str, str], **fields: Any) -> RobotSection:
    return section(waypoints=[{"positions": stop} for stop in stops], **fields)


ALL = {"all": {"speed": "1 rad/s", "acceleration": "2 rad/s^2"}}


# --- waypoints


def test_one_joint_as_worked_out_by_hand(robot: Robot) -> None:
    fastest, smooth = (
        moves_of(between({"turn": "0 rad"}, {"turn": "1 rad"}, limits=ALL, law=law), robot)
        for law in ("fastest", "poly5")
    )
    assert fastest.duration.sum() == pytest.approx(1.5) and smooth.duration.sum() == pytest.approx(1.875)
    assert fastest.speed.max() == pytest.approx(1.0) and np.abs(fastest.acceleration).max() == pytest.approx(2.0)
    assert smooth.speed.max() == pytest.approx(1.0) and np.abs(smooth.acceleration).max() < 2.0
    for one in (fastest, smooth):
        assert one.position[-1, 1, 0] == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("law", ["fastest", "poly5"])
@pytest.mark.parametrize("jerk", [None, 8.0])
def test_joints_arrive_together_and_one_limit_is_met(law: str, jerk: float | None, robot: Robot) -> None:
    limits: dict[str, Any] = {
        "turn": {"speed": "2 rad/s", "acceleration": "4 rad/s^2"},
        "slide": {"speed": "0.3 m/s", "acceleration": "5 m/s^2"},
    }
    if jerk:
        limits["turn"]["jerk"], limits["slide"]["jerk"] = f"{jerk} rad/s^3", f"{jerk} m/s^3"
    stops = {"turn": "0 deg", "slide": "0 mm"}, {"turn": "90 deg", "slide": "400 mm"}, {"turn": "-30 deg"}
    moved = moves_of(between(*stops, law=law, limits=limits), robot)
    assert moved.joints == ("turn", "slide")
    assert (np.abs(moved.speed) <= np.array([2.0, 0.3]) * (1 + 1e-9)).all()
    assert (np.abs(moved.acceleration) <= np.array([4.0, 5.0]) * (1 + 1e-9)).all()
    # the curve is its own derivative's integral: positions by Simpson's rule on speeds, exact for cubics
    step = moved.duration[:, None]
    trapezoid = (moved.speed[:, 0] + moved.speed[:, 1]) / 2 * step
    bend = (moved.acceleration[:, 0] - moved.acceleration[:, 1]) / 12 * step**2
    assert moved.position[:, 1] - moved.position[:, 0] == pytest.approx(trapezoid + bend, abs=2e-9)
    assert moved.position[1:, 0] == pytest.approx(moved.position[:-1, 1], abs=1e-12)
    first = moved.position[: int(np.argmax(moved.position[:, 1, 0])) + 1]
    assert first[:, :, 1] == pytest.approx(first[:, :, 0] / math.radians(90) * 0.4, abs=1e-9)  # a straight line
    tight = np.abs(moved.speed).max(axis=(0, 1)) / [2.0, 0.3]
    swift = np.abs(moved.acceleration).max(axis=(0, 1)) / [4.0, 5.0]
    assert jerk or max(*tight, *swift) == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (between({"turn": "0 deg"}, {"turn": "1 m"}, limits=ALL), 'slides, and "turn" turns; expected e.g. 10 deg'),
        (between({"turn": "0 deg"}, {"trun": "1 deg"}, limits=ALL), '"trun" is no joint of'),
        (between({"turn": "0 deg"}, {"turn": "1 deg", "spin": "3 deg"}, limits=ALL), 'joint "spin" moves later'),
        (between({"spin": "0 deg"}, {"spin": "1 deg"}), 'joint "spin" has no limit of speed; expected speed here'),
        (between({"turn": "0 deg"}, {"turn": "1 deg"}), 'joint "turn" has no limit of acceleration'),
        (between({"turn": "9 deg"}, {"turn": "9 deg"}, limits=ALL), "nothing moves"),
        (between({}, {}, limits=ALL), "no joint moves; expected its positions"),
        (
            between({"turn": "0 deg"}, {"turn": "3 rad"}, limits=ALL),
            'joint "turn" is at 3 rad after 3.5 s; expected -2 to 2',
        ),
        (
            between(
                {"turn": "0 deg"}, {"turn": "2 rad"}, limits={"turn": {"speed": "9 rad/s", "acceleration": "9 rad/s^2"}}
            ),
            'joint "turn" has 4.243 rad/s after 0.4714 s; expected at most 3 rad/s, its limits in',
        ),
    ],
)
def test_waypoints_that_cannot_be_followed(made: RobotSection, said: str, robot: Robot, folder: Path) -> None:
    with pytest.raises(FieldError) as caught:
        motion_of(made, robot, str(folder / "machine.yaml"))
    assert said in str(caught.value) and "\n" not in str(caught.value)
    assert caught.value.field[0] == "robot"


# --- recorded


def recorded(folder: Path, robot: Robot, text: str, **fields: Any) -> Any:
    (folder / "moves.csv").write_text(text, encoding="utf-8")
    return motion_of(section(trajectory="moves.csv", **fields), robot, str(folder / "machine.yaml"))


def table(time: Any, *columns: Any, head: str = "time,turn", units: str = "s,rad") -> str:
    rows = [",".join(repr(float(x)) for x in row) for row in zip(time, *columns, strict=True)]
    return "\n".join([head, units, *rows]) + "\n"


def test_a_recorded_move_has_its_own_derivatives(folder: Path, robot: Robot) -> None:
    time = np.linspace(0.0, 2.0, 201)
    x = time / 2.0
    rise = 10 * x**3 - 15 * x**4 + 6 * x**5
    found = recorded(folder, robot, table(time, rise, 400 * rise, head="time,turn,slide", units="s,rad,mm"))
    assert found.joints == ("turn", "slide")
    at = found.time / 2.0
    assert found.position[:, :, 0] == pytest.approx(10 * at**3 - 15 * at**4 + 6 * at**5, abs=1e-8)
    assert found.speed[:, :, 1] == pytest.approx(0.4 * 15 * at**2 * (1 - at) ** 2, abs=1e-5)
    assert found.acceleration[:, :, 0] == pytest.approx(15 * at * (1 - at) * (1 - 2 * at), abs=2e-2)
    assert not found.speed[0, 0].any() and not found.speed[-1, 1].any()


def test_a_gait_is_periodic_and_a_wheel_goes_on_turning(folder: Path, robot: Robot) -> None:
    time = np.linspace(0.0, 1.0, 101)
    swing, steady = np.sin(2 * np.pi * time), 2 * np.pi * time
    found = recorded(folder, robot, table(time, swing * 0.3, steady, head="time,turn,spin", units="s,rad,rad"))
    assert found.speed[0, 0] == pytest.approx([0.6 * np.pi, 2 * np.pi], rel=1e-5)
    assert found.speed[-1, 1] == pytest.approx(found.speed[0, 0], rel=1e-12)
    assert found.acceleration[-1, 1] == pytest.approx(found.acceleration[0, 0], abs=1e-9)
    assert np.abs(found.acceleration[:, :, 1]).max() < 1e-9


def test_a_continuous_joint_has_no_limits_of_position(tmp_path: Path) -> None:
    limit = '<child link="c"/><limit lower="0" upper="0" velocity="2"/>'
    (tmp_path / "robot.urdf").write_text(ROBOT.replace('<child link="c"/>', limit), encoding="utf-8")
    made = between({"spin": "0 deg"}, {"spin": "900 deg"}, limits={"spin": {"acceleration": "5 rad/s^2"}})
    found = motion_of(made, read_description(tmp_path / "robot.urdf"), "")
    assert found.speed.max() == pytest.approx(2.0) and found.position.max() == pytest.approx(math.radians(900))


def test_joints_stand_where_samples_are_the_same(folder: Path, robot: Robot) -> None:
    time = np.linspace(0.0, 3.0, 301)
    x = np.clip(time - 1.0, 0.0, 1.0)
    rise = 10 * x**3 - 15 * x**4 + 6 * x**5
    found = recorded(folder, robot, table(time, rise))
    rests = (found.time[:, 1] <= 0.98) | (found.time[:, 0] >= 2.02)
    assert not found.speed[rests].any() and not found.acceleration[rests].any()
    assert (found.speed >= -1e-9).all()


def test_noise_is_smoothed_or_refused(folder: Path, robot: Robot) -> None:
    time = np.linspace(0.0, 2.0, 1001)
    x = time / 2.0
    coarse = table(time, np.round(10 * x**3 - 15 * x**4 + 6 * x**5, 4))
    with pytest.raises(InputError, match=r"moves\.csv: turn: the last digit, 0\.0001 rad, stands for 150 rad/s\^2"):
        recorded(folder, robot, coarse)
    found = recorded(folder, robot, coarse, smoothing="0.1 s")
    at = found.time / 2.0
    assert found.acceleration[:, :, 0] == pytest.approx(15 * at * (1 - at) * (1 - 2 * at), abs=0.3)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("t,turn\ns,rad\n", 'moves.csv:1: header: "t,turn"; expected time and joints, e.g. time,turn,slide,spin'),
        ("time,trun\ns,rad\n", 'moves.csv:1: header: "trun" is no joint of'),
        ("time,turn,turn\ns,rad,rad\n", "has a column twice"),
        ("time,turn\ns,mm\n", 'moves.csv:2: turn: "mm"'),
        ("time,turn\ns,rad\n0,0\n1,0\n2,x\n", 'moves.csv:5: turn: "x" is not a finite number'),
        ("time,turn\ns,rad\n0,0\n1,1\n", "rows: 2 found; expected at least 4"),
        (table(range(5), [1] * 5), "nothing moves"),
        (table(range(5), [0, 1, 2, 3, 4]), "moves at its ends, 4 rad apart; expected rest at both"),
        (
            table(range(7), [0, 0, 0, 3, 0, 0, 0]),
            'joint "turn" is at 3 rad after 3 s; expected -2 to 2 rad, its limits',
        ),
        (table([0, 0.1, 0.2, 0.3, 0.4, 0.5], [0, 0, 0, 1.5, 1.5, 1.5]), 'joint "turn" has 22.5 rad/s after 0.25 s'),
    ],
)
def test_recordings_that_are_none(text: str, said: str, folder: Path, robot: Robot) -> None:
    assert said in refusal(lambda: recorded(folder, robot, text))


# --- of a whole section


MOVES = ({"turn": "0 deg"}, {"turn": "50 deg"})


@pytest.mark.parametrize(
    ("fields", "changed", "said"),
    [
        ({"held": {"turn": "3 deg"}}, (), '"turn" is moved by the trajectory; leave it out'),
        ({"held": {"slide": "900 mm"}}, (), "does not move and is held at 0.9 m; expected 0 to 0.5 m, its limits"),
        ({"drives": {"slide": {"travel_per_turn": "5 mm"}}}, (), '"slide" is no joint that moves'),
        ({"drives": {"turn": {"travel_per_turn": "5 mm"}}}, (), 'joint "turn" turns; leave it out'),
        ({"drives": {"turn": {"on": "link", "link": "x"}}}, (), '"x" is no link of'),
        ({"payload": {"mass": "1 kg", "link": "base"}}, (), 'nothing moves link "base"'),
        ({"holds": [{"name": "x", "positions": {"spin": "1 deg"}}]}, (), '"spin" is held at one position throughout'),
        ({"holds": [{"name": "x", "positions": {"turn": "200 deg"}}]}, (), 'joint "turn" is at 3.491 rad after 0 s'),
        ({}, (' lower="-2" upper="2" velocity="3"', ""), "has no limits of position; expected lower and upper"),
        (
            {},
            ('"continuous"', '"floating"'),
            'joint "spin" is "floating"; expected joints that are fixed, turn or slide',
        ),
        (
            {},
            ('<parent link="b"/>', '<parent link="b"/><mimic joint="turn"/>'),
            'joint "spin" follows "turn"; expected it',
        ),
        (
            {},
            (INERTIAL, '<visual><geometry><mesh filename="a.stl"/></geometry></visual>'),
            "so that its mass is unknown",
        ),
        ({}, ('ixx="1"', 'ixy="9" ixx="1"'), "has an inertia of -8 kg*m^2 about an axis; expected 0 or more"),
        ({}, ('name="a">', 'name="b">'), 'link "b" is there twice'),
        ({}, ('<mass value="1"/>', '<mass value="1e12"/>'), 'link "a" has 1e+12 kg; no robot has more than 1e+08 kg'),
        ({}, ('<mass value="1"/>', '<mass value="1e60"/>'), '<mass> value: "1e60" is no number'),
        ({}, ('<mass value="1"/>', '<mass value="\u0661"/>'), '<mass> value: "\u0661" is no number'),
        ({}, ("<child", '<origin xyz="0 0 2e4"/><child'), 'joint "turn" has 2e+04 m; no robot has more than 10000 m'),
        ({"limits": {"all": {"acceleration": "1 rad/s^2"}}}, ('"3"', '"1e-30"'), "a move takes 8.73e+29 s"),
    ],
)
def test_sections_that_do_not_fit_their_description(
    fields: dict[str, Any], changed: tuple[str, str], said: str, tmp_path: Path
) -> None:
    text = ROBOT.replace(*changed, 1) if changed else ROBOT
    (tmp_path / "robot.urdf").write_text(text, encoding="utf-8")
    assert said in refusal(
        lambda: joint_torques(between(*MOVES, **{"limits": ALL, **fields}), str(tmp_path / "machine.yaml"))
    )


def test_a_joint_that_slides_needs_the_travel_per_turn_of_its_shaft(folder: Path) -> None:
    limits = {"slide": {"speed": "0.5 m/s", "acceleration": "2 m/s^2"}}
    stops = {"slide": "0 mm"}, {"slide": "300 mm"}
    file = str(folder / "machine.yaml")
    with pytest.raises(FieldError, match='joint "slide" slides; expected travel_per_turn'):
        joint_torques(between(*stops, limits=limits), file)
    found = joint_torques(between(*stops, limits=limits, drives={"slide": {"travel_per_turn": "20 mm"}}), file)
    cycle = found.load("slide", {}).cycle
    radius = 0.02 / (2 * math.pi)
    assert cycle.speed.max() == pytest.approx(0.5 / radius) and cycle.radius == pytest.approx(radius)
    assert cycle.inertia == pytest.approx(2.0 * radius**2)  # links b and c
    assert np.abs(cycle.torque).max() == pytest.approx(2.0 * 2.0 * radius, rel=1e-9)
    assert found.notes[0] == "joints that the trajectory does not move are held: turn at 0 rad, spin at 0 rad"


def test_drives_that_carry_each_other_are_refused(tmp_path: Path) -> None:
    """Two branches, the drive of each on the other's link."""
    text = ROBOT.replace('<parent link="b"/>', '<parent link="base"/>')
    (tmp_path / "robot.urdf").write_text(text, encoding="utf-8")
    drives = {"turn": {"on": "link", "link": "c"}, "spin": {"on": "link", "link": "a"}}
    made = between({"turn": "0 deg", "spin": "0 deg"}, {"turn": "9 deg", "spin": "9 deg"}, limits=ALL, drives=drives)
    with pytest.raises(FieldError, match="joints carry each other's drives in a circle: "):
        joint_torques(made, str(tmp_path / "machine.yaml"))
    shutil.rmtree(tmp_path)
