"""What a load is to a shaft that turns freely, and every kind of load in closed loop."""

from __future__ import annotations

import re
from importlib import resources

import numpy as np
import pytest

from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform import at_shaft, motion_of, remaining_torque
from drivesizer.loads.course import Profile
from drivesizer.simulate import validate
from drivesizer.sizing import size
from drivesizer.spec.robot import read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

HEAD = "name: a load\nsupply: {nominal: 48 V}\n"


def starter(kind):
    text = (resources.files("drivesizer.spec") / "starters" / f"{kind}.yaml").read_text(encoding="utf-8")
    found = read_spec(YamlSource(text, f"{kind}.yaml"))
    exact = found.control.model_copy(update={"speed_from": "exact"})  # counts would add their ripple to the torque
    return found.model_copy(update={"control": exact})


KINDS = [
    "conveyor", "hoist", "lead_screw", "ball_screw", "rack_pinion", "belt_axis", "rotary_table", "arm", "fan",
    "flywheel", "wheeled_vehicle",
]  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_taken_apart_and_put_together_again_it_is_the_load_cycle(kind):
    spec = starter(kind)
    shaft, profile, cycle = at_shaft(spec), motion_of(spec), load_cycle(spec)
    left = remaining_torque(spec, profile, shaft)
    middle = cycle.time.mean(axis=1)
    speed, torque, slope = (getattr(cycle, name).mean(axis=1) for name in ("speed", "torque", "acceleration"))
    constant = np.select([speed > 0.0, speed < 0.0], [shaft.forward_torque, shaft.backward_torque], shaft.rest_torque)
    over_time = np.interp(middle, *left.T) if len(left) else 0.0
    whole = shaft.inertia * slope + constant + over_time
    assert whole == pytest.approx(torque, abs=1e-9 * np.abs(torque).max())


@pytest.mark.parametrize(
    ("kind", "name"),
    [
        ("conveyor", "gearhead_continuous_torque"),
        ("arm", "gearhead_continuous_torque"),
        ("fan", "gearhead_intermittent_torque"),  # it creeps to rest, so that its running time is longer
    ],
)
def test_the_closed_loop_takes_what_the_load_cycle_asks(kind, name):
    """Torque at the gearhead: the closed loop's against the sizing's, which knows the motion beforehand."""
    spec = starter(kind)
    best = size(spec, top=1).sets[0]
    proof = validate(spec, best)
    asked, got = ({c.name: c.demand for c in checks}[name] for checks in (best.checks, proof.checks))
    assert got == pytest.approx(asked, rel=0.02)
    shown = {"linear": ("speed", "m/s"), "rotary": ("rotary_speed", "rpm")}[spec.load.axis]
    assert proof.series_units["speed"] == shown
    assert {c.name: c.status for c in proof.checks}["tracking_error"] == "pass"
    if kind == "arm":
        sentence = next(one for one in proof.assumptions if "an arm's largest weight torque" in one)
        stated = float(re.search(r"error of up to ([\d.]+)% of", sentence)[1]) / 100.0
        assert weight_off(proof.series) <= stated + 5e-5 and stated < 0.01


def weight_off(series):
    """By how much the weight of an arm that starts 60 deg below level differs at its angle from that asked for."""
    t, v = series["time"], series["speed_reference"]
    asked = np.radians(-60.0) + np.concatenate(([0.0], np.cumsum(np.diff(t) * (v[1:] + v[:-1]) / 2)))
    return float(np.abs(np.cos(asked) - np.cos(asked - series["position_error"])).max())


def test_a_recorded_load_is_driven_along_its_own_motion(tmp_path):
    time = np.linspace(0.0, 3.0, 61)
    speed = 8.0 * np.sin(np.pi * time / 3.0)
    torque = 1.5 + 0.4 * speed
    rows = "\n".join(f"{t:.6f},{w:.9f},{m:.9f}" for t, w, m in zip(time, speed, torque, strict=True))
    (tmp_path / "cycle.csv").write_text(f"time,speed,torque\ns,rad/s,N*m\n{rows}\n", encoding="utf-8")
    text = HEAD + "load: {kind: recorded, file: cycle.csv, inertia: 0.01 kg*m^2}\n"
    spec = read_spec(YamlSource(text, str(tmp_path / "load.yaml")))
    asked, shaft = motion_of(spec), at_shaft(spec)
    assert asked.top_speed == pytest.approx(8.0)
    left = remaining_torque(spec, asked, shaft)
    assert np.interp(time, *left.T) == pytest.approx(torque, abs=1e-6)
    best = size(spec, top=1).sets[0]
    assert {c.name: c.status for c in validate(spec, best).checks}["tracking_error"] == "pass"
    with pytest.raises(InputError, match="recorded load brings its own motion"):
        validate(spec, best, profile=Profile("other", (0.0, 1.0), (0.0, 1.0)))
