"""Validation errors of a spec, a line each: ``file:line: field: found; expected, example``."""

from __future__ import annotations

import difflib
import re
from typing import Any

from pydantic import BaseModel, ValidationError

from drivesizer.errors import InputError, quoted
from drivesizer.files.yaml_source import Path_, YamlSource
from drivesizer.spec.keys import known_keys, meant, models_at, models_of
from drivesizer.units import KINDS, noun

__all__ = ["explained"]

# beginnings of validators' messages that state what was found
_ALONE = (
    '"', "give", "expected", "transmission", "platform", "inner", "sinkage", "ki", "motion", "a recorded", "the paper",
)  # fmt: skip


_MOST = 5  # faults that are reported at once


def explained(
    error: ValidationError, source: YamlSource, model: type[BaseModel], data: Any = None, at: Path_ = ()
) -> InputError:
    """The error that a user reads: the first fault in the file as its message, up to five as its lines."""
    data = source.data if data is None else data
    faults = [(_path(dict(fault), data), dict(fault)) for fault in error.errors(include_url=False)]
    # A misspelt key also leaves the right one missing: the misspelling is reported.
    unknown = {path[:-1] for path, fault in faults if fault["type"] == "extra_forbidden"}
    faults = [(path, fault) for path, fault in faults if fault["type"] != "missing" or path[:-1] not in unknown]
    # A word where words or a list may stand is no list, either: that it is not known is said.
    words = {path for path, fault in faults if fault["type"] == "literal_error"}
    faults = [(path, fault) for path, fault in faults if fault["type"] != "list_type" or path not in words]
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
    if fault["type"] == "value_error" and isinstance(data, dict):  # an error of several fields names one of them
        said = str(fault["ctx"]["error"])
        path += _named(said.partition(":")[0], data) or _named(said.partition(" ")[0], data)
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
            return f"{found} is not a whole number; expected one, e.g. 2"
        case "bool_type" | "bool_parsing":
            return f"{found} is neither true nor false; expected one of both"
        case "list_type":
            return f"{found} is not a list; expected entries between [ and ]{_default(model, path, data)}"
        case "string_type":
            return "is empty; expected text" if fault["input"] is None else f"{found} is not text; put it in quotes"
        case "greater_than_equal":
            return f"{found} must be at least {fault['ctx']['ge']}"
        case "less_than_equal":
            return f"{found} must be at most {fault['ctx']['le']}"
        case "extra_forbidden":
            return f"unknown key; {meant(model, path, data)}"
        case "too_short":
            return f"{found} is too short; expected at least {fault['ctx']['min_length']}{_default(model, path, data)}"
        case "too_long":
            return f"{found} is too long; expected at most {fault['ctx']['max_length']} entries"
        case "string_too_short":
            return "is empty; expected text"
        case "string_too_long":
            return f"{found} is too long; expected at most {fault['ctx']['max_length']} characters"
        case "value_error":
            return _validator_text(str(fault["ctx"]["error"]), fault["input"], path)
        case "literal_error":
            return _not_known(fault.get("input"), fault["ctx"]["expected"])
        case "union_tag_invalid":
            return _not_known(fault["ctx"]["tag"], fault["ctx"]["expected_tags"])
        case "union_tag_not_found":
            return "kind is missing"
        case "model_type" | "model_attributes_type" | "dict_type":
            return f"{found} is not a group of fields; expected fields such as {_some(model, path)}"
        case _:
            text = fault["msg"][0].lower() + fault["msg"][1:]
            return f"{found}: {text.replace('input ', '')}"


def _validator_text(text: str, found: Any, path: Path_) -> str:
    """Words of a validator: of a field with what was found there, of several fields, whose names it has, as it is."""
    own = text.removeprefix(f"{'.'.join(map(str, path))}: ")
    if own != text:
        return own
    if isinstance(found, dict) and found:
        of = found.get(path[-1]) if path and text.startswith(f"{path[-1]} ") else None
        return text if of is None or isinstance(of, list | dict) else f"{quoted(of)}: {text}"
    return text if text.startswith(_ALONE) else f"{quoted(_brief(found))} {text}"


def _not_known(found: Any, expected: str) -> str:
    """A word that is none of those that are expected, and the nearest of them.

    >>> _not_known("vehicle", "'wheeled_vehicle'")
    '"vehicle" is not known; the nearest is wheeled_vehicle; expected \\'wheeled_vehicle\\''
    """
    near = difflib.get_close_matches(str(found).lower(), re.findall(r"'([^']+)'", expected), 1, 0.6)
    hint = f"; the nearest is {near[0]}" if near and len(str(found)) > len("car") else ""
    return f"{quoted(_brief(found))} is not known{hint}; expected {expected}"


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
    inner = models_of(field) if field else []
    if inner:
        return f"fields such as {', '.join(list(inner[0].model_fields)[:4])}"
    if kinds:
        return f"{noun(kinds[0])}, e.g. {KINDS[kinds[0]].example}"
    return field.description if field and field.description else "a value"


def _default(model: type[BaseModel], path: Path_, data: Any) -> str:
    """The default of a list as an example."""
    owners = models_at(model, path[:-1], data)
    field = next((m.model_fields[str(path[-1])] for m in owners if path[-1] in m.model_fields), None)
    example = field.default if field and isinstance(field.default, list) and field.default else None
    return f", e.g. {str(example).replace(chr(39), '')}" if example else ""


def _some(model: type[BaseModel], path: Path_) -> str:
    return ", ".join(known_keys(model, path, None)[:4])
