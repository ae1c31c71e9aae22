"""Section of a spec on what the machine is for, as far as no other section has it."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from drivesizer.files.fields import Duration, Length, Section, Velocity, no_entries

__all__ = ["Requirements", "Travel"]


class Travel(Section):
    """A distance that a vehicle must cover in a time."""

    distance: Length
    within: Duration


class Requirements(Section):
    """Requirements on the machine; autonomy and range stand in `battery`, doors in `platform`, the mass in `budget`."""

    travel: Travel | None = Field(default=None, description="by a vehicle, at the mean speed of its motion")
    speed: Velocity | None = Field(default=None, description="that the motion must reach")
    devices: Annotated[list[Annotated[str, Field(min_length=1, max_length=60)]], Field(max_length=100)] = no_entries(
        description="that it must carry: names of `equipment`, of `others` of `budget` or of payloads"
    )

    @model_validator(mode="after")
    def _something(self) -> Self:
        if self.travel is None and self.speed is None and not self.devices:
            raise ValueError("give travel, speed or devices, e.g. travel: {distance: 7 km, within: 80 min}")
        if len(set(self.devices)) != len(self.devices):
            raise ValueError("expected devices with names of their own")
        return self
