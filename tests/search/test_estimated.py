"""Drives whose parts lack a figure: judged at both ends of the band that peers give, not as unknown.

What a drive does at an estimated figure is held against the same drive with that very figure printed; the probability
against the normal distribution that the band stands for.
"""

from __future__ import annotations

import re
from dataclasses import replace
from math import isnan, log, nan, pi
from statistics import NormalDist

import numpy as np
import pytest
from scipy.optimize import brentq
from specs import estimates_off, selecting
from starters import STARTERS

from drivesizer.catalog import Catalog, load
from drivesizer.catalog.tables import Pairs
from drivesizer.catalog.view import search_view
from drivesizer.files.yaml_source import YamlSource
from drivesizer.machine.problem import problem
from drivesizer.results.drive_set import DriveSet
from drivesizer.search.columns.evaluation import by_physics
from drivesizer.search.open_checks import passing
from drivesizer.search.passing import OPEN, sifted
from drivesizer.search.shortlist import load_parts
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.search.uncertainty.uncertain_figures import holding_of_a_set
from drivesizer.sizing import explain, explained, size
from drivesizer.spec.drive import Choice, MotorChoice
from drivesizer.spec.robot import RobotSpec, load_spec, read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

MOTOR, GEARHEAD = "ECXZ22M1VF35N1IL1D577A", "GPX22UPKLSL83D0CPLW"  # RMS current close to the limit
FIGURES = ("rotor_inertia", "no_load_current", "thermal_resistance_housing", "winding_time_constant")


@pytest.fixture(scope="module")
def maxon() -> Catalog:
    return load(["maxon"])


@pytest.fixture(scope="module")
def table() -> RobotSpec:
    """The starter with a little less of inertia: RMS current close to the limit."""
    spec = load_spec(STARTERS / "rotary_table.yaml")
    return spec.model_copy(update={"load": spec.load.model_copy(update={"inertia": 0.119})})


def with_figure(catalog: Catalog, figure: str, value: float, section: str = "motors", part: str = MOTOR) -> Catalog:
    rows = catalog.table(section)
    columns = {**rows.columns, figure: rows[figure].copy()}
    columns[figure][rows.rows[part]] = value
    return catalog.with_tables({section: replace(rows, columns=columns)}, {})


def one(spec: RobotSpec, catalog: Catalog) -> DriveSet:
    (found,) = explain(spec, MOTOR, GEARHEAD, catalog=catalog)
    return found


@pytest.fixture(scope="module")
def lacking(maxon, table) -> DriveSet:
    """The drive without its rotor inertia."""
    return one(table, with_figure(maxon, "rotor_inertia", np.nan))


@pytest.mark.slow
@pytest.mark.parametrize("figure", FIGURES)
def test_each_check_is_what_it_is_with_the_ends_of_the_band_printed(maxon, table, figure):
    found = one(table, with_figure(maxon, figure, np.nan))
    (estimate,) = (e for e in found.estimated if e.figure == figure)
    assert estimate.low < estimate.value < estimate.high
    ends = [one(table, with_figure(maxon, figure, value)) for value in (estimate.low, estimate.high)]
    middle = one(table, with_figure(maxon, figure, estimate.value))
    others = [{e.figure for e in d.estimated} for d in (found, *ends)]
    assert others[0] - {figure} == others[1] == others[2], "no other figure hangs on it"
    for check, *at_ends in zip(found.checks, *(d.checks for d in ends), strict=True):
        status = {c.status for c in at_ends}
        assert check.status == (status.pop() if len(status) == 1 else "open"), check.name
        demands = [c.demand for c in at_ends]
        if check.band:
            assert (check.band.low, check.band.high) == pytest.approx((min(demands), max(demands)), rel=1e-9), (
                check.name
            )
            assert check.band.least_margin == pytest.approx(min(c.margin for c in at_ends), rel=1e-9)
        else:
            assert np.array(demands) == pytest.approx(check.demand, rel=1e-9, nan_ok=True), check.name
    for check, printed in zip(found.checks, middle.checks, strict=True):
        assert check.demand == pytest.approx(printed.demand, rel=1e-9, nan_ok=True), check.name


