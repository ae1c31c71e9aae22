"""What a machine regenerates and burns: a bus walked through time in plain Python, and the choice of a resistor."""

from __future__ import annotations

import json
import math
import random

import numpy as np
import pytest
from kernel_cycles import motor_power
from refusals import refusal

from drivesizer.catalog import load
from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine.problem import problem
from drivesizer.machine.set_cycle import set_cycle
from drivesizer.output.json.documents import plain as document
from drivesizer.output.parts import machine_parts, totals
from drivesizer.results.drive_set import DriveSet
from drivesizer.search.shortlist import load_parts
from drivesizer.sizing import explain
from drivesizer.spec.robot import RobotSpec, read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

WHEEL = """
name: a wheel that is stopped
load: {kind: flywheel, inertia: %s, friction_torque: 1 mN*m}
motion: {speed: %s, acceleration_time: 1 s, cruise_time: 1 s, deceleration_time: %s, rest_time: 5 s}
supply: {nominal: 24 V, %s}
power_stage: {voltage_drop: 0 V}
select: {catalogs: [maxon], controller: {part: "541718"}}
"""
OWN = "brake_resistor: {resistance: 8 ohm, power: 20 W, peak_power: 200 W, pulse_energy: 30 J, %s}"
CHOPPER = "chopper_voltage: 28 V, chopper_current: 5 A"


def wheel(supply="regeneration: 0", more="", inertia="3e-4 kg*m^2", speed="600 rpm", stops="100 ms") -> RobotSpec:
    return read_spec(YamlSource(WHEEL % (inertia, speed, stops, supply) + more, "wheel.yaml"))


def stopped(catalog, **given) -> DriveSet:
    (one,) = explain(wheel(**given), "110940", "406764", catalog=catalog)
    return one


def figures(one: DriveSet) -> dict[str, float]:
    assert one.braking is not None
    return {figure.name: figure.value for figure in one.braking.figures}


def check(one: DriveSet, name: str):
    return next(c for c in one.every_check if c.name == name)


# --- against a bus walked through time ------------------------------------------------------------------------------


def _walked(spec: RobotSpec, one: DriveSet, chopper: float, steps: int = 400) -> tuple[float, float, float]:
    """Energy burnt in the third cycle, largest power and longest braking's energy; the capacitor by its voltage."""
    found = set_cycle(spec, one)
    C, volts = spec.supply.capacitance or 0.0, spec.supply.highest
    low, burnt, peak, run, longest = volts, 0.0, 0.0, 0.0, 0.0
    for cycle in range(3):
        for piece, lasts in enumerate(found.pieces.duration.tolist()):
            dt = lasts / steps
            for power in motor_power(found, piece, (np.arange(steps) + 0.5) / steps).tolist():
                square = volts**2 - 2.0 * power * dt / C if C else (low**2 if power >= 0.0 else math.inf)
                over = 0.0
                if square > chopper**2:
                    over = 0.5 * C * (square - chopper**2) if C else -power * dt
                    square = chopper**2
                volts = math.sqrt(max(square, low**2)) if C else low
                run = run + over if over > 0.0 else 0.0
                if cycle == 2 and over > 0.0:
                    burnt, peak, longest = burnt + over, max(peak, over / dt), max(longest, run)
    return burnt, peak, longest


@pytest.mark.parametrize("seed", range(3))
def test_what_is_burnt_is_that_of_a_bus_walked_through_time(catalog, seed):
    of = random.Random(seed)
    given = {
        "inertia": f"{of.uniform(2e-4, 6e-4):.3g} kg*m^2",
        "speed": f"{of.uniform(500, 800):.4g} rpm",
        "stops": f"{of.uniform(80, 300):.4g} ms",
        "supply": of.choice(["regeneration: 0", f"capacitance: {of.uniform(0.2, 6):.3g} mF"]),
    }
    one = stopped(catalog, more=OWN % CHOPPER, **given)
    energy, peak, pulse = _walked(wheel(more=OWN % CHOPPER, **given), one, 28.0)
    found = figures(one)
    # pieces of the cycle are a sixteenth of a segment: where the bus is full within one, its peak counts as burnt
    assert found["energy_burnt"] == pytest.approx(energy, rel=0.01, abs=1e-3)
    assert found["braking_peak_power"] >= 0.99 * peak and found["braking_peak_power"] <= 1.15 * peak + 0.1
    assert found["braking_pulse"] == pytest.approx(pulse, rel=0.02, abs=1e-3)


def test_the_capacitance_that_needs_no_resistor_is_that_of_the_bus_check(catalog):
    needed = figures(stopped(catalog, supply="regeneration: 0"))["capacitance_needed"]
    for factor, status in ((1.001, "pass"), (0.999, "fail")):
        assert check(stopped(catalog, supply=f"capacitance: {factor * needed} F"), "bus_voltage").status == status


