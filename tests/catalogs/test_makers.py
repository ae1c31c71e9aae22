"""The catalogues of all the other makers: how many parts, figures as printed, and the energy of every actuator.

maxon, Faulhaber, Allied Motion, T-Motor and Pittman have tests of their own. ``MAKERS`` says how many parts each file
has. Numbers behind ``counted`` were counted in the source's own table, less what the file's head leaves out; a ``pin``
is what is there, so that nothing appears or goes unseen, and a remark says what of it was counted. ``ROWS`` are
figures in the units in which the source prints them, ``WORKED`` those that follow from printed ones by the arithmetic
beside them.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from typing import Any

import pytest
import yaml
from rows import hold
from scipy.optimize import brentq

from drivesizer.catalog import DIRECT, PARTS, RELATIONS, Catalog, columns_of, load, shipped
from drivesizer.catalog.query import Hit, every, open_catalogs, origins
from drivesizer.catalog.view.search_view import split_actuators
from drivesizer.units import from_si, to_si

ELSEWHERE = {"maxon", "faulhaber", "allied_motion", "tmotor", "pittman"}  # tested in files of their own
CONFIDENCES = {"quoted", "secondary", "derived", "recalled"}
Figures = dict[str, str]


@pytest.fixture(scope="module")
def shelf() -> dict[str, Catalog]:
    """The catalogues tested here, by name."""
    return open_catalogs(name for name in shipped() if name not in ELSEWHERE)


@pytest.fixture(scope="module")
def full() -> dict[str, Catalog]:
    """All that ship, by name."""
    return open_catalogs()


# --- how many --------------------------------------------------------------------------------------------------------


def counted(**sections: int) -> dict[str, int]:
    """Parts by section, counted in the source."""
    return sections


def pin(**sections: int) -> dict[str, int]:
    """Parts by section as they are, where no table of the source was at hand to count in."""
    return sections


MAKERS: dict[str, dict[str, int]] = {
    # batteries: the tables of cells and blocks; makers of which only a capacity is known have no file
    "a123": counted(batteries=1), "aa_portable_power": counted(batteries=1), "lg": counted(batteries=2),
    "molicel": counted(batteries=4), "murata": counted(batteries=1), "samsung": counted(batteries=5),
    "sigmastek": counted(batteries=2), "sunnyway": counted(batteries=1), "vapcell": counted(batteries=1),
    "vinachem": counted(batteries=1), "yhi": counted(batteries=1), "yuasa": counted(batteries=2),
    # steppers: one per wiring and file of settings
    "aml": counted(steppers=1), "amp": counted(steppers=1), "ams": counted(steppers=1),
    # 57HS04, 09, 13, 22; 57HS04 has no parallel wiring; 57CM, CS-M and 42CM
    "leadshine": counted(steppers=2 + 3 + 3 + 3 + 3 + 2 + 4),
    "mclennan": counted(steppers=1), "motionking": counted(steppers=1),
    "oriental_motor": counted(motors=10 - 2 - 2, steppers=5 - 1 + 4),  # no PK243B1-SG18; PKP
    "parker": counted(steppers=1),
    "phytron": pin(steppers=8 + 1),  # 8 counted; phyBasic is of another list
    "trinamic": counted(steppers=1 + 3, controllers=1 + 2),
    # those of public tables of motors, less what has no holding torque and what is there twice
    "cloudray": pin(steppers=7), "fysetc": pin(steppers=13), "hanpose": pin(steppers=10),
    "kelimotor": pin(steppers=5), "ldo": pin(steppers=63),
    "moons": pin(steppers=20, brakes=3), "motech": pin(steppers=22),
    "oukeda": pin(steppers=5), "rattm": pin(steppers=5), "shengyang": pin(steppers=6), "siboor": pin(steppers=7),
    "stepperonline": pin(steppers=38, brakes=1, controllers=3), "usongshine": pin(steppers=4),
    "wantai": pin(steppers=4),
    # belts and pulleys: the lists of ReCalc, whole
    "last_anvil": counted(belts=24, pulleys=8), "sds": counted(belts=3), "swyft": counted(belts=54),
    "thrifty": counted(belts=103, pulleys=20), "vbelt": counted(belts=872), "wcp": counted(belts=141, pulleys=36),
    # screws: the tables of the makers' catalogues, by program; HIWIN without 3 rows that are cut in print
    "thk": counted(screws=616 + 13), "hiwin": counted(screws=31 + 4 + 2 + 21 + 41 + 37),
    "rexroth": counted(screws=65, motors=27, brakes=9),
    "wangong": counted(screws=10 + 12 + 2), "sfu": counted(screws=27), "pbc": counted(screws=38),
    # power supplies and brake resistors: lists out of data sheets, manuals and public files
    "danotherm": counted(brake_resistors=5), "factonation": counted(brake_resistors=5),
    "omron": counted(brake_resistors=5, motors=24, brakes=3), "te_connectivity": counted(brake_resistors=5),
    "teco": counted(brake_resistors=7 + 9), "mean_well": counted(power_supplies=65),
    "phoenix_contact": counted(power_supplies=3), "puls": counted(power_supplies=3),
    "solahd": counted(power_supplies=2),
    # servo motors for mains: manuals of Yaskawa and B&R, public tables of the others
    "allen_bradley": counted(motors=26 + 38), "br_automation": counted(motors=8, brakes=6),
    "fanuc": counted(motors=8 + 10 + 10 - 1),  # without aiS 30/4000
    "ls_mecapion": counted(motors=3 + 3 + 4 + 12 + 11 + 3 + 3 + 3 + 8 + 8 + 16 + 15 + 17),
    "mitsubishi": counted(motors=15 + 5 + 5 + 5 + 7 + 5, brakes=21),
    "nidec": counted(motors=5),
    "panasonic": counted(motors=6 + 12 + 3 + 12), "siemens": counted(motors=32, brakes=8 + 9),
    "yaskawa": counted(motors=15 + 17 + 11 + 7 + 5 + 4 + 6 + 6 + 3, gearheads=13, brakes=10),  # of both sources
    # holding brakes: those whose torque is known
    "emerson": counted(brakes=4), "intorq": counted(brakes=5), "pi": counted(brakes=1),
    # motors without a gearhead
    "amk": counted(motors=3 - 1),  # without DD7-28-10
    "anaheim": pin(motors=2),
    "andymark": counted(motors=5 - 1 + 1, belts=89, pulleys=8),  # no snow blower; RS775-125 of WPILib
    "banebots": counted(motors=2),
    "beckhoff": counted(motors=7 + 1 + 20, steppers=5, brake_resistors=5 + 4, power_supplies=1)
    | pin(controllers=8),  # AM8122 has two windings; AM8000
    "ctre": counted(motors=3, controllers=3),  # two kinds of commutation are one motor; the Falcon is VEX's
    "kollmorgen": counted(motors=3),
    "nanotec": counted(motors=4, steppers=6 + 2 * 2 + 3 + 1),
    "odrive": counted(motors=5 - 2, brake_resistors=1) | pin(controllers=5),  # without M5312s and BotWheel
    "rev": counted(motors=6 - 1, belts=25, pulleys=12, controllers=3),  # without Core Hex
    "tamagawa": counted(motors=19),
    "tq": counted(motors=3),
    # gearheads
    "apex": counted(gearheads=3),
    "nabtesco": counted(gearheads=2),  # the two ends of one line
    "wittenstein": counted(gearheads=31 + 30 + 25 + 32 + 60, motors=6, brakes=4),  # NPT, NPS, NP, TP, SP; premo
    # actuators
    "cubemars": pin(actuators=8 + 6 + 2 + 3 + 2, motors=7 + 7 + 2),
    "damiao": pin(actuators=14 - 6 + 2 + 3),  # 14 counted, less 6 without R or k_t; P of two; 48 V of three
    "dfrobot": pin(actuators=4 - 2 + 1),  # 4 counted, less FIT0277 and FIT0450; FIT0522 is of another page
    "encos": counted(actuators=10 - 5),
    "feetech": pin(actuators=3 + 1),  # 3 counted; ST-3235 is of the maker's wiki
    "gobilda": counted(actuators=10, motors=1),
    "harmonic_drive": counted(actuators=4 + 5 + 5 + 6 + 6 + 6 + 5 + 5, gearheads=21, brakes=4),
    "lktech": pin(actuators=5),
    "myactuator": pin(actuators=25 - 20 + 10),  # 25 names of V2 and V3 counted; ten V4 of the brochure
    # 37D without the two bare motors, 25D, LP without 5:1 and 10:1, HPCB and 3052, the Romi's: counted but one 25D
    "pololu": pin(actuators=(20 - 2) + (3 + 1) + (11 - 2) + 2 + 1, controllers=15 + 4, brake_resistors=4 - 2),
    # X, MX, AX-12A, XL-320, P and Y counted, one per voltage; PRO
    "robotis": pin(actuators=67 + 3 * 3 + 1 + 1 + 6 + 6 + 11),
    "robstride": pin(actuators=7 + 1 + 1),  # RS00 to RS06 and EduLite counted; RS10P is of the maker's page
    "studica": counted(actuators=1), "tetrix": counted(actuators=3),
    "unitree": counted(actuators=3 - 2),  # without A1, B1
    "vex": counted(motors=4, actuators=3), "xiaomi": counted(actuators=1),
    # controllers
    "amc": counted(controllers=3), "basicmicro": pin(controllers=9), "cytron": pin(controllers=2 + 2),
    "dimension_engineering": pin(controllers=2), "granite_devices": pin(controllers=3),
    "mjbots": counted(controllers=4 * 2),  # with and without cooling
    "phidgets": pin(controllers=2), "roboteq": pin(controllers=15, brake_resistors=2),
    "synapticon": counted(controllers=2),
    "technosoft": pin(controllers=5), "vesc": pin(controllers=8),
    # encoders: one per resolution that the sheet lists
    "ams_osram": pin(encoders=19), "broadcom": pin(encoders=5),
    "cui": counted(encoders=2 * 16 + 3 * 22 + 12 + 1 + 2),  # AMT102, 103; 11, 13, 31; 20, 203; 21
    "kuebler": counted(encoders=9 + 1),  # stock types of the 5000, one 5020
    "posital": pin(encoders=3),
    "rls": pin(encoders=8 + 8 + 6),  # 5 to 12 bit of RM08I and RM08S counted; RMB20
    "usdigital": pin(encoders=15),
}  # fmt: skip


def test_every_file_is_counted(shelf: dict[str, Catalog]) -> None:
    assert set(shelf) == set(MAKERS)
    assert len(MAKERS) == 116 + 3


def test_how_many_parts(shelf: dict[str, Catalog]) -> None:
    found = {name: dict(Counter(hit.section for hit in every({name: shelf[name]}))) for name in MAKERS}
    assert found == MAKERS


def test_only_motors_without_gearhead_are_paired(shelf: dict[str, Catalog]) -> None:
    """No list of these makers says what fits what, but for brakes and Yaskawa's gears: each motor drives directly."""
    hold(_paired_with_nothing, {name: (name, shelf[name]) for name in MAKERS})


