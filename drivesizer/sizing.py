"""Sizing: from a spec and catalogues to the result that everything else prints."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from drivesizer import paper
from drivesizer.catalog import Catalog, load
from drivesizer.choose import offered_buses, offers
from drivesizer.compare import with_both_methods
from drivesizer.errors import InputError, quoted
from drivesizer.results import DriveSet, Relaxation, Requirement, SizingResult
from drivesizer.search import Candidates, Evaluation, candidates, counts, drive_set, evaluate, ranking
from drivesizer.spec import Choice, ControllerChoice, EncoderChoice, RobotSpec
from drivesizer.units import show

__all__ = ["explain", "load_parts", "size"]


def load_parts(spec: RobotSpec) -> Catalog:
    """The catalogues that a spec names; paths count from the spec's folder."""
    return load(spec.select.catalogs, beside=Path(spec.file).parent if spec.file else None)


def size(
    spec: RobotSpec, *, catalog: Catalog | None = None, top: int = 5, objective: str | None = None
) -> SizingResult:
    """Size a drive.

    Parameters
    ----------
    spec
        The robot.
    catalog
        Parts to choose from; those that the spec names when not given.
    top
        How many sets to give.
    objective
        In place of the spec's.

    Returns
    -------
    SizingResult
        The best sets, or the nearest misses and what would have to be relaxed.

    Raises
    ------
    InputError
        When a family or part that the spec selects is in no catalogue.
    """
    catalog = catalog or load_parts(spec)
    objective = objective or spec.select.objective
    _known_choices(spec, catalog)
    evaluation = _evaluated(spec, catalog)
    tally = counts(evaluation)
    order = ranking(evaluation, objective)
    standing = min(top, tally.feasible)
    fallen = top if not tally.feasible else min(_MISSES, top - standing)
    shown = [drive_set(evaluation, int(i), n, objective) for n, i in enumerate(order[: standing + fallen], 1)]
    sets, misses = with_both_methods(spec, catalog, shown[:standing]), tuple(shown[standing:])
    return SizingResult(
        spec=spec,
        catalog=catalog,
        method=spec.method,
        objective=objective,
        requirements=_requirements(evaluation, order),
        sets=sets,
        misses=misses,
        relaxations=() if sets else _relaxations(spec, catalog),
        counts=tally,
        assumptions=_assumptions(spec),
        warnings=_warnings(spec, sets),
        unrestricted=_unrestricted(spec, catalog, objective),
    )


def _requirements(evaluation: Evaluation, order: Any) -> tuple[Requirement, ...]:
    """(1)-(16) with the rotor inertia of the best candidate; without candidates, with none."""
    if len(order):
        return tuple(r.at(int(order[0])) for r in evaluation.wheel.values())
    return tuple(paper.vehicle(evaluation.spec, 0.0).steps.values())


def _known_choices(spec: RobotSpec, catalog: Catalog) -> None:
    """Refuse a family or part that no catalogue has: a misspelling would silently find nothing."""
    import difflib

    for section in ("motor", "gearhead", "encoder", "controller"):
        choice, table = getattr(spec.select, section), catalog.table(f"{section}s")
        for key, wanted in (("family", choice.family or []), ("part", choice.part or [])):
            known = set(table[key].tolist())
            for name in wanted:
                if name not in known:
                    close = difflib.get_close_matches(name, sorted(known), 3, 0.5)
                    hint = f"; the nearest are {', '.join(close)}" if close else ""
                    where = spec.where(("select", section, key))
                    raise InputError(f"{where}: {quoted(name)} is in no catalogue that the spec names{hint}")
    bus, buses = spec.select.controller.bus, offered_buses(catalog.controllers)
    if bus and not any(offers(b, bus) for b in buses):
        where = spec.where(("select", "controller", "bus"))
        raise InputError(
            f"{where}: no controller has the bus {quoted(bus)}; expected one of {', '.join(sorted(buses))}"
        )


def _assumptions(spec: RobotSpec) -> tuple[str, ...]:
    """What the method takes for granted, as sentences."""
    if spec.method == "physics":
        return (
            "gear and belt keep their catalogue efficiency, the maximum, at any torque, and driven backward as well",
            "brushed motors lose k_t I_0 at any speed; of brushless ones the no-load loss rises with speed",
            "the winding's temperature is its steady mean, from copper loss alone; voltage is with it cold and hot",
            "an encoder's unknown inertia is left out; sustained speed is the highest at which the profile stays",
            "requirements (1)-(20) are the paper's, for comparison; the paper factors do not enter the checks",
        )
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
    missing = [check.title for check in best.checks if check.status == "unknown"]
    if missing:
        said.append(f"unknown for the best set: {', '.join(missing)}")
    if spec.method == "paper" and best.motor.nominal_voltage > spec.supply.highest:
        volts = [show(v, "V", "voltage") for v in (best.motor.nominal_voltage, spec.supply.highest)]
        said.append(f"the best set's motor is wound for {volts[0]}, the supply gives {volts[1]} at most")
    return tuple(said)


