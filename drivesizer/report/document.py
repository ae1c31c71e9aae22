"""The content of a report as plain data: what is printed, in its order; the figures are in ``drawings``.

Nothing is computed here but texts. Strings of it are printed as strings, so that no text of a spec or a catalogue is
ever read as markup.
"""

from __future__ import annotations

from math import isnan
from typing import Any

from drivesizer import __version__
from drivesizer.checks import TITLES
from drivesizer.gain_table import gain_rows
from drivesizer.loads import load_cycle
from drivesizer.objectives import objective_figure
from drivesizer.report import figures
from drivesizer.report.behaviour import Behaviour
from drivesizer.report.datasheet import datasheets
from drivesizer.report.derivation import step
from drivesizer.report.field_figure import MOST_PANELS
from drivesizer.report.loop_rows import gain, linear
from drivesizer.report.operating import panels
from drivesizer.report.order_list import order_list
from drivesizer.report.panels import windows
from drivesizer.report.parts import parts
from drivesizer.report.rests_on import marked_figures, unknown_figures
from drivesizer.report.sums import price_of, unknown_of
from drivesizer.report.wording import cleaned, margin, short, use
from drivesizer.results import Check, Comparison, DriveSet, Figure, Relaxation, SizingResult, Validation, worst
from drivesizer.spec import AS_SPECIFIED
from drivesizer.units import show

__all__ = ["document"]


def document(
    result: SizingResult,
    validation: Validation | None,
    does: Behaviour | None,
    paper: str = "a4",
    date: str | None = None,
) -> dict[str, Any]:
    """Everything that a report prints.

    Parameters
    ----------
    result
        What the sizing found.
    validation
        The closed loop, where it was simulated.
    does
        What the set that is shown does over the cycles; None without a set.
    paper
        Format of the sheets.
    date
        Printed where it is given.
    """
    best = next(iter((*result.sets, *result.misses)), None)
    return {
        **cleaned(_content(result, validation, best, does)),
        "sheet": paper,
        "date": cleaned(short(date or "", 40)),
        "header": cleaned(short(result.spec.name)),
        "spec_lines": cleaned(result.spec.text.splitlines()),
    }


def _content(
    result: SizingResult, validation: Validation | None, best: DriveSet | None, does: Behaviour | None
) -> dict[str, Any]:
    cycles = [(name, load_cycle(case)) for name, case in result.spec.load_cases]
    fields = panels(result.spec, best, result.requirements) if best else []
    return {
        "name": result.spec.name,
        "version": __version__,
        "method": result.method,
        "objective": result.objective.replace("_", " "),
        "place": "wheel" if result.spec.load.kind == "wheeled_vehicle" else "load's shaft",
        "paper": result.spec.paper_applies,
        "cases": [name for name, _ in result.spec.load_cases if name],
        "catalogs": [[name, digest] for name, digest in result.catalog.digests.items()],
        "file": result.spec.file.replace("\\", "/").rsplit("/", 1)[-1],
        "found": bool(result.sets),
        "status": result.sets[0].status if result.sets else "fail",
        "motor_sets": result.spec.load.motors,
        **_of_set(best, does, result),
        "regeneration": show(result.spec.supply.regeneration, "%", "dimensionless"),
        "spec": _spec(result.spec.entered),
        "load_steps": [step(r) | {"text": r.text} for r in result.requirements],
        "candidates": _candidates(result),
        "front": _front(result) if result.front else None,
        "hidden_fields": len(fields[MOST_PANELS:]),
        "cut": len(figures.stretches(cycles)) > 1,
        "loop": _loop(validation) if validation else None,
        "assumptions": list(result.assumptions),
        "warnings": list(result.warnings),
    }


