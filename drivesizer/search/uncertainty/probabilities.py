"""Drives over samples: probability that all checks pass, the figures of each, the assumptions that matter most."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.view.mounted import has_steppers
from drivesizer.errors import InputError
from drivesizer.load_cases.platform import WheelLoad
from drivesizer.results.check import Check, Driver, FigureSpread, Reliability, Spread, Uncertain, Uncertainty
from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.check_kinds import BATTERY_SAMPLED, CHECKS
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.problem import Problem
from drivesizer.search.columns.evaluation import Evaluation
from drivesizer.search.uncertainty import uncertain_figures
from drivesizer.search.uncertainty.options import POOL, Sampling
from drivesizer.search.uncertainty.prepare import Prepared, blocks, prepared
from drivesizer.search.uncertainty.sampled_drive import Block, SetRows, checks_of, figure_columns
from drivesizer.search.uncertainty.sampling import (
    Sample,
    first_order,
    mean_and_error,
    rank_correlations,
    sample,
    values_of,
)
from drivesizer.search.uncertainty.uncertain_figures import Assumption
from drivesizer.spec.robot import RobotSpec

# -- Drives over samples: probability that all checks pass, the checks that fail, and the assumptions that matter most.


Array = NDArray[np.float64]
_QUANTILES = (0.05, 0.5, 0.95)
_KEPT = 1_000_000  # segments times samples that are kept in memory for all drives
_TOGETHER = 8  # drives whose samples are held at a time


class Subject(NamedTuple):
    """A drive that is sampled, with its checks at nominal figures."""

    rows: SetRows
    nominal: tuple[Check, ...]


class Examined(NamedTuple):
    """Result of the samples of a drive."""

    reliability: Reliability
    smallest: Array  # margin of each sample, over all checks that have one


class Over(NamedTuple):
    """One check over all samples."""

    passed: NDArray[np.bool_]
    failed: NDArray[np.bool_]
    margin: Array  # NaN where there is none
    tightness: Array


def over_samples(checks: Sequence[Check | None]) -> Over:
    """A check of each sample; where a sample has none there is nothing to fail."""
    known = [(one.status == "pass", one.status == "fail", one.margin, _tightness(one)) if one
             else (True, False, math.inf, math.inf) for one in checks]  # fmt: skip
    return Over(*(np.array(column) for column in zip(*known, strict=True)))


def _tightness(check: Check) -> float:
    return math.inf if math.isnan(check.margin) or (check.by_choice and check.status == "pass") else check.margin


def examined(given: Prepared, catalog: Catalog, subjects: Sequence[Subject], processes: int = 1) -> list[Examined]:
    """Checks of drives over all samples."""
    if processes > 1 and len(subjects) > 1:
        return by_processes(examined, given, catalog, subjects, processes)
    kept = [*blocks_of(given, catalog, subjects)] if given.cells <= _KEPT else None
    found: list[Examined] = []
    for first in range(0, len(subjects), _TOGETHER):
        some = subjects[first : first + _TOGETHER]
        parts: list[list[dict[str, Over]]] = [[] for _ in some]
        for block in kept or blocks_of(given, catalog, subjects):
            for part, one in zip(parts, some, strict=True):
                part.append({n: _over(c, block.size) for n, c in checks_of(catalog, one.rows, block).items()})
        found += [_reduced(one, part) for one, part in zip(some, parts, strict=True)]
    return found


def blocks_of(given: Prepared, catalog: Catalog, subjects: Sequence[Subject]) -> Iterator[Block]:
    """The samples in blocks, ready for some drives."""
    return blocks(given, catalog, sorted({one.rows.belt for one in subjects}))


Found = TypeVar("Found")


def by_processes(
    function: Callable[[Prepared, Catalog, Sequence[Subject]], list[Found]],
    given: Prepared, catalog: Catalog, subjects: Sequence[Subject], processes: int,
) -> list[Found]:  # fmt: skip
    """Results of a function for drives, by several processes, each with some of them."""
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    share = -(-len(subjects) // processes)
    parts = [subjects[first : first + share] for first in range(0, len(subjects), share)]
    with ProcessPoolExecutor(len(parts), mp_context=get_context("spawn")) as pool:
        found = list(pool.map(function, [given] * len(parts), [catalog] * len(parts), parts))
    return [one for part in found for one in part]


_OF_A_FACTOR = ("pull_out_torque",)  # whose margin is required to be some 100 %: what exceeds that is the tight part


def _over(check: CheckColumn, count: int) -> Over:
    """A check over samples; of the pull-out torque the tightness is what exceeds the required factor."""
    margin = check.margin
    tight = check.tight(margin)
    if check.name in _OF_A_FACTOR:
        tight = (1.0 + tight) / (1.0 + check.needed) - 1.0
    return Over._make(np.broadcast_to(x, count) for x in (check.passed, check.failed, margin, tight))


def _reduced(one: Subject, parts: Sequence[Mapping[str, Over]]) -> Examined:
    """Reliability of a drive from its samples; checks that no sample changes are as they are nominally."""
    joined = {
        name: over if len(parts) == 1 else Over(*map(np.concatenate, zip(*(part[name] for part in parts), strict=True)))
        for name, over in parts[0].items()
    }
    count = len(next(iter(joined.values())).passed)
    every, titles = dict[str, Over](), dict[str, str]()
    for check in one.nominal:
        if not check.advice:
            alone = Over._make(np.broadcast_to(x, count) for x in over_samples([check]))
            every[check.name], titles[check.name] = joined.get(check.name) or alone, check.title
    every |= {name: joined[name] for name in BATTERY_SAMPLED if name in joined}
    titles |= {name: CHECKS["budget"][name].title for name in BATTERY_SAMPLED}
    return reduced(every, titles)


def reduced(every: Mapping[str, Over], titles: Mapping[str, str]) -> Examined:
    """Reliability of several checks together."""
    count = len(next(iter(every.values())).passed)
    failed, smallest, place = np.zeros(count, bool), np.full(count, np.inf), np.full(count, -1)
    for number, over in enumerate(every.values()):
        failed |= over.failed
        tighter = over.tightness < smallest
        if tighter.any():  # few checks are ever the tightest
            place[tighter] = number
            smallest = np.minimum(smallest, over.tightness)
    weakest = np.bincount(place + 1, minlength=len(every) + 1)[1:] / count
    spreads = []
    for (name, over), tightest in zip(every.items(), weakest, strict=True):
        low, middle, high = quantiles(over.margin)
        spreads.append(Spread(
            name=name, title=titles[name], passes=np.count_nonzero(over.passed) / count,
            fails=np.count_nonzero(over.failed) / count, weakest=float(tightest), low=low, middle=middle, high=high,
        ))  # fmt: skip
    share = mean_and_error(~failed)
    low, middle, high = quantiles(smallest)
    return Examined(
        Reliability(
            probability=share.value,
            error=share.error,
            unknown=tuple(s.title for s in spreads if s.passes + s.fails < 1.0),
            weakest=max(spreads, key=lambda s: (s.fails, s.weakest)).title,
            low=low,
            middle=middle,
            high=high,
            checks=tuple(spreads),
        ),
        smallest,
    )


def quantiles(values: Array) -> tuple[float, float, float]:
    """The values that 5 %, 50 % and 95 % of all lie below."""
    least = float(values.min())
    if least != least or least == values.max():  # NaN, or all the same
        return (least,) * 3
    places = [int(q * len(values)) for q in _QUANTILES]
    low, middle, high = np.partition(values, places)[places].tolist()
    return low, middle, high


# --- sensitivity


def counting(one: Subject, catalog: Catalog, spec: RobotSpec, given: Sequence[Assumption]) -> list[int]:
    """Numbers of the assumptions that count for a drive: the spec's, and the classes that hold for its parts."""
    rows = one.rows.motor, one.rows.gearhead, one.rows.controller
    held = uncertain_figures.holding_of_a_set(catalog, spec.tolerances.given, *rows)
    return [k for k, assumption in enumerate(given) if assumption.catalogue is None or assumption.catalogue in held]


