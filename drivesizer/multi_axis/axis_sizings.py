"""Sizings of the axes of a machine with drives of some masses on them, joints as axes, and what all draw together."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import fsum, inf, isnan, nan
from typing import Any, NamedTuple

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.errors import FieldError, InputError, nearest, quoted
from drivesizer.joints.mass_columns import JointTorques, joint_torques
from drivesizer.machine.battery import pack_of
from drivesizer.machine.braking import with_parts_of_supply
from drivesizer.machine.budgets import riding_mass, riding_rows, rows_of_drive
from drivesizer.machine.mass_budget import of_drives, of_supply, price_check, settle
from drivesizer.machine.platform_budget import machine_mass, mass_checks
from drivesizer.multi_axis.combinations import Choice, Cost, Loaded, OfferedKinds
from drivesizer.multi_axis.common_bus import moving_alone, waiting_times
from drivesizer.multi_axis.common_supply import AxisPower, common_supply, shared_sections
from drivesizer.results.check import Check, worst_of_cases
from drivesizer.results.check_columns import at_most
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.machine import SUMMED, AxisSizing, MachinePower, objective_sum
from drivesizer.results.problem import Problem
from drivesizer.results.sizing import SizingResult, unknown_parts
from drivesizer.search.ranking import Progress
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.sizing import size
from drivesizer.spec.drive import OBJECTIVES, Ranking
from drivesizer.spec.machine import MachineSpec, carrying, joint_axis, sizing_order, with_common_bus
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.robot_section import DrivePlace, RobotSection
from drivesizer.units import show

__all__ = [
    "AxisSizings", "Options", "PartsOf", "SamplingOf", "TorquesOf", "as_chosen", "budget_checks", "carried_mass",
    "choices_of", "machine_power", "over_tolerances", "with_choppers", "with_joints",
]  # fmt: skip


# -- A machine that was sized, on its supply.


class _OnSupply(NamedTuple):
    """Sections that axes on one supply share, where its parts are listed, and these axes with their drives."""

    shared: RobotSpec
    catalog: Catalog
    axes: list[AxisPower]


def machine_power(machine: MachineSpec, axes: Sequence[AxisSizing]) -> MachinePower | None:
    """Power of the best drives of all axes on the machine's supply."""
    found = _supplied_axes(machine, axes)
    if found is None:
        return None
    try:
        power = common_supply(*found, synchronised=machine.synchronised, cycle_time=machine.cycle_time)
    except FieldError as error:
        raise InputError(f"{machine.where(error.field)}: {error}") from None
    on_it = [one for one in axes if not machine.axis(one.name).own_supply]
    return replace(power, checks=(*power.checks, *_motor_voltage(power, found.shared, on_it)))


def over_tolerances(
    machine: MachineSpec, axes: Sequence[AxisSizing], power: MachinePower, how: Sampling
) -> MachinePower:
    """The same with the probability that no limit of the supply is exceeded, over all uncertain figures."""
    found = _supplied_axes(machine, axes)
    if found is None or power.unknown:
        said = "limits of the supply are judged at nominal figures: power over tolerances is unknown"
        return replace(power, assumptions=(*power.assumptions, said))
    from drivesizer.multi_axis.sampled_supply import with_samples  # where nothing is sampled it need not load

    return with_samples(machine, *found, power, how)


def _supplied_axes(machine: MachineSpec, axes: Sequence[AxisSizing]) -> _OnSupply | None:
    """The axes on the machine's supply; None of a single axis, and where one of them has no drive."""
    on_it = [one for one in axes if not machine.axis(one.name).own_supply]
    if _alone(machine) or not on_it or any(one.best is None for one in on_it):
        return None
    found = [
        AxisPower(one.name, moving_alone(one.result.problem), one.best, axis.start, axis.repeats)
        for one, axis in ((one, machine.axis(one.name)) for one in on_it)
        if one.best
    ]
    shared = shared_sections(machine, [one.spec for one in on_it])
    return _OnSupply(shared, _listing(machine, [one.result.problem.catalog for one in on_it]), found)


def _motor_voltage(power: MachinePower, shared: RobotSpec, on_it: Sequence[AxisSizing]) -> tuple[Check, ...]:
    """Voltage of the motors while the supply's resistance carries the current of all axes, of the tightest axis.

    Its own current counts twice, in the demand of its own check and in the sum: what passes is certain, and what does
    not is unknown.
    """
    ohm, lowest = shared.supply.resistance, shared.supply.lowest
    if not ohm or len(on_it) == 1:
        return ()
    drop, found = ohm * power.peak / lowest, []
    for one in on_it:
        own = next((check for check in one.best.checks if check.name == "supply_voltage"), None) if one.best else None
        if own is not None:
            limit = own.limit - drop
            certain = own.demand * (1.0 + own.needed) <= limit
            said = f"of {one.name}" if certain else f"of {one.name}: unknown while all axes draw: give supply.min"
            column = at_most("supply_voltage", own.demand, limit if certain else nan, needed=own.needed, note=said)
            found.append(("", (column.at((), "budget"),)))
    return worst_of_cases(found)


