"""All figures of a report by name, each drawn when it is asked for."""

from __future__ import annotations

from collections.abc import Callable

import drivesizer.report.figures as figures
from drivesizer.loads import load_cycle
from drivesizer.objectives import objective_figure
from drivesizer.report.field_figure import torque_speed
from drivesizer.report.loop_curves import bode, step
from drivesizer.report.operating import panels
from drivesizer.report.style import Form
from drivesizer.results import SizingResult, Validation
from drivesizer.units import from_si, label

__all__ = ["Drawing", "loop_drawings", "report_drawings"]

Drawing = Callable[[Form], bytes]


def report_drawings(result: SizingResult, validation: Validation | None) -> dict[str, Drawing]:
    """Every figure of a report, in the order in which it shows them."""
    best = next(iter((*result.sets, *result.misses)), None)
    cycles = [(name, load_cycle(case)) for name, case in result.spec.load_cases]
    fields = panels(result.spec, best, result.requirements) if best else []
    made: dict[str, Drawing] = {
        "profile": lambda form: figures.speed_profile(result.spec, form),
        "cycle": lambda form: figures.load_over_time(cycles, form),
    }
    if fields:
        made["field"] = lambda form: torque_speed(fields, form)
    if len(result.front) > 1:
        made["front"] = lambda form: _trade_off(result, form)
    if validation:
        made |= {"loop" if name == "closed_loop" else name: draw for name, draw in loop_drawings(validation).items()}
    return made


def loop_drawings(validation: Validation) -> dict[str, Drawing]:
    """The figures of a closed loop; one without records of its loops has no ``bode`` and no ``step``."""
    made: dict[str, Drawing] = {"closed_loop": lambda form: figures.closed_loop(validation, form)}
    if validation.loops:
        made["bode"] = lambda form: bode(validation.loops, form)
        made["step"] = lambda form: step(validation.loops, form)
    return made


def _trade_off(result: SizingResult, form: Form) -> bytes:
    across, up = ([objective_figure(s, name) for s in result.front] for name in result.pareto[:2])
    x, y = ([float(from_si(f.value, f.unit, f.kind)) for f in column] for column in (across, up))
    heads = [f"{column[0].title} ({label(column[0].unit)})" for column in (across, up)]
    return figures.trade_off([str(s.rank) for s in result.front], x, y, heads, form)
