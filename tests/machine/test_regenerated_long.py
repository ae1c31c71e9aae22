"""What a drive regenerates over a long cycle, found in one pass, against the same piece by piece as columns."""

from __future__ import annotations

import numpy as np
import pytest

from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine import regenerated as module
from drivesizer.machine.problem import problem
from drivesizer.machine.regenerated import regenerated
from drivesizer.physics import cycle_at_gearhead
from drivesizer.physics.groups import census
from drivesizer.physics.one_pass import drives, kernel
from drivesizer.sizing import size
from drivesizer.spec.robot import read_spec

pytestmark = [
    pytest.mark.skipif(kernel.compiled() is None, reason="the pass is not at hand as machine code"),
    pytest.mark.usefixtures("no_further_searches"),
]

SUPPLIES = {
    "nothing is accepted": "{nominal: 48 V, min: 44 V, max: 50 V, regeneration: 0}",
    "a part is accepted": "{nominal: 48 V, min: 44 V, max: 50 V, regeneration: 0.4, resistance: 0.2 ohm}",
    "current for a while": "{nominal: 48 V, min: 44 V, max: 50 V, current: 8 A, peak_current: 40 A, peak_time: 1 s,"
    " regeneration: 0}",
}


def spec_of(folder, supply):
    """A load that goes to and fro with noise, and that drives the shaft for a part of the time."""
    time = np.arange(900) * 0.05
    speed = 12.0 * np.sin(time / 2.0)
    torque = 12.0 * np.cos(time / 2.0) + 0.3 * np.sign(speed) + 0.1 * np.random.default_rng(3).normal(size=len(time))
    rows = "".join(f"{a:.2f},{b:.4f},{c:.4f}\n" for a, b, c in zip(time, speed, torque, strict=True))
    (folder / "x.csv").write_text(f"time,speed,torque\ns,rad/s,N*m\n{rows}", encoding="utf-8")
    text = f"""
name: x
load: {{kind: recorded, file: x.csv, inertia: 20 kg*cm^2, motors: 2}}
transmission: [{{kind: gearhead}}]
supply: {SUPPLIES[supply]}
"""
    return read_spec(YamlSource(text, str(folder / "x.yaml")))


@pytest.mark.parametrize("supply", SUPPLIES)
def test_in_one_pass_as_piece_by_piece(supply, tmp_path, catalog, monkeypatch):
    spec = spec_of(tmp_path, supply)
    one = size(spec, catalog=catalog, top=1).sets[0]
    (whole,) = regenerated(problem(spec, catalog), one)
    for place in (census, cycle_at_gearhead, drives):
        monkeypatch.setattr(place, "SHORT", 10)
    long = problem(spec, catalog)
    assert long.cases[0].at_belt.census
    (passed,) = regenerated(long, one)
    monkeypatch.setattr(module, "is_long", lambda _: False)
    (pieces,) = regenerated(long, one)
    assert whole.energy > 0.1
    for other in (whole, pieces):
        for name in ("energy", "stored", "mean_drawn"):
            assert getattr(passed, name) == pytest.approx(getattr(other, name), rel=1e-9), name
        assert passed.duration.sum() == pytest.approx(other.duration.sum(), rel=1e-12)
        assert passed.drawn.sum() == pytest.approx(other.drawn.sum(), rel=1e-9)
        assert passed.drawn_peak.max() == pytest.approx(other.drawn_peak.max(), rel=1e-9)
    for capacity in (0.0, 0.3 * whole.stored):
        mine, its = (found.burnt(capacity, 6.0, 0.2) for found in (passed, pieces))
        assert mine == pytest.approx(its, rel=1e-9), capacity
    timed = "peak_current" in SUPPLIES[supply]
    assert (len(passed.duration) == len(pieces.duration)) == timed  # pieces in a row that return nothing are one
    if timed:
        longest = passed.longest_above(100.0)
        assert longest == pytest.approx(pieces.longest_above(100.0), rel=1e-9)
        assert 0.0 < longest < whole.duration.sum()
