"""The sizing problem: a machine, its load cases with their load cycles, belts and screws out of the catalogues."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isnan, nan
from typing import TYPE_CHECKING, Any, NamedTuple

from drivesizer.catalog import Catalog
from drivesizer.catalog.parts import BeltDrive, Screw
from drivesizer.loads import MODULES
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.physics.screw import shaft_mass
from drivesizer.results.check import Figure
from drivesizer.spec.drive import Ranking
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

if TYPE_CHECKING:
    from drivesizer.loads.screw import Screw as ScrewLoad


# -- A screw out of a catalogue in the machine that it moves.


_DESIGNS = {"THK": "THK", "HIWIN": "HIWIN", "Bosch Rexroth": "Rexroth"}  # makers that print factors of their own
_RATINGS = (
    "diameter", "root_diameter", "ball_diameter", "pitch_diameter", "shaft_diameter", "dynamic_load", "static_load",
    "permissible_thrust", "dn_max",
)  # fmt: skip

# ratings without which a check is unknown, by kind of screw; the others it need not have
_CHECKED = {"ball": ("dynamic_load", "static_load", "dn_max"), "": ("permissible_thrust", "dynamic_load")}


class TriedScrew(NamedTuple):
    """The smallest screw of a lead that holds, and the best drive for it."""

    lead: float  # m
    screw: str = ""  # empty where none holds
    mass: float = nan  # kg, of the screw
    drive: str = ""  # empty where none passes
    objective: Figure | None = None  # of that drive alone
    failed: str = ""  # the limit that most screws of this lead fail


@dataclass(frozen=True, slots=True, kw_only=True)
class ChosenScrew:
    """A nut with its shaft, as long as the machine needs."""

    screw: Screw  # its mass that of nut and shaft
    length: float  # m, of the shaft with its ends
    shaft_mass: float  # kg
    tried: tuple[TriedScrew, ...] = ()  # one of each lead

    @property
    def least_mass(self) -> float:
        """Mass of shaft and nut, as far as it is known [kg]."""
        return self.shaft_mass if isnan(self.screw.mass) else self.screw.mass

    @property
    def running(self) -> str:
        """Size of the screw in words, with the mass of the shaft where that of the nut is unknown."""
        size = " x ".join(show(x, "mm", "length") for x in (self.screw.diameter, self.screw.lead))
        shaft = f", shaft {show(self.shaft_mass, 'kg', 'mass')}" if isnan(self.screw.mass) else ""
        return f"{self.screw.kind} screw {size}, {show(self.length, 'mm', 'length')} long{shaft}"


def leaves_open(spec: RobotSpec) -> bool:
    """Whether the load of a spec is moved by a screw that has yet to be chosen."""
    load: Any = spec.load
    return MODULES[load.kind] == "screw" and load.lead is None


def wants_screw(spec: RobotSpec) -> bool:
    """Whether a load case leaves the screw to the catalogues."""
    return any(leaves_open(case) for _, case in spec.load_cases)


def chosen_of(spec: RobotSpec, screw: Screw) -> ChosenScrew:
    """A screw of a catalogue at the length that a spec needs."""
    load: Any = spec.load
    thick = screw.diameter if isnan(screw.shaft_diameter) else screw.shaft_diameter  # of a smooth one of its inertia
    shaft = float(shaft_mass(thick, load.overall))
    return ChosenScrew(screw=replace(screw, mass=shaft + screw.nut_mass), length=load.overall, shaft_mass=shaft)


def screw_figures(load: ScrewLoad, screw: Screw) -> dict[str, Any]:
    """Fields of a load that a screw of a catalogue gives."""
    checked = _CHECKED.get(screw.kind, _CHECKED[""])
    figures = {name: getattr(screw, name) for name in _RATINGS}
    fields = {name: value if name in checked else _known(value) for name, value in figures.items()}
    if load.thread_friction is None and load.efficiency is None:
        fields["efficiency"] = _known(screw.efficiency)
        fields["back_efficiency"] = load.back_efficiency or _known(screw.back_efficiency)
    design = load.design or _DESIGNS.get(screw.manufacturer)
    return fields | {"lead": screw.lead, "design": design}


def _known(value: float) -> float | None:
    return None if isnan(value) else value


def with_screw(spec: RobotSpec, screw: Screw) -> RobotSpec:
    """A spec with the screw of a catalogue in place of its choice, in all load cases."""

    def with_screw(case: RobotSpec) -> RobotSpec:
        load: Any = case.load
        if not leaves_open(case):
            return case
        return case.model_copy(update={"load": load.model_copy(update=screw_figures(load, screw))})

    return spec.changed(with_screw)


def for_drive(spec: RobotSpec, screw: ChosenScrew | None) -> RobotSpec:
    """A spec with the screw of a drive, where it leaves one open."""
    return with_screw(spec, screw.screw) if screw is not None and wants_screw(spec) else spec


# -- The sizing problem: a machine, its load cases with their load cycles, the belts for it, and the catalogues.
#
# Made once, by ``machine.problem``, and passed on; nothing behind it changes the spec that a user wrote.


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
        return self.at_belt.load_cycle


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Problem:
    """A machine to size, and the catalogues to choose from."""

    machine: RobotSpec  # as written, of the mass that it is sized for
    catalog: Catalog
    cases: tuple[LoadCase, ...]  # at least one
    belts: BeltDrives | None  # None where the spec names its belt ratios, or has no belt
    screw: ChosenScrew | None = None  # where the spec leaves it to the catalogues
    opposite: Catalog | None = None  # the other end of the bands of estimated figures, where the catalogue is at one

    @property
    def spec(self) -> RobotSpec:
        """The machine in its first load case; of a platform on a trajectory with the load of a wheel."""
        return self.cases[0].spec

    @property
    def segments(self) -> int:
        """Segments of the longest load cycle."""
        return max(len(case.at_belt.load_cycle.duration) for case in self.cases)

    @property
    def machine_cases(self) -> list[list[int]]:
        """The load cases of the machine, each as the numbers of those of ``cases`` that act at the same time."""
        numbers: dict[int, list[int]] = {}
        for place, case in enumerate(self.cases):
            numbers.setdefault(case.number, []).append(place)
        return list(numbers.values())

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

    def ranked_by(self, objective: Ranking) -> Problem:
        """The problem with another objective of the ranking."""
        select = self.spec.select.ranked_by(objective)
        return self if select is self.spec.select else self.with_sections(select=select)

    def with_sections(self, **sections: Any) -> Problem:
        """The problem with other sections of the spec that no load cycle depends on, such as ``select``."""
        cases = (replace(case, spec=case.spec.model_copy(update=sections)) for case in self.cases)
        return replace(self, machine=self.machine.model_copy(update=sections), cases=tuple(cases))
