"""The candidates: other families, the best drives, the closest rejected, the Pareto front, and how probable each is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isnan, nan
from typing import Any

from drivesizer.output.derivation import minus
from drivesizer.output.document import records as doc
from drivesizer.output.document.content import Content, OfDrives, none_reaches
from drivesizer.output.document.rows import error_text, margin_quantity
from drivesizer.output.parts import unknown_of
from drivesizer.output.words import confidence, likely, loop_text, meeting, moved, number_of, reported
from drivesizer.results.check import Driver, Reliability, Spread, Uncertainty, worst
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import DriveParts, DriveSet
from drivesizer.results.sizing import SizingResult, mass_text, objective_figure, ranked_by, unknown_parts
from drivesizer.units import KINDS


def every_list(result: SizingResult, *, front: bool = True) -> list[tuple[str, DriveSet]]:
    """Every drive of the report with the list that it is on; those of the front have ranks of their own."""
    lists = {"set": result.sets, "unsure": result.unsure, "miss": result.misses}
    return [(name, one) for name, some in (lists | {"front": result.front if front else ()}).items() for one in some]


# -- Drives in rows: names with their part numbers, mass, price, energy, smallest margin.


_SHORT = (
    doc.name("drive", "drive", width=1.3), doc.number("objective"), doc.number("mass", "mass"),
    doc.number("price", "price"), doc.number("energy", "energy"), doc.number("margin", "margin"),
    doc.small("tight", "smallest margin", width=1.0, media="paper"), doc.status("status", yields=True),
)  # fmt: skip
_SHOWN = {"mass", "price", "energy", "margin"}  # objectives that have a column whatever ranks


def short_name(one: DriveSet) -> str:
    """Families, reduction and belt of a drive, without its order numbers."""
    gearhead = f" {one.gearhead.reduction}" if one.actuator else f" + {one.gearhead_name}"
    gearhead = "" if one.gearhead_name == "none" else gearhead
    return f"{one.motor.family}{gearhead}{f' × {one.belt_name}' if one.belt_name else ''}"


def numbers_of(one: DriveSet) -> str:
    """The order numbers of motor and gearhead."""
    turning = ("motor", "gearhead", "actuator")
    return " ".join(part.part for role, part in one.parts.items() if part and role in turning)


def short_drive(one: DriveSet, shared: Sequence[str] = (), objective: str = "mass", *, first: bool = False) -> doc.Row:
    """A drive by its names, mass, price, energy per cycle and smallest margin; and what is open or unknown of it.

    The ``first`` is without its order numbers, which the parts list has.
    """
    tight, energy = worst(one.deciding), objective_figure(one, "energy")
    name, numbers = short_name(one), numbers_of(one)
    lacks = []
    for status in ("unknown", "open"):
        titles = [check.title for check in one.deciding if check.status == status and check.title not in shared]
        lacks += [f"{status}: {titles[0] if len(titles) == 1 else f'{len(titles)} checks'}"] if titles else []
    numbers = "" if first else numbers
    least = "≥ " if unknown_of(one, one.price_of) and one.price_of else ""
    own: doc.Cell = "" if objective in _SHOWN else objective_quantity(one, objective)
    return doc.Row({
        "drive": (doc.Strong(name) if one.rank == 1 else name, doc.Small("; ".join(filter(None, [numbers, *lacks])))),
        "objective": own,
        "mass": mass_quantity(one),
        "price": doc.Quantity(one.price, one.currency, "money",
                              own="" if isnan(one.price) else f"{least}{one.price:.0f} {one.currency}"),
        "energy": doc.Quantity(energy.value, energy.unit, energy.kind, own="–" if isnan(energy.value) else ""),
        "margin": doc.Quantity(tight.margin, "%", "margin") if tight else "–", "tight": tight.title if tight else "",
        "status": (doc.Status(one.status),),
    }, name=f"{one.motor.part}_{one.gearhead.part}", status=one.status, data={"rank": str(one.rank)})  # fmt: skip


def mass_quantity(one: DriveSet) -> doc.Quantity:
    """The mass of a drive, marked where a part's is unknown or estimated."""
    return doc.Quantity(one.mass, "g", "mass", own=mass_text(one))


