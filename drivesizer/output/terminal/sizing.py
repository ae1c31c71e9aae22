"""A sizing, an explanation and a validation at the terminal: drives, machine, motion, loops, probabilities."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import TYPE_CHECKING

from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from drivesizer.catalog import Catalog
from drivesizer.control.validation import LinearRun, Loop
from drivesizer.output.loop_table import BESIDE, cell, linear_rows, loop_figures, loop_name
from drivesizer.output.tables import FIGURES, by_case, changes_by_outcome, consumer_rows, most_fail_on, not_enough
from drivesizer.output.terminal import tables
from drivesizer.output.terminal.answer import next_commands, recommended, side_by_side
from drivesizer.output.terminal.tables import MARK, STYLE, bare, percent, width_of
from drivesizer.output.words import confidence, likely, loop_text, meeting, moved, number_of
from drivesizer.results.check import Reliability, Uncertainty, sentence_case
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import DriveSet, MotorPiece
from drivesizer.results.sizing import Explanation, SizingResult, objective_figure, ranked_by, verdict, worst
from drivesizer.spec.drive import OBJECTIVES
from drivesizer.units import label, show

if TYPE_CHECKING:
    from drivesizer.control.validation import Validation

__all__ = ["DETAILS", "explained", "loops", "sizing", "tolerances", "validation", "validations"]


# -- The motor piece by piece at the terminal.


_SHOWN = [figure for figure in FIGURES if figure[1] not in ("start", "rms_current")]  # what 80 characters hold


def pieces(found: Sequence[MotorPiece], title: str) -> Table:
    """The motor piece by piece of the motion, each unit in its column's head."""
    heads = [(f"{head}\n{label(unit)}", "right") for head, _, unit, _ in _SHOWN]
    table = bare(("", "left"), *heads, title=title)
    for one in found:
        cells = (show(getattr(one, field), unit, kind, 3) for _, field, unit, kind in _SHOWN)
        table.add_row(one.name, *(cell.split(" ")[0] for cell in cells))
    return table


# -- The machine with a drive at the terminal: budgets, masses, consumers and the battery.


def _masses(found: DriveSet) -> Table:
    """Masses of the machine, part by part."""
    table = tables.bare(("", "left"), ("", "right"), ("mass", "right"), title="Masses")
    for row in found.masses:
        number = f"{row.number} x {row.text(row.each, 'g')}" if row.number > 1 and row.each == row.each else ""
        table.add_row(row.name, number, row.text(row.total, "kg"))
    return table


def machine(console: Console, found: DriveSet) -> None:
    """Print the budgets of the machine with a drive, and what it regenerates; nothing where there is neither."""
    if found.budget:
        console.print(tables.checks(found.budget, "The machine with this drive"))
    if found.masses:
        console.print(_masses(found))
    if found.machine:
        console.print(tables.loose(found.machine, "The machine"))
    if found.energy:
        heads = ("", "right"), ("mean", "right"), ("peak", "right"), ("on", "right"), ("", "left")
        table = tables.bare(("consumer", "left"), *heads, title=f"From the battery: {found.energy.battery}")
        for row in consumer_rows(found.energy):
            table.add_row(*row)
        console.print(table)
        console.print(tables.loose(found.energy.figures, "The battery"))
        if found.energy.assumptions:
            assumed = "; ".join(found.energy.assumptions)
            console.print(Text(f"Assumptions of the energy budget: {assumed}.\n", style="dim"))
    if found.braking:
        resistor = f"; brake resistor {found.braking.name}" if found.braking.name else ""
        console.print(tables.loose(found.braking.figures, f"Regenerated energy{resistor}"))


# -- The loops of a validation at the terminal: a line each.


_FIRST = 6  # figures that 80 columns have room for


def loops(found: Sequence[Loop], width: int) -> Table:
    """Linear analysis of each loop, innermost first."""
    every = len(loop_figures(found[0]))
    for shown, line in ((every, " "), *((n, "\n") for n in range(every, _FIRST, -1))):
        table = _loop_lines(found, shown, line)
        if width_of(table) <= width:
            return table
    return _loop_lines(found, _FIRST, "\n")


