"""A machine of several axes at the terminal: its drives, axis by axis, what all draw, and the commands that lead on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isnan

from rich.console import Console
from rich.text import Text

from drivesizer.control.validation import Validation
from drivesizer.output.parts import SharedLine, machine_parts_of_axes, mass_text, money_text, total_text, total_texts
from drivesizer.output.several_axes import choice_text, supply_texts
from drivesizer.output.terminal import tables
from drivesizer.output.terminal.answer import compared, names_of
from drivesizer.output.terminal.tables import MARK, STYLE, percent
from drivesizer.results.check import GRAVEST, Check, tightest, worst
from drivesizer.results.machine import AxisSizing, MachineSizing
from drivesizer.results.sizing import Explanation
from drivesizer.units import show

__all__ = ["machine_explained", "machine_proofs", "machine_sizing"]

_AXES = 16  # characters of the names of axes in a parts list, where there is no room for more
_WIDE = 110  # columns from which on a drive has a single line


def machine_sizing(result: MachineSizing, *, spec: str = "", checks: bool = False, quiet: bool = False) -> None:
    """Print the sizing of a machine."""
    console = tables.console()
    status = MARK[result.status] if result.complete else "no drive for every axis"
    tables.heading(console, result.machine.name, status, STYLE[result.status])
    _drives(console, result)
    if not quiet:
        _parts(console, result)
    if checks:
        _all_checks(console, result)
    else:
        _tightest(console, result)
    for sentence in _notes(result):
        console.print(sentence)
    if not quiet:
        _next(console, spec, result)


def _drives(console: Console, result: MachineSizing) -> None:
    """A row for each axis: its drive with mass, price, energy and smallest margin, and what rides on it."""
    wide = console.width >= _WIDE
    heads = ("mass", "price", "energy", "margin")
    table = tables.bare(("axis", "left"), ("drive", "left"), *((head, "right") for head in heads), edged=False)
    for axis in result.axes:
        if axis.best is None:
            table.add_row(axis.name, Text("no drive meets all limits", style="bold red"), *[""] * len(heads))
            continue
        drive = names_of(axis.best, wide=wide)
        if axis.drives > 1:
            drive = Text(f"{axis.drives} × ") + drive
        if axis.carried:
            drive.append("\n" + _riding(axis), "dim")
        table.add_row(axis.name, drive, *compared(axis.best))
    for column in table.columns[2:]:
        column.no_wrap = True
    console.print(table)


def _riding(axis: AxisSizing) -> str:
    """The drives on an axis: their mass first, so that no line ends between a figure and its unit, then names."""
    names = ("its own" if one.of == axis.name else one.of for one in axis.carried)
    return f"on it {show(axis.carried_mass, 'g', 'mass', 3)}: {', '.join(names)}"


def _parts(console: Console, result: MachineSizing) -> None:
    """One parts list of all axes with its totals; equal parts of several axes are one line."""
    shared = machine_parts_of_axes(result)
    heads = [("", "right"), ("", "left"), ("part", "left"), ("axis", "left"), ("price", "right"), ("mass", "right")]
    table = tables.bare(*heads, edged=False)
    for one in shared:
        table.add_row(*_part_row(one))
    for column in (*table.columns[:2], *table.columns[4:]):
        column.no_wrap = True
    if console.width < _WIDE:
        table.columns[3].max_width = _AXES
    table.columns[2].min_width = max((len(one.line.part) for one in shared), default=0)
    console.print()
    console.print(table)
    lines = [one.line for one in shared]
    known = total_texts(lines, lambda total: total_text(total, 3))
    lacks = [line.role for line in lines if isnan(line.price)]
    some = 0 < len(lacks) < len(lines)
    unpriced = f"; without the price of some: {', '.join(dict.fromkeys(lacks))}" if some else ""
    console.print(Text.assemble(("total: ", "bold"), known, unpriced))


def _part_row(one: SharedLine) -> tuple[str | Text, ...]:
    """A part with all its axes: quantity, role, name and number, price of one, mass of all."""
    line, axes = one.line, ", ".join(one.axes)
    if not line.part:
        said = line.said or "none is listed"
        return f"{line.quantity} ×", line.role, Text(said, style="yellow"), axes, "", mass_text(line)
    maker = "" if line.maker in line.family else line.maker
    said = line.said.partition(",")[0] if line.role == "gearhead" else ""
    reduction = said if ":" in said else ""
    name = Text(" ".join(filter(None, (maker, line.family, reduction))), style="bold")
    number = (
        Text(f"\n{line.order_number or line.part}", style="" if line.order_number else "dim")
        if line.part != line.family
        else ""
    )
    price = Text(money_text(line.price, line.currency), style="yellow" if isnan(line.price) else "")
    return f"{line.quantity} ×", line.role, Text.assemble(name, number), axes, price, mass_text(line)


def _tightest(console: Console, result: MachineSizing) -> None:
    """The tightest check of every axis, and those of the machine."""
    table = tables.bare(
        ("", "left"), ("tightest check", "left"), ("demand", "right"), ("limit", "right"), ("margin", "right"),
        ("", "left"), edged=False,
    )  # fmt: skip
    for axis in result.axes:
        check = next(iter(tightest(axis.best.deciding, 1)), None) if axis.best else _failing(axis)
        if check:
            table.add_row(axis.name, *_row(check), Text(MARK[check.status], style=STYLE[check.status]))
    for check in _machine_checks(result):
        table.add_row("all", *_row(check), Text(MARK[check.status], style=STYLE[check.status]))
    console.print()
    console.print(table)


def _machine_checks(result: MachineSizing) -> list[Check]:
    """Checks of all axes together that fail; else the tightest."""
    failed = [check for check in result.checks if check.status == "fail" and not check.advice]
    return failed or tightest(tuple(check for check in result.checks if not check.advice), 1)


def _failing(axis: AxisSizing) -> Check | None:
    """The worst check of the closest rejected of an axis without a drive."""
    return worst(axis.result.misses[0].own_checks) if axis.result.misses else None


def _all_checks(console: Console, result: MachineSizing) -> None:
    """Every check of every axis."""
    for axis in result.axes:
        if axis.best:
            console.print(tables.checks(axis.best.own_checks, f"{axis.name}: {axis.best.label}"))
    if result.checks:
        console.print(tables.checks(result.checks, "all axes on one supply"))


def _notes(result: MachineSizing) -> list[Text]:
    """Open and unknown checks by axis, and how the drives were chosen."""
    found = []
    for axis in result.axes:
        for status in ("open", "unknown"):
            titles = [check.title for check in axis.best.deciding if check.status == status] if axis.best else []
            if titles:
                found.append(Text(f"{axis.name} {status}: {_few(titles)}", style=STYLE[status]))
    unknown = [check.title for check in result.checks if check.status == "unknown" and not check.advice]
    if unknown:
        found.append(Text(f"all axes unknown: {_few(unknown)}", style=STYLE["unknown"]))
    found += [Text(text) for text in supply_texts(result.power)] if result.power else []
    found += [Text(note) for note in result.notes]
    if choice_text(result):
        found.append(Text(choice_text(result), style="dim"))
    return found


def _few(titles: Sequence[str]) -> str:
    """Titles of a few checks, else their number."""
    return "; ".join(titles) if len(titles) <= 2 else f"{len(titles)} checks (--checks)"


def _next(console: Console, spec: str, result: MachineSizing) -> None:
    """Print the commands that lead on."""
    name = next((axis.name for axis in result.axes if axis.best is None), result.axes[0].name)
    quoted = f'"{name}"' if " " in name else name
    behind = f" {spec}" if spec else ""
    console.print(f"\nnext: drivesizer size{behind} --axis {quoted}, one axis in full", soft_wrap=True)
    console.print(f"      drivesizer validate{behind} simulates every axis in closed loop", soft_wrap=True)
    console.print(f"      drivesizer report{behind} -o report.pdf, or .html, .xlsx, .csv, .json", soft_wrap=True)


def machine_explained(name: str, found: Mapping[str, Explanation]) -> None:
    """Print how one combination of motor and gearhead does on every axis of a machine, with its tightest check."""
    console = tables.console()
    label = next(one.sets[0].label for one in found.values())
    tables.heading(console, name, "")
    console.print(Text(label, style="bold"))
    heads = [("axis", "left"), ("", "left"), ("demand", "right"), ("limit", "right"), ("margin", "right"), ("", "left")]
    table = tables.bare(*heads, edged=False)
    for axis, pair in found.items():
        one = max(pair.sets, key=lambda each: GRAVEST.index(each.status))
        title, *figures = _row(next(iter(tightest(one.deciding, 1)), None))
        belt = f", belt {one.belt_ratio:g}:1" if len(pair.sets) > 1 else ""
        table.add_row(axis, f"{title}{belt}", *figures, Text(MARK[one.status], style=STYLE[one.status]))
    console.print(table)


def _row(check: Check | None) -> tuple[str, str, str, str]:
    """A check in a row: its title, demand, limit and margin."""
    if check is None:
        return "–", "", "", ""
    return check.title, tables.plain(check, check.demand), tables.plain(check, check.limit), percent(check.margin)


def machine_proofs(name: str, proofs: Mapping[str, Validation]) -> None:
    """Print the closed loops of a machine's axes, and steppers behind their pulses, a line each."""
    console = tables.console()
    failed = [axis for axis, proof in proofs.items() if proof.status == "fail"]
    loops = " and ".join(dict.fromkeys(proof.loop for proof in proofs.values()))
    tables.heading(console, name, f"FAIL: {', '.join(failed)}" if failed else loops, STYLE["fail"] * bool(failed))
    heads = [("axis", "left"), ("drive", "left"), ("tightest", "left"), ("", "right"), ("", "left")]
    table = tables.bare(*heads, edged=False)
    for axis, proof in proofs.items():
        tight = worst(proof.checks)
        title, margin = (tight.title, percent(tight.margin)) if tight else ("–", "")
        found = Text(MARK[proof.status], style=STYLE[proof.status])
        table.add_row(axis, Text(proof.drive_set.label), title, margin, found)
    console.print(table)
    for axis, proof in proofs.items():
        if proof.tried:
            console.print()
            console.print(tables.tried(proof, f"{axis}: "))
