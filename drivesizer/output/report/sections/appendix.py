"""The appendix: the specification as it was entered, and what made the report out of what."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from drivesizer.output.report.sections.section import (
    Block,
    Code,
    Column,
    Content,
    Fragment,
    Picture,
    Row,
    Section,
    Sheet,
    SheetColumn,
    Table,
    Words,
)
from drivesizer.output.report.sections.summary import texts
from drivesizer.version import __version__

__all__ = ["REPEAT", "SPECIFICATION", "SPEC_FILE", "about", "about_sheet", "file_name", "file_sheet", "repeat_blocks"]


# -- The specification as it was entered, by section, with the figures of the motion.


def _blocks(content: Content) -> Iterator[Block]:
    spec, file = content.result.spec, file_name(content)
    groups = _groups(spec.entered)
    if groups:
        yield Words((
            "The figures as they were entered", *((" in ", Code(file)) if file else ()),
            ".",
        ))  # fmt: skip
    yield Fragment("spec", groups)
    yield Picture("way", "The path from above, to scale, and the robot with its heading at intervals.",
                  "the path in plan view", about="shows the path.")  # fmt: skip
    several = ", as specified" if content.cases else ""
    motion = (
        "The motion of the platform on its path, in its own axes."
        if content.wheel
        else f"The motion of one cycle{several}."
    )
    yield Picture("profile", motion, "speed over time", about="shows the motion.")


def file_name(content: Content) -> str:
    """The name of the spec's file without its folder."""
    return content.result.spec.file.replace("\\", "/").rsplit("/", 1)[-1]


def _groups(entered: dict[str, Any]) -> list[dict[str, Any]]:
    """Sections of the spec with rows of field and value; what is entered at the top level has one of its own."""
    top = [[key, _scalar(value)] for key, value in entered.items() if not isinstance(value, dict | list)]
    groups = [{"title": key.replace("_", " "), "rows": _flat(value)} for key, value in entered.items()
              if isinstance(value, dict | list)]  # fmt: skip
    return [group for group in ({"title": "general", "rows": top}, *groups) if group["rows"]]


def _flat(value: Any, path: tuple[str, ...] = ()) -> list[list[str]]:
    if isinstance(value, dict):
        return [row for key, entry in value.items() for row in _flat(entry, (*path, str(key)))]
    if isinstance(value, list) and any(isinstance(entry, dict) for entry in value):
        return [row for n, entry in enumerate(value, 1) for row in _listed(entry, path, n)]
    shown = ", ".join(_scalar(entry) for entry in value) if isinstance(value, list) else _scalar(value)
    return [[" › ".join(path), shown]]


def _listed(entry: Any, path: tuple[str, ...], number: int) -> list[list[str]]:
    """An entry of a list: in one row under its name where it has one and holds no more than figures."""
    if not isinstance(entry, dict) or "name" not in entry or any(isinstance(v, dict | list) for v in entry.values()):
        return _flat(entry, (*path, str(number)))
    figures = [f"{key.replace('_', ' ')} {_scalar(value)}" for key, value in entry.items() if key != "name"]
    return [[" › ".join((*path, _scalar(entry["name"]))), ", ".join(figures)]]


def _scalar(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return "" if value is None else str(value)


SPECIFICATION = Section(name="specification", title="Specification", blocks=_blocks, tabled=False)


# -- The appendix: what made the report out of what, and the spec file.


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