def test_an_open_check_turns_at_the_value_that_it_states(maxon, table, lacking):
    """Half a per cent below the stated value it passes when printed, above it fails."""
    assert lacking.status == "open"
    (check,) = (c for c in lacking.checks if c.status == "open")
    assert check.name == "motor_nominal_current"
    assert check.note == "passes with a motor rotor inertia of at most 2.5 g·cm², which is estimated"
    assert check.turns_on == "motor rotor inertia"
    assert ("motor", "rotor_inertia", "estimated from peers") in check.origins
    assert not any(one.figure == "torque_constant" for one in check.origins), "that one is printed"
    found = {}
    for inertia in (2.45e-7, 2.55e-7):
        drive = one(table, with_figure(maxon, "rotor_inertia", inertia))
        found[inertia] = next(c.status for c in drive.checks if c.name == check.name)
    assert found == {2.45e-7: "pass", 2.55e-7: "fail"}


@pytest.mark.slow
def test_the_probability_is_that_of_the_band(maxon, table, lacking):
    """One figure decides: the share of the log-normal distribution up to the value at which the check turns."""
    (estimate,) = (e for e in lacking.estimated if e.figure == "rotor_inertia")
    low, high = 1e-7, 1e-6
    for _ in range(14):  # where it turns to 1e-4, by drives with the figure printed
        middle = (low * high) ** 0.5
        status = one(table, with_figure(maxon, "rotor_inertia", middle)).status
        low, high = (middle, high) if status == "pass" else (low, middle)
    end = estimate.low if low < estimate.value else estimate.high
    deviations = 1.6449 * log(low / estimate.value) / abs(log(end / estimate.value))
    assert lacking.probability == pytest.approx(NormalDist().cdf(deviations), abs=0.02)
    (check,) = (c for c in lacking.checks if c.status == "open")
    assert check.probability == lacking.probability


def test_the_probability_of_a_check_is_its_own(maxon, table):
    """The current of the supply grows with the rotor's inertia; a winding that is too hot in most samples has no say.

    Where it turns is worked out from three drives with the figure printed: the demand is a parabola over so little.
    """
    limited = with_figure(maxon, "max_winding_temperature", 387.0)
    weak = table.model_copy(update={"supply": table.supply.model_copy(update={"current": 2.21})})
    found = one(weak, with_figure(limited, "rotor_inertia", np.nan))
    inertia = np.array([2.5e-7, 2.9e-7, 3.3e-7])
    printed = [one(weak, with_figure(limited, "rotor_inertia", J)) for J in inertia]
    demand = [next(c.demand for c in drive.checks if c.name == "supply_current") for drive in printed]
    (turn,) = (J for J in np.roots(np.polyfit(inertia, demand, 2) - [0.0, 0.0, 2.21]) if 2.5e-7 < J < 3.3e-7)
    (estimate,) = (e for e in found.estimated if e.figure == "rotor_inertia")
    deviations = 1.6449 * log(turn / estimate.value) / log(estimate.high / estimate.value)
    probable = {check.name: check.probability for check in found.checks if check.status == "open"}
    assert probable["supply_current"] == pytest.approx(NormalDist().cdf(deviations), abs=0.01)
    assert found.probability == probable["winding_temperature"] < 0.3  # what turns first decides for all together


def test_without_estimates_the_figure_is_unknown_and_nothing_else_changes(maxon, table):
    poorer = with_figure(maxon, "rotor_inertia", np.nan)
    found = one(estimates_off(table), poorer)
    assert found.status == "unknown" and isnan(found.motor.rotor_inertia) and not found.estimated
    of_energy = (size(s, catalog=maxon, top=3, objective="energy") for s in (table, estimates_off(table)))
    whole, off = of_energy  # masses of encoders and controllers that nobody prints are estimates
    assert [s.label for s in whole.sets] == [s.label for s in off.sets]


