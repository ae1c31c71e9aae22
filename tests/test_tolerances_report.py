"""How sure sets are, as documents and figures tell it."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest
from pypdf import PdfReader

from drivesizer import contract
from drivesizer.report import write, write_figures
from drivesizer.report.json_schema import report_schema
from drivesizer.report.tolerance_rows import judged, sure
from drivesizer.report.tornado_figure import swings, tornado
from drivesizer.results import SizingResult
from drivesizer.sizing import size
from drivesizer.spec import read_spec
from drivesizer.terminal import sizing
from drivesizer.tolerances.run import Sampling
from drivesizer.yaml_source import YamlSource


@pytest.fixture(scope="module")
def result(example_text: str) -> SizingResult:
    text = example_text[: example_text.index("select:")].replace("method: paper", "method: physics")
    text = text.replace("mass: 45 kg ", "mass: 45 kg +- 3 kg ")
    text = text.replace("rolling_resistance: 0.02 ", "rolling_resistance: 0.02 in 0.015..0.03 ")
    spec = read_spec(YamlSource(text + "select: {motor: {family: [DCX 22 S, RE 30]}}\n", "robot.yaml"))
    return size(spec, top=2, sampling=Sampling(512, 1, 0.5))


def test_the_json_document_says_how_sure_and_is_what_its_schema_says(result: SizingResult, tmp_path: Path) -> None:
    write(result, None, [tmp_path / "report.json"])
    document = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    jsonschema.validate(document, report_schema())
    told = document["uncertainty"]
    assert (told["samples"], told["seed"], told["confidence"]) == (512, 1, 0.5)
    assert "load.mass" in [one["name"] for one in told["assumptions"]]
    for one in document["sets"]:
        found = one["reliability"]
        assert found["probability"] >= 0.5 and found["drivers"][0]["name"] == "load.rolling_resistance"
        assert found["smallest_margin"]["p5"] <= found["smallest_margin"]["p95"]
    assert all(one["reliability"]["probability"] < 0.5 for one in document["unsure"])


def test_without_tolerances_the_keys_are_there_and_null(spec, catalog) -> None:  # type: ignore[no-untyped-def]
    document = contract.sizing(size(spec, catalog=catalog))
    assert document["uncertainty"] is None and document["unsure"] == []
    assert document["sets"][0]["reliability"] is None


def test_the_pdf_and_the_page_tell_the_same_rows(result: SizingResult, tmp_path: Path) -> None:
    write(result, None, [tmp_path / "report.pdf", tmp_path / "report.html"])
    text = " ".join(page.extract_text() for page in PdfReader(tmp_path / "report.pdf").pages)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    rows = sure(result)
    assert rows
    assert "How sure the sets are" in text and "How sure the sets are" in page
    for row in rows["sets"]:
        assert row[1] in text and row[1] in page
    for title, words, _ in rows["assumptions"]:
        assert title in page and words in page


def test_the_tornado_is_drawn_of_what_moves_the_margin(result: SizingResult, tmp_path: Path) -> None:
    best = judged(result)
    assert best and best.reliability
    drawn = swings(best.reliability.drivers)
    assert 2 <= len(drawn) <= 10 and drawn[0].name == "load.rolling_resistance"
    widest = max(abs(one.high_margin - one.low_margin) for one in drawn)
    assert abs(drawn[0].high_margin - drawn[0].low_margin) == widest
    assert tornado(best.reliability.drivers) == tornado(best.reliability.drivers)
    names = {path.name for path in write_figures(result, None, tmp_path / "figures")}
    assert {"tornado.svg", "tornado.png"} <= names


def test_the_terminal_names_the_three_that_matter_most(
    result: SizingResult, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    sizing(result)
    said = capsys.readouterr().out
    best = result.sets[0].reliability
    assert best and result.uncertainty
    assert "How sure they are" in said and "What its smallest margin hangs on most" in said
    for driver in best.drivers[:3]:
        assert driver.title.split(" +-")[0].split(" in ")[0] in said
    assert f"{result.uncertainty.examined} sets sampled, 512 times each (seed 1)" in said
