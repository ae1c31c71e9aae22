"""The machine with the drive: budgets, masses, a platform's figures, battery, parts list and data sheets."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from math import isnan, radians
from typing import Any

from drivesizer.catalog import Catalog, columns_of, singular
from drivesizer.catalog.query import Hit, origins
from drivesizer.control.path_following.following import extremes
from drivesizer.control.path_following.runs import assumed
from drivesizer.output.derivation import margin
from drivesizer.output.part import datasheets
from drivesizer.output.parts import PartLine, totals
from drivesizer.output.platform import (
    FOLLOWING,
    SPEEDS,
    PlatformNumbers,
    failed_motors_text,
    formula,
    platform_numbers,
    printed,
    speed_heads,
    speed_remarks,
    speed_rows,
)
from drivesizer.output.report.lines import rows as table
from drivesizer.output.report.lines.rows import (
    Row as Line,
)
from drivesizer.output.report.lines.rows import (
    battery_rows,
    braking_rows,
    case_of,
    check_texts,
    figure_texts,
    machine_rows,
)
from drivesizer.output.report.sections.section import (
    NOTE,
    RANK,
    STATUS,
    VALUES,
    Block,
    Bullets,
    Cell,
    Checks,
    Column,
    Content,
    CsvRows,
    Facts,
    Fragment,
    Heading,
    Mark,
    Number,
    Pair,
    Picture,
    Row,
    Section,
    Sheet,
    SheetColumn,
    Status,
    Table,
    Words,
    quantity,
    ranked,
)
from drivesizer.output.report.sections.summary import OUTCOMES
from drivesizer.output.tables import RequiredRow, consumer_rows, required_rows
from drivesizer.platform.robot_figures import Numbers
from drivesizer.results.check_kinds import sorted_by_part
from drivesizer.results.drive_set import DriveSet, EnergyBudget, section_of
from drivesizer.units import KINDS, from_si

__all__ = [
    "BATTERY", "BRAKING", "DATA_SHEETS", "FOLLOWED", "MACHINE", "PARTS", "PART_COLUMNS", "PERMITTED",
    "PLATFORM_NUMBERS", "REQUIRED", "consumers", "masses", "part_sheet_row", "sheet_blocks", "unknown_consumers",
]  # fmt: skip


# -- The sheet and the CSV rows of the parts list, and the data sheets of the parts.


PART_COLUMNS = (
    SheetColumn("role", "role"), SheetColumn("maker", "maker"), SheetColumn("family", "family"),
    SheetColumn("part", "part"), SheetColumn("order number", "order_number"), STATUS, SheetColumn("is", "said"),
    SheetColumn("quantity", "quantity", "count"), SheetColumn("mass of one (g)", "mass_g"),
    SheetColumn("from (g)", "mass_low_g"), SheetColumn("to (g)", "mass_high_g"),
    SheetColumn("mass of all (g)", "masses_g"), SheetColumn("price of one", "price", "money"),
    SheetColumn("price of all", "prices", "money"), SheetColumn("currency", "currency"),
    SheetColumn("price from (pieces)", "pieces", "count"), SheetColumn("price date", "price_date"),
    SheetColumn("price confidence", "price_confidence", "confidence"),
    SheetColumn("part confidence", "confidence", "confidence"), NOTE,
    SheetColumn("price source", "price_source", "line"), SheetColumn("part source", "document", "line"),
    SheetColumn("source date", "date"), SheetColumn("page", "url", "line"),
)  # fmt: skip


def _parts_sheet(content: Content) -> list[Sheet]:
    rows = [part_sheet_row(line) for line in content.bought]
    known = "mass and price are empty where no catalogue has them; a mass with from and to is estimated"
    note = known if rows else "no drive meets all limits: nothing to buy"
    return [Sheet(name="Parts list", columns=PART_COLUMNS, rows=rows, note=note, still=1)]


def part_sheet_row(line: PartLine) -> table.Row:
    """A part by the keys of ``PART_COLUMNS``."""
    grams, low, high = (from_si(mass, "g", "mass") for mass in (line.mass, line.mass_low, line.mass_high))
    row = {name: getattr(line, name) for name in line.__slots__}
    return row | {"status": "" if line.order_number else "unknown", "mass_g": grams, "mass_low_g": low,
                  "mass_high_g": high, "masses_g": line.quantity * grams,
                  "prices": line.quantity * line.price}  # fmt: skip


def _csv(content: Content) -> Iterator[table.Row]:
    rows = [row for line in content.bought for row in table.part_rows(line)]
    yield from (row | {"set_rank": 1} for row in (*rows, *table.total_rows(totals(content.bought))))


def _no_blocks(_: Content) -> tuple[()]:
    """None: its table is in the summary."""
    return ()


PARTS = Section(
    name="parts", title="Parts list", level=2, blocks=_no_blocks, sheets=_parts_sheet, csv=CsvRows(after=_csv)
)


# -- data sheets


def _datasheets(content: Content) -> Iterator[Block]:
    if content.drive is not None:
        yield from sheet_blocks(datasheets(content.drive, content.result.catalog))


def sheet_blocks(sheets: Sequence[dict[str, Any]]) -> Iterator[Block]:
    """Data sheets of parts, below the meaning of their marks."""
    yield Words((
        "Figures without a mark are quoted from the maker's own document. Marked ones are not: ", Mark("secondary"),
        " copied by others, ", Mark("derived"), " computed or inferred, ", Mark("recalled"),
        " from memory, to be checked before anything is built. Figures that the catalogue does not know are not "
        "listed.",
    ))  # fmt: skip
    yield Fragment("datasheets", sheets)


_FIGURES = (
    SheetColumn("part", "role"), SheetColumn("maker", "maker"), SheetColumn("family", "family"),
    SheetColumn("number", "number"), SheetColumn("figure", "title"), SheetColumn("value", "value"),
    SheetColumn("unit", "unit", "unit"), SheetColumn("SI value", "si_value"), SheetColumn("SI unit", "si_unit", "unit"),
    SheetColumn("confidence", "confidence", "confidence"), NOTE, SheetColumn("source date", "date"),
    SheetColumn("source", "document", "line"),
)  # fmt: skip


def _figures_sheet(content: Content) -> list[Sheet]:
    """Every known figure of the drive's parts with its source and confidence, and the figures of the drive."""
    result, best = content.result, content.drive
    if best is None:
        return [Sheet(name="Selected drive", columns=_FIGURES, rows=[], note="no drive was examined")]
    figures = [table.figure_row("figure", f) | {"role": "drive", "confidence": "computed"} for f in best.figures]
    once = {(section_of(part), part.part): part for part in best.parts.values() if part is not None}
    rows = [row for (section, _), part in once.items() for row in _figures(section, part, result.catalog)]
    note = "" if result.sets else OUTCOMES[content.outcome]
    return [Sheet(name="Selected drive", columns=_FIGURES, rows=[*rows, *figures], note=note, still=5)]


