"""Section of a spec on errors of the robot model of a platform."""

from typing import Annotated, Any

from pydantic import Field

from drivesizer.files.fields import Bearing, Mass, Place, Quantity, Section, Thickness, default
from drivesizer.platform.misjudged import Misjudged
from drivesizer.platform.wheels import Payload

__all__ = ["Unknown", "UnknownPayload"]

Off = Annotated[float, Quantity("dimensionless", least=-0.9, most=9.0)]
Each = Annotated[list[Off], Field(min_length=1, max_length=100)]


class UnknownPayload(Section):
    """Something on the platform that the robot model does not know."""

    mass: Mass
    x: Place = default("0 mm")
    y: Place = default("0 mm")
    height: Thickness = default("0 mm")


class Unknown(Section):
    """Differences of the true platform from its robot model, for path following."""

    radius: Off | Each = Field(default=0, description="share by which wheels are larger, of all or of each")
    lever: Off = Field(default=0, description="share by which the wheels stand farther out")
    toe: Bearing = default("0 deg", description="added to the heading of the wheels")
    mass: Off = Field(default=0, description="share by which it is heavier")
    inertia: Off = 0.0
    payload: UnknownPayload | None = None
    rolling_resistance: Off = Field(default=0, description="added to C_rr")
    roller_resistance: Off = Field(default=0, description="added to that of the rollers")
    motor: Off | Each = Field(default=0, description="share by which motors are stronger; -5 % is weak")

    @property
    def record(self) -> Misjudged:
        """The same as a plain record, as the simulation takes it."""
        given = {name: getattr(self, name) for name in type(self).model_fields if name != "payload"}
        errors: dict[str, Any] = {
            name: tuple(value) if isinstance(value, list) else value for name, value in given.items()
        }
        carried = self.payload
        load = Payload(mass=carried.mass, x=carried.x, y=carried.y, height=carried.height) if carried else None
        return Misjudged(**errors, payload=load)
