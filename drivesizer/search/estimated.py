"""Estimated figures of one drive: which they are, and which of its open checks depend on them."""

from __future__ import annotations

from dataclasses import replace
from math import nan

import numpy as np

from drivesizer.catalog import Catalog, columns_of
from drivesizer.catalog.estimates.estimate import law_text, shipped_laws
from drivesizer.catalog.view.stepper_view import has_steppers
from drivesizer.physics.power_stage import ASSUMED_BAND, ASSUMED_LOSS
from drivesizer.results.check import Check
from drivesizer.results.estimated import EstimatedFigure
from drivesizer.results.losses import voltage_assumption
from drivesizer.search.columns.evaluation import Evaluation
from drivesizer.search.order.open_checks import Turn, passing, turns
from drivesizer.units import show

__all__ = ["estimated", "resolved_checks"]

_PART = {
    "motors": "motor",
    "gearheads": "gearhead",
    "encoders": "encoder",
    "controllers": "controller",
    "actuators": "actuator",
    "brakes": "brake",
}
_CONTROLLING = ("encoders", "controllers")  # their masses count in the budget of a machine alone


def estimated(evaluation: Evaluation, index: int) -> tuple[EstimatedFigure, ...]:
    """Figures of a drive's parts that are estimated."""
    catalog, candidates = evaluation.catalog, evaluation.candidates
    motor, gearhead = int(candidates.motor[index]), int(candidates.gearhead[index])
    loss = _stage_loss(evaluation, index)
    if not catalog.ends:
        return loss
    inside = str(catalog.motors["inside"][motor])
    own = {"motors": motor, "gearheads": gearhead}
    places = {"actuators": catalog.actuators.rows[inside]} if inside else own
    chosen = zip(_CONTROLLING, (evaluation.encoder, evaluation.controller), strict=True)
    rows_of = {section: int(rows[index]) for section, rows in chosen if rows[index] >= 0}
    places |= {section: row for section, row in rows_of.items() if not catalog.table(section)["inside"][row]}
    found = [(section, one) for section, row in places.items() for one in _part_bands(catalog, section, row)]
    weighed = evaluation.spec.budget is not None and evaluation.spec.budget.weighs
    if (brake := int(evaluation.brake[index])) >= 0:
        found += [("brakes", one) for one in _part_bands(catalog, "brakes", brake)]
    weighing = (one for section, one in found if weighed or section not in _CONTROLLING or one.figure != "mass")
    return (*weighing, *loss)


def _stage_loss(evaluation: Evaluation, index: int) -> tuple[EstimatedFigure, ...]:
    """The loss of a controller of which none is printed, with its band."""
    row = int(evaluation.controller[index])
    controller = evaluation.catalog.controllers.record(row) if row >= 0 else None
    steps = has_steppers(evaluation.catalog)  # of a stepper's driver no loss is counted
    if steps or not evaluation.spec.feed_of(controller).stage.assumed:
        return ()
    low, high = (ASSUMED_LOSS * share for share in ASSUMED_BAND)
    law = "assumed: of drops and efficiencies that makers print, and one measured bridge"
    return (EstimatedFigure("controller", "loss_voltage", ASSUMED_LOSS, low, high, "voltage", "V", law),)


def _part_bands(catalog: Catalog, section: str, row: int) -> list[EstimatedFigure]:
    names = catalog.estimates.get(section, {})
    found = {name: one for name in names if (one := catalog.estimate_of(section, row, name)) is not None}
    columns = columns_of(section)
    return [
        EstimatedFigure(
            _PART[section], name, *one[:3], columns[name].kind, columns[name].unit, law_text(shipped_laws()[one.fit])
        )
        for name, one in found.items()
    ]


def resolved_checks(evaluation: Evaluation, index: int) -> tuple[tuple[Check, ...], float]:
    """The checks of a drive, its open ones with the value at which they turn and how probable it is that they pass."""
    checks = tuple(_with_assumption(evaluation, index, check) for check in evaluation.checks_of(index))
    names = evaluation.open_checks(index)
    if not names or evaluation.spec.method != "physics":
        return checks, nan
    controller, brake = evaluation.controller[[index]], evaluation.brake[[index]]
    one = evaluation.candidates.on(np.array([index]))._replace(controller=controller, brake=brake)
    probable, turning = passing(evaluation.problem, one, names), turns(evaluation.problem, one, names)
    own = bool(evaluation.catalog.motors["inside"][evaluation.candidates.motor[index]])
    open_ = {name: (probable[name], _turning(turning.get(name), own)) for name in names}
    return tuple(
        _with_probability(check, *open_[check.name]) if check.name in names else check for check in checks
    ), probable[""]


def _with_assumption(evaluation: Evaluation, index: int, check: Check) -> Check:
    """A check, that of the voltage with what is assumed of the controller's drop."""
    if check.name != "supply_voltage" or check.method != "physics" or has_steppers(evaluation.catalog):
        return check
    row = int(evaluation.controller[index])
    controller = evaluation.catalog.controllers.record(row) if row >= 0 else None
    note = voltage_assumption(evaluation.spec, controller, check.limit)
    return replace(check, note="; ".join(text for text in (check.note, note) if text)) if note else check


def _with_probability(check: Check, probability: float, note: str) -> Check:
    return replace(check, probability=probability, note="; ".join(text for text in (note, check.note) if text))


# figures of an actuator's parts that are the actuator's own at its output, as its maker names them
_OF_ACTUATORS = {
    ("gearheads", "continuous_torque"): "nominal_torque",
    ("gearheads", "intermittent_torque"): "peak_torque",
    ("motors", "nominal_current"): "nominal_current",
}  # fmt: skip


def _turning(turn: Turn | None, actuator: bool) -> str:
    """A sentence on where a check turns."""
    if turn is None:
        return "hangs on several estimated figures together"
    section, name = turn.figure
    column = columns_of(section)[name]
    side = "at most" if turn.passes_below else "at least"
    value = show(turn.value, column.unit, column.kind, 2)
    if actuator and turn.figure in _OF_ACTUATORS:
        figure = _OF_ACTUATORS[turn.figure].replace("_", " ")
        return f"passes with a {figure} of {side} {value}; the maker prints none as a limit"
    return f"passes with a {_PART[section]} {name.replace('_', ' ')} of {side} {value}, which is estimated"
