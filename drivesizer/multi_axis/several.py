"""Several axes: sized from the outermost inward, each with the drives that ride on it, all of them on one supply."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import fsum, inf, isnan
from typing import Any, NamedTuple

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.errors import FieldError, InputError, nearest, quoted
from drivesizer.joints.mass_columns import JointTorques, joint_torques
from drivesizer.machine.budgets import riding_mass, riding_unknown, settle
from drivesizer.machine.common_bus import waiting_times
from drivesizer.machine.common_supply import budget_checks, machine_power, toleranced, with_choppers, without_effect
from drivesizer.multi_axis import combinations
from drivesizer.multi_axis.combinations import Choice, Combination, Cost, Loaded, Masses, OfferedKinds
from drivesizer.results.check import GRAVEST
from drivesizer.results.drive_set import Detail, DriveSet
from drivesizer.results.machine import SUMMED, AxisSizing, CarriedMass, MachineSizing, objective_sum
from drivesizer.results.sizing import SizingResult
from drivesizer.search.passing import Progress
from drivesizer.search.ranking import title_of
from drivesizer.search.shortlist import load_parts
from drivesizer.search.uncertainty.options import Sampling, sampling_of
from drivesizer.sizing import size
from drivesizer.spec.drive import OBJECTIVES, Ranking
from drivesizer.spec.machine import MachineSpec, carrying, joint_axis, sizing_order
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.robot_section import RobotSection
from drivesizer.units import show

TorquesOf = Callable[[RobotSection, str, float], JointTorques]
SamplingOf = Callable[[RobotSpec], Sampling | None]
PartsOf = Callable[[RobotSpec], Catalog]
_THRIFTY = ("energy", "peak_current")  # objectives by which drives load a supply least
_FEW = 3
_SAME = 1e-9  # kg: of drives out of a catalogue one is the same again, or another is heavier
_ROUNDING = 1e-9  # of the largest torque
_WORTH_SAYING = 0.005  # of it


def with_joints(machine: MachineSpec, torques_of: TorquesOf = joint_torques) -> tuple[MachineSpec, JointTorques | None]:
    """A machine with the joints of its robot among its axes, and their torques; None where it has no robot."""
    if machine.robot is None:
        return machine, None
    try:
        torques = torques_of(machine.robot, machine.file, machine.environment.gravity)
    except FieldError as error:
        raise InputError(f"{machine.where(error.field)}: {error}") from None
    lost = next((axis.name for axis in machine.axes if axis.is_joint and axis.name not in torques.joints), None)
    if lost is not None:
        expected = f"{nearest(lost, torques.joints)}; expected one that does, or load and motion"
        raise InputError(f"{machine.where(('axes', lost))}: no joint {quoted(lost)} moves{expected}")
    others_on = {name: [axis for axis in torques.carried[name] if axis != name] for name in torques.joints}
    joints = tuple(joint_axis(machine, name, others_on[name]) for name in torques.joints)
    others = tuple(axis for axis in machine.axes if not axis.is_joint)
    return sizing_order(replace(machine, axes=(*joints, *others))), torques


def rises(torques: JointTorques, joint: str, masses: Mapping[str, float]) -> bool:
    """Whether more mass of the drives on a joint nowhere lessens its torque."""
    for case in range(len(torques.cases)):
        own = torques.load(joint, masses, case).cycle
        for other in masses:
            more = torques.load(joint, {**masses, other: masses[other] + 1.0}, case).cycle
            if len(more.duration) != len(own.duration):  # cut elsewhere: it changes sign at another time
                return False
            against = (more.torque - own.torque) * np.sign(own.torque)
            if (against < -_ROUNDING * np.abs(own.torque).max()).any():
                return False
    return True


def joint_notes(
    torques: JointTorques, drives: Mapping[str, tuple[DriveSet, float]], beyond: Mapping[str, float]
) -> Iterator[str]:
    """Sentences on chosen drives: heavier than the link that is said to hold them; rotors beyond a joint.

    ``beyond``: mass of heavier ones with which the machine was sized [kg].
    """
    robot, masses = torques.robot, {name: mass for name, (_, mass) in drives.items() if name in torques.joints}
    quickest = np.abs(torques.cases[0].motion.acceleration).max(axis=(0, 1))
    for joint in torques.joints:
        link, link_mass = torques.holding.get(joint, ("", inf))
        if joint in beyond:
            own, of_link = show(beyond[joint], "kg", "mass"), show(link_mass, "kg", "mass")
            whole = f"{own}, where the link, said to hold it, has {of_link} (robot.masses)"
            yield f"sized again with the drive of {joint} on link {link}: {whole}"
        if masses.get(joint, 0.0) > max(link_mass, beyond.get(joint, 0.0)) + _SAME:
            texts = show(masses[joint], "kg", "mass"), show(link_mass, "kg", "mass")
            heavier = f"{texts[0]}, is heavier than its link {link}, {texts[1]}"
            yield f"the drive of {joint}, {heavier}, which is said to hold it (robot.masses)"
        spun = fsum(
            drives[other][0].total_ratio * drives[other][0].motor.rotor_inertia * quickest[n]
            for n, other in enumerate(torques.joints)
            if other in drives and any(parent.name == joint for parent in robot.chain(robot.joints[other].parent))
        )
        largest = float(np.abs(torques.load(joint, masses).cycle.torque).max())
        if robot.joints[joint].turns and spun > _WORTH_SAYING * largest:
            share = show(spun / largest, "%", "dimensionless", 2)
            yield (
                f"{joint}: rotors of drives beyond it add {show(spun, 'N*m', 'torque', 2)} at most, were their "
                f"axes parallel to its own ({share} of its peak torque), which is left out"
            )


class Options(NamedTuple):
    """Options of the sizing of all axes."""

    top: int
    objective: Ranking | None
    pareto: tuple[str, ...]
    progress: Progress | None
    sampling: SamplingOf
    detail: Detail
    parts: PartsOf
    torques: TorquesOf


class AxisSizings:
    """Sizings of the axes with drives of some masses on them, each made once."""

    def __init__(self, machine: MachineSpec, how: Options, beyond: Mapping[str, float]) -> None:
        machine, self.torques = with_joints(machine, how.torques)
        self.beyond = beyond  # kg, of drives that are heavier than the links that are said to hold them
        self.how, self.ranking = how, how.objective
        self.price = machine.budget.price if machine.budget else None
        self.sizings: dict[tuple[str, Masses], SizingResult] = {}
        self.with_first: dict[tuple[str, Masses, str], SizingResult] = {}  # by the label of the drive
        self.own: dict[tuple[str, Masses], float] = {}  # kg, of its drive on the link that a joint moves
        self.uncertain = set[str]()  # axes of which drives lighter than their own load has may have been left out
        self.kinds: OfferedKinds | None = None  # where common drives are preferred
        self.catalogs: dict[tuple[Any, ...], Catalog] = {}
        self.offered: dict[tuple[str, str], DriveSet] = {}  # by axis and label, drives beside the best
        self.machine = with_choppers(machine, self._parts)
        self.carried = {axis.name: tuple(self.machine.carried(axis.name)) for axis in self.machine.axes}
        self.cycles = waiting_times(
            self.machine, lambda axis: self._with_masses(axis, (0.0,) * len(self.carried[axis]))
        )

    def objective(self, axis: str) -> Ranking:
        """Objective of the ranking of an axis' drives."""
        own: Ranking = self.machine.axis(axis).spec.select.objective
        return self.ranking or own

    def moves_its_drive(self, axis: str) -> bool:
        """Whether an axis is a joint whose drive is on a link that it moves."""
        return self.torques is not None and axis in self.torques.carried.get(axis, ())

    def masses(self, axis: str, choices: Mapping[str, Choice]) -> Masses:
        """Masses of the drives on an axis [kg]; none of an axis without a drive."""
        return tuple(choices[other].mass if other in choices else 0.0 for other in self.carried[axis])

    def fits(self, axis: str, masses: Masses, mass: float) -> bool:
        """Whether a drive of this mass [kg] is no heavier than the axis' load has of its own drive, if any."""
        return mass <= self.own.get((axis, masses), inf) + _SAME

    def result(self, axis: str, masses: Masses) -> SizingResult:
        """The sizing of an axis with carried drives of these masses [kg]."""
        if (axis, masses) not in self.sizings:
            own = self.moves_its_drive(axis)
            self.sizings[axis, masses] = self._with_its_own(axis, masses) if own else self._in_full(axis, masses)
        return self.sizings[axis, masses]

    def _in_full(self, axis: str, masses: Masses) -> SizingResult:
        spec, objective, front = self.laden(axis, masses), self.objective(axis), self.how.pareto
        rides = any(axis in carried for carried in self.carried.values())
        if rides and isinstance(objective, str) and objective in SUMMED:  # what counts for others: cost and mass
            front = tuple(dict.fromkeys((*front, objective, "mass")))
        return size(
            spec, catalog=self._parts(spec), top=self.how.top, objective=self.ranking, pareto=front,
            progress=self.how.progress, sampling=self.how.sampling(spec), detail=self.how.detail,
        )  # fmt: skip

    def _with_its_own(self, axis: str, masses: Masses) -> SizingResult:
        """The sizing of a joint that moves its own drive: in rounds, and of drives no heavier than its load has.

        Where the best drives run away or out, the lightest decide whether any carries itself: each round of these
        begins at a mass that no drive which carries itself is below.
        """
        results: dict[float, SizingResult] = {}

        def rounds(ranking: Ranking | None, own: float) -> float | None:
            self.own[axis, masses] = own
            if ranking is None:
                result = results[own] = self._in_full(axis, masses)
            else:
                result = self._sized(self.laden(axis, masses), 1, ranking)
            return next((riding_mass(result.problem, drive) for drive in result.sets[:1]), None)

        def fitting(drives: Sequence[DriveSet]) -> tuple[DriveSet, ...]:
            return tuple(drive for drive in drives if self.fits(axis, masses, riding_mass(result.problem, drive)))

        settled = settle(partial(rounds, None), 0.0, tolerance=_SAME)
        if not settled.carries_itself:
            settled = settle(partial(rounds, "mass"), 0.0, tolerance=_SAME)
        self.own[axis, masses] = own = settled.total
        spec, result = self.laden(axis, masses), results[own] if own in results else self._in_full(axis, masses)
        sets = fitting(result.sets)
        if not sets and settled.carries_itself:
            sets = tuple(self._ranked(spec, drive) for drive in self._sized(spec, 1, "mass").sets)
        sets = tuple(replace(drive, rank=n) for n, drive in enumerate(sets, 1))
        front, others = fitting(result.front), fitting(result.alternatives)
        result = replace(result, sets=sets, front=front, alternatives=others)
        first, last = (choices_of(sizing, self.objective(axis)) for sizing in (results[0.0], result))
        if [choice.name for choice in first] != [choice.name for choice in last]:
            self.uncertain.add(axis)
        return result

    def loaded(self, axis: str, masses: Masses) -> Loaded:
        """An axis with carried drives of these masses [kg], for a search of few kinds."""
        spec = self.laden(axis, masses)
        spec = spec.with_select(spec.select.ranked_by(self.ranking))
        return Loaded(spec, self._parts(spec), self.how.sampling(spec))

    def with_drive(self, axis: str, masses: Masses, label: str) -> SizingResult:
        """The sizing of an axis with the drive of a label as its first, made once."""
        if (axis, masses, label) not in self.with_first:
            self.with_first[axis, masses, label] = self._with_first(axis, masses, label)
        return self.with_first[axis, masses, label]

    def _with_first(self, axis: str, masses: Masses, label: str) -> SizingResult:
        result = self.result(axis, masses)
        drive = next((drive for drive in (*result.sets, *result.front) if drive.label == label), None)
        if drive is None and self.kinds is not None:
            problem, drive = self.kinds.record(axis, masses, label)
            result = replace(result, problem=replace(problem, catalog=result.problem.catalog))
        if drive is None:
            drive = self._ranked(self.laden(axis, masses), self.offered[axis, label])
        if result.sets[0].label == label:
            return result
        others = [drive for drive in result.sets if drive.label != label][: len(result.sets) - 1]
        return replace(result, sets=tuple(replace(drive, rank=n) for n, drive in enumerate((drive, *others), 1)))

    def offers(self, axis: str, masses: Masses, first: Choice) -> list[Choice]:
        """Drives that an axis may have, by cost: the one that was chosen, the next best, and those that draw least."""
        result, spec = self.result(axis, masses), self.laden(axis, masses)
        drives = {drive.label: drive for drive in (*result.sets, *result.front, *result.alternatives)}
        for objective in _THRIFTY if spec.method == "physics" else ():
            for drive in self._sized(spec, _FEW, objective).sets:
                if drive.label not in drives:
                    drives[drive.label] = self._ranked(spec, drive)
        self.offered |= {(axis, label): drive for label, drive in drives.items()}
        ranking, motors = self.objective(axis), spec.load.motors
        others = []
        for label, drive in drives.items():
            mass = riding_mass(result.problem, drive)
            alike = label != first.name and drive.status == result.sets[0].status
            if alike and self.fits(axis, masses, mass):
                others.append(Choice(label, _cost(drive, ranking, motors, best=False), mass))
        return [first, *sorted(others, key=lambda choice: (choice.cost, choice.mass))]

    def _ranked(self, spec: RobotSpec, drive: DriveSet) -> DriveSet:
        """A drive by its parts as the axis' own objective ranks it; a LookupError where it does not pass."""
        sets = self._sized(as_chosen(spec, drive), _FEW, self.ranking).sets
        return next((other for other in sets if other.label == drive.label), None) or sets[0]

    def _sized(self, spec: RobotSpec, top: int, objective: Ranking | None) -> SizingResult:
        return size(
            spec, catalog=self._parts(spec), top=top, objective=objective, progress=self.how.progress, detail="drives"
        )

    def _parts(self, spec: RobotSpec) -> Catalog:
        """The catalogues of an axis, those of the same choice once."""
        spec = spec.in_machine(self.price)
        if spec.parts_key not in self.catalogs:
            self.catalogs[spec.parts_key] = self.how.parts(spec)
        return self.catalogs[spec.parts_key]

    def laden(self, axis: str, masses: Masses) -> RobotSpec:
        """The spec of an axis in the machine's cycle, with carried drives of these masses [kg]."""
        if self.moves_its_drive(axis) and (axis, masses) not in self.own:
            self.result(axis, masses)
        return self._with_masses(axis, masses).waiting(self.cycles.get(axis, {}))

    def _with_masses(self, axis: str, masses: Masses) -> RobotSpec:
        """The spec of an axis with carried drives of these masses [kg] in its load; of a joint payloads as cases."""
        spec, torques = self.machine.axis(axis).spec, self.torques
        if torques is not None and axis in torques.joints:
            on_it = {**self.beyond, **dict(zip(self.carried[axis], masses, strict=True))}
            if self.moves_its_drive(axis):
                on_it[axis] = self.own.get((axis, masses), 0.0)
            loads = [torques.load(axis, on_it, case) for case in range(len(torques.cases))]
            loaded = spec.changed(lambda case: case.model_copy(update={"load": loads[0]}))
            further = zip(torques.cases[1:], loads[1:], strict=True)
            return loaded.with_cases((case.name, loaded.alone(load=load)) for case, load in further)
        if not any(masses):
            return spec
        at = list(zip(masses, self.machine.carried(axis).values(), strict=True))
        return spec.changed(lambda case: case.model_copy(update={"load": carrying(case.load, at)}))


