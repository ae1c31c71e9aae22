"""Uncertain figures of a machine and its drive, each with its tolerance, its class and the checks it enters."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import isnan
from typing import Any, NamedTuple

import numpy as np

from drivesizer.catalog import DIRECT, Catalog
from drivesizer.catalog.estimates import MOUNTED
from drivesizer.catalog.query import PartRow
from drivesizer.catalog.tables import ESTIMATED
from drivesizer.catalog.tolerances import (
    CLASSES,
    NOT_OF_STEPPERS,
    OF_STEPPERS,
    Class,
    Distribution,
    MakerTolerance,
    class_of,
    classes,
    losses_from_stall,
    losses_identified,
    maker_tolerances_of,
    owner_of,
    resistance_from_stall,
)
from drivesizer.catalog.view import STEPPER, has_steppers
from drivesizer.files.fields import OfSolids, moment
from drivesizer.files.text import listed
from drivesizer.files.yaml_source import Path_, field_name
from drivesizer.physics.figures import Alike
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.tolerances import Toleranced

TABLE = (*listed("drivesizer.search.uncertainty", "figures.txt"),)
# figures that enter checks beside the load cycle, and such as have no effect on any, with the reason
COLUMNS = {cells[0]: {*cells[1].split()} for head, cells in TABLE if head == "checks"}
NOT_SAMPLED = {name: cells[1] for head, cells in TABLE if head == "not sampled" for name in cells[0].split()}


def _field(path: Path_) -> str:
    """Field of a section, or of a stage, consumer or wheel in its list."""
    return str(next((step for step in path[1:] if isinstance(step, str)), ""))


def enters_checks(path: Path_) -> bool:
    """Whether a figure enters checks beside the load cycle.

    >>> enters_checks(("supply", "min")), enters_checks(("transmission", 1, "mass"))
    (True, False)
    """
    return _field(path) in COLUMNS.get(str(path[0]), set())


def reason(path: Path_) -> str:
    """Reason for which a tolerance has no effect on a sampled check; empty where it has one on some machines.

    >>> reason(("margins", "torque")), reason(("supply", "min"))
    ('a required margin is no figure of the machine', '')
    """
    section, field = str(path[0]), _field(path)
    if enters_checks(path):
        return ""
    return NOT_SAMPLED.get(f"{section}.{field}", NOT_SAMPLED.get(section, ""))


# -- Tolerance class of a part's figure: the spec's, else its maker's, else the default one.
#
# Drives of several makers are compared in one sizing, so a class may be of one maker's parts alone.


_SECTIONS = {"motor": "motors", "gearhead": "gearheads", "controller": "controllers"}
SpecClasses = Mapping[tuple[str, str], str]


def holding(catalog: Catalog, spec_classes: SpecClasses, part: str, row: int) -> tuple[Class, ...]:
    """The classes of one part's figures, one a figure; none without the part, or of a controller inside an actuator."""
    table = catalog.table(_SECTIONS[part])
    if row < 0 or table["part"][row] == DIRECT or (part == "controller" and table["inside"][row] != ""):
        return ()
    stated = maker_tolerances_of(catalog.tolerances, part, str(table["manufacturer"][row]), str(table["family"][row]))
    tolerances = []
    for default in classes(spec_classes):
        if default.part == part and _concerns(catalog, part, row, default.figure):
            mine = stated.get(default.figure)
            if (part, default.figure) in spec_classes:
                tolerances.append(default)
            else:
                own = _of_a_maker(catalog, mine) if mine else None
                stalled = None if mine else _of_stall(catalog, part, row, default.figure)
                tolerances.append(stalled or _of_peers(catalog, default, part, row) or own or default)
    return tuple(tolerances)


def _concerns(catalog: Catalog, part: str, row: int, figure: str) -> bool:
    """Whether a part has the figure of a class: not a dry share where both frictions are known, nor a printed peak."""
    if (part, figure) in (NOT_OF_STEPPERS if has_steppers(catalog) else OF_STEPPERS):
        return False
    table = catalog.table(_SECTIONS[part])
    if figure in _OF_THE_MODEL:
        return bool(table[STEPPER][row] not in catalog.pull_outs.stepper)
    if figure == "dry_friction":
        printed = [table[name][row] for name in ("friction_torque", "viscous_friction")]
        return all(bool(value != value) for value in printed)
    if figure == "commutation":
        return bool(table["kind"][row] == "brushless" and table["pole_pairs"][row] * table["inductance"][row] > 0.0)
    if figure == "peak_torque":
        sold = _sold_as(catalog, part, row)
        return sold.section == "actuators" and bool(sold["peak_torque"] == sold["stall_torque"])
    return True


