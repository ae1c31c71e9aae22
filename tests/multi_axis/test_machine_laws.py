"""Laws of machines: the order of axes in the file, other units, equal axes, the sum, what carried mass does."""

from __future__ import annotations

import json
from random import Random
from typing import Any

import pytest
from bought_parts import together
from small_arms import JOINTS, arm

from drivesizer.multi_axis import size_machine
from drivesizer.multi_axis.several import laden
from drivesizer.results.machine import MachineSizing
from drivesizer.sizing import size
from drivesizer.spec.machine import load_machine


@pytest.fixture(scope="module")
def entered(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """An arm of three joints, whose drives ride on one another, as plain data."""
    machine = arm(Random(7), tmp_path_factory.mktemp("arm"), "mass")
    return json.loads(json.dumps(machine.entered))


@pytest.fixture(scope="module")
def found(entered: dict[str, Any]) -> MachineSizing:
    return size_machine(load_machine(entered), top=1)


def drives(sizing: MachineSizing) -> dict[str, tuple[str, float, float]]:
    return {axis.name: (axis.best.label, axis.best.objective, axis.carried_mass) for axis in sizing.axes}


def test_the_order_of_axes_in_the_file_changes_no_drive(entered: dict[str, Any], found: MachineSizing) -> None:
    turned = {**entered, "axes": dict(reversed(entered["axes"].items()))}
    other = size_machine(load_machine(turned), top=1)
    assert [axis.name for axis in other.axes] == list(reversed(JOINTS)) and drives(other) == drives(found)


def test_the_sum_is_that_of_the_axes_each_as_a_spec_with_the_masses_on_it(found: MachineSizing) -> None:
    alone = {name: size(laden(found.machine, name), top=1).sets[0] for name in ("wrist", "shoulder")}
    for name, one in alone.items():
        best = found.axis(name).best
        assert one.label == best.label and one.status == best.status
        assert [check.demand for check in one.checks] == pytest.approx([c.demand for c in best.checks], nan_ok=True)
    assert found.total == pytest.approx(sum(together(axis.best, estimates=False) for axis in found.axes))


def test_an_axis_carries_all_that_its_carried_axes_carry(found: MachineSizing) -> None:
    carried = {name: set(found.machine.carried(name)) for name in JOINTS}
    for name, on_it in carried.items():
        assert on_it == on_it.union(*(carried[other] for other in on_it)) and name not in on_it
        assert {one.of for one in found.axis(name).carried} == on_it
    masses = {one.of: one.mass for one in found.axis("shoulder").carried}
    assert found.axis("elbow").carried_mass == masses["wrist"]
    assert found.axis("shoulder").spec.load.mass == pytest.approx(
        found.machine.axis("shoulder").spec.load.mass + sum(masses.values()), rel=1e-14
    )


def test_other_units_are_the_same_machine(entered: dict[str, Any], found: MachineSizing) -> None:
    other = json.loads(json.dumps(entered))
    for axis in other["axes"].values():
        axis["load"]["mass"] = f"{float(axis['load']['mass'].split()[0]) * 1000!r} g"
        axis["load"]["length"] = f"{float(axis['load']['length'].split()[0]) * 1000!r} mm"
        for place in axis["carries"].values():
            place["at"] = f"{float(place['at'].split()[0]) * 100!r} cm"
    same = size_machine(load_machine(other), top=1)
    assert {name: label for name, (label, _, _) in drives(same).items()} == {
        name: label for name, (label, _, _) in drives(found).items()
    }
    assert same.total == pytest.approx(found.total, rel=1e-12)


def test_equal_axes_have_equal_drives_and_more_on_them_never_lighter_ones(
    entered: dict[str, Any], found: MachineSizing
) -> None:
    one = {name: value for name, value in entered["axes"]["elbow"].items() if name != "carries"}
    other = json.loads(json.dumps(one))
    for field in ("mass", "inertia"):
        number, unit = one["load"][field].split()
        other["load"][field] = f"{float(number) * 1.5!r} {unit}"
    rows = size_machine(load_machine({**entered, "axes": {"left": one, "right": one, "heavy": other}}), top=1)
    left, right, heavy = rows.axes
    assert left.best.label == right.best.label and left.best.objective == right.best.objective
    assert left.best.objective <= heavy.best.objective
    assert left.best.objective <= found.axis("elbow").best.objective and not left.carried
    assert rows.total == pytest.approx(2 * left.best.objective + heavy.best.objective)
