"""Documents: what is said of a sizing, a machine or an explanation, built once for all media."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from drivesizer.output.document.candidates import every_list
from drivesizer.output.document.records import PAPER, Printed, Section, sections

__all__ = ["SECTIONS", "Chapter", "printed", "wide"]

SECTIONS = sections("axis")


class Chapter(NamedTuple):
    """Sections of an axis, or of a whole machine."""

    content: Any  # of one axis a ``Content``
    sections: Iterable[Section] = SECTIONS
    axis: str = ""  # before the names of its figures and tables; in wide media its name


def printed(chapters: Iterable[Chapter], media: frozenset[str] = PAPER) -> Iterator[Printed]:
    """Sections with blocks, of the drive that is reported where they are of a drive."""
    for content, of_chapter, axis in chapters:
        for section in of_chapter:
            if section.media in media and not (section.of_drive and content.drive is None):
                given = (content.of_drives, content.drive) if section.of_drive else (content,)
                blocks = [one for one in section.blocks(*given) if getattr(one, "media", "all") in media]
                if blocks:
                    yield Printed(section, section.headed(content), blocks, axis=axis)


def wide(chapters: Iterable[Chapter], media: frozenset[str]) -> Iterator[Printed]:
    """Sections for wide media: those of a drive of every drive, one after the other."""
    for content, of_chapter, axis in chapters:
        for section in of_chapter:
            if section.media in media and section.of_drive:
                for _, drive in every_list(content.result, front=False):
                    blocks = [*section.blocks(content.of_drives, drive)]
                    yield Printed(section, section.headed(content), blocks, drive.rank, axis)
            elif section.media in media:
                blocks = [*section.blocks(content)]
                if blocks:
                    yield Printed(section, section.headed(content), blocks, axis=axis)
