"""The drive at work: requirements of the load, its load cycle piece by piece, heat and energy, the closed loop."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import groupby
from math import isnan
from typing import TYPE_CHECKING, Any

from drivesizer.output.derivation import margin, step
from drivesizer.output.document import records as doc
from drivesizer.output.document.content import Content, OfDrives, OfLoop, driven_over
from drivesizer.output.document.rows import check_table, figures_table, requirements_table, tightest_table
from drivesizer.output.loop_table import LINEAR_LOOP, NO_LINEAR, gain_rows, left_out, loop_figures, loop_name
from drivesizer.results.check import sentence_case
from drivesizer.results.drive_set import DriveSet, Requirement
from drivesizer.units import show

if TYPE_CHECKING:
    from drivesizer.control.validation import Loop, Validation

# -- The requirements of the load: the paper's equations with the numbers put in, or the figures of the load cycle.


def derivation(content: Content) -> Iterator[doc.Block]:
    """Requirements of the load: equations with their numbers, or figures of the cycle."""
    from drivesizer.output.report.figures.cycle import stretches

    requirements, by_paper = content.result.requirements, content.result.method == "paper"
    notes = (
        "".join(f", {note}" for note in dict.fromkeys(r.note for r in requirements if r.note)) if not by_paper else ""
    )
    table = requirements_table(f"The {content.shaft}, of one drive{notes}", requirements, halves=True)
    yield doc.picture("sketch")
    if by_paper:
        yield from _equations(content)
        yield replace(table, media="listed")
        if content.drive and content.drive.requirements:
            at_motor = requirements_table(f"At the motor, for {content.drive.label}", content.drive.requirements)
            yield replace(at_motor, media="terminal")
    else:
        yield doc.Words(
            doc.sentence("of_wheels", wheel=content.wheel)
            if content.wheel
            else doc.sentence("of_cycle", shaft=content.shaft)
        )
        yield table
    many = len(content.cases)
    if content.wheel:
        first = ", of the first eight; the page has the others too" if many > 8 else ""
        words = f"Torque and speed of each driven wheel on the path{first}; those of equal demand are shown as one."
    else:
        first = ", in the first four load cases; the page has the others too" if many > 4 else ""
        words = f"Torque and speed of the {content.shaft} over the cycle, of one drive{first}."
    yield doc.picture("cycle", of=words, cut=_cut(len(stretches(content.cycles))),
                      about=doc.sentence(f"cycle_by_{content.result.method}"))  # fmt: skip


def _cut(stretches: int) -> str:
    return " On paper stretches without change are left out." if stretches > 1 else ""


def _equations(content: Content) -> Iterator[doc.Block]:
    yield doc.Words((
        f"Equation numbers are those of {doc.sentence('paper')}. {doc.sentence('forms')} "
        "The three factors that the paper calls ",
        doc.Math("eta", "η"), " are ", doc.Math('eta_"v"', "η_v"), " in (1), ", doc.Math('eta_"R"', "η_R"),
        " in (10) and ",
        doc.Math('eta_"g"', "η_g"),
        " in (17), (18).",
    ))  # fmt: skip
    load: Any = content.result.spec.load
    slope = str((content.result.spec.entered.get("load") or {}).get("slope", "")).strip()
    if slope.endswith("%"):
        yield doc.Words(f"The slope of {slope} is put in as its angle, {show(load.slope, 'deg', 'angle')}.")
    yield _compared(content)
    yield doc.Heading("Nominal force, torque and power", media="paper")
    for r in content.result.requirements:
        if r.name == "acceleration":
            yield doc.picture("paper_profile", "profile")
        if r.name == "wheel_mass":
            yield doc.Heading("Maximum torque and power", media="paper")
        yield _equation(r)
    if content.drive and content.drive.requirements:
        yield doc.Heading("At the motor shaft", media="paper")
        yield doc.Words(f"For {content.drive.label}.", media="paper")
        yield from map(_equation, content.drive.requirements)


def _compared(content: Content) -> doc.Table:
    """The figures that the paper gives first, in its order: nominal and maximum force, torque and power."""
    of_drive = content.drive.requirements if content.drive else ()
    quantities = {
        r.name: doc.Quantity(float(r.value), r.unit, r.kind) for r in (*content.result.requirements, *of_drive)
    }
    load: Any = content.result.spec.load
    if "maximum_torque" in quantities:
        quantities["maximum_force"] = doc.Quantity(
            2.0 * quantities["maximum_torque"].value / load.wheel_diameter, "N", "force"
        )
    rows = [
        doc.Row({"title": title, "note": note, "nominal": quantities.get(nominal, ""), "maximum": quantities[most],
                 "rms": quantities.get(rms, "")}, name=most.removeprefix("maximum_"))
        for title, nominal, most, rms, note in doc.texts("paper order") if most in quantities
    ]  # fmt: skip
    caption = "In the order of the paper's section 3.1; the largest force is the largest torque at the wheels' radius"
    return doc.table("compared", caption, rows)


def _equation(r: Requirement) -> doc.Equation:
    value = None if isnan(r.shown) else r.shown
    return doc.Equation(step(r) | {"exact": {"name": r.name, "value": value}})


# -- The motor's own torque piece by piece of the motion: accelerate, run, brake, rest, and over the whole cycle.


def pieces(_: OfDrives, drive: DriveSet) -> Iterator[doc.Block]:
    """The motor in each piece of the motion."""
    for case, pieces in groupby(drive.pieces, key=lambda piece: piece.case):
        of = f" in load case {case}" if case else ""
        rows = [replace(doc.row("pieces", piece, name="_".join(filter(None, (case, piece.name))).replace(" ", "_"),
                                title=piece.name), total=piece.name == "cycle") for piece in pieces]  # fmt: skip
        caption = f"The motor in each piece of the motion{of}: largest figures, and RMS; below 0 torque brakes."
        yield doc.table("pieces", caption, rows)


# -- The drive over the load cycle: torque and speed, current and voltage, heat, energy.


def field(content: Content) -> Iterator[doc.Block]:
    """The motor's torque-speed field with the load cycle in it."""
    if content.drive is None:
        return
    if content.drive.steps:
        yield doc.picture("pull_out", "field")
        return
    more = ""
    if content.result.method == "paper":
        more += " The points of the paper are brought to the shaft as in (18), their speeds with the reserve of (1)."
    if "fields" in content.pictures and content.cycles[0][0]:
        more += f" The load cycle is that of {content.cycles[0][0]}; each load case has a diagram of its own below."
    yield doc.picture("field", more=more)


