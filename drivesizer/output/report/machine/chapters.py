"""Chapters of a machine's report on all axes: their loads side by side, who carries whom, assumptions, the appendix."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

from drivesizer.output.part.datasheet import datasheets
from drivesizer.output.probability import moved
from drivesizer.output.report.lines.drive import figure_row
from drivesizer.output.report.lines.reliability import check_cells
from drivesizer.output.report.machine.content import MachineContent
from drivesizer.output.report.machine.loops import loop_blocks
from drivesizer.output.report.machine.summary import summary_blocks
from drivesizer.output.report.sections.appendix import repeat_blocks
from drivesizer.output.report.sections.blocks import (
    Block,
    Bullets,
    Column,
    Facts,
    Pair,
    Picture,
    Row,
    Table,
    Words,
)
from drivesizer.output.report.sections.machine import consumers
from drivesizer.output.report.sections.parts import sheet_blocks
from drivesizer.output.report.sections.texts import Code, Strong
from drivesizer.output.several_axes import Branch, mass_tree, sampled_text
from drivesizer.results.braking import BrakingBudget
from drivesizer.results.energy import EnergyBudget
from drivesizer.results.machine import AxisSizing, CarriedMass
from drivesizer.results.machine_power import MachinePower
from drivesizer.results.reliability import Reliability
from drivesizer.units import show

__all__ = ["BACK", "FRONT", "Chapter", "assumptions", "warnings"]


class Chapter(NamedTuple):
    """A chapter by its name, which is also its address on the page."""

    name: str
    title: str
    blocks: Callable[[MachineContent], Iterable[Block]]
    appendix: bool = False
    level: int = 1


# -- loads


def _loads(content: MachineContent) -> Iterator[Block]:
    cases = any(len(one.content.cycles) > 1 for one in content.axes)
    first = " Of several load cases the first is drawn." if cases else ""
    lacking = [one.name for one in content.axes if one.sizing.best is None and one.content.drive]
    missed = f" Of {', '.join(lacking)} it is the closest rejected drive." if lacking else ""
    names = [*content.loads]
    for name in names:
        caption = (f"Torque and speed of the motor of each axis, its rotor's acceleration included; below 0 it brakes. "
                   f"The shaded field is allowed continuously.{first}{missed}")  # fmt: skip
        about = "sets the load of each axis against the limits of its motor." if name == names[0] else ""
        last = caption if name == names[-1] else "Continued below."
        yield Picture(name, last, "torque-speed field of each axis with its cycle", about)


# -- power


def _power(content: MachineContent) -> Iterator[Block]:
    power = content.sizing.power
    if power is None:
        return
    if power.unknown:
        yield Bullets("Of some axes the power is unknown, and with it the sum:", list(power.unknown), "alarm")
    together = "" if power.synchronised else " Every axis starts at any time; here all their peaks fall together."
    case = f" Load case {power.case}." if power.case else ""
    stacked = "Power at the controllers of all axes, stacked: above 0 what each draws, below what each returns."
    moved = "Pointed at, an axis has what it draws less what it returns."
    yield Picture("power", f"{stacked} The black line is what the source gives.{case}{together}",
                  "power of every axis over time", about="shows the power over the machine's cycle.",
                  on_page=f"{stacked} The line is what the source gives. {moved}{case}{together}")  # fmt: skip
    yield Facts("All axes on one supply", [*map(figure_row, power.figures)], "machine_figures", halves=True)
    if power.exceeded:
        yield _exceeded(power)
    if power.braking:
        of = f" with brake resistor {power.braking.name}" if power.braking.name else ""
        yield Facts(f"What is regenerated, stored and burnt{of}", [*map(figure_row, power.braking.figures)])
    if power.energy:
        yield Pair([consumers(power.energy)], [Facts("The battery", [*map(figure_row, power.energy.figures)])])
    if power.reliability:
        yield from _over_tolerances(power.reliability)
    yield Bullets("Assumptions:", list(_once((power, power.braking, power.energy))))


def _over_tolerances(found: Reliability) -> Iterator[Block]:
    """Limits of the supply over samples of all uncertain figures."""
    said = sampled_text(found)
    yield Words((f"{said[0].upper()}{said[1:]}.",))
    heads = [Column(name, "number") for name in ("passes", "margin 5 %", "50 %", "95 %")]
    rows = [Row(check_cells(one)) for one in moved(found)]
    if rows:
        caption = "Limits of the supply that samples change: share that passes, and quantiles of the margin"
        yield Table(caption, [Column("check", "name", 1.0), *heads], rows, "supply-checks", "probability")
    columns = [Column("figure", "name", 1.0), *(Column(f"{q} %", "number") for q in (5, 50, 95))]
    figures = [Row([one.title, *one.texts]) for one in found.figures]
    yield Table("All axes over the samples: percentiles", columns, figures, "supply-figures", "probability")


def _exceeded(power: MachinePower) -> Table:
    """Share of the time in which axes at random phases exceed a limit of the supply."""
    columns = (
        Column("limit of the supply", "name", 1.0),
        Column("power", "number"),
        Column("share of the time", "number"),
    )
    titles = {check.name: check.title for check in power.checks}
    rows = [Row((titles.get(one.check, one.check), show(one.limit, "W", "power"),
                 f"{show(one.least, '%', 'dimensionless')} to {show(one.most, '%', 'dimensionless')}"))
            for one in power.exceeded]  # fmt: skip
    return Table("Share of the time in which axes at random phases draw more than the supply gives", columns, rows)


def _once(records: Iterable[MachinePower | BrakingBudget | EnergyBudget | None]) -> dict[str, None]:
    return dict.fromkeys(text for record in records if record for text in record.assumptions)


# -- who carries whom


def _carried(content: MachineContent) -> Iterator[Block]:
    sizing = content.sizing
    if not any(one.carried for one in sizing.axes):
        return
    rows = [_branch_row(branch, sizing.axis(branch.name), sizing.axis(branch.on) if branch.on else None)
            for branch in mass_tree(sizing.machine) if branch.on or sizing.axis(branch.name).carried]  # fmt: skip
    turning = any(one.distance is not None for axis in sizing.axes for one in axis.carried)
    columns = (Column("axis", "name", 0.8), Column("drive", width=1.2), Column("drives on the axis above", "number"),
               *([Column("at", "number")] if turning else []), Column("all drives on it", "number"))  # fmt: skip
    caption = "Each axis below the one that carries its drives; masses are in the load of the carrying axis"
    shown = [Row(row if turning else (*row[:3], *row[4:])) for row in rows]
    yield Table(caption, columns, shown, "riding", "wide carried")
    yield Words("Controllers stay in the cabinet: they are in no carried mass. An estimated mass counts at the upper "
                "end of its band.", "note")  # fmt: skip


def _branch_row(branch: Branch, axis: AxisSizing, above: AxisSizing | None) -> tuple[str, ...]:
    """Name, drive, own mass, distance, and mass on it."""
    found = next((one for one in above.carried if one.of == branch.name), None) if above else None
    indent = f"└{'──' * (branch.depth - 1)} " if branch.depth else ""
    drive = axis.best.label if axis.best else "none"
    distance = "" if found is None or found.distance is None else show(found.distance, "mm", "length")
    on_it = show(axis.carried_mass, "g", "mass") if axis.carried else ""
    return indent + branch.name, drive, _mass(found), distance, on_it


def _mass(found: CarriedMass | None) -> str:
    if found is None:
        return ""
    return f"{'at least ' if found.lacking else ''}{show(found.mass, 'g', 'mass')}"


# -- assumptions


def assumptions(content: MachineContent) -> list[str]:
    """Assumptions of the sizing: those of all axes once, those of some with their names."""
    return _with_axes(content, [(one.name, one.content.result.assumptions) for one in content.axes])


def warnings(content: MachineContent) -> list[str]:
    """Warnings, as the assumptions."""
    return _with_axes(content, [(one.name, one.content.result.warnings) for one in content.axes])


def _with_axes(content: MachineContent, given: Iterable[tuple[str, tuple[str, ...]]]) -> list[str]:
    found: dict[str, list[str]] = {}
    for name, texts in given:
        for text in texts:
            found.setdefault(text, []).append(name)
    whole = len(content.axes)
    return [text if len(names) == whole else f"{', '.join(names)}: {text}" for text, names in found.items()]


def _assumptions(content: MachineContent) -> Iterator[Block]:
    if assumptions(content):
        yield Bullets("Assumptions of the sizing:", assumptions(content))
    if warnings(content):
        yield Bullets((Strong("Warnings:"),), warnings(content), "alarm")


# -- appendix


def _repeat(content: MachineContent) -> Iterator[Block]:
    sizing = content.sizing
    yield Words(("A report of one axis, with its candidates and its heat: ",
                 Code(f"drivesizer report {content.file} --axis NAME -o axis.pdf"), "."))  # fmt: skip
    yield from repeat_blocks(content.catalogs, content.method, sizing.objective, content.file, sizing.machine.text)


def _datasheets(content: MachineContent) -> Iterator[Block]:
    """Every part once, however many axes have it."""
    sheets = [sheet for one in content.axes if one.content.drive
              for sheet in datasheets(one.content.drive, one.content.result.catalog)]  # fmt: skip
    if sheets:
        yield from sheet_blocks([sheet for n, sheet in enumerate(sheets) if sheet not in sheets[:n]])


FRONT = (
    Chapter("summary", "Summary", summary_blocks),
    Chapter("loads", "Loads of the axes", _loads),
    Chapter("supply", "Power of all axes", _power),
    Chapter("carried", "Carried drives", _carried),
    Chapter("loops", "Closed loops of the axes", loop_blocks),
)
BACK = (
    Chapter("assumptions", "Assumptions", _assumptions),
    Chapter("repeat", "How to repeat this", _repeat, appendix=True),
    Chapter("datasheets", "Data sheets", _datasheets, appendix=True),
)