def at_ends(problem: Problem, given: Sequence[Assumption]) -> Prepared:
    """The nominal figures, then two samples an assumption, it alone varied: at its 5 % and at its 95 % quantile."""
    values = np.tile([assumption.nominal for assumption in given], (1 + 2 * len(given), 1))
    ends = values_of(given, np.tile([[0.05], [0.95]], len(given)))
    for k in range(len(given)):
        values[_ends(k), k] = ends[:, k]
    return prepared(problem, given, values, every=True)


def _ends(k: int) -> slice:
    """The rows in which the assumption of that number is varied."""
    return slice(1 + 2 * k, 3 + 2 * k)


def drivers(one: Subject, catalog: Catalog, ends: Prepared, sample: Sample, smallest: Array) -> tuple[Driver, ...]:
    """Effect of each assumption on the smallest margin of a drive, the largest first."""
    known, own = np.isfinite(smallest), counting(one, catalog, ends.spec, ends.given)
    if not own:
        return ()
    values = sample.values[known][:, own]
    shares = first_order(values, smallest[known])
    signs = rank_correlations(values, smallest[known])
    margins, found = _smallest(one, catalog, ends), []
    for k, share, sign in zip(own, shares.tolist(), signs.tolist(), strict=True):
        assumption = ends.given[k]
        (low, high), (low_margin, high_margin) = ends.values[_ends(k), k], margins[_ends(k)].tolist()
        found.append(Driver(
            name=assumption.name, title=assumption.title, share=share, rank_correlation=sign, low_margin=low_margin,
            high_margin=high_margin, low=assumption.shown(low), high=assumption.shown(high),
        ))  # fmt: skip
    return tuple(sorted(found, key=lambda driver: (-driver.share, driver.name)))


