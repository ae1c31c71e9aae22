"""Samples of a platform on its way: every wheel's load cycle, one battery for all of them."""

from __future__ import annotations

from importlib import resources
from typing import Any

import numpy as np
import pytest

from drivesizer.catalog import Catalog
from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine.budgets import machine_budget
from drivesizer.machine.problem import problem
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.columns.evaluation import evaluate
from drivesizer.search.search import search
from drivesizer.search.set_record import drive_set
from drivesizer.search.shortlist import load_parts
from drivesizer.search.uncertainty.probabilities import subject
from drivesizer.search.uncertainty.sampled_drive import Prepared, SetRows, blocks, checks_of, prepared
from drivesizer.search.uncertainty.sampling import sample
from drivesizer.search.uncertainty.uncertain_figures import applied, assumptions
from drivesizer.sizing import size
from drivesizer.spec.drive import ControllerChoice
from drivesizer.spec.robot import RobotSpec, read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

NONE = (
    "tolerances: {motor: {resistance: none, torque_constant: none, friction: none, rotor_inertia: none, "
    "dry_friction: none, commutation: none, thermal_resistance: none}, "
    "gearhead: {efficiency: none, peak_torque: none, inertia: none}, "
    "controller: {losses: none}, samples: 64}\n"
)
# a slope tells wheels apart that are alike on the level; a limit of speed moves the way itself
MOVED = {
    "mass: 60 kg ": "mass: 60 kg +- 5 kg ",
    "rolling_resistance: 0.02\n": "rolling_resistance: 0.02 in 0.015..0.03\n",
    "# slope: 2 deg ": "slope: 0 deg +- 1 deg ",
    "  capacity: 2.5 A*h": "  capacity: 2.5 A*h +- 5 %",
    "    speed: 1.2 m/s\n": "    speed: 1.2 m/s +- 0.1 m/s\n",
}


def _read(changes: dict[str, str]) -> RobotSpec:
    text = (resources.files("drivesizer.spec") / "starters" / "mecanum_platform.yaml").read_text(encoding="utf-8")
    for old, new in changes.items():
        assert old in text, old
        text = text.replace(old, new, 1)
    return read_spec(YamlSource(text + NONE, "robot.yaml"))


@pytest.fixture(scope="module")
def parts() -> Catalog:
    return load_parts(_read({}))


@pytest.fixture(scope="module")
def ready() -> Prepared:
    spec = _read(MOVED)
    given = assumptions(spec)
    return prepared(problem(spec, load_parts(spec)), given, sample(given, 64, 1))


def _plainly(ready: Prepared, parts: Catalog, one: SetRows, values: Any) -> Any:
    """One sample: the machine with its figures, taken apart into wheels anew; the checks of set and battery."""
    machine = ready.problem.machine
    moved = applied(machine, {g.given.path: v - g.nominal for g, v in zip(ready.given, values, strict=True)})
    mine = ControllerChoice(part=[str(parts.controllers["part"][one.controller])])
    select = moved.select.model_copy(update={"controller": mine})
    given = problem(moved.model_copy(update={"select": select}), parts)
    only = Candidates(np.array([one.motor]), np.array([one.gearhead]), np.array([one.belt]), np.array([True]))
    record = drive_set(evaluate(given, only), 0, 1)
    return {check.name: check for check in (*record.checks, *machine_budget(given, record).checks)}


def test_samples_are_what_the_plain_evaluation_says(ready: Prepared, parts: Catalog) -> None:
    """Every check of the drive at its worst wheel, and how long the battery lasts: the same to 1e-4."""
    one = subject(search(ready.problem, top=1).evaluation, 0).rows
    (block,) = blocks(ready, parts, [one.belt])
    got = checks_of(parts, one, block)
    assert {"battery_autonomy", "gearhead_intermittent_torque", "traction"} <= set(got)
    assert not {"battery_power", "battery_peak_current"} & set(got)  # peaks of the wheels need not fall together
    for row in (0, 17, 40, 63):
        exact = _plainly(ready, parts, one, ready.values[row])
        # a set without a figure of it has no such check, nor a brushed motor, which commutates itself
        assert set(got) - set(exact) <= {"motor_peak_torque", "controller_speed", "controller_power"}
        for name, column in got.items():
            if name not in exact:
                continue
            for side in ("demand", "limit"):
                mine = np.broadcast_to(getattr(column, side), block.size)[row]
                near = 2e-3 if name == "winding_temperature" else 1e-4
                np.testing.assert_allclose(mine, getattr(exact[name], side), rtol=near, atol=1e-9, err_msg=name)


def test_a_slope_tells_wheels_apart_that_are_alike_on_the_level() -> None:
    """Straight ahead on the level all four take the same; across a slope a mecanum platform leans on two of them."""
    straight = "    - {x: 8 m, y: 3 m, heading: 0 deg, pause: 10 s}       # sideways, then loading\n"
    turn = "    - {x: 0 m, y: 0 m, heading: 180 deg}\n"
    across = {"  centre_of_mass:": "  uphill: 90 deg\n  centre_of_mass:"}
    spec = _read({straight: "", turn: "", "# slope: 2 deg ": "slope: 0 deg +- 3 deg "} | across)
    level = problem(spec, load_parts(spec))
    assert [case.spec.load.alike for case in level.cases] == [4]
    ready = prepared(level, assumptions(spec), np.array([[0.0], [0.05]]))
    squares = [(case.cycle.torque**2).sum(axis=(0, 1)) for case in ready.cases]
    level, steep = ({f"{square[k]:.6g}" for square in squares} for k in (0, 1))
    assert len(squares) == 4 and len(level) == 1 and len(steep) == 4


def test_size_tells_how_sure_a_platform_is() -> None:
    result = size(_read(MOVED), top=1)
    assert result.uncertainty and result.uncertainty.samples == 64
    reliability = result.sets[0].reliability
    assert reliability and 0.0 < reliability.probability <= 1.0 and reliability.loop is None
    assert {"Battery autonomy"} <= {one.title for one in reliability.checks}
