"""All figures of a report by name, for paper and page, each drawn on demand; and as files: a drawing and a picture.

What a drive does over the load cycles of a machine, for figures and tables, is computed once, when it is used.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from math import fsum, isnan
from pathlib import Path

from drivesizer.control.path_following import Followed, follow_runs
from drivesizer.control.path_following import runs_of_figure as shown_runs
from drivesizer.control.validation import Validation
from drivesizer.errors import InputError, reason_of
from drivesizer.files.writing import ready, write_files
from drivesizer.load_cases.platform import Driving, WheelLoad, driving, with_trajectory
from drivesizer.loads.motions import Track, Waypoints
from drivesizer.machine.platform_budget import PermittedSpeeds, permitted_speeds
from drivesizer.machine.set_cycle import SetCycle, WarmUp, set_cycle, warm_up
from drivesizer.machine.supply_power import EnergyFlow, energy_flow
from drivesizer.output.report.figures import choice, cycle, field, loops, machine
from drivesizer.output.report.figures.picture import Bars, Pictured, Plot, abreast, barred, on_paper, pictured, scatter
from drivesizer.output.report.figures.style import CASES, FILES, Drawing, Ready
from drivesizer.output.sketch import SKETCHES, sketch
from drivesizer.output.words import first_wheel, reported
from drivesizer.physics.stepper import copper_loss, idle_loss
from drivesizer.results.check import Figure, figures_of
from drivesizer.results.check_kinds import sorted_by_part
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.problem import Problem
from drivesizer.results.ratings import continuous_currents
from drivesizer.results.sizing import SizingResult
from drivesizer.units import show

# -- A drive over the load cycles of a machine.


_BODIES = ("winding_time_constant", "motor_time_constant", "thermal_resistance_winding", "thermal_resistance_housing",
           "resistance")  # fmt: skip


class Behaviour:
    """A drive over the load cycles of a machine."""

    def __init__(self, problem: Problem, drive_set: DriveSet) -> None:
        self.problem, self.spec, self.drive_set = problem, problem.spec, drive_set

    @cached_property
    def cycles(self) -> list[tuple[str, SetCycle]]:
        """The drive over each load case, by name."""
        return [(case.name, set_cycle(case.spec, self.drive_set, case.at_belt)) for case in self.problem.cases]

    @property
    def specified(self) -> SetCycle:
        """The drive over the cycle as specified."""
        return self.cycles[0][1]

    @cached_property
    def energy(self) -> EnergyFlow:
        """The energy balance of the cycle as specified; of a platform on a path the sum over its wheels.

        That is over those of its first load case, each as often as there are wheels alike.
        """
        if not first_wheel(self.problem):
            return energy_flow(self.specified)
        loads = [(case, case.spec.load) for _, case in self.cycles]
        wheels = [(case, load) for case, load in loads if isinstance(load, WheelLoad)]
        flows = [(load.alike / load.motors, energy_flow(case)) for case, load in wheels if load.of == wheels[0][1].of]
        parts = zip(*([share * part for part in flow] for share, flow in flows), strict=True)
        return EnergyFlow(*map(fsum, parts))

    @cached_property
    def known(self) -> bool:
        """Whether the motor's current is, in all that is drawn."""
        return all(case.known for _, case in self.cycles[: cycle.MOST_WHEELS])

    @cached_property
    def hottest(self) -> tuple[str, WarmUp] | None:
        """The load case in which the winding gets warmest, and how; None where its course is unknown."""
        known = []
        for name, case in self.cycles:
            warm = warm_up(case) if case.known else None
            if warm is None:
                return None
            known.append((name, warm))
        return max(known, key=lambda pair: pair[1].peak)

    @cached_property
    def permitted(self) -> PermittedSpeeds | None:
        """Speeds that the drive permits a platform in each direction; None of another machine."""
        machine = self.problem.machine
        return permitted_speeds(machine, self.drive_set) if machine.platform else None

    @cached_property
    def path(self) -> Driving | None:
        """The platform on its path, where the spec has that followed."""
        machine = self.problem.machine
        fields = machine.platform.model_fields_set if machine.platform else ()
        if "following" not in fields or not isinstance(machine.motion, Track | Waypoints):
            return None
        return driving(with_trajectory(machine, None))

    @cached_property
    def followed(self) -> dict[str, Followed]:
        """Simulated path following, by name of the run; none where ``not_followed``."""
        self.not_followed = ""
        try:
            return follow_runs(self.path, self.drive_set) if self.path else {}
        except InputError as error:
            self.not_followed = str(error)
            return {}

    # -- figures

    def pictures(self) -> dict[str, Pictured]:
        """Its figures by name; those that depend on figures that the catalogue does not know are left out."""
        pictures: dict[str, Pictured] = {}
        feed = self.spec.feed_of(self.drive_set.controller)
        if self.known:  # the efficiency map has all load cycles, or the first where they would cover one another
            cycles = self.cycles if len(self.cycles) <= cycle.TOGETHER else self.cycles[:1]
            pictures["efficiency"] = Pictured(field.efficiency_map(cycles, feed.applied))
            plot = cycle.demand(self.cycles, self._currents, [("usable", float(feed.usable))])
            layout = cycle.each_over_time if len(self.cycles) > cycle.TOGETHER else on_paper
            pictures["demand"] = Pictured(layout(plot), [plot])
        if self.hottest:
            name, warming = self.hottest
            ambient = next(case.spec for case in self.problem.cases if case.name == name).environment.ambient
            permitted = self.drive_set.motor.max_winding_temperature
            plots = cycle.temperatures(warming, ambient, permitted)
            pictures["heat"] = Pictured(abreast(plots, 1.21, names=4), plots)
        if self.energy.known:
            pictures["energy"] = pictured(cycle.energy_bars(self.energy))
        if self.permitted:
            pictures["permitted"] = Pictured(machine.speed_by_direction(self.permitted))
        if self.followed:
            pictures["followed"] = Pictured(machine.path_and_errors(shown_runs(self.followed)))
        return pictures

    @property
    def _currents(self) -> list[tuple[str, float]]:
        """Limits of the current in the case as specified [A]."""
        controller = self.drive_set.controller
        motor, lasting = continuous_currents(self.drive_set.motor, controller, self.spec.environment)
        own = [("controller, continuous", lasting), ("controller, peak", controller.peak_current)] if controller else []
        return [("motor, nominal", motor), *own]

    # -- texts

    @property
    def cost(self) -> str:
        """Energy that the cycle costs the supply."""
        net = self.energy.net
        return "unknown" if isnan(net) else show(net, "J", "energy")

    @property
    def heat(self) -> tuple[Figure, ...]:
        """Losses and temperatures of the case as specified."""
        case, motor = self.specified, self.drive_set.motor
        copper = float(case.figures.copper[0]) if case.known else float("nan")
        if self.drive_set.steps:
            motion, idle = case.cycle.load_cycle, case.spec.control.idle_current
            copper = copper_loss(motor.nominal_current, motor.resistance)
            copper *= float(idle_loss(motion.speed, idle) @ motion.duration) / motion.total
        winding = case.winding if case.known else float("nan")
        housing = winding - motor.thermal_resistance_winding * copper
        return figures_of("heat", {
            "copper_loss_mean": copper, "friction_and_iron_loss_mean": case.heat.mean[0],
            "thermal_resistance_winding_to_housing": motor.thermal_resistance_winding,
            "thermal_resistance_housing_to_ambient": motor.thermal_resistance_housing,
            "ambient": case.spec.environment.ambient, "housing_in_periodic_steady_state_mean": housing,
            "winding_in_periodic_steady_state_mean": winding, "winding_permitted": motor.max_winding_temperature,
        })  # fmt: skip

    @property
    def heat_lacks(self) -> str:
        """Reason why the course of the temperatures is not known."""
        lacks = [name.replace("_", " ") for name in _BODIES if isnan(getattr(self.drive_set.motor, name))]
        if lacks:
            return f"{', '.join(lacks)} of the motor not known"
        return "thermal runaway of the motor" if self.known else "the motor's current is not known"


