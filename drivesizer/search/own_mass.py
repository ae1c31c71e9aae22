"""A machine as heavy as its own drive makes it."""

from __future__ import annotations

from drivesizer.catalog import Catalog
from drivesizer.load_cases.platform_wheels import on_wheels
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.machine.budgets import drive_mass, mass_without_drive
from drivesizer.machine.mass_budget import settle
from drivesizer.search import pulleys
from drivesizer.search.machine_filter import best_in_machine
from drivesizer.search.ranking import Ranking
from drivesizer.spec.robot import RobotSpec

__all__ = ["at_its_own_mass"]

_SAME = 1e-9  # kg: of sets out of a catalogue one is found again, or another is heavier
_ITERATED = frozenset({"mass_sized_for"})  # holds once the rounds have settled, and not before


def at_its_own_mass(spec: RobotSpec, catalog: Catalog, objective: Ranking) -> tuple[RobotSpec, tuple[str, ...]]:
    """The spec with the mass at which its drive carries itself, and how that was found; where the spec asks for it."""
    load = spec.load
    if spec.budget is None or not spec.budget.drive_counts or not isinstance(load, WheeledVehicle):
        return spec, ()

    def weighing(mass: float) -> RobotSpec:
        return spec.model_copy(update={"load": load.model_copy(update={"mass": mass})})

    def sized(mass: float) -> tuple[float, str] | None:
        robot = pulleys.with_pulleys(on_wheels(weighing(mass)), catalog)
        best = best_in_machine(robot, catalog, objective, _ITERATED)
        return (drive_mass(best, load.motors), best.label) if best else None

    settled = settle(sized, mass_without_drive(spec, catalog), tolerance=_SAME)
    mass = settled.total if settled.carries_itself else settled.steps[-1].total
    return weighing(mass), (f"the drive's own mass counts, as far as it is known: {settled.words}",)
