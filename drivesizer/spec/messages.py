"""Validation errors of a spec, a line each: ``file:line: field: found; expected, example``."""

from __future__ import annotations

import difflib
from types import UnionType
from typing import Any, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError

from drivesizer.errors import InputError, quoted
from drivesizer.files.yaml_source import Path_, YamlSource
from drivesizer.units import KINDS, noun

__all__ = ["explained", "has_names", "known_keys", "models_at"]

# beginnings of validators' messages that state what was found
_ALONE = (
    '"', "give", "expected", "transmission", "platform", "inner", "sinkage", "ki", "motion", "a recorded", "the paper",
)  # fmt: skip


_MOST = 5  # faults that are reported at once


def explained(
    error: ValidationError, source: YamlSource, model: type[BaseModel], data: Any = None, at: Path_ = ()
) -> InputError:
    """The error that a user reads: the first fault in the file as its message, up to five as its lines.

    Parameters
    ----------
    error
        As pydantic raised it.
    source
        The file that was validated.
    model
        The model it was validated against, for the known keys.
    data
        The validated data, where it is not all of the file's.
    at
        Path to the part of the file that changed the data: a load case.

    Returns
    -------
    InputError
        Without line breaks in its lines.
    """
    data = source.data if data is None else data
    faults = [(_path(dict(fault), data), dict(fault)) for fault in error.errors(include_url=False)]
    # A misspelt key also leaves the right one missing: the misspelling is reported.
    unknown = {path[:-1] for path, fault in faults if fault["type"] == "extra_forbidden"}
    faults = [(path, fault) for path, fault in faults if fault["type"] != "missing" or path[:-1] not in unknown]
    faults.sort(key=lambda pair: (pair[1]["type"] != "extra_forbidden", source.line(pair[0]) or 0))
    lines = []
    for path, fault in faults:
        where = source.where(at + path if _changed(source.data, at, path) else path)
        lines.append(f"{where}: {_message(fault, path, data, model)}")
    lines = list(dict.fromkeys(lines))
    shown = [*lines[: _MOST - 1], lines[_MOST - 1] + _more(lines, _MOST)] if len(lines) >= _MOST else lines
    return InputError(lines[0] + _more(lines, 1), shown)


def _more(lines: list[str], shown: int) -> str:
    """The number of faults that are not shown.

    >>> _more(["a", "b", "c"], 1), _more(["a"], 1)
    (' (and 2 more)', '')
    """
    return f" (and {len(lines) - shown} more)" if len(lines) > shown else ""


def _changed(data: Any, at: Path_, path: Path_) -> bool:
    """Whether the part of the file at one path has the field of another path."""
    for step in at:
        data = data[step]
    return bool(at) and bool(path) and path[0] in data


def _path(fault: dict[str, Any], data: Any) -> Path_:
    """The fault's place in the file: pydantic's location without the names of union members."""
    path: list[str | int] = []
    for n, step in enumerate(fault["loc"], 1):
        try:
            data = data[step]
        except (TypeError, KeyError, IndexError):
            absent = fault["type"] in ("missing", "extra_forbidden") and n == len(fault["loc"])
            if not absent:
                continue
        path.append(step)
    if fault["type"] == "value_error" and not path:  # an error of several fields names one of them
        path = _named(str(fault["ctx"]["error"]).partition(":")[0], data)
    if fault["type"] == "union_tag_invalid":
        path.append(fault["ctx"]["discriminator"].strip("'"))
    return tuple(path)


def _named(field: str, data: Any) -> list[str | int]:
    """The place of a field that a message names, where the data has it.

    >>> _named("needs.life", {"needs": {"life": "2 h"}}), _named("needs.life", {"needs": {}}), _named("give a or b", {})
    (['needs', 'life'], [], [])
    """
    path: list[str | int] = []
    for step in field.split("."):
        if not isinstance(data, dict) or step not in data:
            return []
        path.append(step)
        data = data[step]
    return path