def _smallest(one: Subject, catalog: Catalog, given: Prepared) -> Array:
    """Smallest margin of a drive in each sample; checks that no sample changes are at nominal figures."""
    parts = []
    for block in blocks(given, catalog, [one.rows.belt]):
        tight = {check.name: np.asarray(_tightness(check)) for check in one.nominal if not check.advice}
        for name, check in checks_of(catalog, one.rows, block).items():
            if name in tight or name in BATTERY_SAMPLED:
                tight[name] = _over(check, block.size).tightness
        parts.append(np.min([np.broadcast_to(column, block.size) for column in tight.values()], axis=0))
    return np.concatenate(parts)


def without_effect(drives: Sequence[Subject], catalog: Catalog, ends: Prepared) -> list[Assumption]:
    """Figures of the spec that leave every sampled check of some drives as it is."""
    changed = np.zeros(len(ends.values), bool)
    for one in drives:
        first: dict[str, list[Array]] = {}
        row = 0
        for block in blocks(ends, catalog, [one.rows.belt]):
            for name, check in checks_of(catalog, one.rows, block).items():
                columns = [np.broadcast_to(x, block.size) for x in (check.demand, check.limit)]
                nominal = first.setdefault(name, [column[:1] for column in columns])
                for column, figure in zip(columns, nominal, strict=True):
                    changed[row : row + block.size] |= (column != figure) & ~(np.isnan(column) & np.isnan(figure))
            row += block.size
    return [one for k, one in enumerate(ends.given) if one.given is not None and not changed[_ends(k)].any()]


# -- Figures of one drive over samples: current, voltage, power, heat, temperature, free speed and stall torque.
#
# They are those of the same samples as the checks, in each sample of its worst load case.


_FIGURES = {
    "rms_current": ("Motor current, RMS", "current", "A"),
    "peak_current": ("Motor current, peak", "current", "A"),
    "voltage": ("Motor voltage, peak", "voltage", "V"),
    "power": ("Supply power, peak, all drives", "power", "W"),
    "joule_heat": ("Heat of the winding, mean", "power", "W"),
    "winding_temperature": ("Winding temperature, peak", "temperature", "degC"),
    "free_speed": ("Free speed at the load's shaft", "rotary_speed", "rpm"),
    "stall_torque": ("Stall torque at the load's shaft", "torque", "N*m"),
}
_OF_STEPPERS = {
    "motor_torque": ("Motor torque, peak", "torque", "N*m"),
    "pull_out_at_rest": ("Pull-out torque at low speed", "torque", "N*m"),
    "pull_out_at_speed": ("Pull-out torque at the highest speed", "torque", "N*m"),
    "power": _FIGURES["power"],
    "joule_heat": ("Heat of both windings", "power", "W"),
    "peak_current": ("Amplitude of the phase current", "current", "A"),
}


def figure_spreads(given: Prepared, catalog: Catalog, one: SetRows) -> tuple[FigureSpread, ...]:
    """Percentiles of the figures of a drive."""
    each = [figure_columns(catalog, one, block) for block in blocks(given, catalog, [one.belt])]
    found = []
    for name, (title, kind, unit) in (_OF_STEPPERS if has_steppers(catalog) else _FIGURES).items():
        low, middle, high = quantiles(np.concatenate([columns[name] for columns in each]))
        found.append(FigureSpread(name=name, title=title, kind=kind, unit=unit, low=low, middle=middle, high=high))
    return tuple(found)


