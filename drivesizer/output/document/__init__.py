"""Documents: what is said of a sizing, a machine or an explanation, built once for all media."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import nan
from typing import Any, NamedTuple

from drivesizer.output.document.candidates import every_list
from drivesizer.output.document.records import PAPER, Printed, Section, sections

__all__ = ["SECTIONS", "Chapter", "printed"]

SECTIONS = sections("axis")


class Chapter(NamedTuple):
    """Sections of an axis, or of a whole machine."""

    content: Any  # of one axis a ``Content``
    sections: Iterable[Section] = SECTIONS
    axis: str = ""  # before the names of its figures and tables; in wide media its name


def printed(
    chapters: Iterable[Chapter], media: frozenset[str] = PAPER, *, of_all_drives: bool = False
) -> Iterator[Printed]:
    """Sections with blocks: those of a drive are of the drive that is reported, or of every drive after the other."""
    for content, of_chapter, axis in chapters:
        for section in of_chapter:
            drives: list[Any] = [None]
            if section.of_drive and of_all_drives:
                drives = [drive for _, drive in every_list(content.result, front=False)]
            elif section.of_drive:
                drives = [content.drive] if content.drive else []
            for drive in drives if section.media in media else ():
                arguments = (content.of_drives, drive) if section.of_drive else (content,)
                blocks = [block for block in section.blocks(*arguments) if getattr(block, "media", "all") in media]
                if blocks:
                    rank = drive.rank if section.of_drive and of_all_drives else nan
                    yield Printed(section, section.headed(content), blocks, rank, axis)
