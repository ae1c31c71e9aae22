"""CSV against the spreadsheets that open it: no text is computed, however it is split, and numbers stay numbers."""

import csv
import io
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivesizer.output.document.axes import content_of
from drivesizer.output.report import csv as csv_tables
from drivesizer.output.words import csv_cell, visible
from drivesizer.results.sizing import SizingResult
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec

STARTS = ("=", "+", "-", "@", "＝", "＋", "－", "＠")
PAYLOADS = (
    "=cmd|' /C calc'!A0", "+1+1", "-2+3", "@SUM(1+9)", "\t=1", "\r=1", "\n=1", " =1", "a;=1+1", "a\t=1+1", 'a"\n=1+1',
    "a,b;@x", "＝1+1", "'=1+1", "x\r\n-1",
)  # fmt: skip


@pytest.fixture(scope="module")
def result(spec: RobotSpec) -> SizingResult:
    return size(spec, top=2)


def hostile(result: SizingResult, text: str) -> SizingResult:
    best = result.sets[0]
    checks = (replace(best.checks[0], note=text, case=text), *best.checks[1:])
    first, *others = result.requirements
    return replace(
        result,
        sets=(replace(best, checks=checks, motor=replace(best.motor, family=text)),),
        requirements=(replace(first, title=text, note=text), *others),
    )


def every_cell(content: bytes) -> set[str]:
    """Cells as programs split them that know the rules, and as those that do not."""
    text = content.decode()
    cells = {cell for row in csv.reader(io.StringIO(text, newline="")) for cell in row}
    for separator in ",;\t":
        cells |= {cell for row in csv.reader(io.StringIO(text), delimiter=separator) for cell in row}
    return cells | {cell.strip('"') for cell in re.split(r"[;\t\n]", text)}


def is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


@pytest.mark.parametrize("text", PAYLOADS)
def test_no_cell_is_computed_however_the_file_is_split_and_its_text_is_there(text, result):
    content = csv_tables.report_csv(content_of(hostile(result, text)))
    # A comma that is no separator leaves the rest of the row in the cell: only its start is looked at.
    computed = {c for c in every_cell(content) if c.lstrip(" ").startswith(STARTS) and not is_number(c.split(",")[0])}
    assert computed == set()
    rows = list(csv.DictReader(io.StringIO(content.decode(), newline="")))
    told = next(row for row in rows if row["section"] == "requirement" and not row["set_rank"])["title"].replace(
        "'", ""
    )
    assert told == text.replace("\r\n", "\n").replace("\r", "\n").replace("'", "")


@given(st.floats(allow_nan=False))
def test_a_number_is_written_with_all_its_digits(value):
    text = io.StringIO()
    csv.writer(text).writerow([csv_cell(value)])
    assert float(text.getvalue()) == value


@given(st.text(max_size=40))
def test_any_text_is_one_cell_that_is_not_computed(text):
    cell = csv_cell(text)
    assert not cell.lstrip(" ").startswith((*STARTS, "\t"))
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerow([cell, "end"])
    assert list(csv.reader(io.StringIO(out.getvalue(), newline=""))) == [[cell, "end"]]
    out.getvalue().encode()  # half a letter cannot be written
    assert "\x00" not in cell and "\r" not in cell


@given(st.text(alphabet=st.characters(categories=("L", "N", "P", "S", "Zs", "Mn"), exclude_characters="\x00")))
def test_letters_of_any_script_stay_as_they_are(text):
    assert visible(text) == text


def test_columns_over_time_are_written_bit_for_bit_and_what_is_unknown_is_empty():
    time = np.array([0.0, 0.1, 0.30000000000000004, 1e-320, 1e22])
    torque = np.array([-0.0, np.nan, 1 / 3, np.inf, 5.0])
    text = csv_tables.columns_csv({"time": (time, "time", "s"), "T, motor": (torque, "torque", "N*m")}).decode()
    heads, *rows = csv.reader(io.StringIO(text))
    assert heads == ["time (s)", "T, motor (N*m)"] and text.endswith("\n") and "\r" not in text
    assert [row[1] for row in rows] == ["-0.0", "", repr(1 / 3), "inf", "5.0"]
    assert [float(row[0]) for row in rows] == time.tolist()
