"""Generated parts of the pages are what the program says now, and every figure of a page is there."""

from __future__ import annotations

import re

import pytest
from docs_pages import DOCS

from drivesizer import catalog
from drivesizer.catalog.parts import DIRECT

pytest.importorskip("mathematics", reason="the documentation's own packages are not installed")

import catalog_page
import generate

figures = pytest.importorskip("figures")

PARTS = {
    (path, name)
    for path in generate.PAGES
    for name in re.findall(r"<!-- (?:generated|count): (\w+) -->", path.read_text(encoding="utf-8"))
}
PARTS_OF = {
    "motor": "motors", "gearhead": "gearheads", "actuator": "actuators", "encoder": "encoders", "belt": "belts",
    "pulley": "pulleys", "controller": "controllers", "holding brake": "brakes", "brake": "brakes",
}  # fmt: skip
FAST = sorted((path.stem, path) for path, name in PARTS if name not in {"sensitivities", "licences"})


def test_every_part_is_on_a_page():
    assert {name for _, name in PARTS} == set(generate.PARTS)


@pytest.mark.parametrize("path", dict(FAST).values(), ids=dict(FAST))
def test_a_generated_page_is_what_the_program_says(path):
    """After a change: python docs/generate.py."""
    page = path.read_text(encoding="utf-8")
    assert generate.renewed(page) == page


@pytest.mark.slow
def test_the_table_of_misjudged_figures_is_what_the_program_says():
    """Sixteen runs along the paper's path."""
    page = (DOCS / "platform.md").read_text(encoding="utf-8")
    assert generate.renewed(page) == page


def test_what_ships_is_counted(monkeypatch):
    """Of two catalogues, by hand: direct drive is no gearhead."""
    folder = DOCS.parent / "catalogs"
    assert generate.made("makers") == str(len(list(folder.glob("*.yaml"))))
    two = {name: folder / f"{name}.yaml" for name in ("andymark", "yaskawa")}
    monkeypatch.setattr(catalog, "shipped", lambda: two)
    monkeypatch.setattr(catalog_page, "_counts", catalog_page._counts.__wrapped__)
    assert (generate.made("actuators"), generate.made("combinations"), generate.made("makers")) == ("0", "13", "2")
    rows = dict(line.strip("| ").split(" | ", 1) for line in generate.made("shipped").splitlines()[2:])
    assert rows["motors"] == "79 | Yaskawa 74, AndyMark 5" and rows["gearheads"] == "13 | Yaskawa 13"
    assert (rows["belts"], rows["pulleys"]) == ("89 | AndyMark 89", "8 | AndyMark 8")
    assert rows["listed combinations of motor and gearhead"] == "13 | Yaskawa 13"


def test_the_head_of_a_catalogue_counts_its_parts():
    """Where it says ``240 motors, 644 gearheads``."""
    said, kinds = 0, "|".join(PARTS_OF)
    for name, path in catalog.shipped().items():
        head = path.read_text(encoding="utf-8").splitlines()[0]
        for number, kind in re.findall(rf"(?<!of )\b(\d+) ({kinds})s?\b", head):
            table = catalog.load([name]).table(PARTS_OF[kind])
            assert int(number) == (table["part"] != DIRECT).sum(), (name, number, kind)
            said += 1
    assert said > 40


# --- figures


def linked():
    """Pictures of all pages and of the README, as paths."""
    pages = [*DOCS.rglob("*.md"), DOCS.parent / "README.md"]
    return {
        (path.parent / target).resolve()
        for path in pages
        for target in re.findall(r"!\[[^\]]*\]\(([^)#]+)\)", path.read_text(encoding="utf-8"))
    }


def test_every_picture_of_a_page_is_there_and_every_figure_on_a_page():
    drawn = set((DOCS / "figures").glob("*.svg"))
    assert linked() == drawn | set((DOCS / "assets").glob("*.png"))  # drawn, and photographed
    made = {path.stem for path in drawn if not path.stem.startswith("measured-")}
    assert made == set(figures.FIGURES)


@pytest.mark.slow
@pytest.mark.parametrize("name", figures.FIGURES)
def test_a_figure_says_what_the_program_says_now(name):
    """After a change: python docs/generate.py figures. Lines depend on matplotlib's version, words on the program."""
    committed = (DOCS / "figures" / f"{name}.svg").read_text(encoding="utf-8")
    now = figures.drawn(name)
    assert now == figures.drawn(name)
    said = r'viewBox="[^"]*"|<text[^>]*>[^<]*'
    assert re.findall(said, now) == re.findall(said, committed)
