"""The catalogues of all makers: how many parts, figures as printed, and the energy of every actuator.

maxon and Faulhaber, who list what fits what, have tests of their own beside these. ``counted.txt`` says how many parts
each other file has, ``printed.txt`` has figures in the units in which the source prints them, ``worked.txt`` those that
follow from printed ones by the arithmetic above them.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from rows import hold
from scipy.optimize import brentq

from drivesizer.catalog import DIRECT, PARTS, RELATIONS, Catalog, columns_of, load, shipped
from drivesizer.catalog.query import PartRow, all_parts, open_catalogs, origins
from drivesizer.catalog.tables import as_printed
from drivesizer.catalog.view import split_actuators
from drivesizer.units import from_si, to_si

ELSEWHERE = {"maxon", "faulhaber"}  # counted in files of their own
CONFIDENCES = {"quoted", "secondary", "derived", "recalled"}
Figures = dict[str, str]


@pytest.fixture(scope="module")
def shelf() -> dict[str, Catalog]:
    """The catalogues that are counted here, by name."""
    return open_catalogs(name for name in shipped() if name not in ELSEWHERE)


@pytest.fixture(scope="module")
def full() -> dict[str, Catalog]:
    """All that ship, by name."""
    return open_catalogs()


# --- how many --------------------------------------------------------------------------------------------------------


def cells_of(file: str) -> list[list[str]]:
    lines = Path(__file__).with_name(file).read_text(encoding="utf-8").splitlines()
    return [line.split(" | ") for line in lines if line and not line.startswith("#")]


def makers() -> dict[str, dict[str, int]]:
    """Parts by section of each file."""
    found: dict[str, dict[str, int]] = {}
    for name, _, parts, *_ in cells_of("counted.txt"):
        for section, _, number in (part.partition(" ") for part in parts.split("; ")):
            terms = re.findall(r"[+-]?\d+", number.replace(" ", ""))
            found.setdefault(name, {})[section] = sum(map(int, terms))
    return found


MAKERS = makers()


def test_every_file_is_counted(shelf: dict[str, Catalog]) -> None:
    assert set(shelf) == set(MAKERS)
    assert len(MAKERS) == 116 + 3 + 12 + 3


def test_how_many_parts(shelf: dict[str, Catalog]) -> None:
    found = {name: dict(Counter(hit.section for hit in all_parts({name: shelf[name]}))) for name in MAKERS}
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
    return [(name, section, part, dict(one.split(" ", 1) for one in figures.split("; ")))
            for name, section, part, figures in cells_of(file)]  # fmt: skip


ROWS, WORKED = rows_of("printed.txt"), rows_of("worked.txt")


def test_rows_of_every_file() -> None:
    assert {name for name, *_ in ROWS} == set(MAKERS) | ELSEWHERE


@pytest.mark.parametrize(("rows", "within"), [(ROWS, 1e-9), (WORKED, 5e-3)], ids=["as printed", "worked out by hand"])
def test_figures(rows: list[Any], within: float, full: dict[str, Catalog]) -> None:
    named = {
        f"{number} {name} {part}": (full[name], section, part, figures, within)
        for number, (name, section, part, figures) in enumerate(rows)
    }
    hold(_compare, named)


def _compare(catalog: Catalog, section: str, part: str, figures: Figures, within: float) -> None:
    table, columns = catalog.table(section), columns_of(section)
    row = table.rows[part]
    for field, printed in figures.items():
        column = columns[field]
        found = from_si(table[field][row].item(), column.unit, column.kind)
        expected = from_si(to_si(printed.removeprefix("~"), column.kind), column.unit, column.kind)
        digits = 5e-4 if printed.startswith("~") else within
        assert found == pytest.approx(expected, rel=digits), f"{field} in {column.unit}"


# --- what follows from printed figures ------------------------------------------------------------------------------


def test_tmotor_constant_is_that_of_the_name(full: dict[str, Catalog]) -> None:
    """k_t KV = 1 within 10 %: the constants are terminal to terminal. Per phase it would be 0.58 or 1.5."""
    name = np.array([float(part.partition("KV")[2]) * math.pi / 30 for part in full["tmotor"].motors["part"]])
    product = full["tmotor"].motors["torque_constant"] * name
    assert ((product > 0.97) & (product < 1.11)).all()


def test_the_u8_is_converted_from_phase_to_terminals(full: dict[str, Catalog]) -> None:
    """Torque and copper loss stay: 0.14 N*m/A at 7.6 A, and 1.5 x 0.186 ohm (7.6 A)^2 of a three-phase machine."""
    row = full["tmotor"].motors.rows["U8 KV100"]
    motor = full["tmotor"].motors.record(row)
    assert motor.torque_constant * motor.nominal_current == pytest.approx(0.14 * 7.6, rel=1e-3)
    assert motor.resistance * motor.nominal_current**2 == pytest.approx(1.5 * 0.186 * 7.6**2, rel=1e-3)
    assert motor.inductance / motor.resistance == pytest.approx(0.138e-3 / 0.186, rel=1e-3)
    confidence = full["tmotor"].confidence("motors", row)
    derived = {"torque_constant", "resistance", "inductance", "nominal_current", "speed_constant"}
    assert {field for field, how in confidence.items() if how == "derived"} == derived


def test_what_follows_of_a_pittman_row_says_so(full: dict[str, Catalog]) -> None:
    pittman = as_printed(full["pittman"])
    confidence = pittman.confidence("motors", pittman.motors.rows["9233S013"])
    derived = {"nominal_voltage", "resistance", "thermal_resistance_winding"}
    assert {field for field, how in confidence.items() if how == "derived"} == derived
    assert set(confidence.values()) == {"derived", "quoted"}


def test_pittman_resistance_is_that_of_the_motor_constant(full: dict[str, Catalog]) -> None:
    """K_M = k_t / sqrt(R), as the sheets print it in N*m/sqrt(W), three digits."""
    printed = {"9233S013": 1.88e-2, "14201S003": 3.14e-2, "14203S010": 5.56e-2, "14204S004": 6.09e-2}
    motors = full["pittman"].motors
    for part, constant in printed.items():
        motor = motors.record(motors.rows[part])
        assert motor.torque_constant / math.sqrt(motor.resistance) == pytest.approx(constant, rel=3e-3)


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
    identified = [one for one in all_parts(shelf, ["actuators"]) if not math.isnan(one["coulomb_friction"])]
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
    for hit in all_parts(shelf):
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


def test_no_figure_is_infinite(full: dict[str, Catalog]) -> None:
    """Sources write Inf for a limit that they do not know."""
    for name, catalog in full.items():
        for section in set(PARTS) - {"gearheads"}:  # nothing limits a motor without one
            for field, column in catalog.table(section).columns.items():
                assert column.dtype.kind != "f" or not np.isinf(column).any(), (name, section, field)


def test_what_is_derived_or_recalled_says_how(shelf: dict[str, Catalog]) -> None:
    """A figure that is not printed has a note with a text on it, or stands in a table whose source is one."""
    for hit in all_parts(shelf):
        base = hit.catalog.sources[hit.table.source[hit.row]].confidence
        notes = hit.catalog.notes_on(hit.section, hit.part)
        for field, confidence in hit.catalog.confidence(hit.section, hit.row).items():
            if confidence in ("derived", "recalled") and confidence != base:
                texts = [n.text for n in notes if n.confidence == confidence and (field in n.fields or not n.fields)]
                assert any(len(text.strip()) > 2 for text in texts), (hit.part, field)


def test_prices_are_dated(full: dict[str, Catalog]) -> None:
    """None of the makers here has a price in EUR; where others have one, its source has a date."""
    priced = Counter[str]()
    for hit in all_parts(full):
        prices = [field for field in columns_of(hit.section) if "price" in field and not math.isnan(hit[field])]
        if prices:
            found = origins(hit)
            assert all(found[field].date for field in prices), hit.part
            priced[hit.catalogue] += 1
    assert not set(priced) & set(MAKERS)


# --- all together ----------------------------------------------------------------------------------------------------


def _maker(hit: PartRow) -> str:
    return str(hit["manufacturer"])


def test_one_file_per_maker(full: dict[str, Catalog]) -> None:
    spelt: dict[str, set[str]] = {}
    for hit in all_parts(full):
        spelt.setdefault(hit.catalogue, set()).add(_maker(hit))
    assert {name for name, makers in spelt.items() if len(makers) != 1} == set()
    makers = [next(iter(names)) for names in spelt.values()]
    assert len({re.sub(r"\W", "", maker.casefold()) for maker in makers}) == len(makers) == len(shipped())
    assert all(maker and maker == maker.strip() for maker in makers)


def test_no_part_is_in_two_catalogues(full: dict[str, Catalog]) -> None:
    where: dict[str, list[str]] = {}
    for hit in all_parts(full):
        where.setdefault(hit.part.casefold(), []).append(f"{hit.catalogue} {hit.section}")
    assert {part: places for part, places in where.items() if len(places) > 1} == {}


def test_all_load_as_one(full: dict[str, Catalog]) -> None:
    everything = load(["all"])
    assert set(everything.digests) == set(shipped()) == set(full) == set(MAKERS) | ELSEWHERE
    for section in PARTS:
        parts = [part for part in everything.table(section)["part"].tolist() if part != DIRECT]
        assert len(parts) == len(set(parts))
        assert len(parts) == sum(1 for _ in all_parts(full, [section])), section
    apart = split_actuators(everything)
    assert int((apart.motors["inside"] != "").sum()) == len(everything.actuators)


@pytest.mark.slow
def test_a_catalogue_is_yaml_to_the_parser_in_python_too():
    """Where PyYAML comes without libyaml: within ``{...}`` an unquoted ``?`` begins a key there."""
    for path in shipped().values():
        assert sum(1 for _ in yaml.parse(path.read_text(encoding="utf-8"), Loader=yaml.SafeLoader)) > 20, path
