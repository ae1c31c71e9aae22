"""A sizing, an explanation and a validation at the terminal."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from drivesizer.catalog import Catalog, Controller, Encoder
from drivesizer.control.validation import Validation
from drivesizer.output.terminal import tables as tables
from drivesizer.output.terminal.loops import loops
from drivesizer.output.terminal.machine import machine
from drivesizer.output.terminal.reliability import below_confidence, tolerances, tolerances_of
from drivesizer.output.terminal.tables import MARK, STYLE, percent
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.objectives import objective_figure
from drivesizer.results.sizing import Explanation, SizingResult, verdict, worst
from drivesizer.spec.select import OBJECTIVES
from drivesizer.units import show

__all__ = ["explained", "sizing", "validation", "validations"]


def sizing(result: SizingResult, *, quiet: bool = False) -> None:
    """Print a sizing: requirements, the best drive, the next best, the closest rejected, and why the others fail.

    Parameters
    ----------
    result
        The sizing.
    quiet
        Leave out the requirements and the checks one by one.
    """
    console = tables.console()
    tables.heading(console, result.spec.name, f"method: {result.method}")
    if not quiet:
        place = "wheel" if result.spec.load.kind == "wheeled_vehicle" else "load"
        console.print(tables.requirements(result.requirements, f"Requirements at the {place}"))
    if result.sets:
        _chosen(console, result, result.sets[0], "The drive: ", quiet=quiet)
    elif result.unsure:
        console.print(Text(below_confidence(result), style="bold red"))
        _chosen(console, result, result.unsure[0], "The most probable, at nominal figures: ", quiet=quiet)
    else:
        _none(console, result)
    if len(result.sets) > 1:
        console.print(_ranking(result.sets, result))
    if result.front:
        console.print(_front(result))
    elif result.pareto:
        console.print(f"No Pareto front: no drive that passes has known values of {', '.join(result.pareto)}.")
    tolerances(console, result, quiet=quiet)
    if result.misses:
        console.print(_rejected(result.misses))
    _tally(console, result)


def _chosen(console: Console, result: SizingResult, best: DriveSet, words: str, *, quiet: bool) -> None:
    tight = worst(best.deciding)
    line = Text(words, style="bold") + Text(MARK[best.status], style=STYLE[best.status])
    console.print(line + _by_the_other(best))
    console.print(tables.parts(best, result.catalog))
    mass = f"{show(best.mass, 'g', 'mass')} ({' + '.join(best.mass_of)})"
    console.print(f"total ratio {best.total_ratio:.4g} · mass {mass}")
    if tight:
        console.print(f"tightest: {tight.title}, margin {percent(tight.margin)}")
    for hanging in tables.hanging(best):
        console.print(Text(hanging, style=STYLE["open"]))
    if not quiet:
        console.print()
        if best.requirements:
            console.print(tables.requirements(best.requirements, "Requirements at the motor"))
        _both_methods(console, best)


_METHODS = {"paper": "by the paper's equations and rule", "physics": "by physics, over the whole load cycle"}


def _both_methods(console: Console, found: DriveSet) -> None:
    """The checks of the method that ranked, those of the other, and both where the limit is the same."""
    console.print(tables.checks(found.checks, f"Checks {_METHODS[found.checks[0].method]}"))
    if found.figures:
        console.print(tables.loose(found.figures, "Operating figures"))
    if found.beside:
        console.print(tables.checks(found.beside, f"The same drive {_METHODS[found.beside[0].method]}"))
        console.print(_both(found))
    machine(console, found)


def _by_the_other(found: DriveSet) -> Text:
    """The other method's verdict, and the checks that decide it."""
    if not found.beside:
        return Text()
    status = verdict(found.beside)
    which = ", ".join(check.title.lower() for check in found.beside if check.status == status != "pass")
    words = Text(f", by {found.beside[0].method} ") + Text(MARK[status], style=STYLE[status])
    return words + Text(f" ({which})") if which else words


def _both(found: DriveSet) -> Table:
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


def _none(console: Console, result: SizingResult) -> None:
    console.print(Text("No drive meets all limits.", style="bold red"))
    if result.counts.failed_by:
        name, count = max(result.counts.failed_by.items(), key=lambda item: item[1])
        title = CHECKS[result.method][name].title.lower()
        console.print(f"Most frequent failure: {title}, in {count:,} of {result.counts.considered:,} drives.")
    if result.relaxations:
        console.print("Any one of these changes alone would let a drive pass:")
    for r in result.relaxations:
        console.print(Text(f"  {r.field} {r.now} → {r.needed}: {r.set_label}"))
    if not result.relaxations and result.counts.considered:
        console.print("  No single figure of the spec, changed by up to a factor of 20, is enough.")
    if not result.counts.considered:
        console.print("  The families and parts that the spec names leave no listed combination of motor and gearhead.")
    if result.misses:
        console.print()
        console.print(tables.checks(result.misses[0].checks, f"Closest rejected: {result.misses[0].label}"))
        machine(console, result.misses[0])


def _ranking(sets: tuple[DriveSet, ...], result: SizingResult) -> Table:
    table = tables.bare(
        ("", "right"), ("motor", "left"), ("gearhead", "left"), ("encoder", "left"), ("controller", "left"),
        (result.objective.replace("_", " "), "right"), ("tightest", "right"), title="Best first",
    )  # fmt: skip
    for found in sets:
        tight = worst(found.deciding)
        table.add_row(
            str(found.rank),
            f"{found.motor.family}\n{found.motor.part}",
            _gearhead(found, sets) + (f"\n{found.gearhead.part}" if "gearhead" in found.parts else ""),
            _named(found.encoder, "unknown"),
            _named(found.controller, "none"),
            _objective(found, result.objective),
            Text(percent(tight.margin) if tight else "–", style=STYLE[found.status]),
        )
    return table


