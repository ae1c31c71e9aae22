"""What has no effect has no say: a figure that is missing and changes nothing leaves no check unknown.

Each case is held against the same drive with that figure printed, whatever it is.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from string import Template

import pytest

from drivesizer.results.drive_set import DriveSet
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import load_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

PARTS = Template(Path(__file__).with_name("no_effect.yaml").read_text(encoding="utf-8"))
PRINTED = {"inertia": "100", "efficiency": "90", "encoder_speed": "9000", "peak_time": "2", "drop": "0"}
LEVEL = "load: {{kind: recorded, file: level.csv, smoothing: 0 s}}"
STOPPING = """load: {{kind: flywheel, inertia: 0.02 kg*cm^2}}
motion: {{profile: trapezoid, speed: 300 rpm, acceleration_time: {braking}, cruise_time: 1 s, rest_time: 1 s}}"""
REST = """
transmission: [{{kind: gearhead}}]
supply: {{nominal: 24 V, regeneration: 0, power: 200 W{capacitance}}}
select: {{catalogs: [parts.yaml], estimates: {estimates}}}
"""


class Shop:
    """One drive on a cycle, with any of its figures missing."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def drive(self, gearhead: str = "direct", load: str = LEVEL, torque: str = "0.1", **figures: str) -> DriveSet:
        """As ``size`` has it; ``explain`` must say the same."""
        settings = {"capacitance": "", "estimates": "on", "braking": "10 ms"} | figures
        (self.folder / "parts.yaml").write_text(PARTS.substitute(PRINTED | figures), encoding="utf-8")
        rows = f"0,1000,{torque}\n10,1000,{torque}\n"
        (self.folder / "level.csv").write_text(f"time,speed,torque\ns,rpm,N*m\n{rows}", encoding="utf-8")
        (self.folder / "robot.yaml").write_text("name: one\n" + (load + REST).format(**settings), encoding="utf-8")
        spec = load_spec(self.folder / "robot.yaml")
        found = next(one for one in size(spec).sets if one.gearhead.part == gearhead)
        (alone,) = explain(spec, "M", gearhead)
        assert statuses(alone) == statuses(found) and alone.status == found.status
        return found


def statuses(one: DriveSet) -> dict[str, str]:
    return {check.name: check.status for check in one.checks}


def same_checks(one: DriveSet, other: DriveSet) -> bool:
    """But for whence their figures are."""
    found = ([repr(replace(check, origins=())) for check in drive.checks] for drive in (one, other))
    return next(found) == next(found)


@pytest.fixture
def shop(tmp_path):
    return Shop(tmp_path)


@pytest.mark.parametrize("estimates", ["on", "off"])
@pytest.mark.parametrize("printed", ["1", "100", "10000"])
def test_a_rotor_inertia_at_constant_speed(shop, estimates, printed):
    found, other = (shop.drive(inertia=figure, estimates=estimates) for figure in ("~", printed))
    assert found.status == other.status == "pass"
    assert same_checks(found, other)


def test_a_rotor_inertia_that_is_accelerated_has_one(shop):
    assert shop.drive(inertia="~", estimates="off", load=STOPPING).status == "unknown"


@pytest.mark.parametrize("estimates", ["on", "off"])
@pytest.mark.parametrize("printed", ["30", "95"])
def test_the_efficiency_of_a_gear_without_torque(shop, estimates, printed):
    """The figure counts with the torque that goes through the gear, none."""
    found, other = (shop.drive("G", torque="0", efficiency=figure, estimates=estimates) for figure in ("~", printed))
    assert found.status == other.status == "pass"
    assert same_checks(found, other)


@pytest.mark.parametrize("printed", ["0.1", "60"])
def test_how_long_a_controller_stands_a_peak_that_never_comes(shop, printed):
    """2.2 A of 10 A: no time is spent above the continuous current."""
    found, other = (shop.drive(peak_time=figure) for figure in ("~", printed))
    assert found.status == other.status == "pass"
    assert statuses(found)["controller_peak_time"] == statuses(other)["controller_peak_time"] == "pass"


def test_a_voltage_drop_that_is_not_printed_is_assumed_and_said(shop):
    """24 V less 1.1 V are enough; a printed drop needs no word."""
    found, printed = (shop.drive(drop=figure) for figure in ("~", "1"))
    volts, known = (next(check for check in one.checks if check.name == "supply_voltage") for one in (found, printed))
    assert volts.status == known.status == "pass"
    assert (volts.limit, known.limit) == pytest.approx((24.0 - 1.1, 24.0 - 1.0))
    assert volts.note == "the controller's voltage drop is not printed: 0.5 V to 1.1 V assumed" and not known.note


@pytest.mark.parametrize("printed", ["100", "9000"])
def test_an_encoder_that_is_not_required(shop, printed):
    """Too slow, fast enough, or without a figure: the drive passes."""
    found, other = (shop.drive(encoder_speed=figure) for figure in ("~", printed))
    assert found.status == other.status == "pass"
    (check,) = (check for check in found.checks if check.name == "encoder_speed")
    assert check.advice and check.status == "unknown"


@pytest.mark.parametrize("capacitance", ["20 uF", "1 mF", "1 F"])
def test_a_millijoule_that_is_returned(shop, capacitance):
    """The least capacitor of a controller of 10 A holds it: 10.4 uF from 24 V to 60 V are 15.8 mJ."""
    found = shop.drive(load=STOPPING)
    printed = shop.drive(load=STOPPING, capacitance=f", capacitance: {capacitance}")
    bus, known = (next(check for check in one.checks if check.name == "bus_voltage") for one in (found, printed))
    assert found.status == printed.status == "pass"
    assert 24.0 < known.demand <= bus.demand <= bus.limit == 60.0


def test_what_a_capacitor_need_not_hold_is_unknown(shop):
    """A millijoule is held, joules are not."""
    heavy = STOPPING.replace("0.02 kg", "2 kg").replace("300 rpm", "3000 rpm").replace("{braking}", "500 ms")
    assert shop.drive(load=heavy).status == "unknown"
    assert shop.drive(load=heavy, capacitance=", capacitance: 10 mF").status == "pass"


def test_friction_of_a_gear_without_load_is_said_where_it_decides(shop):
    """0.45 N*m / 4 / 50 mN*m/A (1/0.9 - s) + 0.13 A + 0.05 A + s 2 N*m / 4 / 50 mN*m/A: s 0.7, 2 and 6 %, of 3 A."""
    (shop.folder / "slow.csv").write_text("time,speed,torque\ns,rpm,N*m\n0,800,0.45\n10,800,0.45\n", encoding="utf-8")
    shop.drive("G", LEVEL.replace("level", "slow"))
    (said,) = (text for text in size(load_spec(shop.folder / "robot.yaml")).warnings if "gearhead" in text)
    assert "3.3 mN·m to 30 mN·m at its input" in said  # s 2 N*m / 4
    assert "Motor nominal current (RMS) 2.73 A to 3.14 A of 3 A; Winding temperature, peak 126 °C" in said
    assert "passes with 0 %" in said  # of a winding of 125 degC
