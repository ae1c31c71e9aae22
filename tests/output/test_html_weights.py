"""The choice by weights on the page: its figures are those of the drives, its first order that of the spec."""

from dataclasses import replace
from math import isnan, nan

import pytest
from html_reports import HOSTILE, parsed, with_choices
from lxml import html
from printed import blank_figures

from drivesizer.output.document.axes import content_of
from drivesizer.output.document.content import Content
from drivesizer.output.report.html.candidate_plots import weights_section
from drivesizer.output.report.html.page import report_html
from drivesizer.output.report.html.templates import section_html


def section(result):
    """The section alone, as a tree."""
    (text,) = section_html([weights_section(Content(result))], {}, {})
    return html.fromstring(f"<div>{text}</div>")


def words(element):
    return " ".join(element.text_content().split())


@pytest.fixture(scope="module")
def weighed(result):
    return with_choices(result)


@pytest.fixture(scope="module")
def page(weighed):
    return section(weighed)


def measured(text, unit):
    """In a unit, of which the text may have a thousand."""
    figure, _, own = text.partition(" ")
    return float(figure) * {unit: 1.0, f"k{unit}": 1000.0}[own]


def test_every_drive_is_there_with_its_figures(page, weighed):
    heads = [words(th) for th in page.xpath("//thead//th")]
    assert heads == ["place", "motor", "gearhead", "mass", "price", "energy per cycle", "smallest margin", "score",
                     "best by"]  # fmt: skip
    rows = {int(tr.get("data-row")): [words(cell) for cell in tr] for tr in page.xpath("//tbody/tr")}
    assert sorted(rows) == [*range(30)]
    for n, one in enumerate(weighed.choices.drives):
        cells, figures = rows[n], one.figures
        assert cells[1] == (f"{HOSTILE} M3" if n == 3 else f"F M{n}")
        assert measured(cells[3], "g") == pytest.approx(1e3 * figures["mass"], rel=5.1e-4)
        assert cells[4] == ("unknown" if isnan(figures["price"]) else f"{figures['price']:.2f} EUR")
        assert measured(cells[5], "J") == pytest.approx(figures["energy"], rel=5.1e-4)
        assert float(cells[6].removesuffix(" %").replace("−", "-")) == pytest.approx(100 * figures["margin"], abs=0.51)
    assert not page.xpath("//script[not(@type)]")


def test_the_first_order_is_that_of_the_spec(page, weighed):
    masses = [one.figures["mass"] for one in weighed.choices.drives]
    order = [int(tr.get("data-row")) for tr in page.xpath("//tbody/tr")]
    assert order == sorted(range(30), key=masses.__getitem__)
    assert [words(td) for td in page.xpath("//tbody/tr/td[1]")] == [str(n) for n in range(1, 31)]
    scores = [float(words(td)) for td in page.xpath("//td[contains(@class, 'score')]")]
    assert scores == pytest.approx([masses[n] / min(masses) for n in order], abs=5.1e-4)
    assert words(page.xpath("//tbody/tr[1]/td[last()]")[0]) == "weightsspec"
    assert len(page.xpath("//tbody//*[contains(@class, 'pill')]")) == 2


def changed(result, **figures):
    """The same with other figures, each a function of the drive's number."""
    choices = result.choices
    drives = tuple(
        replace(one, figures=one.figures | {name: of(n) for name, of in figures.items()})
        for n, one in enumerate(choices.drives)
    )
    return replace(result, choices=replace(choices, drives=drives))


def test_a_figure_that_is_unknown_or_the_same_of_all_has_no_weight(weighed):
    page = section(changed(weighed, price=lambda n: nan, margin=lambda n: 0.25))
    assert page.xpath("//*[@class='weight']/@data-name") == ["mass", "energy"]
    assert "Without a weight: price is unknown of all; smallest margin is the same, +25 %." in words(page)
    assert "go below all others" not in words(page)
    alike = dict.fromkeys(("mass", "price", "energy", "margin"), lambda n: 1.0)
    assert weights_section(Content(changed(weighed, **alike))) is None


def test_it_follows_the_candidates_and_is_missing_without_drives(result, weighed):
    with blank_figures():
        page, without = (parsed(report_html(content_of(one))) for one in (weighed, result))
    names = page.xpath("//h2/@id")
    assert names[names.index("candidates") + 1] == "weights"
    assert "Choose by weights" in words(page.xpath("//nav")[0])
    assert page.xpath("//h1 | //h2 | //h3")[0].tag == "h1" and not without.xpath("//*[@id='weights']")
