"""The appendix: what made the report out of what, and the spec file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from drivesizer.output.report.sections.blocks import Block, Column, Fragment, Row, Table
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.section import Section
from drivesizer.output.report.sections.sheet import Sheet, SheetColumn
from drivesizer.output.report.sections.specification import file_name
from drivesizer.output.report.sections.summary import texts
from drivesizer.output.report.sections.texts import Code
from drivesizer.version import __version__

__all__ = ["REPEAT", "SPEC_FILE", "about", "about_sheet", "file_sheet", "repeat_blocks"]

_FEW = 4  # catalogues in the table; more are listed in a file of their own


def _repeat(content: Content) -> Iterator[Block]:
    result = content.result
    yield from repeat_blocks(
        result.catalog.digests, result.method, result.objective, file_name(content), result.spec.text
    )


def repeat_blocks(catalogs: Mapping[str, str], method: str, objective: str, file: str, text: str) -> Iterator[Block]:
    """Versions, digests and the file that a result came from."""
    digests = [*catalogs.items()]
    rows = [Row(("drivesizer", __version__)), Row(("method", method)), Row(("objective", objective.replace("_", " ")))]
    few = digests if len(digests) <= _FEW else []
    rows += [Row((f"catalogue {name}, digest", (Code(digest),))) for name, digest in few]
    yield Table("", (Column("", "name"), Column("", width=1.0)), rows, look="figures")
    if len(digests) > _FEW:
        yield Fragment("digests", [list(one) for one in digests])
    lines = text.splitlines()
    if lines:
        yield Fragment("file", [file or "spec.yaml", *lines])


REPEAT = Section(name="repeat", title="How to repeat this", blocks=_repeat, appendix=True, tabled=False)


def _no_blocks(_: Content) -> tuple[()]:
    """None: the file is part of how to repeat the report."""
    return ()


def _sheet(content: Content) -> list[Sheet]:
    spec = content.result.spec
    return [file_sheet(file_name(content), spec.text, spec.entered)]


def file_sheet(file: str, text: str, entered: Mapping[str, Any]) -> Sheet:
    """The spec file line by line, comments included; without a file the fields as they were entered."""
    import yaml

    written = text or yaml.safe_dump(entered, allow_unicode=True, sort_keys=False)
    rows = [{"line": number, "text": line} for number, line in enumerate(written.splitlines(), 1)]
    columns = (SheetColumn("line", "line", "count"), SheetColumn(file or "spec", "text", "code", 110))
    return Sheet(name="Spec", columns=columns, rows=rows, filtered=False)


SPEC_FILE = Section(name="file", title="The spec file", blocks=_no_blocks, appendix=True, sheets=_sheet, tabled=False)


_MEANING = (
    ("pass, fail, unknown", "a check with an unknown figure is unknown: it neither passes nor fails"),
    ("open", "a check that passes at one end of the 5 to 95 % band of estimated figures and fails at the other"),
    ("empty cell", "the figure is unknown; never zero"),
    ("numbers", "with all their digits, shown with four; the unit is beside or in the head"),
    ("SI value", "the same figure in the unit of the SI"),
    ("margin", "limit over demand less 1; of a required minimum what there is over what is required less 1"),
    ("quoted", "from the maker's own document"),
    ("secondary", "copied by others"),
    ("derived", "computed or inferred"),
    ("recalled", "from memory: to be checked before anything is built"),
)


def about(content: Content, sheets: Sequence[Sheet]) -> Sheet:
    """The last sheet of a workbook: versions, digests, the meaning of its words, and notes on the other sheets."""
    result = content.result
    return about_sheet(result.catalog.digests, result.method, result.objective, sheets)


def about_sheet(catalogs: Mapping[str, str], method: str, objective: str, sheets: Sequence[Sheet]) -> Sheet:
    """The last sheet of a workbook; see :func:`about`."""
    rows = [{"title": "drivesizer", "note": __version__}]
    rows += [{"title": f"catalogue {name}, digest", "note": digest} for name, digest in catalogs.items()]
    rows += [{"title": "method", "note": method}, {"title": "objective", "note": objective}]
    rows += [{"part": "Words"}, *({"title": word, "note": meaning} for word, meaning in _MEANING)]
    rows += texts("Sheets", [f"{sheet.name}: {sheet.note}" for sheet in sheets if sheet.note])
    columns = (SheetColumn("About this file", "title"), SheetColumn("meaning", "note", "", 110))
    return Sheet(name="About", columns=columns, rows=rows, filtered=False)
