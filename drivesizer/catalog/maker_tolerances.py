"""What makers say of how far their figures may be off: carried beside the figures, by maker and family.

The statement is the maker's and holds for its parts in whatever file they stand. One that names families holds for
these alone, and before one that names none.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from drivesizer.errors import CatalogError

__all__ = ["STATED", "Stated", "join_stated", "stated_of", "whose"]

STATED = "tolerances"  # the section of a catalogue file


class Stated(NamedTuple):
    """How far a figure may be off, as its maker says."""

    part: str  # motor or gearhead
    figure: str
    tolerance: str  # as it is written, of the printed figure
    maker: str
    families: tuple[str, ...]  # empty: all of the maker's
    text: str  # a remark
    source: int  # index into Catalog.sources


def stated_of(stated: Sequence[Stated], part: str, maker: str, family: str) -> dict[str, Stated]:
    """What is stated of a part's figures, by figure.

    Parameters
    ----------
    stated
        Of a catalogue.
    part
        motor or gearhead.
    maker, family
        Of the part.
    """
    mine = [one for one in stated if (one.part, one.maker) == (part, maker)]
    general = {one.figure: one for one in mine if not one.families}
    return general | {one.figure: one for one in mine if family in one.families}


def whose(stated: Sequence[Stated], one: Stated) -> str:
    """Maker, and families where that maker says something else of others."""
    several = sum((other.part, other.figure, other.maker) == (one.part, one.figure, one.maker) for other in stated) > 1
    return f"{one.maker} {', '.join(one.families)}".strip() if several else one.maker


def join_stated(
    each: Sequence[tuple[str, Sequence[Stated], bool]], first_source: Sequence[int]
) -> tuple[tuple[Stated, ...], tuple[str, ...]]:
    """What several catalogues state as one, and what was replaced, in words.

    Parameters
    ----------
    each
        Of every catalogue: its name, what it states, and whether it overrides those before it.
    first_source
        Number of its first source among all.

    Raises
    ------
    CatalogError
        When two state the same, and the later one does not say that it overrides.
    """
    found: list[tuple[str, Stated]] = []
    said: list[str] = []
    for (name, stated, overrides), first in zip(each, first_source, strict=True):
        before, found = found, []
        for other, theirs in before:
            mine = next((one for one in stated if _same(theirs, one, overrides)), None)
            if mine and not overrides:
                raise CatalogError(
                    f"the tolerance of {_named(mine)} is in two catalogues: {other} and {name}; "
                    "`overrides: true` in the second makes its own count"
                )
            if mine:
                said.append(f"tolerance of {_named(mine)}: {name} in place of {other}")
            found += [(other, one) for one in _left(theirs, stated, overrides)]
        found += [(name, one._replace(source=one.source + first)) for one in stated]
    return tuple(one for _, one in found), tuple(said)


def _named(one: Stated) -> str:
    return f"{one.maker} {one.part} {one.figure.replace('_', ' ')}"


def _same(one: Stated, later: Stated, overrides: bool) -> bool:
    """Whether a later one says something of the same figure and parts; of all, it overrides what is of some."""
    if one[:2] != later[:2] or one.maker != later.maker:
        return False
    if one.families and later.families:
        return bool(set(one.families) & set(later.families))
    return not later.families and (overrides or not one.families)


def _left(one: Stated, stated: Sequence[Stated], overrides: bool) -> list[Stated]:
    """What of a statement still holds beside later ones: all of it, or that of the families that they do not name."""
    later = [other for other in stated if _same(one, other, overrides)]
    if not later:
        return [one]
    named = {family for other in later for family in other.families}
    left = tuple(family for family in one.families if family not in named)
    return [one._replace(families=left)] if left and all(other.families for other in later) else []
