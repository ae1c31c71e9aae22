"""The report of a machine of several axes: what all of them are, then a chapter for each out of the sections of one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import inf, isnan
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.validation import Validation
from drivesizer.output.part import datasheets
from drivesizer.output.parts import (
    LEAST,
    PartLine,
    SharedLine,
    Total,
    machine_parts,
    machine_parts_of_axes,
    parts_by_axis,
    totals,
    totals_of_axes,
)
from drivesizer.output.report.csv import encoded, timeseries_csv
from drivesizer.output.report.figures.field import Panel, panels, torque_speed_panels
from drivesizer.output.report.figures.machine import axes_power
from drivesizer.output.report.figures.style import Drawing
from drivesizer.output.report.lines.rows import (
    COLUMNS,
    Row,
    check_cells,
    check_texts,
    closed_loop_rows,
    driven_over,
    figure_texts,
    tight_of,
)
from drivesizer.output.report.sections import SECTIONS, assembled
from drivesizer.output.report.sections.appendix import repeat_blocks
from drivesizer.output.report.sections.cycle import LOOP_COLUMNS, field_picture, time_series
from drivesizer.output.report.sections.machine import consumers, sheet_blocks
from drivesizer.output.report.sections.section import (
    Block,
    Bullets,
    Checks,
    Code,
    Column,
    Content,
    Facts,
    Pair,
    Picture,
    Section,
    Sheet,
    SheetColumn,
    Strong,
    Table,
    Text,
    Tiles,
    Verdict,
    Words,
    as_data,
)
from drivesizer.output.report.sections.section import (
    Row as Cells,
)
from drivesizer.output.report.sections.section import (
    Status as StatusMark,
)
from drivesizer.output.report.sections.summary import (
    OUTCOMES,
    change_blocks,
    check_line,
    confidence_table,
    outcome_texts,
    parts_table,
    shared_parts_table,
    summed_tile,
    tiles,
    total_of,
    unknown_blocks,
)
from drivesizer.output.several_axes import Branch, choice_text, mass_tree, sampled_text, supply_texts
from drivesizer.output.words import moved, number_of
from drivesizer.results.check import Reliability, Status, gravest, tightest, worst
from drivesizer.results.drive_set import BrakingBudget, EnergyBudget
from drivesizer.results.machine import AxisSizing, CarriedMass, MachinePower, MachineSizing
from drivesizer.results.sizing import objective_figure
from drivesizer.units import show

__all__ = [
    "AxisContent", "MachineContent", "assumptions", "document", "drive_name", "loop_files", "loop_sheet",
    "loop_summary", "notes", "power_columns", "shown", "time_series_sheets", "verdict_text", "warnings",
]  # fmt: skip


# -- Power of all axes over time as columns of a table.


_PIECES = 2000  # finer than a screen


def power_columns(power: MachinePower) -> dict[str, tuple[NDArray[np.float64], str, str]]:
    """Mean powers, each from its time to that of the next row; the last row repeats them at the end."""
    course = power.course(_PIECES)
    rows = {f"{name} drawn": values for name, values in zip(power.axes, course.drawn, strict=True)}
    rows |= {f"{name} returned": values for name, values in zip(power.axes, course.returned, strict=True)}
    rows |= {"out of the source": course.total, "left": course.left}
    held = {name: (np.append(values, values[-1:]), "power", "W") for name, values in rows.items()}
    return {"time": (course.time, "time", "s"), **held}


# -- Content of a machine's report: its sizing, the content and closed loop of each axis, its parts, its figures.


_FIELDS = 6  # of axes in one figure, which leaves room for a heading on its page


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisContent:
    """An axis, with what a report of it alone would print."""

    key: str  # before the names of its figures and tables, which every axis has
    sizing: AxisSizing
    content: Content
    lines: list[PartLine]  # parts that are bought
    own_supply: bool  # whether what it regenerates is its own affair

    @property
    def name(self) -> str:
        """Name in the file."""
        return self.sizing.name

    @property
    def status(self) -> Status:
        """Verdict of its drive; a fail without one."""
        return self.sizing.best.status if self.sizing.best else "fail"


@dataclass(frozen=True)
class MachineContent:
    """A sizing of a machine; each part that takes time is computed once, when it is used."""

    sizing: MachineSizing
    proofs: Mapping[str, Validation] = field(default_factory=dict)  # closed loops, by the name of the axis

    @property
    def status(self) -> Status:
        """The gravest of the machine's verdict and those of all closed loops."""
        return gravest([self.sizing.status, *(proof.status for proof in self.proofs.values())])

    @cached_property
    def axes(self) -> list[AxisContent]:
        """Every axis, in the order of the file."""
        lines = parts_by_axis(self.sizing)
        alone = [  # without the front, which served the choice
            Content(replace(one.result, front=(), pareto=()), self.proofs.get(one.name)) for one in self.sizing.axes
        ]
        return [
            AxisContent(key=f"axis{number}-", sizing=one, content=content, lines=lines[one.name], own_supply=own)
            for number, (one, content, own) in enumerate(
                zip(self.sizing.axes, alone, self._own_supplies, strict=True), 1
            )
        ]

    @property
    def _own_supplies(self) -> list[bool]:
        axes = self.sizing.machine.axes
        return [len(axes) == 1 or axis.own_supply for axis in axes]

    @cached_property
    def bought(self) -> list[SharedLine]:
        """The parts list of all axes."""
        return machine_parts_of_axes(self.sizing)

    @cached_property
    def totals(self) -> list[Total]:
        """Mass and price of all parts."""
        return totals_of_axes(self.bought)

    @property
    def drives(self) -> int:
        """Drives of all axes that have one."""
        return sum(one.drives for one in self.sizing.axes if one.best)

    @property
    def title_block(self) -> list[tuple[str, str]]:
        """Rows of the title block, as of a spec of one axis."""
        given = self.sizing.machine.report.model_dump(exclude_none=True)
        return [(name.replace("_", " ").capitalize(), str(text)) for name, text in given.items()]

    @cached_property
    def catalogs(self) -> dict[str, str]:
        """Digests of the catalogues of all axes, by name."""
        return {name: digest for one in self.axes for name, digest in one.content.result.catalog.digests.items()}

    @property
    def method(self) -> str:
        """Methods that ranked."""
        return ", ".join(dict.fromkeys(one.content.result.method for one in self.axes))

    @property
    def file(self) -> str:
        """The name of the machine's file without its folder."""
        return self.sizing.machine.file.replace("\\", "/").rsplit("/", 1)[-1]

    @cached_property
    def loads(self) -> dict[str, Drawing]:
        """Figures with the field of every axis, as many on each as a page has room for."""
        fields = [*self._fields()]
        parts = [fields[n : n + _FIELDS] for n in range(0, len(fields), _FIELDS)]
        return {f"loads{n}": torque_speed_panels(part) for n, part in enumerate(parts, 1)}

    def _fields(self) -> Iterator[Panel]:
        """The field of each axis' drive with its first load case, under the name of the axis."""
        for one in self.axes:
            drive, result = one.content.drive, one.content.result
            found = panels(result.problem, drive, result.requirements) if drive else []
            for panel in found[:1]:
                number, _, field = panel.cases[0]
                yield replace(panel, cases=((number, one.name, field),), points=())

    @cached_property
    def supply(self) -> dict[str, Drawing]:
        """The power of all axes over time, where it is known of any."""
        power = self.sizing.power
        known = power is not None and len(power.unknown) < len(power.axes)
        return {"power": axes_power(power)} if power is not None and known else {}

    @cached_property
    def drawings(self) -> dict[str, Drawing]:
        """Every figure by name: those of all axes, then those of each."""
        own = {f"{one.key}{name}": draw for one in self.axes for name, draw in one.content.drawings.items()}
        return self.loads | self.supply | own


