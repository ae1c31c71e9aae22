"""Power of several axes on one bus: cases by hand, and sums walked through time in plain Python."""

from __future__ import annotations

import math
import random
from itertools import pairwise

import numpy as np
import pytest

from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine.common_bus import (
    AtAnyPhase,
    exchanged,
    from_start,
    share_above,
    summed_up,
    worst_start,
)
from drivesizer.machine.supply_power import DrivePower, Regenerated
from drivesizer.physics.power_stage import Feed, PowerStage
from drivesizer.spec.robot import RobotSpec, read_spec

FINE = 16  # pieces of a segment
STIFF = Feed(PowerStage(1.0, 0.0, 0.0, 0.0, 0.0, False), 48.0, 0.0, 1)


def course(points) -> DrivePower:
    """Power that goes straight from point to point, (s, W): each line in pieces, as that of a drive is."""
    duration, ends = [], []
    for (t0, p0), (t1, p1) in pairwise(points):
        for k in range(FINE):
            duration.append((t1 - t0) / FINE)
            ends.append((p0 + (p1 - p0) * k / FINE, p0 + (p1 - p0) * (k + 1) / FINE))
    drawn, returned = np.array([_shares(a, b) for a, b in ends]).T
    most, least = np.max(ends, axis=1), np.min(ends, axis=1)
    known = {name: np.zeros_like(drawn) for name in DrivePower._fields if name != "distance"}
    known |= {"duration": np.array(duration), "drawn": drawn, "bus_drawn": drawn, "returned": returned, "most": most}
    known |= {"least": least, "peak": np.maximum(most, 0.0), "returned_peak": np.maximum(-least, 0.0)}
    return DrivePower(distance=math.nan, **known)


def _shares(a: float, b: float) -> tuple[float, float]:
    """Mean of what a straight line has above zero, and below."""
    if a * b >= 0.0:
        return max((a + b) / 2, 0.0), max(-(a + b) / 2, 0.0)
    above = max(a, b) ** 2 / (2 * abs(b - a))
    return above, above - (a + b) / 2


def at_random(seed: int, total: float = 0.0) -> list[tuple[float, float]]:
    of = random.Random(seed)
    count = of.randint(2, 6)
    times = sorted(of.uniform(0.02, 0.98) for _ in range(count))
    total = total or of.choice([1.0, 1.5, 2.0, 3.0])
    power = [of.uniform(-60.0, 100.0) for _ in range(count)]
    first = of.uniform(-20.0, 30.0)
    return [(0.0, first), *((t * total, p) for t, p in zip(times, power, strict=True)), (total, first)]


def walked(axes, start, total: float, steps: int = 6000):
    """Net power of axes at the middle of small steps: largest, drawn and returned energy."""
    net = [sum(_at(points, (t - s) % points[-1][0]) for points, s in zip(axes, start, strict=True))
           for t in ((k + 0.5) * total / steps for k in range(steps))]  # fmt: skip
    step = total / steps
    return max(net), sum(max(p, 0.0) for p in net) * step, sum(max(-p, 0.0) for p in net) * step


def _at(points, time: float) -> float:
    for (t0, p0), (t1, p1) in pairwise(points):
        if t0 <= time < t1:
            return p0 + (p1 - p0) * (time - t0) / (t1 - t0)
    return points[-1][1]


def energy(power: DrivePower) -> tuple[float, float]:
    return float(power.bus_drawn @ power.duration), float(power.returned @ power.duration)


# --- by hand ----------------------------------------------------------------------------------------------------------


def test_one_axis_accelerates_with_what_another_regenerates():
    """Triangles of 100 W and of -60 W in 1 s: 50 J and 30 J; as one comes back the other goes, so 30 J change hands."""
    one = course([(0.0, 0.0), (1.0, 100.0), (1.0, 0.0), (2.0, 0.0)])
    other = course([(0.0, 0.0), (1.0, -60.0), (1.0, 0.0), (2.0, 0.0)])
    net = exchanged([one, other], STIFF)
    assert energy(net) == pytest.approx((20.0, 0.0), abs=0.2)  # by so much at most: 1/64 of what the pieces rise by
    assert energy(net)[1] >= 0.0 and energy(net)[0] - energy(net)[1] == pytest.approx(20.0)
    assert float(net.peak.max()) == pytest.approx(40.0, rel=0.1)  # of pieces: their largest and their least
    assert energy(summed_up([one, other], STIFF)) == pytest.approx((50.0, 30.0))
    apart = exchanged([one, from_start(other, 1.0)], STIFF)
    assert energy(apart) == pytest.approx((50.0, 30.0)) and float(apart.peak.max()) == pytest.approx(100.0)


# --- walked through time ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(6))
def test_sums_are_those_walked_through_time(seed):
    of = random.Random(100 + seed)
    points = [at_random(10 * seed + k, 2.0) for k in range(of.randint(2, 4))]
    starts = [of.uniform(0.0, 3.0) for _ in points]
    net = exchanged([from_start(course(p), s) for p, s in zip(points, starts, strict=True)], STIFF)
    peak, drawn, returned = walked(points, starts, 2.0)
    spread = sum(max(p for _, p in one) - min(p for _, p in one) for one in points) / FINE
    assert peak - 0.1 <= float(net.peak.max()) <= peak + spread
    assert energy(net)[0] - energy(net)[1] == pytest.approx(drawn - returned, abs=1e-2)
    assert returned * 0.999 - 1e-3 <= energy(net)[1] <= returned + 0.05 * spread