def as_chosen(spec: RobotSpec, drive: DriveSet) -> RobotSpec:
    """The spec with the choice of a drive that is not its own best, but that of the machine."""
    select = spec.select
    motor = select.motor.model_copy(update={"family": None, "part": [drive.motor.part]})
    gearhead = select.gearhead
    if not drive.actuator:
        gearhead = gearhead.model_copy(update={"family": None, "part": [drive.gearhead.part]})
    select = select.model_copy(update={"motor": motor, "gearhead": gearhead})
    return spec.changed(lambda case: case.model_copy(update={"select": select}))


def choices_of(result: SizingResult, objective: Ranking) -> list[Choice]:
    """Drives that count for others: the best, and those on the front of cost and mass that are as certain as it."""
    if not result.sets:
        return []
    best, motors = result.sets[0], result.spec.load.motors
    drives = {drive.label: drive for drive in [*(drive for drive in result.front if drive.status == best.status), best]}
    choices = [
        Choice(name, _cost(drive, objective, motors, best=name == best.label), riding_mass(result.problem, drive))
        for name, drive in drives.items()
    ]

    def beaten(choice: Choice) -> bool:
        """Whether a drive is no worse in cost and mass, and better in one of them."""
        return any(
            other.cost <= choice.cost
            and other.mass <= choice.mass
            and (other.cost < choice.cost or other.mass < choice.mass)
            for other in choices
        )

    return sorted((choice for choice in choices if not beaten(choice)), key=lambda choice: (choice.cost, choice.mass))


