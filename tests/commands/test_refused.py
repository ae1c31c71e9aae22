"""Inputs with ordinary mistakes: each is one line that says where, and none takes long or holds anybody up."""

import os
import time
from pathlib import Path

import pytest
from refusals import refusal
from small_catalogue import CATALOGUE
from starters import STARTERS

from drivesizer.catalog import load
from drivesizer.errors import CatalogError, InputError
from drivesizer.files.yaml_source import YamlSource, read
from drivesizer.results.check_columns import at_most
from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec, read_spec

FLYWHEEL = (STARTERS / "flywheel.yaml").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("'\n", "f.yaml:1: not YAML: found unexpected end of stream while scanning a quoted scalar"),
        ('a: 1\nname: "my robot\nb: 2\nc: 3\n', "f.yaml:2: not YAML: found unexpected end of stream"),
        ("name: x\nselect: {catalogs: [maxon\n", "f.yaml:2: not YAML: did not find expected ',' or ']'"),
        ("name: x\nload: {kind: fan\n", "f.yaml:2: not YAML: did not find expected ',' or '}'"),
        ('"\\e[31mRED": 1\n', r"f.yaml:1: the character '\x1b' is not used here"),
        ('a: 1\nname: "\\e[2J"\n', r"f.yaml:2: the character '\x1b' is not used here"),
        ('name: "a\\Nb"\n', r"f.yaml:1: the character '\x85' is not used here"),
        ("name: a\u202eb\n", r"f.yaml:1: the character '\u202e' is not used here"),
        ('name: "a\\u2066b"\n', r"f.yaml:1: the character '\u2066' is not used here"),
    ],
)
def test_a_syntax_error_has_the_line_to_be_mended(text, said):
    line = refusal(lambda: YamlSource(text, "f.yaml"))
    assert line.startswith(said)
    assert line.isprintable()


def test_thousands_of_wrong_fields_are_refused_as_fast_as_one():
    """The time is the reading's alone; each fault on its own line was looked up in a reading of its own."""
    rows = "".join(f"    - {{time: 0.1, to: {n % 7} m/s}}\n" for n in range(3000))
    text = FLYWHEEL[: FLYWHEEL.index("motion:")] + f"motion:\n  profile: segments\n  segments:\n{rows}"
    start = time.process_time()
    source = YamlSource(text, "f.yaml")
    reading = time.process_time() - start
    with pytest.raises(InputError, match=r"\(and \d{4} more\)"):
        read_spec(source)
    assert time.process_time() - start < 12 * reading + 1.0


def test_millions_of_keys_are_refused_at_the_ten_thousandth(tmp_path):
    keys = "".join(f"k{n}: 1\n" for n in range(100_000))
    with pytest.raises(InputError, match=r"f\.yaml:10001: more than 10000 keys"):
        YamlSource(keys, "f.yaml")
    (tmp_path / "f.yaml").write_text("#" * 2_000_001)
    with pytest.raises(InputError, match="larger than 2 MB"):
        read(tmp_path / "f.yaml")


@pytest.mark.skipif(os.name == "nt", reason="no named pipes in folders")
def test_a_pipe_without_a_writer_holds_nobody_up(tmp_path):
    os.mkfifo(tmp_path / "robot.yaml")
    start = time.monotonic()
    with pytest.raises(InputError, match="nobody writes into it"):
        load_spec(tmp_path / "robot.yaml")
    assert time.monotonic() - start < 20.0


# --- figures that no machine has --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("was", "put", "said"),
    [
        ("9500, 37,", "9500, 1e300,", ": motors[1].rows[1][4]: no_load_current \"1e+300\" is no current of a machine"),
        ("398, 11,", "398, 5e-322,", ": motors[1].rows[1][14]: rotor_inertia \"5e-322\" is no"),
        ("398, 11,", "398, 0,", ': motors[1].rows[1][14]: rotor_inertia "0" is not above 0; expected g·cm² above 0, ~'),
        ("90, 60, 0.5", "0, 60, 0.5", ': gearheads[1].rows[1][7]: efficiency "0" is not above 0'),
        ("90, 60, 0.5", "900, 60, 0.5", ': gearheads[1].rows[1][7]: efficiency "900" is above 100 %'),
        ("14, 3, 12, 610", "0, 3, 12, 610", "thermal_resistance_housing \"0\" is not above 0"),
        ("diameter: 25 mm", "diameter: 1e300 mm", ".common.diameter: \"1e300 mm\" is no length of a machine"),
        ("sources: {s: {document: data sheet,", "sources: -1 #", ": sources: expected fields such as sheet"),
    ],
)  # fmt: skip
def test_a_catalogue_with_an_impossible_figure_is_refused_with_its_line(was, put, said, tmp_path):
    assert was in CATALOGUE
    text = CATALOGUE.replace(was, put, 1)
    line = text[: text.index(put)].count("\n") + 1
    (tmp_path / "own.yaml").write_text(text)
    told = refusal(lambda: load([str(tmp_path / "own.yaml")]), CatalogError)
    assert f"own.yaml:{line}: " in told
    assert said.removeprefix(": ") in told


def test_a_recording_with_an_impossible_figure_is_refused_with_its_line(tmp_path):
    from drivesizer.files.sheets import columns

    (tmp_path / "c.csv").write_text("time,speed\ns,rpm\n0,0\n1,1e300\n2,0\n")
    with pytest.raises(InputError, match=r'c.csv:4: speed: "1e\+300" is no rotary speed of a machine'):
        columns(tmp_path / "c.csv", {"time": "time", "speed": "rotary_speed"})


# --- searches at their ends -------------------------------------------------------------------------------------------


@pytest.fixture
def shelf(tmp_path) -> Path:
    """A folder with a small catalogue, and a fan that is sized out of it."""
    (tmp_path / "own.yaml").write_text(CATALOGUE)
    return tmp_path


def fan(folder: Path, **given: str) -> Path:
    text = (STARTERS / "fan.yaml").read_text(encoding="utf-8")
    text = text[: text.index("select:")] + "select: {catalogs: [own.yaml], objective: energy}\n"
    for was, put in given.items():
        text = text.replace(f"{was}: ", f"{was}: {put} #", 1)
    (folder / "robot.yaml").write_text(text)
    return folder / "robot.yaml"


def test_a_fan_too_heavy_for_every_motor_has_no_set(shelf):
    """25 N·m at 1800 rpm are 4.7 kW; the larger motor gives 0.4 N·m at 4600 rpm, 0.2 kW."""
    result = size(load_spec(fan(shelf, rated_torque="25 N*m")))
    assert not result.sets
    assert result.counts.considered > 0 and sum(result.counts.failed_by.values()) > 0


def test_what_grows_without_end_has_no_margin():
    check = at_most("supply_power", 1e-300, 1e300).at((), "physics")
    assert (check.status, check.margin) == ("pass", pytest.approx(float("nan"), nan_ok=True))
