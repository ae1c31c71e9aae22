"""A long noisy cycle behind several belts: bounds decide nothing that the waveform would decide otherwise."""

from __future__ import annotations

import numpy as np
import pytest

from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine.problem import problem
from drivesizer.physics.figures import joined
from drivesizer.search.columns.candidates import Crossed, pairs
from drivesizer.search.columns.stages import examine
from drivesizer.spec.robot import read_spec

BELTS = [0.8, 1.1, 1.7]
SUPPLIES = {
    "a current": "{nominal: 24 V, min: 22 V, max: 26 V, current: 7 A}",
    "a power, and nothing goes back": "{nominal: 24 V, min: 22 V, max: 26 V, regeneration: 0, power: 70 W}",
    "a capacitance": "{nominal: 24 V, min: 22 V, max: 26 V, regeneration: 0.4, capacitance: 20 mF, current: 7 A}",
    "resistances": "{nominal: 24 V, min: 22 V, max: 26 V, resistance: 0.3 ohm, current: 6.5 A}\n"
    "power_stage: {resistance: 20 mohm}",
}
PARTS = "{motor: {family: [RE 25, EC-max 30]}, gearhead: {family: [GP 32 C, GP 42 C]}}"


def recording(count):
    """To and fro with noise on the torque, and a short time of three times as much."""
    rng, time = np.random.default_rng(4), np.linspace(0.0, 120.0, count)
    speed = 11.0 * np.sin(time)
    torque = (0.5 * np.cos(time) + 0.2 * np.sign(speed)) * (1.0 + 0.15 * rng.normal(size=count))
    torque[count // 3 : count // 3 + count // 40] *= 3.0
    rows = "".join(f"{a!r},{b!r},{c!r}\n" for a, b, c in np.array([time, speed, torque]).T.tolist())
    return f"time,speed,torque\ns,rad/s,N*m\n{rows}"


@pytest.fixture(params=SUPPLIES)
def given(request, tmp_path, catalog):
    (tmp_path / "x.csv").write_text(recording(700), encoding="utf-8")
    text = f"""
name: x
load: {{kind: recorded, file: x.csv, inertia: 3 kg*cm^2}}
transmission: [{{kind: gearhead}}, {{kind: belt, ratios: {BELTS}, efficiency: 0.93}}]
supply: {SUPPLIES[request.param]}
environment: {{ambient: 31 degC}}
select: {PARTS}
"""
    return problem(read_spec(YamlSource(text, str(tmp_path / "x.yaml"))), catalog)


def whole(found, name):
    drives = joined([one.drives for one in found])
    return drives.amount.unknown if name == "unknown" else getattr(drives, name)


def test_what_bounds_pass_the_waveform_passes_and_nothing_else(given):
    crossed = Crossed(pairs(given), BELTS)
    by_waveform, by_bounds = (list(examine(given, crossed, waveform=waveform)) for waveform in ("all", "open"))
    assert 20 < len(whole(by_waveform, "rows")) < 0.2 * len(crossed.pairs.motor) * len(BELTS)
    for name in ("rows", "unknown", "controller"):
        np.testing.assert_array_equal(whole(by_bounds, name), whole(by_waveform, name), name)
