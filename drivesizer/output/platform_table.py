"""Tables of a platform, for terminal and reports: the speed that its drives permit in each direction."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import isinf, isnan

from drivesizer.machine.permitted_speed import PermittedSpeeds
from drivesizer.units import show

__all__ = ["FOLLOWING", "SPEEDS", "failed_motors_text", "speed_heads", "speed_remarks", "speed_rows", "speed_text"]

FOLLOWING = "Path following: largest deviations"
SPEEDS = "Highest steady speed by direction, counterclockwise from ahead"


def speed_heads(found: PermittedSpeeds) -> list[str]:
    """Heads of the columns: direction, motors, and each failed wheel."""
    return ["direction", failed_motors_text(found), *(f"without {failed}" for failed in found.speed if failed)]


def failed_motors_text(found: PermittedSpeeds) -> str:
    """Motors that drive where no further one fails: ``all motors``, or without the failed ones."""
    return f"without {', '.join(map(str, found.failed))}" if found.failed else "all motors"


def speed_rows(found: PermittedSpeeds) -> Iterator[tuple[str, str, list[float]]]:
    """Direction, what limits it, and speeds [m/s], with all motors and without each; of a quarter turn."""
    for degrees in range(0, 91, 15):
        here = found.at(degrees)
        if not isnan(here[0][0]):
            yield f"{degrees} °", here[0][1], [speed for speed, _ in here.values()]


def speed_text(speed: float) -> str:
    """A speed of the table; a dash where the wheels do not go there.

    >>> speed_text(1.35), speed_text(float("nan")), speed_text(float("inf"))
    ('1.35 m/s', '–', 'any')
    """
    return "any" if isinf(speed) else "–" if isnan(speed) else show(speed, "m/s", "speed", 3)


def speed_remarks(found: PermittedSpeeds) -> Iterator[str]:
    """Directions in which a speed is not permitted, and assumptions of the table, as sentences."""
    required, every = found.required, len(found.direction)
    slow = {failed: int((speed < (required or 0.0)).sum()) for failed, speed in found.speed.items()}
    if required is not None and any(slow.values()):
        less = f", without a motor in up to {max(slow.values())}" if len(slow) > 1 else ""
        yield f"{speed_text(required)}, as in the spec, is not permitted in {slow[0]} of {every} directions{less}."
    yield (
        "At constant speed for long, at the lowest supply voltage: what is left for gaining speed is not in it, and "
        "neither are supply and battery."
    )
    by = dict.fromkeys(name for names in found.limit.values() for name in names if name)
    never = "; 0 m/s: not for long at any speed" * any((speed == 0.0).any() for speed in found.speed.values())
    yield f"Limited by {_listed(by)}{never}." if by else "No limit is known."
    if len(found.speed) > 1 or found.failed:
        yield "Without: the motor of that wheel has failed, and neither it nor its gearhead resists."
    if found.estimated:
        yield f"Estimated, at the middle of its band: {_listed(found.estimated)}."
    if found.unknown:
        yield f"Unknown and not looked at: {_listed(found.unknown)}."


def _listed(titles: Iterable[str]) -> str:
    return "; ".join(f"{title[0].lower()}{title[1:]}" for title in titles)
