"""Tables for other programs: CSV, tidy and beside it tables and series with files of their own; and plain rows."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import isnan
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.validation import Validation
from drivesizer.output.document import records as doc
from drivesizer.output.document.axes import MachineContent, content_of, wide_of
from drivesizer.output.document.candidates import drives_in_rows, every_list
from drivesizer.output.words import csv_cell
from drivesizer.results.machine import MachineSizing
from drivesizer.results.sizing import SizingResult
from drivesizer.units import from_si

# UTF-8, lines end with a newline. Numbers are written with every digit that they have, an unknown figure is an empty
# cell, an unbounded one is ``inf``. Units are spelled as a spec accepts them.

COLUMNS = (
    "section", "set_rank", "name", "title", "symbol", "equation", "method", "case", "value", "limit", "unit",
    "si_value", "si_limit", "si_unit", "margin", "needed_margin", "status", "at_time_s", "note",
)  # fmt: skip


def files_csv(content: MachineContent, path: Path) -> dict[Path, bytes]:
    """The files of a CSV report: the tidy table, a file of each table and series that has one."""
    sections = list(wide_of(content, doc.WIDE))
    axes = list(dict.fromkeys(section.axis for section in sections if section.axis))
    files = {path: _tidy(sections)}
    for section in sections:
        for block in doc.flat(section.blocks):
            key = f"axis{1 + axes.index(section.axis)}-" if section.axis else ""
            name = path.with_name(f"{path.stem}-{key}{getattr(block, 'file', '')}{path.suffix}")
            if isinstance(block, doc.Series):
                files[name] = columns_csv(block.columns)
            elif isinstance(block, doc.Table) and block.file and not section.axis:
                files[name] = table_csv(block)
    return files


def report_csv(content: MachineContent) -> bytes:
    """The tidy table of everything that was found: one figure in a row."""
    return _tidy(list(wide_of(content, doc.WIDE)))


def _tidy(sections: Sequence[doc.Printed]) -> bytes:
    columns = ("axis", *COLUMNS) if any(section.axis for section in sections) else COLUMNS
    return encoded(columns, ([row.get(column, "") for column in columns] for row in _rows(sections)))


def _rows(sections: Iterable[doc.Printed]) -> Iterator[dict[str, Any]]:
    """One figure in a row: a table with a column ``value`` has a line for each of its rows, another for each number."""
    for section in sections:
        rank = "" if isnan(section.rank) else int(section.rank)
        for table in doc.flat(section.blocks):
            if isinstance(table, doc.Table) and table.media in doc.WIDE:
                known = {"axis": section.axis, "section": table.record or section.section.name, "set_rank": rank}
                valued = any(column.key == "value" for column in table.columns)
                for row in table.rows:
                    own = (
                        {"set_rank": int(cell.value)} if isinstance(cell := row.cells.get("rank"), doc.Quantity) else {}
                    )
                    for line in _lines(table, row) if valued else _figures_of(table, row):
                        yield known | own | line


_LINE = {"margin": "margin", "needed": "needed_margin", "at": "at_time_s", "equation": "equation"}  # keys, SI


def _lines(table: doc.Table, row: doc.Row) -> Iterator[dict[str, Any]]:
    """A row with its value and limit; further numbers as lines of their own."""
    cells = row.cells
    line: dict[str, Any] = {"name": row.name, "title": _plain(cells.get("title", cells.get("role", "")))}
    line |= {key: _plain(cells[key]) for key in ("symbol", "method", "case", "note") if key in cells}
    line |= _number(cells.get("value", ""), "value") | _number(cells.get("limit", ""), "limit")
    line |= {name: cell.value for key, name in _LINE.items() if isinstance(cell := cells.get(key), doc.Quantity)}
    value = cells.get("value")
    unknown = isinstance(value, doc.Quantity) and isnan(value.value) and "status" not in cells
    yield line | {"status": "unknown" if unknown else _plain(cells.get("status", ""))}
    for column in table.columns:
        cell = cells.get(column.key)
        if isinstance(cell, doc.Quantity) and column.key not in {"value", "limit", "rank", "number", *_LINE}:
            yield {"name": f"{row.name}_{column.key}", "title": f"{line['title']}, {column.head}",
                   **_number(cell, "value")}  # fmt: skip


def _figures_of(table: doc.Table, row: doc.Row) -> Iterator[dict[str, Any]]:
    """Every number of a row as a line."""
    title = _plain(row.cells.get("title", row.cells.get("role", row.name)))
    more = {key: _plain(row.cells[key]) for key in ("symbol", "equation", "case") if key in row.cells}
    for column in table.columns:
        cell = row.cells.get(column.key)
        if isinstance(cell, doc.Quantity) and column.key != "rank":
            named = f"{title}, {column.head or column.key}".removeprefix(", ")
            status = row.status or ("unknown" if isnan(cell.value) else "")
            yield {**more, "name": f"{row.name}_{column.key}".strip("_"), "title": named, **_number(cell, "value"),
                   "status": status}  # fmt: skip


def _number(cell: Any, key: str) -> dict[str, Any]:
    if not isinstance(cell, doc.Quantity):
        return {key: _plain(cell)}
    if cell.kind == "count" and not isnan(cell.value):
        return {key: int(cell.value)}
    shares = 100.0 if cell.kind in ("margin", "probability") else 1.0
    return {key: shares * cell.number, "unit": cell.unit, f"si_{key}": cell.value, "si_unit": cell.si_unit}


def _plain(cell: Any) -> str:
    """A text; of a status its word, of mathematics the line of text."""
    status = isinstance(cell, tuple) and cell and isinstance(cell[0], doc.Status)
    return cell[0].text if status else doc.text_of(cell)


def table_csv(table: doc.Table) -> bytes:
    """A table by itself: a column for each key of wide media, numbers in SI or in their currency; sums at its end."""
    keys = [column.key for column in table.columns if column.media in doc.WIDE]
    heads = []
    for key in keys:
        figures = [cell for row in table.rows if isinstance(cell := row.cells.get(key), doc.Quantity)]
        units = {figure.si_unit for figure in figures} - {"", "1"}
        money = any(figure.kind == "money" for figure in figures)
        heads.append(f"{key}_{min(units)}" if len(units) == 1 and not money else key)
    return encoded(heads, ([_value(row.cells.get(key, "")) for key in keys] for row in table.rows))


def _value(cell: Any) -> Any:
    if not isinstance(cell, doc.Quantity):
        return _plain(cell)
    return int(cell.value) if cell.kind == "count" else cell.value


def sets_csv(result: SizingResult | MachineSizing) -> bytes:
    """One row per drive, of each axis where there are several: the best, the closest rejected, those of the front."""
    axes = [(axis.name, axis.result) for axis in result.axes] if isinstance(result, MachineSizing) else [("", result)]
    heads, rows = list[str](), list[tuple[str, doc.Row]]()
    for axis, of in axes:
        columns, drives = drives_in_rows(every_list(of), of.objective)
        heads += [column.key for column in columns if column.key not in heads]
        rows += [(axis, row) for row in drives]
    several = len(axes) > 1 or bool(axes[0][0])
    return encoded([*(["axis"] if several else []), *heads],
                   ([*([axis] if several else []), *(_value(row.cells.get(head, "")) for head in heads)]
                    for axis, row in rows))  # fmt: skip


def columns_csv(columns: Mapping[str, tuple[NDArray[np.float64], str, str]]) -> bytes:
    """Columns over time by name, each with its kind and the unit that it is written in."""
    heads = [f"{name} ({unit})" for name, (_, _, unit) in columns.items()]
    written = (_figures(from_si(values, unit, kind)) for values, kind, unit in columns.values())
    return encoded(heads, ()) + "".join(f"{','.join(row)}\n" for row in zip(*written, strict=True)).encode()


def _figures(values: NDArray[np.float64]) -> list[str]:
    """Figures as they stand in a CSV, which is to be read bit for bit; what is unknown is empty."""
    texts = [*map(repr, values.tolist())]
    return ["" if text == "nan" else text for text in texts] if np.isnan(values).any() else texts


def encoded(heads: Iterable[str], rows: Iterable[Iterable[Any]]) -> bytes:
    """A table as the bytes of a file."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(heads)
    writer.writerows([csv_cell(value) for value in row] for row in rows)
    return text.getvalue().encode()


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
    rows_of: dict[str, list[dict[str, Any]]] = {}
    for section in wide_of(content_of(result, proof), doc.WIDE):
        head: dict[str, Any] = {"axis": section.axis} if section.axis else {}
        if not isnan(section.rank):
            head["rank"] = int(section.rank)
        for table in doc.flat(section.blocks):
            if not isinstance(table, doc.Table) or table.media not in doc.WIDE:
                continue
            keys = [column.key for column in table.columns if column.media in doc.WIDE]
            for row in table.rows:
                cells = {key: cell for key in keys if not isinstance(cell := row.cells.get(key, ""), doc.Bar)}
                figures = {key: cell.value if isinstance(cell, doc.Quantity) else doc.text_of(cell)
                           for key, cell in cells.items()}  # fmt: skip
                name = table.record or section.section.name
                rows_of.setdefault(name, []).append({**head, "name": row.name, **figures})
    return rows_of
