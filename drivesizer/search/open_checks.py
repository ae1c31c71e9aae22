"""Drives whose checks hang on estimated figures: which they are, how probable each passes, at which value it turns."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence, Set
from dataclasses import replace
from functools import cache
from math import nan
from statistics import NormalDist
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog, Table, columns_of, singular
from drivesizer.catalog.estimates import law_text, shipped_laws
from drivesizer.catalog.tables import Pairs, stacked, unique_pairs
from drivesizer.catalog.tolerances import lognormal
from drivesizer.catalog.view import has_steppers
from drivesizer.physics.figures import Alike, Array, Mask, Whole
from drivesizer.physics.power_stage import ASSUMED_BAND, ASSUMED_LOSS
from drivesizer.physics.thermal import rated_ambient, steady_winding
from drivesizer.results.check import Check
from drivesizer.results.check_kinds import figure_words
from drivesizer.results.drive_set import EstimatedFigure, voltage_assumption
from drivesizer.results.problem import Problem
from drivesizer.search.columns.brakes import is_listed
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.columns.evaluation import Evaluation, at_figures
from drivesizer.units import show

# -- Drives whose checks hang on estimated figures: how probable it is that each passes, and at which value it turns.
#
# Every estimated figure is a random factor of its own, log-normal with the band as its 5th and 95th percentile;
# those of motor and gearhead are independent, and an actuator's torque constant at the rotor follows the loss of its
# gears. One row of a catalogue made for it is one sample, so that the checks are those of the search; open ones are
# judged by themselves, of samples that fail on something else as well.


Figure = tuple[str, str]  # section and column
SAMPLES = 128
_NO_PAIRS = Pairs(*(np.zeros(0, np.int32),) * 3)
_FARTHEST = 3.0  # standard deviations that a figure is followed
_STEPS = 13
_FINER = 9  # steps within the one in which a check turns
_RATED = "max_winding_temperature"  # of brushless motors that of their nominal current: ``estimates.assumed.by_rating``
_FOLLOWS: dict[Figure, Figure] = {
    ("motors", name): ("gearheads", "efficiency") for name in ("torque_constant", "nominal_torque", "stall_torque")
}
_HOUSING: Figure = ("motors", "thermal_resistance_housing")
_WITH_THE_HOUSING = ("motor_time_constant", "nominal_current", "nominal_torque")  # as ``catalog.view`` has them


class Turn(NamedTuple):
    """Value at which a check turns when one estimated figure moves and the others stay at the middle of their bands."""

    figure: Figure
    value: float  # SI
    passes_below: bool


def estimated_figures(problem: Problem, drive: Candidates) -> list[Figure]:
    """Figures of a single candidate's motor, gearhead and brake that are not the same at both ends of their bands."""
    if not problem.catalog.ends:
        return []
    (low, high), motors, motor = problem.catalog.ends, problem.catalog.motors, int(drive.motor[0])
    inside, figures = motors["inside"][motor] != "", []
    own_limit = motors["kind"][motor] == "brushed" or np.isnan(motors["nominal_current"][motor])
    follows = _followers(problem.catalog, motor)
    for section, (row,) in _rows_of(drive).items():
        for name, column in columns_of(section).items():
            ends = low.table(section)[name][row], high.table(section)[name][row]
            leads = ((section, name) not in _FOLLOWS if inside else True) and (name != _RATED or own_limit)
            leads = leads and (section, name) not in follows
            if column.kind != "text" and leads and ends[0] != ends[1] and ends[0] == ends[0]:
                figures.append((section, name))
    return figures


def _followers(catalog: Catalog, motor: int) -> dict[Figure, Figure]:
    """Figures of a mounted motor that follow its housing's thermal resistance; brushes have a limit of their own."""
    if not catalog.mounted:
        return {}
    low, high = (end.motors[_HOUSING[1]][motor] for end in catalog.ends)
    names = _WITH_THE_HOUSING[: 1 if catalog.motors["kind"][motor] == "brushed" else None]
    return dict.fromkeys((("motors", name) for name in names), _HOUSING) if low != high else {}


