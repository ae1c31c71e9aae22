"""A full battery that is charged by what comes back: V = E + R I by hand, and who is told of it."""

from __future__ import annotations

from math import exp, isnan, nan, sqrt
from typing import Any

import numpy as np
import pytest

from drivesizer.catalog import Catalog, load
from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine.battery import Load, Pack, battery_checks, charge_along, pack_of, raised_voltage
from drivesizer.physics.battery import polarised_voltage
from drivesizer.results.check import Check
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec, read_spec
from drivesizer.spec.sections import Battery

pytestmark = pytest.mark.usefixtures("no_further_searches")

# two blocks in series: E = 25.8 V full and 23.4 V empty, R = 0.05 ohm, 28.8 V and 2 A while charging
TWO = {"nominal_voltage": "12 V", "capacity": "7 A*h", "chemistry": "lead-acid", "cutoff_voltage": "10.5 V",
       "charge_voltage": "14.4 V", "resistance": "25 mohm", "open_circuit": {"full": "12.9 V", "empty": "11.7 V"},
       "rated_time": "20 h", "peukert_exponent": 1.2, "continuous_current": "20 A", "peak_current": "80 A",
       "max_charge_current": "11 A", "series": 2, "autonomy": "1 h"}  # fmt: skip

HOIST = """
name: lifts and lowers
load: {kind: hoist, mass: 20 kg, drum_diameter: 60 mm}
motion: {speed: 0.3 m/s, acceleration_time: 0.3 s, cruise_time: 3 s, rest_time: 5 s, there_and_back: true}
supply: {nominal: 24 V, min: 21 V, max: 29 V, regeneration: %s%s}
select: {catalogs: [maxon], objective: mass}
battery: {%s}
"""


@pytest.fixture(scope="module")
def maxon() -> Catalog:
    return load(["maxon"])


def spec_of(share: str = "50 %", supply: str = "", **changed: Any) -> RobotSpec:
    given = {name: value for name, value in (TWO | changed).items() if value is not None}
    listed = ", ".join(f"{name}: {_flow(value)}" for name, value in given.items())
    return read_spec(YamlSource(HOIST % (share, supply, listed), "hoist.yaml"))


def _flow(value: Any) -> str:
    return "{" + ", ".join(f"{k}: {v}" for k, v in value.items()) + "}" if isinstance(value, dict) else str(value)


def asked(back: float, mean: float = 40.0, **changed: Any) -> dict[str, Check]:
    """Checks of a battery that so much power comes back into [W], half of its charge left in the end."""
    spec = spec_of(**changed)
    given = spec.battery
    assert given is not None
    pack: Pack = pack_of(given, load(["maxon"]))
    rest = pack.emf(1.0 if mean < 0.0 else pack.start)
    raised = float(raised_voltage(pack, back, rest))
    one = Load(mean=mean, peak=100.0, rms=50.0, back=back, speed=nan, full=36000.0, required=3600.0, charge=0.5,
               lowest=24.0, highest=raised)  # fmt: skip
    return {check.name: check for check in battery_checks(spec, pack, one)}


def test_what_comes_back_raises_the_voltage_of_a_full_battery() -> None:
    """10 A into 25.8 V behind 0.05 ohm: 26.3 V, 263 W. Of 28.8 V that leaves 3 V to rise by, of which 0.5 is used.

    With half the charge left E = 24.6 V, and 0.05 I^2 + 24.6 I = 263 gives I = (sqrt(24.6^2 + 4 * 0.05 * 263) - 24.6) /
    0.1 = 10.468 A: the largest current flows into the emptiest battery.
    """
    found = asked(263.0)
    over, bus, current = (
        found[name] for name in ("battery_overcharge", "battery_return_voltage", "battery_charge_current")
    )
    assert (over.demand, over.limit) == pytest.approx((26.3, 28.8), rel=1e-12)
    assert over.margin == pytest.approx(3.0 / 0.5 - 1.0)
    assert (bus.demand, bus.limit, bus.margin) == pytest.approx((26.3, 29.0, 29.0 / 26.3 - 1.0))
    assert current.demand == pytest.approx((sqrt(24.6**2 + 4 * 0.05 * 263) - 24.6) / 0.1) == pytest.approx(10.468, 1e-4)
    assert {over.status, bus.status, current.status} == {"pass"}


