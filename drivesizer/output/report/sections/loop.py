"""The closed loop: its checks, figures and gains, its loops by linear theory, and the time series."""

from __future__ import annotations

from collections.abc import Iterator

from drivesizer.control.validation import Validation
from drivesizer.output.loop_table import BESIDE, NO_LINEAR, gain, gain_rows, left_out, linear, linear_rows, remedies
from drivesizer.output.report.figures.load_and_loop import closed_loop_rows
from drivesizer.output.report.figures.time_strips import windows
from drivesizer.output.report.lines import rows as table
from drivesizer.output.report.lines.drive import check_row, figure_row
from drivesizer.output.report.lines.machine import driven_over
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
from drivesizer.output.report.sections.sheet import Sheet, SheetColumn, headed
from drivesizer.output.report.sections.sheets import LIMITS
from drivesizer.output.report.sections.texts import Code, Status, Strong
from drivesizer.output.thinning import curve_points
from drivesizer.results.check_parts import sorted_by_part
from drivesizer.units import from_si

__all__ = ["LINEAR_LOOPS", "LOOP", "LOOP_COLUMNS", "MOST_SAMPLES", "time_series"]

MOST_SAMPLES = 50_000  # of the time series: what a spreadsheet opens at once; the CSV report has all
LOOP_COLUMNS = (
    SheetColumn("of", "section"), SheetColumn("figure", "title"), SheetColumn("direction or case", "case"), *LIMITS,
)  # fmt: skip


def _blocks(content: Content) -> Iterator[Block]:
    v = content.validation
    if v is None:
        return
    yield Words((f"{v.drive_set.label} over {driven_over(v)}: ", Status(v.status)))
    if v.checks:
        yield Checks(f"Checks of the {v.loop}", [*map(check_row, sorted_by_part(v.checks))], "loop-checks",
                     grouped=True)  # fmt: skip
    if v.tried:
        title, tried = remedies(v)
        heads4 = Column("change", "name", 1.0), Column("entered as", "code", 1.4), Column("tightest", "small", 0.8)
        made = [Row((what, (Code(entry),), tight, (Status(found),))) for what, entry, tight, found in tried]
        yield Table(title, (*heads4, Column("", "status")), made)
    if v.linear:
        yield Picture("diagram", "The loop as simulated, after figure 3 of the paper: K is the total ratio, r the "
                      "radius of the load's travel, J the inertia at the motor with the load.",
                      "block diagram of the closed loop", about="is its block diagram.")  # fmt: skip
    *first, last = [title for _, title in closed_loop_rows(v)]
    shown = f"In {v.loop}: {', '.join(first)} and {last}." if first else f"In {v.loop}: {last}."
    cut = " Stretches in which the reference does not change are left out." if len(windows(v.series)) > 1 else ""
    yield Picture("loop", shown + cut, f"{v.loop} over time", about="shows it over time.",
                  on_page=f"{shown} All diagrams share the axis of time.")  # fmt: skip
    gains = [Row((row.title, gain(row))) for row in gain_rows(v.gains)]
    rule = f"Rule of the {v.set_up.lower()}: {v.gains.rule}. Source: {v.gains.source}."
    columns = Column("gain", "name", 1.0), Column("value", "number")
    yield Pair([Facts(f"Figures of the {v.loop}", [*map(figure_row, v.figures)])],
               [Table(f"{v.set_up} of the controller", columns, gains, look="figures"),
                Words(rule, "note")])  # fmt: skip
    if v.controller_gains:
        columns3 = Column("object", "code"), Column("gain", "name", 1.0), Column("value", "number")
        own = [Row(((Code(g.place),), g.name, f"{g.value} {g.unit}")) for g in v.controller_gains]
        yield Table("The same gains as they are written into the controller", columns3, own)
    if v.linear:
        heads = (Column("figure", "name", 1.0), Column("python-control", "number"), Column("at", "number"),
                 Column("engine", "number"), Column("at", "number"))  # fmt: skip
        yield Table(BESIDE, heads, [Row(row) for row in linear_rows(v.linear)], name="python-control", dense=True)
        yield Words(left_out(v.linear), "note")
    else:
        yield Words(NO_LINEAR, "note")
    if v.assumptions:
        yield Bullets("Assumptions of the simulation:", list(v.assumptions))
    if v.warnings:
        yield Bullets("Warnings of the simulation:", list(v.warnings))


