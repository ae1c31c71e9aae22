"""Wrong specs as people write them: every fault of a file at once, each with its line and its cure."""

import re

import pytest
from typer.testing import CliRunner

from drivesizer.cli import app
from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource, shipped_data
from drivesizer.search.shortlist import load_parts
from drivesizer.sizing import size
from drivesizer.spec import messages
from drivesizer.spec.robot import RobotSpec, read_spec

SPEC = """name: cart
load:
  kind: wheeled_vehicle
  mass: 30 kg
  driven_wheels: 2
  wheel_diameter: 150 mm
  rolling_resistance: 2 %
  inertia: 1 kg*cm^2
motion:
  speed: 0.5 m/s
  acceleration_time: 1 s
  cruise_time: 10 s
transmission:
  - kind: gearhead
supply: {nominal: 24 V, current: 20 A}
select: {catalogs: [maxon], gearhead: {family: GPX 22 HP}}
"""


def lines(*changes):
    """The messages for the spec with some of its text changed."""
    text = SPEC
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    with pytest.raises(InputError) as caught:
        load_parts(read_spec(YamlSource(text, "robot.yaml")))
    assert all("\n" not in line for line in (str(caught.value), *caught.value.lines))
    return caught.value.lines


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("  - kind: gearhead", "  []", r"^robot.yaml:1[34]: transmission: .*at least 1, e.g. \[\{kind: gearhead"),
        ("  mass", "   mass", "^robot.yaml:4: .*indented by 3 blanks, deeper than the line above"),
        ("  speed", "speed", "^robot.yaml:11: .*indented by 2 blanks, deeper than the line above"),
        ("  driven", " driven", "^robot.yaml:5: .*indented by 1 blank, less deep than"),
        ("name: cart", "name: my: cart", "^robot.yaml:1: .*needs quotes"),
        ("name: cart", "name cart", "^robot.yaml:2: .*line above has no colon"),
        ("30 kg", "20 kg .. 30 kg", r'^robot.yaml:4: load.mass: "20 kg .. 30 kg" is a range; its usual figure'),
        ("30 kg", "20-30 kg", r'^robot.yaml:4: load.mass: "20-30 kg" is a range; its usual figure'),
        ("30 kg", "20 to 30 kg", r'^robot.yaml:4: load.mass: "20 to 30 kg" is a range; its usual figure'),
        ("30 kg", "[20 kg, 30 kg]", "^robot.yaml:4: load.mass: a list is not a quantity; expected mass, e.g. 45 kg$"),
        ("mass: 30 kg", "mass:", "^robot.yaml:4: load.mass: is empty; expected mass, e.g. 45 kg$"),
        ("supply:", "power:", r'^robot.yaml:15: power: unknown key; did you mean "supply"\?$'),
        ("motion:", "movement:", r'^robot.yaml:9: movement: unknown key; did you mean "motion"\?$'),
        ("load:", "machine:", r'^robot.yaml:2: machine: unknown key; did you mean "load"\?$'),
        ("transmission:", "gearbox:", r'^robot.yaml:13: gearbox: unknown key; did you mean "transmission"\?$'),
        ("[maxon]", "[maxxon]", r'^robot.yaml:16: select.catalogs: .*"maxxon"; the nearest is maxon'),
        ("  speed: 0.5 m/s", "  stroke: 2 m", r'^robot.yaml:10: motion.stroke: .*did you mean "distance"'),
        ("  rolling_resistance", "  drum_diameter", r"^robot.yaml:7: load.drum_diameter: .*kind: conveyor or hoist"),
        ("{nominal:", "{voltage:", r'^robot.yaml:15: supply.voltage: unknown key; did you mean "nominal"\?$'),
        ("name: cart", "ambient: 40 degC", r"^robot.yaml:1: ambient: unknown key; expected environment.ambient"),
        ("name: cart", "temperature: 40 degC", "expected margins.temperature or environment.ambient"),
        ("  cruise_time: 10 s", "", "^robot.yaml:9: motion: give cruise_time or distance$"),
        ("  cruise_time: 10 s", "  distance: 2 m\n  cruise_time: 1 s", "motion: give cruise_time or distance, not"),
        ("  cruise_time: 10 s", "  acceleration: 1 m/s^2", "motion: give acceleration_time or acceleration, not both"),
        ("  cruise_time: 10 s", "  dwell: 2 s", r'^robot.yaml:12: motion.dwell: .*did you mean "rest_time"'),
    ],
)  # fmt: skip
def test_the_line_and_the_cure(old, new, said):
    assert re.search(said, lines((old, new))[0])


def test_all_faults_at_once_in_the_order_of_the_file():
    found = lines(("30 kg", "30"), ("150 mm", "150 s"), ("24 V", "24"))
    assert [line.split(": ")[0] for line in found] == ["robot.yaml:4", "robot.yaml:6", "robot.yaml:15"]


def test_five_at_most_and_the_number_of_the_others():
    found = lines(
        ("30 kg", "1"),
        (" 2\n", " two\n"),
        ("150 mm", "1"),
        ("2 %", "x"),
        ("0.5 m/s", "1"),
        ("10 s", "1"),
        ("24 V", "1"),
    )
    assert len(found) == 5 and found[-1].endswith(" (and 2 more)")


