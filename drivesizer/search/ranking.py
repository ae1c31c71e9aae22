"""Ranking: objectives as columns, the order of drives by them, and the Pareto front."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.estimates import assumed_mass
from drivesizer.errors import InputError, quoted
from drivesizer.physics.extremes import undominated
from drivesizer.physics.figures import Array, Whole
from drivesizer.results.sizing import multiples, used_share
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.columns.evaluation import Evaluation, smallest_margin
from drivesizer.search.columns.stages import Drives
from drivesizer.spec.drive import OBJECTIVES, Ranking, Weighted
from drivesizer.units import RANGES

CONTROLLING = ("encoder", "controller")
_UNLISTED, _NEEDLESS = -1, -2  # in place of the row of a part
COUNTED = tuple(name for name, declared in OBJECTIVES.items() if not declared.over and name != "margin")
_BEHIND = len(CONTROLLING) + 1  # so that what is unknown of a motor goes before what is of all else
_DIGITS = 9  # in which equal objectives agree


def objective_of(text: str) -> Ranking:
    """An objective as the command line gives it: a name, or names with weights such as ``mass=2,price=1``."""
    parts = [part.partition("=") for part in text.split(",")]
    for name, _, _ in parts:
        if name.strip() not in OBJECTIVES:
            raise InputError(f"objective {quoted(name.strip())} is not known; expected {', '.join(OBJECTIVES)}")
    names = [name.strip() for name, _, _ in parts]
    if twice := [name for name in names if names.count(name) > 1]:
        raise InputError(f"objective {quoted(twice[0])} is given twice; expected each once, e.g. mass=2,price=1")
    if len(parts) == 1 and not parts[0][1]:
        return names[0]
    weights, (least, most) = [], RANGES["dimensionless"]
    for name, equals, weight in parts:
        try:
            value = float(weight) if equals else 1.0
        except ValueError:
            value = np.nan
        if not least <= value <= most:  # written so that NaN fails too
            reason = f"weight {quoted(weight)} is not a number above 0 ({least:g} to {most:g})"
            raise InputError(f"objective {quoted(name)}: {reason}, e.g. mass=2")
        weights.append(Weighted.model_validate({"objective": name.strip(), "weight": value}))
    return weights


def title_of(objective: Ranking) -> str:
    """An objective in a word or a line.

    >>> title_of("mass"), title_of(objective_of("mass=2,price=1"))
    ('mass', '2 mass + 1 price')
    """
    if isinstance(objective, str):
        return objective
    return " + ".join(f"{part.weight:g} {part.objective}" for part in objective)


# Figures of the parts that are bought with each candidate: motor or actuator, gearhead, brake, encoder, controller.
# What is inside an actuator has the figure 0 by itself. Of an encoder or controller that no catalogue lists the mass
# is assumed where estimates count, and unknown otherwise, as its price is.


def part_rows(drives: Evaluation | Drives, *, needs_encoder: bool) -> dict[str, Array]:
    """The parts that go with candidates, among the figures that objectives count."""
    return {
        "encoder": np.where(drives.encoder < 0, _UNLISTED if needs_encoder else _NEEDLESS, drives.encoder).astype(
            float
        ),
        "controller": drives.controller.astype(float),
        "brake": np.where(drives.brake < 0, _NEEDLESS, drives.brake).astype(float),
    }


def counted_figures(evaluation: Evaluation) -> dict[str, Array]:
    """Figures that objectives count beside those of the catalogue."""
    parts = part_rows(evaluation, needs_encoder=not evaluation.spec.steps)
    return {**evaluation.figures, "margin": smallest_margin(evaluation.checks), **parts}


def bought(
    catalog: Catalog,
    sets: Candidates,
    parts: Mapping[str, Array],
    figure: str,
    over: Sequence[str],
    end: int | None = None,
) -> Array:
    """A figure of the parts of each candidate: shape (parts, candidates)."""
    figures = np.zeros((len(over), len(sets.motor)))
    for row, role in zip(figures, over, strict=True):
        table = catalog.table(f"{role}s")
        if role in parts:
            assumed = end is not None and figure == "mass" and role in CONTROLLING
            unlisted = assumed_mass(f"{role}s")[end or 0] if assumed else nan
            column = table["added_length" if role == "brake" and figure == "length" else figure]
            row[:] = np.concatenate([column, [0.0, unlisted]])[parts[role].astype(np.int64)]
        else:
            row[:] = table[figure][getattr(sets, role)]
    return figures


def values(catalog: Catalog, sets: Candidates, figures: Mapping[str, Array], objective: Ranking) -> tuple[Array, Whole]:
    """An objective of each drive, less is better, and of how many parts it is unknown."""
    if isinstance(objective, str):
        value, missing = single(catalog, sets, figures, objective)
        if objective == "price" and missing.any():  # what is known of a price says nothing of the rest of it
            value = np.where(missing > 0, single(catalog, sets, figures, "mass")[0], value)
        return value, _BEHIND * missing + controlling_unknown(catalog, sets, figures, objective)
    total, missing = np.zeros(len(sets.motor)), np.zeros(len(sets.motor), np.int64)
    for part in objective:
        value, lacking = single(catalog, sets, figures, part.objective)
        if OBJECTIVES[part.objective].more_is_better:  # a margin, counted as what is used of the limit
            value = used_share(-value)
        total += part.weight * multiples(value, lacking == 0)
        missing += lacking
    return total, missing


def single(catalog: Catalog, sets: Candidates, figures: Mapping[str, Array], name: str) -> tuple[Array, Whole]:
    """One objective of each drive as far as it is known, less is better, and what is unknown of it."""
    declared = OBJECTIVES[name]
    if not declared.over:
        value = np.where(np.isinf(figures[name]), np.nan, -figures[name]) if declared.more_is_better else figures[name]
        return np.nan_to_num(value, nan=0.0), np.isnan(value).astype(np.int64)
    parts = bought(catalog, sets, figures, declared.figure, declared.over, 0 if catalog.ends else None)
    turning = [role not in CONTROLLING for role in declared.over]
    total = np.nansum(parts, 0)
    return -total if declared.more_is_better else total, np.isnan(parts[turning]).sum(0)


def controlling_unknown(catalog: Catalog, sets: Candidates, figures: Mapping[str, Array], objective: str) -> Whole:
    """Number of encoder and controller of each drive of which an objective is unknown."""
    declared = OBJECTIVES[objective]
    over = [role for role in declared.over if role in CONTROLLING]
    return np.isnan(bought(catalog, sets, figures, declared.figure, over, 0 if catalog.ends else None)).sum(0)


def order(
    catalog: Catalog,
    sets: Candidates,
    value: Array,
    missing: Whole,
    before: Sequence[NDArray[Any]] = (),
    margin: Array | None = None,
) -> Whole:
    """Drives from best to worst.

    An objective that is known of all parts goes before one that is not, then the better one, then the larger smallest
    margin where that is at hand, then part numbers: the same input gives the same order.
    """
    return np.lexsort((
        sets.belt,
        catalog.gearheads.alphabetical[sets.gearhead],
        catalog.motors.alphabetical[sets.motor],
        np.zeros(len(value)) if margin is None else rounded(-np.nan_to_num(margin, nan=-np.inf)),
        rounded(value),
        missing,
        *reversed(before),
    )).astype(np.int64)  # fmt: skip


def rounded(value: Array) -> Array:
    """Values of which those that differ by rounding alone are equal."""
    with np.errstate(divide="ignore", invalid="ignore"):
        place = 10.0 ** (_DIGITS - np.ceil(np.log10(np.abs(value))))
        nearest: Array = np.round(value * place) / place
    return np.where(np.isfinite(nearest), nearest, value)


def front(catalog: Catalog, sets: Candidates, figures: Mapping[str, Array], names: Sequence[str]) -> Whole:
    """Drives that no other drive equals or beats in every one of several objectives, in order of the first.

    Drives of which one of the objectives is not wholly known are left out.
    """
    columns = [single(catalog, sets, figures, name) for name in names]
    known = np.flatnonzero(sum(missing for _, missing in columns) == 0)
    values_ = np.stack([rounded(value[known]) for value, _ in columns], axis=1)
    ordered = order(catalog, sets.on(known), values_[:, 0], np.zeros(len(known), np.int64))
    best = ordered[np.sort(undominated(-values_[ordered]))]
    return known[best]
