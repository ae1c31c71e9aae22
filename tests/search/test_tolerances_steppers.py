"""Steppers over samples: against plain Monte Carlo, the evaluation of each sample by itself, and nominal verdicts."""

from __future__ import annotations

import math
import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from refusals import refusal
from sampled_plainly import machine_of, scaled
from stepper_catalog import ideal_torque, printed_torque, written

from drivesizer.catalog import Catalog
from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine.problem import problem
from drivesizer.output.json.documents import as_text
from drivesizer.physics.stepper import PULL_OUT_SHARE
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.columns.evaluation import evaluate
from drivesizer.search.shortlist import load_parts
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.search.uncertainty.sampled_drive import SetRows, blocks, checks_of, prepared
from drivesizer.search.uncertainty.sampling import sample
from drivesizer.search.uncertainty.uncertain_figures import Assumption, assumptions, classes_in_use, holding
from drivesizer.sizing import explained, size
from drivesizer.spec.drive import ControllerChoice
from drivesizer.spec.robot import RobotSpec, read_spec

RPM = math.pi / 30.0
FLYWHEEL = "load: {kind: rotary_table, inertia: %s, friction_torque: %s}\n"
TRAPEZOID = "motion: {speed: %s, acceleration_time: 0.15 s, cruise_time: 0.5 s, rest_time: 0.3 s}\n"
SINE = "motion: {profile: harmonic, amplitude: 200 deg, period: 0.6 s +- 0.05 s}\n"
TABLE = FLYWHEEL % ("4e-4 kg*m^2 +- 1e-4 kg*m^2", "0.05 N*m +- 0.02 N*m")
SLOW = TRAPEZOID % "300 rpm"
SUPPLY = "supply: {nominal: 26 V, min: 24 V +- 2 V, current: 6 A, capacitance: 50 mF}\n"


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("steps"))


@pytest.fixture(scope="module")
def parts(path: Path) -> Catalog:
    return load_parts(read(path, TABLE + SLOW + SUPPLY))


def read(path: Path, text: str, part: str = "A2") -> RobotSpec:
    select = f"select: {{catalogs: ['{path}'], motor: {{kind: stepper, part: {part}}}}}\n"
    return read_spec(YamlSource(f"name: table\ntransmission: [{{kind: direct}}]\n{text}{select}", "robot.yaml"))


def rows_of(parts: Catalog, part: str, driver: str = "D4") -> SetRows:
    drive = parts.motors.rows[part], parts.gearheads.rows["direct"]
    return SetRows(*drive, -1, parts.controllers.rows[driver], 1.0)


def given_of(spec: RobotSpec, parts: Catalog, one: SetRows) -> tuple[Assumption, ...]:
    held = classes_in_use(parts, spec.tolerances.classes, [(one.motor, one.gearhead, one.controller)])
    return assumptions(spec, held)


def plainly(spec: RobotSpec, parts: Catalog, one: SetRows, given: Any, values: Any) -> Any:
    """One sample by the evaluation that knows no samples: a spec and a catalogue of its own."""
    v = dict.fromkeys(("pull_out", "holding_torque", "phase_current", "inductance", "resistance", "rotor_inertia",
                       "start_speed"), 1.0)  # fmt: skip
    v |= {a.catalogue.figure: x for a, x in zip(given, values, strict=True) if a.catalogue}
    current, curves = v["phase_current"], parts.pull_outs
    catalog = replace(parts, ends=(), pull_outs=curves._replace(torque=curves.torque * v["pull_out"]), motors=scaled(
        parts.motors, one.motor, {
            "pull_out_share": v["pull_out"], "holding_torque": v["holding_torque"] * current,
            "nominal_current": current, "resistance": v["resistance"], "inductance": v["inductance"],
            "rotor_inertia": v["rotor_inertia"], "start_speed": v["start_speed"],
        }))  # fmt: skip
    moved = machine_of(spec, given, values)
    mine = ControllerChoice(part=[str(parts.controllers["part"][one.controller])])
    moved = moved.model_copy(update={"select": moved.select.model_copy(update={"controller": mine})})
    only = Candidates(np.array([one.motor]), np.array([one.gearhead]), np.array([one.belt]), np.array([True]))
    return evaluate(problem(moved, catalog), only)


NEEDS = "needs: {start_speed: 20 rpm +- 2 rpm, resolution_at_load: 1 deg +- 0.1 deg, inertia_ratio: 90}\n"


