"""Keys of a spec: those that are known at a place, and which one an unknown key stands for."""

from __future__ import annotations

import difflib
import re
from types import UnionType
from typing import Any, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from drivesizer.errors import quoted
from drivesizer.files.yaml_source import Path_

__all__ = ["has_names", "known_keys", "meant", "models_at", "models_in", "models_of"]

# What others call a field: the first of these that is known at its place, or elsewhere in the file, is proposed.
_OTHER_WORDS = {
    "accel": ("acceleration", "acceleration_time"),
    "ambient_temperature": ("ambient",),
    "angle": ("incline", "slope", "distance"),
    "bus_voltage": ("nominal",),
    "displacement": ("distance",),
    "dwell": ("rest_time",),
    "dwell_time": ("rest_time",),
    "friction": ("friction_coefficient", "rolling_resistance", "friction_torque"),
    "gear_ratio": ("ratio",),
    "inclination": ("incline", "slope"),
    "max_voltage": ("max",),
    "min_voltage": ("min",),
    "moment_of_inertia": ("inertia",),
    "move": ("distance",),
    "mu": ("friction_coefficient",),
    "pause": ("rest_time",),
    "payload": ("mass",),
    "pitch": ("lead",),
    "radius": ("diameter", "wheel_diameter", "pulley_diameter"),
    "stroke": ("distance",),
    "temperature": ("ambient",),
    "travel": ("distance",),
    "velocity": ("speed",),
    "voltage": ("nominal", "nominal_voltage"),
    "weight": ("mass",),
}
_FEW = 3  # places of a key that are named


def meant(model: type[BaseModel], path: Path_, data: Any) -> str:
    """Return what an unknown key stands for."""
    key = str(path[-1])
    if re.match(r"[0-9]", key):
        return "a comma ends a field between { and }; a number has a decimal point, e.g. 3.6 km/h"
    known = known_keys(model, path[:-1], data)
    named = next((word for word in _OTHER_WORDS.get(key, ()) if word in known), None)
    if named:
        return f"did you mean {quoted(named)}?"
    kinds = (_other_kind(model, path, word) for word in (key, *_OTHER_WORDS.get(key, ())))
    return next(filter(None, kinds), "") or _other_group(model, key) or _nearest(key, known)


def _other_kind(model: type[BaseModel], path: Path_, word: str) -> str:
    """The profiles or kinds with a word that the one of the file lacks; empty where none has it."""
    # of load and motion, each one of several models, and of each stage of the transmission
    owners = [model] if len(path) == 2 or (len(path) == 3 and isinstance(path[1], int)) else []
    fields = [m.model_fields[str(path[0])] for m in owners if path[0] in m.model_fields]
    models = [m for field in fields for m in models_of(field) if word in m.model_fields]
    for name in ("profile", "kind"):
        having = [m.model_fields[name].annotation for m in models if name in m.model_fields]
        named = [str(kind) for annotation in having for kind in get_args(annotation)]
        if named:
            return f"{'it' if word == path[-1] else quoted(word)} belongs to {name}: {' or '.join(named)}"
    return ""


def _other_group(model: type[BaseModel], key: str) -> str:
    """The groups of the file that have a key, or what it is called there; empty where none has it, or too many."""
    places = [
        f"{group}.{word}"
        for word in (key, *_OTHER_WORDS.get(key, ()))
        for group, field in model.model_fields.items()
        if any(word in one.model_fields for one in models_of(field))
    ]
    return f"expected {' or '.join(places)}" if 0 < len(places) <= _FEW else ""


def _nearest(key: str, known: list[str]) -> str:
    close = difflib.get_close_matches(key, known, 1, 0.5)
    return f"did you mean {quoted(close[0])}?" if close else f"expected one of {', '.join(known)}"


def known_keys(model: type[BaseModel], path: Path_, data: Any) -> list[str]:
    """Names of the fields at a path."""
    return list(dict.fromkeys(name for m in models_at(model, path, data) for name in m.model_fields))


def models_at(model: type[BaseModel], path: Path_, data: Any) -> list[type[BaseModel]]:
    """Models of a path; `kind` or `profile` decides between them."""
    return _reached(model, path, data)[0]


def has_names(model: type[BaseModel], path: Path_, data: Any) -> bool:
    """Whether the keys at a path are names that the user gives, such as joints."""
    return _reached(model, path, data)[1]


def _reached(model: type[BaseModel], path: Path_, data: Any) -> tuple[list[type[BaseModel]], bool]:
    """Models of a path, and whether the keys there are names by which each has one of these models."""
    models: list[type[BaseModel]] = [model]
    by_name = False
    for step in path:
        try:
            data = data[step]
        except (TypeError, KeyError, IndexError):
            data = None
        if isinstance(step, str) and not by_name:
            fields = [m.model_fields[step] for m in models if step in m.model_fields]
            models = [found for f in fields for found in models_of(f)]
            by_name = any(_is_by_name(f.annotation) for f in fields)
        elif isinstance(step, str):
            by_name = False
        found = data if isinstance(data, dict) else {}
        models = [m for m in models if _is_named(m, found)] or models
    return models, by_name


def _is_by_name(annotation: Any) -> bool:
    """Whether a type is a group of fields by names of the user's, or may be one."""
    if get_origin(annotation) in (Union, UnionType):
        return any(map(_is_by_name, get_args(annotation)))
    return get_origin(annotation) is dict


def _is_named(model: type[BaseModel], data: dict[str, Any]) -> bool:
    """Whether the field that selects a model, kind or profile, names this one."""
    named = {key: model.model_fields[key] for key in ("kind", "profile") if key in model.model_fields}
    return any(data.get(key, field.default) in get_args(field.annotation) for key, field in named.items())


def models_of(field: FieldInfo) -> list[type[BaseModel]]:
    """Models that a field is of, or may be, by its type or by what marks it."""
    return [found for part in (field.annotation, *field.metadata) for found in models_in(part)]


def models_in(annotation: Any) -> list[type[BaseModel]]:
    """Models that a type is, or may be."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    if hasattr(annotation, "models"):  # a figure that may be a group of fields too
        return list(annotation.models)
    if get_origin(annotation) in (Union, UnionType, list) or get_origin(annotation) is not None:
        return [found for inner in get_args(annotation) for found in models_in(inner)]
    return []
