"""Room that a platform needs: against the ladder's law, rectangles turned and clipped by hand, and its own motions."""

import math

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from trajectories import straight, turning

from drivesizer.platform.envelope import Passage, Size, clearances, corner_width, heading_tolerance, width_at
from drivesizer.platform.trajectory import control_points, finer

ROBOT = Size(length=0.707, width=0.350, height=0.184)  # of the paper, section 1
DOOR = 0.400  # m, of the paper: the passage of the access doors, 400 mm by 200 mm
sides = st.floats(0.1, 2.0)


@st.composite
def sizes(draw, off=0.0):
    place = {n: draw(st.floats(-off, off)) for n in ("x", "y")} if off else {}
    return Size(length=draw(sides), width=draw(sides), height=0.5, **place)


def outline(size, x, y, heading, points=1):
    """Points on the rectangle's edges in the world, corners first: by complex numbers."""
    corners = [complex(size.x + a * size.length / 2, size.y + b * size.width / 2)
               for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))]  # fmt: skip
    found = [p + (q - p) * k / points for p, q in zip(corners, corners[1:] + corners[:1], strict=True)
             for k in range(points)]  # fmt: skip
    return np.array([complex(x, y) + p * complex(math.cos(heading), math.sin(heading)) for p in found])


# --- straight through -------------------------------------------------------------------------------------------------


@given(sizes(), st.floats(-math.pi, math.pi))
def test_the_width_taken_is_that_of_the_turned_corners(size, heading):
    across = outline(size, 0.0, 0.0, heading).imag
    assert width_at(size, heading) == pytest.approx(np.ptp(across))


def test_the_papers_robot_has_25_mm_beside_it_in_the_door():
    assert (DOOR - width_at(ROBOT, 0.0)) / 2 == pytest.approx(0.025)


def test_the_papers_robot_may_be_4_degrees_off():
    """By bisection on the turned corners, not by the closed form."""
    low, high = 0.0, 0.5
    for _ in range(50):
        middle = (low + high) / 2
        fits = np.ptp(outline(ROBOT, 0.0, 0.0, middle).imag) <= DOOR
        low, high = (middle, high) if fits else (low, middle)
    assert heading_tolerance(ROBOT, DOOR) == pytest.approx(low, rel=1e-9)
    assert math.degrees(low) == pytest.approx(4.13, abs=0.005)


@given(sizes(), st.floats(0.05, 4.0), st.floats(0.0, 0.05))
def test_every_error_up_to_the_tolerance_fits_and_none_beyond(size, opening, aside):
    found = heading_tolerance(size, opening, aside)
    if math.isnan(found):
        assert width_at(size, 0.0, aside) > opening
        return
    within = np.linspace(0.0, found, 50)
    assert max(width_at(size, t, aside) for t in within) <= opening + 1e-9
    if found < math.pi / 2:
        assert width_at(size, found + 1e-4, aside) > opening
    else:
        assert math.hypot(size.length, size.width) <= opening - 2 * aside + 1e-9


# --- turning ----------------------------------------------------------------------------------------------------------


@given(sides, sides)
def test_a_ladder_round_a_corner(one, other):
    """(a^2/3 + b^2/3)^3/2, as in every text on extrema."""
    ladder = (one ** (2 / 3) + other ** (2 / 3)) ** 1.5
    assert corner_width(ladder, one, other) == pytest.approx(0.0, abs=1e-9)


def clears_corner(size, one, other, t):
    """Whether a rectangle at an angle, pushed into the outer corner of x, y >= 0, keeps out of x > one, y > other."""
    shape = outline(size, 0.0, 0.0, t)
    near = outline(size, -shape.real.min(), -shape.imag.min(), t, points=300)
    return not ((near.real > one + 1e-9) & (near.imag > other + 1e-9)).any()


@given(st.floats(0.3, 1.5), st.floats(0.3, 1.5), st.floats(0.2, 2.5), st.floats(0.05, 1.0))
@example(1.09375, 0.46875, 1.796875, 0.171875)  # it touches between two of 100 points
@settings(max_examples=60)
def test_a_rectangle_round_a_corner_by_pushing_it(one, other, length, width):
    """Second opinion by points on its outline, at every angle: no distance to a line, no polynomial."""
    room = corner_width(length, one, other)
    assume(abs(room - width) > 0.02 * width)
    size = Size(length=length, width=width, height=0.5)
    turned = [math.pi - t for t in np.linspace(0.0, math.pi / 2, 91)[1:-1]]
    by_hand = width <= min(one, other) and all(clears_corner(size, one, other, t) for t in turned)
    assert (width < room) == by_hand


