"""Messages on a spec, a line each: field, found, expected; unknown keys; what contradicts another section."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from drivesizer.errors import InputError, quoted
from drivesizer.files import fields
from drivesizer.files.yaml_source import Path_, YamlSource, shipped_data, value_at
from drivesizer.loads import MODULES
from drivesizer.loads.motions import Track, Waypoints
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.spec.drive import DIRECT, DirectStage, GearheadStage
from drivesizer.spec.sections import FREE, Lives, open_figures
from drivesizer.units import KINDS, noun

# -- Keys of a spec: those that are known at a place, and which one an unknown key stands for.


_FEW = 3  # places of a key that are named


def meant(model: type[BaseModel], path: Path_, data: Any) -> str:
    """Return what an unknown key stands for."""
    key = str(path[-1])
    if re.match(r"[0-9]", key):
        return "a comma ends a field between { and }; a number has a decimal point, e.g. 3.6 km/h"
    known, others = known_keys(model, path[:-1], data), shipped_data("drivesizer.spec", "other_words.yaml").get(key, [])
    named = next((word for word in others if word in known), None)
    if named:
        return f"did you mean {quoted(named)}?"
    kinds = (_other_kind(model, path, word) for word in (key, *others))
    if hint := next(filter(None, kinds), "") or _other_group(model, [key, *others]):
        return hint
    close = difflib.get_close_matches(key, known, 1, 0.5)
    return f"did you mean {quoted(close[0])}?" if close else f"expected one of {', '.join(known)}"


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


def _other_group(model: type[BaseModel], words: list[str]) -> str:
    """The groups of the file that have a key, or what it is called there; empty where none has it, or too many."""
    places = [
        f"{group}.{word}"
        for word in words
        for group, field in model.model_fields.items()
        if any(word in section.model_fields for section in models_of(field))
    ]
    return f"expected {' or '.join(places)}" if 0 < len(places) <= _FEW else ""


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
            models = [owner for f in fields for owner in models_of(f)]
            by_name = any(get_origin(part) is dict for f in fields for part in _parts_of(f))
        elif isinstance(step, str):
            by_name = False
        group = data if isinstance(data, dict) else {}
        models = [m for m in models if _is_named(m, group)] or models
    return models, by_name


def _is_named(model: type[BaseModel], data: dict[str, Any]) -> bool:
    """Whether the field that selects a model, kind or profile, names this one."""
    named = {key: model.model_fields[key] for key in ("kind", "profile") if key in model.model_fields}
    return any(data.get(key, field.default) in get_args(field.annotation) for key, field in named.items())


def models_of(field: FieldInfo) -> list[type[BaseModel]]:
    """Models that a field is of, or may be, by its type or by what marks it."""
    return [part for part in _parts_of(field) if isinstance(part, type) and issubclass(part, BaseModel)]


def _parts_of(field: FieldInfo) -> Iterator[Any]:
    """All that the type of a field is made of."""
    waiting = [field.annotation, *field.metadata]
    for part in waiting:
        yield part
        waiting += get_args(part)


# -- Validation errors of a spec, a line each: ``file:line: field: found; expected, example``.


# beginnings of validators' messages that state what was found
_ALONE = (
    '"', "is empty", "a list", "give", "expected", "transmission", "platform", "inner", "sinkage", "ki", "motion",
    "a recorded", "the paper",
)  # fmt: skip


_MOST = 5  # faults that are reported at once


def explained(
    error: ValidationError, source: YamlSource, model: type[BaseModel], data: Any = None, at: Path_ = ()
) -> InputError:
    """The error that a user reads: the first fault in the file as its message, up to five as its lines."""
    data = source.data if data is None else data
    for path, text in open_figures(source.data):
        state = "is free" if FREE in text else "is an expression"
        return InputError(f"{source.where(path)}: {state}; `drivesizer design` fills in what is open")
    faults = [(_path(dict(fault), data), dict(fault)) for fault in error.errors(include_url=False)]
    # A misspelt key also leaves the right one missing: the misspelling is reported.
    unknown = {path[:-1] for path, fault in faults if fault["type"] == "extra_forbidden"}
    faults = [(path, fault) for path, fault in faults if fault["type"] != "missing" or path[:-1] not in unknown]
    # A word where words or a list may stand is no list, either: that it is not known is said.
    words = {path for path, fault in faults if fault["type"] == "literal_error"}
    faults = [(path, fault) for path, fault in faults if fault["type"] != "list_type" or path not in words]
    # Without a known kind of load it is not known whether it turns: units of the motion are not judged.
    if any(path == ("load", "kind") or (path, fault["type"]) == (("load",), "union_tag_not_found")
           for path, fault in faults):  # fmt: skip
        faults = [(path, fault) for path, fault in faults if path[:1] != ("motion",) or fault["type"] != "value_error"]
    faults.sort(key=lambda pair: (pair[1]["type"] != "extra_forbidden", source.line(pair[0]) or 0))
    lines = []
    for path, fault in faults:
        in_part = at and path and path[0] in value_at(source.data, at)
        where = source.where(at + path if in_part else path)
        lines.append(f"{where}: {_message(fault, path, data, model)}")
    lines = list(dict.fromkeys(lines))
    listed = [*lines[: _MOST - 1], lines[_MOST - 1] + _more(lines, _MOST)] if len(lines) >= _MOST else lines
    return InputError(lines[0] + _more(lines, 1), listed)


def _more(lines: list[str], count: int) -> str:
    """The number of faults that are not shown.

    >>> _more(["a", "b", "c"], 1), _more(["a"], 1)
    (' (and 2 more)', '')
    """
    return f" (and {len(lines) - count} more)" if len(lines) > count else ""


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
        text = str(fault["ctx"]["error"])
        path += _named(text.partition(":")[0], data) or _named(text.partition(" ")[0], data)
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


# type of a fault: message, with what was found and the figures of the rule
_MESSAGES = dict.fromkeys(("int_type", "int_from_float"), "{found} is not a whole number; expected one, e.g. 2") | {
    "bool_type": "{found} is neither true nor false; expected one of both",
    "bool_parsing": "{found} is neither true nor false; expected one of both",
    "list_type": "{found} is not a list; expected entries between [ and ]{default}",
    "greater_than_equal": "{found} must be at least {ge}", "less_than_equal": "{found} must be at most {le}",
    "too_short": "{found} is too short; expected at least {min_length}{default}",
    "too_long": "{found} is too long; expected at most {max_length} entries",
    "none_required": "{found} is no part with figures of its own, {{name: ..., ...}}; expected one, or select.motor, "
    "which chooses actuators of the catalogues too, e.g. motor: {{part: XM430-W350}}",
    "string_too_short": "is empty; expected text",
    "string_too_long": "{found} is too long; expected at most {max_length} characters",
}  # fmt: skip


def _message(fault: dict[str, Any], path: Path_, data: Any, model: type[BaseModel]) -> str:
    value, rule = quoted(_brief(fault.get("input"))), fault.get("ctx", {})
    owners = models_at(model, path[:-1], data) if path else []
    field = next((m.model_fields[str(path[-1])] for m in owners if path[-1] in m.model_fields), None)
    if fault["type"] in _MESSAGES:
        example = field.default if field and isinstance(field.default, list) and field.default else None
        default = f", e.g. {str(example).replace(chr(39), '')}" if example else ""
        return _MESSAGES[fault["type"]].format(found=value, default=default, **rule)
    match fault["type"]:
        case "missing":
            return f"is missing; expected {_expected(field)}"
        case "string_type" if fault["input"] is None:
            return "is empty; expected text"
        case "string_type":
            grouped = isinstance(fault["input"], dict | list)
            return f"{value} is not text; {'expected text' if grouped else 'put it in quotes'}"
        case "extra_forbidden":
            return f"unknown key; {meant(model, path, data)}"
        case "value_error":
            return _validator_text(_with_own_example(str(rule["error"]), field), fault["input"], path)
        case "literal_error":
            return _not_known(fault.get("input"), rule["expected"])
        case "union_tag_invalid":
            return _not_known(rule["tag"], rule["expected_tags"])
        case "union_tag_not_found":
            key = rule["discriminator"].strip("'")
            kinds = dict.fromkeys(str(kind) for owner in models_at(model, path, data) if key in owner.model_fields
                                  for kind in get_args(owner.model_fields[key].annotation))  # fmt: skip
            return f"{key} is missing; expected {key}: {' or '.join(kinds)}"
        case "model_type" | "model_attributes_type" | "dict_type":
            keys = ", ".join(known_keys(model, path, None)[:4])
            return f"{value} is not a group of fields; expected fields such as {keys}"
        case _:
            text = fault["msg"][0].lower() + fault["msg"][1:]
            return f"{value}: {text.replace('input ', '')}"


def _validator_text(text: str, value: Any, path: Path_) -> str:
    """Words of a validator: of a field with what was found there, of several fields, whose names it has, as it is."""
    own = text.removeprefix(f"{'.'.join(map(str, path))}: ")
    if own != text:
        return own
    if isinstance(value, dict) and value:
        of = value.get(path[-1]) if path and text.startswith(f"{path[-1]} ") else None
        return text if of is None or isinstance(of, list | dict) else f"{quoted(of)}: {text}"
    return text if text.startswith(_ALONE) else f"{quoted(_brief(value))} {text}"


def _not_known(word: Any, expected: str) -> str:
    """A word that is none of those that are expected, and the nearest of them.

    >>> _not_known("vehicle", "'wheeled_vehicle'")
    '"vehicle" is not known; the nearest is wheeled_vehicle; expected \\'wheeled_vehicle\\''
    """
    near = difflib.get_close_matches(str(word).lower(), re.findall(r"'([^']+)'", expected), 1, 0.6)
    hint = f"; the nearest is {near[0]}" if near and len(str(word)) > len("car") else ""
    return f"{quoted(_brief(word))} is not known{hint}; expected {expected}"


def _brief(value: Any) -> Any:
    if isinstance(value, dict):
        return "{" + ", ".join(value) + "}"
    if isinstance(value, list):
        return f"a list of {len(value)}" if value else "an empty list"
    return "nothing" if value is None else value


def _expected(field: FieldInfo | None) -> str:
    """Words for what a missing field takes, with an example."""
    if field is None:
        return "a value"
    if inner := models_of(field):
        return f"fields such as {', '.join(list(inner[0].model_fields)[:4])}"
    if get_origin(field.annotation) is Literal:
        return " or ".join(map(str, get_args(field.annotation)))
    quantity = _quantity_of(field)
    if quantity is None:
        return field.description or "a value"
    return f"{noun(quantity.kind)}, e.g. {_example_of(field, quantity)}"


def _quantity_of(field: FieldInfo) -> fields.Quantity | None:
    return next((part for part in _parts_of(field) if isinstance(part, fields.Quantity)), None)


def _example_of(field: FieldInfo, quantity: fields.Quantity) -> str:
    """The field's own example or default, else one of its kind of quantity."""
    default = field.default if isinstance(field.default, str) and not field.default.startswith("0 ") else ""
    return str(field.examples[0] if field.examples else default or KINDS[quantity.kind].example)


