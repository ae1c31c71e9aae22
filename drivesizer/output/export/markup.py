"""XML of the formats: a tree with remarks, figures to twelve digits, escaped names."""

from __future__ import annotations

import re
from collections.abc import Iterable
from xml.etree.ElementTree import Comment, Element, indent, tostring

__all__ = ["brief", "document", "identifier", "number", "remark", "text", "vector"]

_NO_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # XML 1.0, production 2


def number(value: float) -> str:
    """A figure to twelve digits, more than any data sheet has.

    >>> number(0.1 + 0.2), number(3.0)
    ('0.3', '3')
    """
    return f"{value:.12g}"


def vector(values: Iterable[float]) -> str:
    """Figures in a row."""
    return " ".join(number(value + 0.0) for value in values)  # + 0.0: no -0


def brief(value: float) -> str:
    """A figure in a sentence."""
    return f"{value:.5g}"


def text(said: str) -> str:
    r"""A text with characters that XML forbids as their codes.

    >>> text("a\x00b")
    'a\\x00b'
    """
    return _NO_XML.sub(lambda found: repr(found[0])[1:-1], said)


def identifier(said: str) -> str:
    """A text as a name that simulators accept: letters, digits and underscores.

    Examples
    --------
    >>> identifier("SPS surveillance robot")
    'SPS_surveillance_robot'
    """
    name = re.sub(r"[^A-Za-z0-9]+", "_", said).strip("_")
    if name[:1].isdigit():
        name = f"_{name}"
    return name or "drive"


def remark(parent: Element, *lines: str) -> None:
    """A comment under an element; two hyphens end a comment in XML and get a blank between them."""
    for line in lines:
        safe = re.sub("-(?=-)", "- ", text(line).replace("\n", " "))
        parent.append(Comment(f" {safe} "))


def document(root: Element) -> bytes:
    """The file: declaration, tree with two blanks a level, UTF-8."""
    indent(root)
    return f'<?xml version="1.0" encoding="utf-8"?>\n{tostring(root, encoding="unicode")}\n'.encode()