_IN_HEAD = {"part", "family", "manufacturer"}


def _figures(section: str, part: Any, catalog: Catalog) -> Iterator[table.Row]:
    """The known figures of a part, and the notes on them."""
    known = origins(Hit("", catalog, section, catalog.table(section).rows[part.part]))
    notes = catalog.notes_on(section, part.part)
    named = {"role": singular(section), "maker": part.manufacturer, "family": part.family, "number": part.part}
    of_part = "; ".join(note.text for note in notes if not note.fields)
    yield named | _sourced(known["part"]) | {"title": "part", "value": part.part, "note": of_part}
    for name, column in columns_of(section).items():
        if name in known and name not in _IN_HEAD:
            note = "; ".join(note.text for note in notes if name in note.fields)
            yield named | _measured(getattr(part, name), column) | _sourced(known[name]) | {
                "title": name.replace("_", " "), "note": note}  # fmt: skip


def _measured(value: Any, column: Any) -> table.Row:
    if column.kind == "text":
        return {"value": value}
    form = "money" if column.kind.startswith("price") else "datum"
    return {"value": Cell(from_si(value, column.unit, column.kind), form), "unit": column.unit, "si_value": value,
            "si_unit": KINDS[column.kind].si}  # fmt: skip


def _sourced(source: Any) -> table.Row:
    return {"confidence": source.confidence, "document": source.document, "date": source.date}


DATA_SHEETS = Section(
    name="datasheets",
    title="Data sheets",
    blocks=_datasheets,
    sheets=_figures_sheet,
    appendix=True,
    tabled=False,
)


# -- The platform's kinematics and dynamics in numbers, equations (21)-(59) beside them.


_SI = {"deg": ("rad", radians(1.0)), "mm": ("m", 1e-3)}


def _numbers(content: Content) -> PlatformNumbers | None:
    spec = content.result.spec
    return platform_numbers(spec, content.drive) if spec.platform else None


