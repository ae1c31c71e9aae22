"""Every figure of the schema with a tolerance: it changes a sampled check, or the program says why it cannot."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, get_args

import numpy as np
import pytest
from every_figure import PARTS, SPECS, text_of
from pydantic import BaseModel

from drivesizer.errors import InputError
from drivesizer.files.fields import Quantity
from drivesizer.files.yaml_source import Path_, YamlSource
from drivesizer.machine.problem import problem
from drivesizer.search.shortlist import load_parts
from drivesizer.search.uncertainty.probabilities import Subject, at_ends, without_effect
from drivesizer.search.uncertainty.sampled_drive import SetRows
from drivesizer.search.uncertainty.uncertain_figures import COLUMNS, NOT_SAMPLED, Assumption, reason
from drivesizer.spec.messages import models_at
from drivesizer.spec.robot import RobotSpec, read_spec
from drivesizer.spec.tolerances import tolerance

ELSEWHERE = {  # choices of parts and samples, which are refused; platforms on a path: see test_tolerances_platform
    "ScrewChoice", "Pulleys", "Weighted", "Tolerances", "Platform", "Waypoint", "Track",
}  # fmt: skip
REFUSED = {("BeltStage", "ratio"), ("BeltStage", "ratios"), ("Case", "share"), ("Case", "lasting")}
ALIKE = {("Hold", "time")}  # repeated: however long, nothing changes


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A catalogue of one drive, and the recordings that specs name."""
    place = tmp_path_factory.mktemp("figures")
    (place / "parts.yaml").write_text(PARTS, encoding="utf-8")
    rows = "0,0,0\n0.5,20,2\n1,60,2\n1.5,60,1\n2,60,1\n2.5,40,0\n3,0,-1\n"
    level = f"time,speed,torque\ns,rpm,N*m\n{rows}"
    (place / "level.csv").write_text(level, encoding="utf-8")
    turns = "".join(f"{angle},{50.0 * np.sin(np.radians(angle)):.4f}\n" for angle in range(0, 361, 20))
    (place / "cam.csv").write_text(f"angle,position\ndeg,mm\n{turns}", encoding="utf-8")
    return place


def quantities(annotation: Any) -> bool:
    """Whether a field takes a quantity."""
    inner = (*getattr(annotation, "__metadata__", ()), *get_args(annotation))
    return isinstance(annotation, Quantity) or any(quantities(one) for one in inner)


def declared(model: type[BaseModel], name: str) -> bool:
    field = model.model_fields[name]
    return any(quantities(one) for one in (*field.metadata, field.annotation))


def schema(model: type[BaseModel], at: Path_, seen: set[type[BaseModel]]) -> Iterator[tuple[str, str, Path_]]:
    """Models, their fields that take quantities, and a place of each."""
    if model in seen or model.__name__ in ELSEWHERE:
        return
    seen.add(model)
    for name in model.model_fields:
        if declared(model, name):
            yield model.__name__, name, (*at, name)
        for one in models_at(model, (name,), None):
            yield from schema(one, (*at, name), seen)


def leaves(data: Any, path: Path_ = ()) -> Iterator[tuple[Path_, str]]:
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for step, value in items:
        if isinstance(value, dict | list):
            yield from leaves(value, (*path, step))
        elif not isinstance(value, bool):
            yield (*path, step), str(value)


def figures(source: YamlSource) -> dict[Path_, str]:
    """Places of all quantities of a spec that are not 0, as texts."""
    found = {}
    for path, text in leaves(source.data):
        owners = [one for one in models_at(RobotSpec, path[:-1], source.data) if path[-1] in one.model_fields]
        if any(declared(one, str(path[-1])) for one in owners) and not text.startswith("0 "):
            found[path] = text
    return found


def owners(path: Path_, data: Any) -> list[tuple[str, str]]:
    """Models of a place and its field in them; of a body the field also that it is the inertia of."""
    found = [(one.__name__, str(path[-1])) for one in models_at(RobotSpec, path[:-1], data)]
    return [*found, *owners(path[: path.index("inertia") + 1], data)] if "inertia" in path[:-1] else found


Effects = dict[tuple[str, str], list[tuple[Path_, bool]]]


