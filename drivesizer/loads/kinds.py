"""The kinds of load: the one list of them.

A kind is a file of this folder with its torque law, a function named as the file, ``(load, gravity, course) ->
LoadCycle``, and its model, a class of the same name in capitals: ``rack_pinion`` and ``RackPinion``. A recording brings
its own course: its law takes the file instead. A file is loaded when a spec has a load of its kind.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cache
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Annotated, Any, Generic, TypeVar, Union

from pydantic import Field, TypeAdapter, ValidationInfo
from pydantic_core import core_schema

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
_SEVERAL = {"screw": ("lead_screw", "ball_screw"), "fan": ("fan", "flywheel")}  # kinds of a file; of others its name

TorqueLaw = Callable[..., LoadCycle]
MODULES: dict[str, str] = {kind: name for name in _FILES for kind in _SEVERAL.get(name, (name,))}
Of = TypeVar("Of")


@cache
def _home(name: str) -> ModuleType:
    return import_module(f"drivesizer.loads.{name}")


def _model(name: str) -> type[LoadModel]:
    found: type[LoadModel] = getattr(_home(name), name.title().replace("_", ""))
    return found


class _ByKind(Mapping[str, Of], Generic[Of]):
    """Models, axes or laws by kind, each out of its file."""

    def __init__(self, of: Callable[[str], Of]) -> None:
        self.of = of

    def __getitem__(self, kind: str) -> Of:
        return self.of(MODULES[kind])

    def __iter__(self) -> Iterator[str]:
        return iter(MODULES)

    def __len__(self) -> int:
        return len(MODULES)


AXES: Mapping[str, Axis] = _ByKind(lambda name: _model(name).axis)
LAWS: Mapping[str, TorqueLaw] = _ByKind(lambda name: getattr(_home(name), name))


class _OfItsKind:
    """Type of the field ``load``: of the model that its kind names."""

    @property
    def models(self) -> tuple[type[LoadModel], ...]:
        """All of them, now loaded."""
        return tuple(map(_model, _FILES))

    def read(self, given: Any, info: ValidationInfo) -> Any:
        """The load; what is wrong in it, or with its kind, is raised with its place."""
        kind = given.get("kind") if isinstance(given, dict) else getattr(given, "kind", None)
        name = MODULES.get(kind) if isinstance(kind, str) else None
        if name is None:
            return _any_kind().validate_python(given, context=info.context)
        return _model(name).model_validate(given, context=info.context)

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.with_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        found: dict[str, Any] = handler(core_schema.definitions_schema(_any_kind().core_schema, []))
        return found


@cache
def _any_kind() -> TypeAdapter[Any]:
    """All kinds at once, for the schema, and for the message about a kind that is none."""
    every: Any = Union[_OfItsKind().models]  # noqa: UP007
    return TypeAdapter(Annotated[every, Field(discriminator="kind")])


if TYPE_CHECKING:
    Load: TypeAlias = WheeledVehicle | SharedLoad
else:
    Load = Annotated[Any, _OfItsKind()]
