"""Sizings of the axes of a machine with drives of some masses on them, and the drives that count for other axes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from math import inf, isnan
from typing import Any, NamedTuple

from drivesizer.catalog import Catalog
from drivesizer.machine.budgets import riding_mass, riding_rows
from drivesizer.machine.mass_budget import settle
from drivesizer.multi_axis.combinations import Choice, Cost
from drivesizer.multi_axis.joint_axes import TorquesOf, with_joints
from drivesizer.multi_axis.machine_cycle import waiting_times
from drivesizer.multi_axis.machine_power import with_choppers
from drivesizer.multi_axis.offered_kinds import Loaded, OfferedKinds
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.machine import SUMMED, objective_sum
from drivesizer.results.objectives import unknown_parts
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import SizingResult
from drivesizer.search.order.ranking import Ranking
from drivesizer.search.order.sifting import Progress
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.select import OBJECTIVES
from drivesizer.spec.several_axes.carried import carrying
from drivesizer.spec.several_axes.machine import MachineSpec

__all__ = ["AxisSizings", "Options", "PartsOf", "SamplingOf", "as_chosen", "carried_mass", "choices_of"]

_THRIFTY = ("energy", "peak_current")  # objectives by which drives load a supply least
_FEW = 3
_SAME = 1e-9  # kg: of drives out of a catalogue one is the same again, or another is heavier
SamplingOf = Callable[[RobotSpec], Sampling | None]
PartsOf = Callable[[RobotSpec], Catalog]


class Options(NamedTuple):
    """Options of the sizing of all axes."""

    top: int
    objective: Ranking | None
    progress: Progress | None
    sampling: SamplingOf
    brief: bool
    parts: PartsOf
    torques: TorquesOf


class AxisSizings:
    """Sizings of the axes with drives of some masses on them, each made once."""

    def __init__(self, machine: MachineSpec, how: Options) -> None:
        self.machine, self.joints = with_joints(machine, how.torques)
        self.how, self.ranking = how, how.objective
        self.made: dict[tuple[str, tuple[float, ...]], SizingResult] = {}
        self.own: dict[tuple[str, tuple[float, ...]], float] = {}  # kg, of its drive on the link that a joint moves
        self.uncertain = set[str]()  # axes of which drives lighter than their own load has may have been left out
        self.kinds: OfferedKinds | None = None  # where common drives are preferred
        self.catalogs: dict[tuple[Any, ...], Catalog] = {}
        self.offered: dict[tuple[str, str], DriveSet] = {}  # by axis and label, drives beside the best
        self.machine = with_choppers(self.machine, self._parts)
        self.cycles = waiting_times(self.machine, lambda axis: self._with_masses(axis, None))

    def objective(self, axis: str) -> Ranking:
        """Objective of the ranking of an axis' drives."""
        own: Ranking = self.machine.axis(axis).spec.select.objective
        return self.ranking or own

    def result(self, axis: str, masses: tuple[float, ...]) -> SizingResult:
        """The sizing of an axis with carried drives of these masses [kg]."""
        if (axis, masses) not in self.made:
            own = self.joints.moves_its_drive(axis)
            self.made[axis, masses] = self._with_its_own(axis, masses) if own else self._in_full(axis, masses)
        return self.made[axis, masses]

    def _in_full(self, axis: str, masses: tuple[float, ...]) -> SizingResult:
        spec = self.laden(axis, masses)
        return size(
            spec, catalog=self._parts(spec), top=self.how.top, objective=self.ranking, pareto=self._front(axis),
            progress=self.how.progress, sampling=self.how.sampling(spec), brief=self.how.brief,
        )  # fmt: skip

    def _with_its_own(self, axis: str, masses: tuple[float, ...]) -> SizingResult:
        """The sizing of a joint that moves its own drive: in rounds, and of drives no heavier than its load has.

        Where the best drives run away or out, the lightest decide whether any carries itself: each round of these
        begins at a mass that no drive which carries itself is below.
        """
        found: dict[float, SizingResult] = {}

        def rounds(ranking: Ranking | None, own: float) -> tuple[float, str] | None:
            self.own[axis, masses] = own
            if ranking is None:
                result = found[own] = self._in_full(axis, masses)
            else:
                result = self._sized(self.laden(axis, masses), 1, ranking)
            return next(((riding_mass(result.problem, one), one.label) for one in result.sets[:1]), None)

        settled = settle(partial(rounds, None), 0.0, tolerance=_SAME)
        if not settled.carries_itself:
            settled = settle(partial(rounds, "mass"), 0.0, tolerance=_SAME)
        self.own[axis, masses] = own = settled.total if settled.carries_itself else settled.steps[-1].total
        spec, result = self.laden(axis, masses), found[own] if own in found else self._in_full(axis, masses)
        sets = self._fitting(axis, masses, result, result.sets)
        if not sets and settled.carries_itself:
            sets = [self._ranked(spec, one) for one in self._sized(spec, 1, "mass").sets]
        front, others = (self._fitting(axis, masses, result, some) for some in (result.front, result.alternatives))
        sets = [replace(one, rank=n) for n, one in enumerate(sets, 1)]
        result = replace(result, sets=tuple(sets), front=tuple(front), alternatives=tuple(others))
        first, last = (choices_of(one, self.objective(axis)) for one in (found[0.0], result))
        if [one.name for one in first] != [one.name for one in last]:
            self.uncertain.add(axis)
        return result

    def _fitting(
        self, axis: str, masses: tuple[float, ...], result: SizingResult, drives: Sequence[DriveSet]
    ) -> list[DriveSet]:
        """Drives of a sizing that are no heavier than a joint's load has of its own."""
        return [one for one in drives if self.fits(axis, masses, riding_mass(result.problem, one))]

    def fits(self, axis: str, masses: tuple[float, ...], mass: float) -> bool:
        """Whether a drive of this mass [kg] is no heavier than the axis' load has of its own drive, if any."""
        return mass <= self.own.get((axis, masses), inf) + _SAME

    def loaded(self, axis: str, masses: tuple[float, ...]) -> Loaded:
        """An axis with carried drives of these masses [kg], for a search of few kinds."""
        spec = self.laden(axis, masses)
        return Loaded(spec, self._parts(spec), str(self.objective(axis)), self.how.sampling(spec))

    def chosen(self, axis: str, masses: tuple[float, ...], label: str) -> SizingResult:
        """The sizing of an axis with the drive of a label as its first."""
        result = self.result(axis, masses)
        one = next((one for one in (*result.sets, *result.front) if one.label == label), None)
        if one is None and self.kinds is not None:
            problem, one = self.kinds.record(axis, masses, label)
            result = replace(result, problem=replace(problem, catalog=result.problem.catalog))
        if one is None:
            one = self._ranked(self.laden(axis, masses), self.offered[axis, label])
        return _first(result, one)

    def offers(self, axis: str, masses: tuple[float, ...], first: Choice) -> list[Choice]:
        """Drives that an axis may have, by cost: the one that was chosen, the next best, and those that draw least."""
        result, spec = self.result(axis, masses), self.laden(axis, masses)
        drives = {one.label: one for one in (*result.sets, *result.front, *result.alternatives)}
        for objective in _THRIFTY if spec.method == "physics" else ():
            for one in self._sized(spec, _FEW, objective).sets:
                if one.label not in drives:
                    drives[one.label] = self._ranked(spec, one)
        self.offered |= {(axis, label): one for label, one in drives.items()}
        ranking, motors = self.objective(axis), spec.load.motors
        others = [
            Choice(label, _cost(one, ranking, motors, False), carried_mass(result.problem, one)[0])
            for label, one in drives.items()
            if label != first.name
            and one.status == result.sets[0].status
            and self.fits(axis, masses, riding_mass(result.problem, one))
        ]
        return [first, *sorted(others, key=lambda one: (one.cost, one.mass))]

    def _ranked(self, spec: RobotSpec, one: DriveSet) -> DriveSet:
        """A drive by its parts as the axis' own objective ranks it; a LookupError where it does not pass."""
        found = self._sized(as_chosen(spec, one), _FEW, self.ranking).sets
        return next(iter(each for each in found if each.label == one.label), None) or found[0]

    def _sized(self, spec: RobotSpec, top: int, objective: Ranking | None) -> SizingResult:
        return size(
            spec, catalog=self._parts(spec), top=top, objective=objective, progress=self.how.progress, brief=True
        )

    def _front(self, axis: str) -> tuple[str, ...]:
        """Objectives whose front is wanted: cost and mass of drives that ride on others."""
        objective = self.objective(axis)
        rides = any(axis in self.machine.carried(other.name) for other in self.machine.axes)
        if not rides or not isinstance(objective, str) or objective not in SUMMED:
            return ()
        return tuple(dict.fromkeys((objective, "mass")))

    def _parts(self, spec: RobotSpec) -> Catalog:
        """The catalogues of an axis, those of the same choice once."""
        key = tuple(spec.select.catalogs), spec.select.motor.kind, spec.select.estimates
        if key not in self.catalogs:
            self.catalogs[key] = self.how.parts(spec)
        return self.catalogs[key]

    def laden(self, axis: str, masses: tuple[float, ...]) -> RobotSpec:
        """The spec of an axis in the machine's cycle, with carried drives of these masses [kg]."""
        if self.joints.moves_its_drive(axis) and (axis, masses) not in self.own:
            self.result(axis, masses)
        return self._with_masses(axis, masses).waiting(self.cycles.get(axis, {}))

    def _with_masses(self, axis: str, masses: tuple[float, ...] | None) -> RobotSpec:
        """The spec of an axis with its load, carried drives of these masses [kg] on it; of none without."""
        one, carried = self.machine.axis(axis), self.machine.carried(axis)
        masses = masses or (0.0,) * len(carried)
        if self.joints.has(axis):
            own = {axis: self.own.get((axis, masses), 0.0)} if self.joints.moves_its_drive(axis) else {}
            return self.joints.laden(one.spec, axis, dict(zip(carried, masses, strict=True)) | own)
        if not any(masses):
            return one.spec
        on_it = list(zip(masses, carried.values(), strict=True))
        return one.spec.changed(lambda spec: spec.model_copy(update={"load": carrying(spec.load, on_it)}))


