"""Command lines that cannot be parsed: one line in the words of all refusals, with what is expected and an example."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from small_catalogue import CATALOGUE

# the command line, the beginning of what is said of it, and the end
SAID = [
    ("size --top x", '--top: "x" is not a whole number; expected 1 to 1000, e.g. 3', ""),
    ("size --top 0", '--top: "0" is out of range; expected 1 to 1000, e.g. 3', ""),
    ("size --top 1e3", '--top: "1e3" is not a whole number; expected 1 to 1000', ""),
    ("size --samples x", '--samples: "x" is not a whole number; expected e.g. 2000', ""),
    ("size --confidence x", '--confidence: "x" is not a number; expected e.g. 0.95', ""),
    ("validate --all --top 101", '--top: "101" is out of range; expected 1 to 100, e.g. 5', ""),
    ("study --processes -1", '--processes: "-1" is out of range; expected 0 to 1024, e.g. 2', ""),
    ("serve --port 65536", '--port: "65536" is out of range; expected 0 to 65535, e.g. 8000', ""),
    ("catalog list --limit 0", '--limit: "0" is out of range; expected 1 or more, e.g. 100', ""),
    ("predict 1 --minutes x", '--minutes: "x" is not a number; expected e.g. 60', ""),
    ("drive --failed x", '--failed: "x" is not a whole number; expected e.g. 2', ""),
    ("size --top", "size: --top has no value; expected one behind it, e.g. `drivesizer size ", "--objective price`"),
    ("size --json=3", "size: --json takes no value; expected --json alone, e.g. `drivesizer size ", "price`"),
    ("study --no-maps=3", "study: --no-maps takes no value; expected --no-maps alone, ", "study examples/study.yaml`"),
    ("init --king hoist", 'init: "--king" is no option; expected --kind, --output, ', "-o robot.yaml`"),
    ("init --king hoist", 'init: "--king" is no option; ', "; the nearest are --kind, --joint, e.g. `drivesizer init "
     "--kind wheeled_vehicle -o robot.yaml`"),
    ("serve -p 1", 'serve: "-p" is no option; expected --port, --browser, --no-browser', "serve robot.yaml`"),
    ("doctor x", 'doctor: "x" is more than it takes; expected no argument, ', "`drivesizer doctor`"),
    ("size a b c", 'size: "b c" is more than it takes; expected ROBOT.YAML, e.g. `drivesizer size ', "price`"),
    ("predict", "predict: MOTOR is missing; expected one, e.g. `drivesizer predict 118752 ", "`"),
    ("explain", "explain: --motor is missing; expected --motor with its value, e.g. `drivesizer explain ", "`"),
    ("sise", '"sise" is no command; expected init, size, ', "; the nearest is size, e.g. `drivesizer --help`"),
    ("catalog foo", 'catalog: "foo" is no command; expected list, show, ', "e.g. `drivesizer catalog --help`"),
    ("--foo size", '"--foo" is no option; expected --version, ', "e.g. `drivesizer --help`"),
]  # fmt: skip


@pytest.mark.parametrize(("words", "begins", "ends"), SAID)
def test_a_command_line_that_cannot_be_parsed_is_one_line(run, words, begins, ends, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    status, out, err = run(*words.split())
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert err.startswith(f"drivesizer: {begins}")
    assert err.endswith(f"{ends}\n")
    assert "; expected " in err and "e.g. " in err


def test_what_a_terminal_obeys_is_written_out(run):
    status, _, err = run("size", "--\x1b[31m")
    assert status == 2 and r'size: "--\x1b[31m" is no option; expected --top' in err


def test_numbers_are_read_as_they_are_typed(run, example):
    """Spaces and leading zeros as Python takes them; a number beyond its digits is refused like any text."""
    assert run("size", example, "-q", "--top", " 02 ")[0] == 0
    assert run("size", example, "--top", "9" * 5000)[0] == 2


def test_a_catalogue_of_the_command_line_is_no_fault_of_the_spec(run, example, tmp_path, monkeypatch):
    """An unknown one was said to be in a line of the spec; the spec's own file once more, to be another of its name."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own.yaml").write_text(CATALOGUE)
    (tmp_path / "robot.yaml").write_text(example.read_text().replace("catalogs: [maxon]", "catalogs: [own.yaml]"))
    assert run("size", "--catalog", "nope")[2].startswith('drivesizer: --catalog: no catalogue is called "nope"; ')
    assert run("size", "--catalog", "own.yaml")[1:] == run("size")[1:]


def test_where_no_drive_is_found_all_catalogues_are_named(run, example):
    """Nothing said that there are more catalogues than the one that a spec names."""
    said = "size robot.yaml --catalog all"
    assert said not in run("size", example)[1]
    assert said in run("size", example, "--set", "load.mass=9 t")[1].replace(str(example), "robot.yaml")


@pytest.mark.parametrize("words", [[], ["catalog"]])
@pytest.mark.skipif(os.name == "nt", reason="no such device")
def test_help_without_words_whose_reader_is_gone(words):
    """Both ended in a traceback: the help was printed where failures are already dealt with."""
    command = [sys.executable, "-m", "drivesizer", *words]
    with open(os.devnull, "rb") as nothing, subprocess.Popen(  # noqa: PTH123
        command, stdin=nothing, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:  # fmt: skip
        process.stdout.close()
        assert (process.wait(60), process.stderr.read()) == (0, b"")
    with open("/dev/full", "wb") as full:  # noqa: PTH123
        found = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, check=False)
    assert found.returncode == 2
    assert found.stderr == b"drivesizer: the output cannot be written (no space left on device)\n"


@pytest.mark.parametrize(
    "words", [["SPEC", "--profile"], ["--profile", "SPEC"], ["SPEC", "--profile", "--set", "118752/406764"]]
)
def test_a_profile_without_a_value_is_the_spec_s_own(run, example, words):
    """As one types it who has the paper's trapezoid in the spec; it ended in "--profile has no value"."""
    words = [str(example) if word == "SPEC" else word for word in words]
    found = run("validate", *words)
    assert found == run("validate", *(word for word in words if word != "--profile"))
    assert "PID and DC motor by python-control, beside the engine" in found[1]


# --- fields at the command line

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
