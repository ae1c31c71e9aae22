"""The catalogues of all the other makers: how many parts, figures as printed, and the energy of every actuator.

maxon, Faulhaber, Allied Motion, T-Motor and Pittman have tests of their own. ``MAKERS`` says how many parts each file
has. Numbers behind ``counted`` were counted in the source's own table, less what the file's head leaves out; a ``pin``
is what is there, so that nothing appears or goes unseen, and a remark says what of it was counted. ``printed.txt``
has figures in the units in which the source prints them, ``worked.txt`` those that follow from printed ones by the
arithmetic above them.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
import yaml
from rows import hold
from scipy.optimize import brentq

from drivesizer.catalog import DIRECT, PARTS, RELATIONS, Catalog, columns_of, load, shipped
from drivesizer.catalog.query import Hit, every, open_catalogs, origins
from drivesizer.catalog.view import split_actuators
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
    "stepperonline": pin(steppers=39, brakes=1, controllers=3), "usongshine": pin(steppers=4),
    "wantai": pin(steppers=4),
    # belts and pulleys: the lists of ReCalc, whole
    "last_anvil": counted(belts=24, pulleys=8), "sds": counted(belts=3), "swyft": counted(belts=54),
    "thrifty": counted(belts=103, pulleys=20, controllers=1),
    "vbelt": counted(belts=872), "wcp": counted(belts=141, pulleys=36),
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
    "ctre": counted(motors=3, controllers=4, encoders=1),  # two kinds of commutation are one motor; the Falcon is VEX's
    "ipower": counted(motors=3 - 2), "no_maker": counted(motors=2), "waveshare": counted(motors=4),
    "zltech": counted(motors=2), "kollmorgen": counted(motors=3),
    "nanotec": counted(motors=4, steppers=6 + 2 * 2 + 3 + 1),
    "odrive": counted(motors=5 - 2, brake_resistors=1) | pin(controllers=5 + 2),  # without M5312s and BotWheel
    "rev": counted(motors=6 - 1, belts=25, pulleys=12, controllers=3, encoders=1),  # without Core Hex
    "tamagawa": counted(motors=19),
    "tq": counted(motors=3),
    # gearheads
    "apex": counted(gearheads=3),
    "nabtesco": counted(gearheads=2),  # the two ends of one line
    "wittenstein": counted(gearheads=31 + 30 + 25 + 32 + 60, motors=6, brakes=4),  # NPT, NPS, NP, TP, SP; premo
    # actuators
    "cubemars": pin(actuators=8 + 6 + 2 + 3 + 2, motors=7 + 7 + 2),
    "damiao": pin(actuators=14 - 6 + 2 + 3 + 5),  # less 6 without R or k_t; P of two; 48 V of three; a survey
    "dfrobot": pin(actuators=4 - 2 + 1),  # 4 counted, less FIT0277 and FIT0450; FIT0522 is of another page
    "encos": counted(actuators=10 - 5),
    "feetech": pin(actuators=3 + 1),  # 3 counted; ST-3235 is of the maker's wiki
    "gobilda": counted(actuators=10, motors=1),
    "harmonic_drive": counted(actuators=4 + 5 + 5 + 6 + 6 + 6 + 5 + 5, gearheads=21, brakes=4),
    "lktech": pin(actuators=5),
    "myactuator": pin(actuators=25 - 20 + 10 + 3),  # 25 names of V2 and V3 counted; ten V4 of the brochure, V4.1
    # 37D without the two bare motors, 25D, LP without 5:1 and 10:1, HPCB and 3052, the Romi's: counted but one 25D
    "pololu": pin(actuators=(20 - 2) + (3 + 1 + 2) + (11 - 2) + 2 + 1, controllers=15 + 4, brake_resistors=4 - 2),
    # X, MX, AX-12A, XL-320, P and Y counted, one per voltage; PRO
    "robotis": pin(actuators=67 + 3 * 3 + 1 + 1 + 6 + 6 + 11),
    "robstride": pin(actuators=7 + 1 + 1),  # RS00 to RS06 and EduLite counted; RS10P is of the maker's page
    "studica": counted(actuators=1), "tetrix": counted(actuators=3),
    "steadywin": counted(actuators=13), "deep_robotics": counted(actuators=2),
    "towerpro": counted(actuators=3), "dsservo": counted(actuators=4), "hiwonder": counted(actuators=1),
    "unitree": counted(actuators=3 - 2 + 1),  # without A1, B1
    "vex": counted(motors=4, actuators=3 + 1, encoders=1), "xiaomi": counted(actuators=1),
    # controllers
    "adafruit": counted(controllers=1), "makerbase": counted(controllers=1), "simplefoc": counted(controllers=6 - 2),
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
    assert len(MAKERS) == 116 + 3 + 12


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
    within = {"motor_gearhead", "motor_brake"} | ({"motor_encoder"} if name in ("ctre", "rev", "vex") else set())
    assert all(not len(getattr(catalog, relation).left) for relation in RELATIONS.keys() - within)  # built in


# --- figures as printed ----------------------------------------------------------------------------------------------


def rows_of(file: str) -> list[tuple[str, str, str, Figures]]:
    """File, section, part, and figures in the source's units."""
    lines = Path(__file__).with_name(file).read_text(encoding="utf-8").splitlines()
    cells = [line.split(" | ") for line in lines if line and not line.startswith("#")]
    return [(name, section, part, dict(one.split(" ", 1) for one in figures.split("; ")))
            for name, section, part, figures in cells]  # fmt: skip


ROWS, WORKED = rows_of("printed.txt"), rows_of("worked.txt")


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
