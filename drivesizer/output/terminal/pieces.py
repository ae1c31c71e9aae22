"""The motor piece by piece at the terminal."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table

from drivesizer.output.pieces_table import FIGURES
from drivesizer.output.terminal.tables import bare
from drivesizer.results.pieces import MotorPiece
from drivesizer.units import label, show

__all__ = ["pieces"]

_SHOWN = [figure for figure in FIGURES if figure[1] not in ("start", "rms_current")]  # what 80 characters hold


def pieces(found: Sequence[MotorPiece], title: str) -> Table:
    """The motor piece by piece of the motion, each unit in its column's head."""
    heads = [(f"{head}\n{label(unit)}", "right") for head, _, unit, _ in _SHOWN]
    table = bare(("", "left"), *heads, title=title)
    for one in found:
        cells = (show(getattr(one, field), unit, kind, 3) for _, field, unit, kind in _SHOWN)
        table.add_row(one.name, *(cell.split(" ")[0] for cell in cells))
    return table
