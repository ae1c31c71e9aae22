"""The tables of a sizing as plain rows, for data frames and programs of one's own."""

from __future__ import annotations

from collections.abc import Mapping
from math import isnan
from typing import Any

from drivesizer.control.validation import Validation
from drivesizer.output.document.axes import content_of, wide_of
from drivesizer.output.document.records import WIDE, Bar, Quantity, Table, flat, text_of
from drivesizer.results.machine import MachineSizing
from drivesizer.results.sizing import SizingResult


def tables(
    result: SizingResult | MachineSizing, proof: Validation | Mapping[str, Validation] | None = None
) -> dict[str, list[dict[str, Any]]]:
    """The tables of a report as rows, by the kind of thing that a row is.

    Parameters
    ----------
    result
        Of ``size``, or of ``size_machine``.
    proof
        Of ``validate``; of several axes by their names.

    Returns
    -------
    dict of list of dict
        Rows with their name, the rank of the drive that they are of, the axis where there are several, and a value for
        each column: a figure [SI], NaN where it is unknown, or a text.

    Examples
    --------
    >>> from drivesizer import load_spec, size
    >>> found = tables(size(load_spec("examples/sps_robot.yaml"), top=1))
    >>> [row["status"] for row in found["check"] if row["name"] == "winding_temperature"]
    ['pass']
    """
    found: dict[str, list[dict[str, Any]]] = {}
    for section in wide_of(content_of(result, proof), WIDE):
        head: dict[str, Any] = {"axis": section.axis} if section.axis else {}
        if not isnan(section.rank):
            head["rank"] = int(section.rank)
        for table in flat(section.blocks):
            if not isinstance(table, Table) or table.media not in WIDE:
                continue
            keys = [column.key for column in table.columns if column.media in WIDE]
            for row in table.rows:
                cells = {key: cell for key in keys if not isinstance(cell := row.cells.get(key, ""), Bar)}
                figures = {key: cell.value if isinstance(cell, Quantity) else text_of(cell)
                           for key, cell in cells.items()}  # fmt: skip
                name = table.record or section.section.name
                found.setdefault(name, []).append({**head, "name": row.name, **figures})
    return found
