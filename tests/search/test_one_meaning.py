"""Pass, fail and unknown mean one thing: of a check, a set, a set in closed loop, a set over samples."""

from __future__ import annotations

import math

import numpy as np
import pytest
from specs import estimates_off, poorer

from drivesizer.files.yaml_source import YamlSource
from drivesizer.output.document.candidates import probability_table
from drivesizer.output.json.documents import plain
from drivesizer.results.check_columns import at_most
from drivesizer.search.columns.limits import unknown_where_doubtful
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.simulate import validate
from drivesizer.sizing import explained
from drivesizer.spec.robot import read_spec


def test_a_check_that_is_unknown_has_no_margin():
    """A least demand below its limit may fail, once all of it is known: 10 of 20 A tell nothing, 30 of 20 A do."""
    column = at_most("controller_peak_current", np.array([10.0, 30.0]), np.array([20.0, 20.0]))
    assert column.margin == pytest.approx([1.0, -1 / 3])
    (open_,) = unknown_where_doubtful([column], np.array([False, False]))
    assert math.isnan(open_.margin[0]) and open_.margin[1] == pytest.approx(-1 / 3)
    assert [open_.at(k, "physics").status for k in (0, 1)] == ["unknown", "fail"]


@pytest.fixture(scope="module")
def pair(example_text, catalog):
    """The SPS robot with an uncertain mass, as if its motor's thermal figures and permissible speed were unknown."""
    text = example_text.replace("mass: 45 kg", "mass: 45 kg +- 2 kg", 1).replace("method: paper", "method: physics")
    spec = estimates_off(read_spec(YamlSource(text, "robot.yaml")))
    return explained(spec, "118752", "406764", catalog=poorer(catalog), sampling=Sampling(64, 1, None, loop=16))


def test_samples_do_not_say_that_all_pass_where_checks_are_unknown(pair):
    (one,) = pair.sets
    assert one.status == "unknown" and math.isnan(one.motor.max_speed)
    found = one.reliability
    assert found.unknown and math.isnan(found.passing)
    told = {spread.title: spread for spread in found.checks}
    for title in found.unknown:
        assert told[title].passes + told[title].fails < 1.0
        assert all(math.isnan(x) for x in (told[title].low, told[title].middle, told[title].high))


def test_samples_in_closed_loop_do_not_say_so_either(pair):
    """What hangs on unknown heat is named and says unknown, in closed loop as without; the motor's speed is assumed."""
    found = pair.sets[0].reliability
    assert found.loop.probability > 0.0
    assert set(found.loop.unknown) == {"Motor voltage", "Supply current, all drives"}
    assert math.isnan(found.loop.passing)
    written = plain(found)["loop"]
    assert written["passing"] is None and written["probability"] == found.loop.probability
    cell = probability_table("", pair.sets, "").rows[0].cells["loop"]
    assert cell.text == "unknown" and cell.note.startswith("none fails: ")


def test_the_closed_loop_heads_a_set_unknown_where_a_check_is(pair, spec):
    proof = validate(spec, pair.sets[0])
    statuses = {check.status for check in proof.checks if not check.advice}
    assert "unknown" in statuses and "fail" not in statuses
    assert proof.status == "unknown"
