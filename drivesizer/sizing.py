"""Sizing: from a spec and catalogues to the result that everything else prints."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from drivesizer import belt_choice, paper
from drivesizer.budgets import check_battery, drive_mass, mass_without_drive, of_the_platform, with_budget
from drivesizer.candidates import Candidates, candidates
from drivesizer.catalog import DIRECT, Catalog, load, one_of
from drivesizer.catalog.inside import taken_apart
from drivesizer.catalog.shafts import on_any_shaft
from drivesizer.choices import Choice, ControllerChoice, EncoderChoice
from drivesizer.choose import offered_buses, offers
from drivesizer.compare import with_both_methods
from drivesizer.errors import InputError, nearest, quoted
from drivesizer.evaluation import evaluate
from drivesizer.machines import WheeledVehicle
from drivesizer.mass_budget import settle
from drivesizer.platform_cases import on_wheels
from drivesizer.ranking import Objective, names_of, title_of
from drivesizer.records import drive_set
from drivesizer.relax import changes_for, relaxations
from drivesizer.requirements import requirements
from drivesizer.results import DriveSet, Requirement, SizingResult, verdict
from drivesizer.search import Found, Progress, search
from drivesizer.spec import RobotSpec
from drivesizer.tolerances.assess import Subject
from drivesizer.tolerances.run import (
    FINALISTS,
    POOL,
    Sampling,
    asked,
    judged,
    subject,
    subject_of,
    told,
    uncertainty,
)
from drivesizer.units import show

__all__ = ["explain", "load_parts", "size"]


def load_parts(spec: RobotSpec) -> Catalog:
    """The catalogues that a spec names; paths count from the spec's folder."""
    return _prepared(load(spec.select.catalogs, beside=Path(spec.file).parent if spec.file else None))


def _prepared(catalog: Catalog) -> Catalog:
    """A catalogue for the search: actuators taken apart, gearheads with a hub on every shaft that fits."""
    return on_any_shaft(taken_apart(catalog))


def size(
    spec: RobotSpec,
    *,
    catalog: Catalog | None = None,
    top: int = 5,
    objective: Objective | None = None,
    pareto: tuple[str, ...] = (),
    progress: Progress | None = None,
    sampling: Sampling | None = None,
) -> SizingResult:
    """Size a drive.

    Parameters
    ----------
    spec
        The machine.
    catalog
        Parts to choose from; those that the spec names when not given.
    top
        How many sets to give.
    objective
        In place of the spec's.
    pareto
        Objectives of which the front is wanted too: sets that no other beats in all of them.
    progress
        Called with the sets that are examined and all there are, a chunk at a time.
    sampling
        How sets are sampled for their tolerances; as the spec says when not given.

    Returns
    -------
    SizingResult
        The best sets, or the nearest misses and what would have to be relaxed.

    Raises
    ------
    InputError
        When a family or part that the spec selects is in no catalogue, no pulleys fit, or the objective needs
        another method.
    """
    catalog = _prepared(catalog) if catalog else load_parts(spec)
    objective = objective or spec.select.objective
    spec, weighed = _at_its_own_mass(spec, catalog, objective)
    spec = belt_choice.with_pulleys(on_wheels(spec), catalog)
    _known_choices(spec, catalog)
    check_battery(spec, catalog)
    _known_to(spec, {*names_of(objective), *pareto})
    sampling = sampling or asked(spec)
    pool = POOL if sampling and sampling.confidence is not None else 0
    most = max(top * _FURTHER if spec.battery or spec.budget else top, pool)
    found = search(spec, catalog, top=most, objective=objective, pareto=pareto, progress=progress)
    certain = (
        judged(spec, catalog, _subjects(found, spec, catalog, objective, pool), sampling) if sampling and pool else None
    )
    best, short = _divided(found, spec, objective, top, certain.good if certain else range(found.standing))
    if sampling and not certain and best:
        certain = judged(spec, catalog, _subjects(found, spec, catalog, objective, 0, best), sampling)
    count = len(found.evaluation.candidates.motor)
    fallen = [i for i in range(found.standing, count) if found.evaluation.failed[i]]
    fell = [*short.values(), *(drive_set(found.evaluation, i, 0, objective) for i in fallen)]
    unsure: tuple[DriveSet, ...] = ()
    if certain:
        best = {row: told(certain, catalog, row, one, loop=n < FINALISTS) for n, (row, one) in enumerate(best.items())}
        close = _divided(found, spec, objective, top, certain.bad)[0]
        unsure = _ranked(told(certain, catalog, row, one) for row, one in close.items())
    sets = with_both_methods(spec, catalog, _ranked(best.values()))
    return SizingResult(
        spec=spec,
        catalog=catalog,
        method=spec.method,
        objective=title_of(objective),
        requirements=_requirements(found, spec, next(iter((*best, *short)), 0)),
        sets=sets,
        misses=_ranked(fell[: None if sets else top], len(sets)),
        relaxations=() if found.standing else relaxations(spec, catalog),
        counts=found.counts,
        assumptions=(*_assumptions(spec), *belt_choice.assumptions(spec), *weighed),
        warnings=(*_warnings(spec, sets), *_shortfall(best, short), *catalog.replaced),
        unrestricted=_unrestricted(spec, catalog, objective),
        front=tuple(drive_set(found.evaluation, i, n, objective) for n, i in enumerate(found.front, 1)),
        pareto=pareto,
        unsure=unsure,
        uncertainty=uncertainty(certain) if certain else None,
    )


