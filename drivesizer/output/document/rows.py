"""Tables that several sections have: checks, figures, requirements, masses, consumers; each row is made once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from math import inf, isfinite, isnan, nan
from typing import TYPE_CHECKING, Any

from drivesizer.output.derivation import margin, symbol, use
from drivesizer.output.document import records as doc
from drivesizer.results.check import Check, Figure, Reliability, Spread, tightest
from drivesizer.results.check_kinds import OWN_REQUIREMENTS, REQUIREMENTS, figure_words, part_of, sorted_by_part
from drivesizer.results.drive_set import DriveSet, EnergyBudget, MassRow, Relaxation, Requirement
from drivesizer.spec.robot import AS_SPECIFIED

if TYPE_CHECKING:
    from drivesizer.control.validation import Validation

# -- checks


_CLOSE = 0.2  # least margin at the ends of the band of estimates, below which the band is shown
_ALIKE = 0.01  # of a margin, within which it is that of two figures
_TIGHTEST = 3


def case_of(c: Check) -> str:
    """The load case in which a check is worst; one whose name begins with a digit as such."""
    return f"case {c.case}" if c.case[:1].isdigit() else c.case


def check_row(c: Check) -> doc.Row:
    """A check: its demand, limit and margin, the share of the limit that it uses, and what is remarked on it."""
    bare = isnan(c.demand) and isnan(c.limit)  # a condition without figures
    at = nan if c.at_time is None else c.at_time
    moment = f"{at:.0f} s" if at >= 1000.0 else f"{at:.4g} s"
    note = c.note or ("selected to be so: not a measure of the load" if c.by_choice and c.status == "pass" else "")
    remarks = ["" if bare or c.case == AS_SPECIFIED else case_of(c), "" if isnan(at) else f"at {moment}", note]
    needed = f"needs {margin(c.needed)}" if c.needed and not isnan(c.margin) else ""
    return doc.row(
        "checks", c, outcome=c.status, data={"check": c.name, "unit": c.unit}, part=part_of(c.name),
        title=(c.title, doc.Note("; ".join(filter(None, remarks)))), note=note,
        value="" if bare else doc.Quantity(c.demand, c.unit, c.kind),
        limit="" if bare else doc.Quantity(c.limit, c.unit, c.kind),
        margin=doc.Quantity(c.margin, "%", "margin", note=needed), used=doc.Bar(use(c.margin), use(c.needed), c.status),
        at="" if isnan(at) else doc.Quantity(at, "s", "time"),
        origins="; ".join(f"{figure_words(*origin[:2])}: {origin.confidence}" for origin in c.origins),
    )  # fmt: skip


def _worst_end(c: Check) -> Iterator[doc.Row]:
    """The same at the unfavourable end of estimated figures, where it is seen; without a limit that moves too."""
    if not c.band or c.status not in ("open", "pass") or not c.band.least_margin < _CLOSE:
        return
    high, least = c.band.high, c.band.least_margin
    if margin(least) == margin(c.margin):
        return
    alike = high > 0.0 and abs(c.limit / high - 1.0 - least) < _ALIKE
    ends = doc.quantities(c.unit, c.kind, value=high, limit=c.limit) if alike else {"value": "", "limit": ""}
    yield doc.Row({
        "part": part_of(c.name), "title": (doc.Small("at worst, by estimates"),), "method": c.method, "case": c.case,
        **ends, "margin": doc.Quantity(least, "%", "margin"), "used": doc.Bar(use(least)),
        "note": "at worst, by estimates",
    }, name=f"{c.name}_at_worst")  # fmt: skip


def check_table(
    caption: doc.Text, checks: Iterable[Check], name: str = "", *, grouped: bool = False, record: str = "check"
) -> doc.Table:
    """Checks with their limits, margins and bars; under the part that they concern where they are grouped."""
    ordered = sorted_by_part([*checks]) if grouped else [*checks]
    rows = [row for check in ordered for row in (check_row(check), *_worst_end(check))]
    return doc.table("checks", caption, rows, name=name, record=record, group="part" if grouped else "")


def tightest_table(caption: doc.Text, checks: Sequence[Check], name: str = "tightest") -> doc.Table:
    """Three checks: conditions that fail, then the smallest margins; those kept small by selection are left out."""
    return replace(check_table(caption, tightest(tuple(checks), _TIGHTEST), name), media="shown")


def tight_of(drive: DriveSet, proof: Validation | None) -> tuple[str, str]:
    """The smallest margin of a drive, in its closed loop too, and its check; a condition that fails has none."""
    checks = [(check, "") for check in tightest(drive.deciding, 1)]
    checks += [(check, f"{proof.loop}: ") for check in tightest(proof.checks, 1)] if proof else []
    if not checks:
        return "unknown", ""
    check, where = smallest(checks)
    title = f"{where}{check.title}"
    return ("none", f"{title}: not met") if isnan(check.margin) else (margin(check.margin), title)


def smallest(checks: Iterable[tuple[Check, str]]) -> tuple[Check, str]:
    """The check of the smallest margin with its words; a condition that fails, which has none, comes first."""
    return min(checks, key=lambda pair: -inf if isnan(pair[0].margin) else pair[0].margin)


# -- figures without a limit, requirements of the load, requirements on the machine


def figures_table(caption: doc.Text, figures: Iterable[Figure], record: str = "figure", **look: Any) -> doc.Table:
    """Names and figures without a limit, with the moment at which each is reached."""
    rows = [
        doc.row("figures", f, at="" if f.at_time is None else doc.Quantity(f.at_time, "s", "time",
                                                                           own=f"at {f.at_time:.4g} s"))
        for f in figures
    ]  # fmt: skip
    return doc.table("figures", caption, rows, record=record, **look)


def requirements_table(caption: doc.Text, requirements: Iterable[Requirement], **look: Any) -> doc.Table:
    """Requirements of a load with their symbols, and the paper's number of their equations."""
    rows = [
        doc.row("requirements", r, data={"requirement": r.name}, symbol=(doc.Math(symbol(r.symbol), r.symbol),),
                equation=doc.Quantity(r.equation, own=f"({r.equation})") if r.equation else "",
                title=(r.title, doc.Note("given" if r.note.startswith("given") else "")),
                value=doc.Quantity(float(r.value), r.unit, r.kind))
        for r in requirements
    ]  # fmt: skip
    return doc.table("requirements", caption, rows, **look)