def passing(
    problem: Problem, drives: Candidates, names: Sequence[Set[str]], samples: int = SAMPLES, *, exact: bool = True
) -> list[dict[str, float]]:
    """Probability that each check of each drive passes, by name; under "" that all of these pass.

    ``names``: of each drive the checks that are open; computed by themselves where ``exact``.
    """
    points = list[dict[Figure, Array]]()
    for place in range(len(names)):
        figures = estimated_figures(problem, drives.on(slice(place, place + 1)))
        points.append(dict(zip(figures, _normal(samples, len(figures)).T, strict=True)))
    columns = drives_at_points(problem, drives, points, samples, set[str]().union(*names) if exact else ()).checks
    probabilities = list[dict[str, float]]()
    for place, own in enumerate(names):
        checks = [check.on(slice(place * samples, (place + 1) * samples)) for check in columns if not check.advice]
        known = [check for check in checks if check.name in own or (check.passed | check.failed).any()]
        together = np.logical_and.reduce([check.passed for check in known])
        probabilities.append({check.name: float(check.passed.mean()) for check in known} | {"": float(together.mean())})
    return probabilities


def _rows_of(drives: Candidates) -> dict[str, Whole]:
    """Motors, gearheads and brakes of drives, as rows of their sections; without brakes where none has one."""
    rows = {"motors": drives.motor, "gearheads": drives.gearhead, "brakes": drives.brake}
    return {section: row for section, row in rows.items() if row is not None and (row >= 0).any()}


@cache
def _normal(samples: int, figures: int) -> Array:
    """Points spread evenly over independent standard normal figures: shape (samples, figures).

    An additive recurrence (M. Roberts, *The unreasonable effectiveness of quasirandom sequences*, 2018): few points are
    wanted, and nothing need be loaded for them.
    """
    ratio = 2.0
    for _ in range(40):
        ratio = (1.0 + ratio) ** (1.0 / (figures + 1))
    steps = ratio ** -np.arange(1.0, figures + 1)
    cube = (0.5 + np.arange(1, samples + 1)[:, None] * steps) % 1.0
    return np.array([[NormalDist().inv_cdf(p) for p in row] for row in cube.tolist()]).reshape(samples, figures)


def turns(problem: Problem, drive: Candidates, names: Set[str]) -> dict[str, Turn]:
    """For some checks of a drive the estimated figure that moves each most, and the value at which it turns."""
    figures = estimated_figures(problem, drive)
    if not figures or not names:
        return {}
    coarse = [np.linspace(-_FARTHEST, _FARTHEST, _STEPS)] * len(figures)
    near = {
        name: place for name, passed in _along(problem, drive, figures, coarse, names).items()
        if name in names and (place := _nearest_change(coarse, passed)) is not None
    }  # fmt: skip
    places = list(dict.fromkeys(near.values()))
    fine = [np.linspace(coarse[k][step], coarse[k][step + 1], _FINER) for k, step in places]
    passes = _along(problem, drive, [figures[k] for k, _ in places], fine, names) if places else {}
    number = {place: n for n, place in enumerate(places)}
    return {
        name: _turn(problem, drive, figures[place[0]], fine[number[place]], passed)
        for name, place in near.items()
        if (passed := passes[name][number[place]]).any() and not passed.all()  # else open among many points alone
    }


def _along(
    problem: Problem, drive: Candidates, figures: list[Figure], steps: Sequence[Array], names: Set[str]
) -> dict[str, list[Mask]]:
    """Whether each check passes along the steps of one figure after the other, the others at the middle."""
    ends = np.cumsum([len(row) for row in steps])
    owner = np.repeat(np.arange(len(steps)), np.diff(ends, prepend=0))
    deviations, points = np.concatenate(steps), dict[Figure, Array]()
    for k, figure in enumerate(figures):
        points[figure] = points.get(figure, 0.0) + np.where(owner == k, deviations, 0.0)
    checks = drives_at_points(problem, drive, [points], len(deviations), names).checks
    return {check.name: np.split(check.passed, ends[:-1]) for check in checks}


def _nearest_change(steps: Sequence[Array], passed: Sequence[Mask]) -> tuple[int, int] | None:
    """Figure and step between which a check turns nearest to the middle of the band; None where none turns it."""
    changes = [
        (abs(float(values[step] + values[step + 1])), k, int(step))
        for k, (values, good) in enumerate(zip(steps, passed, strict=True))
        for step in np.flatnonzero(good[1:] != good[:-1])
    ]
    return min(changes)[1:] if changes else None


def _turn(problem: Problem, drive: Candidates, figure: Figure, steps: Array, passed: Mask) -> Turn:
    """The value at which a check turns, between two steps of a figure."""
    step = int(np.flatnonzero(passed != passed[0])[0]) - 1
    (row,) = _rows_of(drive)[figure[0]]
    three = np.array([steps[step], (steps[step] + steps[step + 1]) / 2.0, steps[step + 1]])
    below, value, above = _at_deviation(problem.catalog, figure, np.array([row, row, row]), three).tolist()
    return Turn(figure, value, bool(passed[step]) == (below < above))