def _cost(drive: DriveSet, objective: Ranking, motors: int, *, best: bool) -> Cost:
    """The objective of all drives of an axis; where it is no sum, the best one alone counts."""
    if not isinstance(objective, str) or objective not in SUMMED:
        return (0 if best else 1), 0.0
    value, summed = drive.objective, OBJECTIVES[objective].over
    missing = len(drive.unknown_parts(objective, drive.objective_of)) if summed else int(isnan(value))
    return missing, 0.0 if isnan(value) else objective_sum(objective, value, motors)


_PER_AXIS = 3  # sizings of each axis at most, on the average
_ROUNDS = 5  # with drives that are heavier than the links that are said to hold them
_MOST_COMBINATIONS = 60  # combinations that are tried where the best of all axes break a limit


def sized(machine: MachineSpec, how: Options) -> MachineSizing:
    """Size all axes of a machine of several; where one has no drive, those that it would carry are still sized.

    Drives that are heavier than the links that are said to hold them count on these, in rounds until none is heavier.
    """
    beyond = dict[str, float]()
    for _ in range(_ROUNDS):
        sizings = AxisSizings(machine, how, beyond)
        sizing = _once(sizings)
        masses = {axis.name: riding_mass(axis.result.problem, axis.best) for axis in sizing.axes if axis.best}
        more = sizings.torques.beyond_links(masses) if sizings.torques else {}
        heavier = {name: masses[name] for name, kg in more.items() if kg > 0.0 and masses[name] > beyond.get(name, 0.0)}
        if not heavier:
            break
        beyond = beyond | heavier
    return _over_tolerances(sizing, how.sampling)


