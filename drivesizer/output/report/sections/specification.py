"""The specification as it was entered, by section, with the figures of the motion."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from drivesizer.output.report.sections.blocks import Block, Fragment, Picture, Words
from drivesizer.output.report.sections.content import Content
from drivesizer.output.report.sections.section import Section
from drivesizer.output.report.sections.texts import Code

__all__ = ["SPECIFICATION", "file_name"]


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
