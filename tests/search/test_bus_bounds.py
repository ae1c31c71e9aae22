"""Energy that a supply does not take: decided by bounds, and from the waveform of few drives alone."""

from __future__ import annotations

import numpy as np
import pytest
from specs import estimates_off
from starters import STARTERS

from drivesizer.machine.problem import problem
from drivesizer.physics.cycle_at_gearhead import ACCELERATION, BRAKING
from drivesizer.spec.robot import load_spec


def spec_of(name, supply):
    spec = estimates_off(load_spec(STARTERS / f"{name}.yaml"))
    return spec.model_copy(update={"supply": spec.supply.model_copy(update={"accepts": None, **supply})})


def test_what_load_and_masses_give_back_is_their_energy(catalog):
    """Of a mass that is lowered m g h at the drum, of 1 kg*m^2 behind a belt of 2 the energy of its speed, twice."""
    given = problem(spec_of("hoist", {}), catalog)
    load, motion, (case,) = given.spec.load, given.spec.motion, given.cases
    at = case.at_belt.behind(2.0)
    braked = at.base.braked * at.scale * at.belt
    assert list(np.flatnonzero(braked)) == [BRAKING, ACCELERATION]
    fastest = 2.0 * load.falls * motion.speed / (load.drum_diameter / 2.0)
    assert braked[ACCELERATION] == pytest.approx(2 * fastest**2 / 2.0)
    height = motion.speed * (motion.cruise_time + motion.acceleration_time)
    lowered = (load.mass * 9.80665 - load.friction_force) * height * load.rope_efficiency
    assert braked[BRAKING] == pytest.approx(lowered, rel=1e-3)