# -- All figures of a report.


_MOST_PANELS = 6  # of the motor's field that can be moved


def report_pictures(
    result: SizingResult, validation: Validation | None, does: Behaviour | None = None
) -> dict[str, Pictured]:
    """Every figure of a report, in the order in which it shows them."""
    best, certain = result.reported, reported(result)
    cycles = [(case.name, case.cycle) for case in result.problem.cases]
    pictures: dict[str, Pictured] = {}
    load = result.spec.entered.get("load")
    if isinstance(load, dict) and load.get("kind") in SKETCHES:
        pictures["sketch"] = Pictured(Ready(sketch(load["kind"], load)))
    if machine.ways_of(result.spec):
        pictures["way"] = Pictured(machine.plan_view(result.spec))
    pictures["profile"] = Pictured(cycle.speed_profile(result.spec), [cycle.motion(result.spec)])
    plot = cycle.load(cycles)
    wheels = first_wheel(result.problem)
    first = plot if wheels or len(cycles) <= len(CASES) else cycle.load(cycles[: len(CASES)])
    pictures["cycle"] = Pictured(cycle.each_over_time(first) if wheels else on_paper(first), [plot])
    if front := choice.trade_off(result):
        pictures["front"] = Pictured(scatter(front), [front])
    if certain and certain.reliability and choice.swings(certain.reliability.drivers):
        pictures["tornado"] = pictured(choice.tornado(certain.reliability.drivers))
    if best:
        pictures["margins"] = Pictured(barred(choice.margins(sorted_by_part(best.own_checks))))
        panels = field.panels(result.problem, best, result.requirements)
        if panels:
            plots = [field.torque_speed(panel) for panel in panels[:_MOST_PANELS]]
            plots = [
                plots[0],
                *(plot.titled(field.conditions(p)) for plot, p in zip(plots[1:], panels[1:], strict=False)),
            ]
            pictures["field"] = Pictured(on_paper(field.torque_speed(field.leading(panels))), plots[:1])
        if alone := field.alone(panels):
            pictures["fields"] = Pictured(field.torque_speed_panels(alone), plots[1:])
        pictures |= (does or Behaviour(result.problem, best)).pictures()
        if best.energy and machine.is_known(best.energy):
            pair: list[Plot | Bars] = [machine.consumers(best.energy), machine.charge(best.energy)]
            pictures["battery"] = Pictured(machine.battery(best.energy), pair)
    if validation:
        pictures |= {
            "loop" if name == "closed_loop" else name: picture for name, picture in loop_pictures(validation).items()
        }
    return pictures


