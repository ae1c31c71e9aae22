"""Required life: of all parts that have one, or of some of them by name."""

from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator

from drivesizer.files.fields import Duration, Section

__all__ = ["Life", "LifeOf", "Lives", "required_life"]

LifeOf = Literal["screw", "gearhead", "output_bearing"]


class Lives(Section):
    """Life of parts by name, in hours of the cycle, rests included; of the others none is required."""

    screw: Duration | None = Field(default=None, description="of a ball screw")
    gearhead: Duration | None = Field(default=None, description="of its gears, by its rated life")
    output_bearing: Duration | None = Field(default=None, description="of the gearhead's output, under section shaft")

    @model_validator(mode="after")
    def _some(self) -> Self:
        if self.screw is self.gearhead is self.output_bearing is None:
            raise ValueError("give screw, gearhead or output_bearing, or one time for all, e.g. life: 20000 h")
        return self


Life = Annotated[
    Annotated[Duration, Tag("of all")] | Annotated[Lives, Tag("by part")],
    Discriminator(lambda given: "by part" if isinstance(given, dict | Lives) else "of all"),
]


def required_life(life: Any, part: LifeOf) -> Any:
    """Life that is required of a part.

    Examples
    --------
    >>> required_life(3600.0, "screw"), required_life(Lives(gearhead="1 h"), "screw")
    (3600.0, None)
    """
    return getattr(life, part) if isinstance(life, Lives) else life
