"""The drives to choose from as figures that move, and in an order of the reader's own weights."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from math import isfinite, isnan, nan
from typing import Any, NamedTuple

import numpy as np

from drivesizer.output.derivation import cleaned, margin
from drivesizer.output.document.candidates import gearhead_words
from drivesizer.output.document.content import Content
from drivesizer.output.document.paper import as_data
from drivesizer.output.document.records import picture as picture_of
from drivesizer.output.document.records import sentence
from drivesizer.output.json import documents
from drivesizer.output.report.figures import picture
from drivesizer.output.report.figures.picture import Curve, Diagram, Plot
from drivesizer.output.words import number_of
from drivesizer.physics.extremes import undominated
from drivesizer.results.sizing import Choice, Choices, used_share, weighted_order
from drivesizer.spec.drive import BOUGHT, OBJECTIVES
from drivesizer.units import show

# -- The drives by mass, margin and price; all drives to choose from, those that no other beats larger.


_LOOKS = {  # of a drive by its status: colour and mark
    "pass": ("blue", "o", False), "open": ("orange", "o", True), "unknown": ("grey", "o", True),
    "fail": ("vermillion", "x", True),
}  # fmt: skip
_FEW = 10  # numbers beside more points than these would cover one another
_ROOM, _SIZE = (520.0, 200.0), 8.5  # pt, of the axes on a page and of a number there


def sets_plot(rows: Sequence[dict[str, Any]], up: str, title: str, unit: str) -> Plot | None:
    """The drives of the table by their mass and another figure; None where fewer than two can be drawn."""
    known = [row for row in rows if row["exact"]["mass"] is not None and row["exact"][up] is not None]
    if len(known) < 2:
        return None
    places: dict[tuple[float, float], list[str]] = {}  # drives in one place are named together
    for row in known:
        places.setdefault((row["exact"]["mass"], row["exact"][up]), []).append(row["rank"])
    texts = [(", ".join(ranks[:3]) + (" …" if len(ranks) > 3 else ""),) for ranks in places.values()]
    spots = picture.spots([*places], texts, _ROOM, _SIZE) if len(places) <= _FEW else [("", "")] * len(places)
    spot_of = {ranks[0]: spot for ranks, spot in zip(places.values(), spots, strict=True)}
    curves = []
    for status, (colour, mark, hollow) in _LOOKS.items():
        of_status = [row for row in known if row["status"] == status]
        lines = ("{rank}  {motor}", "{gearhead}", "ratio {ratio}", "{mass}, {price}", "{margin} {check}")
        hovers = ["\n".join(lines).format(**row) for row in of_status]
        if of_status:
            curves.append(Curve(name=status, x=[row["exact"]["mass"] for row in of_status], hollow=hollow, joined=False,
                                y=[row["exact"][up] for row in of_status], colour=colour, mark=mark, texts=hovers,
                                keys=[row["rank"] for row in of_status],
                                spots=[spot_of.get(row["rank"], ("", "")) for row in of_status]))  # fmt: skip
    return Plot(diagrams=[Diagram(name=title, unit=unit, curves=curves)], across="mass", unit="g")


_AXES = ("mass", "price", "energy")  # less of each is better
_WORST = -1e30  # in the place of what is unknown
_SCALE = [[0.0, "#2c7fb8"], [0.5, "#a1dab4"], [1.0, "#fdae61"]]  # of the energy: seen in light and in dark


def choices_plot(choices: Choices | None) -> Plot | None:
    """The drives by mass and price, coloured by the energy of a cycle; diamonds are those that no other beats."""
    listed = choices.drives if choices else ()
    drives = [drive for drive in listed if isfinite(drive.figures["mass"]) and isfinite(drive.figures["price"])]
    if len(drives) < 2:
        return None
    energy = [drive.figures["energy"] for drive in drives]
    goals = -np.array([[drive.figures.get(name, nan) for name in _AXES] for drive in drives])
    different, which = np.unique(np.nan_to_num(goals, nan=_WORST), axis=0, return_inverse=True)
    best = np.isin(which.ravel(), undominated(different)).tolist()
    points = Curve(
        name="drives", x=[1e3 * drive.figures["mass"] for drive in drives],
        y=[drive.figures["price"] for drive in drives], mark="o", joined=False, listed=False, keys=[""] * len(drives),
        texts=["\n".join(_hover_text(drive, front)) for drive, front in zip(drives, best, strict=True)],
    )  # fmt: skip
    marker = {
        "size": [12 if front else 8 for front in best],
        "symbol": ["diamond" if front else "circle" for front in best],
        "color": [value if isfinite(value) else None for value in energy], "colorscale": _SCALE,
        "colorbar": {"title": {"text": "energy per cycle (J)", "side": "right"}, "thickness": 10, "outlinewidth": 0},
    }  # fmt: skip
    prices = Diagram(name="price", unit=drives[0].parts.currency, curves=[points])
    return Plot(diagrams=[prices], across="mass", unit="g", trace={"marker": marker})


def _hover_text(drive: Choice, front: bool) -> Iterator[str]:
    energy, tight = drive.figures["energy"], drive.figures.get("margin", nan)
    text = show(energy, "J", "energy") if isfinite(energy) else "energy unknown"
    yield drive.parts.label
    yield f"{show(drive.figures['mass'], 'g', 'mass')}, {drive.figures['price']:.2f} {drive.parts.currency}, {text}"
    words = [f"smallest margin {margin(tight)}"] if isfinite(tight) else []
    yield "; ".join([*words, *(["none beats it"] if front else [])])


# -- The drives that pass in an order of the reader's own weights, which the page computes by itself.
#
# The table is whole without a script, in the order of the spec's objective. ``weights.js`` has the rule of
# ``results.weights`` over the numbers of ``data``; ``weights_view.js`` joins it to the controls.


_DIGITS = 7  # of a figure, in Python and in the page: a shorter file, and the same order in both
_PARTS = "parts"  # number of parts, beside the objectives


class Criterion(NamedTuple):
    """A figure that drives can be chosen by."""

    name: str
    title: str
    texts: list[str]  # of each drive, as it is printed
    figures: list[float]  # less is better; NaN unknown


def weights_section(content: Content) -> dict[str, Any] | None:
    """The section as plain data for the page's template."""
    choices = content.result.choices
    criteria = [*_criteria(choices.drives)] if choices else []
    offered = [criterion for criterion in criteria if len({*criterion.figures}) > 1]
    if choices is None or not offered:
        return None
    controls = [
        {"name": criterion.name, "title": criterion.title, "weight": choices.weights.get(criterion.name, 0.0)}
        for criterion in offered
    ]
    block = {
        "kind": "weights", "intro": _intro(content, choices), "caption": _caption(choices, offered),
        "controls": controls, "rules": [*_rules(offered)], "left_out": [*_left_out(criteria, offered)],
        **_table(choices, offered),
        **_command(content, choices),
    }  # fmt: skip
    blocks = [block, *as_data([picture_of("choices")])]
    return cleaned({"name": "weights", "title": "Choose by weights", "level": 1, "blocks": blocks})


