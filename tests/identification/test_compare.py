"""A machine's log beside its sizing: torques by hand give back the figure of the spec that was wrong."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest

SPEC = """\
name: cart            # a comment that stays
load:
  kind: wheeled_vehicle
  mass: 30 kg         # weighed last year
  driven_wheels: 2
  wheel_diameter: 200 mm
  rolling_resistance: 0.015
  inertia: 0 kg*m^2
motion: {profile: trapezoid, speed: 1 m/s, acceleration_time: 1 s, cruise_time: 4 s, rest_time: 2 s}
supply: {nominal: 24 V}
select: {catalogs: [maxon]}
"""
DRIVE = "DCX22S01EBKL598/GPX22HPKLSL44D0CPLW"


@pytest.fixture
def cart(tmp_path: Path, monkeypatch: Any) -> Path:
    monkeypatch.chdir(tmp_path)
    path = Path("cart.yaml")
    path.write_text(SPEC)
    return path


def driven(path: Path, figures: dict[str, float], mass: float, rolling: float) -> Path:
    """Current by hand: rolling resistance and inertia of the mass at two wheels, through a gear with losses."""
    time = np.arange(0.0, 8.0, 0.002)
    speed = np.clip(np.minimum(time, 6.0 - time), 0.0, 1.0)  # m/s
    a = np.gradient(speed, time)
    K, e, r = figures["ratio"], figures["efficiency"], 0.1
    T = r / 2.0 * mass * (a + rolling * 9.80665 * (speed > 0.0))
    w, dw = speed / r * K, a / r * K
    shaft = np.where(T > 0.0, T / (K * e), T * e / K)
    friction = figures["friction"] * (speed > 0.0) + figures["viscous"] * w
    current = (figures["inertia"] * dw + shaft + friction) / figures["k_t"]
    current += 0.01 * np.random.default_rng(1).standard_normal(len(time))
    rows = np.column_stack([time, current, w * 30.0 / np.pi])
    np.savetxt(path, rows, delimiter=",", header="time (s),current (A),motor speed (rpm)", comments="", fmt="%.6g")
    return path


@pytest.fixture(scope="module")
def figures(tmp_path_factory: Any) -> dict[str, float]:
    """Of motor and gear, as the catalogue has them."""
    from drivesizer.commands.common import load_axis
    from drivesizer.control.drive_train import drive_train
    from drivesizer.sizing import explain

    path = tmp_path_factory.mktemp("cart") / "cart.yaml"
    path.write_text(SPEC)
    spec = load_axis(path)
    train, _ = drive_train(spec, explain(spec, *DRIVE.split("/"))[0], 1e-3)
    return {"ratio": train.ratio, "efficiency": train.efficiency, "friction": train.friction, "viscous": train.viscous,
            "inertia": train.motor_inertia, "k_t": train.torque_constant}  # fmt: skip


@pytest.mark.parametrize(
    ("mass", "rolling", "field", "value"),
    [(36.0, 0.015, "load.mass", 36.0), (30.0, 0.04, "load.rolling_resistance", 0.04)],
)
def test_the_figure_that_was_wrong_explains_the_log(
    run: Any, cart: Path, figures: dict[str, float], mass: float, rolling: float, field: str, value: float
) -> None:
    log = driven(Path("log.csv"), figures, mass, rolling)
    status, out, _ = run("compare", log, "--spec", cart, "--set", DRIVE, "--json", "-o", "right.yaml", "-o", "log.svg")
    found = json.loads(out)
    first = found["explanations"][0]
    assert status == int(any(one["status"] == "fail" for one in found["checks"]))
    assert first["field"] == field
    assert float(first["explains"].split()[0]) == pytest.approx(value, rel=0.03)
    assert first["share"] > 0.9
    right = Path("right.yaml").read_text()
    assert right.replace(f"{first['explains']} ", f"{first['entered']} ").count("# a comment that stays") == 1
    changed = [(a, b) for a, b in zip(SPEC.splitlines(), right.splitlines(), strict=True) if a != b]
    assert len(changed) == 1
    assert changed[0][1].lstrip().startswith(field.removeprefix("load.") + ":")


def test_margins_are_those_of_the_measured_figures(run: Any, cart: Path, figures: dict[str, float]) -> None:
    log = driven(Path("log.csv"), figures, 30.0, 0.015)
    _, out, _ = run("compare", log, "--spec", cart, "--set", DRIVE, "--json")
    found = json.loads(out)
    jsonschema.Draft202012Validator(json.loads(run("schema", "comparison")[1])).validate(found)
    table = np.loadtxt(log, delimiter=",", skiprows=1)
    mean = np.sqrt(np.trapezoid(table[:, 1] ** 2, table[:, 0]) / table[-1, 0])
    checks = {one["name"]: one for one in found["checks"]}
    rated = checks["motor_nominal_current"]
    assert rated["measured"] == pytest.approx(mean)
    assert rated["left"] == pytest.approx(rated["limit"] / mean - 1.0)
    assert checks["motor_speed"]["measured"] == pytest.approx(np.abs(table[:, 2]).max() * np.pi / 30.0)
    assert "winding_temperature" not in checks
    assert any("not in the log" in remark for remark in found["remarks"])
    assert found["explanations"] == []  # the spec is right


def test_a_log_without_any_figure_of_a_check_is_one_line(run: Any, cart: Path) -> None:
    Path("log.csv").write_text("time (s),position (rad)\n" + "".join(f"{n},{n * n}\n" for n in range(3)))
    status, _, err = run("compare", "log.csv", "--spec", cart, "--set", DRIVE)
    assert status == 2
    assert len(err.strip().splitlines()) == 1
