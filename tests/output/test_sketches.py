"""Sketches of loads: every kind has one, of fields that it has, and it is whole as SVG."""

from pathlib import Path
from typing import get_type_hints

import pytest
from lxml import etree
from typer.testing import CliRunner

from drivesizer import loads
from drivesizer.cli import app
from drivesizer.output.sketch import SKETCHES, sketch

SVG = "{http://www.w3.org/2000/svg}"


def test_every_kind_of_load_has_one():
    assert set(SKETCHES) == set(loads.MODULES)


@pytest.mark.parametrize("kind", SKETCHES)
def test_it_names_the_fields_of_its_load_alone(kind):
    root = etree.fromstring(sketch(kind))
    words = ["".join(one.itertext()) for one in root.iter(f"{SVG}text") if "9px" in one.get("style")][1::2]
    fields = {name.replace("_", " ") for name in get_type_hints(loads.LAWS[kind])["load"].model_fields}
    assert len(words) >= 2 and set(words) <= fields
    assert float(root.get("height")) >= max(float(one.get("y")) for one in root.iter(f"{SVG}text"))


def test_what_was_entered_stands_beside_its_symbol_and_nothing_else_is_named():
    text = "".join(etree.fromstring(sketch("hoist", {"mass": "<3 kg>", "drum_diameter": "90 mm"})).itertext())
    assert "mass <3 kg>" in text and "drum diameter 90 mm" in text
    assert "counterweight" not in text and "rope efficiency" not in text


@pytest.mark.parametrize("kind", SKETCHES)
def test_what_is_beside_the_drive_is_drawn_with_its_figures(kind):
    beside = [{"kind": "gas", "force": "400 N"}, {"kind": "counterweight", "mass": "4 kg"}]
    entered = {"kind": kind, "inertia": "1 kg*m^2"}
    without, drawn = (etree.fromstring(sketch(kind, entered | {"springs": some})) for some in ([], beside))
    marks = drawn.findall(f"{SVG}polyline")[len(without.findall(f"{SVG}polyline")) :]
    points = [tuple(map(float, p.split(","))) for one in marks for p in one.get("points").split()]
    assert len(marks) > 4 and all(0 <= x <= float(drawn.get("width")) and 0 <= y <= 204 for x, y in points)
    text = "".join(drawn.itertext())
    assert "springs gas, 400 N" in text and "springs counterweight, 4 kg" in text


def test_springs_that_are_not_understood_yet_are_left_out():
    assert sketch("arm", {"springs": ["gas", {"kind": "rubber"}]}) == sketch("arm", {"springs": None})


def test_init_writes_it_and_refuses_what_has_none(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert CliRunner().invoke(app, ["init", "--kind", "arm", "--sketch", "arm.svg"]).exit_code == 0
    assert Path("arm.svg").read_bytes() == sketch("arm") and Path("robot.yaml").exists()
    refused = CliRunner().invoke(app, ["init", "--kind", "gantry", "-o", "g.yaml", "--sketch", "g.svg"])
    assert "there is none of" in str(refused.exception) and not Path("g.yaml").exists()
