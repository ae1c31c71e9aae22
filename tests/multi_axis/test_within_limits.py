"""Where the best drives of all axes break a limit of the machine the cheapest are taken that keep it: brute force."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice, product
from math import inf

import numpy as np
import pytest

from drivesizer.machine.common_supply import machine_power
from drivesizer.multi_axis.combinations import Choice, cheapest_first
from drivesizer.multi_axis.sizing import size_machine
from drivesizer.results.machine import MachineSizing
from drivesizer.spec.machine import load_machine

CURRENT = "supply_current"
MACHINE = {
    "name": "two",
    "select": {"motor": {"family": ["DCX 22 L", "DCX 22 S"]}, "gearhead": {"family": ["GPX 22 HP", "GPX 22 UP"]}},
    "motion": {
        "speed": "0.8 m/s", "acceleration_time": "0.2 s", "cruise_time": "0.5 s", "rest_time": "0.6 s",
        "there_and_back": True,
    },
    "axes": {
        name: {"load": {"kind": "belt_axis", "mass": mass, "pulley_diameter": "38 mm", "efficiency": 0.95}}
        for name, mass in (("x", "11 kg"), ("y", "9 kg"))
    },
}  # fmt: skip


def sized(current: float, top: int = 8) -> MachineSizing:
    supply = {"nominal": "48 V", "current": f"{current} A", "accepts": "all"}
    return size_machine(load_machine({**MACHINE, "supply": supply}), top=top)


def test_choices_come_by_their_cost() -> None:
    rng = np.random.default_rng(5)
    costs = {name: sorted(rng.uniform(1, 9, 5).tolist()) for name in "abc"}
    offers = {
        name: [Choice(f"{name}{n}", (int(n > 3), cost), 0.0) for n, cost in enumerate(each)]
        for name, each in costs.items()
    }
    every = [dict(zip(offers, choice, strict=True)) for choice in product(*offers.values())]

    def cost(chosen: dict[str, Choice]) -> tuple[int, float]:
        return sum(one.cost[0] for one in chosen.values()), sum(one.cost[1] for one in chosen.values())

    found = list(cheapest_first(offers, 1000))
    assert len(found) == len(every) - 1 and cost(found[0]) >= cost({name: each[0] for name, each in offers.items()})
    assert [cost(one) for one in found] == pytest.approx(np.array(sorted(map(cost, every))[1:]))
    assert list(islice(cheapest_first(offers, 7), 9)) == found[:7]


@pytest.fixture(scope="module")
def free() -> MachineSizing:
    """The best drives, on a supply that gives what they draw."""
    return sized(20.0)


def by_hand(free: MachineSizing, current: float) -> float:
    """Least mass of two drives with which the sum of both keeps a limit of the supply's current [kg]."""
    least = inf
    for pair in product(*(one.result.sets for one in free.axes)):
        drives = zip(free.axes, pair, strict=True)
        axes = [replace(one, result=replace(one.result, sets=(drive,))) for one, drive in drives]
        power = machine_power(free.machine, axes)
        assert power is not None
        (drawn,) = (check.demand for check in power.checks if check.name == CURRENT)
        if drawn <= current:
            least = min(least, sum(drive.objective for drive in pair))
    return least


def test_the_lightest_drives_that_keep_the_supply_are_found(free: MachineSizing) -> None:
    (check,) = (one for one in free.checks if one.name == CURRENT)
    for share in (1.01, 0.95):
        limit = share * check.demand
        found = sized(limit)
        assert found.status == "pass" and found.total == pytest.approx(by_hand(free, limit), rel=1e-12)
        changed = share < 1.0
        assert (found.total > free.total) == changed == any("break it together" in note for note in found.notes)


def test_a_limit_that_no_choice_keeps_is_said(free: MachineSizing) -> None:
    (check,) = (one for one in free.checks if one.name == CURRENT)
    found = sized(0.6 * check.demand, top=3)
    assert found.status == "fail" and not found.certain
    assert [one.best.label for one in found.axes if one.best] == [one.best.label for one in free.axes if one.best]
    assert any("other choices of drives keeps it" in note for note in found.notes)


def tables(**budget: str) -> MachineSizing:
    turn = {"speed": "71 rpm", "acceleration_time": "0.13 s", "cruise_time": "0.6 s", "rest_time": "0.9 s"}
    axes = {
        name: {"load": {"kind": "rotary_table", "inertia": f"{inertia} kg*m^2", "friction_torque": "0.3 N*m",
                        "motors": motors}, "transmission": [{"kind": "gearhead"}]}
        for name, inertia, motors in (("large", 0.09, 2), ("small", 0.05, 1))
    }  # fmt: skip
    supply = {"nominal": "24 V", "accepts": "all"}
    given = {"name": "tables", "supply": supply, "budget": budget, "motion": turn, "axes": axes}
    return size_machine(
        load_machine({**given, "select": {"motor": {"family": ["DCX 22 L", "DCX 26 L"]}}}), top=1, brief=True
    )


def test_all_axes_together_have_the_machines_mass_and_price() -> None:
    """What the parts of two drives and of one weigh and cost, and 3 kg of structure."""
    found = tables(mass="9 kg", price="9999 EUR", structure="3 kg")
    checks = {check.name: check for check in found.checks}
    assert all(axis.best for axis in found.axes)
    drives = [axis.drives * axis.best.mass for axis in found.axes]
    assert len(set(drives)) == 2 and checks["mass"].demand == pytest.approx(3.0 + sum(drives))
    assert (checks["mass"].limit, checks["mass"].status) == (9.0, "pass")
    assert checks["price"].demand == pytest.approx(sum(axis.drives * axis.best.price for axis in found.axes))
    assert checks["price"].status == "unknown" and "controller" in checks["price"].note
    heavy = tables(mass="3.1 kg", structure="3 kg")
    assert heavy.status == "fail" and [check.name for check in heavy.checks if check.status == "fail"] == ["mass"]
    dear = tables(price="300 EUR")
    assert dear.status == "fail" and [check.name for check in dear.checks if check.status == "fail"] == ["price"]
