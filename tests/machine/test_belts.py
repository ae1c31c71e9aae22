"""Belts and pulleys out of the catalogues: the geometry, which ratios there are, and what a set says of its belt."""

import itertools
import math
import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from refusals import refusal

from drivesizer.machine import belts as pulleys
from drivesizer.machine.problem import problem
from drivesizer.physics.belt import (
    belt_length,
    centre_distance,
    pitch_diameter,
    shortest_recommended,
    teeth_in_mesh,
    wrap_angle,
)
from drivesizer.search.shortlist import load_parts
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import load_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

MM, INCH = 1e-3, 25.4e-3


def by_tangents(z_1: float, z_2: float, pitch: float, a: float) -> tuple[float, float, float]:
    """Length of the belt and its angles on both pulleys, by the points where the upper span leaves the circles.

    The unit vector n across the span has n . (c_2 - c_1) = r_1 - r_2, for both radii end on the same straight line.
    """
    r_1, r_2 = z_1 * pitch / (2 * math.pi), z_2 * pitch / (2 * math.pi)
    n = np.array([(r_1 - r_2) / a, math.sqrt(1 - ((r_1 - r_2) / a) ** 2)])
    span = np.linalg.norm(np.array([a, 0.0]) + r_2 * n - r_1 * n)
    lean = math.atan2(n[1], n[0])  # of the radius to where the belt leaves, from the line of centres
    on_1, on_2 = 2 * math.pi - 2 * lean, 2 * lean
    return 2 * span + r_1 * on_1 + r_2 * on_2, on_1, on_2


# -- geometry


@pytest.mark.parametrize(
    ("teeth", "pitch", "inches"),
    [(18, 5, 1.128), (24, 5, 1.504), (30, 5, 1.88), (36, 5, 2.256), (12, 3, 0.451), (60, 3, 2.256)],
)
def test_pitch_diameters_as_vex_prints_them(teeth, pitch, inches):
    """HTD 5 mm and GT2 3 mm pulleys, tabulated in the tests of ReCalc (github.com/tervay/recalc)."""
    assert pitch_diameter(teeth, pitch * MM) == pytest.approx(inches * INCH, abs=0.0005 * INCH)


@pytest.mark.parametrize(
    ("z_1", "z_2", "pitch", "belt", "printed", "half_a_digit"),
    [
        (20, 30, 5, 100, 187.331 * MM, 0.0005 * MM),
        (16, 24, 5, 125, 262.423 * MM, 0.0005 * MM),
        (20, 60, 5, 120, 7.773 * INCH, 0.0005 * INCH),
        (20, 60, 5, 123, 8.072 * INCH, 0.0005 * INCH),
        (52, 54, 5, 340, 28.24796 * INCH, 0.000005 * INCH),
    ],
)
def test_centre_distances_as_printed(z_1, z_2, pitch, belt, printed, half_a_digit):
    """ReCalc, app/lib/math/belts.test.ts and its forerunners: what WCP's and VEX's calculators give for these belts."""
    assert centre_distance(z_1, z_2, pitch * MM, belt) == pytest.approx(printed, abs=half_a_digit)


def test_a_belt_length_as_printed():
    """machinecalcs.com, Timing Belt Calculator: GT2 2 mm, 20 and 40 teeth at 100 mm need 260.40 mm, 130.2 teeth."""
    length = belt_length(20, 40, 2 * MM, 100 * MM)
    assert length == pytest.approx(260.40 * MM, abs=0.006 * MM)  # their 260.405 is cut, not rounded
    assert length / (2 * MM) == pytest.approx(130.2, abs=0.05)


def test_a_belt_round_wheels_of_a_pythagorean_triangle():
    """Radii 6 and 1, 13 apart, so spans of 12: L = 2 (12 + 6 pi - 5 arctan(12/5)), solve.club prints 49.939."""
    pitch = 2 * math.pi  # so that radii are teeth
    assert belt_length(6, 1, pitch, 13) == pytest.approx(49.939059772127518, rel=1e-12)
    assert belt_length(6, 1, pitch, 13) == pytest.approx(2 * (12 + 6 * math.pi - 5 * math.atan(12 / 5)), rel=1e-12)


@pytest.mark.parametrize(("distance", "printed", "half"), [(130, 6.74, 0.005), (100, 5.6, 0.05)])
def test_teeth_in_mesh_as_printed(distance, printed, half):
    """20 and 100 teeth of 5 mm: a robot's public design notes, after SDP/SI's handbook (13.3), print 6.74 and 5.6."""
    assert teeth_in_mesh(20, 100, 5 * MM, distance * MM) == pytest.approx(printed, abs=half)