# --- checks ---------------------------------------------------------------------------------------------------------


def test_a_resistor_decides_the_bus(catalog):
    """Without anything the bus is unknown; the chopper holds it, and each limit of the resistor is by its formula."""
    assert check(stopped(catalog), "bus_voltage").status == "unknown"
    one = stopped(catalog, more=OWN % CHOPPER)
    bus, found = check(one, "bus_voltage"), figures(one)
    assert (bus.status, bus.demand) == ("pass", 28.0)
    assert check(one, "resistor_resistance").limit == pytest.approx(28.0**2 / found["braking_peak_power"])
    assert check(one, "resistor_peak_power").demand == pytest.approx(28.0**2 / 8)
    assert check(one, "chopper_current").demand == pytest.approx(28.0 / 8)
    assert check(one, "resistor_mean_power").demand == pytest.approx(found["braking_mean_power"])
    assert found["braking_mean_power"] >= found["energy_burnt"] / 7.1


@pytest.mark.parametrize(
    ("field", "value", "name"),
    [
        ("resistance: 8 ohm", "resistance: 800 ohm", "resistor_resistance"),
        ("peak_power: 200 W", "peak_power: 90 W", "resistor_peak_power"),
        ("power: 20 W", "power: 0.01 W", "resistor_mean_power"),
        ("chopper_current: 5 A", "chopper_current: 3 A", "chopper_current"),
        ("chopper_voltage: 28 V", "chopper_voltage: 24.5 V", "chopper_voltage"),
    ],
)
def test_each_limit_fails_alone(catalog, field, value, name):
    own = (OWN % CHOPPER).replace(field, value)
    one = stopped(catalog, supply="max: 25 V", more=own)
    assert name in [c.name for c in one.budget if c.status == "fail"]


def test_a_controller_has_to_withstand_the_chopper(catalog):
    """541718 is one for 50 V at most."""
    one = stopped(catalog, more=(OWN % CHOPPER).replace("28 V", "51 V"))
    assert check(one, "controller_available").status == "fail"


def test_what_no_data_sheet_gives_is_unknown(catalog):
    bare = stopped(catalog, more="brake_resistor: {resistance: 8 ohm, chopper_voltage: 28 V}")
    unknown = {c.name for c in bare.budget if c.status == "unknown"}
    assert {"resistor_peak_power", "resistor_mean_power", "resistor_pulse_energy", "chopper_current"} <= unknown
    gentle = stopped(catalog, more="brake_resistor: {resistance: 8 ohm, chopper_voltage: 28 V, power: 120 W}")
    passing = {c.name for c in gentle.budget if c.status == "pass"}  # 98 W while on: it withstands that at any time
    assert {"resistor_peak_power", "resistor_mean_power", "resistor_pulse_energy"} <= passing


def test_a_power_supply_has_a_peak_for_a_time_and_a_trip(catalog):
    free = stopped(catalog, supply="regeneration: 0")
    peak = next(f.value for f in free.figures if f.name == "power") / 24.0
    limits = f"current: {0.5 * peak} A, peak_current: {2 * peak} A, peak_time: %s, overvoltage_trip: %s"
    good = stopped(catalog, supply=limits % ("3 s", "30 V"), more=OWN % CHOPPER)
    assert check(good, "supply_current").limit == pytest.approx(2 * peak)
    assert check(good, "supply_overvoltage").demand == 28.0
    assert {c.status for c in good.budget if c.name.startswith("supply_")} == {"pass"}
    long = check(good, "supply_peak_time").demand
    assert 0.3 < long < 0.7  # of a current that rises straight within a second
    bad = stopped(catalog, supply=limits % ("1 ms", "26 V"), more=OWN % CHOPPER)
    assert {c.name for c in bad.budget if c.status == "fail"} == {"supply_peak_time", "supply_overvoltage"}
    lone = stopped(catalog, supply="overvoltage_trip: 30 V")
    assert check(lone, "supply_overvoltage").status == "unknown"


# --- out of the catalogues ------------------------------------------------------------------------------------------

SUPPLIED = "regeneration: 0, part: SDR-240-24"


@pytest.fixture(scope="module")
def shelf():
    return load(["maxon", "mean_well", "te_connectivity", "roboteq", "pololu"])


