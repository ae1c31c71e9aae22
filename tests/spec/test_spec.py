"""robot.yaml: what is right is read to SI, what is wrong is one line with file, line, field and a way out."""

import pytest
from refusals import refusal

from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.spec.robot import RobotSpec, load_spec, read_spec


def read(text):
    return read_spec(YamlSource(text, "robot.yaml"))


def test_the_example_in_si(spec):
    assert spec.load.wheel_diameter == pytest.approx(0.1524)
    assert spec.load.cylinders.wheel.width == pytest.approx(0.05)
    assert spec.environment.ambient == pytest.approx(298.15)
    assert spec.supply.lowest == 22.0
    assert spec.belt_ratios == [1.1]
    assert spec.entered["load"]["mass"] == "45 kg"


# edit of the example, line that is named, words that the message must hold
WRONG = [
    ("mass: 45 kg", "mass: 45", ":10:", ["load.mass", '"45"', "unit", "45 kg"]),
    ("mass: 45 kg", "mas: 45 kg", ":10:", ["load.mas", "unknown key", '"mass"']),
    ("mass: 45 kg", "mass: -45 kg", ":10:", ["above 0 kg", '"-45 kg"']),
    ("mass: 45 kg", "mass: 0 kg", ":10:", ["above 0 kg"]),
    ("mass: 45 kg", "mass: .inf", ":10:", ["load.mass"]),
    ("mass: 45 kg", "mass: [45 kg]", ":10:", ["load.mass"]),
    ("  mass: 45 kg", "  #", ":8:", ["load.mass", "missing", "e.g. 45 kg"]),
    ("speed: 1.5 m/s", "speed: 1,5 m/s", ":29:", ["comma"]),
    ("speed: 1.5 m/s", "speed: 1.5 m", ":29:", ["unit of length", "speed"]),
    ("speed: 1.5 m/s", "speed: 60 rpm", ":29:", ["rotary speed"]),
    ("driven_wheels: 4", "driven_wheels: 4.5", ":11:", ["whole number"]),
    ("driven_wheels: 4", "driven_wheels: 0", ":11:", ["must be at least 1"]),
    ("driven_wheels: 4", "driven_wheels: true", ":11:", ["whole number"]),
    ("rolling_resistance: 0.02", "rolling_resistance: 0.02\n  sinkage: 1 mm", ":8:", ["exactly one", "both"]),
    ("  rolling_resistance: 0.02", "  #", ":8:", ["rolling_resistance or sinkage", "neither"]),
    ("  rolling_resistance: 0.02", "  sinkage: 2 m #", ":13:", ["sinkage must be below"]),
    ("  cylinders:", "  inertia: 1 kg*cm^2\n  cylinders:", ":8:", ["inertia", "both"]),
    ("inner_diameter: 60 mm", "inner_diameter: 600 mm", ":20:", ["below outer_diameter"]),
    ("kind: belt", "kind: rope", ":36:", ["rope", "belt"]),
    ("  - kind: belt", "  - knd: belt", ":36:", ["kind is missing"]),
    ("    efficiency: 0.95", "    efficiency: 95", ":38:", ["at most 1"]),
    ("ratio: 1.1 ", "ratio: 1.1\n    ratios: [1.1, 2] ", ":36:", ["ratio or ratios", "both"]),
    ("ratio: 1.1 ", "ratios: [] ", ":37:", ["ratios"]),
    ("confidence: 0.9 ", "confidence: 1.9 ", ":45:", ["at most 1"]),
    ("min: 22 V", "min: 25 V", ":48:", ["min <= nominal <= max"]),
    ("kind: wheeled_vehicle", "kind: boat", ":9:", ["boat", "wheeled_vehicle", "hoist"]),
    ("method: paper", "method: guess", ":6:", ["guess", "paper"]),
    ("objective: mass", "objective: weight", ":113:", ["weight", "mass"]),
    ("objective: mass", "objektive: mass", ":113:", ["objective"]),
    ("name: SPS surveillance robot", "name:", ":5:", ["text"]),
    ("supply:", "supply: 5\nsuply:", ":49:", ["suply", '"supply"']),
    ("load:\n", "load: 5\nload2:\n", ":9:", ["load2"]),
    ("  - kind: gearhead", "  - kind: belt\n    ratio: 2\n    efficiency: 0.9", "robot.yaml", ["gearhead"]),
    ("catalogs: [maxon]", "catalogs: []", ":108:", ["expected at least 1"]),
    ("family: GP 26 A", "family: []", ":110:", ["expected at least 1"]),
    ("slope: 0 deg", "slope: 80 deg", ":15:", ["at most"]),
]


