"""YAML text to plain data, strictly, and back from a field's path to its line; several documents over one another."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from drivesizer.errors import InputError, printable, quoted
from drivesizer.files.text import read_text

__all__ = ["LOADER", "Path_", "YamlSource", "overlay", "read", "written"]


# -- YAML text to plain data, strictly, and back from a field's path to its line.
#
# YAML 1.2 core scalars only (``on`` is text, ``27:1`` is text), unique keys, no anchors, aliases, tags or second
# documents, no terminal control characters, bounded size, depth and number of keys: a hostile or careless file
# causes no more than a one-line error. libyaml parses; the data is built here, because PyYAML's constructor keeps
# neither positions nor strictness.


Path_ = tuple[str | int, ...]  # keys and indices from the top of the document to a field

LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_DEEPEST = 20
_TOO_DEEP = f"nested deeper than {_DEEPEST} levels"
_MOST_KEYS = 10_000  # of one group of fields
_LARGEST = 2_000_000  # bytes: long data belongs in a CSV file beside it
_NULL = {"", "~", "null", "Null", "NULL"}
_BOOL = {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}
_INT = re.compile(r"[-+]?[0-9]+", re.ASCII)
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?", re.ASCII)
# controls but tab and line feed, line ends of other scripts, and marks of writing direction
_UNSEEN = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff\ufff9-\ufffb\ud800-\udfff]"
)


class YamlSource:
    """A YAML document: its data, and the line of any field in it."""

    def __init__(self, text: str, name: str, *, numbered: bool = True) -> None:
        self.text = text
        self.name = name
        self.numbered = numbered  # whether its lines are those of a file
        self.data = _build(text, name, lambda path, line: None)
        self._lines: dict[Path_, int] = {}

    def with_data(self, data: Any) -> YamlSource:
        """The same document with other data, whose fields have its lines."""
        other = object.__new__(YamlSource)
        other.__dict__.update(self.__dict__, data=data)
        return other

    def line(self, path: Path_) -> int | None:
        """Line of the field at a path, or of the nearest field above it (parsed again on the first call)."""
        if not self.numbered:
            return None
        if not self._lines:
            _build(self.text, self.name, self._lines.setdefault)
        for length in range(len(path), 0, -1):
            if path[:length] in self._lines:
                return self._lines[path[:length]]
        return None

    def where(self, path: Path_) -> str:
        """``file:line: field.path``, the head of a message."""
        line = self.line(path)
        place = f"{self.name}:{line}" if line else self.name
        field = "".join(f"[{p + 1}]" if isinstance(p, int) else f".{_short(p)}" for p in path).lstrip(".")
        return f"{place}: {printable(field)}" if field else place


def _short(key: str, longest: int = 60) -> str:
    """A key as it is named in a message: none of the schema's is cut."""
    return key if len(key) <= longest else key[: longest - 1] + "…"


def read(path: Path, largest: int = _LARGEST) -> YamlSource:
    """Read a YAML file of at most `largest` bytes."""
    return YamlSource(read_text(path, largest), str(path))


def written(data: Mapping[str, Any], name: str = "spec") -> YamlSource:
    """Fields of a program as the YAML document that has them, read as strictly as a file."""
    try:
        text = yaml.dump(dict(data), Dumper=_Unshared, sort_keys=False, allow_unicode=True, width=math.inf)
    except yaml.representer.RepresenterError as error:
        found = f"{type(error.args[-1]).__name__} {quoted(str(error.args[-1]))}"
        raise InputError(
            f"{name}: {found}: expected text with a unit, a number, a list or a dict, e.g. '45 kg'"
        ) from None
    return YamlSource(text, name, numbered=False)


