"""Section of a spec on what acts on the output shaft of gearhead or motor."""

import math
from typing import Annotated

from pydantic import Field

from drivesizer.files.fields import Factor, Force, Quantity, Section, Thickness, default

__all__ = ["Shaft"]

ToothAngle = Annotated[float, Quantity("angle", least=0.0, most=math.radians(45.0))]


class Shaft(Section):
    """Overhung shaft of gearhead, or motor: pulley or pinion of the next stage, or what of the load it carries."""

    distance: Thickness | None = Field(
        default=None,
        description="of the radial force from the mounting face of gearhead or motor; where not given that of the "
        "maker's limit",
    )
    carries_load: bool = Field(
        default=False,
        description="that the load's wheel, pinion, pulley, drum or screw has no bearing of its own, but this shaft's",
    )
    wheel_load: Force | None = Field(
        default=None, description="of the floor on a carried wheel; an equal part of the weight where not given"
    )
    pressure_angle: ToothAngle = default("20 deg", description="of a pinion's teeth")
    helix_angle: ToothAngle = default("0 deg", description="of a pinion's teeth")
    belt_pretension: Force | None = Field(
        default=None,
        description="of each strand at rest; where not given only the least force of a belt is known",
    )
    load_factor: Factor = Field(default=1.5, description="f_w of the bearing's life: 1 smooth, 1.5, 3 with impacts")
    static_safety: Factor = Field(default=1.5, description="of the bearing: 1.5, 2 with impacts, 3 for precision")
