"""Closed loops in the report of a machine: those of `validate`, in each kind of file, a stepper behind its pulses."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator
from typing import Any

import jsonschema
import numpy as np
import openpyxl
import pytest
from printed import blank_figures
from two_axes import STEPPER, two_axes
from typer.testing import CliRunner

from drivesizer.cli import app
from drivesizer.commands.common import proven
from drivesizer.errors import InputError
from drivesizer.output.document.axes import MachineContent, document_of
from drivesizer.output.document.paper import paper_data
from drivesizer.output.json.documents import as_text
from drivesizer.output.json.schema import report_schema

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
    axes = json.loads(called("validate", machine.file, "--json"))["axes"]
    return {axis["name"]: axis["validations"][0] for axis in axes}


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
    from drivesizer.multi_axis import size_machine

    return MachineContent(*proven(size_machine(machine, top=1)))


# -- the same numbers as those of validate


def test_the_report_has_what_validate_prints(files, validated):
    axes = json.loads(files["a.json"])["axes"]
    assert [one["name"] for one in axes] == [*validated] == ["x", "table"]
    for one in axes:
        assert one["validation"] == validated[one["name"]] and len(one["series"]["columns"]["time"]) > 100


def test_the_rms_current_of_the_series_is_that_of_the_check_weighed_by_time(files, validated):
    series = json.loads(files["a.json"])["axes"][0]["series"]["columns"]
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
    """In SI as JSON has them in the CSV; beside them and in the workbook in the units of the trade."""
    table = [*csv.DictReader(io.StringIO(files["a.csv"].decode()))]
    rows = {(row["axis"], row["name"], row["si_value"], row["si_limit"]): row for row in table
            if row["section"] == "validation"}  # fmt: skip
    sheets = [row for name in ("Closed loop", "Open loop") for row in book[name].iter_rows(values_only=True)]
    cells = {(row[0], digits(cell)) for row in sheets for cell in row}
    for name, proof in validated.items():
        written = [(one["name"], one["value"], None) for one in proof["figures"]]
        written += [(one["name"], one["demand"], one["limit"]) for one in proof["checks"]]
        assert len(written) > 10
        for key, *numbers in written:
            row = rows[name, key, *("" if number is None else str(number) for number in numbers)]
            for column in ("value", "limit"):
                printed = {digits(float(row[of])) for of in (column, f"si_{column}") if row[of]}
                assert not printed or any((name, one) in cells for one in printed)


# -- chapters


def document(content):
    return paper_data(document_of(content))


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


# -- failing, missing, older


def test_documents_with_and_without_loops_obey_the_schema(files, content):
    validator = jsonschema.Draft202012Validator(report_schema())
    report = json.loads(files["a.json"])
    validator.validate(report)
    validator.validate(json.loads(as_text(content.sizing)))  # of size
    report["axes"][0]["validation"]["profile"] = 1
    assert not validator.is_valid(report)


def test_a_profile_that_an_axis_cannot_follow_is_refused_with_its_name(content):
    with pytest.raises(InputError, match=r"^x: profile .triangle.: the spec's motion is trapezoid; expected [^\n]*$"):
        proven(content.sizing, "triangle")
