"""The answer of `drivesizer size`: parts with totals, verdict, tightest checks, alternatives, next commands."""

from dataclasses import replace
from math import nan

import pytest
from starters import STARTERS

from drivesizer.output.document.content import machine_words
from drivesizer.output.document.rows import check_table
from drivesizer.output.parts import machine_parts, totals
from drivesizer.output.terminal.sizing import DETAILS, sizing
from drivesizer.results.check import Band, Check
from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec


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
    assert len(lines) <= 44 and max(map(len, lines)) <= 80
    best = starter.sets[0]
    for part in best.parts.values():  # no part number is broken
        assert any(part.part in line for line in lines)
    for check in sorted((c for c in best.deciding if c.is_comparable), key=lambda c: c.margin)[:3]:
        assert any(line.startswith(check.title) for line in lines)  # nor the name of a check
    assert "paper" not in out and "58,817 drives" in out and "next: drivesizer size --checks" in out
    assert "price each" in out and "120.82 EUR" in out  # of one motor; the widest name wraps in its stead
    others = out.partition("Beside other")[2].partition("next: ")[0].splitlines()
    assert len(others) > 4 and all(line.rstrip().endswith("pass") for line in others[2:] if " EUR " in line)
    order = [out.index(words) for words in ("pass A drive", "total", "smallest margins", "Beside other", "next: ")]
    assert order == sorted(order)


def test_totals_are_sums_of_the_lines_and_say_what_they_lack(starter, capsys, monkeypatch):
    """2 x (120.82 + 143.55) EUR by the shop of 2020; encoder and controller have no price in any catalogue."""
    out = " ".join(told(starter, capsys, monkeypatch).split())
    assert "≥ 528.74 EUR" in out and "no price of encoder, controller" in out
    mass = next(t for t in totals(machine_parts(starter.sets[0], starter.problem)) if t.name == "mass")
    assert mass.value == pytest.approx(2 * (0.066 + 0.073 + 0.020 + 0.045))
    assert mass.estimated == ("encoder", "controller") and mass.low < mass.value < mass.high
    # 0.045 kg times 6.5, the class of controllers, and 0.02 kg times 2.5, that of encoders
    assert mass.high - mass.value == pytest.approx(2 * (0.045 * 6.5 + 0.020 * 1.5))
    assert "≈ 90 g" in out


@pytest.mark.parametrize("detail", sorted(DETAILS))
def test_details_come_on_request_alone(detail, starter, capsys, monkeypatch):
    words = {"checks": "Gearhead temperature range", "derivation": "Largest speed of the load's shaft",
             "paper": "Both methods", "ranking": "Best first", "rejected": "Rejected candidates"}  # fmt: skip
    out = told(starter, capsys, monkeypatch, details=frozenset({detail}))
    assert {name for name, said in words.items() if said in out} == {detail}


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


def test_the_unfavourable_end_shows_figures_only_where_they_give_its_margin():
    """A winding of estimated limit: 161 degC against the nominal 103 degC would contradict a margin of 5 %."""
    check = Check(name="a", title="A", method="physics", demand=1.0, limit=2.0, kind="current", unit="A", margin=1.0,
                  status="pass", band=Band(0.9, 1.9, 2.0 / 1.9 - 1.0))  # fmt: skip
    both = (replace(check, band=Band(0.9, 2.5, 0.05)), check)
    rows = [row.cells for row in check_table("", both).rows]
    shown = [[getattr(row[key], "text", "") for row in rows] for key in ("value", "limit")]
    assert shown == [["1 A", "", "1 A", "1.9 A"], ["2 A", "", "2 A", "2 A"]]


CART = """\
name: cart
load: {kind: wheeled_vehicle, mass: 80 kg, driven_wheels: 4, wheel_diameter: 200 mm, rolling_resistance: 0.015,
  inertia: 40 kg*cm^2}
motion: {profile: trapezoid, speed: 1.2 m/s, acceleration_time: 1 s, cruise_time: 5 s}
supply: {nominal: 24 V, min: 20 V, max: 29 V}
battery: {nominal_voltage: 12 V, capacity: 20 Ah, series: 2, autonomy: 4 h%s}
"""


