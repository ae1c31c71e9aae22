"""Springs, gravity compensation and forces on links, against MuJoCo's own inverse of the same file and by hand."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drivesizer.errors import InputError
from drivesizer.joints.mass_columns import JointTorques, joint_torques
from drivesizer.physics.load_cycle import end_times
from drivesizer.spec.robot_section import RobotSection

G = 9.80665
LEG = """<mujoco>
  <compiler angle="radian" autolimits="true"/>
  <option gravity="0 0 -9.80665"/>
  <worldbody>
    <body name="thigh">
      <joint name="hip" axis="0 1 0" range="-3 3" stiffness="7" springref="0.4"/>
      <inertial pos="0 0 -0.1" mass="3" diaginertia="0.02 0.02 0.004"/>
      <body name="shank" pos="0 0 -0.3" gravcomp="0.8">
        <joint name="knee" axis="0 1 0" range="-3 3" stiffness="2" ref="0.2" springref="-0.3"/>
        <inertial pos="0 0 -0.15" mass="2" diaginertia="0.015 0.015 0.002"/>
        <body name="foot" pos="0 0 -0.25" gravcomp="1.2">
          <joint name="ankle" axis="0 1 0" range="-3 3" actuatorgravcomp="true"/>
          <inertial pos="0.05 0 0" mass="0.5" diaginertia="0.001 0.001 0.001"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
HERE = {"positions": {"hip": "-20 deg", "knee": "0 deg", "ankle": "0 deg"}}
THERE = {"positions": {"hip": "30 deg", "knee": "50 deg", "ankle": "-20 deg"}, "pause": "0.2 s"}


def leg(folder: Path, **fields: Any) -> JointTorques:
    (folder / "leg.xml").write_text(LEG, encoding="utf-8")
    given = {"description": "leg.xml", "waypoints": [HERE, THERE, HERE], "masses": "with_drives",
             "limits": {"all": {"speed": "5 rad/s", "acceleration": "20 rad/s^2"}}, **fields}  # fmt: skip
    return joint_torques(RobotSection.model_validate(given), str(folder / "leg.yaml"))


def demand(found: JointTorques, joint: str, case: int = 0) -> np.ndarray:
    """Torque of a joint at both ends of each piece of its motion, before it is cut where it changes sign."""
    weights = np.array([1.0, *(0.0 for _ in found.points)])
    return weights @ found.cases[case].torques.torque[:, :, found.joints.index(joint)]


def test_joints_springs_and_gravcomp_are_those_of_mj_inverse(tmp_path: Path) -> None:
    import mujoco

    found = leg(tmp_path)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "leg.xml"))
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data, motion = mujoco.MjData(model), found.cases[0].motion
    rows = [c.reshape(-1, 3) for c in (motion.position, motion.speed, motion.acceleration)]
    own = np.array([demand(found, joint) for joint in found.joints]).T
    for row in range(0, len(own), 17):
        data.qpos[:], data.qvel[:], data.qacc[:] = (c[row] for c in rows)
        mujoco.mj_inverse(model, data)
        assert own[row] == pytest.approx(data.qfrc_inverse, rel=1e-7, abs=1e-9)
    said = " ".join(found.notes)
    assert "springs of the description act beside the drives of hip, knee" in said
    assert "takes off shank, foot (gravcomp) is carried beside the drives, as by counterweights" in said
    left = leg(tmp_path, gravcomp="leave")
    knee = np.radians(-20.0) - 0.2  # of the shank against the plumb line, at the start; the foot is level with it
    lever = 0.8 * 2 * 0.15 * np.sin(knee) + 1.2 * 0.5 * (0.25 * np.sin(knee) - 0.05 * np.cos(knee))
    assert demand(left, "knee")[0] - demand(found, "knee")[0] == pytest.approx(G * lever)
    assert demand(left, "ankle") == pytest.approx(demand(found, "ankle"))  # whose drive is said to carry it


