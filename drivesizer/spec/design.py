"""Section of a spec on its free figures: what the best machine is, and within which limits."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import Field

from drivesizer.files import fields
from drivesizer.files.yaml_source import Path_

FREE, EXPRESSION = "free", "expression"  # keys in place of a figure
_Text = Annotated[str, Field(min_length=1, max_length=400)]


class Design(fields.Section):
    """Goals and limits of the spec's free figures, for `drivesizer design`."""

    minimise: _Text | None = fields.optional(
        "mass, price, energy, time, -autonomy, or an expression; the objective under select where not given",
        example="mass + 0.1 * price",
    )
    subject_to: Annotated[list[_Text], Field(max_length=50)] = fields.no_entries(
        "limits beside all checks, such as autonomy >= 3 h"
    )
    pareto: Annotated[list[_Text], Field(max_length=4)] = fields.no_entries(
        "figures of which no machine of the front is worse in all, such as [mass, energy]"
    )
    evaluations: Annotated[int, Field(ge=10, le=1_000_000)] = fields.default(
        2000, "machines that are sized at most before the best is refined; a grid of fewer is sized whole"
    )
    seed: Annotated[int, Field(ge=0)] = fields.default(0, "of the search where not all are sized")


def open_figures(data: Any, path: Path_ = ()) -> Iterator[tuple[Path_, dict[str, Any]]]:
    """Places of a document where a range, a choice or an expression stands for a figure, in its order."""
    if isinstance(data, dict) and (FREE in data or EXPRESSION in data):
        yield path, data
    elif isinstance(data, dict | list):
        for step, below in data.items() if isinstance(data, dict) else enumerate(data):
            yield from open_figures(below, (*path, step))
