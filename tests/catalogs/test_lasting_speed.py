"""How long a gearhead turns faster than its continuous limit: by hand, by bisection, and by makers' rules."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from by_hand import lasting
from hypothesis import given, settings
from hypothesis import strategies as st

from drivesizer.catalog import load
from drivesizer.files.yaml_source import YamlSource
from drivesizer.physics.load_cycle import exceeded, lasting_speeds, mean_running
from drivesizer.results.ratings import continuous_speed_limit
from drivesizer.sizing import size
from drivesizer.spec.robot import read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

SHORT = (1.0, 0.1)


def cycle(*breaks):
    """Straight lines through (time, speed)."""
    time, speed = np.array(breaks, float).T
    return np.diff(time), np.stack([speed[:-1], speed[1:]], axis=1)


@pytest.mark.parametrize(("breaks", "expected"), [
    pytest.param(
        [(0, 0), (2, 10), (4, 0), (64, 0)], 7.5, id="triangle of 4 s: above 3/4 of its peak for 1 s without a break"
    ),
    pytest.param([(0, 0), (0.4, 10), (0.8, 0), (4, 0)], 5.0, id="0.8 s, above half of it for 10 % of 4 s"),
    pytest.param([(0, 9), (0.9, 9), (0.9001, 1), (90, 1)], 1.0, id="0.9 s and 1 % of the time are no matter"),
    pytest.param([(0, 9), (1.1, 9), (1.1001, 1), (90, 1)], 9.0, id="1.1 s without a break are"),
    pytest.param([(0, 9), (0.6, 9), (0.6001, 1), (89.4, 1), (89.4001, 9), (90, 9)], 9.0, id="0.6 s on both sides"),
    pytest.param([(0, 3), (0.2, 4), (0.4, 3)], 3.9, id="never below 3, above 3.9 for 10 % of the time"),
    pytest.param([(0, 0), (0.02, 5), (0.04, 0), (60, 0)], 0.0, id="short and seldom: nothing lasts"),
])  # fmt: skip
def test_by_hand(breaks, expected):
    assert exceeded(*cycle(*breaks), SHORT).item() == pytest.approx(expected, abs=2e-3)


@settings(max_examples=60)
@given(st.integers(0, 10_000), st.sampled_from([SHORT, (0.3, 0.5), (2.0, 1.0), (30.0, 1.0)]))
def test_as_bisection_finds_it(seed, permitted):
    random = np.random.default_rng(seed)
    speed = np.round(random.uniform(0, 6, int(random.integers(2, 9))))
    duration, ends = cycle(*zip(np.cumsum(random.uniform(0.1, 2, len(speed))), speed, strict=True))
    if seed % 2:
        ends[:, 1] = ends[:, 0]
    found = exceeded(duration, ends, permitted).item()
    assert found == pytest.approx(lasting(tuple(zip(duration, map(tuple, ends), strict=True)), *permitted), abs=1e-8)
    columns = np.stack([duration, 2 * duration], axis=1), np.stack([ends, ends / 2], axis=2)
    assert exceeded(*columns, permitted)[0] == pytest.approx(found, rel=1e-12)


def test_the_mean_is_that_of_the_time_in_which_it_runs():
    assert mean_running(*cycle((0, 0), (1, 6), (3, 6), (4, 0), (9, 0))).item() == pytest.approx(18 / 4)


def test_makers_of_servo_gearboxes_limit_the_mean_or_what_lasts_for_20_minutes():
    short, long = (lasting_speeds(*cycle((0, 8), (t, 8), (t, 2), (9000, 2))) for t in (600, 1500))
    assert short["sustained_speed"] == long["sustained_speed"] == 8.0
    assert short["mean_speed"].item() == pytest.approx((600 * 8 + 8400 * 2) / 9000)
    assert long["mean_speed"] == 8.0
    gearheads = {
        "manufacturer": np.array(["Wittenstein", "maxon", "somebody"]),
        "continuous_input_speed": np.full(3, 10.0),
        "intermittent_input_speed": np.full(3, 12.0),
    }
    assert continuous_speed_limit(gearheads, 2.0, 8.0, 3.0).demand.tolist() == [6.0, 24.0, 24.0]


@pytest.mark.parametrize("manufacturer", ["Apex Dynamics", "Harmonic Drive", "Wittenstein"])
def test_makers_are_called_as_in_their_catalogues(manufacturer):
    (file,) = (Path(__file__).resolve().parents[2] / "catalogs").glob(f"{manufacturer.split()[0].lower()}*.yaml")
    assert set(load([file.stem]).gearheads["manufacturer"][:5]) == {manufacturer}


SAW = """
name: a saw
load: {kind: rotary_table, inertia: 1e-5 kg*m^2, friction_torque: 1 mN*m}
motion: {profile: segments, segments: [%s]}
supply: {nominal: 48 V}
select: {catalogs: [maxon], motor: {family: [RE 25, ECX SPEED 22 M]}}
"""


def test_a_saw_tooth_with_a_crawl_is_judged_by_the_saw_tooth(catalog):
    """Ten teeth of 1 s up to 60 rad/s, then 0.5 s at 2 rad/s: 10 (1 - v/60) s exceed v, 1.05 s exceed 53.7.

    The crawl is the only stretch without change of speed, and says nothing of how fast the gearhead is driven.
    """
    teeth = ["{time: 0.5 s, to: 60 rad/s}, {time: 0.5 s, to: 0 rad/s}"] * 10
    crawl = "{time: 1 ms, to: 2 rad/s}, {time: 0.5 s, to: 2 rad/s}, {time: 1 ms, to: 0 rad/s}"
    result = size(read_spec(YamlSource(SAW % ", ".join([*teeth, crawl]), "saw.yaml")), catalog=catalog, top=1)
    check = next(c for c in result.reported.checks if c.name == "gearhead_continuous_speed")
    lasts = 60 * (1 - 0.1 * 10.502 / 10)
    assert check.demand == pytest.approx(lasts * result.reported.gearhead.ratio, rel=1e-6)
