"""All figures of a report by name, each drawn when it is asked for."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from math import isfinite, nan

import drivesizer.report.figures as figures
from drivesizer.choose import usable_in
from drivesizer.energy_flow import EnergyFlow, energy_flow
from drivesizer.loads import load_cycle
from drivesizer.objectives import objective_figure
from drivesizer.report.demand_figure import current_and_voltage
from drivesizer.report.efficiency_figure import efficiency_field, efficiency_map
from drivesizer.report.energy_figure import energy_bars
from drivesizer.report.field_figure import torque_speed
from drivesizer.report.front_figure import trade_off
from drivesizer.report.heat_figure import temperatures
from drivesizer.report.loop_curves import bode, step
from drivesizer.report.margin_figure import margins
from drivesizer.report.motion_figure import speed_profile
from drivesizer.report.operating import panels
from drivesizer.report.style import CASES, Form
from drivesizer.results import DriveSet, SizingResult, Validation
from drivesizer.set_cycle import SetCycle, set_cycle, warming
from drivesizer.thermal import current_derating, two_bodies
from drivesizer.units import from_si, label
from drivesizer.warm_up import WarmUp, warm_up

__all__ = ["IN_TABLES", "Behaviour", "Drawing", "loop_drawings", "report_drawings"]

Drawing = Callable[[Form], bytes]
IN_TABLES = {"margins"}  # of the figures: what the PDF shows in its tables


class Behaviour:
    """What a set does over the cycles of a spec, computed when it is asked for."""

    def __init__(self, result: SizingResult, drive_set: DriveSet) -> None:
        self.result, self.drive_set = result, drive_set

    @cached_property
    def cycles(self) -> list[tuple[str, SetCycle]]:
        """The set over each load case, by name."""
        return [(name, set_cycle(case, self.drive_set)) for name, case in self.result.spec.load_cases]

    @cached_property
    def energy(self) -> EnergyFlow:
        """The account of the cycle as specified."""
        return energy_flow(self.cycles[0][1])

    @cached_property
    def known(self) -> bool:
        """Whether the motor's current is, in all that is drawn."""
        return all(found.known for _, found in self.cycles[: len(CASES)])

    @cached_property
    def hottest(self) -> tuple[str, WarmUp] | None:
        """The load case in which the winding gets warmest, and how; None where its course is unknown."""
        found = [(name, self._warm(cycle)) for name, cycle in self.cycles]
        known = [(name, one) for name, one in found if one is not None]
        return max(known, key=lambda pair: pair[1].periodic.winding_peak) if len(known) == len(found) else None

    def _warm(self, found: SetCycle) -> WarmUp | None:
        bodies = two_bodies({name: values[0] for name, values in found.motor.items()})
        return warm_up(bodies, found.spec.environment.ambient, warming(found)) if found.known else None

    def temperatures(self, form: Form) -> bytes:
        """The figure of them."""
        assert self.hottest is not None
        name, found = self.hottest
        ambient = dict(self.result.spec.load_cases)[name].environment.ambient
        return temperatures(found, ambient, self.drive_set.motor.max_winding_temperature, form)

    def demand(self, form: Form) -> bytes:
        """Current and voltage; limits are those of the case as specified."""
        motor, controller, spec = self.drive_set.motor, self.drive_set.controller, self.result.spec
        derated = motor.nominal_current * current_derating(spec.environment.ambient, motor.max_winding_temperature)
        currents = [("motor, nominal", float(derated))]
        if controller:
            currents += [("controller, continuous", controller.continuous_current)]
            currents += [("controller, peak", controller.peak_current)]
        return current_and_voltage(self.cycles, currents, [("usable", usable_in(spec, controller))], form)

    def efficiency(self, form: Form) -> bytes:
        """The efficiency map with the load cycles in it."""
        usable = usable_in(self.result.spec, self.drive_set.controller)
        voltage = usable if isfinite(usable) else self.result.spec.supply.lowest
        return efficiency_map(efficiency_field(self.cycles[: len(CASES)], voltage), form)


def report_drawings(result: SizingResult, validation: Validation | None) -> dict[str, Drawing]:
    """Every figure of a report, in the order in which it shows them.

    Parameters
    ----------
    result
        What the sizing found.
    validation
        The closed loop, where it was simulated.

    Returns
    -------
    dict
        By name what draws it: ``profile``, ``cycle``; of a set ``margins``, ``field``, ``efficiency``, ``demand``,
        ``heat`` and ``energy``, as far as its figures are known; ``front``; ``loop``, ``bode`` and ``step``.
    """
    best = next(iter((*result.sets, *result.misses)), None)
    cycles = [(name, load_cycle(case)) for name, case in result.spec.load_cases]
    made: dict[str, Drawing] = {
        "profile": lambda form: speed_profile(result.spec, form),
        "cycle": lambda form: figures.load_over_time(cycles, form),
    }
    if len(result.front) > 1:
        made["front"] = lambda form: _trade_off(result, form)
    if best:
        made |= _of_set(result, best)
    if validation:
        made |= {"loop" if name == "closed_loop" else name: draw for name, draw in loop_drawings(validation).items()}
    return made


def _of_set(result: SizingResult, best: DriveSet) -> dict[str, Drawing]:
    """The figures of a set: what hangs on figures that the catalogue does not know is left out."""
    does, fields = Behaviour(result, best), panels(result.spec, best, result.requirements)
    made: dict[str, Drawing] = {"margins": lambda form: margins((*best.checks, *best.beside), form)}
    if fields:
        made["field"] = lambda form: torque_speed(fields, form)
    if does.known:
        made |= {"efficiency": does.efficiency, "demand": does.demand}
    if does.hottest:
        made["heat"] = does.temperatures
    if does.energy.known:
        made["energy"] = lambda form: energy_bars(does.energy, form)
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
    x, y = ([float(from_si(f.value, f.unit, f.kind)) if isfinite(f.value) else nan for f in column]
            for column in (across, up))  # fmt: skip
    heads = [f"{column[0].title} ({label(column[0].unit)})" for column in (across, up)]
    return trade_off([str(s.rank) for s in result.front], [s.label for s in result.front], x, y, heads, form)
