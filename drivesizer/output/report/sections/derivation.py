"""The requirements of the load: the paper's equations with the numbers put in, or the figures of the load cycle."""

from __future__ import annotations

from collections.abc import Iterator

from drivesizer.output.derivation import step, symbol
from drivesizer.output.json.loops import number
from drivesizer.output.report.figures.load_and_loop import stretches
from drivesizer.output.report.lines.rows import requirement_row
from drivesizer.output.report.sections.blocks import Block, Column, Equation, Heading, Picture, Row, Table, Words
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.section import CsvRows, Section
from drivesizer.output.report.sections.sheet import Sheet, SheetColumn
from drivesizer.output.report.sections.sheets import NOTE, RANK, VALUES, ranked
from drivesizer.output.report.sections.texts import Math, Number
from drivesizer.results.requirement import Requirement

__all__ = ["DERIVATION"]


def _title(content: Content) -> str:
    return "Derivation" if content.result.method == "paper" else "Requirements of the load"


def _blocks(content: Content) -> Iterator[Block]:
    if content.result.method == "paper":
        yield from _equations(content)
    else:
        yield Words(_OF_WHEELS.format(wheel=content.wheel) if content.wheel else _OF_CYCLE.format(shaft=content.shaft))
        yield _table(content)
    cut = " The longest stretch without change is left out." if len(stretches(content.cycles)) > 1 else ""
    inertia = "The load's own inertia is in the torque."
    further = " Load cases beyond the fourth are shown when they are selected above." if len(content.cases) > 4 else ""
    if content.wheel:
        first = ", of the first eight" if len(content.cases) > 8 else ""
        caption = (
            f"Torque and speed of each driven wheel on the path{{}}; those of equal demand are shown as one. {inertia}"
        )
    else:
        first = ", in the first four load cases" if len(content.cases) > 4 else ""
        caption = f"Torque and speed of the {content.shaft} over the cycle, of one drive{{}}. {inertia}"
    yield Picture("cycle", caption.format(first) + cut, "torque and speed of the driven shaft over time",
                  about=_ABOUT_CYCLE[content.result.method], on_page=caption.format("") + further)  # fmt: skip


_ABOUT_CYCLE = {
    "paper": "is the cycle of one drive over time, as the checks by physics use it.",
    "physics": "shows the load cycle.",
}
_SOURCE = (
    "C. Prados Sesmero, L. R. Buonocore, M. Di Castro, Omnidirectional Robotic Platform for Surveillance of Particle "
    "Accelerator Environments with Limited Space Areas, Appl. Sci. 2021, 11, 6631"
)
_OF_WHEELS = (
    "The motion of the platform takes a torque at each of its wheels: where there are more torques than the motion "
    "needs, those of the least sum of squares. Each driven wheel is a load case, and the drive is sized for the worst "
    "of them; the worst is {wheel} by its RMS torque."
)
_OF_CYCLE = "Figures of the load cycle, segment by segment, at the {shaft}."


def _equations(content: Content) -> Iterator[Block]:
    yield Words((
        f"Equation numbers are those of {_SOURCE}. Where the printed form and the computed one differ, both are shown. "
        "Numbers are put in in SI units; results follow in customary units. The three factors that the paper calls ",
        Math("eta"), " are ", Math('eta_"v"'), " in (1), ", Math('eta_"R"'), " in (10) and ", Math('eta_"g"'),
        " in (17), (18).",
    ))  # fmt: skip
    yield Heading("The vehicle and its wheels")
    yield from map(_equation, content.result.requirements)
    if content.drive and content.drive.requirements:
        yield Heading("At the motor shaft")
        yield Words(f"For {content.drive.label}.")
        yield from map(_equation, content.drive.requirements)


def _equation(r: Requirement) -> Equation:
    return Equation(step(r) | {"exact": {"name": r.name, "value": number(r.shown)}})


def _table(content: Content) -> Table:
    found = content.result.requirements
    notes = "".join(f", {note}" for note in dict.fromkeys(r.note for r in found if r.note))
    rows = [Row((r.title, (Math(symbol(r.symbol)),), Number(r.text, number(r.shown), r.unit)), {"requirement": r.name})
            for r in found]  # fmt: skip
    columns = Column("", width=1.0), Column("", "math"), Column("", "number")
    return Table(f"The {content.shaft}, of one drive{notes}", columns, rows, look="figures", halves=True)


def _sheet(content: Content) -> list[Sheet]:
    """The requirements of the load, and with each drive those of its motor."""
    columns = (RANK, SheetColumn("requirement", "title"), SheetColumn("symbol", "symbol"),
               SheetColumn("equation", "equation", "count"), *VALUES, NOTE)  # fmt: skip
    motor = ranked(content, lambda drive: map(requirement_row, drive.requirements))
    return [Sheet(name="Requirements", columns=columns, note="without a drive: of the load; with one: of its motor",
                  still=2, rows=[*map(requirement_row, content.result.requirements), *motor])]  # fmt: skip


DERIVATION = Section(
    name="derivation", title=_title, blocks=_blocks, sheets=_sheet,
    csv=CsvRows(before=lambda content: map(requirement_row, content.result.requirements)),
)  # fmt: skip