def test_the_search_finds_what_the_single_drive_is(maxon, table):
    """Status by search and alone; drives that pass come before open ones, which are counted, and unknown ones last."""
    poorer = maxon
    for motor in [m for m in maxon.motors["part"] if m.startswith("ECXZ22M1VF35N1IL1D")]:
        poorer = with_figure(poorer, "rotor_inertia", np.nan, part=motor)
    some = [m for m in maxon.motors["part"] if m.startswith("ECXZ22M1VF35N1IL1D5")]
    spec = selecting(table, motor=table.select.motor.model_copy(update={"part": some}))
    found = size(spec, catalog=poorer, top=2000)
    unknown = [{check.name for check in s.checks if check.status == "unknown"} for s in found.sets]
    alike = set.intersection(*unknown)  # what all lack sets none back
    hanging = [any(check.status == "open" for check in s.checks) for s in found.sets]
    place = [2 if lacks - alike else int(open_) for lacks, open_ in zip(unknown, hanging, strict=True)]
    assert place == sorted(place)
    assert found.counts.open == place.count(1) > 0
    for drive in (found.sets[0], found.sets[-1], found.sets[hanging.index(True)]):
        (alone,) = explain(spec, drive.motor.part, drive.gearhead.part, catalog=poorer)
        assert alone.status == drive.status and alone.probability == pytest.approx(drive.probability, nan_ok=True)
        for mine, found_check in zip(alone.checks, drive.checks, strict=True):
            assert (mine.name, mine.status, mine.note) == (found_check.name, found_check.status, found_check.note)
            assert mine.demand == pytest.approx(found_check.demand, rel=1e-9, nan_ok=True)


def test_samples_vary_an_estimated_figure_within_its_band(maxon, table):
    """Its class is the band of its law, not the tolerance of a printed figure."""
    poorer = with_figure(maxon, "rotor_inertia", np.nan)
    view = search_view(poorer)
    row, gear = view.motors.rows[MOTOR], view.gearheads.rows[GEARHEAD]
    (held,) = (c for c in holding_of_a_set(view, {}, row, gear) if c.figure == "rotor_inertia")
    assert held.why == "estimated from peers" and held.factor is not None
    value, low, high, _ = view.estimate_of("motors", row, "rotor_inertia") or (nan, nan, nan, 0)
    ends = held.factor.at(np.array([0.05, 0.5, 0.95])) * value
    assert ends == pytest.approx([low, value, high], rel=1e-3)
    (printed,) = (c for c in holding_of_a_set(search_view(maxon), {}, row, gear) if c.figure == "rotor_inertia")
    assert printed.factor is not None and printed.factor.high - 1.0 < (high - value) / value


def test_samples_and_bands_give_the_same_probability(maxon, table, lacking):
    """The estimated figure as the only uncertain one: the share of samples that pass is the probability."""
    alone = {
        part: section.model_copy(update=dict.fromkeys(set(type(section).model_fields) - {"rotor_inertia"}, "none"))
        for part, section in (("motor", table.tolerances.motor), ("gearhead", table.tolerances.gearhead))
    }
    spec = table.model_copy(update={"tolerances": table.tolerances.model_copy(update=alone)})
    poorer = with_figure(maxon, "rotor_inertia", np.nan)
    found = explained(spec, MOTOR, GEARHEAD, catalog=poorer, sampling=Sampling(2048, 1, None)).sets[0].reliability
    assert found is not None
    assert found.probability == pytest.approx(lacking.probability, abs=0.02)


@pytest.mark.slow
def test_of_open_drives_the_more_probable_come_first(maxon, table):
    """A catalogue of open pairs alone: tenths of the probability that none fails, and the mass within."""
    figures = ("thermal_resistance_housing", "thermal_resistance_winding", "no_load_current", "rotor_inertia")
    columns = {**maxon.motors.columns, **{figure: np.full(len(maxon.motors), np.nan) for figure in figures}}
    lacking = search_view(maxon.with_tables({"motors": replace(maxon.motors, columns=columns)}, {}))
    kept, _, _ = sifted(problem(table, lacking))
    open_ = {(int(m), int(g)) for m, g, c in zip(*kept.sets[:2], kept.certainty, strict=True) if c == OPEN}
    pairs = lacking.motor_gearhead
    rows = np.array([pair in open_ for pair in zip(pairs.left.tolist(), pairs.right.tolist(), strict=True)])
    alone = replace(lacking, motor_gearhead=Pairs(*(side[rows] for side in pairs)))
    found = size(table, top=20, catalog=alone).sets
    sampled = [one for one in found if not isnan(one.probability)]  # others are open by what nobody knows more of
    tenths = [(-int(10.0 * one.probability), round(one.mass, 9)) for one in sampled]
    assert {one.status for one in found} == {"open"} and len({tenth for tenth, _ in tenths}) > 1
    assert tenths == sorted(tenths)


