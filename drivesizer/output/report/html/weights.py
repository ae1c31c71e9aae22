"""The drives that pass in an order of the reader's own weights, which the page computes by itself.

The table is whole without a script, in the order of the spec's objective. ``weights.js`` has the rule of
``results.weights`` over the numbers of ``data``; ``weights_view.js`` joins it to the controls.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from math import isnan
from typing import Any, NamedTuple

import numpy as np

from drivesizer.output.counted import number_of
from drivesizer.output.json.loops import number
from drivesizer.output.report.sections.blocks import Picture, as_data
from drivesizer.output.report.sections.candidates import gearhead_words
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.specification import file_name
from drivesizer.output.text import cleaned, margin
from drivesizer.results.weights import Choice, Choices, used_share, weighted_order
from drivesizer.spec.select import BOUGHT, OBJECTIVES
from drivesizer.units import show

__all__ = ["weights_section"]

_DIGITS = 7  # of a figure, in Python and in the page: a shorter file, and the same order in both
_PARTS = "parts"  # number of parts, beside the objectives
_SOURCE = (
    "Weighted sum of ratios: R. T. Marler, J. S. Arora, Survey of multi-objective optimization methods for "
    "engineering, Structural and Multidisciplinary Optimization 26 (2004) 369–395; C.-L. Hwang, K. Yoon, Multiple "
    "Attribute Decision Making, Springer 1981 (simple additive weighting)."
)
_RULE = (
    "Each figure is divided by the smallest of these drives; of a margin counts the share of the limit that is used, "
    "1/(1 + margin). The score is the mean of these ratios by the weights: 1 for a drive that is the best in all that "
    "has a weight, 1.1 for one that is a tenth worse in the mean. Of equal scores the larger margin goes first."
)
_NEGATIVE = "Where the smallest energy is not above zero, 1 + its distance from that over the largest amount counts."
_PICTURE = Picture(
    "choices",
    "The same drives by mass and price, as far as both are known, their energy per cycle as colour. Diamonds are those "
    "that no other beats in all three.",
    "price over mass of the drives to choose from, coloured by energy per cycle",
)
_UNKNOWN = "Drives of which a figure with a weight is unknown go below all others, whatever it would be."


class Criterion(NamedTuple):
    """A figure that drives can be chosen by."""

    name: str
    title: str
    texts: list[str]  # of each drive, as it is printed
    figures: list[float]  # less is better; NaN unknown


def weights_section(content: Content) -> dict[str, Any] | None:
    """The section as plain data for the page's template."""
    chosen = content.result.choices
    every = [*_criteria(chosen.drives)] if chosen else []
    offered = [one for one in every if len({*one.figures}) > 1]
    if chosen is None or not offered:
        return None
    controls = [{"name": one.name, "title": one.title, "weight": chosen.weights.get(one.name, 0.0)} for one in offered]
    block = {
        "kind": "weights", "intro": _intro(content, chosen), "caption": _caption(chosen, offered), "controls": controls,
        "rules": [*_rules(offered)], "left_out": [*_left_out(every, offered)], **_table(chosen, offered),
        **_command(content, chosen),
    }  # fmt: skip
    blocks = [block, *as_data([_PICTURE])]
    made: dict[str, Any] = cleaned({"name": "weights", "title": "Choose by weights", "level": 1, "blocks": blocks})
    return made


def _criteria(drives: tuple[Choice, ...]) -> Iterator[Criterion]:
    """All figures of the drives, whether they differ or not."""
    for name in drives[0].figures:
        declared, values = OBJECTIVES[name], [one.figures[name] for one in drives]
        figures = used_share(np.array(values)).tolist() if declared.more_is_better else values
        yield Criterion(name, declared.title, [_text(name, value) for value in values], [*map(_rounded, figures)])
    counts = [len(one.parts.parts) for one in drives]
    yield Criterion(_PARTS, "number of parts", [number_of(count, "part") for count in counts], [*map(float, counts)])


