"""The candidates: other families, the best drives, the closest rejected, the Pareto front, and how probable each is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isnan, nan
from typing import Any

from drivesizer.output.derivation import minus
from drivesizer.output.document import records as doc
from drivesizer.output.document.content import Content, OfDrives
from drivesizer.output.document.rows import error_text, margin_quantity, margins
from drivesizer.output.parts import unknown_of
from drivesizer.output.words import confidence, likely, loop_text, meeting, number_of, reported, varying_checks
from drivesizer.results.check import Driver, Reliability, Spread, Uncertainty, worst
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.drive_set import DriveParts, DriveSet
from drivesizer.results.sizing import SizingResult, objective_figure, ranked_by
from drivesizer.units import KINDS


def every_list(result: SizingResult, *, front: bool = True) -> list[tuple[str, DriveSet]]:
    """Every drive of the report with the list that it is on; those of the front have ranks of their own."""
    lists = {"set": result.sets, "unsure": result.unsure, "miss": result.misses}
    return [
        (name, drive) for name, drives in (lists | {"front": result.front if front else ()}).items() for drive in drives
    ]


# -- Drives in rows: names with their part numbers, mass, price, energy, smallest margin.


_WITH_COLUMN = {"mass", "price", "energy", "margin"}  # objectives that have a column whatever ranks


def short_name(drive: DriveSet) -> str:
    """Families, reduction and belt of a drive, without its order numbers."""
    gearhead = f" {drive.gearhead.reduction}" if drive.actuator else f" + {drive.gearhead_name}"
    gearhead = "" if drive.gearhead_name == "none" else gearhead
    return f"{drive.motor.family}{gearhead}{f' × {drive.belt_name}' if drive.belt_name else ''}"


def numbers_of(drive: DriveSet) -> str:
    """The order numbers of motor and gearhead."""
    turning = ("motor", "gearhead", "actuator")
    return " ".join(part.part for role, part in drive.parts.items() if part and role in turning)


def short_drive(
    drive: DriveSet, shared: Sequence[str] = (), objective: str = "mass", *, first: bool = False
) -> doc.Row:
    """A drive by its names, mass, price, energy per cycle and smallest margin; and what is open or unknown of it.

    The ``first`` is without its order numbers, which the parts list has.
    """
    tight, energy = worst(drive.deciding), objective_figure(drive, "energy")
    name, small = short_name(drive), [] if first else [numbers_of(drive)]
    for status in ("unknown", "open"):
        titles = [check.title for check in drive.deciding if check.status == status and check.title not in shared]
        small += [f"{status}: {titles[0] if len(titles) == 1 else f'{len(titles)} checks'}"] if titles else []
    least = "≥ " if unknown_of(drive, drive.price_of) and drive.price_of else ""
    price = "" if isnan(drive.price) else f"{least}{drive.price:.0f} {drive.currency}"
    return doc.row(
        "short", drive, name=f"{drive.motor.part}_{drive.gearhead.part}", outcome=drive.status,
        data={"rank": str(drive.rank)},
        drive=(doc.Strong(name) if drive.rank == 1 else name, doc.Small("; ".join(filter(None, small)))),
        objective="" if objective in _WITH_COLUMN else objective_quantity(drive, objective), mass=mass_quantity(drive),
        price=doc.Quantity(drive.price, drive.currency, "money", own=price),
        energy=doc.Quantity(energy.value, energy.unit, energy.kind, own="–" if isnan(energy.value) else ""),
        margin=doc.Quantity(tight.margin, "%", "margin") if tight else "–", tight=tight.title if tight else "",
    )  # fmt: skip


def mass_quantity(drive: DriveSet) -> doc.Quantity:
    """The mass of a drive, marked where a part's is unknown or estimated."""
    return doc.Quantity(drive.mass, "g", "mass", own=drive.mass_text)


def objective_quantity(drive: DriveSet, objective: str) -> doc.Quantity:
    """The figure that ranked a drive, and of which parts it is alone where those of others are unknown."""
    from drivesizer.spec.drive import OBJECTIVES

    if objective not in OBJECTIVES:
        return doc.Quantity(drive.objective, "1", "plain")
    declared = OBJECTIVES[objective]
    lacks = declared.over and drive.unknown_parts(objective, drive.objective_of)
    note = f"{' and '.join(drive.objective_of)} only" if lacks and drive.objective_of else ""
    own = drive.mass_text if objective == "mass" else ""
    unit = drive.currency if declared.kind == "price" else declared.unit
    return doc.Quantity(drive.objective, unit, declared.kind, own=own, note=note)