# -- Closed loops of all axes: side by side in a chapter, and in tables as those of a single axis with its name.


def loop_blocks(content: MachineContent) -> Iterator[Block]:
    """A row for each axis with a drive: what it was simulated over, and its tightest check."""
    if not content.proofs:
        return
    columns = (Column("axis", "name", 0.7), Column("simulated in", width=1.0), Column("tightest check", "small", 1.0),
               Column("demand", "number"), Column("limit", "number"), Column("margin", "number"),
               Column("", "status"))  # fmt: skip
    rows = [Cells(_cells(one), {"axis": one.name}) for one in content.axes if one.sizing.best]
    caption = "Every axis simulated in its hardest load case, with the drives that ride on it"
    yield Table(caption, columns, rows, "axes_loops", "wide")
    yield Words("Figures, gains and the loop over time are in the chapter of each axis.", "note")


def _cells(one: AxisContent) -> tuple[object, ...]:
    v = one.content.validation
    if v is None:
        return one.name, "not simulated, see its warnings", "", "", "", "", (StatusMark("unknown"),)
    tight = worst(v.checks)
    row = check_texts(tight) if tight else {"title": "", "demand": "", "limit": "", "margin": ""}
    shown = (row[name] for name in ("title", "demand", "limit", "margin"))
    return one.name, f"{v.loop}, {driven_over(v)}", *shown, (StatusMark(v.status),)


# -- the workbook


