"""Mean load and nominal life of a ball screw over its load cases, as figures: whether a life is required or not."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from drivesizer.load_cases.profile import profile_of
from drivesizer.loads.course import course
from drivesizer.loads.kinds import MODULES
from drivesizer.results.requirement import Requirement
from drivesizer.spec.robot import RobotSpec

if TYPE_CHECKING:
    from drivesizer.loads.screw_limits import ScrewLife

__all__ = ["screw_requirements"]


def screw_requirements(cases: Sequence[RobotSpec]) -> list[Requirement]:
    """Figures of the life of a ball screw in the load case in which it is shortest; none without a dynamic rating."""
    lives = [life for spec in cases if (life := _life(spec)) is not None]
    if not lives:
        return []
    worst = min(lives, key=lambda one: one.time)
    note = "in the worst load case" if len(lives) > 1 else ""
    figures = (
        ("screw_mean_load", "Mean axial load of the screw", "F_m", max(worst.mean), ("force", "N")),
        ("screw_life_turns", "Nominal life of the screw in turns", "L_10", worst.turns, ("dimensionless", "1")),
        ("screw_life_distance", "Nominal life of the screw in distance", "L_s", worst.distance, ("length", "km")),
        ("screw_life_time", "Nominal life of the screw, rests included", "L_h", worst.time, ("time", "h")),
    )
    return [
        Requirement(name=name, title=title, symbol=symbol, value=value, kind=kind, unit=unit, note=note)
        for name, title, symbol, value, (kind, unit) in figures
    ]


def _life(spec: RobotSpec) -> ScrewLife | None:
    load: Any = spec.load
    if MODULES[load.kind] != "screw" or load.dynamic_load is None:
        return None
    from drivesizer.loads.screw_limits import screw_life
    from drivesizer.loads.stage_losses import force_along

    moved = course(profile_of(spec))
    force = force_along(moved, load, spec.environment.gravity, load.mass) / load.motors
    return screw_life(load, moved, force)
