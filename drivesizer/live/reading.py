"""The text of the page as a spec, and its sizing."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from drivesizer.errors import InputError
from drivesizer.files.yaml_edit import Edit, edited
from drivesizer.files.yaml_source import YamlSource
from drivesizer.live.held import EngineMemory, Piece

__all__ = ["FRONT", "TOP", "faults", "named", "text_of", "whole"]

TOP = 10  # drives of an answer, as in a report
FRONT = ("mass", "price", "energy")
_CHOICES = 200  # drives to choose from by weights, as in a report


def text_of(held: EngineMemory, request: Piece) -> str:
    """The text of a request with its edits made."""
    edits = [Edit(tuple(path), value, bool(text)) for path, value, text in request.get("edits") or []]
    return edited(str(request["text"]), edits, held.name) if edits else str(request["text"])


def whole(held: EngineMemory, text: str, *, top: int = TOP, front: bool = False, brief: bool = False) -> Any:
    """The sizing of a text, made once."""
    from drivesizer.spec.several_axes.any_spec import read_any
    from drivesizer.spec.several_axes.machine import MachineSpec

    def sized() -> Any:
        spec = read_any(YamlSource(text, held.name))
        if isinstance(spec, MachineSpec):
            from drivesizer.multi_axis.sizing import size_machine

            return size_machine(spec, top=top, brief=brief, progress=held.go_on)
        from drivesizer.sizing import size

        more = (_front(spec), _CHOICES) if front else ((), 0)
        return size(spec, top=top, pareto=more[0], choices=more[1], brief=brief, progress=held.go_on)

    return held.keep(json.dumps([top, front, brief, text]), sized)


def named(text: str, file: str) -> list[Path]:
    """Files that a text may name: each text in it as a path from its folder, whether there is one or not."""
    try:
        data = YamlSource(text, file).data
    except InputError:
        return []
    return [Path(file).parent / name for name in _texts(data)]


def _texts(data: Any) -> Iterator[str]:
    if isinstance(data, dict | list):
        for below in data.values() if isinstance(data, dict) else data:
            yield from _texts(below)
    elif isinstance(data, str):
        yield data


def _front(spec: Any) -> tuple[str, ...]:
    """Objectives of the front; none where each of its drives would be weighed in the whole machine, for minutes."""
    if spec.platform or spec.battery or spec.budget or spec.limits_the_bus:
        return ()
    return FRONT if spec.method == "physics" else tuple(name for name in FRONT if name != "energy")


def faults(error: InputError, name: str) -> list[Piece]:
    """Each line of an error with the place that it names."""
    return [{"said": line.replace(name, Path(name).name), **_fault(line, name)} for line in error.lines]


def _fault(text: str, name: str) -> Piece:
    found = re.match(rf"{re.escape(name)}:(\d+): (?:([^\s:]+): )?(.*)", text, re.DOTALL)
    if not found:
        return {"text": text.removeprefix(f"{name}: "), "line": None, "path": []}
    line, field, said = found.groups()
    return {"text": said, "line": int(line), "path": _path(field or "")}


def _path(field: str) -> list[str | int]:
    """Path of a field as messages print it: ``transmission[2].ratio``."""
    steps = re.findall(r"\[(\d+)\]|([^.\[\]]+)", field)
    return [int(number) - 1 if number else key for number, key in steps]
