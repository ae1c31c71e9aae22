"""Steppers in the search: checks against plain Python over random loads, drivers, outputs, and what is refused."""

from __future__ import annotations

import math
import random
from dataclasses import replace
from pathlib import Path
from statistics import NormalDist
from typing import Any

import numpy as np
import pytest
from refusals import refusal
from stepper_catalog import ideal_torque, printed_torque, worst_share, written

from drivesizer import load_spec, size
from drivesizer.catalog import Catalog, load
from drivesizer.errors import InputError
from drivesizer.machine.set_cycle import set_cycle
from drivesizer.machine.supply_power import energy_flow
from drivesizer.physics.stepper import PULL_OUT_SHARE
from drivesizer.results.check import Check
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import SizingResult
from drivesizer.search.shortlist import load_parts
from drivesizer.sizing import explained

RPM = math.pi / 30.0
DRAW = random.Random(2100)


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("steps"))


@pytest.fixture(scope="module")
def catalog(path: Path) -> Catalog:
    return load([str(path)])


def spec_of(path: Path, **changes: Any) -> dict[str, Any]:
    given: dict[str, Any] = {
        "name": "table",
        "load": {"kind": "flywheel", "inertia": "4e-4 kg*m^2"},
        "motion": {"speed": "300 rpm", "acceleration_time": "0.15 s", "cruise_time": "0.5 s", "rest_time": "0.3 s"},
        "transmission": [{"kind": "direct"}],
        "supply": {"nominal": "24 V", "current": "6 A"},
        "select": {"catalogs": [str(path)], "motor": {"kind": "stepper"}},
    }
    for name, value in changes.items():
        given[name] = value if not isinstance(value, dict) or name not in given else {**given[name], **value}
    return given


def sized(path: Path, **changes: Any) -> SizingResult:
    return size(load_spec(spec_of(path, **changes)), top=20)


def check(drive: DriveSet, name: str) -> Check:
    return next(one for one in drive.checks if one.name == name)


def figures(catalog: Catalog, part: str) -> dict[str, float]:
    row, table = catalog.steppers.rows[part], catalog.steppers
    names = ("full_steps", "phase_current", "holding_torque", "resistance", "inductance", "rotor_inertia")
    return {name: float(table[name][row]) for name in names}


# --- brute force -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("part", ["A1", "A2", "A3", "A4"])
def test_the_share_of_the_pull_out_torque_by_brute_force(path: Path, catalog: Catalog, part: str) -> None:
    """Random loads, supplies and gears: torque and pull-out torque at 33 moments of every segment."""
    motor, curves = figures(catalog, part), catalog.pull_outs
    own = curves.on(curves.stepper == catalog.steppers.rows[part])
    printed = {
        float(volts): list(zip(own.speed[own.voltage == volts], own.torque[own.voltage == volts], strict=True))
        for volts in np.unique(own.voltage)
    }
    for _ in range(2):
        volts, ratio = DRAW.choice((18.0, 24.0, 30.0, 48.0)), DRAW.choice((1.0, 4.0, 7.0))
        J, weight = DRAW.uniform(1e-4, 2e-3), DRAW.uniform(0.01, 0.2)
        spec = load_spec(spec_of(
            path,
            load={"kind": "rotary_table", "inertia": f"{J} kg*m^2", "friction_torque": f"{weight} N*m"},
            motion={"speed": f"{DRAW.uniform(20, 500) / ratio} rpm", "acceleration_time": f"{DRAW.uniform(0.1, 1)} s",
                    "cruise_time": "0.4 s"},
            transmission=[{"kind": "direct" if ratio == 1.0 else "gearhead"}], supply={"nominal": f"{volts} V"},
        ))  # fmt: skip
        row = catalog.gearheads.rows.get({4.0: "G4", 7.0: "G7"}.get(ratio, ""), -1)
        J_g = float(catalog.gearheads["inertia"][row]) if row >= 0 else 0.0
        eta = 0.95 if row >= 0 else 1.0
        view = load_parts(spec, catalog)
        if row >= 0:
            view = replace(view, motor_gearhead=_with_all(view))
        found = explained(spec, part, "direct" if row < 0 else {4.0: "G4", 7.0: "G7"}[ratio], catalog=view).sets[0]

        def at_motor(T: float, w: float, a: float, i: float = ratio, e: float = eta, J_g: float = J_g) -> Any:
            along = T / (i * e) if T * w > 0.0 else T * e / i if T * w < 0.0 else T / i
            return along + (motor["rotor_inertia"] + J_g) * i * a, w * i

        def available(w: float, volts: float = volts) -> float:
            return printed_torque(w, volts, printed) if printed else PULL_OUT_SHARE[0] * ideal_torque(w, volts, motor)

        one, expected = check(found, "pull_out_torque"), worst_share(_cycle(spec), at_motor, available)
        assert one.demand / one.limit == pytest.approx(expected, rel=0.012)
        assert (one.status == "pass") == (one.demand * 2.0 <= one.limit) or one.status == "open"


