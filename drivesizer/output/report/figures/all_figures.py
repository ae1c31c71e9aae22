"""All figures of a report by name, each drawn on demand, and as files: a drawing and a picture of each."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite, nan
from pathlib import Path

from drivesizer.control.validation import Validation
from drivesizer.errors import InputError, reason_of
from drivesizer.files.writing import ready, write_files
from drivesizer.output.report.figures import choice, cycle, field, loops, machine
from drivesizer.output.report.figures.set_behaviour import Behaviour
from drivesizer.output.report.figures.style import FILES, Drawing, Ready
from drivesizer.output.sketch import SKETCHES, sketch
from drivesizer.output.words import first_wheel, reported
from drivesizer.results.check_kinds import sorted_by_part
from drivesizer.results.sizing import SizingResult, objective_figure
from drivesizer.units import from_si, label

IN_TABLES = {"margins"}  # of the figures: what the PDF shows in its tables
STILL = (  # what the page shows as the PDF does
    "sketch", "way", "tornado", "fields", "efficiency", "demand", "heat", "energy", "permitted", "followed", "diagram",
)  # fmt: skip


def report_drawings(
    result: SizingResult, validation: Validation | None, does: Behaviour | None = None
) -> dict[str, Drawing]:
    """Every figure of a report, in the order in which it shows them."""
    best, certain = result.shown, reported(result)
    cycles = [(case.name, case.cycle) for case in result.problem.cases]
    made: dict[str, Drawing] = {}
    load = result.spec.entered.get("load")
    if isinstance(load, dict) and load.get("kind") in SKETCHES:
        made["sketch"] = Ready(sketch(load["kind"], load))
    if machine.ways_of(result.spec):
        made["way"] = machine.plan_view(result.spec)
    made["profile"] = cycle.speed_profile(result.spec)
    over_time = cycle.wheels_over_time if first_wheel(result.problem) else cycle.load_over_time
    made["cycle"] = over_time(cycles)
    if len(result.front) > 1:
        across, up = ([objective_figure(s, name) for s in result.front] for name in result.pareto[:2])
        x, y = ([float(from_si(f.value, f.unit, f.kind)) if isfinite(f.value) else nan for f in column]
                for column in (across, up))  # fmt: skip
        heads = [f"{column[0].title} ({label(column[0].unit)})" for column in (across, up)]
        ranks, names = [str(s.rank) for s in result.front], [s.label for s in result.front]
        made["front"] = choice.trade_off(ranks, names, x, y, heads)
    if certain and certain.reliability and choice.swings(certain.reliability.drivers):
        made["tornado"] = choice.tornado(certain.reliability.drivers)
    if best:
        made["margins"] = choice.margins(sorted_by_part(best.own_checks))
        panels = field.panels(result.problem, best, result.requirements)
        if panels:
            made["field"] = field.torque_speed([field.leading(panels)])
        if each := field.alone(panels):
            made["fields"] = field.torque_speed_panels(each)
        made |= (does or Behaviour(result.problem, best)).drawings()
        if best.energy and machine.is_known(best.energy):
            made["battery"] = machine.battery(best.energy)
    if validation:
        made |= {"loop" if name == "closed_loop" else name: draw for name, draw in loop_drawings(validation).items()}
    return made


def loop_drawings(validation: Validation) -> dict[str, Drawing]:
    """The figures of a closed loop; one without records of its loops has no ``bode`` and no ``step``."""
    made: dict[str, Drawing] = {}
    if validation.linear:
        made["diagram"] = loops.block_diagram(validation, validation.linear)
    made["closed_loop"] = cycle.closed_loop(validation)
    if validation.loops:
        made |= {"bode": loops.bode(validation.loops), "step": loops.step(validation.loops)}
    return made


def figures_into(made: Mapping[str, Drawing], folder: Path) -> list[Path]:
    """Draw into a folder; see :func:`drivesizer.output.report.write_figures`.

    What stands in the way is refused before time is spent on the content.
    """
    paths = {(name, form): folder / f"{name}.{form}" for name, draw in made.items()
             for form in (FILES[:1] if isinstance(draw, Ready) else FILES)}  # fmt: skip
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: is a file; expected a folder for the figures")
    if folder.is_dir():
        for path in paths.values():
            ready(path)
    elif not folder.parent.is_dir():
        raise InputError(f"{folder}: cannot be made, there is no folder {folder.parent}")
    files = {path: made[name](form) for (name, form), path in paths.items()}
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be made ({reason_of(error)})") from None
    return write_files(files)
