"""Studies of machines: each variant is that machine as `size` has it, by its totals or by one of its axes."""

from __future__ import annotations

import json
import re
from functools import partial
from pathlib import Path
from random import Random
from typing import Any

import pytest
from refusals import refusal
from small_arms import catalogue
from studies import ROOT

from drivesizer.files.yaml_source import YamlSource
from drivesizer.study.figures import kind_of, path_of
from drivesizer.study.plan import Plan, read_study
from drivesizer.study.rows import columns_of, document_of, rows_of
from drivesizer.study.store import made_of

CELL = """\
name: cell
supply: {nominal: 24 V, current: 20 A, capacitance: 10 mF}
select: {catalogs: [parts.yaml], estimates: "off"}
motion: {speed: 30 deg/s, acceleration_time: 0.3 s, cruise_time: 0.6 s, rest_time: 1 s, there_and_back: true}
axes:
  shoulder:
    load: {kind: arm, mass: 2 kg, length: 0.3 m, inertia: 0.3 kg*m^2}
    carries: {left elbow: {at: 300 mm}}
  left elbow:
    load: {kind: arm, mass: 1 kg, length: 0.2 m}
"""
STUDY = """\
spec: cell.yaml
vary:
  supply.nominal: [24 V, 28 V]
  axes.left elbow.load.mass: {from: 1 kg, to: 30 kg, steps: 2}
"""


@pytest.fixture(scope="module")
def parts() -> str:
    """A catalogue of three motors and two gearheads."""
    return catalogue(Random(4))


@pytest.fixture
def folder(tmp_path: Path, parts: str) -> Path:
    (tmp_path / "parts.yaml").write_text(parts, encoding="utf-8")
    (tmp_path / "cell.yaml").write_text(CELL, encoding="utf-8")
    return tmp_path


def planned(folder: Path, study: str) -> Plan:
    (folder / "study.yaml").write_text(study, encoding="utf-8")
    return read_study(folder / "study.yaml")


def table(plan: Plan) -> list[dict[str, Any]]:
    variants = [plan.variant(n) for n in range(1, plan.total + 1)]
    rows = rows_of(plan.job, variants).rows
    return [dict(zip([column.head for column in columns_of(plan)], row, strict=True)) for row in rows]


close = partial(pytest.approx, rel=1e-9)


def test_each_variant_is_what_size_says_of_the_machine_with_these_figures(folder, run):
    """The file as a person would change it, and the JSON of `drivesizer size`: the machine, and one of its axes."""
    wholes, singles = (table(planned(folder, STUDY + more)) for more in ("", "axis: left elbow\n"))
    assert len(wholes) == len(singles) == 4
    for whole, single in zip(wholes, singles, strict=True):
        text = CELL.replace("24 V", f"{whole['supply.nominal (V)']} V")
        text = text.replace("mass: 1 kg", f"mass: {whole['axes.left elbow.load.mass (kg)']} kg")
        (folder / "by_hand.yaml").write_text(text, encoding="utf-8")
        found = json.loads(run("size", folder / "by_hand.yaml", "--json", "--top", 1)[1])
        axes = {axis["name"]: axis["result"] for axis in found["axes"]}
        assert whole["status"] == found["status"] and single["rank"] == (1 if axes["left elbow"]["sets"] else None)
        if not axes["left elbow"]["sets"]:
            assert (single["status"], whole["machine_mass_kg"], whole["left elbow.set"], whole["peak_W"]) == (
                "fail",
                None,
                "",
                None,
            )
            assert whole["nearest_miss"] == f"left elbow: {single['nearest_miss']}" and single["nearest_miss"]
            continue
        sets = {name: sizing["sets"][0] for name, sizing in axes.items()}
        elbow = sets["left elbow"]
        assert (single["set"], single["status"]) == (whole["left elbow.set"], elbow["status"])
        assert single["motor_part"] == elbow["motor"]["part"] and whole["drives"] == 2
        for row, some in ((whole, [*sets.values()]), (single, [elbow])):
            assert row["machine_mass_kg"] == close(sum(one["mass"] for one in some))
            assert row["machine_price_EUR"] == close(
                sum(one[part]["price"] for one in some for part in ("motor", "gearhead"))
            )
        power = found["power"]
        (cycle,) = (figure for figure in power["figures"] if figure["name"] == "machine_cycle")
        assert whole["objective_si"] == close(found["total"]) and whole["peak_W"] == close(power["peak"])
        assert whole["energy_J"] == close(power["mean"] * cycle["value"])
        margins = {name: tightest(one["checks"]) for name, one in sets.items()} | {"all": tightest(power["checks"])}
        assert (whole["smallest_margin"], whole["smallest_margin_check"]) == min(margins.values())
        assert margins[whole["smallest_margin_axis"]] == min(margins.values())
        assert (single["smallest_margin"], single["smallest_margin_check"]) == margins["left elbow"]
    assert [row["status"] == "fail" for row in wholes] == [False, True, False, True]


def tightest(checks: list[dict[str, Any]]) -> tuple[float, str]:
    chosen = ("common_bus_voltage", "encoder_counts")  # parts are selected by these
    known = [one for one in checks if one["margin"] is not None and not one["advice"] and one["name"] not in chosen]
    return min((float(f"{one['margin']:.12g}"), one["name"]) for one in known)


