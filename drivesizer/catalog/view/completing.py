"""Tables of parts with estimates where a figure is missing: at their middles, and at both ends of their bands.

At the unfavourable end every estimated figure is where it makes most drives harder to pass: inertia, friction and
thermal resistance high, time constants and efficiency low; at the favourable end the other way round. A drive is judged
at both.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.tables import Catalog, Estimates, Table

__all__ = ["ENDS", "MIDDLE", "End", "completed"]

End = Literal["middle", "favourable", "unfavourable"]
MIDDLE: End = "middle"
ENDS: tuple[End, End] = ("favourable", "unfavourable")
_HARDER_WHEN_LOW = {  # of which kind of parts; "": of all. A brushless motor's temperature goes with its resistances
    "winding_time_constant": "", "motor_time_constant": "", "efficiency": "", "max_winding_temperature": "brushed",
    "pull_out_share": "", "start_speed": "", "nominal_torque": "", "nominal_current": "", "peak_torque": "",
}  # fmt: skip


def completed(catalog: Catalog, end: End) -> dict[str, Table[Any]]:
    """The tables that have estimates, with these where a figure is missing.

    Parameters
    ----------
    catalog
        With its estimates; actuators not yet split.
    end
        ``middle`` of the bands, or which end of them.

    Returns
    -------
    dict
        Tables by section.
    """
    return {section: _table(catalog.table(section), figures, end) for section, figures in catalog.estimates.items()}


def _table(table: Table[Any], figures: Mapping[str, Estimates], end: End) -> Table[Any]:
    columns = dict(table.columns)
    for name, found in figures.items():
        columns[name] = columns[name].copy()
        columns[name][found.rows] = found.value if end == MIDDLE else _at_end(table, found, name, end)
    return Table(table.section, columns, table.source, table.excluded)


def _at_end(table: Table[Any], found: Estimates, name: str, end: End) -> NDArray[np.float64]:
    kind = _HARDER_WHEN_LOW.get(name)
    harder_when_low = (table["kind"][found.rows] == kind) if kind else kind is not None
    return np.where(harder_when_low == (end == "unfavourable"), found.low, found.high)
