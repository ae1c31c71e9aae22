"""Other drives for the axes where the best of each together break a limit of the machine."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

from drivesizer.multi_axis.combinations import Choice
from drivesizer.results.check import GRAVEST
from drivesizer.results.machine import MachineSizing

__all__ = ["cheapest_first", "within_limits"]

_MOST = 60  # combinations that are tried


def within_limits(
    best: MachineSizing,
    offers: Callable[[], Mapping[str, Sequence[Choice]]],
    tried: Callable[[Mapping[str, Choice]], MachineSizing | None],
) -> MachineSizing:
    """The machine with the drives that keep its own limits at the least cost, of those that are tried."""
    broken = [check.title for check in best.checks if check.status == "fail"]
    if not broken or not best.complete:
        return best
    count = 0
    for count, chosen in enumerate(cheapest_first(offers(), _MOST), 1):
        result = tried(chosen)
        if result is None or not _keeps(result, best):
            continue
        note = f"{broken[0]}: the best drives of all axes break it together; of the next best, choice {count} keeps it"
        return replace(result, certain=False, notes=(*result.notes, note))
    note = f"{broken[0]}: none of {count} other choices of drives keeps it"
    return replace(best, certain=False, notes=(*best.notes, note))


def _keeps(result: MachineSizing, best: MachineSizing) -> bool:
    """Whether no limit of the machine is broken, and no axis has become worse."""
    axes = zip(result.axes, best.axes, strict=True)
    statuses = [(one.best.status if one.best else "fail", other.best.status) for one, other in axes if other.best]
    worse = any(GRAVEST.index(now) < GRAVEST.index(before) for now, before in statuses)
    return not worse and not any(check.status == "fail" for check in result.checks)


def cheapest_first(offers: Mapping[str, Sequence[Choice]], most: int) -> Iterator[dict[str, Choice]]:
    """Choices of one drive for each axis in the order of their cost, the cheapest of all left out."""
    names = list(offers)
    start = (0,) * len(names)

    def cost(places: tuple[int, ...]) -> tuple[int, float, int]:
        costs = [offers[name][place].cost for name, place in zip(names, places, strict=True)]
        return sum(missing for missing, _ in costs), sum(value for _, value in costs), sum(places)

    waiting, seen = [(cost(start), start)], {start}
    while waiting and most > 0:
        _, places = heapq.heappop(waiting)
        if any(places):
            most -= 1
            yield {name: offers[name][place] for name, place in zip(names, places, strict=True)}
        for n, name in enumerate(names):
            further = (*places[:n], places[n] + 1, *places[n + 1 :])
            if further[n] < len(offers[name]) and further not in seen:
                seen.add(further)
                heapq.heappush(waiting, (cost(further), further))
