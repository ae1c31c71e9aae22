"""Docstrings of the program as Markdown: their mathematics, their roles, their lists of sources."""

from __future__ import annotations

import re
from typing import Any

import griffe

__all__ = ["Docstrings", "as_markdown"]

_BLOCK = re.compile(r"^( *)\.\. math::[ ]*(.*(?:\n(?:\1 +\S.*|[ ]*(?=\n\1 +\S)))*)", re.MULTILINE)
_SOURCE = re.compile(r"^( *)\.\. \[(\d+)\] ", re.MULTILINE)
_ROLE = re.compile(r":(math|func|class|mod|meth|attr):`~?([^`]*)`")


def as_markdown(text: str) -> str:
    """A docstring in reStructuredText as Markdown.

    >>> as_markdown("Torque :math:`T`, see :func:`size` and ``spec``.")
    'Torque $T$, see `size` and `spec`.'
    """
    text = _BLOCK.sub(lambda m: f"\n{m[1]}$$\n{m[1]}{' '.join(m[2].split())}\n{m[1]}$$\n", text)
    text = _ROLE.sub(lambda m: f"${m[2]}$" if m[1] == "math" else f"`{m[2].rsplit('.', 1)[-1]}`", text)
    text = _SOURCE.sub(r"\1- [\2] ", text)
    return re.sub(r"(\[\d+\])_", r"\1", text).replace("``", "`")


class Docstrings(griffe.Extension):
    """Has mkdocstrings read them so."""

    def on_object(self, *, obj: Any, **_: Any) -> None:
        """Rewrite the docstring of an object that was found."""
        if obj.docstring is not None:
            obj.docstring.value = as_markdown(obj.docstring.value)
