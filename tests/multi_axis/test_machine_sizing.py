"""Machines of several axes: what rides on what, the same drives as of single specs, all combinations of small arms."""

from __future__ import annotations

import math
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from exports import rendered
from refusals import refusal
from small_arms import arm, catalogue, least_of_all, two_joints

from drivesizer.joints.mass_columns import joint_torques
from drivesizer.machine.budgets import riding_mass
from drivesizer.machine.problem import problem
from drivesizer.multi_axis import alone, size_machine
from drivesizer.output.export import machine_export
from drivesizer.output.json.documents import as_text, report
from drivesizer.results.machine import MachineSizing, of_one_axis
from drivesizer.search.columns.candidates import candidates
from drivesizer.search.columns.evaluation import evaluate
from drivesizer.search.set_record import drive_parts
from drivesizer.search.shortlist import load_parts
from drivesizer.sizing import explain, size
from drivesizer.spec.description import read_description
from drivesizer.spec.machine import MachineSpec, load_machine, machine_of
from drivesizer.spec.robot import load_spec
from drivesizer.units import show

pytestmark = pytest.mark.usefixtures("no_further_searches")

MOTION = {"profile": "trapezoid", "speed": "0.5 m/s", "acceleration_time": "0.3 s", "cruise_time": "0.5 s",
          "rest_time": "0.5 s", "there_and_back": True}  # fmt: skip
GANTRY: dict[str, Any] = {
    "name": "gantry",
    "supply": {"nominal": "48 V", "current": "30 A"},
    "select": {"motor": {"family": "EC-max*"}, "gearhead": {"family": "GP 32*"}},
    "axes": {
        "bridge": {
            "load": {"kind": "belt_axis", "mass": "12 kg", "pulley_diameter": "40 mm"}, "motion": MOTION,
            "carries": ["lift"],
        },
        "lift": {
            "load": {"kind": "rack_pinion", "mass": "3 kg", "pinion_diameter": "30 mm", "incline": "90 deg"},
            "motion": MOTION,
        },
    },
}  # fmt: skip


@pytest.fixture(scope="module")
def gantry() -> MachineSizing:
    return size_machine(load_machine(GANTRY), top=2)


def test_a_carried_axis_is_sized_as_a_spec_of_its_own(gantry: MachineSizing) -> None:
    shared = {name: value for name, value in GANTRY.items() if name != "axes"}
    alone = {**shared, "name": "lift", **GANTRY["axes"]["lift"]}
    alone["supply"] = {**alone["supply"], "accepts": "all"}
    assert gantry.axis("lift").best.label == size(load_spec(alone), top=1).sets[0].label
    assert not gantry.axis("lift").carried


def test_the_carrier_is_sized_with_the_mass_of_the_carried_drives(gantry: MachineSizing) -> None:
    bridge, lift = gantry.axis("bridge"), gantry.axis("lift").best
    (riding,) = bridge.carried
    parts = [lift.motor.mass, lift.gearhead.mass, *([lift.brake.mass] if lift.brake else [])]
    assert riding.of == "lift" and riding.mass >= sum(parts) and riding.mass < sum(parts) + 0.2  # an encoder at most
    shared = {name: value for name, value in GANTRY.items() if name != "axes"}
    heavier = {**shared, "name": "bridge", "load": dict(GANTRY["axes"]["bridge"]["load"]), "motion": MOTION}
    heavier["load"]["mass"] = f"{12.0 + riding.mass!r} kg"
    heavier["supply"] = {**heavier["supply"], "accepts": "all"}
    spec, best = load_spec(heavier), bridge.best
    assert best.objective == size(spec, top=1).sets[0].objective  # several weigh the same
    (by_itself,) = explain(spec, best.motor.part, best.gearhead.part)
    for one, other in zip(best.checks, by_itself.checks, strict=True):
        assert one.name.removeprefix("common_") == other.name
        assert one.demand == pytest.approx(other.demand, rel=1e-12, nan_ok=True)
    assert alone(gantry.machine, "bridge").axes[0].spec.load.mass == pytest.approx(12.0 + riding.mass, rel=1e-15)


