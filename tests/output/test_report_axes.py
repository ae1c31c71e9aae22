"""The report of a machine of several axes: one parts list, a row and a chapter for each axis."""

from __future__ import annotations

import csv
import io
import re
from dataclasses import replace
from math import isnan

import numpy as np
import openpyxl
import pytest
from forty_motors import catalogue
from printed import blank_figures

from drivesizer.machine.common_supply import machine_power
from drivesizer.multi_axis import size_machine
from drivesizer.output.derivation import margin
from drivesizer.output.document.axes import MachineContent, content_of, document_of
from drivesizer.output.document.paper import paper_data
from drivesizer.output.parts import machine_parts, machine_parts_of_axes, parts_by_axis, totals
from drivesizer.output.report import write
from drivesizer.output.report.csv import files_csv
from drivesizer.output.report.figures.machine import layers
from drivesizer.results.check import tightest
from drivesizer.results.machine import MachineSizing
from drivesizer.spec.machine import load_machine
from drivesizer.units import from_si

LONG = "carriage of the second portal behind the guard door"  # an axis may have 60 letters
_PRICES = "price: 80 EUR, price_5: 70 EUR"


def _axis(mass: str, **more: object) -> dict:
    load = {"kind": "belt_axis", "mass": mass, "pulley_diameter": "40 mm", "friction_coefficient": 0.01}
    motion = {"profile": "trapezoid", "speed": "1 m/s", "acceleration_time": "0.3 s", "cruise_time": "0.5 s",
              "rest_time": "0.5 s"}  # fmt: skip
    return {"load": load | more, "motion": motion}


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> MachineSizing:
    """Two axes of the same drives, one that carries the other, and a third that no motor moves."""
    shelf = tmp_path_factory.mktemp("shelf") / "shelf.yaml"
    text = catalogue(lambda n: 0.6 - 0.01 * n, "0.1 K/W", "mass: 100 g")
    shelf.write_text(text.replace("max_speed:", f"{_PRICES}, max_speed:"), encoding="utf-8")
    axes = {"x": _axis("9 kg", motors=2) | {"carries": [LONG]}, LONG: _axis("6 kg", motors=3), "z": _axis("9000 kg")}
    spec = {"name": "portal", "supply": {"nominal": "24 V", "current": "60 A"}, "axes": axes,
            "select": {"catalogs": [str(shelf)], "estimates": "off"}}  # fmt: skip
    return size_machine(load_machine(spec))


# -- the parts list


def test_equal_parts_of_axes_are_one_line_whose_quantities_add_up(machine):
    lines = machine_parts_of_axes(machine)
    assert [(x.line.role, x.line.part, x.line.quantity, x.axes) for x in lines] == [
        ("motor", "m00", 5, ("x", LONG)), ("encoder", "", 5, ("x", LONG)), ("controller", "only", 5, ("x", LONG)),
    ]  # fmt: skip
    alone = [line for axis in machine.axes[:2] for line in machine_parts(axis.best, axis.result.problem)]
    assert sum(line.quantity for line in alone) == sum(x.line.quantity for x in lines) == 15
    assert not parts_by_axis(machine)["z"]


def test_a_price_is_that_of_all_pieces_of_the_machine(machine):
    """Of two or three pieces it is 80 EUR, of five 70."""
    alone = [machine_parts(axis.best, axis.result.problem)[0].price for axis in machine.axes[:2]]
    together = machine_parts_of_axes(machine)[0].line
    assert alone == [80.0, 80.0] and (together.price, together.pieces) == (70.0, 5)
    mass, price = totals([x.line for x in machine_parts_of_axes(machine)])
    assert (price.value, price.over, price.lacks) == (350.0, ("motor",), ("encoder", "controller"))
    by_axis = [totals(lines) for lines in parts_by_axis(machine).values() if lines]
    assert [found[1].value for found in by_axis] == [140.0, 210.0]
    assert sum(found[0].value for found in by_axis) == pytest.approx(mass.value) == pytest.approx(5 * (0.3 + 0.1))
    assert isnan(together.mass_low)


# -- one document, four kinds of file


