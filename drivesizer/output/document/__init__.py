"""Documents: what is said of a sizing, a machine or an explanation, built once for all media."""

from __future__ import annotations

from collections.abc import Iterator

from drivesizer.output.document import appendix, at_work, candidates, machine, summary, worked
from drivesizer.output.document.content import Content, machine_words
from drivesizer.output.document.records import PAPER, Document, Printed, Section

__all__ = ["SECTIONS", "document", "printed", "wide"]

SECTIONS: tuple[Section, ...] = (  # what to buy, whether it holds, how close others come, why; then what it rests on
    summary.SUMMARY,
    summary.GLANCE,
    summary.CHANGES,
    summary.CONFIDENCE,
    at_work.FIELD,
    summary.REQUIRED,
    candidates.ALTERNATIVES,
    candidates.FRONT,
    candidates.PROBABILITIES,
    summary.DRIVE,
    summary.CHECKS,
    summary.ESTIMATES,
    at_work.CYCLE,
    at_work.CYCLE_PICTURES,
    at_work.HEAT,
    at_work.ENERGY,
    at_work.PIECES,
    candidates.RELIABILITY,
    candidates.UNCERTAIN,
    machine.MACHINE,
    machine.PERMITTED,
    machine.FOLLOWED,
    machine.BATTERY_PICTURE,
    machine.BATTERY,
    machine.BRAKING,
    at_work.LOOP,
    at_work.LOOP_DETAILS,
    at_work.LINEAR_LOOPS,
    candidates.RANKING,
    candidates.CANDIDATES,
    candidates.SCREWS,
    candidates.REJECTED,
    appendix.SPECIFICATION,
    at_work.DERIVATION,
    worked.WORKED,
    summary.ASSUMPTIONS,
    summary.PHYSICS,
    machine.PLATFORM_NUMBERS,
    appendix.REPEAT,
    appendix.FIGURES_OF_PARTS,
    appendix.DATA_SHEETS,
)


def printed(
    content: Content, sections: tuple[Section, ...] = SECTIONS, media: frozenset[str] = PAPER
) -> Iterator[Printed]:
    """Sections with blocks, of the drive that is reported where they are of a drive."""
    for section in sections:
        if section.media in media and not (section.of_drive and content.drive is None):
            given = (content.of_drives, content.drive) if section.of_drive else (content,)
            blocks = [one for one in section.blocks(*given) if getattr(one, "media", "all") in media]
            if blocks:
                yield Printed(section, section.headed(content), blocks)


def wide(content: Content, media: frozenset[str], axis: str = "") -> Iterator[Printed]:
    """Sections for wide media: those of a drive of every drive, one after the other."""
    drives = [one for _, one in candidates.every_list(content.result, front=False)]
    for section in SECTIONS:
        if section.media not in media:
            continue
        title = section.headed(content)
        if section.of_drive:
            for drive in drives:
                yield Printed(section, title, [*section.blocks(content.of_drives, drive)], drive.rank, axis)
        else:
            yield Printed(section, title, [*section.blocks(content)], axis=axis)


def document(content: Content) -> Document:
    """Everything that a report prints on paper but its figures."""
    spec = content.result.spec
    return Document(name=spec.name, machine=machine_words(spec), block=content.title_block,
                    sections=[*printed(content)],
                    found=bool(content.result.sets))  # fmt: skip
