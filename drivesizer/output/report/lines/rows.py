"""Texts and rows of plain data for sections and figures: drives, machine, probabilities, one figure in each cell."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from math import isfinite, isnan, nan
from typing import Any

from drivesizer.control.validation import Validation
from drivesizer.load_cases.platform import WheelLoad, trajectory_of
from drivesizer.loads.kinds import Load
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.output.derivation import margin, minus, use
from drivesizer.output.json.documents import number
from drivesizer.output.loop_table import gain_rows, loop_figures
from drivesizer.output.parts import PartLine, Total
from drivesizer.output.words import confidence, likely, loop_text
from drivesizer.results.check import Driver, FigureSpread, LoopShare, Reliability, Spread, tightest
from drivesizer.results.check_kinds import CHECKS, part_of
from drivesizer.results.drive_set import DriveSet, Relaxation, Requirement
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import Check, Figure, SizingResult, objective_figure
from drivesizer.spec.platform import Platform
from drivesizer.spec.robot import AS_SPECIFIED, RobotSpec
from drivesizer.units import KINDS, from_si, show

__all__ = [
    "COLUMNS", "QUANTILES", "Row", "battery_rows", "below_confidence_row", "braking_rows", "case_of", "chance_columns",
    "chances", "change_row", "check_cells", "check_row", "check_texts", "closed_loop_rows", "count_rows", "drive_cells",
    "driven_over", "driver_cells", "error_and_weakest", "every_list", "figure_row", "figure_texts", "first_wheel",
    "front_rows", "machine_rows", "machine_words", "method_of", "none_reaches", "outcome", "part_rows", "plain_row",
    "reliability_rows", "reported", "requirement_row", "sampling_rows", "set_rows", "tight_of", "tightest_checks",
    "total_rows",
]  # fmt: skip


# -- The machine in words: its kind, its wheels and its path.


def first_wheel(problem: Problem) -> str:
    """The first load case where it is that of a wheel on a trajectory, such as ``wheel 1``; else empty."""
    return problem.cases[0].name if isinstance(problem.spec.load, WheelLoad) else ""


def driven_over(v: Validation) -> str:
    """The reference of a closed loop in words: the profile, or the cycle of a wheel."""
    wheel = isinstance(v.spec.load, WheelLoad) and v.profile == v.spec.load.file
    return f"the cycle of {v.profile}" if wheel else v.over


def machine_words(spec: RobotSpec) -> str:
    """The machine in a line: a platform with its wheels and its path, else the kind of load with mass or inertia."""
    load, platform = spec.load, spec.platform
    mass = _burden(load) + _carried(spec)
    if platform is None or not isinstance(load, WheeledVehicle):
        kind = load.kind.replace("_", " ").capitalize()
        return ", ".join(filter(None, (kind, mass, _count_text(load.motors, "drive"))))
    wheels = " and ".join(_wheels(platform))
    diameter = show(load.wheel_diameter, "mm", "length")
    return "; ".join([f"Platform of {mass} on {wheels}, wheel diameter {diameter}", *_size(platform), *_path(spec)])


def _burden(load: Load) -> str:
    """Mass that is moved, else the inertia of what turns without one; empty where a load has neither.

    >>> from types import SimpleNamespace
    >>> _burden(SimpleNamespace(mass=45.0, inertia=0.0)), _burden(SimpleNamespace(mass=0.0, inertia=0.08))
    ('45 kg', '0.08 kg·m²')
    """
    figures = ((getattr(load, name, None), name, unit) for name, unit in (("mass", "kg"), ("inertia", "kg*m^2")))
    return next((show(value, unit, kind) for value, kind, unit in figures if value), "")


def _carried(spec: RobotSpec) -> str:
    """The largest payload that the motion adds to the mass, in words."""
    motion = spec.motion if spec.carries else None
    payloads = [getattr(motion, name, None) for name in ("payload", "payload_back")]
    payloads += [piece.payload for piece in getattr(motion, "segments", ())]
    most = max(filter(None, payloads), default=0.0)
    return f" and a payload of up to {show(most, 'kg', 'mass')}" if most else ""


def _wheels(platform: Platform) -> Iterator[str]:
    """``4 driven mecanum wheels``, and what rolls along."""
    for (kind, driven), count in Counter((place.kind, place.driven) for place in platform.places).items():
        yield _count_text(count, f"{'driven' if driven else 'free'} {kind} wheel")
    if platform.casters:
        yield _count_text(len(platform.casters), "caster")


def _count_text(count: int, name: str) -> str:
    return f"{count} {name}" + ("" if count == 1 else "s")


def _size(platform: Platform) -> Iterator[str]:
    if platform.size:
        sides = (platform.size.length, platform.size.width, platform.size.height)
        length, width, height = (show(x, "mm", "length").removesuffix(" mm") for x in sides)
        yield f"{length} × {width} × {height} mm"


def _path(spec: RobotSpec) -> Iterator[str]:
    path = trajectory_of(spec)
    if path is not None:
        yield f"path of {show(path.length, 'm', 'length')} in {show(path.total, 's', 'time')}"


# -- A sizing as rows of plain data, one figure in each, under the names in ``COLUMNS``.
#
# CSV and workbook print the same rows. Figures are floats, NaN where unknown; each is in its customary unit and in
# SI beside.


Row = dict[str, Any]

COLUMNS = (
    "section", "set_rank", "name", "title", "symbol", "equation", "method", "case", "value", "limit", "unit",
    "si_value", "si_limit", "si_unit", "margin", "needed_margin", "status", "at_time_s", "note",
)  # fmt: skip


def row(section: str, name: str, title: str, **more: Any) -> Row:
    """A row of a section."""
    return {"section": section, "name": name, "title": title} | more


def _figure(section: str, name: str, title: str, value: float, kind: str, unit: str) -> Row:
    si = {"si_value": value, "si_unit": KINDS[kind].si}
    return row(section, name, title, value=from_si(value, unit, kind), unit=unit, **si)


def plain_row(section: str, name: str, title: str, value: float, unit: str) -> Row:
    """A figure whose unit is the same in SI."""
    return row(section, name, title, value=value, unit=unit, si_value=value, si_unit=unit)


def figure_row(section: str, f: Figure) -> Row:
    """A figure that has no limit of its own."""
    at_time = "" if f.at_time is None else f.at_time
    return _figure(section, f.name, f.title, f.value, f.kind, f.unit) | {"at_time_s": at_time}


def requirement_row(r: Requirement) -> Row:
    """A requirement of the load, with the paper's symbol and number."""
    found = _figure("requirement", r.name, r.title, float(r.value), r.kind, r.unit)
    return found | {"symbol": r.symbol, "equation": r.equation or "", "note": r.note}


