"""``--set FIELD=VALUE``: the answer is that of a file with the value in it, and so is what is said of a wrong one."""

import json
from pathlib import Path

import pytest

MISSION = "\nmission: {duration: 3 h}\nsupply"
WRONG = [
    ("load.mass=4OO kg", ' load.mass: "4OO kg": "OO kg" is not a unit of mass; expected mass, e.g. 45 kg'),
    ("load.wheels=2", ' load.wheels: unknown key; did you mean "driven_wheels"?'),
    ("needs.brake=true", ' needs.brake: unknown key; did you mean "hold_unpowered"?'),
    (
        "load.mass=1'000 kg",
        ' load.mass: "1\'000 kg" has a separator in its number; write it without: 1000 kg; expected',
    ),
    ("select.motor.maker=nobody", ' select.motor.maker: "nobody" is in no catalogue that the spec names'),
    ("transmission[3].ratio=2", "--set: transmission[3].ratio: entry 3 does not exist, there are "),
    ("load.mass", '--set: "load.mass" is no field with its value; expected e.g. load.mass=400kg'),
    ("118752/406764", '--set: "118752/406764" is no field with its value; expected e.g. load.mass=400kg'),
]


def test_the_answer_is_that_of_a_file_with_the_values(run, example, tmp_path):
    text, other = Path(example).read_text(encoding="utf-8"), tmp_path / "robot.yaml"
    assert "mass: 45 kg" in text and "\nsupply" in text
    (tmp_path / "spec.yaml").write_text(text, encoding="utf-8")
    other.write_text(text.replace("mass: 45 kg", "mass: 40kg").replace("\nsupply", MISSION),
                     encoding="utf-8")  # fmt: skip
    fields = ("--set", "load.mass=40kg", "--set", "mission.duration=3 h")
    found, expected = (json.loads(run("size", *words, "--json")[1])
                       for words in ((tmp_path / "spec.yaml", *fields), (other,)))  # fmt: skip
    assert found["axes"][0]["result"]["sets"] == expected["axes"][0]["result"]["sets"]


@pytest.mark.parametrize(("word", "said"), WRONG)
def test_a_wrong_one_is_a_line_as_of_the_file(run, example, word, said):
    status, out, err = run("size", example, "--set", word)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert said in err


def test_a_field_stands_beside_a_drive(run, example):
    parts = ("--set", "118752/406764")
    light, heavy = (json.loads(run("validate", example, *parts, "--set", f"load.mass={mass}", "--json")[1])
                    for mass in ("20 kg", "45 kg"))  # fmt: skip
    assert light != heavy
