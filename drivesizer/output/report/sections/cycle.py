"""The drive at work: requirements of the load, its load cycle piece by piece, the closed loop."""

from __future__ import annotations

from collections.abc import Iterator
from math import isnan
from typing import Any

from drivesizer.control.validation import Validation
from drivesizer.output.derivation import step, symbol
from drivesizer.output.json.documents import number
from drivesizer.output.loop_table import BESIDE, NO_LINEAR, gain, gain_rows, left_out, linear, linear_rows, remedies
from drivesizer.output.report.figures.cycle import MOST_WHEELS, closed_loop_rows, stretches
from drivesizer.output.report.figures.field import TOGETHER
from drivesizer.output.report.figures.style import windows
from drivesizer.output.report.lines import rows as table
from drivesizer.output.report.lines.rows import check_texts, driven_over, figure_row, figure_texts, requirement_row
from drivesizer.output.report.sections.section import (
    LIMITS,
    NOTE,
    RANK,
    VALUES,
    Block,
    Bullets,
    Checks,
    Code,
    Column,
    Content,
    CsvRows,
    Equation,
    Facts,
    Heading,
    Math,
    Number,
    Pair,
    Picture,
    Row,
    Section,
    Sheet,
    SheetColumn,
    Status,
    Strong,
    Table,
    TableLink,
    Text,
    Words,
    headed,
    quantity,
    ranked,
)
from drivesizer.output.tables import FIGURES, by_case
from drivesizer.output.thinning import curve_points
from drivesizer.results.check import Figure
from drivesizer.results.check_kinds import sorted_by_part
from drivesizer.results.drive_set import DriveSet, MotorPiece, Requirement
from drivesizer.units import from_si, show

__all__ = [
    "CYCLE", "DERIVATION", "ENERGY", "HEAT", "LINEAR_LOOPS", "LOOP", "LOOP_COLUMNS", "PIECES", "field_picture",
    "time_series",
]  # fmt: skip


# -- The requirements of the load: the paper's equations with the numbers put in, or the figures of the load cycle.


def _derivation_title(content: Content) -> str:
    return "Derivation" if content.result.method == "paper" else "Requirements of the load"


def _derivation_blocks(content: Content) -> Iterator[Block]:
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


def _derivation_sheet(content: Content) -> list[Sheet]:
    """The requirements of the load, and with each drive those of its motor."""
    columns = (RANK, SheetColumn("requirement", "title"), SheetColumn("symbol", "symbol"),
               SheetColumn("equation", "equation", "count"), *VALUES, NOTE)  # fmt: skip
    motor = ranked(content, lambda drive: map(requirement_row, drive.requirements))
    return [Sheet(name="Requirements", columns=columns, note="without a drive: of the load; with one: of its motor",
                  still=2, rows=[*map(requirement_row, content.result.requirements), *motor])]  # fmt: skip


DERIVATION = Section(
    name="derivation", title=_derivation_title, blocks=_derivation_blocks, sheets=_derivation_sheet,
    csv=CsvRows(before=lambda content: map(requirement_row, content.result.requirements)),
)  # fmt: skip


# -- The motor's own torque piece by piece of the motion: accelerate, run, brake, rest, and over the whole cycle.


def _pieces_blocks(content: Content) -> Iterator[Block]:
    if content.drive is None:
        return
    columns = Column("piece", "name", 1.0), *(Column(head, "number") for head, *_ in FIGURES)
    for case, pieces in by_case(content.drive.pieces):
        of = f" in load case {case}" if case else ""
        caption = f"The motor in each piece of the motion{of}: largest figures, and RMS; below 0 torque brakes."
        yield Table(caption, columns, [*map(_row, pieces)], "pieces", "figures", dense=True)


def _row(one: MotorPiece) -> Row:
    cells = [quantity(getattr(one, field), unit, kind) for _, field, unit, kind in FIGURES]
    return Row((one.name, *cells), total=one.name == "cycle")


def _pieces_sheet(content: Content) -> list[Sheet]:
    """The pieces of every drive, a figure a column."""
    heads = [SheetColumn(headed(head, unit), field) for head, field, unit, _ in FIGURES]
    columns = RANK, SheetColumn("load case", "case"), SheetColumn("piece", "piece"), *heads
    rows = list(ranked(content, lambda drive: map(_cells, drive.pieces)))
    note = "largest figures of each piece of the motion, and RMS; below 0 torque brakes"
    return [Sheet(name="Pieces", columns=columns, rows=rows, still=3, note=note)]


