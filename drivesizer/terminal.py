"""What a person sees at the terminal: tables that fit 80 columns and use what there is."""

from __future__ import annotations

from collections.abc import Iterable
from math import isnan
from typing import Any

from rich import box
from rich.console import Console
from rich.rule import Rule
from rich.table import Table
from rich.text import Text

from drivesizer import formula
from drivesizer.catalog import Catalog, columns_of
from drivesizer.declare import COMPANIONS, EQUATIONS, Equation
from drivesizer.results import Check, DriveSet, Figure, Requirement, SizingResult, Validation, verdict, worst
from drivesizer.units import label, show

__all__ = ["equation", "equations", "explained", "sizing", "validation"]

_STYLE = {"pass": "green", "fail": "bold red", "unknown": "yellow"}
_MARK = {"pass": "pass", "fail": "FAIL", "unknown": "unknown"}


def _console() -> Console:
    return Console(highlight=False, soft_wrap=False)


def _table(*columns: tuple[str, str], title: str = "", wide: bool = False) -> Table:
    """A plain table; a column is its header and its alignment."""
    table = Table(box=box.SIMPLE_HEAD, title=title or None, title_justify="left", title_style="bold", pad_edge=False)
    table.padding = (0, 2, 0, 0)
    for header, justify in columns:
        table.add_column(header, justify=justify, overflow="fold")  # type: ignore[arg-type]
    table.expand = wide
    return table


def _percent(margin: float) -> str:
    if isnan(margin):
        return "–"
    return f"{100 * margin:+.0f} %" if abs(margin) < 10 else f"×{margin + 1:.0f}"


def _heading(console: Console, name: str, right: str, style: str = "") -> None:
    grid = Table.grid(expand=True)
    grid.add_column(overflow="fold")
    grid.add_column(justify="right", no_wrap=True)
    grid.add_row(Text(name, style="bold"), Text(right, style=style))
    console.print(grid)
    console.print(Rule(style="dim"))


def _requirements(requirements: Iterable[Requirement], title: str) -> Table:
    table = _table(("eq.", "right"), ("", "left"), ("", "left"), ("", "right"), title=title)
    for r in requirements:
        number = f"({r.equation})" if r.equation else ""
        table.add_row(number, r.symbol, Text(r.title + (", given" if r.note.startswith("given") else "")), r.text)
    table.show_header = False
    return table


def _checks(checks: Iterable[Check], title: str) -> Table:
    timed = any(check.at_time is not None for check in checks)
    columns = [("check", "left"), ("demand", "right"), ("limit", "right"), ("margin", "right"), ("", "left")]
    table = _table(*columns, *([("at", "right")] if timed else []), title=title)
    for check in checks:
        status = Text(_MARK[check.status], style=_STYLE[check.status])
        figures = [_plain(check, check.demand), _plain(check, check.limit)]
        when = [f"{check.at_time:.3g} s" if check.at_time is not None else ""] if timed else []
        where = f" ({check.case})" if check.case else ""
        needed = f"\nneeds {_percent(check.needed)}" if check.needed and not isnan(check.margin) else ""
        table.add_row(Text(check.title + where), *figures, _percent(check.margin) + needed, status, *when)
    return table


def _plain(check: Check, figure: float) -> str:
    if isnan(check.demand) and isnan(check.limit) and check.status != "unknown":
        return ""  # a condition that is met or not, without figures
    return check.shown(figure)


_PARTS: dict[str, tuple[tuple[str, str, str, str], ...]] = {  # figure, unit, kind, words
    "motor": (
        ("assigned_power", "W", "power", ""),
        ("nominal_voltage", "V", "voltage", ""),
        ("mass", "g", "mass", ""),
        ("price", "EUR", "price", ""),
    ),
    "gearhead": (
        ("efficiency", "%", "dimensionless", "efficient"),
        ("mass", "g", "mass", ""),
        ("price", "EUR", "price", ""),
    ),
    "encoder": (("counts_per_turn", "1", "dimensionless", "counts per turn"),),
    "controller": (("continuous_current", "A", "current", "continuous"), ("peak_current", "A", "current", "peak")),
}