def test_a_machine_of_one_axis_is_that_spec() -> None:
    shared = {name: value for name, value in GANTRY.items() if name != "axes"}
    sections = GANTRY["axes"]["lift"]
    machine, spec = load_machine({**shared, "axes": {"lift": sections}}), load_spec({**shared, **sections})
    one, other = (size_machine(of, top=1) for of in (machine, machine_of(spec)))
    assert as_text(one) == as_text(other) == as_text(of_one_axis(size(spec, top=1)))
    assert as_text(report(one, {})) == as_text(report(other, {}))


def test_an_axis_alone_has_the_drive_that_is_the_best_for_all(tmp_path: Path) -> None:
    found = size_machine(arm(Random(31), tmp_path, "price"), top=1)  # a dearer and lighter drive is worth its price
    moved = next(axis for axis in found.axes if axis.for_all)
    best = size_machine(alone(found.machine, moved.name), top=1).axes[0].best
    assert best.label == moved.best.label and repr(best.checks) == repr(moved.best.checks)


def test_distances_of_what_rides_add_along_the_chain() -> None:
    """But where it is written: the wrist's drive 400 mm from the elbow, that 100 mm from the lift, and folded back."""
    plain: dict[str, Any] = {"load": {"kind": "arm", "mass": "0.5 kg", "length": "130 mm"},
                             "motion": GANTRY["axes"]["lift"]["motion"] | {"speed": "60 deg/s"}}  # fmt: skip
    axes = {
        "lift": plain | {"carries": {"elbow": {"at": "100 mm"}, "wrist": {"at": "300 mm"}}},
        "elbow": plain | {"carries": {"wrist": {"at": "400 mm"}}},
        "wrist": plain,
    }
    assert load_machine({**GANTRY, "axes": axes}).carried("lift") == pytest.approx({"elbow": 0.1, "wrist": 0.3})


def test_an_axis_without_a_drive_is_named_and_the_others_are_sized() -> None:
    axes = {**GANTRY["axes"], "lift": {**GANTRY["axes"]["lift"]}}
    axes["lift"] = {**axes["lift"], "load": {**axes["lift"]["load"], "mass": "3000 kg"}}
    found = size_machine(load_machine({**GANTRY, "axes": axes}), top=1)
    assert found.status == "fail" and not found.complete and math.isnan(found.total)
    assert found.axis("lift").best is None and found.axis("bridge").best is not None
    assert any(note.startswith("lift: no drive") for note in found.notes)


@pytest.mark.parametrize(
    ("seed", "objective"),
    [(1, "price"), (4, "mass"), *(pytest.param(n, "price", marks=pytest.mark.slow) for n in range(10, 13))],
)
def test_the_arm_is_the_best_of_all_combinations(seed: int, objective: str, tmp_path: Path) -> None:
    machine = arm(Random(seed), tmp_path, objective)
    found = size_machine(machine, top=1)
    assert found.certain and found.total == pytest.approx(least_of_all(machine, objective), rel=1e-9)


# --- joints of a description ------------------------------------------------------------------------------------------


def test_the_elbow_s_drive_is_load_of_the_shoulder_at_its_place(tmp_path: Path) -> None:
    found = size_machine(load_machine(two_joints(tmp_path)), top=1)
    shoulder, elbow = found.axes
    assert (shoulder.name, elbow.name) == ("shoulder", "elbow") and found.complete
    (riding,) = shoulder.carried
    assert (
        riding.of == "elbow"
        and riding.mass > (elbow.best.motor.mass + elbow.best.gearhead.mass) * 0.999
        and not elbow.carried
    )
    level = 9.80665 * (1.0 * 0.4 + riding.mass * 0.4 + 0.5 * 0.7)
    assert float(shoulder.spec.load.cycle.torque[0, 0]) == pytest.approx(-level, rel=1e-6)
    assert float(elbow.spec.load.cycle.torque[0, 0]) == pytest.approx(-9.80665 * 0.5 * 0.3, rel=1e-6)


