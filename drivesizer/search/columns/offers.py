"""Columns common to all load cases and belts: parts that go with each motor, what is bought, its own limits."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.estimates.estimate import assumed_mass
from drivesizer.catalog.parts import BeltDrive
from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.winding import belts_of
from drivesizer.results.check_columns import CheckColumn, together, worst_case
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.problem import Problem
from drivesizer.search.columns.brakes import EncoderOffers, OfferedBrakes, offered_brakes, offered_encoders
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.columns.controllers import Usable, usable_controllers
from drivesizer.search.columns.limits import motor_limits

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
    return together(found, count)


def placed(parts: Sequence[tuple[Any, Any]], count: int, dtype: Any = np.float64) -> NDArray[Any]:
    """Columns of some rows at a time as one column."""
    whole = np.empty(count, dtype)
    for rows, part in parts:
        whole[rows] = part
    return whole
