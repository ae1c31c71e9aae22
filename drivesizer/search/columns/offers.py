"""Columns common to all load cases and belts: parts that go with each motor, what is bought, its own limits."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.estimates.estimate import assumed_mass
from drivesizer.catalog.parts import BeltDrive
from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.winding import belts_of
from drivesizer.results.check_columns import CheckColumn, worst_case
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.problem import Problem
from drivesizer.search.columns.brakes import EncoderOffers, OfferedBrakes, offered_brakes, offered_encoders
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.columns.controllers import Usable, usable_controllers
from drivesizer.search.columns.limits import motor_limits

__all__ = [
    "CONTROLLING", "Offers", "bought", "chosen", "limits_behind_each", "offers", "placed", "scattered",
    "unknown_where_doubtful", "worst_of_all",
]  # fmt: skip


# -- Figures of the parts that are bought with each candidate: motor or actuator, gearhead, brake, encoder, controller.
#
# What is inside an actuator has the figure 0 by itself. Of an encoder or controller that no catalogue lists the mass
# is assumed where estimates count, and unknown otherwise, as its price is.


Array = NDArray[np.float64]
BRAKE_FIGURES = {"length": "added_length"}  # that objectives sum under another name
CONTROLLING = ("encoder", "controller")
_UNLISTED, _NEEDLESS = -1, -2  # in place of the row of a part
_TABLES = {"motor": "motors", "gearhead": "gearheads", "brake": "brakes", "encoder": "encoders",
           "controller": "controllers"}  # fmt: skip


def chosen(
    encoder: NDArray[np.int64], controller: NDArray[np.int64], brake: NDArray[np.int64], *, needs_encoder: bool
) -> dict[str, Array]:
    """The parts that go with candidates, among the figures that objectives count."""
    unlisted = _UNLISTED if needs_encoder else _NEEDLESS
    return {
        "encoder": np.where(encoder < 0, unlisted, encoder).astype(float),
        "controller": controller.astype(float),
        "brake": np.where(brake < 0, _NEEDLESS, brake).astype(float),
    }


def bought(
    catalog: Catalog,
    sets: Candidates,
    parts: Mapping[str, Array],
    figure: str,
    over: Sequence[str],
    end: int | None = None,
) -> Array:
    """A figure of the parts of each candidate."""
    found = np.zeros((len(over), len(sets.motor)))
    for row, role in zip(found, over, strict=True):
        table = catalog.table(_TABLES[role])
        if role in parts:
            assumed = end is not None and figure == "mass" and role in CONTROLLING
            unlisted = assumed_mass(_TABLES[role])[end or 0] if assumed else nan
            column = table[BRAKE_FIGURES.get(figure, figure) if role == "brake" else figure]
            row[:] = np.concatenate([column, [0.0, unlisted]])[parts[role].astype(np.int64)]
        else:
            row[:] = table[figure][getattr(sets, role)]
    return found


# -- Columns common to all load cases and belts: parts that go with each motor, its own limits, and checks put together.
#
# Of several load cases a check is that of the worst; behind several belts it is made of the candidates behind each.


_COLUMNS = {
    "demand": float,
    "limit": float,
    "passed": bool,
    "failed": bool,
    "time": float,
    "case": np.int64,
}
_IDLE: dict[str, Any] = {
    "demand": 0.0,
    "limit": np.inf,
    "passed": True,
    "failed": False,
    "time": np.nan,
    "case": 0,
}  # no limit


class Offers(NamedTuple):
    """For every motor of the catalogues its encoders, controllers, brakes, and the limits that no load changes."""

    encoders: EncoderOffers
    controllers: Usable
    motor_limits: list[CheckColumn]
    brakes: OfferedBrakes | None  # None where the spec wants none


def offers(problem: Problem) -> Offers:
    """The encoders, controllers, brakes and own limits of every motor, at the supply and ambient of all load cases."""
    spec, catalog = problem.spec, problem.catalog
    own = worst_of_all(problem, lambda k: motor_limits(problem.cases[k].spec, catalog.motors))
    hottest = max(case.spec.environment.ambient for case in problem.cases)
    controllers = usable_controllers(spec, catalog, problem.supply, hottest)
    return Offers(offered_encoders(spec, catalog), controllers, own, offered_brakes(spec, catalog))


def unknown_where_doubtful(checks: list[CheckColumn], known: NDArray[np.bool_]) -> list[CheckColumn]:
    """The checks; with an unknown inertia those that hang on it may fail but not pass."""
    if known.all():
        return checks
    return [c.where_known(known) if CHECKS["physics"][c.name].on_inertia else c for c in checks]


def worst_of_all(problem: Problem, checks: Callable[[int], list[CheckColumn]]) -> list[CheckColumn]:
    """The worst case of each check."""
    found: dict[str, list[tuple[int, CheckColumn]]] = {}
    for number in range(len(problem.cases)):
        for check in checks(number):
            found.setdefault(check.name, []).append((number, check))
    return [worst_case(same) for same in found.values()]


def limits_behind_each(
    problem: Problem,
    cycle: AtGearhead,
    compute: Callable[[AtGearhead, BeltDrive | None, slice], list[CheckColumn]],
    count: int,
) -> list[CheckColumn]:
    """Limits that hang on the belt itself: those behind each belt put together."""
    found = [(rows, compute(at, problem.belt_drive(at.belt), rows)) for at, rows in belts_of(cycle, count)]
    return scattered(found, count)


def scattered(found: Sequence[tuple[Any, list[CheckColumn]]], count: int) -> list[CheckColumn]:
    """Checks of some rows at a time, put together."""
    parts: dict[str, list[tuple[Any, CheckColumn]]] = {}
    for rows, checks in found:
        for check in checks:
            parts.setdefault(check.name, []).append((rows, check))
    return [_one_check(same, count) for same in parts.values()]


def _one_check(parts: list[tuple[Any, CheckColumn]], count: int) -> CheckColumn:
    """One check of some rows at a time as one column."""
    first, rest = parts[0][1], _others(count, [rows for rows, _ in parts])
    columns: dict[str, Any] = {
        name: placed([(rest, _IDLE[name]), *((rows, getattr(check, name)) for rows, check in parts)], count, kind)
        for name, kind in _COLUMNS.items()
        if getattr(first, name) is not None
    }
    if any(check.on_basis is not None for _, check in parts):  # of some rows all figures may be known
        own = [(rows, False if check.on_basis is None else check.on_basis) for rows, check in parts]
        columns["on_basis"] = placed([(rest, False), *own], count, bool)
    if isinstance(first.zero, np.ndarray):  # the ambient of the worst case
        columns["zero"] = placed([(rest, 0.0), *((rows, c.zero) for rows, c in parts)], count)
    return replace(first, **columns)


def placed(parts: Sequence[tuple[Any, Any]], count: int, dtype: Any = np.float64) -> NDArray[Any]:
    """Columns of some rows at a time as one column."""
    whole = np.empty(count, dtype)
    for rows, part in parts:
        whole[rows] = part
    return whole


def _others(count: int, parts: Sequence[Any]) -> NDArray[np.int64]:
    """The rows that are in none of some parts."""
    left = np.ones(count, bool)
    for rows in parts:
        left[rows] = False
    return np.flatnonzero(left)
