"""Loads: one file per kind, with its fields in robot.yaml and the torque at its shaft; here the one list of them.

A kind is a file of this folder with its torque law, a function named as the file, ``(load, gravity, course) ->
LoadCycle``, and its model, a class of the same name in capitals: ``rack_pinion`` and ``RackPinion``. A recording brings
its own course: its law takes the file instead.

May import: files, physics, equations.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Annotated, Union

from pydantic import Field

from drivesizer.files.fields import Axis
from drivesizer.loads.model import LoadModel
from drivesizer.physics.load_cycle import LoadCycle

if TYPE_CHECKING:
    from typing import TypeAlias

    from drivesizer.loads.model import SharedLoad
    from drivesizer.loads.wheeled_vehicle import WheeledVehicle


_FILES = (
    "wheeled_vehicle", "conveyor", "hoist", "screw", "rack_pinion", "belt_axis", "rotary_table", "arm", "fan",
    "winder", "recorded",
)  # fmt: skip
_SEVERAL = {"screw": ("lead_screw", "ball_screw"), "fan": ("fan", "flywheel")}  # kinds of a file; of others its name

TorqueLaw = Callable[..., LoadCycle]
MODULES: dict[str, str] = {kind: name for name in _FILES for kind in _SEVERAL.get(name, (name,))}
_HOMES = {name: import_module(f"drivesizer.loads.{name}") for name in _FILES}
_MODELS: dict[str, type[LoadModel]] = {
    name: getattr(home, name.title().replace("_", "")) for name, home in _HOMES.items()
}
AXES: dict[str, Axis] = {kind: _MODELS[name].axis for kind, name in MODULES.items()}
LAWS: dict[str, TorqueLaw] = {kind: getattr(_HOMES[name], name) for kind, name in MODULES.items()}

if TYPE_CHECKING:
    Load: TypeAlias = WheeledVehicle | SharedLoad
else:
    Load = Annotated[Union[tuple(_MODELS.values())], Field(discriminator="kind")]  # noqa: UP007
