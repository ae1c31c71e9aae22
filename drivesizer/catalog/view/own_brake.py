"""A holding brake with figures of the spec's own, as a part beside those of the catalogues."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from drivesizer.catalog.estimates.estimate import estimates
from drivesizer.catalog.parts import columns_of
from drivesizer.catalog.tables import Catalog, Estimates, Source, Table

__all__ = ["OWN", "with_own_brake"]

OWN = "of the spec"  # family of that brake
_SECTION = "brakes"


def with_own_brake(catalog: Catalog, figures: Mapping[str, float | str]) -> Catalog:
    """The catalogue with a brake of these figures; what is not given is estimated."""
    one = _row(figures, len(catalog.sources))
    source = Source("section brake of the spec", "quoted")
    found = estimates(one) if catalog.ends else {}
    middle, *ends = (
        replace(given, brakes=_with_brake(given.brakes, _brake_at(one, found, place)), sources=(*given.sources, source))
        for given, place in zip((catalog, *catalog.ends), ("value", "low", "high"), strict=False)
    )
    if not found:
        return middle
    known = dict(catalog.estimates)
    known[_SECTION] = _joined(known.get(_SECTION, {}), found, len(catalog.brakes))
    return replace(middle, estimates=known, ends=tuple(ends))


def _row(figures: Mapping[str, float | str], source: int) -> Table[Any]:
    """A table of one brake."""
    texts = {"part": "brake", "family": OWN}
    columns = {
        name: np.array([figures.get(name, texts.get(name, ""))], str) if column.kind == "text"
        else np.array([figures.get(name, np.nan)], float)
        for name, column in columns_of(_SECTION).items()
    }  # fmt: skip
    return Table(_SECTION, columns, np.array([source], np.int32), np.zeros(1, bool))


def _brake_at(one: Table[Any], found: Mapping[str, Estimates], place: str) -> Table[Any]:
    """The brake with estimated figures at the middle or an end of their bands."""
    columns = dict(one.columns) | {name: getattr(each, place) for name, each in found.items()}
    return Table(_SECTION, columns, one.source, one.excluded)


def _with_brake(table: Table[Any], one: Table[Any]) -> Table[Any]:
    columns = {name: np.concatenate([table[name], one[name]]) for name in table.columns}
    source, excluded = np.append(table.source, one.source), np.append(table.excluded, one.excluded)
    return Table(_SECTION, columns, source, excluded)


def _joined(known: Mapping[str, Estimates], own: Mapping[str, Estimates], row: int) -> dict[str, Estimates]:
    """Estimates of the catalogue's brakes and of one in a row behind them."""
    found = dict(known)
    for name, one in own.items():
        sides: tuple[Any, ...] = one._replace(rows=one.rows + row)
        if name in known:
            sides = tuple(np.concatenate(pair) for pair in zip(known[name], sides, strict=True))
        found[name] = Estimates(*sides)
    return found