def _parts(found: DriveSet, catalog: Catalog) -> Table:
    """The set, part by part, with what the catalogue is less sure of."""
    table = _table(("", "left"), ("", "left"), ("", "left"))
    table.show_header = False
    for name, facts in _PARTS.items():
        part: Any = getattr(found, name)
        if part is None:
            table.add_row(name, Text("unknown", style="yellow"), "none is listed for this motor")
            continue
        reduction = f" {part.reduction}" if name == "gearhead" else ""
        values = [(getattr(part, field), unit, kind, words) for field, unit, kind, words in facts]
        shown = [f"{show(v, unit, kind)} {words}".strip() for v, unit, kind, words in values if not isnan(v)]
        doubt = _doubt(catalog, f"{name}s", part.part)
        text = Text(" · ".join(shown)) + (Text(f"\n{doubt}", style="yellow") if doubt else Text(""))
        table.add_row(name, Text(f"{part.family}{reduction}", style="bold") + Text(f"\n{part.part}"), text)
        if name == "gearhead" and found.belt_ratio != 1.0:
            table.add_row(
                "belt", f"{found.belt_ratio:g}", show(found.belt_efficiency, "%", "dimensionless") + " efficient"
            )
    return table


def _doubt(catalog: Catalog, section: str, part: str) -> str:
    """How many figures are not quoted from the maker's own document, the shakiest ones by name."""
    sure = catalog.confidence(section, catalog.table(section).rows[part])
    figures = {
        name: sure[name] for name, column in columns_of(section).items() if name in sure and column.kind != "text"
    }
    said = []
    for level in ("secondary", "derived", "recalled"):
        names = [name.replace("_", " ") for name, value in figures.items() if value == level]
        if names and level == "secondary":
            said.append(f"{len(names)} of {len(figures)} figures secondary")
        elif names:
            more = f" and {len(names) - 4} more" if len(names) > 5 else ""
            said.append(f"{level}: {', '.join(names[: 4 if more else 5])}{more}")
    return "; ".join(said)


def sizing(result: SizingResult, *, quiet: bool = False) -> None:
    """Print a sizing: requirements, the chosen set, the next best, and why the rest fell."""
    console = _console()
    _heading(console, result.spec.name, f"method: {result.method}")
    if not quiet:
        place = "wheel" if result.spec.load.kind == "wheeled_vehicle" else "load"
        console.print(_requirements(result.requirements, f"Requirements at the {place}"))
    if result.sets:
        _chosen(console, result, result.sets[0], quiet=quiet)
    else:
        _none(console, result)
    if len(result.sets) > 1:
        console.print(_ranking(result.sets, result))
    if result.pareto:
        console.print(_front(result))
    if result.misses:
        console.print(_nearest(result.misses))
    _tally(console, result)


def _chosen(console: Console, result: SizingResult, best: DriveSet, *, quiet: bool) -> None:
    tight = worst(best.checks)
    line = Text("The drive: ", style="bold") + Text(_MARK[best.status], style=_STYLE[best.status])
    console.print(line + _by_the_other(best))
    console.print(_parts(best, result.catalog))
    mass = f"{show(best.mass, 'g', 'mass')} ({' + '.join(best.mass_of)})"
    console.print(f"whole reduction {best.total_ratio:.4g} · mass {mass}")
    if tight:
        console.print(f"tightest: {tight.title}, margin {_percent(tight.margin)}")
    if not quiet:
        console.print()
        if best.requirements:
            console.print(_requirements(best.requirements, "Requirements at the motor"))
        _both_methods(console, best)


_METHODS = {"paper": "by the paper's equations and rule", "physics": "by physics, over the whole load cycle"}


def _both_methods(console: Console, found: DriveSet) -> None:
    """The checks of the method that ranked, those of the other, and where they look at the same limit."""
    console.print(_checks(found.checks, f"Checks {_METHODS[found.checks[0].method]}"))
    if found.figures:
        console.print(_loose(found.figures, "What it does"))
    if found.beside:
        console.print(_checks(found.beside, f"The same set {_METHODS[found.beside[0].method]}"))
        console.print(_both(found))


def _by_the_other(found: DriveSet) -> Text:
    """What the other method says of the set, in a few words."""
    if not found.beside:
        return Text()
    status = verdict(found.beside)
    which = ", ".join(check.title.lower() for check in found.beside if check.status == status != "pass")
    words = Text(f", by {found.beside[0].method} ") + Text(_MARK[status], style=_STYLE[status])
    return words + Text(f" ({which})") if which else words


def _both(found: DriveSet) -> Table:
    """Where both methods look at the same limit: both demands, and why they differ."""
    table = _table(
        ("", "left"), ("paper", "right"), ("physics", "right"), ("why they differ", "left"), title="Both methods"
    )
    for pair in found.comparison:
        figures = []
        for check in (pair.paper, pair.physics):
            mark = f"\n{_MARK[check.status]}" if pair.paper.status != pair.physics.status else ""
            figures.append(Text(check.shown(check.demand) + mark))
        table.add_row(pair.paper.title, *figures, pair.why)
    return table


