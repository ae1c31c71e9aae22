"""The sizing problem of a machine whose mass includes that of its own drive, or whose screw is left open."""

from __future__ import annotations

from drivesizer.catalog import Catalog
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.machine.budgets import drive_mass, mass_without_drive
from drivesizer.machine.mass_budget import settle
from drivesizer.machine.problem import problem
from drivesizer.results.problem import Problem
from drivesizer.results.screws import wants_screw
from drivesizer.search.machine_filter import best_in_machine
from drivesizer.search.order.ranking import Ranking
from drivesizer.spec.robot import RobotSpec

__all__ = ["depends_on_ranking", "problem_with_drive_mass"]

_SAME = 1e-9  # kg: of drives out of a catalogue one is found again, or another is heavier
_ITERATED = frozenset({"mass_sized_for"})  # holds once the rounds have settled, and not before


def depends_on_ranking(spec: RobotSpec) -> bool:
    """Whether the problem of a machine hangs on what ranks drives: by its own drive's mass, or a screw left open."""
    counts = spec.budget is not None and spec.budget.drive_counts and isinstance(spec.load, WheeledVehicle)
    return counts or wants_screw(spec)


def problem_with_drive_mass(spec: RobotSpec, catalog: Catalog, objective: Ranking) -> tuple[Problem, tuple[str, ...]]:
    """The sizing problem of a machine, with the mass of its drive or the screw that the spec leaves to the search."""
    load = spec.load
    if wants_screw(spec):
        from drivesizer.search.screw_choice import problem_with_screw

        return problem_with_screw(spec, catalog, objective)
    if not depends_on_ranking(spec) or not isinstance(load, WheeledVehicle):
        return problem(spec, catalog), ()

    def weighing(mass: float) -> RobotSpec:
        return spec.model_copy(update={"load": load.model_copy(update={"mass": mass})})

    def sized(mass: float) -> tuple[float, str] | None:
        heavy = problem(weighing(mass), catalog)
        best = best_in_machine(heavy, objective, _ITERATED)
        return (drive_mass(heavy, best), best.label) if best else None

    settled = settle(sized, mass_without_drive(spec, catalog), tolerance=_SAME)
    mass = settled.total if settled.carries_itself else settled.steps[-1].total
    return problem(weighing(mass), catalog), (f"the drive's own mass counts, as far as it is known: {settled.words}",)