def test_a_voltage_above_the_limit_fails_and_so_does_a_current() -> None:
    """60 A raise 25.8 V by 3 V to the 28.8 V at which a charge ends; 1728 W are just that, a watt more is too much."""
    assert asked(28.8 * 59.9)["battery_overcharge"].status == "pass"
    assert asked(28.8 * 60.1)["battery_overcharge"].status == "fail"
    assert asked(28.8 * 60.1)["battery_charge_current"].status == "fail"
    assert asked(29.0 * 64.1)["battery_return_voltage"].status == "fail"  # (29 - 25.8) / 0.05 = 64 A


def test_a_battery_at_its_limit_takes_nothing_until_some_is_drawn() -> None:
    """E of a full one is the voltage at which its charge ends: no current may flow. At 95 % E is 0.27 V lower."""
    full = {"open_circuit": {"full": "14.4 V", "empty": "11.7 V"}}
    assert asked(1.0, **full)["battery_overcharge"].status == "fail"
    assert asked(0.0, **full)["battery_overcharge"].status == "pass"
    some = asked(100.0, start="95 %", **full)["battery_overcharge"]
    rest = 2 * (14.4 - 0.05 * 2.7)
    assert some.demand == pytest.approx(0.5 * (rest + sqrt(rest**2 + 4 * 0.05 * 100)))  # V (V - E) / R = P
    assert some.status == "pass"


def test_nothing_that_comes_back_asks_for_nothing() -> None:
    """Whatever is unknown of the battery's charging."""
    for unknown in ({}, {"resistance": None}, {"charge_voltage": None, "max_charge_current": None},
                    {"open_circuit": None}):  # fmt: skip
        found = asked(0.0, **unknown)
        for name in ("battery_overcharge", "battery_charge_current"):
            assert found[name].status == "pass"
            assert isnan(found[name].margin)


def test_an_unknown_limit_or_resistance_does_not_pass() -> None:
    for unknown, names in (
        ({"charge_voltage": None}, {"battery_overcharge"}),
        ({"max_charge_current": None}, {"battery_charge_current"}),
        ({"resistance": None}, {"battery_overcharge", "battery_return_voltage", "battery_charge_current"}),
        ({"open_circuit": None}, {"battery_overcharge", "battery_return_voltage"}),
    ):
        found = asked(263.0, **unknown)
        assert {name for name in ("battery_overcharge", "battery_return_voltage", "battery_charge_current")
                if found[name].status == "unknown"} == names  # fmt: skip
    assert "give the resistance" in asked(263.0, resistance=None)["battery_overcharge"].note
    assert asked(29.0 * 105.0, open_circuit=None)["battery_return_voltage"].status == "fail"  # even from 24 V


def test_more_back_than_drawn_needs_room() -> None:
    """10 W for an hour at 22.5 V (mean of nominal and end) are 0.444 A h; of 7 A h 5 % are 0.35, 10 % are 0.7."""
    for start, room, status in (("100 %", 0.0, "fail"), ("95 %", 0.35, "fail"), ("90 %", 0.7, "pass")):
        found = asked(20.0, mean=-10.0, start=start)["battery_room"]
        assert found.status == status
        assert (found.demand / 3600, found.limit / 3600) == pytest.approx((10 / 22.5, room), abs=1e-12)
    assert asked(20.0, mean=-10.0, start="90 %")["battery_overcharge"].demand > 25.8  # it becomes full
    assert "battery_room" not in asked(20.0)


def test_the_pair_of_a_rested_battery() -> None:
    """2 A flow in for 5 s: u = -0.03 * 2 (1 - e^-0.5), then decays; V rises from 25.8 by that."""
    duration, current = np.array([5.0, 10.0]), np.array([-2.0, 0.0])
    left, right = polarised_voltage(duration, current, 25.8, 0.0, 0.03, 10.0, rested=True)
    u = 0.06 * (1.0 - exp(-0.5))
    assert left == pytest.approx([25.8, 25.8 + u])
    assert right == pytest.approx([25.8 + u, 25.8 + u * exp(-1.0)])


