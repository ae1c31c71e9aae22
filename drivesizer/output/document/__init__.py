"""Documents: what is said of a sizing, a machine or an explanation, built once for all media."""

from __future__ import annotations

from collections.abc import Iterator

from drivesizer.output.document import appendix, at_work, candidates, machine, summary, worked
from drivesizer.output.document.content import Content, machine_words
from drivesizer.output.document.records import PAPER, Document, Printed, Section

__all__ = ["SECTIONS", "document", "printed", "wide"]

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
                    sections=[*printed(content)], found=bool(content.result.sets))  # fmt: skip