# -- Reliability of a sizing's drives: in how many samples each passes, and what decides it.


Failed = NDArray[np.bool_]


def failing(given: Prepared, catalog: Catalog, subjects: Sequence[Subject], processes: int = 1) -> list[Failed]:
    """Whether some check fails, of each drive in each sample; a check that no sample changes is as it is nominally."""
    if processes > 1 and len(subjects) > 1:
        return by_processes(failing, given, catalog, subjects, processes)
    parts: list[list[Failed]] = [[] for _ in subjects]
    for block in blocks_of(given, catalog, subjects):
        for part, one in zip(parts, subjects, strict=True):
            found = checks_of(catalog, one.rows, block)
            decide = {check.name: check.status for check in one.nominal if not check.advice}
            failed = np.full(block.size, any(status == "fail" for name, status in decide.items() if name not in found))
            for name in {*decide, *BATTERY_SAMPLED} & found.keys():
                failed |= found[name].failed
            part.append(failed)
    return [np.concatenate(part) for part in parts]


class SampledDrives(NamedTuple):
    """Drives over samples, by their rows in the result of the search."""

    good: list[int]  # in their order; with a required confidence those that reach it
    bad: list[int]  # that do not, the most reliable first
    subjects: dict[int, Subject]  # both
    ready: Prepared
    drawn: Sample
    how: Sampling
    ends: Prepared | None  # one figure varied at a time; None where the probabilities are all that is wanted

    def examined(self, rows: Collection[int]) -> dict[int, Examined]:
        """Probability, and every check over the samples, of some of them."""
        some = [self.subjects[row] for row in rows]
        found = examined(self.ready, self.ready.problem.catalog, some, self.how.processes)
        return dict(zip(rows, found, strict=True))


def sample_drives(
    problem: Problem, subjects: Mapping[int, Subject], how: Sampling, *, brief: bool = False
) -> SampledDrives:
    """Reliability of drives."""
    rows = [(one.rows.motor, one.rows.gearhead, one.rows.controller) for one in subjects.values()]
    catalog, machine = problem.catalog, problem.machine
    held = uncertain_figures.used(catalog, machine.tolerances.given, rows)
    if machine.needs.start_speed is None:
        held = tuple(one for one in held if one.figure != "start_speed")  # no check depends on it
    given = uncertain_figures.assumptions(machine, held)
    drawn = sample(given, how.samples, how.seed, uncertain_figures.assumptions(machine))
    ready = prepared(problem, given, drawn.values)
    good, bad = _divided(ready, subjects, how)
    ends = None if brief else at_ends(problem, given)
    return SampledDrives(good, bad, {**subjects}, ready, drawn._replace(values=ready.values), how, ends)


def _divided(ready: Prepared, subjects: Mapping[int, Subject], how: Sampling) -> tuple[list[int], list[int]]:
    """Rows of drives that reach the required confidence, and of those that do not, the most reliable first."""
    if how.confidence is None:
        return [*subjects], []
    failed = failing(ready, ready.problem.catalog, [*subjects.values()], how.processes)
    share = {row: float((~one).mean()) for row, one in zip(subjects, failed, strict=True)}
    good = [row for row in subjects if share[row] >= how.confidence]
    return good, sorted((row for row in subjects if row not in good), key=lambda row: -share[row])


def subject(evaluation: Evaluation, row: int, beside: tuple[Check, ...] = ()) -> Subject:
    """A drive that a search found, with its checks by physics."""
    given = evaluation.candidates
    rows = SetRows(
        int(given.motor[row]), int(given.gearhead[row]), int(evaluation.encoder[row]), int(evaluation.controller[row]),
        float(given.belt[row]), int(evaluation.brake[row]),
    )  # fmt: skip
    return Subject(rows, tuple(c for c in (*evaluation.checks_of(row), *beside) if c.method == "physics"))