def check_row(section: str, c: Check) -> Row:
    """A check: its demand as value, its limit, margin and status."""
    return _figure(section, c.name, c.title, c.demand, c.kind, c.unit) | {
        "method": c.method,
        "case": c.case,
        "limit": from_si(c.limit, c.unit, c.kind),
        "si_limit": c.limit,
        "margin": c.margin,
        "needed_margin": c.needed,
        "status": c.status,
        "at_time_s": "" if c.at_time is None else c.at_time,
        "note": c.note,
    }


def battery_rows(s: DriveSet) -> Iterator[Row]:
    """The consumers of the battery, mean power as value and highest as limit, and the figures of the battery."""
    if s.energy is None:
        return
    for one in s.energy.consumers:
        found = _figure("consumer", one.name, one.name, one.mean, "power", "W")
        said = f"{one.number} of them" + (", assumed" if one.assumed else "")
        status = "unknown" if isnan(one.mean) else ""
        yield found | {"limit": one.peak, "si_limit": one.peak, "note": said, "how_many": one.number, "status": status}
    yield from (figure_row("battery", figure) for figure in s.energy.figures)


def braking_rows(s: DriveSet) -> Iterator[Row]:
    """Figures of what is regenerated and of the brake resistor."""
    if s.braking is None:
        return
    resistor = s.braking.resistor
    if resistor is not None:
        title = f"{resistor.manufacturer} {resistor.family}".strip() or "as the spec gives it"
        yield row("braking", "brake_resistor", title, value=resistor.part)
    yield from (figure_row("braking", figure) for figure in s.braking.figures)


