"""Samples in closed loop: the batch is what each machine does alone, and at nominal figures what validation says."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from drivesizer.catalog.tolerances import Distribution
from drivesizer.control.closed_loop.checks import checks
from drivesizer.control.closed_loop.run import prepared, run
from drivesizer.control.engine import simulate
from drivesizer.errors import InputError
from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases.platform import motion_of
from drivesizer.results.check import Check
from drivesizer.results.drive_set import DriveSet
from drivesizer.search.uncertainty import sampled_closed_loop
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.search.uncertainty.sampled_waveform import Judged, alike, warm_at_most, weakest
from drivesizer.search.uncertainty.sampling import sample
from drivesizer.search.uncertainty.uncertain_figures import Assumption, assumptions
from drivesizer.sizing import size
from drivesizer.spec.robot import RobotSpec, read_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

ARM = """
name: arm
load: {kind: arm, mass: 1.5 kg +- 0.2 kg, length: 200 mm}
motion: {profile: triangle, distance: 60 deg, time: 1.2 s, rest_time: 2 s, there_and_back: true}
supply: {nominal: 24 V, regeneration: 50 %}
margins: {torque: 80 %, speed: 20 %, temperature: 80 %}
select: {motor: {part: DCX22L01EBKL570}, controller: {part: "409510"}}
"""


@pytest.fixture(scope="module")
def arm() -> tuple[RobotSpec, DriveSet]:
    """An arm whose weight goes round with it: each mass is a task of its own."""
    spec = read_spec(YamlSource(ARM, "arm.yaml"))
    result = size(spec, top=1, sampling=Sampling(64, 1, None))
    return result.spec, result.sets[0]


def test_a_batch_is_what_each_machine_does_alone(arm: tuple[RobotSpec, DriveSet]) -> None:
    spec, one = arm
    given = assumptions(spec)
    nominal = run(spec, one, motion_of(spec))
    machines = [sampled_closed_loop.deviating(spec, one, given, values) for values in sample(given, 64, 5).values[:4]]
    assert len({machine[0].load.mass for machine in machines}) == 4  # type: ignore[union-attr]
    made = [prepared(*machine, motion_of(machine[0]), nominal.controller) for machine in machines]
    for ours, each in zip(sampled_closed_loop._simulated(made), made, strict=True):
        alone = simulate(each.drive, each.task, rows=0)
        for name in ("speed_error", "current", "rms_current", "gear_torque"):
            assert ours.figures[name][0] == pytest.approx(alone.figures[name][0], rel=1e-9)


def test_at_nominal_figures_the_checks_are_those_of_validation(arm: tuple[RobotSpec, DriveSet]) -> None:
    spec, one = arm
    given = assumptions(spec)
    nominal = run(spec, one, motion_of(spec))
    machine = sampled_closed_loop.deviating(spec, one, given, np.array([a.nominal for a in given]))
    (found,) = sampled_closed_loop._checked(nominal, [machine], every=True)
    want = [check for check in checks(nominal) if check.name != "winding_temperature"]
    for mine, theirs in zip(found.checks, want, strict=True):
        assert (mine.name, mine.status) == (theirs.name, theirs.status)
        assert mine.demand == pytest.approx(theirs.demand, rel=1e-9, nan_ok=True)


def test_a_sample_keeps_the_gains_of_the_nominal_machine_and_designs_none(arm: tuple[RobotSpec, DriveSet]) -> None:
    spec, one = arm
    made = prepared(spec, one, motion_of(spec))
    assert prepared(spec, one, motion_of(spec), made.controller)[:5] == made[:5]
    too_fast = spec.model_copy(update={"control": spec.control.model_copy(update={"bandwidth": 1e4})})
    with pytest.raises(InputError, match="10000 Hz is faster than the delay"):
        prepared(too_fast, one, motion_of(spec))
    assert prepared(too_fast, one, motion_of(spec), made.controller).controller == made.controller


@pytest.mark.slow
def test_the_share_is_that_of_what_fails(arm: tuple[RobotSpec, DriveSet]) -> None:
    """A supply that is far too low in half of all machines: the voltage fails there, and nowhere else."""
    spec, one = arm
    given = assumptions(spec)
    whole = sampled_closed_loop.loop_share(spec, one, given, sample(given, 64, 1).values, 8)
    assert whole and whole.probability == 1.0 and whole.samples == 8
    text = ARM.replace("nominal: 24 V", "nominal: 24 V, min: uniform(1 V; 24 V)")
    low = read_spec(YamlSource(text, "arm.yaml"))
    uncertain = assumptions(low)
    asked = run(spec, one, motion_of(spec)).required("voltage_demand")
    assert one.controller
    needed = asked / one.controller.max_duty + one.controller.voltage_drop
    values = sample(uncertain, 32, 1).values
    found = sampled_closed_loop.loop_share(low, one, uncertain, values, 32)
    supply = values[:, [a.name for a in uncertain].index("supply.min")]
    assert found and found.weakest in ("Motor voltage", "Tracking error")  # what does not suffice is not followed
    assert found.probability == pytest.approx(np.mean(supply > needed), abs=0.15)


def test_machines_that_lack_voltage_need_no_further_runs(
    arm: tuple[RobotSpec, DriveSet], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The share, its error and the check that fails most often are those with all runs of all machines."""
    spec, one = arm
    assert one.controller
    asked = run(spec, one, motion_of(spec)).required("voltage_demand")
    needed = asked / one.controller.max_duty + one.controller.voltage_drop
    lacks_voltage, lacking = sampled_closed_loop._lacks_voltage, list[bool]()

    def lacks(sample: sampled_closed_loop._Sample) -> bool:
        lacking.append(lacks_voltage(sample))
        return lacking[-1]

    for least, most in ((0.8, 1.2), (0.6, 0.95)):
        text = ARM.replace("nominal: 24 V", f"nominal: 24 V, min: uniform({least * needed} V; {most * needed} V)")
        low = read_spec(YamlSource(text, "arm.yaml"))
        given = assumptions(low)
        values = sample(given, 16, 1).values
        lacking.clear()
        with monkeypatch.context() as patch:
            patch.setattr(sampled_closed_loop, "_lacks_voltage", lacks)
            found = sampled_closed_loop.loop_share(low, one, given, values, 16)
            patch.setattr(sampled_closed_loop, "_lacks_voltage", lambda _: False)
            assert sampled_closed_loop.loop_share(low, one, given, values, 16) == found
        assert any(lacking) and found and found.probability < 1.0 and found.weakest == "Motor voltage"