def _paired_with_nothing(name: str, catalog: Catalog) -> None:
    motors = MAKERS[name].get("motors", 0)
    pairs = catalog.motor_gearhead
    gearheads = catalog.gearheads["part"][pairs.right]
    assert pairs.left[gearheads == DIRECT].tolist() == list(range(motors))
    names = zip(catalog.motors["part"][pairs.left].tolist(), gearheads.tolist(), strict=True)
    geared = [(motor, gear) for motor, gear in names if gear != DIRECT]
    assert len(geared) == (13 if name == "yaskawa" else 0)
    assert all(gear.startswith(motor + "J") for motor, gear in geared)  # whose type names the motor
    assert all(
        not len(getattr(catalog, relation).left) for relation in RELATIONS.keys() - {"motor_gearhead", "motor_brake"}
    )


# --- figures as printed ----------------------------------------------------------------------------------------------

# file, section, part, figures in the source's units; those that were converted stand under WORKED
ROWS: list[tuple[str, str, str, Figures]] = [
    # holding brakes: the manuals that the files name
    ("siemens", "brakes", "1Fx2106", {"static_torque": "16 N*m", "dynamic_torque": "9 N*m", "release_time": "100 ms",
     "engage_time": "50 ms", "energy_per_stop": "1065 J", "total_energy": "774 kJ"}),
    ("siemens", "brakes", "EBD 1.5 B", {"static_torque": "15 N*m", "energy_per_stop": "320 J", "engage_time": "30 ms"}),
    ("rexroth", "brakes", "MS2E07-C", {"static_torque": "20 N*m", "dynamic_torque": "12.5 N*m",
     "energy_per_stop": "340 J"}),
    ("mitsubishi", "brakes", "HG-KR/HG-MR 23 43 B", {"static_torque": "1.3 N*m", "power": "7.9 W",
     "release_time": "30 ms", "engage_time": "20 ms", "energy_per_stop": "22 J", "energy_per_hour": "220 J",
     "backlash": "1.2 deg"}),
    ("yaskawa", "gearheads", "SGMAH-01AJC", {"ratio": "21", "continuous_torque": "5.34 N*m",
     "intermittent_torque": "18.1 N*m", "efficiency": "80 %", "inertia": "3.5e-6 kg*m^2"}),
    ("oriental_motor", "motors", "NX640AS-3", {"nominal_torque": "1.27 N*m", "peak_torque": "3.82 N*m",
     "rotor_inertia": "2.91e-5 kg*m^2", "mass": "1.5 kg"}),
    ("yaskawa", "brakes", "SGMGV-09", {"static_torque": "12.7 N*m", "power": "10 W", "release_time": "100 ms"}),
    ("br_automation", "brakes", "8JSA4", {"static_torque": "5.3 N*m", "power": "12.8 W", "inertia": "0.068 kg*cm^2",
     "mass": "0.63 kg"}),
    ("emerson", "brakes", "IC830M4", {"static_torque": "5.3 N*m", "max_speed": "6000 rpm", "engage_time": "30 ms"}),
    ("omron", "brakes", "R88M-K90010", {"static_torque": "13.7 N*m", "inertia": "1.35 kg*cm^2",
     "energy_per_stop": "1176 J", "backlash": "1 deg"}),
    ("intorq", "brakes", "BFK458-10", {"dynamic_torque": "16 N*m", "release_time": "76 ms", "engage_time": "47 ms"}),
    ("pi", "brakes", "L-417", {"static_torque": "1.42 N*m", "engage_time": "36 ms"}),
    # ROBOTIS e-Manual, _data/dxl_x_info.yml, dxl_mx_info.yml, dxl_p_info.yml, pages AX-12A and XL-320
    ("robotis", "actuators", "XM430-W350 12 V", {"ratio": "353.5", "stall_torque": "4.1 N*m", "stall_current": "2.3 A",
     "no_load_speed": "46 rpm", "mass": "82 g", "backlash": "15 arcmin"}),
    ("robotis", "actuators", "XL330-M077-T 5 V", {"ratio": "77.5", "stall_torque": "0.215 N*m", "mass": "18 g",
     "stall_current": "1.47 A", "no_load_speed": "383 rpm", "ambient_max": "60 degC"}),
    ("robotis", "actuators", "XW540-T140 14.8 V", {"ratio": "145.6", "stall_torque": "8.3 N*m", "supply_max": "14.8 V",
     "stall_current": "5.9 A", "no_load_speed": "88 rpm", "mass": "185 g"}),
    ("robotis", "actuators", "XH540-V270", {"ratio": "272.5", "stall_torque": "9.2 N*m", "stall_current": "2.4 A",
     "no_load_speed": "34 rpm", "max_radial_load": "40 N", "max_axial_load": "20 N"}),
    ("robotis", "actuators", "MX-64 12 V", {"ratio": "200", "output_inertia": "0.0112 kg*m^2",
        "stall_torque": "6.0 N*m", "stall_current": "4.1 A",
     "no_load_speed": "63 rpm", "mass": "165 g", "backlash": "20 arcmin"}),
    ("robotis", "actuators", "PH54-200-S500-R", {"ratio": "501.923", "no_load_speed": "33.1 rpm", "mass": "855 g",
     "no_load_current": "1.65 A", "nominal_speed": "29 rpm", "nominal_torque": "44.7 N*m", "nominal_current": "9.3 A"}),
    ("robotis", "actuators", "XL-320", {"ratio": "238", "stall_torque": "0.39 N*m", "stall_current": "1.1 A",
     "no_load_speed": "114 rpm", "mass": "16.7 g"}),
    # Harmonic Drive manual 1018854, edition 12/2015; what is per ampere stands under WORKED
    ("harmonic_drive", "actuators", "CHA-20A-100", {"nominal_voltage": "680 V", "peak_torque": "82 N*m",
     "max_speed": "60 rpm", "nominal_torque": "49 N*m", "resistance": "5.9 ohm", "inductance": "8 mH",
     "output_inertia": "2.32 kg*m^2"}),
    ("harmonic_drive", "actuators", "CHA-14A-E-50", {"nominal_voltage": "48 V", "peak_torque": "18 N*m",
     "max_speed": "170 rpm", "nominal_torque": "6.9 N*m", "resistance": "0.42 ohm", "mass": "1.6 kg"}),
    ("harmonic_drive", "actuators", "CHA-58A-160", {"peak_torque": "1840 N*m", "max_speed": "19 rpm",
     "nominal_torque": "1080 N*m", "output_inertia": "122 kg*m^2", "mass": "28.2 kg", "pole_pairs": "6"}),
    ("harmonic_drive", "gearheads", "CSF-25-50-2UH", {"ratio": "50", "ratcheting_torque": "450 N*m",
     "rated_life": "7000 h", "median_life": "35000 h", "continuous_torque": "39 N*m", "mass": "1.5 kg",
     "intermittent_torque": "98 N*m", "emergency_torque": "186 N*m", "inertia": "4.13e-5 kg*m^2"}),
    ("harmonic_drive", "gearheads", "SHG25-100", {"ratio": "100", "continuous_torque": "87 N*m", "mass": "0.48 kg",
     "intermittent_torque": "204 N*m", "emergency_torque": "369 N*m", "intermittent_input_speed": "4500 rpm"}),
    # Beckhoff Information System: SP (AG2300), NPT (AG3400), TP (AG2400)
    ("wittenstein", "gearheads", "SP 060 MF 10:1", {"continuous_torque": "27 N*m", "intermittent_torque": "38 N*m",
     "emergency_torque": "100 N*m", "no_load_torque": "0.32 N*m", "backlash": "4 arcmin", "inertia": "0.09 kg*cm^2"}),
    ("wittenstein", "gearheads", "SP 140 MF 10:1", {"continuous_torque": "327 N*m", "intermittent_torque": "636 N*m",
     "continuous_input_speed": "2600 rpm", "max_tilting_moment": "952 N*m", "efficiency": "97 %", "mass": "17.2 kg"}),
    ("wittenstein", "gearheads", "SP 140 MC 10:1", {"rated_life": "30000 h",
     "continuous_torque": "195 N*m", "intermittent_torque": "380 N*m",
     "intermittent_input_speed": "6000 rpm", "no_load_torque": "1.7 N*m", "efficiency": "98.5 %"}),
    ("wittenstein", "gearheads", "NPT 005 MF 5:1", {"continuous_torque": "6.5 N*m", "intermittent_torque": "14 N*m",
     "emergency_torque": "26 N*m", "continuous_input_speed": "4000 rpm", "stiffness": "1.2 N*m/arcmin",
     "inertia": "0.03 kg*cm^2"}),
    ("apex", "gearheads", "AF060-050-P1", {"ratio": "50", "continuous_torque": "60 N*m",
     "intermittent_torque": "108 N*m", "emergency_torque": "180 N*m", "backlash": "5 arcmin"}),
    ("nabtesco", "gearheads", "RV-42N-164.07", {"ratio": "164.07", "continuous_torque": "412 N*m",
     "backlash": "1 arcmin", "intermittent_torque": "1029 N*m", "emergency_torque": "2058 N*m",
     "stiffness": "113 N*m/arcmin"}),
    # brushed gearmotors: Pololu's sheet of the 37D in kg cm, the FTC table, DFRobot's wiki in kg cm, Feetech, Studica
    ("pololu", "actuators", "37D 19:1 12 V", {"ratio": "18.75", "no_load_speed": "530 rpm", "no_load_current": "0.2 A",
     "stall_torque": "0.8336 N*m", "stall_current": "5.5 A", "steps_per_turn": "1200"}),
    ("pololu", "actuators", "37D 131:1 24 V", {"ratio": "131.25", "no_load_speed": "79 rpm", "steps_per_turn": "8400",
     "no_load_current": "0.1 A"}),
    ("pololu", "actuators", "25D 47:1 HP 12 V", {"ratio": "46.85", "no_load_speed": "220 rpm", "stall_current": "5 A",
     "no_load_current": "0.3 A", "stall_torque": "1.471 N*m", "steps_per_turn": "2248.86"}),
    ("pololu", "actuators", "micro metal 298:1 LP 6 V", {"ratio": "297.92", "no_load_speed": "45 rpm", "mass": "10 g",
     "no_load_current": "0.02 A", "stall_torque": "0.1961 N*m", "stall_current": "0.36 A"}),
    ("pololu", "actuators", "mini plastic 120:1 HP 4.5 V", {"nominal_voltage": "4.5 V", "no_load_speed": "150 rpm",
     "no_load_current": "0.13 A", "stall_torque": "0.1765 N*m", "stall_current": "1.25 A"}),
    ("gobilda", "actuators", "5203-2402-0014", {"no_load_speed": "435 rpm", "no_load_current": "0.25 A",
     "stall_torque": "1.8338 N*m", "stall_current": "9.2 A", "steps_per_turn": "384.5"}),
    ("gobilda", "motors", "5203-2402-0001", {"nominal_voltage": "12 V", "no_load_speed": "6000 rpm",
     "stall_torque": "0.1442 N*m", "stall_current": "9.2 A"}),
    ("tetrix", "actuators", "TorqueNADO 40:1", {"ratio": "40", "no_load_speed": "150 rpm", "stall_torque": "3.2907 N*m",
     "stall_current": "8.7 A", "mass": "324 g"}),
    ("dfrobot", "actuators", "FIT0403", {"ratio": "90", "no_load_speed": "122 rpm", "no_load_current": "0.35 A",
     "stall_current": "7 A", "mass": "205 g"}),
    ("feetech", "actuators", "ST-3250-C001", {"nominal_voltage": "12 V", "no_load_current": "0.28 A", "ratio": "345",
     "steps_per_turn": "4096", "backlash": "0.5 deg"}),
    ("studica", "actuators", "Maverick", {"ratio": "61", "no_load_speed": "100 rpm", "no_load_current": "0.6 A",
     "nominal_speed": "80 rpm", "nominal_torque": "0.9816 N*m", "nominal_current": "2.2 A", "stall_torque": "5 N*m"}),
    ("vex", "actuators", "V5 11 W 36:1", {"ratio": "36", "max_speed": "100 rpm", "peak_torque": "2.1 N*m",
     "peak_current": "2.5 A"}),
    # brushless actuators
    ("cubemars", "actuators", "AK80-9 V3.0 KV100", {"nominal_voltage": "48 V", "nominal_torque": "9 N*m", "ratio": "9",
     "peak_torque": "22 N*m", "nominal_speed": "390 rpm", "no_load_speed": "570 rpm", "mass": "0.49 kg"}),
    ("cubemars", "actuators", "AK10-9 V2.0 KV60", {"nominal_torque": "18 N*m", "peak_torque": "48 N*m",
     "mass": "0.96 kg", "nominal_speed": "228 rpm", "no_load_speed": "320 rpm", "rotor_inertia": "1002 g*cm^2",
     "backlash": "19.8 arcmin"}),
    ("cubemars", "actuators", "AK70-10 KV100", {"nominal_torque": "8.3 N*m", "peak_torque": "24.8 N*m", "ratio": "10",
     "nominal_speed": "310 rpm", "no_load_speed": "480 rpm", "backlash": "12 arcmin", "pole_pairs": "21"}),
    ("cubemars", "motors", "RI50 KV100", {"resistance": "1.42 ohm", "inductance": "1500 uH",
     "torque_constant": "120 mN*m/A", "nominal_current": "4.8 A", "mass": "0.1808 kg"}),
    ("damiao", "actuators", "DM-J8009-2EC", {"nominal_torque": "20 N*m", "peak_torque": "40 N*m", "mass": "896 g",
     "rotor_inertia": "1950 g*cm^2", "ratio": "9"}),
    ("damiao", "actuators", "DM-J4310-2EC V1.1 (48V)", {"peak_torque": "7 N*m", "no_load_speed": "400 rpm",
     "rotor_inertia": "180 g*cm^2"}),
    ("encos", "actuators", "EC-A8112-P1-18", {"ratio": "18", "peak_torque": "90 N*m", "max_speed": "157 rpm",
     "output_inertia": "0.04849 kg*m^2"}),
    ("robstride", "actuators", "RS00", {"ratio": "10", "nominal_voltage": "48 V", "nominal_torque": "5 N*m",
     "peak_torque": "14 N*m", "nominal_speed": "100 rpm", "no_load_speed": "315 rpm", "mass": "0.31 kg"}),
    ("robstride", "actuators", "RS04", {"ratio": "9", "nominal_torque": "40 N*m", "peak_torque": "120 N*m",
     "no_load_speed": "200 rpm", "mass": "1.42 kg", "output_inertia": "0.04 kg*m^2"}),
    ("lktech", "actuators", "MG8008-i9", {"ratio": "9", "nominal_torque": "10 N*m", "peak_torque": "20 N*m"}),
    ("unitree", "actuators", "GO-M8010-6", {"ratio": "6.33", "peak_torque": "23.7 N*m",
     "rotor_inertia": "1118.42 g*cm^2", "max_speed": "30 rad/s"}),
    ("xiaomi", "actuators", "CyberGear", {"ratio": "7.75", "nominal_voltage": "24 V", "nominal_torque": "4 N*m",
     "peak_torque": "12 N*m", "nominal_speed": "240 rpm", "no_load_speed": "296 rpm", "mass": "317 g"}),
    ("myactuator", "actuators", "RMD-X10-P35-100", {"ratio": "35", "nominal_speed": "50 rpm",
     "nominal_torque": "50 N*m", "nominal_current": "6.7 A", "rotor_inertia": "5675 g*cm^2", "pole_pairs": "21"}),
    ("myactuator", "actuators", "RMD-X6-P36-40", {"ratio": "36", "nominal_speed": "90 rpm", "nominal_torque": "18 N*m",
     "nominal_current": "5.2 A", "rotor_inertia": "800 g*cm^2"}),
    # motors: ReCalc and WPILib; drive files of Synapticon and of the Paul Scherrer Institute; ODrive by pypowertrain
    ("ctre", "motors", "Kraken X60", {"stall_torque": "7.157 N*m", "stall_current": "374.383 A", "mass": "0.5443 kg",
     "no_load_current": "2.83 A", "no_load_speed": "6065 rpm"}),
    ("ctre", "motors", "Minion", {"stall_torque": "3.173 N*m", "stall_current": "211.607 A", "mass": "0.2948 kg",
     "no_load_current": "2.206 A", "no_load_speed": "7703 rpm"}),
    ("rev", "motors", "NEO V1.1", {"stall_torque": "4.201 N*m", "stall_current": "216.269 A", "mass": "0.4255 kg",
     "no_load_current": "1.782 A", "no_load_speed": "5906 rpm"}),
    ("rev", "motors", "NEO Vortex", {"stall_torque": "3.6 N*m", "stall_current": "211 A", "no_load_current": "3.6 A",
     "no_load_speed": "6784 rpm"}),
    ("vex", "motors", "775pro", {"stall_torque": "0.71 N*m", "stall_current": "134 A", "no_load_current": "0.7 A",
     "no_load_speed": "18730 rpm"}),
    ("vex", "motors", "Falcon 500", {"stall_torque": "4.69 N*m", "stall_current": "257 A", "no_load_current": "1.5 A",
     "no_load_speed": "6380 rpm", "mass": "0.567 kg"}),
    ("andymark", "motors", "NeveRest", {"stall_torque": "0.173 N*m", "stall_current": "9.8 A",
     "no_load_speed": "5480 rpm", "no_load_current": "0.355 A"}),
    ("andymark", "motors", "CIM", {"stall_torque": "2.425 N*m", "stall_current": "133 A", "no_load_current": "2.7 A",
     "no_load_speed": "5310 rpm"}),
    ("banebots", "motors", "BaneBots RS-550", {"stall_torque": "0.488 N*m", "stall_current": "85 A",
     "no_load_current": "1.4 A", "no_load_speed": "19300 rpm"}),
    ("banebots", "motors", "BaneBots RS-775", {"stall_torque": "0.72 N*m", "stall_current": "97 A",
     "no_load_current": "2.7 A", "no_load_speed": "13050 rpm"}),
    ("amk", "motors", "DT4", {"nominal_torque": "1.25 N*m", "peak_torque": "2.5 N*m", "assigned_power": "300 W",
     "resistance": "0.49 ohm", "inductance": "580 uH", "max_speed": "3700 rpm"}),
    ("nanotec", "motors", "DB59L024035-A", {"nominal_torque": "0.47 N*m", "peak_torque": "1.41 N*m", "pole_pairs": "3",
     "nominal_current": "9.4 A", "resistance": "0.22 ohm", "torque_constant": "0.05 N*m/A"}),
    ("tq", "motors", "ILM 115x25", {"nominal_torque": "5.4 N*m", "peak_torque": "12.2 N*m", "assigned_power": "735 W",
     "resistance": "0.125 ohm", "inductance": "525 uH", "max_speed": "3000 rpm"}),
    ("odrive", "motors", "M8325s 100KV", {"speed_constant": "100 rpm/V", "pole_pairs": "20", "mass": "0.84 kg"}),
    ("kollmorgen", "motors", "TBM(S)-6051-A", {"nominal_torque": "1.16 N*m", "peak_torque": "4.53 N*m",
     "mass": "0.55 kg", "nominal_current": "7.0 A", "rotor_inertia": "4.75e-5 kg*m^2"}),
    ("anaheim", "motors", "BLY171D-24V-4000", {"nominal_voltage": "24 V", "nominal_torque": "0.0628 N*m",
     "peak_torque": "0.219 N*m", "nominal_speed": "4000 rpm", "mass": "0.299 kg", "length": "40.4 mm"}),
    ("beckhoff", "motors", "AM8112-wFyz", {"nominal_voltage": "48 V", "inductance": "0.8 mH",
     "rotor_inertia": "48 g*cm^2", "winding_time_constant": "41.9 s"}),
    ("beckhoff", "motors", "AM8131-wFyz", {"inductance": "5.3 mH", "rotor_inertia": "462 g*cm^2", "pole_pairs": "4"}),
    ("yaskawa", "motors", "SGM7J-04A", {"nominal_torque": "1.27 N*m", "peak_torque": "4.46 N*m",
     "max_speed": "6000 rpm", "rotor_inertia": "0.486 kg*cm^2", "assigned_power": "400 W",
     "shaft_diameter": "14 mm", "mass": "1.1 kg"}),
    ("mitsubishi", "motors", "HG-JR203", {"nominal_torque": "6.4 N*m", "peak_torque": "19.1 N*m",
     "rotor_inertia": "4.92 kg*cm^2", "max_speed": "6000 rpm", "mass": "7.5 kg"}),
    ("allen_bradley", "motors", "VPL-B0751M", {"standstill_torque": "1.01 N*m", "peak_torque": "2.27 N*m",
     "rotor_inertia": "0.136 kg*cm^2", "max_speed": "8000 rpm", "mass": "1.48 kg"}),
    ("omron", "motors", "R88M-K1K520T/T", {"nominal_torque": "7.16 N*m", "peak_torque": "21.5 N*m",
     "rotor_inertia": "6.7 kg*cm^2", "max_speed": "3000 rpm", "mass": "6.7 kg"}),
    ("ls_mecapion", "motors", "APM-FG20G", {"nominal_torque": "11.5 N*m", "peak_torque": "34.4 N*m",
     "rotor_inertia": "14.13 kg*cm^2", "max_speed": "3000 rpm", "mass": "15.42 kg"}),
    ("fanuc", "motors", "aiS 8/6000", {"standstill_torque": "8 N*m", "peak_torque": "22 N*m",
     "rotor_inertia": "11.7 kg*cm^2", "max_speed": "6000 rpm", "mass": "8 kg"}),
    ("nidec", "motors", "D64", {"nominal_torque": "0.76 N*m", "peak_torque": "2.59 N*m",
     "rotor_inertia": "0.158 kg*cm^2", "max_speed": "3500 rpm", "mass": "0.516 kg"}),
    ("siemens", "motors", "1FT7042-5AF7", {"nominal_torque": "2.7 N*m", "peak_torque": "13 N*m",
     "max_speed": "6600 rpm", "rotor_inertia": "3.68 kg*cm^2", "mass": "4.6 kg"}),
    ("panasonic", "motors", "MSMF012L1", {"nominal_torque": "0.32 N*m", "shaft_diameter": "8 mm", "mass": "0.47 kg"}),
    ("br_automation", "motors", "8JSA32.ee030", {"nominal_torque": "1.81 N*m", "standstill_torque": "2 N*m",
     "resistance": "23.76 ohm", "inductance": "46.5 mH", "motor_time_constant": "1020 s"}),
    ("wittenstein", "motors", "premo 320 V 3F", {"resistance": "0.53 ohm", "inductance": "2.25 mH",
     "standstill_torque": "6.38 N*m", "thermal_resistance_housing": "0.54 K/W", "motor_time_constant": "1992 s"}),
    ("tamagawa", "motors", "TSM3104E040", {"peak_torque": "1.11 N*m", "standstill_torque": "0.318 N*m",
     "mass": "0.7 kg", "max_speed": "6000 rpm", "rotor_inertia": "6.7e-6 kg*m^2", "top_speed_torque": "0.18 N*m"}),
    ("tamagawa", "motors", "TS4872", {"peak_torque": "0.155 N*m", "nominal_torque": "0.051 N*m", "mass": "0.15 kg",
     "rotor_inertia": "4.7e-7 kg*m^2", "top_speed_torque": "0.025 N*m"}),
    ("tamagawa", "motors", "TSM3204E200", {"peak_torque": "3.256 N*m", "standstill_torque": "1.27 N*m",
     "nominal_torque": "1.1 N*m", "max_speed": "8000 rpm", "rotor_inertia": "5e-5 kg*m^2"}),
    # steppers: Beckhoff's manual, and the files that terminals are loaded with (ecmccfg)
    ("beckhoff", "steppers", "AS1060", {"phase_current": "5 A", "holding_torque": "5 N*m", "resistance": "0.36 ohm",
     "inductance": "2.8 mH", "rotor_inertia": "3000 g*cm^2", "max_radial_load": "191 N", "mass": "2.85 kg"}),
    ("aml", "steppers", "D42.3", {"phase_current": "1 A", "holding_torque": "0.45 N*m", "resistance": "8.5 ohm",
     "inductance": "19.5 mH", "rotor_inertia": "102 g*cm^2"}),
    ("amp", "steppers", "57TH76-4280", {"phase_current": "2.8 A", "resistance": "1.13 ohm", "inductance": "3.6 mH"}),
    ("ams", "steppers", "AM23-239-3", {"phase_current": "3 A", "resistance": "0.95 ohm", "inductance": "3.36 mH"}),
    ("leadshine", "steppers", "57HS22 series", {"phase_current": "2.8 A", "resistance": "1.6 ohm",
     "full_steps": "200"}),
    ("leadshine", "steppers", "57HS13 parallel", {"phase_current": "4 A", "resistance": "0.5 ohm",
     "full_steps": "200"}),
    ("mclennan", "steppers", "HT18C230 series", {"full_steps": "200", "resistance": "1.5 ohm", "inductance": "4.8 mH"}),
    ("motionking", "steppers", "23H2A8425", {"phase_current": "2.5 A", "resistance": "1.8 ohm",
     "inductance": "6.5 mH"}),
    ("nanotec", "steppers", "ST5918L1008 series", {"phase_current": "0.71 A", "resistance": "17.6 ohm",
     "full_steps": "200"}),
    ("oriental_motor", "steppers", "PK244M-01B", {"phase_current": "1.2 A", "resistance": "3.3 ohm",
     "inductance": "4.3 mH", "full_steps": "400"}),
    ("parker", "steppers", "TS33B", {"phase_current": "4 A", "holding_torque": "10.7 N*m", "resistance": "1.45 ohm",
     "inductance": "13.6 mH"}),
    ("phytron", "steppers", "VSS 52.200.2.5", {"phase_current": "2.5 A", "resistance": "0.6 ohm", "full_steps": "200"}),
    ("stepperonline", "steppers", "17HS19-2004S1", {"phase_current": "2 A", "holding_torque": "0.59 N*m",
     "resistance": "1.6 ohm", "inductance": "3 mH", "rotor_inertia": "82 g*cm^2", "shaft_diameter": "5 mm"}),
    ("ldo", "steppers", "42STH48-2504AC", {"phase_current": "2.5 A", "holding_torque": "0.55 N*m"}),
    ("cloudray", "steppers", "17CS07A-180", {"phase_current": "1.8 A", "holding_torque": "0.71 N*m",
     "resistance": "1.94 ohm"}),
    ("fysetc", "steppers", "35HSH7402-24B-400A", {"phase_current": "1.5 A", "holding_torque": "0.42 N*m",
     "resistance": "2.8 ohm"}),
    ("hanpose", "steppers", "17HS9401", {"phase_current": "2.8 A", "holding_torque": "0.92 N*m",
     "resistance": "1.5 ohm"}),
    ("kelimotor", "steppers", "BJ42D41-14V19", {"phase_current": "2 A", "holding_torque": "0.65 N*m",
     "resistance": "1.1 ohm"}),
    ("moons", "steppers", "MS17HA2P4200", {"phase_current": "2.0 A", "holding_torque": "0.39 N*m",
     "resistance": "1.05 ohm"}),
    ("motech", "steppers", "1705HS200A", {"phase_current": "2.0 A", "holding_torque": "0.82 N*m",
     "resistance": "2.0 ohm"}),
    ("oukeda", "steppers", "OK42STH47-204A1XH", {"phase_current": "2.0 A", "holding_torque": "0.59 N*m",
     "resistance": "1.4 ohm"}),
    ("rattm", "steppers", "17HS4402", {"phase_current": "1.3 A", "holding_torque": "0.4 N*m", "resistance": "2.5 ohm"}),
    ("shengyang", "steppers", "42BYGH3025-3M-25D", {"phase_current": "4.0 A", "holding_torque": "0.56 N*m",
     "resistance": "0.4 ohm"}),
    ("siboor", "steppers", "35STH52-1204A", {"phase_current": "1.2 A", "holding_torque": "0.4 N*m",
     "resistance": "2.3 ohm"}),
    ("usongshine", "steppers", "17HS8401S", {"phase_current": "1.7 A", "holding_torque": "0.52 N*m",
     "resistance": "1.8 ohm"}),
    ("wantai", "steppers", "42BYGHW811", {"phase_current": "2.5 A", "holding_torque": "0.48 N*m",
     "resistance": "1.25 ohm"}),
    ("trinamic", "steppers", "QSH4218-41-10-035", {"phase_current": "1 A", "resistance": "4.5 ohm",
     "inductance": "7.5 mH"}),
    # belts and pulleys: ReCalc
    ("andymark", "belts", "am-2267", {"teeth": "104", "width": "15 mm", "pitch": "5 mm"}),
    ("andymark", "pulleys", "am-4626", {"teeth": "24", "width": "18 mm", "pitch": "5 mm"}),
    ("last_anvil", "pulleys", "LA-240107", {"teeth": "18", "width": "9 mm", "pitch": "5 mm"}),
    ("last_anvil", "belts", "LA-240219", {"teeth": "35", "width": "9 mm", "pitch": "5 mm"}),
    ("rev", "pulleys", "REV-21-1908", {"teeth": "12", "width": "16 mm", "pitch": "3 mm"}),
    ("rev", "belts", "REV-21-4104", {"teeth": "104", "width": "12.7 mm", "pitch": "6.35 mm"}),
    ("sds", "belts", "SDS HTD 390-5M-15", {"teeth": "78", "width": "15 mm", "pitch": "5 mm"}),
    ("swyft", "belts", "Swyft 1000-5M-15", {"teeth": "200", "width": "15 mm", "pitch": "5 mm"}),
    ("thrifty", "pulleys", "TTB-0061", {"teeth": "11", "width": "18.5 mm", "pitch": "5 mm"}),
    ("vbelt", "belts", "1000-5m-15", {"teeth": "200", "width": "15 mm", "pitch": "5 mm"}),
    ("wcp", "belts", "WCP-1636", {"teeth": "51", "width": "6 mm", "pitch": "3 mm"}),
    ("wcp", "pulleys", "WCP-0565", {"teeth": "30", "width": "9 mm", "pitch": "5 mm"}),
    # screws: makers' catalogues
    ("thk", "screws", "WTF 2040-3", {"lead": "40 mm", "root_diameter": "17.5 mm", "ball_diameter": "20.75 mm",
     "dynamic_load": "6.6 kN", "static_load": "17.2 kN", "dn_max": "70000", "axial_play": "0.1 mm"}),
    ("thk", "screws", "CS 12 / DCM 12", {"lead": "2 mm", "root_diameter": "9.5 mm",
     "pitch_diameter": "11 mm", "permissible_thrust": "3920 N", "nut_mass": "0.1 kg"}),
    ("hiwin", "screws", "R12-05K4-FSCDIN", {"root_diameter": "9.9 mm", "shaft_diameter": "11.7 mm",
     "dynamic_load": "5500 N", "static_load": "12 kN", "efficiency": "85 %", "back_efficiency": "75 %"}),
    ("rexroth", "screws", "6x1Rx0.8-4", {"dynamic_load": "900 N", "static_load": "1290 N", "dn_max": "18000"}),
    ("wangong", "screws", "SFS1205-2.8", {"lead": "5 mm", "dynamic_load": "6482 N", "stiffness": "186 N/um"}),
    ("sfu", "screws", "SFU1204-4", {"dynamic_load": "5815 N", "static_load": "11072 N"}),
    ("pbc", "screws", "16 x 25 mm lead", {"diameter": "16 mm", "lead": "25 mm", "efficiency": "83 %"}),
    # power supplies and brake resistors
    ("beckhoff", "power_supplies", "PS2001-4810", {"peak_current": "30 A", "peak_time": "12 ms",
     "voltage_max": "56 V"}),
    ("mean_well", "power_supplies", "SDR-480-48", {"continuous_current": "10 A", "peak_current": "15 A",
     "peak_time": "3 s", "efficiency": "94 %", "hold_up": "14 ms"}),
    ("mean_well", "power_supplies", "RSD-150C-24", {"overvoltage_min": "27.6 V", "overvoltage_max": "32.4 V"}),
    ("solahd", "power_supplies", "SDN 20-24-480CC", {"overvoltage_min": "30.5 V", "return_voltage": "35 V"}),
    ("puls", "power_supplies", "QS40.241", {"peak_current": "60 A", "peak_time": "4 s", "efficiency": "94.6 %"}),
    ("phoenix_contact", "power_supplies", "QUINT4-PS/1AC/24DC/20", {"continuous_current": "20 A"}),
    ("roboteq", "brake_resistors", "SR2K60V25R, 30 V", {"resistance": "2.5 ohm", "power": "110 W",
     "chopper_voltage_max": "32 V", "capacitance": "1.65 mF"}),
    ("beckhoff", "brake_resistors", "AX2090-BW65-0518", {"resistance": "18 ohm", "power": "450 W", "mass": "2.8 kg"}),
    ("omron", "brake_resistors", "R88A-RR22047S", {"resistance": "47 ohm", "power": "70 W"}),
    ("teco", "brake_resistors", "JSDG2S-75A3", {"resistance": "12.5 ohm", "min_resistance": "6.8 ohm",
     "power": "12 W"}),
    ("te_connectivity", "brake_resistors", "HSC75", {"resistance_min": "0.05 ohm", "resistance_max": "50000 ohm",
     "max_voltage": "1400 V"}),
    ("danotherm", "brake_resistors", "HSD 140", {"resistance_min": "0.47 ohm", "max_voltage": "1200 V"}),
    ("factonation", "brake_resistors", "R8 750 W", {"resistance": "50 ohm", "power": "50 W"}),
    # batteries: a table of cells, and the blocks' sheets
    ("a123", "batteries", "ANR26650M1", {"nominal_voltage": "3.3 V", "capacity": "2.3 A*h", "mass": "0.07 kg"}),
    ("aa_portable_power", "batteries", "LFP-26650-3300", {"capacity": "3.3 A*h", "continuous_current": "9.9 A",
     "peak_current": "19.8 A", "resistance": "30 mohm", "mass": "0.09 kg"}),
    ("lg", "batteries", "LG M50LT", {"capacity": "5 A*h", "continuous_current": "7 A", "peak_current": "15 A",
     "resistance": "22 mohm", "mass": "69 g"}),
    ("molicel", "batteries", "Molicel P45B", {"capacity": "4.5 A*h", "continuous_current": "45 A",
     "peak_current": "50 A", "resistance": "12 mohm", "mass": "70 g"}),
    ("murata", "batteries", "Murata VTC6", {"capacity": "3 A*h", "continuous_current": "15 A", "peak_current": "30 A",
     "resistance": "13 mohm", "mass": "46.5 g"}),
    ("samsung", "batteries", "Samsung 40T", {"capacity": "4 A*h", "continuous_current": "25 A", "peak_current": "35 A",
     "resistance": "14 mohm", "mass": "67 g"}),
    ("sigmastek", "batteries", "SP12-20-DZM", {"capacity": "25.2 A*h", "capacity_1h": "17.7 A*h", "mass": "7.2 kg",
     "peak_current": "150 A", "resistance": "12 mohm", "rated_time": "20 h"}),
    ("sunnyway", "batteries", "SW12140E", {"capacity": "14 A*h", "capacity_5h": "12 A*h", "resistance": "13.5 mohm",
     "cutoff_voltage": "10.5 V", "mass": "3.7 kg"}),
    ("vapcell", "batteries", "Vapcell RS50", {"capacity": "5 A*h", "continuous_current": "30 A", "peak_current": "40 A",
     "mass": "70 g"}),
    ("vinachem", "batteries", "Vinachem 12V-40Ah", {"capacity": "40 A*h", "capacity_10h": "37.2 A*h", "mass": "16 kg",
     "peak_current": "160 A", "cutoff_voltage": "10.8 V"}),
    ("yhi", "batteries", "YHI NP125", {"capacity": "5 A*h", "capacity_10h": "4.75 A*h", "peak_current": "75 A",
     "resistance": "27 mohm", "mass": "1.92 kg"}),
    ("yuasa", "batteries", "NP7-12", {"capacity": "7 A*h", "cutoff_voltage": "10.5 V", "max_charge_current": "2.1 A",
     "mass": "2.65 kg"}),
    # controllers: the sheets' pages in public copies, read again for this test
    ("amc", "controllers", "B15A8", {"supply_min": "20 V", "supply_max": "80 V", "absolute_max": "86 V",
     "mass": "0.28 kg", "continuous_current": "7.5 A", "peak_current": "15 A", "pwm_frequency": "33 kHz"}),
    ("basicmicro", "controllers", "RoboClaw Solo 60A", {"supply_min": "6 V", "supply_max": "34 V",
     "continuous_current": "60 A", "peak_current": "100 A"}),
    ("cytron", "controllers", "SmartDriveDuo-60 MDDS60", {"supply_min": "10 V", "supply_max": "45 V",
     "peak_time": "1 s", "continuous_current": "60 A", "peak_current": "100 A", "pwm_frequency": "16 kHz"}),
    ("dimension_engineering", "controllers", "Sabertooth 2x25 V2", {"supply_min": "6 V", "supply_max": "30 V",
     "absolute_max": "33.6 V", "continuous_current": "25 A", "peak_current": "50 A", "mass": "90 g"}),
    ("dimension_engineering", "controllers", "Sabertooth 2x5 RC", {"supply_min": "6 V", "supply_max": "18 V",
     "continuous_current": "5 A", "peak_current": "10 A", "mass": "18 g"}),
    ("mjbots", "controllers", "moteus n1 (cooled)", {"supply_min": "10 V", "absolute_max": "54 V",
     "continuous_current": "26 A", "peak_current": "100 A"}),
    ("mjbots", "controllers", "moteus r4.11", {"max_power": "900 W", "max_power_voltage": "30 V",
     "reduced_power": "400 W", "reduced_power_voltage": "38 V"}),
    ("mjbots", "controllers", "moteus c1", {"max_power": "250 W", "max_power_voltage": "28 V",
     "reduced_power": "150 W", "reduced_power_voltage": "41 V"}),
    ("roboteq", "controllers", "SDC2130", {"supply_min": "10 V", "supply_max": "35 V", "continuous_current": "15 A",
     "peak_current": "20 A", "peak_time": "30 s"}),
    ("rev", "motors", "NEO 550", {"no_load_speed": "11000 rpm", "no_load_current": "1.4 A", "stall_torque": "0.97 N*m",
     "stall_current": "100 A"}),
    # 1200 W at 2000 rpm are 5.730 N*m, 440 W at 4500 rpm 0.9337; both are more at standstill
    ("fanuc", "motors", "beta 8.0/3000is", {"nominal_torque": "5.73 N*m", "standstill_torque": "7 N*m"}),
    ("allen_bradley", "motors", "VPL-A0633F", {"nominal_torque": "0.934 N*m", "standstill_torque": "1.27 N*m"}),
    ("mjbots", "controllers", "moteus x1", {"supply_min": "10 V", "absolute_max": "54 V", "continuous_current": "25 A",
     "peak_current": "120 A"}),
    ("phidgets", "controllers", "Phidgets 1064 MotorControl HC", {"supply_max": "15 V", "continuous_current": "14 A"}),
    ("roboteq", "controllers", "HDC2450S", {"supply_min": "9 V", "supply_max": "50 V", "continuous_current": "160 A",
     "peak_current": "300 A", "peak_time": "30 s"}),
    ("technosoft", "controllers", "iPOS4808 BX-CAT-STO", {"supply_max": "48 V", "continuous_current": "8 A",
     "max_efficiency": "98 %", "mass": "125 g"}),
    ("vesc", "controllers", "VESC 75/300", {"supply_min": "11 V", "supply_max": "72 V", "peak_current": "400 A",
     "max_duty": "99 %"}),
    ("vesc", "controllers", "VESC 60/75", {"supply_min": "11 V", "supply_max": "72 V", "peak_current": "120 A"}),
    ("synapticon", "controllers", "Circulo 7", {"absolute_max": "60 V", "mass": "92 g", "max_efficiency": "98 %"}),
    # pins: the pages were not to be had again
    ("granite_devices", "controllers", "IONI Pro HC", {"supply_max": "58 V", "peak_current": "25 A"}),
    ("odrive", "controllers", "ODrive Pro", {"supply_min": "15 V", "supply_max": "58 V", "continuous_current": "20 A"}),
    ("pololu", "controllers", "Jrk 12v12", {"supply_min": "6 V", "supply_max": "16 V", "continuous_current": "12 A"}),
    ("rev", "controllers", "SPARK Flex", {"supply_min": "6 V", "supply_max": "24 V", "continuous_current": "60 A"}),
    ("posital", "encoders", "OCD-IBA1B-1212-B10S-PRI", {"steps_per_turn": "4096", "inertia": "30 g*cm^2",
     "max_mechanical_speed": "3000 rpm"}),
    # encoders: the sheets' pages in public copies, read again for this test
    ("ams_osram", "encoders", "AS5047U ABI 4096", {"counts_per_turn": "4096", "max_speed": "28000 rpm"}),
    ("ams_osram", "encoders", "AS5247 ABI 512", {"counts_per_turn": "512"}),
    ("broadcom", "encoders", "HEDS-5500#A", {"counts_per_turn": "500", "max_frequency": "100 kHz", "channels": "2",
     "current_draw": "17 mA", "inertia": "0.6 g*cm^2"}),
    ("cui", "encoders", "AMT102-512", {"counts_per_turn": "512", "max_speed": "15000 rpm", "current_draw": "6 mA",
     "mass": "20.5 g"}),
    ("cui", "encoders", "AMT103-500", {"counts_per_turn": "500", "max_speed": "7500 rpm", "mass": "14.0 g"}),
    ("cui", "encoders", "AMT203 SPI", {"steps_per_turn": "4096", "max_speed": "8000 rpm", "mass": "15.7 g",
     "current_draw": "8 mA"}),
    ("kuebler", "encoders", "8.5020.2842.3600", {"counts_per_turn": "3600", "max_frequency": "300 kHz",
     "max_mechanical_speed": "6000 rpm", "inertia": "6e-6 kg*m^2", "current_draw": "40 mA"}),
    ("kuebler", "encoders", "8.5000.8358.1000", {"counts_per_turn": "1000", "inertia": "1.8e-6 kg*m^2",
     "current_draw": "50 mA", "diameter": "58 mm"}),
    ("rls", "encoders", "RM08I-1024", {"counts_per_turn": "1024", "diameter": "8 mm"}),
    ("rls", "encoders", "RM08S-4096", {"steps_per_turn": "4096", "diameter": "8 mm"}),
    ("usdigital", "encoders", "E2-5000", {"counts_per_turn": "5000"}),
]  # fmt: skip

