"""Probabilities at the terminal: of each drive, of the best one's checks, and the largest influences."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from drivesizer.output.probability import confidence, likely, loop_text, moved
from drivesizer.output.terminal import tables as tables
from drivesizer.output.terminal.tables import percent
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.reliability import Reliability, Uncertainty
from drivesizer.results.sizing import Explanation, SizingResult

__all__ = ["below_confidence", "tolerances", "tolerances_of"]

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
        console.print(_table(result.sets, "Probability that all checks pass"))
    if result.unsure:
        console.print(
            _table(
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
    console.print(_table(pair.sets, "Probability that all checks pass"))
    for one in pair.sets:
        if one.reliability:
            _drive_reliability(console, one.reliability, one.label if len(pair.sets) > 1 else "Check by check")
    console.print(_assumed(pair.uncertainty))
    _summary(console, pair.uncertainty, quiet=False)


_FIGURES = (("all pass", "right"), ("weakest check", "left"), ("margin\n5 %", "right"), ("margin\n50 %", "right"))


def _table(sets: Sequence[DriveSet], title: str) -> Table:
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
