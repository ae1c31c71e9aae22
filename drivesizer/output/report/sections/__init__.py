"""The sections of a report in their order: the one list that PDF, HTML, XLSX and CSV print, and it as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from drivesizer.output.derivation import cleaned, short
from drivesizer.output.report.lines.rows import machine_words
from drivesizer.output.report.sections.appendix import REPEAT, SPEC_FILE, SPECIFICATION
from drivesizer.output.report.sections.candidates import CANDIDATES, RELIABILITY
from drivesizer.output.report.sections.cycle import CYCLE, DERIVATION, ENERGY, HEAT, LINEAR_LOOPS, LOOP, PIECES
from drivesizer.output.report.sections.machine import (
    BATTERY,
    BRAKING,
    DATA_SHEETS,
    FOLLOWED,
    MACHINE,
    PARTS,
    PERMITTED,
    PLATFORM_NUMBERS,
    REQUIRED,
)
from drivesizer.output.report.sections.section import Content, as_data
from drivesizer.output.report.sections.summary import ASSUMPTIONS, CHANGES, CHECKS, DRIVE, ESTIMATES, PHYSICS, SUMMARY
from drivesizer.version import __version__

__all__ = ["SECTIONS", "assembled", "document"]


SECTIONS = (  # what to buy, whether it holds, how close others come, why; then what it rests on
    SUMMARY,
    REQUIRED,
    PARTS,
    DRIVE,
    CHECKS,
    CHANGES,
    ESTIMATES,
    CYCLE,
    HEAT,
    ENERGY,
    RELIABILITY,
    MACHINE,
    PERMITTED,
    FOLLOWED,
    BATTERY,
    BRAKING,
    LOOP,
    LINEAR_LOOPS,
    CANDIDATES,
    SPECIFICATION,
    DERIVATION,
    PIECES,
    ASSUMPTIONS,
    PHYSICS,
    PLATFORM_NUMBERS,
    REPEAT,
    SPEC_FILE,
    DATA_SHEETS,
)


# -- The sections of a report as plain data for the templates of PDF and HTML.
#
# Its texts are printed as strings, so that no text of a spec or a catalogue is ever read as markup.


_MOST_LISTED = 40  # sections of a table of contents on half a page


def _header(name: str, block: Sequence[tuple[str, str]]) -> str:
    """The machine's name, and the project with its revision where they are given."""
    given = dict(block)
    revision = f"revision {given['Revision']}" if "Revision" in given else ""
    return ", ".join(filter(None, (name, given.get("Project", ""), revision)))


def document(content: Content, date: str | None = None) -> dict[str, Any]:
    """Everything that a report prints but its figures."""
    result = content.result
    printed = [(section, [*section.blocks(content)]) for section in SECTIONS]
    sections = [
        {"name": section.name, "title": section.headed(content), "level": section.level, "new_page": section.new_page,
         "appendix": section.appendix, "blocks": as_data(blocks)} for section, blocks in printed if blocks
    ]  # fmt: skip
    name, words = result.spec.name, machine_words(result.spec)
    return assembled(name, words, content.title_block, sections, date, found=bool(result.sets))


def assembled(
    name: str,
    machine: str,
    block: Sequence[tuple[str, str]],
    sections: Sequence[dict[str, Any]],
    date: str | None,
    *,
    found: bool,
) -> dict[str, Any]:
    """The document of a report out of its sections."""
    made: dict[str, Any] = cleaned({
        "name": name, "header": short(_header(name, block)), "block": block, "machine": machine,
        "version": __version__, "date": short(date or "", 40), "found": found, "sections": sections,
        "depth": 2 if len(sections) <= _MOST_LISTED else 1,
    })  # fmt: skip
    return made
