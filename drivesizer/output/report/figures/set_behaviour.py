"""A drive over the load cycles of a machine, for figures and tables; each part is computed once, when it is used."""

from __future__ import annotations

from functools import cached_property
from math import fsum, isfinite, isnan, sqrt

from drivesizer.control.path_following import Followed, follow_runs
from drivesizer.control.path_following import drawn as shown_runs
from drivesizer.errors import InputError
from drivesizer.load_cases.platform import Driving, WheelLoad, driving, with_trajectory
from drivesizer.loads.motions import Track, Waypoints
from drivesizer.machine.platform_budget import PermittedSpeeds, permitted_speeds
from drivesizer.machine.set_cycle import SetCycle, WarmUp, set_cycle, warm_up
from drivesizer.machine.supply_power import EnergyFlow, energy_flow
from drivesizer.output.report.figures import cycle, machine
from drivesizer.output.report.figures.cycle import MOST_WHEELS
from drivesizer.output.report.figures.field import efficiency_map
from drivesizer.output.report.figures.picture import Pictured, on_paper
from drivesizer.output.words import first_wheel
from drivesizer.physics.stepper import copper_loss, idle_loss
from drivesizer.physics.thermal import current_derating, rated_ambient
from drivesizer.results.check import Figure
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.problem import Problem
from drivesizer.results.ratings import controller_current
from drivesizer.spec.mounting import rise_left
from drivesizer.units import show

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
        loads = [(found, found.spec.load) for _, found in self.cycles]
        wheels = [(found, load) for found, load in loads if isinstance(load, WheelLoad)]
        flows = [(load.alike / load.motors, energy_flow(found)) for found, load in wheels if load.of == wheels[0][1].of]
        parts = zip(*([share * part for part in flow] for share, flow in flows), strict=True)
        return EnergyFlow(*map(fsum, parts))

    @cached_property
    def known(self) -> bool:
        """Whether the motor's current is, in all that is drawn."""
        return all(found.known for _, found in self.cycles[:MOST_WHEELS])

    @cached_property
    def hottest(self) -> tuple[str, WarmUp] | None:
        """The load case in which the winding gets warmest, and how; None where its course is unknown."""
        known = []
        for name, found in self.cycles:
            warm = warm_up(found) if found.known else None
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
        given = machine.platform.model_fields_set if machine.platform else ()
        if "following" not in given or not isinstance(machine.motion, Track | Waypoints):
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
        made: dict[str, Pictured] = {}
        usable = float(self.spec.feed_of(self.drive_set.controller).usable)
        if self.known:  # the efficiency map has all load cycles, or the first where they would cover one another
            shown = self.cycles if len(self.cycles) <= cycle.TOGETHER else self.cycles[:1]
            voltage = usable if isfinite(usable) else self.spec.supply.lowest
            made["efficiency"] = Pictured(efficiency_map(shown, voltage))
            plot = cycle.demand(self.cycles, self._currents, [("usable", usable)])
            each = cycle.each_over_time if len(self.cycles) > cycle.TOGETHER else on_paper
            made["demand"] = Pictured(each(plot), [plot])
        if self.hottest:
            name, found = self.hottest
            ambient = next(case.spec for case in self.problem.cases if case.name == name).environment.ambient
            permitted = self.drive_set.motor.max_winding_temperature
            made["heat"] = Pictured(cycle.temperatures(found, ambient, permitted))
        if self.energy.known:
            made["energy"] = Pictured(cycle.energy_bars(self.energy))
        if self.permitted:
            made["permitted"] = Pictured(machine.speed_by_direction(self.permitted))
        if self.followed:
            made["followed"] = Pictured(machine.path_and_errors(shown_runs(self.followed)))
        return made

    @property
    def _currents(self) -> list[tuple[str, float]]:
        """Limits of the current in the case as specified [A]."""
        motor, controller, environment = self.drive_set.motor, self.drive_set.controller, self.spec.environment
        derated = motor.nominal_current * current_derating(
            environment.ambient, motor.max_winding_temperature, rated_ambient(motor)
        )
        left = rise_left(environment)
        currents = [("motor, nominal", float(derated) * sqrt(left))]
        if controller:
            lasting = float(controller_current(controller, environment.ambient))
            currents += [("controller, continuous", lasting * left), ("controller, peak", controller.peak_current)]
        return currents

    # -- texts

    @property
    def cost(self) -> str:
        """Energy that the cycle costs the supply."""
        net = self.energy.net
        return "unknown" if isnan(net) else show(net, "J", "energy")

    @property
    def heat(self) -> list[Figure]:
        """Losses and temperatures of the case as specified."""
        found, motor = self.specified, self.drive_set.motor
        copper = float(found.figures.copper[0]) if found.known else float("nan")
        if self.drive_set.steps:
            cycle, idle = found.cycle.load_cycle, found.spec.control.idle_current
            copper = copper_loss(motor.nominal_current, motor.resistance)
            copper *= float(idle_loss(cycle.speed, idle) @ cycle.duration) / cycle.total
        winding = found.winding if found.known else float("nan")
        housing = winding - motor.thermal_resistance_winding * copper
        rows = [
            ("Copper loss, mean", copper, "W", "power"),
            ("Friction and iron loss, mean", float(found.heat.mean[0]), "W", "power"),
            ("Thermal resistance, winding to housing", motor.thermal_resistance_winding, "K/W", "thermal_resistance"),
            ("Thermal resistance, housing to ambient", motor.thermal_resistance_housing, "K/W", "thermal_resistance"),
            ("Ambient", found.spec.environment.ambient, "degC", "temperature"),
            ("Housing in periodic steady state, mean", housing, "degC", "temperature"),
            ("Winding in periodic steady state, mean", winding, "degC", "temperature"),
            ("Winding, permitted", motor.max_winding_temperature, "degC", "temperature"),
        ]
        return [Figure(name="_".join(title.lower().replace(",", "").split()), title=title, value=value, kind=kind,
                       unit=unit)
                for title, value, unit, kind in rows]  # fmt: skip

    @property
    def heat_lacks(self) -> str:
        """Reason why the course of the temperatures is not known."""
        lacks = [name.replace("_", " ") for name in _BODIES if isnan(getattr(self.drive_set.motor, name))]
        if lacks:
            return f"{', '.join(lacks)} of the motor not known"
        return "thermal runaway of the motor" if self.known else "the motor's current is not known"