def machine_rows(s: DriveSet) -> Iterator[Row]:
    """The masses of the machine, all pieces of a part together, and its figures with the drive."""
    for one in s.masses:
        found = _figure("mass", one.name, one.name, one.total, "mass", "kg")
        each = one.text(one.each, "kg")
        said = f"{one.number} of {each}" if one.number > 1 else each if one.band else ""
        yield found | {"each": one.each, "how_many": one.number, "note": said,
                     "status": "unknown" if isnan(one.each) else ""}  # fmt: skip
    yield from (figure_row("machine", figure) for figure in s.machine)


def change_row(r: Relaxation) -> Row:
    """A change after which a drive passes: the figure now as value, the needed one as limit."""
    found = _figure("change", r.field, "Change of the spec", r.before, r.kind, r.unit)
    note = f"{r.now} to {r.needed}: then {r.set_label} passes"
    return found | {"limit": from_si(r.after, r.unit, r.kind), "si_limit": r.after, "note": note}


def count_rows(result: SizingResult) -> Iterator[Row]:
    """The number of combinations examined, of drives that meet all limits, and of those that fail on each check."""
    counts, declared = result.counts, CHECKS[result.method]
    yield row("count", "considered", "Combinations that were examined", value=counts.considered)
    yield row("count", "feasible", "Drives that fail no check", value=counts.feasible)
    yield row("count", "passing", "Drives that meet all limits", value=counts.passing)
    if counts.undecided:
        yield row("count", "undecided", "Drives behind them that may, not computed", value=counts.undecided)
    for name, count in counts.failed_by.items():
        yield row("count", f"failed_{name}", f"Fails on: {declared[name].title}", value=count)
    for name, count in counts.failed_by_budget.items():
        title = f"Fails on the machine's budget: {CHECKS['budget'][name].title}"
        yield row("count", f"failed_budget_{name}", title, value=count)


def front_rows(s: DriveSet, objectives: Iterable[str]) -> Iterator[Row]:
    """A drive of the Pareto front by its objectives."""
    yield from _names("front", {"motor": s.motor, "gearhead": s.gearhead})
    yield _figure("front", "total_ratio", "Total ratio", s.total_ratio, "dimensionless", "1")
    yield from (figure_row("front", objective_figure(s, name)) for name in objectives)


def _names(section: str, parts: dict[str, Any]) -> Iterator[Row]:
    for name, part in parts.items():
        title = f"{part.manufacturer} {part.family}" if part else ""
        yield row(section, name, title, value=part.part if part else "", status="" if part else "unknown")


def set_rows(s: DriveSet, objective: str) -> Iterator[Row]:
    """A drive: its parts, ratios, mass, price, objective and verdict."""
    yield from _names("set", {name: getattr(s, name) for name in ("motor", "gearhead", "encoder", "controller")})
    if s.brake:
        yield from _names("set", {"brake": s.brake})
    if s.belt_drive:
        yield from _names("set", {role.replace(" ", "_"): part for role, part in s.belt_drive.parts.items()})
        yield _figure("set", "centre_distance", "Centre distance", s.belt_drive.centre_distance, "length", "mm")
        yield _figure("set", "teeth_in_mesh", "Teeth in mesh", s.belt_drive.teeth_in_mesh, "dimensionless", "1")
    if s.chosen_screw:
        yield from _names("set", {"screw": s.chosen_screw.screw})
        yield _figure("set", "screw_length", "Length of the screw", s.chosen_screw.length, "length", "mm")
    yield _figure("set", "gearhead_ratio", "Ratio of the gearhead", s.gearhead.ratio, "dimensionless", "1")
    yield _figure("set", "belt_ratio", "Ratio of the belt", s.belt_ratio, "dimensionless", "1")
    yield _figure("set", "total_ratio", "Total ratio", s.total_ratio, "dimensionless", "1")
    yield _figure("set", "mass", "Mass", s.mass, "mass", "g") | _over("sum of", s.mass_of)
    yield _figure("set", "price", "Price", s.price, "price", "EUR") | _over("sum of", s.price_of)
    yield row("set", "objective", f"Objective: {objective}", si_value=s.objective) | _over("of", s.objective_of)
    yield row("set", "verdict", "All checks", status=s.status)