def _text(name: str, value: float) -> str:
    declared = OBJECTIVES[name]
    if isnan(value):
        return "unknown"
    if declared.more_is_better:
        return margin(value)
    return f"{value:.2f} EUR" if name == "price" else show(value, declared.unit, declared.kind)


def _rounded(value: float) -> float:
    """A figure with as many digits as the page has of it; one NaN for all that is unknown."""
    return np.nan if isnan(value) else float(f"{value:.{_DIGITS}g}")


def _table(chosen: Choices, offered: list[Criterion]) -> dict[str, Any]:
    """The drives in the order of the spec's objective, and the numbers that another order is made of."""
    figures = {one.name: np.array(one.figures) for one in offered}
    found = weighted_order(figures, chosen.weights)
    rows = [
        {"row": row, "place": place, **_names(chosen.drives[row]), "texts": [one.texts[row] for one in offered],
         "score": "unknown" if found.lacking[row] or isnan(found.score[row]) else f"{found.score[row]:.3f}"}
        for place, row in enumerate(found.order.tolist(), 1)
    ]  # fmt: skip
    data = {"figures": {one.name: [*map(number, one.figures)] for one in offered}, "first": chosen.first}
    return {"rows": rows, "belts": any(row["belt"] for row in rows), "data": data, "first": chosen.first}


def _names(one: Choice) -> dict[str, str]:
    parts = one.parts
    return {"motor": parts.motor_name, "gearhead": gearhead_words(parts, belt=False), "belt": parts.belt_name}


def _intro(content: Content, chosen: Choices) -> str:
    result, count = content.result, len(chosen.drives)
    met = "all limits" if result.sets and result.sets[0].status == "pass" else ""
    each = ("meets " if count == 1 else "meet ") if met else ("fails " if count == 1 else "fail ")
    picked = f"The {'drive' if count == 1 else f'{count} drives'} below {each}{met or 'no check'}"
    if chosen.judged:
        picked += f", in the machine as well; {chosen.passing} meet their own limits"
    elif chosen.passing > count:
        why = "whatever the weights, none of the others is better than the first" if chosen.whole else (
            "by mass, price, a lower bound of the power and a bound of the margin")  # fmt: skip
        picked += f". They are picked out of {chosen.passing}: {why}"
    ranked = result.objective.replace("_", " ")
    return f"{picked}. At first they are in the order of the spec, which ranks by {ranked}."


def _caption(chosen: Choices, offered: list[Criterion]) -> str:
    """Meaning of the figures: parts that they are summed over, or drives that they are of."""
    there = {role for role in BOUGHT if any(getattr(one.parts, role) for one in chosen.drives)}
    said = dict[str, list[str]]()
    for declared in (OBJECTIVES[one.name] for one in offered if one.name != _PARTS):
        over = f"of {', '.join(role for role in declared.over if role in there)}" if declared.over else declared.note
        said.setdefault(over, []).append(declared.title)
    return "; ".join(f"{' and '.join(titles)}: {over}" for over, titles in said.items())


def _rules(offered: list[Criterion]) -> Iterator[str]:
    yield _RULE
    if any(np.nanmin(one.figures) <= 0.0 for one in offered):
        yield _NEGATIVE
    if any(isnan(figure) for one in offered for figure in one.figures):
        yield _UNKNOWN
    yield _SOURCE


def _left_out(every: list[Criterion], offered: list[Criterion]) -> Iterator[str]:
    """Figures without a weight, and why."""
    for one in every:
        if one in offered or one.name == _PARTS:
            continue
        yield f"{one.title} is unknown of all" if isnan(one.figures[0]) else f"{one.title} is the same, {one.texts[0]}"


def _command(content: Content, chosen: Choices) -> dict[str, Any]:
    """The search of all drives by the same weights."""
    named = ",".join(f"{name}={weight:g}" for name, weight in chosen.weights.items())
    command = shlex.join(["drivesizer", "size", file_name(content) or "robot.yaml", "--objective"])
    return {"command": f"{command} ", "objective": named}
