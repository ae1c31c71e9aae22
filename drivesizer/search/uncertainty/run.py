"""From a sizing's sets to how sure each is: what is uncertain, samples, the sets over them, what matters most."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import NamedTuple

from drivesizer.catalog import Catalog
from drivesizer.errors import InputError
from drivesizer.load_cases.wheel import WheelLoad
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.problem import Problem
from drivesizer.results.reliability import Reliability, Uncertain, Uncertainty
from drivesizer.search.columns.evaluation import Evaluation
from drivesizer.search.uncertainty.class_of_part import used
from drivesizer.search.uncertainty.options import POOL, Sampling
from drivesizer.search.uncertainty.prepare import Prepared, prepared, unused
from drivesizer.search.uncertainty.probabilities import Examined, Subject, at_ends, counting, drivers, examined
from drivesizer.search.uncertainty.sampled_checks import SetRows
from drivesizer.search.uncertainty.sampling import Sample, sample
from drivesizer.search.uncertainty.uncertain_figures import Assumption, assumptions

__all__ = ["Judged", "judged", "subject", "subject_of", "told", "uncertainty"]


class Judged(NamedTuple):
    """Sets over samples, by their rows in what the search found."""

    good: list[int]  # in their order; where a confidence is asked for, those that reach it
    bad: list[int]  # that do not, the surest first
    found: dict[int, tuple[Subject, Examined]]
    ready: Prepared
    drawn: Sample
    how: Sampling


def judged(problem: Problem, subjects: Mapping[int, Subject], how: Sampling) -> Judged:
    """How sure sets are.

    Parameters
    ----------
    problem
        The machine with its load cases, and the catalogues.
    subjects
        Sets that stand at nominal figures, in order, by their rows.
    how
        Samples, seed, and the confidence that is asked for.
    """
    rows = [(one.rows.motor, one.rows.gearhead) for one in subjects.values()]
    catalog, machine = problem.catalog, problem.machine
    given = assumptions(machine, used(catalog, machine.tolerances.given, rows))
    drawn = sample(given, how.samples, how.seed, assumptions(machine))
    ready = prepared(problem, given, drawn.values)
    results = examined(ready, catalog, list(subjects.values()), how.processes)
    found = {row: (subject, one) for (row, subject), one in zip(subjects.items(), results, strict=True)}
    chance = {row: one.reliability.probability for row, (_, one) in found.items()}
    good = [row for row in found if how.confidence is None or chance[row] >= how.confidence]
    bad = sorted((row for row in found if row not in good), key=lambda row: -chance[row])
    return Judged(good, bad, found, ready, drawn._replace(values=ready.values), how)


def subject(evaluation: Evaluation, row: int) -> Subject:
    """A set of what a search by physics found."""
    given = evaluation.candidates
    rows = SetRows(
        int(given.motor[row]), int(given.gearhead[row]), int(evaluation.encoder[row]), int(evaluation.controller[row]),
        float(given.belt[row]),
    )  # fmt: skip
    return Subject(rows, evaluation.checks_of(row))


def subject_of(catalog: Catalog, one: DriveSet) -> Subject:
    """A set as a record, with its checks by physics among those of either method."""
    rows = SetRows(
        catalog.motors.rows[one.motor.part],
        catalog.gearheads.rows[one.gearhead.part],
        catalog.encoders.rows[one.encoder.part] if one.encoder else -1,
        catalog.controllers.rows[one.controller.part] if one.controller else -1,
        one.belt_ratio,
    )
    return Subject(rows, tuple(check for check in (*one.checks, *one.beside) if check.method == "physics"))


def told(
    judged_: Judged, catalog: Catalog, sets: Mapping[int, DriveSet], finalists: Collection[int] = ()
) -> dict[int, DriveSet]:
    """Sets with how sure they are, and what matters most for each.

    Parameters
    ----------
    judged_
        What was sampled.
    catalog
        The parts.
    sets
        By their rows.
    finalists
        Rows of those that are sampled in closed loop too.
    """
    ends, said = at_ends(judged_.ready.problem, judged_.ready.given), {}
    for row, one in sets.items():
        what, found = judged_.found[row]
        matters = drivers(what, catalog, ends, judged_.drawn, found.smallest)
        told_ = replace(found.reliability, drivers=matters)
        looped = row in finalists and judged_.how.loop > 0
        said[row] = replace(one, reliability=_in_the_loop(judged_, catalog, what, one, told_) if looped else told_)
    return said


def _in_the_loop(judged_: Judged, catalog: Catalog, what: Subject, one: DriveSet, found: Reliability) -> Reliability:
    """With the share of samples that pass in closed loop, or why there is none: the model may lack a figure."""
    from drivesizer.search.uncertainty.sampled_closed_loop import loop_share

    ready = judged_.ready
    own = counting(what, catalog, ready.spec, ready.given)
    values = judged_.drawn.values[:, own]
    try:
        share = loop_share(ready.spec, one, [ready.given[k] for k in own], values, judged_.how.loop)
    except InputError as error:
        return replace(found, no_loop=str(error))
    return replace(found, loop=share)


def uncertainty(one: Judged) -> Uncertainty:
    """What all sets have in common."""
    return Uncertainty(
        assumptions=tuple(_uncertain(given) for given in one.ready.given),
        samples=one.drawn.size,
        seed=one.how.seed,
        confidence=one.how.confidence,
        examined=len(one.found),
        reached=len(one.good),
        notes=_notes(one.ready, one.how, len(one.found)),
    )


def _uncertain(one: Assumption) -> Uncertain:
    text = one.given.text if one.given else one.catalogue.text if one.catalogue else ""
    title = one.name if one.given else one.catalogue.title if one.catalogue else one.name
    return Uncertain(name=one.name, title=title, text=text, source=one.catalogue.why if one.catalogue else "spec")


def _notes(ready: Prepared, how: Sampling, examined_: int) -> tuple[str, ...]:
    """What the probabilities rest on."""
    said = [
        "limits are the catalogue's, as printed; encoder and controller are those of the nominal set; all motor sets "
        "of the machine are off alike",
        "the probability is that no check of the physics fails, nor the battery's autonomy, range, peak and voltage; "
        "other budgets of the machine are at nominal figures",
    ]
    if ready.spec.method == "paper":
        said.append("the paper's factors do not enter: the checks that are sampled are the physics beside it")
    if ready.fitted > 1e-12:
        said.append(f"load cycles of the samples are fitted to {ready.fitted:.0e} of their largest value")
    if len(ready.values) < how.samples:
        said.append(f"each sample's load cycle is computed by itself: {len(ready.values)} samples, not {how.samples}")
    if isinstance(ready.spec.load, WheelLoad):
        said.append("on its way a platform is not sampled in closed loop; peaks and voltage of its battery are nominal")
    idle = [one.name for one in unused(ready)]
    if idle:
        said.append(f"no check that is sampled asks for {', '.join(idle)}: that tolerance changes nothing here")
    if how.confidence is not None and examined_ >= POOL:
        said.append(f"the best {POOL} sets that stand at nominal figures were sampled, no others")
    return tuple(said)