def _platform_blocks(content: Content) -> Iterator[Block]:
    found = _numbers(content)
    if found is None:
        return
    yield Words(
        "Symbols and numbers of equations are those of the paper, the symbols L, α, β, γ of its Table 1; x points "
        "forward, y to the left, θ turns counterclockwise. Each table is computed by the equation that it names."
    )
    yield Heading("Kinematics")
    yield _table(found.wheels)
    kinematics, dynamics = found.matrices[:4], found.matrices[4:]
    yield from _pairs([*kinematics[:3:2], *kinematics[1::2]])
    yield _table(found.mobility)
    yield Heading("Dynamics")
    yield Words(f"{found.rotors} C̄ and C_q are at a turning speed of 1 rad/s, with which they grow.")
    yield from _pairs([one for pair in zip(dynamics[::2], dynamics[1::2], strict=True) for one in pair])
    yield Heading("Forces and torques")
    yield Words(
        f"{found.moment} Rolling resistance is that of wheels, rollers and casters, which the paper leaves out."
    )
    yield from map(_table, found.at_instant)


def _pairs(tables: list[Numbers]) -> Iterator[Block]:
    """Tables beside each other, two by two."""
    for left, right in zip(tables[::2], tables[1::2], strict=True):
        yield Pair([_table(left)], [_table(right)])


def _table(numbers: Numbers) -> Table:
    shown, rows = printed(numbers), []
    for name, texts, values, units in zip(numbers.rows, shown.cells, numbers.values, numbers.units, strict=True):
        rows.append(Row((name, *map(_number, texts, values.tolist(), units))))
    named = ", ".join(f"({number})" for number in numbers.equations)
    caption = f"{numbers.meaning} {named}: {formula(numbers)}" if named else numbers.meaning
    columns = [Column("", "name", 1.0), *(Column(head, "number") for head in shown.heads)]
    return Table(f"{caption}, in {shown.unit}" if shown.unit else caption, columns, rows, look="figures", dense=True)


def _number(text: str, value: float, unit: str) -> Number:
    si, factor = _SI.get(unit, (unit, 1.0))
    return Number(text, value, unit, value * factor, si)


def _lines(content: Content) -> Iterator[Line]:
    """One entry of a table in each."""
    found = _numbers(content)
    for numbers in found.every if found else ():
        of = {"section": "platform", "symbol": numbers.symbol, "equation": next(iter(numbers.equations), "")}
        for row, values, units in zip(numbers.rows, numbers.values, numbers.units, strict=True):
            for column, value, unit in zip(numbers.columns, values.tolist(), units, strict=True):
                entry = _number("", value, unit)
                place = ", ".join(filter(None, (row, column)))
                name = re.sub(r"\W+", "_", f"{numbers.name} {place}".replace("θ", "theta"))
                yield of | {"name": name, "title": f"{numbers.meaning}, {place}", "value": value, "unit": unit,
                            "si_value": entry.si_value, "si_unit": entry.si_unit}  # fmt: skip


def _platform_sheet(content: Content) -> Iterator[Sheet]:
    rows = [*_lines(content)]
    heads = SheetColumn("what", "title"), SheetColumn("symbol", "symbol"), SheetColumn("equation", "equation", "count")
    if rows:
        yield Sheet(
            name="Platform", columns=(*heads, *VALUES), rows=rows, still=3, note="kinematics and dynamics in numbers"
        )


PLATFORM_NUMBERS = Section(
    name="platform", title="Kinematics and dynamics of the platform", blocks=_platform_blocks, appendix=True,
    sheets=_platform_sheet, csv=CsvRows(after=_lines),
)  # fmt: skip


# -- The machine with the drive: requirements, budgets, masses, a platform's speeds, battery, what it regenerates.


_OF_MASSES = ("mass_known", "mass_left")  # figures that belong below the masses that they sum


def _machine_blocks(content: Content) -> Iterator[Block]:
    best = content.drive
    if best is None or not best.budget:
        return
    cases = "; each in its worst load case" if content.cases else ""
    yield Checks(f"The machine's budgets, which more than the choice of the motor decides{cases}",
                 [*map(check_texts, sorted_by_part(best.budget))], "budget", grouped=True)  # fmt: skip
    others = [figure_texts(f) for f in best.machine if f.name not in _OF_MASSES]
    figures = [Facts("Figures of the machine without a limit", others)] if others else []
    if best.masses:
        yield Pair([*masses(best)], figures)
    else:
        yield from figures


