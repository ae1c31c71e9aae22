"""Sets of wheels, and their contact written out."""

from __future__ import annotations

import itertools
import math

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

from drivesizer.platform.kinematics import Wheel

figure, turn = st.floats(-3.0, 3.0), st.floats(-math.pi, math.pi)


@st.composite
def wheel_sets(draw, least=3, most=6):
    """Wheels with rollers of any angle, in any place and heading, that hold a platform well."""
    count = draw(st.integers(least, most))
    wheels = [
        Wheel(
            x=draw(st.floats(-0.8, 0.8)), y=draw(st.floats(-0.8, 0.8)), radius=draw(st.floats(0.03, 0.3)),
            heading=draw(turn), roller_angle=draw(st.floats(-1.2, 1.2)),
        )
        for _ in range(count)
    ]  # fmt: skip
    assume(all(math.dist((a.x, a.y), (b.x, b.y)) > 0.01 for a, b in itertools.combinations(wheels, 2)))
    rows = np.array([contact_row(w) for w in wheels])
    assume(np.linalg.cond(rows) < 50.0)
    return wheels


def contact_row(w):
    """Speed of the contact point along the roller's axis over velocity: by vectors, not by (26)."""
    along = np.array([math.cos(w.heading + w.roller_angle), math.sin(w.heading + w.roller_angle)])
    return np.array([*along, w.x * along[1] - w.y * along[0]])