@given(st.integers(8, 200), st.floats(1.01, 50.0), st.sampled_from([2, 3, 5, 6.35, 8]))
def test_equal_pulleys_are_two_spans_and_one_circle(teeth, apart, pitch):
    """L = 2 a + z p, half of the teeth in mesh."""
    pitch = pitch * MM
    a = apart * pitch_diameter(teeth, pitch)
    assert belt_length(teeth, teeth, pitch, a) == pytest.approx(2 * a + teeth * pitch, rel=1e-12)
    assert wrap_angle(teeth, teeth, pitch, a) == pytest.approx(math.pi)
    assert teeth_in_mesh(teeth, teeth, pitch, a) == pytest.approx(teeth / 2)
    belt = teeth * round(2 + apart)
    assert centre_distance(teeth, teeth, pitch, belt) == pytest.approx((belt - teeth) * pitch / 2, rel=1e-12)


@given(st.integers(8, 200), st.integers(8, 200), st.floats(1.001, 30.0), st.sampled_from([2, 3, 5, 6.35, 8]))
def test_the_belt_is_that_of_the_tangent_points(z_1, z_2, apart, pitch):
    pitch = pitch * MM
    a = apart * (pitch_diameter(z_1, pitch) + pitch_diameter(z_2, pitch)) / 2
    length, on_1, on_2 = by_tangents(z_1, z_2, pitch, a)
    assert belt_length(z_1, z_2, pitch, a) == pytest.approx(length, rel=1e-12)
    assert belt_length(z_2, z_1, pitch, a) == pytest.approx(length, rel=1e-12)
    assert wrap_angle(z_1, z_2, pitch, a) == pytest.approx(min(on_1, on_2), rel=1e-9)
    assert teeth_in_mesh(z_1, z_2, pitch, a) == pytest.approx(min(z_1 * on_1, z_2 * on_2) / (2 * math.pi), rel=1e-9)
    assert centre_distance(z_1, z_2, pitch, length / pitch) == pytest.approx(a, rel=1e-9)


def test_a_belt_that_is_too_short_holds_no_pulleys():
    """The pulleys would be inside each other: no answer, and unknown teeth give none either."""
    touching = (pitch_diameter(20, 5 * MM) + pitch_diameter(40, 5 * MM)) / 2
    least = by_tangents(20, 40, 5 * MM, touching)[0] / (5 * MM)
    found = centre_distance(20, 40, 5 * MM, np.array([39.0, 41.0, least - 0.01, least + 0.01, np.nan]))
    assert np.isnan(found).tolist() == [True, True, True, False, True]
    assert found[3] >= touching


# -- which ratios there are

SHOP = Path(__file__).with_name("belts.yaml").read_text(encoding="utf-8")
FAR = """
catalog: 1
manufacturer: Far
sources: {sheet: {document: "sheet F", confidence: quoted}}
belts:
  - {family: FB, source: sheet, common: {profile: HTD, pitch: 5 mm, width: 9 mm}, columns: [part, teeth],
     rows: [[A70, 70]]}
pulleys:
  - {family: FP, source: sheet, common: {profile: HTD, pitch: 5 mm, width: 9 mm}, columns: [part, teeth],
     rows: [[A15, 15], [A18, 18], [A22, 22]]}
"""
BELT = "pulleys: {profile: HTD, pitch: 5 mm, width: 9 mm, ratio_min: 1.05, ratio_max: 2.1%s}"


@pytest.fixture
def shop(tmp_path, example_text):
    """The SPS robot by physics with pulleys, and two makers of them; a function that writes it otherwise."""
    (tmp_path / "near.yaml").write_text(SHOP)
    (tmp_path / "far.yaml").write_text(FAR)

    def spec(more: str = ", centre_distance: 120 mm, adjustable: 20 mm", *pairs: tuple[str, str], beside: str = ""):
        text = example_text.replace("method: paper", "method: physics").replace("min: 22 V", "min: 23 V")
        text = re.sub(r"ratio: 1\.1 .*", BELT % more + beside, text)
        for old, new in (("catalogs: [maxon]", "catalogs: [maxon, near.yaml, far.yaml]"), *pairs):
            assert old in text
            text = text.replace(old, new)
        (tmp_path / "robot.yaml").write_text(text)
        return load_spec(tmp_path / "robot.yaml")

    return spec


def offered(spec):
    return pulleys.belt_drives(spec, load_parts(spec))