def _at_its_own_mass(spec: RobotSpec, catalog: Catalog, objective: Objective) -> tuple[RobotSpec, tuple[str, ...]]:
    """The spec with the mass at which its drive carries itself, and how that was found; where the spec asks for it."""
    load = spec.load
    if spec.budget is None or not spec.budget.drive_counts or not isinstance(load, WheeledVehicle):
        return spec, ()

    def weighing(mass: float) -> RobotSpec:
        return spec.model_copy(update={"load": load.model_copy(update={"mass": mass})})

    def sized(mass: float) -> tuple[float, str] | None:
        robot = belt_choice.with_pulleys(on_wheels(weighing(mass)), catalog)
        found = search(robot, catalog, top=1, objective=objective, misses=0)
        if not found.standing:
            return None
        best = drive_set(found.evaluation, 0, 1, objective)
        return drive_mass(best, load.motors), best.label

    settled = settle(sized, mass_without_drive(spec, catalog))
    mass = settled.total if settled.carries_itself else settled.steps[-1].total
    return weighing(mass), (f"the drive's own mass counts, as far as it is known: {settled.words}",)


_FURTHER = 4  # times as many sets are looked at where some may fall by the machine's budgets


def _divided(
    found: Found, spec: RobotSpec, objective: Objective, top: int, rows: Iterable[int]
) -> tuple[dict[int, DriveSet], dict[int, DriveSet]]:
    """Of some rows the best sets that stand with the machine's budgets, and the better ones that fall by those."""
    catalog, machine = found.evaluation.catalog, of_the_platform(spec.whole)
    best: dict[int, DriveSet] = {}
    short: dict[int, DriveSet] = {}
    for row in rows:
        one = with_budget(spec, catalog, drive_set(found.evaluation, row, 0, objective), machine)
        falls = one.status == "fail" or (verdict(one.budget) == "unknown" and spec.select.unknown != "allow")
        (short if falls else best)[row] = one
        if len(best) == top:
            break
    return best, dict(list(short.items())[:top])


def _subjects(
    found: Found, spec: RobotSpec, catalog: Catalog, objective: Objective, pool: int, rows: Iterable[int] = ()
) -> dict[int, Subject]:
    """Sets that are to be sampled, by their rows, with their checks by physics."""
    rows = rows or range(min(found.standing, pool))
    if spec.method == "physics":
        return {row: subject(found.evaluation, row) for row in rows}
    records = with_both_methods(spec, catalog, [drive_set(found.evaluation, row, 0, objective) for row in rows])
    return {row: subject_of(catalog, one) for row, one in zip(rows, records, strict=True)}


def _ranked(sets: Iterable[DriveSet], before: int = 0) -> tuple[DriveSet, ...]:
    return tuple(replace(one, rank=rank) for rank, one in enumerate(sets, before + 1))


