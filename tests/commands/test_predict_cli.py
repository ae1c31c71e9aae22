"""``drivesizer predict`` at the command line."""

from __future__ import annotations

import json

import jsonschema
import pytest

from drivesizer.catalog.tolerances import resistance_from_stall

SET = ("DCX22S01EBKL598", "--gearhead", "GPX22HPKLSL44D0CPLW", "--catalog", "maxon")


@pytest.mark.parametrize(
    "words",
    [SET, ("XL330-M288-T 5 V", "--catalog", "robotis", "--load", "0.1 N*m", "--warm", "50 degC"),
     ("118752", "--catalog", "maxon", "--controller", "438725", "--inertia", "3 kg*cm^2")],
)  # fmt: skip
def test_json_is_of_the_printed_schema(words, run):
    status, out, err = run("predict", *words, "--json")
    document = json.loads(out)
    jsonschema.validate(document, json.loads(run("schema", "prediction")[1]))
    assert (status, err) == (0, "".join(f"note: {text}\n" for text in document["warnings"]) * 0)
    for one in document["figures"]:
        assert (one["band"]["nominal"] is None) <= (bool(one["missing"]) or one["never"] is not None)


def test_text_names_conditions_bands_and_what_is_missing(run):
    status, out, _ = run("predict", "XL330-M288-T 5 V", "--catalog", "robotis", "--voltage", "4.5 V")
    assert status == 0 and "4.5 V, 25 °C" in out and "5 %" in out
    assert "missing: " in out
    assert f"resistance, from no load and stall {resistance_from_stall().text};" in " ".join(out.split())


@pytest.mark.slow
@pytest.mark.parametrize("form", ["svg", "png"])
def test_figure_is_drawn(form, run, tmp_path):
    target = tmp_path / f"bench.{form}"
    status, _, err = run("predict", *SET, "--figure", target)
    assert (status, err) == (0, f"{target} written\n") and target.stat().st_size > 4000


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--voltage", "12"), "--voltage: "),
        (("--voltage", "12 A"), "--voltage: "),
        (("--voltage", "-12 V"), "is not above 0; expected e.g. 24 V"),
        (("--load", "3 J"), "--load: "),
        (("--load", "-1 N*m"), "is below 0"),
        (("--ambient", "25 K/W"), "--ambient: "),
        (("--minutes", "0"), "--minutes: 0 is out of range"),
        (("--figure", "bench.pdf"), "expected .svg or .png"),
        (("--controller", "GPX22HPKLSL44D0CPLW"), "is no controller but in gearheads"),
        (("--gearhead", "none"), "is in no catalogue"),
        (("--gearhead", "9:1"), "is a ratio and no part"),
    ],
)
def test_wrong_input_is_one_line(words, said, run):
    status, out, err = run("predict", *SET, *words)
    assert (status, out, err.count("\n")) == (2, "", 1) and said in err and err.startswith("drivesizer: ")


def test_an_actuator_takes_no_gearhead(run):
    status, _, err = run("predict", "XL330-M288-T 5 V", "--gearhead", "406764", "--catalog", "robotis")
    assert status == 2 and "is an actuator with its gear inside" in err