def reliabilities(
    sampled: SampledDrives, rows: Collection[int], finalists: Mapping[int, DriveParts]
) -> dict[int, Reliability]:
    """Reliability of drives, with the sensitivities of each unless they were sampled in brief."""
    catalog, ends, described = sampled.ready.problem.catalog, sampled.ends, {}
    for row, found in sampled.examined(rows).items():
        described[row], one = found.reliability, sampled.subjects[row]
        if ends is None:
            continue
        matters = drivers(one, catalog, ends, sampled.drawn, found.smallest)
        figures = figure_spreads(sampled.ready, catalog, one.rows)
        described[row] = replace(described[row], drivers=matters, figures=figures)
        if row in finalists and sampled.how.loop > 0 and not sampled.ready.spec.steps:
            described[row] = _in_the_loop(sampled, one, finalists[row], described[row])
    return described


def _in_the_loop(sampled: SampledDrives, examined_: Subject, one: DriveParts, found: Reliability) -> Reliability:
    """With the share of samples that pass in closed loop, or why there is none: the model may lack a figure."""
    from drivesizer.search.uncertainty.sampled_closed_loop import loop_share

    ready = sampled.ready
    own = counting(examined_, ready.problem.catalog, ready.spec, ready.given)
    values = sampled.drawn.values[:, own]
    try:
        share = loop_share(ready.spec, one, [ready.given[k] for k in own], values, sampled.how.loop)
    except InputError as error:
        return replace(found, no_loop=str(error))
    return replace(found, loop=share)


def uncertainty(one: SampledDrives) -> Uncertainty:
    """Assumptions and samples, which all drives have in common."""
    return Uncertainty(
        assumptions=tuple(_uncertain(given) for given in one.ready.given),
        samples=one.drawn.size,
        seed=one.how.seed,
        confidence=one.how.confidence,
        examined=len(one.subjects),
        reached=len(one.good),
        notes=(*_notes(one.ready, one.how, len(one.subjects)), *_idle(one)),
    )


def _uncertain(one: Assumption) -> Uncertain:
    text = one.given.text if one.given else one.catalogue.text if one.catalogue else ""
    title = one.name if one.given else one.catalogue.title if one.catalogue else one.name
    return Uncertain(name=one.name, title=title, text=text, source=one.catalogue.why if one.catalogue else "spec")


def _notes(ready: Prepared, how: Sampling, examined_: int) -> tuple[str, ...]:
    """Notes on the basis of the probabilities."""
    deviating = (
        "a stepper's driver is held against the current that is set, not against what it is off"
        if ready.spec.steps
        else "the voltage drop of the controller goes with its losses"
    )
    notes = [
        f"limits are the catalogue's, as printed, but {deviating}; "
        "encoder and controller are those of the nominal drive; all drives of the machine deviate alike",
        "the probability is that no check of the physics fails, nor the battery's autonomy, range, peak and voltage; "
        "other budgets of the machine are at nominal figures",
    ]
    if ready.spec.method == "paper":
        notes.append("the paper's factors do not enter: the sampled checks are those of the physics beside it")
    if len(ready.values) < how.samples:
        notes.append(f"load cycles take long to compute here: {len(ready.values)} samples, not {how.samples}")
    if ready.spec.steps:
        notes.append("of the pull-out torque the smallest margin counts what exceeds the required factor")
    if ready.spec.steps and how.loop > 0:
        notes.append("steppers run open-loop: they are not sampled in closed loop")
    if isinstance(ready.spec.load, WheelLoad):
        notes.append("platforms on a path are not sampled in closed loop; peaks and voltage of the battery are nominal")
    if how.confidence is not None and examined_ >= POOL:
        notes.append(f"only the best {POOL} drives that meet all limits at nominal figures were sampled")
    return tuple(notes)


_LOOKED_AT = 3  # drives


def _idle(one: SampledDrives) -> list[str]:
    """Notes on tolerances of the spec that change no sampled check of the first drives, each reason once."""
    if one.ends is None:
        return []
    drives = [*one.subjects.values()][:_LOOKED_AT]
    by_reason: dict[str, list[str]] = {}
    for figure in without_effect(drives, one.ready.problem.catalog, one.ends):
        looped = (
            one.how.confidence is not None and one.how.loop > 0 and figure.given and figure.given.path[0] == "plant"
        )
        if figure.given and not looped:
            by_reason.setdefault(uncertain_figures.reason(figure.given.path), []).append(figure.name)
    return [
        f"no sampled check depends on {', '.join(names)}: that tolerance has no effect here{f'; {why}' if why else ''}"
        for why, names in by_reason.items()
    ]
