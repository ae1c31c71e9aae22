"""Validation errors of a spec as one line: ``file:line: field: found; expected, example``.

The first error in the file is reported, with the number of the others at the end.
"""

from __future__ import annotations

import difflib
from types import UnionType
from typing import Any, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError

from drivesizer.errors import quoted
from drivesizer.files.yaml_source import Path_, YamlSource
from drivesizer.units import KINDS, noun

__all__ = ["explained", "known_keys", "models_at"]

# beginnings of validators' messages that state what was found
_ALONE = (
    '"', "give", "expected", "transmission", "platform", "inner", "sinkage", "ki", "motion", "a recorded", "the paper",
)  # fmt: skip


def explained(
    error: ValidationError, source: YamlSource, model: type[BaseModel], data: Any = None, at: Path_ = ()
) -> str:
    """One line for a validation error.

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
    str
        The message, without a line break.
    """
    data = source.data if data is None else data
    faults = [(_path(dict(fault), data), dict(fault)) for fault in error.errors(include_url=False)]
    # A misspelt key also leaves the right one missing: the misspelling is reported.
    faults.sort(key=lambda pair: (pair[1]["type"] != "extra_forbidden", source.line(pair[0]) or 0))
    path, fault = faults[0]
    more = f" (and {len(faults) - 1} more)" if len(faults) > 1 else ""
    where = source.where(at + path if _changed(source.data, at, path) else path)
    return f"{where}: {_message(fault, path, data, model)}{more}"


def _changed(data: Any, at: Path_, path: Path_) -> bool:
    """Whether the part of the file at one path has the field of another path."""
    for step in at:
        data = data[step]
    return bool(at) and bool(path) and path[0] in data


def _path(fault: dict[str, Any], data: Any) -> Path_:
    """The fault's place in the file: pydantic's location without the names of union members."""
    path: list[str | int] = []
    for step in fault["loc"]:
        try:
            data = data[step]
        except (TypeError, KeyError, IndexError):
            absent = fault["type"] in ("missing", "extra_forbidden") and step == fault["loc"][-1]
            if not absent:
                continue
        path.append(step)
    if fault["type"] == "value_error" and not path:  # an error of several fields names one of them
        named = str(fault["ctx"]["error"]).partition(":")[0]
        path = [named] if isinstance(data, dict) and named in data else []
    if fault["type"] == "union_tag_invalid":
        path.append(fault["ctx"]["discriminator"].strip("'"))
    return tuple(path)


def _message(fault: dict[str, Any], path: Path_, data: Any, model: type[BaseModel]) -> str:
    found = quoted(_brief(fault.get("input")))
    match fault["type"]:
        case "missing":
            return f"is missing; expected {_example(model, path, data)}"
        case "int_type" | "int_from_float":
            return f"{found} is not a whole number"
        case "string_type":
            return "is empty; expected text" if fault["input"] is None else f"{found} is not text; put it in quotes"
        case "greater_than_equal" | "less_than_equal":
            return f"{found} must be {fault['msg'].removeprefix('Input should be ')}"
        case "extra_forbidden":
            return f"unknown key; {_nearest(str(path[-1]), known_keys(model, path[:-1], data))}"
        case "value_error":
            text = str(fault["ctx"]["error"])
            own = text.removeprefix(f"{path[-1]}: ") if len(path) == 1 else text
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
        return f"a list of {len(value)}"
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
    models: list[type[BaseModel]] = [model]
    for step in path:
        try:
            data = data[step]
        except (TypeError, KeyError, IndexError):
            data = None
        if isinstance(step, str):
            fields = [m.model_fields[step] for m in models if step in m.model_fields]
            models = [found for f in fields for found in _models_in(f.annotation)]
        found = data if isinstance(data, dict) else {}
        models = [m for m in models if _is_named(m, found)] or models
    return models


def _is_named(model: type[BaseModel], data: dict[str, Any]) -> bool:
    """Whether the field that selects a model, kind or profile, names this one."""
    named = {key: model.model_fields[key] for key in ("kind", "profile") if key in model.model_fields}
    return any(data.get(key, field.default) in get_args(field.annotation) for key, field in named.items())


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    if get_origin(annotation) in (Union, UnionType, list) or get_origin(annotation) is not None:
        return [found for inner in get_args(annotation) for found in _models_in(inner)]
    return []