def test_what_is_not_there_at_the_start_cannot_be_drawn(maxon: Catalog) -> None:
    """90 % there, of which 20 % may not be drawn: 70 of 80 % last 7/8 as long."""
    whole, some = (size(spec_of(usable="80 %", start=start), catalog=maxon, top=1).sets[0].energy
                   for start in ("100 %", "90 %"))  # fmt: skip
    assert whole is not None and some is not None
    assert some.autonomy / whole.autonomy == pytest.approx(0.7 / 0.8)
    with pytest.raises(Exception, match="expected start above the share that may not be drawn"):
        Battery.model_validate({"nominal_voltage": "12 V", "capacity": "7 A*h", "usable": 0.3, "start": 0.6})


def test_of_a_whole_search_none_stands_that_charges_a_battery_at_its_limit(maxon: Catalog) -> None:
    """What a hoist lowers comes back: not into a full battery; with a tenth drawn before, or a diode, it stands."""
    full = {"open_circuit": {"full": "14.4 V", "empty": "11.7 V"}, "max_charge_current": "20 A"}
    assert not size(spec_of(**full), catalog=maxon, top=3).sets  # 20 kg at 0.3 m/s drive every gear that lifts them
    assert size(spec_of(share="0 %", supply=", accepts: share, capacitance: 1 F", **full), catalog=maxon, top=1).sets
    drained = size(spec_of(start="90 %", **full), catalog=maxon, top=1).sets[0]
    checks = {check.name: check for check in (*drained.checks, *drained.budget)}
    assert checks["battery_overcharge"].status == checks["battery_return_voltage"].status == "pass"
    assert checks["bus_voltage"].demand == 29.0 >= checks["battery_return_voltage"].demand
    assert "held to it" in checks["bus_voltage"].note


def test_a_day_with_a_charging_station_by_hand(maxon: Catalog) -> None:
    """10 A·h at 25.2 V gives 252 W·h: 60 W driven and 12 W besides; docking at 30 %; 8 A of which 95 % stay."""
    legs = "legs: [{time: 2 h}, {time: 30 min, load: 30 %}, {time: 45 min, charges: true}, {time: 30 min, load: 0}]"
    given = {"nominal_voltage": "25.2 V", "capacity": "10 A*h", "chemistry": "Li-ion", "series": 1, "autonomy": None,
             "rated_time": None, "peukert_exponent": None, "cutoff_voltage": "20 V", "charge_voltage": "29 V",
             "charger": {"current": "8 A", "efficiency": 0.95}}  # fmt: skip
    spec = spec_of(supply=f"}}\nmission: {{{legs}", **given)
    assert spec.battery is not None and spec.mission is not None
    assert spec.mission.duration == pytest.approx(3.75 * 3600)
    pack = pack_of(spec.battery, maxon)
    whole = 72.0  # W
    used = Load(
        whole, 90.0, 80.0, 0.0, nan, full=252 / whole * 3600, charge=0.5, lowest=24.0, highest=26.0, others=12.0
    )
    after = [1 - 144 / 252]
    after.append(after[-1] - (18 + 12) / 2 / 252)
    after.append(after[-1] + (0.95 * 8 * 0.75 / 10) - 12 * 0.75 / 252)
    after.append(after[-1] - 12 / 2 / 252)
    assert charge_along(spec.mission.legs, pack, used) == pytest.approx(after)
    checks = {one.name: one for one in battery_checks(spec, pack, used)}
    assert "battery_autonomy" not in checks
    assert (checks["battery_on_the_way"].status, checks["battery_on_the_way"].limit) == (
        "pass",
        pytest.approx(after[1]),
    )
    assert (checks["battery_recharged"].status, checks["battery_recharged"].advice) == ("fail", True)
    with pytest.raises(InputError, match=r"mission\.legs: one charges; expected battery: \{charger"):
        spec_of(supply=f"}}\nmission: {{{legs}", **given | {"charger": None})