def objective_quantity(one: DriveSet, objective: str) -> doc.Quantity:
    """The figure that ranked a drive, and of which parts it is alone where those of others are unknown."""
    from drivesizer.spec.drive import OBJECTIVES

    if objective not in OBJECTIVES:
        return doc.Quantity(one.objective, "1", "plain")
    declared = OBJECTIVES[objective]
    lacks = declared.over and unknown_parts(one, objective, one.objective_of)
    note = f"{' and '.join(one.objective_of)} only" if lacks and one.objective_of else ""
    own = mass_text(one) if objective == "mass" else ""
    unit = one.currency if declared.kind == "price" else declared.unit
    return doc.Quantity(one.objective, unit, declared.kind, own=own, note=note)


def short_table(caption: str, drives: Sequence[DriveSet], objective: str, name: str) -> Iterator[doc.Block]:
    """Drives in rows; what is unknown of all of them is said once, below."""
    each = [[check.title for check in one.deciding if check.status == "unknown"] for one in drives]
    shared = [title for title in each[0] if all(title in other for other in each)] if len(drives) > 1 else []
    own = [] if objective not in _SHOWN else ["objective"]
    columns = [
        replace(c, head=objective.replace("_", " ")) if c.key == "objective" else c for c in _SHORT if c.key not in own
    ]
    braked = "brake, " if any(one.brake for one in drives) else ""
    said = caption, f": one drive each, mass with {braked}encoder and controller", doc.Note("energy per cycle of all")
    rows = [short_drive(one, shared, objective, first=one is drives[0]) for one in drives]
    yield doc.Table(said, columns, rows, name, "drive", "alternatives", dense=True, media="print")
    if shared:
        yield doc.Words(f"Unknown of each: {shared[0] if len(shared) == 1 else f'{len(shared)} checks'}.", "note")


@doc.section("alternatives", "Other families", early="answer")
def alternatives(content: Content) -> Iterator[doc.Block]:
    """The best drive of other motor families."""
    result = content.result
    if result.alternatives:
        drives = (*result.sets[:1], *result.alternatives)
        yield from short_table("Beside other motor families", drives, result.objective, "alternatives")
    other = result.unrestricted
    if other and other.label != next((one.label for one in result.sets), ""):
        more = [f"{role} {part.part}" for role, part in (("brake", other.brake), ("encoder", other.encoder)) if part]
        more += [f"controller {other.controller.family}"] if other.controller else []
        price = f"{other.price:.2f} {other.currency}, sum of {' + '.join(other.price_of)}"
        price = price if other.price_of else "unknown"
        mass = f"{mass_text(other)}, sum of {' + '.join(other.mass_of)}"
        yield doc.Words(("Without the families and parts that the spec names, the whole catalogue gives ",
                         doc.Strong(", ".join([other.label, *more])), f" (mass {mass}; price {price})."))  # fmt: skip


@doc.section("ranking", "Ranking", early="ranking", media="terminal")
def ranking(content: Content) -> Iterator[doc.Block]:
    """The best drives in rows."""
    if len(content.result.sets) > 1:
        yield from short_table("Best first", content.result.sets, content.result.objective, "ranking")


@doc.section("screws", "Screws by lead", level=2)
def screws(content: Content) -> Iterator[doc.Block]:
    """Of each lead the smallest screw that holds, and the best drive for it."""
    found = content.result.problem.screw
    if found is None or len(found.tried) < 2:
        return
    objective = content.result.objective.replace("_", " ")
    columns = (doc.number("lead", "lead"), doc.name("title", "screw", width=1.0), doc.number("mass", "mass"),
               doc.Column("drive", "best drive", width=1.2), doc.number("value", objective))  # fmt: skip
    rows = []
    for one in found.tried:
        chosen = one.screw == f"{found.screw.manufacturer} {found.screw.part}"
        cells: dict[str, doc.Cell] = {"lead": doc.Quantity(one.lead, "mm", "length"), "drive": one.drive}
        if not one.screw:
            cells |= {"title": f"none holds: {one.failed}"}
        else:
            cells |= {
                "title": (doc.Strong(one.screw),) if chosen else one.screw,
                "mass": doc.Quantity(one.mass, "g", "mass"),
            }
            cells |= {"drive": one.drive or "none passes"}
        cells |= {"value": doc.Quantity(f.value, f.unit, f.kind)} if (f := one.objective) else {}
        rows.append(doc.Row(cells, name=f"lead_{1e3 * one.lead:.4g}_mm"))
    caption = f"The smallest screw of each lead that holds, and its best drive; {objective} of the drive without it"
    yield doc.Table(caption, columns, rows, "screws", "screw", dense=True)