# Figures by hand; the files have them to three digits or four. i is the ratio, e the efficiency, speeds are in rad/s.
WORKED: list[tuple[str, str, str, Figures]] = [
    # R = 12 / 2.3; k = 12 / (353.5 x 4.817); e = 4.1 / (353.5 x 7.047e-3 x 2.3); a fifth of the stall point
    ("robotis", "actuators", "XM430-W350 12 V", {"resistance": "5.217 ohm", "motor_torque_constant": "7.047 mN*m/A",
     "efficiency": "71.56 %", "nominal_torque": "0.82 N*m", "nominal_current": "0.46 A"}),
    # R = 7.4 / 1.1; k = (7.4 - 0.18 x 6.727) / (238 x 11.938); e = 0.39 / (238 x 2.178e-3 x 0.92)
    ("robotis", "actuators", "XL-320", {"resistance": "6.727 ohm", "motor_torque_constant": "2.178 mN*m/A",
     "efficiency": "81.8 %"}),
    # 24 = 1.65 R + 3.4662 x = 9.3 R + 3.0369 x with x = i k: R = 0.05612 x, x = 6.744; e = 44.7 / (6.744 x 7.65)
    ("robotis", "actuators", "PH54-200-S500-R", {"resistance": "0.3785 ohm", "motor_torque_constant": "13.44 mN*m/A",
     "efficiency": "86.6 %"}),
    # 11.9 A x 0.866 = 10.31; R = k^2 (594.28 - 488.41) / 0.32; 24 = 10.31 R + 488.41 k: k = 0.03869
    ("robotis", "actuators", "YM070-210-M001-RH", {"resistance": "0.4952 ohm", "motor_torque_constant": "38.69 mN*m/A",
     "nominal_current": "10.3 A", "no_load_current": "2.035 A"}),
    # R = 12 / 5.5; k = (12 - 0.2 x 2.182) / (18.75 x 55.50); e = 0.8336 / (18.75 x 0.01111 x 5.3);
    # a quarter of 5.5 A: 0.8336 x (1.375 - 0.2) / 5.3
    ("pololu", "actuators", "37D 19:1 12 V", {"resistance": "2.182 ohm", "motor_torque_constant": "11.11 mN*m/A",
     "efficiency": "75.5 %", "nominal_current": "1.375 A", "nominal_torque": "0.1848 N*m"}),
    # R = 4.5 / 1.25; k = (4.5 - 0.13 x 3.6) / (120 x 15.708); e = 0.1765 / (120 x 2.139e-3 x 1.12)
    ("pololu", "actuators", "mini plastic 120:1 HP 4.5 V", {"resistance": "3.6 ohm", "efficiency": "61.4 %",
     "motor_torque_constant": "2.139 mN*m/A"}),
    # i = (63/17)^2 = 13.734; R = 12 / 9.2; k = (12 - 0.25 x 1.304) / (13.734 x 45.553); e = 1.8338 / (i k 8.95)
    ("gobilda", "actuators", "5203-2402-0014", {"ratio": "13.734", "resistance": "1.304 ohm", "efficiency": "79.95 %",
     "motor_torque_constant": "18.66 mN*m/A"}),
    # R = 12 / 8.7; k = 12 / (40 x 15.708); e = 3.2907 / (40 x 0.0191 x 8.7)
    ("tetrix", "actuators", "TorqueNADO 40:1", {"resistance": "1.379 ohm", "motor_torque_constant": "19.10 mN*m/A",
     "efficiency": "49.5 %"}),
    # 38 kg cm; R = 12 / 7; k = (12 - 0.35 x 1.714) / (90 x 12.776); e = 3.7265 / (90 x 9.915e-3 x 6.65)
    ("dfrobot", "actuators", "FIT0403", {"stall_torque": "38 kgf*cm", "resistance": "1.714 ohm", "efficiency": "62.8 %",
     "motor_torque_constant": "9.915 mN*m/A"}),
    # 50 kg cm; 0.133 s for 60 degrees: 10 / 0.133 rpm; R = 12 / 4.2; k = (12 - 0.28 R) / (345 x 7.874);
    # e = 4.9033 / (345 k 3.92)
    ("feetech", "actuators", "ST-3250-C001", {"no_load_speed": "75.19 rpm", "stall_torque": "50 kgf*cm",
     "resistance": "2.857 ohm", "motor_torque_constant": "4.123 mN*m/A", "efficiency": "87.9 %"}),
    # R = 12 / 11; k = (12 - 0.6 R) / (61 x 10.472); at the rated point e = 0.9816 / (61 x 0.01776 x 1.6)
    ("studica", "actuators", "Maverick", {"resistance": "1.091 ohm", "motor_torque_constant": "17.76 mN*m/A",
     "efficiency": "56.6 %"}),
    # line through 2.44 A at 60 to 0.95 A at 100 rpm: 4.69 A at 0, -0.359 A/(rad/s); R = 12.8 / 4.69; i k = 0.359 R;
    # 2.1 N*m at 2.5 A and 0.735 at 0.95: 0.8806 N*m/A = i k e
    ("vex", "actuators", "V5 11 W 36:1", {"resistance": "2.73 ohm", "motor_torque_constant": "27.2 mN*m/A",
     "efficiency": "90 %"}),
    # A rms x 1.2247, N*m/A rms / 1.2247: 1.6, 2.8, 33.4, 0.36; e = 33.4 / (100 x 0.36)
    ("harmonic_drive", "actuators", "CHA-20A-100", {"nominal_current": "1.96 A", "peak_current": "3.429 A",
     "torque_constant": "27.27 N*m/A", "motor_torque_constant": "293.9 mN*m/A", "efficiency": "92.78 %"}),
    # A peak x 0.866: 4.7, 15.5; 1.48 / 1.2247; 9.5 V rms per 1000 rpm x 1.4142 / 104.72; e = 5 / (10 x 0.1283 x 4.07)
    ("robstride", "actuators", "RS00", {"nominal_current": "4.07 A", "peak_current": "13.42 A", "efficiency": "95.75 %",
     "torque_constant": "1.208 N*m/A", "motor_torque_constant": "128.3 mN*m/A"}),
    # 6.5, 23 A x 0.866; 0.5 A x 1.2247; 0.87 / 1.2247; 0.0555 V/rpm x 9.549 x 1.4142 / 7.75; e = 4 / (7.75 k 5.629)
    ("xiaomi", "actuators", "CyberGear", {"nominal_current": "5.629 A", "peak_current": "19.92 A",
     "efficiency": "94.8 %", "no_load_current": "0.6124 A", "torque_constant": "0.7104 N*m/A",
     "motor_torque_constant": "96.71 mN*m/A"}),
    # 0.63895 N*m/A / 6.33; e = 23.7 / (0.63895 x 40); 2^15 x 6.33
    ("unitree", "actuators", "GO-M8010-6", {"motor_torque_constant": "100.9 mN*m/A", "efficiency": "92.7 %",
     "steps_per_turn": "207421.44"}),
    # 18.6, 40 A x 0.866; e = 20 / (9 x 0.1619 x 16.11); 2^14 x 9
    ("damiao", "actuators", "DM-J8009-2EC", {"nominal_current": "16.11 A", "peak_current": "34.64 A",
     "efficiency": "85.2 %", "steps_per_turn": "147456"}),
    # of 48 V x 10.7 A go 0.248 x 13.26^2 W into the winding: e = 18 x 24.61 / 470; 18 and 53 N*m / (9 x 0.943 x 0.16)
    ("cubemars", "actuators", "AK10-9 V3.0 KV60", {"efficiency": "94.25 %", "nominal_current": "13.26 A",
     "peak_current": "39.03 A"}),
    # 9.55 / 80; 80 rpm/V x 48 V / 64
    ("cubemars", "actuators", "AK80-64 KV80", {"motor_torque_constant": "119.4 mN*m/A", "no_load_speed": "60 rpm"}),
    # 48 / (9 x 23.04); e = 10 / (9 x 0.2315 x 4.9)
    ("lktech", "actuators", "MG8008-i9", {"motor_torque_constant": "231.5 mN*m/A", "efficiency": "97.95 %"}),
    # 30 A rms x 1.2247; 17.9 V / 104.72; e = 85 / (20 x 0.1709 x 36.74)
    ("myactuator", "actuators", "RMD-X12-P20-320", {"nominal_current": "36.74 A",
     "motor_torque_constant": "170.9 mN*m/A", "efficiency": "67.7 %"}),
    # 8.27 / 100 / 0.866; 2 x 24 mohm; 40 A x 0.866; 40 A x 0.083
    ("odrive", "motors", "M8325s 100KV", {"torque_constant": "95.5 mN*m/A", "resistance": "48 mohm",
     "nominal_current": "34.64 A", "nominal_torque": "3.32 N*m"}),
    # 20 A x 0.866; 5.4 / 17.32
    ("tq", "motors", "ILM 115x25", {"nominal_current": "17.32 A", "torque_constant": "311.8 mN*m/A"}),
    # 8 A rms x 1.2247; 0.15 / 1.2247
    ("amk", "motors", "DT4", {"nominal_current": "9.798 A", "torque_constant": "122.5 mN*m/A"}),
    # 4.5 A rms x 1.2247; 0.081 / 1.2247; 4.5 x 0.081
    ("beckhoff", "motors", "AM8112-wFyz", {"nominal_current": "5.511 A", "torque_constant": "66.14 mN*m/A",
     "standstill_torque": "0.3645 N*m"}),
    # 2.5 A rms x 1.2247; 0.544 / 1.2247
    ("yaskawa", "motors", "SGM7J-04A", {"nominal_current": "3.062 A", "torque_constant": "444.2 mN*m/A"}),
    # 12.2 A rms x 1.2247; 0.54 / 1.2247
    ("wittenstein", "motors", "premo 320 V 3F", {"nominal_current": "14.94 A", "torque_constant": "440.9 mN*m/A"}),
    # 706 / 5.7; 0.318 ohm x (123.9 / 85)^2
    ("kollmorgen", "motors", "TBM(S)-6025-A", {"torque_constant": "123.9 mN*m/A", "resistance": "0.6757 ohm"}),
    # 12 / 374.383; 7.157 / 374.383
    ("ctre", "motors", "Kraken X60", {"resistance": "32.05 mohm", "torque_constant": "19.12 mN*m/A"}),
    # 12 / 211; 3.6 / 211
    ("rev", "motors", "NEO Vortex", {"resistance": "56.87 mohm", "torque_constant": "17.06 mN*m/A"}),
    # 8, 24 A rms x 1.2247
    ("synapticon", "controllers", "Circulo 7", {"continuous_current": "9.798 A", "peak_current": "29.39 A"}),
    # 30, 60 A rms x 1.2247
    ("trinamic", "controllers", "TMCM-1636-24V", {"continuous_current": "36.74 A", "peak_current": "73.48 A"}),
    # 4.5, 9 A rms x 1.2247
    ("beckhoff", "controllers", "ELM7211", {"continuous_current": "5.511 A", "peak_current": "11.02 A"}),
    # min(43.2e6 / 5000, 60000)
    ("usdigital", "encoders", "E2-5000", {"max_speed": "8640 rpm"}),
]  # fmt: skip


