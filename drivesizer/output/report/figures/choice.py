"""Margins of all checks, a Pareto front, and the effect of each assumption, as figures."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite, isnan, nan

from drivesizer.output.derivation import clean, margin, minus, short, use
from drivesizer.output.report.figures import picture
from drivesizer.output.report.figures.picture import Bar, Bars, Curve, Diagram, Plot
from drivesizer.results.check import Check, Driver
from drivesizer.results.sizing import SizingResult, objective_figure
from drivesizer.units import from_si

# -- The margins of all checks as bars: how much of each limit is used, and how much may be.


FARTHEST = 125.0  # % of a limit where the axis ends; a bar that goes on ends in an arrow


def margins(checks: Sequence[Check]) -> Bars:
    """Every check with the used share of its limit; a mark where the required margin begins."""
    rows = []
    for check in checks:
        share_of_limit, allowed = use(check.margin), use(check.needed)
        share = 100.0 * share_of_limit if share_of_limit is not None else 0.0 if check.status == "pass" else FARTHEST
        mark = nan if share_of_limit is None or allowed is None or allowed == 1.0 else 100.0 * allowed
        text = check.status if isnan(check.margin) else margin(check.margin)
        rows.append(Bar(check.title, min(share, FARTHEST), look=check.status, label=text, mark=mark))
    return Bars(rows=rows, across="used share of the limit", unit="%", ends=(0.0, FARTHEST), line=100.0,
                sides=(2.35, 0.62), marks="up to here with the required margin")  # fmt: skip


# -- A Pareto front as a figure: two figures of each drive, and the names where there is room for them.


_SIZE = 6.5  # pt, of a name
_ROOM = (405.0, 173.0)  # pt, of the axes on paper
_LONGEST = 34  # letters of a name
_FEW = 10  # drives with a number beside their point


def trade_off(result: SizingResult) -> Plot | None:
    """Drives of a front by its first two figures, with numbers as in the table; None where fewer than two are known."""
    figures = [[objective_figure(drive, name) for name in result.pareto] for drive in result.front]
    places = [[float(from_si(f.value, f.unit, f.kind)) for f in row[:2]] for row in figures]
    known = [n for n, place in enumerate(places) if isfinite(sum(place))]
    if len(known) < 2:
        return None
    drives = [result.front[n] for n in known]
    texts = [f"{drive.rank}  {drive.label}\n" + "\n".join(f"{f.title} {f.text}" for f in figures[n])
             for n, drive in zip(known, drives, strict=True)]  # fmt: skip
    names = [(f"{drive.rank}  {short(clean(drive.label), _LONGEST)}", str(drive.rank)) for drive in drives]
    return front([places[n] for n in known], names, [(f.title, f.unit) for f in figures[0][:2]], texts)


def front(
    places: Sequence[Sequence[float]], names: Sequence[tuple[str, ...]], heads: Sequence[tuple[str, str]],
    texts: Sequence[str],
) -> Plot:  # fmt: skip
    """Points with the longest of their names that has room."""
    x, y = zip(*places, strict=True)
    spots = picture.spots([*zip(x, y, strict=True)], names, _ROOM, _SIZE)
    points = Curve(name="front", x=x, y=y, mark="o", joined=False, listed=False, texts=texts, spots=spots,
                   keys=[name[-1] for name in names])  # fmt: skip
    (across, unit), (up, of) = heads
    return Plot(diagrams=[Diagram(name=up, unit=of, curves=[points])], across=across, unit=unit)


# -- Effect of each assumption on a drive's smallest margin, the largest on top: a tornado.


MOST = 10  # bars
_LEAST = 0.005  # share of the variance, or of the widest bar, that is drawn


def swings(drivers: Sequence[Driver]) -> list[Driver]:
    """The assumptions that are drawn: those that move the margin.

    In the order of the shares that are printed beside them, and of those with the same the widest bar first.
    """
    wide = {driver: abs(driver.high_margin - driver.low_margin) for driver in drivers}
    known = [driver for driver in drivers if isfinite(driver.low_margin + driver.high_margin)]
    widest = max((wide[driver] for driver in known), default=0.0)
    moving = [driver for driver in known if driver.share >= _LEAST or wide[driver] > _LEAST * widest]
    return sorted(moving, key=lambda driver: (-round(100.0 * driver.share), -wide[driver]))[:MOST]


def tornado(drivers: Sequence[Driver]) -> Bars:
    """Smallest margin with one assumption at its 5 % and at its 95 % quantile, all others nominal.

    Each end of a bar has the value that makes it.
    """
    rows = []
    for driver in swings(drivers):
        (left, at_left), (right, at_right) = sorted(
            ((100.0 * driver.low_margin, minus(driver.low)), (100.0 * driver.high_margin, minus(driver.high))),
            key=lambda end: end[0],
        )
        rows.append(Bar(driver.title, right, left, label=f"{100.0 * driver.share:.0f} %", left=at_left, right=at_right))
    return Bars(rows=rows, across="smallest margin of all checks", unit="%", head="share of\nvariance",
                sides=(2.75, 0.6))  # fmt: skip