def _once(sizings: AxisSizings) -> MachineSizing:
    """All axes of a machine, with the drives that are heavier than their links as they were before."""
    machine = sizings.machine

    def choices(axis: str, masses: tuple[float, ...]) -> list[Choice]:
        return choices_of(sizings.result(axis, masses), sizings.objective(axis))

    if machine.whole:
        combination = combinations.best_combination(
            machine.order, sizings.carried, choices, _PER_AXIS * len(machine.axes)
        )
    else:
        combination = combinations.axis_by_axis(machine.order, sizings.carried, choices)
    best = _machine_with_drives(sizings, combination)
    if machine.few_kinds is not None and not combination.missing:
        best = _with_few_kinds(sizings, combination, best, machine.few_kinds)
    elif best.complete:
        best = _within_limits(sizings, combination, best)
    return best


def laden(machine: MachineSpec, axis: str) -> RobotSpec:
    """The spec of one axis with the drives that ride on it."""
    how = Options(5, None, (), None, sampling_of, "full", load_parts, joint_torques)
    alone = machine.robot is None and not machine.axis(axis).carries
    rides = any(axis in machine.carried(other.name) for other in machine.axes)
    if alone and not rides and machine.few_kinds is None:
        return AxisSizings(machine, how, {}).laden(axis, ())
    sizing = sized(machine, how).axis(axis)
    return as_chosen(sizing.spec, sizing.best) if sizing.for_all and sizing.best else sizing.spec