def linear(run: LinearRun) -> Table:
    """The simulation by python-control beside the engine's, a line for each figure."""
    heads = (("", "left"), ("python-control", "right"), ("at", "right"), ("engine", "right"), ("at", "right"))
    table = bare(*heads, title=BESIDE)
    for row in linear_rows(run):
        table.add_row(*row)
    return table


def _loop_lines(found: Sequence[Loop], shown: int, line: str) -> Table:
    """The first figures of each loop; its name and direction on a line or on two."""
    heads = [figure.title.replace(" ", "\n") for figure in loop_figures(found[0])[:shown]]
    table = bare(
        ("loop", "left"), *((head, "right") for head in heads), title="Linear analysis of the loops, by python-control"
    )
    for loop in found:
        name = Text(loop_name(loop).replace(" ", line))
        if not loop.stable:
            name += Text("\nUNSTABLE", style=STYLE["fail"])
        table.add_row(name, *(cell(figure) for figure in loop_figures(loop)[:shown]))
    return table


# -- Probabilities at the terminal: of each drive, of the best one's checks, and the largest influences.


_DRIVERS = 3
_NEAR = 0.0995  # margin below which its tenths are shown


def below_confidence(result: SizingResult) -> str:
    """The sentence that no drive reaches the required confidence."""
    wanted = result.uncertainty.confidence if result.uncertainty else None
    return f"No drive reaches the confidence of {confidence(wanted)}."


def tolerances(console: Console, result: SizingResult, *, quiet: bool = False) -> None:
    """Print the probabilities of a sizing; nothing where no tolerances were sampled."""
    uncertain = result.uncertainty
    if uncertain is None or not (result.sets or result.unsure):
        return
    if result.sets:
        console.print(_probability_table(result.sets, "Probability that all checks pass"))
    if result.unsure:
        console.print(
            _probability_table(
                result.unsure, f"Pass at nominal figures, below the confidence of {confidence(uncertain.confidence)}"
            )
        )
    best = next(iter((*result.sets, *result.unsure)))
    if best.reliability and not quiet:
        named = f"Drive {best.rank}" if len(result.sets) + len(result.unsure) > 1 else "The drive"
        _drive_reliability(console, best.reliability, f"{named}, check by check")
        console.print(_assumed(uncertain))
    _summary(console, uncertain, quiet=quiet)


def tolerances_of(console: Console, pair: Explanation) -> None:
    """Print the probabilities of a combination with each belt ratio; nothing where no tolerances were sampled."""
    if pair.uncertainty is None:
        return
    console.print(_probability_table(pair.sets, "Probability that all checks pass"))
    for one in pair.sets:
        if one.reliability:
            _drive_reliability(console, one.reliability, one.label if len(pair.sets) > 1 else "Check by check")
    console.print(_assumed(pair.uncertainty))
    _summary(console, pair.uncertainty, quiet=False)


_FIGURES = (("all pass", "right"), ("weakest check", "left"), ("margin\n5 %", "right"), ("margin\n50 %", "right"))


def _probability_table(sets: Sequence[DriveSet], title: str) -> Table:
    """Two lines for a drive: probability over its error, motor over gearhead."""
    loops = [("in closed\nloop", "right")] if any(one.reliability and one.reliability.loop for one in sets) else []
    table = tables.bare(("", "right"), ("drive", "left"), *_FIGURES, *loops, title=title)
    _unbroken(table)
    for one in sets:
        found = one.reliability
        if found is None:
            continue
        table.add_row(
            str(one.rank), _named(one), _all_pass(found), _weakest(found),
            _margin(found.low), _margin(found.middle), *[_loop(found)][: len(loops)],
        )  # fmt: skip
    return table


def _unbroken(table: Table) -> None:
    """Let only columns of words become narrow: figures do not wrap."""
    for column in table.columns:
        column.no_wrap = column.justify == "right"


def _named(one: DriveSet) -> Text:
    """Motor and gearhead, with the belt where there is one."""
    belt = f" × {one.belt_name}" if one.belt_name else ""
    return Text(f"{one.motor_name}\n{one.gearhead_name}{belt}")