def _message(fault: dict[str, Any], path: Path_, data: Any, model: type[BaseModel]) -> str:
    found = quoted(_brief(fault.get("input")))
    match fault["type"]:
        case "missing":
            return f"is missing; expected {_example(model, path, data)}"
        case "int_type" | "int_from_float":
            return f"{found} is not a whole number"
        case "bool_type" | "bool_parsing":
            return f"{found} is neither true nor false"
        case "list_type":
            return f"{found} is not a list; expected entries between [ and ]{_default(model, path, data)}"
        case "string_type":
            return "is empty; expected text" if fault["input"] is None else f"{found} is not text; put it in quotes"
        case "greater_than_equal" | "less_than_equal":
            return f"{found} must be {fault['msg'].removeprefix('Input should be ')}"
        case "extra_forbidden":
            other = _elsewhere(model, path)
            return f"unknown key; {other or _nearest(str(path[-1]), known_keys(model, path[:-1], data))}"
        case "too_short":
            return f"{found} is too short; expected at least {fault['ctx']['min_length']}{_default(model, path, data)}"
        case "value_error":
            text = str(fault["ctx"]["error"])
            own = text.removeprefix(f"{'.'.join(map(str, path))}: ")
            return own if own != text or own.startswith(_ALONE) else f"{found} {own}"
        case "literal_error":
            return f"{found} is not known; expected {fault['ctx']['expected']}"
        case "union_tag_invalid":
            return f"{quoted(fault['ctx']['tag'])} is not known; expected {fault['ctx']['expected_tags']}"
        case "union_tag_not_found":
            return "kind is missing"
        case "model_type" | "model_attributes_type" | "dict_type":
            return f"{found} is not a group of fields; expected fields such as {_some(model, path)}"
        case _:
            text = fault["msg"][0].lower() + fault["msg"][1:]
            return f"{found}: {text.replace('input ', '')}"


def _brief(value: Any) -> Any:
    if isinstance(value, dict):
        return "{" + ", ".join(value) + "}"
    if isinstance(value, list):
        return f"a list of {len(value)}" if value else "an empty list"
    return "nothing" if value is None else value


def _example(model: type[BaseModel], path: Path_, data: Any) -> str:
    """Example for a missing field."""
    owners = models_at(model, path[:-1], data)
    field = next((m.model_fields[str(path[-1])] for m in owners if path[-1] in m.model_fields), None)
    kinds = [part.kind for part in (field.metadata if field else []) if hasattr(part, "kind")]
    inner = _models_in(field.annotation) if field else []
    if inner:
        return f"fields such as {', '.join(list(inner[0].model_fields)[:4])}"
    if kinds:
        return f"{noun(kinds[0])}, e.g. {KINDS[kinds[0]].example}"
    return field.description if field and field.description else "a value"


def _nearest(key: str, known: list[str]) -> str:
    close = difflib.get_close_matches(key, known, 1, 0.5)
    return f"did you mean {quoted(close[0])}?" if close else f"expected one of {', '.join(known)}"


def _elsewhere(model: type[BaseModel], path: Path_) -> str:
    """The profiles or kinds with a key that the one of the file lacks; empty where none has it."""
    owners = [model] if len(path) == 2 else []  # of load and motion, each one of several models
    fields = [m.model_fields[str(path[0])] for m in owners if path[0] in m.model_fields]
    models = [m for field in fields for m in _models_in(field.annotation) if path[-1] in m.model_fields]
    for name in ("profile", "kind"):
        having = [m.model_fields[name].annotation for m in models if name in m.model_fields]
        named = [str(kind) for annotation in having for kind in get_args(annotation)]
        if named:
            return f"it belongs to {name}: {' or '.join(named)}"
    return ""


def _default(model: type[BaseModel], path: Path_, data: Any) -> str:
    """The default of a list as an example."""
    owners = models_at(model, path[:-1], data)
    field = next((m.model_fields[str(path[-1])] for m in owners if path[-1] in m.model_fields), None)
    example = field.default if field and isinstance(field.default, list) and field.default else None
    return f", e.g. {str(example).replace(chr(39), '')}" if example else ""


def _some(model: type[BaseModel], path: Path_) -> str:
    return ", ".join(known_keys(model, path, None)[:4])


def known_keys(model: type[BaseModel], path: Path_, data: Any) -> list[str]:
    """Names of the fields at a path.

    Parameters
    ----------
    model
        Model of the file.
    path
        Keys and indices from the top of the document.
    data
        The file's data; None where unknown.

    Returns
    -------
    list[str]
        In the order of the models.
    """
    return list(dict.fromkeys(name for m in models_at(model, path, data) for name in m.model_fields))


def models_at(model: type[BaseModel], path: Path_, data: Any) -> list[type[BaseModel]]:
    """Models of a path; `kind` or `profile` decides between them.

    Parameters
    ----------
    model
        Model of the file.
    path
        Keys and indices from the top of the document.
    data
        The file's data; None where unknown.

    Returns
    -------
    list[type[BaseModel]]
        More than one where the data does not decide.
    """
    return _reached(model, path, data)[0]


def has_names(model: type[BaseModel], path: Path_, data: Any) -> bool:
    """Whether the keys at a path are names that the user gives, such as joints.

    Parameters
    ----------
    model, path, data
        As of ``models_at``.

    Returns
    -------
    bool
        False where they are fields.
    """
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
            models = [found for f in fields for part in (f.annotation, *f.metadata) for found in _models_in(part)]
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


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    if hasattr(annotation, "models"):  # a figure that may be a group of fields too
        return list(annotation.models)
    if get_origin(annotation) in (Union, UnionType, list) or get_origin(annotation) is not None:
        return [found for inner in get_args(annotation) for found in _models_in(inner)]
    return []
