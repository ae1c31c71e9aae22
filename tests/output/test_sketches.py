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


def test_init_writes_it_and_refuses_what_has_none(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert CliRunner().invoke(app, ["init", "--kind", "arm", "--sketch", "arm.svg"]).exit_code == 0
    assert Path("arm.svg").read_bytes() == sketch("arm") and Path("robot.yaml").exists()
    refused = CliRunner().invoke(app, ["init", "--kind", "gantry", "-o", "g.yaml", "--sketch", "g.svg"])
    assert "there is none of" in str(refused.exception) and not Path("g.yaml").exists()