def test_rotors_beyond_a_joint_are_said_and_drives_too_heavy_for_their_links_count(tmp_path: Path) -> None:
    """By hand: k J_m of the elbow's drive, 2197:27 and 542 g*cm^2, at 20 rad/s^2: 88 mN*m at the shoulder.

    Beside a weight of 1 kg at 0.4 m and 0.5 kg at 0.7 m, 7.35 N*m.
    """
    poses = [{"positions": {"shoulder": "0 deg", "elbow": f"{angle} deg"}, "pause": "1 s"} for angle in (0, -90)]
    limits = {"all": {"acceleration": "20 rad/s^2"}}
    machine = two_joints(tmp_path, masses="with_drives", limits=limits, waypoints=poses)
    machine["select"] = {"motor": {"part": ["578298"]}, "gearhead": {"part": ["223093"]}}
    found = size_machine(load_machine(machine), top=1)
    (said,) = [note for note in found.notes if note.startswith("shoulder: rotors")]
    spun, peak = 2197 / 27 * 542e-7 * 20, float(np.abs(found.axis("shoulder").spec.load.cycle.torque).max())
    assert 7.35 < peak < 2 * 7.35
    assert f"add {show(spun, 'N*m', 'torque', 2)} at most" in said and f"({100 * spun / peak:.2g} %" in said
    (heavy,) = [note for note in found.notes if note.startswith("sized again")]
    own = riding_mass(found.axis("elbow").result.problem, found.axis("elbow").best)
    assert heavy.startswith(f"sized again with the drive of elbow on link upper: {show(own, 'kg', 'mass')}, ")
    level = 9.80665 * (1.0 * 0.4 + 0.5 * 0.7 + (own - 1.0) * 0.4)  # what it has beyond the link, at the elbow
    assert float(found.axis("shoulder").spec.load.cycle.torque[0, 0]) == pytest.approx(-level, rel=1e-9)
    (tmp_path / "written.urdf").write_bytes(rendered(machine_export(found), "urdf"))
    links = read_description(tmp_path / "written.urdf").links
    assert [links[name].mass for name in ("upper", "fore")] == pytest.approx([own, 0.5])


def test_a_drive_on_the_base_is_no_load(tmp_path: Path) -> None:
    machine = load_machine(two_joints(tmp_path, drives={"elbow": {"on": "base"}}))
    shoulder = size_machine(machine, top=1).axis("shoulder")
    assert not shoulder.carried
    assert float(shoulder.spec.load.cycle.torque[0, 0]) == pytest.approx(-9.80665 * 0.75, rel=1e-6)


def test_a_vehicle_carries_an_arm_of_joints(tmp_path: Path) -> None:
    machine = two_joints(tmp_path)
    machine["axes"] = {
        "base": {
            "load": {"kind": "wheeled_vehicle", "mass": "40 kg", "driven_wheels": 2, "wheel_diameter": "150 mm",
                     "rolling_resistance": 0.02, "inertia": "10 kg*cm^2"},
            "motion": {"speed": "1 m/s", "acceleration_time": "1 s", "cruise_time": "3 s"},
            "carries": ["shoulder"],
        },
        "elbow": {"needs": {"hold_unpowered": True}},
    }  # fmt: skip
    found = size_machine(load_machine(machine), top=1)
    base = found.axis("base")
    assert [one.of for one in base.carried] == ["shoulder", "elbow"]
    assert base.spec.load.mass == pytest.approx(40.0 + base.carried_mass, rel=1e-12)
    assert found.axis("elbow").best.brake is not None and found.axis("shoulder").best.brake is None


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"axes": {"elbov": {"needs": {"hold_unpowered": True}}}}, 'axes.elbov: no joint "elbov" moves; the nearest'),
        ({"axes": {"elbow": {"carries": ["shoulder"]}}}, "it is in the description; leave it out"),
        ({"axes": {"elbow": {"load": {"kind": "flywheel", "inertia": "1 kg*m^2"},
                             "motion": {"profile": "hold", "time": "1 s"}}}}, "has a joint of this name"),
        ({"robot": {"description": "none.urdf", "trajectory": "a.csv"}}, "none.urdf"),
    ],
)  # fmt: skip
def test_faults_of_joints_are_one_line(change: dict[str, Any], said: str, tmp_path: Path) -> None:
    assert said in refusal(lambda: size_machine(load_machine({**two_joints(tmp_path), **change})))


