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

from drivesizer.catalog.estimates.assumed import UNRATED
from drivesizer.catalog.tables import Catalog, Estimates, Table

__all__ = ["ENDS", "MIDDLE", "End", "completed"]

End = Literal["middle", "favourable", "unfavourable"]
MIDDLE: End = "middle"
ENDS: tuple[End, End] = ("favourable", "unfavourable")
_HARDER_WHEN_LOW = {  # of which kind of parts; "": of all. A brushless motor's temperature goes with its resistances
    "winding_time_constant": "", "motor_time_constant": "", "efficiency": "", "max_winding_temperature": "brushed",
    "pull_out_share": "", "start_speed": "", "nominal_torque": "", "nominal_current": "", "peak_torque": "",
    "peak_current": "",
}  # fmt: skip


_PRINTED = 0.02  # within which printed figures of one part agree


def completed(catalog: Catalog, end: End) -> dict[str, Table[Any]]:
    """The tables that have estimates, with these where a figure is missing."""
    return {section: _table(catalog.table(section), figures, end) for section, figures in catalog.estimates.items()}


def _table(table: Table[Any], figures: Mapping[str, Estimates], end: End) -> Table[Any]:
    columns = dict(table.columns)
    for name, found in figures.items():
        columns[name] = columns[name].copy()
        columns[name][found.rows] = found.value if end == MIDDLE else _at_band_end(table, found, name, end)
    if "no_load_current" in figures and table.section == "actuators":
        _keep_printed_points(table, columns, figures["no_load_current"].rows)
    return Table(table.section, columns, table.source, table.excluded)


def _keep_printed_points(table: Table[Any], columns: dict[str, NDArray[Any]], rows: NDArray[np.int64]) -> None:
    """Constant and efficiency of actuators that were worked out of no load and stall without the no-load current.

    With an estimated one they are others, so that its loss does not count twice: speed without load and torque at stall
    stay what is printed.
    """
    V, w_0, M_s, I_s, R, i, k_t, e = (
        table[name][rows]
        for name in ("nominal_voltage", "no_load_speed", "stall_torque", "stall_current", "resistance", "ratio",
                     "motor_torque_constant", "efficiency")
    )  # fmt: skip
    I_0 = columns["no_load_current"][rows]
    without = np.isclose(k_t * i * w_0, V, rtol=_PRINTED) & np.isclose(i * e * k_t * I_s, M_s, rtol=_PRINTED)
    constant = (V - I_0 * R) / (i * w_0)
    share = M_s / (i * constant * (I_s - I_0))
    some = without & (constant > 0.0) & (share > 0.0) & (share <= 1.0)
    for name, value in (("motor_torque_constant", constant), ("efficiency", share)):
        columns[name] = columns[name].copy()
        columns[name][rows[some]] = value[some]


def _at_band_end(table: Table[Any], found: Estimates, name: str, end: End) -> NDArray[np.float64]:
    kind = _HARDER_WHEN_LOW.get(name)
    harder_when_low = (table["kind"][found.rows] == kind) if kind else np.full(len(found.rows), kind is not None)
    if name == "max_winding_temperature":  # without a rating it goes with nothing
        harder_when_low |= found.fit == UNRATED
    return np.where(harder_when_low == (end == "unfavourable"), found.low, found.high)