# -- The best drives and the closest rejected ones, why the others were rejected, and the Pareto front.


_LONGEST_FRONT = 40  # drives of it that are printed


@doc.section("candidates", "Candidates", early="never")
def candidates(content: Content) -> Iterator[doc.Block]:
    """The best drives and the closest rejected ones."""
    result, counts = content.result, content.result.counts
    yield doc.Words(f"{number_of(counts.considered, 'combination')} of motor and gearhead, with the belt, "
                f"{'was' if counts.considered == 1 else 'were'} examined; "
                f"of them {meeting(counts, result.sets[0].status if result.sets else None)}. "
                f"{ranked_by(result.objective, result.sets[:1]).capitalize()}.")  # fmt: skip
    if result.sets or result.misses:
        yield _drives(content)
        margins = ("The drives by mass and smallest margin, numbered as in the table; those of unknown mass are left "
                   "out.")  # fmt: skip
        prices = "The drives by mass and price, each as far as it is known of their parts."
        yield doc.Pair([doc.Picture("sets-margin", margins, "smallest margin over mass of the drives")],
                       [doc.Picture("sets-price", prices, "price over mass of the drives")])  # fmt: skip
    columns, rows = drives_in_rows(every_list(result), result.objective)
    yield doc.Table("All drives", columns, rows, "all-drives", media="book")


def _drives(content: Content) -> doc.Table:
    result = content.result
    check = "smallest margin or failed check" if result.misses else "check of the smallest margin"
    columns = (doc.number("rank", "rank"), doc.Column("motor", "motor", width=1.0), doc.Column("gearhead", "gearhead",
                                                                                               width=1.2),
               doc.number("ratio", "ratio"), doc.number("mass", "mass"),
               doc.number("price", f"price ({result.catalog.currency})"),
               doc.number("margin", "margin"), doc.Column("check", check, width=1.5), doc.status("status"))  # fmt: skip
    required = result.uncertainty.confidence if result.uncertainty else None
    reach = f" that reach the confidence of {confidence(required)}" if required is not None else ""
    below = ", and below them the closest rejected" if result.misses else ""
    caption = f"The best drives{reach}{below}" if result.sets else "The closest rejected drives"
    rows = [doc.Row({"rank": doc.Quantity(one.rank), "motor": one.motor_name, "gearhead": gearhead_words(one,
                                                                                                         belt=False),
                     "ratio": doc.Quantity(one.total_ratio, "1", "plain"), "mass": mass_quantity(one),
                     "price": doc.Quantity(one.price, one.currency, "money", own="" if isnan(one.price)
                                           else f"{one.price:.2f}"), "margin": doc.Quantity(_smallest(one), "%",
                                                                                            "margin"),
                     "check": _limiting(one), "status": (doc.Status(one.status),)}, status=one.status,
                    data={"rank": str(one.rank)}) for one in (*result.sets, *result.misses)]  # fmt: skip
    return doc.Table(caption, columns, rows, "sets", look="sets", dense=True, sortable=True, media="paper")


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
    """The drives of the table as texts, and under ``exact`` mass [g], price and margin [%]; None: unknown."""
    found = []
    for row in _drives(content).rows:
        texts = {key: cell.text for key, cell in row.cells.items() if isinstance(cell, doc.Quantity)}
        texts |= {key: cell for key, cell in row.cells.items() if isinstance(cell, str)}
        texts["price"] += "" if texts["price"] == "unknown" else f" {content.result.catalog.currency}"
        exact = {key: _known(cell.number) for key, cell in row.cells.items() if isinstance(cell, doc.Quantity)}
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


