"""Refinement of studies: finer points where the best drive changes, the same whatever happens on the way."""

import csv
from itertools import pairwise, product
from random import Random

import pytest
from refusals import refusal
from studies import CHEAP, laid, results

from drivesizer.study import run
from drivesizer.study.plan import read_study
from drivesizer.study.rows import columns_of
from drivesizer.study.run import carry_out, computed, refined

GRID = """\
spec: robot.yaml
vary:
  load.mass: {{from: 20 kg, to: 90 kg, steps: {}}}
  motion.speed: {{from: 0.5 m/s, to: 2 m/s, steps: {}}}
"""
COARSE, FINE = GRID.format(4, 3) + "refine: 2\n", GRID.format(13, 9)
PLACE = "load.mass (kg)", "motion.speed (m/s)"


def carried(folder, study, maps=None):
    return carry_out(read_study(laid(folder, study)), folder / "study", processes=1, maps=maps)


def by_place(folder):
    with (folder / "study" / "results.csv").open(encoding="utf-8") as file:
        return {tuple(float(row[name]) for name in PLACE): row for row in csv.DictReader(file)}


def kind(row):
    return row["set"], row["status"]


@pytest.fixture(scope="module")
def coarse(tmp_path_factory):
    """The folder of a refined study with its maps."""
    folder = tmp_path_factory.mktemp("coarse")
    carried(folder, COARSE, maps=())
    return folder


def test_a_refined_map_is_that_of_the_fine_grid_where_it_has_points(coarse, tmp_path):
    """Row by row, with 101 variants of 117; and each two neighbours of the coarse grid that differ have all between."""
    carried(tmp_path, FINE)
    found, full = by_place(coarse), by_place(tmp_path)
    assert (len(found), len(full)) == (101, 117)
    assert all(row | {"variant": ""} == full[place] | {"variant": ""} for place, row in found.items())
    assert [int(row["variant"]) for row in found.values()] == list(range(1, len(found) + 1))
    masses, speeds = (sorted({place[n] for place in full}) for n in (0, 1))
    changes = 0
    for x, y in product(range(0, 13, 4), range(0, 9, 4)):
        for dx, dy in ((1, 0), (0, 1)):
            if x + 4 * dx > 12 or y + 4 * dy > 8:
                continue
            line = [(masses[x + n * dx], speeds[y + n * dy]) for n in range(5)]
            if kind(full[line[0]]) == kind(full[line[4]]):
                continue
            changes += 1
            assert any(a in found and b in found and kind(found[a]) != kind(found[b]) for a, b in pairwise(line))
    assert changes > 5
    assert {kind(row) for row in full.values()} == {kind(row) for row in found.values()}


def test_order_and_interruption_change_nothing(coarse, tmp_path, monkeypatch):
    """Tasks in any order, stopped several times within and between halvings."""
    chance = Random(1)

    def stopped(job, tasks, on, compute):
        every = list(tasks)
        for n, part in enumerate(computed(job, chance.sample(every, len(every)), on, compute)):
            if n == 30:
                raise KeyboardInterrupt
            yield part

    monkeypatch.setattr(run, "computed", stopped)
    ends = 0
    while True:
        try:
            carried(tmp_path, COARSE, maps=())
            break
        except KeyboardInterrupt:
            ends += 1
    assert ends >= 2
    assert results(tmp_path / "study") == results(coarse / "study")


def rows_with(plan, numbers, other=0):
    """Rows of variants with the drive A, of one with B."""
    heads = [column.head for column in columns_of(plan)]
    cells = {"rank": 1, "status": "pass"}
    for n in numbers:
        row = dict.fromkeys(heads) | dict(zip(heads, plan.variant(n).head, strict=False)) | cells
        yield [*(row | {"set": "B" if n == other else "A"}).values()]


def test_only_ranges_are_halved_and_every_objective_counts(tmp_path):
    """Between 20 and 40 kg at 2 m/s, where one objective of two has another drive at 40 kg."""
    study = (
        "spec: robot.yaml\nvary:\n  load.mass: {from: 20 kg, to: 40 kg, steps: 2}\n  motion.speed: [1 m/s, 2 m/s]\n"
        "objectives: [mass, price]\nrefine: 2\n"
    )
    plan = read_study(laid(tmp_path, study))
    assert refined(plan, rows_with(plan, range(1, 9))) is None
    once = refined(plan, rows_with(plan, range(1, 9), other=7))
    assert (once.rounds, once.added, once.total) == ((1,), ((2, 1),), 10)
    assert once.variant(10).head == [10, 30.0, 2.0]
    twice = refined(once, rows_with(once, range(1, 11), other=7))
    assert (twice.rounds, twice.added) == ((1, 1), ((2, 1), (3, 1)))  # 35 kg, between A at 30 and B at 40
    assert refined(twice, rows_with(twice, range(1, 13), other=7)) is None
    assert [v.number for n in range(twice.every_point) for v in twice.point(n)] == list(range(1, 13))
    assert [twice.round_of(n) for n in (1, 8, 9, 10, 11, 12)] == [0, 0, 1, 1, 2, 2]


@pytest.mark.parametrize(
    ("study", "said"),
    [
        (COARSE.replace("refine: 2", "refine: 99"), "study.yaml:5: refine: "),
        (COARSE.replace("refine: 2", "refine: -1"), "study.yaml:5: refine: "),
        (COARSE.replace("refine: 2", "refine: twice"), "study.yaml:5: refine: "),
        (GRID.format(1000, 1000) + "refine: 2\n", "expected at most 10000000, by fewer halvings"),
        ("spec: robot.yaml\nvary: {load.mass: [30 kg]}\nrefine: 3\n", "no field under vary is one; expected e.g."),
        ("specs: [robot.yaml]\nrefine: 3\n", "no field under vary is one; expected e.g."),
        ("spec: robot.yaml\nvary: {load.mass: {from: 1 kg, to: 2 kg}}\nsampling: {latin_hypercube: 5}\nrefine: 3\n",
         "a Latin hypercube has no steps to halve"),
    ],
)  # fmt: skip
def test_a_wrong_refinement_is_one_line(tmp_path, study, said):
    assert said in refusal(lambda: read_study(laid(tmp_path, study, CHEAP)))
