"""All figures of a report by name, for paper and page, each drawn on demand; and as files: a drawing and a picture."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from drivesizer.control.validation import Validation
from drivesizer.errors import InputError, reason_of
from drivesizer.files.writing import ready, write_files
from drivesizer.output.report.figures import choice, cycle, field, loops, machine
from drivesizer.output.report.figures.picture import Bars, Pictured, Plot, on_paper, scatter
from drivesizer.output.report.figures.set_behaviour import Behaviour
from drivesizer.output.report.figures.style import CASES, FILES, Drawing, Ready
from drivesizer.output.sketch import SKETCHES, sketch
from drivesizer.output.words import first_wheel, reported
from drivesizer.results.check_kinds import sorted_by_part
from drivesizer.results.sizing import SizingResult

IN_TABLES = {"margins"}  # of the figures: what the PDF shows in its tables
_MOST_PANELS = 6  # of the motor's field that can be moved


def report_pictures(
    result: SizingResult, validation: Validation | None, does: Behaviour | None = None
) -> dict[str, Pictured]:
    """Every figure of a report, in the order in which it shows them."""
    best, certain = result.shown, reported(result)
    cycles = [(case.name, case.cycle) for case in result.problem.cases]
    made: dict[str, Pictured] = {}
    load = result.spec.entered.get("load")
    if isinstance(load, dict) and load.get("kind") in SKETCHES:
        made["sketch"] = Pictured(Ready(sketch(load["kind"], load)))
    if machine.ways_of(result.spec):
        made["way"] = Pictured(machine.plan_view(result.spec))
    made["profile"] = Pictured(cycle.speed_profile(result.spec), [cycle.motion(result.spec)])
    drawn = cycle.load(cycles)
    wheels = first_wheel(result.problem)
    first = drawn if wheels or len(cycles) <= len(CASES) else cycle.load(cycles[: len(CASES)])
    made["cycle"] = Pictured(cycle.each_over_time(first) if wheels else on_paper(first), [drawn])
    if front := choice.trade_off(result):
        made["front"] = Pictured(scatter(front), [front])
    if certain and certain.reliability and choice.swings(certain.reliability.drivers):
        made["tornado"] = Pictured(choice.tornado(certain.reliability.drivers))
    if best:
        made["margins"] = Pictured(choice.margins(sorted_by_part(best.own_checks)))
        panels = field.panels(result.problem, best, result.requirements)
        if panels:
            each = [field.torque_speed(panel) for panel in panels[:_MOST_PANELS]]
            each = [each[0], *(plot.titled(field.conditions(p)) for plot, p in zip(each[1:], panels[1:], strict=False))]
            made["field"] = Pictured(on_paper(field.torque_speed(field.leading(panels))), each[:1])
        if alone := field.alone(panels):
            made["fields"] = Pictured(field.torque_speed_panels(alone), each[1:])
        made |= (does or Behaviour(result.problem, best)).pictures()
        if best.energy and machine.is_known(best.energy):
            pair: list[Plot | Bars] = [machine.consumers(best.energy), machine.charge(best.energy)]
            made["battery"] = Pictured(machine.battery(best.energy), pair)
    if validation:
        made |= {"loop" if name == "closed_loop" else name: one for name, one in loop_pictures(validation).items()}
    return made


def loop_pictures(validation: Validation) -> dict[str, Pictured]:
    """The figures of a closed loop; one without records of its loops has no ``bode`` and no ``step``."""
    made: dict[str, Pictured] = {}
    if validation.linear:
        made["diagram"] = Pictured(loops.block_diagram(validation, validation.linear))
    course = cycle.closed_loop(validation)
    made["closed_loop"] = Pictured(on_paper(course), [course])
    if validation.loops:
        response = loops.bode(validation.loops)
        made["bode"] = Pictured(on_paper(response), [response])
        made["step"] = Pictured(loops.step(validation.loops), loops.answers(validation.loops))
    return made


def report_drawings(result: SizingResult, validation: Validation | None) -> dict[str, Drawing]:
    """Every figure of a report as paper has it."""
    return on_sheets(report_pictures(result, validation))


def on_sheets(pictures: Mapping[str, Pictured]) -> dict[str, Drawing]:
    """Figures as paper has them."""
    return {name: one.paper for name, one in pictures.items() if one.paper}


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