def drives_of_two_joints(machine: MachineSpec) -> tuple[dict[tuple[str, str], float], dict[str, tuple[float, float]]]:
    """Price of every pair of drives that hold, and price and mass of the elbow's that carry themselves."""
    torques = joint_torques(machine.robot, "", 9.80665)
    catalog = load_parts(machine.axis("elbow").spec)

    def passing(joint: str, elbow: float) -> dict[str, tuple[float, float]]:
        load = torques.load(joint, {"elbow": elbow})
        of_all = problem(machine.axis(joint).spec.model_copy(update={"load": load}), catalog)
        found = evaluate(of_all, candidates(of_all))
        parts = [drive_parts(found, row) for row in np.flatnonzero(~found.failed).tolist()]
        return {p.label: (p.motor.price + p.gearhead.price, p.motor.mass + p.gearhead.mass) for p in parts}

    light = passing("elbow", 0.0)
    carry_themselves = {label: one for label, one in light.items() if label in passing("elbow", one[1])}
    pairs = {
        (shoulder, elbow): price + own
        for elbow, (own, mass) in carry_themselves.items()
        for shoulder, (price, _) in passing("shoulder", mass).items()
    }
    return pairs, carry_themselves


@pytest.mark.parametrize("at", [0, 300, 800, 1500])
def test_a_drive_on_the_link_that_it_moves_carries_itself(at: int, tmp_path: Path) -> None:
    """Against every pair of drives, each in its own load: a pair of these, and none better where that is said."""
    proved = without = 0
    for seed in range(6):
        (tmp_path / "parts.yaml").write_text(catalogue(Random(seed)), encoding="utf-8")
        place = {"on": "link", "link": "fore", "at": [f"{at} mm", "0 mm", "0 mm"]}
        given = two_joints(tmp_path, drives={"elbow": place})
        given["supply"] = {"nominal": "24 V", "accepts": "all"}
        given["select"] = {"catalogs": [str(tmp_path / "parts.yaml")], "objective": "price", "estimates": "off"}
        found = size_machine(load_machine(given), top=3)
        shoulder, elbow = found.axes
        pairs, carry_themselves = drives_of_two_joints(found.machine)
        assert (elbow.best is None) == (not carry_themselves), seed
        if elbow.best is None:
            assert "elbow moves its own drive, and no drive carries itself" in found.notes
        if not found.complete:
            without += 1
            lightest = any("even with the lightest" in note for note in found.notes)
            assert not (lightest and pairs)  # one lighter and dearer, that its first rounds left out, may do
            continue
        (own,), (on_shoulder,) = elbow.carried, shoulder.carried
        assert found.total == pytest.approx(pairs[shoulder.best.label, elbow.best.label], rel=1e-12)
        assert min(pairs.values()) == pytest.approx(found.total, rel=1e-12) or not found.certain
        mass = elbow.best.motor.mass + elbow.best.gearhead.mass
        assert own.of == on_shoulder.of == "elbow" and own.mass == pytest.approx(mass, rel=1e-12) == on_shoulder.mass
        torque = elbow.spec.load.cycle.torque[0, 0]  # level and at rest: 0.5 kg at 0.3 m, and the drive
        assert abs(torque) == pytest.approx((0.5 * 0.3 + own.mass * at / 1e3) * 9.80665, rel=1e-9)
        assert any("elbow moves its own drive, which is" in note for note in found.notes)
        proved += found.certain
    assert (proved == 6 or at) and (not without or at == 1500)


def test_cases_of_the_file_and_poses_of_the_robot_are_load_cases_and_sampled(tmp_path: Path) -> None:
    pose = {"name": "stretched", "positions": {"shoulder": "0 deg", "elbow": "0 deg"}, "time": "5 s"}
    machine = two_joints(tmp_path, holds=[pose])
    machine["supply"] = {"nominal": "48 V +- 2 V"}
    machine["select"] = {"motor": {"family": ["RE 40", "EC-max 30", "EC-4pole 30"]}}
    machine["cases"] = [{"name": "hot", "environment": {"ambient": "45 degC"}}]
    machine["tolerances"] = {"samples": 64}
    sizing = size_machine(load_machine(machine), top=1)
    shoulder = sizing.axis("shoulder")
    assert sizing.power.reliability.probability == 1.0  # that supply has no limits
    assert [name for name, _ in shoulder.spec.load_cases] == ["as specified", "hot", "stretched"]
    hot, stretched = (case for _, case in shoulder.spec.load_cases[1:])
    assert hot.environment.ambient == pytest.approx(318.15) and not hot.load.case
    assert stretched.load.case == "stretched" and stretched.load.cycle.speed.max() == 0.0
    assert shoulder.best.reliability.probability > 0.5