def budget_checks(machine: MachineSpec, axes: Sequence[AxisSizing], power: MachinePower | None) -> tuple[Check, ...]:
    """Mass and price of all axes against the machine's budget."""
    budget, drives = machine.budget, [(one.result.problem, one.best) for one in axes if one.best]
    if budget is None or _alone(machine) or len(drives) < len(axes):
        return ()
    catalog, found = _listing(machine, [problem.catalog for problem, _ in drives]), list[Check]()
    if budget.weighs:
        battery = pack_of(machine.battery, catalog).mass if machine.battery else None
        rows = [row for problem, one in drives for row in rows_of_drive(problem, one)]
        found += mass_checks(machine_mass(budget, rows, battery=battery))
    if budget.price is not None:
        resistor = power.braking.resistor if power and power.braking else None
        items = [item for problem, one in drives for item in of_drives(problem, one)]
        found.append(price_check([*items, *of_supply(machine.supply.part, resistor, catalog)], budget.price))
    return tuple(found)


def with_choppers(machine: MachineSpec, catalog_of: Callable[[RobotSpec], Catalog]) -> MachineSpec:
    """The machine on a bus that rises to the lowest voltage of the choppers among which its spec leaves the choice."""
    section, on_it = machine.brake_resistor, [one.spec for one in machine.axes if not one.own_supply]
    if section is None or section.chopper_voltage is not None or _alone(machine) or not on_it:
        return machine
    catalog = _listing(machine, [catalog_of(spec) for spec in on_it])
    resistor = with_parts_of_supply(shared_sections(machine, on_it), catalog).brake_resistor
    return replace(machine, axes=tuple(with_common_bus(one, resistor) for one in machine.axes))


def _alone(machine: MachineSpec) -> bool:
    """Whether the only axis has the sections of the machine as its own."""
    return len(machine.axes) == 1 and machine.robot is None


def _listing(machine: MachineSpec, catalogs: Sequence[Catalog]) -> Catalog:
    """The catalogues of the axis that lists power supply and battery, or brake resistors; else those of the first."""
    battery = machine.battery.part if machine.battery else None

    def listed(catalog: Catalog) -> int:
        named = machine.supply.part in catalog.power_supplies.rows, battery in catalog.batteries.rows
        return 2 * sum(named) + (len(catalog.brake_resistors) > 0)

    return max(catalogs, key=listed)


# -- Joints of a robot description as axes of its machine, their loads linear in the masses of the drives on them.


TorquesOf = Callable[[RobotSection, str, float], JointTorques]
_ROUNDING = 1e-9  # of the largest torque
_WORTH_SAYING = 0.005  # of it


