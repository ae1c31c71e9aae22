"""Section of a spec on a holding brake of its own, and what is required of one."""

from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from drivesizer.files.fields import (
    Consumed,
    Duration,
    Energy,
    Mass,
    Pause,
    Power,
    Price,
    Section,
    Thickness,
    TorqueAbove,
    Turning,
    Voltage,
)
from drivesizer.files.inertia import Inertia

__all__ = ["OwnBrake"]

_FIGURES = {"torque": "static_torque", "voltage": "supply", "length": "added_length"}  # others have the same name


class OwnBrake(Section):
    """A holding brake with figures of its own, in place of one out of the catalogues."""

    torque: TorqueAbove = Field(description="static, that it holds at least")
    dynamic_torque: TorqueAbove | None = Field(default=None, description="while it slips")
    at: Literal["motor", "load"] = Field(default="motor", description="whose shaft it sits on")
    inertia: Inertia | None = Field(default=None, description="that turns with that shaft; estimated where not given")
    power: Power | None = Field(default=None, description="of its coil while released; estimated where not given")
    holding_power: Consumed | None = Field(default=None, description="that keeps it released, where that is less")
    voltage: Voltage | None = Field(default=None, description="of its coil")
    mass: Mass | None = Field(default=None, description="estimated where not given")
    length: Thickness | None = Field(default=None, description="that it adds to the motor")
    price: Price | None = None
    release_time: Duration | None = None
    engage_time: Pause | None = Field(default=None, description="until it has its torque")
    max_speed: Turning | None = Field(default=None, description="of its shaft")
    energy_per_stop: Energy | None = Field(default=None, description="permitted in one emergency stop")
    total_energy: Energy | None = Field(default=None, description="of all emergency stops in its life")
    emergency_stops: Annotated[int, Field(ge=1)] | None = Field(default=None, description="permitted in its life")

    @model_validator(mode="after")
    def _one_in_all(self) -> Self:
        if self.total_energy is not None and not self.total_energy >= (self.energy_per_stop or 0.0):
            raise ValueError("total_energy: expected at least energy_per_stop, as it is that of all stops")
        return self

    @property
    def figures(self) -> dict[str, Any]:
        """Columns of the catalogue, as far as given [SI]; arrays over samples."""
        given = {_FIGURES.get(name, name): getattr(self, name) for name in type(self).model_fields if name != "at"}
        known = {name: value for name, value in given.items() if value is not None}
        return known | {"shaft": "load" if self.at == "load" else ""}