def short_table(caption: str, drives: Sequence[DriveSet], objective: str, name: str) -> Iterator[doc.Block]:
    """Drives in rows; what is unknown of all of them is said once, below."""
    unknown = [[check.title for check in drive.deciding if check.status == "unknown"] for drive in drives]
    shared = [title for title in unknown[0] if all(title in other for other in unknown)] if len(drives) > 1 else []
    braked = "brake, " if any(drive.brake for drive in drives) else ""
    words = caption, f": one drive each, mass with {braked}encoder and controller", doc.Note("energy per cycle of all")
    rows = [short_drive(drive, shared, objective, first=drive is drives[0]) for drive in drives]
    yield doc.table("short", words, rows, name=name, heads={"objective": objective.replace("_", " ")},
                    without=["objective"] if objective in _WITH_COLUMN else ())  # fmt: skip
    if shared:
        yield doc.Words(f"Unknown of each: {shared[0] if len(shared) == 1 else f'{len(shared)} checks'}.", "note")


def alternatives(content: Content) -> Iterator[doc.Block]:
    """The best drive of other motor families."""
    result = content.result
    if result.alternatives:
        drives = (*result.sets[:1], *result.alternatives)
        yield from short_table("Beside other motor families", drives, result.objective, "alternatives")
    other = result.unrestricted
    if other and other.label != next((drive.label for drive in result.sets), ""):
        more = [f"{role} {part.part}" for role, part in (("brake", other.brake), ("encoder", other.encoder)) if part]
        more += [f"controller {other.controller.family}"] if other.controller else []
        price = f"{other.price:.2f} {other.currency}, sum of {' + '.join(other.price_of)}"
        price = price if other.price_of else "unknown"
        mass = f"{other.mass_text}, sum of {' + '.join(other.mass_of)}"
        yield doc.Words(("Without the families and parts that the spec names, the whole catalogue gives ",
                         doc.Strong(", ".join([other.label, *more])), f" (mass {mass}; price {price})."))  # fmt: skip


def ranking(content: Content) -> Iterator[doc.Block]:
    """The best drives in rows."""
    if len(content.result.sets) > 1:
        yield from short_table("Best first", content.result.sets, content.result.objective, "ranking")


def screws(content: Content) -> Iterator[doc.Block]:
    """Of each lead the smallest screw that holds, and the best drive for it."""
    choice = content.result.problem.screw
    if choice is None or len(choice.tried) < 2:
        return
    objective = content.result.objective.replace("_", " ")
    rows = []
    for trial in choice.tried:
        is_own = trial.screw == f"{choice.screw.manufacturer} {choice.screw.part}"
        screw: doc.Cell = (doc.Strong(trial.screw),) if is_own else trial.screw
        figure = trial.objective
        rows.append(doc.row(
            "screws", trial, name=f"lead_{1e3 * trial.lead:.4g}_mm", title=screw if trial.screw else
            f"none holds: {trial.failed}", mass=doc.Quantity(trial.mass, "g", "mass") if trial.screw else "",
            drive=trial.drive or ("none passes" if trial.screw else ""),
            value=doc.Quantity(figure.value, figure.unit, figure.kind) if figure else "",
        ))  # fmt: skip
    caption = f"The smallest screw of each lead that holds, and its best drive; {objective} of the drive without it"
    yield doc.table("screws", caption, rows, heads={"value": objective})


# -- The best drives and the closest rejected ones, why the others were rejected, and the Pareto front.


_LONGEST_FRONT = 40  # drives of it that are printed


def candidates(content: Content) -> Iterator[doc.Block]:
    """The best drives and the closest rejected ones."""
    result, counts = content.result, content.result.counts
    yield doc.Words(f"{number_of(counts.considered, 'combination')} of motor and gearhead, with the belt, "
                f"{'was' if counts.considered == 1 else 'were'} examined; "
                f"of them {meeting(counts, result.sets[0].status if result.sets else None)}. "
                f"{ranked_by(result.objective, result.sets[:1]).capitalize()}.")  # fmt: skip
    if result.sets or result.misses:
        yield _drives(content)
        yield doc.Pair([doc.picture("sets-margin")], [doc.picture("sets-price")])
    columns, rows = drives_in_rows(every_list(result), result.objective)
    yield doc.Table("All drives", columns, rows, "all-drives", media="book")


def _drives(content: Content) -> doc.Table:
    result = content.result
    required = result.uncertainty.confidence if result.uncertainty else None
    reach = f" that reach the confidence of {confidence(required)}" if required is not None else ""
    below = ", and below them the closest rejected" if result.misses else ""
    caption = f"The best drives{reach}{below}" if result.sets else "The closest rejected drives"
    heads = {
        "price": f"price ({result.catalog.currency})",
        "check": "smallest margin or failed check" if result.misses else "check of the smallest margin",
    }
    return doc.table("sets", caption, map(_drive_row, (*result.sets, *result.misses)), heads=heads)


