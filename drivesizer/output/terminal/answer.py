"""The answer of a sizing at the terminal: the drive to buy, its verdict and margins, its certainty, alternatives."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from math import isfinite, isnan

from rich.console import Console
from rich.table import Table
from rich.text import Text

from drivesizer.machine.battery import lacking, pack_of
from drivesizer.output.parts import (
    OWN_SUPPLY,
    PartLine,
    Total,
    machine_parts,
    mass_text,
    money_text,
    total_text,
    total_texts,
    unknown_of,
)
from drivesizer.output.terminal import tables as tables
from drivesizer.output.terminal.tables import MARK, STYLE, percent
from drivesizer.output.words import likely, not_quoted, number_of
from drivesizer.results.check import Check, tightest
from drivesizer.results.check_kinds import part_of
from drivesizer.results.drive_set import BrakingBudget, DriveSet
from drivesizer.results.sizing import SizingResult, objective_figure, unknown_parts, worst
from drivesizer.units import show

__all__ = ["compared", "names_of", "next_commands", "recommended", "side_by_side"]

_WIDE = 110  # columns from which on a part has a single line
_NAMED = 4  # unknown checks at most that are named
_NAME = 30  # characters of a part's name, beyond which it is broken so that prices and masses are seen
_NARROW = 72  # columns below which only the price of one is shown
_LEAST_NAME = 8  # and at least of it on the narrowest terminal
_TIGHT = 3  # checks with the smallest margins that are shown


def recommended(console: Console, result: SizingResult, best: DriveSet) -> None:
    """Print a drive as a parts list with its totals, its tightest checks, and the confidence of its figures."""
    lines = machine_parts(best, result.problem)
    console.print(_parts(lines, best, console.width))
    console.print(Text.assemble(("total: ", "bold"), total_texts(lines, _summed), _unpriced(lines)))
    console.print()
    title = f"{MARK[best.status]}: the tightest of {number_of(len(best.deciding), 'check')}"
    console.print(tables.checks(tightest(best.deciding, _TIGHT), title, edged=False))
    if required := tables.required(best):
        console.print()
        console.print(required)
        console.print()
    for line in _certainty(best, result):
        console.print(line)


# --- the parts list ---------------------------------------------------------------------------------------------------


def _parts(lines: list[PartLine], best: DriveSet, width: int) -> Table:
    """A row for each part: quantity, part, prices and mass; where a terminal is narrow without the price of all."""
    several, wide = lines[0].quantity > 1 and width >= _NARROW, width >= _WIDE
    more = [("price", "right"), ("all", "right")] if several else [("price", "right")]
    heads = [("", "right"), ("", "left"), ("part", "left"), *([("", "left")] if wide else []), *more, ("mass", "right")]
    table = tables.bare(*heads, edged=False)
    for line in lines:
        number = [_number(line)] if wide else []
        name = _named(line, best, wide=True) if wide else Text("\n").join([_named(line, best), *_second(line)])
        prices = [_money(line.price, line), *([_money(line.quantity * line.price, line)] if several else [])]
        table.add_row(f"{line.quantity} ×", line.role, name, *number, *prices, _massed(line))
    for column in table.columns:
        column.no_wrap = column.header != "part"
    known = [line for line in lines if line.part]
    names = max(len(_named(line, best, wide=wide)) for line in known)
    numbers = 0 if wide else max(len(line.part) for line in known)
    longest = max(len(text) for cell in table.columns[2].cells for text in str(cell).split("\n"))
    figures = tables.width_of(table) - longest
    room = max(width - figures, _LEAST_NAME)
    table.columns[2].min_width = min(max(numbers, names if wide else min(names, _NAME)), room)
    return table


def _named(line: PartLine, best: DriveSet, *, wide: bool = False) -> Text:
    """Maker and family, with the reduction of a gearhead or the ratio of a belt; a number that begins with these."""
    if not line.part:
        return Text(line.said or "none is listed for this motor", style="" if line.said else "yellow")
    reduction = best.gearhead.reduction if line.role in ("gearhead", "actuator") else ""
    maker = "" if line.maker in line.family else line.maker
    family = line.part if line.part.startswith(line.family) and not (wide or reduction) else line.family
    name = Text(" ".join(filter(None, (maker, family, reduction))), style="bold")
    return name + Text(f", {line.said}") if line.said.endswith(OWN_SUPPLY) else name


def _second(line: PartLine) -> list[Text]:
    """The order number below a part's name, unless it is the name."""
    again = line.part.startswith(line.family) and line.role not in ("gearhead", "actuator")
    return [_number(line)] if line.part and line.part != line.family and not again else []