def _over(words: str, names: Iterable[str]) -> Row:
    said = ", ".join(names)
    return {"note": f"{words} {said}" if said else ""}


def part_rows(line: PartLine) -> Iterator[Row]:
    """A part as it is bought: its order number, then how many, mass and price of one, as far as they are known."""
    name, bare = line.role.replace(" ", "_"), "" if line.order_number else line.part
    title = " ".join(filter(None, (line.maker, line.family, bare)))
    yield row("part", name, title or line.role, value=line.order_number, status="" if line.order_number else "unknown",
              note="; ".join(filter(None, (line.said, line.note))))  # fmt: skip
    yield plain_row("part", f"{name}_quantity", f"{line.role}, pieces for the machine", line.quantity, "1")
    yield _figure("part", f"{name}_mass", f"{line.role}, mass of one", line.mass, "mass", "g")
    note = ", ".join(filter(None, (line.price_source, line.price_date)))
    yield plain_row("part", f"{name}_price", f"{line.role}, price of one", line.price, line.currency) | {"note": note}


def total_rows(totals: Iterable[Total]) -> Iterator[Row]:
    """The sums of a parts list, with the roles that they cover."""
    for total in totals:
        least = ", at least" if total.lacks else ""
        named = "part", f"total_{total.name}", f"All parts, {total.name}{least}", total.value
        lacks = f"; not known and not in the sum: {', '.join(total.lacks)}" if total.lacks else ""
        found = _figure(*named, "mass", "g") if total.name == "mass" else plain_row(*named, total.unit)
        guessed = f"; estimated: {', '.join(total.estimated)}" if total.estimated else ""
        yield found | {"note": f"sum of {', '.join(total.over)}{lacks}{guessed}"}


def closed_loop_rows(v: Validation) -> Iterator[Row]:
    """The closed loop: verdict, checks, figures, gains in SI and in the controller's units, and each linear loop."""
    rank = {"set_rank": v.drive_set.rank}
    yield row("validation", "verdict", f"{v.loop.capitalize()}, {driven_over(v)}", status=v.status) | rank
    yield from (check_row("validation", c) | rank for c in v.checks)
    yield from (figure_row("validation", f) | rank for f in v.figures)
    yield from (one | rank for one in _gains(v))
    for one in v.linear.figures if v.linear else ():
        yield figure_row("python_control", one.linear) | rank
        if one.engine:
            yield figure_row("engine", one.engine) | rank
    for loop in v.loops:
        said = {"case": loop.direction, "status": "pass" if loop.stable else "fail"} | rank
        for f in loop_figures(loop):
            title = f"{loop.name} loop, {f.title}"
            yield _figure("loop", f"{loop.name}_{f.name}", title, f.value, f.kind, f.unit) | said


def _gains(v: Validation) -> Iterator[Row]:
    rule = f"{v.gains.rule}; {v.gains.source}"
    for gain in gain_rows(v.gains):
        yield plain_row("validation", *gain) | {"note": rule}
    for own in v.controller_gains:
        title = f"{own.name}, as written into the controller"
        yield row("validation", own.place, title, value=own.value, unit=own.unit)


# -- The probabilities of the drives, as rows of plain data under the names in ``rows.COLUMNS`` and ``QUANTILES``.
#
# CSV and workbook print the same floats. A probability stands in per cent and, in SI, as a share of 1; a margin is a
# share of 1, as in every other row. Drives that were not sampled have no such rows.


QUANTILES = ("margin_5", "margin_50", "margin_95")  # margins that 95 %, 50 % and 5 % of samples exceed