VEHICLE = """
name: vehicle
load: {kind: wheeled_vehicle, mass: 45 kg +- 5 kg, wheel_diameter: 150 mm, driven_wheels: 4, slope: 3 deg,
  inertia: 0.003 kg*m^2, rolling_resistance: 0.02 in 0.015..0.03, friction_coefficient: 0.6}
motion: {profile: trapezoid, speed: 1.2 m/s, acceleration_time: 1 s, cruise_time: 20 s, rest_time: 2 s}
supply: {nominal: 24 V, min: 22 V +- 0.5 V, current: 40 A}
environment: {ambient: 25 degC +- 10 K}
select: {motor: {family: [DCX 26 L, RE 40, EC-i 40]}}
"""


@pytest.mark.parametrize("text", [ARM, VEHICLE])
def test_a_warm_cycle_exceeds_none_of_its_bounds(text: str) -> None:
    """A law: of a motor that is warm each figure is between what it is from cold and its bound."""
    spec = read_spec(YamlSource(text, "machine.yaml"))
    result = size(spec, top=3, sampling=Sampling(64, 1, None))
    given = assumptions(spec)
    for one in result.sets:
        nominal = run(spec, one, motion_of(spec))
        start = nominal.steady_start
        assert start and max(start) > spec.environment.ambient + 5.0
        values = sample(given, 64, 2).values[::8]
        machines = [sampled_closed_loop.deviating(spec, one, given, row) for row in values]
        samples = sampled_closed_loop._from_cold(nominal, machines)
        made, cold = [each.made for each in samples], [each.out for each in samples]
        free, warm = sampled_closed_loop._freed(made, cold, nominal), sampled_closed_loop._warm(made, nominal)
        for each, alone, (with_limits, without) in zip(samples, free, warm, strict=True):
            assert each.made.drive.heat
            bound = warm_at_most(each.made.drive.heat, each.out, alone, start).figures
            for name, found in (
                ("stage_voltage", without), ("current_demand", without), ("bus_current", with_limits),
            ):  # fmt: skip
                assert found.figures[name][0] < bound[name][0], name


