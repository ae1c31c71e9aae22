"""CSV: one tidy table of everything that was found, the parts list, the closed loop over time, the drives in rows."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.control.validation import Validation
from drivesizer.output.parts import HEADS, PartLine, SharedLine
from drivesizer.output.report.lines.rows import COLUMNS, QUANTILES, Row, chance_columns, chances, every_list
from drivesizer.output.report.sections import SECTIONS
from drivesizer.output.report.sections.section import Content, rows_of
from drivesizer.output.words import csv_cell
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import SizingResult, worst
from drivesizer.units import KINDS, from_si

__all__ = [
    "COLUMNS", "columns_csv", "encoded", "report_csv", "set_columns", "sets_csv", "shared_parts_csv", "timeseries_csv",
]  # fmt: skip


# -- CSV: one tidy table of everything that was found, the parts list, the closed loop over time, and the drives in
# rows.
#
# UTF-8, lines end with a newline. Numbers are written with every digit that they have, an unknown figure is an
# empty cell, an unbounded one is ``inf``. Units are spelled as a spec accepts them.


def render(content: Content, path: Path) -> dict[Path, bytes]:
    """The files of a CSV report: the table, and beside it the parts list and the time series when there are such."""
    files = {path: report_csv(content)}
    if content.result.sets:
        files[path.with_name(f"{path.stem}-parts{path.suffix}")] = parts_csv(content.bought)
    if content.validation is not None:
        files[path.with_name(f"{path.stem}-timeseries{path.suffix}")] = timeseries_csv(content.validation)
    return files


def report_csv(content: Content) -> bytes:
    """Requirements, sets, what they do, checks, changes, the Pareto front, the parts list, the closed loop.

    One figure in a row.
    """
    columns = COLUMNS if content.result.uncertainty is None else (*COLUMNS, *QUANTILES)
    return encoded(columns, ([row.get(column, "") for column in columns] for row in _rows(content)))


def _rows(content: Content) -> Iterator[Row]:
    """Rows of every section: before the drives, of each drive with its rank, and after them."""
    found = [rows_of(section, content) for section in SECTIONS]
    for one in found:
        yield from one.before(content)
    for where, drive in every_list(content.result, front=False):
        for one in found:
            yield from (row | {"set_rank": drive.rank} for row in one.of_drive(content, where, drive))
    for one in found:
        yield from one.after(content)


_PARTS = (
    "role", "maker", "family", "part", "order_number", "said", "quantity", "mass", "mass_low", "mass_high", "price",
    "currency", "pieces", "price_date", "price_confidence", "price_source", "confidence", "document",
    "date", "url", "note",
)  # fmt: skip


def parts_csv(lines: Iterable[PartLine]) -> bytes:
    """A parts list: a row for each part, mass and price of one piece, and how many the machine has."""
    heads = (HEADS.get(name, name) for name in _PARTS)
    return encoded(heads, ([getattr(line, name) for name in _PARTS] for line in lines))


def shared_parts_csv(lines: Iterable[SharedLine]) -> bytes:
    """The parts list of several axes: as :func:`parts_csv`, with the names of the axes that need a part."""
    heads = (HEADS.get(name, name) for name in _PARTS)
    rows = ([*(getattr(one.line, name) for name in _PARTS), "; ".join(one.axes)] for one in lines)
    return encoded([*heads, "axes"], rows)


def timeseries_csv(validation: Validation) -> bytes:
    """The closed loop over time: a column per signal, its unit in the head."""
    units = validation.series_units
    return columns_csv({name: (values, *units[name]) for name, values in validation.series.items()})


def columns_csv(columns: Mapping[str, tuple[NDArray[np.float64], str, str]]) -> bytes:
    """Columns over time by name, each with its kind and the unit that it is written in."""
    heads = [f"{name} ({unit})" for name, (_, _, unit) in columns.items()]
    written = (_figures(from_si(values, unit, kind)) for values, kind, unit in columns.values())
    return encoded(heads, ()) + "".join(f"{','.join(row)}\n" for row in zip(*written, strict=True)).encode()


def _figures(values: NDArray[np.float64]) -> list[str]:
    """Figures as they stand in a CSV, which is to be read bit for bit; what is unknown is empty."""
    texts = [*map(repr, values.tolist())]
    return ["" if text == "nan" else text for text in texts] if np.isnan(values).any() else texts


def sets_csv(result: SizingResult) -> bytes:
    """One row per drive: the best, those below the required confidence, the closest rejected, and those of the front.

    Their probabilities are behind all other columns.
    """
    sets = every_list(result)
    heads, rows = set_columns([one for _, one in sets], result.objective)
    return encoded(["list", *heads], ([name, *row] for (name, _), row in zip(sets, rows, strict=True)))


def set_columns(sets: Sequence[DriveSet], objective: str) -> tuple[list[str], list[list[Any]]]:
    """Drives in rows, with all that they are, do and hold."""
    checks = list(dict.fromkeys(c.name for s in sets for c in s.own_checks))
    figures = {f.name: f.kind for s in sets for f in s.figures}
    heads = [*_SET_HEADS, "price_of", f"objective_{_slug(objective)}_si", "smallest_margin", "smallest_margin_check"]
    heads += [*(f"margin_{name}" for name in checks), *(f"figure_{name}_{KINDS[k].si}" for name, k in figures.items())]
    chance = chance_columns(iter(sets))
    return [*heads, *chance], [[*_set_row(one, checks, list(figures)), *chances(one, chance)] for one in sets]


def _slug(title: str) -> str:
    """The title of an objective as a word: that of several with weights has blanks.

    >>> _slug("2 mass + 1 price")
    '2_mass_1_price'
    """
    return "_".join(title.replace("+", " ").replace(",", " ").split())


_SET_HEADS = (
    "rank", "status", "motor_family", "motor_part", "gearhead_family", "gearhead_part", "gearhead_ratio",
    "belt_ratio", "driving_pulley_part", "belt_part", "driven_pulley_part", "centre_distance_m", "teeth_in_mesh",
    "screw_part", "brake_family", "brake_part", "encoder_family", "encoder_part", "controller_family",
    "controller_part", "total_ratio", "mass_kg", "mass_of", "price_EUR",
)  # fmt: skip


def _set_row(s: DriveSet, checks: list[str], figures: list[str]) -> list[Any]:
    tightest = worst(s.deciding)
    margins, does = {c.name: c.margin for c in s.own_checks}, {f.name: f.value for f in s.figures}
    chosen = [
        text for part in (s.brake, s.encoder, s.controller) for text in ((part.family, part.part) if part else ("", ""))
    ]
    return [
        s.rank, s.status, s.motor.family, s.motor.part, s.gearhead.family, s.gearhead.part, s.gearhead.ratio,
        s.belt_ratio, *_belt(s), s.chosen_screw.screw.part if s.chosen_screw else "", *chosen,
        s.total_ratio, s.mass, " + ".join(s.mass_of), s.price,
        " + ".join(s.price_of),
        s.objective, tightest.margin if tightest else "", tightest.name if tightest else "",
        *(margins.get(name, "") for name in checks), *(does.get(name, "") for name in figures),
    ]  # fmt: skip


def _belt(s: DriveSet) -> list[Any]:
    """Belt and pulleys, empty where they are not out of the catalogues."""
    drive = s.belt_drive
    return (
        [*(part.part for part in drive.parts.values()), drive.centre_distance, drive.teeth_in_mesh]
        if drive
        else [""] * 5
    )


def encoded(heads: Iterable[str], rows: Iterable[Iterable[Any]]) -> bytes:
    """A table as the bytes of a file."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(heads)
    writer.writerows([csv_cell(value) for value in row] for row in rows)
    return text.getvalue().encode()