def _with_all(view: Catalog) -> Any:
    """Every stepper with every gearhead, whatever its shaft."""
    left, right = np.meshgrid(np.arange(len(view.motors)), np.arange(len(view.gearheads)), indexing="ij")
    pairs = view.motor_gearhead
    return pairs._replace(left=left.ravel(), right=right.ravel(), source=np.zeros(left.size, np.int32))


def _cycle(spec: Any) -> Any:
    from drivesizer.load_cases import load_cycle

    return load_cycle(spec)


# --- one drive -------------------------------------------------------------------------------------------------------


def test_a_drive_with_its_driver_passes(path: Path) -> None:
    """J = 4e-4 and 82e-7 kg*m^2 to 300 rpm in 0.15 s: 0.0855 N*m at 300 rpm, where A2's chart has 0.42."""
    drive = next(one for one in sized(path).sets if one.motor.part == "A2")
    assert drive.status == "pass"
    assert check(drive, "pull_out_torque").demand == pytest.approx((4e-4 + 82e-7) * 300 * RPM / 0.15, rel=1e-6)
    assert check(drive, "pull_out_torque").limit == pytest.approx(0.42)
    assert check(drive, "pull_out_torque").needed == 1.0
    assert drive.controller is not None
    assert drive.controller.part == "D2"  # 2.2 A RMS, 3.1 A amplitude for 2 A and 2.83 A
    assert list(drive.parts) == ["motor", "controller"]  # no encoder: it runs open-loop
    values = {figure.name: figure.value for figure in drive.figures}
    assert values["joule_heat"] == pytest.approx(2 * 2.0**2 * 1.6)
    assert values["peak_current"] == pytest.approx(2.0 * math.sqrt(2.0))
    assert values["step_rate"] == pytest.approx(300 / 60 * 200)
    assert values["pull_out_at_rest"] == values["pull_out_at_speed"] == pytest.approx(0.42)
    T, steps = 1.1, 0.15 * 2 + 0.5 + 0.3
    assert pytest.approx(steps) == T
    assert values["energy"] == pytest.approx(12.8 * T, rel=1e-6)  # what accelerates comes back into the windings


def test_a_price_list_of_motors_that_are_no_steppers_changes_nothing(path: Path) -> None:
    """Banebots prices its motors in a list; the search for steppers has none of these."""
    spec = load_spec(spec_of(path, select={"catalogs": [str(path), "banebots"]}))
    (best,) = size(spec, catalog=load_parts(spec), top=1).sets
    assert best.label == sized(path).sets[0].label


def test_drivers_by_current_and_supply(path: Path) -> None:
    at = {one.motor.part: one for one in sized(path).sets}
    assert at["A3"].controller is not None
    assert at["A3"].controller.part == "D4"
    high = {one.motor.part: one for one in sized(path, supply={"nominal": "48 V"}).sets}
    assert {one.controller.part for one in high.values() if one.controller} == {"D4"}  # D2 ends at 30 V
    assert not {"B1", "B2"} & set(high)  # which take 30 V


def test_resolution_is_that_of_the_microsteps_that_are_set(path: Path) -> None:
    """360 degrees / (200 x 8) = 0.225 degrees, whatever finer ones a driver has; S9 prints none and runs these."""
    found = sized(path, needs={"resolution_at_load": "0.23 deg"}, control={"microsteps": 8}).sets
    assert {round(math.degrees(check(one, "step_resolution").demand), 6) for one in found} <= {0.225, 0.1125}
    assert check(next(one for one in found if one.motor.part == "A2"), "step_resolution").demand == pytest.approx(
        math.radians(0.225)
    )
    few = sized(path, needs={"resolution_at_load": "0.2 deg"}, control={"microsteps": 8})
    assert "A2" not in {one.motor.part for one in few.sets}


