"""How sure sets are, as documents and figures tell it."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import jsonschema
import openpyxl
import pytest
from printed import blank_figures, text_of

from drivesizer.files.yaml_source import YamlSource
from drivesizer.output.json.documents import plain
from drivesizer.output.json.schema import report_schema
from drivesizer.output.report import csv as csv_tables
from drivesizer.output.report import write
from drivesizer.output.report.figures.all_figures import report_drawings
from drivesizer.output.report.figures.choice import swings, tornado
from drivesizer.output.report.figures.picture import barred
from drivesizer.output.terminal.sizing import DETAILS, sizing
from drivesizer.output.words import reported, varying_checks
from drivesizer.results.sizing import SizingResult
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.sizing import explained, size
from drivesizer.spec.robot import read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")


@pytest.fixture(scope="module")
def result(example_text: str) -> SizingResult:
    text = example_text[: example_text.index("select:")].replace("method: paper", "method: physics")
    text = text.replace("mass: 45 kg ", "mass: 45 kg +- 3 kg ")
    text = text.replace("rolling_resistance: 0.02 ", "rolling_resistance: 0.02 in 0.015..0.03 ")
    spec = read_spec(YamlSource(text + "select: {motor: {family: [DCX 22 S, RE 30]}}\n", "robot.yaml"))
    return size(spec, top=2, sampling=Sampling(512, 1, 0.5))


@pytest.mark.slow
def test_the_json_document_says_how_sure_and_is_what_its_schema_says(result: SizingResult, tmp_path: Path) -> None:
    write(result, None, [tmp_path / "report.json"])
    document = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    jsonschema.validate(document, report_schema())
    document = document["axes"][0]["result"]
    told = document["uncertainty"]
    assert (told["samples"], told["seed"], told["confidence"]) == (512, 1, 0.5)
    assert "load.mass" in [one["name"] for one in told["assumptions"]]
    for one in document["sets"]:
        found = one["reliability"]
        assert found["probability"] >= 0.5 and found["drivers"][0]["name"] == "load.rolling_resistance"
        assert found["low"] <= found["high"]
    assert all(one["reliability"]["probability"] < 0.5 for one in document["unsure"])


def test_the_tornado_is_drawn_of_what_moves_the_margin(result: SizingResult) -> None:
    best = reported(result)
    assert best and best.reliability
    drawn = swings(best.reliability.drivers)
    assert 2 <= len(drawn) <= 10 and drawn[0].name == "load.rolling_resistance"
    widest = max(abs(one.high_margin - one.low_margin) for one in drawn)
    assert abs(drawn[0].high_margin - drawn[0].low_margin) == widest
    assert barred(tornado(best.reliability.drivers))() == barred(tornado(best.reliability.drivers))()
    printed = [round(100.0 * one.share) for one in drawn]
    assert printed == sorted(printed, reverse=True)
    assert report_drawings(result, None)["tornado"]("png").startswith(b"\x89PNG")


# --- what is printed where nothing was sampled, and where nothing is sure enough -----------------------------------


def test_the_other_columns_are_those_of_the_nominal_spec(example_text: str) -> None:
    """Tolerances add columns at the end, and change no cell before them."""
    plain, moved_ = (
        size(read_spec(YamlSource(text, "robot.yaml")), sampling=sampling)
        for text, sampling in ((example_text, None), (example_text.replace("45 kg ", "45 kg +- 3 kg "), FEW))
    )
    before, after = (list(csv.reader(io.StringIO(csv_tables.sets_csv(one).decode()))) for one in (plain, moved_))
    width = len(before[0])
    assert [row[:width] for row in after] == before and len(after[0]) > width
    assert after[0][width : width + 2] == ["probability", "none_fails"]
    assert 0.0 < float(after[1][width]) == float(after[1][width + 1]) < 1.0  # nothing of it is unknown
    miss = dict(zip(after[0], after[2], strict=True))
    assert miss["list"] == "miss" and miss["probability"] == miss["passes_supply_voltage"] == ""


FEW = Sampling(256, 1, None)


@pytest.fixture(scope="module")
def unsure(result: SizingResult) -> SizingResult:
    """No set is as sure as 100 %."""
    return size(result.spec, top=2, sampling=Sampling(256, 1, 1.0))


@pytest.mark.slow
def test_every_report_says_that_no_set_is_as_sure_and_shows_the_surest(unsure: SizingResult, tmp_path: Path) -> None:
    assert not unsure.sets and len(unsure.unsure) == 2 and unsure.reported is unsure.unsure[0]
    with blank_figures():
        write(unsure, None, [tmp_path / f"report.{kind}" for kind in ("pdf", "html", "xlsx", "csv")])
    text = text_of((tmp_path / "report.pdf").read_bytes())
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    for said in (text, page):
        assert "No drive reaches the confidence of 100 %." in said
        assert "the most probable drive: below the required confidence" in said
        assert "all limits at nominal figures" in said and "closest rejected drive is" not in said
        assert all(one.label in said for one in unsure.unsure)
    book = openpyxl.load_workbook(tmp_path / "report.xlsx")
    assert any("No drive reaches the confidence of 100 %." in str(row[0].value) for row in book["Summary"].iter_rows())
    rows = list(csv.DictReader(io.StringIO((tmp_path / "report.csv").read_text(encoding="utf-8"))))
    chances = {row["set_rank"]: row["si_value"] for row in rows if row["name"] == "all_checks"}
    assert chances == {
        str(one.rank): "" if one.reliability.unknown else str(one.reliability.probability) for one in unsure.unsure
    }
    ranks = [one.rank for one in (*unsure.unsure, *unsure.misses)]
    assert ranks == list(range(1, len(ranks) + 1))
    lists = [row["list"] for row in csv.DictReader(io.StringIO(csv_tables.sets_csv(unsure).decode()))]
    assert lists[:2] == ["unsure", "unsure"] and "set" not in lists


# --- the terminal ----------------------------------------------------------------------------------------------------


def told(result: SizingResult, capsys: pytest.CaptureFixture[str], *, quiet: bool = False) -> str:
    sizing(result, details=frozenset() if quiet else DETAILS, quiet=quiet)
    return capsys.readouterr().out


# --- one pair --------------------------------------------------------------------------------------------------------


def test_a_pair_is_as_sure_as_the_sizing_says(result: SizingResult) -> None:
    """The same set by another way: alone, and among all that the search found."""
    best = result.sets[0]
    pair = explained(result.spec, best.motor.part, best.gearhead.part, sampling=Sampling(512, 1, None))
    (one,) = [s for s in pair.sets if s.belt_ratio == best.belt_ratio]
    assert one.reliability and plain(one.reliability) == plain(best.reliability)
    assert pair.uncertainty and pair.uncertainty.assumptions == result.uncertainty.assumptions  # type: ignore[union-attr]


def test_a_pair_that_falls_at_nominal_figures_is_sampled_too(result: SizingResult) -> None:
    miss = next(one for one in result.misses or size(result.spec, top=200).misses)
    (one, *_) = explained(result.spec, miss.motor.part, miss.gearhead.part, sampling=FEW).sets
    failed = {check.title for check in one.checks if check.status == "fail"}
    assert one.status == "fail" and one.reliability and one.reliability.probability < 1.0
    assert failed <= {check.title for check in varying_checks(one.reliability)}