def test_rows_of_every_file() -> None:
    assert {name for name, *_ in ROWS} == set(MAKERS)


@pytest.mark.parametrize(("rows", "within"), [(ROWS, 1e-9), (WORKED, 5e-3)], ids=["as printed", "worked out by hand"])
def test_figures(rows: list[Any], within: float, shelf: dict[str, Catalog]) -> None:
    named = {
        f"{number} {name} {part}": (shelf[name], section, part, figures, within)
        for number, (name, section, part, figures) in enumerate(rows)
    }
    hold(_compare, named)


def _compare(catalog: Catalog, section: str, part: str, figures: Figures, within: float) -> None:
    table, columns = catalog.table(section), columns_of(section)
    row = table.rows[part]
    for field, printed in figures.items():
        column = columns[field]
        found = from_si(table[field][row].item(), column.unit, column.kind)
        expected = from_si(to_si(printed, column.kind), column.unit, column.kind)
        assert found == pytest.approx(expected, rel=within), f"{field} in {column.unit}"


# --- friction of actuators --------------------------------------------------------------------------------------------

# Better Actuator Models, params/*/m3.json at 1b5a1ce (STS3215: 31e5b97), at the output: friction_base [N*m],
# load_friction_base [1], friction_viscous [N*m*s/rad]
IDENTIFIED = {
    "XL330-M288-T": (0.0088817, 0.12166, 0.0043791), "XL-320": (0.02063, 0.21898, 0.0022633),
    "MX-64": (0.10217, 0.075801, 0.00063003), "MX-106": (0.11335, 0.10824, 0.011945),
    "ST-3215-C001": (0.05564449, 0.2115543, 0.03149464),
}  # fmt: skip


