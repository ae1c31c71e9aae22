"""Drives over samples: probability that all checks pass, the figures of each, the assumptions that matter most."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.view.mounted import has_steppers
from drivesizer.physics.at_voltage import Winding, operating_point
from drivesizer.physics.drive_train import friction, gear_loss
from drivesizer.physics.thermal import resistance_25, resistance_at
from drivesizer.physics.winding import Parts
from drivesizer.results.check import Check, Driver, FigureSpread, Reliability, Spread
from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.check_kinds import BATTERY_SAMPLED, CHECKS
from drivesizer.results.problem import Problem
from drivesizer.search.uncertainty.prepare import Prepared, blocks, prepared
from drivesizer.search.uncertainty.sampled_checks import Loaded, checks_of, loaded, pull_out_of
from drivesizer.search.uncertainty.sampled_parts import Block, SetRows, parts_of, stepper_figures
from drivesizer.search.uncertainty.sampling import Sample, first_order, mean_and_error, rank_correlations, values_of
from drivesizer.search.uncertainty.uncertain_figures import Assumption, holding_of_a_set
from drivesizer.spec.robot import RobotSpec

__all__ = [
    "Examined", "Over", "Subject", "at_ends", "blocks_of", "by_processes", "counting", "drivers", "examined",
    "figure_columns", "figure_spreads", "over_samples", "quantiles", "reduced", "without_effect",
]  # fmt: skip


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
    known = [(one.status == "pass", one.status == "fail", one.margin, _tightness(one)) if one else _NOTHING
             for one in checks]  # fmt: skip
    passed, failed, margin, tight = (np.array(column) for column in zip(*known, strict=True))
    return Over(passed, failed, margin, tight)


_NOTHING = True, False, math.inf, math.inf


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


def _over(check: CheckColumn, count: int) -> Over:
    """Figures that are kept of a check; one figure where all samples have the same."""
    margin = check.margin
    figures = check.passed, check.failed, margin, _beyond(check, margin)
    return Over(*(_as_many(x, count) for x in figures))


_OF_A_FACTOR = ("pull_out_torque",)  # whose margin is required to be some 100 %: what exceeds that is the tight part


def _beyond(check: CheckColumn, margin: Array) -> Array:
    """Tightness of a check over samples; of the pull-out torque by what it exceeds the required factor."""
    tight = check.tight(margin)
    return (1.0 + tight) / (1.0 + check.needed) - 1.0 if check.name in _OF_A_FACTOR else tight


def _as_many(column: NDArray[Any], count: int) -> NDArray[Any]:
    """A column of so many samples; of a single figure a view."""
    return column if column.shape == (count,) else np.broadcast_to(column, count)


def _constant(check: Check, count: int) -> Over:
    """A check that no sample changes."""
    figures = (check.status == "pass", check.status == "fail", check.margin, _tightness(check))
    return Over(*(np.broadcast_to(np.asarray(x), count) for x in figures))


def _reduced(one: Subject, parts: Sequence[Mapping[str, Over]]) -> Examined:
    """Reliability of a drive from its samples."""
    joined = (
        parts[0] if len(parts) == 1 else {name: _one_after_the_other([p[name] for p in parts]) for name in parts[0]}
    )
    count = len(next(iter(joined.values())).passed)
    decide = [check for check in one.nominal if not check.advice]
    every = {check.name: joined.get(check.name) or _constant(check, count) for check in decide}
    every |= {name: joined[name] for name in BATTERY_SAMPLED if name in joined}
    titles = {check.name: check.title for check in decide}
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
    spreads = [
        _spread(name, titles[name], over, float(w)) for (name, over), w in zip(every.items(), weakest, strict=True)
    ]
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


def _one_after_the_other(parts: Sequence[Over]) -> Over:
    return Over(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def _tightness(check: Check) -> float:
    return math.inf if math.isnan(check.margin) or (check.by_choice and check.status == "pass") else check.margin


def _spread(name: str, title: str, over: Over, weakest: float) -> Spread:
    low, middle, high = quantiles(over.margin)
    return Spread(
        name=name, title=title, passes=np.count_nonzero(over.passed) / len(over.passed),
        fails=np.count_nonzero(over.failed) / len(over.failed),
        weakest=weakest, low=low, middle=middle, high=high,
    )  # fmt: skip


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
    held = holding_of_a_set(catalog, spec.tolerances.given, one.rows.motor, one.rows.gearhead, one.rows.controller)
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
    margins = _smallest(one, catalog, ends)
    found = [_driver(ends, k, float(shares[n]), float(signs[n]), margins) for n, k in enumerate(own)]
    return tuple(sorted(found, key=lambda driver: (-driver.share, driver.name)))


def _driver(ends: Prepared, k: int, share: float, sign: float, margins: Array) -> Driver:
    """The assumption of that number."""
    assumption = ends.given[k]
    (low, high), (low_margin, high_margin) = ends.values[_ends(k), k], margins[_ends(k)]
    return Driver(
        name=assumption.name, title=assumption.title, share=share, rank_correlation=sign,
        low_margin=float(low_margin), high_margin=float(high_margin),
        low=assumption.shown(low), high=assumption.shown(high),
    )  # fmt: skip


def _smallest(one: Subject, catalog: Catalog, given: Prepared) -> Array:
    """Smallest margin of a drive in each sample; checks that no sample changes are at nominal figures."""
    parts = []
    for block in blocks(given, catalog, [one.rows.belt]):
        tight = {check.name: np.asarray(_tightness(check)) for check in one.nominal if not check.advice}
        found = checks_of(catalog, one.rows, block)
        counted = (name for name in found if name in tight or name in BATTERY_SAMPLED)
        tight |= {name: _beyond(found[name], found[name].margin) for name in counted}
        parts.append(np.min([np.broadcast_to(column, block.size) for column in tight.values()], axis=0))
    return np.concatenate(parts)


def without_effect(drives: Sequence[Subject], catalog: Catalog, ends: Prepared) -> list[Assumption]:
    """Figures of the spec that leave every sampled check of some drives as it is."""
    changed = np.zeros(len(ends.values), bool)
    for one in drives:
        first: dict[str, tuple[Array, Array]] = {}
        row = 0
        for block in blocks(ends, catalog, [one.rows.belt]):
            for name, check in checks_of(catalog, one.rows, block).items():
                columns = _as_many(check.demand, block.size), _as_many(check.limit, block.size)
                nominal = first.setdefault(name, (columns[0][:1], columns[1][:1]))
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
_LEAST = ("free_speed", "stall_torque", "pull_out_at_rest", "pull_out_at_speed")  # the worst load case has the smallest


def figure_spreads(given: Prepared, catalog: Catalog, one: SetRows) -> tuple[FigureSpread, ...]:
    """Percentiles of the figures of a drive."""
    each = [figure_columns(catalog, one, block) for block in blocks(given, catalog, [one.belt])]
    found = []
    for name, (title, kind, unit) in (_OF_STEPPERS if has_steppers(catalog) else _FIGURES).items():
        low, middle, high = quantiles(np.concatenate([columns[name] for columns in each]))
        found.append(FigureSpread(name=name, title=title, kind=kind, unit=unit, low=low, middle=middle, high=high))
    return tuple(found)


def figure_columns(catalog: Catalog, one: SetRows, block: Block) -> dict[str, Array]:
    """Figures of a drive, sample by sample."""
    parts, factors = parts_of(catalog, one, block)
    found: dict[str, Array] = {}
    for spec, ats in zip(block.specs, block.ats, strict=True):
        if has_steppers(catalog):
            figures = stepper_figures(spec, ats[one.belt], parts, pull_out_of(catalog, parts, factors))
        else:
            case = loaded(spec, ats[one.belt], parts, factors, energies=True)
            with np.errstate(divide="ignore", invalid="ignore"):
                figures = _demanded(spec, case) | _at_full_voltage(spec, parts, one.belt)
        for name, column in figures.items():
            values = np.array(np.broadcast_to(column, block.size))
            worse = np.minimum if name in _LEAST else np.maximum
            found[name] = worse(found[name], values) if name in found else values
    return found


def _demanded(spec: Any, case: Loaded) -> dict[str, Any]:
    """Figures that the load cycle makes; unknown where only a least demand is known."""
    known, (low, high) = case.required.complete, case.over_time
    over_time = low.agreed(high)
    copper = np.where(np.isnan(over_time.winding), np.nan, over_time.copper)  # bounds of it are not kept
    figures = {
        "rms_current": case.required.rms_current, "peak_current": case.peaks.current.value,
        "voltage": over_time.voltage, "power": over_time.power * spec.load.motors,
        "joule_heat": copper, "winding_temperature": over_time.winding,
    }  # fmt: skip
    return {name: np.where(known, column, np.nan) for name, column in figures.items()}


def _at_full_voltage(spec: Any, parts: Parts, belt: float) -> dict[str, Any]:
    """Free speed [rad/s] and stall torque [N*m] of one drive at the nominal supply, winding at the ambient."""
    motor, gearhead, feed = parts.motor, parts.gearhead, spec.feed(parts.controller, parts.brake)
    feed = feed._replace(voltage=spec.supply.nominal)
    cold = resistance_at(resistance_25(motor), spec.environment.ambient) + (feed.leads if spec.resists else 0.0)
    k_t, (dry, viscous), (efficiency, idle) = motor["torque_constant"], friction(motor), gear_loss(gearhead)
    winding = Winding(cold, np.nan, k_t, motor["back_emf_constant"])
    speed, _ = operating_point(winding, feed.usable, dry + idle, viscous)
    stalled = np.fmin(feed.usable / cold, parts.controller["peak_current"])
    ratio = gearhead["ratio"] * belt
    held = np.maximum(k_t * stalled - dry - idle, 0.0) * ratio * efficiency * spec.belt_efficiency
    return {"free_speed": np.maximum(speed, 0.0) / ratio, "stall_torque": np.where(np.isnan(feed.usable), np.nan, held)}
