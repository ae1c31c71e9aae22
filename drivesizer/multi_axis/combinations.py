"""Drives of axes that ride on one another, chosen so that the sum over the machine is the least.

A carried axis' drive enters the others by its mass alone. So of each axis only drives count that no other equals or
beats in cost and mass, and the axes are gone through from the outermost inward. A bound ends what cannot be the best:
an axis costs no less than with the least masses on it, as long as more mass never makes its drive cheaper.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple

__all__ = ["Choice", "Combination", "Cost", "axis_by_axis", "best_combination"]

_ROUNDING = 1e-9
Cost = tuple[int, float]  # figures that are unknown, and the sum of those that are known: less is better in this order


class Choice(NamedTuple):
    """A drive of an axis, as others see it."""

    name: str
    cost: Cost  # of all drives of the axis
    mass: float  # kg, that rides on the axes that carry this one


class Combination(NamedTuple):
    """A drive for each axis that has one, by its name."""

    chosen: dict[str, Choice]
    cost: Cost
    certain: bool  # no other combination costs less, as long as more mass never makes a drive cheaper
    searches: int  # axes that were sized, with the same masses once
    missing: str = ""  # axis without a drive, whatever rides on it


Masses = tuple[float, ...]  # kg, of the carried axes in their order
Sized = Callable[[str, Masses], Sequence[Choice]]  # drives of an axis that none beats in cost and mass, by cost


class _Search:
    """Sizings that were made, how many may follow, and the best combination so far."""

    def __init__(self, order: Sequence[str], carried: Mapping[str, Sequence[str]], sized: Sized, most: int) -> None:
        self.order, self.carried, self.sized, self.most = order, carried, sized, most
        self.made: dict[tuple[str, Masses], Sequence[Choice]] = {}
        self.least: dict[str, Cost] = {}
        self.best: dict[str, Choice] = {}
        self.cost: Cost | None = None
        self.cut = self.falling = False

    def choices(self, axis: str, masses: Mapping[str, float]) -> Sequence[Choice]:
        """Drives of an axis with drives of some masses on it, each sizing once."""
        on_it = tuple(masses[other] for other in self.carried[axis])
        if (axis, on_it) not in self.made:
            self.made[axis, on_it] = self.sized(axis, on_it)
        found = self.made[axis, on_it]
        if found and axis in self.least:
            self.falling |= found[0].cost < self.least[axis]
        return found

    def known(self, axis: str, masses: Mapping[str, float]) -> bool:
        """Whether an axis was sized with these masses."""
        return (axis, tuple(masses[other] for other in self.carried[axis])) in self.made


def best_combination(
    order: Sequence[str], carried: Mapping[str, Sequence[str]], sized: Sized, most: int = 100
) -> Combination:
    """The drives of all axes of which the sum of costs is the least."""
    search = _Search(order, carried, sized, most)
    lightest: dict[str, float] = {}
    for axis in order:  # bounds: each axis with the least masses on it
        found = search.choices(axis, lightest)
        if not found:
            return _sequential_choice(search, _lightest)
        search.least[axis], lightest[axis] = found[0].cost, min(choice.mass for choice in found)
    _descend(search, 0, {}, (0, 0.0))
    if search.cost is None:  # the cheapest were too heavy to carry
        return _sequential_choice(search, _lightest)
    return Combination(search.best, search.cost, not (search.cut or search.falling), len(search.made))


def axis_by_axis(order: Sequence[str], carried: Mapping[str, Sequence[str]], sized: Sized) -> Combination:
    """The best drive of each axis as it is, those that ride on it chosen before."""
    search = _Search(order, carried, sized, 0)
    return _sequential_choice(search, lambda found: found[0])


def _descend(search: _Search, depth: int, chosen: dict[str, Choice], spent: Cost) -> None:
    """Go on with the next axis inward, the cheapest drives first."""
    if depth == len(search.order):
        search.best, search.cost = dict(chosen), spent
        return
    axis = search.order[depth]
    masses = {name: choice.mass for name, choice in chosen.items()}
    if len(search.made) >= search.most and not search.known(axis, masses):
        search.cut = True
        return
    rest = _total(search.least[name] for name in search.order[depth + 1 :])
    for choice in _that_count(search, axis, search.choices(axis, masses)):
        after = _total((spent, choice.cost))
        if search.cost is not None and _reaches(_total((after, rest)), search.cost):
            return
        _descend(search, depth + 1, {**chosen, axis: choice}, after)


def _that_count(search: _Search, axis: str, choices: Sequence[Choice]) -> Sequence[Choice]:
    """All drives of an axis that others carry; else the cheapest."""
    return choices if any(axis in names for names in search.carried.values()) else choices[:1]


def _reaches(cost: Cost, best: Cost) -> bool:
    """Whether a cost is no less than another, but for rounding."""
    return cost[0] > best[0] or (cost[0] == best[0] and cost[1] >= best[1] - _ROUNDING * abs(best[1]))


def _total(costs: Iterable[Cost]) -> Cost:
    known = list(costs)
    return sum(missing for missing, _ in known), sum(value for _, value in known)


def _sequential_choice(search: _Search, pick: Callable[[Sequence[Choice]], Choice]) -> Combination:
    """A drive of each axis that has one, those that ride on it chosen before; another choice may cost less."""
    chosen, missing = dict[str, Choice](), ""
    for axis in search.order:
        found = search.choices(axis, {name: chosen[name].mass if name in chosen else 0.0 for name in search.order})
        if found:
            chosen[axis] = pick(found)
        missing = missing or ("" if found else axis)
    cost = _total(choice.cost for choice in chosen.values())
    return Combination(chosen, cost, False, len(search.made), missing)


def _lightest(found: Sequence[Choice]) -> Choice:
    return min(found, key=lambda choice: choice.mass)