def test_identified_friction_is_the_published_model(shelf: dict[str, Catalog]) -> None:
    """The motor's torque as the authors' model has it, friction C + b w + K (motor + load): by search for it."""
    identified = [one for one in every(shelf, ["actuators"]) if not math.isnan(one["coulomb_friction"])]
    for one in identified:
        C, K, b = IDENTIFIED[one.part.partition(" ")[0]]
        load, w = 0.2 * one["stall_torque"], 0.7 * one["no_load_speed"]
        needed = brentq(lambda T, C=C, K=K, b=b, load=load, w=w: T - load - (C + b * w + K * (T + load)), 0, 50 * load)
        lost = one["coulomb_friction"] + one["viscous_friction"] * w
        assert load * (1 + one["load_friction"]) + lost == pytest.approx(needed, rel=5e-3), one.part
        held = brentq(lambda T, K=K, load=load: T - load + K * (T + load), -load, load)  # by the load, slowly
        assert load / (1 + one["load_friction"]) == pytest.approx(held, rel=5e-3), one.part
    assert len(identified) == 3 + 1 + 3 + 3 + 1


# --- where it comes from ---------------------------------------------------------------------------------------------

LOCAL = re.compile(r"/(work|tmp|home|root|mnt|usr)/|catalog-facts|catalog-sources|\bfile #\d|\.csv\b|^\s*$|[A-Z]:\\")


