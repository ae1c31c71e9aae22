"""Common drives for several axes, where they cost little more than the best drive of each.

A kind is a motor with its gearhead. From the best drives on, the two groups of axes whose common kind adds least to the
sum share it, as long as the sum stays within the allowance. What each kind costs is known with the masses that the best
drives put on the axes; with those of the common drives all axes are sized again before they are taken.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import combinations
from typing import NamedTuple

from drivesizer.multi_axis.combinations import Combination, Cost

__all__ = ["Kind", "Permitted", "fewer_kinds", "within"]

_TRIED = 12  # common kinds that are tried for one kind less
_OF_A_PAIR = 4  # of them for the same axes
_ROUNDING = 1e-9
Kind = tuple[str, str]  # motor and gearhead
Permitted = Mapping[str, Kind]  # kinds by the axis' name; axes that are not in it are free
Offered = Mapping[str, Mapping[Kind, Cost]]  # by axis, the best kinds first
Group = tuple[str, ...]  # axes of a common kind


class _Merger(NamedTuple):
    """Two groups of axes with a kind for both."""

    first: Group
    second: Group
    kind: Kind
    added: Cost


def within(cost: Cost, limit: Cost) -> bool:
    """Whether a cost is no more than a limit, but for rounding."""
    return cost[0] < limit[0] or (cost[0] == limit[0] and cost[1] <= limit[1] + _ROUNDING * abs(limit[1]))


def fewer_kinds(
    best: Combination,
    kinds: Mapping[str, Kind],
    offered: Offered,
    limit: Cost,
    tried: Callable[[Permitted], Combination],
) -> tuple[Combination, dict[str, Kind]]:
    """A combination of fewer kinds of drives within a limit."""
    groups = _alike(kinds)
    common = {axis: kinds[axis] for group in groups if len(group) > 1 for axis in group}
    first = len(groups)
    while len(groups) > 1:
        for merger in _mergers(groups, common, offered, best.cost, limit):
            shared = common | dict.fromkeys((*merger.first, *merger.second), merger.kind)
            found = tried(shared)
            if not found.missing and within(found.cost, limit):
                break
        else:
            break
        groups = [group for group in groups if group not in (merger.first, merger.second)]
        groups.append((*merger.first, *merger.second))
        best, common = found, shared
    return best, common if len(groups) < first else {}


def _alike(kinds: Mapping[str, Kind]) -> list[Group]:
    """Axes by their kind."""
    found: dict[Kind, Group] = {}
    for axis, kind in kinds.items():
        found[kind] = (*found.get(kind, ()), axis)
    return list(found.values())


def _mergers(groups: list[Group], common: Permitted, offered: Offered, cost: Cost, limit: Cost) -> Iterator[_Merger]:
    """Pairs of groups with a kind for both, the least added cost first, as far as the sum may stay within the limit."""
    own = {group: _group_cost(group, common, offered) for group in groups}
    found: list[_Merger] = []
    for first, second in combinations(groups, 2):
        before = _sum(own[first], own[second])
        both = [
            _Merger(first, second, kind, _less(after, before))
            for kind, after in _common_kinds((*first, *second), offered)
        ]
        found += sorted(both, key=lambda merger: merger.added)[:_OF_A_PAIR]
    likely = [merger for merger in found if within(_sum(cost, merger.added), limit)]
    yield from sorted(likely, key=lambda merger: merger.added)[:_TRIED]


def _group_cost(group: Group, common: Permitted, offered: Offered) -> Cost:
    """Cost of the axes of a group with the kind that they share; of a single axis with its best."""
    axis = group[0]
    if axis not in common:
        return min(offered[axis].values())
    return _sum(*(offered[one][common[one]] for one in group))


def _common_kinds(axes: Group, offered: Offered) -> Iterator[tuple[Kind, Cost]]:
    """Kinds that all of some axes may have, with their cost."""
    for kind in offered[axes[0]]:
        if all(kind in offered[axis] for axis in axes):
            yield kind, _sum(*(offered[axis][kind] for axis in axes))


def _sum(*costs: Cost) -> Cost:
    return sum(missing for missing, _ in costs), sum(value for _, value in costs)


def _less(cost: Cost, other: Cost) -> Cost:
    return cost[0] - other[0], cost[1] - other[1]
