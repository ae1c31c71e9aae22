"""The first page of a report and the order of the rest: one verdict, totals, tightest checks, confidence, a picture."""

from __future__ import annotations

import io
import re
from dataclasses import replace

import pypdf
import pytest
from pdf_text import texts_of
from printed import blank_figures

from drivesizer.output.document import SECTIONS, Chapter, printed
from drivesizer.output.document.axes import content_of, document_of
from drivesizer.output.document.content import Content
from drivesizer.output.document.paper import paper_data
from drivesizer.output.document.records import BOOK
from drivesizer.output.report.html.page import report_html
from drivesizer.output.report.pdf import report_pdf
from drivesizer.results.check_kinds import PARTS, part_of, sorted_by_part
from drivesizer.results.sizing import SizingResult
from drivesizer.spec.sections import TitleBlock


@pytest.fixture(scope="module")
def by_physics(result: SizingResult) -> SizingResult:
    """The robot as if physics had ranked: the checks of both methods changed over."""
    best = result.sets[0]
    spec = result.problem.machine.model_copy(update={"method": "physics"})
    other = replace(best, checks=best.beside, beside=best.checks)
    problem = replace(result.problem, machine=spec)
    counts = replace(result.counts, failed_by={})
    return replace(result, problem=problem, method="physics", sets=(other,), misses=(), counts=counts)


def sections(result: SizingResult) -> dict:
    return {section["name"]: section for section in paper_data(document_of(content_of(result)))["sections"]}


def blocks(result: SizingResult, name: str) -> dict:
    """Blocks of a section by their name, else their kind."""
    return {block.get("name") or block["kind"]: block for block in sections(result)[name]["blocks"]}


# -- the order, and one verdict


def test_the_summary_has_the_answer_in_its_order(result):
    assert [*blocks(result, "summary")] == ["verdict", "parts", "words", "tightest", "tiles", "confidence", "field"]
    made = blocks(result, "summary")
    assert len(made["tightest"]["rows"]) == 3
    margins = [row["cells"][3]["value"] for row in made["tightest"]["rows"]]
    assert margins == sorted(margins) and margins[0] == min(
        c.margin for c in result.sets[0].deciding if c.is_comparable
    )
    assert made["words"]["text"] == (
        "In all: no mass of belt, encoder, controller; no price of motor, belt, encoder, controller."
    )
    assert made["verdict"]["paragraphs"][0][0] == {"kind": "status", "text": result.sets[0].status}


APPENDIX = ("physics", "platform", "repeat", "datasheets")


def test_the_grounds_follow_the_answer_and_what_is_seldom_read_is_appendix(result):
    order = [*sections(result)]
    wanted = ["summary", "drive", "checks", "over-time", "machine", "candidates", "specification", "derivation",
              "assumptions", "physics", "repeat", "datasheets"]  # fmt: skip
    assert [name for name in order if name in wanted] == wanted
    assert [name for name, one in sections(result).items() if one["appendix"]] == [*APPENDIX]


def test_the_method_that_did_not_rank_has_no_verdict(by_physics, result):
    """The paper's verdict is printed only where its method ranks; physics beside it only in the appendix."""
    assert "beside" in blocks(result, "physics") and "beside" not in blocks(result, "checks")
    assert "physics" not in sections(by_physics)
    shown = {row["data"]["check"] for row in blocks(by_physics, "checks")["checks"]["rows"]}
    own = {check.name for check in by_physics.sets[0].checks}
    assert shown == own and own != {check.name for check in by_physics.sets[0].beside}


def test_the_first_page_of_a_pdf_holds_all_of_it_and_files_go_with_it(result):
    digests = {f"maker {n}": f"{n:032x}" for n in range(80)}
    many = replace(result, problem=replace(result.problem, catalog=replace(result.catalog, digests=digests)))
    with blank_figures():
        content = report_pdf(content_of(many), paper="us-letter")
    first, *others = (re.sub(r"\s+", " ", text) for text in texts_of(content))
    for said in ("A drive was found", "total", "smallest margins", "Confidence in the verdict", "Figure 1"):
        assert said in first, said
    last = 1 + len(others)
    assert all(f"page {n} of {last}" in text for n, text in enumerate((first, *others), 1))  # the layout converged
    attached = pypdf.PdfReader(io.BytesIO(content)).attachments
    assert attached["sps_robot.yaml"][0].decode().splitlines() == result.spec.text.splitlines()
    lines = attached["catalogues.txt"][0].decode().splitlines()  # digests of many catalogues are no page
    assert dict(line.split("  ") for line in lines) == digests
    assert not any(f"{79:032x}" in page for page in others)


def test_the_title_block_is_what_the_spec_gives(result):
    given = {"customer": "Muster <AG>", "project": "AGV 12", "revision": "B"}
    spec = result.problem.machine.model_copy(update={"report": TitleBlock(**given)})
    titled = replace(result, problem=replace(result.problem, machine=spec))
    with blank_figures():
        pages = [re.sub(r"\s+", " ", text) for text in texts_of(report_pdf(content_of(titled)))]
        page = report_html(content_of(titled)).decode()
    assert all(text in pages[0] for text in given.values())
    assert all("SPS surveillance robot, AGV 12, revision B" in text for text in pages[1:])
    assert "<dt>Customer</dt><dd>Muster &lt;AG&gt;</dd>" in page and "Author" not in pages[0]
    assert paper_data(document_of(content_of(result)))["block"] == []
    (summary,) = printed([Chapter(Content(titled), SECTIONS[:1])], BOOK)
    assert {row.cells.get("title"): row.cells.get("note") for row in summary.blocks[1].rows}["Project"] == "AGV 12"


def test_of_unknown_checks_no_more_is_said_than_that_none_fails(result):
    best = replace(result.sets[0], status="unknown")
    said = str(blocks(replace(result, sets=(best,)), "summary")["verdict"])
    assert "fails no check" in said and "limits" not in said
    assert "meets all limits" in str(blocks(result, "summary")["verdict"])


# -- groups


def test_checks_are_grouped_by_part_and_keep_their_order_within(result):
    best = result.sets[0]
    ordered = sorted_by_part(best.checks)
    places = [PARTS.index(part_of(check.name)) for check in ordered]
    assert places == sorted(places)
    for part in PARTS:
        assert [c for c in ordered if part_of(c.name) == part] == [c for c in best.checks if part_of(c.name) == part]
    heads = re.findall(r'<tr class="part"><th colspan="6" scope="colgroup">(.*?)</th>', checks_of(result))
    assert heads == [part for part in PARTS if any(part_of(check.name) == part for check in best.checks)]


def checks_of(result: SizingResult) -> str:
    """The table of checks on the page."""
    with blank_figures():
        page = report_html(content_of(result)).decode()
    return page.partition('id="checks"')[2].partition("</table>")[0]
