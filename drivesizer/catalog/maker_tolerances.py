"""Tolerances that makers state for their figures, by maker and family.

A statement holds for the maker's parts in every catalogue file. One that names families holds for these alone and
takes precedence over one that names none.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from drivesizer.errors import CatalogError

__all__ = ["TOLERANCES", "MakerTolerance", "join_maker_tolerances", "maker_tolerances_of", "owner_of"]

TOLERANCES = "tolerances"  # the section of a catalogue file


class MakerTolerance(NamedTuple):
    """Tolerance of a catalogue figure as its maker states it."""

    part: str  # motor or gearhead
    figure: str
    tolerance: str  # of the printed figure, as written
    maker: str
    families: tuple[str, ...]  # empty: all of the maker's
    text: str  # a remark
    source: int  # index into Catalog.sources


def maker_tolerances_of(
    stated: Sequence[MakerTolerance], part: str, maker: str, family: str
) -> dict[str, MakerTolerance]:
    """Tolerances that a maker states for a part, by figure."""
    mine = [one for one in stated if (one.part, one.maker) == (part, maker)]
    general = {one.figure: one for one in mine if not one.families}
    return general | {one.figure: one for one in mine if family in one.families}


def owner_of(stated: Sequence[MakerTolerance], one: MakerTolerance) -> str:
    """Maker, and families where that maker states another tolerance for others."""
    several = sum((other.part, other.figure, other.maker) == (one.part, one.figure, one.maker) for other in stated) > 1
    return f"{one.maker} {', '.join(one.families)}".strip() if several else one.maker


def join_maker_tolerances(
    each: Sequence[tuple[str, Sequence[MakerTolerance], bool]], first_source: Sequence[int]
) -> tuple[tuple[MakerTolerance, ...], tuple[str, ...]]:
    """Tolerances of several catalogues as one, and a message for each that was replaced."""
    found: list[tuple[str, MakerTolerance]] = []
    messages: list[str] = []
    for (name, stated, overrides), first in zip(each, first_source, strict=True):
        before, found = found, []
        for other, theirs in before:
            mine = next((one for one in stated if _same_figure(theirs, one, overrides)), None)
            if mine and not overrides:
                raise CatalogError(
                    f"the tolerance of {_named(mine)} is in two catalogues: {other} and {name}; "
                    "`overrides: true` in the second makes its own count"
                )
            if mine:
                messages.append(f"tolerance of {_named(mine)}: {name} in place of {other}")
            found += [(other, one) for one in _remaining(theirs, stated, overrides)]
        found += [(name, one._replace(source=one.source + first)) for one in stated]
    return tuple(one for _, one in found), tuple(messages)


def _named(one: MakerTolerance) -> str:
    return f"{one.maker} {one.part} {one.figure.replace('_', ' ')}"


def _same_figure(one: MakerTolerance, later: MakerTolerance, overrides: bool) -> bool:
    """Whether a later tolerance is of the same figure and parts; one of all families overrides those of some."""
    if one[:2] != later[:2] or one.maker != later.maker:
        return False
    if one.families and later.families:
        return bool(set(one.families) & set(later.families))
    return not later.families and (overrides or not one.families)


def _remaining(one: MakerTolerance, stated: Sequence[MakerTolerance], overrides: bool) -> list[MakerTolerance]:
    """The part of a tolerance that later ones leave: all of it, or that of the families that they do not name."""
    later = [other for other in stated if _same_figure(one, other, overrides)]
    if not later:
        return [one]
    named = {family for other in later for family in other.families}
    left = tuple(family for family in one.families if family not in named)
    return [one._replace(families=left)] if left and all(other.families for other in later) else []
