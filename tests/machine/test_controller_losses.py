"""Losses of controllers and the resistance of the supply in a sized drive: by hand, and against the closed loop."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import by_hand
import numpy as np
import pytest
from specs import estimates_off
from starters import starter

from drivesizer.catalog import Catalog
from drivesizer.machine.set_cycle import set_cycle
from drivesizer.machine.supply_power import EnergyFlow, energy_flow
from drivesizer.results.drive_set import DriveSet
from drivesizer.simulate import validate
from drivesizer.sizing import explain, size
from drivesizer.spec.robot import RobotSpec

pytestmark = pytest.mark.usefixtures("no_further_searches")

OHM = 0.08  # of source and cables


def given(spec: RobotSpec, section: str, **figures: Any) -> RobotSpec:
    return spec.model_copy(update={section: getattr(spec, section).model_copy(update=figures)})


def demand(one: DriveSet, name: str) -> float:
    return next(check.demand for check in (*one.checks, *one.beside) if check.name == name)


def figure(proof: Any, name: str) -> float:
    return next(float(f.value) for f in proof.figures if f.name == name)


@pytest.fixture(scope="module")
def hoist(tmp_path_factory: pytest.TempPathFactory) -> RobotSpec:
    return estimates_off(starter("hoist", tmp_path_factory.mktemp("hoist")))


@pytest.fixture(scope="module")
def best(hoist: RobotSpec, catalog: Catalog) -> DriveSet:
    return next(one for one in size(hoist, catalog=catalog, top=30).sets if one.controller.voltage_drop == 1.0)


def again(spec: RobotSpec, one: DriveSet, catalog: Catalog) -> DriveSet:
    only = {
        section: getattr(spec.select, section).model_copy(update={"part": [getattr(one, section).part]})
        for section in ("controller", "encoder")
    }
    return explain(given(spec, "select", **only), one.motor.part, one.gearhead.part, catalog=catalog)[0]


# --- voltage


def test_what_the_resistances_take_of_the_voltage(hoist: RobotSpec, best: DriveSet, catalog: Catalog) -> None:
    """Largest over the cycle of R I + k_e w and what bridge and source take of it, the winding as warm as it is."""
    spec = given(given(hoist, "supply", resistance=OHM), "power_stage", resistance=0.05)
    found, flows = again(spec, best, catalog), set_cycle(hoist, best)
    n, duty, lowest = hoist.load.motors, best.controller.max_duty, hoist.supply.lowest
    loss = by_hand.loss_per_ampere(best.controller)
    leads = 0.05 + n * OHM * duty * (duty + (loss - duty * 1.0) / lowest)
    p, R_25, cold = flows.pieces, best.motor.resistance, 1.0 + 0.0039 * (hoist.environment.ambient - 298.15)
    current, warm = np.array([p.I_0, p.I_1]), cold + 0.0039 * np.array([p.rise_0, p.rise_1])
    induced = flows.drive.emf * np.array([p.w_0, p.w_1])
    volts = [np.abs(induced + (R_25 * x + r) * current).max()
             for x in (cold, warm) for r in (0.0, leads)]  # fmt: skip
    assert demand(found, "supply_voltage") == pytest.approx(max(volts), rel=2e-3)
    assert demand(found, "supply_voltage") > demand(best, "supply_voltage") + 0.5 * leads * np.abs(current).max()


def test_a_source_that_sags_below_what_the_motor_needs_fails(
    hoist: RobotSpec, best: DriveSet, catalog: Catalog
) -> None:
    peak = next(f.value for f in best.figures if f.name == "peak_current")
    room = 0.9 * (hoist.supply.lowest - 1.0) - demand(best, "supply_voltage")
    per_ohm = hoist.load.motors * 0.81 * peak
    regenerated = {f.name: f.value for f in again(hoist, best, catalog).braking.figures}
    for share, status in ((0.3, "pass"), (3.0, "fail")):
        one = again(given(hoist, "supply", resistance=share * room / per_ohm), best, catalog)
        assert next(c.status for c in one.checks if c.name == "supply_voltage") == status
        assert {f.name: f.value for f in one.braking.figures} == regenerated  # no matter of the source


# --- energy, and the closed loop


def flow_of(spec: RobotSpec, one: DriveSet) -> EnergyFlow:
    return energy_flow(set_cycle(spec, one))


@pytest.mark.parametrize("lossy", [False, True])
def test_energy_and_current_of_the_closed_loop_are_those_of_the_budget(
    spec: RobotSpec, catalog: Catalog, lossy: bool
) -> None:
    """The SPS robot on a long cruise, 4 drives: energy taken and largest current of the supply, with all losses."""
    calm = given(given(spec, "motion", cruise_time=6.0, rest_time=1.0), "control", speed_from="exact")
    if lossy:
        calm = given(given(calm, "supply", resistance=OHM), "power_stage", resistance=0.2, standby=3.0)
    (one,) = explain(calm, "118752", "406764", catalog=catalog)
    one = replace(one, motor=replace(one.motor, winding_time_constant=math.nan))  # the winding stays at 25 degC
    proof = validate(given(calm, "plant", warming=False), one)
    flow = flow_of(given(calm, "environment", ambient=298.15), one)
    taken, returned = figure(proof, "energy_in"), figure(proof, "energy_returned")
    assert taken - returned == pytest.approx(flow.drawn - flow.returned, rel=0.03)
    total = flow.copper + flow.friction + flow.gearhead + flow.belt + flow.load + flow.rotor + flow.controller
    assert flow.drawn == pytest.approx(total + flow.supply + flow.returned, rel=1e-9)
    assert (flow.supply > 0.0) is lossy