def test_other_words_stand_for_keys_that_exist():
    """A field that is renamed must be renamed among the words that propose it."""
    known = {name for one in _sections(RobotSpec) for name in one.model_fields}
    others = shipped_data("drivesizer.spec", "other_words.yaml")
    assert {word for words in others.values() for word in words} <= known
    assert not any(word in words for word, words in others.items())


def _sections(model, seen=None):
    """A model and all models of its fields."""
    seen = {model} if seen is None else seen | {model}
    inner = {one for field in model.model_fields.values() for one in messages.models_of(field)}
    return seen.union(*(_sections(one, seen) for one in inner - seen))


def test_the_format_of_a_simulator_is_named_by_the_simulator(tmp_path):
    file = tmp_path / "robot.yaml"
    file.write_text(SPEC, encoding="utf-8")
    found = CliRunner().invoke(app, ["export", str(file), "--format", "mujoco", "-o", str(tmp_path / "a.xml")])
    assert "MuJoCo reads mjcf" in str(found.exception)


def test_what_unknown_reject_leaves_out_is_counted():
    """Against the same search that allows them: those with an unknown check that nothing rejects."""
    free = read_spec(
        YamlSource(
            SPEC.replace("{family: GPX 22 HP}", "{family: GP 26 A}, motor: {family: [RE 25, A-max 26]}"), "robot.yaml"
        )
    )
    strict = free.model_copy(update={"select": free.select.model_copy(update={"unknown": "reject"})})
    allowed, rejected = size(free, top=1000), size(strict, top=1)
    unknown = sum(one.status == "unknown" for one in allowed.sets)
    assert len(allowed.sets) == allowed.counts.feasible
    assert unknown and (rejected.counts.left_out, allowed.counts.left_out) == (unknown, 0)
    assert rejected.counts.feasible == allowed.counts.feasible - unknown


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("30 kg", "30,5 kg",
         'robot.yaml:4: load.mass: "30,5 kg" has a comma in its number; write a decimal point: 30.5 kg'),
        ("30 kg", "1.030,5 kg", "write a decimal point: 1030.5 kg; expected mass"),
        ("30 kg", "1,030 kg", "write a decimal point: 1.030 kg, or 1030 kg; expected mass"),
        ("  - kind: gearhead", "  - {kind: gearhead, ratio: 27}",
         "robot.yaml:14: transmission[1].ratio: unknown key; it belongs to kind: belt or gear or"),
        ("  - kind: gearhead", '  - {kind: belt, ratio: "1:3", efficiency: 90 %}',
         'transmission[1].ratio: "1:3": write the quotient, 0.333333; expected plain number'),
        ("  - kind: gearhead", "  - {kind: belt, ratio: 3, efficiency: 95}",
         'transmission[1].efficiency: "95" must be at most 1, e.g. 0.95 or 95 %'),
        ("rolling_resistance: 2 %", "rolling_resistance: 2",
         'robot.yaml:7: load.rolling_resistance: "2" must be at most 1, e.g. 0.02 or 2 %'),
        ("30 kg", "30 kg\n  radius: 80 mm", 'robot.yaml:5: load.radius: unknown key; did you mean "wheel_diameter"?'),
        ("wheeled_vehicle", "vehicle", 'load.kind: "vehicle" is not known; the nearest is wheeled_vehicle; expected '),
        ("wheeled_vehicle", "car", "load.kind: \"car\" is not known; expected 'wheeled_vehicle', "),
        ("{nominal: 24 V, current: 20 A}", "{nominal: 24 V, min: 26 V}",
         'robot.yaml:15: supply: "min 26 V, nominal 24 V": expected min <= nominal <= max'),
        ("driven_wheels: 2", "driven_wheels: 2.5", '"2.5" is not a whole number; expected one, e.g. 2'),
        ("[maxon]", "[nowhere.yaml]", "robot.yaml:16: select.catalogs: nowhere.yaml: cannot be read (no such file"),
        ("{nominal: 24 V, current: 20 A}", "{nominal: 24 V, current: 3,6 A}",
         "robot.yaml:15: supply.6 A: unknown key; a comma ends a field between { and }; "),
        ("  mass: 30 kg", "  mass 30 kg", "robot.yaml:4: not YAML: could not find expected ':' behind a field's name"),
        ("current: 20 A}", "current: 20 A", "; the bracket of line 15 is not closed"),
    ],
)  # fmt: skip
def test_what_buyers_write(old, new, said):
    assert said in lines((old, new))[0]


def test_a_field_that_others_contradict_is_named_with_its_line():
    arm = SPEC[: SPEC.index("  mass")].replace("wheeled_vehicle", "arm")
    text = f"{arm}  mass: 3.2 kg\n  length: 260 mm\n  inertia: 0.09 kg*m^2\n{SPEC[SPEC.index('motion') :]}"
    with pytest.raises(InputError) as caught:
        read_spec(YamlSource(text.replace("0.5 m/s", "30 rpm"), "robot.yaml"))
    said = 'robot.yaml:6: load.inertia: "0.09 kg*m^2": inertia must be at least mass times length squared, 0.2163 kg·m²'
    assert list(caught.value.lines) == [said]


def test_a_limit_of_an_angle_is_in_degrees():
    found = lines(("  inertia", "  slope: 91 deg\n  inertia"))
    assert 'load.slope: "91 deg" must be at most 60 deg, e.g. 2 deg' in found[0]