def _gearhead(found: DriveSet, among: tuple[DriveSet, ...]) -> str:
    """Gearhead and its reduction, with the belt's ratio where the drives differ in it."""
    belt = f" × {found.belt_name or 1}" if len({s.belt_ratio for s in among}) > 1 else ""
    return f"{found.gearhead_name}{belt}"


def _named(part: Encoder | Controller | None, otherwise: str) -> str:
    """Family and number of a part; "inside" where the actuator contains it."""
    if part is None:
        return otherwise
    return "inside" if part.inside else f"{part.family}\n{part.part}"


def _rejected(misses: tuple[DriveSet, ...]) -> Table:
    """The closest rejected, each with its worst check."""
    table = tables.bare(
        ("motor", "left"), ("gearhead", "left"), ("fails on", "left"), ("demand", "right"), ("limit", "right"),
        title="Closest rejected",
    )  # fmt: skip
    for found in misses:
        failed = [check for check in found.deciding if check.status != "pass"]
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


def _objective(found: DriveSet, objective: str) -> str:
    if objective == "margin":
        return percent(found.objective)
    if objective not in OBJECTIVES:
        return f"{found.objective:.4g}"
    declared = OBJECTIVES[objective]
    text = show(found.objective, declared.unit, declared.kind)
    whole = len(declared.over) if declared.over and not found.actuator else 1
    return text if len(found.objective_of) in (0, whole) else f"{text}\n({found.objective_of[0]} only)"


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


def _tally(console: Console, result: SizingResult) -> None:
    counts = result.counts
    drives = "1 drive" if counts.considered == 1 else f"{counts.considered:,} drives"
    meet = "meets" if counts.feasible == 1 else "meet"
    console.print(f"{drives} considered, {counts.feasible:,} {meet} all limits.", end="")
    if counts.failed_by:
        console.print(" The others fail on:")
        for name, count in sorted(counts.failed_by.items(), key=lambda item: -item[1]):
            words = (
                "not the largest reduction"
                if name == "largest_reduction"
                else CHECKS[result.method][name].title.lower()
            )
            console.print(f"  {count:>8,}  {words}")
    else:
        console.print()
    if counts.failed_by_budget:
        console.print(f"Of {counts.judged:,} checked in the machine, best first, some fail on:")
        for name, count in sorted(counts.failed_by_budget.items(), key=lambda item: -item[1]):
            console.print(f"  {count:>8,}  {CHECKS['budget'][name].title.lower()}")
    other = result.unrestricted
    if other:
        encoder = f", encoder {other.encoder.part}" if other.encoder else ""
        controller = f", controller {other.controller.family}" if other.controller else ""
        single = result.objective in OBJECTIVES
        words = f"{result.objective} {_objective(other, result.objective)}".replace("_", " ").replace("\n", " ")
        value = f": {words}" if single else ""
        console.print(
            Text(
                f"Without the families and parts that the spec names, the whole catalogue gives {other.label}{encoder}"
                f"{controller}{value}."
            )
        )


def explained(pair: Explanation, catalog: Catalog) -> None:
    """Print a combination of motor and gearhead check by check, for every belt ratio, and its probabilities.

    Parameters
    ----------
    pair
        The combination with each belt.
    catalog
        The catalogue of its parts.
    """
    console = tables.console()
    for found in pair.sets:
        tables.heading(console, found.label, MARK[found.status], STYLE[found.status])
        console.print(tables.parts(found, catalog))
        if found.requirements:
            console.print(tables.requirements(found.requirements, "Requirements at the motor"))
        _both_methods(console, found)
        _changes(console, found)
    tolerances_of(console, pair)


def _changes(console: Console, found: DriveSet) -> None:
    """Changes of the spec that would let a failing drive pass."""
    if found.status != "fail":
        return
    if not found.changes:
        console.print("No single change of the spec, by up to a factor of 20, would let it pass.")
        return
    console.print("Any one of these changes alone would let it pass, smallest first:")
    for change in found.changes:
        console.print(Text(f"  {change.field} {change.now} → {change.needed}"))


def validation(proof: Validation) -> None:
    """Print a validation in closed loop."""
    console = tables.console()
    tables.heading(console, f"{proof.spec.name}: {proof.over}", MARK[proof.status], STYLE[proof.status])
    console.print(Text(proof.drive_set.label))
    console.print(tables.gains(proof))
    console.print(tables.checks(proof.checks, "Checks in closed loop"))
    console.print(tables.loose(proof.figures, "Figures of the closed loop"))
    if proof.loops:
        console.print(loops(proof.loops, console.width))


def validations(proofs: Sequence[Validation], objective: str) -> None:
    """Print several drives in closed loop, a line each, best first.

    Parameters
    ----------
    proofs
        The validations.
    objective
        The objective of the sizing that ranked them.
    """
    console = tables.console()
    first = proofs[0]
    tables.heading(console, f"{first.spec.name}: {first.profile}", f"{len(proofs)} drives in closed loop", "")
    table = tables.bare(
        ("", "right"), ("was", "right"), ("drive", "left"), (objective.replace("_", " "), "right"),
        ("tightest", "right"), ("", "left"),
    )  # fmt: skip
    for place, proof in enumerate(proofs, 1):
        tight = worst(proof.checks)
        table.add_row(
            str(place), str(proof.drive_set.rank), Text(proof.drive_set.label), _objective(proof.drive_set, objective),
            f"{tight.title} {percent(tight.margin)}" if tight else "–",
            Text(MARK[proof.status], style=STYLE[proof.status]),
        )  # fmt: skip
    console.print(table)
