"""Fields that all kinds of load have in common."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar

from pydantic import Field

from drivesizer.files.fields import Axis, Section, default, no_entries
from drivesizer.loads.springs import Lever, Springs, unfit_springs

Count = Annotated[int, Field(ge=1, le=100)]


class LoadModel(Section):
    """A load as a user writes it; its file also has the torque law."""

    axis: ClassVar[Axis]  # of its motion: along a line or about an axis
    takes_payload: ClassVar[bool] = False  # whether a motion may add one to its mass, and drives of other axes theirs
    is_wheel: ClassVar[bool] = False  # whether it is of driven wheels of a platform, their cycle computed
    of_shaft: ClassVar[bool] = False  # whether its law or file gives the shaft's speed: at no fixed radius
    loads_shaft: ClassVar[bool] = False  # whether its force on the shaft that carries it is known
    has_end: ClassVar[bool] = False  # whether its travel is limited, so that a cycle has to end where it starts

    @property
    def shaft_axis(self) -> Axis:
        """Along a line or about an axis, as a loop of its drive has the motion."""
        return "rotary" if self.of_shaft else self.axis

    @property
    def lever(self) -> Lever | None:
        """The mass that gravity turns about the axis, of the whole load; None where there is none."""
        return None


class SharedLoad(LoadModel):
    """A load that one drive moves, or several that share it equally."""

    kind: str
    motors: Count = default(1, "drives that share the load equally; all figures are of the whole")
    springs: Springs = no_entries("springs and counterweights beside the drives")

    def _contradictions(self) -> Iterator[str]:
        if self.springs:
            turns, lever = self.axis == "rotary", self.lever
            yield from unfit_springs(self.springs, turns=turns, levels=lever is not None)

    @property
    def alike(self) -> int:
        """Number of drives that the load cycle applies to: all."""
        return self.motors