def test_what_more_inertia_helps_and_what_it_harms_are_open_in_the_search_too(maxon, table, lacking):
    """The inertia ratio fails at the low end of the band only, other limits at the high end: one drive, undecided."""
    catalog = with_figure(maxon, "rotor_inertia", np.nan)
    found = {}
    for ratio in (30.0, 50.0, 100.0):
        needs = table.needs.model_copy(update={"inertia_ratio": ratio})
        chosen = {"motor": MotorChoice(part=[MOTOR]), "gearhead": Choice(part=[GEARHEAD])}
        spec = selecting(table.model_copy(update={"needs": needs}), **chosen)
        drive, result = one(spec, catalog), size(spec, catalog=catalog)
        assert [shown.status for shown in result.sets] == [drive.status] * (drive.status != "fail")
        found[ratio] = drive.status
    assert found == {30.0: "fail", 50.0: "open", 100.0: "open"}


@pytest.mark.parametrize("holds", [False, True])
def test_several_drives_that_are_sampled_together_pass_as_probably_as_each_alone(holds):
    """Drives of several makers, with encoders and without, with brakes and without."""
    arm = load_spec(STARTERS / "arm.yaml")
    arm = arm.model_copy(update={"needs": arm.needs.model_copy(update={"hold_unpowered": holds})})
    spec = selecting(arm, catalogs=["maxon", "allied_motion", "rev", "pololu", "damiao"])
    at = problem(spec, load_parts(spec))
    kept, _, _ = sifted(at)
    found = by_physics(at, kept.sets.on(np.flatnonzero(kept.certainty == OPEN)), "open")
    names = {place: found.open_checks(place) for place in range(len(found.encoder))}
    together = passing(at, found.with_parts(np.array(list(names))), list(names.values()), exact=False)
    alone = [passing(at, found.with_parts(np.array([place])), [some], exact=False)[0] for place, some in names.items()]
    of_all = [{name: one[name] for name in own} for one, own in zip(together, alone, strict=True)]
    assert len(names) > 3 and of_all == alone
    assert len({one[""] for one in alone}) > 1


STEADY = """name: nearly steady
load: {kind: rotary_table, inertia: 0.0001 kg*m^2, friction_torque: 0.41 N*m}
motion: {profile: segments, segments: [{time: 1 s, to: 30 rpm}, {time: 3598 s}, {time: 1 s, to: 0 rpm}]}
transmission: [{kind: gearhead}]
supply: {nominal: 12 V}
select: {catalogs: [maxon], motor: {part: DCX22S01EBKL598}, gearhead: {part: GPX22HPKLSL44D0CPLW}}
"""


def test_friction_of_a_gearhead_without_load_is_a_range_where_it_decides(maxon: Catalog) -> None:
    """The current at both ends of what is usual, 2 % a stage and three times either way; how probable it passes."""
    spec = read_spec(YamlSource(STEADY, "steady.yaml"))
    (said,) = [text for text in size(spec, catalog=maxon, top=1).warnings if "gearhead without load" in text]
    (best,) = size(spec, catalog=maxon, top=1).sets
    motor, gear, w = best.motor, best.gearhead, 30 * pi / 30 * best.gearhead.ratio
    lost = motor.torque_constant * motor.no_load_current * (0.65 + 0.35 * w / motor.no_load_speed)

    def current(idle: float) -> float:
        e = 1.0 / (1.0 / gear.efficiency - gear.ratio * idle / gear.continuous_torque)
        return (0.41 / (gear.ratio * e) + idle + lost) / motor.torque_constant

    usual = 0.02 * gear.stages * gear.continuous_torque / gear.ratio
    low, high, limit = (float(x) for x in re.findall(r"\(RMS\) ([\d.]+) A to ([\d.]+) A of ([\d.]+) A", said)[0])
    assert (low, high) == pytest.approx((current(usual / 3.0), current(usual * 3.0)), rel=2e-3)
    assert limit == motor.nominal_current and best.status == "pass"
    ends = [float(x) for x in re.findall(r"([\d.]+) mN·m", said)]
    assert ends == pytest.approx([usual / 3.0 * 1e3, usual * 3.0 * 1e3], rel=0.02)
    most = brentq(lambda idle: current(idle) - limit, usual / 9.0, usual * 9.0)
    probable = NormalDist(log(usual), log(3.0) / 1.6448536269514722).cdf(log(most))
    assert float(re.findall(r"passes with (\d+) %", said)[0]) / 100.0 == pytest.approx(probable, abs=0.06)
    printed = with_figure(maxon, "no_load_torque", usual, "gearheads", gear.part)
    assert not any("gearhead without load" in text for text in size(spec, catalog=printed, top=1).warnings)
