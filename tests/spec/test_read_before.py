"""Variants of a spec read with what was read of it before: the same specs and the same errors as without."""

from copy import copy
from pathlib import Path

import pytest

from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.spec.robot import read_spec
from drivesizer.study.fields import changed

EXAMPLE = (Path(__file__).resolve().parents[2] / "examples" / "sps_robot.yaml").read_text(encoding="utf-8")
SOURCE = YamlSource(EXAMPLE, "robot.yaml")


def variant(*changes):
    source = copy(SOURCE)
    for path, value in changes:
        source.data = changed(source.data, path, value)
    return source


@pytest.mark.parametrize("changes", [
    [(("load", "mass"), "31 kg")],
    [(("load", "cylinders", "wheel", "width"), "51 mm")],
    [(("load", "cylinders", "shaft"), None)],
    [(("transmission", 1, "ratio"), 1.3), (("supply", "nominal"), "25 V")],
    [(("equipment", 1, "power"), "4.5 W")],
    [(("battery", "open_circuit", "full"), "12.8 V"), (("battery", "parallel"), 3)],
    [(("motion", "speed"), "1.2 m/s +- 0.1 m/s")],
    [(("motion",), {"profile": "triangle", "distance": "3 m", "time": "3 s"}), (("method",), "physics")],
    [(("select", "motor", "family"), ["RE 25", "RE 30"])],
])  # fmt: skip
def test_a_variant_reads_the_same_with_what_was_read_before(changes):
    before, source = read_spec(SOURCE), variant(*changes)
    alone, found = read_spec(source), read_spec(source, before)
    assert found.model_dump() == alone.model_dump() != before.model_dump()
    assert found.toleranced == alone.toleranced
    assert bool(found.toleranced) == ("+-" in str(changes))


@pytest.mark.parametrize("changes", [
    [(("load", "mass"), "-31 kg")],
    [(("load", "kind"), "hoist")],
    [(("load", "sinkage"), "3 mm")],
    [(("load", "cylinders", "wheel", "widht"), "51 mm")],
    [(("transmission", 1, "kind"), "gearhead")],
    [(("equipment", 1, "power"), "4.5 V")],
    [(("equipment", 4, "duty"), "110 %")],
    [(("battery",), None)],
    [(("supply", "min"), "30 V")],
    [(("motion", "speed"), "1.2 m/s +- 1.3 m/s")],
    [(("paper_factors",), ["0.9"])],
])  # fmt: skip
def test_what_is_wrong_is_said_the_same(changes):
    before, source, said = read_spec(SOURCE), variant(*changes), []
    for known in (None, before):
        with pytest.raises(InputError) as caught:
            read_spec(source, known)
        said.append(str(caught.value))
    assert said[0] == said[1] and "\n" not in said[0]


def test_tolerances_are_found_beside_others():
    """Where the spec has one already, one more is found, and none is lost."""
    with_one = YamlSource(EXAMPLE.replace("mass: 45 kg", "mass: 45 kg +- 1 kg"), "robot.yaml")
    source = copy(with_one)
    source.data = changed(source.data, ("supply", "nominal"), "24 V +- 0.5 V")
    found = read_spec(source, read_spec(with_one))
    assert [one.path for one in found.toleranced] == [("load", "mass"), ("supply", "nominal")]
