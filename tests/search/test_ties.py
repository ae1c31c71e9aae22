"""Drives that are equally far from passing go by part number, wherever a catalogue lists them."""

from small_catalogue import CATALOGUE

from drivesizer.catalog import load
from drivesizer.files.yaml_source import YamlSource
from drivesizer.sizing import size
from drivesizer.spec.robot import read_spec

SPEC = """\
name: tied
load: {kind: flywheel, inertia: 80 kg*m^2}
motion: {speed: 600 rpm, acceleration_time: 0.5 s, cruise_time: 1 s, rest_time: 1 s}
supply: {nominal: 24 V}
"""
ROW, OTHER = (next(line for line in CATALOGUE.splitlines() if f"[{part}," in line) for part in ("m1", "m2"))


def test_the_order_of_rows_does_not_choose_the_closest_rejected(tmp_path, monkeypatch):
    """Fifty motors alike: more than the search keeps of those that are equally far from passing."""
    monkeypatch.setattr("drivesizer.sizing.relaxations", lambda *_: ())
    monkeypatch.setattr("drivesizer.sizing.changes_for", lambda *_: ())
    rows = [ROW.replace("m1", f"p{number}") for number in range(10, 60)]
    closest = []
    for name, some in {"there": rows, "back": rows[::-1]}.items():
        path = tmp_path / f"{name}.yaml"
        path.write_text(CATALOGUE.replace(OTHER + "\n", "").replace(ROW, "\n".join(some)), encoding="utf-8")
        spec = read_spec(YamlSource(f"{SPEC}select: {{catalogs: [{path}]}}\n", str(tmp_path / "robot.yaml")))
        result = size(spec, catalog=load([str(path)]), top=3)
        assert not result.sets
        closest.append([(one.motor.part, one.gearhead.part) for one in result.misses])
    assert closest[0] == closest[1]
    assert closest[0][0][0] == "p10"
