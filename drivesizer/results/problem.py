"""The sizing problem: a machine, its load cases with their load cycles, the belts for it, and the catalogues.

Made once, by ``machine.problem``, and passed on; nothing behind it changes the spec that a user wrote.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from drivesizer.catalog import Catalog
from drivesizer.catalog.belt_drive import BeltDrive
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.results.screws import ChosenScrew
from drivesizer.spec.robot import RobotSpec

__all__ = ["SHIFT", "BeltDrives", "LoadCase", "Problem"]

SHIFT = "whole shift"  # the load cases that alternate, as one


class BeltDrives(NamedTuple):
    """Belts and pulleys that the catalogues have for a machine."""

    drives: tuple[BeltDrive, ...]  # one for each ratio that is searched, by ratio
    ratios: int  # how many ratios the catalogues have


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoadCase:
    """A load case as it is sized: of a platform on a trajectory one wheel, or several with the same load cycle."""

    name: str  # empty where there is only one
    number: int  # of the machine's load case that it belongs to, from 0
    spec: RobotSpec  # the machine in this case; of a wheel with its load
    at_belt: CycleAtBelt  # its load cycle through a belt, whatever the ratio

    @property
    def cycle(self) -> LoadCycle:
        """The load cycle at the driven shaft of one motor."""
        cycle: LoadCycle = self.at_belt.load_cycle
        return cycle


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Problem:
    """A machine to size, and the catalogues to choose from."""

    machine: RobotSpec  # as written, of the mass that it is sized for
    catalog: Catalog
    cases: tuple[LoadCase, ...]  # at least one
    belts: BeltDrives | None  # None where the spec names its belt ratios, or has no belt
    screw: ChosenScrew | None = None  # where the spec leaves it to the catalogues

    @property
    def spec(self) -> RobotSpec:
        """The machine in its first load case; of a platform on a trajectory with the load of a wheel."""
        return self.cases[0].spec

    @property
    def machine_cases(self) -> list[list[int]]:
        """The load cases of the machine, each as the numbers of those of ``cases`` that act at the same time."""
        found: dict[int, list[int]] = {}
        for place, case in enumerate(self.cases):
            found.setdefault(case.number, []).append(place)
        return list(found.values())

    def name_of(self, numbers: list[int]) -> str:
        """Name of one of ``machine_cases``; cases that alternate are one."""
        number = self.cases[numbers[0]].number
        return SHIFT if self.machine.alternating and number == 0 else self.machine.load_cases[number][0]

    @property
    def supply(self) -> tuple[float, float]:
        """Lowest and highest voltage of the bus in all load cases [V]: of the supply, or while a chopper holds it."""
        supplies, chopper = [case.spec.supply for case in self.cases], self.spec.chopper_voltage or 0.0
        return min(s.lowest for s in supplies), max(chopper, *(s.highest for s in supplies))

    @property
    def belt_ratios(self) -> list[float]:
        """The belt ratios to search; 1 without a belt."""
        return [drive.ratio for drive in self.belts.drives] if self.belts else self.machine.belt_ratios

    def belt_drive(self, ratio: float) -> BeltDrive | None:
        """Belt and pulleys of a ratio, where they are out of the catalogues."""
        return next((drive for drive in self.belts.drives if drive.ratio == ratio), None) if self.belts else None

    def with_sections(self, **sections: Any) -> Problem:
        """The problem with other sections of the spec that no load cycle depends on, such as ``select``."""
        cases = (replace(case, spec=case.spec.model_copy(update=sections)) for case in self.cases)
        return replace(self, machine=self.machine.model_copy(update=sections), cases=tuple(cases))