def loop_summary(content: MachineContent) -> Iterator[Row]:
    """Rows of the first sheet: each axis by the tightest check of its closed loop."""
    if content.proofs:
        yield {"part": "Closed loop of each axis, by its tightest check"}
    for name, v in content.proofs.items():
        tight = worst(v.checks)
        found = check_line(tight) if tight else {}
        title = f"{tight.title}; " if tight else ""
        yield found | {"title": name, "status": v.status, "note": f"{title}{v.loop} over {driven_over(v)}"}


def loop_sheet(content: MachineContent) -> Iterator[Sheet]:
    """One sheet of all closed loops: checks, figures, gains and linear loops; none where nothing was simulated."""
    if content.proofs:
        columns = (SheetColumn("axis", "axis"), *LOOP_COLUMNS)
        yield Sheet(name="Closed loops", columns=columns, rows=[*_rows(content)], still=3)


def _rows(content: MachineContent) -> Iterator[Row]:
    for name, v in content.proofs.items():
        yield from (row | {"axis": name} for row in closed_loop_rows(v))


def time_series_sheets(content: MachineContent, names: dict[str, str]) -> Iterator[Sheet]:
    """A sheet of time series for each axis, all together as long as that of a single axis."""
    for name, v in content.proofs.items():
        yield time_series(v, names[name], len(content.proofs))


# -- CSV


def loop_files(content: MachineContent, path: Path) -> dict[Path, bytes]:
    """Files beside the table of axes: one of all closed loops, and for each axis one of its time series."""
    if not content.proofs:
        return {}
    rows = ([row["axis"], *(row.get(column, "") for column in COLUMNS)] for row in _rows(content))
    files = {path.with_name(f"{path.stem}-loops{path.suffix}"): encoded(["axis", *COLUMNS], rows)}
    for one in content.axes:
        if one.content.validation:
            series = timeseries_csv(one.content.validation)
            files[path.with_name(f"{path.stem}-{one.key}timeseries{path.suffix}")] = series
    return files


# -- The first page of a machine's report: its verdict, a row for each axis, all parts, and the machine's own checks.


def summary_blocks(content: MachineContent) -> Iterator[Block]:
    """The answer."""
    sizing = content.sizing
    yield Verdict(sizing.status != "fail", [(StatusMark(content.status), " ", *verdict_text(content))])
    yield _axes_table(content)
    if sizing.checks:
        yield Checks("Checks of all axes together", [*map(check_texts, sizing.checks)], "machine_checks")
    yield Tiles([*_tiles(content)])
    if content.bought:
        axes = [one.name for one in content.axes if one.sizing.best]
        whole = f"{_drives(content)} of {len(axes)} axes" if len(axes) > 1 else f"{_drives(content)} of {axes[0]}"
        yield shared_parts_table(content.bought, content.totals, whole)
    if notes(content):
        yield Bullets("Of all axes together:", notes(content))


def verdict_text(content: MachineContent) -> tuple[Any, ...]:
    """Axes that have a drive, as a text with marks."""
    sizing = content.sizing
    without = [one.name for one in sizing.axes if one.best is None]
    drives = number_of(content.drives, "drive")
    ranked = f"ranked by {sizing.objective.replace('_', ' ')}"
    if without:
        others = f" The others: {drives}, {ranked}." if content.drives else ""
        return Strong(f"No drive for {', '.join(without)}."), *_simulated(content), others
    failed = ", ".join(check.title for check in sizing.checks if check.status == "fail" and not check.advice)
    together = (Strong(f" Together they fail on: {failed}."),) if failed else ()
    return (
        Strong("Every axis has a drive."),
        *together,
        *_simulated(content),
        f" {drives} on {number_of(len(sizing.axes), 'axis', 'axes')}, {ranked}.",
    )


def _simulated(content: MachineContent) -> tuple[Any, ...]:
    """Verdict of all closed loops: those that fail by name."""
    failed = [
        f"{name} fails on {proof.failed}".removesuffix(" on ")
        for name, proof in content.proofs.items()
        if proof.status == "fail"
    ]
    if failed:
        return (Strong(f" Simulated in its hardest load case, {'; '.join(failed)}."),)
    passed = all(proof.status == "pass" for proof in content.proofs.values())
    said = f" Simulated in its hardest load case, {'every axis passes' if passed else 'no axis fails'}."
    return (said,) if len(content.proofs) == len(content.axes) else ()


def notes(content: MachineContent) -> list[str]:
    """Power of the supply and choice of the drives, as sentences."""
    power = content.sizing.power
    found = [*(supply_texts(power) if power else ()), *content.sizing.notes, choice_text(content.sizing)]
    return [note for note in found if note]


# -- a row for each axis


