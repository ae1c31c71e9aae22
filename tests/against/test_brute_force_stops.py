"""Shocks, emergency stops and steppers that start: every check against plain Python over random sets.

The plain side follows a stop in small steps, and the rotor of a stepper along its angle; it has no formula of the
program's.
"""

from __future__ import annotations

import math
import random
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from stepper_catalog import ideal_torque, printed_torque, written

from drivesizer.catalog import Brake, Encoder, Gearhead, Motor, load
from drivesizer.load_cases import load_cycle
from drivesizer.machine.problem import problem
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.physics.motor_demand import demands
from drivesizer.physics.stepper import PULL_OUT_SHARE
from drivesizer.physics.winding import Parts
from drivesizer.search.columns.brakes import brake_inertia, brake_limits
from drivesizer.search.columns.candidates import Candidates
from drivesizer.search.columns.evaluation import evaluate
from drivesizer.search.columns.shaft_limits import shock_limits
from drivesizer.search.shortlist import load_parts
from drivesizer.spec.robot import RobotSpec, load_spec

NAN, RPM = math.nan, math.pi / 30.0
PRINTED = ("full_steps", "phase_current", "holding_torque", "resistance", "inductance", "start_speed")


def verdict(passes: bool | None) -> str:
    return "unknown" if passes is None else "pass" if passes else "fail"


def within(demand: float, limit: float, needed: float = 0.0) -> bool | None:
    """Whether a demand with its margin is within a limit; None where either is unknown, but what never ends is not."""
    if demand == math.inf and limit != math.inf:
        return False
    return None if math.isnan(demand) or math.isnan(limit) else demand * (1.0 + needed) <= limit


def status(check: Any, row: int) -> str:
    return "pass" if check.passed[row] else "fail" if check.failed[row] else "unknown"


