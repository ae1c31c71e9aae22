"""Axes that wait at rest until the machine's cycle is over are sized with that rest, as if it stood in their motion."""

from __future__ import annotations

import copy
import math
from pathlib import Path
from typing import Any

import pytest

from drivesizer.errors import InputError
from drivesizer.multi_axis import size_machine
from drivesizer.multi_axis.several import as_chosen, laden
from drivesizer.results.machine import MachineSizing
from drivesizer.sizing import size
from drivesizer.spec.machine import load_machine

TRAPEZOID = {"speed": "0.5 m/s", "acceleration_time": "0.2 s", "cruise_time": "0.3 s"}
LAW = {"profile": "move", "law": "modified_sine", "distance": "150 mm", "time": "0.4 s"}
BELT = {"kind": "belt_axis", "mass": "4 kg", "pulley_diameter": "30 mm", "friction_force": "5 N"}
ROW: dict[str, Any] = {
    "name": "row",
    "supply": {"nominal": "48 V", "current": "30 A", "accepts": "all"},
    "select": {"motor": {"family": "DCX*"}, "gearhead": {"family": "GPX 22*"}},
    "axes": {
        "long": {"load": BELT, "motion": {**TRAPEZOID, "rest_time": "4.3 s"}},  # 5 s
        "ramps": {"load": BELT, "motion": TRAPEZOID, "start": "0.5 s"},  # 0.7 s
        "curve": {
            "load": {"kind": "hoist", "mass": "3 kg", "drum_diameter": "30 mm"},
            "motion": {**LAW, "payload": "1 kg", "payload_back": "0 kg", "there_and_back": True}, "start": "1 s",
        },
    },
}  # fmt: skip


@pytest.fixture(scope="module")
def row() -> MachineSizing:
    return size_machine(load_machine(ROW), top=1)


def changed(**axes: dict[str, Any]) -> dict[str, Any]:
    """The machine with fields of its axes in their places."""
    made = copy.deepcopy(ROW)
    for name, fields in axes.items():
        made["axes"][name] |= fields
    return made


def until(given: dict[str, Any]) -> dict[str, float | None]:
    machine = load_machine(given)
    return {axis.name: laden(machine, axis.name).waits_until for axis in machine.axes}


def test_a_rest_that_is_waited_is_the_same_as_one_that_is_written(row: MachineSizing) -> None:
    written = size_machine(load_machine(changed(ramps={"motion": {**TRAPEZOID, "rest_time": "4.3 s"}, "start": "0 s"})))
    one, other = row.axis("ramps").best, written.axis("ramps").best
    assert one and other and one.label == other.label
    demands = {c.name: c.demand for c in other.checks}
    assert {c.name: c.demand for c in one.checks} == pytest.approx(demands, rel=1e-12, nan_ok=True)


def test_the_motors_current_is_spread_over_the_machines_cycle(row: MachineSizing) -> None:
    """Of a belt axis, which nothing holds at rest: its own RMS over 0.7 s times the root of 0.7 s by 5 s."""
    axis = row.axis("ramps")
    assert axis.best
    alone = size(as_chosen(axis.spec.waiting({}), axis.best), top=1)
    own, spread = (
        next(c.demand for c in one.checks if c.name == "motor_nominal_current")
        for one in ((alone.sets or alone.misses)[0], axis.best)
    )
    assert spread == pytest.approx(own * math.sqrt(0.7 / 5.0), rel=1e-9) and own > 2.0 * spread


def test_a_load_that_is_held_while_its_axis_waits_counts() -> None:
    """An arm that swings from level to level through its lowest point: 200 s of waiting are all weight."""
    arm = {"kind": "arm", "mass": "3 kg", "length": "300 mm"}
    swing = {"profile": "move", "law": "poly5", "distance": "180 deg", "time": "4 s", "there_and_back": True}
    given = {**ROW, "select": {}, "axes": {
        "arm": {"load": arm, "motion": swing},
        "slow": {"load": BELT, "motion": {**TRAPEZOID, "rest_time": "200 s"}},
    }}  # fmt: skip
    best = size_machine(load_machine(given), top=1).axis("arm").best
    assert best
    held = 3.0 * 9.80665 * 0.3 / best.gearhead.ratio / best.motor.torque_constant
    rms = next(c.demand for c in best.checks if c.name == "motor_nominal_current")
    assert held * 0.98 < rms < held * 1.01 and rms <= best.motor.nominal_current


def test_axes_wait_until_the_last_is_done_or_as_long_as_the_cycle_is_given() -> None:
    assert until(ROW) == {"long": None, "ramps": pytest.approx(5.0), "curve": pytest.approx(5.0)}
    assert until(changed(ramps={"start": "4.5 s"})) == pytest.approx({"long": 5.2, "ramps": 5.2, "curve": 5.2})
    assert until({**ROW, "cycle_time": "8 s"}) == pytest.approx({"long": 8.0, "ramps": 8.0, "curve": 8.0})
    assert set(until({**ROW, "timing": "independent"}).values()) == {None}
    own = until(changed(long={"supply": {"nominal": "24 V"}}))
    assert own["long"] is None and own["ramps"] == pytest.approx(1.8) and own["curve"] == pytest.approx(1.8)
    with pytest.raises(InputError, match='axis "long" moves for 5 s; expected no less, not 2 s'):
        laden(load_machine({**ROW, "cycle_time": "2 s"}), "ramps")


def test_a_motion_that_does_not_end_at_rest_cannot_wait(tmp_path: Path) -> None:
    (tmp_path / "on.csv").write_text("time,speed,torque\ns,rpm,N*m\n0,50,0.02\n1,50,0.02\n", encoding="utf-8")
    given = copy.deepcopy(ROW)
    given["axes"]["ramps"] = {"load": {"kind": "recorded", "file": str(tmp_path / "on.csv")}}
    assert until(given)["ramps"] is None
    given["axes"]["ramps"]["repeats"] = False
    with pytest.raises(InputError, match=r"axes.ramps.repeats: its motion is not at rest at both ends; expected true"):
        until(given)
