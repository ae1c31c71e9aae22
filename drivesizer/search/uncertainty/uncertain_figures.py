"""Uncertain figures of a machine and its drive: every figure with a tolerance, in a fixed order.

First the spec's figures, in the order of the file, then the classes of the catalogue's figures. All drives of a
machine are taken to deviate alike, and so are all drives that are compared: one sample is one machine. Where makers
state different tolerances of a figure, a sample deviates by the same share of each.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from drivesizer.catalog.tolerances.classes import NOT_OF_STEPPERS, OF_STEPPERS, Class, classes
from drivesizer.catalog.tolerances.distributions import Distribution
from drivesizer.files.inertia import OfSolids, moment
from drivesizer.files.yaml_source import Path_
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.tolerance_text import Toleranced

__all__ = ["Assumption", "applied", "assumptions", "case_paths", "of_a_class", "of_the_file"]

_VARIED = ("load", "motion", "supply", "environment")  # sections that a load case may replace


class Assumption(NamedTuple):
    """One uncertain figure."""

    name: str  # load.mass, motor.resistance
    title: str  # load.mass 45 kg +- 3 kg; Motor resistance +- 10 %
    nominal: float  # SI; 1 of a factor
    distribution: Distribution  # SI; of a factor of the printed figure
    given: Toleranced | None = None  # of the spec
    catalogue: Class | None = None  # of the catalogue

    @property
    def column(self) -> str:
        """Name that it shares with the same figure of other makers: its column in a sample."""
        return f"{self.catalogue.part}.{self.catalogue.figure}" if self.catalogue else self.name

    def shown(self, value: float) -> str:
        """A value of it as text."""
        if self.given:
            return self.given.shown(value)
        return f"{100.0 * (value - 1.0):+.3g} %"


def assumptions(spec: RobotSpec, held: Sequence[Class] | None = None) -> tuple[Assumption, ...]:
    """All uncertain figures of a spec and of the catalogue."""
    classes_held = _of_the_kind(spec) if held is None else held
    return (*map(of_the_file, spec.toleranced), *(of_a_class(one) for one in classes_held if one.factor is not None))


def of_the_file(one: Toleranced) -> Assumption:
    """The assumption that a figure of a spec is."""
    name = _named(one.path)
    return Assumption(name, f"{name} {one.text}", one.value, one.distribution, given=one)


def of_a_class(one: Class) -> Assumption:
    """The assumption that the class of a catalogue's figure is; it has a distribution."""
    assert one.factor is not None
    return Assumption(one.name, f"{one.title} {one.text}", 1.0, one.factor, catalogue=one)


def _of_the_kind(spec: RobotSpec) -> list[Class]:
    """The default classes of what a machine with its kind of motor has: others would take columns of its samples."""
    foreign = NOT_OF_STEPPERS if spec.steps else OF_STEPPERS
    return [one for one in classes(spec.tolerances.given) if (one.part, one.figure) not in foreign]


def _named(path: Path_) -> str:
    """``transmission[2].efficiency``, as messages have it."""
    return "".join(f"[{step + 1}]" if isinstance(step, int) else f".{step}" for step in path).lstrip(".")


def case_paths(spec: RobotSpec, number: int | None) -> dict[int, Path_]:
    """The spec's tolerances that count in a load case, by their number, with their places there."""
    if number is None:
        return {k: one.path for k, one in enumerate(spec.toleranced) if one.path[0] != "cases"}
    own = dict(enumerate(spec.entered.get("cases") or ())).get(number, {})  # poses of a robot are not in the file
    found: dict[int, Path_] = {}
    for k, one in enumerate(spec.toleranced):
        if one.path[:2] == ("cases", number):
            found[k] = one.path[2:]
        elif one.path[0] != "cases" and not _replaced(own, one.path):
            found[k] = one.path
    return found


def _replaced(case: Mapping[str, Any], path: Path_) -> bool:
    """Whether a load case has a figure of its own, or another load or motion altogether."""
    if path[0] not in _VARIED or path[0] not in case:
        return False
    section = case[path[0]]
    return path[1] in section or "kind" in section or "profile" in section


def applied(spec: RobotSpec, changes: Mapping[Path_, Any]) -> RobotSpec:
    """A spec with some figures moved by differences from their nominal values [SI], figures or columns; unchecked."""
    changed: RobotSpec = _moved(spec, changes) if changes else spec
    return changed


def _moved(place: Any, changes: Mapping[Path_, Any]) -> Any:
    """A section, list or figure with what is in it moved; places count from it."""
    if () in changes:
        return place + changes[()]
    if isinstance(place, OfSolids):
        solids = _moved(place.solids, changes)
        return moment(solids) if any(np.ndim(x) for x in changes.values()) else OfSolids(solids)
    within: dict[Any, dict[Path_, Any]] = {}
    for path, difference in changes.items():
        within.setdefault(path[0], {})[path[1:]] = difference
    if isinstance(place, list):
        return [_moved(one, within[n]) if n in within else one for n, one in enumerate(place)]
    if isinstance(place, dict):
        return place | {name: _moved(place[name], some) for name, some in within.items()}
    return place.model_copy(update={name: _moved(getattr(place, name), some) for name, some in within.items()})
