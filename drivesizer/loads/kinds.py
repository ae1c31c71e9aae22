"""The kinds of load: the one list of them.

A kind is a file of this folder with its torque law, a function named as the file, ``(load, gravity, course) ->
LoadCycle``, and its model, a class of the same name in capitals: ``rack_pinion`` and ``RackPinion``. A recording brings
its own course: its law takes the file instead.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Annotated, Union, get_args

from pydantic import Field

from drivesizer.files.fields import Axis
from drivesizer.loads.model import LoadModel
from drivesizer.physics.load_cycle import LoadCycle

if TYPE_CHECKING:
    from typing import TypeAlias

    from drivesizer.loads.model import SharedLoad
    from drivesizer.loads.wheeled_vehicle import WheeledVehicle

__all__ = ["AXES", "LAWS", "MODULES", "Load", "TorqueLaw"]

_FILES = (
    "wheeled_vehicle", "conveyor", "hoist", "screw", "rack_pinion", "belt_axis", "rotary_table", "arm", "fan",
    "recorded",
)  # fmt: skip

TorqueLaw = Callable[..., LoadCycle]
_HOMES = {name: import_module(f"drivesizer.loads.{name}") for name in _FILES}
_MODELS: dict[str, type[LoadModel]] = {
    name: getattr(home, name.title().replace("_", "")) for name, home in _HOMES.items()
}
MODULES: dict[str, str] = {  # a model may have several kinds
    kind: name for name, model in _MODELS.items() for kind in get_args(model.model_fields["kind"].annotation)
}
AXES: dict[str, Axis] = {kind: _MODELS[name].axis for kind, name in MODULES.items()}
LAWS: dict[str, TorqueLaw] = {kind: getattr(_HOMES[name], name) for kind, name in MODULES.items()}

if TYPE_CHECKING:
    Load: TypeAlias = WheeledVehicle | SharedLoad
else:
    Load = Annotated[Union[tuple(_MODELS.values())], Field(discriminator="kind")]  # noqa: UP007