def as_chosen(spec: RobotSpec, one: DriveSet) -> RobotSpec:
    """The spec with the choice of a drive that is not its own best, but that of the machine."""
    select = spec.select
    motor = select.motor.model_copy(update={"family": None, "part": [one.motor.part]})
    gearhead = select.gearhead
    if not one.actuator:
        gearhead = gearhead.model_copy(update={"family": None, "part": [one.gearhead.part]})
    select = select.model_copy(update={"motor": motor, "gearhead": gearhead})
    return spec.changed(lambda case: case.model_copy(update={"select": select}))


def _first(result: SizingResult, chosen: DriveSet) -> SizingResult:
    """The sizing with a drive as its first."""
    if result.sets[0].label == chosen.label:
        return result
    others = [one for one in result.sets if one.label != chosen.label][: len(result.sets) - 1]
    return replace(result, sets=tuple(replace(one, rank=n) for n, one in enumerate((chosen, *others), 1)))


def choices_of(result: SizingResult, objective: Ranking) -> list[Choice]:
    """Drives that count for others: the best, and those on the front of cost and mass that are as certain as it."""
    if not result.sets:
        return []
    best = result.sets[0]
    found = [one for one in result.front if one.status == best.status]
    drives = {one.label: one for one in [*found, best]}
    choices = [
        Choice(
            name,
            _cost(one, objective, result.spec.load.motors, one.label == best.label),
            carried_mass(result.problem, one)[0],
        )
        for name, one in drives.items()
    ]
    kept = [one for one in choices if not any(_beats(other, one) for other in choices)]
    return sorted(kept, key=lambda one: (one.cost, one.mass))


def _beats(one: Choice, other: Choice) -> bool:
    """Whether a drive is no worse in cost and mass, and better in one of them."""
    same = one.cost <= other.cost and one.mass <= other.mass
    return same and (one.cost < other.cost or one.mass < other.mass)


def _cost(one: DriveSet, objective: Ranking, motors: int, best: bool) -> Cost:
    """The objective of all drives of an axis; where it is no sum, the best one alone counts."""
    if not isinstance(objective, str) or objective not in SUMMED:
        return (0 if best else 1), 0.0
    value, summed = one.objective, OBJECTIVES[objective].over
    missing = len(unknown_parts(one, objective, one.objective_of)) if summed else int(isnan(value))
    return missing, 0.0 if isnan(value) else objective_sum(objective, one, motors)


def carried_mass(problem: Problem, one: DriveSet) -> tuple[float, tuple[str, ...]]:
    """Mass of an axis' drives that ride on another, and parts of unknown mass."""
    return riding_mass(problem, one), tuple(row.name for row in riding_rows(problem, one) if isnan(row.each))