def sampling_rows(result: SizingResult) -> Iterator[Row]:
    """The sampling, and each uncertain figure with the source of its tolerance."""
    sampled = result.uncertainty
    if sampled is None:
        return
    counts = {
        "samples": ("Samples of each drive", sampled.samples),
        "seed": ("Seed of the samples", sampled.seed),
        "sets_sampled": ("Drives that were sampled", sampled.examined),
    }
    if sampled.confidence is not None:
        yield _share("sampling", "confidence", "Required confidence", sampled.confidence)
        counts["sets_that_reach_it"] = ("Drives that reach the required confidence", sampled.reached)
    for name, (title, count) in counts.items():
        yield row("sampling", name, title, value=count)
    for one in sampled.assumptions:
        yield row("uncertain", one.name, one.title, value=one.text, note=one.source)


def every_list(result: SizingResult, *, front: bool = True) -> list[tuple[str, DriveSet]]:
    """Every drive of the report with the list that it is on; those of the front have ranks of their own."""
    lists = {"set": result.sets, "unsure": result.unsure, "miss": result.misses}
    return [(name, one) for name, some in (lists | {"front": result.front if front else ()}).items() for one in some]


def below_confidence_row(result: SizingResult) -> Row:
    """The row that marks a drive below the required confidence."""
    wanted = result.uncertainty.confidence if result.uncertainty else None
    title = "Meets all limits, but below the required confidence"
    return row("set", "unsure", title, note=f"below the confidence of {confidence(wanted)}")


def reliability_rows(one: DriveSet) -> Iterator[Row]:
    """A drive over its samples: the probability that all checks pass, each check alone, and the drivers."""
    found = one.reliability
    if found is None:
        return
    margins = (found.low, found.middle, found.high)
    yield _share("reliability", "all_checks", "All checks pass", found.passing) | _quantiles(*margins)
    yield _share("reliability", "none_fails", "No check fails", found.probability)
    yield _share("reliability", "error_95", "Error of that, 95 % to both sides", found.error)
    yield row("reliability", "weakest_check", "Weakest check", value=_weakest(found), note=found.weakest)
    if found.loop:
        said = {"note": f"weakest: {found.loop.weakest}"}
        yield _share("reliability", "closed_loop", "All checks pass in closed loop", found.loop.passing) | said
        yield _share("reliability", "closed_loop_none_fails", "No check fails in closed loop", found.loop.probability)
        yield _share("reliability", "closed_loop_error_95", "Error of that, 95 % to both sides", found.loop.error)
        yield row("reliability", "closed_loop_samples", "Samples in closed loop", value=found.loop.samples)
    if found.no_loop:
        title = "All checks pass in closed loop"
        yield row("reliability", "closed_loop", title, status="unknown", note=found.no_loop)
    yield from (_check(spread, one) for spread in found.checks)
    yield from (line for spread in found.figures for line in _percentiles(spread))
    yield from (line for driver in found.drivers for line in _driver(driver))


def _share(section: str, name: str, title: str, value: float) -> Row:
    return row(section, name, title, value=100.0 * value, unit="%", si_value=value, si_unit="1")


def _quantiles(*margins: float) -> Row:
    return dict(zip(QUANTILES, margins, strict=True))


def _check(spread: Spread, one: DriveSet) -> Row:
    """A check's share of samples that pass; what is left neither passes nor fails."""
    unknown = 1.0 - spread.passes - spread.fails
    said = {"status": "unknown", "note": f"unknown in {100.0 * unknown:.4g} % of samples"} if unknown > 0.0 else {}
    found = _share("reliability", spread.name, f"Passes: {spread.title}", spread.passes) | said
    return found | {"method": method_of(spread, one)} | _quantiles(spread.low, spread.middle, spread.high)


def _percentiles(spread: FigureSpread) -> Iterator[Row]:
    """A figure at its 5th, 50th and 95th percentile."""
    for percent, value in ((5, spread.low), (50, spread.middle), (95, spread.high)):
        title = f"{spread.title}, {percent} % of samples are below"
        yield figure_row(
            "percentile",
            Figure(name=f"{spread.name}_{percent}", title=title, value=value, kind=spread.kind, unit=spread.unit),
        )


