"""The stages between motor and load that a spec may name."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from drivesizer.fields import Force, Inertia, Length, Ratio, Section, Share, Speed, Stiffness, default, exactly_one

__all__ = ["BeltStage", "GearheadStage", "Stage"]


class GearheadStage(Section):
    """A gearhead out of the catalogues: searched."""

    kind: Literal["gearhead"]


class BeltStage(Section):
    """A belt between gearhead and load: one ratio, or several to search."""

    kind: Literal["belt"]
    ratio: Ratio | None = Field(default=None, description="gearhead turns per turn of the load; or give ratios")
    ratios: Annotated[list[Ratio], Field(min_length=1, max_length=1000)] | None = None
    efficiency: Share = Field(description="in either direction of power")
    inertia: Inertia = default("0 kg*m^2", description="of belt and pulleys, seen at the load's shaft")
    stiffness: Stiffness | None = Field(default=None, description="of the belt, seen at the load's shaft")
    pulley_diameter: Length | None = Field(default=None, description="of the load's pulley")
    max_tension: Force | None = Field(default=None, description="permitted effective tension, with pulley_diameter")
    max_speed: Speed | None = Field(default=None, description="permitted belt speed, with pulley_diameter")

    @model_validator(mode="after")
    def _one_of_each(self) -> BeltStage:
        exactly_one(self, "ratio", "ratios")
        if self.pulley_diameter is None and (self.max_tension or self.max_speed):
            raise ValueError("give pulley_diameter beside max_tension and max_speed")
        return self


Stage = Annotated[GearheadStage | BeltStage, Field(discriminator="kind")]
