"""The PDF page by page: as many as a reader takes in, everything within its margins, every section and its figures."""

import io
import re
from dataclasses import replace
from math import nan

import numpy as np
import pypdf
import pytest
import typst
from matplotlib.image import imread
from test_figures import synthetic_validation
from test_report import HOSTILE, changed, starter, text_of

from drivesizer.errors import InputError
from drivesizer.report import pdf
from drivesizer.results import SizingResult, Validation
from drivesizer.simulate import validate
from drivesizer.sizing import size
from drivesizer.spec import RobotSpec

SHEETS = {"a4": (210.0, 297.0), "us-letter": (215.9, 279.4)}  # mm
SECTIONS = (
    "What was asked", "Derivation", "The vehicle and its wheels", "At the motor shaft", "Candidates", "The chosen set",
    "Checks", "Over the cycle", "Heat", "Energy", "Parts list", "Data sheets", "Closed loop",
    "The loops by linear theory", "Assumptions and unknowns", "How to repeat this", "The spec file",
)  # fmt: skip
_DOTS = 40  # per inch, of a page as a picture
_CLEAR = 17.0  # mm at the left and the right of every page
_NARROW = 5.0  # mm above and below


@pytest.fixture(scope="module")
def result(spec: RobotSpec) -> SizingResult:
    return size(spec)


@pytest.fixture(scope="module")
def proof(result: SizingResult) -> Validation:
    return validate(result.spec, result.sets[0])


@pytest.fixture
def pictures(monkeypatch):
    """The pages of a report as arrays of grey, 1 is white."""

    def of(*given, **more) -> list[np.ndarray]:
        kept = []
        compile_it = typst.compile
        with monkeypatch.context() as patch:
            patch.setattr(typst, "compile", lambda source, **how: kept.append((source, how)) or b"")
            pdf.report_pdf(*given, **more)
        source, how = kept[0]
        pages = compile_it(source, **(how | {"format": "png", "ppi": _DOTS}))
        pages = pages if isinstance(pages, list) else [pages]
        return [imread(io.BytesIO(page))[..., :3].min(axis=2) for page in pages]

    return of


def assert_within_margins(pages: list[np.ndarray], paper: str) -> None:
    """Nothing is printed beyond the text at either side, nor at the very top or bottom."""
    side, ends = (round(room / 25.4 * _DOTS) for room in (_CLEAR, _NARROW))
    for number, page in enumerate(pages, 1):
        assert page.shape[1] == pytest.approx(SHEETS[paper][0] / 25.4 * _DOTS, abs=1.5)
        blank = (page[:, :side], page[:, -side:], page[:ends], page[-ends:])
        assert all(part.min() > 0.98 for part in blank), f"page {number}"
        assert page[:, side:-side].min() < 0.5, f"page {number} is empty"


# -- the robot


@pytest.mark.parametrize("paper", SHEETS)
def test_the_robots_report_has_six_to_twelve_pages_of_the_paper(result, proof, paper):
    content = pdf.report_pdf(result, proof, paper=paper)
    pages = pypdf.PdfReader(io.BytesIO(content)).pages
    assert 6 <= len(pages) <= 12
    for page in pages:
        sheet = [float(x) * 25.4 / 72.0 for x in page.mediabox[2:]]
        assert sheet == pytest.approx(SHEETS[paper], abs=0.2)
    assert pdf.report_pdf(result, proof, paper=paper) == content


@pytest.mark.parametrize("paper", SHEETS)
def test_nothing_of_the_robots_report_leaves_the_page(result, proof, paper, pictures):
    assert_within_margins(pictures(result, proof, paper=paper, date="2026-03-01"), paper)


def test_every_section_figure_and_table_is_there_and_numbered(result, proof):
    text = text_of(pdf.report_pdf(result, proof))
    for section in SECTIONS:
        assert len(re.findall(re.escape(section), text)) >= 2, section  # in the contents as well
    captions = [int(n) for n in re.findall(r"Figure (\d+): ", text)]
    assert sorted(captions) == list(range(1, len(captions) + 1)) and len(captions) == 10
    for n in captions:
        assert len(re.findall(rf"Figure {n}\b", text)) >= 2, f"figure {n} is not referred to"
    tables = [int(n) for n in re.findall(r"Table (\d+): ", text)]
    assert sorted(tables) == list(range(1, len(tables) + 1))
    last = len(pypdf.PdfReader(io.BytesIO(pdf.report_pdf(result, proof))).pages)
    assert f"page {last} of {last}" in text


