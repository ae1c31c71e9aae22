"""Path following as a table: effect of each misjudged figure of examples/sps_following.yaml alone."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from drivesizer import load_spec
from drivesizer.control.path_following.deviation import extremes
from drivesizer.control.path_following.following import Followed
from drivesizer.control.path_following.runs import FollowingRun, follow_case
from drivesizer.load_cases.platform_drive import Driving, driving, with_trajectory
from drivesizer.platform.misjudged import EXACT, Misjudged
from drivesizer.platform.wheels import Payload
from drivesizer.units import show

__all__ = ["ran", "sensitivities"]

ROOT = Path(__file__).resolve().parents[2]
_VALUE, _TOGETHER = re.compile(r"^([\d.]+) (m|°|%)$"), "\\1\u00a0\\2"  # on one line
_HEADS = ("misjudged", "position, PI", "heading, PI", "position, P", "heading, P")
_ONE: tuple[tuple[str, Misjudged], ...] = (
    ("none: slip and controllers alone", EXACT),
    ("all radii 1 % larger", Misjudged(radius=0.01)),
    ("one radius 0.1 % larger", Misjudged(radius=(0.001, 0.0, 0.0, 0.0))),
    ("wheels 1 % farther out", Misjudged(lever=0.01)),
    ("mass and inertia 10 % more", Misjudged(mass=0.1, inertia=0.1)),
    ("payload of 5 kg in front", Misjudged(payload=Payload(mass=5.0, x=0.2, height=0.3))),
    ("rolling resistance 0.005 more", Misjudged(rolling_resistance=0.005)),
    ("one motor 5 % weak", Misjudged(motor=(0.0, -0.05, 0.0, 0.0))),
)


@cache
def _example() -> Driving:
    return driving(with_trajectory(load_spec(ROOT / "examples" / "sps_following.yaml"), None))


def ran(run: FollowingRun) -> Followed:
    """The path of the example, followed in one run."""
    return follow_case(_example(), None, run)


def sensitivities() -> str:
    """Effect of each misjudged figure alone, with the dynamic model and without pose feedback."""
    rows = [_HEADS, ("---",) * len(_HEADS), *(_row(name, off) for name, off in _ONE)]
    return "\n".join(f"| {' | '.join(_VALUE.sub(_TOGETHER, cell) for cell in row)} |" for row in rows)


def _row(name: str, off: Misjudged) -> tuple[str, ...]:
    cells = [name]
    for integral in (True, False):
        found = follow_case(_example(), None, FollowingRun("dynamic", integral, False, False), off)
        by = {e.title: abs(e.value) for e in extremes(found)}
        cells += [show(by["position"], "m", "length", 3), show(by["heading"], "deg", "angle", 3)]
    return tuple(cells)