def _unrestricted(spec: RobotSpec, catalog: Catalog, objective: str) -> DriveSet | None:
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
    evaluation = _evaluated(whole, catalog)
    order = ranking(evaluation, objective)
    if not len(order) or evaluation.failed[order[0]]:
        return None
    return drive_set(evaluation, int(order[0]), 1, objective)


_MISSES = 3  # of those that fell, how many are shown below those that stand

# What may be relaxed when nothing fits: field, how to scale it, the direction, and how to show it.
_FIELDS: tuple[tuple[str, str, str, str, int], ...] = (
    ("motion.speed", "speed", "m/s", "speed", -1),
    ("motion.acceleration_time", "acceleration_time", "s", "time", +1),
    ("load.mass", "mass", "kg", "mass", -1),
)


def _relaxations(spec: RobotSpec, catalog: Catalog) -> tuple[Relaxation, ...]:
    """How far single figures of the spec must move until a set passes: found by search, to 1 %."""
    found = []
    for path, name, unit, kind, direction in _FIELDS:
        section = path.split(".")[0]

        def scaled(factor: float, section: str = section, name: str = name) -> RobotSpec:
            part = getattr(spec, section)
            return spec.model_copy(update={section: part.model_copy(update={name: getattr(part, name) * factor})})

        factor = _least_change(lambda f, s=scaled: _passes(s(f), catalog), direction)  # type: ignore[misc]
        if factor is not None:
            changed = scaled(factor)
            best = _best(changed, catalog)
            now = getattr(getattr(spec, section), name)
            found.append(Relaxation(
                field=path, now=show(now, unit, kind), needed=show(now * factor, unit, kind, 3), set_label=best.label
            ))  # fmt: skip
    return tuple(found)


def _least_change(passes: Callable[[float], bool], direction: int) -> float | None:
    """The factor nearest to 1 at which something passes, between 1 and 1/20 or 20; None when nothing there does."""
    far = 20.0**direction
    if not passes(far):
        return None
    near = 1.0
    while abs(far / near - 1.0) > 0.01:
        middle = float(np.sqrt(near * far))
        near, far = (near, middle) if passes(middle) else (middle, far)
    return far


def _evaluated(spec: RobotSpec, catalog: Catalog) -> Evaluation:
    return evaluate(spec, catalog, candidates(spec, catalog))


def _passes(spec: RobotSpec, catalog: Catalog) -> bool:
    return counts(_evaluated(spec, catalog)).feasible > 0


def _best(spec: RobotSpec, catalog: Catalog) -> DriveSet:
    evaluation = _evaluated(spec, catalog)
    return drive_set(evaluation, int(ranking(evaluation, spec.select.objective)[0]), 1, spec.select.objective)


def explain(spec: RobotSpec, motor: str, gearhead: str, *, catalog: Catalog | None = None) -> list[DriveSet]:
    """One pair of motor and gearhead, check by check, with every belt ratio of the spec.

    Parameters
    ----------
    spec
        The robot; its choice of motors and gearheads is left aside.
    motor, gearhead
        Part numbers.
    catalog
        Parts to choose from; those that the spec names when not given.

    Raises
    ------
    InputError
        When a part number is in no catalogue.
    """
    catalog = catalog or load_parts(spec)
    rows = (_row(catalog, "motors", motor), _row(catalog, "gearheads", gearhead))
    family = str(catalog.gearheads["family"][rows[1]])
    select = spec.select.model_copy(update={"motor": Choice(part=[motor]), "gearhead": Choice(family=[family])})
    narrowed = spec.model_copy(update={"select": select})
    given: Candidates = candidates(narrowed, catalog, also=rows)
    evaluation = evaluate(narrowed, catalog, given)
    found = np.flatnonzero((given.motor == rows[0]) & (given.gearhead == rows[1]))
    sets = [drive_set(evaluation, int(i), n, spec.select.objective) for n, i in enumerate(found, 1)]
    return list(with_both_methods(spec, catalog, sets))


def _row(catalog: Catalog, section: str, part: str) -> int:
    import difflib

    table = catalog.table(section)
    if part not in table.rows:
        close = difflib.get_close_matches(part, table.rows, 3)
        hint = f"; the nearest are {', '.join(close)}" if close else ""
        raise InputError(f"{section[:-1]} {quoted(part)} is in no catalogue{hint}")
    return table.rows[part]