def by_enumeration(pulleys, belts, pitch, ratios, wish, tolerance):
    """The best way for each ratio, one triple after the other, distances by halving the interval."""
    best = {}
    for z_1, z_2, belt in itertools.product(pulleys, pulleys, belts):
        low, high = (z_1 + z_2) * pitch / (2 * math.pi), belt * pitch
        if not ratios[0] <= z_2 / z_1 <= ratios[1] or by_tangents(z_1, z_2, pitch, low)[0] > belt * pitch:
            continue
        for _ in range(80):
            middle = (low + high) / 2
            low, high = (middle, high) if by_tangents(z_1, z_2, pitch, middle)[0] < belt * pitch else (low, middle)
        if abs(low - wish) > tolerance:
            continue
        _, on_1, on_2 = by_tangents(z_1, z_2, pitch, low)
        held = min(z_1 * on_1, z_2 * on_2) / (2 * math.pi)
        value = max(6 - math.floor(held), 0), z_1, abs(low - wish), belt
        best.setdefault(Fraction(z_2, z_1), []).append((value, (z_1, z_2, belt, low, held)))
    return [min(best[ratio])[1] for ratio in sorted(best)]


@pytest.mark.parametrize(("wish", "tolerance"), [(120, 20), (112, 8), (101, 3)])
def test_of_each_ratio_the_best_way(shop, wish, tolerance):
    found = offered(shop(f", centre_distance: {wish} mm, adjustable: {tolerance} mm")).drives
    pulleys, belts = [12, 15, 16, 18, 22, 24, 30], [60, 64, 70, 90]  # 20 is too narrow, of 40 nobody tells the width
    expected = by_enumeration(pulleys, belts, 5 * MM, (1.05, 2.1), wish * MM, tolerance * MM)
    assert len(found) == len(expected) > 5
    for drive, (z_1, z_2, belt, distance, held) in zip(found, expected, strict=True):
        assert (drive.driving.teeth, drive.driven.teeth, drive.belt.teeth) == (z_1, z_2, belt)
        assert drive.ratio == z_2 / z_1
        assert drive.centre_distance == pytest.approx(distance, rel=1e-9)
        assert drive.teeth_in_mesh == pytest.approx(held, rel=1e-9)


def test_parts_of_the_belts_maker_the_narrowest_first(shop):
    found = {drive.name: drive for drive in offered(shop()).drives}
    one = found["24:16"]
    assert (one.driving.part, one.driven.part, one.belt.manufacturer) == ("P16", "P24", "Near")
    mixed = found["22:18"]  # 22 is made by the other one only, who has 18 as well, and this belt
    assert {p.manufacturer for p in mixed.parts.values()} == {"Far"}
    assert [p.part for p in mixed.parts.values()] == ["A18", "A70", "A22"]
    assert {drive.belt.part for drive in found.values()} <= {"B60", "B64A", "B70", "B90", "A70"}  # B64 is withdrawn


def test_a_step_up_is_a_ratio_below_1(shop):
    drives = offered(shop(", centre_distance: 120 mm, adjustable: 20 mm", ("ratio_min: 1.05", "ratio_min: 0.5"),
                          ("ratio_max: 2.1", "ratio_max: 0.95"))).drives  # fmt: skip
    assert [d.name for d in drives if d.ratio == 0.5] == ["15:30"]
    assert all(d.driving.teeth > d.driven.teeth for d in drives)


def test_without_a_centre_distance_the_shortest_belt_that_a_new_drive_should_have(shop):
    for drive in offered(shop("")).drives:
        z_1, z_2 = drive.driving.teeth, drive.driven.teeth
        assert drive.centre_distance >= shortest_recommended(z_1, z_2, 5 * MM)
        shorter = [z for z in (60, 64, 70, 90) if z < drive.belt.teeth]
        fewer = [teeth_in_mesh(z_1, z_2, 5 * MM, centre_distance(z_1, z_2, 5 * MM, z)) for z in shorter]
        too_near = [centre_distance(z_1, z_2, 5 * MM, z) < 5 * MM * 0.2 * (z_1 + z_2) for z in shorter]
        whole = math.floor(min(drive.teeth_in_mesh, 6))
        assert all(near or math.floor(min(held, 6)) < whole for near, held in zip(too_near, fewer, strict=True))


def test_many_ratios_are_cut_and_it_is_said(shop, tmp_path):
    rows = ", ".join(f"[Q{z}, {z}]" for z in range(21, 60))
    head, tail = FAR.split("rows: [[A15, 15], [A18, 18], [A22, 22]]")
    (tmp_path / "far.yaml").write_text(f"{head}rows: [{rows}]{tail}")
    given = problem(shop(""), load_parts(shop("")))
    drives, ratios = given.belts
    assert len(drives) == pulleys.MOST_RATIOS == len(given.belt_ratios) < ratios
    assert all(drive.teeth_in_mesh >= 6 for drive in drives)
    said = pulleys.assumptions(given)
    assert any(f"{ratios} ratios" in text and "60" in text for text in said)
    assert any("0.2 p" in text for text in said)