def _unknown(subject: str) -> doc.Words:
    return doc.Words((f"{subject}: {doc.sentence('without_current')} (", doc.TableLink("unknown"), ")."))


def cycle(of: OfDrives, drive: DriveSet) -> Iterator[doc.Block]:
    """Figures of a drive over the cycle."""
    if drive.steps:
        yield doc.Words("The rated current flows in the stepper's windings at any time, whatever the load.")
    if drive.figures:
        wheel = f"; energy and power of the supply as if every drive did what that of {of.wheel} does"
        words = of.of_machine(wheel, "; energy is that of the case as specified, the rest of the worst case")
        yield figures_table(f"Figures of the drive over the cycle{words}", drive.figures, halves=True)


def cycle_pictures(content: Content) -> Iterator[doc.Block]:
    """Field, efficiency, current and voltage as figures."""
    from drivesizer.output.report.figures.cycle import MOST_WHEELS, TOGETHER, stretches

    best = content.drive
    if best is None:
        return
    if not best.steps and "demand" not in content.pictures:
        yield _unknown("The motor's current over time is unknown")
    if "fields" in content.pictures:
        yield doc.picture("fields")
    first = f" The load cycle is that of {content.cycles[0][0]}." if len(content.cycles) > TOGETHER else ""
    yield doc.picture("efficiency", first=first)
    cases = f", in the first {MOST_WHEELS} load cases" if len(content.cases) > MOST_WHEELS else ""
    of = "" if content.wheel else " those of the case as specified,"
    yield doc.picture("demand", cases=cases, of=of, cut=_cut(len(stretches(content.cycles))))