def _with_own_example(text: str, field: FieldInfo | None) -> str:
    """Words of the reader of a quantity, with the field's example in place of that of the kind."""
    quantity = _quantity_of(field) if field else None
    if field is None or quantity is None:
        return text
    return text.replace(f"e.g. {KINDS[quantity.kind].example}", f"e.g. {_example_of(field, quantity)}")


# -- Sections of a spec that contradict each other: what is refused where each of them by itself is right.


PAPER_TREATS = (
    "the paper treats a wheeled_vehicle without wind on a trapezoid that decelerates as it accelerates, in one case"
)

_MOST_SHARED = 0.999  # of the time, that load cases may take of the machine as specified


def contradictions(spec: Any) -> Iterator[str]:
    """Faults of sections of a ``RobotSpec`` together, each with the name of the field."""
    for rules in (
        _chained, _motion, _motor_kind_conflicts, _wheel_conflicts, _burning, _overhung, _lasting, _equipped,
        _alternating, _paid,
    ):  # fmt: skip
        yield from rules(spec)


def _chained(spec: Any) -> Iterator[str]:
    """Stages behind each other as machines have them; a gear where what is behind it knows of it."""
    kinds = [stage.kind for stage in spec.transmission]
    behind = ["belt" if kind == "belt" else "gear" for kind in kinds[1:]]
    groups = [kind for n, kind in enumerate(behind) if n == 0 or behind[n - 1] != kind or kind == "belt"]
    if (
        not isinstance(spec.transmission[0], GearheadStage | DirectStage)
        or len(set(groups)) != len(groups)
        or ({"gearhead", DIRECT} & set(kinds[1:]))
    ):
        yield "transmission must be a gearhead or direct, or one of them and then a belt, gears in a row, or both"
    gear, belt = spec.gear, spec.belt
    if gear is not None and spec.platform is not None:
        yield f"transmission: a {gear.kind} drives no wheel of a platform; expected a gearhead or belt"
    if gear is not None and spec.gear_before_belt and belt is not None:
        own = any(
            (stage.pinion_inertia, stage.wheel_inertia, stage.pinion_friction, stage.wheel_friction) != (0.0,) * 4
            for stage in spec.gears
        )
        if own and belt.ratio is None:
            yield (
                f"transmission: inertia and friction of a {gear.kind} before a belt need the one ratio of the belt; "
                "expected ratio, or the belt before it"
            )
        if belt.pulleys is not None and (belt.max_tension or belt.max_speed):
            yield (
                f"transmission: max_tension and max_speed of pulleys behind a {gear.kind} are not checked; expected "
                "the belt before it, or ratio with pulley_diameter"
            )
    named = spec.select.gearhead.named.values()
    if spec.is_direct and {name for names in named for name in names} - {DIRECT}:
        yield f"select: with kind: {DIRECT} as transmission there is none; leave gearhead out"