@doc.section("rejected", "Why the others fail", level=2, early="rejected")
def rejected(content: Content) -> Iterator[doc.Block]:
    """The checks that reject the others."""
    result, counts = content.result, content.result.counts
    if result.misses:
        columns = (doc.name("motor", "motor"), doc.Column("gearhead", "gearhead"), doc.Column("check", "fails on",
                                                                                              width=1.0),
                   doc.number("value", "demand"), doc.number("limit", "limit"))  # fmt: skip
        belts = len({one.belt_ratio for one in result.misses}) > 1
        yield doc.Table(
            "Closest rejected", columns, [_rejected_row(one, belts) for one in result.misses], media="terminal"
        )
    titles, budget = CHECKS[result.method], CHECKS["budget"]
    fails = [(f"failed_{name}", titles[name].title, n) for name, n in counts.failed_by.items()]
    fails += [
        (f"failed_budget_{name}", f"in the machine: {budget[name].title}", n)
        for name, n in counts.failed_by_budget.items()
    ]
    if fails:
        heads = (
            doc.name("title", "check", width=1.0),
            doc.number("value", "drives"),
            doc.Column("share", "", "share", 1.0, "paper"),
        )
        rows = [
            doc.Row({"title": title, "value": doc.Quantity(n), "share": doc.Bar(n / counts.considered)}, name=name)
            for name, title, n in sorted(fails, key=lambda one: -one[-1])
        ]
        caption = "Rejected candidates by check: one counts at every check that it fails"
        yield doc.Table(caption, heads, rows, record="count", look="fell")
    numbers = {"considered": ("Combinations that were examined", counts.considered),
               "feasible": ("Drives that fail no check", counts.feasible), "passing": ("Drives that meet all limits",
                                                                                       counts.passing)}  # fmt: skip
    if counts.undecided:
        numbers["undecided"] = ("Drives behind them that may, not computed", counts.undecided)
    rows = [doc.Row({"title": title, "value": doc.Quantity(n)}, name=name) for name, (title, n) in numbers.items()]
    yield doc.Table("Counts", (doc.Column("title"), doc.number("value")), rows, record="count", media="wide")


def _rejected_row(one: DriveSet, belts: bool) -> doc.Row:
    """A rejected drive with its worst check."""
    missed = [check for check in one.deciding if check.status != "pass"]
    failed = [check for check in missed if check.status == "fail"] or missed
    check = worst(tuple(failed)) or next(iter(failed or one.deciding))
    others = "" if len(failed) < 2 else f" and {number_of(len(failed) - 1, 'more check')}"
    bare = isnan(check.demand) and isnan(check.limit) and check.status != "unknown"
    demand, limit = ("" if bare else doc.Quantity(x, check.unit, check.kind) for x in (check.demand, check.limit))
    belt = f" × {one.belt_name or 1}" if belts else ""
    return doc.Row({"motor": one.motor_name, "gearhead": f"{one.gearhead_name}{belt}", "check": check.title + others,
                    "value": demand, "limit": limit})  # fmt: skip


@doc.section("pareto", "Pareto front", level=2, early="answer")
def front(content: Content) -> Iterator[doc.Block]:
    """Drives that no other beats in all of the objectives."""
    result = content.result
    if result.pareto and not result.front:
        yield doc.Words(f"No Pareto front: no drive that passes has known values of {', '.join(result.pareto)}.")
    if not result.front:
        return
    shown = result.front[:_LONGEST_FRONT]
    titles = [objective_figure(shown[0], name).title for name in result.pareto]
    columns = (doc.number("rank", "rank"), doc.Column("motor", "motor", width=1.1), doc.Column("gearhead", "gearhead",
                                                                                               width=1.4),
               *(doc.number(name, title) for name, title in zip(result.pareto, titles, strict=True)),
               doc.status("status"))  # fmt: skip
    rows = []
    for one in shown:
        figures = [objective_figure(one, name) for name in result.pareto]
        cells: dict[str, doc.Cell] = {"rank": doc.Quantity(one.rank), "title": one.label, "motor": one.motor_name}
        cells |= {"gearhead": gearhead_words(one)}
        cells |= {f.name: doc.Quantity(f.value, f.unit, f.kind) for f in figures}
        rows.append(doc.Row(cells | {"status": (doc.Status(one.status),)}, data={"rank": str(one.rank)}))
    caption = "The Pareto front: no other drive equals or beats one of these in all of its figures"
    yield doc.Table(caption, columns, rows, "front", "front", "front", dense=True, sortable=True)
    if len(result.front) > len(shown):
        yield doc.Words(f"And {len(result.front) - len(shown)} more, which the CSV report has.")
    yield doc.Picture("front", "The front by its first two figures, numbered as in the table.",
                      "drives of the front by two figures", about="draws the front.")  # fmt: skip


