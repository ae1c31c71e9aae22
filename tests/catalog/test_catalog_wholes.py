"""The checker's laws of actuators, brakes, steppers, belts, pulleys, screws and batteries, on an invented catalogue."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from broken_catalogs import about, alone, broken, held_to, laws_of, with_cells
from rows import hold

from drivesizer.catalog import PARTS, Catalog, load
from drivesizer.catalog.laws import LAWS, Law, check
from drivesizer.catalog.parts import printed

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


def test_every_law_finds_what_breaks_it(invented: Catalog) -> None:
    laws = [law for law in LAWS if law.section in WHOLES]
    hold(_finds_what_breaks_it, {f"{law.section}: {law.name} {n}": (invented, law) for n, law in enumerate(laws)})


def _finds_what_breaks_it(invented: Catalog, law: Law) -> None:
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
