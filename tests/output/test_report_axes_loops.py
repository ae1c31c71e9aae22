"""Closed loops in the report of a machine: those of `validate`, in each kind of file, a stepper behind its pulses."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import jsonschema
import numpy as np
import openpyxl
import pytest
from docs_pages import held_against_the_page
from printed import blank_figures, text_of
from two_axes import STEPPER, two_axes
from typer.testing import CliRunner

import drivesizer.simulate
from drivesizer.cli import app
from drivesizer.commands.common import proven
from drivesizer.errors import InputError, NoLoopError
from drivesizer.output.document.axes import MachineContent, document_of
from drivesizer.output.document.paper import paper_data
from drivesizer.output.json.documents import as_text, machine_document
from drivesizer.output.json.schema import machine_report_schema
from drivesizer.output.report.html.plots import power_plot

pytestmark = pytest.mark.usefixtures("no_further_searches")


def called(*words: Any) -> str:
    found = CliRunner().invoke(app, [str(word) for word in words], catch_exceptions=False)
    assert found.exit_code == 0
    return found.stdout


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> Any:
    return two_axes(tmp_path_factory.mktemp("shelf"))


@pytest.fixture(scope="module")
def validated(machine: Any) -> dict[str, dict[str, Any]]:
    """What `drivesizer validate --json` prints of each axis."""
    return json.loads(called("validate", machine.file, "--json"))["axes"]


@pytest.fixture(scope="module")
def files(machine: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, bytes]]:
    """What `drivesizer report` writes."""
    folder = tmp_path_factory.mktemp("report")
    paths = [folder / f"a.{kind}" for kind in ("json", "csv", "xlsx", "html", "pdf")]
    with blank_figures():
        called("report", machine.file, "--top", 1, *(word for path in paths for word in ("-o", path)))
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture(scope="module")
def content(machine: Any) -> MachineContent:
    from drivesizer.multi_axis.sizing import size_machine

    return MachineContent(*proven(size_machine(machine, top=1)))


# -- the same numbers as those of validate


def test_the_report_has_what_validate_prints(files, validated):
    axes = json.loads(files["a.json"])["axes"]
    assert [*axes] == [*validated] == ["x", "table"]
    for name, one in axes.items():
        series = one["validation"].pop("series")
        assert one["validation"] == validated[name] and len(series["columns"]["time"]) > 100


def test_the_rms_current_of_the_series_is_that_of_the_check_weighed_by_time(files, validated):
    series = json.loads(files["a.json"])["axes"]["x"]["validation"]["series"]["columns"]
    time, current = (np.array(series[name]) for name in ("time", "current"))
    squares = (current[1:] ** 2 + current[:-1] ** 2 + current[1:] * current[:-1]) / 3
    rms = np.sqrt((squares * np.diff(time)).sum() / (time[-1] - time[0]))
    (check,) = (one for one in validated["x"]["checks"] if one["name"] == "motor_nominal_current")
    assert rms == pytest.approx(check["demand"], rel=0.02)  # between its rows the current moves as well


@pytest.fixture(scope="module")
def book(files: dict[str, bytes]) -> Any:
    return openpyxl.load_workbook(io.BytesIO(files["a.xlsx"]), read_only=True)


def digits(number: Any) -> str:
    """A number as far as a workbook has it, which are 16 digits: far from where these round the other way."""
    return f"{number:.10g}" if isinstance(number, float | int) else ""


def test_every_table_has_the_figures_of_validate(files, book, validated):
    table = [*csv.DictReader(io.StringIO(files["a.csv"].decode()))]
    rows = {(row["axis"], row["name"], row["value"], row["limit"]) for row in table if row["section"] == "validation"}
    sheets = [row for name in ("Closed loop", "Open loop") for row in book[name].iter_rows(values_only=True)]
    cells = {(row[0], digits(cell)) for row in sheets for cell in row}
    for name, proof in validated.items():
        written = [(key, one["value"], None) for key, one in proof["figures"].items()]
        written += [(one["name"], one["demand"], one["limit"]) for one in proof["checks"]]
        assert len(written) > 10
        for key, *numbers in written:
            assert (name, key, *("" if number is None else str(number) for number in numbers)) in rows
            assert all((name, digits(number)) in cells for number in numbers)


def test_series_over_time_are_whole_in_a_file_of_each_axis(files, book, content):
    for number, (_, proof) in enumerate(content.proofs.items(), 1):
        rows = [*csv.DictReader(io.StringIO(files[f"a-axis{number}-timeseries.csv"].decode()))]
        assert [float(row["time (s)"]) for row in rows] == proof.series["time"].tolist()
    assert {"x over time", "table over time"} < {*book.sheetnames}


# -- chapters


def document(content):
    return paper_data(document_of(content))


def test_each_chapter_prints_the_sections_of_a_report_of_one_axis(content, validated):
    sections = {one["name"]: one for one in document(content)["sections"]}
    titles = {number: [one["title"] for name, one in sections.items() if name.startswith(f"axis{number}-")]
              for number in (1, 2)}  # fmt: skip
    assert {"Closed loop", "The loops by linear theory"} < {*titles[1]} and "Open loop" in titles[2]
    assert not {"Closed loop", "The loops by linear theory"} & {*titles[2]}
    for number, (name, proof) in enumerate(content.proofs.items(), 1):
        loop = sections[f"axis{number}-loop"]["blocks"]
        checks = next(block for block in loop if block.get("name") == f"axis{number}-loop-checks")
        assert {row["data"]["check"] for row in checks["rows"]} == {one["name"] for one in validated[name]["checks"]}
        figures = next(block for block in loop if block["kind"] == "pair")["left"][0]["rows"]
        assert [row["cells"][1]["text"] for row in figures] == [figure.text for figure in proof.figures]
        assert any(block["kind"] == "picture" and block["name"] == f"axis{number}-loop" for block in loop)
        assert f"axis{number}-loop" in content.drawings
    rows = {row["cells"][0]: row["cells"][1:] for row in sections["loops"]["blocks"][0]["rows"]}
    assert rows["x"][0].startswith("closed loop, ") and rows["table"][0].startswith("open loop, ")
    assert "every axis passes" in str(sections["summary"]["blocks"][0])


def test_the_loop_carries_what_rides_on_the_axis(content):
    """Twice m v^2 / 2 of 2 kg and the stepper is what its drive gives and takes while the speed is reached."""
    proof = content.proofs["x"]
    assert proof.spec.load.mass == pytest.approx(2.0 + STEPPER)
    torque = proof.drive_set.motor.torque_constant * proof.series["current"]
    rising = (proof.series["time"] > 0.05) & (proof.series["time"] < 0.14)
    inertia = proof.drive_set.motor.rotor_inertia + (2.0 + STEPPER) * 0.02**2
    needed = inertia * (1.0 / 0.02) / 0.15
    dry = proof.drive_set.motor.torque_constant * proof.drive_set.motor.no_load_current
    assert np.mean(torque[rising]) == pytest.approx(needed + dry, rel=0.03)


def test_pdf_and_page_show_the_loops(files):
    page, pdf = files["a.html"].decode(), text_of(files["a.pdf"])
    for name in ("axis1-loop", "axis1-bode", "axis1-step-1", "axis2-loop", "power"):
        assert f'id="figure-{name}"' in page and f'data-plot="{name}"' in page
    assert 'id="figure-axis2-bode"' not in page
    assert all(words in pdf for words in ("Checks of the closed loop", "Checks of the open loop", "open loop, "))


# -- failing, missing, older


def test_an_axis_that_fails_or_is_not_simulated_is_named(content, monkeypatch):
    failing = {name: replace(proof, status="fail") for name, proof in content.proofs.items() if name == "x"}
    first, *others = document(MachineContent(content.sizing, failing))["sections"]
    assert "Simulated in its hardest load case, x fails." in str(first["blocks"][0])
    rows = next(one for one in others if one["name"] == "loops")["blocks"][0]["rows"]
    assert rows[1]["cells"][1].startswith("not simulated") and rows[1]["cells"][-1][0]["text"] == "unknown"

    def refuse(spec: Any, drive: Any, **_: Any) -> Any:
        raise NoLoopError(f"motor {drive.motor.part}: its inductance is unknown")

    monkeypatch.setattr(drivesizer.simulate, "validate", refuse)
    sizing, proofs = proven(content.sizing)
    assert (
        not proofs
        and "not simulated in open loop: motor A2: its inductance is unknown" in sizing.axes[1].result.warnings
    )
    assert "loops" not in {one["name"] for one in document(MachineContent(sizing, proofs))["sections"]}


def test_documents_with_and_without_loops_obey_the_schema(files, content):
    validator = jsonschema.Draft202012Validator(machine_report_schema())
    report = json.loads(files["a.json"])
    validator.validate(report)
    validator.validate(json.loads(as_text(machine_document(content.sizing))))  # of size, and of earlier versions
    assert machine_document(content.sizing, {})["axes"]["x"]["validation"] is None
    held_against_the_page("Machine", [report])
    held_against_the_page("Axis", report["axes"].values())
    held_against_the_page("Power", [report["power"]])
    report["axes"]["x"]["validation"]["profile"] = 1
    assert not validator.is_valid(report)


def test_a_profile_that_an_axis_cannot_follow_is_refused_with_its_name(content):
    with pytest.raises(InputError, match=r"^x: profile .triangle.: the spec's motion is trapezoid; expected [^\n]*$"):
        proven(content.sizing, "triangle")


# -- power that can be moved


def test_power_on_the_page_is_stacked_by_axis_and_adds_up_to_the_course(content):
    power = content.sizing.power
    plot, course = power_plot(power), power.course(1000)
    assert [entry["label"] for entry in plot["legend"]] == ["x", "table", "out of the source"]
    for stack, rows in (("drawn", course.drawn), ("returned", -course.returned)):
        traces = [trace for trace in plot["data"] if trace.get("stackgroup") == stack]
        assert [len(trace["y"]) for trace in traces] == [len(course.time)] * 2
        assert np.sum([trace["y"][:-1] for trace in traces], axis=0) == pytest.approx(
            rows.sum(axis=0), rel=1e-5, abs=1e-4
        )
    assert plot["data"][-1]["y"][:-1] == pytest.approx(course.total, rel=1e-5, abs=1e-6)
    net = course.drawn[0] - course.returned[0]
    assert plot["data"][0]["customdata"][:-1] == pytest.approx(net, rel=1e-3, abs=1e-4)
    assert min(net) < 0.0 < max(net)  # braking shows below zero
    assert power_plot(replace(power, drawn=power.drawn * np.nan, returned=power.returned * np.nan)) is None
    unknown = power_plot(replace(power, total=power.total * np.nan))
    assert [entry["label"] for entry in unknown["legend"]] == ["x", "table"]
