"""A field of a YAML text set, added or removed; everything else stays as it was written, comments included."""

from __future__ import annotations

import copy
import json
import re
from itertools import islice
from typing import Any, NamedTuple

import yaml

from drivesizer.errors import InputError, quoted
from drivesizer.files.yaml_source import LOADER, Path_, YamlSource

__all__ = ["Edit", "edited"]


# -- Whether a document reads as another one with one field changed: what an edit of its text is held against.


def reads_as(after: Any, before: Any, path: Path_, value: Any, *, text: bool) -> bool:
    """Whether only one field differs."""
    if value is None:
        return bool(_same_data(after, _without_value(before, path)))
    try:
        found = after
        for step in path:
            found = found[step]
        expected = _with_value(before, path, found)
    except (KeyError, IndexError, TypeError):
        return False
    return bool(_same_data(after, expected)) and (not text or not isinstance(value, str) or found == value)


def _same_data(one: Any, other: Any) -> bool:
    return bool((one or None) == (other or None))  # without a field, a document is none, or an empty group


def _with_value(data: Any, path: Path_, value: Any) -> Any:
    """Data with a field, and the groups that it is in."""
    if not path:
        return value
    step, *rest = path
    if isinstance(step, int):
        entries = list(data or ())
        entries[step : step + 1] = [_with_value(entries[step] if step < len(entries) else None, tuple(rest), value)]
        return entries
    return {**(data or {}), step: _with_value((data or {}).get(step), tuple(rest), value)}


def _without_value(data: Any, path: Path_) -> Any:
    """Data without a field, and without groups that are empty then."""
    left = copy.deepcopy(data)
    places = [left]
    for step in path[:-1]:
        places.append(_below(places[-1], step))
    for place, step in zip(reversed(places), reversed(path), strict=True):
        if _below(place, step) is _NOTHING:
            return data
        if len(place) > 1 or place is left:
            del place[step]
            return left
    return left


_NOTHING = object()


def _below(place: Any, step: str | int) -> Any:
    known = isinstance(place, list) and isinstance(step, int) and 0 <= step < len(place)
    known = known or (isinstance(place, dict) and step in place)
    return place[step] if known else _NOTHING


_LINE_END = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
_STEP = 2  # blanks by which a new group of fields is indented


class Edit(NamedTuple):
    """A change of one field."""

    path: Path_
    value: (
        Any  # what the file says afterwards: a text as one types it, a number, a list, a dict; None removes the field
    )
    text: bool = False  # whether the field is a text, so that "5" is to be read as one


class _Place(NamedTuple):
    """Place of a node of the document in the text."""

    node: yaml.Node
    parent: yaml.Node | None
    key: yaml.Node | None


def edited(text: str, edits: list[Edit], name: str = "spec") -> str:
    """A YAML text with some of its fields changed."""
    text = text.removeprefix("\ufeff")
    data = YamlSource(text, name).data  # refused in its own words before it is changed
    for edit in edits:
        changed = _changed(text, edit, name)
        try:
            after = YamlSource(changed, name).data
        except InputError:
            after = None
        if not reads_as(after, data, edit.path, edit.value, text=edit.text):
            place = ".".join(map(str, edit.path))
            raise InputError(f"{name}: {quoted(place)} cannot be changed in this text; edit it as YAML")
        text, data = changed, after
    return text


def _changed(text: str, edit: Edit, name: str) -> str:
    if not edit.path:
        raise InputError(f"{name}: a change names no field")
    root = yaml.compose(text, Loader=LOADER)
    if root is None:
        return text if edit.value is None else f"{text}{_end(text)}{_block(edit.path, edit, 0)}\n"
    place, rest = _deepest_node(root, edit.path)
    if not rest:
        return _removed(text, root, edit.path) if edit.value is None else _replaced(text, place, edit)
    if edit.value is None:
        return text
    if isinstance(place.node, yaml.ScalarNode) and not place.node.value and place.key is not None:  # `needs:` alone
        return _replaced(text, place, Edit((), _nested(rest, edit.value), edit.text))
    if isinstance(place.node, yaml.SequenceNode) is not isinstance(rest[0], int) and _has_fields(place.node):
        found = "a list" if isinstance(place.node, yaml.SequenceNode) else "a group of fields"
        raise InputError(f"{name}: {'.'.join(map(str, edit.path))}: {quoted(rest[0])} is no place of {found}")
    if not _has_fields(place.node):
        raise InputError(f"{name}: {'.'.join(map(str, edit.path))}: {quoted(place.node.value)} is no group of fields")
    return _added(text, place, rest, edit)


def _has_fields(node: yaml.Node) -> bool:
    return isinstance(node, yaml.CollectionNode)


def _nested(path: Path_, value: Any) -> Any:
    for step in reversed(path):
        value = [value] if isinstance(step, int) else {step: value}
    return value


def _deepest_node(root: yaml.Node, path: Path_) -> tuple[_Place, Path_]:
    """The deepest node of a path that is there, and the rest of the path."""
    place = _Place(root, None, None)
    for n, step in enumerate(path):
        below = _child(place.node, step)
        if below is None:
            return place, path[n:]
        place = _Place(below[1], place.node, below[0])
    return place, ()


def _child(node: yaml.Node, step: str | int) -> tuple[yaml.Node | None, yaml.Node] | None:
    if isinstance(node, yaml.SequenceNode) and isinstance(step, int) and 0 <= step < len(node.value):
        return None, node.value[step]
    if isinstance(node, yaml.MappingNode):
        return next(((key, value) for key, value in node.value if key.value == step), None)
    return None


# -- places in the text


