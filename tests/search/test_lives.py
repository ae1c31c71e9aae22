"""Required lives by part: each counts for its own check, and of what is not named none is required."""

from dataclasses import asdict, replace

import numpy as np
import pytest
from refusals import refusal

from drivesizer.catalog import Gearhead
from drivesizer.load_cases import load_cycle
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.search.columns.limits import gearhead_limits, load_limits
from drivesizer.search.columns.shaft_limits import loads_on_gearheads
from drivesizer.spec.robot import load_spec

HOUR = 3600.0
SCREW = {"kind": "ball_screw", "mass": "50 kg", "lead": "10 mm", "efficiency": 0.9, "incline": "90 deg",
         "diameter": "15 mm", "length": "700 mm", "dynamic_load": "9.8 kN"}  # fmt: skip
RACK = {"kind": "rack_pinion", "mass": "100 kg", "pinion_diameter": "50 mm"}
MOTION = {"speed": "0.3 m/s", "acceleration_time": "0.2 s", "cruise_time": "1.8 s", "there_and_back": True}
CHECKS = {"screw": "screw_life", "gearhead": "gearhead_life", "output_bearing": "gearhead_bearing_life"}


def spec_of(life, load=SCREW, **sections):
    supply = {"nominal": "48 V"}
    return load_spec(
        {"name": "x", "load": load, "motion": MOTION, "supply": supply, "needs": {"life": life}} | sections
    )


def lives_of(spec, **figures):
    """The life checks of a gearhead: required hours, and whether it passes, fails or is unknown."""
    cycle = CycleAtBelt(load_cycle(spec), 1.0).behind(1.0)
    gearhead = {name: np.atleast_1d(figure) for name, figure in asdict(replace(Gearhead(), **figures)).items()}
    found = [*load_limits(spec, cycle), *gearhead_limits(spec, cycle, gearhead),
             *loads_on_gearheads(spec, cycle, None, gearhead)]  # fmt: skip
    return {
        check.name: (float(np.max(check.demand)) / HOUR, bool(check.passed.all()), bool(check.failed.any()))
        for check in found
        if check.name in CHECKS.values()
    }


def test_only_what_is_named_is_required():
    """A gearhead without a rated life leaves the drive unknown where all must last, and says nothing of the screw."""
    passed, unknown = (20000.0, True, False), (20000.0, False, False)
    assert lives_of(spec_of("20000 h")) == {"screw_life": passed, "gearhead_life": unknown}
    assert lives_of(spec_of({"screw": "20000 h"})) == {"screw_life": passed}
    assert lives_of(spec_of({"screw": "90000 h"})) == {"screw_life": (90000.0, False, True)}
    assert lives_of(spec_of({"gearhead": "20000 h"})) == {"gearhead_life": unknown}
    both = lives_of(spec_of({"screw": "20000 h", "gearhead": "9 h"}))
    assert both == {"screw_life": passed, "gearhead_life": (9.0, False, False)}


def test_each_part_has_its_own_hours():
    """Hours of one check are not those of another, and one time for all is that of each."""
    printed = {"ratio": 5.0, "continuous_torque": 30.0, "rated_life": 1000.0 * HOUR, "life_exponent": 3.0,
               "rated_speed": 100.0, "max_radial_load": 900.0}  # fmt: skip
    shaft = {"shaft": {"carries_load": True}}
    life = {"gearhead": "600 h", "output_bearing": "8000 h"}
    found = lives_of(spec_of(life, RACK, **shaft), **printed)
    assert found.keys() == {"gearhead_life", "gearhead_bearing_life"}
    assert (found["gearhead_life"][0], found["gearhead_bearing_life"][0]) == (600.0, 8000.0)
    assert found["gearhead_bearing_life"][1]  # the printed radial load stands for it
    alike = lives_of(spec_of("600 h", RACK, **shaft), **printed)
    assert alike["gearhead_life"] == found["gearhead_life"]
    assert lives_of(spec_of({"gearhead": "600 h"}, RACK, **shaft), **printed).keys() == {"gearhead_life"}


@pytest.mark.parametrize(
    ("life", "sections", "said"),
    [
        ("-10 h", {}, 'needs.life: "-10 h" must be above 0 s, e.g. 20000 h'),
        ({}, {}, "needs.life: give screw, gearhead or output_bearing, or one time for all, e.g. life: 20000 h"),
        ({"screw": "10 h"}, {"load": RACK}, "needs.life.screw: a rack_pinion has no screw; leave it out"),
        (
            {"screw": "10 h"}, {"load": SCREW | {"dynamic_load": None}},
            "needs.life.screw: it follows from a ball screw's rating; expected load.dynamic_load",
        ),
        ({"gearhead": "10 h"}, {"transmission": [{"kind": "direct"}]}, "needs.life: with kind: direct as transmission"),
        ({"output_bearing": "10 h"}, {}, "needs.life.output_bearing: nothing is known to load it; expected a section"),
    ],
)  # fmt: skip
def test_what_no_part_can_have_is_refused(life, sections, said):
    assert refusal(lambda: spec_of(life, **sections)).startswith(f"spec: {said}")
