"""YAML text to plain data, strictly, and back from a field's path to its line; overlays; single fields changed."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from importlib import resources
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

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
        value = f"{type(error.args[-1]).__name__} {quoted(str(error.args[-1]))}"
        raise InputError(
            f"{name}: {value}: expected text with a unit, a number, a list or a dict, e.g. '45 kg'"
        ) from None
    return YamlSource(text, name, numbered=False)


def source_of(document: str | Path | Mapping[str, Any], name: str = "spec") -> YamlSource:
    """The source of a file, or of the same fields as a dict, which messages call by a name."""
    return written(document, name) if isinstance(document, Mapping) else read(Path(document))


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
    events, data = _permitted(text, name), None
    for event in events:
        if isinstance(event, yaml.NodeEvent):
            data = _value(event, (), events, name, note)
    return data


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
        while not isinstance(entry := next(events), yaml.SequenceEndEvent):
            at: Path_ = (*path, len(items))
            note(at, entry.start_mark.line + 1)
            items.append(_value(entry, at, events, name, note))
        return items
    fields: dict[str, Any] = {}
    while not isinstance(entry := next(events), yaml.MappingEndEvent):
        line = entry.start_mark.line + 1
        if not isinstance(entry, yaml.ScalarEvent):
            raise _fail(name, entry, "a key must be plain text")
        key = str(entry.value)
        if key == "<<":
            raise _fail(name, entry, "merge keys (<<) are not used here; write the fields out")
        if key in fields:
            raise _fail(name, entry, f"the key {quoted(key)} is given twice")
        if len(fields) == _MOST_KEYS:
            raise _fail(name, entry, f"more than {_MOST_KEYS} keys in one group of fields; expected fewer")
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


# -- A field of a YAML text set, added or removed; everything else stays as it was written, comments included.


_LINE_END = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
_STEP = 2  # blanks by which a new group of fields is indented


class Edit(NamedTuple):
    """A change of one field."""

    path: Path_
    value: Any  # afterwards: a text as one types it, a number, a list, a dict; None removes the field
    text: bool = False  # whether the field is a text, so that "5" is to be read as one


class _Place(NamedTuple):
    """A node of the document, with the one that it is in and its key."""

    node: yaml.Node
    parent: yaml.Node | None = None
    key: yaml.Node | None = None


def edited(text: str, edits: list[Edit], name: str = "spec") -> str:
    """A YAML text with some of its fields changed."""
    text = text.removeprefix("\ufeff")
    data = YamlSource(text, name).data  # refused in its own words before it is changed
    for edit in edits:
        changed = _changed(text, edit, name)
        if edit.value is None and changed == text:
            continue
        try:
            after = YamlSource(changed, name).data
        except InputError:
            after = None
        if not _reads_as(after, data, edit):
            place = ".".join(map(str, edit.path))
            raise InputError(f"{name}: {quoted(place)} cannot be changed in this text; edit it as YAML")
        text, data = changed, after
    return text


def _reads_as(after: Any, before: Any, edit: Edit) -> bool:
    """Whether only the one field differs."""
    try:
        value = after
        for step in edit.path if edit.value is not None else ():
            value = value[step]
        expected = _with(before, edit.path, None if edit.value is None else value)
    except (KeyError, IndexError, TypeError, ValueError):
        return False
    same = (after or None) == (expected or None)  # without a field a document is none, or an empty group
    return bool(same) and (not edit.text or not isinstance(edit.value, str) or value == edit.value)


def _with(data: Any, path: Path_, value: Any) -> Any:
    """Data with a field and the groups that it is in; None removes it, and groups that are empty then."""
    if not path:
        return value
    step = path[0]
    group: Any = list(data or ()) if isinstance(step, int) else dict(data or {})
    known = step < len(group) if isinstance(step, int) else step in group
    below = _with(group[step] if known else None, path[1:], value)
    if value is None and not below:
        if known:
            del group[step]
    elif isinstance(step, int):
        group[step : step + 1] = [below]
    else:
        group[step] = below
    return group


def _changed(text: str, edit: Edit, name: str) -> str:
    if not edit.path:
        raise InputError(f"{name}: a change names no field")
    root = yaml.compose(text, Loader=LOADER)
    if root is None:
        end = "" if not text or text.endswith("\n") else "\n"
        return text if edit.value is None else f"{text}{end}{_block(edit.path, edit.value, edit.text, 0)}\n"
    place, rest = _deepest_node(root, edit.path)
    node = place.node
    if not rest:
        return _removed(text, root, edit.path) if edit.value is None else _replaced(text, place, edit.value, edit.text)
    if edit.value is None:
        return text
    if isinstance(node, yaml.ScalarNode) and not node.value and place.key is not None:  # `needs:` alone
        return _replaced(text, place, _nested(rest, edit.value), edit.text)
    where = f"{name}: {'.'.join(map(str, edit.path))}"
    if not isinstance(node, yaml.CollectionNode):
        raise InputError(f"{where}: {quoted(node.value)} is no group of fields")
    listed = isinstance(node, yaml.SequenceNode)
    if listed is not isinstance(rest[0], int):
        kind = "a list" if listed else "a group of fields"
        raise InputError(f"{where}: {quoted(rest[0])} is no place of {kind}")
    return _added(text, node, rest, edit)


def _nested(path: Path_, value: Any) -> Any:
    for step in reversed(path):
        value = [value] if isinstance(step, int) else {step: value}
    return value


def _deepest_node(root: yaml.Node, path: Path_) -> tuple[_Place, Path_]:
    """The deepest node of a path that is there, and the rest of the path."""
    place = _Place(root)
    for n, step in enumerate(path):
        node, below = place.node, None
        if isinstance(node, yaml.SequenceNode) and isinstance(step, int) and 0 <= step < len(node.value):
            below = _Place(node.value[step], node)
        elif isinstance(node, yaml.MappingNode):
            below = next((_Place(value, node, key) for key, value in node.value if key.value == step), None)
        if below is None:
            return place, path[n:]
        place = below
    return place, ()


# -- places in the text


def _offset(text: str, mark: Any) -> int:
    """Place of a mark; marks of libyaml know line and column for certain, of lines that end as YAML 1.1 has it."""
    *_, at = (0, *(match.end() for match in islice(_LINE_END.finditer(text), mark.line)))
    return at + int(mark.column)


def _last(text: str, node: yaml.Node) -> int:
    """End of the text of a node; that of a block would end where the next one begins."""
    if isinstance(node, yaml.CollectionNode) and not node.flow_style and node.value:
        below = node.value[-1]
        return _last(text, below[1] if isinstance(below, tuple) else below)
    end = _offset(text, node.end_mark)
    if isinstance(node, yaml.ScalarNode) and node.style in ("|", ">"):
        return _offset(text, node.start_mark) + len(text[_offset(text, node.start_mark) : end].rstrip())
    return end


def _line_end(text: str, at: int) -> tuple[int, int]:
    """End of the line of a place, and the beginning of the next."""
    match = _LINE_END.search(text, at)
    return match.span() if match else (len(text), len(text))


# -- changes


def _replaced(text: str, place: _Place, value: Any, as_text: bool) -> str:
    node = place.node
    start, stop = _offset(text, node.start_mark), _last(text, node)
    inside = isinstance(place.parent, yaml.CollectionNode) and place.parent.flow_style
    if place.key is not None and not inside:  # a block begins on a line of its own: from behind the colon on
        indent, start = int(place.key.start_mark.column) + _STEP, text.index(":", _offset(text, place.key.end_mark)) + 1
        return f"{text[:start]}{_behind_colon(value, as_text, indent)}{text[max(stop, start) :]}"
    blank = " " if text[start - 1 : start] == "-" else ""
    return f"{text[:start]}{blank}{_flow(value, as_text)}{text[stop:]}"


def _added(text: str, node: yaml.CollectionNode, rest: Path_, edit: Edit) -> str:
    listed, last = isinstance(node, yaml.SequenceNode), _last(text, node)
    if node.flow_style or not node.value:
        at = last - 1
        head = "" if listed else f"{_in_line(str(rest[0]), True)}: "
        before = text[:at].rstrip() if node.value else text[:at]
        comma = "" if not node.value else " " if before.endswith(",") else ", "
        return f"{before}{comma}{head}{_flow(_nested(rest[1:], edit.value), edit.text)}{text[at:]}"
    at, _ = _line_end(text, last)
    indent = int(node.start_mark.column)
    entry = f"{' ' * indent}- {_flow(_nested(rest[1:], edit.value), edit.text)}"
    return f"{text[:at]}\n{entry if listed else _block(rest, edit.value, edit.text, indent)}{text[at:]}"


def _removed(text: str, root: yaml.Node, path: Path_) -> str:
    """The text without a field; a group that would be empty goes with it."""
    above, (place, _) = _deepest_node(root, path[:-1])[0].node, _deepest_node(root, path)
    assert isinstance(above, yaml.CollectionNode)
    if len(above.value) == 1 and len(path) > 1:
        return _removed(text, root, path[:-1])
    entries = [entry[0] if isinstance(entry, tuple) else entry for entry in above.value]
    first = place.key or place.node
    number, start, stop = entries.index(first), _offset(text, first.start_mark), _last(text, place.node)
    line = start - int(first.start_mark.column)
    head = text[line:start].strip()
    first_behind_dash = not above.flow_style and head and not (head == "-" and place.key is None)
    if first_behind_dash or (above.flow_style and number + 1 < len(entries)):  # the next takes its place
        return text[:start] + text[_offset(text, entries[number + 1].start_mark) :]
    if above.flow_style:
        comma = text.rfind(",", 0, start) if number else -1
        return text[: comma if comma >= 0 else start] + text[stop:]
    return text[:line] + text[_line_end(text, max(stop, start))[1] :]


# -- values as they are written


def _in_line(value: Any, key: bool = False, text: bool = True) -> str:
    """A value in one line: plain where YAML reads the same, else quoted."""
    if value is None or isinstance(value, bool | int | float):
        return json.dumps(value)
    try:
        read = YamlSource(f"{{{value}: 1}}" if key else f"[{value}]", "value").data
    except InputError:
        return json.dumps(value, ensure_ascii=False)
    scalar = next(iter(read)) if key else read[0] if len(read) == 1 else None
    plain = bool(value) and "#" not in value and value == value.strip() and value.isprintable()
    same = scalar == value if text or key else isinstance(scalar, str | int | float | bool)
    return str(value) if plain and same else json.dumps(value, ensure_ascii=False)


def _flow(value: Any, text: bool) -> str:
    """A value in one line."""
    if isinstance(value, dict):
        return f"{{{', '.join(_entries(value, text))}}}"
    if isinstance(value, list):
        return f"[{', '.join(_flow(below, text) for below in value)}]"
    return _in_line(value, text=text)


def _entries(value: dict[Any, Any], text: bool) -> list[str]:
    return [f"{_in_line(str(key), True)}: {_flow(below, text)}" for key, below in value.items()]


def _behind_colon(value: Any, text: bool, indent: int) -> str:
    """A value in the line, or a group or list over lines; what is inside is in one line each."""
    if not (isinstance(value, dict | list) and value):
        return f" {_flow(value, text)}"
    entries = _entries(value, text) if isinstance(value, dict) else [f"- {_flow(below, text)}" for below in value]
    return "".join(f"\n{' ' * indent}{entry}" for entry in entries)


def _block(path: Path_, value: Any, text: bool, indent: int) -> str:
    """A field that is not there yet, in lines of its own."""
    head = f"{' ' * indent}{_in_line(str(path[0]), True)}:"
    return head + _behind_colon(_nested(path[1:], value), text, indent + _STEP)
