"""Documents: what is said of a sizing, a machine or an explanation, built once for all media."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from drivesizer.output.document import appendix, at_work, candidates, machine, summary, worked
from drivesizer.output.document.records import PAPER, Printed, Section

__all__ = ["SECTIONS", "Chapter", "printed", "wide"]

SECTIONS: tuple[Section, ...] = (  # what to buy, whether it holds, how close others come, why; then what it rests on
    summary.summary,
    summary.glance,
    summary.changes,
    summary.grounds,
    at_work.field,
    summary.required,
    candidates.alternatives,
    candidates.front,
    candidates.probabilities,
    summary.drive,
    summary.checks,
    summary.estimates,
    at_work.cycle,
    at_work.cycle_pictures,
    at_work.heat,
    at_work.energy,
    at_work.pieces,
    candidates.reliability,
    candidates.uncertain,
    machine.machine,
    machine.permitted,
    machine.followed,
    machine.battery_picture,
    machine.battery,
    machine.braking,
    at_work.loop,
    at_work.loop_details,
    at_work.linear_loops,
    candidates.ranking,
    candidates.candidates,
    candidates.screws,
    candidates.rejected,
    appendix.specification,
    at_work.derivation,
    worked.with_numbers,
    summary.assumptions,
    summary.physics,
    machine.kinematics_and_dynamics,
    appendix.repeat,
    appendix.figures_of_parts,
    appendix.data_sheets,
)


class Chapter(NamedTuple):
    """Sections of an axis, or of a whole machine."""

    content: Any  # of one axis a ``Content``
    sections: Iterable[Section] = SECTIONS
    axis: str = ""  # before the names of its figures and tables; in wide media its name


def printed(chapters: Iterable[Chapter], media: frozenset[str] = PAPER) -> Iterator[Printed]:
    """Sections with blocks, of the drive that is reported where they are of a drive."""
    for content, sections, axis in chapters:
        for section in sections:
            if section.media in media and not (section.of_drive and content.drive is None):
                given = (content.of_drives, content.drive) if section.of_drive else (content,)
                blocks = [one for one in section.blocks(*given) if getattr(one, "media", "all") in media]
                if blocks:
                    yield Printed(section, section.headed(content), blocks, axis=axis)


def wide(chapters: Iterable[Chapter], media: frozenset[str]) -> Iterator[Printed]:
    """Sections for wide media: those of a drive of every drive, one after the other."""
    for content, sections, axis in chapters:
        for section in sections:
            if section.media in media and section.of_drive:
                for _, drive in candidates.every_list(content.result, front=False):
                    blocks = [*section.blocks(content.of_drives, drive)]
                    yield Printed(section, section.headed(content), blocks, drive.rank, axis)
            elif section.media in media:
                blocks = [*section.blocks(content)]
                if blocks:
                    yield Printed(section, section.headed(content), blocks, axis=axis)