def _sold_as(catalog: Catalog, part: str, row: int) -> PartRow:
    """The part as its catalogue has it: the actuator, of one that is inside of that."""
    section = _SECTIONS[part]
    inside = str(catalog.table(section)["inside"][row])
    return (
        PartRow("", catalog, "actuators", catalog.actuators.rows[inside])
        if inside
        else PartRow("", catalog, section, row)
    )


def _of_stall(catalog: Catalog, part: str, row: int, figure: str) -> Class | None:
    """The class of a figure that is worked out from no-load and stall figures; None of others."""
    if figure not in ("resistance", "efficiency"):
        return None
    sold = _sold_as(catalog, part, row)
    if "stall_current" not in sold.table.columns:
        return None
    if figure == "efficiency" and isnan(sold["efficiency"]) and not isnan(sold["load_friction"]):
        return losses_identified()
    if not abs(sold["resistance"] * sold["stall_current"] / sold["nominal_voltage"] - 1.0) < _ROUNDED:
        return None
    confidence = catalog.confidence(sold.section, sold.row)
    if not {confidence["resistance"], confidence.get(figure, "")} <= _WORKED_OUT:
        return None
    if part == "motor":
        return resistance_from_stall()
    if sold["gearing"] != "spur" or not sold["efficiency"] < 1.0:
        return None
    return losses_from_stall(sold.part, *(float(sold[name]) for name in ("efficiency", "ratio", "stages")))


_WORKED_OUT = {"derived", "recalled", ESTIMATED}  # confidences of figures that are not printed
_ROUNDED = 0.05  # of a resistance that is voltage over stall current


_OF_THE_MODEL = ("holding_torque", "inductance")  # which counts where no curve is printed
_COLUMNS = {  # of a class: the columns that it varies, as far as they may be estimated
    ("motor", "friction"): ("no_load_current",),
    ("motor", "rotor_inertia"): ("rotor_inertia",),
    ("motor", "pull_out"): ("pull_out_share",),
    ("motor", "start_speed"): ("start_speed",),
    ("motor", "thermal_resistance"): ("thermal_resistance_housing", "thermal_resistance_winding"),
    ("gearhead", "efficiency"): ("efficiency",),
    ("gearhead", "inertia"): ("inertia",),
}


def _of_peers(catalog: Catalog, default: Class, part: str, row: int) -> Class | None:
    """The class of a figure that is estimated: the band of its law; None where the catalogue has the figure."""
    for name in _COLUMNS.get((part, default.figure), ()):
        estimate = catalog.estimate_of(_SECTIONS[part], row, name)
        if estimate is None or estimate.fit == MOUNTED:  # a mounting is no property of the part
            continue
        value, low, high = (1.0 / x - 1.0 if name == "efficiency" else x for x in estimate[:3])  # of losses per torque
        least, most = sorted((low / value, high / value))
        text = f"{least:.2f} to {most:.2f} times, 5 to 95 %"
        factor = Distribution("lognormal", least, most, 1.0)
        whose = str(catalog.table(_SECTIONS[part])["part"][row])
        return Class(part, default.figure, f"{default.title}, {whose}", text, factor, "estimated from peers", whose)
    return None


def _of_a_maker(catalog: Catalog, tolerance: MakerTolerance) -> Class:
    source = catalog.sources[tolerance.source]
    certainty = "" if source.confidence == "quoted" else source.confidence
    date = "" if source.date in source.document else source.date
    why = ", ".join(text for text in (f"{tolerance.maker}: {source.document}", date, certainty) if text)
    return class_of(tolerance.part, tolerance.figure, tolerance.tolerance, why, owner_of(catalog.tolerances, tolerance))


def holding_of_a_set(catalog: Catalog, spec_classes: SpecClasses, *rows: int) -> tuple[Class, ...]:
    """The classes of the figures of a motor, its gearhead and its controller, by their rows."""
    return tuple(
        tolerance
        for part, row in zip(_SECTIONS, rows, strict=False)
        for tolerance in holding(catalog, spec_classes, part, row)
    )


def classes_in_use(catalog: Catalog, spec_classes: SpecClasses, rows: Iterable[tuple[int, ...]]) -> tuple[Class, ...]:
    """The classes that hold for any of some motors, gearheads and controllers, each once, in a fixed order.

    The order is that of the figures, the default class of each first, then the makers' by name.
    """
    parts = dict.fromkeys(pair for group in rows for pair in zip(_SECTIONS, group, strict=False))
    tolerances = {tolerance for part, row in parts for tolerance in holding(catalog, spec_classes, part, row)}
    order = {key: place for place, key in enumerate(CLASSES)}
    return tuple(
        sorted(
            tolerances,
            key=lambda tolerance: (
                order[tolerance.part, tolerance.figure],
                tolerance.whose,
                tolerance.text,
                tolerance.why,
            ),
        )
    )


