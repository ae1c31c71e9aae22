"""The HTML report: one file that asks for nothing; its numbers are those of the JSON document, its texts are text."""

import base64
import hashlib
import json
import re
import zlib
from dataclasses import replace
from itertools import pairwise

import pytest
from html_reports import CASE, NAME, figures_of, hostile_spec, parsed, whole_validation

from drivesizer.control.validation import Validation
from drivesizer.output.document.axes import content_of
from drivesizer.output.report import write
from drivesizer.output.report.figures.style import COLOURS
from drivesizer.output.report.html.page import report_html
from drivesizer.output.report.html.plots import plain
from drivesizer.output.report.html.templates import environment
from drivesizer.results.sizing import SizingResult
from drivesizer.sizing import size


@pytest.fixture(scope="module")
def proof(result: SizingResult) -> Validation:
    return whole_validation(result)


@pytest.fixture(scope="module")
def content(result: SizingResult, proof: Validation) -> bytes:
    return report_html(content_of(result, proof))


@pytest.fixture(scope="module")
def page(content):
    return parsed(content)


@pytest.fixture(scope="module")
def hostile(tmp_path_factory, catalog) -> SizingResult:
    return size(
        hostile_spec(tmp_path_factory.mktemp("hostile")), catalog=catalog, top=6, pareto=("mass", "price", "energy")
    )


FAMILY = "</td><script>alert(2)</script>{{ 7*7 }}<a href='javascript:1'>x</a>"


@pytest.fixture(scope="module")
def named_page(hostile):
    """The page of a motor whose family is markup."""
    best = hostile.sets[0]
    named = replace(best, motor=replace(best.motor, family=FAMILY))
    return parsed(report_html(content_of(replace(hostile, sets=(named, *hostile.sets[1:])))))


def words(element) -> str:
    return " ".join(element.text_content().split())


# -- one file


def test_the_same_input_gives_the_same_bytes(content, result, proof, tmp_path):
    (path,) = write(result, proof, [tmp_path / "report.html"])
    assert path.read_bytes() == content
    assert len(content) <= 5_000_000


def test_the_file_asks_for_nothing(content, page):
    assert (
        page.xpath("//link[not(@rel='icon')] | //iframe | //object | //embed | //base | //*[@src][not(self::img)]")
        == []
    )
    stills = page.xpath("//img/@src")
    assert len(stills) >= 3 and all(src.startswith("data:image/svg+xml;base64,") for src in stills)
    for src in stills:  # nor does a drawing inside it
        drawing = base64.b64decode(src.partition(",")[2]).decode()
        assert not re.search(r"<(script|image|foreignObject)|(?:href|src)=.(?!#)", drawing)
    assert page.xpath("//link/@href") == ["data:,"]
    assert all(re.match(r"#|https://", href) for href in page.xpath("//a/@href"))
    assert not re.search(r"@import|url\(", page.xpath("string(//style)"))
    policy = page.xpath("string(//meta[@http-equiv='Content-Security-Policy']/@content)")
    assert policy.startswith("default-src 'none'; ") and "unsafe-eval" not in policy
    script = page.xpath("//script[not(@type)]")
    library = zlib.decompress(base64.b64decode(page.xpath("string(//script[@id='library'])")))
    assert len(script) == 1 and library.startswith(b"/**\n* plotly.js v")
    digests = [base64.b64encode(hashlib.sha256(s).digest()).decode() for s in (script[0].text.encode(), library)]
    assert re.findall(r"'sha256-(.*?)'", policy) == digests


def test_headings_and_contents_agree(page):
    heads = {h.get("id"): words(h) for h in page.xpath("//h2")}
    assert {a.get("href")[1:]: words(a) for a in page.xpath("//nav//a")} == heads and len(heads) == 14
    levels = [int(h.tag[1]) for h in page.xpath("//h1 | //h2 | //h3 | //h4")]
    assert levels[0] == 1 and levels.count(1) == 1 and all(b <= a + 1 for a, b in pairwise(levels))
    ids = page.xpath("//@id")
    assert len(ids) == len(set(ids))
    for box in page.xpath("//*[@tabindex='0']"):
        assert box.get("aria-label"), box.get("class")


