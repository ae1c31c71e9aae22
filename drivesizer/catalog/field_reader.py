"""One catalogue file while it is read: places of fields, and the checks that all its sections share."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Any

from drivesizer.catalog.tables import Note, Source
from drivesizer.errors import CatalogError, quoted
from drivesizer.files.yaml_source import Path_, YamlSource

__all__ = ["Reader", "did_you_mean"]


class Reader:
    """A catalogue file with its sources and notes; errors name file, line and field."""

    def __init__(self, source: YamlSource) -> None:
        self.file = source
        self.sources: dict[str, Source] = {}
        self.notes: list[Note] = []

    def fail(self, path: Path_, message: str) -> CatalogError:
        """The error at a place of the file."""
        return CatalogError(f"{self.file.where(path)}: {message}")

    def mapping(self, value: Any, path: Path_, allowed: Iterable[str], required: Iterable[str] = ()) -> dict[str, Any]:
        """A mapping with no other keys than those allowed, and all that are required."""
        if not isinstance(value, dict):
            raise self.fail(path, f"expected fields such as {', '.join(sorted(required) or sorted(allowed)[:3])}")
        for key in value:
            if key not in allowed:
                raise self.fail((*path, key), f"unknown key {quoted(key)}{did_you_mean(key, allowed)}")
        for key in sorted(required):
            if key not in value:
                raise self.fail(path, f"{quoted(key)} is missing")
        return value

    def sequence(self, value: Any, path: Path_) -> list[Any]:
        """A list."""
        if not isinstance(value, list):
            raise self.fail(path, "expected a list")
        return value

    def source_number(self, name: Any, path: Path_) -> int:
        """The place of a named source among the file's."""
        if not isinstance(name, str) or name not in self.sources:
            raise self.fail(path, f"{quoted(name)} is not one of the file's sources ({', '.join(self.sources)})")
        return list(self.sources).index(name)

    def plain_text(self, value: Any, path: Path_) -> str:
        """A text; numbers count as what they look like."""
        if value is None:
            return ""
        if isinstance(value, bool) or not isinstance(value, str | int | float):
            raise self.fail(path, "expected text")
        return str(value)

    def part_number(self, value: Any, path: Path_) -> str:
        """A part number, quoted or not."""
        if isinstance(value, bool) or not isinstance(value, str | int) or not str(value).strip():
            raise self.fail(path, f"{quoted(value)} is not a part number; quote it")
        return str(value)

    def flag(self, value: Any, path: Path_) -> bool:
        """True or false."""
        if not isinstance(value, bool):
            raise self.fail(path, f"{quoted(value)} is not true or false")
        return value


def did_you_mean(key: str, allowed: Iterable[str]) -> str:
    """Hint for an unknown word: the nearest allowed one, or all of them."""
    close = difflib.get_close_matches(key, sorted(allowed), 1)
    return f"; did you mean {quoted(close[0])}?" if close else f"; expected one of {', '.join(sorted(allowed))}"