def _motion(spec: Any) -> Iterator[str]:
    """A mounting where heat is computed, and a motion that the load takes."""
    if spec.mounting is not None and spec.steps:
        yield "mounting: the heat of steppers is not computed; leave it out"
    if spec.mounting is not None and spec.method == "paper":
        yield "mounting: the paper's method knows no heat; leave it out, or method: physics"
    recorded = spec.load.kind == "recorded"
    if recorded and spec.motion is not None:
        yield "motion: a recorded load brings its own motion; leave this one out"
    if not recorded and spec.motion is None:
        yield "motion is missing; expected fields such as speed, acceleration_time, cruise_time"
    if spec.carries and (spec.platform is not None or not spec.load.takes_payload):
        what = "platform" if spec.platform else spec.load.kind
        yield f"motion: a {what} takes no payload that changes; expected load cases"


def _motor_kind_conflicts(spec: Any) -> Iterator[str]:
    """Fields of steppers and of the paper's method where they are."""
    if spec.needs.start_speed is not None and not spec.steps:
        yield "needs.start_speed: it is of steppers; expected select: {motor: {kind: stepper}}"
    own = {"microsteps", "phase_current", "idle_current", "damping_ratio"} & spec.control.model_fields_set
    if own and not spec.steps:
        yield f"control.{min(own)}: it is of steppers; expected select: {{motor: {{kind: stepper}}}}"
    if foreign := spec.tolerances.foreign(steps=spec.steps):
        yield foreign
    if spec.method == "paper" and spec.steps:
        yield "method: the paper treats DC motors, no steppers; expected method: physics"
    if spec.method == "paper" and not spec.paper_applies:
        yield f"method: {PAPER_TREATS}; expected method: physics"


