"""Sections that few files have, as types of fields: the model of each is loaded where a file has one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from drivesizer.files.later import Later

__all__ = [
    "Battery", "BrakeResistor", "Budget", "Consumer", "Mounting", "OwnBrake", "Platform", "Requirements", "Shaft",
    "or_any",
]  # fmt: skip

if TYPE_CHECKING:
    from drivesizer.spec.battery import Battery, Consumer
    from drivesizer.spec.brake import OwnBrake
    from drivesizer.spec.brake_resistor import BrakeResistor
    from drivesizer.spec.mounting import Mounting
    from drivesizer.spec.platform import Budget, Platform
    from drivesizer.spec.requirements import Requirements
    from drivesizer.spec.shaft import Shaft
else:
    Battery = Annotated[Any, Later("drivesizer.spec.battery", "Battery")]
    Consumer = Annotated[Any, Later("drivesizer.spec.battery", "Consumer")]
    OwnBrake = Annotated[Any, Later("drivesizer.spec.brake", "OwnBrake")]
    BrakeResistor = Annotated[Any, Later("drivesizer.spec.brake_resistor", "BrakeResistor")]
    Mounting = Annotated[Any, Later("drivesizer.spec.mounting", "Mounting")]
    Budget = Annotated[Any, Later("drivesizer.spec.platform", "Budget")]
    Platform = Annotated[Any, Later("drivesizer.spec.platform", "Platform")]
    Requirements = Annotated[Any, Later("drivesizer.spec.requirements", "Requirements")]
    Shaft = Annotated[Any, Later("drivesizer.spec.shaft", "Shaft")]


def or_any(schema: dict[str, Any]) -> None:
    """Let the schema of a section take the word ``any``."""
    schema["anyOf"].insert(0, {"const": "any", "type": "string"})
