"""Every check there is, as ``checks.txt`` declares it: its title, unit, the part that it concerns, what it rests on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isnan

from drivesizer.catalog import Catalog, columns_of
from drivesizer.catalog.tables import ESTIMATED
from drivesizer.catalog.view import printed_field
from drivesizer.files.text import listed
from drivesizer.results.check import Check, Confidence, Origin, sentence_case
from drivesizer.results.drive_set import DriveParts, DriveSet, EstimatedFigure
from drivesizer.units import show


@dataclass(frozen=True, slots=True)
class CheckKind:
    """Properties of a check that are the same for every candidate."""

    title: str
    kind: str  # of quantity
    unit: str  # of the trade
    rotary: tuple[str, str]  # kind and unit where the load turns about an axis
    rests_on: tuple[str, ...]  # figures such as ``motor.resistance``, and words that ``rests_on`` has
    on_inertia: bool  # with an unknown one of rotor or gearhead it cannot pass


def _declared() -> tuple[dict[str, dict[str, CheckKind]], dict[str, tuple[str, ...]]]:
    """The checks of each method by name, and how the names of a part's checks begin."""
    kinds: dict[str, dict[str, CheckKind]] = {}
    lists: dict[str, dict[str, tuple[str, ...]]] = {"figures": {}, "parts": {}}
    for section, cells in listed("drivesizer.results", "checks.txt"):
        name, title, units, figures, inertia = (*cells, "", "", "")[:5]
        words = (title if section in lists else figures).split()
        names = tuple(figure for word in words for figure in lists["figures"].get(word, (word,)))
        if section in lists:
            lists[section][name] = names
        else:
            own, *rotary = ((kind, unit) for kind, unit in map(str.split, (units or "dimensionless 1").split(",")))
            declared = CheckKind(title, *own, rotary[0] if rotary else own, names, inertia == "inertia")
            kinds.setdefault(section, {})[name] = declared
    return kinds, lists["parts"]


CHECKS, _OF_PART = _declared()
_MACHINE = "Machine"  # whatever concerns the drive as a whole, or the machine
PARTS = (*_OF_PART, _MACHINE)

OWN_REQUIREMENTS = ("travel_time", "motion_speed", "devices")  # of the section ``requirements`` alone
REQUIREMENTS = {  # of the machine, in the order in which people read them: which end of the check is required
    "travel_time": "limit", "motion_speed": "demand", "passage_width": "limit", "passage_height": "limit",
    "passage_turning": "limit", "passage_corner": "limit", "passage_clearance": "limit", "mass": "limit",
    "price": "limit", "battery_autonomy": "demand", "battery_range": "demand", "devices": "demand",
}  # fmt: skip
BATTERY_LASTING = ("battery_autonomy", "battery_range")
BATTERY_VOLTAGES = ("battery_voltage", "battery_cutoff")
# budgets that are checked sample by sample too
BATTERY_SAMPLED = (*BATTERY_LASTING, "battery_power", "battery_peak_current", *BATTERY_VOLTAGES)


def part_of(name: str) -> str:
    """The part that a check concerns.

    >>> part_of("winding_temperature"), part_of("backlash_at_load"), part_of("traction")
    ('Motor', 'Gearhead', 'Machine')
    """
    return next((part for part, begins in _OF_PART.items() if name.startswith(begins)), _MACHINE)


def sorted_by_part(checks: Sequence[Check]) -> list[Check]:
    """Checks sorted by part; those of one part in the order given."""
    return sorted(checks, key=lambda check: PARTS.index(part_of(check.name)))


# -- The catalogue figures that each check rests on: those that are unknown, and those that are not quoted.
#
# ``rests_on`` names every figure whose lack would leave a check of the drive unknown or change it; a test takes them
# away one by one and looks.


def rests_on(check: Check, drive_set: DriveParts) -> tuple[str, ...]:
    """The figures that a check of a drive rests on, such as ``motor.resistance``; none for what has none."""
    motor, gearhead, encoder, controller = (
        drive_set.motor, drive_set.gearhead, drive_set.encoder, drive_set.controller,
    )  # fmt: skip
    stepper, brushed = motor.kind == "stepper", motor.kind == "brushed"
    rubbing = [f"motor.{name}" for name in ("friction_torque", "viscous_friction") if not isnan(getattr(motor, name))]
    if len(rubbing) < 2:  # the rest is what the no-load current leaves
        rubbing += ["motor.no_load_current", "motor.no_load_speed"]
    current = [
        "gearhead.ratio", "gearhead.efficiency", "gearhead.inertia", "motor.rotor_inertia", "motor.torque_constant",
        *rubbing,
        *([] if isnan(gearhead.no_load_torque) else ["gearhead.no_load_torque", "gearhead.continuous_torque"]),
        *(["encoder.inertia"] if encoder and not isnan(encoder.inertia) else []),
    ]  # fmt: skip
    iron = ["motor.max_winding_temperature", "motor.nominal_current", "motor.nominal_speed"]
    rated = ["motor.nominal_current"]  # of a stepper, whatever the load
    absolute = encoder is not None and isnan(encoder.counts_per_turn)
    derated = controller is not None and not isnan(controller.full_current_ambient)
    model = ("holding_torque", "nominal_current", "resistance", "inductance", "pole_pairs", "pull_out_share")
    words = {
        "CURRENT": rated if stepper else current,
        "HOUSING": rated if stepper else [] if brushed else iron,
        "COUNTS": ["encoder.steps_per_turn" if absolute else "encoder.counts_per_turn"],
        "LEVER": [] if isnan(gearhead.max_radial_load) else ["gearhead.radial_load_distance"],  # of a limit at one
        "COMMUTATION": ["motor.inductance", "motor.pole_pairs"] if motor.kind == "brushless" else [],
        "DERATING": ["motor.max_winding_temperature"],
        "CONTROLLER_DERATING": [
            f"controller.{name}" for name in ("full_current_ambient", "derating_slope", "ambient_max") if derated
        ],
        "PULL_OUT": [f"motor.{name}" for name in model],
    }
    named = CHECKS[check.method][check.name].rests_on
    return tuple(dict.fromkeys(figure for name in named for figure in words.get(name, [name])))