def heat(content: Content) -> Iterator[doc.Block]:
    """Losses and temperatures, and the way to them."""
    behaviour = content.behaviour
    if behaviour is None:
        return
    of = content.of_drives.of_machine(f" at {content.wheel}", " in the case as specified")
    yield figures_table(
        f"Losses and temperatures{of}, in periodic steady state", behaviour.heat, "heat", name="heat", halves=True
    )
    if behaviour.hottest is None:
        yield doc.Words(f"The course of the temperatures over time is not drawn: {behaviour.heat_lacks}.")
        return
    several = len(behaviour.cycles) > 1
    worst = f" {'at' if content.wheel else 'in load case'} {behaviour.hottest[0]}, the warmest" if several else ""
    yield doc.picture("heat", worst=worst)


def energy(content: Content) -> Iterator[doc.Block]:
    """The energy of a cycle and where it goes."""
    behaviour = content.behaviour
    if behaviour is None:
        return
    if not behaviour.energy.known:
        yield _unknown("Unknown")
        return
    share = show(content.result.spec.supply.regeneration, "%", "dimensionless")
    yield doc.Words(f"The cycle costs the supply {behaviour.cost}: drawn less what is regenerated and kept ({share} of "
                "it, by the spec).")  # fmt: skip
    of = content.of_drives.of_machine(", each at its wheel", ", as specified")
    yield doc.picture("energy", of=of)


# -- The closed loop: its verdict and tightest checks first, what helps, then all checks, figures, gains and courses.


def loop(content: Content | OfLoop) -> Iterator[doc.Block]:
    """Verdict of a closed loop, its tightest checks and what helps."""
    v = content.validation
    if v is None:
        return
    yield doc.Words(
        (f"{v.drive_set.label} over {driven_over(v)}: ", doc.Status(v.status), f" {v.failed}" if v.failed else "")
    )
    if v.checks:
        count = len([check for check in v.checks if not check.advice])
        yield replace(
            tightest_table(f"In {v.loop}: the tightest of {count} checks", v.checks, "loop-tightest"), media="terminal"
        )
    if v.linear:
        figures = []
        for linear, engine in v.linear.figures:
            if engine and not isnan(linear.value + engine.value):
                values = " and ".join(show(figure.value, figure.unit, figure.kind) for figure in (linear, engine))
                figures.append(f"{linear.title[0].lower()}{linear.title[1:]} {values}")
        yield doc.Words(f"{LINEAR_LOOP}: {'; '.join(figures) or 'no figure that figures have'}.", media="terminal")
    if v.tried:
        yield remedies(v)


def remedies(v: Validation, axis: str = "") -> doc.Table:
    """Changes that help a drive that fails in its loop, and those that were tried in vain."""
    rows = []
    for remedy in sorted(v.tried, key=lambda remedy: remedy.status == "fail"):
        tight = f"{sentence_case(remedy.tightest.title)} {margin(remedy.tightest.margin)}" if remedy.tightest else ""
        rows.append(doc.row("remedies", remedy, name="", tight=tight))
    helps = any(remedy.status != "fail" for remedy in v.tried)
    caption = "What helps in the loop, each simulated by itself" if helps else "Nothing that was simulated helps"
    return doc.table("remedies", f"{axis}: {sentence_case(caption)}" if axis else caption, rows)


