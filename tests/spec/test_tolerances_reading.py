"""Figures with a tolerance: what is read, and the one line that is said of what makes no sense."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from refusals import refusal
from scipy import stats

from drivesizer.catalog.tolerances import CLASSES, CUT, Distribution, classes, share
from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.search.uncertainty.options import Sampling, sampling_of
from drivesizer.spec.robot import read_spec
from drivesizer.spec.tolerances import has_tolerance, tolerance

READ = {
    "45 kg +- 3 kg": ("45 kg", "uniform", 42.0, 48.0),
    "45 +/- 3 kg": ("45 kg", "uniform", 42.0, 48.0),
    "45 kg ± 300 g": ("45 kg", "uniform", 44.7, 45.3),
    "45 kg +- 5 %": ("45 kg", "uniform", 42.75, 47.25),
    "90 % +- 2 %": ("90 %", "uniform", 0.88, 0.92),
    "0.9 +- 2 %": ("0.9", "uniform", 0.882, 0.918),
    "0.02 in 0.015..0.03": ("0.02", "uniform", 0.015, 0.03),
    "5 in in 4..6 in": ("5 in", "uniform", 0.1016, 0.1524),
    "uniform(40 kg, 52 kg)": ("46 kg", "uniform", 40.0, 52.0),
    "triangular(40, 45, 52 kg)": ("45 kg", "triangular", 40.0, 52.0),
    "normal(24 V, 0.5 V)": ("24 V", "normal", 22.0, 26.0),
    "normal(24 V, 2 %)": ("24 V", "normal", 22.08, 25.92),
    "25 degC +- 5 K": ("25 degC", "uniform", 293.15, 303.15),
    "25 degC +- 9 degF": ("25 degC", "uniform", 293.15, 303.15),
}


@pytest.mark.parametrize("text", READ)
def test_a_tolerance_is_read_as_it_is_written(text: str) -> None:
    nominal, shape, low, high = READ[text]
    found = tolerance(text)
    assert (found.nominal, found.distribution.shape) == (nominal, shape)
    assert (found.distribution.low, found.distribution.high) == pytest.approx((low, high), rel=1e-12)


def test_a_slope_takes_the_tolerance_of_a_grade(example_text: str) -> None:
    """By hand: atan(0.04) is 0.0399787 rad, atan(0.03) 0.0299910, atan(0.05) 0.0499584; in a load case too."""
    case = "cases: [{name: ramp, load: {slope: 8 % +- 1 %}}]\n"
    text = example_text.replace("slope: 0 deg", "slope: 4 % +- 1 %").replace("method: paper", case + "method: physics")
    spec = read_spec(YamlSource(text, "robot.yaml"))
    assert spec.load.slope == pytest.approx(0.0399787, abs=5e-8)
    case_, one = sorted(spec.toleranced, key=lambda found: found.path[0])
    assert (one.value, one.distribution.low, one.distribution.high) == pytest.approx(
        (0.0399787, 0.0299910, 0.0499584), abs=5e-8
    )
    assert case_.value == pytest.approx(0.0798300, abs=5e-8)
    assert {one.kind, case_.kind} == {"angle"}


@pytest.mark.parametrize(
    "text", ["118 mm", "-5 deg", "27:1", "robot +- x", "RE 25", "1e-5", "EC 45 flat (70 W)", "a..b"]
)
def test_what_carries_none_is_left_alone(text: str) -> None:
    assert not has_tolerance(text)


WRONG = {
    "45 kg +- -3 kg": "a width must be above 0",
    "45 kg +- 0 kg": "a width must be above 0",
    "45 kg +- 3 V": '"V" is a unit of voltage, not of mass',
    "45 kg +- 3 furlongs": '"furlongs" is not a unit of mass',
    "45 kg +- 3,5 kg": "has a comma in its number",
    "0 deg +- 5 %": "per cent of a figure that is 0 are nothing",
    "0.02 in 0.03..0.015": "its ends must be apart",
    "0.05 in 0.015..0.03": "must lie between its ends",
    "weibull(24 V, 2 V)": '"weibull" is no distribution that is known here',
    "normal(24 V)": "normal takes 2 figures",
    "normal(24 V, 0 V)": "a standard deviation must be above 0",
    "normal(24 V, -1 V)": "a standard deviation must be above 0",
    "triangular(40 kg, 39 kg, 52 kg)": "its figures must rise",
}


@pytest.mark.parametrize("text", WRONG)
def test_a_malformed_tolerance_is_one_line(text: str) -> None:
    refusal(lambda: tolerance(text), match=WRONG[text].replace("(", r"\("))


SHAPES = {
    "uniform": (Distribution("uniform", 2.0, 5.0, 3.5), stats.uniform(2.0, 3.0)),
    "triangular": (Distribution("triangular", 2.0, 6.0, 3.0), stats.triang(0.25, 2.0, 4.0)),
    "normal": (Distribution("normal", 10.0 - 2.0 * CUT, 10.0 + 2.0 * CUT, 10.0), stats.truncnorm(-4.0, 4.0, 10.0, 2.0)),
}


@pytest.mark.parametrize("name", SHAPES)
def test_distributions_are_those_of_scipy(name: str) -> None:
    own, theirs = SHAPES[name]
    at = np.linspace(0.0, 1.0, 101)
    np.testing.assert_allclose(own.at(at), theirs.ppf(at), rtol=1e-9)


def test_shares_of_catalogue_figures() -> None:
    assert share("none") is None
    for text, low, high in (("+- 7 %", 0.93, 1.07), ("-10 %..30 %", 0.9, 1.3), ("normal(5 %)", 0.8, 1.2)):
        found = share(text)
        assert found and (found.low, found.high) == pytest.approx((low, high))
    for text in ("+- 100 %", "-120 %..10 %", "normal(25 %)"):
        with pytest.raises(InputError, match="reaches 0 and below"):
            share(text)
    for text in ("7 %", "+- 0 %", "10 %..-10 %", "+- 3 kg"):
        with pytest.raises(InputError, match="expected"):
            share(text)


def test_every_class_has_a_tolerance_and_a_reason() -> None:
    found = classes()
    assert [(one.part, one.figure) for one in found] == list(CLASSES)
    assert all(one.factor and len(one.why) > 10 for one in found)


# --- in a spec -------------------------------------------------------------------------------------------------------


def _spec(text: str, old: str, new: str) -> YamlSource:
    assert old in text
    return YamlSource(text.replace(old, new), "robot.yaml")


def test_the_spec_has_the_nominal_figure_and_keeps_what_was_written(example_text: str) -> None:
    spec = read_spec(_spec(example_text, "mass: 45 kg ", "mass: 44 kg +- 3 kg "))
    assert spec.load.mass == 44.0  # type: ignore[union-attr]
    assert spec.entered["load"]["mass"] == "44 kg +- 3 kg"
    (one,) = spec.toleranced
    assert one.path == ("load", "mass") and one.with_unit(one.distribution.high) == "47 kg"


REFUSED = [
    ("mass: 45 kg ", "mass: 45 kg +- 50 kg ", "robot.yaml:10: load.mass: ", "-5 kg at its lowest: must be above 0 kg"),
    ("mass: 45 kg ", "mass: normal(45 kg, 12 kg) ", "robot.yaml:10: load.mass: ", "-3 kg at its lowest: must be above"),
    ("efficiency: 0.95 ", "efficiency: 0.95 +- 0.1 ", "robot.yaml:38: transmission[2].efficiency: ", "at its highest"),
    ("min: 22 V ", "min: 22 V +- 4 V ", "robot.yaml:50: supply.min: ", "expected min <= nominal <= max"),
    ("mass: 45 kg ", "mass: 45 V +- 3 V ", "robot.yaml:10: load.mass: ", "unit of voltage, not of mass"),
    ("mass: 45 kg ", "mass: lognormal(45 kg, 3 kg) ", "robot.yaml:10: load.mass: ", "no distribution that is known"),
    ("select:\n", "tolerances: {motor: {resistance: +- 120 %}}\nselect:\n", "tolerances.motor.resistance", "reaches 0"),
    ("select:\n", "tolerances: {motor: {resistence: 3 %}}\nselect:\n", "resistence", 'did you mean "resistance"?'),
    ("select:\n", "tolerances: {samples: 3}\nselect:\n", "tolerances.samples", "must be at least 64"),
    ("select:\n", "tolerances: {confidence: 120 %}\nselect:\n", "tolerances.confidence", "must be at most 1"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "where", "what"), REFUSED)
def test_a_tolerance_that_leads_astray_is_refused(example_text: str, old: str, new: str, where: str, what: str) -> None:
    said = refusal(lambda: read_spec(_spec(example_text, old, new)))
    assert where in said and what in said


@pytest.mark.parametrize(("options", "said"), [
    (["--confidence", "1.5"], "--confidence: 1.5 is not a probability"),
    (["--samples", "3"], "--samples: 3 is out of range"),
    (["--seed", "-1"], "--seed: -1 is out of range"),
    (["--loop-samples", "-1"], "--loop-samples: -1 is out of range"),
])  # fmt: skip
def test_options_out_of_range_end_with_status_2(example: Path, options: list[str], said: str) -> None:
    run = subprocess.run(
        [sys.executable, "-m", "drivesizer", "size", str(example), *options],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (run.returncode, run.stdout) == (2, "")
    assert said in run.stderr and len(run.stderr.strip().splitlines()) == 1


def test_samples_in_closed_loop_that_are_asked_for_are_made(example_text: str) -> None:
    """Alone the option had no effect and no word about it; none at all is no wish."""
    spec = read_spec(YamlSource(example_text, "robot.yaml"))
    assert sampling_of(spec, loop=4) == Sampling(spec.tolerances.samples, spec.tolerances.seed, None, loop=4)
    assert sampling_of(spec, loop=0) is None is sampling_of(spec)
