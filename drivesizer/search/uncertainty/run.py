"""Reliability of a sizing's drives: in how many samples each passes, and what decides it."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.errors import InputError
from drivesizer.load_cases.platform import WheelLoad
from drivesizer.results.check import Check, Reliability, Uncertain, Uncertainty
from drivesizer.results.check_kinds import BATTERY_SAMPLED
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.problem import Problem
from drivesizer.search.columns.evaluation import Evaluation
from drivesizer.search.uncertainty.options import POOL, Sampling
from drivesizer.search.uncertainty.prepare import Prepared, prepared
from drivesizer.search.uncertainty.probabilities import (
    Examined,
    Subject,
    at_ends,
    blocks_of,
    by_processes,
    counting,
    drivers,
    examined,
    figure_spreads,
    without_effect,
)
from drivesizer.search.uncertainty.sampled_checks import checks_of
from drivesizer.search.uncertainty.sampled_parts import SetRows
from drivesizer.search.uncertainty.sampling import Sample, sample
from drivesizer.search.uncertainty.uncertain_figures import Assumption, assumptions, reason, used

__all__ = ["SampledDrives", "failing", "reliabilities", "sample_drives", "subject", "uncertainty"]


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
    held = used(catalog, machine.tolerances.given, rows)
    if machine.needs.start_speed is None:
        held = tuple(one for one in held if one.figure != "start_speed")  # no check depends on it
    given = assumptions(machine, held)
    drawn = sample(given, how.samples, how.seed, assumptions(machine))
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
            by_reason.setdefault(reason(figure.given.path), []).append(figure.name)
    return [
        f"no sampled check depends on {', '.join(names)}: that tolerance has no effect here{f'; {why}' if why else ''}"
        for why, names in by_reason.items()
    ]