class _Unshared(yaml.SafeDumper):
    """Writes an object twice that two fields share, without an anchor."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def _scalar(event: Any) -> Any:
    value = event.value
    if event.style:  # quoted or a block
        return value
    if value in _NULL:
        return None
    if value in _BOOL:
        return _BOOL[value]
    if _INT.fullmatch(value):
        return value if len(value) > 1 and value[0] == "0" else int(value) if len(value) < 300 else value
    if _FLOAT.fullmatch(value) and math.isfinite(float(value)):
        return float(value)
    return value


def _events(text: str, name: str) -> Iterator[Any]:
    try:
        yield from yaml.parse(text, Loader=LOADER)
    except yaml.reader.ReaderError as error:
        line = text.encode()[: error.position].count(b"\n") + 1  # libyaml counts bytes
        raise InputError(f"{name}:{line}: the character {error.character!r} is not allowed in YAML") from None
    except yaml.MarkedYAMLError as error:
        raise InputError(f"{name}:{_not_yaml(error, text)}") from None


def _not_yaml(error: yaml.MarkedYAMLError, text: str) -> str:
    """Line and reason of a syntax error; of an unclosed quote or bracket, the line that opens it."""
    lines = text.splitlines()
    here = error.problem_mark or error.context_mark
    problem, line = error.problem or "unreadable", here.line if here else 0
    if line >= len(lines) and error.context_mark:  # the file ends in the middle of something
        line, problem = (
            error.context_mark.line,
            f"{problem} {error.context or ''}, which begins here".replace(" ,", ","),
        )
    elif error.context_mark and error.context_mark.line < line:
        begun = error.context_mark.line
        if "simple key" in (error.context or ""):  # the line before is no field
            line, problem = begun, f"{problem} behind a field's name"
        elif "flow" in (error.context or ""):
            problem = f"{problem}; the bracket of line {begun + 1} is not closed"
    line = min(line, max(len(lines) - 1, 0))
    if "nesting depth" in problem:  # libyaml looks ahead of what it hands on
        return f"{line + 1}: {_TOO_DEEP}"
    return f"{line + 1}: not YAML: {problem}{_hint(lines, line, problem)}"


def _hint(lines: list[str], line: int, problem: str) -> str:
    """The likely cause of a syntax error, by its line and the one above that says something."""
    if not lines:
        return ""
    if "\t" in lines[line]:
        return "; indent with blanks, not tabs"
    above = next((text for text in reversed(lines[:line]) if text.split("#")[0].strip()), "")
    here, before = (len(text) - len(text.lstrip(" ")) for text in (lines[line], above))
    if here != before and ("mapping values" in problem or "expected" in problem):
        where = "deeper" if here > before else "less deep"
        by = f"{here} blank{'s' * (here != 1)}, {where} than the line above"
        return f"; indented by {by}: fields of one group stand below each other"
    if "mapping values" in problem:
        return "; a text with a colon and a blank in it needs quotes"
    return ""


def _build(text: str, name: str, note: Callable[[Path_, int], object]) -> Any:
    """Data from events; ``note`` is called with the path and line of every field."""
    builder = _Builder(name, note)
    for event in _events(text, name):
        builder.take(event)
    return builder.root


class _Builder:
    """Builds dicts, lists and scalars from YAML events, and refuses features that specs do not use."""

    def __init__(self, name: str, note: Callable[[Path_, int], object]) -> None:
        self.name = name
        self.note = note
        self.root: Any = None
        self.documents = 0
        self.open: list[tuple[Any, Path_]] = []  # containers that are not closed yet, with their paths
        self.keys: list[str | None] = []  # for each open mapping, the key that waits for its value

    def fail(self, event: Any, message: str) -> InputError:
        return InputError(f"{self.name}:{event.start_mark.line + 1}: {message}")

    def take(self, event: Any) -> None:
        self.check(event)
        match type(event).__name__:
            case "MappingEndEvent":
                self.open.pop()
                self.keys.pop()
            case "SequenceEndEvent":
                self.open.pop()
            case _ if self.keys and isinstance(self.open[-1][0], dict) and self.keys[-1] is None:
                self.keys[-1] = self.key(event)
            case "ScalarEvent":
                self.place(_scalar(event), event)
            case "MappingStartEvent":
                self.start({}, event)
                self.keys.append(None)
            case "SequenceStartEvent":
                self.start([], event)

    def check(self, event: Any) -> None:
        if isinstance(event, yaml.DocumentStartEvent):
            self.documents += 1
            if self.documents > 1:
                raise self.fail(event, "a second document (---) starts; expected one")
        if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None):
            raise self.fail(event, "anchors and aliases (& and *) are not used here; quote text that starts with them")
        if getattr(event, "tag", None) and event.tag != "!":
            raise self.fail(event, f"the tag {quoted(event.tag)} is not used here")
        if unseen := _UNSEEN.search(getattr(event, "value", "")):
            raise self.fail(event, f"the character {unseen[0]!r} is not used here; expected text as it is printed")

    def start(self, container: Any, event: Any) -> None:
        if len(self.open) >= _DEEPEST:
            raise self.fail(event, _TOO_DEEP)
        self.open.append((container, self.place(container, event)))

    def key(self, event: Any) -> str:
        if type(event).__name__ != "ScalarEvent":
            raise self.fail(event, "a key must be plain text")
        container, path = self.open[-1]
        key = str(event.value)
        if key == "<<":
            raise self.fail(event, "merge keys (<<) are not used here; write the fields out")
        if key in container:
            raise self.fail(event, f"the key {quoted(key)} is given twice")
        if len(container) == _MOST_KEYS:
            raise self.fail(event, f"more than {_MOST_KEYS} keys in one group of fields; expected fewer")
        self.note((*path, key), event.start_mark.line + 1)
        return key

    def place(self, value: Any, event: Any) -> Path_:
        """Add a value to its container; return its path."""
        if not self.open:
            self.root = value
            return ()
        container, path = self.open[-1]
        if isinstance(container, list):
            container.append(value)
            path = (*path, len(container) - 1)
        else:
            container[self.keys[-1]] = value
            path = (*path, self.keys[-1] or "")
            self.keys[-1] = None
        self.note(path, event.start_mark.line + 1)
        return path


# -- Part of a YAML document over defaults from the top of it, read as a document of its own.
#
# A field keeps the line at which it stands: in the part where that has it, else among the defaults.


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
