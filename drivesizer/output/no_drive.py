"""Words for a sizing in which no drive meets all limits: what most fail on, and what was tried in vain."""

from __future__ import annotations

from drivesizer.output.counted import number_of
from drivesizer.results.check import in_a_sentence
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.sizing import SizingResult

__all__ = ["most_fail_on", "not_enough"]


def most_fail_on(result: SizingResult) -> str:
    """The check that rejects most drives: of the machine where some meet their own limits; empty without any."""
    counts = result.counts
    if counts.failed_by_budget:
        name, _ = max(counts.failed_by_budget.items(), key=lambda item: item[1])
        those = "1 drive meets its" if counts.judged == 1 else f"{counts.judged:,} drives meet their"
        fails = "it fails" if counts.judged == 1 else "they fail"
        return f"{those} own limits; in the machine {fails} on {in_a_sentence(CHECKS['budget'][name].title)}."
    if not counts.failed_by:
        return ""
    name, count = max(counts.failed_by.items(), key=lambda item: item[1])
    title = in_a_sentence(CHECKS[result.method][name].title)
    return f"Most frequent failure: {title}, in {count:,} of {number_of(counts.considered, 'drive')}."


def not_enough(result: SizingResult) -> str:
    """The figures of the spec of which none, moved alone, lets a drive pass; first what is not known of any drive."""
    if undecided := _undecided(result):
        return undecided
    if not result.tried:
        return "The spec has no single figure whose change was tried."
    return f"None of these figures is enough, changed alone by up to a factor of 20: {', '.join(result.tried)}."


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
    if left_out:
        fail = "1 drive fails nothing" if left_out == 1 else f"{left_out:,} drives fail nothing"
        said.append(f"{fail}, but figures are missing: select: {{unknown: allow}} shows which.")
    return " ".join(said)