def _drive_row(drive: DriveSet) -> doc.Row:
    """A drive with the check of its smallest margin, or the first failed one and how many more there are."""
    failed, tight = [c.title for c in drive.deciding if c.status == "fail"], worst(drive.deciding)
    check = failed[0] + (f" and {len(failed) - 1} more" if len(failed) > 1 else "") if failed else ""
    return doc.row(
        "sets", drive, name="", outcome=drive.status, data={"rank": str(drive.rank)}, mass=mass_quantity(drive),
        gearhead=gearhead_words(drive, belt=False), check=check or (tight.title if tight else ""),
        price=doc.Quantity(drive.price, drive.currency, "money",
                           own="" if isnan(drive.price) else f"{drive.price:.2f}"),
        margin=doc.Quantity(tight.margin if tight else nan, "%", "margin"),
    )  # fmt: skip


def candidate_numbers(content: Content) -> list[dict[str, Any]]:
    """The drives of the table as texts, and under ``exact`` mass [g], price and margin [%]; None: unknown."""
    numbers = []
    for row in _drives(content).rows:
        figures = {key: cell for key, cell in row.cells.items() if isinstance(cell, doc.Quantity)}
        texts = {key: cell for key, cell in row.cells.items() if isinstance(cell, str)}
        texts |= {key: cell.text for key, cell in figures.items()}
        texts["price"] += "" if texts["price"] == "unknown" else f" {content.result.catalog.currency}"
        exact = {key: None if isnan(cell.number) else cell.number for key, cell in figures.items()}
        exact["percent"] = None if exact["margin"] is None else 100.0 * exact["margin"]
        numbers.append({**texts, "status": row.status, "exact": exact})
    return numbers


def gearhead_words(drive: DriveParts, *, belt: bool = True) -> str:
    """The gearhead with its part number, and the belt where it is wanted."""
    driven = f" + belt {drive.belt_name}" if belt and drive.belt_name else ""
    part = drive.gearhead.part if "gearhead" in drive.parts and drive.gearhead.part != drive.gearhead_name else ""
    return " ".join(f"{drive.gearhead_name} {part}{driven}".split())


def rejected(content: Content) -> Iterator[doc.Block]:
    """The checks that reject the others."""
    result, counts = content.result, content.result.counts
    if result.misses:
        belts = len({drive.belt_ratio for drive in result.misses}) > 1
        yield doc.table("misses", "Closest rejected", [_rejected_row(drive, belts) for drive in result.misses])
    titles, budget = CHECKS[result.method], CHECKS["budget"]
    fails = [(f"failed_{name}", titles[name].title, n) for name, n in counts.failed_by.items()]
    fails += [
        (f"failed_budget_{name}", f"in the machine: {budget[name].title}", n)
        for name, n in counts.failed_by_budget.items()
    ]
    if fails:
        rows = [
            doc.Row({"title": title, "value": doc.Quantity(n), "share": doc.Bar(n / counts.considered)}, name=name)
            for name, title, n in sorted(fails, key=lambda fail: -fail[-1])
        ]
        yield doc.table("fails", "Rejected candidates by check: one counts at every check that it fails", rows)
    numbers = {"considered": "Combinations that were examined", "feasible": "Drives that fail no check",
               "passing": "Drives that meet all limits"}  # fmt: skip
    numbers |= {"undecided": "Drives behind them that may, not computed"} if counts.undecided else {}
    rows = [doc.Row({"title": title, "value": doc.Quantity(getattr(counts, name))}, name=name)
            for name, title in numbers.items()]  # fmt: skip
    yield doc.table("counts", "Counts", rows)


def _rejected_row(drive: DriveSet, belts: bool) -> doc.Row:
    """A rejected drive with its worst check."""
    missed = [check for check in drive.deciding if check.status != "pass"]
    failed = [check for check in missed if check.status == "fail"] or missed
    check = worst(tuple(failed)) or next(iter(failed or drive.deciding))
    others = "" if len(failed) < 2 else f" and {number_of(len(failed) - 1, 'more check')}"
    bare = isnan(check.demand) and isnan(check.limit) and check.status != "unknown"
    demand, limit = ("" if bare else doc.Quantity(x, check.unit, check.kind) for x in (check.demand, check.limit))
    belt = f" × {drive.belt_name or 1}" if belts else ""
    return doc.row("misses", drive, name="", gearhead=f"{drive.gearhead_name}{belt}", check=check.title + others,
                   value=demand, limit=limit)  # fmt: skip