# -- The probability that each drive passes, its checks over the samples, and the assumptions that matter most.


_MOST_DRIVES = 10
_MOST_CHECKS = 12
_MOST_DRIVERS = 3


@doc.section("probabilities", "Probability that the drives pass", level=2, early="answer")
def probabilities(content: Content) -> Iterator[doc.Block]:
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


def sampled_words(sampled: Uncertainty, none: str = "") -> doc.Bullets:
    """Number of samples and of drives that reach the required confidence."""
    drives = number_of(sampled.examined, "drive")
    intro: list[Any] = [
        f"{drives} sampled, {sampled.samples:,} times each (seed {sampled.seed}), over the tolerances of spec and "
        "catalogue"
    ]
    if none:
        intro += ["; ", doc.Strong(none), ", the most probable come first"]
    elif sampled.confidence is not None:
        reach = "reaches" if sampled.reached == 1 else "reach"
        intro.append(
            f"; {sampled.reached or 'none'} of them {reach} the confidence of {confidence(sampled.confidence)}"
        )
    return doc.Bullets((*intro, ". Basis of the probabilities:"), list(sampled.notes))


def probability_table(caption: str, drives: Sequence[DriveSet], name: str) -> doc.Table:
    """Drives with the probability that all checks pass, and where it is weakest."""
    looped = any(one.reliability and one.reliability.loop for one in drives)
    columns = (
        doc.number("rank"), doc.name("drive", "drive", width=1.0), doc.number("value", "all pass"),
        doc.number("error", "error"), doc.Column("weakest", "weakest check", width=0.9),
        doc.number("low", "margin 5 %"), doc.number("middle", "50 %"),
        doc.number("high", "95 %", media="wide"),
        *((doc.number("loop", "in closed loop"), doc.Column("loop_weakest", "weakest in closed loop", media="wide"),
           doc.number("loop_samples", "samples in closed loop", media="wide")) if looped else ()),
    )  # fmt: skip
    rows = []
    for one in drives:
        found = one.reliability
        assert found is not None
        more = [loop_text(found), f"unknown: {'; '.join(found.unknown)}" if found.unknown else ""]
        cells: dict[str, doc.Cell] = {
            "rank": doc.Quantity(one.rank), "drive": one.label, "value": _chance(found.probability, found.unknown),
            "error": doc.Quantity(found.error, "%", "probability", own=error_text(found.error)),
            "weakest": (found.weakest, doc.Note("; ".join(filter(None, more)))), "low": margin_quantity(found.low),
            "middle": margin_quantity(found.middle), "high": margin_quantity(found.high),
        }  # fmt: skip
        if looped:
            loop = found.loop
            cells["loop"] = _chance(loop.probability, loop.unknown, error_text(loop.error)) if loop else "–"
            cells |= {"loop_weakest": loop.weakest, "loop_samples": doc.Quantity(loop.samples)} if loop else {}
        rows.append(doc.Row(cells, name="all_checks", data={"rank": str(one.rank)}))
    return doc.Table(caption, columns, rows, name, "reliability", "probability", dense=True)


def _chance(probability: float, unknown: Sequence[str], error: str = "") -> doc.Quantity:
    """The probability that all checks pass; where that is unknown, that none of the known ones fails."""
    said = f"{likely(probability)} {error}".strip()
    if unknown:
        return doc.Quantity(nan, "%", "probability", own="unknown", note=f"none fails: {said}")
    return doc.Quantity(probability, "%", "probability", own=said)


@doc.section("reliability", "The drive over its tolerances", level=2, of_drive=True)
def reliability(_: OfDrives, drive: DriveSet) -> Iterator[doc.Block]:
    """A drive over its tolerances: checks, figures, the assumptions that matter most."""
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
    yield doc.Picture(
        "tornado", f"The smallest margin of all checks of {drive.label} with one assumption at its 5 % and at its 95 % "
        "quantile, all others nominal; at the right the share of the variance that each makes alone. Left of the line "
        "the drive does not pass.", "bars of the effect of each assumption on the smallest margin",
        about="draws the effect of each assumption.")  # fmt: skip