def _shortfall(best: dict[int, DriveSet], short: dict[int, DriveSet]) -> list[str]:
    """That better sets fell by a budget."""
    names = sorted({check.title.lower() for one in short.values() for check in one.budget if check.status == "fail"})
    better = [row for row in short if not best or row < min(best)]
    if not better or not names:
        return []
    sets = "1 set that stands" if len(better) == 1 else f"{len(better)} sets that stand"
    return [f"{sets} by method and objective before these: not enough for the machine ({', '.join(names)})"]


def _known_to(spec: RobotSpec, names: set[str]) -> None:
    """Refuse objectives that the paper's method does not compute."""
    foreign = sorted(names & {"energy", "joule_heat", "peak_current", "winding_temperature"})
    if spec.method == "paper" and foreign:
        raise InputError(f"objective {foreign[0]}: the paper's method does not compute it; expected method: physics")


def _requirements(found: Found, spec: RobotSpec, row: int) -> tuple[Requirement, ...]:
    """(1)-(16) with the rotor inertia of the candidate that is shown; without candidates, with none."""
    if not spec.paper_applies:
        assert found.evaluation.asked  # such a spec is sized by physics
        return tuple(requirements([base.cycle for base in found.evaluation.asked.bases]))
    if len(found.evaluation.candidates.motor):
        return tuple(r.at(row) for r in found.evaluation.wheel.values())
    return tuple(paper.vehicle(spec, 0.0).steps.values())


def _known_choices(spec: RobotSpec, catalog: Catalog) -> None:
    """Refuse a family or part that no catalogue has: a misspelling would silently find nothing."""
    for section in ("motor", "gearhead", "encoder", "controller"):
        choice, table = getattr(spec.select, section), catalog.table(f"{section}s")
        for key, wanted in (("family", choice.family or []), ("part", choice.part or [])):
            known = set(table[key].tolist())
            for name in wanted:
                if name not in known:
                    where = spec.where(("select", section, key))
                    raise InputError(
                        f"{where}: {quoted(name)} is in no catalogue that the spec names{nearest(name, known)}"
                    )
    bus, buses = spec.select.controller.bus, offered_buses(catalog.controllers)
    if bus and not any(offers(b, bus) for b in buses):
        where = spec.where(("select", "controller", "bus"))
        raise InputError(
            f"{where}: no controller has the bus {quoted(bus)}; expected one of {', '.join(sorted(buses))}"
        )


def _assumptions(spec: RobotSpec) -> tuple[str, ...]:
    """What the method takes for granted, as sentences."""
    if spec.method == "physics":
        said = [
            "gear and belt keep their catalogue efficiency, the maximum, at any torque, and driven backward as well; "
            "where a gearhead's no-load torque is printed, that is lost at any torque and the rest in proportion",
            "brushed motors lose k_t I_0 at any speed; of brushless ones the no-load loss rises with speed",
            "the winding's peak is that of the cycle repeated for ever; friction and iron losses warm the housing, "
            "copper the winding; where time constants are unknown it is the mean",
            "voltage is with the winding at the ambient and at its mean temperature, the larger counts",
            "at rest the motor holds what the load asks for, without help of friction",
            "an unknown inertia of the gearhead or friction of the motor is left out where more could only ask for "
            "more: what fails then fails, what passes is unknown",
            "an encoder's unknown inertia is left out; sustained speed is the highest at which the profile stays",
        ]
        if spec.paper_applies:
            said.append("requirements (1)-(20) are the paper's, for comparison; its factors do not enter the checks")
        return tuple(said)
    said = [
        "J_m of (10) is each candidate's own rotor inertia at the motor shaft, without K², as the paper has it",
        "the motor's speed is its no-load speed at nominal voltage, its maximum torque the stall torque",
        "a gearhead's efficiency is the catalogue's maximum, at rated torque",
        "motor current is torque / k_t plus the no-load current",
    ]
    factors = spec.paper_factors
    left = [name for name in type(factors).model_fields if getattr(factors, name) == 1.0]
    if left:
        said.append(f"paper factors at 1, no allowance: {', '.join(left)}")
    return tuple(said)


