"""The candidates: other families, the best drives, the closest rejected, the Pareto front, and how probable each is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isnan, nan
from typing import Any

from drivesizer.output.derivation import minus
from drivesizer.output.document.content import Content, OfDrives, none_reaches
from drivesizer.output.document.records import (
    Bar,
    Block,
    Bullets,
    Cell,
    Column,
    Note,
    Pair,
    Picture,
    Quantity,
    Row,
    Section,
    Small,
    Status,
    Strong,
    Table,
    Words,
)  # fmt: skip
from drivesizer.output.document.rows import error_text, margin_quantity
from drivesizer.output.parts import unknown_of
from drivesizer.output.words import confidence, likely, loop_text, meeting, moved, number_of, reported
from drivesizer.results.check import Driver, Reliability, Spread, Uncertainty, worst
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import DriveParts, DriveSet
from drivesizer.results.sizing import SizingResult, objective_figure, ranked_by, unknown_parts
from drivesizer.units import KINDS, show


def every_list(result: SizingResult, *, front: bool = True) -> list[tuple[str, DriveSet]]:
    """Every drive of the report with the list that it is on; those of the front have ranks of their own."""
    lists = {"set": result.sets, "unsure": result.unsure, "miss": result.misses}
    return [(name, one) for name, some in (lists | {"front": result.front if front else ()}).items() for one in some]


# -- Drives in rows: names with their part numbers, mass, price, energy, smallest margin.


_SHORT = (
    Column("drive", "drive", "name", 1.3), Column("objective", "", "number"), Column("mass", "mass", "number"),
    Column("price", "price", "number"), Column("energy", "energy", "number"), Column("margin", "margin", "number"),
    Column("tight", "smallest margin", "small", 1.0, media="paper"), Column("status", "", "status", yields=True),
)  # fmt: skip
_SHOWN = {"mass", "price", "energy", "margin"}  # objectives that have a column whatever ranks


def short_drive(one: DriveSet, shared: Sequence[str] = (), objective: str = "mass", *, first: bool = False) -> Row:
    """A drive by its names, mass, price, energy per cycle and smallest margin; and what is open or unknown of it.

    The ``first`` is without its order numbers, which the parts list has.
    """
    tight, energy = worst(one.deciding), objective_figure(one, "energy")
    gearhead = f" {one.gearhead.reduction}" if one.actuator else f" + {one.gearhead_name}"
    gearhead = "" if one.gearhead_name == "none" else gearhead
    family = one.motor.family if one.motor.part != one.motor.family else one.motor.part
    numbers = " ".join(
        part.part for role, part in one.parts.items() if part and role in ("motor", "gearhead", "actuator")
    )
    lacks = []
    for status in ("unknown", "open"):
        titles = [check.title for check in one.deciding if check.status == status and check.title not in shared]
        lacks += [f"{status}: {titles[0] if len(titles) == 1 else f'{len(titles)} checks'}"] if titles else []
    name = f"{family}{gearhead}{f' × {one.belt_name}' if one.belt_name else ''}"
    numbers = "" if first else numbers
    least = "≥ " if unknown_of(one, one.price_of) and one.price_of else ""
    light = "≥ " if not isnan(one.mass) and unknown_parts(one, "mass", one.mass_of) else ""
    mass = Quantity(one.mass, "g", "mass")
    own: Cell = "" if objective in _SHOWN else objective_quantity(one, objective)
    return Row({
        "drive": (Strong(name) if one.rank == 1 else name, Small("; ".join(filter(None, [numbers, *lacks])))),
        "objective": own,
        "mass": Quantity(one.mass, "g", "mass", own=light + mass.text if light else ""),
        "price": Quantity(one.price, "EUR", "money", own="" if isnan(one.price) else f"{least}{one.price:.0f} EUR"),
        "energy": Quantity(energy.value, energy.unit, energy.kind, own="–" if isnan(energy.value) else ""),
        "margin": Quantity(tight.margin, "%", "margin") if tight else "–", "tight": tight.title if tight else "",
        "status": (Status(one.status),),
    }, name=f"{one.motor.part}_{one.gearhead.part}", status=one.status, data={"rank": str(one.rank)})  # fmt: skip


def objective_quantity(one: DriveSet, objective: str) -> Quantity:
    """The figure that ranked a drive, and of which parts it is alone where those of others are unknown."""
    from drivesizer.spec.drive import OBJECTIVES

    if objective not in OBJECTIVES:
        return Quantity(one.objective, "1", "plain")
    declared = OBJECTIVES[objective]
    lacks = declared.over and unknown_parts(one, objective, one.objective_of)
    note = f"{' and '.join(one.objective_of)} only" if lacks and one.objective_of else ""
    return Quantity(one.objective, declared.unit, declared.kind, note=note)


def short_table(caption: str, drives: Sequence[DriveSet], objective: str, name: str) -> Iterator[Block]:
    """Drives in rows; what is unknown of all of them is said once, below."""
    each = [[check.title for check in one.deciding if check.status == "unknown"] for one in drives]
    shared = [title for title in each[0] if all(title in other for other in each)] if len(drives) > 1 else []
    own = [] if objective not in _SHOWN else ["objective"]
    columns = [
        replace(c, head=objective.replace("_", " ")) if c.key == "objective" else c for c in _SHORT if c.key not in own
    ]
    braked = "brake, " if any(one.brake for one in drives) else ""
    said = caption, f": one drive each, mass with {braked}encoder and controller", Note("energy per cycle of all")
    rows = [short_drive(one, shared, objective, first=one is drives[0]) for one in drives]
    yield Table(said, columns, rows, name, "drive", "alternatives", dense=True, media="print")
    if shared:
        yield Words(f"Unknown of each: {shared[0] if len(shared) == 1 else f'{len(shared)} checks'}.", "note")


def _alternatives(content: Content) -> Iterator[Block]:
    result = content.result
    if result.alternatives:
        drives = (*result.sets[:1], *result.alternatives)
        yield from short_table("Beside other motor families", drives, result.objective, "alternatives")
    other = result.unrestricted
    if other:
        more = [f"{role} {part.part}" for role, part in (("brake", other.brake), ("encoder", other.encoder)) if part]
        more += [f"controller {other.controller.family}"] if other.controller else []
        price = f"{other.price:.2f} EUR, sum of {' + '.join(other.price_of)}" if other.price_of else "unknown"
        mass = f"{show(other.mass, 'g', 'mass')}, sum of {' + '.join(other.mass_of)}"
        yield Words(("Without the families and parts that the spec names, the whole catalogue gives ",
                     Strong(", ".join([other.label, *more])), f" (mass {mass}; price {price})."))  # fmt: skip


ALTERNATIVES = Section(name="alternatives", title="Other families", blocks=_alternatives, early="answer")


def _ranking(content: Content) -> Iterator[Block]:
    if len(content.result.sets) > 1:
        yield from short_table("Best first", content.result.sets, content.result.objective, "ranking")


RANKING = Section(name="ranking", title="Ranking", blocks=_ranking, early="ranking", media="terminal")


def _screws(content: Content) -> Iterator[Block]:
    """Of each lead the smallest screw that holds, and the best drive for it."""
    found = content.result.problem.screw
    if found is None or len(found.tried) < 2:
        return
    objective = content.result.objective.replace("_", " ")
    columns = (Column("lead", "lead", "number"), Column("title", "screw", "name", 1.0),
               Column("mass", "mass", "number"), Column("drive", "best drive", width=1.2),
               Column("value", objective, "number"))  # fmt: skip
    rows = []
    for one in found.tried:
        chosen = one.screw == f"{found.screw.manufacturer} {found.screw.part}"
        cells: dict[str, Cell] = {"lead": Quantity(one.lead, "mm", "length"), "drive": one.drive}
        if not one.screw:
            cells |= {"title": f"none holds: {one.failed}"}
        else:
            cells |= {"title": (Strong(one.screw),) if chosen else one.screw, "mass": Quantity(one.mass, "g", "mass")}
            cells |= {"drive": one.drive or "none passes"}
        cells |= {"value": Quantity(f.value, f.unit, f.kind)} if (f := one.objective) else {}
        rows.append(Row(cells, name=f"lead_{1e3 * one.lead:.4g}_mm"))
    caption = f"The smallest screw of each lead that holds, and its best drive; {objective} of the drive without it"
    yield Table(caption, columns, rows, "screws", "screw", dense=True)


SCREWS = Section(name="screws", title="Screws by lead", level=2, blocks=_screws)


# -- The best drives and the closest rejected ones, why the others were rejected, and the Pareto front.


_LONGEST_FRONT = 40  # drives of it that are printed


def _candidates(content: Content) -> Iterator[Block]:
    result, counts = content.result, content.result.counts
    yield Words(f"{number_of(counts.considered, 'combination')} of motor and gearhead, with the belt, "
                f"{'was' if counts.considered == 1 else 'were'} examined; "
                f"of them {meeting(counts, result.sets[0].status if result.sets else None)}. "
                f"{ranked_by(result.objective, result.sets).capitalize()}.")  # fmt: skip
    if result.sets or result.misses:
        yield _drives(content)
        yield Pair([Picture("sets-margin", "The drives by mass and smallest margin, numbered as in the table; those of "
                            "unknown mass are left out.", "smallest margin over mass of the drives")],
                   [Picture("sets-price", "The drives by mass and price, each as far as it is known of their parts.",
                            "price over mass of the drives")])  # fmt: skip
    drives = every_list(result)
    heads, rows = set_columns(drives, result.objective)
    columns = [Column(head, head.replace("_", " "), "number") for head in ("list", *heads)]
    made = [Row(dict(zip(("list", *heads), map(_cell, (where, *row)), strict=True)))
            for (where, _), row in zip(drives, rows, strict=True)]  # fmt: skip
    yield Table("All drives", columns, made, "all-drives", media="book")


def _cell(value: Any) -> Cell:
    return value if isinstance(value, str) else Quantity(value, "1", "count" if isinstance(value, int) else "plain")


def _drives(content: Content) -> Table:
    result = content.result
    check = "smallest margin or failed check" if result.misses else "check of the smallest margin"
    columns = (
        Column("rank", "rank", "number"), Column("motor", "motor", width=1.0),
        Column("gearhead", "gearhead", width=1.2),
        Column("ratio", "ratio", "number"), Column("mass", "mass", "number"), Column("price", "price (EUR)", "number"),
        Column("margin", "margin", "number"), Column("check", check, width=1.5), Column("status", "", "status"),
    )  # fmt: skip
    required = result.uncertainty.confidence if result.uncertainty else None
    reach = f" that reach the confidence of {confidence(required)}" if required is not None else ""
    below = ", and below them the closest rejected" if result.misses else ""
    caption = f"The best drives{reach}{below}" if result.sets else "The closest rejected drives"
    rows = [
        Row({"rank": Quantity(one.rank), "motor": one.motor_name, "gearhead": gearhead_words(one, belt=False),
             "ratio": Quantity(one.total_ratio, "1", "plain"), "mass": Quantity(one.mass, "g", "mass"),
             "price": Quantity(one.price, "EUR", "money", own="" if isnan(one.price) else f"{one.price:.2f}"),
             "margin": Quantity(_smallest(one), "%",
                                "margin"), "check": _limiting(one), "status": (Status(one.status),)},
            status=one.status, data={"rank": str(one.rank)})
        for one in (*result.sets, *result.misses)
    ]  # fmt: skip
    return Table(caption, columns, rows, "sets", look="sets", dense=True, sortable=True, media="paper")


def _smallest(one: DriveSet) -> float:
    tight = worst(one.deciding)
    return tight.margin if tight else nan


def _limiting(one: DriveSet) -> str:
    """The first failed check, and how many more there are; else the one of the smallest margin."""
    failed, tight = [c.title for c in one.deciding if c.status == "fail"], worst(one.deciding)
    if failed:
        return failed[0] + (f" and {len(failed) - 1} more" if len(failed) > 1 else "")
    return tight.title if tight else ""


def candidate_numbers(content: Content) -> list[dict[str, Any]]:
    """The drives of the table as texts, and under ``exact`` mass [g], price [EUR] and margin [%]; None: unknown."""
    found = []
    for row in _drives(content).rows:
        texts = {key: cell.text for key, cell in row.cells.items() if isinstance(cell, Quantity)}
        texts |= {key: cell for key, cell in row.cells.items() if isinstance(cell, str)}
        texts["price"] = texts["price"] if texts["price"] == "unknown" else f"{texts['price']} EUR"
        exact = {key: _known(cell.number) for key, cell in row.cells.items() if isinstance(cell, Quantity)}
        exact["percent"] = None if exact["margin"] is None else 100.0 * exact["margin"]
        found.append({**texts, "status": row.status, "exact": exact})
    return found


def _known(value: float) -> float | None:
    return None if isnan(value) else value


def gearhead_words(one: DriveParts, *, belt: bool = True) -> str:
    """The gearhead with its part number, and the belt where it is wanted."""
    driven = f" + belt {one.belt_name}" if belt and one.belt_name else ""
    part = one.gearhead.part if "gearhead" in one.parts and one.gearhead.part != one.gearhead_name else ""
    return " ".join(f"{one.gearhead_name} {part}{driven}".split())


CANDIDATES = Section(name="candidates", title="Candidates", blocks=_candidates, early="never")


def _rejected(content: Content) -> Iterator[Block]:
    result, counts = content.result, content.result.counts
    if result.misses:
        columns = (Column("motor", "motor", "name"), Column("gearhead", "gearhead"),
                   Column("check", "fails on", width=1.0),
                   Column("value", "demand", "number"), Column("limit", "limit", "number"))  # fmt: skip
        belts = len({one.belt_ratio for one in result.misses}) > 1
        yield Table("Closest rejected", columns, [_rejected_row(one, belts) for one in result.misses], media="terminal")
    titles, budget = CHECKS[result.method], CHECKS["budget"]
    fails = [(f"failed_{name}", titles[name].title, n) for name, n in counts.failed_by.items()]
    fails += [
        (f"failed_budget_{name}", f"in the machine: {budget[name].title}", n)
        for name, n in counts.failed_by_budget.items()
    ]
    if fails:
        heads = (
            Column("title", "check", "name", 1.0),
            Column("value", "drives", "number"),
            Column("share", "", "share", 1.0, "paper"),
        )
        rows = [
            Row({"title": title, "value": Quantity(n), "share": Bar(n / counts.considered)}, name=name)
            for name, title, n in sorted(fails, key=lambda one: -one[-1])
        ]
        caption = "Rejected candidates by check: one counts at every check that it fails"
        yield Table(caption, heads, rows, record="count", look="fell")
    numbers = {"considered": ("Combinations that were examined", counts.considered),
               "feasible": ("Drives that fail no check", counts.feasible),
               "passing": ("Drives that meet all limits", counts.passing)}  # fmt: skip
    if counts.undecided:
        numbers["undecided"] = ("Drives behind them that may, not computed", counts.undecided)
    rows = [Row({"title": title, "value": Quantity(n)}, name=name) for name, (title, n) in numbers.items()]
    yield Table("Counts", (Column("title"), Column("value", "", "number")), rows, record="count", media="wide")


def _rejected_row(one: DriveSet, belts: bool) -> Row:
    """A rejected drive with its worst check."""
    missed = [check for check in one.deciding if check.status != "pass"]
    failed = [check for check in missed if check.status == "fail"] or missed
    check = worst(tuple(failed)) or next(iter(failed or one.deciding))
    others = "" if len(failed) < 2 else f" and {number_of(len(failed) - 1, 'more check')}"
    bare = isnan(check.demand) and isnan(check.limit) and check.status != "unknown"
    demand, limit = ("" if bare else Quantity(x, check.unit, check.kind) for x in (check.demand, check.limit))
    belt = f" × {one.belt_name or 1}" if belts else ""
    return Row({"motor": one.motor_name, "gearhead": f"{one.gearhead_name}{belt}", "check": check.title + others,
                "value": demand, "limit": limit})  # fmt: skip


REJECTED = Section(name="rejected", title="Why the others fail", level=2, blocks=_rejected, early="rejected")


def _front(content: Content) -> Iterator[Block]:
    result = content.result
    if result.pareto and not result.front:
        yield Words(f"No Pareto front: no drive that passes has known values of {', '.join(result.pareto)}.")
    if not result.front:
        return
    shown = result.front[:_LONGEST_FRONT]
    titles = [objective_figure(shown[0], name).title for name in result.pareto]
    columns = (Column("rank", "rank", "number"), Column("motor", "motor", width=1.1),
               Column("gearhead", "gearhead", width=1.4),
               *(Column(name, title, "number") for name, title in zip(result.pareto, titles, strict=True)),
               Column("status", "", "status"))  # fmt: skip
    rows = []
    for one in shown:
        figures = [objective_figure(one, name) for name in result.pareto]
        cells: dict[str, Cell] = {"rank": Quantity(one.rank), "title": one.label, "motor": one.motor_name}
        cells |= {"gearhead": gearhead_words(one)}
        cells |= {f.name: Quantity(f.value, f.unit, f.kind) for f in figures}
        rows.append(Row(cells | {"status": (Status(one.status),)}, data={"rank": str(one.rank)}))
    caption = "The Pareto front: no other drive equals or beats one of these in all of its figures"
    yield Table(caption, columns, rows, "front", "front", "front", dense=True, sortable=True)
    if len(result.front) > len(shown):
        yield Words(f"And {len(result.front) - len(shown)} more, which the CSV report has.")
    yield Picture("front", "The front by its first two figures, numbered as in the table.",
                  "drives of the front by two figures", about="draws the front.")  # fmt: skip


FRONT = Section(name="pareto", title="Pareto front", level=2, blocks=_front, early="answer")


# -- The probability that each drive passes, its checks over the samples, and the assumptions that matter most.


_MOST_DRIVES = 10
_MOST_CHECKS = 12
_MOST_DRIVERS = 3


def _probabilities(content: Content) -> Iterator[Block]:
    """Drives that reach the required confidence, and drives that do not."""
    result, sampled = content.result, content.result.uncertainty
    if sampled is None or reported(result) is None:
        return
    caption, required = (
        "Probability that every check passes, and quantiles of the smallest margin",
        confidence(sampled.confidence),
    )
    below = f"drives that meet all limits at nominal figures, but below the confidence of {required}"
    reach = [one for one in result.sets[:_MOST_DRIVES] if one.reliability]
    less = [one for one in result.unsure[:_MOST_DRIVES] if one.reliability]
    if reach:
        yield probability_table(caption, reach, "probabilities")
    if less:
        yield probability_table(below.capitalize() if reach else f"{caption}: {below}", less, "unsure")
    yield sampled_words(sampled, none_reaches(result))


def sampled_words(sampled: Uncertainty, none: str = "") -> Bullets:
    """Number of samples and of drives that reach the required confidence."""
    drives = number_of(sampled.examined, "drive")
    intro: list[Any] = [
        f"{drives} sampled, {sampled.samples:,} times each (seed {sampled.seed}), over the tolerances of spec and "
        "catalogue"
    ]
    if none:
        intro += ["; ", Strong(none), ", the most probable come first"]
    elif sampled.confidence is not None:
        reach = "reaches" if sampled.reached == 1 else "reach"
        intro.append(
            f"; {sampled.reached or 'none'} of them {reach} the confidence of {confidence(sampled.confidence)}"
        )
    return Bullets((*intro, ". Basis of the probabilities:"), list(sampled.notes))


def probability_table(caption: str, drives: Sequence[DriveSet], name: str) -> Table:
    """Drives with the probability that all checks pass, and where it is weakest."""
    looped = any(one.reliability and one.reliability.loop for one in drives)
    columns = (
        Column("rank", "", "number"), Column("drive", "drive", "name", 1.0), Column("value", "all pass", "number"),
        Column("error", "error", "number"), Column("weakest", "weakest check", width=0.9),
        Column("low", "margin 5 %", "number"), Column("middle", "50 %", "number"),
        Column("high", "95 %", "number", media="wide"),
        *((Column("loop", "in closed loop", "number"), Column("loop_weakest", "weakest in closed loop", media="wide"),
           Column("loop_samples", "samples in closed loop", "number", media="wide")) if looped else ()),
    )  # fmt: skip
    rows = []
    for one in drives:
        found = one.reliability
        assert found is not None
        more = [loop_text(found), f"unknown: {'; '.join(found.unknown)}" if found.unknown else ""]
        cells: dict[str, Cell] = {
            "rank": Quantity(one.rank), "drive": one.label, "value": _chance(found.probability, found.unknown),
            "error": Quantity(found.error, "%", "probability", own=error_text(found.error)),
            "weakest": (found.weakest, Note("; ".join(filter(None, more)))), "low": margin_quantity(found.low),
            "middle": margin_quantity(found.middle), "high": margin_quantity(found.high),
        }  # fmt: skip
        if looped:
            loop = found.loop
            cells["loop"] = _chance(loop.probability, loop.unknown, error_text(loop.error)) if loop else "–"
            cells |= {"loop_weakest": loop.weakest, "loop_samples": Quantity(loop.samples)} if loop else {}
        rows.append(Row(cells, name="all_checks", data={"rank": str(one.rank)}))
    return Table(caption, columns, rows, name, "reliability", "probability", dense=True)


def _chance(probability: float, unknown: Sequence[str], error: str = "") -> Quantity:
    """The probability that all checks pass; where that is unknown, that none of the known ones fails."""
    said = f"{likely(probability)} {error}".strip()
    if unknown:
        return Quantity(nan, "%", "probability", own="unknown", note=f"none fails: {said}")
    return Quantity(probability, "%", "probability", own=said)


PROBABILITIES = Section(
    name="probabilities", title="Probability that the drives pass", level=2, blocks=_probabilities, early="answer"
)


def _reliability(_: OfDrives, drive: DriveSet) -> Iterator[Block]:
    found = drive.reliability
    if found is None:
        return
    yield spreads_table(
        f"The checks of {drive.label} that samples change: share that passes, and quantiles of the margin",
        moved(found)[:_MOST_CHECKS],
        "probability-checks",
    )
    others = [one for one in found.checks if one not in moved(found)[:_MOST_CHECKS]]
    if others:
        yield replace(spreads_table("Its other checks", others, "probability-others"), media="wide")
    if found.figures:
        yield percentiles_table(f"Figures of {drive.label} over the samples: percentiles", found, "probability-figures")
    if found.drivers:
        yield _drivers("What its smallest margin depends on most: share of its variance, and the margin with this "
                       "alone at its 5 % and 95 % quantile", found.drivers[:_MOST_DRIVERS])  # fmt: skip
        if found.drivers[_MOST_DRIVERS:]:
            yield replace(_drivers("Other assumptions", found.drivers[_MOST_DRIVERS:]), name="", media="wide")
    yield Picture(
        "tornado", f"The smallest margin of all checks of {drive.label} with one assumption at its 5 % and at its 95 % "
        "quantile, all others nominal; at the right the share of the variance that each makes alone. Left of the line "
        "the drive does not pass.", "bars of the effect of each assumption on the smallest margin",
        about="draws the effect of each assumption.")  # fmt: skip


def spreads_table(caption: str, checks: Sequence[Spread], name: str) -> Table:
    """Checks over the samples."""
    columns = (Column("title", "check", "name", 1.0), Column("value", "passes", "number"),
               Column("fails", "fails", "number", media="wide"),
               Column("weakest", "tightest of all", "number", media="wide"), Column("low", "margin 5 %", "number"),
               Column("middle", "50 %", "number"), Column("high", "95 %", "number"))  # fmt: skip
    rows = [
        Row({"title": one.title, **{key: Quantity(x, "%", "probability") for key,
                                    x in (("value", one.passes), ("fails", one.fails), ("weakest", one.weakest))},
             **{key: margin_quantity(x) for key, x in (("low", one.low), ("middle", one.middle),
                                                       ("high", one.high))}}, name=one.name)
        for one in checks
    ]  # fmt: skip
    return Table(caption, columns, rows, name, "reliability", "probability")


def percentiles_table(caption: str, found: Reliability, name: str) -> Table:
    """Figures over the samples."""
    columns = (
        Column("title", "figure", "name", 1.0),
        *(Column(key, f"{q} %", "number") for key, q in (("low", 5), ("middle", 50), ("high", 95))),
    )
    rows = [
        Row({"title": one.title, **{key: Quantity(getattr(one, key), one.unit, one.kind)
                                    for key in ("low", "middle", "high")}}, name=one.name)
        for one in found.figures
    ]  # fmt: skip
    return Table(caption, columns, rows, name, "percentile", "probability")


def _drivers(caption: str, drivers: Sequence[Driver]) -> Table:
    columns = (Column("title", "assumption", "name", 1.0), Column("value", "share", "number"),
               Column("correlation", "rank correlation", "number", media="wide"),
               Column("low", "margin at 5 %", "number"), Column("low_at", "at", "small"),
               Column("high", "margin at 95 %", "number"), Column("high_at", "at", "small"))  # fmt: skip
    rows = [
        Row({"title": one.title, "value": Quantity(one.share, "%", "probability", own=f"{100 * one.share:.0f} %"),
             "correlation": Quantity(one.rank_correlation, "1", "plain"), "low": margin_quantity(one.low_margin),
             "low_at": minus(one.low), "high": margin_quantity(one.high_margin), "high_at": minus(one.high)},
            name=one.name)
        for one in drivers
    ]  # fmt: skip
    return Table(caption, columns, rows, "probability-drivers", "driver", "probability")


RELIABILITY = Section(
    name="reliability", title="The drive over its tolerances", level=2, blocks=_reliability, of_drive=True
)


def _uncertain(content: Content) -> Iterator[Block]:
    if content.result.uncertainty:
        yield uncertain_table(content.result.uncertainty)


def uncertain_table(sampled: Uncertainty) -> Table:
    """The uncertain figures with their tolerances."""
    columns = Column("title", "figure", "name"), Column("value", "tolerance"), Column("note", "from", width=1.0)
    rows = [
        Row({"title": one.title, "value": one.text, "note": one.source}, name=one.name) for one in sampled.assumptions
    ]
    return Table("Uncertain figures", columns, rows, "uncertain", "uncertain", "probability")


UNCERTAIN = Section(name="uncertain", title="", level=2, blocks=_uncertain)


# -- Drives in rows with all that they are, do and hold, for other programs.


_SET_HEADS = (
    "rank", "status", "motor_family", "motor_part", "gearhead_family", "gearhead_part", "gearhead_ratio",
    "belt_ratio", "driving_pulley_part", "belt_part", "driven_pulley_part", "centre_distance_m", "teeth_in_mesh",
    "screw_part", "brake_family", "brake_part", "encoder_family", "encoder_part", "controller_family",
    "controller_part", "total_ratio", "mass_kg", "mass_of", "price_EUR", "price_of",
)  # fmt: skip
_WHOLE = ("probability", "none_fails", "probability_error_95", "weakest_check", "unknown_checks", "smallest_margin_5",
          "smallest_margin_50", "smallest_margin_95")  # fmt: skip
_LOOP = ("closed_loop_probability", "closed_loop_none_fails", "closed_loop_error_95", "closed_loop_weakest_check",
         "closed_loop_unknown_checks", "closed_loop_samples")  # fmt: skip
_QUANTILES = ("margin_5", "margin_50", "margin_95")


def set_columns(drives: Sequence[tuple[str, DriveSet]], objective: str) -> tuple[list[str], list[list[Any]]]:
    """Heads, and drives in rows with all that they are, do and hold; SI."""
    sets = [one for _, one in drives]
    checks = list(dict.fromkeys(c.name for s in sets for c in s.own_checks))
    figures = {f.name: f.kind for s in sets for f in s.figures}
    slug = "_".join(objective.replace("+", " ").replace(",", " ").split())
    heads = [*_SET_HEADS, f"objective_{slug}_si", "smallest_margin", "smallest_margin_check"]
    heads += [*(f"margin_{name}" for name in checks), *(f"figure_{name}_{KINDS[k].si}" for name, k in figures.items())]
    sampled = [one.reliability for one in sets if one.reliability]
    if sampled:
        spread = dict.fromkeys(check.name for one in sampled for check in one.checks)
        heads += [*_WHOLE, *(_LOOP if any(one.loop for one in sampled) else ())]
        heads += [f"{head}_{name}" for name in spread for head in ("passes", "fails", *_QUANTILES)]
    found = (_set_cells(one) | {f"objective_{slug}_si": one.objective} for one in sets)
    return heads, [[cells.get(head, "") for head in heads] for cells in found]


def _set_cells(s: DriveSet) -> dict[str, Any]:
    tight, belt = worst(s.deciding), s.belt_drive
    cells: dict[str, Any] = {
        "rank": s.rank, "status": s.status, "gearhead_ratio": s.gearhead.ratio, "belt_ratio": s.belt_ratio,
        "total_ratio": s.total_ratio, "mass_kg": s.mass, "mass_of": " + ".join(s.mass_of), "price_EUR": s.price,
        "price_of": " + ".join(s.price_of), "screw_part": s.chosen_screw.screw.part if s.chosen_screw else "",
        "smallest_margin": tight.margin if tight else "", "smallest_margin_check": tight.name if tight else "",
    }  # fmt: skip
    for role in ("motor", "gearhead", "brake", "encoder", "controller"):
        part = getattr(s, role)
        cells |= {f"{role}_family": part.family, f"{role}_part": part.part} if part else {}
    if belt:
        cells |= {f"{role.replace(' ', '_')}_part": part.part for role, part in belt.parts.items()}
        cells |= {"centre_distance_m": belt.centre_distance, "teeth_in_mesh": belt.teeth_in_mesh}
    cells |= {f"margin_{c.name}": c.margin for c in s.own_checks}
    cells |= {f"figure_{f.name}_{KINDS[f.kind].si}": f.value for f in s.figures}
    found = s.reliability
    if found:
        weakest = next((check.name for check in found.checks if check.title == found.weakest), found.weakest)
        whole = (
            found.passing,
            found.probability,
            found.error,
            weakest,
            "; ".join(found.unknown),
            found.low,
            found.middle,
            found.high,
        )
        cells |= dict(zip(_WHOLE, whole, strict=True))
        if found.loop:
            loop = found.loop
            driven = (loop.passing, loop.probability, loop.error, loop.weakest, "; ".join(loop.unknown), loop.samples)
            cells |= dict(zip(_LOOP, driven, strict=True))
        for check in found.checks:
            spread = (check.passes, check.fails, check.low, check.middle, check.high)
            cells |= {
                f"{head}_{check.name}": x for head, x in zip(("passes", "fails", *_QUANTILES), spread, strict=True)
            }
    return cells
