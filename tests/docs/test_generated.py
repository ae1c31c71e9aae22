"""Generated parts of the pages are what the program says now, and every figure of a page is there."""

from __future__ import annotations

import re

import pytest
from docs_pages import DOCS

pytest.importorskip("mathematics", reason="the documentation's own packages are not installed")

import generate

PARTS = {
    (path, name)
    for path in DOCS.rglob("*.md")
    for name in re.findall(r"^<!-- generated: (\w+) -->$", path.read_text(encoding="utf-8"), re.MULTILINE)
}
FAST = sorted((path.stem, path) for path, name in PARTS if name != "sensitivities")


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


def test_nothing_but_the_part_between_its_marks_is_written(monkeypatch):
    monkeypatch.setattr(generate, "made", lambda name: f"new {name}")
    page = "by hand\n\n<!-- generated: spec -->\nold\n<!-- end: spec -->\n\nby hand\n"
    assert generate.renewed(page) == page.replace("\nold\n", "\n\nnew spec\n\n")
