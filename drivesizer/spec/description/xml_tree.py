"""Elements of an XML file with their lines.

expat parses; document types, and so entities, are refused, size and depth are bounded.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, quoted
from drivesizer.files.text import read_bytes

__all__ = ["Node", "figure", "figures", "name_of", "read_tree", "vector"]

Array = NDArray[np.float64]
_LARGEST = 16_000_000  # bytes
_DEEPEST = 60
_MOST = 20_000  # elements
_FARTHEST = 1e50  # of any figure: products of a few of them can still be computed with


@dataclass(slots=True)
class Node:
    """An element with its line in the file."""

    tag: str
    line: int
    attributes: dict[str, str]
    children: list[Node] = field(default_factory=list)

    def all(self, tag: str) -> Iterator[Node]:
        """Children of a tag."""
        return (child for child in self.children if child.tag == tag)

    def first(self, tag: str) -> Node | None:
        """First child of a tag; None without any."""
        return next(self.all(tag), None)


def read_tree(path: Path) -> Node:
    """Root element of a file, without text between the elements."""
    raw = read_bytes(path, _LARGEST)
    top, open_, count = Node("", 0, {}), [], 0
    open_.append(top)
    parser = expat.ParserCreate()

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if len(open_) > _DEEPEST or count > _MOST:
            raise InputError(f"{path}:{parser.CurrentLineNumber}: expected at most {_MOST} elements, {_DEEPEST} deep")
        node = Node(tag, parser.CurrentLineNumber, attributes)
        open_[-1].children.append(node)
        open_.append(node)

    def refuse(*_: object) -> None:
        raise InputError(f"{path}:{parser.CurrentLineNumber}: a document type is not taken; expected plain XML")

    parser.StartElementHandler, parser.EndElementHandler = start, lambda _: open_.pop()
    parser.StartDoctypeDeclHandler, parser.EntityDeclHandler = refuse, refuse
    try:
        parser.Parse(raw, True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        if isinstance(error, InputError):
            raise
        line, reason = getattr(error, "lineno", 1), expat.ErrorString(getattr(error, "code", 0)) or "unknown encoding"
        raise InputError(f"{path}:{line}: this is no XML ({reason})") from None
    return top.children[0]


def name_of(node: Node, path: Path) -> str:
    """Name of an element that must have one."""
    name = node.attributes.get("name", "")
    if not name:
        raise InputError(f"{path}:{node.line}: <{node.tag}> has no name")
    return name


def figure(node: Node, name: str, path: Path, otherwise: float | None = None) -> float:
    """Number in an attribute."""
    written = node.attributes.get(name)
    if written is None:
        if otherwise is None:
            raise InputError(f"{path}:{node.line}: <{node.tag}> has no {name}")
        return otherwise
    return _number(written, node, name, path)


def _number(written: str, node: Node, name: str, path: Path) -> float:
    try:
        value = float(written)
    except ValueError:
        value = math.nan
    plain = written.isascii() and "_" not in written  # float() takes digits of other scripts
    if not (plain and abs(value) < _FARTHEST):  # written so that NaN fails too
        raise InputError(f"{path}:{node.line}: <{node.tag}> {name}: {quoted(written)} is no number")
    return value


def figures(node: Node, name: str, path: Path) -> Array:
    """Numbers in an attribute, separated by blanks; none where it is not there."""
    return np.array([_number(part, node, name, path) for part in node.attributes.get(name, "").split()])


def vector(node: Node, name: str, path: Path, otherwise: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Array:
    """Three numbers in an attribute."""
    written = node.attributes.get(name)
    if written is None:
        return np.array(otherwise)
    parts = written.split()
    if len(parts) != 3:
        raise InputError(f"{path}:{node.line}: <{node.tag}> {name}: {quoted(written)} is no vector; expected 3 numbers")
    return figures(node, name, path)
