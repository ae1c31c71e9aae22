"""Path following as a table: effect of what robot models misjudge, on examples/sps_following.yaml."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from drivesizer import explain, load_spec
from drivesizer.control.path_following import Followed, FollowingRun, extremes, follow_case
from drivesizer.load_cases.platform import Driving, driving, with_trajectory
from drivesizer.platform.kinematics import EXACT, Misjudged
from drivesizer.results.drive_set import DriveSet
from drivesizer.units import show

__all__ = ["ran", "sensitivities"]

ROOT = Path(__file__).resolve().parents[2]
_VALUE, _TOGETHER = re.compile(r"([\d.]+) (m|°)"), "\\1\u00a0\\2"  # on one line
_HEADS = ("misjudged", "kinematic, P", "dynamic, P", "dynamic, PI")
_OF_EACH = (("kinematic", False), ("dynamic", False), ("dynamic", True))
_ALL = "all of these: the example"
_UNKNOWN = "all resistance: (49) to (59) as printed"
_ROWS: tuple[tuple[str, Misjudged], ...] = (
    ("nothing: slip and controllers alone", EXACT),
    ("mass and inertia 5 % more", Misjudged(mass=0.05, inertia=0.05)),
    ("all radii 0.5 % smaller", Misjudged(radius=-0.005)),
    ("rolling resistance 0.005 more", Misjudged(rolling_resistance=0.005)),
    ("resistance of rollers 0.005 more", Misjudged(roller_resistance=0.005)),
    ("all motors 5 % weak", Misjudged(motor=-0.05)),
    (_ALL, EXACT),
    (_UNKNOWN, Misjudged(rolling_resistance=0.02, roller_resistance=0.02)),
    ("centre of mass 10 mm ahead", Misjudged(centre=(0.01, 0.0, 0.0))),
    ("one radius 0.1 % larger", Misjudged(radius=(0.001, 0.0, 0.0, 0.0))),
    ("one motor 5 % weak", Misjudged(motor=(0.0, -0.05, 0.0, 0.0))),
    ("wheels 1 % farther out", Misjudged(lever=0.01)),
)


@cache
def _example(resists: bool = True) -> tuple[Driving, DriveSet]:
    """The example with the paper's drive; or as a model believes it that knows of no resistance."""
    spec = with_trajectory(load_spec(ROOT / "examples" / "sps_following.yaml"), None)
    (drive,) = explain(spec, "118752", "406764")
    if not resists:
        load = spec.load.model_copy(update={"rolling_resistance": 0.0})
        spec = spec.alone(load=load, platform=spec.platform.model_copy(update={"roller_resistance": 0.0}))
    return driving(spec), drive


def ran(run: FollowingRun, off: Misjudged | None = None, resists: bool = True) -> Followed:
    """The path of the example, followed in one run."""
    return follow_case(*_example(resists), run, off)


def sensitivities() -> str:
    """Largest errors by what is misjudged, without pose feedback."""
    rows = [_HEADS, ("---",) * len(_HEADS), *((name, *_errors(name, off)) for name, off in _ROWS)]
    return "\n".join(f"| {' | '.join(_VALUE.sub(_TOGETHER, cell) for cell in row)} |" for row in rows)


def _errors(name: str, off: Misjudged) -> Iterator[str]:
    for model, integral in _OF_EACH:
        run = FollowingRun(model, integral, False, False)
        by = {e.title: abs(e.value) for e in extremes(ran(run, None if name == _ALL else off, name != _UNKNOWN))}
        yield f"{show(by['position'], 'm', 'length', 3)}, {show(by['heading'], 'deg', 'angle', 3)}"
