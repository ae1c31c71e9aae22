"""Several axes: sized from the outermost inward, each with the drives that ride on it, all of them on one supply."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from drivesizer.errors import InputError
from drivesizer.joints.mass_columns import joint_torques
from drivesizer.multi_axis import axis_sizings, combinations
from drivesizer.multi_axis.axis_sizings import AxisSizings
from drivesizer.multi_axis.combinations import Choice, Combination
from drivesizer.multi_axis.common_bus import waiting_times
from drivesizer.multi_axis.common_supply import toleranced, without_effect
from drivesizer.multi_axis.machine_power import budget_checks, machine_power, over_tolerances, with_choppers
from drivesizer.results.machine import SUMMED, AxisSizing, CarriedMass, MachineSizing
from drivesizer.results.sizing import SizingResult
from drivesizer.search.ranking import title_of
from drivesizer.search.shortlist import load_parts
from drivesizer.search.uncertainty.options import sampling_of
from drivesizer.spec.drive import OBJECTIVES
from drivesizer.spec.machine_record import MachineSpec
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

_PER_AXIS = 3  # sizings of each axis at most, on the average


def sized(machine: MachineSpec, how: axis_sizings.Options) -> MachineSizing:
    """Size all axes of a machine of several; where one has no drive, those that it would carry are still sized."""
    sizings = AxisSizings(machine, how)
    machine = sizings.machine

    def choices(axis: str, masses: tuple[float, ...]) -> list[Choice]:
        return axis_sizings.choices_of(sizings.result(axis, masses), sizings.objective(axis))

    if machine.whole:
        found = combinations.best_combination(machine.order, sizings.carried, choices, _PER_AXIS * len(machine.axes))
    else:
        found = combinations.axis_by_axis(machine.order, sizings.carried, choices)
    best = _machine_with_drives(sizings, found)
    if machine.few_kinds is not None and not found.missing:
        best = _with_few_kinds(sizings, found, best, machine.few_kinds)
    elif best.complete:
        best = _within_limits(sizings, found, best)
    return _over_tolerances(best, how.sampling)


def laden(machine: MachineSpec, axis: str) -> RobotSpec:
    """The spec of one axis with the drives that ride on it."""
    alone = machine.robot is None and not machine.axis(axis).carries
    rides = any(axis in machine.carried(other.name) for other in machine.axes)
    if alone and not rides and machine.few_kinds is None:
        machine = with_choppers(machine, load_parts)
        cycles = waiting_times(machine, lambda name: machine.axis(name).spec)
        return machine.axis(axis).spec.waiting(cycles.get(axis, {}))
    how = axis_sizings.Options(5, None, (), None, sampling_of, False, load_parts, joint_torques)
    found = sized(machine, how).axis(axis)
    return axis_sizings.as_chosen(found.spec, found.best) if found.for_all and found.best else found.spec


def _machine_with_drives(sizings: AxisSizings, found: Combination) -> MachineSizing:
    """The machine with the drives of a combination."""
    machine = sizings.machine
    axes = tuple(_axis(sizings, found, axis.name) for axis in machine.axes)
    power = machine_power(machine, axes)
    return MachineSizing(
        machine=machine,
        axes=axes,
        objective=", ".join(dict.fromkeys(title_of(sizings.objective(axis.name)) for axis in machine.axes)),
        searches=len(sizings.made),
        certain=found.certain and all(_bounded(sizings, axis.name, found) for axis in machine.axes),
        notes=tuple(_notes(sizings, axes, found)),
        checks=(*(power.checks if power else ()), *budget_checks(machine, axes, power)),
        power=power,
    )


def _axis(sizings: AxisSizings, found: Combination, name: str) -> AxisSizing:
    """An axis with the drive that was chosen for the whole as its best, and those that ride on it."""

    def with_drive(axis: str) -> SizingResult | None:
        masses = sizings.masses(axis, found.chosen)
        return sizings.chosen(axis, masses, found.chosen[axis].name) if axis in found.chosen else None

    masses, distances = sizings.masses(name, found.chosen), sizings.machine.carried(name)
    own = sizings.result(name, masses)
    result = with_drive(name) or own
    riding = []
    for other, mass in zip(sizings.carried[name], masses, strict=True):
        drive = with_drive(other)
        lacking = axis_sizings.carried_mass(drive.problem, drive.sets[0])[1] if drive else ()
        riding.append(CarriedMass(other, mass, distances[other], lacking))
    if name in found.chosen and (name, masses) in sizings.own:
        lacking = axis_sizings.carried_mass(result.problem, result.sets[0])[1]
        riding.append(CarriedMass(name, sizings.own[name, masses], None, lacking))
    for_all = bool(result.sets and own.sets) and result.sets[0].label != own.sets[0].label
    return AxisSizing(name=name, result=result, carried=tuple(riding), for_all=for_all)


def _bounded(sizings: AxisSizings, axis: str, found: Combination) -> bool:
    """Whether the sum that is least is that of the objective, and more mass on the axis never lightens its load."""
    objective, load, torques = sizings.objective(axis), sizings.machine.axis(axis).spec.load, sizings.torques
    if not isinstance(objective, str) or objective not in SUMMED:
        return False
    carried = sizings.carried[axis]
    if torques is not None and axis in torques.joints and not found.missing:
        own = (axis,) if sizings.moves_its_drive(axis) else ()
        masses = {other: found.chosen[other].mass for other in (*carried, *own)}
        return axis_sizings.rises(torques, axis, masses) and axis not in sizings.uncertain
    return not carried or not (getattr(load, "counterweight", 0.0) > 0.0 or getattr(load, "springs", ()))


def _notes(sizings: AxisSizings, axes: Sequence[AxisSizing], found: Combination) -> Iterator[str]:
    """Choice of the drives, as sentences."""
    if found.missing:
        with_ = "with the drives that were tried" if sizings.uncertain else "even with the lightest drives"
        yield f"{found.missing}: no drive meets all limits, {with_} on it"
    for axis in axes:
        lacking = [f"{part} of {one.of}" for one in axis.carried for part in one.lacking]
        if lacking:
            yield f"{axis.name} carries drives of which the mass of {', '.join(lacking)} is unknown: left out"
    yield from sizings.torques.notes if sizings.torques else ()
    for axis in axes:
        own = next((one.mass for one in axis.carried if one.of == axis.name), None)
        if own is not None and axis.best:
            drive, loaded = axis_sizings.carried_mass(axis.result.problem, axis.best)[0], show(own, "kg", "mass")
            heavier = f"{loaded} of its load, of one that is heavier than its {show(drive, 'kg', 'mass')}"
            said = f"which is {loaded} of its load" if own <= drive * (1.0 + 1e-9) else heavier
            yield f"{axis.name} moves its own drive, {said}"
        elif any(mass > 0.0 for (name, _), mass in sizings.own.items() if name == axis.name):
            yield f"{axis.name} moves its own drive, and no drive carries itself"
    if sizings.torques:
        chosen = {one.name: one.best for one in axes if one.best and one.name in found.chosen}
        yield from axis_sizings.joint_notes(
            sizings.torques, {n: (one, found.chosen[n].mass) for n, one in chosen.items()}
        )
    currencies = {axis.name: axis.result.catalog.currency for axis in axes}
    if len(set(currencies.values())) > 1 and any(axis.result.spec.counts_price for axis in axes):
        said = ", ".join(f"{name} in {code}" for name, code in currencies.items())
        yield f"prices are summed though {said}; expected select.rates, e.g. {{USD: ... EUR}}"
    until = {axis.name: axis.result.problem.machine.waits_until for axis in axes}
    waits = {name: end for name, end in until.items() if end is not None}
    if waits:
        cycle = show(next(iter(waits.values())), "s", "time")
        yield f"{', '.join(waits)}: at rest after the motion until the cycle of {cycle} is over; if not: repeats: true"


def _within_limits(sizings: AxisSizings, found: Combination, best: MachineSizing) -> MachineSizing:
    """The machine with other drives where the best of all axes break a limit of its own."""

    def offers() -> dict[str, list[Choice]]:
        chosen = found.chosen
        return {axis: sizings.offers(axis, sizings.masses(axis, chosen), chosen[axis]) for axis in chosen}

    def tried(chosen: Mapping[str, Choice]) -> MachineSizing | None:
        try:
            return _machine_with_drives(sizings, found._replace(chosen=dict(chosen)))
        except LookupError:  # a drive does not carry what rides on it then
            return None

    return combinations.within_limits(best, offers, tried)


def _over_tolerances(sizing: MachineSizing, sampling: axis_sizings.SamplingOf) -> MachineSizing:
    """The machine with its supply's limits over tolerances, where any figure has one."""
    machine, power, first = sizing.machine, sizing.power, sizing.axes[0].spec
    lost = without_effect(machine)
    note = f"the tolerance of {', '.join(lost)} has no effect: axes and supply are those of the nominal figure"
    notes = (*sizing.notes, *([note] if lost else ()))
    how = next((found for found in (sampling(axis.spec) for axis in sizing.axes) if found), None)
    if how is None and toleranced(machine):
        how = sampling_of(first, samples=first.tolerances.samples)
    if power is None or how is None:
        return replace(sizing, notes=notes)
    power = over_tolerances(machine, sizing.axes, power, how)
    own = budget_checks(machine, sizing.axes, power)
    return replace(sizing, power=power, checks=(*power.checks, *own), notes=notes)