def front(content: Content) -> Iterator[doc.Block]:
    """Drives that no other beats in all of the objectives."""
    result = content.result
    if result.pareto and not result.front:
        yield doc.Words(f"No Pareto front: no drive that passes has known values of {', '.join(result.pareto)}.")
    if not result.front:
        return
    drives = result.front[:_LONGEST_FRONT]
    columns = [doc.Column(name, objective_figure(drives[0], name).title, "number") for name in result.pareto]
    rows = []
    for drive in drives:
        figures = [objective_figure(drive, name) for name in result.pareto]
        cells: dict[str, Any] = {f.name: doc.Quantity(f.value, f.unit, f.kind) for f in figures}
        rows.append(doc.row("front", drive, name="", data={"rank": str(drive.rank)}, title=drive.label,
                            gearhead=gearhead_words(drive), status=(doc.Status(drive.status),), **cells))  # fmt: skip
    caption = "The Pareto front: no other drive equals or beats one of these in all of its figures"
    yield doc.table("front", caption, rows, more=[*columns, doc.Column("status", "", "status")])
    if len(result.front) > len(drives):
        yield doc.Words(f"And {len(result.front) - len(drives)} more, which the CSV report has.")
    yield doc.picture("front")


# -- The probability that each drive passes, its checks over the samples, and the assumptions that matter most.


_MOST_DRIVES = 10
_MOST_CHECKS = 12
_MOST_DRIVERS = 3


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
    reach = [drive for drive in result.sets[:_MOST_DRIVES] if drive.reliability]
    less = [drive for drive in result.unsure[:_MOST_DRIVES] if drive.reliability]
    if reach:
        yield probability_table(caption, reach, "probabilities")
    if less:
        yield probability_table(below.capitalize() if reach else f"{caption}: {below}", less, "unsure")
    none = "" if result.sets or not result.unsure else f"no drive reaches the confidence of {required}"
    yield sampled_words(sampled, none)


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
    looped = any(drive.reliability and drive.reliability.loop for drive in drives)
    rows = []
    for drive in drives:
        reliability = drive.reliability
        assert reliability is not None
        more = [loop_text(reliability), f"unknown: {'; '.join(reliability.unknown)}" if reliability.unknown else ""]
        cells: dict[str, Any] = {}
        if looped:
            loop = reliability.loop
            cells["loop"] = _chance(loop.probability, loop.unknown, error_text(loop.error)) if loop else "–"
            cells |= {"loop_weakest": loop.weakest, "loop_samples": doc.Quantity(loop.samples)} if loop else {}
        rows.append(doc.row(
            "reliability", drive, name="all_checks", data={"rank": str(drive.rank)},
            value=_chance(reliability.probability, reliability.unknown),
            error=doc.Quantity(reliability.error, "%", "probability", own=error_text(reliability.error)),
            weakest=(reliability.weakest, doc.Note("; ".join(filter(None, more)))), **margins(reliability), **cells,
        ))  # fmt: skip
    left_out = () if looped else ("loop", "loop_weakest", "loop_samples")
    return doc.table("reliability", caption, rows, name=name, without=left_out)


def _chance(probability: float, unknown: Sequence[str], error: str = "") -> doc.Quantity:
    """The probability that all checks pass; where that is unknown, that none of the known ones fails."""
    text = f"{likely(probability)} {error}".strip()
    if unknown:
        return doc.Quantity(nan, "%", "probability", own="unknown", note=f"none fails: {text}")
    return doc.Quantity(probability, "%", "probability", own=text)


def reliability(_: OfDrives, drive: DriveSet) -> Iterator[doc.Block]:
    """A drive over its tolerances: checks, figures, the assumptions that matter most."""
    reliability = drive.reliability
    if reliability is None:
        return
    yield spreads_table(
        f"The checks of {drive.label} that samples change: share that passes, and quantiles of the margin",
        varying_checks(reliability)[:_MOST_CHECKS],
        "probability-checks",
    )
    others = [check for check in reliability.checks if check not in varying_checks(reliability)[:_MOST_CHECKS]]
    if others:
        yield replace(spreads_table("Its other checks", others, "probability-others"), media="wide")
    if reliability.figures:
        yield percentiles_table(
            f"Figures of {drive.label} over the samples: percentiles", reliability, "probability-figures"
        )
    if reliability.drivers:
        yield _drivers(doc.sentence("variance"), reliability.drivers[:_MOST_DRIVERS])
        if reliability.drivers[_MOST_DRIVERS:]:
            yield _drivers("Other assumptions", reliability.drivers[_MOST_DRIVERS:], name="", media="wide")
    yield doc.picture("tornado", drive=drive.label)