def _all_pass(found: Reliability) -> str:
    """Probability that all checks pass; where that is unknown, that none of the known ones fails."""
    return _chance(found.probability, found.error, found.unknown)


def _chance(probability: float, error: float, unknown: tuple[str, ...]) -> str:
    if unknown:
        return f"unknown; none\nfails: {likely(probability)}"
    return f"{likely(probability)}\n± {100 * error:.2g} %"


def _weakest(found: Reliability) -> Text:
    """The weakest check, that of the closed loop where it fails, and the checks that stay unknown."""
    loop = loop_text(found)
    unknown = f"\nunknown: {'; '.join(found.unknown)}" if found.unknown else ""
    return Text(found.weakest + (f"\n{loop}" if loop else "")) + Text(unknown, style="yellow")


def _loop(found: Reliability) -> str:
    """Probability in closed loop, with its own error."""
    return _chance(found.loop.probability, found.loop.error, found.loop.unknown) if found.loop else "–"


def _margin(value: float) -> str:
    """A margin, to a tenth of a per cent near the limit.

    >>> _margin(-0.0034), _margin(0.213)
    ('-0.3 %', '+21 %')
    """
    if not isfinite(value):
        return "–"
    return f"{100 * value:+.1f} %" if abs(value) < _NEAR else percent(value)


def _drive_reliability(console: Console, found: Reliability, title: str) -> None:
    console.print(_spreads(found, title))
    if found.figures:
        console.print(_figures(found))
    if found.drivers:
        console.print(_drivers(found))


def _spreads(found: Reliability, title: str) -> Table:
    """The checks of a drive that vary over the samples, most failures first."""
    heads = ("check", "left"), ("passes", "right"), ("margin 5 %", "right"), ("50 %", "right"), ("95 %", "right")
    table = tables.bare(*heads, title=title)
    _unbroken(table)
    for one in moved(found):
        table.add_row(one.title, likely(one.passes), *(_margin(value) for value in (one.low, one.middle, one.high)))
    return table


def _figures(found: Reliability) -> Table:
    """Percentiles of current, voltage, power, heat and temperature over the samples."""
    table = tables.bare(
        ("figure", "left"), *((f"{q} %", "right") for q in (5, 50, 95)), title="Figures over the samples"
    )
    _unbroken(table)
    for one in found.figures:
        table.add_row(one.title, *one.texts)
    return table


def _drivers(found: Reliability) -> Table:
    """The assumptions with the largest influence on its smallest margin."""
    heads = ("assumption", "left"), ("share", "right"), ("from", "right"), ("to", "right"), ("smallest margin", "right")
    table = tables.bare(*heads, title="Largest influences on its smallest margin")
    _unbroken(table)
    for one in found.drivers[:_DRIVERS]:
        moves = f"{_margin(one.low_margin)} … {_margin(one.high_margin)}"
        table.add_row(one.title, f"{100 * one.share:.0f} %", one.low, one.high, moves)
    return table


def _assumed(found: Uncertainty) -> Table:
    """The uncertain figures."""
    table = tables.bare(("figure", "left"), ("tolerance", "left"), ("source", "left"), title="Uncertain figures")
    for one in found.assumptions:
        table.add_row(one.title, Text(one.text), one.source)
    return table


def _summary(console: Console, found: Uncertainty, *, quiet: bool) -> None:
    drives = "1 drive" if found.examined == 1 else f"{found.examined} drives"
    console.print(f"{drives} sampled, {found.samples:,} times each (seed {found.seed}){_reached(found)}.")
    for note in () if quiet else found.notes:
        console.print(Padding(Text(note), (0, 0, 0, 2)))
    console.print()


def _reached(found: Uncertainty) -> str:
    """Number of drives that reach the required confidence."""
    if found.confidence is None:
        return ""
    wanted = confidence(found.confidence)
    if found.examined == 1:
        return f": {'reaches' if found.reached else 'below'} the confidence of {wanted}"
    return f", {found.reached or 'none'} of them at or above the confidence of {wanted}"


# -- A sizing, an explanation and a validation at the terminal.


DETAILS = frozenset({"derivation", "checks", "paper", "ranking", "rejected"})
"""Details that :func:`sizing` shows on request beside the answer."""