def test_what_the_summary_says_first(page, result):
    best = result.sets[0]
    tiles = {words(t.xpath("dt")[0]): words(t.xpath("dd")[0]) for t in page.xpath("//dl[@class='tiles']/div")}
    assert tiles["Price of all 4 drives, at least"] == "510.92 EUR"  # four gearheads
    assert tiles["Mass of all 4 drives, at least"] == "828 g"  # of motor and gearhead 207 g, the rest unknown
    assert tiles["Smallest margin"] == "+2.0 %" and tiles["Energy per cycle"].endswith(" kJ")
    for part in (best.motor, best.gearhead, best.encoder, best.controller):
        assert part is not None and part.part in words(page.xpath("//table[contains(@class, 'parts')]")[0])


# -- text stays text


def test_hostile_text_is_shown_letter_by_letter(named_page):
    page = named_page
    seen = "".join(c if c.isprintable() else repr(c)[1:-1] for c in json.loads(json.dumps(NAME)))
    assert page.xpath("string(//h1)") == seen and "\\u202e" in seen
    assert page.xpath("string(//title)").startswith(seen)
    assert [s.get("type") for s in page.xpath("//script")] == ["application/json", "text/plain", None]
    ours = "self::img and ancestor::figure[contains(@class, 'still')] or ancestor::span[contains(@class, 'bar')]"
    assert page.xpath(f"(//img | //b)[not({ours})]") == []
    assert not [name for e in page.iter() if isinstance(e.tag, str) for name in e.attrib if name.startswith("on")]
    assert any(CASE in words(small) for small in page.xpath("//table[@id='checks']//small"))
    assert FAMILY in words(page.xpath("//table[contains(@class, 'parts')]")[0])
    labels = [words(button) for button in page.xpath("//*[@id='figure-cycle']//button")]
    assert labels == ["as specified", CASE, "weak"]


def test_no_text_of_a_figure_is_read_as_markup(named_page):
    """Whatever plotly draws as text has no angle bracket but those of our own hovers."""
    found = figures_of(named_page)
    drawn = [(t["name"], t.get("text"), t.get("customdata")) for plot in found.values() for t in plot["data"]]
    text = json.dumps([drawn, [plot["layout"] for plot in found.values()]], ensure_ascii=False)
    assert "&lt;img src=x onerror" in text and "&lt;a href='javascript:1'&gt;" in text
    assert set(re.findall(r"<[^>]*>?", text)) <= {"<br>"}
    assert plain("<b>&lt;") == "&lt;b&gt;&amp;lt;"


def test_only_an_address_of_the_web_becomes_a_link():
    parts = environment({}).get_template("blocks.html").module
    assert "<a " not in parts.linked("javascript:alert(1)") and "<a " not in parts.linked(" https://x.org")
    assert parts.linked('https://x.org/?a="><b>') == (
        '<a href="https://x.org/?a=&#34;&gt;&lt;b&gt;" rel="noopener noreferrer">https://x.org/?a=&#34;&gt;&lt;b&gt;</a>'
    )


# -- mathematics


def test_every_formula_is_mathematics_of_the_browser(page):
    for step in page.xpath("//article[@class='step']"):
        assert step.xpath("header//math")
    said = {words(math) for math in page.xpath("//math")}
    assert not [text for text in said if re.search(r"thin|sqrt|dot|\"|_|\^", text)]
    assert "Vnom=1.5" not in said and any(text.startswith("nnom=") and "208.9" in text for text in said)
    assert len(page.xpath("//article//math//mfrac")) > 20 and page.xpath("//article//math//msqrt")


# -- figures


def test_every_figure_has_its_place_and_every_place_its_figure(page):
    found = figures_of(page)
    assert sorted(found) == ["battery-1", "battery-2", "bode", "cycle", "demand", "energy", "field", "heat-1", "heat-2",
                             "loop", "profile", "sets-margin", "sets-price", "step-1", "step-2", "step-3"]  # fmt: skip
    assert sorted(d.get("data-plot") for d in page.xpath("//div[@class='drawing']")) == sorted(found)
    names = {*COLOURS, "ink", "page"}
    for plot in found.values():
        colours = re.findall(r'"(?:fill)?color": "(.*?)"', json.dumps(plot))
        assert set(colours) <= names  # the page has their values, in light and in dark
        for entry in plot["legend"]:
            assert entry["colour"] in names and entry["traces"]


# -- every kind of drive


def test_a_symbol_in_a_note_is_lowered_and_the_rest_escaped():
    assert (
        environment({}).filters["noted"]("F_N <b> & k_t^2")
        == "<var>F</var><sub>N</sub> &lt;b&gt; &amp; <var>k</var><sub>t</sub>^2"
    )
