"""The candidates: the best drives, the closest rejected ones, the Pareto front, and how probable each passes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from math import isnan, nan
from typing import Any

from drivesizer.output.derivation import margin
from drivesizer.output.json.documents import number
from drivesizer.output.parts import unknown_of
from drivesizer.output.report.lines import rows as table
from drivesizer.output.report.lines.rows import (
    Row as SheetRow,
)
from drivesizer.output.report.lines.rows import (
    below_confidence_row,
    check_cells,
    drive_cells,
    driver_cells,
    every_list,
    method_of,
    none_reaches,
    reliability_rows,
    reported,
    sampling_rows,
)
from drivesizer.output.report.sections.section import (
    RANK,
    STATUS,
    Block,
    Bullets,
    Column,
    Content,
    CsvRows,
    Number,
    Pair,
    Picture,
    Row,
    Section,
    Sheet,
    SheetColumn,
    Status,
    Strong,
    Table,
    Text,
    Words,
    headed,
)
from drivesizer.output.words import confidence, meeting, moved, number_of
from drivesizer.results.check import Uncertain, Uncertainty
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import DriveParts, DriveSet
from drivesizer.results.sizing import objective_figure, ranked_by, worst
from drivesizer.units import from_si, show

__all__ = ["CANDIDATES", "RELIABILITY", "candidate_numbers", "gearhead_words"]


# -- The candidates: the best drives, the closest rejected ones, why the others were rejected, and the Pareto front.


_LONGEST_FRONT = 40  # drives of it that are printed


def _candidates_blocks(content: Content) -> Iterator[Block]:
    result = content.result
    counts = result.counts
    yield Words(f"{number_of(counts.considered, 'combination')} of motor and gearhead, with the belt, "
                f"{'was' if counts.considered == 1 else 'were'} examined; "
                f"of them {meeting(counts, result.sets[0].status if result.sets else None)}. "
                f"Ranked by {result.objective.replace('_', ' ')}.")  # fmt: skip
    if result.alternatives:
        yield _alternatives(content)
    if result.sets or result.misses:
        yield _drives(content)
        yield Pair([Picture("sets-margin", "The drives by mass and smallest margin, numbered as in the table; those of "
                            "unknown mass are left out.", "smallest margin over mass of the drives")],
                   [Picture("sets-price", "The drives by mass and price, each as far as it is known of their parts.",
                            "price over mass of the drives")])  # fmt: skip
    rejected = [*_rejected(content)]
    if rejected:
        columns = Column("check", "name"), Column("drives", "number"), Column("", "share", 1.0)
        rows = [Row((title, Number(str(n), n), Number("", n / counts.considered))) for title, n in rejected]
        yield Table("Rejected candidates by check: one counts at every check that it fails", columns, rows, look="fell")
    if result.front:
        yield from _front(content)
    other = result.unrestricted
    if other:
        price = f"{other.price:.2f} EUR, sum of {' + '.join(other.price_of)}" if other.price_of else "unknown"
        mass = f"{show(other.mass, 'g', 'mass')}, sum of {' + '.join(other.mass_of)}"
        yield Words(("Without the families and parts that the spec names, the whole catalogue would give ",
                     Strong(other.label), f" ({mass}; {price})."))  # fmt: skip


def _alternatives(content: Content) -> Table:
    """The best drive of each other motor family beside the selected one."""
    result = content.result
    columns = (Column("drive", "name", 1.3), Column("mass", "number"), Column("price", "number"),
               Column("energy", "number"), Column("margin", "number"), Column("smallest margin; unknown", "small", 1.0),
               Column("", "status"))  # fmt: skip
    rows = [Row(_alternative_row(one), status=one.status) for one in (*result.sets[:1], *result.alternatives)]
    return Table("Beside the best drives of other motor families: mass and price of one drive, energy per cycle of "
                 "all, as far as known", columns, rows, "alternatives", "alternatives", dense=True)  # fmt: skip


def _alternative_row(one: DriveSet) -> tuple[Any, ...]:
    tight, energy = worst(one.deciding), objective_figure(one, "energy")
    price = "unknown" if isnan(one.price) else f"{one.price:.2f} EUR"
    least = "≥ " if unknown_of(one, one.price_of) and one.price_of else ""
    lacks = [f"{c.status}: {c.title}" for c in one.deciding if c.status in ("unknown", "open")]
    grounds = "; ".join([*([tight.title] if tight else []), *([_first(lacks)] if lacks else [])])
    return (one.label, show(one.mass, "g", "mass"), least + price, energy.text, margin(tight.margin) if tight else "",
            grounds, (Status(one.status),))  # fmt: skip


def _drives(content: Content) -> Table:
    result = content.result
    check = "smallest margin or failed check" if result.misses else "check of the smallest margin"
    columns = (
        Column("rank", "number"), Column("motor", width=1.0), Column("gearhead", width=1.2), Column("ratio", "number"),
        Column("mass", "number"), Column("price (EUR)", "number"), Column("margin", "number"),
        Column(check, width=1.5), Column("", "status"),
    )  # fmt: skip
    required = result.uncertainty.confidence if result.uncertainty else None
    reach = f" that reach the confidence of {confidence(required)}" if required is not None else ""
    below = ", and below them the closest rejected" if result.misses else ""
    caption = f"The best drives{reach}{below}" if result.sets else "The closest rejected drives"
    rows = []
    for one in candidate_numbers(content):
        exact = one["exact"]
        rows.append(Row(
            (Number(one["rank"], int(one["rank"])), one["motor"], one["gearhead"], Number(one["ratio"], exact["ratio"]),
             Number(one["mass"], exact["mass"], "g"), Number(one["price"].removesuffix(" EUR"), exact["price"], "EUR"),
             Number(one["margin"], exact["margin"]), one["check"], (Status(one["status"]),)),
            {"rank": one["rank"]}, one["status"],
        ))  # fmt: skip
    return Table(caption, columns, rows, name="sets", look="sets", dense=True, sortable=True)


def candidate_numbers(content: Content) -> list[dict[str, Any]]:
    """The drives of the table as texts, and under ``exact`` mass [g], price [EUR], ratio and margin; None: unknown."""
    return [_candidate(one) for one in (*content.result.sets, *content.result.misses)]


def _candidate(one: DriveSet) -> dict[str, Any]:
    tight = worst(one.deciding)
    smallest = number(tight.margin) if tight else None
    failed = [c.title for c in one.deciding if c.status == "fail"]
    return {
        "rank": str(one.rank), "motor": one.motor_name, "gearhead": gearhead_words(one, belt=False),
        "ratio": f"{one.total_ratio:.4g}", "mass": show(one.mass, "g", "mass"),
        "price": "unknown" if isnan(one.price) else f"{one.price:.2f} EUR",
        "margin": margin(tight.margin) if tight else "",
        "check": _first(failed) if failed else tight.title if tight else "", "status": one.status,
        "exact": {
            "ratio": one.total_ratio, "mass": number(float(from_si(one.mass, "g", "mass"))), "price": number(one.price),
            "margin": smallest, "percent": None if smallest is None else 100.0 * smallest,
        },
    }  # fmt: skip


def _first(titles: list[str]) -> str:
    """The first of several checks, and how many more there are."""
    return titles[0] + (f" and {len(titles) - 1} more" if len(titles) > 1 else "")


def gearhead_words(one: DriveParts, *, belt: bool = True) -> str:
    """The gearhead with its part number, and the belt where it is wanted."""
    driven = f" + belt {one.belt_name}" if belt and one.belt_name else ""
    part = one.gearhead.part if "gearhead" in one.parts and one.gearhead.part != one.gearhead_name else ""
    return " ".join(f"{one.gearhead_name} {part}{driven}".split())


def _rejected(content: Content) -> Iterator[tuple[str, int]]:
    """Titles of checks, and how many candidates fail on each."""
    counts, declared = content.result.counts, CHECKS[content.result.method]
    for name, n in sorted(counts.failed_by.items(), key=lambda item: (-item[1], item[0])):
        yield declared[name].title, n
    for name, n in sorted(counts.failed_by_budget.items()):
        yield CHECKS["budget"][name].title, n


def _front(content: Content) -> Iterator[Block]:
    result = content.result
    shown = result.front[:_LONGEST_FRONT]
    figures = [[objective_figure(one, name) for name in result.pareto] for one in shown]
    columns = (Column("rank", "number"), Column("motor", width=1.1), Column("gearhead", width=1.4),
               *(Column(f.title, "number") for f in figures[0]), Column("", "status"))  # fmt: skip
    rows = [
        Row(
            (
                Number(str(one.rank), one.rank),
                one.motor_name,
                gearhead_words(one),
                *(f.text for f in row),
                (Status(one.status),),
            )
        )
        for one, row in zip(shown, figures, strict=True)
    ]
    caption = "The Pareto front: no other drive equals or beats one of these in all of its figures"
    yield Table(caption, columns, rows, name="front", look="front", dense=True, sortable=True)
    if len(result.front) > len(shown):
        yield Words(f"And {len(result.front) - len(shown)} more, which the CSV report has.")
    yield Picture("front", "The front by its first two figures, numbered as in the table.",
                  "drives of the front by two figures", about="draws the front.")  # fmt: skip


# -- the sheet


_COLUMNS = (
    SheetColumn("list", "list"), RANK, STATUS, SheetColumn("motor or actuator", "motor"),
    SheetColumn("motor part", "motor_part"), SheetColumn("gearhead", "gearhead"),
    SheetColumn("gearhead part", "gearhead_part"), SheetColumn("belt", "belt"), SheetColumn("brake", "brake"),
    SheetColumn("encoder", "encoder"),
    SheetColumn("controller", "controller"), SheetColumn("gearhead ratio", "gearhead_ratio"),
    SheetColumn("belt ratio", "belt_ratio"), SheetColumn("total ratio", "total_ratio"),
    SheetColumn("mass (g)", "mass"), SheetColumn("mass of", "mass_of"), SheetColumn("price (EUR)", "price", "money"),
    SheetColumn("price of", "price_of"), SheetColumn("smallest margin (%)", "margin", "percent"),
    SheetColumn("of check", "tightest"), SheetColumn("failed checks", "failed"),
    SheetColumn("unknown checks", "unknown"),
)  # fmt: skip


def _sheet(content: Content) -> list[Sheet]:
    """All drives and the Pareto front, one in a row, with their margins."""
    result = content.result
    drives = every_list(result)
    checks = {c.name: c.title for _, one in drives for c in one.own_checks}
    figures = {f.name: f for _, one in drives for f in one.figures}
    objectives = [objective_figure(drives[0][1], name) for name in result.pareto] if drives else []
    columns = [SheetColumn(headed(f.title, f.unit), f"objective_{f.name}") for f in objectives]
    columns += [SheetColumn(headed(f.title, f.unit), f"figure_{name}") for name, f in figures.items()]
    columns += [SheetColumn(f"margin: {title} (%)", f"margin_{name}", "percent") for name, title in checks.items()]
    return [Sheet(name="Candidates", columns=(*_COLUMNS, *columns), still=4,
                  note=ranked_by(result.objective, [one for _, one in drives]),
                  rows=[{"list": name} | _sheet_row(one, result.pareto) for name, one in drives])]  # fmt: skip


_CHOSEN = ("brake", "encoder", "controller")


def _sheet_row(s: DriveSet, pareto: tuple[str, ...]) -> table.Row:
    tight = worst(s.deciding)
    separate = {role: f"{p.family} {p.part}" if p else "" for role, p in s.parts.items() if role in _CHOSEN}
    objectives = (objective_figure(s, name) for name in pareto)
    return {
        "set_rank": s.rank, "status": s.status, "motor": s.motor_name, "motor_part": (s.actuator or s.motor).part,
        "gearhead": s.gearhead_name, "gearhead_part": s.gearhead.part if "gearhead" in s.parts else "",
        "belt": s.belt_name, "brake": separate.get("brake", ""), "encoder": separate.get("encoder", "inside"),
        "controller": separate.get("controller", "inside"), "gearhead_ratio": s.gearhead.ratio,
        "belt_ratio": s.belt_ratio, "total_ratio": s.total_ratio, "mass": from_si(s.mass, "g", "mass"),
        "mass_of": " + ".join(s.mass_of), "price": s.price, "price_of": " + ".join(s.price_of),
        "margin": tight.margin if tight else nan, "tightest": tight.title if tight else "",
        "failed": "; ".join(c.title for c in s.deciding if c.status == "fail"),
        "unknown": "; ".join(c.title for c in s.deciding if c.status == "unknown"),
        **{f"objective_{f.name}": from_si(f.value, f.unit, f.kind) for f in objectives},
        **{f"figure_{f.name}": from_si(f.value, f.unit, f.kind) for f in s.figures},
        **{f"margin_{c.name}": c.margin for c in s.own_checks if not isnan(c.margin)},
    }  # fmt: skip


# -- the CSV


def _drive_rows(content: Content, where: str, drive: DriveSet) -> Iterator[table.Row]:
    if where == "unsure":
        yield below_confidence_row(content.result)
    yield from table.set_rows(drive, content.result.objective)


def _closing_rows(content: Content) -> Iterator[table.Row]:
    yield from map(table.change_row, content.result.relaxations)
    for drive in content.result.front:
        yield from (row | {"set_rank": drive.rank} for row in table.front_rows(drive, content.result.pareto))


CANDIDATES = Section(
    name="candidates", title="Candidates", blocks=_candidates_blocks, sheets=_sheet,
    csv=CsvRows(before=lambda content: table.count_rows(content.result), of_drive=_drive_rows, after=_closing_rows),
)  # fmt: skip


# -- The probability that each drive passes, its checks over the samples, and the assumptions that matter most.


_MOST_DRIVES = 10
_MOST_CHECKS = 12
_MOST_DRIVERS = 3


def _reliability_blocks(content: Content) -> Iterator[Block]:
    result, best = content.result, reported(content.result)
    sampled = result.uncertainty
    if sampled is None or best is None or best.reliability is None:
        return
    yield Bullets((f"Each drive was sampled {sampled.samples:,} times (seed {sampled.seed}) over the tolerances of "
                   "spec and catalogue.", *_reached(content, sampled), " Basis of the probabilities:"),
                  list(sampled.notes))  # fmt: skip
    yield from _probabilities(content, sampled)
    share = "share that passes, and quantiles of the margin"
    columns = [Column("check", "name", 1.0), Column("passes", "number"), Column("margin 5 %", "number"),
               Column("50 %", "number"), Column("95 %", "number")]  # fmt: skip
    rows = [Row(check_cells(one)) for one in moved(best.reliability)[:_MOST_CHECKS]]
    yield Table(
        f"The checks of {best.label} that samples change: {share}", columns, rows, "probability-checks", "probability"
    )
    columns = [Column("figure", "name", 1.0), *(Column(f"{q} %", "number") for q in (5, 50, 95))]
    rows = [Row([one.title, *one.texts]) for one in best.reliability.figures]
    yield Table(f"Figures of {best.label} over the samples: percentiles", columns, rows, "probability-figures",
                "probability")  # fmt: skip
    columns = [Column("assumption", "name", 1.0), Column("share", "number"), Column("margin at 5 %", "number"),
               Column("margin at 95 %", "number")]  # fmt: skip
    rows = [Row(driver_cells(one)) for one in best.reliability.drivers[:_MOST_DRIVERS]]
    yield Table("What its smallest margin depends on most: share of its variance, and the margin with this alone at "
                "its 5 % and 95 % quantile", columns, rows, "probability-drivers", "probability")  # fmt: skip
    yield Picture(
        "tornado", f"The smallest margin of all checks of {best.label} with one assumption at its 5 % and at its 95 % "
        "quantile, all others nominal; at the right the share of the variance that each makes alone. Left of the line "
        "the drive does not pass.", "bars of the effect of each assumption on the smallest margin",
        about="draws the effect of each assumption.")  # fmt: skip
    columns = [Column("figure", "name"), Column("tolerance"), Column("from", width=1.0)]
    rows = [Row((one.title, one.text, one.source)) for one in sampled.assumptions]
    yield Table("Uncertain figures", columns, rows, "uncertain", "probability")


def _reached(content: Content, sampled: Uncertainty) -> Iterator[str | Strong]:
    none = none_reaches(content.result)
    if none:
        yield from (
            f" Of {number_of(sampled.examined, 'drive')} that {'was' if sampled.examined == 1 else 'were'} sampled ",
            Strong(none),
            "; the most probable come first.",
        )
    elif sampled.confidence is not None:
        reach = "reaches" if sampled.reached == 1 else "reach"
        yield (f" Of {number_of(sampled.examined, 'drive')} {sampled.reached} {reach} the required confidence of "
               f"{confidence(sampled.confidence)}.")  # fmt: skip


def _probabilities(content: Content, sampled: Uncertainty) -> Iterator[Table]:
    """Two tables: drives that reach the required confidence, and drives that do not."""
    caption = "Probability that every check passes, and quantiles of the smallest margin"
    required = confidence(sampled.confidence)
    below = f"drives that meet all limits at nominal figures, but below the confidence of {required}"
    reach = [one for one in content.result.sets[:_MOST_DRIVES] if one.reliability]
    less = [one for one in content.result.unsure[:_MOST_DRIVES] if one.reliability]
    if reach:
        yield _table(caption, reach, "probabilities")
    if less:
        yield _table(below.capitalize() if reach else f"{caption}: {below}", less, "unsure")


def _table(caption: str, drives: Sequence[DriveSet], name: str) -> Table:
    cells = [drive_cells(one) for one in drives]
    looped = any(one["loop"] for one in cells)
    columns = (
        Column("", "number"), Column("drive", "name", 1.0), Column("all pass", "number"), Column("error", "number"),
        Column("weakest check", width=0.9), Column("margin 5 %", "number"), Column("50 %", "number"),
        *((Column("in closed loop", "number"),) if looped else ()),
    )  # fmt: skip
    rows = []
    for one in cells:
        weakest: Text = f"{one['weakest']} ({one['more']})" if one["more"] else one["weakest"]
        first = (one["rank"], one["label"], one["chance"], one["error"], weakest, one["low"], one["middle"])
        rows.append(Row((*first, one["loop"]) if looped else first, {"rank": one["rank"]}))
    return Table(caption, columns, rows, name, "probability", dense=True)


# -- the sheets


_RANK = SheetColumn("drive", "rank", "count")
_MARGINS = (
    SheetColumn("margin that 95 % exceed (%)", "low", "percent"), SheetColumn("median margin (%)", "middle", "percent"),
    SheetColumn("margin that 5 % exceed (%)", "high", "percent"),
)  # fmt: skip
_DRIVES = (
    SheetColumn("list", "list"), _RANK, SheetColumn("motor and gearhead", "label", "", 60),
    SheetColumn("all pass (%)", "probability", "share"), SheetColumn("error, 95 % (%)", "error", "error"),
    SheetColumn("weakest check", "weakest"), *_MARGINS, SheetColumn("unknown checks", "unknown"),
)  # fmt: skip
_LOOP = (
    SheetColumn("all pass in closed loop (%)", "loop_passing", "share"),
    SheetColumn("none fails in closed loop (%)", "loop_probability", "share"),
    SheetColumn("its error, 95 % (%)", "loop_error", "error"), SheetColumn("weakest in closed loop", "loop_weakest"),
    SheetColumn("unknown in closed loop", "loop_unknown"),
    SheetColumn("samples in closed loop", "loop_samples", "count"),
)  # fmt: skip
_CHECKS = (
    _RANK, SheetColumn("check", "title"), SheetColumn("method", "method"), SheetColumn("passes (%)", "passes", "share"),
    SheetColumn("fails (%)", "fails", "share"), SheetColumn("tightest of all (%)", "weakest", "share"), *_MARGINS,
)  # fmt: skip
_UNCERTAIN = (
    _RANK, SheetColumn("figure", "title"), SheetColumn("tolerance", "text"),
    SheetColumn("share of variance (%)", "share", "needed"),
    SheetColumn("rank correlation", "correlation", "correlation"), SheetColumn("low", "low"),
    SheetColumn("smallest margin at low (%)", "low_margin", "percent"), SheetColumn("high", "high"),
    SheetColumn("smallest margin at high (%)", "high_margin", "percent"), SheetColumn("from", "source", "", 70),
)  # fmt: skip


def _sheets(content: Content) -> list[Sheet]:
    """Drives, their checks, and the uncertain figures; none where nothing was sampled."""
    sampled = content.result.uncertainty
    if sampled is None:
        return []
    listed = [(where, one) for where, one in every_list(content.result, front=False) if one.reliability]
    drives = [one for _, one in listed]
    rows = [{"list": where} | _drive_row(one) for where, one in listed]
    columns = (*_DRIVES, *(_LOOP if any("loop_samples" in row for row in rows) else ()))
    return [
        Sheet(name="Tolerances", columns=columns, rows=rows, note=_note(content, sampled), still=3),
        Sheet(name="Tolerance checks", columns=_CHECKS, rows=[row for one in drives for row in _check_rows(one)],
              still=2, note="share of samples; what neither passes nor fails is unknown"),
        Sheet(name="Uncertain figures", columns=_UNCERTAIN, rows=[*_uncertain(drives, sampled.assumptions)], still=2,
              note="low and high: the 5 % and 95 % quantile of this alone; share: of the smallest margin's variance"),
    ]  # fmt: skip


def _note(content: Content, sampled: Uncertainty) -> str:
    drives = f"{sampled.examined} drives" if sampled.examined != 1 else "1 drive"
    said = f"{drives} sampled, {sampled.samples} times each, seed {sampled.seed}"
    if sampled.confidence is None:
        return said
    reached = f"{sampled.reached} of them reach the confidence of {confidence(sampled.confidence)}"
    return f"{said}; {none_reaches(content.result) or reached}"


def _drive_row(one: DriveSet) -> SheetRow:
    found = one.reliability
    assert found is not None
    row: SheetRow = {
        "rank": one.rank, "label": one.label, "probability": found.passing, "error": found.error,
        "weakest": found.weakest, "low": found.low, "middle": found.middle, "high": found.high,
        "unknown": "; ".join(found.unknown),
    }  # fmt: skip
    loop: SheetRow = {}
    if found.loop:
        loop = asdict(found.loop) | {"passing": found.loop.passing, "unknown": "; ".join(found.loop.unknown)}
    return row | {f"loop_{name}": value for name, value in loop.items()}


def _check_rows(one: DriveSet) -> Iterable[SheetRow]:
    """The checks of a drive, those that fail most first."""
    assert one.reliability is not None
    for check in sorted(one.reliability.checks, key=lambda check: -check.fails):
        yield {
            "rank": one.rank, "title": check.title, "method": method_of(check, one), "passes": check.passes,
            "fails": check.fails, "weakest": check.weakest, "low": check.low, "middle": check.middle,
            "high": check.high,
        }  # fmt: skip


def _uncertain(drives: Sequence[DriveSet], assumptions: Iterable[Uncertain]) -> Iterable[SheetRow]:
    """The uncertain figures with their effect on each drive; without a drive alone."""
    figures = {one.name: {"title": one.title, "text": one.text, "source": one.source} for one in assumptions}
    drivers = [(one.rank, driver) for one in drives if one.reliability for driver in one.reliability.drivers]
    for rank, one in drivers:
        yield figures[one.name] | {
            "rank": rank, "share": one.share, "correlation": one.rank_correlation, "low": one.low, "high": one.high,
            "low_margin": one.low_margin, "high_margin": one.high_margin,
        }  # fmt: skip
    if not drivers:
        yield from figures.values()


RELIABILITY = Section(
    name="reliability", title="Probability that the drives pass", level=2, blocks=_reliability_blocks, sheets=_sheets,
    csv=CsvRows(before=lambda content: sampling_rows(content.result),
                of_drive=lambda content, _, drive: reliability_rows(drive)),
)  # fmt: skip
