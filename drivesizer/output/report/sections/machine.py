"""The machine with the drive: requirements, budgets, masses, a platform's speeds, battery, what it regenerates."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isnan

from drivesizer.control.path_following.deviation import extremes
from drivesizer.control.path_following.runs import assumed
from drivesizer.output.energy_table import consumer_rows
from drivesizer.output.platform_table import (
    FOLLOWING,
    SPEEDS,
    failed_motors_text,
    speed_heads,
    speed_remarks,
    speed_rows,
)
from drivesizer.output.report.lines.drive import case_of, check_row, figure_row
from drivesizer.output.report.lines.rows import battery_rows, braking_rows, machine_rows
from drivesizer.output.report.sections.blocks import (
    Block,
    Bullets,
    Checks,
    Column,
    Facts,
    Pair,
    Picture,
    Row,
    Table,
    Words,
)
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.section import CsvRows, Section
from drivesizer.output.report.sections.sheet import Sheet, SheetColumn
from drivesizer.output.report.sections.sheets import RANK, STATUS, VALUES, ranked
from drivesizer.output.report.sections.texts import Number, Status, quantity
from drivesizer.output.required import RequiredRow, required_rows
from drivesizer.output.text import margin
from drivesizer.results.check_parts import sorted_by_part
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.energy import EnergyBudget

__all__ = [
    "BATTERY",
    "BRAKING",
    "FOLLOWED",
    "MACHINE",
    "PERMITTED",
    "REQUIRED",
    "consumers",
    "masses",
    "unknown_consumers",
    "unknown_masses",
]

_OF_MASSES = ("mass_known", "mass_left")  # figures that belong below the masses that they sum


def _blocks(content: Content) -> Iterator[Block]:
    best = content.drive
    if best is None or not best.budget:
        return
    cases = "; each in its worst load case" if content.cases else ""
    yield Checks(f"The machine's budgets, which more than the choice of the motor decides{cases}",
                 [*map(check_row, sorted_by_part(best.budget))], "budget", grouped=True)  # fmt: skip
    others = [figure_row(f) for f in best.machine if f.name not in _OF_MASSES]
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


def _sheet(content: Content) -> list[Sheet]:
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
    name="machine", title="The machine with this drive", blocks=_blocks, sheets=_sheet,
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
    yield Pair([consumers(budget)], [Facts("The battery", [*map(figure_row, budget.figures)])])
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
    yield Facts("What is regenerated, stored and burnt", [*map(figure_row, budget.figures)])
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
