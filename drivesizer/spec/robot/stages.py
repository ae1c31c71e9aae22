"""Power stages between the supply and the motors: of one controller, and with what keeps a brake released."""

from __future__ import annotations

from functools import lru_cache

from drivesizer.catalog import Controller
from drivesizer.physics.elements.braking import released_power
from drivesizer.physics.figures import Figures
from drivesizer.physics.power_stage import Feed, power_stage
from drivesizer.physics.power_stage import PowerStage as StageFigures
from drivesizer.spec.sections import PowerStage, Supply

__all__ = ["fed", "stage_of"]


@lru_cache(maxsize=64)
def stage_of(controller: Controller | None, volts: float, given: PowerStage, assume: bool) -> StageFigures:
    """The power stage of one controller: of those of late as before."""
    return power_stage(controller or Controller(), volts, given, assume=assume)


def fed(stage: StageFigures, supply: Supply, motors: int, brake: Figures | None, released: float = 1.0) -> Feed:
    """Power stages and what feeds as many as there are motors."""
    if brake is not None:
        stage = stage._replace(standby=stage.standby + released * released_power(brake))
    return Feed(stage, supply.lowest, 0.0 if supply.resistance is None else supply.resistance, motors)