def _warnings(spec: RobotSpec, sets: tuple[DriveSet, ...]) -> tuple[str, ...]:
    """What the method does not look at and the reader should know."""
    said = []
    if spec.method == "paper":
        said.append(
            "the paper's rule does not look at heat, permissible motor speed or supply sag; the physics beside it does"
        )
    if not sets:
        return tuple(said)
    best = sets[0]
    missing = [check.title for check in best.deciding if check.status == "unknown"]
    if missing:
        said.append(f"unknown for the best set: {', '.join(missing)}")
    figures = {figure.name: figure for figure in best.figures}
    if "current_limit" in figures and figures["current_limit"].value < figures["peak_current"].value:
        both = figures["current_limit"].text, figures["peak_current"].text
        said.append(f"the current limit that protects the gearhead at a jam is {both[0]}, the cycle takes {both[1]}")
    if spec.method == "paper" and best.motor.nominal_voltage > spec.supply.highest:
        volts = [show(v, "V", "voltage") for v in (best.motor.nominal_voltage, spec.supply.highest)]
        said.append(f"the best set's motor is wound for {volts[0]}, the supply gives {volts[1]} at most")
    return tuple(said)


def _unrestricted(spec: RobotSpec, catalog: Catalog, objective: Objective) -> DriveSet | None:
    """The best set of the whole catalogue, where the spec names families or parts."""
    if not spec.select.is_restricted:
        return None
    free = {
        "motor": Choice(),
        "gearhead": Choice(),
        "encoder": EncoderChoice(min_counts=spec.select.encoder.min_counts),
        "controller": ControllerChoice(bus=spec.select.controller.bus),
    }
    whole = spec.model_copy(update={"select": spec.select.model_copy(update=free)})
    found = search(whole, catalog, top=1, objective=objective, misses=0)
    return drive_set(found.evaluation, 0, 1, objective) if found.standing else None


def explain(spec: RobotSpec, motor: str, gearhead: str = "", *, catalog: Catalog | None = None) -> list[DriveSet]:
    """One pair of motor and gearhead, check by check, with every belt ratio of the spec.

    Parameters
    ----------
    spec
        The robot; its choice of motors and gearheads is left aside.
    motor, gearhead
        Part numbers; an actuator is named as the motor and brings its own gearhead.
    catalog
        Parts to choose from; those that the spec names when not given.

    Raises
    ------
    InputError
        When a part number is in no catalogue, the gearhead is missing or inside something else, or no pulleys fit.
    """
    catalog = _prepared(catalog) if catalog else load_parts(spec)
    spec = belt_choice.with_pulleys(on_wheels(spec), catalog)
    check_battery(spec, catalog)
    rows = _pair(catalog, motor, gearhead)
    family = str(catalog.gearheads["family"][rows[1]])
    select = spec.select.model_copy(update={"motor": Choice(part=[motor]), "gearhead": Choice(family=[family])})
    narrowed = spec.model_copy(update={"select": select})
    given: Candidates = candidates(narrowed, catalog, also=rows)
    evaluation = evaluate(narrowed, catalog, given)
    found = np.flatnonzero((given.motor == rows[0]) & (given.gearhead == rows[1]))
    sets = [
        with_budget(spec, catalog, drive_set(evaluation, int(i), n, spec.select.objective))
        for n, i in enumerate(found, 1)
    ]
    both = with_both_methods(spec, catalog, sets)
    return [replace(s, changes=changes_for(spec, catalog, s)) if s.status == "fail" else s for s in both]


def _pair(catalog: Catalog, motor: str, gearhead: str) -> tuple[int, int]:
    """Rows of a motor and a gearhead."""
    row = _row(catalog, "motors", motor)
    box = str(catalog.motors["inside"][row])
    if box and gearhead in ("", box):
        return row, catalog.gearheads.rows[box]
    if not gearhead:
        raise InputError(f"--gearhead: motor {quoted(motor)} needs one; expected a part number, or {DIRECT} for none")
    other = _row(catalog, "gearheads", gearhead)
    whole = box or str(catalog.gearheads["inside"][other])
    if whole:
        raise InputError(f"--gearhead: {quoted(whole)} is an actuator, which has motor and gearhead inside")
    return row, other


def _row(catalog: Catalog, section: str, part: str) -> int:
    table = catalog.table(section)
    if part not in table.rows:
        raise InputError(f"{one_of(section)} {quoted(part)} is in no catalogue{nearest(part, table.rows)}")
    return table.rows[part]