def _offset(text: str, mark: yaml.Mark) -> int:
    """Place of a mark; marks of libyaml know line and column for certain, of lines that end as YAML 1.1 has it."""
    *_, at = (0, *(found.end() for found in islice(_LINE_END.finditer(text), mark.line)))
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


def _end(text: str) -> str:
    return "" if not text or text.endswith("\n") else "\n"


def _line_end(text: str, at: int) -> tuple[int, int]:
    """End of the line of a place, and the beginning of the next."""
    found = _LINE_END.search(text, at)
    return found.span() if found else (len(text), len(text))


# -- changes


def _replaced(text: str, place: _Place, edit: Edit) -> str:
    node = place.node
    start, stop = _offset(text, node.start_mark), _last(text, node)
    inside = bool(isinstance(place.parent, yaml.CollectionNode) and place.parent.flow_style)
    if place.key is not None and not inside:  # a block begins on a line of its own: from behind the colon on
        indent, start = int(place.key.start_mark.column) + _STEP, text.index(":", _offset(text, place.key.end_mark)) + 1
        over_lines = isinstance(edit.value, dict | list) and edit.value
        new = f"\n{_lines(edit, indent)}" if over_lines else f" {_flow(edit)}"
        return f"{text[:start]}{new}{text[max(stop, start) :]}"
    return f"{text[:start]}{' ' if text[start - 1 : start] == '-' else ''}{_flow(edit)}{text[stop:]}"


def _added(text: str, place: _Place, rest: Path_, edit: Edit) -> str:
    node = place.node
    assert isinstance(node, yaml.CollectionNode)
    new = Edit((), _nested(rest[1:], edit.value), edit.text)
    listed = isinstance(node, yaml.SequenceNode)
    if node.flow_style or not node.value:
        at = _last(text, node) - 1
        head = "" if listed else f"{_scalar(str(rest[0]), True)}: "
        before = text[:at].rstrip() if node.value else text[:at]
        comma = "" if not node.value else " " if before.endswith(",") else ", "
        return f"{before}{comma}{head}{_flow(new)}{text[at:]}"
    at, _ = _line_end(text, _last(text, node))
    indent = int(node.start_mark.column)
    line = f"{' ' * indent}- {_flow(new)}" if listed else _block((rest[0],), new, indent)
    return f"{text[:at]}\n{line}{text[at:]}"


def _removed(text: str, root: yaml.Node, path: Path_) -> str:
    """The text without a field; a group that would be empty goes with it."""
    above, _ = _deepest_node(root, path[:-1])
    assert isinstance(above.node, yaml.CollectionNode)
    if len(above.node.value) == 1 and len(path) > 1:
        return _removed(text, root, path[:-1])
    place, _ = _deepest_node(root, path)
    entries = [entry[0] if isinstance(entry, tuple) else entry for entry in above.node.value]
    first = place.key or place.node
    number = entries.index(first)
    start, stop = _offset(text, first.start_mark), _last(text, place.node)
    if above.node.flow_style:
        return _without_entry(text, entries, number, start, stop)
    line = start - int(first.start_mark.column)
    head = text[line:start].strip()
    if head and not (head == "-" and place.key is None):  # first behind a dash: the next takes its place
        return text[:start] + text[_offset(text, entries[number + 1].start_mark) :]
    _, rest = _line_end(text, max(stop, start))
    return text[:line] + text[rest:]


def _without_entry(text: str, entries: list[yaml.Node], number: int, start: int, stop: int) -> str:
    if number + 1 < len(entries):
        return text[:start] + text[_offset(text, entries[number + 1].start_mark) :]
    comma = text.rfind(",", 0, start) if number else -1
    return text[: comma if comma >= 0 else start] + text[stop:]


# -- values as they are written


def _scalar(value: Any, key: bool = False, text: bool = True) -> str:
    """A value in one line: plain where YAML reads the same, else quoted."""
    if value is None or isinstance(value, bool | int | float):
        return json.dumps(value)
    try:
        read = YamlSource(f"{{{value}: 1}}" if key else f"[{value}]", "value").data
    except InputError:
        return json.dumps(value, ensure_ascii=False)
    found = next(iter(read)) if key else read[0] if len(read) == 1 else None
    plain = bool(value) and "#" not in value and value == value.strip() and value.isprintable()
    same = found == value if text or key else isinstance(found, str | int | float | bool)
    return str(value) if plain and same else json.dumps(value, ensure_ascii=False)


def _flow(edit: Edit) -> str:
    """A value in one line."""
    value = edit.value
    if isinstance(value, dict):
        return f"{{{', '.join(_entries(value, edit.text))}}}"
    if isinstance(value, list):
        return f"[{', '.join(_flow(Edit((), below, edit.text)) for below in value)}]"
    return _scalar(value, text=edit.text)


def _entries(value: dict[Any, Any], text: bool) -> list[str]:
    return [f"{_scalar(str(key), True)}: {_flow(Edit((), below, text))}" for key, below in value.items()]


def _lines(edit: Edit, indent: int) -> str:
    """A group or a list over lines; what is inside is in one line each."""
    blanks = " " * indent
    if isinstance(edit.value, dict):
        return "\n".join(f"{blanks}{entry}" for entry in _entries(edit.value, edit.text))
    return "\n".join(f"{blanks}- {_flow(Edit((), below, edit.text))}" for below in edit.value)


def _block(path: Path_, edit: Edit, indent: int) -> str:
    """A field that is not there yet, in lines of its own."""
    value = _nested(path[1:], edit.value)
    head = f"{' ' * indent}{_scalar(str(path[0]), True)}:"
    if isinstance(value, dict | list) and value:
        return f"{head}\n{_lines(Edit((), value, edit.text), indent + _STEP)}"
    return f"{head} {_flow(Edit((), value, edit.text))}"