@pytest.mark.parametrize(("volts", "known"), [(24.0, 1.0), (11.0, 0.5), (10.5, 0.1)])
def test_samples_far_from_their_limits_need_no_warm_cycle(
    arm: tuple[RobotSpec, DriveSet], monkeypatch: pytest.MonkeyPatch, volts: float, known: float
) -> None:
    """The share, its error and the weakest check are those with all runs of all machines."""
    _, one = arm
    low = read_spec(YamlSource(ARM.replace("nominal: 24 V", f"nominal: {volts} V"), "arm.yaml"))
    given = assumptions(low)
    values = sample(given, 16, 1).values
    found = sampled_closed_loop.loop_share(low, one, given, values, 16)
    while_cold, decided = sampled_closed_loop._while_cold, list[bool]()

    def counted(*given: Any) -> Any:
        judged = while_cold(*given)
        decided.append(judged is not None)
        return judged

    with monkeypatch.context() as patch:
        patch.setattr(sampled_closed_loop, "_while_cold", counted)
        assert sampled_closed_loop.loop_share(low, one, given, values, 16) == found
        patch.setattr(sampled_closed_loop, "_while_cold", lambda *_: None)
        assert sampled_closed_loop.loop_share(low, one, given, values, 16) == found
    assert known <= np.mean(decided) <= 1.0 - (known < 1.0) * 0.05 and found


def test_the_weakest_check_is_open_where_bounds_of_margins_overlap() -> None:
    def judged(*margins: tuple[float, float]) -> Judged:
        both = [[replace(_CHECK, title=f"{n}", margin=m[k]) for n, m in enumerate(margins)] for k in (0, 1)]
        return Judged(tuple(both[0]), tuple(both[1]))

    assert weakest([judged((0.3, 0.3), (0.5, 0.4))]) == "0"
    assert weakest([judged((0.3, 0.3), (0.5, 0.2))]) is None
    assert weakest([judged((0.3, 0.1), (0.5, 0.5))]) == "0"
    failing = Judged((replace(_CHECK, title="1", status="fail"),), ())
    assert weakest([judged((0.3, 0.3), (0.5, 0.2)), failing]) == "1"
    assert weakest([alike(())]) == ""


_CHECK = Check(
    name="motor_speed", title="", method="closed loop", case="", demand=1.0, limit=1.0, kind="rotary_speed", unit="rpm",
    margin=0.0, needed=0.0, status="pass", at_time=None, by_choice=False, advice=False, note="",
)  # fmt: skip


def test_factors_reach_the_parts(arm: tuple[RobotSpec, DriveSet]) -> None:
    spec, one = arm
    given = assumptions(spec)
    values = np.array([a.nominal for a in given])
    names = [a.name for a in given]
    values[names.index("motor.torque_constant")], values[names.index("gearhead.efficiency")] = 1.1, 1.5
    _, other = sampled_closed_loop.deviating(spec, one, given, values)
    assert other.motor.torque_constant == pytest.approx(1.1 * one.motor.torque_constant)
    assert other.motor.no_load_current * other.motor.torque_constant == pytest.approx(
        one.motor.no_load_current * one.motor.torque_constant
    )
    e = one.gearhead.efficiency
    assert 1 / other.gearhead.efficiency - 1 == pytest.approx(1.5 * (1 / e - 1))


def test_an_assumption_is_shown_in_its_own_unit() -> None:
    spec = read_spec(YamlSource(ARM, "arm.yaml"))
    mass, resistance = assumptions(spec)[:2]
    assert mass.shown(1.6) == "1.6 kg" and resistance.shown(1.05) == "+5 %"
    assert isinstance(mass, Assumption) and isinstance(mass.distribution, Distribution)