@pytest.mark.parametrize("seed", range(8))
def test_sums_never_exceed_the_single_ones(seed):
    powers = [course(at_random(50 * seed + k, 1.5)) for k in range(2 + seed % 4)]
    net, single = exchanged(powers, STIFF), [energy(one) for one in powers]
    assert energy(net)[0] <= math.fsum(d for d, _ in single) * (1 + 1e-12)
    assert energy(net)[1] <= math.fsum(r for _, r in single) * (1 + 1e-12)
    balance = math.fsum(d - r for d, r in single)
    assert energy(net)[0] - energy(net)[1] == pytest.approx(balance) and energy(net)[1] >= max(-balance, 0.0) - 1e-12
    assert float(net.peak.max()) <= math.fsum(float(one.peak.max()) for one in powers) + 1e-9
    assert float(net.returned_peak.max()) <= math.fsum(float(one.returned_peak.max()) for one in powers) + 1e-9
    other = exchanged(powers[::-1], STIFF)
    for name in ("duration", "bus_drawn", "returned", "peak", "drawn"):
        assert getattr(net, name) == pytest.approx(getattr(other, name), abs=1e-9)
    assert exchanged(powers[:1], STIFF) is powers[0]


def test_a_resistance_of_the_supply_has_the_current_of_all_axes():
    """Two axes of 96 W on 48 V and 0.5 ohm: P = U I - R I² of 192 W takes 4.18 A, of one alone 2.05 A."""
    soft = STIFF._replace(resistance=0.5)
    one = course([(0.0, 96.0), (1.0, 96.0)])
    current = (48.0 - math.sqrt(48.0**2 - 4 * 0.5 * 192.0)) / (2 * 0.5)
    both = exchanged([one, one], soft)
    assert both.drawn == pytest.approx(48.0 * current) and both.peak == pytest.approx(48.0 * current)
    assert both.resisted == pytest.approx(0.5 * current**2)
    rising = exchanged([course([(0.0, 0.0), (1.0, 400.0)]), course([(0.0, 0.0), (1.0, 100.0)])], soft)
    exact = np.mean([48.0 * (48.0 - math.sqrt(48.0**2 - 2.0 * 500.0 * (k + 0.5) / 4000)) for k in range(4000)])
    assert exact <= float(rising.drawn @ rising.duration) <= exact * 1.002


# --- at any phase -----------------------------------------------------------------------------------------------------


MACHINE = """
name: x
load: {kind: flywheel, inertia: 3e-4 kg*m^2}
motion: {speed: 9 rpm, acceleration_time: 1 s, cruise_time: 1 s}
supply: {nominal: 48 V}
"""


def machine() -> RobotSpec:
    return read_spec(YamlSource(MACHINE, "x.yaml"))


def test_the_share_of_time_above_a_limit_is_that_of_counting():
    """Sawtooths from 0 to 1: the sum of three exceeds x with the probability of Irwin and Hall."""
    tooth = (np.full(1000, 1e-3), (np.arange(1000) + 0.5) / 1000)
    irwin_hall = {0.5: 1 - 0.5**3 / 6, 1.5: 0.5, 2.5: 0.5**3 / 6}
    for limit, share in irwin_hall.items():
        both = (share_above([tooth] * 3, limit, up=up) for up in (False, True))
        assert next(both) <= share + 1e-3 and share - 1e-3 <= next(both) <= share + 3e-3
    assert share_above([tooth] * 3, 3.0) == 0.0 and share_above([tooth] * 3, -0.1) == pytest.approx(1.0)
    assert math.isnan(share_above([(np.ones(1), np.full(1, math.nan)), tooth], 1.0))


@pytest.mark.parametrize("seed", range(5))
def test_no_phase_exceeds_the_bounds(seed):
    of = random.Random(seed)
    points = [at_random(31 * seed + k, 2.0) for k in range(2 + seed % 2)]
    powers = tuple(course(p) for p in points)
    shared = machine()
    bound = AtAnyPhase("", shared, powers[0], tuple(Regenerated("", shared, p) for p in powers), STIFF)
    limit = 0.5 * sum(float(p.most.max()) for p in powers)
    worst, run, burnt, capacity = 0.0, bound.longest_above(limit), bound.burnt(0.0, 3.0), 5.0
    kept = bound.burnt(capacity, 3.0)
    for _ in range(12):
        starts = [of.uniform(0.0, 2.0) for _ in powers]
        net = exchanged([from_start(p, s) for p, s in zip(powers, starts, strict=True)], STIFF)
        one = Regenerated("", shared, net)
        assert one.energy <= bound.energy * (1 + 1e-9) + 0.3 and one.stored <= bound.stored * (1 + 1e-9)
        assert one.longest_above(limit) <= run + 1e-9
        load, less = one.burnt(0.0, 3.0), one.burnt(capacity, 3.0)
        assert load.mean <= burnt.mean * (1 + 1e-9) and load.peak <= burnt.peak * (1 + 1e-9)
        assert load.pulse <= burnt.pulse * (1 + 1e-9) and less.energy <= kept.energy * (1 + 1e-9) + 0.3
        assert less.pulse <= kept.pulse * (1 + 1e-9) or kept.pulse == 0.0 == less.energy
        worst = max(worst, float(net.peak.max()))
    aligned = exchanged([from_start(p, worst_start(p)) for p in powers], STIFF)
    assert worst <= float(aligned.peak.max()) + 1e-9
    assert float(aligned.peak.max()) == pytest.approx(sum(float(p.most.max()) for p in powers))