def test_resonance_is_advice(path: Path) -> None:
    """A2 with the flywheel swings at 43.2 Hz: 12.4 rpm is 41.3 full steps a second."""
    swings = math.sqrt(50 * 0.59 / (4e-4 + 82e-7)) / (2 * math.pi)
    slow = sized(path, motion={"speed": "12.4 rpm"})
    near = check(next(one for one in slow.sets if one.motor.part == "A2"), "step_resonance")
    assert near.limit == pytest.approx(swings / (12.4 / 60 * 200), rel=1e-6)
    assert (near.status, near.advice) == ("fail", True)
    assert check(next(one for one in sized(path).sets if one.motor.part == "A2"), "step_resonance").status == "pass"


def test_an_estimated_share_leaves_a_check_open_with_its_probability(path: Path) -> None:
    """A3 at a load between both ends of the band: 0.45 and 1.0 of the model's 1.26 N*m."""
    found = sized(path, load={"inertia": "2.4e-3 kg*m^2"}, select={"motor": {"kind": "stepper", "part": "A3"}})
    drive = found.sets[0]
    one = check(drive, "pull_out_torque")
    assert one.status == "open"
    sigma = math.log(PULL_OUT_SHARE[1]) / NormalDist().inv_cdf(0.95)
    assert one.probability == pytest.approx(NormalDist().cdf(math.log(one.limit / (2 * one.demand)) / sigma), abs=0.02)
    assert "pull out share" in one.note
    assert [figure.figure for figure in drive.estimated] == ["pull_out_share"]
    off = sized(path, load={"inertia": "2.4e-3 kg*m^2"}, select={"motor": {"kind": "stepper", "part": "A3"},
                                                               "estimates": "off"})  # fmt: skip
    assert check(off.sets[0], "pull_out_torque").status == "unknown"


def test_beyond_the_printed_curve_torque_is_unknown(path: Path) -> None:
    found = sized(path, motion={"speed": "1300 rpm", "acceleration_time": "1.5 s"},
                  select={"motor": {"kind": "stepper", "part": "A2"}})  # fmt: skip
    assert check(found.sets[0], "pull_out_torque").status == "unknown"


# --- outputs ---------------------------------------------------------------------------------------------------------


def test_the_battery_feeds_steppers(path: Path) -> None:
    """A cycle of 12.8 W of loss: its mean at the battery is that, the flywheel's energy goes into the windings."""
    battery = {"nominal_voltage": "24 V", "capacity": "5 A*h"}
    found = sized(path, battery=battery, select={"motor": {"kind": "stepper", "part": "A2"}})
    assert found.sets[0].energy is not None
    assert found.sets[0].energy.mean_power == pytest.approx(12.8, rel=1e-6)


def figure(drive: DriveSet, name: str) -> float:
    return next(one.value for one in drive.figures if one.name == name)


def test_the_current_that_is_set_by_hand(path: Path) -> None:
    """A2 at 1.5 of 2 A: 3/4 of 0.59 N·m; 2·1.6·1.5² W, at rest a quarter, 0.3 of 1.1 s.

    Of the printed 0.42 N·m 3/4 of what the field has, with 5 % of 0.59 N·m for the rotor's own: 0.3076 N·m.
    """
    select = {"motor": {"kind": "stepper", "part": "A2"}}
    control = {"phase_current": "1.5 A", "idle_current": "50 %"}
    (rated, *_), (drive, *_) = (sized(path, select=select, **more).sets for more in ({}, {"control": control}))
    assert drive.motor.holding_torque == pytest.approx(0.75 * 0.59)
    for name in ("pull_out_at_rest", "pull_out_at_speed"):
        assert (figure(rated, name), figure(drive, name)) == pytest.approx((0.42, 0.307625))
    assert check(drive, "pull_out_torque").limit == pytest.approx(0.307625)
    heat = 7.2 * (0.8 + 0.25 * 0.3) / 1.1
    assert figure(drive, "joule_heat") == pytest.approx(heat)
    assert figure(drive, "peak_current") == pytest.approx(1.5 * math.sqrt(2.0))
    assert figure(drive, "energy") == pytest.approx(1.1 * heat, rel=1e-6)  # the flywheel's goes into the windings
    nominal = check(drive, "motor_nominal_current")
    assert (nominal.demand, nominal.limit, nominal.status) == (1.5, 2.0, "pass")
    assert figure(drive, "natural_frequency") == pytest.approx(math.sqrt(0.75) * figure(rated, "natural_frequency"))


def test_more_than_the_rated_current_fails(path: Path) -> None:
    found = sized(path, control={"phase_current": "2.5 A"})
    assert {one.motor.part for one in found.sets} <= {"A3", "A4", "B2"}  # of 2.8, 4.2 and 3 A
    assert found.counts.failed_by["motor_nominal_current"] == 3