def sizing(result: SizingResult, *, details: frozenset[str] = frozenset(), spec: str = "", quiet: bool = False) -> None:
    """Print a sizing: the drive, its verdict and tightest checks, alternatives, and the commands that lead on.

    Parameters
    ----------
    result
        The sizing.
    details
        Shown beside the answer, of ``DETAILS``.
    spec
        The file as it was named at the command line, for the commands that lead on; empty for the default.
    quiet
        Only the drive.
    """
    console = tables.console()
    best = next(iter((*result.sets, *result.unsure)), None)
    tables.heading(console, result.spec.name, *((MARK[best.status], STYLE[best.status]) if best else ("no drive", "")))
    if best is None:
        _no_drive(console, result, whole="checks" in details)
    else:
        if not result.sets:
            said = f"{below_confidence(result)} The most probable, at nominal figures:"
            console.print(Text(said, style="bold red"))
        recommended(console, result, best)
        _physics_verdict(console, result, best)
        _details(console, result, best, details)
    if result.sets and not quiet:
        shown = (*result.sets[:1], *result.alternatives) if result.alternatives else ()
        side_by_side(console, shown, result.objective, "Beside other motor families")
    if "ranking" in details and len(result.sets) > 1:
        side_by_side(console, result.sets, result.objective, "Best first")
    if result.front:
        console.print(_front(result))
    elif result.pareto:
        console.print(f"No Pareto front: no drive that passes has known values of {', '.join(result.pareto)}.")
    tolerances(console, result, quiet="checks" not in details)
    if result.misses and ("rejected" in details or best is None):
        console.print(_rejected(result.misses))
    _tally(console, result, whole="rejected" in details or best is None)
    if best and not quiet:
        next_commands(console, spec, loop="open loop" if best.steps else "closed loop")


def _physics_verdict(console: Console, result: SizingResult, best: DriveSet) -> None:
    """The verdict by physics and the checks that decide it, if the paper's rule ranked."""
    if result.method != "paper" or not best.beside:
        return
    status = verdict(best.beside)
    which = ", ".join(sentence_case(check.title) for check in best.beside if check.status == status != "pass")
    words = Text("Ranked by the paper's equations and rule; by physics ") + Text(MARK[status], style=STYLE[status])
    console.print(words + Text(f" ({which})" if which else ""))


def _details(console: Console, result: SizingResult, best: DriveSet, details: frozenset[str]) -> None:
    """Requirements, parts in full, checks, and those of the other method, as far as they are wanted."""
    if "derivation" in details:
        place = "wheel" if result.spec.load.kind == "wheeled_vehicle" else "load"
        console.print(tables.requirements(result.requirements, f"Requirements at the {place}"))
        if best.requirements:
            console.print(tables.requirements(best.requirements, "Requirements at the motor"))
    if "checks" in details:
        console.print(tables.parts(best, result.catalog))
        _checks(console, best)
        machine(console, best)
    if "paper" in details:
        _other_method(console, best)


_METHODS = {"paper": "by the paper's equations and rule", "physics": "by physics, over the whole load cycle"}


def _checks(console: Console, found: DriveSet) -> None:
    """The checks of the method that ranked, and figures without a limit."""
    console.print(tables.checks(found.checks, f"Checks {_METHODS[found.checks[0].method]}"))
    if found.figures:
        console.print(tables.loose(found.figures, "Operating figures"))
    for case, of in by_case(found.pieces):
        console.print(pieces(of, "The motor piece by piece" + (f", {case}" if case else "")))


def _other_method(console: Console, found: DriveSet) -> None:
    """The checks of the other method, and both where the limit is the same."""
    if found.beside:
        console.print(tables.checks(found.beside, f"The same drive {_METHODS[found.beside[0].method]}"))
        console.print(_both_methods(found))


def _both_methods(found: DriveSet) -> Table:
    """Limits that both methods check: both demands, and why they differ."""
    table = tables.bare(
        ("", "left"), ("paper", "right"), ("physics", "right"), ("why they differ", "left"), title="Both methods"
    )
    for pair in found.comparison:
        figures = []
        for check in (pair.paper, pair.physics):
            mark = f"\n{MARK[check.status]}" if pair.paper.status != pair.physics.status else ""
            figures.append(Text(check.shown(check.demand) + mark))
        table.add_row(pair.paper.title, *figures, pair.why)
    return table