def columns(kind: Any, rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Records of a kind of part with some figures each, as columns."""
    records = [asdict(kind(**row)) for row in rows]
    return {name: np.array([one[name] for one in records]) for name in records[0]}


def some(chance: random.Random, low: float, high: float) -> float:
    """A figure, one in four times unknown."""
    return chance.choice([NAN, *[chance.uniform(low, high)] * 3])


# --- shocks ----------------------------------------------------------------------------------------------------------


def test_shocks_of_random_gearheads() -> None:
    chance = random.Random(11)
    for _ in range(12):
        shock, needed, belt, gear = (chance.uniform(*span) for span in ((5, 90), (0, 0.3), (0.5, 3), (1.5, 4)))
        stages = [{"kind": "gearhead"}, {"kind": "belt", "ratio": belt, "efficiency": 0.9}]
        geared = chance.random() < 0.5
        if geared:
            stages.append({"kind": "gear", "ratio": gear, "efficiency": 0.8})
        spec = load_spec({
            "name": "x", "load": {"kind": "flywheel", "inertia": "1 kg*m^2"}, "supply": {"nominal": "24 V"},
            "motion": {"speed": "60 rpm", "acceleration_time": "1 s", "cruise_time": "1 s"}, "transmission": stages,
            "needs": {"shock_torque": f"{shock} N*m"}, "margins": {"torque": needed},
        })  # fmt: skip
        rows = [{"kind": chance.choice(["planetary", "strain wave"]), "emergency_torque": some(chance, 1, 60),
                 "ratcheting_torque": some(chance, 1, 60)} for _ in range(25)]  # fmt: skip
        cycle = CycleAtBelt(load_cycle(spec), spec.belt_efficiency).behind(belt)
        hard, jumps = shock_limits(spec, spec.needs.shock_torque or NAN, cycle, columns(Gearhead, rows))
        torque = shock / belt / (gear if geared else 1.0)  # no loss helps
        for n, row in enumerate(rows):
            assert hard.demand[n] == pytest.approx(torque)
            assert status(hard, n) == verdict(within(torque, row["emergency_torque"], needed))
            teeth = row["ratcheting_torque"] if row["kind"] == "strain wave" else math.inf
            assert status(jumps, n) == verdict(within(torque, teeth, needed))


# --- emergency stops -------------------------------------------------------------------------------------------------


def stopped(J: float, w: float, slips: float, pulls: float, late: float) -> float:
    """Energy in a brake that slips [J], in steps: the load speeds the rotor up until it has its torque."""
    if slips <= pulls:
        return math.inf if w > 0.0 else 0.0
    w, energy, steps = w + pulls / J * late, 0.0, 200
    step = w / ((slips - pulls) / J) / steps
    for n in range(steps):
        energy += slips * w * (1.0 - (n + 0.5) / steps) * step
    return energy


class Lift(NamedTuple):
    """A hoist and what is required of its brake."""

    spec: RobotSpec
    weight: float  # N*m at the load's shaft
    inertia: float  # kg*m^2 there
    speed: float  # rad/s
    number: int
    belt: float
    needed: float


def lifts(chance: random.Random) -> Lift:
    mass, speed, belt = chance.uniform(2, 60), chance.uniform(0.05, 0.6), chance.uniform(0.6, 2.5)
    number, needed = chance.choice([10, 900, 1500]), chance.choice([0.0, 0.15])
    spec = load_spec({
        "name": "x", "load": {"kind": "hoist", "mass": f"{mass} kg", "drum_diameter": "80 mm", "inertia": "9 kg*cm^2"},
        "motion": {"speed": f"{speed} m/s", "acceleration_time": "0.5 s", "cruise_time": "1 s", "there_and_back": True},
        "transmission": [{"kind": "gearhead"}, {"kind": "belt", "ratio": belt, "efficiency": 0.9}],
        "supply": {"nominal": "24 V"}, "needs": {"emergency_stops": number}, "margins": {"torque": needed},
    })  # fmt: skip
    return Lift(spec, mass * 9.80665 * 0.04, mass * 0.04**2 + 9e-4, speed / 0.04, number, belt, needed)


def stop_verdicts(lift: Lift, motor: Any, gear: Any, brake: Any) -> dict[str, str]:
    """Checks of one brake in plain Python; of a slipping torque that is not printed at both ends of its band."""
    total = gear["ratio"] * lift.belt
    turns = total if brake["shaft"] == "load" else 1.0  # of the motor for one of the brake
    own = motor["rotor_inertia"] + gear["inertia"] + brake["inertia"] / turns**2
    J, w = (own + lift.inertia / total**2) * turns**2, lift.speed * total / turns
    ends = [1.0 / 3.0, 1.0] if math.isnan(brake["dynamic_torque"]) else [1.0]
    slips = [(brake["static_torque"] if len(ends) > 1 else brake["dynamic_torque"]) * share for share in ends]
    energies = [stopped(J, w, one, lift.weight / total * turns, brake["engage_time"]) for one in slips]
    heats = {within(one, brake["energy_per_stop"]) for one in energies}
    permitted = [np.fmin(brake["total_energy"] / one, brake["emergency_stops"]) for one in energies]
    counts = {within(lift.number, float(one)) for one in permitted}
    i, weight = gear["ratio"], lift.weight / lift.belt
    strongest = np.fmax(brake["static_torque"], brake["dynamic_torque"])
    load = lift.inertia / lift.belt**2
    through = weight + load * max(strongest - weight / i, 0.0) / (own + load / i**2) / i
    few = lift.number <= 1000 and not math.isnan(gear["emergency_torque"])
    limit = gear["emergency_torque"] if few else gear["intermittent_torque"]
    passed = True if brake["shaft"] == "load" else within(through, limit, lift.needed)
    one_of = {name: verdict(found.pop() if len(found) == 1 else None) for name, found in
              (("brake_stop_energy", heats), ("brake_stops", counts))}  # fmt: skip
    return one_of | {"gearhead_stop_torque": verdict(passed)}


def test_emergency_stops_of_random_drives() -> None:
    chance, seen = random.Random(12), set[tuple[str, str]]()
    for _ in range(12):
        lift = lifts(chance)
        motors = [{"rotor_inertia": chance.uniform(1e-6, 1e-4), "torque_constant": 0.05, "kind": "brushed",
                   "no_load_current": 0.1} for _ in range(30)]  # fmt: skip
        gears = [{"ratio": chance.uniform(3, 60), "inertia": chance.uniform(1e-7, 1e-5), "efficiency": 0.8,
                  "emergency_torque": some(chance, 5, 90), "intermittent_torque": some(chance, 5, 60)}
                 for _ in range(30)]  # fmt: skip
        brakes = [{"part": "b", "static_torque": chance.uniform(0.3, 9), "dynamic_torque": some(chance, 0.2, 8),
                   "inertia": chance.uniform(1e-7, 1e-5), "engage_time": chance.uniform(0, 0.06),
                   "energy_per_stop": some(chance, 0.5, 60), "total_energy": some(chance, 1e3, 2e5),
                   "emergency_stops": some(chance, 100, 2000), "shaft": chance.choice(["", "load"])}
                  for _ in range(30)]  # fmt: skip
        cycle = CycleAtBelt(load_cycle(lift.spec), 0.9).behind(lift.belt)
        motor, gearhead, brake = (columns(*pair) for pair in ((Motor, motors), (Gearhead, gears), (Brake, brakes)))
        encoder = columns(Encoder, [{}] * 30)
        parts = Parts(motor, gearhead, encoder, None, brake)
        demand = demands(cycle, motor, gearhead, encoder, brake_inertia(parts, lift.belt))
        checks = {one.name: one for one in brake_limits(lift.spec, cycle, parts, demand, np.ones(30, bool))}
        for n, three in enumerate(zip(motors, gears, brakes, strict=True)):
            for name, expected in stop_verdicts(lift, *three).items():
                assert status(checks[name], n) == expected, (name, n)
                seen.add((name, expected))
    assert len(seen) == 9  # each check passes, fails and is unknown somewhere


# --- steppers --------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("steps"))


def started(ratio: float) -> float:
    """Share of its speed at which a rotor starts, with a load of that share of its torque: work along its angle."""
    if ratio >= 1.0:
        return 0.0
    rest, steps = math.asin(ratio), 2000
    step = (math.pi - 2.0 * rest) / steps
    return math.sqrt(sum((math.sin(rest + (n + 0.5) * step) - ratio) * step for n in range(steps)) / 2.0)


def test_starts_and_inertias_of_random_steppers(path: Path) -> None:
    """Every stepper directly and behind every gearhead: start without a ramp, inertia ratio, resonance, resolution."""
    chance, catalog = random.Random(13), load([str(path)])
    curves, seen = catalog.pull_outs, set[tuple[str, str]]()
    printed = {}
    for volts in np.unique(curves.voltage):
        at = curves.voltage == volts
        printed[float(volts)] = list(zip(curves.speed[at].tolist(), curves.torque[at].tolist(), strict=True))
    for _ in range(12):
        J, rubs, volts = 10 ** chance.uniform(-5, -2.5), chance.uniform(0.001, 0.6), chance.choice([18.0, 24.0, 48.0])
        rate, start, belt = chance.uniform(20, 200), 10 ** chance.uniform(1, 2.6), chance.uniform(0.6, 1.8)
        fine, most, needed = chance.uniform(0.03, 0.5), chance.uniform(1, 40), chance.choice([0.0, 0.2])
        spec = load_spec({
            "name": "x", "supply": {"nominal": f"{volts} V"}, "margins": {"speed": needed},
            "load": {"kind": "rotary_table", "inertia": f"{J} kg*m^2", "friction_torque": f"{rubs} N*m"},
            "motion": {"speed": f"{rate} rpm", "acceleration_time": "0.3 s", "cruise_time": "0.4 s"},
            "transmission": [{"kind": "gearhead"}, {"kind": "belt", "ratio": belt, "efficiency": 0.9}],
            "needs": {"start_speed": f"{start} rpm", "resolution_at_load": f"{fine} deg", "inertia_ratio": most},
            "select": {"catalogs": [str(path)], "motor": {"kind": "stepper"}},
        })  # fmt: skip
        view = load_parts(spec, catalog)
        left, right = (x.ravel() for x in np.meshgrid(range(len(view.motors)), range(len(view.gearheads))))
        sets = Candidates(left, right, np.full(left.size, belt), np.ones(left.size, bool))
        found = evaluate(problem(spec, view), sets)
        checks = {one.name: one for one in found.checks}
        for n, (m, g) in enumerate(zip(left.tolist(), right.tolist(), strict=True)):
            one, gear = view.motors.record(m), view.gearheads.record(g)
            row = catalog.steppers.rows[one.part]
            motor = {name: float(catalog.steppers[name][row]) for name in PRINTED}
            total = gear.ratio * belt
            opposes = rubs / (total * gear.efficiency * 0.9)
            has = one.part == "A2"
            torque = printed_torque(0.0, volts, printed) if has else PULL_OUT_SHARE[0] * ideal_torque(0, volts, motor)
            own, load_at = one.rotor_inertia + gear.inertia, J / total**2
            limit = motor["start_speed"] * math.sqrt(one.rotor_inertia / (own + load_at)) * started(opposes / torque)
            check = checks["start_speed"]
            assert check.limit[n] == pytest.approx(limit, rel=1e-4, abs=1e-6), (one.part, gear.part)
            open_ = bool(check.on(n).opened)
            if not open_ and abs(start * RPM * (1 + needed) / max(limit, 1e-9) - 1.0) > 1e-3:
                assert status(check, n) == verdict(within(start * RPM, limit, needed)) or not has
                seen.add(("start", status(check, n)))
            assert checks["inertia_ratio"].demand[n] == pytest.approx(load_at / own)
            assert status(checks["inertia_ratio"], n) == verdict(within(load_at / own, most))
            driver = int(found.controller[n])
            parts = float(view.controllers["microsteps"][driver]) if driver >= 0 else NAN
            full = 2.0 * math.pi / motor["full_steps"] / total
            angle = full if math.isnan(parts) and full <= math.radians(fine) else full / parts
            assert checks["step_resolution"].demand[n] == pytest.approx(angle, nan_ok=True)
            swings = math.sqrt(motor["full_steps"] / 4 * motor["holding_torque"] / (own + load_at)) / (2 * math.pi)
            apart = rate / 60 * total * motor["full_steps"] / swings
            assert checks["step_resonance"].limit[n] == pytest.approx(max(apart, 1 / apart))
    assert {("start", "pass"), ("start", "fail")} <= seen