def test_what_figures_say_can_be_searched_and_copied(result, proof):
    text = text_of(pdf.report_pdf(result, proof))
    for said in ("torque at the motor's shaft", "energy of a cycle (J)", "speed there (rpm)", "current (A)",
                 "friction and iron of the motor", "frequency (Hz)"):  # fmt: skip
        assert said in text, said


def test_energy_heat_parts_and_what_is_not_known_are_told(result, proof):
    text = text_of(pdf.report_pdf(result, proof))
    for said in (
        "Energy per cycle 5088 J", "drawn less what comes back and is kept (70 %", "Copper loss, mean 0.3658 W",
        "Winding in the long run, mean 38.23 °C", "winding time constant, motor time constant of the motor not known",
        "4 × gearhead maxon GP 26 A 406764 127.73 EUR 510.92 EUR", "without motor, belt, encoder, controller",
        "Cables, connectors", "Motor permissible speed motor max speed", "encoder max speed 24000 rpm recalled",
    ):  # fmt: skip
        assert said in text, said


def test_a_date_is_printed_where_it_is_given_and_nowhere_else(result):
    proof = synthetic_validation(result)
    plain, dated = pdf.report_pdf(result, proof), pdf.report_pdf(result, proof, date="1 March 2026")
    pages = pypdf.PdfReader(io.BytesIO(dated)).pages
    assert all("1 March 2026" in page.extract_text() for page in pages)
    assert "1 March 2026" not in text_of(plain)
    assert b"CreationDate" not in plain + dated and b"ModDate" not in plain + dated


def test_an_unknown_paper_is_refused_in_a_line(result):
    with pytest.raises(InputError, match=r'paper "a5" is not known; expected a4 or us-letter'):
        pdf.report_pdf(result, None, paper="a5")


# -- other machines, long names, other scripts, markup


LONG = "A hoist with a name of remarkable length " * 2 + "W" * 90
CASES = f"""
margins: {{torque: 20 %, temperature: 0.15}}
cases:
  - {{name: '{HOSTILE}', load: {{mass: 18 kg}}}}
  - {{name: тяжёлый груз Ωσ, load: {{mass: 20 kg}}}}
  - {{name: {"X" * 60}, supply: {{nominal: 24 V, min: 21 V}}}}
  - {{name: '# $ * _ ` < @', load: {{mass: 11 kg}}}}
"""


@pytest.mark.parametrize(
    ("name", "paper"), [(LONG, "a4"), (HOSTILE + " робот Ω", "us-letter")], ids=["long", "hostile"]
)
def test_long_and_hostile_names_stay_within_the_page_and_are_printed(name, paper, tmp_path, catalog, pictures):
    spec = starter("hoist", tmp_path, ("name: my hoist", f"name: '{name}'"), more=CASES)
    found = size(spec, catalog=catalog, top=3, pareto=("mass", "price", "energy"))
    proof = synthetic_validation(found) if hasattr(found.spec.motion, "cruise_time") else None
    assert_within_margins(pictures(found, proof, paper=paper, date=HOSTILE), paper)
    text = text_of(pdf.report_pdf(found, proof, paper=paper)).replace(" ", "")
    assert name.replace(" ", "") in text and text.count(HOSTILE.replace(" ", "")) >= 2
    assert "тяжёлыйгруз" in text and "X" * 60 in text


def test_sixty_candidates_run_over_pages_with_their_head_repeated(tmp_path, catalog, pictures):
    found = size(starter("conveyor", tmp_path), catalog=catalog, top=60)
    assert_within_margins(pictures(found, None, paper="us-letter"), "us-letter")
    text = text_of(pdf.report_pdf(found, None))
    assert all(
        f"{s.rank} {s.motor_name}" in text for s in found.sets if " " not in s.motor.part and len(s.motor.part) < 15
    )
    assert text.count("price (EUR)") >= 2


def test_a_set_of_unknown_figures_says_which_and_draws_the_rest(result, pictures):
    best = result.sets[0]
    bare = replace(best, gearhead=replace(best.gearhead, inertia=nan, price=nan), encoder=None)
    some = replace(result, sets=(bare,))
    assert_within_margins(pictures(some, None), "a4")
    text = text_of(pdf.report_pdf(some, None))
    assert "Energy per cycle unknown" in text and "current over time is unknown" in text
    assert "sum of the known prices unknown" in text and not re.search(r"\bnan\b", text)


def test_misses_are_reported_with_bars_and_what_would_have_to_move(example_text, tmp_path, pictures):
    found = size(changed(example_text, tmp_path, ("speed: 1.5 m/s", "speed: 9 m/s")))
    assert not found.sets
    assert_within_margins(pictures(found, None), "a4")
    text = text_of(pdf.report_pdf(found, None))
    assert "The nearest miss" in text and "What would have to move" in text and re.search(r"and \d+ more", text)
