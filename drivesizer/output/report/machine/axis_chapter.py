"""The chapter of one axis: its answer, then sections of a report of it alone, without what the machine has once."""

from __future__ import annotations

from collections.abc import Iterator

from drivesizer.output.parts import machine_parts
from drivesizer.output.report.machine.content import AxisContent
from drivesizer.output.report.sections import SECTIONS
from drivesizer.output.report.sections.assumptions import unknown_blocks
from drivesizer.output.report.sections.blocks import Block, Tiles, Verdict, Words
from drivesizer.output.report.sections.confidence import confidence_table
from drivesizer.output.report.sections.cycle import field_picture
from drivesizer.output.report.sections.part_lines import parts_table
from drivesizer.output.report.sections.section import Section
from drivesizer.output.report.sections.summary import OUTCOMES, change_blocks, outcome_texts, tiles
from drivesizer.units import show

__all__ = ["axis_sections", "opening"]

_ELSEWHERE = {  # sections of the report of one axis that the machine prints once, or that `--axis` alone prints
    "summary", "parts", "drive", "heat", "candidates", "specification", "pieces", "assumptions", "physics", "repeat",
    "file", "datasheets",
}  # fmt: skip


def opening(axis: AxisContent) -> Iterator[Block]:
    """The answer of an axis."""
    content = axis.content
    yield Verdict(bool(content.result.sets), [*outcome_texts(content)])
    if axis.sizing.carried:
        riding = ", ".join(f"{one.of} ({show(one.mass, 'g', 'mass')})" for one in axis.sizing.carried)
        yield Words(f"In its load are the drives of other axes: {riding}.")
    if content.drive is None:
        yield from change_blocks(content)
        return
    lines = axis.lines or machine_parts(content.drive, content.result.problem)
    yield parts_table(lines, content.motors, OUTCOMES[content.outcome])
    yield Tiles(tiles(content, lines))
    yield from change_blocks(content)
    yield confidence_table(content)
    yield field_picture(content)


def axis_sections(axis: AxisContent) -> Iterator[tuple[str, list[Block]]]:
    """Titles and blocks of its sections that have any."""
    left = _ELSEWHERE | (set() if axis.own_supply else {"braking"})
    left |= {"derivation"} if axis.content.result.method == "paper" else set()
    for section in (*(one for one in SECTIONS if one.name not in left), _UNKNOWN):
        blocks = [*section.blocks(axis.content)]
        if blocks:
            yield section.headed(axis.content), blocks


_UNKNOWN = Section(name="unknown", title="Unknown and unquoted figures", blocks=unknown_blocks)