def spreads_table(caption: str, checks: Sequence[Spread], name: str) -> doc.Table:
    """Checks over the samples."""
    columns = (doc.name("title", "check", width=1.0), doc.number("value", "passes"), doc.number("fails", "fails",
                                                                                                media="wide"),
               doc.number("weakest", "tightest of all", media="wide"), doc.number("low", "margin 5 %"),
               doc.number("middle", "50 %"), doc.number("high", "95 %"))  # fmt: skip
    rows = [
        doc.Row({"title": one.title, "low": margin_quantity(one.low), "middle": margin_quantity(one.middle),
                 "high": margin_quantity(one.high),
                 **doc.quantities("%", "probability", value=one.passes, fails=one.fails, weakest=one.weakest)},
                name=one.name)
        for one in checks
    ]  # fmt: skip
    return doc.Table(caption, columns, rows, name, "reliability", "probability")


def percentiles_table(caption: str, found: Reliability, name: str) -> doc.Table:
    """Figures over the samples."""
    columns = (
        doc.name("title", "figure", width=1.0),
        *(doc.number(key, f"{q} %") for key, q in (("low", 5), ("middle", 50), ("high", 95))),
    )
    rows = [
        doc.Row(
            {"title": f.title, **doc.quantities(f.unit, f.kind, low=f.low, middle=f.middle, high=f.high)}, name=f.name
        )
        for f in found.figures
    ]
    return doc.Table(caption, columns, rows, name, "percentile", "probability")


def _drivers(caption: str, drivers: Sequence[Driver]) -> doc.Table:
    columns = (doc.name("title", "assumption", width=1.0), doc.number("value", "share"),
               doc.number("correlation", "rank correlation", media="wide"),
               doc.number("low", "margin at 5 %"), doc.small("low_at", "at"),
               doc.number("high", "margin at 95 %"), doc.small("high_at", "at"))  # fmt: skip
    rows = [doc.Row({"title": one.title, "value": doc.Quantity(one.share, "%", "probability",
                                                               own=f"{100 * one.share:.0f} %"),
                     "correlation": doc.Quantity(one.rank_correlation, "1", "plain"),
                     "low": margin_quantity(one.low_margin), "low_at": minus(one.low),
                     "high": margin_quantity(one.high_margin), "high_at": minus(one.high)}, name=one.name)
            for one in drivers]  # fmt: skip
    return doc.Table(caption, columns, rows, "probability-drivers", "driver", "probability")


@doc.section("uncertain", level=2)
def uncertain(content: Content) -> Iterator[doc.Block]:
    """The uncertain figures with their tolerances."""
    if content.result.uncertainty:
        yield uncertain_table(content.result.uncertainty)


def uncertain_table(sampled: Uncertainty) -> doc.Table:
    """The uncertain figures with their tolerances."""
    columns = doc.name("title", "figure"), doc.Column("value", "tolerance"), doc.Column("note", "from", width=1.0)
    rows = [doc.Row({"title": one.title, "value": one.text, "note": one.source}, name=one.name)
            for one in sampled.assumptions]  # fmt: skip
    return doc.Table("Uncertain figures", columns, rows, "uncertain", "uncertain", "probability")


# -- Drives in rows with all that they are, do and hold, for other programs; SI.


