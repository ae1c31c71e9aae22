"""One belt's candidates against the whole of physics: in stages, the cheap ones first, or all of it for a few.

The same checks serve both: the search drops what fails at each stage, so that only survivors meet the next; a set that
is shown or explained goes through them all. In several load cases each check is that of its worst case, and one
controller must do for all of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer import waveform_limits as wave
from drivesizer.candidates import Candidates, Rows
from drivesizer.catalog import Catalog
from drivesizer.checks import CheckColumn, fits, worst_case
from drivesizer.choose import Chosen, Speeds, Usable, controllers, usable_controllers
from drivesizer.encoder_choice import Offered, counts_check, encoders_for, offered_encoders
from drivesizer.loads import load_cycle
from drivesizer.physics import AtGearhead, Demands, at_gearhead, demands
from drivesizer.physics_limits import (
    Heat,
    Parts,
    Stress,
    electrical_limits,
    electrical_speed,
    gearhead_limits,
    heat,
    line_frequency,
    load_limits,
    motor_limits,
    moving_limits,
    on,
    size_limits,
    stress,
)
from drivesizer.sieve import Alone, Sieve
from drivesizer.spec import RobotSpec
from drivesizer.wheel_load import machine_cases

__all__ = ["Examined", "Problem", "doubted", "examine", "problem"]

Array = NDArray[np.float64]
_LONG = 256  # pieces of a cycle, from where blocks of it decide sooner than the cycle itself
_BLOCKS = (64, 1024)
_PIECES = (1024, 8192)


class Problem(NamedTuple):
    """A spec with its load cycles at hand."""

    spec: RobotSpec
    catalog: Catalog
    names: tuple[str, ...]  # of the load cases
    specs: tuple[RobotSpec, ...]
    bases: tuple[Any, ...]  # their cycles, behind a belt of no ratio
    offered: Offered  # encoders of every motor
    usable: Usable  # controllers of every motor


def problem(spec: RobotSpec, catalog: Catalog) -> Problem:
    """The load cycle of every case, and the encoders and controllers of every motor."""
    names, specs = zip(*spec.load_cases, strict=True)
    constants = catalog.motors["winding_time_constant"]
    quickest = float(np.nanmin(constants, initial=np.inf))
    bases = tuple(at_gearhead(load_cycle(case), case.belt_efficiency, quickest) for case in specs)
    supply = min(s.supply.lowest for s in specs), max(s.supply.highest for s in specs)
    usable = usable_controllers(spec, catalog, supply)
    return Problem(spec, catalog, names, specs, bases, offered_encoders(spec, catalog), usable)


class Examined(NamedTuple):
    """What was found of the candidates that came through, in their order."""

    rows: NDArray[np.int64]  # which candidates these are
    checks: list[CheckColumn]  # theirs; in stages none are kept
    doubtful: NDArray[np.bool_]  # a check is unknown
    margin: Array  # the smallest; NaN where it was not asked for
    encoder: NDArray[np.int64]
    controller: NDArray[np.int64]
    figures: dict[str, Array]  # what objectives count, SI
    failed_by: Counter[str]  # of all candidates, as far as they were examined
    fallen: NDArray[np.int64]  # candidates that fell, of which the nearest are told
    bound: Array  # their smallest margin is no better than this


class _Moving(NamedTuple):
    """The columns of one load case."""

    asked: Demands
    warm: Heat


def examine(
    given: Problem, belt: float, sets: Candidates, *, staged: bool, exact: bool = True, margins: bool = False
) -> Examined:
    """Candidates behind one belt against every limit.

    Parameters
    ----------
    given
        The spec and its load cycles.
    belt
        Ratio of the belt.
    sets
        The candidates; their own belt column is not looked at.
    staged
        Drop what fails at each stage.
    exact
        Compute the waveform of all that come so far; else only of those that safe bounds leave undecided.
    margins
        Tell the smallest margin of each.
    """
    ats = [base.behind(belt) for base in given.bases]
    sieve = Sieve(sets, staged, margins)
    sieve.parts(_alone(given, ats, staged))
    motor = Rows(given.catalog.motors, sets.motor[sieve.rows])
    gearhead = Rows(given.catalog.gearheads, sets.gearhead[sieve.rows])
    listed = fits("compatibility", True, sets.listed[sieve.rows])
    keep = sieve.through([listed, *size_limits(given.spec, motor, gearhead)])
    motor, gearhead = motor.on(keep), gearhead.on(keep)
    encoder = _encoders(given, ats, motor.rows, gearhead["ratio"])
    if not staged:  # in stages each motor was judged by what there is for it
        sieve.through(counts_check(given.spec, given.catalog, encoder))
    parts = Parts(motor, gearhead, Rows(given.catalog.encoders, encoder), None)
    cases = [_moving(spec, at, parts) for spec, at in zip(given.specs, ats, strict=True)]
    keep = sieve.through(
        _each(given, lambda k: doubted(moving_limits(given.specs[k], ats[k], *cases[k], parts), cases[k].asked.sure))
    )
    cases, parts = [on(case, keep) for case in cases], parts.on(keep)
    return _powered(given, ats, cases, parts, sieve, exact)


_OF_THE_CURRENT = {
    "motor_nominal_current", "winding_temperature", "inertia_ratio", "first_resonance", "motor_peak_torque",
    "supply_voltage", "controller_continuous_current", "controller_peak_current", "controller_peak_time",
    "supply_current", "supply_power",
}  # fmt: skip


def doubted(checks: list[CheckColumn], sure: NDArray[np.bool_]) -> list[CheckColumn]:
    """The checks, of which those that hang on an unknown inertia may fail but not pass."""
    if sure.all():
        return checks
    return [replace(c, passed=c.passed & sure) if c.name in _OF_THE_CURRENT else c for c in checks]


def _each(given: Problem, checks: Callable[[int], list[CheckColumn]]) -> list[CheckColumn]:
    """The worst case of each check, of the load cases that have it."""
    found: dict[str, list[tuple[int, CheckColumn]]] = {}
    for number in range(len(given.specs)):
        for check in checks(number):
            found.setdefault(check.name, []).append((number, check))
    return [worst_case(same) for same in found.values()]


def _moving(spec: RobotSpec, at: AtGearhead, parts: Parts) -> _Moving:
    asked = demands(at, parts.motor, parts.gearhead, parts.encoder)
    return _Moving(asked, heat(spec, at, asked, parts.motor))


def _encoders(given: Problem, ats: Sequence[AtGearhead], motor: NDArray[np.int64], ratio: Array) -> NDArray[np.int64]:
    """An encoder for each candidate that does in the fastest of all cases."""
    fastest = max(at.peak_speed * (1.0 + spec.margins.speed) for spec, at in zip(given.specs, ats, strict=True))
    return encoders_for(given.spec, given.offered, motor, fastest * ratio, ratio * ats[0].belt)


def _alone(given: Problem, ats: Sequence[AtGearhead], staged: bool) -> Alone:
    """What concerns the load, a gearhead or a motor alone: once per part, not per pair.

    In stages that a motor has an encoder with the counts asked for is among it: of those enough, or of all, the most.
    """
    motors, gearheads = given.catalog.motors, given.catalog.gearheads
    counted = counts_check(given.spec, given.catalog, given.offered.last) if staged else []
    return Alone(
        _each(given, lambda k: load_limits(given.specs[k], ats[k])),
        _each(given, lambda k: gearhead_limits(given.specs[k], ats[k], gearheads)),
        [*_each(given, lambda k: motor_limits(given.specs[k], motors)), *counted],
    )


def _powered(
    given: Problem, ats: Sequence[AtGearhead], cases: list[_Moving], parts: Parts, sieve: Sieve, exact: bool
) -> Examined:
    """Current, voltage and what needs the waveform, with the smallest controller that does for all cases."""
    under = [stress(s, at, *c, parts.motor) for s, at, c in zip(given.specs, ats, cases, strict=True)]
    found = _controlled(given, ats, cases, under, parts, exact)
    short = next(check for check in found.checks if check.name == "controller_peak_time").failed & ~found.dead
    if short.any():  # one that carries the peak for ever may do where a smaller one gives out
        some = [on(c, short) for c in cases], [on(u, short) for u in under], parts.on(short)
        found = _replaced(found, short, _controlled(given, ats, *some, exact, for_ever=True))
    sieve.checks = [check for check in sieve.checks if check.name != "winding_temperature"]
    sieve.failed_by["winding_temperature"] = sieve.failed_by["winding_temperature"] if sieve.staged else 0
    keep = sieve.through(found.checks)
    figures = {name: value[keep] for name, value in found.figures.items()}
    fallen = np.concatenate([sieve.rows[:0], *(rows for rows, _ in sieve.fallen)])
    bound = np.concatenate([sieve.margin[:0], *(bound for _, bound in sieve.fallen)])
    return Examined(
        sieve.rows, sieve.checks, sieve.doubtful, sieve.margin, parts.encoder.on(keep).rows, found.controller[keep],
        figures, sieve.failed_by, fallen, bound,
    )  # fmt: skip


def _controllers(given: Problem, cases: list[_Moving], under: list[Stress], parts: Parts, for_ever: bool) -> Chosen:
    """The smallest that does in the worst of all cases, with the margins that the spec asks for."""
    more, faster = 1.0 + given.spec.margins.torque, 1.0 + given.spec.margins.speed
    rms = more * np.maximum.reduce([c.asked.rms_current for c in cases])
    largest = more * np.maximum.reduce([u.current.value for u in under])
    volts = faster * np.maximum.reduce([u.voltage.value for u in under])
    electrical = faster * np.maximum.reduce([electrical_speed(c.asked, parts.motor) for c in cases])
    lines = faster * np.maximum.reduce([line_frequency(c.asked, parts.encoder) for c in cases])
    speeds = Speeds(electrical, lines if given.spec.wants_encoder else np.zeros_like(lines))
    carried = largest if for_ever else rms
    return controllers(given.spec, given.catalog, parts.motor.rows, carried, largest, volts, speeds, given.usable)


class _Found(NamedTuple):
    controller: NDArray[np.int64]
    checks: list[CheckColumn]
    dead: NDArray[np.bool_]  # by the electrical limits already
    figures: dict[str, Array]


def _controlled(
    given: Problem,
    ats: Sequence[AtGearhead],
    cases: list[_Moving],
    under: list[Stress],
    parts: Parts,
    exact: bool,
    for_ever: bool = False,
) -> _Found:
    """With the smallest controller the electrical limits, and those of the waveform by bounds or exactly."""
    chosen = _controllers(given, cases, under, parts, for_ever)
    parts = parts._replace(controller=Rows(given.catalog.controllers, chosen.row))
    electrical = _each(
        given,
        lambda k: doubted(
            electrical_limits(given.specs[k], ats[k], cases[k].asked, under[k], parts), cases[k].asked.sure
        ),
    )
    dead: NDArray[np.bool_] = np.logical_or.reduce([check.failed for check in electrical if not check.advice])
    args = [(s, at, *c, u, parts) for s, at, c, u in zip(given.specs, ats, cases, under, strict=True)]
    found = [wave.exact(*a) if exact else _by_bounds(*a, ~dead) for a in args]
    found = [one.least(case.asked.sure, case.warm.winding) for one, case in zip(found, cases, strict=True)]
    checks = _each(given, lambda k: doubted(wave.waveform_limits(given.specs[k], found[k], parts), cases[k].asked.sure))
    figures = _where_known(_figures(given, found, under, cases), cases)
    return _Found(chosen.row, [chosen.checks[0], *electrical, *checks], dead, figures)


def _replaced(found: _Found, rows: NDArray[np.bool_], again: _Found) -> _Found:
    """What was found, of some rows what was found again."""
    checks = [old.with_rows(rows, new) for old, new in zip(found.checks, again.checks, strict=True)]
    figures = {name: _put(column, rows, again.figures[name]) for name, column in found.figures.items()}
    return _Found(_put(found.controller, rows, again.controller), checks, _put(found.dead, rows, again.dead), figures)


def _by_bounds(
    spec: RobotSpec,
    at: AtGearhead,
    asked: Demands,
    warm: Heat,
    under: Stress,
    parts: Parts,
    alive: NDArray[np.bool_],
) -> wave.Moments:
    low, high = wave.bounds(spec, at, asked, warm, under, parts)
    if len(at.base.warming.duration) > _LONG:
        low, high = _closer(spec, at, asked, warm, under, parts, alive, low, high)
    winding, above, *others = _undecided(spec, low, high, parts, alive)
    every = np.logical_or.reduce(others)
    for compute, mask in ((wave.peak_winding, winding), (wave.time_above, above & ~every), (wave.exact, every)):
        if mask.any():
            some = on(asked, mask), on(warm, mask), on(under, mask), parts.on(mask)
            few: tuple[Array | None, ...] = compute(spec, at, *some)
            high = wave.Moments(*(_put(column, mask, new) for column, new in zip(high, few, strict=True)))
    return high


def _undecided(
    spec: RobotSpec, low: wave.Moments, high: wave.Moments, parts: Parts, alive: NDArray[np.bool_]
) -> list[NDArray[np.bool_]]:
    """Of each limit, where the two bounds do not say the same."""
    both = [wave.waveform_limits(spec, side, parts) for side in (low, high)]
    return [alive & ((a.passed != b.passed) | (a.failed != b.failed)) for a, b in zip(*both, strict=True)]


def _closer(
    spec: RobotSpec,
    at: AtGearhead,
    asked: Demands,
    warm: Heat,
    under: Stress,
    parts: Parts,
    alive: NDArray[np.bool_],
    low: wave.Moments,
    high: wave.Moments,
) -> tuple[wave.Moments, wave.Moments]:
    """The same bounds, closer where they leave open the winding or the time of overload: for long cycles."""
    for count in _BLOCKS:
        mask = _undecided(spec, low, high, parts, alive)[0]
        if mask.any():
            some = on(asked, mask), on(warm, mask), parts.on(mask)
            found = wave.bracketed(at, *some, spec.environment.ambient, count)
            low, high = (m._replace(winding=_put(m.winding, mask, b)) for m, b in zip((low, high), found, strict=True))
    for count in _PIECES:
        mask = _undecided(spec, low, high, parts, alive)[1]
        if mask.any():
            found = wave.above_bounds(at, on(asked, mask), on(under, mask), parts.on(mask), count)
            low, high = (m._replace(above=_put(m.above, mask, b)) for m, b in zip((low, high), found, strict=True))
    return low, high


def _put(column: NDArray[Any], mask: NDArray[np.bool_], some: NDArray[Any] | None) -> NDArray[Any]:
    """A column with some of its rows replaced."""
    if some is None:
        return column
    changed = column.copy()
    changed[mask] = some
    return changed


def _where_known(figures: dict[str, Array], cases: list[_Moving]) -> dict[str, Array]:
    """The figures of sets whose current is known in every case: a least one may fail a check, but is no figure."""
    sure = np.logical_and.reduce([case.asked.sure for case in cases])
    return {name: np.where(sure, column, np.nan) for name, column in figures.items()}


def _figures(given: Problem, found: list[wave.Moments], under: list[Stress], cases: list[_Moving]) -> dict[str, Array]:
    """What objectives and records count: the first case's energy and heat, the largest current and temperature."""
    loads, share = [spec.load for spec in given.specs], given.spec.supply.regeneration
    machines = [numbers for _, numbers in machine_cases(zip(given.names, loads, strict=True))]
    power = [np.sum([loads[i].alike * found[i].power for i in wheels], 0) for wheels in machines]
    drawn, returned = (
        np.sum([loads[i].alike * getattr(found[i], name) for i in machines[0]], 0) for name in ("drawn", "returned")
    )
    return {
        "energy": drawn - share * returned,
        "returned": returned,
        "power": np.maximum.reduce(power),
        "joule_heat": under[0].hot * cases[0].asked.rms_current ** 2,
        "peak_current": np.maximum.reduce([u.current.value for u in under]),
        "winding_temperature": np.maximum.reduce([m.winding for m in found]),
    }