@dataclass(frozen=True, slots=True)
class Joints:
    """Torques of the joints of a machine; none where it has no robot."""

    torques: JointTorques | None

    @property
    def notes(self) -> tuple[str, ...]:
        """Assumptions on the joints, as sentences."""
        return self.torques.notes if self.torques else ()

    def has(self, axis: str) -> bool:
        """Whether an axis is a joint."""
        return self.torques is not None and axis in self.torques.joints

    def moves_its_drive(self, axis: str) -> bool:
        """Whether an axis is a joint whose drive is on a link that it moves."""
        return self.torques is not None and axis in self.torques.carried.get(axis, ())

    def laden(self, spec: RobotSpec, joint: str, masses: Mapping[str, float]) -> RobotSpec:
        """The spec of a joint with drives of these masses on it, payloads and poses as load cases."""
        assert self.torques is not None
        loads = [self.torques.load(joint, masses, case) for case in range(len(self.torques.cases))]
        made = spec.changed(lambda one: one.model_copy(update={"load": loads[0]}))
        further = ((case.name, load) for case, load in zip(self.torques.cases[1:], loads[1:], strict=True))
        return made.with_cases((name, made.alone(load=load)) for name, load in further)

    def notes_on(self, drives: Mapping[str, tuple[DriveSet, float]]) -> Iterator[str]:
        """Sentences on what the chosen drives of joints mean to the robot."""
        for joint in self.torques.joints if self.torques else ():
            yield from self._heavier(joint, drives)
            yield from self._spun(joint, drives)

    def _heavier(self, joint: str, drives: Mapping[str, tuple[DriveSet, float]]) -> Iterator[str]:
        """A drive heavier than the link whose mass is said to hold it."""
        assert self.torques is not None
        robot, section = self.torques.robot, self.torques.section
        place, mass = section.drives.get(joint, DrivePlace()), drives[joint][1] if joint in drives else 0.0
        link = robot.links[place.link or robot.joints[joint].parent]
        carried = place.on != "base" and any(one.name in self.torques.joints for one in robot.chain(link.name))
        if section.masses == "with_drives" and carried and mass > link.mass:
            found = f"{show(mass, 'kg', 'mass')}, is heavier than its link {link.name}, {show(link.mass, 'kg', 'mass')}"
            yield f"the drive of {joint}, {found}, which is said to hold it (robot.masses)"

    def _spun(self, joint: str, drives: Mapping[str, tuple[DriveSet, float]]) -> Iterator[str]:
        """The most that rotors of drives beyond a joint add to its torque."""
        assert self.torques is not None
        quickest = np.abs(self.torques.cases[0].motion.acceleration).max(axis=(0, 1))
        spun = fsum(
            drives[one][0].total_ratio * drives[one][0].motor.rotor_inertia * quickest[n]
            for n, one in enumerate(self.torques.joints)
            if one in drives and self._moves(joint, one)
        )
        largest = float(np.abs(self.torques.load(joint, {}).cycle.torque).max())
        if self.torques.robot.joints[joint].turns and spun > _WORTH_SAYING * largest:
            share = show(spun / largest, "%", "dimensionless", 2)
            yield (
                f"{joint}: rotors of drives beyond it add {show(spun, 'N*m', 'torque', 2)} at most, were their "
                f"axes parallel to its own ({share} of its peak torque), which is left out"
            )

    def _moves(self, joint: str, other: str) -> bool:
        """Whether a joint moves the link before another one."""
        assert self.torques is not None
        robot = self.torques.robot
        return any(one.name == joint for one in robot.chain(robot.joints[other].parent))

    def rises(self, joint: str, masses: Mapping[str, float]) -> bool:
        """Whether more mass of the drives on a joint nowhere lessens its torque."""
        assert self.torques is not None
        for case in range(len(self.torques.cases)):
            own = self.torques.load(joint, masses, case).cycle
            for other in masses:
                more = self.torques.load(joint, {**masses, other: masses[other] + 1.0}, case).cycle
                if len(more.duration) != len(own.duration):  # cut elsewhere: it changes sign at another time
                    return False
                against = (more.torque - own.torque) * np.sign(own.torque)
                if (against < -_ROUNDING * np.abs(own.torque).max()).any():
                    return False
        return True


def with_joints(machine: MachineSpec, torques_of: TorquesOf = joint_torques) -> tuple[MachineSpec, Joints]:
    """A machine with the joints of its robot among its axes."""
    if machine.robot is None:
        return machine, Joints(None)
    try:
        torques = torques_of(machine.robot, machine.file, machine.environment.gravity)
    except FieldError as error:
        raise InputError(f"{machine.where(error.field)}: {error}") from None
    lost = next((axis.name for axis in machine.axes if axis.is_joint and axis.name not in torques.joints), None)
    if lost is not None:
        text = (
            f"no joint {quoted(lost)} moves{nearest(lost, torques.joints)}; expected one that does, or load and motion"
        )
        raise InputError(f"{machine.where(('axes', lost))}: {text}")
    others_on = {name: [one for one in torques.carried[name] if one != name] for name in torques.joints}
    joints = tuple(joint_axis(machine, name, others_on[name]) for name in torques.joints)
    others = tuple(axis for axis in machine.axes if not axis.is_joint)
    return sizing_order(replace(machine, axes=(*joints, *others))), Joints(torques)


# -- Sizings of the axes of a machine with drives of some masses on them, and the drives that count for other axes.


_THRIFTY = ("energy", "peak_current")  # objectives by which drives load a supply least
_FEW = 3
_SAME = 1e-9  # kg: of drives out of a catalogue one is the same again, or another is heavier
SamplingOf = Callable[[RobotSpec], Sampling | None]
PartsOf = Callable[[RobotSpec], Catalog]


class Options(NamedTuple):
    """Options of the sizing of all axes."""

    top: int
    objective: Ranking | None
    pareto: tuple[str, ...]
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
        spec = spec.with_select(spec.select.ranked_by(self.ranking))
        return Loaded(spec, self._parts(spec), self.how.sampling(spec))

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
            return self.how.pareto
        return tuple(dict.fromkeys((*self.how.pareto, objective, "mass")))

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