@pytest.mark.parametrize(
    ("part", "text"),
    [
        ("A2", TABLE + SLOW + SUPPLY.replace("26 V, min: 24 V", "50 V, min: 47.9 V") + NEEDS),  # on either chart
        ("A3", TABLE + TRAPEZOID % "900 rpm +- 20 rpm" + SUPPLY + NEEDS),
        ("A3", FLYWHEEL % ("9e-4 kg*m^2 +- 10 %", "0.1 N*m") + SINE + SUPPLY),  # torque falls as the speed rises
        ("A2", FLYWHEEL % ("3e-4 kg*m^2 +- 10 %", "0.1 N*m") + SINE.replace("200", "700") + SUPPLY),
    ],
)
def test_samples_are_what_the_plain_evaluation_says(path: Path, parts: Catalog, part: str, text: str) -> None:
    """Each check's demand, limit and verdict: to 1e-5; points between the ends of segments are at the same levels."""
    spec, one = read(path, text, part), rows_of(parts, part)
    given = given_of(spec, parts, one)
    ready = prepared(problem(spec, parts), given, sample(given, 64, 3))
    (block,) = blocks(ready, parts, [1.0])
    got = checks_of(parts, one, block)
    names = {"pull_out_torque", "supply_current", "bus_voltage", "motor_temperature_range", "controller_available"}
    assert names | ({"start_speed", "step_resolution", "inertia_ratio"} if "needs" in text else set()) <= got.keys()
    for row in (0, 41):
        for check in plainly(spec, parts, one, given, ready.values[row]).checks:
            if check.name not in got or check.name.startswith("controller_"):  # these are of the current that is set
                continue
            mine = got[check.name]
            for name in ("demand", "limit"):
                column = np.broadcast_to(getattr(mine, name), block.size)
                assert column[row] == pytest.approx(getattr(check, name)[0], rel=1e-5, nan_ok=True), check.name
            if not abs(check.margin[0] - check.needed) < 1e-4:
                for name in ("passed", "failed"):
                    assert np.broadcast_to(getattr(mine, name), block.size)[row] == getattr(check, name)[0], check.name


# --- Monte Carlo -----------------------------------------------------------------------------------------------------


def _lognormal(draw: random.Random, band: float) -> float:
    return math.exp(draw.gauss(0.0, math.log(band) / 1.6448536269514722))


def _torque_needed(J: float, friction: float, rotor: float, speed: float = 300 * RPM) -> float:
    return friction + (J + rotor) * speed / 0.15


@pytest.mark.parametrize(("part", "inertia"), [("A3", 2.0e-3), ("A2", 7e-4)])
def test_the_probability_by_plain_monte_carlo(path: Path, parts: Catalog, part: str, inertia: float) -> None:
    """The pull-out torque at the end of the acceleration, twice the load's: within 3 standard errors of 3000 draws."""
    text = FLYWHEEL % (f"{inertia} kg*m^2 +- {0.15 * inertia} kg*m^2", "0.05 N*m +- 0.02 N*m") + SLOW + SUPPLY
    draw, hits, count = random.Random(7), 0, 3000
    table = parts.steppers
    names = ("full_steps", "phase_current", "holding_torque", "resistance", "inductance", "rotor_inertia")
    motor = {name: float(table[name][table.rows[part]]) for name in names}
    curves = {24.0: [(60 * RPM, 0.42), (400 * RPM, 0.43), (700 * RPM, 0.32), (1200 * RPM, 0.17)],
              48.0: [(60 * RPM, 0.44), (900 * RPM, 0.40), (1500 * RPM, 0.28), (2400 * RPM, 0.15)]}  # fmt: skip
    for _ in range(count):
        J, friction = inertia * draw.uniform(0.85, 1.15), draw.uniform(0.03, 0.07)
        volts, rotor = draw.uniform(22.0, 26.0), motor["rotor_inertia"] * draw.uniform(0.9, 1.1)
        if part == "A2":
            available = draw.uniform(0.9, 1.1) * printed_torque(300 * RPM, volts, curves)
        else:
            set_ = draw.uniform(0.91, 1.09)
            mine = motor | {"phase_current": motor["phase_current"] * set_,
                            "holding_torque": motor["holding_torque"] * set_ * draw.uniform(0.9, 1.1),
                            "resistance": motor["resistance"] * draw.uniform(0.9, 1.1),
                            "inductance": motor["inductance"] * draw.uniform(0.8, 1.2)}  # fmt: skip
            share = PULL_OUT_SHARE[0] * _lognormal(draw, PULL_OUT_SHARE[1])
            available = share * _quick_ideal(300 * RPM, volts, mine)
        hits += available >= 2.0 * _torque_needed(J, friction, rotor)
    spec = read(path, text, part)
    found = explained(spec, part, "direct", catalog=parts, sampling=Sampling(4096, 1, None)).sets[0]
    assert found.reliability
    spread = next(one for one in found.reliability.checks if one.name == "pull_out_torque")
    p = hits / count
    assert 0.2 < p < 0.95
    assert spread.passes == pytest.approx(p, abs=3.0 * math.sqrt(p * (1.0 - p) / count))