def _axes_table(content: MachineContent) -> Table:
    columns = (Column("axis", "name", 0.7), Column("drive", width=1.2), Column("carries", "number"),
               Column("mass", "number"), Column("price", "number"), Column("energy", "number"),
               Column("margin", "number"), Column("tightest check", "small", 0.8), Column("", "status"))  # fmt: skip
    rows = [Cells(_axis_cells(one), {"axis": one.name}, one.status) for one in content.axes]
    caption = ("The axes: mass of other axes' drives on each, mass and price of its own parts as far as known, "
               "energy of its cycle")  # fmt: skip
    return Table(caption, columns, rows, "axes", dense=True)


def _axis_cells(one: AxisContent) -> tuple[Any, ...]:
    drive, carried = one.content.drive, one.sizing.carried_mass
    riding = show(carried, "kg", "mass", 3) if one.sizing.carried else ""
    if drive is None:
        return one.name, "no candidate", riding, "", "", "", "", "", (StatusMark("fail"),)
    tight, energy = tight_of(drive), objective_figure(drive, "energy").text
    sums = totals(one.lines)
    return (one.name, drive_name(one), riding, _sum(sums, "mass"), _sum(sums, "price"), energy,
            tight["margin"], tight["title"], (StatusMark(one.status),))  # fmt: skip


def drive_name(one: AxisContent) -> Text:
    """The drive of an axis; of one without the closest rejected, and that it is."""
    assert one.content.drive is not None
    count = f"{one.sizing.drives} × " if one.sizing.drives > 1 else ""
    label = f"{count}{one.content.drive.label}"
    return label if one.sizing.best else (Strong("none; closest:"), f" {label}")


def _sum(sums: Sequence[Total], name: str) -> str:
    return " + ".join(total_of(total).replace(LEAST, "≥ ") for total in sums if total.name == name) or "–"


# -- figures in large letters


def _tiles(content: MachineContent) -> Iterator[tuple[str, str, str]]:
    checks = [(check, one.name) for one in content.axes if one.sizing.best
              for check in tightest(one.sizing.best.deciding, 1)]  # fmt: skip
    checks += [(check, "all axes") for check in tightest(content.sizing.checks, 1)]
    if checks:
        check, name = min(checks, key=lambda pair: -inf if isnan(pair[0].margin) else pair[0].margin)
        yield "Smallest margin", check_texts(check)["margin"] or "none", f"{name}: {check.title}"
    for figure in ("mass", "price"):
        yield summed_tile(content.totals, figure, _drives(content))


def _drives(content: MachineContent) -> str:
    return "the one drive" if content.drives == 1 else f"all {content.drives} drives"


# -- Chapters of a machine's report on all axes: their loads side by side, who carries whom, assumptions, the appendix.


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
    yield Facts("All axes on one supply", [*map(figure_texts, power.figures)], "machine_figures", halves=True)
    if power.exceeded:
        yield _exceeded(power)
    if power.braking:
        of = f" with brake resistor {power.braking.name}" if power.braking.name else ""
        yield Facts(f"What is regenerated, stored and burnt{of}", [*map(figure_texts, power.braking.figures)])
    if power.energy:
        yield Pair([consumers(power.energy)], [Facts("The battery", [*map(figure_texts, power.energy.figures)])])
    if power.reliability:
        yield from _over_tolerances(power.reliability)
    yield Bullets("Assumptions:", list(_once((power, power.braking, power.energy))))


def _over_tolerances(found: Reliability) -> Iterator[Block]:
    """Limits of the supply over samples of all uncertain figures."""
    said = sampled_text(found)
    yield Words((f"{said[0].upper()}{said[1:]}.",))
    heads = [Column(name, "number") for name in ("passes", "margin 5 %", "50 %", "95 %")]
    rows = [Cells(check_cells(one)) for one in moved(found)]
    if rows:
        caption = "Limits of the supply that samples change: share that passes, and quantiles of the margin"
        yield Table(caption, [Column("check", "name", 1.0), *heads], rows, "supply-checks", "probability")
    columns = [Column("figure", "name", 1.0), *(Column(f"{q} %", "number") for q in (5, 50, 95))]
    figures = [Cells([one.title, *one.texts]) for one in found.figures]
    yield Table("All axes over the samples: percentiles", columns, figures, "supply-figures", "probability")


def _exceeded(power: MachinePower) -> Table:
    """Share of the time in which axes at random phases exceed a limit of the supply."""
    columns = (
        Column("limit of the supply", "name", 1.0),
        Column("power", "number"),
        Column("share of the time", "number"),
    )
    titles = {check.name: check.title for check in power.checks}
    rows = [Cells((titles.get(one.check, one.check), show(one.limit, "W", "power"),
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
    shown = [Cells(row if turning else (*row[:3], *row[4:])) for row in rows]
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


# -- The chapter of one axis: its answer, then sections of a report of it alone, without what the machine has once.


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


# -- The document of a machine's report as plain data: chapters on all axes, and one for each axis.


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