# --- along a trajectory -----------------------------------------------------------------------------------------------


@given(
    sizes(off=0.3), st.floats(-1.0, 1.0), st.floats(-0.3, 0.3), st.floats(0.0, 0.6), st.floats(-math.pi, math.pi),
    st.floats(2.2, 4.0),
)  # fmt: skip
@settings(max_examples=40)
def test_a_passage_turned_in_the_world_by_points_on_the_outline(size, heading, aside, depth, direction, width):
    """Held askew, along the passage: many points on the outline at many moments, in the world."""
    turn = complex(math.cos(direction), math.sin(direction))
    centre = complex(0.7, -0.4)
    ends = [centre + turn * complex(s, aside) for s in (-4.0, 4.0)]
    way = straight(*((z.real, z.imag) for z in ends), direction + heading, 6.0)
    door = Passage(name="door", width=width, depth=depth, x=0.7, y=-0.4, direction=direction)
    (found,) = clearances(way, size, (door,))
    shape = outline(size, 0.0, 0.0, direction + heading, points=200)
    places = centre + turn * (np.linspace(-4.0, 4.0, 400) + aside * 1j)
    points = (shape + places[:, None] - centre) / turn
    least = width / 2 - np.abs(points.imag[np.abs(points.real) <= depth / 2 + 0.01]).max()
    assert found.least == pytest.approx(least, abs=0.005)
    by_law = (width - width_at(size, heading)) / 2 - off_middle(size, heading, aside)
    assert found.least == pytest.approx(by_law, abs=width * 2e-5)


def off_middle(size, heading, aside):
    """How far the rectangle's middle runs beside the passage's."""
    return abs(aside + size.x * math.sin(heading) + size.y * math.cos(heading))


def test_what_does_not_lead_through_has_no_clearance():
    door = Passage(name="door", width=DOOR, depth=0.1)
    beside = straight((-2.0, 3.0), (2.0, 3.0), 0.0, 4.0)  # through another opening of the same wall
    before = straight((-2.0, 0.0), (-1.0, 0.0), 0.0, 4.0)
    for way in (beside, before):
        (found,) = clearances(way, ROBOT, (door,))
        assert math.isnan(found.least) and math.isnan(found.time) and found.side == ""
    grazing = straight((-2.0, 0.3), (2.0, 0.3), 0.0, 4.0)  # half of it meets the left jamb
    (found,) = clearances(grazing, ROBOT, (door,))
    assert (found.least, found.side) == (pytest.approx(0.2 - 0.3 - 0.175), "left")


# --- between the ends of pieces ---------------------------------------------------------------------------------------


@given(st.floats(-2.0, 2.0), st.floats(-3.0, 3.0), st.floats(0.3, 3.0))
def test_a_piece_of_steady_acceleration_is_the_parabola(speed, gain, duration):
    way = turning(0.2, 0.2 + speed * duration + gain * duration**2 / 2, duration, speed=speed, gain=gain)
    share = 0.37
    points = control_points(way)[2, 0]
    bezier = sum(math.comb(3, k) * share**k * (1 - share) ** (3 - k) * p for k, p in enumerate(points))
    assert bezier == pytest.approx(0.2 + speed * share * duration + gain * (share * duration) ** 2 / 2)
    fine = finer(way, 0.05)
    assert fine.total == pytest.approx(duration)
    assert np.abs(np.diff(fine.posture[2], axis=-1)).max() <= 0.05 * 3  # the cubic's fastest part
    assert fine.posture[2, 1:, 0] == pytest.approx(fine.posture[2, :-1, 1])
    times = np.cumsum(fine.duration)
    assert fine.posture[2, :, 1] == pytest.approx(0.2 + speed * times + gain * times**2 / 2)
    assert fine.velocity[2, :, 1] == pytest.approx(speed + gain * times)
