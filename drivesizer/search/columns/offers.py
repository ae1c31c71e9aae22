"""Columns common to all load cases: parts that go with each motor, its own limits, and the worst of each check."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.results.check_columns import CheckColumn, worst_case
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.problem import Problem
from drivesizer.search.columns.brakes import OfferedBrakes, offered_brakes
from drivesizer.search.columns.controllers import Usable, usable_controllers
from drivesizer.search.columns.encoders import Offered, offered_encoders
from drivesizer.search.columns.limits import motor_limits

__all__ = ["Offers", "offers", "unknown_where_doubtful", "worst_of_all"]


class Offers(NamedTuple):
    """For every motor of the catalogues its encoders, controllers, brakes, and the limits that no load changes."""

    encoders: Offered
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
    """The checks; with an unknown inertia those that hang on it may fail but not pass.

    Parameters
    ----------
    checks
        Of candidates, by physics.
    known
        Whether all inertias of each candidate are known, shape (candidates,).

    Returns
    -------
    list
        The checks in their order.
    """
    if known.all():
        return checks
    return [
        replace(c, passed=c.passed & (known | np.isposinf(c.limit))) if CHECKS["physics"][c.name].on_inertia else c
        for c in checks
    ]


def worst_of_all(problem: Problem, checks: Callable[[int], list[CheckColumn]]) -> list[CheckColumn]:
    """The worst case of each check.

    Parameters
    ----------
    problem
        With its load cases.
    checks
        Makes the checks of the load case of a number.

    Returns
    -------
    list
        Each check over the load cases that have it.
    """
    found: dict[str, list[tuple[int, CheckColumn]]] = {}
    for number in range(len(problem.cases)):
        for check in checks(number):
            found.setdefault(check.name, []).append((number, check))
    return [worst_case(same) for same in found.values()]