def _wheel_conflicts(spec: Any) -> Iterator[str]:
    """A platform on the wheels of its load."""
    if spec.platform is None:
        if isinstance(spec.motion, Track | Waypoints):
            yield "motion: a trajectory moves a platform; expected a section platform with its wheels"
        return
    if not isinstance(spec.load, WheeledVehicle):
        yield "platform: it stands on the wheels of a load of kind wheeled_vehicle; leave it out"
    driven, driven_wheels = sum(place.driven for place in spec.platform.places), spec.load.driven_wheels
    if driven != driven_wheels:
        yield (f"platform: {driven} of its wheels are driven; expected as many as load.driven_wheels, {driven_wheels}")
    if spec.load.driven_share is not None:
        yield "load.driven_share: each wheel's share follows from the platform; leave it out"
    if not sum(payload.mass for payload in spec.platform.payloads) < spec.load.mass:
        yield "platform: expected payloads that leave some of load.mass, which includes them"


def _burning(spec: Any) -> Iterator[str]:
    """A brake resistor that burns what nothing else takes."""
    section = spec.brake_resistor
    if section is None:
        return
    if spec.battery is not None or spec.supply.kind == "battery":
        yield "brake_resistor: the battery takes what is regenerated; leave one of them out"
    if section.chopper_voltage is not None and section.chopper_voltage <= spec.supply.nominal:
        yield (
            f"brake_resistor: a chopper at {section.chopper_voltage:g} V burns what the supply delivers; "
            f"expected chopper_voltage above nominal, {spec.supply.nominal:g} V"
        )