def method_of(spread: Spread, one: DriveSet) -> str:
    """The method of a check: ``physics``, or ``budget`` of the machine."""
    budget = {check.name for check in one.budget}
    return "budget" if spread.name in budget else "physics"


def _driver(driver: Driver) -> Iterator[Row]:
    """The effect of one assumption on the smallest margin."""
    of = {"case": driver.name}
    yield _share("driver", "share_of_variance", "Share of the variance of the smallest margin", driver.share) | of
    title = "Rank correlation with the smallest margin"
    yield plain_row("driver", "rank_correlation", title, driver.rank_correlation, "1") | of
    ends = {"5": (driver.low, driver.low_margin), "95": (driver.high, driver.high_margin)}
    for quantile, (said, least) in ends.items():
        title = f"Smallest margin with this at its {quantile} % quantile"
        yield row("driver", f"smallest_margin_at_{quantile}", title, margin=least, note=f"at {said}") | of


def _weakest(found: Reliability) -> str:
    """The name of the weakest check, by which the other columns know it."""
    return next((check.name for check in found.checks if check.title == found.weakest), found.weakest)


_WHOLE = ("probability", "none_fails", "probability_error_95", "weakest_check", "unknown_checks", "smallest_margin_5",
          "smallest_margin_50", "smallest_margin_95")  # fmt: skip
_LOOP = ("closed_loop_probability", "closed_loop_none_fails", "closed_loop_error_95", "closed_loop_weakest_check",
         "closed_loop_unknown_checks", "closed_loop_samples")  # fmt: skip


def chance_columns(sets: Iterable[DriveSet]) -> tuple[str, ...]:
    """Heads of the columns of :func:`chances`; none where no drive was sampled."""
    found = [one.reliability for one in sets if one.reliability]
    if not found:
        return ()
    loop = _LOOP if any(one.loop for one in found) else ()
    checks = dict.fromkeys(check.name for one in found for check in one.checks)
    each = (f"{head}_{name}" for name in checks for head in ("passes", "fails", *QUANTILES))
    return (*_WHOLE, *loop, *each)


def chances(one: DriveSet, heads: Sequence[str]) -> list[Any]:
    """The probabilities of a drive, a cell for each head."""
    cells = _cells(one.reliability) if one.reliability else {}
    return [cells.get(head, "") for head in heads]


def _cells(found: Reliability) -> dict[str, Any]:
    margins = (found.low, found.middle, found.high)
    whole = (found.passing, found.probability, found.error, _weakest(found), "; ".join(found.unknown), *margins)
    loop = found.loop
    driven: tuple[Any, ...] = ("", "", nan, "", "", "")
    if loop:
        open_ = "; ".join(loop.unknown)
        driven = (loop.passing, loop.probability, loop.error, loop.weakest, open_, loop.samples)
    cells = dict(zip((*_WHOLE, *_LOOP), (*whole, *driven), strict=True))
    for check in found.checks:
        figures = {"passes": check.passes, "fails": check.fails}
        figures |= _quantiles(check.low, check.middle, check.high)
        cells |= {f"{head}_{check.name}": value for head, value in figures.items()}
    return cells


# -- The probability that a drive passes, in words and as cells of a table.


def outcome(result: SizingResult) -> str:
    """``found``, ``unsure`` where no drive reaches the required confidence, or ``missed`` where all are rejected."""
    return "found" if result.sets else "unsure" if result.unsure else "missed"


def none_reaches(result: SizingResult) -> str:
    """Statement that no drive reaches the required confidence; empty where one does, or none meets all limits."""
    if outcome(result) != "unsure" or result.uncertainty is None:
        return ""
    return f"no drive reaches the confidence of {confidence(result.uncertainty.confidence)}"


def error_and_weakest(found: Reliability) -> str:
    """The error of a probability, the weakest check and the unknown ones."""
    number = "1 check is" if len(found.unknown) == 1 else f"{len(found.unknown)} checks are"
    unknown = f"; {number} unknown: {'; '.join(found.unknown)}" if found.unknown else ""
    return f"{_error(found.error)}; weakest check: {found.weakest}{unknown}"


