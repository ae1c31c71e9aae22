"""The candidates: the best drives, the closest rejected ones, why the others were rejected, and the Pareto front."""

from __future__ import annotations

from collections.abc import Iterator
from math import isnan, nan
from typing import Any

from drivesizer.output.counted import meeting, number_of
from drivesizer.output.json.loops import number
from drivesizer.output.probability import confidence
from drivesizer.output.report.lines import rows as table
from drivesizer.output.report.lines.reliability_rows import below_confidence_row, every_list
from drivesizer.output.report.sections.blocks import Block, Column, Pair, Picture, Row, Table, Words
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.section import CsvRows, Section
from drivesizer.output.report.sections.sheet import Sheet, SheetColumn, headed
from drivesizer.output.report.sections.sheets import RANK, STATUS
from drivesizer.output.report.sections.texts import Number, Status, Strong
from drivesizer.output.sums import unknown_of
from drivesizer.output.text import margin
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import DriveParts, DriveSet
from drivesizer.results.objectives import objective_figure, ranked_by
from drivesizer.results.sizing import worst
from drivesizer.units import from_si, show

__all__ = ["CANDIDATES", "candidate_numbers", "gearhead_words"]

_LONGEST_FRONT = 40  # drives of it that are printed


def _blocks(content: Content) -> Iterator[Block]:
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
    name="candidates", title="Candidates", blocks=_blocks, sheets=_sheet,
    csv=CsvRows(before=lambda content: table.count_rows(content.result), of_drive=_drive_rows, after=_closing_rows),
)  # fmt: skip