def test_the_smallest_that_holds_is_chosen_and_bought_once(shelf):
    spec = wheel(SUPPLIED, "brake_resistor: {family: [HS, DSR*], chopper_voltage: 28 V, chopper_current: 5 A}\n")
    (one,) = explain(spec, "110940", "406764", catalog=shelf)
    assert one.braking is not None and one.braking.resistor is not None
    chosen = one.braking.resistor
    assert chosen.part.startswith("HS")  # a resistor for the chopper that is given, in a resistance of E24
    assert chosen.resistance <= 28.0**2 / figures(one)["braking_peak_power"]
    lines = machine_parts(one, problem(spec, load_parts(spec, shelf)))
    bought = {line.role: line for line in lines}
    assert bought["brake resistor"].quantity == bought["power supply"].quantity == 1
    assert bought["brake resistor"].said == f"{chosen.resistance:g} Ω, {chosen.power:g} W"
    assert "brake resistor" in totals(lines)[0].lacks
    assert document(one)["braking"]["resistor"]["part"] == chosen.part
    assert json.dumps(document(one)["braking"])


def test_any_is_a_shunt_regulator_above_the_supply(shelf):
    (one,) = explain(wheel(more="brake_resistor: any\n"), "110940", "406764", catalog=shelf)
    assert one.braking is not None and one.braking.resistor is not None
    assert one.braking.resistor.part == "SR2K60V25R, 25 V"
    assert {c.status for c in one.budget} == {"pass"}
    (small,) = explain(wheel(more="brake_resistor: {family: DSR*}\n"), "110940", "406764", catalog=shelf)
    assert small.braking is not None and small.braking.resistor is not None
    assert small.braking.resistor.part == "309687, 27 V"  # the smaller one, whose pulse energy is not printed
    assert check(small, "resistor_pulse_energy").status == "unknown"
    assert check(small, "bus_voltage").demand == 27.1


def test_none_is_taken_where_the_capacitors_hold_all(shelf):
    spec = wheel("capacitance: 1 F", "brake_resistor: any\n")
    (one,) = explain(spec, "110940", "406764", catalog=shelf)
    assert one.braking is not None and one.braking.resistor is None
    assert "no brake resistor is needed" in " ".join(one.braking.assumptions)
    assert "brake resistor" not in {line.role for line in machine_parts(one, problem(spec, load_parts(spec, shelf)))}


def test_a_kind_alone_changes_nothing(catalog):
    """A spec without a kind means what it meant; a battery takes all, a power supply none."""
    plain = check(stopped(catalog), "bus_voltage")
    for kind in ("power_supply", "drive_bus"):
        assert repr(check(stopped(catalog, supply=f"kind: {kind}"), "bus_voltage")) == repr(plain)
    taken = stopped(catalog, supply="kind: battery")
    assert check(taken, "bus_voltage").status == "pass" and taken.braking is None


# --- refused ----------------------------------------------------------------------------------------------------------

REFUSED = [
    ("", OWN % "chopper_voltage: 20 V", "expected chopper_voltage above nominal, 24 V"),
    ("", OWN % "averaging_time: 9 s", "give chopper_voltage with resistance"),
    ("", (OWN % CHOPPER).replace("8 ohm", "0 ohm"), "must be above 0"),
    ("", (OWN % CHOPPER).replace("20 W", "-20 W"), "must be above 0 W"),
    ("", (OWN % CHOPPER).replace("200 W", "2 W"), "expected peak_power >= power"),
    ("", "brake_resistor: {power: 20 W}", "give power with the resistance"),
    ("", (OWN % CHOPPER).replace("{", "{part: x, "), "not both"),
    ("kind: battery", "brake_resistor: any", "the battery takes what is regenerated"),
    ("kind: battery, accepts: share", "", "a battery takes all"),
    ("kind: power_supply, regeneration: 0.5", "", "takes nothing back"),
    ("kind: drive_bus, part: x", "", "give part for kind: power_supply"),
    ("peak_current: 5 A", "", "give current with peak_current"),
    ("peak_time: 5 s", "", "give peak_current with peak_time"),
    ("current: 5 A, peak_current: 4 A", "", "expected peak_current >= current"),
    ("overvoltage_trip: 23 V", "", "expected overvoltage_trip above"),
]


@pytest.mark.parametrize(("supply", "more", "said"), REFUSED)
def test_what_is_refused_in_a_line(supply, more, said):
    text = refusal(lambda: wheel(supply, more))
    assert text.startswith("wheel.yaml:") and said in text


@pytest.mark.parametrize(
    ("supply", "more", "said"),
    [
        ("part: NDR-480-48", "", "NDR-480-48 gives 48 V to 55 V"),
        ("part: NDR-480", "", '"NDR-480" is not in'),
        ("regeneration: 0", "brake_resistor: {part: HSA}", '"HSA" is not in'),
        ("regeneration: 0", "brake_resistor: {part: HSA5}", "HSA5 has no chopper of its own"),
    ],
)
def test_parts_that_do_not_fit_are_refused_in_a_line(shelf, supply, more, said):
    line = refusal(lambda: explain(wheel(supply, more), "110940", "406764", catalog=shelf))
    assert line.startswith("wheel.yaml:") and said in line