def _with_few_kinds(sizings: AxisSizings, found: Combination, best: MachineSizing, more: float) -> MachineSizing:
    """The machine with common drives, where they cost no more of the objective than permitted."""
    machine, where = sizings.machine, sizings.machine.where(("few_kinds",))
    if best.objective not in SUMMED:
        text = f"{best.objective} has no sum; expected one objective of all axes, e.g. mass or price"
        raise InputError(f"{where}: {text}")
    if any(axis.spec.method == "paper" for axis in machine.axes):
        raise InputError(f"{where}: the paper's method has no common drives; expected method: physics")
    masses = {axis: sizings.masses(axis, found.chosen) for axis in machine.order}
    bests = {axis.name: axis.best for axis in best.axes if axis.best}
    offers = sizings.kinds = combinations.OfferedKinds(masses, sizings.loaded)
    statuses = {axis: one.status for axis, one in bests.items()}
    offered = offers.costs(statuses, found.cost[1] * more)

    def tried(shared: combinations.Permitted) -> Combination:
        def of_kinds(axis: str, on_it: tuple[float, ...]) -> list[Choice]:
            choices = offers.choices(axis, on_it, shared.get(axis), statuses[axis])
            return [one for one in choices if sizings.fits(axis, on_it, one.mass)]

        return combinations.best_combination(machine.order, sizings.carried, of_kinds, len(machine.axes))

    limit = found.cost[0], found.cost[1] * (1.0 + more)
    kinds = {axis: combinations.kind_of(one) for axis, one in bests.items()}
    fewer, common = combinations.fewer_kinds(found, kinds, offered, limit, tried)
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
    return replace(result, certain=False, searches=len(sizings.made), notes=(*result.notes, note))
