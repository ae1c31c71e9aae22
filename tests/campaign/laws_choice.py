"""Laws of what there is to choose from: more of it loses nothing, one part of it is that part alone, changes help."""

from __future__ import annotations

import copy
import zlib
from collections.abc import Iterator
from typing import Any

import numpy as np
from estimates_study import scaled
from laws_case import SAME, Case, differences, explained, spec_of
from laws_machines import WHOLE, Plain, catalogue

from drivesizer.catalog import shipped
from drivesizer.catalog.parts import DIRECT
from drivesizer.errors import InputError
from drivesizer.machine.problem import problem
from drivesizer.results.drive_set import Relaxation
from drivesizer.results.problem import Problem
from drivesizer.search import ranking
from drivesizer.search.passing import Passing, sifted
from drivesizer.search.relaxations import changes_for, relaxations
from drivesizer.search.shortlist import load_parts
from drivesizer.sizing import size
from drivesizer.spec.drive import OBJECTIVES
from drivesizer.spec.robot import RobotSpec

__all__ = ["more_to_choose_from", "one_part", "proposals"]

_Search = tuple[Problem, Passing, list[tuple[str, str, float]]]
_CONTROLLERS = ("technosoft", "odrive", "mjbots", "roboteq", "granite_devices", "vesc", "amc", "cytron", "trinamic")


def more_to_choose_from(case: Case) -> Iterator[str]:
    """More catalogues, families of motors, gearheads or controllers: no drive is lost, no best objective worse."""
    rng = np.random.default_rng(zlib.crc32(repr(case.data).encode()))
    for what, few, more in _wider(case.data, rng):
        objective = str(rng.choice(list(OBJECTIVES)))
        for data in (few, more):
            data["select"]["objective"] = objective
        try:
            one, other = (_searched(spec_of(data, case.folder), objective) for data in (few, more))
        except InputError:  # a choice without motors
            continue
        for text in _lost(one, other, objective):
            yield f"{what} {few['select']} / {more['select']}: {text}"


def _wider(data: Plain, rng: np.random.Generator) -> Iterator[tuple[str, Plain, Plain]]:
    """A choice and a wider one, by what they differ."""
    names = data["select"]["catalogs"]
    if names == WHOLE:
        names = [*rng.choice(sorted(shipped()), 5, replace=False).tolist(), "maxon"]
    more = [*names, *rng.choice(_CONTROLLERS, 2, replace=False).tolist(), *rng.choice(sorted(shipped()), 2).tolist()]
    more = list(dict.fromkeys(more))
    yield "catalogues", _with(data, catalogs=names), _with(data, catalogs=more)
    every = catalogue(*more)
    for section in ("motors", "gearheads", "controllers"):
        table: Any = every.table(section)
        families = sorted(set(table["family"].tolist()) - {""})
        if section == "motors":
            families += sorted(set(every.actuators["family"].tolist()) - {""})
        if len(families) < 3:
            continue
        chosen = rng.permutation(families).tolist()
        some, wider = chosen[: -(-len(chosen) // 3)], chosen[: -(-2 * len(chosen) // 3)]
        few, wide = ({section[:-1]: {"family": one}} for one in (some, wider))
        yield f"{section} by family", _with(data, catalogs=more, **few), _with(data, catalogs=more, **wide)
        yield f"{section} by family, or any", _with(data, catalogs=more, **wide), _with(data, catalogs=more)


def _with(data: Plain, **select: Any) -> Plain:
    return copy.deepcopy(data) | {"select": {"objective": "mass", **select}}


def _searched(spec: RobotSpec, objective: str) -> _Search:
    one = problem(spec, load_parts(spec, catalogue(*spec.select.catalogs)))
    found, table = sifted(one.ranked_by(objective), margins=objective == "margin")[0], one.catalog
    names = table.motors["part"][found.sets.motor], table.gearheads["part"][found.sets.gearhead], found.sets.belt
    return one, found, list(zip(*(column.tolist() for column in names), strict=True))


def _lost(one: _Search, other: _Search, objective: str) -> Iterator[str]:
    """What passes, or fails nothing, of the one and not of the other; a best objective that gets worse."""
    before, after = (dict(zip(parts, found.passes.tolist(), strict=True)) for _, found, parts in (one, other))
    for parts, passes in before.items():
        if passes and not after.get(parts):
            yield f"{parts} passes no more"
        elif parts not in after:
            yield f"{parts} fails"
    if any(before.values()):
        (missing, value), (lacks, worse) = (_best(*each[:2], objective) for each in (one, other))
        if (lacks, worse - SAME * abs(worse)) > (missing, value):
            yield f"best {objective} {value:.9g} ({missing} unknown) / {worse:.9g} ({lacks} unknown)"


def _best(problem_: Problem, found: Passing, objective: str) -> tuple[int, float]:
    """The least of an objective among the drives that pass, and how many figures of it are unknown."""
    value, missing = ranking.values(problem_.catalog, found.sets, found.figures, objective)
    some = zip(missing[found.passes].tolist(), value[found.passes].tolist(), strict=True)
    return min(some, default=(9, np.inf))


def one_part(case: Case) -> Iterator[str]:
    """All catalogues with one motor and one gearhead chosen give what ``explain`` says of the two."""
    parts = catalogue(*WHOLE)
    for drive in case.drives:
        chosen: Plain = {"motor": {"part": [drive.motor.part]}}
        if not drive.actuator and drive.gearhead.part != DIRECT:
            chosen["gearhead"] = {"part": [drive.gearhead.part]}
        found = size(spec_of(_with(case.data, catalogs=WHOLE, **chosen), case.folder), catalog=parts, top=9)
        alone = explained(spec_of(_with(case.data, catalogs=WHOLE), case.folder), drive, parts)
        every = {(one.gearhead.part, one.belt_ratio): one for one in (*found.misses, *found.sets)}
        same = every.get((alone.gearhead.part, alone.belt_ratio))
        if same is None:
            yield f"{drive.label} is not there"
        elif same.status != alone.status:
            yield f"{drive.label}: {same.status} / {alone.status}"
        else:
            yield from (f"{drive.label}: {text}" for text in differences(same, alone))


def proposals(case: Case) -> Iterator[str]:
    """Each change that would let a drive pass, typed into the spec, lets it pass."""
    one, spec = case.found.problem, case.found.spec
    if not case.found.sets:
        for change in relaxations(one):
            data = _changed(case.data, change)
            found = size(spec_of(data, case.folder), catalog=catalogue(*spec.select.catalogs), top=1, detail="drives")
            said = [one.label if one.status == "pass" else f"{one.label}, {one.status}" for one in found.sets]
            if said != [change.set_label]:
                yield f"{change.field} {change.now} -> {change.needed}: {change.set_label}; {said or 'none passes'}"
    for drive in case.drives:
        for change in changes_for(one, drive) if drive.status == "fail" else ():
            if change.field == "gearhead":
                continue
            again = case.again(_changed(case.data, change), drive)
            if again.status == "fail":
                failing = [check.name for check in again.own_checks if check.status == "fail"]
                yield f"{change.field} {change.now} -> {change.needed}: {drive.label} fails still: {failing}"


def _changed(data: Plain, change: Relaxation) -> Plain:
    """A spec with a proposed change as one types it, in all load cases."""
    section, name = change.field.split(".")
    text, _, together = change.needed.partition(" (")
    by = dict.fromkeys(("min", "max") if together else (), change.after / change.before)
    own = scaled(data.get(section, {}), by) | {name: text}
    cases = scaled(data.get("cases", []), {name: change.after / change.before})
    return data | {section: own} | ({"cases": cases} if cases else {})