def _cells(one: MotorPiece) -> dict[str, Any]:
    figures = {field: float(from_si(getattr(one, field), unit, kind)) for _, field, unit, kind in FIGURES}
    return {"case": one.case, "piece": one.name} | {name: None if isnan(x) else x for name, x in figures.items()}


def _pieces_csv(drive: DriveSet) -> Iterator[dict[str, Any]]:
    """A row for each figure of each piece."""
    for one in drive.pieces:
        name = "_".join(filter(None, (one.case, one.name))).replace(" ", "_")
        for head, field, unit, kind in FIGURES:
            value, title = getattr(one, field), f"{one.name}, {head}"
            yield figure_row("pieces", Figure(name=f"{name}_{field}", title=title, value=value, kind=kind, unit=unit))


PIECES = Section(
    name="pieces", title="The motor piece by piece", level=2, blocks=_pieces_blocks, sheets=_pieces_sheet,
    csv=CsvRows(of_drive=lambda content, _, drive: _pieces_csv(drive)),
)  # fmt: skip


# -- The drive over the load cycle: torque and speed, current and voltage, heat, energy.


def _unknown(subject: str) -> Text:
    reason = "the motor's current depends on figures that the catalogue does not know"
    return (f"{subject}: {reason} (", TableLink("unknown"), ").")


def _machine_words(content: Content, wheel: str, cases: str) -> str:
    """Words for a platform with wheels, for several load cases, or none."""
    return wheel if content.wheel else cases if content.cases else ""


# -- over the cycle


_VOLTAGE = (
    "Voltage is what the controller can give at the lowest voltage of the supply, with the winding at its highest "
    "temperature and at the ambient. Torque is that of the motor's shaft, its rotor's acceleration included; below 0 "
    "it brakes."
)
_PULL_OUT = (
    "Torque and speed of the stepper: its pull-out torque at the lowest voltage of the supply, and the part of it that "
    "the cycle may take by the factor of the spec. Torque is that of the motor's shaft, its rotor's acceleration "
    "included; below 0 it brakes."
)
_DOT = "The dot draws the RMS current of the cycle at its RMS speed."
_ON_PAGE = (
    "Shaded dark: allowed continuously; light: over short times, as rated for controller and gearhead; both with a hot "
    "winding."
)
_EFFICIENCY = (
    "Efficiency of motor and gearhead at constant speed, in per cent: copper losses at the mean temperature of the "
    "winding over the cycle, the motor's friction, and the gearhead's loss on the side that the power comes from. "
    "Where it brakes, the share of the power that reaches the supply. Dots, where there are few, are the ends of the "
    "cycle's segments."
)


def _cycle(content: Content) -> Iterator[Block]:
    best = content.drive
    if best is None:
        return
    if best.steps:
        yield Words("The rated current flows in the stepper's windings at any time, whatever the load.")
    elif "demand" not in content.drawings:
        yield Words(_unknown("The motor's current over time is unknown"))
    if best.figures:
        wheel = f"; energy and power of the supply as if every drive did what that of {content.wheel} does"
        cases = "; energy is that of the case as specified, the rest of the worst case"
        of = _machine_words(content, wheel, cases)
        yield Facts(f"Figures of the drive over the cycle{of}", [*map(figure_texts, best.figures)], halves=True)
    if "fields" in content.drawings:
        yield Picture("fields", f"The motor's torque-speed field with each load case alone. {_VOLTAGE} {_DOT}",
                      "torque-speed field of the motor with each load cycle",
                      about="sets each load case against the limits of the motor.")  # fmt: skip
    first = f" The load cycle is that of {content.cycles[0][0]}." if len(content.cycles) > TOGETHER else ""
    yield Picture("efficiency", _EFFICIENCY + first,
                  "efficiency of motor and gearhead over torque and speed with the load cycle",
                  about="shows the share of the power that arrives.", floats=True)  # fmt: skip
    cases = f", in the first {MOST_WHEELS} load cases" if len(content.cases) > MOST_WHEELS else ""
    of = "" if content.wheel else " those of the case as specified,"
    cut = " The longest stretch without change is left out." if len(stretches(content.cycles)) > 1 else ""
    yield Picture("demand", "Current and voltage of the motor over the cycle, at the mean temperature of the winding "
                  f"over the cycle{cases}. Limits are{of} without the margins that the spec requires.{cut}",
                  "current and voltage over the cycle with their limits",
                  about="shows current and voltage over time, as the checks by physics use them.",
                  floats=True)  # fmt: skip


