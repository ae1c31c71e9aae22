"""Machines of several axes: what rides on what, the same drives as of single specs, all combinations of small arms."""

from __future__ import annotations

import math
from pathlib import Path
from random import Random
from typing import Any

import pytest
from small_arms import arm, least_of_all

from drivesizer.multi_axis.sizing import laden, size_machine
from drivesizer.output.json.documents import as_text
from drivesizer.output.json.documents import sizing as document
from drivesizer.results.machine import MachineSizing
from drivesizer.sizing import size
from drivesizer.spec.machine import load_machine
from drivesizer.spec.robot import load_spec

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
    alone = size(load_spec(heavier), top=1).sets[0]
    assert bridge.best.label == alone.label
    for one, other in zip(bridge.best.checks, alone.checks, strict=True):
        assert one.name == other.name and one.demand == pytest.approx(other.demand, rel=1e-12, nan_ok=True)
    assert laden(gantry.machine, "bridge").load.mass == pytest.approx(12.0 + riding.mass, rel=1e-15)


def test_the_total_is_the_sum_over_the_axes(gantry: MachineSizing) -> None:
    bests = [axis.best for axis in gantry.axes]
    assert gantry.total == pytest.approx(sum(one.motor.mass + one.gearhead.mass for one in bests), rel=1e-12)
    assert gantry.certain and gantry.complete and gantry.searches == 2


def test_a_machine_of_one_axis_is_that_spec() -> None:
    shared = {name: value for name, value in GANTRY.items() if name != "axes"}
    sections = GANTRY["axes"]["lift"]
    machine = load_machine({**shared, "axes": {"lift": sections}})
    one, other = (size(spec, top=1) for spec in (machine.axes[0].spec, load_spec({**shared, **sections})))
    assert as_text(document(one)) == as_text(document(other))


def test_carried_axes_ride_on_all_below_them() -> None:
    axes = {**GANTRY["axes"], "rail": {**GANTRY["axes"]["bridge"], "carries": ["bridge"]}}
    machine = load_machine({**GANTRY, "axes": axes})
    assert machine.order == ("lift", "bridge", "rail")
    assert machine.carried("rail") == {"bridge": None, "lift": None} and machine.carried("lift") == {}


def test_an_axis_without_a_drive_is_named_and_the_others_are_sized() -> None:
    axes = {**GANTRY["axes"], "lift": {**GANTRY["axes"]["lift"]}}
    axes["lift"] = {**axes["lift"], "load": {**axes["lift"]["load"], "mass": "3000 kg"}}
    found = size_machine(load_machine({**GANTRY, "axes": axes}), top=1)
    assert found.status == "fail" and not found.complete and math.isnan(found.total)
    assert found.axis("lift").best is None and found.axis("bridge").best is not None
    assert any(note.startswith("lift: no drive") for note in found.notes)


@pytest.mark.parametrize(
    ("seed", "objective"),
    [(1, "price"), (4, "mass"), *(pytest.param(n, "price", marks=pytest.mark.slow) for n in range(10, 18))],
)
def test_the_arm_is_the_best_of_all_combinations(seed: int, objective: str, tmp_path: Path) -> None:
    machine = arm(Random(seed), tmp_path, objective)
    found = size_machine(machine, top=1)
    assert found.certain and found.total == pytest.approx(least_of_all(machine, objective), rel=1e-9)
