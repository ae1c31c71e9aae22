"""A field of a YAML text set, added or removed; everything else stays as it was written, comments included."""

from __future__ import annotations

import json
import re
from itertools import islice
from typing import Any, NamedTuple

import yaml

from drivesizer.errors import InputError, quoted
from drivesizer.files.yaml_source import LOADER, Path_, YamlSource

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
        found = after
        for step in edit.path if edit.value is not None else ():
            found = found[step]
        expected = _with(before, edit.path, None if edit.value is None else found)
    except (KeyError, IndexError, TypeError, ValueError):
        return False
    same = (after or None) == (expected or None)  # without a field a document is none, or an empty group
    return bool(same) and (not edit.text or not isinstance(edit.value, str) or found == edit.value)


def _with(data: Any, path: Path_, value: Any) -> Any:
    """Data with a field and the groups that it is in; None removes it, and groups that are empty then."""
    if not path:
        return value
    step = path[0]
    made: Any = list(data or ()) if isinstance(step, int) else dict(data or {})
    known = step < len(made) if isinstance(step, int) else step in made
    below = _with(made[step] if known else None, path[1:], value)
    if value is None and not below:
        if known:
            del made[step]
    elif isinstance(step, int):
        made[step : step + 1] = [below]
    else:
        made[step] = below
    return made


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
        found = "a list" if listed else "a group of fields"
        raise InputError(f"{where}: {quoted(rest[0])} is no place of {found}")
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


def _line_end(text: str, at: int) -> tuple[int, int]:
    """End of the line of a place, and the beginning of the next."""
    found = _LINE_END.search(text, at)
    return found.span() if found else (len(text), len(text))


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
        head = "" if listed else f"{_scalar(str(rest[0]), True)}: "
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


def _flow(value: Any, text: bool) -> str:
    """A value in one line."""
    if isinstance(value, dict):
        return f"{{{', '.join(_entries(value, text))}}}"
    if isinstance(value, list):
        return f"[{', '.join(_flow(below, text) for below in value)}]"
    return _scalar(value, text=text)


def _entries(value: dict[Any, Any], text: bool) -> list[str]:
    return [f"{_scalar(str(key), True)}: {_flow(below, text)}" for key, below in value.items()]


def _behind_colon(value: Any, text: bool, indent: int) -> str:
    """A value in the line, or a group or list over lines; what is inside is in one line each."""
    if not (isinstance(value, dict | list) and value):
        return f" {_flow(value, text)}"
    entries = _entries(value, text) if isinstance(value, dict) else [f"- {_flow(below, text)}" for below in value]
    return "".join(f"\n{' ' * indent}{entry}" for entry in entries)


def _block(path: Path_, value: Any, text: bool, indent: int) -> str:
    """A field that is not there yet, in lines of its own."""
    head = f"{' ' * indent}{_scalar(str(path[0]), True)}:"
    return head + _behind_colon(_nested(path[1:], value), text, indent + _STEP)