# -- Uncertain figures of a machine and its drive: every figure with a tolerance, in a fixed order.
#
# First the spec's figures, in the order of the file, then the classes of the catalogue's figures. All drives of a
# machine are taken to deviate alike, and so are all drives that are compared: one sample is one machine. Where
# makers state different tolerances of a figure, a sample deviates by the same share of each.


_VARIED = ("load", "motion", "supply", "environment")  # sections that a load case may replace


class Assumption(NamedTuple):
    """One uncertain figure."""

    name: str  # load.mass, motor.resistance
    title: str  # load.mass 45 kg +- 3 kg; Motor resistance +- 10 %
    nominal: float  # SI; 1 of a factor
    distribution: Distribution  # SI; of a factor of the printed figure
    spec_class: Toleranced | None = None  # of the spec
    catalogue: Class | None = None  # of the catalogue

    @property
    def column(self) -> str:
        """Name that it shares with the same figure of other makers: its column in a sample."""
        return f"{self.catalogue.part}.{self.catalogue.figure}" if self.catalogue else self.name

    def with_unit(self, value: float) -> str:
        """A value of it as text."""
        if self.spec_class:
            return self.spec_class.with_unit(value)
        return f"{100.0 * (value - 1.0):+.3g} %"


def assumptions(spec: RobotSpec, tolerances: Sequence[Class] | None = None) -> tuple[Assumption, ...]:
    """All uncertain figures of a spec and of the catalogue."""
    if tolerances is None:  # the default classes of its kind of motor: others would take columns of its samples
        foreign = NOT_OF_STEPPERS if spec.steps else OF_STEPPERS
        tolerances = [
            tolerance
            for tolerance in classes(spec.tolerances.classes)
            if (tolerance.part, tolerance.figure) not in foreign
        ]
    return (
        *map(of_the_file, spec.toleranced),
        *(of_a_class(tolerance) for tolerance in tolerances if tolerance.factor is not None),
    )


def of_the_file(figure: Toleranced) -> Assumption:
    """The assumption that a figure of a spec is."""
    name = field_name(figure.path)
    return Assumption(name, f"{name} {figure.text}", figure.value, figure.distribution, spec_class=figure)


def of_a_class(tolerance: Class) -> Assumption:
    """The assumption that the class of a catalogue's figure is; it has a distribution."""
    assert tolerance.factor is not None
    return Assumption(tolerance.name, f"{tolerance.title} {tolerance.text}", 1.0, tolerance.factor, catalogue=tolerance)


def case_paths(spec: RobotSpec, number: int | None) -> dict[int, Path_]:
    """The spec's tolerances that count in a load case, by their number, with their places there."""
    if number is None:
        return {k: figure.path for k, figure in enumerate(spec.toleranced) if figure.path[0] != "cases"}
    own = dict(enumerate(spec.entered.get("cases") or ())).get(number, {})  # poses of a robot are not in the file
    paths: dict[int, Path_] = {}
    for k, figure in enumerate(spec.toleranced):
        if figure.path[:2] == ("cases", number):
            paths[k] = figure.path[2:]
        elif figure.path[0] != "cases" and not _replaced(own, figure.path):
            paths[k] = figure.path
    return paths


def _replaced(case: Mapping[str, Any], path: Path_) -> bool:
    """Whether a load case has a figure of its own, or another load or motion altogether."""
    if path[0] not in _VARIED or path[0] not in case:
        return False
    section = case[path[0]]
    return path[1] in section or "kind" in section or "profile" in section


def applied(spec: RobotSpec, changes: Mapping[Path_, Alike]) -> RobotSpec:
    """A spec with some figures moved by differences from their nominal values [SI], figures or columns; unchecked."""
    return _with_differences(spec, changes) if changes else spec


def _with_differences(place: Any, changes: Mapping[Path_, Alike]) -> Any:
    """A section, list or figure with what is in it moved; places count from it."""
    if () in changes:
        return place + changes[()]
    if isinstance(place, OfSolids):
        solids = _with_differences(place.solids, changes)
        return moment(solids) if any(np.ndim(x) for x in changes.values()) else OfSolids(solids)
    within: dict[str | int, dict[Path_, Alike]] = {}
    for path, difference in changes.items():
        within.setdefault(path[0], {})[path[1:]] = difference
    if isinstance(place, list):
        return [_with_differences(element, within[n]) if n in within else element for n, element in enumerate(place)]
    if isinstance(place, dict):
        return place | {name: _with_differences(place[name], inner) for name, inner in within.items()}
    return place.model_copy(
        update={name: _with_differences(getattr(place, str(name)), inner) for name, inner in within.items()}
    )
