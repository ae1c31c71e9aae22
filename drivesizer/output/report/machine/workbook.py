"""XLSX of a machine: sheets of the machine, its axes, parts and closed loops, then those of each axis."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from drivesizer.output.part_totals import totals
from drivesizer.output.report.lines import rows as table
from drivesizer.output.report.lines.machine import driven_over
from drivesizer.output.report.machine.chapters import assumptions, warnings
from drivesizer.output.report.machine.content import AxisContent, MachineContent
from drivesizer.output.report.machine.loops import loop_sheet, loop_summary, time_series_sheets
from drivesizer.output.report.machine.power_columns import power_columns
from drivesizer.output.report.machine.summary import drive_name, notes, verdict_text
from drivesizer.output.report.sections.appendix import about_sheet, file_sheet
from drivesizer.output.report.sections.parts import PART_COLUMNS, part_sheet_row
from drivesizer.output.report.sections.sheet import Cell, Sheet, SheetColumn, headed
from drivesizer.output.report.sections.sheets import LIMITS, STATUS
from drivesizer.output.report.sections.summary import check_line, priced, texts
from drivesizer.output.report.sections.texts import text_of
from drivesizer.output.report.workbook.writer import written
from drivesizer.results.check import tightest
from drivesizer.results.machine import CarriedMass
from drivesizer.results.objectives import objective_figure
from drivesizer.units import from_si

__all__ = ["render_machine", "sheets"]


def render_machine(content: MachineContent, path: Path) -> dict[Path, bytes]:
    """The file of an XLSX report."""
    return {path: written(sheets(content))}


def sheets(content: MachineContent) -> list[Sheet]:
    """The sheets of a report in their order, as plain data."""
    machine = content.sizing.machine
    file = file_sheet(content.file, machine.text, machine.entered)
    own = [_machine(content), _axes(content), _parts(content), *_power(content), *loop_sheet(content)]
    taken = {sheet.name for sheet in (*own, file)} | {"About"}
    axes, simulated = [one.name for one in content.axes], [*content.proofs]
    names = sheet_names([*axes, *(f"{name} over time" for name in simulated)], taken)
    found = [*own, *(_axis(one, name) for one, name in zip(content.axes, names, strict=False))]
    found += [*time_series_sheets(content, dict(zip(simulated, names[len(axes) :], strict=True))), file]
    return [*found, about_sheet(content.catalogs, content.method, content.sizing.objective, found)]


_LONGEST = 31  # letters of a sheet's name


def sheet_names(names: Iterable[str], taken: Iterable[str]) -> list[str]:
    """Names of sheets, of which a workbook has each once whatever its capitals, and that it cuts.

    Examples
    --------
    >>> sheet_names(["x", "X", "axes"], ["Axes"])
    ['x', 'X 2', 'axes 2']
    """
    used, made = {name.lower() for name in taken}, []
    for name in names:
        for number in range(1, 2 + len(used)):
            end = "" if number == 1 else f" {number}"
            short = name[: _LONGEST - len(end)].strip() + end
            if short.lower() not in used:
                break
        used.add(short.lower())
        made.append(short)
    return made


# -- the machine


_COLUMNS = (
    SheetColumn("Machine", "title"), SheetColumn("value", "value"), SheetColumn("unit", "unit", "unit"),
    STATUS, SheetColumn("note", "note", "", 90),
)  # fmt: skip


def _machine(content: MachineContent) -> Sheet:
    sizing = content.sizing
    rows: list[table.Row] = [{"title": "Machine", "note": sizing.machine.name}]
    rows += [{"title": name, "note": value} for name, value in content.title_block]
    rows += [{"title": "Verdict", "status": content.status, "note": text_of(verdict_text(content))},
             {"title": "Drives", "value": Cell(content.drives, "count")}]  # fmt: skip
    rows += [{"part": "Smallest margin of each axis"}, *map(_tight, content.axes)]
    if sizing.checks:
        rows += [{"part": "Checks of all axes together"}, *map(check_line, sizing.checks)]
    if sizing.power:
        rows += [{"part": "All axes on one supply"}]
        rows += [table.figure_row("power", figure) for figure in sizing.power.figures]
    rows += loop_summary(content)
    if content.bought:
        rows += [{"part": "All parts"}, *map(priced, table.total_rows(content.totals))]
    rows += [*texts("Of all axes together", notes(content)), *texts("Assumptions", assumptions(content)),
             *texts("Warnings", warnings(content))]  # fmt: skip
    return Sheet(name="Machine", columns=_COLUMNS, rows=rows, filtered=False)


def _tight(one: AxisContent) -> table.Row:
    """An axis by its tightest check."""
    drive = one.content.drive
    check = next(iter(tightest(drive.deciding, 1)), None) if drive else None
    named = {"title": one.name, "status": one.status}
    return check_line(check) | named | {"note": check.title} if check else named | {"note": "no candidate"}


# -- axes and parts


_AXES = (
    SheetColumn("axis", "axis"), SheetColumn("drives", "drives", "count"), SheetColumn("drive", "drive", "", 60),
    STATUS, SheetColumn("carries", "carries"), SheetColumn("mass of these (kg)", "carried"),
    SheetColumn("mass of its parts (kg)", "mass"), SheetColumn("price of its parts", "price", "money"),
    SheetColumn("currency", "currency"), SheetColumn("energy of its cycle (J)", "energy"),
    SheetColumn("smallest margin (%)", "margin", "percent"), SheetColumn("tightest check", "check"),
    SheetColumn("not in mass", "no_mass"), SheetColumn("not in price", "no_price"),
)  # fmt: skip


def _axes(content: MachineContent) -> Sheet:
    note = "mass and price are those of all drives of an axis, as far as they are known"
    return Sheet(name="Axes", columns=_AXES, rows=[*map(_axis_row, content.axes)], note=note, still=1)


def _axis_row(one: AxisContent) -> table.Row:
    drive = one.content.drive
    found: table.Row = {"axis": one.name, "drives": one.sizing.drives, "status": one.status,
                        "carries": ", ".join(riding.of for riding in one.sizing.carried),
                        "carried": one.sizing.carried_mass if one.sizing.carried else None}  # fmt: skip
    if drive is None:
        return found | {"drive": "no candidate"}
    check = next(iter(tightest(drive.deciding, 1)), None)
    found |= {"drive": text_of(drive_name(one)), "energy": objective_figure(drive, "energy").value}
    for total in totals(one.lines):
        found |= {total.name: total.value, f"no_{total.name}": ", ".join(total.lacks)}
        found |= {"currency": total.unit} if total.name == "price" else {}
    return found | ({"margin": check.margin, "check": check.title} if check else {})


def _parts(content: MachineContent) -> Sheet:
    """The parts of all axes."""
    columns = (*PART_COLUMNS[:1], SheetColumn("axes", "axes"), *PART_COLUMNS[1:])
    rows = [part_sheet_row(one.line) | {"axes": ", ".join(one.axes)} for one in content.bought]
    known = "mass and price are empty where no catalogue has them; a mass with from and to is estimated"
    note = known if rows else "no drive meets all limits: nothing to buy"
    return Sheet(name="Parts list", columns=columns, rows=rows, note=note, still=1)


# -- power


def _power(content: MachineContent) -> Iterator[Sheet]:
    """Power of all axes over time."""
    power = content.sizing.power
    if power is None:
        return
    columns = power_columns(power)
    heads = tuple(SheetColumn(headed(name, unit), name, "sample") for name, (_, _, unit) in columns.items())
    rows = zip(*(from_si(values, unit, kind).tolist() for values, kind, unit in columns.values()), strict=True)
    yield Sheet(name="Power", columns=heads, note="mean powers, each from its time to that of the next row", still=1,
                filtered=False, rows=[dict(zip(columns, row, strict=True)) for row in rows])  # fmt: skip


# -- one axis


def _carried(found: CarriedMass) -> table.Row:
    lacks = f"without {', '.join(found.lacking)}" if found.lacking else ""
    named = table.plain_row("carried", found.of, f"Drives of {found.of} on it", found.mass, "kg")
    return named | {"note": lacks}


def _axis(one: AxisContent, name: str) -> Sheet:
    columns = (SheetColumn(f"Axis {one.name}", "title"), *LIMITS)
    rows = [*_axis_rows(one)]
    return Sheet(name=name, columns=columns, rows=rows, filtered=False, still=1)


def _axis_rows(one: AxisContent) -> Iterator[table.Row]:
    """Its drive, what it carries, its checks, figures, and the requirements of its load."""
    drive, result = one.content.drive, one.content.result
    if drive is None:
        yield {"title": "Drive", "status": "fail", "note": "no candidate"}
        return
    yield {"title": "Drive", "status": one.status, "note": text_of(drive_name(one))}
    v = one.content.validation
    if v:
        yield {"title": v.loop.capitalize(), "status": v.status, "note": f"over {driven_over(v)}"}
    yield from map(_carried, one.sizing.carried)
    yield {"part": "Parts"}
    yield from table.set_rows(drive, result.objective)
    yield {"part": "Checks"}
    yield from (table.check_row("check", check) for check in drive.every_check)
    yield {"part": "Figures of the drive over the cycle"}
    yield from (table.figure_row("figure", figure) for figure in drive.figures)
    yield {"part": "Requirements of the load"}
    yield from map(table.requirement_row, (*result.requirements, *drive.requirements))
    yield from texts("Assumptions", result.assumptions)
    yield from texts("Warnings", result.warnings)
    if v:
        yield from texts("Assumptions of the simulation", v.assumptions)
        yield from texts("Warnings of the simulation", v.warnings)