def _overhung(spec: Any) -> Iterator[str]:
    """A shaft on which something acts."""
    shaft, stages, needs = spec.shaft, spec.transmission, spec.needs
    if shaft is None:
        return
    carries = shaft.carries_load
    if carries and len(stages) > 1:
        yield f"shaft.carries_load: the {stages[1].kind} is on this shaft, not the load; leave it out"
    if carries and not spec.load.loads_shaft:
        yield (f"shaft.carries_load: a {spec.load.kind} has no known force on its shaft; expected needs.radial_load")
    if carries and spec.platform is not None and shaft.wheel_load is None:
        yield "shaft: expected wheel_load, for loads on the wheels of a platform differ"
    if not carries and len(stages) == 1 and needs.radial_load is needs.axial_load is needs.tilting_moment is None:
        yield "shaft: nothing acts on it; expected carries_load, a belt or gear, or needs.radial_load"


def _lasting(spec: Any) -> Iterator[str]:
    """Lives of what there is."""
    lives, load = spec.needs.life, spec.load
    if not isinstance(lives, Lives):
        return
    if lives.screw is not None and MODULES[load.kind] != "screw":
        yield f"needs.life.screw: a {load.kind} has no screw; leave it out"
    if lives.screw is not None and getattr(load, "screw", None) is getattr(load, "dynamic_load", None) is None:
        yield "needs.life.screw: it follows from a ball screw's rating; expected load.dynamic_load"
    if spec.is_direct and (lives.gearhead or lives.output_bearing) is not None:
        yield f"needs.life: with kind: {DIRECT} as transmission there is no gearhead; leave it out"
    if lives.output_bearing is not None and spec.shaft is None:
        yield "needs.life.output_bearing: nothing is known to load it; expected a section shaft"


def _equipped(spec: Any) -> Iterator[str]:
    """Equipment on a battery; one brake, and one that closes at rest where there is one; a distance of what travels."""
    if spec.equipment and spec.battery is None:
        yield "equipment: it draws from a battery; expected a section battery"
    for consumer in spec.equipment:
        try:
            consumer.share(spec.mission.duration if spec.mission else None)
        except ValueError as error:
            yield f"equipment: {error}"
    legs = spec.mission.legs if spec.mission else ()
    if any(leg.charges for leg in legs) and (spec.battery is None or spec.battery.charger is None):
        yield "mission.legs: one charges; expected battery: {charger: {current: 10 A}}"
    if spec.control.at_rest == "brake" and not spec.wants_brake:
        yield "control.at_rest: there is no brake; expected needs: {hold_unpowered: true}, or a brake"
    if spec.brake and spec.select.brake.named:
        yield "brake: it has figures of its own; expected brake or select.brake, not both"
    if spec.requirements and spec.requirements.travel and not isinstance(spec.load, WheeledVehicle):
        yield f"requirements.travel: a {spec.load.kind} does not travel; leave it out, or give speed"


def _paid(spec: Any) -> Iterator[str]:
    """Limits of price in one currency, in which prices are compared then."""
    currencies = [limit.currency for limit in spec.price_limits]
    if len(set(currencies)) > 1:
        yield f"needs.price, budget.price, brake.price: found {' and '.join(currencies)}; expected one currency"


def _alternating(spec: Any) -> Iterator[str]:
    """Load cases that share the time."""
    shares = [case.share for case in spec.cases if case.share is not None]
    if not shares:
        return
    if sum(shares) > _MOST_SHARED:
        yield f"cases: their shares are {100.0 * sum(shares):g} % together; expected less than 100 %"
    motions = [motion for case in spec.cases if case.share is not None for motion in case.motion]
    if isinstance(spec.motion, Track | Waypoints) or {"trajectory", "waypoints"} & {*motions}:
        yield "cases: wheels of a platform on a trajectory do not alternate; leave share out"
