"""Words for a sizing in which no drive meets all limits: what most fail on, and what was tried in vain."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from drivesizer.output.words import number_of
from drivesizer.results.check import sentence_case
from drivesizer.results.check_kinds import CHECKS, part_of
from drivesizer.results.drive_set import Relaxation
from drivesizer.results.sizing import SizingResult


def most_fail_on(result: SizingResult) -> str:
    """The check that rejects most drives: of the machine where some meet their own limits; empty without any."""
    counts = result.counts
    if counts.failed_by_budget:
        name, _ = max(counts.failed_by_budget.items(), key=lambda item: item[1])
        those = "1 drive meets its" if counts.judged == 1 else f"{counts.judged:,} drives meet their"
        fails = "it fails" if counts.judged == 1 else "they fail"
        return f"{those} own limits; in the machine {fails} on {sentence_case(CHECKS['budget'][name].title)}."
    if not counts.failed_by:
        return ""
    name, count = max(counts.failed_by.items(), key=lambda item: item[1])
    title = sentence_case(CHECKS[result.method][name].title)
    return f"Most frequent failure: {title}, in {count:,} of {number_of(counts.considered, 'drive')}."


def not_enough(result: SizingResult) -> str:
    """The figures of the spec of which none, moved alone, lets a drive pass; first what is not known of any drive."""
    if undecided := _undecided(result):
        return undecided
    if not result.tried:
        return "The spec has no single figure whose change was tried."
    return f"None of these figures is enough, changed alone by up to a factor of 20: {', '.join(result.tried)}."


def changes_by_outcome(changes: Sequence[Relaxation], of: str) -> Iterator[tuple[str, list[Relaxation]]]:
    """Changes of a spec after which a drive passes, then those after which it fails nothing and figures are missing."""
    passing = [one for one in changes if one.status == "pass"]
    rest = [one for one in changes if one.status != "pass"]
    if passing:
        yield f"Any one of these changes alone would let {of} pass:", passing
    if rest:
        yield f"Any one of these changes alone would leave no check of {of} failing, figures missing:", rest


_OF_THE_BATTERY = {  # figures that its limits need, where the drive gives and takes what it may
    "continuous_current", "peak_current", "max_charge_current", "charge_voltage", "cutoff_voltage", "resistance",
    "open_circuit",
}  # fmt: skip


def _undecided(result: SizingResult) -> str:
    """Unknown figures that leave drives out where the spec rejects such: the battery's first, then the drives'."""
    spec, left_out = result.spec, result.counts.left_out
    if spec.select.unknown != "reject":
        return ""
    battery, said = spec.battery, list[str]()
    if battery is not None and battery.part is None:
        lacking = [f"battery.{name}" for name in type(battery).model_fields if name in _OF_THE_BATTERY]
        lacking = [name for name in lacking if getattr(battery, name.removeprefix("battery.")) is None]
        if lacking:
            said.append(f"The battery is not wholly known, so no drive is: give {', '.join(lacking)}.")
    said += _of_the_machine(result)
    if left_out:
        fail = "1 drive fails nothing" if left_out == 1 else f"{left_out:,} drives fail nothing"
        said.append(f"{fail}, but figures are missing: select: {{unknown: allow}} shows which.")
    return " ".join(said)


def _of_the_machine(result: SizingResult) -> Iterator[str]:
    """Unknown checks of the machine that reject its best drives, where none of theirs fails."""
    closest = next(iter(result.misses), None)
    if closest is None or any(check.status == "fail" for check in closest.deciding):
        return
    unknown = [check for check in closest.budget if check.status == "unknown" and part_of(check.name) != "Battery"]
    if unknown:
        said = "; ".join(check.title + (f" ({check.note})" if check.note else "") for check in unknown)
        yield f"Unknown of {closest.label} in the machine: {said}."