def test_every_figure_has_a_document_and_a_confidence(shelf: dict[str, Catalog]) -> None:
    figures = 0
    for hit in every(shelf):
        found = origins(hit)
        confidence = hit.catalog.confidence(hit.section, hit.row)
        assert set(found) == set(confidence)
        for field, source in found.items():
            assert source.document.strip(), (hit.part, field)
            assert source.confidence in CONFIDENCES, (hit.part, field)
        figures += len(found)
    assert figures > 20000


def test_sources_and_notes_say_what_they_are(full: dict[str, Catalog]) -> None:
    hold(_says_its_sources, {name: (full[name],) for name in sorted(shipped())})


def _says_its_sources(catalog: Catalog) -> None:
    documents = [source.document for source in catalog.sources]
    assert len(set(documents)) == len(documents)  # a note finds its source by its document
    for source in catalog.sources:
        assert not LOCAL.search(source.document), source.document
        assert not source.url or re.match(r"https?://[\w.-]+\.\w+", source.url), source.url
        assert source.confidence in CONFIDENCES
        assert not source.date or re.match(r"(19|20)\d\d\b", source.date), source.date
    for note in catalog.notes:
        assert note.text.strip(), note
        assert not LOCAL.search(note.text), note.text
        assert note.confidence in CONFIDENCES | {""}
        assert not note.source or note.source in documents