@pytest.mark.parametrize("more", ["", ", chemistry: Li-ion, resistance: 10 mohm"])
def test_a_battery_with_few_figures_has_one_line_that_names_the_fields(more, tmp_path, capsys, monkeypatch):
    path = tmp_path / "robot.yaml"
    path.write_text(CART % more, encoding="utf-8")
    printed = told(size(load_spec(path)), capsys, monkeypatch, 240)
    line = next(line for line in printed.splitlines() if " of the battery" in line)
    assert "checks of the battery; the spec's battery gives no " in line
    assert all(name in line for name in ("continuous_current", "peak_current", "max_charge_current"))
    assert ("chemistry or discharge" in line) == (not more)
    assert ("resistance" in line) == (not more)
    assert printed.count("Unknown of each: ") == 1


HELD = {
    "name": "held",
    "load": {"kind": "hoist", "mass": "40 kg", "drum_diameter": "80 mm"},
    "motion": {"speed": "0.25 m/s", "acceleration_time": "0.4 s", "cruise_time": "4 s", "rest_time": "6 s",
               "there_and_back": True},
    "supply": {"nominal": "48 V", "accepts": "all"},
    "needs": {"hold_unpowered": True},
}  # fmt: skip


def test_a_brake_that_is_needed_and_not_listed_is_a_line_to_buy(capsys, monkeypatch):
    """15.69 N·m at the drum, through the gearhead with its efficiency, twice."""
    result = size(load_spec({**HELD, "select": {"motor": {"family": "EC 60 flat"}}}), top=1)
    best = result.sets[0]
    assert best.brake is None and best.status == "unknown"
    out = " ".join(told(result, capsys, monkeypatch).split())
    torque = 2 * 40 * 9.80665 * 0.04 * best.gearhead.efficiency / best.gearhead.ratio
    assert f"to hold {1000 * torque:.4g} mN·m" in out.replace("unknown unknown ", "")
    assert "no price of brake, encoder, controller" in out
    lines = machine_parts(best, result.problem)
    assert [x.role for x in lines] == ["motor", "gearhead", "brake", "encoder", "controller"]
    assert "brake" in next(t for t in totals(lines) if t.name == "mass").lacks


def none_of(starter, **counts):
    """A sizing in which nothing passes, whose closest rejected fails on one check and lacks a figure for another."""
    best = starter.sets[0]
    bad = [replace(check, status="fail", margin=-0.5) for check in best.checks if check.name == "motor_nominal_current"]
    rest = [replace(check, status="unknown", margin=nan) for check in best.checks[:3]]
    miss = replace(best, status="fail", checks=(*bad, *rest))
    return replace(
        starter, sets=(), alternatives=(), misses=(miss,), counts=replace(starter.counts, feasible=0, **counts)
    )


def test_where_the_machine_rejects_what_passes_alone_its_budget_is_named(starter, capsys, monkeypatch):
    none = none_of(starter, judged=3, failed_by_budget={"battery_autonomy": 3})
    out = " ".join(told(replace(none, tried=("load.mass", "battery.capacity")), capsys, monkeypatch).split())
    assert "3 drives meet their own limits; in the machine they fail on battery autonomy." in out
    assert "None of these figures is enough, changed alone by up to a factor of 20: load.mass, battery.capacity." in out
    assert "Most frequent failure" not in out
    one = none_of(starter, judged=1, failed_by_budget={"battery_autonomy": 1})
    out = " ".join(told(one, capsys, monkeypatch).split())
    assert "1 drive meets its own limits; in the machine it fails on battery autonomy." in out


def test_the_head_of_a_report_has_the_payload(catalog):
    spec = load_spec({**HELD, "motion": HELD["motion"] | {"payload": "5 kg", "payload_back": "7 kg"}})
    assert machine_words(spec) == "Hoist, 40 kg and a payload of up to 7 kg, 1 drive"
    assert machine_words(load_spec(HELD)) == "Hoist, 40 kg, 1 drive"
