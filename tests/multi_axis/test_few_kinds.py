"""Common drives of several axes against all combinations: their number, and what they cost."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest
from small_arms import arm, every_combination

from drivesizer.errors import InputError
from drivesizer.multi_axis import size_machine
from drivesizer.multi_axis.combinations import (
    Choice,
    Combination,
    Kind,
    Permitted,
    best_combination,
    fewer_kinds,
    kind_of,
    within,
)

ORDER = ("hand", "wrist", "elbow", "base")
CARRIED = {axis: ORDER[:n] for n, axis in enumerate(ORDER)}


class Axes:
    """Four axes and one list of drives: cost, mass and strength of each, and what strength an axis needs."""

    def __init__(self, random: Random) -> None:
        self.own = {axis: random.uniform(0.5, 4.0) for axis in ORDER}
        self.lever = random.uniform(0.1, 0.8)
        self.drives: dict[Kind, tuple[float, float, float]] = {}
        for n in range(6):
            strength = random.uniform(2.0, 9.0)
            self.drives[f"m{n}", "g"] = (
                strength * random.uniform(0.8, 1.3),
                strength * random.uniform(0.1, 0.4),
                strength,
            )

    def passing(self, axis: str, masses: tuple[float, ...]) -> dict[Kind, Choice]:
        needed = self.own[axis] + self.lever * sum(masses)
        fit = {kind: one for kind, one in self.drives.items() if one[2] >= needed}
        cheapest = sorted(fit, key=lambda kind: fit[kind][0])
        return {kind: Choice(kind[0], (0, fit[kind][0]), fit[kind][1]) for kind in cheapest}

    def least(self, permitted: Permitted) -> Combination:
        def sized(axis: str, masses: tuple[float, ...]) -> list[Choice]:
            found = self.passing(axis, masses)
            kept = [one for kind, one in found.items() if permitted.get(axis, kind) == kind]
            return [one for one in kept if not any(o.cost < one.cost and o.mass <= one.mass for o in kept)]

        return best_combination(ORDER, CARRIED, sized, most=1000)

    def all(self, chosen: tuple[Kind, ...] = ()) -> Iterator[tuple[float, int]]:
        """Sum and number of kinds of all combinations that hold, one by one."""
        if len(chosen) == len(ORDER):
            yield sum(self.drives[kind][0] for kind in chosen), len(set(chosen))
            return
        axis, masses = ORDER[len(chosen)], (self.drives[kind][1] for kind in chosen)
        needed = self.own[axis] + self.lever * sum(masses)
        for kind, (_, _, strength) in self.drives.items():
            if strength >= needed:
                yield from self.all((*chosen, kind))


@pytest.mark.parametrize("allowance", [0.15, 0.5])
def test_the_number_of_kinds_is_mostly_the_least_within_the_allowance_and_never_beyond_it(allowance: float) -> None:
    right = cases = saved = 0
    for seed in range(20):
        axes = Axes(Random(seed))
        best = axes.least({})
        if best.missing:
            continue
        kinds = {axis: (best.choices[axis].name, "g") for axis in ORDER}
        masses = {axis: tuple(best.choices[other].mass for other in CARRIED[axis]) for axis in ORDER}
        offered = {axis: {k: c.cost for k, c in axes.passing(axis, masses[axis]).items()} for axis in ORDER}
        limit = 0, best.cost[1] * (1.0 + allowance)
        found, common = fewer_kinds(best, kinds, offered, limit, axes.least)
        number = len({one.name for one in found.choices.values()})
        assert within(found.cost, limit) and number <= len(set(kinds.values()))
        assert all(found.choices[axis].name == kind[0] for axis, kind in common.items())
        least = min(many for total, many in axes.all() if total <= limit[1] * (1 + 1e-9))
        assert number >= least
        right, cases, saved = right + (number == least), cases + 1, saved + (number < len(set(kinds.values())))
    assert cases > 10 and saved > cases / 5
    assert right >= 0.9 * cases


@pytest.mark.parametrize("seed", [2, *(pytest.param(n, marks=pytest.mark.slow) for n in range(3, 6))])
def test_common_drives_of_an_arm_are_the_fewest_of_all_combinations(seed: int, tmp_path: Path) -> None:
    machine = arm(Random(seed), tmp_path, "price")
    free = size_machine(machine, top=1)
    every = list(every_combination(machine, "price"))
    found = size_machine(replace(machine, few_kinds=0.5), top=1)
    limit = free.total * 1.5
    kinds = {kind_of(axis.best) for axis in found.axes}
    assert len(kinds) == min(many for total, many in every if total <= limit * (1 + 1e-9))
    assert found.total <= limit * (1 + 1e-9) and found.status == free.status
    assert any(abs(total - found.total) < 1e-6 and many == len(kinds) for total, many in every)
    before = len({kind_of(axis.best) for axis in free.axes})
    assert any(note.startswith(f"{len(kinds)} kind") for note in found.notes) == (before > 1)


def test_an_objective_without_a_sum_has_no_common_drives(tmp_path: Path) -> None:
    machine = replace(arm(Random(1), tmp_path, "margin"), few_kinds=0.1)
    with pytest.raises(InputError, match=r"few_kinds: margin has no sum; expected one objective of all axes"):
        size_machine(machine)
