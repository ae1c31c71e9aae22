"""YAML text to plain data, strictly, and back from a field's path to its line; several documents over one another."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from drivesizer.errors import InputError, printable, quoted
from drivesizer.files.text import read_text

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
_LONGEST = 60  # characters of a key in messages: none of the schema's is cut
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
        # what was read of it of late, also with other data: by name and units, the data of a section and what it became
        self.sections: dict[tuple[str, str], tuple[Any, Any]] = {}

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
        field = field_name([p if isinstance(p, int) or len(p) <= _LONGEST else f"{p[: _LONGEST - 1]}…" for p in path])
        return f"{place}: {printable(field)}" if field else place


class OfFile:
    """Something that was read of a file, its ``source``, or of a dict, which has no name."""

    if TYPE_CHECKING:

        @property
        def source(self) -> YamlSource:
            """The file."""

    @property
    def entered(self) -> dict[str, Any]:
        """The data as the user wrote them."""
        return dict(self.source.data)

    @property
    def text(self) -> str:
        """The file as the user wrote it, comments included."""
        return self.source.text

    @property
    def file(self) -> str:
        """Name of the file."""
        return self.source.name

    def where(self, path: Path_) -> str:
        """File, line and name of a field, for a message."""
        return self.source.where(path)


def field_name(path: Sequence[str | int]) -> str:
    """A field as messages name it; entries of lists count from 1.

    >>> field_name(("transmission", 1, "ratio"))
    'transmission[2].ratio'
    """
    return "".join(f"[{step + 1}]" if isinstance(step, int) else f".{step}" for step in path).lstrip(".")


def read(path: Path, largest: int = _LARGEST) -> YamlSource:
    """Read a YAML file of at most `largest` bytes."""
    return YamlSource(read_text(path, largest), str(path))


@cache
def shipped_data(package: str, name: str) -> Any:
    """The data of a YAML file that ships with the program; not to be changed."""
    text = (resources.files(package) / name).read_text(encoding="utf-8")
    return yaml.load(text, Loader=LOADER)  # noqa: S506  the safe loader


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


def source_of(given: str | Path | Mapping[str, Any], name: str = "spec") -> YamlSource:
    """The source of a file, or of the same fields as a dict, which messages call by a name."""
    return written(given, name) if isinstance(given, Mapping) else read(Path(given))


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
    if "mapping values" in problem and above.strip() and ":" not in above and here == before:
        return "; the line above has no colon behind the name of its field"
    if "mapping values" in problem:
        return "; a text with a colon and a blank in it needs quotes"
    return ""


def _build(text: str, name: str, note: Callable[[Path_, int], object]) -> Any:
    """Data from events, without features that specs do not use; ``note`` has the path and line of every field."""
    events, found = _permitted(text, name), None
    for event in events:
        if isinstance(event, yaml.NodeEvent):
            found = _value(event, (), events, name, note)
    return found


def _fail(name: str, event: Any, message: str) -> InputError:
    return InputError(f"{name}:{event.start_mark.line + 1}: {message}")


def _permitted(text: str, name: str) -> Iterator[Any]:
    """Events of a document, each looked at for what is not used here."""
    documents = 0
    for event in _events(text, name):
        documents += isinstance(event, yaml.DocumentStartEvent)
        if documents > 1:
            raise _fail(name, event, "a second document (---) starts; expected one")
        if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None):
            text = "anchors and aliases (& and *) are not used here; quote text that starts with them"
            raise _fail(name, event, text)
        if getattr(event, "tag", None) and event.tag != "!":
            raise _fail(name, event, f"the tag {quoted(event.tag)} is not used here")
        if unseen := _UNSEEN.search(getattr(event, "value", "")):
            raise _fail(name, event, f"the character {unseen[0]!r} is not used here; expected text as it is printed")
        yield event


def _value(event: Any, path: Path_, events: Iterator[Any], name: str, note: Callable[[Path_, int], object]) -> Any:
    """A scalar, a list or a group of fields, by its first event and those that follow."""
    if isinstance(event, yaml.ScalarEvent):
        return _scalar(event)
    if len(path) >= _DEEPEST:
        raise _fail(name, event, _TOO_DEEP)
    if isinstance(event, yaml.SequenceStartEvent):
        items: list[Any] = []
        while not isinstance(one := next(events), yaml.SequenceEndEvent):
            at: Path_ = (*path, len(items))
            note(at, one.start_mark.line + 1)
            items.append(_value(one, at, events, name, note))
        return items
    fields: dict[str, Any] = {}
    while not isinstance(one := next(events), yaml.MappingEndEvent):
        line = one.start_mark.line + 1
        if not isinstance(one, yaml.ScalarEvent):
            raise _fail(name, one, "a key must be plain text")
        key = str(one.value)
        if key == "<<":
            raise _fail(name, one, "merge keys (<<) are not used here; write the fields out")
        if key in fields:
            raise _fail(name, one, f"the key {quoted(key)} is given twice")
        if len(fields) == _MOST_KEYS:
            raise _fail(name, one, f"more than {_MOST_KEYS} keys in one group of fields; expected fewer")
        note((*path, key), line)
        fields[key] = _value(next(events), (*path, key), events, name, note)
    return fields


# -- Part of a YAML document over defaults from the top of it, read as a document of its own.
#
# A field keeps the line at which it stands: in the part where that has it, else among the defaults.


class YamlOverlay(YamlSource):
    """A part of a document with the defaults under it."""

    def __init__(self, whole: YamlSource, at: Path_, data: dict[str, Any]) -> None:
        self.whole, self.at = whole, at
        self.text, self.name, self.numbered = whole.text, whole.name, whole.numbered
        self.data, self.sections = data, {}

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


def value_at(data: Any, path: Path_) -> Any:
    """The value at a path; None where there is none."""
    for step in path:
        try:
            data = data[step]
        except (KeyError, IndexError, TypeError):
            return None
    return data


def changed(data: Any, path: Path_, value: Any) -> Any:
    """Data with another value at a path; everything else is shared, not copied."""
    if not path:
        return value
    step, rest = path[0], path[1:]
    if isinstance(step, int):
        return [*data[:step], changed(data[step], rest, value), *data[step + 1 :]]
    inside = data if isinstance(data, dict) else {}
    return {**inside, step: changed(inside.get(step), rest, value)}


def texts_in(data: Any) -> Iterator[str]:
    """All texts among the values of a document."""
    if isinstance(data, dict | list):
        for value in data.values() if isinstance(data, dict) else data:
            yield from texts_in(value)
    elif isinstance(data, str):
        yield data
