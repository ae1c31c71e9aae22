"""Groups of fields whose model is loaded where a file has such a group: a spec has few of those that it may have."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any, get_args

from pydantic import BaseModel, ValidationInfo
from pydantic_core import core_schema

from drivesizer.files.fields import Section

__all__ = ["HasLater", "Later"]


@dataclass(frozen=True, slots=True)
class Later:
    """Type of a field, ``Annotated[Any, Later("drivesizer.spec.shaft", "Shaft")]``: a group of fields of that model."""

    module: str
    name: str

    @property
    def models(self) -> tuple[type[BaseModel], ...]:
        """The model, now loaded."""
        return (_model(self.module, self.name),)

    def read(self, given: object, info: ValidationInfo) -> BaseModel:
        """The group of fields; what is wrong in it is raised with its place."""
        model = _model(self.module, self.name)
        if isinstance(given, model):  # as it was read before
            return given
        return model.model_validate(given, context=info.context)

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.with_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        (model,) = self.models
        model.model_rebuild()
        found: dict[str, Any] = handler(core_schema.definitions_schema(model.__pydantic_core_schema__, []))
        return found


@cache
def _model(module: str, name: str) -> type[BaseModel]:
    found: type[BaseModel] = getattr(import_module(module), name)
    return found


class HasLater(Section):
    """A group of fields, some of them of models that are loaded later; its JSON Schema is that with these models."""

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: Any) -> dict[str, Any]:
        made: dict[str, Any] = handler(schema)
        properties = handler.resolve_ref_schema(made)["properties"]
        for name, field in cls.model_fields.items():
            marks = (mark for option in get_args(field.annotation) for mark in get_args(option))
            if "anyOf" in properties[name] and any(isinstance(mark, Later) for mark in marks):
                del properties[name]["title"]  # a model has its own
        return made
