"""Two drives side by side: their parts, figures and checks, whether the search lists them or not."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.live.held import EngineMemory, Piece
from drivesizer.live.reading import text_of

__all__ = ["compare"]


def compare(held: EngineMemory, request: Piece) -> Iterator[Piece]:
    """A piece ``compared``: rows of texts, a column for each drive."""
    from drivesizer.sizing import explained, load_parts
    from drivesizer.spec.robot import read_spec

    spec = read_spec(YamlSource(text_of(held, request), held.name))
    catalog, found = load_parts(spec), []
    for motor, gearhead in request["sets"]:
        held.go_on()
        sets = explained(spec, motor, gearhead, catalog=catalog).sets
        if not sets:
            raise InputError(f"{motor} with {gearhead}: no belt of the spec goes with it")
        found.append(min(sets, key=lambda one: one.rank))
    yield {"kind": "compared", "heads": [one.label for one in found], "status": [one.status for one in found],
           "rows": [*_parts(found), *_figures(found), *_checks(found)]}  # fmt: skip


def _parts(sets: list[Any]) -> Iterator[Piece]:
    for role in dict.fromkeys(role for one in sets for role in one.parts):
        parts = [one.parts.get(role) for one in sets]
        yield {"title": role, "group": "parts", "cells": [_named(part) for part in parts]}


def _named(part: Any) -> str:
    named = dict.fromkeys((part.manufacturer, part.family, part.part)) if part else ["none"]  # some are named by family
    return " ".join(filter(None, named))


def _figures(sets: list[Any]) -> Iterator[Piece]:
    from drivesizer.units import show

    yield {"title": "mass of a drive", "group": "figures", "cells": [show(one.mass, "g", "mass") for one in sets]}
    yield {"title": "price of a drive", "group": "figures", "cells": [one.price_text for one in sets]}
    named = dict.fromkeys(figure.name for one in sets for figure in one.figures)
    for name in named:
        each = [{figure.name: figure for figure in one.figures}.get(name) for one in sets]
        title = next(figure.title for figure in each if figure)
        yield {"title": title, "group": "figures", "cells": [figure.text if figure else "" for figure in each]}


def _checks(sets: list[Any]) -> Iterator[Piece]:
    from drivesizer.output.text import margin

    for name in dict.fromkeys(check.name for one in sets for check in one.checks):
        each = [{check.name: check for check in one.checks}.get(name) for one in sets]
        title = next(check.title for check in each if check)
        cells, status = zip(*((margin(c.margin), c.status) if c else ("", "") for c in each), strict=True)
        yield {"title": title, "group": "checks", "cells": cells, "status": status}