def _quick_ideal(w: float, volts: float, motor: dict[str, float]) -> float:
    """Torque of the two-phase model by bisection along the edge of the current's disc, and that of the voltage."""
    p, I_m = motor["full_steps"] / 4.0, math.sqrt(2.0) * motor["phase_current"]
    k, R, X = motor["holding_torque"] / I_m, motor["resistance"], p * w * motor["inductance"]

    def allowed(x: float) -> bool:
        """Whether some y within the current has a voltage within the supply."""
        most = math.sqrt(max(I_m**2 - x * x, 0.0))
        best = -((R * x + k * w) * -X + X * R * x) / (X * X + R * R)  # least voltage over y
        y = min(max(best, -most), most)
        return (R * x - X * y + k * w) ** 2 + (R * y + X * x) ** 2 <= volts**2

    if allowed(I_m):
        return k * I_m
    low, high = 0.0, I_m
    for _ in range(30):
        middle = (low + high) / 2.0
        low, high = (middle, high) if allowed(middle) else (low, middle)
    return k * low


def test_the_quick_model_is_the_slow_one() -> None:
    motor = {"full_steps": 200.0, "phase_current": 2.8, "holding_torque": 1.26, "resistance": 1.1, "inductance": 3.6e-3}
    for rpm in (50, 300, 700, 1500):
        assert _quick_ideal(rpm * RPM, 24.0, motor) == pytest.approx(ideal_torque(rpm * RPM, 24.0, motor), rel=2e-3)


def test_a_wider_load_never_raises_the_probability(path: Path, parts: Catalog) -> None:
    """Of a drive that passes at nominal figures; A2 takes 2 x 0.16 N*m of 0.42."""
    found = []
    for width in (0.05, 0.3, 0.6, 0.9):
        text = FLYWHEEL % (f"7e-4 kg*m^2 +- {width * 7e-4} kg*m^2", "0.01 N*m") + SLOW + SUPPLY
        drive = explained(read(path, text), "A2", "direct", catalog=parts, sampling=Sampling(1024, 1, None)).sets[0]
        assert drive.status == "pass" and drive.reliability
        found.append(drive.reliability.probability)
    assert found == sorted(found, reverse=True)
    assert found[0] == 1.0 and found[-1] < 0.9


# --- classes, outputs, refusals --------------------------------------------------------------------------------------


def test_classes_are_those_of_a_stepper(parts: Catalog) -> None:
    """A printed curve has 10 %, an estimated share its band; holding torque and inductance are of the model alone."""
    printed, model = (
        {one.figure: one for one in holding(parts, {}, "motor", parts.motors.rows[part])} for part in ("A2", "A3")
    )
    assert set(printed) == {"resistance", "rotor_inertia", "pull_out", "start_speed"}
    assert set(model) == set(printed) | {"holding_torque", "inductance"}
    band = model["pull_out"].factor
    assert printed["pull_out"].text == "+- 10 %" and band
    assert (band.shape, band.low, band.high) == ("lognormal", pytest.approx(1 / 1.5), pytest.approx(1.5))
    assert [one.figure for one in holding(parts, {}, "controller", 0)] == ["phase_current"]


def test_size_with_a_required_confidence(path: Path, parts: Catalog) -> None:
    """Drives below it are listed apart; none is sampled in closed loop, which is said once."""
    text = FLYWHEEL % ("6.4e-4 kg*m^2 +- 3e-4 kg*m^2", "0.05 N*m") + SLOW + SUPPLY
    spec = read(path, text, "[A2, A4]")
    found = size(spec, catalog=parts, sampling=Sampling(512, 1, 0.9, loop=16))
    assert [one.motor.part for one in found.sets] == ["A4"]
    assert [one.motor.part for one in found.unsure] == ["A2"]
    best, uncertain = found.sets[0].reliability, found.uncertainty
    assert best and uncertain and best.loop is None and best.no_loop == ""
    assert any("steppers run open-loop" in note for note in uncertain.notes)
    assert {"motor_torque", "pull_out_at_rest", "pull_out_at_speed"} <= {one.name for one in best.figures}
    weak = found.unsure[0].reliability
    assert weak and weak.weakest == "Pull-out torque at the speed"
    assert weak.drivers[0].name == "load.inertia" and weak.drivers[0].low_margin > weak.drivers[0].high_margin
    assert '"pull_out_at_rest"' in as_text(found)


@pytest.mark.parametrize(
    ("kind", "given", "said"),
    [
        ("stepper", "motor: {torque_constant: +- 5 %}", "tolerances.motor.torque_constant: no check of a stepper"),
        ("brushed", "motor: {pull_out: +- 5 %}", "tolerances.motor.pull_out: it is of steppers; expected select"),
        ("brushed", "controller: {phase_current: +- 5 %}", "tolerances.controller.phase_current: it is of steppers"),
    ],
)
def test_tolerances_of_other_motors_are_refused(kind: str, given: str, said: str) -> None:
    text = f"name: x\n{TABLE}{SLOW}{SUPPLY}tolerances: {{{given}}}\nselect: {{motor: {{kind: {kind}}}}}\n"
    assert said in refusal(lambda: read_spec(YamlSource(text, "robot.yaml")))