def test_what_is_derived_or_recalled_says_how(shelf: dict[str, Catalog]) -> None:
    """A figure that is not printed has a note with a text on it, or stands in a table whose source is one."""
    for hit in every(shelf):
        base = hit.catalog.sources[hit.table.source[hit.row]].confidence
        notes = hit.catalog.notes_on(hit.section, hit.part)
        for field, confidence in hit.catalog.confidence(hit.section, hit.row).items():
            if confidence in ("derived", "recalled") and confidence != base:
                texts = [n.text for n in notes if n.confidence == confidence and (field in n.fields or not n.fields)]
                assert any(len(text.strip()) > 2 for text in texts), (hit.part, field)


def test_prices_are_dated(full: dict[str, Catalog]) -> None:
    """None of the makers here has a price in EUR; where others have one, its source has a date."""
    priced = Counter[str]()
    for hit in every(full):
        prices = [field for field in columns_of(hit.section) if "price" in field and not math.isnan(hit[field])]
        if prices:
            found = origins(hit)
            assert all(found[field].date for field in prices), hit.part
            priced[hit.catalogue] += 1
    assert not set(priced) & set(MAKERS)


# --- all together ----------------------------------------------------------------------------------------------------


def _maker(hit: Hit) -> str:
    return str(hit["manufacturer"])