def add_effects(every: Effects, folder: Any, name: str) -> None:
    """Add places by model and field, and whether a figure alone, 1 % off, changes a check; only of those without."""
    source = YamlSource(text_of(name), str(folder / "robot.yaml"))
    spec = read_spec(source)
    given = []
    for path, text in figures(source).items():
        if not all(any(moved for _, moved in every.get(field, ())) for field in owners(path, source.data)):
            one = tolerance(f"{text} +- 1 %", path)
            given.append(Assumption(".".join(map(str, path)), text, one.value, one.distribution, spec_class=one))
    spec._toleranced = tuple(one.spec_class for one in given if one.spec_class)
    found = problem(spec, load_parts(spec))
    rows = SetRows(0, 0, 0, 0, spec.belt_ratios[0], 0 if spec.brake else -1)
    idle = {one.name for one in without_effect([Subject(rows, ())], found.catalog, at_ends(found, given))}
    for one in given:
        path = one.spec_class.path if one.spec_class else ()
        for field in owners(path, source.data):
            every.setdefault(field, []).append((path, one.name not in idle))


def test_every_figure_has_an_effect_or_a_reason(folder: Any) -> None:
    """Over all specs: a figure without a reason changes a check in one of them, one with a reason in none."""
    every: Effects = {}
    for name in SPECS:
        add_effects(every, folder, name)
    silent = {field for field, found in every.items() if not any(moved or reason(path) for path, moved in found)}
    wrong = {field for field, found in every.items() if any(moved and reason(path) for path, moved in found)}
    assert (silent - REFUSED - ALIKE, wrong) == (set(), set())
    fields = {(model, name): path for model, name, path in schema(RobotSpec, (), set())}
    assert {one for one in fields.keys() - every.keys() if not reason(fields[one])} - REFUSED == set()


def test_the_tables_name_fields_of_the_schema() -> None:
    """A column or reason of a field that is no more would be silent."""
    known = {"control", "plant", "paper_factors", "margins", "budget", "battery", "brake_resistor", "mounting",
             "requirements"}  # fmt: skip
    named = {f"{section}.{field}" for section, fields in COLUMNS.items() for field in fields}
    for name in (named | NOT_SAMPLED.keys()) - known:
        section, field = name.split(".")
        assert any(field in one.model_fields for one in models_at(RobotSpec, (section,), None)), name


SCREW = "load: {kind: ball_screw, mass: 5 kg, length: 400 mm, ends: fixed-free, screw: {lead_min: 5 mm +- 1 mm}}"
RACK = "load: {kind: rack_pinion, mass: 5 kg, pinion_diameter: 50 mm}"
BELT = "transmission: [{kind: gearhead}, {kind: belt, efficiency: 0.9, %s}]"
PULLEYS = (
    "pulleys: {profile: HTD, pitch: 5 mm, width: 9 mm, ratio_min: 1, ratio_max: 2, centre_distance: 90 mm +- 1 mm}"
)


@pytest.mark.parametrize(
    ("load", "more", "said"),
    [
        (SCREW, "", "load.screw.lead_min: it chooses among screws of the catalogues; expected it without a tolerance"),
        (RACK, BELT % "ratio: 1.5 +- 0.1", "transmission[2].ratio: ratios of a belt are searched as they are; ex"),
        (RACK, BELT % "ratios: [2, 1.5 +- 0.1]", "transmission[2].ratios[2]: ratios of a belt are searched as they"),
        (RACK, BELT % PULLEYS, "transmission[2].pulleys.centre_distance: it chooses among pulleys of the catalogues"),
        (RACK, "cases: [{name: more, load: {motors: 3 +- 1}}]", 'cases[1].load.motors: "3" is not a whole number'),
    ],
)  # fmt: skip
def test_what_cannot_be_sampled_is_refused(load: str, more: str, said: str) -> None:
    motion = "motion: {speed: 0.2 m/s, acceleration_time: 1 s, cruise_time: 1 s}\nsupply: {nominal: 48 V}"
    with pytest.raises(InputError) as caught:
        read_spec(YamlSource(f"name: x\n{load}\n{motion}\n{more}\n", "robot.yaml"))
    place, _, words = str(caught.value).partition(": ")
    assert place.startswith("robot.yaml:") and words.startswith(said) and "\n" not in words
