"""Sections of a platform: as Table 1 prints it, layouts by hand, the record put together, one-line refusals."""

import math

import numpy as np
import pytest
from platform_specs import DOOR, section, vehicle
from platforms import ALPHA, LENGTH, RADIUS, mecanum
from pydantic import ValidationError

from drivesizer.errors import InputError
from drivesizer.load_cases.platform import box_inertia, platform_assumptions, platform_of
from drivesizer.platform.kinematics import kinematics
from drivesizer.spec.platform import Budget


def refusal(**given):
    with pytest.raises(ValidationError) as error:
        section(**given)
    (fault,) = error.value.errors()
    assert "\n" not in fault["msg"]
    return fault["msg"]


# --- wheels -----------------------------------------------------------------------------------------------------------


def table_1():
    """The paper's Table 1 as a spec has it; angles in degrees."""
    directions = (330.5, 29.5, 150.5, 209.5)
    return [
        {"kind": "mecanum", "distance": "274.06 mm", "alpha": f"{a} deg", "beta": f"{90 - a} deg", "roller_angle": g}
        for a, g in zip(directions, 2 * ("45 deg", "-45 deg"), strict=True)
    ]


def test_table_1_is_the_papers_robot():
    wheels = [place.record(RADIUS) for place in section(layout=None, wheels=table_1()).places]
    printed = kinematics(mecanum().wheels).E
    made = kinematics(wheels).E
    assert made == pytest.approx(printed)
    level = [p | {"beta": None} for p in table_1()]
    assert [w.heading for w in (p.record(RADIUS) for p in section(layout=None, wheels=level).places)] == pytest.approx(
        4 * [0.0], abs=1e-12
    )


def test_a_mecanum_layout_is_its_rectangle():
    found = [place.record(RADIUS) for place in section().places]
    assert [(w.x, w.y) for w in found] == [
        (pytest.approx(sx * 0.23853), pytest.approx(sy * 0.13495)) for sx, sy in ((1, -1), (1, 1), (-1, 1), (-1, -1))
    ]
    assert LENGTH * math.cos(ALPHA) == pytest.approx(0.23853, abs=5e-6)
    assert LENGTH * math.sin(ALPHA) == pytest.approx(0.13495, abs=5e-6)
    printed = kinematics(mecanum().wheels).E
    made = kinematics(found).E
    assert made == pytest.approx(printed, rel=1e-4)


def test_a_differential_layout_turns_about_its_axle():
    found = section(layout={"kind": "differential", "track": "500 mm", "x": "80 mm"}).places
    k = kinematics([place.record(0.1) for place in found])
    assert k.mobility == 2
    assert k.E @ np.array([0.0, -0.08 * 2.0, 2.0]) == pytest.approx([2.0 * 0.25 / 0.1, -2.0 * 0.25 / 0.1])


@pytest.mark.parametrize("number", [3, 4, 5])
def test_omni_wheels_on_a_circle_roll_along_it(number):
    layout = {"kind": "omni", "radius": "250 mm", "number": number}
    wheels = [place.record(0.06) for place in section(layout=layout).places]
    k = kinematics(wheels)
    assert k.mobility == 3
    assert k.E @ np.array([0.0, 0.0, 2.0]) == pytest.approx(number * [2.0 * 0.25 / 0.06])
    assert k.E @ np.array([0.0, 0.7, 0.0]) == pytest.approx(
        [0.7 * math.cos(2 * math.pi * i / number) / 0.06 for i in range(number)]
    )


def test_wheels_one_by_one_with_one_that_is_free():
    wheels = [
        {"kind": "fixed", "x": "0 m", "y": "-250 mm"}, {"kind": "fixed", "x": "0 m", "y": "250 mm"},
        {"kind": "omni", "x": "0.4 m", "y": "0 m", "driven": False},
    ]  # fmt: skip
    p = platform_of(section(layout=None, wheels=wheels), vehicle(driven_wheels=2), rotor_inertia=0.03)
    assert [w.drive for w in p.wheels] == ["motor", "motor", "free"]
    assert [w.held for w in p.wheels] == [True, True, False]
    assert [w.rotor_inertia for w in p.wheels] == [0.03, 0.03, 0.0]
    assert kinematics(p.wheels).mobility == 2