WRONG = [
    (
        ("profile: HTD", "profile: XL"),
        ['no pulleys "XL" 5 mm', "9 mm width", "GT2 3 mm of 9 mm", "HTD 5 mm of 6 mm, 9"],
    ),
    (("width: 9 mm", "width: 12 mm"), ['no belts "HTD" 5 mm of 12 mm width', "HTD 5 mm of 9 mm, 15 mm"]),
    (("near.yaml, far.yaml]", "]"), ["no pulleys", "they list no pulleys", "wcp"]),
    (("ratio_max: 2.1", "ratio_max: 1.06"), ["from 1.05 to 1.06", "nearest are 1 and 1.067"]),
    (
        ("distance: 120 mm", "distance: 400 mm"),
        ["400 mm within 20 mm", "4 belts of 60 to 90 teeth", "15:12 with 90 teeth"],
    ),
    (("ratio_max: 2.1", "ratio_max: 1.04"), ["expected ratio_min <= ratio_max"]),
    (("pitch: 5 mm, ", ""), ["pulleys.pitch", "missing", "length"]),
    (("profile: HTD", "profil: HTD"), ["pulleys.profil", "unknown key", '"profile"']),
    (
        ("efficiency: 0.95", "ratio: 1.1\n    efficiency: 0.95"),
        ["ratio or ratios or pulleys", "both ratio and pulleys"],
    ),
    (("efficiency: 0.95", "pulley_diameter: 40 mm\n    efficiency: 0.95"), ["pulleys or pulley_diameter"]),
]


@pytest.mark.parametrize(("change", "words"), WRONG, ids=[pair[0][1] or "gone" for pair in WRONG])
def test_what_does_not_fit_is_one_line_that_says_what_there_is(shop, change, words):
    message = refusal(lambda: offered(shop(", centre_distance: 120 mm, adjustable: 20 mm", change)))
    assert "robot.yaml:3" in message and "transmission" in message
    for word in words:
        assert word in message


# -- in a set


PAIR = ("118752", "406764")


def test_pulleys_do_what_the_ratio_and_the_diameter_do(shop, tmp_path):
    """The same set with the numbers in place of the parts: every demand and limit agrees, tension and speed too."""
    limits = "\n    max_tension: 180 N\n    max_speed: 3 m/s"
    spec = shop(", centre_distance: 120 mm, adjustable: 20 mm", beside=limits)
    with_parts = {s.belt_ratio: s for s in explain(spec, *PAIR)}
    one = with_parts[2.0]
    pulleys = re.search(r"pulleys: .*\}", spec.text)
    assert pulleys
    text = spec.text.replace(pulleys[0], f"ratio: 2\n    pulley_diameter: {30 * 5 / math.pi!r} mm")
    (tmp_path / "numbers.yaml").write_text(text)
    (plain,) = explain(load_spec(tmp_path / "numbers.yaml"), *PAIR)
    beside = {check.name: check for check in plain.checks}
    assert {"belt_tension", "belt_speed"} <= set(beside)
    for check in one.checks:
        if check.name != "belt_teeth_in_mesh":
            assert check.demand == pytest.approx(beside[check.name].demand, rel=1e-9, nan_ok=True), check.name
            assert check.limit == pytest.approx(beside[check.name].limit, rel=1e-9, nan_ok=True), check.name
    assert set(beside) == {check.name for check in one.checks} - {"belt_teeth_in_mesh"}
    tensions = {
        s.belt_drive.driven.teeth: c.demand for s in with_parts.values() for c in s.checks if c.name == "belt_tension"
    }
    assert tensions[30] / tensions[24] == pytest.approx(24 / 30)  # same torque at the load's shaft, other radius


def test_too_few_teeth_in_mesh_fail_the_set(shop):
    sets = {s.belt_ratio: s for s in explain(shop(), *PAIR)}
    for found in sets.values():
        (check,) = [c for c in found.checks if c.name == "belt_teeth_in_mesh"]
        assert check.demand == 6 and check.limit == found.belt_drive.teeth_in_mesh and check.by_choice
        assert check.status == ("pass" if check.limit >= 6 else "fail")
    assert sets[22 / 12].status == "fail" and sets[1.25].status != "fail"


def test_belt_and_pulleys_are_parts_of_the_set(shop):
    result = size(shop(), top=3)
    for found in result.sets:
        assert found.belt_ratio == found.belt_drive.ratio
        assert found.total_ratio == pytest.approx(found.gearhead.ratio * found.belt_drive.ratio)
        assert list(found.parts)[-5:] == ["driving pulley", "belt", "driven pulley", "encoder", "controller"]
        assert found.label.endswith(f"+ belt {found.belt_drive.name}")
    assert any("torque that a belt withstands" in text for text in result.assumptions)
    assert result.counts.considered % len(result.problem.belt_ratios) == 0
