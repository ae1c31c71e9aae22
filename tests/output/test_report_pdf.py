"""The PDF page by page: as many as a reader takes in, everything within its margins, every section and its figures."""

import io
import re
from dataclasses import replace
from math import isnan, nan

import pypdf
import pytest
from pdf_pages import SHEETS, assert_within_margins
from pdf_text import texts_of
from printed import Printed, blank_figures, printed, text_of
from report_texts import HOSTILE
from starters import changed, starter
from synthetic_validation import synthetic_validation

from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.output.document.axes import content_of
from drivesizer.output.report import pdf
from drivesizer.simulate import validate
from drivesizer.sizing import size

SECTIONS = (
    "The selected drive", "Checks", "Over the cycle", "Heat", "Energy", "Closed loop", "The loops by linear theory",
    "Candidates", "Specification", "Derivation", "Nominal force, torque and power", "Maximum torque and power",
    "At the motor shaft",
    "Assumptions and unknowns", "The same drive by physics", "Data sheets", "How to repeat this",
)  # fmt: skip


DATED = "1 March 2026"


@pytest.fixture(scope="module")
def sheets(result) -> Printed:
    """The robot's report on A4, with a date."""
    return printed(result, validate(result.spec, result.sets[0]), paper="a4", date=DATED)


# -- the robot


def test_the_robots_report_has_six_to_eighteen_dated_pages_of_the_paper(sheets):
    pages = pypdf.PdfReader(io.BytesIO(sheets.content)).pages
    assert 6 <= len(pages) == len(sheets.pictures) <= 18
    for page in pages:
        assert [float(x) * 25.4 / 72.0 for x in page.mediabox[2:]] == pytest.approx(SHEETS["a4"], abs=0.2)
    assert_within_margins(sheets.pictures, "a4")
    assert all(DATED in page for page in texts_of(sheets.content))
    assert b"CreationDate" not in sheets.content and b"ModDate" not in sheets.content


def test_every_section_figure_and_table_is_there_and_numbered(sheets):
    text = text_of(sheets.content)
    for section in SECTIONS:
        assert len(re.findall(re.escape(section), text)) >= 2, section  # in the contents as well
    captions = [int(n) for n in re.findall(r"Figure (\d+): ", text)]
    assert sorted(captions) == list(range(1, len(captions) + 1)) and len(captions) == 14
    for n in {*captions} - {1}:  # the first is on the first page
        assert len(re.findall(rf"Figure {n}\b", text)) >= 2, f"figure {n} is not referred to"
    tables = [int(n) for n in re.findall(r"Table (\d+): ", text)]
    assert sorted(tables) == list(range(1, len(tables) + 1))
    last = len(sheets.pictures)
    assert f"page {last} of {last}" in text


def test_an_unknown_paper_is_refused_in_a_line(result):
    with pytest.raises(InputError, match=r'paper "a5" is not known; expected a4 or us-letter'):
        pdf.report_pdf(content_of(result), paper="a5")


# -- other machines, long names, other scripts, markup


FAMILY = '#eval("1+1") `raw` $x$ @ref'
LONG = "A hoist with a name of remarkable length " * 2 + "W" * 90
CASES = f"""
margins: {{torque: 20 %, temperature: 0.15}}
cases:
  - {{name: '{HOSTILE}', load: {{mass: 18 kg}}}}
  - {{name: тяжёлый груз Ωσ, load: {{mass: 20 kg}}}}
  - {{name: {"X" * 60}, supply: {{nominal: 24 V, min: 21 V}}}}
  - {{name: '# $ * _ ` < @', load: {{mass: 11 kg}}}}
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "paper"), [(LONG, "a4"), (HOSTILE + " робот Ω", "us-letter")], ids=["long", "hostile"]
)
def test_long_and_hostile_names_stay_within_the_page_and_are_printed(name, paper, tmp_path, catalog):
    spec = starter("hoist", tmp_path, ("name: my hoist", f"name: '{name}'"), more=CASES)
    found = size(spec, catalog=catalog, top=3, pareto=("mass", "price", "energy"))
    best = found.sets[0]
    named = replace(best, motor=replace(best.motor, family=FAMILY))
    found = replace(found, sets=(named, *found.sets[1:]))
    proof = synthetic_validation(found) if hasattr(found.spec.motion, "cruise_time") else None
    made = printed(found, proof, paper=paper, date=HOSTILE)
    assert_within_margins(made.pictures, paper)
    text = text_of(made.content).replace(" ", "")
    assert name.replace(" ", "") in text and FAMILY.replace(" ", "") in text
    assert text.count(HOSTILE.replace(" ", "")) >= 2 + len(made.pictures)  # as the date on every page
    assert "тяжёлыйгруз" in text and "X" * 60 in text


def test_sixty_candidates_run_over_pages_with_their_head_repeated(tmp_path, catalog):
    found = size(starter("conveyor", tmp_path), catalog=catalog, top=60)
    with blank_figures():
        made = printed(found, None, paper="us-letter")
    assert_within_margins(made.pictures, "us-letter")
    text = text_of(made.content)
    assert all(
        f"{s.rank} {s.motor_name}" in text for s in found.sets if " " not in s.motor.part and len(s.motor.part) < 15
    )
    assert text.count("price (EUR)") >= 2


def test_a_set_of_unknown_figures_and_a_file_whose_name_is_no_text(result):
    """The rest is drawn; letters of the name are spelled out with backslashes, which the typesetter once refused."""
    best = result.sets[0]
    bare = replace(best, gearhead=replace(best.gearhead, inertia=nan))
    named = replace(result, sets=(bare,), problem=replace(result.problem, machine=result.spec.model_copy()))
    named.spec._source = YamlSource(result.spec.text, "folder/a\udcff\x01.yaml")
    made = printed(named, None)
    assert_within_margins(made.pictures, "a4")
    text = text_of(made.content)
    assert "a_udcff_x01.yaml" in pypdf.PdfReader(io.BytesIO(made.content)).attachments
    assert "attachedtothisPDFasa_udcff_x01.yaml" in "".join(text.split())
    assert "Energy per cycle unknown" in text and "current over time is unknown" in text
    assert not isnan(best.gearhead.price) and isnan(best.motor.price)
    least = re.search(r"total ≥ [\d.]+ k?g ≥ ([\d.]+) EUR", text)
    assert least and float(least[1]) == pytest.approx(4 * best.gearhead.price) and not re.search(r"\bnan\b", text)


def test_misses_are_reported_with_bars_and_what_would_have_to_move(example_text, tmp_path):
    pairs = ("speed: 1.5 m/s", "speed: 9 m/s"), ("name: SPS surveillance robot", f"name: {LONG}")
    found = size(changed(example_text, tmp_path, *pairs))
    assert not found.sets
    with blank_figures():
        made = printed(found, None)
    assert_within_margins(made.pictures, "a4")
    text = text_of(made.content)
    assert "No drive meets all limits." in text and "; it fails on:" in text and found.misses[0].motor.part in text
    assert "The closest rejected drive" in text and "Changes after which" in text and re.search(r"and \d+ more", text)
