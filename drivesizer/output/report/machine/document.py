"""The document of a machine's report as plain data: chapters on all axes, and one for each axis."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from drivesizer.output.counted import number_of
from drivesizer.output.report.machine.axis_chapter import axis_sections, opening
from drivesizer.output.report.machine.chapters import BACK, FRONT, Chapter
from drivesizer.output.report.machine.content import AxisContent, MachineContent
from drivesizer.output.report.sections.blocks import Block, as_data
from drivesizer.output.report.sections.document import assembled

__all__ = ["document", "shown"]

_NAMED = ("picture", "table", "facts", "checks", "tablelink")  # blocks and marks of which every axis has one


def document(content: MachineContent, date: str | None = None) -> dict[str, Any]:
    """Everything that a report prints but its figures."""
    sizing = content.sizing
    sections = [*_chapters(content, FRONT), *(part for one in content.axes for part in _axis(one))]
    sections += _chapters(content, BACK)
    words = f"Machine of {number_of(len(content.axes), 'axis', 'axes')}: {', '.join(one.name for one in content.axes)}"
    return assembled(sizing.machine.name, words, content.title_block, sections, date, found=sizing.complete)


def shown(sections: Any) -> Iterator[str]:
    """Names of the figures that sections have a place for."""
    if isinstance(sections, dict):
        if sections.get("kind") == "picture":
            yield sections["name"]
        sections = [*sections.values()]
    if isinstance(sections, list | tuple):
        for one in sections:
            yield from shown(one)


def _chapters(content: MachineContent, chapters: Sequence[Chapter]) -> Iterator[dict[str, Any]]:
    for chapter in chapters:
        blocks = [*chapter.blocks(content)]
        if blocks:
            yield _section(chapter.name, chapter.title, blocks, appendix=chapter.appendix)


def _axis(one: AxisContent) -> Iterator[dict[str, Any]]:
    name = one.key.removesuffix("-")
    yield _keyed(_section(name, f"Axis {one.name}", [*opening(one)], new_page=True), one.key)
    for number, (title, blocks) in enumerate(axis_sections(one), 1):
        yield _keyed(_section(f"{name}_{number}", title, blocks, level=2), one.key)


def _section(
    name: str,
    title: str,
    blocks: Sequence[Block],
    *,
    level: int = 1,
    new_page: bool = False,
    appendix: bool = False,
) -> dict[str, Any]:
    return {"name": name, "title": title, "level": level, "new_page": new_page, "appendix": appendix,
            "blocks": as_data(blocks)}  # fmt: skip


def _keyed(value: Any, key: str) -> Any:
    """Plain data with the names of figures and tables behind the key of an axis."""
    if isinstance(value, dict):
        found = {name: _keyed(entry, key) for name, entry in value.items()}
        return found | {"name": f"{key}{value['name']}"} if value.get("kind") in _NAMED and value.get("name") else found
    return [_keyed(entry, key) for entry in value] if isinstance(value, list | tuple) else value