def _of_set(best: DriveSet | None, does: Behaviour | None, result: SizingResult) -> dict[str, Any]:
    if best is None or does is None:
        return {"best": None, "motor_steps": []}
    catalog = result.catalog
    return {
        "best": _best(best) | {"energy": does.cost, "energy_of": _energy_of(result)},
        "heat": does.heat,
        "heat_lacks": does.heat_lacks,
        "hottest": does.hottest[0] if does.hottest and len(does.cycles) > 1 else "",
        **order_list(best, result.spec.load.motors, catalog),
        "unknown": unknown_figures(best),
        "marked": marked_figures(best, catalog),
        "motor_steps": [step(r) for r in best.requirements],
        "datasheets": datasheets(best, catalog),
        "checks": [_check(c) for c in best.checks],
        "beside": [_check(c) for c in best.beside],
        "comparison": [_compared(pair) for pair in best.comparison],
        "does": [_figure(f) for f in best.figures],
        "changes": _moves(best.changes),
    }


def _best(best: DriveSet) -> dict[str, Any]:
    price, price_over = price_of(best)
    failed = [c for c in best.checks if c.status == "fail" and isnan(c.margin)]
    return {
        "label": best.label,
        "parts": parts(best),
        "total_ratio": f"{best.total_ratio:.4g}",
        "mass": show(best.mass, "g", "mass"),
        "mass_of": " + ".join(best.mass_of),
        "mass_lacks": ", ".join(unknown_of(best, best.mass_of)),
        "price": "unknown" if isnan(price) else f"{price:.2f} EUR",
        "price_of": " + ".join(price_over),
        "price_lacks": ", ".join(unknown_of(best, price_over)),
        "tight": _tight(best, failed),
        "tightest": [_check(c) for c in [*failed, *_tightest(best)][:5]],
        "failed": [c.title for c in best.checks if c.status == "fail"],
        "unknown": [c.title for c in best.checks if c.status == "unknown"],
    }


def _energy_of(result: SizingResult) -> str:
    """Of what the energy of a cycle is the sum."""
    sets = result.spec.load.motors
    said = "of the one motor set" if sets == 1 else f"of all {sets} motor sets"
    return f"out of the supply, {said}" + (", as specified" if len(result.spec.load_cases) > 1 else "")


def _tight(s: DriveSet, failed: list[Check]) -> dict[str, str]:
    """The one margin of the summary; of a condition that fails there is none."""
    if failed:
        return {"margin": "none", "title": f"{failed[0].title}: not met"}
    check = next(iter(_tightest(s)), None)
    return {"margin": margin(check.margin), "title": check.title} if check else {"margin": "unknown", "title": ""}


def _tightest(s: DriveSet) -> list[Check]:
    """Checks with a margin, the smallest first; what was kept small by choice says nothing and is left out."""
    known = (c for c in s.checks if not isnan(c.margin) and not (c.by_choice and c.status == "pass"))
    return sorted(known, key=lambda c: c.margin)


def _check(c: Check) -> dict[str, Any]:
    bare = isnan(c.demand) and isnan(c.limit)  # a condition without figures
    return {
        "title": c.title,
        "case": "" if bare or c.case == AS_SPECIFIED else c.case,
        "demand": "" if bare else c.shown(c.demand),
        "limit": "" if bare else c.shown(c.limit),
        "margin": margin(c.margin),
        "needed": margin(c.needed) if c.needed and not isnan(c.margin) else "",
        "use": use(c.margin),
        "allowed": use(c.needed),
        "status": c.status,
        "at": "" if c.at_time is None else f"{c.at_time:.4g} s",
        "note": c.note or ("so by choice: says nothing of the load" if c.by_choice and c.status == "pass" else ""),
    }


def _figure(f: Figure) -> dict[str, str]:
    return {"title": f.title, "text": f.text, "at": "" if f.at_time is None else f"{f.at_time:.4g} s"}


def _moves(changes: tuple[Relaxation, ...]) -> list[list[str]]:
    return [[r.field, r.now, r.needed, r.set_label] for r in changes]


def _compared(pair: Comparison) -> dict[str, Any]:
    return {
        "title": pair.paper.title,
        "paper": pair.paper.shown(pair.paper.demand),
        "physics": pair.physics.shown(pair.physics.demand),
        "paper_status": pair.paper.status,
        "physics_status": pair.physics.status,
        "why": pair.why,
    }


def _spec(entered: dict[str, Any]) -> list[dict[str, Any]]:
    """The spec as it was entered, by section; what stands at the top level goes into one of its own."""
    top = [[key, _scalar(value)] for key, value in entered.items() if not isinstance(value, dict | list)]
    sections = [{"title": key.replace("_", " "), "rows": _flat(value)} for key, value in entered.items()
                if isinstance(value, dict | list)]  # fmt: skip
    return [section for section in ({"title": "general", "rows": top}, *sections) if section["rows"]]