def _number(line: PartLine) -> Text:
    """The order number; a name that is the catalogue's own is dim."""
    return Text(line.order_number or line.part, style="" if line.order_number else "dim")


def _money(price: float, line: PartLine) -> Text:
    return Text(money_text(price, line.currency), style="yellow" if isnan(price) else "")


def _massed(line: PartLine) -> Text:
    """The mass of all pieces, coloured where it is estimated or unknown."""
    return Text(mass_text(line), style="yellow" if isnan(line.mass) or not isnan(line.mass_low) else "")


def _summed(total: Total) -> str:
    """A total: at least, where something is unknown; with its band, where something is estimated."""
    text = total_text(total, 3)
    if not total.estimated:
        return text
    band = f"{show(total.low, 'kg', 'mass', 2).removesuffix(' kg')} to {show(total.high, 'kg', 'mass', 2)}"
    return f"{text} ({band}; ≈ estimated)"


def _unpriced(lines: list[PartLine]) -> str:
    """The parts whose price is unknown."""
    lacks = [line.role for line in lines if isnan(line.price)]
    return f"; without the price of {', '.join(lacks)}" if 0 < len(lacks) < len(lines) else ""


# --- certainty --------------------------------------------------------------------------------------------------------


def _certainty(best: DriveSet, result: SizingResult) -> Iterator[Text]:
    """Open and unknown checks, the probability that all pass, and the figures that are not the makers' own."""
    for hanging in tables.hanging(best):
        yield Text(hanging, style=STYLE["open"])
    yield from _undecided(best, result)
    if best.reliability:
        claim = "no known check fails" if best.reliability.unknown else "all checks pass"
        yield Text(f"With tolerances {claim} with a probability of {likely(best.reliability.probability)}.")
    if best.estimated and best.status == "pass":
        names = dict.fromkeys(f"{one.part} {one.figure.removeprefix(f'{one.part}_')}" for one in best.estimated)
        yield Text(f"holds over the whole band of what is estimated: {', '.join(names).replace('_', ' ')}")
    counts = {
        role: not_quoted(part, role, best, result.catalog) for role, part in best.parts.items() if part is not None
    }
    doubts = [f"{role} {_confidence_counts(found)}" for role, found in counts.items() if found]
    if doubts:
        yield Text(f"not out of the maker's own document: {'; '.join(doubts)}", style="dim")


def _undecided(best: DriveSet, result: SizingResult) -> Iterator[Text]:
    """Unknown checks by name; those of the battery in one line with the fields that would decide them."""
    unknown = [check for check in best.deciding if check.status == "unknown"]
    of_battery = [check for check in unknown if part_of(check.name) == "Battery"]
    battery = result.problem.spec.battery
    if battery and len(of_battery) > 1:
        fields = ", ".join(lacking(pack_of(battery, result.problem.catalog)))
        hint = f"; the spec's battery gives no {fields}" if fields else ""
        yield Text(f"unknown: {len(of_battery)} checks of the battery{hint}", style=STYLE["unknown"])
        unknown = [check for check in unknown if check not in of_battery]
    bus = next((check for check in unknown if check.name == "bus_voltage"), None)
    if bus and bus.note and best.braking:  # else the controller is not known
        yield Text(f"unknown: {bus.title}; decided by {_deciding(best.braking)}", style=STYLE["unknown"])
        unknown.remove(bus)
    if unknown:
        more = f" and {len(unknown) - _NAMED} more (--checks)" if len(unknown) > _NAMED + 1 else ""
        names = "; ".join(map(_named_check, unknown[: _NAMED if more else None]))
        yield Text(f"unknown: {names}{more}", style=STYLE["unknown"])
    yield from tables.missing(best)


def _named_check(check: Check) -> str:
    """A check; that of the price with what it lacks."""
    return f"{check.title} ({check.note})" if (check.name, check.method) == ("price", "budget") else check.title


def _deciding(braking: BrakingBudget) -> str:
    """Fields of a spec that decide whether the bus holds, with what they would have to be."""
    needed = next(figure for figure in braking.figures if figure.name == "capacitance_needed")
    least = f" of {needed.text} or more" if isfinite(needed.value) else ""
    return f"brake_resistor: any, supply.capacitance{least}, or supply.accepts: all of a battery"


def _confidence_counts(found: dict[str, str]) -> str:
    """Number of figures at each level of confidence.

    >>> _confidence_counts({"mass": "secondary", "k_t": "derived", "price": "secondary"})
    '2 secondary, 1 derived'
    """
    return ", ".join(f"{count} {level}" for level, count in Counter(found.values()).items())


# --- alternatives -----------------------------------------------------------------------------------------------------


