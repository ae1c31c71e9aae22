"""The numbers behind the texts of a report: those of the JSON document, beside each text that shows one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from drivesizer.control.validation import Validation
from drivesizer.output.json import documents as json_documents
from drivesizer.output.sums import price_of
from drivesizer.results.sizing import SizingResult
from drivesizer.units import from_si

__all__ = ["with_numbers"]


_CHECKS = ("checks", "beside", "budget")  # in the order of the contract


def with_numbers(content: dict[str, Any], result: SizingResult, validation: Validation | None) -> dict[str, Any]:
    """A report's content, each requirement, check and set of it with its numbers under ``exact``.

    Parameters
    ----------
    content
        What ``document`` gives.
    result, validation
        What it gave that of.
    """
    best = result.shown
    found = content | {
        "load_steps": _requirements(content["load_steps"], json_documents.sizing(result)["requirements"]),
        "candidates": content["candidates"] | {"sets": _sets(content["candidates"]["sets"], result)},
    }
    if best is not None:
        told = json_documents.drive_set(best)
        checks = iter(_joined([row for part in _CHECKS for row in content[part]], told["checks"]))
        found |= {part: [next(checks) for _ in content[part]] for part in _CHECKS}
        found["motor_steps"] = _requirements(content["motor_steps"], told["requirements"])
    if validation is not None:
        proof = json_documents.validation(validation)
        found["loop"] = content["loop"] | {"checks": _joined(content["loop"]["checks"], proof["checks"])}
    return found


def _joined(texts: list[dict[str, Any]], numbers: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    return [text | {"exact": exact} for text, exact in zip(texts, numbers, strict=True)]


def _requirements(texts: list[dict[str, Any]], numbers: Mapping[str, Mapping[str, Any]]) -> list[dict[str, Any]]:
    return _joined(texts, [{"name": name, **exact} for name, exact in numbers.items()])


def _sets(texts: list[dict[str, Any]], result: SizingResult) -> list[dict[str, Any]]:
    """Ratio, mass [g], price [EUR] and smallest margin [1, and %] of every set of the table; None where unknown."""
    made = []
    for text, found in zip(texts, (*result.sets, *result.misses), strict=True):
        told = json_documents.drive_set(found)
        of_method = told["results"].get(result.method)
        margin = of_method["smallest_margin"] if of_method else None
        exact = {
            "ratio": told["total_ratio"],
            "mass": None if told["mass_kg"] is None else float(from_si(told["mass_kg"], "g", "mass")),
            "price": price if (price := price_of(found)[0]) == price else None,
            "margin": margin,
            "percent": None if margin is None else 100.0 * margin,
        }
        made.append(text | {"exact": exact})
    return made
