"""The answer of `drivesizer size`: parts with totals, verdict, tightest checks, alternatives, next commands."""

from dataclasses import replace
from math import nan
from pathlib import Path

import pytest

import drivesizer
from drivesizer.output.parts import machine_parts, totals
from drivesizer.output.terminal.sizing import DETAILS, sizing
from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec

STARTERS = Path(drivesizer.__file__).parent / "spec" / "starters"


@pytest.fixture(scope="module")
def starter():
    return size(load_spec(STARTERS / "wheeled_vehicle.yaml"))


def told(result, capsys, monkeypatch, columns=80, **options):
    monkeypatch.setenv("COLUMNS", str(columns))
    sizing(result, **options)
    return capsys.readouterr().out


def test_the_first_screen_has_the_whole_answer_in_forty_lines(starter, capsys, monkeypatch):
    out = told(starter, capsys, monkeypatch)
    lines = [line.rstrip() for line in out.splitlines()]
    assert len(lines) <= 40 and max(map(len, lines)) <= 80
    best = starter.sets[0]
    for part in best.parts.values():  # no part number is broken
        assert any(part.part in line for line in lines)
    for check in sorted((c for c in best.deciding if c.is_comparable), key=lambda c: c.margin)[:3]:
        assert any(line.startswith(check.title) for line in lines)  # nor the name of a check
    assert "paper" not in out and "considered" in out and "next: drivesizer size --checks" in out
    order = [out.index(words) for words in ("price", "total: ", "pass: the tightest", "Beside other", "next: ")]
    assert order == sorted(order)


def test_totals_are_sums_of_the_lines_and_say_what_they_lack(starter, capsys, monkeypatch):
    """2 x (127.00 + 143.55) EUR by the shop of 2020; encoder and controller have no price in any catalogue."""
    out = " ".join(told(starter, capsys, monkeypatch).split())
    assert "at least 541.10 EUR; without the price of encoder, controller" in out
    mass = next(t for t in totals(machine_parts(starter.sets[0], starter.problem)) if t.name == "mass")
    assert mass.value == pytest.approx(2 * (0.066 + 0.073 + 0.035 + 0.045))
    assert mass.estimated == ("controller",) and mass.low < mass.value < mass.high
    assert mass.high - mass.value == pytest.approx(2 * 0.045 * 5.5)  # 0.045 kg times 6.5, the class of controllers
    assert "≈ 90 g" in out


def test_an_unknown_price_is_unknown_and_not_nothing(starter, capsys, monkeypatch):
    best = starter.sets[0]
    bare = replace(best, motor=replace(best.motor, price=nan), gearhead=replace(best.gearhead, price=nan))
    out = told(replace(starter, sets=(bare,), alternatives=()), capsys, monkeypatch)
    assert " 0 EUR" not in out and " 0.00" not in out


@pytest.mark.parametrize("detail", sorted(DETAILS))
def test_details_come_on_request_alone(detail, starter, capsys, monkeypatch):
    words = {"checks": "Gearhead temperature range", "derivation": "Largest speed of the load's shaft",
             "paper": "Both methods", "ranking": "Best first"}  # fmt: skip
    out = told(starter, capsys, monkeypatch, details=frozenset({detail}))
    assert {name for name, said in words.items() if said in out} == {detail}


def test_wide_terminals_have_a_line_for_each_part(starter, capsys, monkeypatch):
    narrow, wide = (told(starter, capsys, monkeypatch, columns=width).splitlines() for width in (80, 140))
    assert len(wide) < len(narrow)
    assert any("GPX 22 HP 44:1" in line and "GPX22HPKLSL44D0CPLW" in line and "143.55 EUR" in line for line in wide)


FAMILIES = {"motor": {"family": ["DCX 22", "DCX 22 L", "DC-max 22 S"]}}


def test_alternatives_are_the_best_of_other_families(starter):
    """Against all drives that pass, in order: the first of each family other than the best one's."""
    spec = starter.spec
    few = spec.model_copy(update={"select": type(spec.select)(**FAMILIES, gearhead={"family": ["GPX 22 HP"]})})
    every = size(few, top=120)
    assert every.counts.feasible <= 120
    first = {}
    for one in every.sets:
        first.setdefault(one.motor.family, one.label)
    first.pop(every.sets[0].motor.family)
    assert first and [one.label for one in every.alternatives] == list(first.values())[:3]
    assert [one.rank for one in every.alternatives] == [2, 3, 4][: len(first)]


def test_alternatives_by_the_papers_rule_and_where_there_is_one_family(spec):
    assert size(spec, top=1).alternatives == ()