def required_table(caption: doc.Text, drive: DriveSet) -> doc.Table | None:
    """Requirements on the machine, what is reached and by what margin; None where the spec has none."""
    if not any(check.name in OWN_REQUIREMENTS for check in drive.budget):
        return None
    order = list(REQUIREMENTS)
    rows = []
    for c in sorted((c for c in drive.budget if c.name in REQUIREMENTS), key=lambda c: order.index(c.name)):
        upper = REQUIREMENTS[c.name] == "limit"
        demand, limit = (doc.Quantity(value, c.unit, c.kind) for value in (c.demand, c.limit))
        remarks = "; ".join(filter(None, ("" if c.case == AS_SPECIFIED else case_of(c), c.note)))
        rows.append(doc.row("required", c, title=(c.title, doc.Note(remarks)), bound="≤" if upper else "≥",
                            required=limit if upper else demand, reached=demand if upper else limit))  # fmt: skip
    return doc.table("required", caption, rows)


def changes_table(caption: str, changes: Sequence[Relaxation]) -> doc.Table:
    """Fields of the spec as they are and as they would have to be."""
    if any(change.status != "pass" for change in changes):
        caption = caption.replace(" passes,", " passes or fails no check,", 1)
    rows = [
        doc.row("changes", r, name=r.field, field=r.field.replace("_", " ").replace(".", " › "),
                value=doc.Quantity(r.before, r.unit, r.kind, own=r.now),
                limit=doc.Quantity(r.after, r.unit, r.kind, own=r.needed))
        for r in changes
    ]  # fmt: skip
    return doc.table("changes", caption, rows)


# -- masses of the machine, consumers of its battery


def masses_table(masses: Sequence[MassRow], sums: Sequence[Figure]) -> doc.Table:
    """The masses of the machine one by one, and their sums."""
    rows = [
        doc.row("masses", mass, number=doc.Quantity(mass.number, own=f"{mass.number} ×"),
                each=doc.Quantity(mass.each, "kg", "mass", own=mass.text(mass.each, "kg") if mass.band else ""),
                status=(doc.Status("unknown"),) if isnan(mass.each) else "")
        for mass in masses
    ]  # fmt: skip
    whole = [
        doc.Row({"title": f.title, "value": doc.Quantity(f.value, f.unit, f.kind)}, f.name, total=True) for f in sums
    ]
    return doc.table("masses", "Masses of the machine", rows + whole)


def consumers_table(budget: EnergyBudget) -> doc.Table:
    """Mean and highest power of each consumer of the battery, and their sum."""
    rows = [
        doc.row("consumers", consumer, number=doc.Quantity(consumer.number) if consumer.number > 1 else "",
                duty="" if isnan(consumer.duty) or consumer.duty == 1.0 else doc.Quantity(consumer.duty, "%",
                                                                                         "dimensionless"),
                note="assumed" if consumer.assumed else "")
        for consumer in budget.consumers if consumer.mean or isnan(consumer.mean)
    ]  # fmt: skip
    lacks = any(isnan(consumer.mean) for consumer in budget.consumers)
    whole = doc.quantities("W", "power", value=budget.mean_power, limit=budget.peak_power)
    total = doc.Row({"title": "total", **whole, "note": "of the known ones" if lacks else ""}, "total", total=True)
    return doc.table("consumers", "Consumers of the battery", [*rows, total])


def error_text(value: float) -> str:
    """The error of a probability."""
    return f"± {100 * value:.2g} %"


def margin_quantity(value: float) -> doc.Quantity:
    """A margin over samples; a dash where there is none."""
    return doc.Quantity(value if isfinite(value) else nan, "%", "margin", own="" if isfinite(value) else "–")


def margins(spread: Reliability | Spread) -> dict[str, Any]:
    """The quantiles of a margin over samples."""
    return {key: margin_quantity(getattr(spread, key)) for key in ("low", "middle", "high")}