def _no_drive(console: Console, result: SizingResult, *, whole: bool) -> None:
    """The changes that would let a drive pass, and the checks on which the closest rejected fails; or all of them."""
    console.print(Text("No drive meets all limits.", style="bold red"))
    if failure := most_fail_on(result):
        console.print(failure)
    for title, changes in changes_by_outcome(result.relaxations, "a drive"):
        console.print(title)
        for r in changes:
            console.print(Text(f"  {r.field} {r.now} → {r.needed}: {r.set_label}"))
    if not result.relaxations and result.counts.considered:
        console.print(not_enough(result))
    if not result.counts.considered:
        console.print("  The families and parts that the spec names leave no listed combination of motor and gearhead.")
    if result.misses:
        closest = result.misses[0]
        console.print()
        failed = [check for check in closest.own_checks if check.status == "fail"]
        shown = closest.checks if whole else failed or [c for c in closest.own_checks if c.status != "pass"]
        console.print(tables.checks(shown, f"Closest rejected: {closest.label}"))
        if required := tables.required(closest):
            console.print(required)
            console.print()
        if whole:
            machine(console, closest)


def _gearhead(found: DriveSet, among: tuple[DriveSet, ...]) -> str:
    """Gearhead and its reduction, with the belt's ratio where the drives differ in it."""
    belt = f" × {found.belt_name or 1}" if len({s.belt_ratio for s in among}) > 1 else ""
    return f"{found.gearhead_name}{belt}"


def _rejected(misses: tuple[DriveSet, ...]) -> Table:
    """The closest rejected, each with its worst check."""
    table = tables.bare(
        ("motor", "left"), ("gearhead", "left"), ("fails on", "left"), ("demand", "right"), ("limit", "right"),
        title="Closest rejected",
    )  # fmt: skip
    for found in misses:
        missed = [check for check in found.deciding if check.status != "pass"]
        failed = [check for check in missed if check.status == "fail"] or missed
        check = worst(tuple(failed)) or failed[0]
        others = {1: "", 2: " and 1 more check"}.get(len(failed), f" and {len(failed) - 1} more checks")
        table.add_row(
            found.motor_name,
            _gearhead(found, misses),
            check.title + others,
            tables.plain(check, check.demand),
            tables.plain(check, check.limit),
        )
    return table


def _front(result: SizingResult) -> Table:
    """Drives that no other beats in all objectives."""
    heads = [(name.replace("_", " "), "right") for name in result.pareto]
    table = tables.bare(("motor", "left"), ("gearhead", "left"), *heads, title="Pareto front")
    for found in result.front:
        table.add_row(
            found.motor_name, _gearhead(found, result.front),
            *(objective_figure(found, name).text for name in result.pareto),
        )  # fmt: skip
    return table


def _tally(console: Console, result: SizingResult, *, whole: bool) -> None:
    """Number of drives that were considered and that meet all limits; what the others fail on, where it is wanted."""
    counts = result.counts
    drives = number_of(counts.considered, "drive")
    shown = (*result.sets, *result.unsure)
    best = next(iter(shown), None)
    some = 0 < counts.judged < counts.feasible
    said = meeting(counts, best.status if best else None, " of the drive" if some else "")
    said += f", {counts.judged:,} were checked in the machine" if some else ""
    said += f", {ranked_by(result.objective, shown)}" if counts.feasible > 1 else ""
    console.print(f"{drives} considered, {said}.")
    if whole and counts.failed_by:
        console.print("The others fail on:" if counts.feasible else "They fail on:")
        for name, count in sorted(counts.failed_by.items(), key=lambda item: -item[1]):
            console.print(f"  {count:>8,}  {_title(name, result.method)}")
    if whole and counts.failed_by_budget:
        console.print(f"Of {counts.judged:,} checked in the machine, best first, some fail on:")
        for name, count in sorted(counts.failed_by_budget.items(), key=lambda item: -item[1]):
            console.print(f"  {count:>8,}  {sentence_case(CHECKS['budget'][name].title)}")
    if result.unrestricted:
        console.print(Text(_unrestricted(result.unrestricted, result.objective)))