def _machine_with_drives(sizings: AxisSizings, combination: Combination) -> MachineSizing:
    """The machine with the drives of a combination."""
    machine = sizings.machine
    axes = tuple(_axis(sizings, combination, axis.name) for axis in machine.axes)
    power = machine_power(machine, axes)
    return MachineSizing(
        machine=machine,
        axes=axes,
        objective=", ".join(dict.fromkeys(title_of(sizings.objective(axis.name)) for axis in machine.axes)),
        searches=len(sizings.sizings),
        certain=combination.certain and all(_bounded(sizings, axis.name, combination) for axis in machine.axes),
        notes=tuple(_notes(sizings, axes, combination)),
        checks=(*(power.checks if power else ()), *budget_checks(machine, axes, power)),
        power=power,
    )


def _axis(sizings: AxisSizings, combination: Combination, name: str) -> AxisSizing:
    """An axis with the drive that was chosen for the whole as its best, and those that ride on it."""

    def with_drive(axis: str) -> SizingResult | None:
        masses = sizings.masses(axis, combination.choices)
        return sizings.with_drive(axis, masses, combination.choices[axis].name) if axis in combination.choices else None

    masses, distances = sizings.masses(name, combination.choices), sizings.machine.carried(name)
    own = sizings.result(name, masses)
    result = with_drive(name) or own
    riding = []
    for other, mass in zip(sizings.carried[name], masses, strict=True):
        drive = with_drive(other)
        lacking = riding_unknown(drive.problem, drive.sets[0]) if drive else ()
        riding.append(CarriedMass(other, mass, distances[other], lacking))
    if name in combination.choices and (name, masses) in sizings.own:
        lacking = riding_unknown(result.problem, result.sets[0])
        riding.append(CarriedMass(name, sizings.own[name, masses], None, lacking))
    for_all = bool(result.sets and own.sets) and result.sets[0].label != own.sets[0].label
    return AxisSizing(name=name, result=result, carried=tuple(riding), for_all=for_all)


