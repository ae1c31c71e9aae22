"""Which parts a spec allows, and what makes one set better than another to it."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from drivesizer.spec.fields import Names, Ratio, Section

__all__ = ["OBJECTIVES", "Choice", "ControllerChoice", "EncoderChoice", "Objective", "Select", "Weighted"]


class Choice(Section):
    """Restricts a kind of part to some families or part numbers."""

    family: Names | None = None
    part: Names | None = None


class EncoderChoice(Choice):
    """Restricts the encoder."""

    min_counts: Annotated[int, Field(ge=1)] | None = Field(default=None, description="counts per turn at least")


class ControllerChoice(Choice):
    """Restricts the controller."""

    bus: str | None = Field(default=None, description="such as CANopen or EtherCAT")


Objective = Literal[
    "mass", "price", "length", "power", "energy", "joule_heat", "peak_current", "winding_temperature", "margin"
]
OBJECTIVES: tuple[str, ...] = Objective.__args__  # type: ignore[attr-defined]


class Weighted(Section):
    """One of several objectives: its weight counts shares of the smallest value that any set has."""

    objective: Objective
    weight: Ratio


class Select(Section):
    """Which parts may be chosen, and what makes one set better than another."""

    catalogs: Names = Field(default=["maxon"])
    motor: Choice = Field(default_factory=Choice)
    gearhead: Choice = Field(default_factory=Choice)
    encoder: EncoderChoice = Field(default_factory=EncoderChoice)
    controller: ControllerChoice = Field(default_factory=ControllerChoice)
    objective: Objective | Annotated[list[Weighted], Field(min_length=1, max_length=8)] = "mass"
    unknown: Literal["allow", "reject"] = Field(default="allow", description="sets with a check that is unknown")

    @property
    def is_restricted(self) -> bool:
        """Whether families or parts are named."""
        return any(c.family or c.part for c in (self.motor, self.gearhead, self.encoder, self.controller))
