"""A check, an objective, a load and a section of a report are declared once: outputs of a copy with each have them."""

from __future__ import annotations

import csv
import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path
from shutil import copytree

import numpy as np
import openpyxl
import pytest
from lxml import html
from pdf_text import texts_of

import drivesizer
from drivesizer.loads import AXES
from drivesizer.results.check_columns import at_least, at_most, fits
from drivesizer.results.check_kinds import CHECKS
from drivesizer.units import KINDS, from_si, scale

PACKAGE = Path(drivesizer.__file__).parent
HELPERS = Path(__file__).resolve().parent.parent / "helpers"

ADDED = {  # file: a line before which another goes, or several such
    "results/checks.txt": (
        "motor_nominal_current | Motor nominal current (RMS) | current A | CURRENT",
        "below_no_load | Speed below no load | rotary_speed rpm | RATIO motor.no_load_speed\n",
    ),
    "search/columns/limits.py": (
        "        nominal_current_limit(demand.rms_current, motor, ambient, torque),\n",
        '        at_most("below_no_load", demand.peak_speed, motor["no_load_speed"]),\n',
    ),
    "loads/__init__.py": ('"hoist", ', '"wire_winder", '),
    "output/document/sections.txt": (
        "pieces | at_work.pieces",
        "speeds | speeds.speeds | Speeds of the motor | level=2 of_drive\n",
    ),
    "spec/drive.py": (
        '    "energy": ObjectiveKind(',
        '    "idle": ObjectiveKind("idle current", "current", "mA", "no_load_current", ("motor",)),\n',
    ),
}
WINDER = """
from typing import ClassVar, Literal

from drivesizer.files.fields import Axis, Force, Length
from drivesizer.loads.course import Course
from drivesizer.loads.model import SharedLoad
from drivesizer.physics.load_cycle import LoadCycle


class WireWinder(SharedLoad):
    axis: ClassVar[Axis] = "linear"
    kind: Literal["wire_winder"]
    tension: Force
    reel_diameter: Length


def wire_winder(load: WireWinder, gravity: float, course: Course) -> LoadCycle:
    radius = load.reel_diameter / 2
    torque = load.tension * radius * course.direction + 0.0 * course.speed
    return course.cycle(torque / load.motors, radius, inertia=0.0)
"""
REEL = """
name: reel
load: {kind: wire_winder, tension: 23 N, reel_diameter: 70 mm}
motion: {profile: trapezoid, speed: 0.4 m/s, acceleration_time: 0.5 s, cruise_time: 6 s, rest_time: 2 s}
supply: {nominal: 24 V}
select: {catalogs: [maxon]}
"""
SECTION = """
from drivesizer.output.document.records import Column, Quantity, Row, Table, Words


def speeds(of, drive):
    yield Words("Speeds of the bare motor.")
    speed = Quantity(drive.motor.no_load_speed, "rpm", "rotary_speed")
    columns = Column("title", "figure"), Column("value", "value", "number")
    yield Table("Speeds without a load", columns, [Row({"title": "no-load speed", "value": speed}, name="no_load")])
"""
RUN = """
from pathlib import Path
from drivesizer import load_spec, size
from drivesizer.output.report import write
from drivesizer.output.terminal.sizing import DETAILS, sizing
from printed import blank_figures
result = size(load_spec(Path("robot.yaml")), objective="idle", top=5)
sizing(result, details=DETAILS)
reel = size(load_spec(Path("reel.yaml")), top=1)
with blank_figures():
    write(result, None, [Path("report.json"), Path("report.html")])
    write(reel, None, [Path(f"reel.{kind}") for kind in ("json", "pdf", "html", "xlsx", "csv")])
"""


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """The folder where a copy with more declarations was run, and what it printed."""
    folder = tmp_path_factory.mktemp("declared")
    copytree(PACKAGE, folder / "drivesizer")  # with its byte code, which is made anew only of what is changed below
    copytree(PACKAGE.parent / "catalogs", folder / "catalogs")
    for file, lines in ADDED.items():
        path = folder / "drivesizer" / file
        text = path.read_text(encoding="utf-8")
        for before, line in zip(lines[::2], lines[1::2], strict=True):
            assert text.count(before) == 1, file
            text = text.replace(before, line + before)
        path.write_text(text, encoding="utf-8")
    (folder / "drivesizer" / "output" / "document" / "speeds.py").write_text(SECTION, encoding="utf-8")
    (folder / "drivesizer" / "loads" / "wire_winder.py").write_text(WINDER, encoding="utf-8")
    (folder / "reel.yaml").write_text(REEL, encoding="utf-8")
    text = (PACKAGE / "spec" / "starters" / "hoist.yaml").read_text(encoding="utf-8")
    (folder / "robot.yaml").write_text(text, encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(folder), str(HELPERS))), "COLUMNS": "160"}
    done = subprocess.run(
        [sys.executable, "-c", RUN], cwd=folder, env=environment, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    return folder, done.stdout


@pytest.fixture
def told(copy):
    """Terminal, JSON and page of the copy."""
    folder, printed = copy
    document, page = ((folder / f"report.{kind}").read_text(encoding="utf-8") for kind in ("json", "html"))
    return printed, json.loads(document)["axes"][0]["result"], page


def test_one_declaration_makes_a_check(told, catalog):
    """In rpm, by the catalogue's own figure, at its place."""
    terminal, document, page = told
    best = document["sets"][0]
    names = [check["name"] for check in best["checks"]]
    assert names.index("below_no_load") == names.index("motor_speed") + 1
    check, speed = best["checks"][names.index("below_no_load")], best["checks"][names.index("motor_speed")]
    motor = catalog.motors.record(catalog.motors.rows[best["motor"]["part"]])
    assert (check["unit"], check["status"]) == ("rad/s", "pass")
    assert check["limit"] == pytest.approx(motor.no_load_speed)
    assert check["demand"] == speed["demand"]
    assert "Speed below no load" in terminal and "Speed below no load" in page


def test_the_check_is_in_every_medium(copy):
    """The same demand in PDF, page, workbook and CSV, without a line in any renderer."""
    folder, _ = copy
    reel = json.loads((folder / "reel.json").read_text(encoding="utf-8"))["axes"][0]["result"]["sets"][0]
    speed = next(check["demand"] for check in reel["checks"] if check["name"] == "below_no_load")
    demand = float(from_si(speed, "rpm", "rotary_speed"))
    assert "Speed below no load" in "".join(texts_of((folder / "reel.pdf").read_bytes()))
    page = html.fromstring((folder / "reel.html").read_text(encoding="utf-8"))
    assert page.xpath("//tr[@data-check='below_no_load']//data/@value")[0] == str(demand)
    heads, *rows = openpyxl.load_workbook(folder / "reel.xlsx")["Checks"].iter_rows(values_only=True)
    (row,) = [dict(zip(heads, row, strict=True)) for row in rows if row[0] == 1 and "Speed below no load" in row]
    with (folder / "reel.csv").open(encoding="utf-8") as file:
        (line,) = [one for one in csv.DictReader(file) if (one["name"], one["set_rank"]) == ("below_no_load", "1")]
    assert (
        row["demand"] == pytest.approx(demand)
        and float(line["value"]) == demand
        and row["status"] == line["status"] == "pass"
    )


def test_one_declaration_makes_an_objective(told, catalog):
    """The sets are in the order of the currents that the catalogue prints."""
    terminal, document, page = told
    motors = [catalog.motors.record(catalog.motors.rows[one["motor"]["part"]]) for one in document["sets"]]
    currents = [motor.no_load_current for motor in motors]
    assert document["objective"] == "idle" and len(set(currents)) > 1
    assert [one["objective"] for one in document["sets"]] == pytest.approx(currents)
    assert currents == sorted(currents)
    assert f"{1000.0 * currents[0]:g} mA" in terminal and "idle" in page


def test_one_file_and_one_line_make_a_kind_of_load(copy):
    """Its fields are read, its torque is sized for, and its reports name it."""
    folder, _ = copy
    document = json.loads((folder / "reel.json").read_text(encoding="utf-8"))["axes"][0]["result"]
    required = {one["name"]: one["value"] for one in document["requirements"]}
    assert required["maximum_torque_per_motor"] == pytest.approx(23.0 * 0.035)
    assert required["nominal_speed"] == pytest.approx(0.4 / 0.035)
    assert document["spec"]["load"]["kind"] == "wire_winder" and document["sets"][0]["status"] == "pass"
    text = "".join(texts_of((folder / "reel.pdf").read_bytes()))
    assert "wire_winder" in text and "23 N" in text


def test_one_record_makes_a_section_in_every_medium(copy):
    """At the terminal, on paper, on the page, in a sheet of its own and in the table: the same figure."""
    folder, printed = copy
    assert re.search(r"Speeds without a load\n.*\nno-load speed +\d+ rpm", printed)
    document = json.loads((folder / "reel.json").read_text(encoding="utf-8"))["axes"][0]["result"]
    speed = document["sets"][0]["motor"]["no_load_speed"]
    text = "".join(texts_of((folder / "reel.pdf").read_bytes()))
    page = html.fromstring((folder / "reel.html").read_text(encoding="utf-8"))
    assert "Speeds of the motor" in text and "no-load speed" in text and text.count("Speeds of the bare motor.") == 1
    order = [head.text_content() for head in page.xpath("//h3")]
    assert order.index("Energy") + 1 == order.index("Speeds of the motor")
    (cell,) = page.xpath("//table[caption='Speeds without a load']//data/@value")
    heads, row, *_ = openpyxl.load_workbook(folder / "reel.xlsx")["Speeds of the motor"].iter_rows(values_only=True)
    assert dict(zip(heads, row, strict=True)) == {
        "drive": 1,
        "figure": "no-load speed",
        "value (rpm)": pytest.approx(float(cell)),
    }
    with (folder / "reel.csv").open(encoding="utf-8") as file:
        (line,) = [one for one in csv.DictReader(file) if (one["section"], one["set_rank"]) == ("speeds", "1")]
    assert (line["title"], line["unit"], line["si_unit"]) == ("no-load speed", "rpm", "rad/s")
    assert float(line["value"]) == float(cell) == pytest.approx(speed * 30.0 / math.pi)
    assert float(line["si_value"]) == speed


@pytest.mark.parametrize("make", [at_most, at_least, fits])
def test_a_check_that_nobody_declared_is_refused(make):
    with pytest.raises(LookupError, match=r"'motor_sped' is not declared in results/checks\.txt"):
        make("motor_sped", 1.0, 2.0)
    with pytest.raises(KeyError, match="battery_power"):  # declared, of another method
        make("battery_power", 1.0, 2.0).at((), "physics")


@pytest.mark.parametrize("method", CHECKS)
def test_every_declaration_has_a_unit_of_its_kind(method):
    for name, declared in CHECKS[method].items():
        kinds = (declared.kind, declared.unit), declared.rotary
        assert all(kind in KINDS and scale(unit, kind) for kind, unit in kinds), name
    titles = [declared.title for declared in CHECKS[method].values()]
    assert len(set(titles)) == len(titles)


def test_every_kind_of_load_has_a_starter():
    """What ``drivesizer init`` lists is these, and platforms beside them."""
    starters = {path.stem for path in (PACKAGE / "spec" / "starters").glob("*.yaml")}
    assert starters >= set(AXES)


def test_a_demand_that_is_unknown_passes_where_there_is_no_limit():
    found = at_most("controller_speed", np.array([np.nan, np.inf, 5.0]), np.inf)
    assert found.passed.tolist() == [True, False, True] and found.failed.tolist() == [False, True, False]