# --- the record -------------------------------------------------------------------------------------------------------


def test_the_record_takes_the_loads_figures():
    p = platform_of(section(roller_resistance=0.03, inertia="2.1 kg*m^2"), vehicle(), rotor_inertia=0.05)
    assert (p.mass, p.inertia) == (45.0, 2.1)
    assert [w.radius for w in p.wheels] == pytest.approx(4 * [0.0762])
    assert [w.inertia for w in p.wheels] == pytest.approx(4 * [0.0032])
    assert {(w.rolling_resistance, w.roller_resistance, w.rotor_inertia) for w in p.wheels} == {(0.02, 0.03, 0.05)}


def test_sinkage_and_cylinders_are_read_as_the_load_reads_them():
    """(4) is √(z / d): 4 mm into the floor under 152.4 mm. A solid cylinder has m r² / 2."""
    wheel = {"density": "1100 kg/m^3", "outer_diameter": "152.4 mm", "width": "50 mm"}
    load = vehicle(rolling_resistance=None, sinkage="4 mm", inertia=None, cylinders={"wheel": wheel})
    p = platform_of(section(), load)
    assert p.wheels[0].rolling_resistance == pytest.approx(math.sqrt(4.0 / 152.4))
    mass = 1100 * math.pi * 0.0762**2 * 0.05
    assert p.wheels[0].inertia == pytest.approx(mass * 0.0762**2 / 2)


def test_without_inertia_it_is_a_box_and_that_is_said():
    """45 kg of 707 mm by 350 mm: 45 (0.707² + 0.350²) / 12 = 2.334 kg·m²."""
    found = section(centre_of_mass={"height": "90 mm"})
    assert platform_of(found, vehicle()).inertia == pytest.approx(2.334, abs=5e-4)
    assert box_inertia(found, 45.0) == pytest.approx(2.334, abs=5e-4)
    (sentence,) = platform_assumptions(found, vehicle())
    assert sentence == "The robot's inertia is that of a homogeneous box of its size without payloads, 2.334 kg·m²."
    given = section(inertia="2 kg*m^2", centre_of_mass={"height": "90 mm"})
    assert platform_assumptions(given, vehicle()) == ()
    assert any("height" in s for s in platform_assumptions(section(), vehicle()))


def test_payloads_are_part_of_the_loads_mass():
    """30 kg of robot and 15 kg at x 0.3 m: together 45 kg at 0.1 m, by levers; the inertia by Steiner."""
    payload = {"name": "case", "mass": "15 kg", "x": "0.3 m", "height": "0.5 m", "inertia": "0.4 kg*m^2"}
    found = section(inertia="1.5 kg*m^2", centre_of_mass={"height": "0.11 m"}, payloads=[payload])
    p = platform_of(found, vehicle())
    assert (p.mass, p.x, p.y) == (pytest.approx(45.0), pytest.approx(0.1), 0.0)
    assert p.height == pytest.approx((30 * 0.11 + 15 * 0.5) / 45)
    assert p.inertia == pytest.approx(1.5 + 30 * 0.1**2 + 0.4 + 15 * 0.2**2)
    assert found.height_known
    assert not section(payloads=[payload], centre_of_mass={"x": "0 m"}).height_known
    assert not section(payloads=[payload | {"height": None}], centre_of_mass={"height": "0.11 m"}).height_known