def spreads_table(caption: str, checks: Sequence[Spread], name: str) -> doc.Table:
    """Checks over the samples."""
    return doc.table("spreads", caption, [doc.row("spreads", check, **margins(check)) for check in checks], name=name)


def percentiles_table(caption: str, reliability: Reliability, name: str) -> doc.Table:
    """Figures over the samples."""
    return doc.table(
        "percentiles", caption, [doc.row("percentiles", figure) for figure in reliability.figures], name=name
    )


def _drivers(caption: str, drivers: Sequence[Driver], **look: Any) -> doc.Table:
    rows = [
        doc.row("drivers", driver,
                value=doc.Quantity(driver.share, "%", "probability", own=f"{100 * driver.share:.0f} %"),
                low=margin_quantity(driver.low_margin), low_at=minus(driver.low),
                high=margin_quantity(driver.high_margin), high_at=minus(driver.high))
        for driver in drivers
    ]  # fmt: skip
    return doc.table("drivers", caption, rows, **look)


def uncertain(content: Content) -> Iterator[doc.Block]:
    """The uncertain figures with their tolerances."""
    if content.result.uncertainty:
        yield uncertain_table(content.result.uncertainty)


def uncertain_table(sampled: Uncertainty) -> doc.Table:
    """The uncertain figures with their tolerances."""
    rows = [doc.row("uncertain", assumption) for assumption in sampled.assumptions]
    return doc.table("uncertain", "Uncertain figures", rows)


# -- Drives in rows with all that they are, do and hold, for other programs; SI.


def drives_in_rows(drives: Sequence[tuple[str, DriveSet]], objective: str) -> tuple[list[doc.Column], list[doc.Row]]:
    """Drives with the list that each is on, its margins, figures and probabilities."""
    slug = "_".join(objective.replace("+", " ").replace(",", " ").split())
    nominal = [{"list": where} | dict(_nominal(drive, slug)) for where, drive in drives]
    sampled = [dict(_sampled(drive.reliability)) if drive.reliability else {} for _, drive in drives]
    currency = drives[0][1].currency if drives else "EUR"
    heads = ["list", *(column.key.replace("EUR", currency) for column in doc.declared()["drives"][1])]
    heads += [f"objective_{slug}_si"]
    heads += ["smallest_margin", "smallest_margin_check"]
    for begin in ("margin_", "figure_"):
        heads += [head for cells in nominal for head in cells if head.startswith(begin)]
    for kind in ("drives_probability", "drives_in_loop"):
        heads += [column.key for column in doc.declared()[kind][1] if any(column.key in cells for cells in sampled)]
    heads += [head for cells in sampled for head in cells]
    columns = [doc.Column(head, head.replace("_", " "), "number") for head in dict.fromkeys(heads)]
    return columns, [doc.Row(row | other) for row, other in zip(nominal, sampled, strict=True)]


def _nominal(drive: DriveSet, slug: str) -> Iterator[tuple[str, doc.Cell]]:
    for head, cell in _read(drive, "drives"):
        yield head.replace("EUR", drive.currency), cell
    yield f"objective_{slug}_si", _cell(drive.objective)
    if tight := worst(drive.deciding):
        yield from (("smallest_margin", _cell(tight.margin)), ("smallest_margin_check", tight.name))
    for check in drive.own_checks:
        yield f"margin_{check.name}", _cell(check.margin)
    for f in drive.figures:
        yield f"figure_{f.name}_{KINDS[f.kind].si}", _cell(f.value)


def _sampled(reliability: Reliability) -> Iterator[tuple[str, doc.Cell]]:
    yield from _read(reliability, "drives_probability")
    titles = {check.title: check.name for check in reliability.checks}
    yield "weakest_check", titles.get(reliability.weakest, reliability.weakest)
    yield from _read(reliability, "drives_in_loop")
    for check in reliability.checks:
        yield from ((f"{head}_{check.name}", cell) for head, cell in _read(check, "drives_check"))


def _read(record: Any, table: str) -> Iterator[tuple[str, doc.Cell]]:
    """Cells of a record as a table declares them; none behind what it has not."""
    for column in doc.declared()[table][1]:
        value = doc.attribute(record, column.of)
        if value is not None:
            yield column.key, _cell(value, " + " if column.key.endswith("_of") else "; ")


def _cell(value: Any, between: str = "") -> doc.Cell:
    if isinstance(value, tuple):
        return between.join(value)
    return value if isinstance(value, str) else doc.Quantity(value, "1", "count" if isinstance(value, int) else "plain")