def test_a_force_on_the_foot_by_hand(tmp_path: Path) -> None:
    """At rest: its moment about each joint; along the way its power is what the drives give for it."""
    force = np.array([40.0, 0.0, 200.0])
    given = {"link": "foot", "at": ["0 mm", "0 mm", "-50 mm"], "force": [f"{one} N" for one in force]}
    found, without = leg(tmp_path, forces=[given]), leg(tmp_path)
    motion = found.cases[0].motion
    hip, knee, ankle = (motion.position[:, :, n].ravel() for n in range(3))
    knee = knee - 0.2  # from its reference
    angles = np.array([hip, hip + knee, hip + knee + ankle])
    reach = np.array([[0.3], [0.25], [0.05]])
    x, z = -(reach * np.sin(angles)), -(reach * np.cos(angles))  # each part hangs down at 0 and turns about y
    for joint, first in (("hip", 0), ("knee", 1), ("ankle", 2)):
        arm = x[first:].sum(axis=0), z[first:].sum(axis=0)
        moment = arm[1] * force[0] - arm[0] * force[2]  # about y, of the force on the joint
        assert demand(found, joint) - demand(without, joint) == pytest.approx(-moment, abs=1e-9)


def test_a_force_over_time_is_followed_from_row_to_row(tmp_path: Path) -> None:
    """A blow of 500 N in 20 ms within the pause, on the foot: 500 N times its lever about the hip."""
    plain = leg(tmp_path)
    total = float(plain.cases[0].motion.duration.sum())
    times = [0.0, total / 2 - 0.02, total / 2, total / 2 + 0.02, total]
    rows = "".join(f"{t!r},0,0,{500.0 if n == 2 else 0.0}\n" for n, t in enumerate(times))
    (tmp_path / "foot.csv").write_text(f"time,x,y,z\ns,N,N,N\n{rows}", encoding="utf-8")
    hold = {"name": "there", "positions": {"hip": "10 deg"}}
    found = leg(tmp_path, forces=[{"link": "foot", "file": "foot.csv"}], holds=[hold])
    motion = found.cases[0].motion
    assert motion.duration.sum() == pytest.approx(total)
    ends = end_times(motion.duration).ravel()
    middle = int(np.abs(ends - total / 2).argmin())
    blow, still = demand(found, "hip")[[middle, middle - 1]]  # and where the blow begins
    hip, knee = np.radians(30.0), np.radians(50.0) - 0.2
    assert blow - still == pytest.approx(-500.0 * (0.3 * np.sin(hip) + 0.25 * np.sin(hip + knee)), rel=1e-9)
    assert "not in poses that are held" in " ".join(found.notes)
    late = rows.replace(repr(total), repr(total / 2 + 0.5))
    (tmp_path / "foot.csv").write_text(f"time,x,y,z\ns,N,N,N\n{late}", encoding="utf-8")
    with pytest.raises(InputError, match=r"foot\.csv: time from 0 to .* s; expected all of the trajectory, 0 to"):
        leg(tmp_path, forces=[{"link": "foot", "file": "foot.csv"}])