def _none(console: Console, result: SizingResult) -> None:
    console.print(Text("No set stands.", style="bold red"))
    if result.relaxations:
        console.print("Any one of these changes would let one stand:")
    for r in result.relaxations:
        console.print(Text(f"  {r.field} {r.now} → {r.needed}: then {r.set_label}"))
    if not result.relaxations and result.counts.considered:
        console.print("  No single figure of the spec, moved up to 20 times, is enough.")
    if not result.counts.considered:
        console.print("  No listed pair of motor and gearhead is left by the families and parts that the spec names.")
    if result.misses:
        console.print()
        console.print(_checks(result.misses[0].checks, f"Nearest miss: {result.misses[0].label}"))


def _ranking(sets: tuple[DriveSet, ...], result: SizingResult) -> Table:
    table = _table(
        ("", "right"), ("motor", "left"), ("gearhead", "left"), ("encoder", "left"), ("controller", "left"),
        (result.objective, "right"), ("tightest", "right"), title="Best first",
    )  # fmt: skip
    for found in sets:
        tight = worst(found.checks)
        table.add_row(
            str(found.rank),
            f"{found.motor.family}\n{found.motor.part}",
            f"{_gearhead(found, sets)}\n{found.gearhead.part}",
            f"{found.encoder.family}\n{found.encoder.part}" if found.encoder else "unknown",
            f"{found.controller.family}\n{found.controller.part}" if found.controller else "none",
            _objective(found, result.objective),
            Text(_percent(tight.margin) if tight else "–", style=_STYLE[found.status]),
        )
    return table


def _gearhead(found: DriveSet, among: tuple[DriveSet, ...]) -> str:
    """Gearhead and reduction, with the belt's where the sets differ in it."""
    belt = f" × {found.belt_ratio:g}" if len({s.belt_ratio for s in among}) > 1 else ""
    return f"{found.gearhead.family} {found.gearhead.reduction}{belt}"


def _nearest(misses: tuple[DriveSet, ...]) -> Table:
    """The nearest that fell, each with its worst check."""
    table = _table(
        ("motor", "left"), ("gearhead", "left"), ("falls by", "left"), ("demand", "right"), ("limit", "right"),
        title="Nearest of those that fell",
    )  # fmt: skip
    for found in misses:
        failed = [check for check in found.checks if check.status != "pass"]
        check = worst(tuple(failed)) or failed[0]
        others = f" (+{len(failed) - 1})" if len(failed) > 1 else ""
        table.add_row(
            f"{found.motor.family} {found.motor.part}",
            _gearhead(found, misses),
            check.title + others,
            _plain(check, check.demand),
            _plain(check, check.limit),
        )
    return table


_OBJECTIVE_UNITS = {
    "mass": ("g", "mass"),
    "price": ("EUR", "price"),
    "length": ("mm", "length"),
    "power": ("W", "power"),
    "energy": ("J", "energy"),
    "joule_heat": ("W", "power"),
    "peak_current": ("A", "current"),
    "winding_temperature": ("degC", "temperature"),
}


def _objective(found: DriveSet, objective: str) -> str:
    if objective == "margin":
        return _percent(found.objective)
    if objective not in _OBJECTIVE_UNITS:
        return f"{found.objective:.4g}"
    text = show(found.objective, *_OBJECTIVE_UNITS[objective])
    whole = 2 if objective in ("mass", "price", "length") else 1
    return text if len(found.objective_of) in (0, whole) else f"{text}\n({found.objective_of[0]} only)"


def _front(result: SizingResult) -> Table:
    """Sets that no other beats in all of several objectives."""
    heads = [(name.replace("_", " "), "right") for name in result.pareto]
    table = _table(("motor", "left"), ("gearhead", "left"), *heads, title="Pareto front")
    for found in result.front:
        table.add_row(
            f"{found.motor.family} {found.motor.part}", _gearhead(found, result.front),
            *(_figure_of(found, name) for name in result.pareto),
        )  # fmt: skip
    return table


def _figure_of(found: DriveSet, objective: str) -> str:
    """What a set has of an objective, whether it was ranked by it or not."""
    if objective == "margin":
        tight = worst(found.checks)
        return _percent(tight.margin) if tight else "–"
    known = {figure.name: figure.value for figure in found.figures}
    parts = [found.motor] if objective == "power" else [found.motor, found.gearhead]
    name = "assigned_power" if objective == "power" else objective
    value = known[objective] if objective in known else sum(getattr(part, name) for part in parts)
    return show(value, *_OBJECTIVE_UNITS[objective])


def _loose(figures: Iterable[Figure], title: str) -> Table:
    """Figures without a limit."""
    table = _table(("", "left"), ("", "right"), ("", "right"), title=title)
    table.show_header = False
    for figure in figures:
        when = f"at {figure.at_time:.4g} s" if figure.at_time is not None else ""
        table.add_row(figure.title, figure.text, when)
    return table


