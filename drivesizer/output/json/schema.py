"""JSON Schema of the JSON report; that of a part is made from the catalogue's columns.

The document of ``drivesizer size --json`` is the same without ``parts_list`` and ``validation``, that of
``drivesizer validate --json`` is what ``validation`` has here, without ``series``.
"""

from __future__ import annotations

from typing import Any

from drivesizer.catalog import PARTS, columns_of
from drivesizer.catalog.tables import CONFIDENCE
from drivesizer.output.json.documents import SCHEMA_VERSION
from drivesizer.units import KINDS

__all__ = ["report_schema"]

_Schema = dict[str, Any]
_NUMBER: _Schema = {"type": ["number", "null"], "description": "null: unknown"}
_TEXT: _Schema = {"type": ["string", "null"]}
_STRING: _Schema = {"type": "string"}
_FLOAT: _Schema = {"type": "number"}
_COUNT: _Schema = {"type": "integer", "minimum": 0}
_STATUS: _Schema = {"enum": ["pass", "fail", "unknown"]}
_WORDS: _Schema = {"type": "array", "items": _STRING}
_OPEN: _Schema = {"type": "object"}


def report_schema() -> _Schema:
    """The JSON Schema of ``drivesizer report -o report.json``."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "drivesizer report",
        **_all_of(
            schema_version={"const": SCHEMA_VERSION}, drivesizer=_STRING, catalogs=_named(_STRING), spec=_OPEN,
            method={"enum": ["paper", "physics"]}, objective=_STRING, requirements=_named(_to("requirement")),
            sets=_list(_to("set")), misses=_list(_to("set")), relaxations=_list(_to("relaxation")),
            pareto=_all_of(objectives=_WORDS, sets=_list(_to("set"))), unrestricted=_or_null(_to("set")),
            unsure=_list(_to("set")), uncertainty=_or_null(_uncertainty()),
            counts=_all_of(considered=_COUNT, feasible=_COUNT, failed_by=_named(_COUNT), judged=_COUNT,
                           failed_by_budget=_named(_COUNT)), assumptions=_WORDS,
            warnings=_WORDS, parts_list=_list(_to("line")), validation=_or_null(_to("validation")),
        ),
        "$defs": _definitions(),
    }  # fmt: skip


def _definitions() -> dict[str, _Schema]:
    return {
        "requirement": _REQUIREMENT,
        "check": _CHECK,
        "relaxation": _RELAXATION,
        "figure": _all_of(**_FIGURE),
        "set": _set(),
        "line": _LINE,
        "loop": _loop(),
        "validation": _validation(),
        **{section: _part(section) for section in PARTS},
    }


def _all_of(**properties: _Schema) -> _Schema:
    """An object that has all of these and nothing else."""
    return {
        "type": "object",
        "properties": properties,
        "required": list(properties),
        "additionalProperties": False,
    }


def _to(name: str) -> _Schema:
    return {"$ref": f"#/$defs/{name}"}


def _list(of: _Schema) -> _Schema:
    return {"type": "array", "items": of}


def _named(of: _Schema) -> _Schema:
    return {"type": "object", "additionalProperties": of}


def _or_null(of: _Schema) -> _Schema:
    return {"anyOf": [of, {"type": "null"}]}


def _part(section: str) -> _Schema:
    """A part: every column of its section, in SI."""
    return _all_of(
        **{
            name: _TEXT
            if column.kind == "text"
            else _NUMBER | {"description": f"{KINDS[column.kind].si}; null: unknown"}
            for name, column in columns_of(section).items()
        }
    )


_REQUIREMENT = _all_of(
    symbol=_STRING, equation={"type": ["integer", "null"]}, value=_NUMBER, unit=_STRING, si=_NUMBER, title=_STRING,
    note=_STRING,
)  # fmt: skip
_CHECK = _all_of(
    name=_STRING, method=_STRING, case=_TEXT, demand=_NUMBER, limit=_NUMBER, unit=_STRING, margin=_NUMBER,
    needed_margin=_FLOAT, status=_STATUS, advice={"type": "boolean"}, at_time_s=_NUMBER,
    note=_STRING,
)  # fmt: skip
_RELAXATION = _all_of(
    field=_STRING, now=_STRING, needed=_STRING, set=_STRING, si_now=_FLOAT, si_needed=_FLOAT, si_unit=_STRING
)
_RESULT = _all_of(
    status=_STATUS, smallest_margin=_NUMBER, tightest_check=_TEXT, failed=_WORDS, unknown=_WORDS
)  # of one method
_FIGURE = {"value": _NUMBER, "unit": _STRING, "si": _NUMBER, "at_time_s": _NUMBER}
_CONFIDENCE = {"enum": [*CONFIDENCE, None]}
_LINE = _all_of(
    role=_STRING, maker=_TEXT, family=_TEXT, part=_TEXT,
    order_number=_TEXT | {"description": "null: the catalogue knows none, `part` is its own name"},
    **{"is": _TEXT}, quantity=_COUNT | {"description": "of the whole machine"}, mass_kg=_NUMBER,
    price=_NUMBER | {"description": "of one, in the currency; null: unknown"}, currency=_TEXT,
    price_from_pieces={"type": ["integer", "null"]}, price_date=_TEXT, price_source=_TEXT,
    price_confidence=_CONFIDENCE, part_source=_TEXT, part_source_date=_TEXT, part_confidence=_CONFIDENCE, url=_TEXT,
    note=_TEXT,
)  # fmt: skip


def _set() -> _Schema:
    pulleys = _all_of(driving=_to("pulleys"), driven=_to("pulleys"))
    belt = _all_of(ratio=_FLOAT, efficiency=_FLOAT, pulleys=_or_null(pulleys), part=_or_null(_to("belts")),
                   centre_distance_m=_NUMBER, teeth_in_mesh=_NUMBER)  # fmt: skip
    return _all_of(
        rank=_COUNT, status=_STATUS, actuator=_or_null(_to("actuators")), motor=_to("motors"),
        gearhead=_to("gearheads"), belt=belt, encoder=_or_null(_to("encoders")),
        controller=_or_null(_to("controllers")), total_ratio=_FLOAT, mass_kg=_NUMBER, mass_of=_WORDS,
        objective=_NUMBER, objective_of=_WORDS, requirements=_named(_to("requirement")),
        figures=_named(_to("figure")), results=_named(_RESULT), checks=_list(_to("check")),
        machine=_list(_all_of(name=_STRING, title=_STRING, **_FIGURE)),
        masses=_list(_all_of(name=_STRING, number=_COUNT, each_kg=_NUMBER, total_kg=_NUMBER)),
        energy=_or_null(_energy()), changes=_list(_to("relaxation")),
        reliability=_or_null(_reliability()),
    )  # fmt: skip


def _energy() -> _Schema:
    consumer = _all_of(name=_STRING, number=_COUNT, mean_W=_NUMBER, peak_W=_NUMBER, share_of_time=_NUMBER,
                       assumed={"type": "boolean"})  # fmt: skip
    return _all_of(battery=_STRING, consumers=_list(consumer), figures=_named(_to("figure")), assumptions=_WORDS)


def _uncertainty() -> _Schema:
    assumption = _all_of(name=_STRING, tolerance=_STRING, source=_STRING)
    return _all_of(samples=_COUNT, seed=_COUNT, confidence=_NUMBER, sets_sampled=_COUNT, sets_that_reach_it=_COUNT,
                   assumptions=_list(assumption), notes=_WORDS)  # fmt: skip


def _reliability() -> _Schema:
    margin = _all_of(p5=_NUMBER, p50=_NUMBER, p95=_NUMBER)
    end = _all_of(value=_STRING, smallest_margin=_NUMBER)
    check = _all_of(name=_STRING, passes=_FLOAT, fails=_FLOAT, weakest=_FLOAT, margin=margin)
    driver = _all_of(name=_STRING, share_of_variance=_FLOAT, rank_correlation=_FLOAT, at_p5=end, at_p95=end)
    loop = _all_of(
        samples=_COUNT, probability=_NUMBER, none_fails=_FLOAT, error_95=_FLOAT, weakest_check=_STRING, unknown=_WORDS
    )
    return _all_of(
        probability=_NUMBER, none_fails=_FLOAT, error_95=_FLOAT, weakest_check=_STRING, unknown=_WORDS,
        smallest_margin=margin,
        checks=_list(check), drivers=_list(driver), closed_loop=_or_null(loop), closed_loop_refused=_or_null(_STRING),
    )  # fmt: skip


def _curve(**columns: _Schema) -> _Schema:
    return _all_of(thinned_from=_COUNT, **columns)


def _loop() -> _Schema:
    numbers = _list(_NUMBER)
    bode = ("frequency_Hz", "open_magnitude", "open_phase_rad", "closed_magnitude", "closed_phase_rad")
    figures = ("period_s", "pole_radius", "gain_margin", "gain_reduction", "phase_margin_rad", "crossover_Hz",
               "sensitivity", "bandwidth_Hz", "rise_time_s", "overshoot", "settling_time_s")  # fmt: skip
    return _all_of(
        name=_STRING, direction=_TEXT, stable={"type": "boolean"}, **dict.fromkeys(figures, _NUMBER),
        poles=_list(numbers | {"minItems": 2, "maxItems": 2}), bode=_curve(**dict.fromkeys(bode, numbers)),
        step=_or_null(_curve(time_s=numbers, response=numbers)),
    )  # fmt: skip


def _validation() -> _Schema:
    gain = _all_of(place=_STRING, name=_STRING, value={"type": "integer"}, unit=_STRING)
    series = _curve(units=_named(_STRING), columns=_named(_list(_NUMBER)))
    return _all_of(
        schema_version={"const": SCHEMA_VERSION}, drivesizer=_STRING, spec=_OPEN, case=_TEXT, profile=_STRING,
        status=_STATUS,
        set=_to("set"), gains=_OPEN, controller_gains=_list(gain), figures=_named(_to("figure")),
        checks=_list(_to("check")), loops=_list(_to("loop")), assumptions=_WORDS, warnings=_WORDS, series=series,
    )  # fmt: skip
