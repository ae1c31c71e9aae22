"""The content of a report as plain data: what is printed, in its order; the figures are in ``drawings``.

Nothing is computed here but texts. Strings of it are printed as strings, so that no text of a spec or a catalogue is
ever read as markup.
"""

from __future__ import annotations

from typing import Any

from drivesizer.control.validation import Validation
from drivesizer.output.datasheet import datasheets
from drivesizer.output.derivation import step
from drivesizer.output.loop_table import gain, gain_rows, linear
from drivesizer.output.parts import parts_list
from drivesizer.output.report.figures import load_and_loop
from drivesizer.output.report.figures.field import MOST_PANELS
from drivesizer.output.report.figures.field_panels import panels
from drivesizer.output.report.figures.time_windows import windows
from drivesizer.output.report.lines.battery import battery_rows
from drivesizer.output.report.lines.candidates import candidates, front
from drivesizer.output.report.lines.figures_behind_checks import marked_figures, unknown_figures
from drivesizer.output.report.lines.machine import driven_over, first_wheel, machine_rows, machine_words
from drivesizer.output.report.lines.order_list import order_list
from drivesizer.output.report.lines.reliability import standing, sure
from drivesizer.output.report.lines.sets import check_row, compared, figure_row, moves, set_row
from drivesizer.output.report.set_behaviour import Behaviour
from drivesizer.output.text import cleaned, margin, short
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import SizingResult, worst
from drivesizer.units import show
from drivesizer.version import __version__

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
    best = result.shown
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
    cases = result.problem.cases
    cycles = [(case.name, case.cycle) for case in cases]
    fields = panels(result.problem, best, result.requirements) if best else []
    return {
        "name": result.spec.name,
        "what": machine_words(result.spec),
        "version": __version__,
        "method": result.method,
        "objective": result.objective.replace("_", " "),
        "place": "wheel" if result.spec.load.kind == "wheeled_vehicle" else "load's shaft",
        "paper": result.method == "paper",
        "wheel": first_wheel(result.problem),
        "cases": [case.name for case in cases if case.name],
        "catalogs": [[name, digest] for name, digest in result.catalog.digests.items()],
        "file": result.spec.file.replace("\\", "/").rsplit("/", 1)[-1],
        "standing": standing(result),
        "found": bool(result.sets),
        "status": result.sets[0].status if result.sets else "fail",
        "motor_sets": result.spec.load.motors,
        **_of_set(best, does, result),
        "regeneration": show(result.spec.supply.regeneration, "%", "dimensionless"),
        "spec": _spec(result.spec.entered),
        "load_steps": [step(r) | {"text": r.text} for r in result.requirements],
        "candidates": candidates(result),
        "front": front(result) if result.front else None,
        "sure": sure(result),
        "hidden_fields": len(fields[MOST_PANELS:]),
        "cut": len(load_and_loop.stretches(cycles)) > 1,
        "loop": _loop(validation) if validation else None,
        "assumptions": list(result.assumptions),
        "warnings": list(result.warnings),
    }


def _of_set(best: DriveSet | None, does: Behaviour | None, result: SizingResult) -> dict[str, Any]:
    if best is None or does is None:
        return {"best": None, "motor_steps": []}
    catalog = result.catalog
    return {
        "best": set_row(best, catalog) | {"energy": does.cost, "energy_of": _energy_of(result)},
        "heat": does.heat,
        "heat_lacks": does.heat_lacks,
        "hottest": does.hottest[0] if does.hottest and len(does.cycles) > 1 else "",
        **order_list(parts_list(best, catalog, result.spec.load.motors)),
        "unknown": unknown_figures(best),
        "marked": marked_figures(best, catalog),
        "motor_steps": [step(r) for r in best.requirements],
        "datasheets": datasheets(best, catalog),
        "checks": [check_row(c) for c in best.checks],
        "beside": [check_row(c) for c in best.beside],
        "comparison": [compared(pair) for pair in best.comparison],
        "budget": [check_row(c) for c in best.budget],
        **machine_rows(best),
        "battery": battery_rows(best),
        "does": [figure_row(f) for f in best.figures],
        "changes": moves(best.changes),
    }


def _energy_of(result: SizingResult) -> str:
    """Of what the energy of a cycle is the sum."""
    sets = result.spec.load.motors
    said = "of the one motor set" if sets == 1 else f"of all {sets} motor sets"
    several = ", as specified" if len(result.problem.cases) > 1 else ""
    return f"out of the supply, {said}" + (", each at its wheel" if first_wheel(result.problem) else several)


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
        return [row for n, entry in enumerate(value, 1) for row in _listed(entry, path, n)]
    shown = ", ".join(_scalar(entry) for entry in value) if isinstance(value, list) else _scalar(value)
    return [[" › ".join(path), shown]]


def _listed(entry: Any, path: tuple[str, ...], number: int) -> list[list[str]]:
    """An entry of a list: in one row under its name where it has one and holds no more than figures."""
    if not isinstance(entry, dict) or "name" not in entry or any(isinstance(v, dict | list) for v in entry.values()):
        return _flat(entry, (*path, str(number)))
    said = [f"{key.replace('_', ' ')} {_scalar(value)}" for key, value in entry.items() if key != "name"]
    return [[" › ".join((*path, _scalar(entry["name"]))), ", ".join(said)]]


def _scalar(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return "" if value is None else str(value)


def _loop(v: Validation) -> dict[str, Any]:
    tight = worst(v.checks)
    return {
        "tightest": f"{tight.title} {margin(tight.margin)}" if tight else "",
        "unknown": ", ".join(c.title for c in v.checks if c.status == "unknown"),
        "label": v.drive_set.label,
        "profile": driven_over(v),
        "status": v.status,
        "checks": [check_row(c) for c in v.checks],
        "figures": [figure_row(f) for f in v.figures],
        "shown": [title for _, title in load_and_loop.closed_loop_rows(v)],
        "cut": len(windows(v.series)) > 1,
        "linear": linear(v.loops),
        "gains": [[row.title, gain(row)] for row in gain_rows(v.gains)],
        "own_gains": [[g.place, g.name, f"{g.value} {g.unit}"] for g in v.controller_gains],
        "rule": v.gains.rule,
        "source": v.gains.source,
        "assumptions": list(v.assumptions),
        "warnings": list(v.warnings),
    }