def masses(best: DriveSet) -> Iterator[Block]:
    """The masses of the machine one by one, their sum, and what it lacks."""
    rows = [Row((one.name, f"{one.number} ×" if one.number > 1 else "",
                 quantity(one.each, "kg", "mass") if one.number > 1 else "", quantity(one.total, "kg", "mass")))
            for one in best.masses]  # fmt: skip
    sums = [Row((f.title, "", "", f.text), total=True) for f in best.machine if f.name in _OF_MASSES]
    columns = Column("part", "name", 1.0), Column("", "number"), Column("each", "number"), Column("together", "number")
    yield Table("Masses of the machine", columns, [*rows, *sums], "masses", "figures")
    guessed = ", ".join(f"{one.name} {one.text(one.each, 'kg')}" for one in best.masses if one.band)
    if guessed:
        yield Words(f"Estimated, each from the 5th to the 95th percentile: {guessed}.", "note")
    lacks = ", ".join(unknown_masses(best))
    if lacks:
        yield Words(f"Not known and not in the sum: {lacks}.", "note")


def unknown_masses(best: DriveSet) -> tuple[str, ...]:
    """Parts of the machine whose mass is unknown and in no sum."""
    return tuple(dict.fromkeys(one.name for one in best.masses if isnan(one.each)))


def _machine_sheet(content: Content) -> list[Sheet]:
    """Masses of the machine with every drive, and its figures without a limit."""
    columns = (
        RANK, SheetColumn("of", "section"), SheetColumn("what", "title"), SheetColumn("how many", "how_many", "count"),
        SheetColumn("mass of one (kg)", "each"), *VALUES, SheetColumn("at (s)", "at_time_s"), STATUS,
    )  # fmt: skip
    rows = list(ranked(content, machine_rows))
    note = "masses of all pieces together, and figures without a limit; those with one are in Checks"
    return [Sheet(name="Machine", columns=columns, rows=rows, still=3,
                  note=note if rows else "the spec has neither budget nor platform")]  # fmt: skip


MACHINE = Section(
    name="machine", title="The machine with this drive", blocks=_machine_blocks, sheets=_machine_sheet,
    csv=CsvRows(of_drive=lambda content, _, drive: machine_rows(drive)),
)  # fmt: skip


# -- a platform


def _permitted(content: Content) -> Iterator[Block]:
    found = content.behaviour.permitted if content.behaviour else None
    if found is None:
        return
    with_motors = failed_motors_text(found) if found.failed else "with all motors"
    yield Picture("permitted", f"Highest steady speed over the direction, {with_motors} and without each.",
                  "permitted speed over the direction", about="shows how fast the robot may go.")  # fmt: skip
    direction, *heads = speed_heads(found)
    columns = [Column(direction, "number"), *(Column(head, "number") for head in heads), Column("limited by", "small")]
    rows = [Row((degrees, *(quantity(speed, "m/s", "speed") for speed in speeds), by))
            for degrees, by, speeds in speed_rows(found)]  # fmt: skip
    yield Table(f"{SPEEDS}; what limits it {with_motors}", columns, rows, "permitted", dense=True)
    yield Bullets("In these speeds:", [*speed_remarks(found)])


def _followed(content: Content) -> Iterator[Block]:
    does, platform = content.behaviour, content.result.spec.platform
    if does is None or does.path is None or platform is None:
        return
    runs = does.followed
    if not runs:
        yield Words(f"Not simulated: {does.not_followed}", "alarm")
        return
    plain = "; of the runs those with P loops, poses not fed back" if len(runs) > 4 else ""
    yield Picture("followed", f"The path from above, desired and driven, distance and heading error along it{plain}.",
                  "the path desired and driven", about="shows how the robot follows its path.")  # fmt: skip
    heads = "position", "heading", "slip", "torque of a wheel", "use of the floor's grip"
    columns = [Column("model, speed loops, poses, what the model knows" if len(runs) > 4 else "run", "name", 1.0),
               *(Column(head, "number") for head in (*heads, "at the torque limit"))]  # fmt: skip
    rows = [Row((f"{one.name}, measured", quantity(one.position, "m", "length"), quantity(one.heading, "deg", "angle"),
                 *[""] * 4)) for one in platform.following.measured]  # fmt: skip
    for name, run in runs.items():
        by = {one.title: quantity(abs(one.value), one.unit, one.kind) for one in extremes(run)}
        limited = quantity(float(run.limited.max()), "%", "dimensionless")
        rows.append(Row((name, *(by[head] for head in heads), limited)))
    yield Table(FOLLOWING, columns, rows, "followed", dense=True)
    yield Bullets("In this simulation:", [*assumed(does.path, content.drive)])


FOLLOWED = Section(name="followed", title="Path following", level=2, blocks=_followed)
PERMITTED = Section(name="permitted", title="Speed by direction", level=2, blocks=_permitted)


# -- requirements


