"""The catalogue checker: silent over what ships, loud over one wrong cell, mute where nothing is known."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from broken_catalogs import about, alone, broken, held_to, laws_of, rows_of, with_cells
from rows import hold

from drivesizer.catalog import PARTS, Catalog, Note, columns_of, load, shipped
from drivesizer.catalog.laws import Finding, Law, all_laws, check
from drivesizer.catalog.parts import printed

RPM = 2 * np.pi / 60  # rad/s


def kin(catalog: Catalog, section: str, part: str) -> Catalog:
    """The family of a part alone: no law looks beyond it."""
    table, none = catalog.table(section), np.zeros(0, np.intp)
    rows = np.flatnonzero(table["family"] == table["family"][table.rows[part]])
    return rows_of(catalog, {s: rows if s == section else none for s in PARTS})


FAMILIES = {
    "motors": ["DCX 26 L", "EC-max 22"],
    "gearheads": ["GP 22 HP", "GS 30 A"],
    "encoders": ["MILE (EC 90 flat)", "MR type ML"],
}
SHIPPED = (*FAMILIES, "controllers")  # the laws of other sections on an invented catalogue, below


@pytest.fixture(scope="module")
def some(catalog: Catalog) -> Catalog:
    """A few whole families, and all controllers: every law in little time."""
    rows = {s: np.flatnonzero(np.isin(catalog.table(s)["family"], FAMILIES[s])) for s in FAMILIES}
    return rows_of(catalog, rows | {"controllers": np.arange(len(catalog.controllers))})


@pytest.fixture(scope="module")
def before(some: Catalog) -> dict[str, tuple[Catalog, list[Finding]]]:
    """Each section of those few by itself, and what is found in it."""
    each = {section: alone(some, section) for section in PARTS}
    return {section: (few, check(few)) for section, few in each.items()}


@pytest.fixture(scope="module")
def found(catalog: Catalog) -> list[Finding]:
    return check(catalog)


# --- what ships ------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", shipped())
def test_a_shipped_catalogue_has_no_unexplained_finding(name: str) -> None:
    assert [f.text() for f in check(load([name])) if f.unexplained] == []


def test_the_excluded_motors_break_the_laws_and_say_why(catalog: Catalog, found: list[Finding]) -> None:
    """Integrated electronics: V, k_t and R do not belong together."""
    for part in ("350909", "370416", "370418", "370427"):
        assert {"stall current", "no-load speed"} <= about(found, part)
        assert all("integrated electronics" in f.accepted for f in found if f.part == part and f.grade == "finding")


def test_what_the_pages_print_oddly_is_found_and_accepted(found: list[Finding]) -> None:
    """From the pages: 118743 prints 4.25 ms where its figures make 4.10 ms; the ECX has two speeds swapped."""
    (time,) = (f for f in found if f.part == "118743" and f.identity == "mechanical time constant")
    assert time.found == pytest.approx(4.25e-3)
    assert time.expected == pytest.approx(10.3e-7 * 2.18 / 23.4e-3**2)
    assert time.deviation == pytest.approx(0.0364, abs=5e-4)
    assert "as printed" in time.accepted
    assert {"nominal speed", "nominal speed and no load speed"} <= about(found, "ECXZ16M1VF35N1IL1D589B")
    assert "mass by stages" in about(found, "GPX19HPKLSL0243CPLW")  # 41 g beside 61 g of a stage less
    assert sum(f.identity == "intermittent torque and continuous torque" for f in found) == 12


# --- one wrong cell --------------------------------------------------------------------------------------------------

# section, part, field, factor, the identity that must notice
WRONG: list[tuple[str, str, str, float, str]] = [
    ("motors", "236662", "speed_constant", 1.02, "speed constant"),
    ("motors", "236662", "stall_current", 0.98, "stall current"),
    ("motors", "236662", "stall_torque", 1.03, "stall torque"),
    ("motors", "236662", "resistance", 1.05, "speed-torque gradient"),
    ("motors", "236662", "rotor_inertia", 10.0, "mechanical time constant"),
    ("motors", "236662", "no_load_speed", 1.1, "no-load speed"),
    ("motors", "236662", "nominal_torque", 1.1, "nominal torque of brushed motors"),
    ("motors", "283858", "nominal_torque", 0.9, "nominal torque of brushless motors"),
    ("motors", "283858", "nominal_torque", 1.3, "nominal torque without friction"),
    ("motors", "236662", "nominal_speed", 0.7, "nominal speed"),
    ("motors", "236662", "nominal_speed", 1.5, "nominal speed and no load speed"),
    ("motors", "236662", "max_efficiency", 0.8, "maximum efficiency"),
    ("motors", "236662", "nominal_current", 1.5, "nominal current of brushed motors, from heat"),
    ("motors", "283858", "thermal_resistance_housing", 10.0, "nominal current, from heat"),
    ("motors", "236662", "mass", 1e-3, "mass beside diameter, at least"),
    ("motors", "DCX26L01GBKL529", "mass", 10.0, "mass beside similar parts, at most"),
    ("motors", "236662", "price_5", 2.0, "price 5 and price"),
    ("motors", "236662", "half_speed_torque", 2.0, "half speed torque and standstill torque"),
    ("motors", "236662", "top_speed_torque", 2.0, "top speed torque and half speed torque"),
    ("motors", "236662", "nominal_torque", 1.3, "nominal torque beside the operating range, at most"),
    ("motors", "236662", "nominal_torque", 0.8, "nominal torque beside the operating range, at least"),
    ("gearheads", "166167", "continuous_torque", 10.0, "intermittent torque and continuous torque"),
    ("gearheads", "166167", "efficiency", 0.5, "efficiency beside similar parts, at least"),
    ("gearheads", "166167", "ratio", 1.1, "printed reduction"),
    ("gearheads", "110445", "direction", -1.0, "direction"),
    ("gearheads", "166167", "mass", 0.1, "mass beside volume, at least"),
    ("encoders", "225778", "max_speed", 2.0, "speed at the greatest frequency"),
]


@pytest.mark.parametrize(("section", "part", "field", "factor", "identity"), WRONG)
def test_a_wrong_figure_is_found(
    catalog: Catalog, section: str, part: str, field: str, factor: float, identity: str
) -> None:
    family = kin(catalog, section, part)
    table = family.table(section)
    changed = with_cells(family, section, table.rows[part], **{field: table[field][table.rows[part]] * factor})
    assert identity not in about(held_to(family, laws_of(section)), part)
    assert identity in about(held_to(changed, laws_of(section)), part)


def test_every_law_finds_what_breaks_it(before: dict[str, tuple[Catalog, list[Finding]]]) -> None:
    """In a part that kept it before, with sisters enough that it is not its own measure."""
    laws = [law for law in all_laws() if law.section in SHIPPED]
    named = {f"{law.section}: {law.name} {n}": (*before[law.section], law) for n, law in enumerate(laws)}
    hold(_finds_what_breaks_it, named)


def _finds_what_breaks_it(some: Catalog, findings: list[Finding], law: Law) -> None:
    table, broke_it = some.table(law.section), {f.part for f in findings if f.identity == law.name}
    if law.name == "no-load speed without its current":
        table = replace(table, columns=dict(table.columns) | {"no_load_current": np.full(len(table), np.nan)})
        some = replace(some, motors=table)
    for row in np.flatnonzero(~table.excluded).tolist():
        cells = broken(law, table, row)
        part = str(table["part"][row])
        if np.isnan(cells[law.figure]) or part in broke_it:
            continue
        after = held_to(with_cells(some, law.section, row, **cells), [law])
        hits = [f for f in after if f.part == part and f.identity == law.name]
        if hits:
            assert hits[0].fields[0] == law.figure and hits[0].reason and hits[0].source
            return
    pytest.fail("no part could be made to break it")


def test_figures_that_agree_to_their_last_digit_are_no_finding(catalog: Catalog) -> None:
    """k_t 35.2 mN*m/A makes 271.3 rpm/V: 271 and 272 are within half a digit of both, 275 is not."""
    family = kin(catalog, "motors", "236662")
    row = family.motors.rows["236662"]
    for rpm, wrong in ((271, False), (272, False), (275, True)):
        changed = with_cells(family, "motors", row, speed_constant=rpm * RPM)
        assert ("speed constant" in about(held_to(changed, laws_of("motors")), "236662")) == wrong


def test_a_maker_that_prints_fewer_digits_gets_more_room(catalog: Catalog) -> None:
    """0.05 ohm rounded from 0.0457 ohm: wrong beside 0.0512 ohm, right where all have two places."""
    rows = np.flatnonzero(catalog.motors["family"] == "RE 65")
    small = rows_of(catalog, {s: rows if s == "motors" else np.zeros(0, np.intp) for s in PARTS})
    volts = small.motors["nominal_voltage"]
    for resistances, wrong in (((0.05, 0.15), False), ((0.05, 0.1512), True)):
        columns = dict(small.motors.columns) | {
            "resistance": np.array(resistances),
            "stall_current": np.array([volts[0] / 0.0457, volts[1] / resistances[1]]),
        }
        other = replace(small, motors=replace(small.motors, columns=columns))
        assert ("stall current" in about(check(other), str(small.motors["part"][0]))) == wrong


# --- what is not known -----------------------------------------------------------------------------------------------


def test_unknown_figures_give_no_findings(some: Catalog) -> None:
    for section, kind in PARTS.items():
        table = some.table(section)
        texts = {n for n, c in columns_of(section).items() if c.kind == "text"}
        columns = {n: c if n in texts else np.full(len(table), np.nan) for n, c in table.columns.items()}
        hidden = replace(some, **{section: replace(table, columns=columns)})  # type: ignore[arg-type]
        assert [f.text() for f in check(hidden) if f.section == section and f.grade == "finding"] == [], kind


@pytest.mark.parametrize("section", PARTS)
def test_hiding_a_figure_adds_no_finding(before: dict[str, tuple[Catalog, list[Finding]]], section: str) -> None:
    """Column by column: what is found without it was found with it."""
    some, findings = before[section]
    table, known = some.table(section), {(f.part, f.identity) for f in findings if f.grade == "finding"}
    for name, column in columns_of(section).items():
        if column.kind != "text":
            columns = dict(table.columns) | {name: np.full(len(table), np.nan)}
            hidden = replace(some, **{section: replace(table, columns=columns)})  # type: ignore[arg-type]
            after = held_to(hidden, laws_of(section))
            assert {(f.part, f.identity) for f in after if f.grade == "finding"} <= known, name


# --- notes -----------------------------------------------------------------------------------------------------------


def test_a_note_on_a_figure_accepts_what_is_found_of_it(catalog: Catalog) -> None:
    family = kin(catalog, "motors", "236662")
    changed = with_cells(family, "motors", family.motors.rows["236662"], stall_torque=1.0)
    for fields, accepted in ((("stall_torque",), True), ((), True), (("mass",), False)):
        note = Note("motors", ("236662",), fields, "so printed", accepted=True)
        noted = check(replace(changed, notes=(*changed.notes, note)))
        (finding,) = (f for f in noted if f.part == "236662" and f.identity == "stall torque")
        assert (finding.accepted, finding.unexplained) == (("so printed", False) if accepted else ("", True))


# --- parts among each other ------------------------------------------------------------------------------------------


def test_the_same_part_under_two_numbers(some: Catalog) -> None:
    rows = {s: np.array([0, 0]) if s == "motors" else np.zeros(0, np.intp) for s in PARTS}
    twice = rows_of(some, rows)
    twice = with_cells(twice, "motors", 1, part="000000")
    (finding,) = (f for f in check(twice) if f.identity == "two numbers for one part")
    assert (finding.part, finding.grade) == ("000000", "information")
    assert str(twice.motors["part"][0]) in finding.meaning


# --- parts of other kinds, on an invented catalogue

WHOLES = (
    "actuators", "brakes", "steppers", "belts", "pulleys", "screws", "batteries", "power_supplies", "brake_resistors",
)  # fmt: skip


@pytest.fixture(scope="module")
def invented() -> Catalog:
    return load(["invented.yaml"], beside=Path(__file__).parent)


def test_every_section_is_here_or_in_the_test_of_the_shipped_parts() -> None:
    assert {*WHOLES, "motors", "gearheads", "encoders", "controllers"} == set(PARTS)


def test_consistent_parts_have_no_finding_and_no_unknown_figure(invented: Catalog) -> None:
    assert [f.text() for f in check(invented) if f.grade == "finding"] == []
    for section in WHOLES:
        table = invented.table(section)
        figures = [n for n, c in printed(section).items() if c.kind != "text" and n != "foreign_price"]
        assert [n for n in figures if np.isnan(table[n]).any()] == [], section


def test_every_law_of_a_whole_finds_what_breaks_it(invented: Catalog) -> None:
    laws = [law for law in all_laws() if law.section in WHOLES]
    hold(_whole_finds_what_breaks_it, {f"{law.section}: {law.name} {n}": (invented, law) for n, law in enumerate(laws)})


def _whole_finds_what_breaks_it(invented: Catalog, law: Law) -> None:
    few, table = alone(invented, law.section), invented.table(law.section)
    for row in range(len(table)):
        part = str(table["part"][row])
        after = held_to(with_cells(few, law.section, row, **broken(law, table, row)), [law])
        hits = [f for f in after if f.part == part and f.identity == law.name]
        if hits:
            assert hits[0].fields[0] == law.figure and hits[0].reason and hits[0].source
            return
    pytest.fail("no part could be made to break it")


# section, part, field, factor, the identity that must notice, as slips happen
SLIPS: list[tuple[str, str, str, float, str]] = [
    ("actuators", "A10", "motor_torque_constant", 3**0.5 / 2**0.5, "stall torque"),  # of effective amperes
    ("actuators", "A10", "stall_torque", 1.1, "stall torque"),  # though 0.5 A may be 0.45 A
    ("actuators", "A10", "torque_constant", 10.0, "torque constant beside i eta k_m, at most"),  # the ratio twice
    ("actuators", "A20", "no_load_speed", 20.0, "no-load speed without friction"),  # the motor's
    ("actuators", "A20", "no_load_speed", 60 / (2 * np.pi), "energy at stall and no load"),  # rpm for rad/s
    ("actuators", "A30", "viscous_friction", 30.0, "no-load current beside (M_c + b w_0) / (i k_m), at least"),  # rpm
    ("actuators", "A30", "load_friction", 10.0, "efficiency beside 1 / (1 + s), at most"),
    ("actuators", "A30", "output_inertia", 1 / 900, "output inertia beside i^2 J, at least"),  # the motor's
    ("actuators", "A30", "stall_torque", 9.80665 / 100, "stall torque"),  # N*m for kgf*cm
    ("actuators", "A30", "nominal_torque", 1.5, "nominal torque without friction"),
    ("actuators", "A30", "mass", 0.01, "mass beside volume, at least"),
    ("brakes", "B2", "static_torque", 1000.0, "torque by mass, at most"),  # mN*m for N*m
    ("brakes", "B2", "inertia", 1e-3, "torque by inertia, at most"),  # g*cm^2 for kg*cm^2
    ("brakes", "B2", "total_energy", 1e-3, "energy per stop and total energy"),  # J for kJ
    ("steppers", "S1", "inductance", 1000.0, "inductance by resistance, at most"),  # uH for mH
    ("steppers", "S1", "rotor_inertia", 100.0, "rotor inertia by mass, at most"),
    ("steppers", "S2", "full_steps", 1.8, "full steps in use"),  # 360
    ("belts", "T80", "pitch", 1.2, "pitch of the profile"),
    ("belts", "T80", "mass", 1000.0, "mass by area, at most"),  # g for kg
    ("pulleys", "P20", "width", 0.1, "width beside pitch, at least"),  # cm for mm
    ("pulleys", "P20", "teeth", 0.25, "teeth, at least"),
    ("batteries", "C4", "capacity", 1000.0, "energy by mass, Li-ion, at most"),  # mA*h for A*h
    ("batteries", "C4", "resistance", 1000.0, "peak current beside V / R, at most"),  # ohm for mohm
    ("batteries", "L10", "capacity_1h", 0.7, "Peukert's law at 1 h, at least"),
    ("batteries", "L10", "capacity_10h", 1.1, "capacity 10 h and capacity"),
]


@pytest.mark.parametrize(("section", "part", "field", "factor", "identity"), SLIPS)
def test_a_slip_is_found(invented: Catalog, section: str, part: str, field: str, factor: float, identity: str) -> None:
    table = invented.table(section)
    row = table.rows[part]
    changed = with_cells(alone(invented, section), section, row, **{field: table[field][row] * factor})
    assert identity in about(held_to(changed, laws_of(section)), part)


def test_a_direct_actuator_may_lose_nothing(invented: Catalog) -> None:
    """No gear: ratio 1 and efficiency 1 are no finding, an efficiency of 1 behind a gear is."""
    for ratio, wrong in ((1.0, False), (10.0, True)):
        changed = with_cells(invented, "actuators", 0, ratio=ratio, efficiency=1.0)
        assert ("efficiency is a share" in about(check(changed), "A10")) == wrong


def test_a_profile_that_is_not_known_has_any_pitch(invented: Catalog) -> None:
    changed = with_cells(invented, "belts", 0, pitch=5.3e-3)
    assert "pitch of the profile" in about(check(changed), "T60")
    assert "pitch of the profile" not in about(check(with_cells(changed, "belts", 0, profile="XYZ")), "T60")


def test_a_capacity_drawn_faster_is_not_held_against_a_slower_one(invented: Catalog) -> None:
    """5 A*h in 5 h, 5.05 A*h in 10 h: no finding; the same with 20 h as the rated time is one."""
    row = invented.batteries.rows["C5"]
    slow = with_cells(invented, "batteries", row, rated_time=20 * 3600.0)
    assert "capacity 10 h and capacity" in about(check(slow), "C5")
