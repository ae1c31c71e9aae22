"""Limits of a common supply over tolerances: against plain Monte Carlo, exact shares, and what is said of them."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from drivesizer.machine.common_supply import machine_power
from drivesizer.machine.problem import problem
from drivesizer.multi_axis import size_machine
from drivesizer.multi_axis.sampled_supply import over_tolerances
from drivesizer.results.machine import AxisSizing, MachineSizing
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.spec.machine import load_machine

pytestmark = pytest.mark.usefixtures("no_further_searches")

MOTION = {"speed": "0.6 m/s", "acceleration_time": "80 ms", "cruise_time": "100 ms", "rest_time": "0.2 s"}
PRINTED = {
    "motor": dict.fromkeys(("resistance", "friction", "rotor_inertia", "thermal_resistance", "dry_friction"), "none"),
    "gearhead": dict.fromkeys(("efficiency", "inertia"), "none"), "controller": {"losses": "none"},
}  # fmt: skip
EXACT = {**PRINTED, "motor": {**PRINTED["motor"], "torque_constant": "none"}, "samples": 64}


def axis(mass: str, **more: Any) -> dict[str, Any]:
    return {"load": {"kind": "belt_axis", "mass": mass, "pulley_diameter": "20 mm"}, "motion": MOTION, **more}


MACHINE: dict[str, Any] = {
    "name": "two axes",
    "supply": {"nominal": "48 V ± 2 V", "current": "0.5 A", "capacitance": "50 mF"},
    "select": {"motor": {"part": "DCX22L01EBKL570"}, "gearhead": {"part": "GPX22AAKLSL06D6CPLW"}},
    "tolerances": {**PRINTED, "samples": 64},
    "cycle_time": "2 s ± 1 %",
    "axes": {"x": axis("2 kg ± 0.4 kg"), "y": axis("1.8 kg ± 20 %", start="60 ms ± 30 ms")},
}


@pytest.fixture(scope="module")
def sizing() -> MachineSizing:
    return size_machine(load_machine(MACHINE), top=1, detail="drives")


def written(figures: dict[str, Any], machine: dict[str, Any] = MACHINE) -> dict[str, Any]:
    """The machine with plain figures in its file."""
    made = deepcopy(machine)
    for name, value in figures.items():
        *path, last = name.split(".")
        place = made
        for step in path:
            place = place[step]
        place[last] = value
    return made


def with_figures(sizing: MachineSizing, machine: dict[str, Any], constant: float = 1.0) -> Any:
    """Power of the same drives in a machine of other figures, their torque constant times a factor."""
    other = load_machine(machine)
    axes = []
    for one in sizing.axes:
        motor, spec = one.best.motor, other.axis(one.name).spec
        moved = replace(motor, torque_constant=motor.torque_constant * constant,
                        back_emf_constant=motor.torque_constant * constant,
                        no_load_current=motor.no_load_current / constant)  # fmt: skip
        made = problem(spec, one.result.problem.catalog)
        result = replace(one.result, problem=made, sets=(replace(one.best, motor=moved),))
        axes.append(replace(one, result=result))
    return machine_power(other, axes)


def test_shares_and_percentiles_are_those_of_plain_monte_carlo(sizing):
    """Figures drawn one by one, written into the file and read again; the same drives in that machine."""
    rng = np.random.default_rng(3)
    peaks, fails = [], 0
    for _ in range(80):
        x, y, start, volts, k = rng.uniform([1.6, 1.44, 30.0, 46.0, 0.9], [2.4, 2.16, 90.0, 50.0, 1.1])
        power = with_figures(sizing, written({
            "axes.x.load.mass": f"{x} kg", "axes.y.load.mass": f"{y} kg", "axes.y.start": f"{start} ms",
            "supply.nominal": f"{volts} V",
        }), k)  # fmt: skip
        peaks.append(power.peak)
        fails += power.status == "fail"
    found = sizing.power.reliability
    share, error = 1.0 - fails / 80, 3.0 * np.sqrt(0.25 / 80)
    assert 0.1 < share < 0.9 and abs(found.probability - share) <= found.error + error
    peak = next(one for one in found.figures if one.name == "supply_peak")
    for value, (low, high) in ((peak.low, (0.0, 0.14)), (peak.middle, (0.38, 0.62)), (peak.high, (0.86, 1.0))):
        assert np.quantile(peaks, low) < value < np.quantile(peaks, high)
    assert peak.low < 0.8 * peak.middle and peak.high > 1.2 * peak.middle  # it does vary
    assert found.weakest == "Supply current, all axes" and not found.unknown


def test_one_figure_fails_where_it_alone_passes_the_limit(sizing):
    """Of one uniform mass the share that passes ends where the supply is just strong enough, found by bisection."""
    plain = written({"supply.nominal": "48 V", "axes.y.load.mass": "1.8 kg", "axes.y.start": "60 ms"})
    low, high = 1.6, 2.4
    for _ in range(12):
        middle = (low + high) / 2
        failed = with_figures(sizing, written({"axes.x.load.mass": f"{middle} kg"}, plain)).status == "fail"
        low, high = (low, middle) if failed else (middle, high)
    exact = load_machine(written({"tolerances": EXACT}, plain))
    axes = _sized_as(sizing, exact)
    power = over_tolerances(exact, axes, machine_power(exact, axes), Sampling(64, 5, 0.9))
    found, share = power.reliability, (low - 1.6) / 0.8
    assert 0.1 < share < 0.8 and found.probability == pytest.approx(share, abs=1 / 16)
    check = next(one for one in power.checks if one.name == "supply_confidence")
    assert (check.status, check.demand, check.limit) == ("fail", 0.9, found.probability)
    assert power.status == "fail" and check.title == "Probability that no limit of the supply is exceeded"


def _sized_as(sizing: MachineSizing, machine: Any) -> list[AxisSizing]:
    """The axes of another machine with the same drives."""
    return [
        replace(
            one, result=replace(one.result, problem=problem(machine.axis(one.name).spec, one.result.problem.catalog))
        )
        for one in sizing.axes
    ]


def test_a_battery_s_capacity_decides_its_autonomy(sizing):
    """The run time goes with the capacity: the share of a uniform one above that which is needed."""
    battery = {"chemistry": "LiFePO4", "series": 15, "nominal_voltage": "3.2 V", "capacity": "1 A*h",
               "resistance": "20 mohm", "autonomy": "1 h"}  # fmt: skip
    figures = {"supply": {"nominal": "48 V"}, "axes.x.load.mass": "2 kg", "axes.y.load.mass": "1.8 kg",
               "axes.y.start": "60 ms", "tolerances": EXACT, "battery": battery}  # fmt: skip
    plain = written(figures)
    nominal = next(c for c in with_figures(sizing, plain).checks if c.name == "battery_autonomy")
    needed = nominal.demand / nominal.limit
    uncertain = written({"battery.capacity": f"{needed * 1.2} A*h ± 50 %"}, plain)
    machine = load_machine(uncertain)
    assert not any(one.spec.toleranced for one in machine.axes)
    axes = _sized_as(sizing, machine)
    power = over_tolerances(machine, axes, machine_power(machine, axes), Sampling(32, 1, None))
    spread = next(one for one in power.reliability.checks if one.name == "battery_autonomy")
    assert spread.passes == pytest.approx((1.8 - 1.0) / 1.2, abs=0.1)