def _tally(console: Console, result: SizingResult) -> None:
    from drivesizer.checks import TITLES

    counts = result.counts
    console.print(
        f"{counts.considered:,} sets considered, {counts.feasible:,} stand{'s' if counts.feasible == 1 else ''}.",
        end="",
    )
    if counts.failed_by:
        console.print(" The others fell by:")
        for name, count in sorted(counts.failed_by.items(), key=lambda item: -item[1]):
            words = "not the largest reduction" if name == "largest_reduction" else TITLES[result.method][name].lower()
            console.print(f"  {count:>8,}  {words}")
    else:
        console.print()
    other = result.unrestricted
    if other:
        encoder = f", encoder {other.encoder.part}" if other.encoder else ""
        controller = f", controller {other.controller.family}" if other.controller else ""
        value = _objective(other, result.objective).replace("\n", " ")
        console.print(
            Text(
                f"Without the families and parts that the spec names, the whole catalogue gives {other.label}{encoder}"
                f"{controller}: {result.objective} {value}."
            )
        )


def explained(sets: list[DriveSet], catalog: Catalog) -> None:
    """Print one pair check by check, for every belt ratio."""
    console = _console()
    for found in sets:
        _heading(console, found.label, _MARK[found.status], _STYLE[found.status])
        console.print(_parts(found, catalog))
        if found.requirements:
            console.print(_requirements(found.requirements, "Requirements at the motor"))
        _both_methods(console, found)
        _changes(console, found)


def _changes(console: Console, found: DriveSet) -> None:
    """What would let a set pass that fails."""
    if found.status != "fail":
        return
    if not found.changes:
        console.print("No single change of the spec, up to 20 times, would let it pass.")
        return
    console.print("Any one of these changes alone would let it pass, the least first:")
    for change in found.changes:
        console.print(Text(f"  {change.field} {change.now} → {change.needed}"))


def validation(proof: Validation) -> None:
    """Print a closed-loop verdict."""
    console = _console()
    _heading(console, f"{proof.spec.name}: {proof.profile}", _MARK[proof.status], _STYLE[proof.status])
    console.print(Text(proof.drive_set.label))
    gains = proof.gains
    console.print(
        f"Gains kp {gains.kp:.4g} V/(rad/s), ki {gains.ki:.4g} V/rad, kd {gains.kd:.4g} V/(rad/s²) every "
        f"{show(gains.period, 'ms', 'time')}; {gains.rule}"
    )
    console.print(_checks(proof.checks, "Demand against limit"))
    console.print(_loose(proof.figures, "The closed loop"))


def equations() -> None:
    """Print all equations, a line each."""
    console = _console()
    table = _table(("", "right"), ("quantity", "left"), ("computed", "left"), ("unit", "left"))
    for declared in [*EQUATIONS.values(), *COMPANIONS.values()]:
        number = f"({declared.number})" if declared.number else ""
        mark = " *" if formula.printed_failure(declared) else ""
        computed = f"{declared.symbol} = {formula.text(formula.computed(declared))}{mark}"
        table.add_row(number, Text(declared.title), Text(computed), label(declared.shown))
    console.print(table)
    console.print("* the printed form fails the unit check; `drivesizer equations 10` says why.")


def equation(declared: Equation) -> None:
    """Print one equation: as printed, as computed, why they differ, units, source."""
    console = _console()
    _heading(console, declared.title, f"equation ({declared.number})" if declared.number else "not in the paper")
    rows = []
    failure = formula.printed_failure(declared)
    if declared.printed:
        rows.append(("as printed", f"{declared.symbol} = {formula.text(declared.printed, paper=True)}"))
        rows.append(("unit check", f"fails: {failure}" if failure else "passes"))
    rows.append(("as computed", f"{declared.symbol} = {formula.text(formula.computed(declared))}"))
    if declared.note:
        rows.append(("note", declared.note))
    rows.append(("result", f"{declared.result.meaning} [{label(declared.shown) or '1'}]"))
    table = _table(("", "left"), ("", "left"))
    table.show_header = False
    for name, words in rows:
        table.add_row(Text(name, style="dim"), Text(words, style="red" if words.startswith("fails") else ""))
    for term in declared.terms:
        table.add_row(formula.symbol_text(term.name), Text(f"{term.meaning} [{label(term.unit) or '1'}]"))
    table.add_row(
        Text("source", style="dim"), "Prados Sesmero et al., Appl. Sci. 2021, 11, 6631, doi:10.3390/app11146631"
    )
    console.print(table)