def _criteria(drives: tuple[Choice, ...]) -> Iterator[Criterion]:
    """All figures of the drives, whether they differ or not."""
    currency = drives[0].parts.currency
    for name in drives[0].figures:
        declared, values = OBJECTIVES[name], [drive.figures[name] for drive in drives]
        figures = used_share(np.array(values)).tolist() if declared.more_is_better else values
        yield Criterion(
            name, declared.title, [_text(name, value, currency) for value in values], [*map(_rounded, figures)]
        )
    counts = [len(drive.parts.parts) for drive in drives]
    yield Criterion(_PARTS, "number of parts", [number_of(count, "part") for count in counts], [*map(float, counts)])


def _text(name: str, value: float, currency: str) -> str:
    declared = OBJECTIVES[name]
    if isnan(value):
        return "unknown"
    if declared.more_is_better:
        return margin(value)
    return f"{value:.2f} {currency}" if name == "price" else show(value, declared.unit, declared.kind)


def _rounded(value: float) -> float:
    """A figure with as many digits as the page has of it; one NaN for all that is unknown."""
    return np.nan if isnan(value) else float(f"{value:.{_DIGITS}g}")


def _table(choices: Choices, offered: list[Criterion]) -> dict[str, Any]:
    """The drives in the order of the spec's objective, and the numbers that another order is made of."""
    figures = {criterion.name: np.array(criterion.figures) for criterion in offered}
    ranking = weighted_order(figures, choices.weights)
    rows = [
        {"row": row, "place": place, **_part_names(choices.drives[row]),
         "texts": [criterion.texts[row] for criterion in offered],
         "score": "unknown" if ranking.lacking[row] or isnan(ranking.score[row]) else f"{ranking.score[row]:.3f}"}
        for place, row in enumerate(ranking.order.tolist(), 1)
    ]  # fmt: skip
    data = {
        "figures": {criterion.name: documents.plain(criterion.figures) for criterion in offered},
        "first": choices.first,
    }
    return {"rows": rows, "belts": any(row["belt"] for row in rows), "data": data, "first": choices.first}


