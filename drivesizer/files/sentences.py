"""Sentences with figures in them, out of a text that ships with the program."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib import resources
from typing import Any

from drivesizer.units import show

Filters = tuple[tuple[str, Callable[..., str]], ...]


@cache
def _templates(package: str, subject: str, filters: Filters) -> list[Any]:
    from jinja2 import Environment, StrictUndefined

    environment = Environment(undefined=StrictUndefined, autoescape=False)  # noqa: S701 - what writes a file escapes it
    environment.filters |= {"show": show, **dict(filters)}
    every = resources.files(package).joinpath("remarks.txt").read_text(encoding="utf-8")
    _, text = every.split(f"\n## {subject}\n")
    paragraphs = text.split("\n## ")[0].split("\n\n")
    return [environment.from_string(" ".join(one.split())) for one in paragraphs if one.strip()]


def sentences(package: str, subject: str, filters: Filters = (), **given: object) -> list[str]:
    """The paragraphs on a subject in ``remarks.txt`` of a package; without those that come out empty."""
    return [line for line in (template.render(given) for template in _templates(package, subject, filters)) if line]