def unknown_figures(drive_set: DriveSet) -> list[list[str]]:
    """For each unknown check its title, and which figures are not known: else those that its note names."""
    rows = []
    for check in _reported(drive_set):
        if check.status == "unknown":
            stated = "a figure of the load or of the spec"
            if check.name == "brake_fits":
                stated = "a source that lists it with this motor"
            elif check.note.startswith("unknown: "):  # such as masses of parts
                stated = check.note.removeprefix("unknown: ")
            rows.append([check.title, ", ".join(_lacking(check, drive_set)) or stated])
    return rows


def _reported(drive_set: DriveSet) -> tuple[Check, ...]:
    """Checks that a report prints: those of the method that ranked, and by physics too where that is the paper's."""
    by_paper = any(check.method == "paper" for check in drive_set.checks)
    return drive_set.every_check if by_paper else drive_set.own_checks


def _lacking(check: Check, drive_set: DriveParts) -> list[str]:
    """The parts, or figures of parts, that a check lacks."""
    if check.name.startswith(("resistor_", "chopper_")) and isnan(check.limit) and not isnan(check.demand):
        return [sentence_case(check.title)]  # the limit is the resistor's own figure
    lacking = []
    for name in rests_on(check, drive_set):
        role, _, field = name.partition(".")
        part = getattr(drive_set, role)
        if part is None:
            lacking.append(f"any {role}")
        elif _is_unknown(drive_set, role, field):
            lacking.append(figure_words(role, field, bool(part.inside)))
    return list(dict.fromkeys(lacking))


def _is_unknown(drive: DriveParts, role: str, field: str) -> bool:
    """Whether a figure of a part is not known; for a voltage constant k_t stands where none is printed."""
    value = getattr(getattr(drive, role), field, 0.0)
    return field not in ("back_emf_constant", "speed_constant") and isinstance(value, float) and isnan(value)


def figure_words(role: str, field: str, inside: bool = False) -> str:
    """A figure in words; of a part inside an actuator the one that is printed of that."""
    if inside:
        role, field = "actuator", printed_field(role, field)
    return f"{role} {field.removeprefix(f'{role}_').replace('_', ' ')}"


def missing_figures(drive_set: DriveSet) -> list[str]:
    """The parts, and figures of parts, that the unknown checks of a drive lack, each once."""
    unknown = (check for check in drive_set.deciding if check.status == "unknown")
    return list(dict.fromkeys(name for check in unknown for name in _lacking(check, drive_set)))


_OF_MARK: dict[str, Confidence] = {
    "derived": "derived", "recalled": "recalled", ESTIMATED: "estimated from peers",
}  # fmt: skip
_LOSSES = {"controller.voltage_drop", "controller.max_efficiency"}


def with_origins(
    checks: Sequence[Check], drive: DriveParts, catalog: Catalog, estimated: Sequence[EstimatedFigure]
) -> tuple[Check, ...]:
    """Checks of a drive, each with whence the figures are that it rests on, as far as they are not printed."""
    marks: dict[str, dict[str, str]] = {}
    assumed = {estimate.figure for estimate in estimated if estimate.confidence == "assumed by class"}
    for role in ("motor", "gearhead", "brake", "encoder", "controller"):
        part, table = getattr(drive, role), catalog.table(f"{role}s")
        if part is not None and part.part in table.rows:
            marks[role] = catalog.confidence(f"{role}s", table.rows[part.part])
    with_origin = []
    for check in checks:
        origins = []
        for name in rests_on(check, drive):
            role, _, field = name.partition(".")
            mark = _OF_MARK.get(marks.get(role, {}).get(field, ""))
            if mark is None and "loss_voltage" in assumed and name in _LOSSES:
                mark = "assumed by class"
            elif mark is None and check.status == "unknown" and _is_unknown(drive, role, field):
                mark = "unbounded"
            if mark:
                origins.append(Origin(role, field, mark))
        with_origin.append(replace(check, origins=tuple(origins)) if origins else check)
    return tuple(with_origin)


def marked_figures(drive_set: DriveSet) -> list[list[str]]:
    """Figures that are only derived, recalled or estimated and that a check rests on: values, confidences, checks."""
    resting: dict[Origin, list[str]] = {}
    for check in _reported(drive_set):
        for origin in check.origins:
            if origin.confidence in _OF_MARK.values():
                resting.setdefault(origin, []).append(check.title)
    rows = []
    for (role, field, confidence), titles in resting.items():
        column, digits = columns_of(f"{role}s")[field], 3 if confidence == "estimated from peers" else 6
        value = show(getattr(getattr(drive_set, role), field), column.unit, column.kind, digits)
        rows.append([figure_words(role, field), value, confidence.split()[0], "; ".join(dict.fromkeys(titles))])
    return rows
