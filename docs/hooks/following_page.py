"""Following as tables: the paper's measured errors beside simulated ones, each misjudged figure alone, what is assumed.

Every run is a simulation of the program's own; each way to drive is run once for tables and figure.
"""

from __future__ import annotations

import re
from functools import cache

from drivesizer.platform import following_example, following_table
from drivesizer.platform.following import Followed
from drivesizer.platform.following_example import Case
from drivesizer.platform.following_table import Table

__all__ = ["following", "ran", "sensitivities", "taken"]


_VALUE, _TOGETHER = re.compile(r"^([\d.]+) (m|°|%)$"), "\\1\u00a0\\2"  # on one line


@cache
def ran(case: Case) -> Followed:
    """The path of the example, driven in one way."""
    return following_example.run(case)


def following() -> str:
    """The paper's two measured errors, and what the simulated path gives; without a column where no limit was met."""
    table = following_table.beside_the_paper()
    if {row[-1] for row in table.rows} != {"–", "0 %"}:
        return _markdown(table)
    rows = tuple(row[:-1] for row in table.rows)
    return f"{_markdown(table._replace(heads=table.heads[:-1], rows=rows))}\n\nNo wheel stood at its torque limit."


def sensitivities() -> str:
    """What each misjudged figure alone comes to."""
    return _markdown(following_table.one_at_a_time())


def taken() -> str:
    """What is assumed."""
    return _markdown(following_table.assumed())


def _markdown(table: Table) -> str:
    lines = [table.heads, ("---",) * len(table.heads), *table.rows]
    return "\n".join(f"| {' | '.join(_VALUE.sub(_TOGETHER, cell) for cell in row)} |" for row in lines)
