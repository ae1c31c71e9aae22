"""The catalogue figures that each check rests on: those that are unknown, and those that are not quoted.

``results.check_kinds`` declares them; here its words in capitals become the figures of a drive's
motor. ``rests_on`` names every figure whose lack would leave a check of the drive unknown or change it; a test takes
them away one by one and looks.
"""

from __future__ import annotations

from math import isnan
from typing import Any

from drivesizer.catalog import Catalog, columns_of
from drivesizer.catalog.tables import ESTIMATED
from drivesizer.catalog.view.search_view import printed_field
from drivesizer.results.check import sentence_case
from drivesizer.results.check_kinds import CHECKS, EMF
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import Check
from drivesizer.units import show

__all__ = ["figure_words", "marked_figures", "missing_figures", "rests_on", "unknown_figures"]

_DERATING = ("full_current_ambient", "derating_slope", "ambient_max")
_MODEL = ("holding_torque", "nominal_current", "resistance", "inductance", "pole_pairs", "pull_out_share")
_GEAR = ("gearhead.ratio", "gearhead.efficiency", "gearhead.inertia", "motor.rotor_inertia", "motor.torque_constant")


def rests_on(check: Check, drive_set: DriveSet) -> tuple[str, ...]:
    """The figures that a check of a drive rests on, such as ``motor.resistance``; none for what has none."""
    found: list[str] = []
    for name in CHECKS[check.method][check.name].rests_on:
        found += _figures_of_word(name, drive_set) if name.isupper() else [name]
    return tuple(dict.fromkeys(found))


def _figures_of_word(word: str, drive_set: DriveSet) -> list[str]:
    motor, gearhead, encoder = drive_set.motor, drive_set.gearhead, drive_set.encoder
    if word == "COUNTS":
        absolute = encoder is not None and isnan(encoder.counts_per_turn)
        return ["encoder.steps_per_turn" if absolute else "encoder.counts_per_turn"]
    if word == "LEVER":  # of a radial load, where the limit has a distance
        return [] if isnan(gearhead.max_radial_load) else ["gearhead.radial_load_distance"]
    if word == "DERATING":
        return ["motor.max_winding_temperature"]
    if word == "CONTROLLER_DERATING":
        controller = drive_set.controller
        known = controller is not None and not isnan(controller.full_current_ambient)
        return [f"controller.{name}" for name in _DERATING] if known else []
    if word == "PULL_OUT":
        return [f"motor.{name}" for name in _MODEL]
    if motor.kind == "stepper":  # whose current is the rated one, whatever the load
        return ["motor.nominal_current"]
    if word == "HOUSING":
        iron = ["motor.max_winding_temperature", "motor.nominal_current", "motor.nominal_speed"]
        return [] if motor.kind == "brushed" else iron
    rubbing = [f"motor.{name}" for name in ("friction_torque", "viscous_friction") if not isnan(getattr(motor, name))]
    if len(rubbing) < 2:  # the rest is what the no-load current leaves
        by_speed = bool(rubbing) or motor.kind != "brushed"
        rubbing += ["motor.no_load_current", *(["motor.no_load_speed"] if by_speed else [])]
    idle = [] if isnan(gearhead.no_load_torque) else ["gearhead.no_load_torque", "gearhead.continuous_torque"]
    own = ["encoder.inertia"] if encoder and not isnan(encoder.inertia) else []
    return [*_GEAR, *rubbing, *idle, *own]


def unknown_figures(drive_set: DriveSet) -> list[list[str]]:
    """For each unknown check its title, and which figures are not known."""
    return [
        [check.title, ", ".join(_lacking(check, drive_set)) or _stated(check)]
        for check in _reported(drive_set)
        if check.status == "unknown"
    ]


def _reported(drive_set: DriveSet) -> tuple[Check, ...]:
    """Checks that a report prints: those of the method that ranked, and by physics too where that is the paper's."""
    by_paper = any(check.method == "paper" for check in drive_set.checks)
    return drive_set.every_check if by_paper else drive_set.own_checks


def _lacking(check: Check, drive_set: DriveSet) -> list[str]:
    """The parts, or figures of parts, that a check lacks."""
    if check.name.startswith(("resistor_", "chopper_")) and isnan(check.limit) and not isnan(check.demand):
        return [sentence_case(check.title)]  # the limit is the resistor's own figure
    lacking = []
    for name in rests_on(check, drive_set):
        role, _, field = name.partition(".")
        part = getattr(drive_set, role)
        if part is None:
            lacking.append(f"any {role}")
        elif name not in EMF and _is_unknown(getattr(part, field)):
            lacking.append(figure_words(role, field, bool(part.inside)))
    return list(dict.fromkeys(lacking))


def figure_words(role: str, field: str, inside: bool = False) -> str:
    """A figure in words; of a part inside an actuator the one that is printed of that."""
    if inside:
        role, field = "actuator", printed_field(role, field)
    return f"{role} {field.removeprefix(f'{role}_').replace('_', ' ')}"


def missing_figures(drive_set: DriveSet) -> list[str]:
    """The parts, and figures of parts, that the unknown checks of a drive lack, each once."""
    unknown = (check for check in drive_set.deciding if check.status == "unknown")
    return list(dict.fromkeys(name for check in unknown for name in _lacking(check, drive_set)))


def _is_unknown(value: Any) -> bool:
    return isinstance(value, float) and isnan(value)


def _stated(check: Check) -> str:
    """The missing figures that the note of a check names, such as masses of parts; else where they belong."""
    if check.name == "brake_fits":
        return "a source that lists it with this motor"
    return check.note.removeprefix("unknown: ") if check.note.startswith("unknown: ") else _OF_THE_SPEC


_OF_THE_SPEC = "a figure of the load or of the spec"


def marked_figures(drive_set: DriveSet, catalog: Catalog) -> list[list[str]]:
    """Figures that are only derived or recalled and that a check rests on: their values, confidences and checks."""
    resting: dict[str, list[str]] = {}
    for check in _reported(drive_set):
        for name in rests_on(check, drive_set):
            resting.setdefault(name, []).append(check.title)
    found = []
    for name, titles in resting.items():
        role, _, field = name.partition(".")
        part, section = getattr(drive_set, role), f"{role}s"
        table = catalog.table(section)
        if part is None or part.part not in table.rows:
            continue
        mark = catalog.confidence(section, table.rows[part.part]).get(field, "")
        if mark in ("derived", "recalled", ESTIMATED):
            column = columns_of(section)[field]
            value = show(getattr(part, field), column.unit, column.kind, 3 if mark == ESTIMATED else 6)
            found.append([figure_words(role, field), value, mark, "; ".join(dict.fromkeys(titles))])
    return found