def side_by_side(console: Console, sets: Sequence[DriveSet], objective: str, title: str) -> None:
    """Print drives with mass, price, energy and smallest margin, a row each; nothing without any."""
    if not sets:
        return
    own, wide = objective not in _SHOWN, console.width >= _WIDE
    heads = [("", "left"), *([(objective.replace("_", " "), "right")] if own else [])]
    heads += [("mass", "right"), ("price", "right"), ("energy", "right"), ("margin", "right")]
    table = tables.bare(*heads, edged=False)
    shared = _shared(sets)
    drives = [_drive(found, shared, wide=wide) for found in sets]
    for drive, found in zip(drives, sets, strict=True):
        value = [tables.objective(found, objective)] if own else []
        table.add_row(drive, *value, *compared(found))
    for column in table.columns[1:]:
        column.no_wrap = True
    figures = tables.width_of(table) - max(map(_longest_line, drives))
    names = max(_longest_line(names_of(found, wide=wide)) for found in sets)
    table.columns[0].min_width = min(names, console.width - figures)  # figures are whole, long part numbers wrap
    braked = "brake, " if any(found.brake for found in sets) else ""
    over = f", mass with {braked}encoder and controller"
    console.print(Text(f"\n{title}: one drive each{over}", style="bold"))
    console.print(table)
    if shared:
        console.print(Text(f"unknown of each: {_few(shared)}", style=STYLE["unknown"]))


def _shared(sets: Sequence[DriveSet]) -> list[str]:
    """Checks that are unknown of every drive of several."""
    each = [[check.title for check in found.deciding if check.status == "unknown"] for found in sets]
    return [title for title in each[0] if all(title in other for other in each)] if len(sets) > 1 else []


def _few(titles: Sequence[str]) -> str:
    """Title of a single check, number of several."""
    return titles[0] if len(titles) == 1 else f"{len(titles)} checks"


_SHOWN = {"mass", "price", "energy", "margin"}  # objectives that have a column whatever ranks


def _drive(found: DriveSet, shared: Sequence[str], *, wide: bool) -> Text:
    """Motor and gearhead with their part numbers, then the checks that are open, or unknown and not of all drives."""
    text = names_of(found, wide=wide)
    said = []
    for status in ("unknown", "open"):
        titles = [check.title for check in found.deciding if check.status == status and check.title not in shared]
        said += [f"{status}: {_few(titles)}"] if titles else []
    return text.append(f"\n{', '.join(said)}", STYLE["unknown"]) if said else text


def _longest_line(text: Text) -> int:
    return max(map(len, text.plain.splitlines()))


def names_of(found: DriveSet, *, wide: bool) -> Text:
    """Motor and gearhead, and their part numbers."""
    gearhead = f" {found.gearhead.reduction}" if found.actuator else f" + {found.gearhead_name}"
    gearhead = "" if found.gearhead_name == "none" else gearhead
    belt = f" × {found.belt_name}" if found.belt_name else ""
    family = found.motor.family if found.motor.part != found.motor.family else found.motor.part
    numbers = " ".join(part.part for role, part in found.parts.items() if part and role in _TURNING)
    text = Text(f"{family}{gearhead}{belt}", style="bold" if found.rank == 1 else "")
    return text.append(f"{'  ' if wide else chr(10)}{numbers}", style="dim")


_TURNING = {"motor", "gearhead", "actuator"}


def compared(found: DriveSet) -> tuple[str | Text, ...]:
    """Mass, price, energy and smallest margin of a drive, as cells of a table."""
    least = "≥ " if unknown_of(found, found.price_of) else ""
    tight = worst(found.deciding)
    energy, known = objective_figure(found, "energy"), not isnan(found.mass)
    return (
        ("≥ " if known and unknown_parts(found, "mass", found.mass_of) else "") + show(found.mass, "g", "mass"),
        "unknown" if isnan(found.price) else f"{least}{found.price:.0f} EUR",
        "–" if isnan(energy.value) else energy.text,
        Text(percent(tight.margin) if tight else "–", style=STYLE[found.status]),
    )


# --- what next --------------------------------------------------------------------------------------------------------


def next_commands(console: Console, spec: str, loop: str = "closed loop") -> None:
    """Print the commands that lead on."""
    behind = f" {spec}" if spec else ""
    console.print(f"\nnext: drivesizer size{behind} --checks, or -v for all", soft_wrap=True)
    console.print(f"      drivesizer validate{behind} simulates the drive in {loop}", soft_wrap=True)
    console.print(f"      drivesizer report{behind} -o report.pdf, or .html, .xlsx, .csv, .json", soft_wrap=True)
