"""How sure the sets are, at the terminal: probabilities, margins of the best set, and what matters most."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from drivesizer.output.probability_order import moved
from drivesizer.output.probability_words import asked_for, in_the_loop, likely
from drivesizer.output.terminal import tables as tables
from drivesizer.output.terminal.tables import percent
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.reliability import Reliability, Uncertainty
from drivesizer.results.sizing import Explanation, SizingResult

__all__ = ["none_as_sure", "tolerances", "tolerances_of"]

_DRIVERS = 3
_NEAR = 0.0995  # margin below which its tenths are told


def none_as_sure(result: SizingResult) -> str:
    """That no set reaches the confidence that was asked for."""
    wanted = result.uncertainty.confidence if result.uncertainty else None
    return f"No set is as sure as {asked_for(wanted)}."


def tolerances(console: Console, result: SizingResult, *, quiet: bool = False) -> None:
    """Print how sure the sets are; nothing where no tolerances were sampled."""
    told = result.uncertainty
    if told is None or not (result.sets or result.unsure):
        return
    if result.sets:
        console.print(_table(result.sets, "How sure they are"))
    if result.unsure:
        console.print(_table(result.unsure, f"Stand, but less surely than {asked_for(told.confidence)}"))
    best = next(iter((*result.sets, *result.unsure)))
    if best.reliability and not quiet:
        named = f"Set {best.rank}" if len(result.sets) + len(result.unsure) > 1 else "The set"
        _of_a_set(console, best.reliability, f"{named}, check by check")
        console.print(_assumed(told))
    _said(console, told, quiet=quiet)


def tolerances_of(console: Console, pair: Explanation) -> None:
    """Print how sure one pair is with each belt ratio; nothing where no tolerances were sampled."""
    if pair.uncertainty is None:
        return
    console.print(_table(pair.sets, "How sure it is"))
    for one in pair.sets:
        if one.reliability:
            _of_a_set(console, one.reliability, one.label if len(pair.sets) > 1 else "Check by check")
    console.print(_assumed(pair.uncertainty))
    _said(console, pair.uncertainty, quiet=False)


_FIGURES = (("all pass", "right"), ("weakest check", "left"), ("margin\n5 %", "right"), ("margin\n50 %", "right"))


def _table(sets: Sequence[DriveSet], title: str) -> Table:
    """A set in two lines: a probability stands over its error, as the motor over the gearhead."""
    loops = [("in closed\nloop", "right")] if any(one.reliability and one.reliability.loop for one in sets) else []
    table = tables.bare(("", "right"), ("set", "left"), *_FIGURES, *loops, title=title)
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
    """Leave it to the columns of words to become narrow: figures stay whole."""
    for column in table.columns:
        column.no_wrap = column.justify == "right"


def _named(one: DriveSet) -> Text:
    """Motor and gearhead, with the belt where there is one."""
    belt = f" × {one.belt_name}" if one.belt_name else ""
    return Text(f"{one.motor_name}\n{one.gearhead_name}{belt}")


def _all_pass(found: Reliability) -> str:
    """How probable it is that all checks pass; where that is unknown, that none of the known ones fails."""
    return _chance(found.probability, found.error, found.unknown)


def _chance(probability: float, error: float, unknown: tuple[str, ...]) -> str:
    if unknown:
        return f"unknown; none\nfails: {likely(probability)}"
    return f"{likely(probability)}\n± {100 * error:.2g} %"


def _weakest(found: Reliability) -> Text:
    """The weakest check, that of the closed loop where it fails, and what no sample can tell."""
    loop = in_the_loop(found)
    unknown = f"\nunknown: {'; '.join(found.unknown)}" if found.unknown else ""
    return Text(found.weakest + (f"\n{loop}" if loop else "")) + Text(unknown, style="yellow")


def _loop(found: Reliability) -> str:
    """What the closed loop says, with its own error."""
    return _chance(found.loop.probability, found.loop.error, found.loop.unknown) if found.loop else "–"


def _margin(value: float) -> str:
    """A margin, near the limit to a tenth of a per cent: whether it is one is what samples tell.

    >>> _margin(-0.0034), _margin(0.213)
    ('-0.3 %', '+21 %')
    """
    if not isfinite(value):
        return "–"
    return f"{100 * value:+.1f} %" if abs(value) < _NEAR else percent(value)


def _of_a_set(console: Console, found: Reliability, title: str) -> None:
    console.print(_spreads(found, title))
    if found.drivers:
        console.print(_drivers(found))


def _spreads(found: Reliability, title: str) -> Table:
    """The checks of a set that samples move, those that fail most first."""
    heads = ("check", "left"), ("passes", "right"), ("margin 5 %", "right"), ("50 %", "right"), ("95 %", "right")
    table = tables.bare(*heads, title=title)
    _unbroken(table)
    for one in moved(found):
        table.add_row(one.title, likely(one.passes), *(_margin(value) for value in (one.low, one.middle, one.high)))
    return table


def _drivers(found: Reliability) -> Table:
    """What matters most for its smallest margin."""
    heads = ("assumption", "left"), ("share", "right"), ("from", "right"), ("to", "right"), ("smallest margin", "right")
    table = tables.bare(*heads, title="What its smallest margin hangs on most")
    _unbroken(table)
    for one in found.drivers[:_DRIVERS]:
        moves = f"{_margin(one.low_margin)} … {_margin(one.high_margin)}"
        table.add_row(one.title, f"{100 * one.share:.0f} %", one.low, one.high, moves)
    return table


def _assumed(found: Uncertainty) -> Table:
    """What was uncertain."""
    table = tables.bare(("figure", "left"), ("tolerance", "left"), ("from", "left"), title="What is uncertain")
    for one in found.assumptions:
        table.add_row(one.title, Text(one.text), one.source)
    return table


def _said(console: Console, found: Uncertainty, *, quiet: bool) -> None:
    sets = "1 set" if found.examined == 1 else f"{found.examined} sets"
    console.print(f"{sets} sampled, {found.samples:,} times each (seed {found.seed}){_reached(found)}.")
    for note in () if quiet else found.notes:
        console.print(Padding(Text(note), (0, 0, 0, 2)))
    console.print()


def _reached(found: Uncertainty) -> str:
    """How many are as sure as was asked for."""
    if found.confidence is None:
        return ""
    wanted = asked_for(found.confidence)
    if found.examined == 1:
        return f": {'' if found.reached else 'not '}as sure as {wanted}"
    return f", {found.reached or 'none'} of them as sure as {wanted}"