def _flat(value: Any, path: tuple[str, ...] = ()) -> list[list[str]]:
    if isinstance(value, dict):
        return [row for key, entry in value.items() for row in _flat(entry, (*path, str(key)))]
    if isinstance(value, list) and any(isinstance(entry, dict) for entry in value):
        return [row for n, entry in enumerate(value, 1) for row in _flat(entry, (*path, str(n)))]
    shown = ", ".join(_scalar(entry) for entry in value) if isinstance(value, list) else _scalar(value)
    return [[" › ".join(path), shown]]


def _scalar(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return "" if value is None else str(value)


def _candidates(result: SizingResult) -> dict[str, Any]:
    counts, other = result.counts, result.unrestricted
    fell = sorted(counts.failed_by.items(), key=lambda item: (-item[1], item[0]))
    return {
        "considered": counts.considered,
        "feasible": counts.feasible,
        "sets": [_row(s) for s in (*result.sets, *result.misses)],
        "fallen": len(result.misses),
        "fell": [
            {"title": TITLES[result.method][name], "count": n, "share": n / counts.considered} for name, n in fell
        ],
        "relaxations": _moves(result.relaxations),
        "unrestricted": _best(other) if other else None,
    }


def _row(s: DriveSet) -> dict[str, Any]:
    tight = worst(s.checks)
    failed = [c.title for c in s.checks if c.status == "fail"]
    price, _ = price_of(s)
    return {
        "rank": str(s.rank),
        "motor": s.motor_name,
        "gearhead": _gearhead(s, belt=False),
        "ratio": f"{s.total_ratio:.4g}",
        "mass": show(s.mass, "g", "mass"),
        "price": "unknown" if isnan(price) else f"{price:.2f}",
        "margin": margin(tight.margin) if tight else "",
        "check": _some(failed) if failed else tight.title if tight else "",
        "status": s.status,
    }


def _some(titles: list[str], most: int = 1) -> str:
    """The first of several titles, and how many more there are."""
    more = len(titles) - most
    return ", ".join(titles[:most]) + (f" and {more} more" if more > 0 else "")


_LONGEST_FRONT = 40  # sets of it that are printed


def _front(result: SizingResult) -> dict[str, Any]:
    """Sets that no other beats in all of several objectives."""
    found = [[objective_figure(s, name) for name in result.pareto] for s in result.front[:_LONGEST_FRONT]]
    return {
        "heads": [f.title for f in found[0]],
        "rows": [
            [str(s.rank), s.motor_name, _gearhead(s), *(f.text for f in row), s.status]
            for s, row in zip(result.front, found, strict=False)
        ],
        "more": max(len(result.front) - _LONGEST_FRONT, 0),
    }


def _gearhead(s: DriveSet, *, belt: bool = True) -> str:
    driven = f" + belt {s.belt_name}" if belt and s.belt_name else ""
    part = s.gearhead.part if "gearhead" in s.parts else ""
    return " ".join(f"{s.gearhead_name} {part}{driven}".split())


def _loop(v: Validation) -> dict[str, Any]:
    tight = worst(v.checks)
    return {
        "tightest": f"{tight.title} {margin(tight.margin)}" if tight else "",
        "unknown": ", ".join(c.title for c in v.checks if c.status == "unknown"),
        "label": v.drive_set.label,
        "profile": v.profile,
        "status": v.status,
        "checks": [_check(c) for c in v.checks],
        "figures": [_figure(f) for f in v.figures],
        "shown": [title for _, title in figures.closed_loop_rows(v)],
        "cut": len(windows(v.series)) > 1,
        "linear": linear(v.loops),
        "gains": [[row.title, gain(row)] for row in gain_rows(v.gains)],
        "own_gains": [[g.place, g.name, f"{g.value} {g.unit}"] for g in v.controller_gains],
        "rule": v.gains.rule,
        "source": v.gains.source,
        "assumptions": list(v.assumptions),
        "warnings": list(v.warnings),
    }
