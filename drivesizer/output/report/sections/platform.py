"""The platform's kinematics and dynamics in numbers, equations (21)-(59) beside them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from math import radians

from drivesizer.output.platform_numbers import PlatformNumbers, formula, platform_numbers, printed
from drivesizer.output.report.lines.rows import Row as Line
from drivesizer.output.report.sections.blocks import Block, Column, Heading, Pair, Row, Table, Words
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.section import CsvRows, Section
from drivesizer.output.report.sections.sheet import Sheet, SheetColumn
from drivesizer.output.report.sections.sheets import VALUES
from drivesizer.output.report.sections.texts import Number
from drivesizer.platform.robot_figures import Numbers

__all__ = ["PLATFORM_NUMBERS"]

_SI = {"deg": ("rad", radians(1.0)), "mm": ("m", 1e-3)}


def _numbers(content: Content) -> PlatformNumbers | None:
    spec = content.result.spec
    return platform_numbers(spec, content.drive) if spec.platform else None


def _blocks(content: Content) -> Iterator[Block]:
    found = _numbers(content)
    if found is None:
        return
    yield Words(
        "Symbols and numbers of equations are those of the paper, the symbols L, α, β, γ of its Table 1; x points "
        "forward, y to the left, θ turns counterclockwise. Each table is computed by the equation that it names."
    )
    yield Heading("Kinematics")
    yield _table(found.wheels)
    kinematics, dynamics = found.matrices[:4], found.matrices[4:]
    yield from _pairs([*kinematics[:3:2], *kinematics[1::2]])
    yield _table(found.mobility)
    yield Heading("Dynamics")
    yield Words(f"{found.rotors} C̄ and C_q are at a turning speed of 1 rad/s, with which they grow.")
    yield from _pairs([one for pair in zip(dynamics[::2], dynamics[1::2], strict=True) for one in pair])
    yield Heading("Forces and torques")
    yield Words(
        f"{found.moment} Rolling resistance is that of wheels, rollers and casters, which the paper leaves out."
    )
    yield from map(_table, found.at_instant)


def _pairs(tables: list[Numbers]) -> Iterator[Block]:
    """Tables beside each other, two by two."""
    for left, right in zip(tables[::2], tables[1::2], strict=True):
        yield Pair([_table(left)], [_table(right)])


def _table(numbers: Numbers) -> Table:
    shown, rows = printed(numbers), []
    for name, texts, values, units in zip(numbers.rows, shown.cells, numbers.values, numbers.units, strict=True):
        rows.append(Row((name, *map(_number, texts, values.tolist(), units))))
    named = ", ".join(f"({number})" for number in numbers.equations)
    caption = f"{numbers.meaning} {named}: {formula(numbers)}" if named else numbers.meaning
    columns = [Column("", "name", 1.0), *(Column(head, "number") for head in shown.heads)]
    return Table(f"{caption}, in {shown.unit}" if shown.unit else caption, columns, rows, look="figures", dense=True)


def _number(text: str, value: float, unit: str) -> Number:
    si, factor = _SI.get(unit, (unit, 1.0))
    return Number(text, value, unit, value * factor, si)


def _lines(content: Content) -> Iterator[Line]:
    """One entry of a table in each."""
    found = _numbers(content)
    for numbers in found.every if found else ():
        of = {"section": "platform", "symbol": numbers.symbol, "equation": next(iter(numbers.equations), "")}
        for row, values, units in zip(numbers.rows, numbers.values, numbers.units, strict=True):
            for column, value, unit in zip(numbers.columns, values.tolist(), units, strict=True):
                entry = _number("", value, unit)
                place = ", ".join(filter(None, (row, column)))
                name = re.sub(r"\W+", "_", f"{numbers.name} {place}".replace("θ", "theta"))
                yield of | {"name": name, "title": f"{numbers.meaning}, {place}", "value": value, "unit": unit,
                            "si_value": entry.si_value, "si_unit": entry.si_unit}  # fmt: skip


def _sheet(content: Content) -> Iterator[Sheet]:
    rows = [*_lines(content)]
    heads = SheetColumn("what", "title"), SheetColumn("symbol", "symbol"), SheetColumn("equation", "equation", "count")
    if rows:
        yield Sheet(
            name="Platform", columns=(*heads, *VALUES), rows=rows, still=3, note="kinematics and dynamics in numbers"
        )


PLATFORM_NUMBERS = Section(
    name="platform", title="Kinematics and dynamics of the platform", blocks=_blocks, appendix=True, sheets=_sheet,
    csv=CsvRows(after=_lines),
)  # fmt: skip