def test_idle_current_holds_less_at_rest(path: Path) -> None:
    """0.8 kg on a drum of 40 mm: 0.157 N·m, held by 40 % of the 0.42 N·m of the curve."""
    given = {
        "load": {"kind": "hoist", "mass": "0.8 kg", "drum_diameter": "40 mm"}, "margins": {"pull_out": 1},
        "motion": {"speed": "0.1 m/s", "acceleration_time": "0.3 s", "cruise_time": "0.5 s", "rest_time": "1 s",
                   "there_and_back": True},
        "supply": {"nominal": "24 V", "accepts": "all"},
        "select": {"motor": {"kind": "stepper", "part": "A2"}, "catalogs": [str(path)]},
    }  # fmt: skip
    held, lost = (
        size(load_spec({**spec_of(path), **given, "control": {"idle_current": idle}}), top=1)
        for idle in ("40 %", "30 %")
    )
    idle = check(held.sets[0], "idle_torque")
    assert (idle.demand, idle.limit) == (pytest.approx(0.8 * 9.80665 * 0.02), pytest.approx(0.4 * 0.42))
    assert idle.status == "pass"
    assert not lost.sets
    assert check(lost.misses[0], "idle_torque").status == "fail"


def test_energy_of_a_cycle_is_all_accounted_for(path: Path) -> None:
    """What is drawn less what is returned is lost in windings and gears, done on the load, or in the rotor."""
    load = {"kind": "rotary_table", "inertia": "1e-3 kg*m^2", "friction_torque": "0.15 N*m"}
    found = sized(path, load=load, transmission=[{"kind": "gearhead"}], motion={"speed": "40 rpm"})
    drive = next(one for one in found.sets if one.gearhead.part == "G7")
    flow = energy_flow(set_cycle(found.problem.spec, drive))
    spent = flow.load + flow.belt + flow.gearhead + flow.friction + flow.copper + flow.rotor + flow.controller
    assert flow.drawn - flow.returned == pytest.approx(spent, rel=1e-9)
    assert flow.drawn == pytest.approx(next(f.value for f in drive.figures if f.name == "energy"), rel=1e-9)
    assert flow.copper == pytest.approx(2 * drive.motor.nominal_current**2 * drive.motor.resistance * 1.1)


def test_what_is_returned_stays_on_the_bus(path: Path) -> None:
    """A flywheel that stops faster than the windings take it: all of it in 10 mF, 24 V to sqrt(24^2 + 2 E / C)."""
    given = {"load": {"inertia": "7e-4 kg*m^2"}, "motion": {"speed": "600 rpm"}, "margins": {"pull_out": 1},
             "select": {"motor": {"kind": "stepper", "part": "A2"}}}  # fmt: skip
    open_ = check(sized(path, **given).sets[0], "bus_voltage")
    assert (open_.status, "supply.capacitance" in open_.note) == ("unknown", True)
    found = sized(path, **given, supply={"capacitance": "10 mF"}).sets[0]
    energy = next(figure.value for figure in found.figures if figure.name == "returned")
    assert energy > 0.1
    assert check(found, "bus_voltage").demand == pytest.approx(math.sqrt(24.0**2 + 2 * energy / 0.01))
    assert check(sized(path, **given, supply={"accepts": "all"}).sets[0], "bus_voltage").status == "pass"


# --- what is refused -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"method": "paper"}, "the paper treats DC motors, no steppers; expected method: physics"),
        ({"select": {"catalogs": ["vex"]}}, "vex without steppers; expected e.g. stepperonline"),
        ({"margins": {"pull_out": 0.5}}, "pull_out"),
        ({"control": {"idle_current": "50 %"}, "select": {"motor": {}}}, "control.idle_current: it is of steppers"),
        ({"control": {"phase_current": "1.5"}}, "phase_current"),
        ({"needs": {"start_speed": "-5 rpm"}}, "start_speed"),
        ({"needs": {"start_speed": "5 rpm"}, "select": {"motor": {}}}, "start_speed: it is of steppers; expected sel"),
    ],
)
def test_refused_in_a_line(path: Path, changes: dict[str, Any], said: str) -> None:
    assert said in refusal(lambda: sized(path, **changes))


def test_catalogues_of_steppers_alone_ask_for_the_kind() -> None:
    given = spec_of(Path("stepperonline"), select={"motor": {}})
    with pytest.raises(InputError, match=r"only steppers are in them; expected select: \{motor: \{kind: stepper\}\}"):
        size(load_spec(given))