def drives_at_points(
    problem: Problem, drives: Candidates, points: Sequence[Mapping[Figure, Array]], count: int, names: Collection[str],
    values: Mapping[Figure, Array] = MappingProxyType({}),
) -> Evaluation:  # fmt: skip
    """Drives, each with its estimated figures at several points of their bands: so many rows of each in turn.

    Other figures have values. There are no more encoders than those that were chosen for them, one of each.
    """
    catalog, repeated = problem.catalog, drives.on(np.repeat(np.arange(len(points)), count))
    tables, numbers = dict[str, Table[Any]](), dict[str, Alike]()
    for section, rows in _rows_of(drives).items():
        own = zip(rows.tolist(), points, strict=True)
        table = stacked([_table(catalog, section, np.full(count, row), by) for row, by in own if row >= 0])
        tables[section] = table.changed({name: x for (of, name), x in values.items() if of == section})
        numbers[singular(section)] = np.cumsum(np.repeat(rows >= 0, count)) - 1
    encoder = np.asarray(drives.encoder)
    tables["encoders"] = catalog.encoders.at_rows(encoder[encoder >= 0])
    numbers["encoder"] = np.repeat(np.cumsum(encoder >= 0) - 1, count)
    numbers = {
        name: np.where(getattr(repeated, name) < 0, getattr(repeated, name), own) for name, own in numbers.items()
    }
    pairs = {"motor_encoder": _NO_PAIRS, "motor_brake": _NO_PAIRS}
    if drives.brake is not None and "brake" in numbers:
        braked = zip(drives.motor.tolist(), drives.brake.tolist(), strict=True)
        rows = np.flatnonzero(np.repeat([is_listed(catalog, *pair) for pair in braked], count))
        pairs["motor_brake"] = unique_pairs(rows, numbers["brake"][rows], 0 * rows)
    varied = replace(catalog.with_tables(tables, pairs), ends=())
    return at_figures(replace(problem, catalog=varied), repeated._replace(**numbers), "open", exact_checks=names)


def _table(catalog: Catalog, section: str, rows: Whole, points: Mapping[Figure, Array]) -> Table[Any]:
    table = catalog.table(section).at_rows(rows)
    inside = section != "brakes" and bool(table["inside"][0] != "")
    follows = (_FOLLOWS if inside else {}) | (_followers(catalog, int(rows[0])) if section == "motors" else {})
    columns = dict(table.columns)
    for name, column in columns_of(section).items():
        own = (section, name)
        by = points.get(follows.get(own, own), points.get(own))
        if by is not None and column.kind != "text":
            columns[name] = _at_deviation(catalog, own, rows, by)
    if section == "motors" and catalog.ends:
        _with_rated_temperature(catalog, rows, columns)
    return replace(table, columns=columns)


def _with_rated_temperature(catalog: Catalog, rows: Whole, columns: dict[str, NDArray[Any]]) -> None:
    """Put in the permitted temperature that is that of the nominal current: it follows the thermal resistances."""
    easy, hard = (end.motors[_RATED][rows] for end in catalog.ends)
    reached = steady_winding(columns, rated_ambient(columns), columns["nominal_current"])
    follows = (columns["kind"] != "brushed") & (easy != hard) & ~np.isnan(easy + reached)
    columns[_RATED] = np.where(follows, reached, columns[_RATED])


def _at_deviation(catalog: Catalog, figure: Figure, rows: Whole, by: Array) -> Array:
    """A figure of some parts, moved from the middle of its band towards its unfavourable end."""
    section, name = figure
    easy, middle, hard = (c.table(section)[name][rows] for c in (catalog.ends[0], catalog, catalog.ends[1]))
    with np.errstate(invalid="ignore", divide="ignore"):
        value = lognormal(easy, middle, hard, by)
    return np.minimum(np.where(np.isnan(value), middle, value), 1.0 if name == "efficiency" else np.inf)


# -- Estimated figures of one drive: which they are, and which of its open checks depend on them.


_CONTROLLING = ("encoders", "controllers")  # their masses count in the budget of a machine alone


