"""machine.yaml: sections of the machine under those of its axes, and what is refused with its line."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from refusals import refusal

from drivesizer.errors import InputError
from drivesizer.spec.machine import carrying, load_any, load_machine
from drivesizer.spec.robot import load_spec

TEXT = """\
name: cell
supply: {nominal: 48 V, max: 50 V}
environment: {ambient: 30 degC}
margins: {torque: 10 %}
axes:
  bridge:
    load: {kind: belt_axis, mass: 12 kg, pulley_diameter: 40 mm}
    motion: {speed: 1 m/s, acceleration_time: 0.3 s, cruise_time: 0.5 s}
    carries: [lift]
    environment: {altitude: 2000 m}
  lift:
    load: {kind: rack_pinion, mass: 3 kg, pinion_diameter: 30 mm}
    motion: {speed: 0.5 m/s, acceleration_time: 0.2 s, cruise_time: 0.4 s}
    start: 0.5 s
"""


def written(folder: Path, *changes: tuple[str, str]) -> Path:
    text = TEXT
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / "cell.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_sections_of_an_axis_stand_field_by_field_over_the_machine_s(tmp_path: Path) -> None:
    machine = load_machine(written(tmp_path))
    bridge, lift = (machine.axis(name).spec for name in ("bridge", "lift"))
    assert bridge.environment.ambient == lift.environment.ambient == pytest.approx(303.15)
    assert (bridge.environment.altitude, lift.environment.altitude) == (2000.0, 0.0)
    assert bridge.margins.torque == 0.1 and bridge.supply.highest == 50.0 and bridge.name == "bridge"
    assert machine.order == ("lift", "bridge") and machine.axis("lift").start == 0.5


def test_a_field_keeps_its_line_wherever_it_stands(tmp_path: Path) -> None:
    bridge = load_machine(written(tmp_path)).axis("bridge").spec
    assert bridge.where(("load", "mass")).endswith("cell.yaml:7: axes.bridge.load.mass")
    assert bridge.where(("environment", "altitude")).endswith("cell.yaml:10: axes.bridge.environment.altitude")
    assert bridge.where(("environment", "ambient")).endswith("cell.yaml:3: environment.ambient")


def test_a_plain_spec_is_a_machine_of_one_axis(tmp_path: Path) -> None:
    assert load_any(written(tmp_path)).is_several
    one = tmp_path / "one.yaml"
    one.write_text("name: a\nsupply: {nominal: 24 V}\nload: {kind: flywheel, inertia: 1 kg*m^2}\n"
                   "motion: {speed: 60 rpm, acceleration_time: 1 s, cruise_time: 1 s}\n", encoding="utf-8")  # fmt: skip
    machine = load_any(one)
    assert not machine.is_several and [axis.name for axis in machine.axes] == ["a"] == [*machine.order]
    assert machine.entered == machine.axes[0].spec.entered == load_spec(one).entered


@pytest.mark.parametrize(
    ("old", "new", "line", "said"),
    [
        ("carries: [lift]", "carries: [lifd]", 9, 'axes.bridge.carries: there is no axis "lifd"; the nearest is lift'),
        ("carries: [lift]", "carries: 3", 9, "expected names of axes"),
        ("carries: [lift]", "carries: {lift: {at: 1 m}}", 9, "a belt_axis moves along a line"),
        ("start: 0.5 s", "carries: [bridge]", 14, "no order to size them in"),
        ("carries: [lift]", "carries: [lift, lift]", 9, 'axes.bridge.carries: "lift" is there twice'),
        ("start: 0.5 s", "start: 0.5", 14, 'axes.lift.start: "0.5" has no unit'),
        ("start: 0.5 s", "strat: 0.5 s", 14, "axes.lift.strat: unknown key; the nearest are start"),
        ("12 kg", "12 kgg", 7, 'axes.bridge.load.mass: "12 kgg"'),
        ("30 degC", "30 K/W", 3, "environment.ambient"),
        ("  lift:", '  "a/b":', 11, '"a/b" names no axis'),
        ("start: 0.5 s", "battery: {part: x}", 14, "it is of the machine"),
        ("margins: {", "timing: never\nmargins: {", 4, '"never" is not known'),
        ("margins: {", "margin: {", 4, "unknown key; the nearest"),
        ("    load: {kind: rack_pinion, mass: 3 kg, pinion_diameter: 30 mm}\n", "", 11, "axes.lift.load: is missing"),
    ],
)  # fmt: skip
def test_faults_are_one_line_with_their_place(old: str, new: str, line: int, said: str, tmp_path: Path) -> None:
    text = refusal(lambda: load_machine(written(tmp_path, (old, new))))
    assert f"cell.yaml:{line}: " in text and said in text, text


def test_a_drive_on_an_arm_is_a_point_mass_at_its_place() -> None:
    load = load_spec({
        "name": "arm", "supply": {"nominal": "24 V"}, "motion": {"profile": "hold", "time": "1 s"},
        "load": {"kind": "arm", "mass": "4 kg", "length": "0.5 m", "inertia": "1.2 kg*m^2"},
    }).load  # fmt: skip
    laden = carrying(load, [(1.0, 0.9), (0.5, 0.2)])
    assert laden.mass == 5.5
    assert laden.mass * laden.length == pytest.approx(4 * 0.5 + 0.9 + 0.1)
    assert laden.inertia == pytest.approx(1.2 + 0.81 + 0.02)
    assert carrying(load, [(0.0, 1.0)]) is load


def test_a_drive_on_a_balanced_table_unbalances_it() -> None:
    load = load_spec({
        "name": "table", "supply": {"nominal": "24 V"}, "motion": {"profile": "hold", "time": "1 s"},
        "load": {"kind": "rotary_table", "inertia": "0.5 kg*m^2", "tilt": "90 deg"},
    }).load  # fmt: skip
    laden = carrying(load, [(2.0, 0.3)])
    assert laden.lever.moment(9.81) == pytest.approx(2.0 * 9.81 * 0.3)
    assert laden.inertia == pytest.approx(0.5 + 2.0 * 0.09) and not math.isclose(load.inertia, laden.inertia)


def test_figures_of_an_axis_keep_their_tolerances():
    """Of the axis that has them, and of all where they are at the top of the file."""
    axes = {name: {"load": {"kind": "belt_axis", "mass": "5 kg", "pulley_diameter": "20 mm"}} for name in "xy"}
    axes["x"]["load"]["mass"] = "5 kg ± 10 %"
    axes["y"]["start"] = "1 s ± 10 ms"
    motion = {"speed": "0.5 m/s ± 5 %", "acceleration_time": "1 s", "cruise_time": "1 s"}
    machine = load_machine({"name": "cell", "supply": {"nominal": "48 V"}, "motion": motion, "axes": axes})
    paths = [[one.path for one in axis.spec.toleranced] for axis in machine.axes]
    assert [set(some) for some in paths] == [{("load", "mass"), ("motion", "speed")}, {("motion", "speed")}]
    assert machine.axis("x").spec.load.mass == 5.0 and machine.axis("y").start == 1.0
    axes["x"]["load"]["mass"] = "5 kg ± 6 kg"
    with pytest.raises(InputError, match=r'machine: axes\.x\.load\.mass: "5 kg ± 6 kg" is -1 kg at its lowest'):
        load_machine({"name": "cell", "supply": {"nominal": "48 V"}, "motion": motion, "axes": axes})
