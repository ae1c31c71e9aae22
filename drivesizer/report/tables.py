"""CSV: one tidy table of everything that was found, the closed loop over time, and the sets in rows.

UTF-8, lines end with a newline. Numbers are written with every digit that they have, an unknown figure is an
empty cell, one without end is ``inf``. Units are spelled as a spec accepts them.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from drivesizer.gain_table import gain_rows
from drivesizer.loop_table import loop_figures
from drivesizer.objectives import objective_figure
from drivesizer.report.sums import price_of
from drivesizer.results import Check, DriveSet, Figure, Relaxation, Requirement, SizingResult, Validation, worst
from drivesizer.units import KINDS, from_si

__all__ = ["COLUMNS", "render", "report_csv", "sets_csv", "timeseries_csv"]

COLUMNS = (
    "section", "set_rank", "name", "title", "symbol", "equation", "method", "case", "value", "limit", "unit",
    "si_value", "si_limit", "si_unit", "margin", "needed_margin", "status", "at_time_s", "note",
)  # fmt: skip

_FORMULA = ("=", "+", "-", "@", "\t", "\r")  # a spreadsheet computes a cell that begins so


def render(result: SizingResult, validation: Validation | None, path: Path) -> dict[Path, bytes]:
    """The files of a CSV report: the table, and beside it the time series when there is one."""
    files = {path: report_csv(result, validation)}
    if validation is not None:
        files[path.with_name(f"{path.stem}-timeseries{path.suffix}")] = timeseries_csv(validation)
    return files


def report_csv(result: SizingResult, validation: Validation | None) -> bytes:
    """Requirements, sets, what they do, checks, changes, the Pareto front, the closed loop: one figure in a row."""
    rows = (row for part in _sections(result, validation) for row in part)
    return _encoded(COLUMNS, ([row.get(column, "") for column in COLUMNS] for row in rows))


def _sections(result: SizingResult, validation: Validation | None) -> Iterator[Iterable[dict[str, Any]]]:
    yield (_requirement(r) for r in result.requirements)
    for drive_set in (*result.sets, *result.misses):
        rank = {"set_rank": drive_set.rank}
        yield ({**row, **rank} for row in _set(drive_set, result.objective))
        yield ({**_requirement(r), **rank} for r in drive_set.requirements)
        yield ({**_loose("figure", f), **rank} for f in drive_set.figures)
        yield ({**_check("check", c), **rank} for c in (*drive_set.checks, *drive_set.beside))
        yield ({**_change(r), **rank} for r in drive_set.changes)
    yield (_change(r) for r in result.relaxations)
    for drive_set in result.front:
        yield ({**row, "set_rank": drive_set.rank} for row in _on_front(drive_set, result.pareto))
    if validation is not None:
        yield _validation(validation)


def _figure(section: str, name: str, title: str, value: float, kind: str, unit: str) -> dict[str, Any]:
    return {
        "section": section,
        "name": name,
        "title": title,
        "value": from_si(value, unit, kind),
        "unit": unit,
        "si_value": value,
        "si_unit": KINDS[kind].si,
    }


def _requirement(r: Requirement) -> dict[str, Any]:
    row = _figure("requirement", r.name, r.title, float(r.value), r.kind, r.unit)
    return row | {"symbol": r.symbol, "equation": r.equation or "", "note": r.note}


def _check(section: str, c: Check) -> dict[str, Any]:
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


def _change(r: Relaxation) -> dict[str, Any]:
    """What would let a set stand: the figure now as value, what it must become as limit."""
    row = _figure("change", r.field, "What would have to move", r.before, r.kind, r.unit)
    return row | {
        "limit": from_si(r.after, r.unit, r.kind),
        "si_limit": r.after,
        "note": f"{r.now} to {r.needed}: then {r.set_label} stands",
    }


def _on_front(s: DriveSet, objectives: Iterable[str]) -> Iterator[dict[str, Any]]:
    yield from _parts("front", {"motor": s.motor, "gearhead": s.gearhead})
    yield _figure("front", "total_ratio", "Whole reduction", s.total_ratio, "dimensionless", "1")
    yield from (_loose("front", objective_figure(s, name)) for name in objectives)


def _parts(section: str, parts: dict[str, Any]) -> Iterator[dict[str, Any]]:
    for name, part in parts.items():
        title = f"{part.manufacturer} {part.family}" if part else ""
        said = part.part if part else ""
        yield {"section": section, "name": name, "title": title, "value": said, "status": "" if part else "unknown"}


def _set(s: DriveSet, objective: str) -> Iterator[dict[str, Any]]:
    names = ("motor", "gearhead", "encoder", "controller")
    yield from _parts("set", {name: getattr(s, name) for name in names})
    if s.belt_drive:
        yield from _parts("set", {role.replace(" ", "_"): part for role, part in s.belt_drive.parts.items()})
        yield _figure("set", "centre_distance", "Centre distance", s.belt_drive.centre_distance, "length", "mm")
        yield _figure("set", "teeth_in_mesh", "Teeth in mesh", s.belt_drive.teeth_in_mesh, "dimensionless", "1")
    figures = {
        "gearhead_ratio": ("Reduction of the gearhead", s.gearhead.ratio, "dimensionless", "1", ()),
        "belt_ratio": ("Reduction of the belt", s.belt_ratio, "dimensionless", "1", ()),
        "total_ratio": ("Whole reduction", s.total_ratio, "dimensionless", "1", ()),
        "mass": ("Mass", s.mass, "mass", "g", s.mass_of),
        "price": ("Price", *_priced(s)),
    }
    for name, (title, value, kind, unit, over) in figures.items():
        yield _figure("set", name, title, value, kind, unit) | {"note": f"sum of {', '.join(over)}" if over else ""}
    yield {"section": "set", "name": "objective", "title": f"Objective: {objective}", "si_value": s.objective,
           "note": f"of {', '.join(s.objective_of)}" if s.objective_of else ""}  # fmt: skip
    yield {"section": "set", "name": "verdict", "title": "All checks", "status": s.status}


def _priced(s: DriveSet) -> tuple[float, str, str, tuple[str, ...]]:
    value, over = price_of(s)
    return value, "price", "EUR", over


def _validation(v: Validation) -> Iterator[dict[str, Any]]:
    rank = {"set_rank": v.drive_set.rank}
    yield {"section": "validation", "name": "verdict", "title": f"Closed loop, {v.profile}", "status": v.status, **rank}
    yield from (_check("validation", c) | rank for c in v.checks)
    yield from (_loose("validation", f) | rank for f in v.figures)
    for name, title, value, unit in gain_rows(v.gains):
        yield {"section": "validation", "name": name, "title": title, "value": value, "unit": unit, "si_value": value,
               "si_unit": unit, "note": f"{v.gains.rule}; {v.gains.source}", **rank}  # fmt: skip
    for loop in v.loops:
        said = {"case": loop.direction, "status": "pass" if loop.stable else "fail"} | rank
        for f in loop_figures(loop):
            yield (
                _figure("loop", f"{loop.name}_{f.name}", f"{loop.name} loop, {f.title}", f.value, f.kind, f.unit) | said
            )


def _loose(section: str, f: Figure) -> dict[str, Any]:
    """A figure that has no limit of its own."""
    at_time = "" if f.at_time is None else f.at_time
    return _figure(section, f.name, f.title, f.value, f.kind, f.unit) | {"at_time_s": at_time}


def timeseries_csv(validation: Validation) -> bytes:
    """The closed loop over time: a column per signal, its unit in the head."""
    heads, columns = [], []
    for name, values in validation.series.items():
        kind, unit = validation.series_units[name]
        heads.append(f"{name} ({unit})")
        columns.append(from_si(values, unit, kind).tolist())
    return _encoded(heads, zip(*columns, strict=True))


def sets_csv(result: SizingResult) -> bytes:
    """One row per set, per nearest miss where fewer stand than were asked for, and per set of the Pareto front."""
    lists = (("set", result.sets), ("miss", result.misses), ("front", result.front))
    sets = [(name, one) for name, some in lists for one in some]
    checks = list(dict.fromkeys(c.name for _, s in sets for c in s.checks))
    figures = {f.name: f.kind for _, s in sets for f in s.figures}
    objective = f"objective_{_slug(result.objective)}_si"
    heads = [*_SET_HEADS, "price_of", objective, "smallest_margin", "smallest_margin_check"]
    heads += [*(f"margin_{name}" for name in checks), *(f"figure_{name}_{KINDS[k].si}" for name, k in figures.items())]
    return _encoded(heads, ([name, *_set_row(one, checks, list(figures))] for name, one in sets))


def _slug(title: str) -> str:
    """The title of an objective as a word: that of several with weights has blanks.

    >>> _slug("2 mass + 1 price")
    '2_mass_1_price'
    """
    return "_".join(title.replace("+", " ").split())


_SET_HEADS = (
    "list", "rank", "status", "motor_family", "motor_part", "gearhead_family", "gearhead_part", "gearhead_ratio",
    "belt_ratio", "driving_pulley_part", "belt_part", "driven_pulley_part", "centre_distance_m", "teeth_in_mesh",
    "encoder_family", "encoder_part", "controller_family", "controller_part", "total_ratio", "mass_kg", "mass_of",
    "price_EUR",
)  # fmt: skip


def _set_row(s: DriveSet, checks: list[str], figures: list[str]) -> list[Any]:
    tightest, (price, price_over) = worst(s.checks), price_of(s)
    margins, does = {c.name: c.margin for c in s.checks}, {f.name: f.value for f in s.figures}
    chosen = [text for part in (s.encoder, s.controller) for text in ((part.family, part.part) if part else ("", ""))]
    return [
        s.rank, s.status, s.motor.family, s.motor.part, s.gearhead.family, s.gearhead.part, s.gearhead.ratio,
        s.belt_ratio, *_belt(s), *chosen, s.total_ratio, s.mass, " + ".join(s.mass_of), price, " + ".join(price_over),
        s.objective, tightest.margin if tightest else "", tightest.name if tightest else "",
        *(margins.get(name, "") for name in checks), *(does.get(name, "") for name in figures),
    ]  # fmt: skip


def _belt(s: DriveSet) -> list[Any]:
    """Belt and pulleys, empty where they are not out of the catalogues."""
    drive = s.belt_drive
    return (
        [*(part.part for part in drive.parts.values()), drive.centre_distance, drive.teeth_in_mesh]
        if drive
        else [""] * 5
    )


def _encoded(heads: Iterable[str], rows: Iterable[Iterable[Any]]) -> bytes:
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(heads)
    writer.writerows([_cell(value) for value in row] for row in rows)
    return text.getvalue().encode()


def _cell(value: Any) -> Any:
    if isinstance(value, float):
        return "" if math.isnan(value) else float(value)  # numpy's floats print as their constructor
    if not isinstance(value, str):
        return value
    # A lone carriage return would end the row for most readers, and the csv module does not quote it.
    text = value.replace("\r\n", "\n").replace("\r", "\n")
    return f"'{text}" if value.startswith(_FORMULA) else text