def _bounded(sizings: AxisSizings, axis: str, combination: Combination) -> bool:
    """Whether the sum that is least is that of the objective, and more mass on the axis never lightens its load."""
    objective, load, torques = sizings.objective(axis), sizings.machine.axis(axis).spec.load, sizings.torques
    if not isinstance(objective, str) or objective not in SUMMED:
        return False
    carried = sizings.carried[axis]
    if torques is not None and axis in torques.joints and not combination.missing:
        own = (axis,) if sizings.moves_its_drive(axis) else ()
        masses = {other: combination.choices[other].mass for other in (*carried, *own)}
        return rises(torques, axis, masses) and axis not in sizings.uncertain
    return not carried or not (getattr(load, "counterweight", 0.0) > 0.0 or getattr(load, "springs", ()))


def _notes(sizings: AxisSizings, axes: Sequence[AxisSizing], combination: Combination) -> Iterator[str]:
    """Choice of the drives, as sentences."""
    if combination.missing:
        with_ = "with the drives that were tried" if sizings.uncertain else "even with the lightest drives"
        yield f"{combination.missing}: no drive meets all limits, {with_} on it"
    for axis in axes:
        lacking = [f"{part} of {rider.of}" for rider in axis.carried for part in rider.lacking]
        if lacking:
            yield f"{axis.name} carries drives of which the mass of {', '.join(lacking)} is unknown: left out"
    yield from sizings.torques.notes if sizings.torques else ()
    for axis in axes:
        own = next((rider.mass for rider in axis.carried if rider.of == axis.name), None)
        if own is not None and axis.best:
            drive, loaded = riding_mass(axis.result.problem, axis.best), show(own, "kg", "mass")
            heavier = f"{loaded} of its load, of one that is heavier than its {show(drive, 'kg', 'mass')}"
            text = f"which is {loaded} of its load" if own <= drive * (1.0 + 1e-9) else heavier
            yield f"{axis.name} moves its own drive, {text}"
        elif any(mass > 0.0 for (name, _), mass in sizings.own.items() if name == axis.name):
            yield f"{axis.name} moves its own drive, and no drive carries itself"
    if sizings.torques:
        drives = {axis.name: axis.best for axis in axes if axis.best and axis.name in combination.choices}
        masses = {name: (drive_set, combination.choices[name].mass) for name, drive_set in drives.items()}
        yield from joint_notes(sizings.torques, masses, sizings.beyond)
    currencies = {axis.name: axis.result.catalog.currency for axis in axes}
    if len(set(currencies.values())) > 1 and any(axis.result.spec.counts_price for axis in axes):
        text = ", ".join(f"{name} in {code}" for name, code in currencies.items())
        yield f"prices are summed though {text}; expected select.rates, e.g. {{USD: ... EUR}}"
    until = {axis.name: axis.result.problem.machine.waits_until for axis in axes}
    waits = {name: end for name, end in until.items() if end is not None}
    if waits:
        cycle = show(next(iter(waits.values())), "s", "time")
        yield f"{', '.join(waits)}: at rest after the motion until the cycle of {cycle} is over; if not: repeats: true"