_SET = (  # head, and where a drive has it
    ("rank", "rank"), ("status", "status"), ("motor_family", "motor.family"), ("motor_part", "motor.part"),
    ("gearhead_family", "gearhead.family"), ("gearhead_part", "gearhead.part"), ("gearhead_ratio", "gearhead.ratio"),
    ("belt_ratio", "belt_ratio"), ("driving_pulley_part", "belt_drive.driving.part"),
    ("belt_part", "belt_drive.belt.part"), ("driven_pulley_part", "belt_drive.driven.part"),
    ("centre_distance_m", "belt_drive.centre_distance"), ("teeth_in_mesh", "belt_drive.teeth_in_mesh"),
    ("screw_part", "chosen_screw.screw.part"), ("brake_family", "brake.family"), ("brake_part", "brake.part"),
    ("encoder_family", "encoder.family"), ("encoder_part", "encoder.part"), ("controller_family", "controller.family"),
    ("controller_part", "controller.part"), ("total_ratio", "total_ratio"), ("mass_kg", "mass"), ("mass_of", "mass_of"),
    ("mass_estimated_of", "mass_estimated"),
    ("price_EUR", "price"), ("price_of", "price_of"),
)  # fmt: skip
_WHOLE = (  # of its probability
    ("probability", "passing"), ("none_fails", "probability"), ("probability_error_95", "error"),
    ("weakest_check", "weakest"), ("unknown_checks", "unknown"), ("smallest_margin_5", "low"),
    ("smallest_margin_50", "middle"), ("smallest_margin_95", "high"),
)  # fmt: skip
_LOOP = (
    ("closed_loop_probability", "loop.passing"), ("closed_loop_none_fails", "loop.probability"),
    ("closed_loop_error_95", "loop.error"), ("closed_loop_weakest_check", "loop.weakest"),
    ("closed_loop_unknown_checks", "loop.unknown"), ("closed_loop_samples", "loop.samples"),
)  # fmt: skip
_SPREAD = (
    ("passes", "passes"),
    ("fails", "fails"),
    ("margin_5", "low"),
    ("margin_50", "middle"),
    ("margin_95", "high"),
)


def drives_in_rows(drives: Sequence[tuple[str, DriveSet]], objective: str) -> tuple[list[doc.Column], list[doc.Row]]:
    """Drives with the list that each is on, its margins, figures and probabilities."""
    slug = "_".join(objective.replace("+", " ").replace(",", " ").split())
    nominal = [{"list": where} | dict(_nominal(one, slug)) for where, one in drives]
    sampled = [dict(_sampled(one.reliability)) if one.reliability else {} for _, one in drives]
    currency = drives[0][1].currency if drives else "EUR"
    heads = ["list", *(head.replace("EUR", currency) for head, _ in _SET), f"objective_{slug}_si"]
    heads += ["smallest_margin", "smallest_margin_check"]
    for begin in ("margin_", "figure_"):
        heads += [head for cells in nominal for head in cells if head.startswith(begin)]
    for wanted in (_WHOLE, _LOOP):
        heads += [head for head, _ in wanted if any(head in cells for cells in sampled)]
    heads += [head for cells in sampled for head in cells]
    columns = [doc.number(head, head.replace("_", " ")) for head in dict.fromkeys(heads)]
    return columns, [doc.Row(one | other) for one, other in zip(nominal, sampled, strict=True)]


def _nominal(one: DriveSet, slug: str) -> Iterator[tuple[str, doc.Cell]]:
    for head, cell in _read(one, _SET):
        yield head.replace("EUR", one.currency), cell
    yield f"objective_{slug}_si", _cell(one.objective)
    if tight := worst(one.deciding):
        yield from (("smallest_margin", _cell(tight.margin)), ("smallest_margin_check", tight.name))
    for check in one.own_checks:
        yield f"margin_{check.name}", _cell(check.margin)
    for f in one.figures:
        yield f"figure_{f.name}_{KINDS[f.kind].si}", _cell(f.value)


def _sampled(found: Reliability) -> Iterator[tuple[str, doc.Cell]]:
    yield from _read(found, _WHOLE)
    titles = {check.title: check.name for check in found.checks}
    yield "weakest_check", titles.get(found.weakest, found.weakest)
    yield from _read(found, _LOOP)
    for check in found.checks:
        yield from ((f"{head}_{check.name}", cell) for head, cell in _read(check, _SPREAD))


def _read(record: Any, wanted: Sequence[tuple[str, str]]) -> Iterator[tuple[str, doc.Cell]]:
    """Cells of a record by the paths of its attributes; none behind what it has not."""
    for head, path in wanted:
        value = record
        for name in path.split("."):
            value = getattr(value, name) if value is not None else None
        if value is not None:
            yield head, _cell(value, " + " if head.endswith("_of") else "; ")


def _cell(value: Any, between: str = "") -> doc.Cell:
    if isinstance(value, tuple):
        return between.join(value)
    return value if isinstance(value, str) else doc.Quantity(value, "1", "count" if isinstance(value, int) else "plain")