def _sheets(content: Content) -> Iterator[Sheet]:
    """Checks, figures, gains and linear loops of the closed loop; and its time series."""
    v = content.validation
    if v is None:
        yield Sheet(
            name="Closed loop", columns=LOOP_COLUMNS, rows=[], note="no drive meets all limits: nothing was simulated"
        )
        yield Sheet(
            name="Time series", columns=(SheetColumn("time (s)", "time"),), rows=[], note="nothing was simulated"
        )
        return
    rows = list(table.closed_loop_rows(v))
    yield Sheet(name=v.loop.capitalize(), columns=LOOP_COLUMNS, rows=rows, note=f"over {driven_over(v)}", still=2)
    yield time_series(v)


def time_series(v: Validation, name: str = "Time series", sheets: int = 1) -> Sheet:
    """The closed loop over time; of a longer record samples evenly, with the peaks of every column."""
    units = v.series_units
    columns = {name: from_si(x, units[name][1], units[name][0]) for name, x in v.series.items()}
    count = len(columns["time"])
    kept = curve_points(tuple(columns.values()), MOST_SAMPLES // sheets)
    note = f"{len(kept)} of {count} samples, evenly and with the peaks of every column" if len(kept) < count else ""
    heads = tuple(SheetColumn(headed(name.replace("_", " "), units[name][1]), name, "sample") for name in columns)
    rows = zip(*(values[kept].tolist() for values in columns.values()), strict=True)
    return Sheet(name=name, columns=heads, note=note, still=1, filtered=False,
                 drawn=tuple(name for name in _DRAWN if name in columns),
                 rows=[dict(zip(columns, row, strict=True)) for row in rows])  # fmt: skip


_DRAWN = ("speed_reference", "speed", "current", "load_angle")


def _csv(content: Content) -> Iterator[table.Row]:
    if content.validation:
        yield from table.closed_loop_rows(content.validation)


def _title(content: Content) -> str:
    return content.validation.loop.capitalize() if content.validation else "Closed loop"


LOOP = Section(name="loop", title=_title, blocks=_blocks, sheets=_sheets, csv=CsvRows(after=_csv))


# -- linear theory


def _linear(content: Content) -> Iterator[Block]:
    loops = content.validation.loops if content.validation else ()
    if not loops:
        return
    found = linear(loops)
    directed, unstable = found["directed"], found["unstable"]
    of_power = (", power flowing in the direction that is nearer to instability; margins and bandwidth are the least "
                "of both directions") if directed else ""  # fmt: skip
    yield Words(
        f"The loops in python-control, sampled, without their limits{of_power}. A loop is stable while all its poles "
        "lie inside 1."
    )
    rows = []
    for row in found["rows"]:
        name = row["name"] if row["stable"] else (f"{row['name']} ", Strong("unstable"))
        rows.append(Row((name, *row["cells"])))
    columns = Column("loop", "name", 1.0), *(Column(head, "number") for head in found["heads"])
    yield Table("The loops, from the inside out; gain margin as a factor", columns, rows, "loops", "loops", dense=True)
    other = (
        "Where the other direction of power has the lesser bandwidth or margin, the mark of the bandwidth is beside "
    )
    other += "the curve"
    line = other + " and the line is longer than the margin that is given." if directed else ""
    none = " An unstable loop has no margins." if unstable else ""
    ends = "and the bandwidth, 3 dB below rest. Each curve ends at the Nyquist frequency of its loop. "
    yield Picture(
        "bode", "Frequency response. Marked are the crossover, the phase margin there (a thick line from the phase to "
        f"−180°) {ends}{line}{none}", "Bode diagram of the loops", about="is the frequency response.",
        on_page="Frequency response. Marked are the crossover, with the phase margin to −180°, "
        f"{ends}{other + '.' if directed else ''}{none}")  # fmt: skip
    band = "The grey band is 2 % to either side of the end, the dashed line the settling time."
    yield Picture("step", f"Response of each loop to a step of its reference. {band}", "step responses of the loops",
                  about="is the response to a step.",
                  on_page=f"Response of each stable loop to a step of its reference. {band}")  # fmt: skip


LINEAR_LOOPS = Section(name="linear", title="The loops by linear theory", level=2, blocks=_linear, tabled=False)
