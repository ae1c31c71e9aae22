"""From a sizing's sets to how sure each is: what is uncertain, samples, the sets over them, what matters most."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from drivesizer.catalog import Catalog
from drivesizer.errors import InputError
from drivesizer.results import DriveSet
from drivesizer.spec import RobotSpec
from drivesizer.tolerances.assess import Examined, Subject, drivers, examined
from drivesizer.tolerances.assumptions import Assumption, assumptions
from drivesizer.tolerances.evaluate import SetRows
from drivesizer.tolerances.prepare import Prepared, prepared, unused
from drivesizer.tolerances.records import Uncertain, Uncertainty
from drivesizer.tolerances.sampling import Sample, sample
from drivesizer.tolerances.schema import FEWEST, MOST

__all__ = ["POOL", "Sampling", "Sure", "asked", "sure"]

POOL = 100  # of the best sets are sampled where a confidence is asked for


class Sampling(NamedTuple):
    """How sets are sampled."""

    samples: int
    seed: int
    confidence: float | None  # None: all are told, none falls
    processes: int = 1


class Sure(NamedTuple):
    """Sets with how sure each is."""

    sets: tuple[DriveSet, ...]  # in their order; where a confidence is asked for, those that reach it
    unsure: tuple[DriveSet, ...]  # that do not, the surest first
    uncertainty: Uncertainty


def asked(
    spec: RobotSpec, confidence: float | None = None, samples: int | None = None, seed: int | None = None,
    processes: int = 1,
) -> Sampling | None:  # fmt: skip
    """How a spec, and options before it, want sets to be sampled; None where neither has tolerances in mind.

    Raises
    ------
    InputError
        When an option is out of its range.
    """
    given = spec.tolerances
    wanted = any(option is not None for option in (confidence, samples, seed, given.confidence))
    if not (wanted or spec.toleranced or "tolerances" in spec.model_fields_set):
        return None
    if confidence is not None and not 0.0 < confidence <= 1.0:
        raise InputError(f"--confidence {confidence:g} is not a probability; expected above 0, at most 1, e.g. 0.95")
    if samples is not None and not FEWEST <= samples <= MOST:
        raise InputError(f"--samples {samples} is out of range; expected {FEWEST} to {MOST}")
    if seed is not None and not 0 <= seed < 2**32:
        raise InputError(f"--seed {seed} is out of range; expected 0 to {2**32 - 1}")
    return Sampling(
        given.samples if samples is None else samples,
        given.seed if seed is None else seed,
        given.confidence if confidence is None else confidence,
        processes,
    )


def sure(spec: RobotSpec, catalog: Catalog, sets: Sequence[DriveSet], how: Sampling, top: int) -> Sure:
    """How sure sets are, and those of them that are sure enough.

    Parameters
    ----------
    spec, catalog
        The machine as it was sized, and the parts.
    sets
        That stand at nominal figures, in order; with their checks by physics.
    how
        Samples, seed, and the confidence that is asked for.
    top
        How many sets to give.
    """
    given = assumptions(spec)
    drawn = sample(given, how.samples, how.seed)
    ready = prepared(spec, given, drawn.values)
    drawn = drawn._replace(values=ready.values)
    subjects = [_subject(catalog, one) for one in sets]
    found = examined(ready, catalog, subjects, how.processes)
    judged = [replace(one, reliability=result.reliability) for one, result in zip(sets, found, strict=True)]
    good, bad = _parted(judged, how.confidence)
    shown = [*good[:top], *bad[:top]]
    told = {id(judged[n]): _told(ready, catalog, drawn, subjects[n], found[n], judged[n]) for n in range(len(judged))
            if any(one is judged[n] for one in shown)}  # fmt: skip
    kept, fell = ([told[id(one)] for one in some[:top]] for some in (good, bad))
    return Sure(
        tuple(replace(one, rank=rank) for rank, one in enumerate(kept, 1)), tuple(fell),
        _uncertainty(ready, how, drawn, len(judged), len(good)),
    )  # fmt: skip


def _subject(catalog: Catalog, one: DriveSet) -> Subject:
    rows = SetRows(
        catalog.motors.rows[one.motor.part],
        catalog.gearheads.rows[one.gearhead.part],
        catalog.encoders.rows[one.encoder.part] if one.encoder else -1,
        catalog.controllers.rows[one.controller.part] if one.controller else -1,
        one.belt_ratio,
    )
    by_physics = tuple(check for check in (*one.checks, *one.beside) if check.method == "physics")
    return Subject(rows, by_physics)


def _parted(sets: Sequence[DriveSet], confidence: float | None) -> tuple[list[DriveSet], list[DriveSet]]:
    """Those that are sure enough, in their order, and the others, the surest first."""
    if confidence is None:
        return list(sets), []
    good = [one for one in sets if one.reliability and one.reliability.reaches(confidence)]
    bad = [one for one in sets if one.reliability and not one.reliability.reaches(confidence)]
    return good, sorted(bad, key=lambda one: -one.reliability.probability if one.reliability else 0.0)


def _told(
    ready: Prepared, catalog: Catalog, drawn: Sample, subject: Subject, found: Examined, one: DriveSet
) -> DriveSet:
    """A set that is shown, with what matters most."""
    said = drivers(subject, catalog, ready.spec, ready.given, drawn, found.smallest)
    return replace(one, reliability=replace(found.reliability, drivers=said))


def _uncertainty(ready: Prepared, how: Sampling, drawn: Sample, examined_: int, reached: int) -> Uncertainty:
    return Uncertainty(
        assumptions=tuple(_uncertain(one) for one in ready.given),
        samples=drawn.count,
        seed=how.seed,
        confidence=how.confidence,
        examined=examined_,
        reached=reached,
        notes=_notes(ready, how, examined_),
    )


def _uncertain(one: Assumption) -> Uncertain:
    text = one.given.text if one.given else one.catalogue.text if one.catalogue else ""
    title = one.name if one.given else one.catalogue.title if one.catalogue else one.name
    return Uncertain(name=one.name, title=title, text=text, source=one.catalogue.why if one.catalogue else "spec")


def _notes(ready: Prepared, how: Sampling, examined_: int) -> tuple[str, ...]:
    """What the probabilities rest on."""
    said = [
        "limits are the catalogue's, at their printed figures; encoder and controller are those of the nominal set; all "
        "motor sets of the machine are off alike",
        "the probability is that no check of the physics fails at nominal budgets of mass, room and battery",
    ]
    if ready.spec.method == "paper":
        said.append("the paper's factors do not enter: the checks that are sampled are the physics beside it")
    if 0.0 < ready.fitted:
        said.append(f"load cycles of the samples are fitted to {ready.fitted:.0e} of their largest value")
    if ready.shared < len(ready.values):
        said.append(f"the samples share {ready.shared} load cycles, each computed by itself")
    idle = [one.name for one in unused(ready)]
    if idle:
        said.append(f"no check that is sampled asks for {', '.join(idle)}: that tolerance changes nothing here")
    if how.confidence is not None and examined_ >= POOL:
        said.append(f"the best {POOL} sets that stand at nominal figures were sampled, no others")
    return tuple(said)