def test_two_motors_share_a_joint_and_a_spring_of_the_section_counts_from_the_start(tmp_path: Path) -> None:
    spring = {"kind": "torsion", "rate": "9 N*m/rad", "torque": "1 N*m"}
    one = leg(tmp_path, springs={"knee": [spring]})
    moved = one.cases[0].motion.position[:, :, 1].ravel() - one.cases[0].motion.position[0, 0, 1]
    assert demand(one, "knee") - demand(leg(tmp_path), "knee") == pytest.approx(9.0 * moved - 1.0, abs=1e-9)
    two = leg(tmp_path, springs={"knee": [spring]}, drives={"knee": {"motors": 2}})
    both, alone = two.load("knee", {}), one.load("knee", {})
    assert both.motors == 2
    assert 2 * both.cycle.torque == pytest.approx(alone.cycle.torque)
    assert (2 * both.cycle.inertia, 2 * both.cycle.holding_torque) == pytest.approx(
        (alone.cycle.inertia, alone.cycle.holding_torque)
    )


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"springs": {"knie": []}}, '"knie" is no joint'),
        ({"springs": {"knee": [{"kind": "counterweight", "mass": "1 kg"}]}}, "is mass of its link"),
        ({"springs": {"knee": [{"kind": "linear", "rate": "1 N/mm"}]}}, "a force about an axis needs ends"),
        ({"forces": [{"link": "toe", "force": ["0 N", "0 N", "1 N"]}]}, '"toe" is no link'),
    ],
)
def test_what_does_not_fit_the_robot(fields: dict[str, Any], said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        leg(tmp_path, **fields)


GANTRY = """<mujoco><compiler autolimits="true"/><worldbody>
  <body name="bridge"><joint name="x" type="slide" axis="1 0 0" range="-1 1"/>
    <inertial pos="0 0 0" mass="2" diaginertia="0.1 0.1 0.1"/>
    <body name="head"><joint name="y" type="slide" axis="0 1 0" range="-1 1"/>
      <inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/></body></body></worldbody></mujoco>"""


def test_a_corexy_gantry_by_hand(tmp_path: Path) -> None:
    """(F_x ± F_y) / 2 at each belt: 3 kg along x on both motors; along a diagonal on one alone."""
    (tmp_path / "leg.xml").write_text(GANTRY, encoding="utf-8")
    drive = {"travel_per_turn": "40 mm"}
    plain = {
        "description": "leg.xml", "masses": "without", "drives": {"x": drive, "y": drive},
        "limits": {"all": {"speed": "1 m/s", "acceleration": "3 m/s^2"}},
        "waypoints": [{"positions": {"x": "0 m", "y": "0 m"}}, {"positions": {"x": "100 mm", "y": "300 mm"}}],
    }  # fmt: skip
    both = RobotSection.model_validate(plain | {"couplings": [{"kind": "corexy", "joints": ["x", "y"]}]})
    found = joint_torques(both, str(tmp_path / "leg.yaml"))
    r = 0.04 / (2 * np.pi)
    first, second = found.load("x", {}).cycle, found.load("y", {}).cycle
    a_y = 3.0  # m/s², and a third of it along x
    assert first.torque[0, 0] == pytest.approx((3 * a_y / 3 + 1 * a_y) / 2 * r)
    assert second.torque[0, 0] == pytest.approx(0.0, abs=1e-12)  # 3 kg · 1 m/s² is 1 kg · 3 m/s²
    assert first.acceleration[0, 0] == pytest.approx((a_y / 3 + a_y) / r)
    assert second.acceleration[0, 0] == pytest.approx((a_y / 3 - a_y) / r)
    assert first.inertia == pytest.approx((3 + 1) / 4 * r**2)


def test_a_differential_wrist_shares_both_joints(tmp_path: Path) -> None:
    """T = (τ_1 ± τ_2 / i) / 2, and together the drives do the work of the joints; both sit before the first joint."""
    pair = {"kind": "differential", "joints": ["knee", "ankle"], "ratio": 2}
    alone, found = leg(tmp_path, masses="without"), leg(tmp_path, couplings=[pair], masses="without")
    knee, ankle = demand(alone, "knee"), demand(alone, "ankle")
    assert demand(found, "knee") == pytest.approx((knee + ankle / 2) / 2, abs=1e-9)
    assert demand(found, "ankle") == pytest.approx((knee - ankle / 2) / 2, abs=1e-9)
    speed = found.cases[0].motion.speed.reshape(-1, 3)
    drives = speed @ found.coupling.T
    done = sum(demand(found, joint) * drives[:, n] for n, joint in enumerate(found.joints))
    assert done == pytest.approx(sum(demand(alone, one) * speed[:, n] for n, one in enumerate(alone.joints)), abs=1e-9)
    assert found.carried["knee"] == () and alone.carried["knee"] == ("ankle",)
    for wrong, said in (
        ({"joints": ["knee", "toe"]}, '"toe" is no joint'),
        ({"kind": "corexy"}, '"knee" turns; the joints of kind: corexy slide'),
        ({"joints": ["knee", "knee"]}, '"knee" is coupled twice'),
    ):  # fmt: skip
        with pytest.raises(InputError, match=said):
            leg(tmp_path, couplings=[pair | wrong])
