"""Part of a YAML document over defaults from the top of it, read as a document of its own.

A field keeps the line at which it stands: in the part where that has it, else among the defaults.
"""

from __future__ import annotations

from typing import Any

from drivesizer.files.yaml_source import Path_, YamlSource

__all__ = ["YamlOverlay", "overlay"]


class YamlOverlay(YamlSource):
    """A part of a document with the defaults under it."""

    def __init__(self, whole: YamlSource, at: Path_, data: dict[str, Any]) -> None:
        self.whole, self.at = whole, at
        self.text, self.name, self.numbered = whole.text, whole.name, whole.numbered
        self.data = data

    def line(self, path: Path_) -> int | None:
        """Line of the field at a path."""
        return self.whole.line(self._placed(path))

    def where(self, path: Path_) -> str:
        """``file:line: field.path``, the path as it is in the whole document."""
        return self.whole.where(self._placed(path))

    def _placed(self, path: Path_) -> Path_:
        """Path of a field in the whole document; one that is missing is of the part, unless only defaults are there."""
        own, shared = (_depth(self.whole.data, at + path) - len(at) for at in (self.at, ()))
        return path if shared > max(own, 0) else self.at + path


def _depth(data: Any, path: Path_) -> int:
    """Number of steps of a path that the data have."""
    for count, step in enumerate(path):
        try:
            data = data[step]
        except (TypeError, KeyError, IndexError):
            return count
    return len(path)


def overlay(whole: YamlSource, at: Path_, shared: dict[str, Any], own: dict[str, Any]) -> YamlOverlay:
    """Fields of a part over shared ones: groups of fields field by field, anything else as a whole."""
    data = dict(shared)
    for name, value in own.items():
        default = shared.get(name)
        merged = isinstance(value, dict) and isinstance(default, dict) and not {"kind", "profile"} & set(value)
        data[name] = {**default, **value} if merged and default is not None else value
    return YamlOverlay(whole, at, data)
