"""What a drive regenerates over a long cycle, its pieces merged, against the same piece by piece."""

from __future__ import annotations

import numpy as np
import pytest

from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine import supply_power
from drivesizer.machine.problem import problem
from drivesizer.machine.supply_power import drive_power, regenerated, regenerated_of
from drivesizer.sizing import size
from drivesizer.spec.robot import read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

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
def test_pieces_that_return_nothing_are_one_and_change_nothing(supply, tmp_path, catalog, monkeypatch):
    spec = spec_of(tmp_path, supply)
    one, given = size(spec, catalog=catalog, top=1).sets[0], problem(spec, catalog)
    (whole,) = regenerated(given, one)
    monkeypatch.setattr(supply_power, "_MOST", 10)
    (merged,) = regenerated(given, one)
    pieces = regenerated_of("", spec, drive_power(spec, one, given.cases[0].at_belt))
    assert whole.energy > 0.1
    for other in (whole, pieces):
        for name in ("energy", "stored", "mean_drawn"):
            assert getattr(merged, name) == pytest.approx(getattr(other, name), rel=1e-9), name
        assert merged.duration.sum() == pytest.approx(other.duration.sum(), rel=1e-12)
        assert merged.drawn.sum() == pytest.approx(other.drawn.sum(), rel=1e-9)
        assert merged.drawn_peak.max() == pytest.approx(other.drawn_peak.max(), rel=1e-9)
    for capacity in (0.0, 0.3 * whole.stored):
        mine, its = (found.burnt(capacity, 6.0, 0.2) for found in (merged, pieces))
        assert mine == pytest.approx(its, rel=1e-9), capacity
    timed = "peak_current" in SUPPLIES[supply]
    assert (len(merged.duration) == len(pieces.duration)) == timed
    if timed:
        longest = merged.longest_above(100.0)
        assert longest == pytest.approx(pieces.longest_above(100.0), rel=1e-9)
        assert 0.0 < longest < whole.duration.sum()