@pytest.mark.parametrize(("old", "new", "line", "words"), WRONG, ids=lambda v: str(v)[:30])
def test_wrong_spec_is_one_line(example_text, old, new, line, words):
    assert old in example_text
    message = refusal(lambda: read(example_text.replace(old, new, 1)))
    assert message.startswith("robot.yaml")
    assert line in message
    for word in words:
        assert word in message


@pytest.mark.parametrize("text", ["", "[]", "just text", "5", "name: x"])
def test_what_is_no_spec_at_all(text):
    with pytest.raises(InputError, match=r"robot\.yaml"):
        read(text)


def test_the_line_is_right_behind_comments_and_quotes(example_text):
    text = "# a comment\n\n" + example_text.replace("mass: 45 kg", 'mass: "45 kgs"')
    with pytest.raises(InputError, match=r"robot\.yaml:12: load\.mass"):
        read(text)


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        load_spec(tmp_path / "nothing.yaml")
    with pytest.raises(InputError, match="cannot be read"):
        load_spec(tmp_path)


def test_bytes_that_are_no_text(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_bytes(b"name: x\nload: \xff\xfe\n")
    with pytest.raises(InputError, match=r":2: the file is not UTF-8"):
        load_spec(path)


def test_schema_knows_every_field():
    schema = RobotSpec.model_json_schema()
    assert set(schema["properties"]) == set(RobotSpec.model_fields)
    assert schema["additionalProperties"] is False
    assert schema["$defs"]["WheeledVehicle"]["properties"]["mass"]["examples"] == ["45 kg"]


def test_the_starter_is_a_good_spec():
    from importlib import resources

    starters = (resources.files("drivesizer.spec") / "starters").iterdir()
    for entry in (one for one in starters if one.is_file()):  # machines are read in tests/commands
        read_spec(YamlSource(entry.read_text(encoding="utf-8"), entry.name))


HOIST = """
name: a hoist
load: {kind: hoist, mass: 10 kg, drum_diameter: 80 mm}
motion: {speed: 0.3 m/s, acceleration_time: 0.4 s, cruise_time: 2 s}
supply: {nominal: 24 V}
cases:
  - {name: heavy, load: {mass: 12 kg}}
  - {name: slow, motion: {profile: triangle, distance: 600 mm, time: 5 s}, environment: {ambient: 40 degC}}
"""


def test_cases_change_what_they_name_and_nothing_else():
    spec = read(HOIST)
    (_, base), (first, heavy), (second, slow) = spec.load_cases
    assert (first, second) == ("heavy", "slow")
    assert (base.load.mass, heavy.load.mass, slow.load.mass) == (10.0, 12.0, 10.0)
    assert heavy.load.drum_diameter == base.load.drum_diameter == 0.08
    assert slow.motion.profile == "triangle" and heavy.motion == base.motion
    assert slow.environment.ambient == pytest.approx(313.15)


@pytest.mark.parametrize(("old", "new", "line", "words"), [
    ("load: {mass: 12 kg}", "load: {mas: 12 kg}", ":7: cases[1].load.mas", ["unknown key", '"mass"']),
    ("load: {mass: 12 kg}", "load: {mass: -12 kg}", ":7: cases[1].load.mass", ["above 0 kg"]),
    ("distance: 600 mm", "distance: 60 deg", ":8: cases[2].motion.distance", ["angle", "length"]),
    ("name: slow", "name: heavy", ":6: cases", ["names of their own"]),
    ("name: slow", "nam: slow", ":8: cases[2].nam", ["unknown key"]),
    ("load: {mass: 12 kg}", "load: [12 kg]", ":7: cases[1].load", ["group of fields"]),
    ("speed: 0.3 m/s", "speed: 30 rpm", ":4: motion.speed", ["rotary speed"]),
    ("motion: {speed", "motion: {profile: s_curv, speed", ":4: motion.profile", ["s_curv", "s_curve"]),
    ("name: a hoist", "name: a hoist\nmethod: paper", ":3: method", ["wheeled_vehicle", "physics"]),
    ("motion: {speed: 0.3 m/s, acceleration_time: 0.4 s, cruise_time: 2 s}", "", "robot.yaml: motion", ["is missing"]),
])  # fmt: skip
def test_wrong_loads_motions_and_cases_are_one_line(old, new, line, words):
    assert old in HOIST
    message = refusal(lambda: read(HOIST.replace(old, new, 1)))
    assert line in message
    for word in words:
        assert word in message