def test_a_machine_that_is_wrong_is_a_row_and_catalogues_go_to_every_axis(folder):
    study = "spec: cell.yaml\nvary: {axes.shoulder.load.mass: [2 kg, -2 kg]}\ncatalogs: [[parts.yaml], [maxon]]\n"
    (folder / "cell.yaml").write_text(CELL.replace("0.2 m}", "0.2 m}\n    select: {catalogs: [maxon]}"), "utf-8")
    plan = planned(folder, study)
    documents = [document_of(plan.job, plan.variant(n)).data for n in (1, 2)]
    for data, names in zip(documents, plan.job.catalogs, strict=True):
        assert data["select"]["catalogs"] == data["axes"]["left elbow"]["select"]["catalogs"] == list(names)
        assert "select" not in data["axes"]["shoulder"]
    found = rows_of(plan.job, [plan.variant(n) for n in (1, 3)])
    row = dict(zip([column.head for column in columns_of(plan)], found.rows[1], strict=True))
    status, error = row["status"], row["error"]
    assert status == "error" and 'cell.yaml:7: axes.shoulder.load.mass: "-2 kg" must be above 0 kg' in error
    assert set(found.made_of) == {"drivesizer", "catalogue parts"}
    assert {"catalogue maxon", "catalogue parts"} <= set(made_of(plan))


VARY = "spec: cell.yaml\nvary: "


@pytest.mark.parametrize(
    ("study", "said"),
    [
        ("spec: cell.yaml\naxis: sholder\n", 'study.yaml:2: axis: there is no axis "sholder"; the nearest is shoulder'),
        (VARY + "{axes.right elbow.load.mass: [1 kg]}\n", "is no field; expected one of"),
        (VARY + "{axes.sholder.load.mass: [1 kg]}\n", '"sholder" is no axis; the nearest is shoulder'),
        (
            VARY + "{axes.left elbow.load.mas: [1 kg]}\n",
            '"mas" is no field of axes.left elbow.load; the nearest is mass',
        ),
        (
            VARY + "{axes.shoulder.battery.part: [x]}\n",
            '"battery" is no field of axes.shoulder; expected one of carries',
        ),
        (VARY + "{supply.nominl: [24 V]}\n", '"nominl" is no field of supply; the nearest are nominal, min'),
        (VARY + "{cycle_tme: [2 s]}\n", '"cycle_tme" is no field of a machine; the nearest'),
        (VARY + "{axes.shoulder.start: [1 m]}\n", '"1 m": "m" is a unit of length, not of time'),
        (VARY + "{axes.shoulder.select.catalogs: [maxon]}\n", "expected them in the study's own list, catalogs"),
        (VARY + "{supply.nominal: [24 V]}\ntop: 2\n", 'top: "2": a machine has one choice of drives; expected 1, or'),
        ("spec: one.yaml\naxis: x\n", 'axis: "one.yaml" is a spec of one axis; leave axis out'),
        ("specs: [one.yaml, cell.yaml]\n", 'specs[2]: "cell.yaml" is a machine of several axes, and the first is the'),
        ("spec: list.yaml\n", "list.yaml:3: axes: expected axes by name"),
    ],
)
def test_a_wrong_study_of_a_machine_is_one_line(folder, study, said):
    (folder / "one.yaml").write_text("name: one\n", encoding="utf-8")
    (folder / "list.yaml").write_text("name: cell\nsupply: {nominal: 24 V}\naxes: [a, b]\n", encoding="utf-8")
    assert said in refusal(lambda: planned(folder, study)).replace(f"{folder}/", "")


def test_a_machine_of_one_axis_is_that_spec(folder):
    text = CELL[: CELL.index("    carries")].replace("2 kg", "3 kg")
    (folder / "cell.yaml").write_text(text, encoding="utf-8")
    plan = planned(folder, "spec: cell.yaml\nvary: {axes.shoulder.load.mass: [2 kg]}\naxis: shoulder\n")
    (row,) = table(plan)
    assert not plan.job.machine and (row["motor_family"], row["sets_examined"]) == ("M", 6)


def test_fields_of_a_machine_have_their_kinds():
    """A joint turns or slides, and axes without a load at the top may do either: the value says which."""
    source = YamlSource(CELL + "robot: {description: a.urdf, limits: {all: {}}}\n", "cell.yaml")
    for name, value, kind in (
        ("robot.limits.all.acceleration", "4 rad/s^2", "angular_acceleration"),
        ("robot.limits.rail.acceleration", "4 m/s^2", "acceleration"),
        ("robot.held.wrist", "10 deg", "angle"),
        ("robot.payload.mass", "1 kg", "mass"),
        ("motion.speed", "30 deg/s", "rotary_speed"),
        ("motion.speed", "1 m/s", "speed"),
        ("axes.shoulder.motion.speed", "30 deg/s", "rotary_speed"),
        ("axes.shoulder.carries.left elbow.at", "3 mm", "length"),
        ("timing", "independent", ""),
    ):
        path = path_of(name, source.data["axes"])
        assert path is not None and kind_of(source, path, value) == kind, name


def test_the_columns_on_the_page_are_those_of_a_machine(folder):
    page = (ROOT / "docs" / "studies.md").read_text(encoding="utf-8")
    part = page[page.index("## Machines of several axes") :]
    listed = set(re.findall(r"`([\w.]+)`", part[: part.index("\n## ", 5)]))
    heads = {column.head for column in columns_of(planned(folder, "spec: cell.yaml\n"))}
    own = {"drives", "kinds", "energy_J", "mean_W", "peak_W", "smallest_margin_axis", "shoulder.set"}
    assert own <= heads and own - {"shoulder.set"} <= listed