def estimated(evaluation: Evaluation, index: int) -> tuple[EstimatedFigure, ...]:
    """Figures of a drive's parts that are estimated."""
    catalog, candidates = evaluation.catalog, evaluation.candidates
    motor, gearhead = int(candidates.motor[index]), int(candidates.gearhead[index])
    loss = _stage_loss(evaluation, index)
    if not catalog.ends:
        return loss
    inside = str(catalog.motors["inside"][motor])
    own = {"motors": motor, "gearheads": gearhead}
    places = {"actuators": catalog.actuators.rows[inside]} if inside else own
    parts = zip(_CONTROLLING, (evaluation.encoder, evaluation.controller), strict=True)
    rows_of = {section: int(rows[index]) for section, rows in parts if rows[index] >= 0}
    places |= {section: row for section, row in rows_of.items() if not catalog.table(section)["inside"][row]}
    bands = [(section, band) for section, row in places.items() for band in _part_bands(catalog, section, row)]
    weighed = evaluation.spec.budget is not None and evaluation.spec.budget.weighs
    if (brake := int(evaluation.brake[index])) >= 0:
        bands += [("brakes", band) for band in _part_bands(catalog, "brakes", brake)]
    weighing = (band for section, band in bands if weighed or section not in _CONTROLLING or band.figure != "mass")
    return (*weighing, *loss)


def _stage_loss(evaluation: Evaluation, index: int) -> tuple[EstimatedFigure, ...]:
    """The loss of a controller of which none is printed, with its band."""
    row = int(evaluation.controller[index])
    controller = evaluation.catalog.controllers.record(row) if row >= 0 else None
    steps = has_steppers(evaluation.catalog)  # of a stepper's driver no loss is counted
    if steps or not evaluation.spec.feed_of(controller).stage.assumed:
        return ()
    low, high = (ASSUMED_LOSS * share for share in ASSUMED_BAND)
    law = "assumed: of drops and efficiencies that makers print, and one measured bridge"
    return (
        EstimatedFigure("controller", "loss_voltage", ASSUMED_LOSS, low, high, "voltage", "V", law, "assumed by class"),
    )


def _part_bands(catalog: Catalog, section: str, row: int) -> list[EstimatedFigure]:
    names, part = catalog.estimates.get(section, {}), singular(section)
    bands = {name: band for name in names if (band := catalog.estimate_of(section, row, name)) is not None}
    columns, laws = columns_of(section), shipped_laws()
    return [
        EstimatedFigure(part, name, *band[:3], columns[name].kind, columns[name].unit, law_text(laws[band.fit]))
        for name, band in bands.items()
    ]


def resolved_checks(evaluation: Evaluation, index: int) -> tuple[tuple[Check, ...], float]:
    """The checks of a drive, its open ones with the value at which they turn and how probable it is that they pass."""
    checks = tuple(_with_assumption(evaluation, index, check) for check in evaluation.checks_of(index))
    names = evaluation.sampled_checks(index)
    if not names or evaluation.spec.method != "physics":
        return checks, nan
    drive = evaluation.with_parts(np.array([index]))
    (probable,), turning = passing(evaluation.problem, drive, [names]), turns(evaluation.problem, drive, names)
    own = bool(evaluation.catalog.motors["inside"][evaluation.candidates.motor[index]])
    with_turns = []
    for check in checks:
        if check.name in names:
            turn = turning.get(check.name)
            note = "; ".join(text for text in (_turning(turn, own), check.note) if text)
            figure = figure_words(singular(turn.figure[0]), turn.figure[1]) if turn else ""
            check = replace(check, probability=probable[check.name], note=note, turns_on=figure)
        with_turns.append(check)
    return tuple(with_turns), probable[""]


def _with_assumption(evaluation: Evaluation, index: int, check: Check) -> Check:
    """A check, that of the voltage with what is assumed of the controller's drop."""
    unknown = check.status == "unknown" or np.isnan(check.limit)
    if check.name != "supply_voltage" or unknown or check.method != "physics" or has_steppers(evaluation.catalog):
        return check
    row = int(evaluation.controller[index])
    controller = evaluation.catalog.controllers.record(row) if row >= 0 else None
    note = voltage_assumption(evaluation.spec, controller)
    return replace(check, note="; ".join(text for text in (check.note, note) if text)) if note else check


# figures of an actuator's parts that are the actuator's own at its output, as its maker names them
_OF_ACTUATORS = {
    ("gearheads", "continuous_torque"): "nominal_torque",
    ("gearheads", "intermittent_torque"): "peak_torque",
    ("motors", "nominal_current"): "nominal_current",
}  # fmt: skip


def _turning(turn: Turn | None, actuator: bool) -> str:
    """A sentence on where a check turns."""
    if turn is None:
        return "hangs on several estimated figures together"
    section, name = turn.figure
    column = columns_of(section)[name]
    side = "at most" if turn.passes_below else "at least"
    value = show(turn.value, column.unit, column.kind, 2)
    if actuator and turn.figure in _OF_ACTUATORS:
        figure = _OF_ACTUATORS[turn.figure].replace("_", " ")
        return f"passes with a {figure} of {side} {value}; the maker prints none as a limit"
    return f"passes with a {figure_words(singular(section), name)} of {side} {value}, which is estimated"
