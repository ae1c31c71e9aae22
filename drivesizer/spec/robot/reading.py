"""A robot.yaml, or the same fields as a dict, to a ``RobotSpec`` with its load cases and tolerances."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from copy import deepcopy
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from drivesizer.errors import InputError, quoted
from drivesizer.files.read_before import left_out_before, read_before
from drivesizer.files.yaml_source import Path_, YamlSource, read, written
from drivesizer.loads.kinds import AXES
from drivesizer.spec.messages import explained
from drivesizer.spec.robot.model import RobotSpec
from drivesizer.spec.tolerance_text import Toleranced, split_tolerances

__all__ = ["load_spec", "read_spec"]

_SHAPING = ("load", "motion", "transmission", "platform", "cases")  # the load cycles
_VARIED = ("load", "motion", "supply", "environment", "platform")


def read_spec(source: YamlSource, before: RobotSpec | None = None) -> RobotSpec:
    """A spec from YAML source.

    Parameters
    ----------
    source
        The file.
    before
        A spec of the same file with other values in some fields: sections whose data are the very same are not read
        again.

    Returns
    -------
    RobotSpec
        The spec, checked as a whole whatever was read before.

    Raises
    ------
    InputError
        One line with file, line, field, what was found and what is expected.
    """
    if not isinstance(source.data, dict):
        raise InputError(f"{source.name}: expected fields such as name, load, motion; see `drivesizer init`")
    data, toleranced = split_tolerances(source, None if before is None or before._toleranced else before._source)
    spec = _read(source, data, before)
    spec._toleranced = toleranced
    shaping = next((one for one in toleranced if spec.shift and one.path[0] in _SHAPING), None)
    if shaping is not None:
        text = "cases that alternate by their shares are at nominal figures; expected it without a tolerance"
        raise InputError(f"{source.where(shaping.path)}: {text}")
    for one in toleranced:  # both ends must be values that the field may have
        for end, value in (("lowest", one.distribution.low), ("highest", one.distribution.high)):
            _reached(source, data, one, end, value)
    spec._toleranced = tuple(one.as_angle() if _is_grade(spec, one) else one for one in toleranced)
    return spec


def _is_grade(spec: RobotSpec, one: Toleranced) -> bool:
    """Whether a figure in per cent became the angle of a slope."""
    if one.unit != "%":
        return False
    of_case = one.path[0] == "cases"
    place: Any = spec._cases[int(one.path[1])][1] if of_case else spec
    for step in one.path[2:] if of_case else one.path:
        place = getattr(place, step) if isinstance(step, str) and not isinstance(place, dict) else place[step]
    return bool(place == math.atan(one.value) != one.value)


def _read(source: YamlSource, data: dict[str, Any], before: RobotSpec | None = None) -> RobotSpec:
    spec = _validated(source, data, before=before)
    spec._cases = tuple((case.name, _case(source, data, number)) for number, case in enumerate(spec.cases))
    return spec


def _reached(source: YamlSource, data: dict[str, Any], one: Toleranced, end: str, value: float) -> None:
    """Refuse a tolerance with an end outside the range of the field."""
    changed = deepcopy(data)
    place: Any = changed
    for step in one.path[:-1]:
        place = place[step]
    place[one.path[-1]] = one.as_text(value)
    try:
        _read(source, changed)
    except InputError as error:
        reason = re.sub(r'^\S+:\d+: (\S+: )?("[^"]*" )?', "", str(error))
        text = f"{quoted(one.text)} is {one.shown(value)} at its {end}: {reason}"
        raise InputError(f"{source.where(one.path)}: {text}") from None


def _validated(source: YamlSource, data: dict[str, Any], at: Path_ = (), before: RobotSpec | None = None) -> RobotSpec:
    axis = _axis(data)
    known = {**data, **_unchanged(data, axis, before)}
    try:
        spec = RobotSpec.model_validate(known, context={"axis": axis})
    except ValidationError as error:
        if before is not None:
            return _validated(source, data, at)  # whose message has what the user wrote
        raise explained(error, source, RobotSpec, data, at) from None
    spec.model_fields_set.difference_update(known.keys() - data.keys())
    spec._source = source
    return spec


def _unchanged(data: dict[str, Any], axis: str, before: RobotSpec | None) -> dict[str, Any]:
    """Sections of a spec that was read before where their data are the very same, or both leave them out."""
    source = None if before is None else before._source
    if before is None or source is None or _axis(source.data) != axis:
        return {}
    return {**left_out_before(data, source.data, before), **read_before(data, source.data, before)}


def _axis(data: Mapping[str, Any]) -> str:
    """Whether the load turns or travels, which decides in which units its motion is given."""
    kind = data["load"].get("kind") if isinstance(data.get("load"), dict) else None
    return AXES.get(str(kind), "linear")


def _case(source: YamlSource, whole: dict[str, Any], number: int) -> RobotSpec:
    """The spec changed by one of its cases, validated as a spec of its own."""
    case, data = whole["cases"][number], deepcopy(whole)
    del data["cases"]
    for section in _VARIED:
        if section in case:
            another = "kind" in case[section] or "profile" in case[section]  # another load or motion altogether
            data[section] = {**({} if another else data.get(section) or {}), **case[section]}
    return _validated(source, data, ("cases", number))


def load_spec(given: str | Path | Mapping[str, Any]) -> RobotSpec:
    """A spec from a file, or from the same fields as a dict.

    Parameters
    ----------
    given
        Path of the file, or fields: texts with units, numbers, lists and dicts, as a file has them.

    Returns
    -------
    RobotSpec
        The spec; paths in a dict count from the current folder.

    Raises
    ------
    InputError
        When the file cannot be read or something in it is wrong: one line with place and reason.

    Examples
    --------
    >>> spec = load_spec({
    ...     "name": "turntable",
    ...     "load": {"kind": "flywheel", "inertia": "0.2 kg*m^2"},
    ...     "motion": {"speed": "60 rpm", "acceleration_time": "1 s", "cruise_time": "5 s"},
    ...     "supply": {"nominal": "24 V", "current": "10 A"},
    ... })
    >>> round(spec.motion.speed, 3)
    6.283
    """
    return read_spec(written(given) if isinstance(given, Mapping) else read(Path(given)))