def loop_pictures(validation: Validation) -> dict[str, Pictured]:
    """The figures of a closed loop; one without records of its loops has no ``bode`` and no ``step``."""
    pictures: dict[str, Pictured] = {}
    if validation.linear:
        pictures["diagram"] = Pictured(loops.block_diagram(validation, validation.linear))
    pictures["closed_loop"] = pictured(cycle.closed_loop(validation))
    if validation.loops:
        pictures["bode"] = pictured(loops.bode(validation.loops))
        steps = loops.steps(validation.loops)
        pictures["step"] = Pictured(abreast(steps, 0.76), [step for step in steps if step.diagrams[0].curves])
    return pictures


def report_drawings(result: SizingResult, validation: Validation | None) -> dict[str, Drawing]:
    """Every figure of a report as paper has it."""
    return on_sheets(report_pictures(result, validation))


def on_sheets(pictures: Mapping[str, Pictured]) -> dict[str, Drawing]:
    """Figures as paper has them."""
    return {name: picture.paper for name, picture in pictures.items() if picture.paper}


def figures_into(drawings: Mapping[str, Drawing], folder: Path) -> list[Path]:
    """Draw into a folder; see :func:`drivesizer.output.report.write_figures`.

    What stands in the way is refused before time is spent on the content.
    """
    paths = {(name, form): folder / f"{name}.{form}" for name, draw in drawings.items()
             for form in (FILES[:1] if isinstance(draw, Ready) else FILES)}  # fmt: skip
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: is a file; expected a folder for the figures")
    if folder.is_dir():
        for path in paths.values():
            ready(path)
    elif not folder.parent.is_dir():
        raise InputError(f"{folder}: cannot be made, there is no folder {folder.parent}")
    files = {path: drawings[name](form) for (name, form), path in paths.items()}
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be made ({reason_of(error)})") from None
    return write_files(files)