def _part_names(drive: Choice) -> dict[str, str]:
    parts = drive.parts
    return {"motor": parts.motor_name, "gearhead": gearhead_words(parts, belt=False), "belt": parts.belt_name}


def _intro(content: Content, choices: Choices) -> str:
    result, count = content.result, len(choices.drives)
    met = "all limits" if result.sets and result.sets[0].status == "pass" else ""
    verb = ("meets " if count == 1 else "meet ") if met else ("fails " if count == 1 else "fail ")
    picked = f"The {'drive' if count == 1 else f'{count} drives'} below {verb}{met or 'no check'}"
    if choices.judged:
        picked += f", in the machine as well; {choices.passing} meet their own limits"
    elif choices.passing > count:
        why = "whatever the weights, none of the others is better than the first" if choices.whole else (
            "by mass, price, a lower bound of the power and a bound of the margin")  # fmt: skip
        picked += f". They are picked out of {choices.passing}: {why}"
    ranked = result.objective.replace("_", " ")
    return f"{picked}. At first they are in the order of the spec, which ranks by {ranked}."


def _caption(choices: Choices, offered: list[Criterion]) -> str:
    """Meaning of the figures: parts that they are summed over, or drives that they are of."""
    there = {role for role in BOUGHT if any(getattr(drive.parts, role) for drive in choices.drives)}
    titles_of = dict[str, list[str]]()
    for declared in (OBJECTIVES[criterion.name] for criterion in offered if criterion.name != _PARTS):
        over = f"of {', '.join(role for role in declared.over if role in there)}" if declared.over else declared.note
        titles_of.setdefault(over, []).append(declared.title)
    return "; ".join(f"{' and '.join(titles)}: {over}" for over, titles in titles_of.items())


def _rules(offered: list[Criterion]) -> Iterator[str]:
    yield sentence("weights")
    if any(np.nanmin(criterion.figures) <= 0.0 for criterion in offered):
        yield sentence("weights_negative")
    if any(isnan(figure) for criterion in offered for figure in criterion.figures):
        yield sentence("weights_unknown")
    yield sentence("weights_source")


def _left_out(criteria: list[Criterion], offered: list[Criterion]) -> Iterator[str]:
    """Figures without a weight, and why."""
    for criterion in criteria:
        if criterion in offered or criterion.name == _PARTS:
            continue
        yield (
            f"{criterion.title} is unknown of all"
            if isnan(criterion.figures[0])
            else f"{criterion.title} is the same, {criterion.texts[0]}"
        )


def _command(content: Content, choices: Choices) -> dict[str, Any]:
    """The search of all drives by the same weights."""
    named = ",".join(f"{name}={weight:g}" for name, weight in choices.weights.items())
    command = shlex.join(["drivesizer", "size", content.file or "robot.yaml", "--objective"])
    return {"command": f"{command} ", "objective": named}