def _within_limits(sizings: AxisSizings, combination: Combination, best: MachineSizing) -> MachineSizing:
    """The machine with the drives that keep its own limits at the least cost, of those that are tried."""
    broken, choices = [check.title for check in best.checks if check.status == "fail"], combination.choices
    if not broken:
        return best
    offers = {axis: sizings.offers(axis, sizings.masses(axis, choices), choices[axis]) for axis in choices}
    count, before = 0, [axis.best.status for axis in best.axes if axis.best]
    for count, others in enumerate(combinations.cheapest_first(offers, _MOST_COMBINATIONS), 1):
        try:
            result = _machine_with_drives(sizings, combination._replace(choices=others))
        except LookupError:  # a drive does not carry what rides on it then
            continue
        now = [axis.best.status if axis.best else "fail" for axis in result.axes]
        worse = any(GRAVEST.index(a) < GRAVEST.index(b) for a, b in zip(now, before, strict=True))
        if worse or any(check.status == "fail" for check in result.checks):
            continue
        note = f"{broken[0]}: the best drives of all axes break it together; of the next best, choice {count} keeps it"
        return replace(result, certain=False, notes=(*result.notes, note))
    note = f"{broken[0]}: none of {count} other choices of drives keeps it"
    return replace(best, certain=False, notes=(*best.notes, note))


def _over_tolerances(sizing: MachineSizing, sampling: SamplingOf) -> MachineSizing:
    """The machine with its supply's limits over tolerances, where any figure has one."""
    machine, power, first = sizing.machine, sizing.power, sizing.axes[0].spec
    lost = without_effect(machine)
    note = f"the tolerance of {', '.join(lost)} has no effect: axes and supply are those of the nominal figure"
    notes = (*sizing.notes, *([note] if lost else ()))
    how = next((plan for plan in (sampling(axis.spec) for axis in sizing.axes) if plan), None)
    if how is None and toleranced(machine):
        how = sampling_of(first, samples=first.tolerances.samples)
    if power is None or how is None:
        return replace(sizing, notes=notes)
    from drivesizer.multi_axis.sampled_supply import over_tolerances  # where nothing is sampled it need not load

    power = over_tolerances(machine, sizing.axes, power, how)
    own = budget_checks(machine, sizing.axes, power)
    return replace(sizing, power=power, checks=(*power.checks, *own), notes=notes)


def _with_few_kinds(sizings: AxisSizings, combination: Combination, best: MachineSizing, more: float) -> MachineSizing:
    """The machine with common drives, where they cost no more of the objective than permitted."""
    machine, where = sizings.machine, sizings.machine.where(("few_kinds",))
    if best.objective not in SUMMED:
        text = f"{best.objective} has no sum; expected one objective of all axes, e.g. mass or price"
        raise InputError(f"{where}: {text}")
    if any(axis.spec.method == "paper" for axis in machine.axes):
        raise InputError(f"{where}: the paper's method has no common drives; expected method: physics")
    masses = {axis: sizings.masses(axis, combination.choices) for axis in machine.order}
    bests = {axis.name: axis.best for axis in best.axes if axis.best}
    offers = sizings.kinds = combinations.OfferedKinds(masses, sizings.loaded)
    statuses = {axis: drive.status for axis, drive in bests.items()}
    offered = offers.costs(statuses, combination.cost[1] * more)

    def search(shared: combinations.Permitted) -> Combination:
        def of_kinds(axis: str, on_it: tuple[float, ...]) -> list[Choice]:
            choices = offers.choices(axis, on_it, shared.get(axis), statuses[axis])
            return [choice for choice in choices if sizings.fits(axis, on_it, choice.mass)]

        return combinations.best_combination(machine.order, sizings.carried, of_kinds, len(machine.axes))

    limit = combination.cost[0], combination.cost[1] * (1.0 + more)
    kinds = {axis: combinations.kind_of(drive) for axis, drive in bests.items()}
    fewer, common = combinations.fewer_kinds(combination, kinds, offered, limit, search)
    before, objective = len(set(kinds.values())), OBJECTIVES[best.objective].title
    if not common:
        allowed = show(more, "%", "dimensionless")
        note = f"{before} kinds of motor and gearhead: fewer take over {allowed} more {objective}"
        return replace(best, notes=(*best.notes, note)) if before > 1 else best
    result = _machine_with_drives(sizings, fewer)
    after = len({combinations.kind_of(axis.best) for axis in result.axes if axis.best})
    note = (
        f"{after} kind{'s' * (after > 1)} of motor and gearhead instead of {before}: "
        f"{show(result.total / best.total - 1.0, '%', 'dimensionless', 2)} more {objective} than the best of each axis"
    )
    if combinations.ORDER.index(result.status) > combinations.ORDER.index(best.status):
        return replace(best, notes=(*best.notes, f"not {note}: {result.status}, where the best drives {best.status}"))
    return replace(result, certain=False, searches=len(sizings.sizings), notes=(*result.notes, note))