def test_one_file_per_maker(full: dict[str, Catalog]) -> None:
    spelt: dict[str, set[str]] = {}
    for hit in every(full):
        spelt.setdefault(hit.catalogue, set()).add(_maker(hit))
    assert {name for name, makers in spelt.items() if len(makers) != 1} == set()
    makers = [next(iter(names)) for names in spelt.values()]
    assert len({re.sub(r"\W", "", maker.casefold()) for maker in makers}) == len(makers) == len(shipped())
    assert all(maker and maker == maker.strip() for maker in makers)


def test_no_part_is_in_two_catalogues(full: dict[str, Catalog]) -> None:
    where: dict[str, list[str]] = {}
    for hit in every(full):
        where.setdefault(hit.part.casefold(), []).append(f"{hit.catalogue} {hit.section}")
    assert {part: places for part, places in where.items() if len(places) > 1} == {}


def test_all_load_as_one(full: dict[str, Catalog]) -> None:
    everything = load(["all"])
    assert set(everything.digests) == set(shipped()) == set(full) == set(MAKERS) | ELSEWHERE
    for section in PARTS:
        parts = [part for part in everything.table(section)["part"].tolist() if part != DIRECT]
        assert len(parts) == len(set(parts))
        assert len(parts) == sum(1 for _ in every(full, [section])), section
    apart = split_actuators(everything)
    assert int((apart.motors["inside"] != "").sum()) == len(everything.actuators)


@pytest.mark.slow
def test_a_catalogue_is_yaml_to_the_parser_in_python_too():
    """Where PyYAML comes without libyaml: within ``{...}`` an unquoted ``?`` begins a key there."""
    for path in shipped().values():
        assert sum(1 for _ in yaml.parse(path.read_text(encoding="utf-8"), Loader=yaml.SafeLoader)) > 20, path