def field_picture(content: Content) -> Picture:
    """The motor's torque-speed field with the load cycle in it."""
    more = ""
    if content.drive is not None and content.drive.steps:
        return Picture("field", _PULL_OUT, "torque-speed field of the stepper with the load cycle")
    if content.result.method == "paper":
        more += " The points of the paper are brought to the shaft as in (18), their speeds with the reserve of (1)."
    if "fields" in content.drawings and content.cycles[0][0]:
        more += f" The load cycle is that of {content.cycles[0][0]}; each load case has a diagram of its own below."
    return Picture(
        "field", f"Torque and speed of the motor: the shaded field is allowed continuously. {_VOLTAGE} {_DOT}{more}",
        "torque-speed field of the motor with the load cycle",
        on_page=f"Torque and speed of the motor. {_ON_PAGE} {_VOLTAGE} {_DOT}{more}")  # fmt: skip


CYCLE = Section(name="cycle", title="Over the cycle", level=2, blocks=_cycle, tabled=False)


# -- heat


def _heat(content: Content) -> Iterator[Block]:
    behaviour = content.behaviour
    if behaviour is None:
        return
    of = _machine_words(content, f" at {content.wheel}", " in the case as specified")
    yield Facts(f"Losses and temperatures{of}, in periodic steady state", behaviour.heat, "heat", halves=True)
    if behaviour.hottest is None:
        yield Words(f"The course of the temperatures over time is not drawn: {behaviour.heat_lacks}.")
        return
    several = len(behaviour.cycles) > 1
    worst = f" {'at' if content.wheel else 'in load case'} {behaviour.hottest[0]}, the warmest" if several else ""
    yield Picture("heat", f"Winding and housing{worst}. Left from cold to where less than 1 % of the rise remains, the "
                  "winding as a band between its lowest and its highest in each cycle; right the periodic steady "
                  "state, with its peak.", "temperatures of winding and housing from cold and over the cycle",
                  about="shows the motor warming up.")  # fmt: skip


HEAT = Section(name="heat", title="Heat", level=2, blocks=_heat, tabled=False)


# -- energy


def _energy(content: Content) -> Iterator[Block]:
    behaviour = content.behaviour
    if behaviour is None:
        return
    if not behaviour.energy.known:
        yield Words(_unknown("Unknown"))
        return
    kept = show(content.result.spec.supply.regeneration, "%", "dimensionless")
    yield Words(f"The cycle costs the supply {behaviour.cost}: drawn less what is regenerated and kept ({kept} of it, "
                "by the spec).")  # fmt: skip
    of = _machine_words(content, ", each at its wheel", ", as specified")
    yield Picture("energy", f"Energy of one cycle, all drives{of}. Each bar begins where the one above it ends.",
                  "losses and work in the energy of a cycle",
                  about="splits the energy that the supply gives in a cycle; the parts sum to the whole.")  # fmt: skip


ENERGY = Section(name="energy", title="Energy", level=2, blocks=_energy, tabled=False)


# -- The closed loop: its checks, figures and gains, its loops by linear theory, and the time series.


MOST_SAMPLES = 50_000  # of the time series: what a spreadsheet opens at once; the CSV report has all
LOOP_COLUMNS = (
    SheetColumn("of", "section"), SheetColumn("figure", "title"), SheetColumn("direction or case", "case"), *LIMITS,
)  # fmt: skip


def _loop_blocks(content: Content) -> Iterator[Block]:
    v = content.validation
    if v is None:
        return
    yield Words((f"{v.drive_set.label} over {driven_over(v)}: ", Status(v.status)))
    if v.checks:
        yield Checks(f"Checks of the {v.loop}", [*map(check_texts, sorted_by_part(v.checks))], "loop-checks",
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
    yield Pair([Facts(f"Figures of the {v.loop}", [*map(figure_texts, v.figures)])],
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


def _loop_csv(content: Content) -> Iterator[table.Row]:
    if content.validation:
        yield from table.closed_loop_rows(content.validation)


def _loop_title(content: Content) -> str:
    return content.validation.loop.capitalize() if content.validation else "Closed loop"


LOOP = Section(name="loop", title=_loop_title, blocks=_loop_blocks, sheets=_sheets, csv=CsvRows(after=_loop_csv))


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
