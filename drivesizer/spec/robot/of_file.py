"""A model that knows the file of which it was read: its text, its data as they were written, and lines of fields."""

from __future__ import annotations

from typing import Any

from pydantic import PrivateAttr

from drivesizer.files.fields import Section
from drivesizer.files.yaml_source import Path_, YamlSource

__all__ = ["OfFile"]


class OfFile(Section):
    """A group of fields that was read of a file, or of a dict, which has no name."""

    _source: YamlSource | None = PrivateAttr(default=None)

    @property
    def entered(self) -> dict[str, Any]:
        """The spec as the user wrote it."""
        return dict(self._source.data) if self._source else {}

    @property
    def text(self) -> str:
        """The file as the user wrote it, comments included."""
        return self._source.text if self._source else ""

    @property
    def file(self) -> str:
        """Name of the file."""
        return self._source.name if self._source else ""

    def where(self, path: Path_) -> str:
        """File, line and name of a field, for a message."""
        return self._source.where(path) if self._source else ".".join(str(step) for step in path)