@pytest.fixture(scope="module")
def files(machine: MachineSizing, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("report")
    kinds = ["report.pdf", "report.html", "report.xlsx", "report.csv"]
    with blank_figures():
        written = write(machine, {}, [folder / name for name in kinds])
    return {path.name: path.read_bytes() for path in written}


def document(content):
    return paper_data(document_of(content))


@pytest.fixture(scope="module")
def chapters(machine: MachineSizing) -> dict[str, dict]:
    return {section["name"]: section for section in document(MachineContent(machine))["sections"]}


def block(chapter: dict, name: str) -> dict:
    return next(one for one in chapter["blocks"] if one.get("name") == name)


def test_the_first_page_has_a_row_for_each_axis_and_names_the_one_without_a_drive(machine, chapters):
    first = chapters["summary"]
    assert not first["blocks"][0]["has_drive"] and "No drive for z." in str(first["blocks"][0])
    rows = [row["cells"] for row in block(first, "axes")["rows"]]
    assert [row[0] for row in rows] == ["x", LONG, "z"]
    for row, axis in zip(rows, machine.axes[:2], strict=False):
        check = tightest(axis.best.deciding, 1)[0]
        assert f"{axis.drives} × " in str(row[1]) and row[-2] == check.title
        assert row[-3] == margin(check.margin) and row[-1][0]["text"] == axis.best.status
    assert "on it 900 g" in str(rows[0][1])  # three motors of 300 g
    assert rows[2][1][0]["text"] == "none; closest: " and rows[2][-1][0]["text"] == "fail"
    assert machine.status == "fail"


def test_drives_that_ride_on_an_axis_stand_below_it(chapters, machine):
    rows = [row["cells"] for row in block(chapters["carried"], "riding")["rows"]]
    assert [row[0] for row in rows] == ["x", f"└ {LONG}"]  # nothing rides on z, nor z on anything
    assert (rows[0][-1]["text"], rows[1][-2]["text"]) == ("900 g", "900 g")


def test_each_part_of_the_page_that_scrolls_has_a_name_of_its_own(files):
    names = re.findall(r'role="region" aria-label="([^"]+)"', files["report.html"].decode())
    assert len(names) > 20 and sorted(names) == sorted(set(names))
    assert not [name for name in names if name.startswith(",")]


def test_tables_have_the_records_figures_of_every_axis(machine, files):
    rows = [*csv.DictReader(io.StringIO(files["report.csv"].decode()))]
    heads, *cells = openpyxl.load_workbook(io.BytesIO(files["report.xlsx"]))["Checks"].iter_rows(values_only=True)
    sheet = {(row[0], row[heads.index("check")]): row[heads.index("demand")] for row in cells if row[1] == 1}
    for axis in machine.axes[:2]:
        mine = {r["name"]: r for r in rows if (r["axis"], r["section"], r["set_rank"]) == (axis.name, "check", "1")}
        for check in axis.best.checks:
            if check.demand == check.demand:
                shown = from_si(check.demand, check.unit, check.kind)
                assert float(mine[check.name]["si_value"]) == check.demand
                assert sheet[axis.name, check.title] == pytest.approx(shown)
    parts = [*csv.DictReader(io.StringIO(files["report-parts.csv"].decode()))]
    assert (parts[0]["part"], int(parts[0]["quantity"]), parts[0]["axes"]) == ("m00", 5, f"x, {LONG}")
    assert [float(parts[-1][name]) for name in ("masses_kg", "prices")] == [pytest.approx(2.0), 350.0]


def test_a_machine_of_one_axis_gives_the_document_of_a_plain_spec(machine):
    one = replace(machine, machine=replace(machine.machine, axes=machine.machine.axes[:1]), axes=machine.axes[:1])
    alone = document(content_of(one.axes[0].result))
    assert document(MachineContent(one))["sections"] == alone["sections"]


def test_drives_that_fail_together_are_no_answer(whole):
    check = replace(whole.power.checks[0], status="fail")
    first, *_ = document(MachineContent(replace(whole, checks=(check,))))["sections"]
    verdict = first["blocks"][0]
    assert not verdict["has_drive"] and f"Together they fail on: {check.title}." in str(verdict["paragraphs"])
    assert document(MachineContent(whole))["sections"][0]["blocks"][0]["has_drive"]


# -- power of all axes


@pytest.fixture(scope="module")
def whole(machine: MachineSizing) -> MachineSizing:
    """The two axes that have drives, on their supply."""
    spec, axes = replace(machine.machine, axes=machine.machine.axes[:2]), machine.axes[:2]
    power = machine_power(spec, axes)
    return replace(machine, machine=spec, axes=axes, power=power, checks=power.checks, notes=())


def test_power_is_stacked_by_axis_and_written_with_the_records_figures(whole, tmp_path):
    course, content = whole.power.course(), MachineContent(whole)
    found = layers(whole.power, course)
    assert [one.name for one in found] == ["x", LONG]
    assert np.array_equal([one.drawn for one in found], course.drawn)
    sections = {section["name"]: section for section in document(content)["sections"]}
    cells = [row["cells"] for row in block(sections["supply"], "machine_figures")["rows"]]
    figures = {title: value["text"] for title, value, *_ in cells}
    assert figures == {figure.title: figure.text for figure in whole.power.figures}
    assert block(sections["supply"], "power")["kind"] == "picture" and b"<svg" in content.pictures["power"].paper("svg")
    rows = [row["cells"][0][0] for row in block(sections["summary"], "machine_checks")["rows"]]
    assert rows == [check.title for check in whole.power.checks]
    files = files_csv(content, tmp_path / "a.csv")
    table = [*csv.DictReader(io.StringIO(files[tmp_path / "a-power.csv"].decode()))]
    assert max(float(row["out of the source (W)"]) for row in table) == course.total.max()
    assert float(table[-1]["time (s)"]) == course.time[-1]