def test_casters_roll_as_the_wheels_do_by_default():
    layout = {"kind": "differential", "track": "500 mm"}
    casters = [{"x": "-0.4 m", "y": "0 m"}, {"x": "0.4 m", "y": "0 m", "rolling_resistance": 0.05}]
    found = section(layout=layout, casters=casters)
    p = platform_of(found, vehicle(driven_wheels=2))
    assert [c.rolling_resistance for c in p.casters] == [0.02, 0.05]
    assert "Casters roll as hard as the wheels." in platform_assumptions(found, vehicle(driven_wheels=2))


def test_what_platform_and_load_contradict():
    with pytest.raises(InputError, match=r"^platform: 4 of its wheels are driven, load\.driven_wheels is 3$"):
        platform_of(section(), vehicle(driven_wheels=3))
    heavy = section(payloads=[{"name": "case", "mass": "45 kg"}])
    with pytest.raises(InputError, match=r"^platform: payloads of 45 kg leave nothing of load\.mass, 45 kg"):
        platform_of(heavy, vehicle())


# --- refusals ---------------------------------------------------------------------------------------------------------

ONE = {"kind": "fixed", "x": "0.1 m", "y": "0.2 m"}


@pytest.mark.parametrize(("given", "words"), [
    ({"layout": None}, "give wheels or layout, exactly one of them"),
    ({"wheels": [ONE]}, "give wheels or layout, exactly one of them"),
    ({"size": None}, "give inertia, or size"),
    ({"size": None, "inertia": "2 kg*m^2", "passages": [DOOR]}, "give size for the passages"),
    ({"passages": [DOOR, DOOR]}, "expected passages with names of their own"),
    ({"payloads": 2 * [{"name": "arm", "mass": "3 kg"}]}, "expected payloads with names of their own"),
    ({"passages": [DOOR | {"x": "1 m"}]}, "give both x and y, or none"),
    ({"passages": [DOOR | {"width": "0 mm"}]}, "must be above 0 m"),
    ({"layout": {"kind": "omni", "radius": "0.2 m", "number": 2}}, "greater than or equal to 3"),
    ({"casters": [{"x": "238.53 mm", "y": "134.95 mm"}]}, "stand in one place"),
    ({"layout": None, "wheels": [ONE, ONE]}, "stand in one place"),
    ({"layout": None, "wheels": [ONE | {"driven": False}]}, "no wheel is driven"),
    ({"layout": None, "wheels": [ONE | {"kind": "omni"}]}, "it can move with its driven wheels at rest"),
    ({"layout": None, "wheels": [ONE | {"distance": "0.2 m"}]}, "give x and y with heading, or distance and alpha"),
    ({"layout": None, "wheels": [{"kind": "fixed", "x": "0.1 m"}]}, "give x and y with heading"),
    ({"layout": None, "wheels": [{"kind": "fixed", "distance": "0.1 m"}]}, "give x and y with heading"),
    ({"layout": None, "wheels": [ONE | {"roller_angle": "45 deg"}]}, "give roller_angle for a mecanum wheel"),
    ({"layout": None, "wheels": [ONE | {"kind": "mecanum"}]}, "give roller_angle for a mecanum wheel"),
])  # fmt: skip
def test_a_section_that_is_none_is_refused_in_one_line(given, words):
    assert words in refusal(**given)


def test_a_budget_and_its_refusals():
    found = Budget.model_validate(
        {"mass": "45 kg", "structure": "18 kg", "others": [{"name": "camera", "mass": "120 g", "number": 3}]}
    )
    assert (found.mass, found.structure, found.others[0].mass) == (45.0, 18.0, pytest.approx(0.12))
    for given, words in (
        ({"drive_counts": True}, "give structure where drive_counts"),
        ({"others": 2 * [{"name": "arm", "mass": "3 kg"}]}, "expected others with names of their own"),
        ({"mass": "-45 kg"}, "must be above 0 kg"),
        ({"others": [{"name": "arm", "mass": "-3 kg"}]}, "must be at least 0 kg"),
    ):
        with pytest.raises(ValidationError, match=words):
            Budget.model_validate(given)