def reported(result: SizingResult) -> DriveSet | None:
    """The drive whose margins and drivers are reported: the best that is probable enough, else the most probable."""
    return next((one for one in (*result.sets, *result.unsure) if one.reliability), None)


def drive_cells(one: DriveSet) -> dict[str, str]:
    """A drive over its samples; it must have been sampled."""
    found = one.reliability
    assert found is not None
    more = [loop_text(found)] if loop_text(found) else []
    more += [f"unknown: {'; '.join(found.unknown)}"] if found.unknown else []
    return {
        "rank": str(one.rank),
        "label": one.label,
        "chance": likely(found.passing),
        "error": _error(found.error),
        "weakest": found.weakest,
        "more": "; ".join(more),
        "low": _shown(found.low),
        "middle": _shown(found.middle),
        "loop": _driven(found.loop) if found.loop else "",
    }


def _driven(loop: LoopShare) -> str:
    none_fails = f"{likely(loop.probability)} {_error(loop.error)}"
    return f"unknown; none fails: {none_fails}" if loop.unknown else none_fails


def _error(value: float) -> str:
    return f"± {100 * value:.2g} %"


def _shown(value: float) -> str:
    return margin(value) if isfinite(value) else "–"


def check_cells(one: Spread) -> list[str]:
    """Title, share of samples that pass, quantiles of the margin."""
    return [one.title, likely(one.passes), *(_shown(value) for value in (one.low, one.middle, one.high))]


def driver_cells(one: Driver) -> list[str]:
    """Title, share of the variance, and the smallest margin at both quantiles of the assumption."""
    ends = ((one.low_margin, one.low), (one.high_margin, one.high))
    return [one.title, f"{100 * one.share:.0f} %", *(f"{_shown(value)} at {minus(end)}" for value, end in ends)]


# -- A drive, its checks and its figures as rows of text.


def tight_of(drive: DriveSet) -> dict[str, str]:
    """The smallest margin of a drive with its check; a condition that fails has none."""
    check = next(iter(tightest_checks(drive)), None)
    if check is None:
        return {"margin": "unknown", "title": ""}
    if isnan(check.margin):
        return {"margin": "none", "title": f"{check.title}: not met"}
    return {"margin": margin(check.margin), "title": check.title}


_TIGHTEST = 3


def tightest_checks(drive: DriveSet) -> list[Check]:
    """Three checks: conditions that fail, then the smallest margins; those kept small by selection are left out."""
    return tightest(drive.deciding, _TIGHTEST)


def check_texts(c: Check) -> dict[str, Any]:
    """A check: texts of its demand, limit and margin, the share of the limit that it uses, and the exact numbers."""
    bare = isnan(c.demand) and isnan(c.limit)  # a condition without figures
    return {
        "title": c.title,
        "part": part_of(c.name),
        "case": "" if bare or c.case == AS_SPECIFIED else case_of(c),
        "demand": "" if bare else c.shown(c.demand),
        "limit": "" if bare else c.shown(c.limit),
        "margin": margin(c.margin),
        "needed": margin(c.needed) if c.needed and not isnan(c.margin) else "",
        "use": use(c.margin),
        "allowed": use(c.needed),
        "status": c.status,
        "at": "" if c.at_time is None else f"{c.at_time:.4g} s",
        "note": c.note
        or ("selected to be so: not a measure of the load" if c.by_choice and c.status == "pass" else ""),
        "exact": {"name": c.name, "unit": c.unit, "margin": number(c.margin)}
        | {name: number(from_si(x, c.unit, c.kind)) for name, x in (("demand", c.demand), ("limit", c.limit))},
    }


def case_of(c: Check) -> str:
    """The load case in which a check is worst; a wheel and a passage are named without "case"."""
    alone = not c.case or c.name.startswith("passage_") or re.match(r"wheels? \d", c.case)
    return c.case if alone else f"case {c.case}"


def figure_texts(f: Figure) -> dict[str, str]:
    """A figure that has no limit."""
    return {"title": f.title, "text": f.text, "at": "" if f.at_time is None else f"{f.at_time:.4g} s"}
