"""The chart of a workbook: columns of a sheet over its first, drawn by the spreadsheet itself."""

from __future__ import annotations

from typing import Any

from drivesizer.output.report.figures.style import COLOURS
from drivesizer.output.report.sections.sheet import Sheet, SheetColumn

__all__ = ["draw"]

_INKS = (COLOURS["grey"], COLOURS["blue"], COLOURS["vermillion"])


def draw(book: Any, page: Any, sheet: Sheet, count: int) -> None:
    """Draw what a sheet names beside its rows; a column in another unit than the first has its own axis."""
    drawing, places = book.add_chart(_SCATTER), {column.key: place for place, column in enumerate(sheet.columns)}
    units = [_unit(sheet.columns[places[key]]) for key in sheet.drawn]
    for ink, key, unit in zip(_INKS, sheet.drawn, units, strict=True):
        drawing.add_series({
            "name": [sheet.name, 0, places[key]],
            "categories": [sheet.name, 1, 0, count, 0],
            "values": [sheet.name, 1, places[key], count, places[key]],
            "line": {"color": ink, "width": 1.0},
            "y2_axis": unit != units[0],
            "categories_data": [], "values_data": [],  # read from the sheet: a copy would double the file
        })  # fmt: skip
    drawing.set_x_axis({"name": sheet.columns[0].head, "min": 0, "label_position": "low"})
    drawing.set_y_axis({"name": units[0], "major_gridlines": {"visible": True, "line": {"color": "#DDDDDD"}}})
    drawing.set_y2_axis({"name": units[-1]})
    drawing.set_legend({"position": "top"})
    drawing.set_size({"width": 900, "height": 380})
    page.insert_chart(1, len(sheet.columns) + 1, drawing)


def _unit(column: SheetColumn) -> str:
    return column.head.partition("(")[2].removesuffix(")")


_SCATTER = {"type": "scatter", "subtype": "straight"}
