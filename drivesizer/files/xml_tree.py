"""Elements of an XML file with their lines, and the figures in their attributes.

expat parses; document types, and so entities, are refused, size and depth are bounded.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, quoted
from drivesizer.files.text import plain_number, read_bytes

Array = NDArray[np.float64]
_LARGEST = 16_000_000  # bytes
_DEEPEST = 60
_MOST = 20_000  # elements
_FARTHEST = 1e50  # of any figure: products of a few of them can still be computed with


@dataclass(slots=True)
class Node:
    """An element with its place in a file."""

    tag: str
    path: Path
    line: int
    attributes: dict[str, str]
    children: list[Node] = field(default_factory=list)

    def all(self, tag: str) -> Iterator[Node]:
        """Children of a tag."""
        return (child for child in self.children if child.tag == tag)

    def first(self, tag: str) -> Node | None:
        """First child of a tag; None without any."""
        return next(self.all(tag), None)

    def fault(self, text: str, of: str | None = None) -> InputError:
        """Fault of the element, or of what it is ``of``: a link, a joint, nothing."""
        subject = f"<{self.tag[:40]}> " if of is None else f"{of}: " if of else ""
        return InputError(f"{self.path}:{self.line}: {subject}{text}")

    @property
    def name(self) -> str:
        """Name of an element that must have one."""
        if not (name := self.attributes.get("name", "")):
            raise self.fault("has no name")
        return name

    def figure(self, name: str, otherwise: float | None = None) -> float:
        """Number in an attribute."""
        written = self.attributes.get(name)
        if written is not None:
            return self._number(written, name)
        if otherwise is None:
            raise self.fault(f"has no {name}")
        return otherwise

    def figures(self, name: str) -> Array:
        """Numbers in an attribute, separated by blanks; none where it is not there."""
        return np.array([self._number(part, name) for part in self.attributes.get(name, "").split()])

    def vector(self, name: str, otherwise: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Array:
        """Three numbers in an attribute."""
        if (written := self.attributes.get(name)) is None:
            return np.array(otherwise)
        if len(written.split()) != 3:
            raise self.fault(f"{name}: {quoted(written)} is no vector; expected 3 numbers")
        return self.figures(name)

    def _number(self, written: str, name: str) -> float:
        value = plain_number(written)
        if not abs(value) < _FARTHEST:  # written so that NaN fails too
            raise self.fault(f"{name}: {quoted(written)} is no number")
        return value


def read_tree(path: Path) -> Node:
    """Root element of a file, without text between the elements."""
    raw, open_, count = read_bytes(path, _LARGEST), [Node("", path, 0, {})], 0
    parser = expat.ParserCreate()

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if len(open_) > _DEEPEST or count > _MOST:
            raise InputError(f"{path}:{parser.CurrentLineNumber}: expected at most {_MOST} elements, {_DEEPEST} deep")
        node = Node(tag, path, parser.CurrentLineNumber, attributes)
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
    return open_[0].children[0]
