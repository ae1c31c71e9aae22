"""Candidates with figures that are estimated: which they are, and the problem at both ends of the bands."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog, columns_of
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.problem import Problem
from drivesizer.search.columns.brakes import offered_brakes
from drivesizer.search.columns.candidates import Candidates
from drivesizer.spec.robot import RobotSpec

__all__ = ["at_ends", "estimated"]

# sizes and masses: whether a drive moves its load does not hang on them
_SIZES = {"mass", "length", "diameter", "backlash"}
_NEEDED = {"length": "length", "mass": "mass", "diameter": "diameter", "backlash": "backlash_at_load"}


def at_ends(problem: Problem) -> tuple[Problem, Problem]:
    """The problem with estimated figures at the favourable and at the unfavourable end of their bands."""
    favourable, unfavourable = (replace(problem, catalog=end) for end in problem.catalog.ends)
    return favourable, unfavourable


def estimated(problem: Problem, candidates: Candidates, method: str = "physics") -> NDArray[np.int64]:
    """Candidates with an estimated figure that a check may hang on.

    Parameters
    ----------
    problem
        Its catalogue with both ends of the bands, or without estimates.
    candidates
        The candidates.
    method
        Of the checks: the paper's rest on few figures.

    Returns
    -------
    array of int
        Rows of them.
    """
    if not problem.catalog.ends:
        return np.zeros(0, np.int64)
    motors, gearheads = (_differ(problem.catalog, name, problem.spec, method) for name in ("motors", "gearheads"))
    found: NDArray[np.bool_] = motors[candidates.motor] | gearheads[candidates.gearhead]
    if method == "physics" and (offered := offered_brakes(problem.spec, problem.catalog)) is not None:
        brakes: NDArray[np.bool_] = np.append(_differ(problem.catalog, "brakes", problem.spec, method), False)
        uncertain: NDArray[np.bool_] = np.any(brakes[offered.row], axis=1)
        found |= uncertain[candidates.motor]
    return np.flatnonzero(found)


def _differ(catalog: Catalog, section: str, spec: RobotSpec, method: str) -> NDArray[np.bool_]:
    """Parts of which a figure that counts is not the same at both ends."""
    left = frozenset(name for name in _SIZES if not getattr(spec.needs, _NEEDED[name]))

    def differ() -> NDArray[np.bool_]:
        low, high = (end.table(section) for end in catalog.ends)
        found = np.zeros(len(low), bool)
        counted = None if method == "physics" else _paper_figures(section)
        for name, column in columns_of(section).items():
            if column.kind != "text" and name not in left and (counted is None or name in counted):
                found |= (low[name] != high[name]) & ~np.isnan(low[name])
        return found

    found: NDArray[np.bool_] = catalog.once(("differ", section, left, method), differ)
    return found


def _paper_figures(section: str) -> set[str]:
    """Figures of a kind of part that checks of the paper's method rest on."""
    prefix = f"{section[:-1]}."
    names = {name for check in CHECKS["paper"].values() for name in check.rests_on}
    return {name.removeprefix(prefix) for name in names if name.startswith(prefix)}
