"""How sure the sets are, at the terminal: probabilities, margins of the best set, and what matters most."""

from __future__ import annotations

from math import isfinite

from rich.console import Console
from rich.table import Table
from rich.text import Text

from drivesizer import terminal_tables as tables
from drivesizer.results import DriveSet, SizingResult
from drivesizer.terminal_tables import percent
from drivesizer.tolerances.records import Reliability
from drivesizer.tolerances.wording import likely

__all__ = ["tolerances"]

_DRIVERS = 3


def tolerances(console: Console, result: SizingResult, *, quiet: bool = False) -> None:
    """Print how sure the sets are; nothing where no tolerances were sampled."""
    if result.uncertainty is None:
        return
    if result.sets:
        console.print(_table(result.sets, "How sure they are"))
    if result.unsure:
        wanted = likely(result.uncertainty.confidence or 0.0)
        console.print(_table(result.unsure, f"Stand, but less surely than {wanted}"))
    best = next(iter((*result.sets, *result.unsure)), None)
    if best and best.reliability and not quiet:
        console.print(_spreads(best.reliability))
        console.print(_drivers(best.reliability))
        console.print(_assumed(result))
    _said(console, result)


def _table(sets: tuple[DriveSet, ...], title: str) -> Table:
    heads = ("", "right"), ("set", "left"), ("all pass", "right"), ("±", "right"), ("weakest check", "left")
    loops = [("in closed loop", "right")] if any(one.reliability and one.reliability.loop for one in sets) else []
    table = tables.bare(*heads, ("margin 5 %", "right"), ("median", "right"), *loops, title=title)
    for one in sets:
        found = one.reliability
        if found is None:
            continue
        unknown = f"\nunknown: {', '.join(found.unknown)}" if found.unknown else ""
        table.add_row(
            str(one.rank), _named(one), likely(found.probability), f"{100 * found.error:.2g} %",
            found.weakest + unknown, _margin(found.low), _margin(found.middle), *[_loop(found)][: len(loops)],
        )  # fmt: skip
    return table


def _named(one: DriveSet) -> Text:
    """Motor and gearhead, with the belt where there is one."""
    belt = f" × {one.belt_name}" if one.belt_name else ""
    return Text(f"{one.motor_name}\n{one.gearhead_name}{belt}")


def _loop(found: Reliability) -> str:
    """What the closed loop says, with its own error."""
    if found.loop is None:
        return "–"
    weakest = f"\n{found.loop.weakest}" if found.loop.probability < 1.0 else ""
    return f"{likely(found.loop.probability)} ± {100 * found.loop.error:.2g} %{weakest}"


def _margin(value: float) -> str:
    return percent(value) if isfinite(value) else "–"


def _spreads(found: Reliability) -> Table:
    """The checks of the best set that samples move, those that fail most first."""
    heads = ("check", "left"), ("passes", "right"), ("margin 5 %", "right"), ("50 %", "right"), ("95 %", "right")
    table = tables.bare(*heads, title="The best of them, check by check")
    moved = [one for one in found.checks if one.low != one.high and one.low == one.low]
    for one in sorted(moved, key=lambda one: (one.passes, one.low)):
        table.add_row(one.title, likely(one.passes), *(_margin(value) for value in (one.low, one.middle, one.high)))
    return table


def _drivers(found: Reliability) -> Table:
    """What matters most for its smallest margin."""
    heads = ("assumption", "left"), ("share", "right"), ("from", "right"), ("to", "right"), ("smallest margin", "right")
    table = tables.bare(*heads, title="What its smallest margin hangs on most")
    for one in found.drivers[:_DRIVERS]:
        moves = f"{_margin(one.low_margin)} … {_margin(one.high_margin)}"
        table.add_row(one.title, f"{100 * one.share:.0f} %", one.low, one.high, moves)
    return table


def _assumed(result: SizingResult) -> Table:
    """What was uncertain."""
    table = tables.bare(("figure", "left"), ("tolerance", "left"), ("from", "left"), title="What is uncertain")
    for one in result.uncertainty.assumptions if result.uncertainty else ():
        table.add_row(one.title, Text(one.text), one.source)
    return table


def _said(console: Console, result: SizingResult) -> None:
    found = result.uncertainty
    assert found is not None
    reached = ""
    if found.confidence is not None:
        reached = f", {found.reached} of them as sure as {likely(found.confidence)}"
    sets = "1 set" if found.examined == 1 else f"{found.examined} sets"
    console.print(f"{sets} sampled, {found.samples:,} times each (seed {found.seed}){reached}.")
    for note in found.notes:
        console.print(Text(f"  {note}"))
