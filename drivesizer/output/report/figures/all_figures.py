"""All figures of a report by name, each drawn on demand, and as files: a drawing and a picture of each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isfinite, nan
from pathlib import Path

import drivesizer.output.report.figures.cycle as figures
from drivesizer.control.validation import Validation
from drivesizer.errors import InputError, reason_of
from drivesizer.files.writing import ready, write_files
from drivesizer.output.report.figures.choice import margins, swings, tornado, trade_off
from drivesizer.output.report.figures.cycle import speed_profile, wheels_over_time
from drivesizer.output.report.figures.field import alone, leading, panels, torque_speed, torque_speed_panels
from drivesizer.output.report.figures.loops import block_diagram, bode, step
from drivesizer.output.report.figures.machine import battery, is_known, plan_view, ways_of
from drivesizer.output.report.figures.set_behaviour import Behaviour
from drivesizer.output.report.figures.style import FILES, Form
from drivesizer.output.report.lines.rows import first_wheel, reported
from drivesizer.results.check_kinds import sorted_by_part
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import SizingResult, objective_figure
from drivesizer.units import from_si, label

__all__ = ["IN_TABLES", "STILL", "Drawing", "figures_into", "loop_drawings", "report_drawings"]


# -- All figures of a report by name, each drawn on demand.


Drawing = Callable[[Form], bytes]
IN_TABLES = {"margins"}  # of the figures: what the PDF shows in its tables
STILL = (  # what the page shows as the PDF does
    "way", "tornado", "fields", "efficiency", "demand", "heat", "energy", "permitted", "followed", "diagram",
)  # fmt: skip


def report_drawings(
    result: SizingResult, validation: Validation | None, does: Behaviour | None = None
) -> dict[str, Drawing]:
    """Every figure of a report, in the order in which it shows them."""
    best = result.shown
    cycles = [(case.name, case.cycle) for case in result.problem.cases]
    made: dict[str, Drawing] = {}
    over_time = wheels_over_time if first_wheel(result.problem) else figures.load_over_time
    if ways_of(result.spec):
        made["way"] = lambda form: plan_view(result.spec, form)
    made["profile"] = lambda form: speed_profile(result.spec, form)
    made["cycle"] = lambda form: over_time(cycles, form)
    if len(result.front) > 1:
        made["front"] = lambda form: _trade_off(result, form)
    certain = reported(result)
    if certain and certain.reliability and swings(certain.reliability.drivers):
        drivers = certain.reliability.drivers
        made["tornado"] = lambda form: tornado(drivers, form)
    if best:
        made |= _drive_figures(result, best, does or Behaviour(result.problem, best))
    if validation:
        made |= {"loop" if name == "closed_loop" else name: draw for name, draw in loop_drawings(validation).items()}
    return made


def _drive_figures(result: SizingResult, best: DriveSet, does: Behaviour) -> dict[str, Drawing]:
    """The figures of a drive; those that depend on figures that the catalogue does not know are left out."""
    fields = panels(result.problem, best, result.requirements)
    made: dict[str, Drawing] = {"margins": lambda form: margins(sorted_by_part(best.own_checks), form)}
    if fields:
        made["field"] = lambda form: torque_speed([leading(fields)], form)
    if each := alone(fields):
        made["fields"] = lambda form: torque_speed_panels(each, form)
    if does.known:
        made |= {"efficiency": does.efficiency, "demand": does.demand}
    if does.hottest:
        made["heat"] = does.temperatures
    if does.energy.known:
        made["energy"] = does.flow
    if does.permitted:
        made["permitted"] = does.speeds
    if does.followed:
        made["followed"] = does.course
    budget = best.energy
    if budget and is_known(budget):
        made["battery"] = lambda form: battery(budget, form)
    return made


def loop_drawings(validation: Validation) -> dict[str, Drawing]:
    """The figures of a closed loop; one without records of its loops has no ``bode`` and no ``step``."""
    made: dict[str, Drawing] = {}
    linear = validation.linear
    if linear:
        made["diagram"] = lambda form: block_diagram(validation, linear, form)
    made["closed_loop"] = lambda form: figures.closed_loop(validation, form)
    if validation.loops:
        made["bode"] = lambda form: bode(validation.loops, form)
        made["step"] = lambda form: step(validation.loops, form)
    return made


def _trade_off(result: SizingResult, form: Form) -> bytes:
    across, up = ([objective_figure(s, name) for s in result.front] for name in result.pareto[:2])
    x, y = ([float(from_si(f.value, f.unit, f.kind)) if isfinite(f.value) else nan for f in column]
            for column in (across, up))  # fmt: skip
    heads = [f"{column[0].title} ({label(column[0].unit)})" for column in (across, up)]
    return trade_off([str(s.rank) for s in result.front], [s.label for s in result.front], x, y, heads, form)


# -- Figures as files: a drawing and a picture of each.


def figures_into(made: Mapping[str, Drawing], folder: Path) -> list[Path]:
    """Draw into a folder; see :func:`drivesizer.output.report.write_figures`."""
    paths = {(name, form): folder / f"{name}.{form}" for name in made for form in FILES}
    _ready(folder, list(paths.values()))
    files = {path: made[name](form) for (name, form), path in paths.items()}
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be made ({reason_of(error)})") from None
    return write_files(files)


def _ready(folder: Path, paths: list[Path]) -> None:
    """Refuse a folder that cannot be one, and what stands in the way in it, before time is spent on the content."""
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: is a file; expected a folder for the figures")
    if folder.is_dir():
        for path in paths:
            ready(path)
    elif not folder.parent.is_dir():
        raise InputError(f"{folder}: cannot be made, there is no folder {folder.parent}")