def _required(content: Content) -> Iterator[Block]:
    rows = required_rows(content.drive) if content.drive else []
    if rows:
        numbers = (Column(head, "number") for head in ("required", "reached", "margin"))
        columns = (
            Column("requirement", "name", 1.0),
            Column("bound", "small"),
            *numbers,
            Column("met", "status"),
            Column("note"),
        )
        yield Table("Requirements on the machine, what is reached, and by what margin", columns, [*map(_demand, rows)])


def _demand(row: RequiredRow) -> Row:
    """A requirement with the load case or passage that it is of."""
    check = row.check
    figures = (quantity(value, check.unit, check.kind) for value in (row.required, row.reached))
    note = "; ".join(filter(None, (case_of(check), check.note)))
    return Row((check.title, row.bound, *figures, margin(check.margin), (Status(check.status),), note))


REQUIRED = Section(name="required", title="Requirements on the machine", blocks=_required)


# -- battery


def _battery(content: Content) -> Iterator[Block]:
    budget = content.drive.energy if content.drive else None
    if budget is None:
        return
    lacks = " Unknown consumers are not counted." if unknown_consumers(budget) else ""
    mean = f"Mean power that the consumers draw from the battery ({budget.battery}).{lacks}"
    charge = "The charge that is left over time, from full."
    yield Picture("battery", f"{mean} {charge}", "consumers, and the battery's charge over time",
                  about="shows the consumers and the battery's charge over time.")  # fmt: skip
    yield Pair([Picture("consumers", mean, "consumers of the battery, mean power")],
               [Picture("charge", charge, "charge of the battery over time")])  # fmt: skip
    yield Pair([consumers(budget)], [Facts("The battery", [*map(figure_texts, budget.figures)])])
    yield Bullets("Assumptions of the energy budget:", list(budget.assumptions))


def unknown_consumers(budget: EnergyBudget) -> tuple[str, ...]:
    """Consumers whose power is unknown and in no sum."""
    return tuple(one.name for one in budget.consumers if isnan(one.mean))


def consumers(budget: EnergyBudget) -> Table:
    """Mean and highest power of each consumer of the battery, and their sum."""
    *single, together = consumer_rows(budget)
    rows = [*single, together._replace(said="of the known ones" if unknown_consumers(budget) else "")]
    timed = any(row.duty for row in single)
    columns = [Column("consumer", "name", 1.0), Column("", "number"), Column("mean", "number"),
               Column("peak", "number"), *([Column("on", "number")] if timed else []), Column("", "small")]  # fmt: skip
    cells: list[Sequence[str | Number]] = [
        (row.name, row.number, row.mean, row.peak, *((row.duty,) if timed else ()), row.said) for row in rows
    ]
    return Table("Consumers of the battery", columns, [*map(Row, cells)], "", "consumers")


def _battery_sheet(content: Content) -> list[Sheet]:
    """Consumers and figures of the battery, with every drive."""
    columns = (
        RANK, SheetColumn("of", "section"), SheetColumn("what", "title"), SheetColumn("how many", "how_many", "count"),
        *VALUES, SheetColumn("at most", "limit"), STATUS, SheetColumn("note", "note", "", 40),
    )  # fmt: skip
    rows = list(ranked(content, battery_rows))
    note = "mean and highest power of the consumers, and the battery's figures" if rows else "the spec has no battery"
    return [Sheet(name="Battery", columns=columns, rows=rows, note=note, still=3)]


BATTERY = Section(
    name="battery", title="Battery", level=2, blocks=_battery, sheets=_battery_sheet,
    csv=CsvRows(of_drive=lambda content, _, drive: battery_rows(drive)),
)  # fmt: skip


# -- braking


def _braking(content: Content) -> Iterator[Block]:
    budget = content.drive.braking if content.drive else None
    if budget is None:
        return
    if budget.name:
        yield Words(f"Brake resistor: {budget.name}. Its checks are among the machine's budgets.")
    yield Facts("What is regenerated, stored and burnt", [*map(figure_texts, budget.figures)])
    if budget.assumptions:
        yield Bullets("Assumptions:", list(budget.assumptions))


def _braking_sheet(content: Content) -> list[Sheet]:
    """Figures of what is regenerated, with every drive."""
    columns = (RANK, SheetColumn("what", "title"), *VALUES)
    rows = list(ranked(content, braking_rows))
    note = "what the drives regenerate and a brake resistor burns" if rows else "nothing is regenerated"
    return [Sheet(name="Regenerated energy", columns=columns, rows=rows, note=note, still=2)]


BRAKING = Section(
    name="braking", title="Regenerated energy", level=2, blocks=_braking, sheets=_braking_sheet,
    csv=CsvRows(of_drive=lambda content, _, drive: braking_rows(drive)),
)  # fmt: skip