def _title(name: str, method: str) -> str:
    return "not the largest reduction" if name == "largest_reduction" else sentence_case(CHECKS[method][name].title)


def _unrestricted(other: DriveSet, objective: str) -> str:
    """The best drive of the whole catalogue, in a sentence."""
    brake = f", brake {other.brake.part}" if other.brake else ""
    encoder = f", encoder {other.encoder.part}" if other.encoder else ""
    controller = f", controller {other.controller.family}" if other.controller else ""
    words = f"{objective} {tables.objective(other, objective)}".replace("_", " ").replace("\n", " ")
    value = f": {words}" if objective in OBJECTIVES else ""
    return (
        f"Without the families and parts that the spec names, the whole catalogue gives {other.label}{brake}{encoder}"
        f"{controller}{value}."
    )


def explained(pair: Explanation, catalog: Catalog) -> None:
    """Print a combination of motor and gearhead check by check, for every belt ratio, and its probabilities."""
    console = tables.console()
    for found in pair.sets:
        tables.heading(console, found.label, MARK[found.status], STYLE[found.status])
        console.print(tables.parts(found, catalog))
        if found.requirements:
            console.print(tables.requirements(found.requirements, "Requirements at the motor"))
        _checks(console, found)
        for line in tables.missing(found):
            console.print(line)
        _other_method(console, found)
        machine(console, found)
        _changes(console, found)
    tolerances_of(console, pair)


_NO_CHANGE = {
    "physics": "None of the spec's figures, changed alone by up to a factor of 20, would let it pass.",
    "paper": "No other reduction of the gearhead's family would let it pass.",  # by that rule no figure is tried
}


def _changes(console: Console, found: DriveSet) -> None:
    """Changes of the spec that would let a failing drive pass."""
    if found.status != "fail":
        return
    if not found.changes:
        console.print(_NO_CHANGE[found.checks[0].method])
        return
    for title, changes in changes_by_outcome(found.changes, "it"):
        console.print(title.removesuffix(":") + ", smallest first:")
        for change in changes:
            console.print(Text(f"  {change.field} {change.now} → {change.needed}"))


def validation(proof: Validation) -> None:
    """Print a validation, in closed loop or of a stepper."""
    from drivesizer.output.loop_table import NO_LINEAR, left_out  # with what a sizing need not load

    console = tables.console()
    tables.heading(console, f"{proof.spec.name}: {proof.over}", MARK[proof.status], STYLE[proof.status])
    console.print(Text(proof.drive_set.label))
    console.print(tables.gains(proof))
    console.print(tables.checks(proof.checks, f"Checks in {proof.loop}"))
    if proof.tried:
        console.print(tables.tried(proof))
    console.print(tables.loose(proof.figures, f"Figures of the {proof.loop}"))
    if proof.loops:
        console.print(loops(proof.loops, console.width))
    if proof.linear:
        console.print(linear(proof.linear))
        console.print(left_out(proof.linear))
    else:
        console.print(NO_LINEAR)


def validations(proofs: Sequence[Validation], objective: str) -> None:
    """Print several drives in closed loop, a line each, best first."""
    console = tables.console()
    first = proofs[0]
    tables.heading(
        console, f"{first.spec.name}: {first.profile}", f"{number_of(len(proofs), 'drive')} in {first.loop}", ""
    )
    table = tables.bare(
        ("", "right"), ("was", "right"), ("drive", "left"), (objective.replace("_", " "), "right"),
        ("tightest", "right"), ("", "left"),
    )  # fmt: skip
    for place, proof in enumerate(proofs, 1):
        tight = worst(proof.checks)
        table.add_row(
            str(place), str(proof.drive_set.rank), Text(proof.drive_set.label),
            tables.objective(proof.drive_set, objective),
            f"{tight.title} {percent(tight.margin)}" if tight else "–",
            Text(MARK[proof.status], style=STYLE[proof.status]),
        )  # fmt: skip
    console.print(table)