def loop_details(content: Content | OfLoop) -> Iterator[doc.Block]:
    """Checks, figures, gains and courses of a closed loop."""
    v = content.validation
    if v is None:
        return
    from drivesizer.output.report.figures.cycle import closed_loop_rows
    from drivesizer.output.report.figures.style import windows

    if v.checks:
        yield check_table(f"Checks of the {v.loop}", v.checks, "loop-checks", grouped=True, record="validation")
    if v.linear:
        yield doc.picture("diagram")
    *first, last = [title for _, title in closed_loop_rows(v)]
    titles = f"{', '.join(first)} and {last}" if first else last
    stretches = windows(v.series["time"], v.series["speed_reference"])
    yield doc.picture("loop", loop=v.loop, shown=titles, cut=_cut(len(stretches)))
    rule = f"{v.gains.rule}. Source: {v.gains.source}."
    gains = []
    for gain in gain_rows(v.gains):
        period = gain.unit == "s"
        value = doc.Quantity(gain.value, "ms", "time") if period else doc.Quantity(gain.value, gain.unit, "plain")
        gains.append(doc.row("gains", gain, value=value, note=rule))
    yield doc.Pair([figures_table(f"Figures of the {v.loop}", v.figures, "validation")],
                   [doc.table("gains", f"{v.set_up} of the controller", gains),
                    doc.Words(f"Rule of the {v.set_up.lower()}: {rule}", "note")])  # fmt: skip
    if v.controller_gains:
        own = [
            doc.row("controller_gains", g, name=g.place, value=doc.Quantity(g.value, g.unit, own=f"{g.value} {g.unit}"))
            for g in v.controller_gains
        ]
        yield doc.table("controller_gains", "The same gains as they are written into the controller", own)
    yield from _linear_run(v)
    if v.assumptions:
        yield doc.Bullets("Assumptions of the simulation:", list(v.assumptions))
    if v.warnings:
        yield doc.Bullets("Warnings of the simulation:", list(v.warnings))
    columns_of = {name: (values, *v.series_units[name]) for name, values in v.series.items()}
    yield doc.Series("Time series", "timeseries", columns_of, _CHART_COLUMNS)


_CHART_COLUMNS = ("speed_reference", "speed", "current", "load_angle")


def _linear_run(v: Validation) -> Iterator[doc.Block]:
    """The same by python-control, beside the engine."""
    if v.linear is None:
        yield doc.Words(NO_LINEAR, "note")
        return
    rows = []
    for pair in v.linear.figures:
        cells: dict[str, doc.Cell] = {"title": pair.linear.title}
        for key, f in (("linear", pair.linear), ("engine", pair.engine)):
            known = f is not None and not isnan(f.value)
            cells[key] = doc.Quantity(f.value, f.unit, f.kind) if f is not None and known else "–"
            cells[f"{key}_at"] = (
                doc.Quantity(f.at_time, "s", "time") if f is not None and known and f.at_time is not None else ""
            )
        rows.append(doc.Row(cells, name=pair.linear.name))
    yield doc.table("linear_run", LINEAR_LOOP, rows)
    yield doc.Words(left_out(v.linear), "note")


def linear_loops(content: Content | OfLoop) -> Iterator[doc.Block]:
    """Loops by linear theory."""
    loops = content.validation.loops if content.validation else ()
    if not loops:
        return
    directed, unstable = any(loop.direction for loop in loops), any(not loop.stable for loop in loops)
    yield doc.Words(doc.sentence("linear", power=doc.sentence("power_directed") if directed else ""))
    figures = [doc.Column(f.name, f.title, "number", yields=n > 5) for n, f in enumerate(loop_figures(loops[0]))]
    yield doc.table("loops", "The loops by linear analysis, from the inside out; gain margin as a factor",
                    map(_loop_row, loops), more=figures)  # fmt: skip
    none = " An unstable loop has no margins." if unstable else ""
    yield doc.picture("bode", line=f" {doc.sentence('bode_directed')}" if directed else "", none=none)
    yield doc.picture("step")


def _loop_row(loop: Loop) -> doc.Row:
    """A loop by its figures: three digits, the pole's modulus with four; a dash where one does not exist."""
    name: doc.Text = loop_name(loop) if loop.stable else (f"{loop_name(loop)} ", doc.Strong("unstable"))
    cells: dict[str, doc.Cell] = {"title": name, "case": loop.direction}
    for f in loop_figures(loop):
        digits = 4 if f.name == "pole_radius" else 3
        cells[f.name] = doc.Quantity(f.value, f.unit, f.kind, digits, own="–" if isnan(f.value) else "")
    return doc.Row(cells, name=loop.name, status="pass" if loop.stable else "fail")
