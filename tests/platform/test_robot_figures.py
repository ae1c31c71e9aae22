"""Figures of a robot by the names of (21)-(59): by hand for the paper's robot, and which equations hold for others."""

import math
from dataclasses import replace

import numpy as np
import pytest
from platform_vehicles import VEHICLE
from platforms import ALPHA, INERTIA, LENGTH, MASS, RADIUS, WHEEL, mecanum

from drivesizer.files.yaml_source import YamlSource
from drivesizer.load_cases import load_cycle
from drivesizer.output.platform import hardest_instant
from drivesizer.platform.dynamics import dynamics
from drivesizer.platform.robot_figures import (
    _OF_ITS,
    Instant,
    figures,
    matrices,
    mobility,
    robot_at_instant,
    wheel_table,
)
from drivesizer.spec.robot import read_spec
from drivesizer.units import registry

LX, LY = LENGTH * math.cos(ALPHA), LENGTH * math.sin(ALPHA)  # 238.5 mm, 135.0 mm
SIDE = np.array([[1, 1, 1], [1, -1, -1], [1, 1, -1], [1, -1, 1]])  # signs of forward, sideways and turning
AT = Instant(np.array([1.2, -0.7, 0.4]), np.array([0.9, 0.35, 0.8]), np.array([0.5, -0.3, 0.6]))


def by_name(d):
    return {one.name: one for one in [wheel_table(d), mobility(d), *matrices(d)]}


def test_the_inertia_of_the_papers_robot_by_hand():
    """Forward and sideways all wheels turn with v / r: m + 4 J / r²; turning I + 4 J (l / r)²."""
    found = by_name(dynamics(mecanum()))["M_bar"]
    along, turning = MASS + 4 * WHEEL / RADIUS**2, INERTIA + 4 * WHEEL * ((LX + LY) / RADIUS) ** 2
    assert found.values == pytest.approx(np.diag([along, along, turning]), rel=1e-12, abs=1e-12)
    assert [found.units[i][i] for i in range(3)] == ["kg", "kg", "kg*m^2"] and found.equations == (50,)


def test_the_inertia_is_the_curvature_of_the_kinetic_energy():
    """T of body and wheels, differentiated by numbers; the centre of mass off the reference point."""
    p = replace(mecanum(), x=0.04, y=-0.03)

    def kinetic(eta):
        v_x, v_y, turn = eta
        speeds = SIDE @ [v_x, v_y, (LX + LY) * turn] / RADIUS
        body = p.mass * ((v_x - p.y * turn) ** 2 + (v_y + p.x * turn) ** 2) + p.inertia * turn**2
        return (body + WHEEL * (speeds**2).sum()) / 2

    h, unit = 1e-3, np.eye(3)
    curved = [[(kinetic(h * (a + b)) - kinetic(h * (a - b))) / (2 * h**2) for b in unit] for a in unit]
    assert by_name(dynamics(p))["M_bar"].values == pytest.approx(np.array(curved), rel=1e-8, abs=1e-8)
    assert figures(dynamics(p), AT)["T"] == pytest.approx(kinetic(AT.eta), rel=1e-12)


def test_the_instant_is_that_of_the_largest_torque_straight_ahead():
    """1.5 m/s in 2 s, up a slope: the end of the acceleration, with M̄ of the level and the weight by hand."""
    layout = "platform: {layout: {kind: mecanum, wheelbase: 477 mm, track: 270 mm}, inertia: 2 kg*m^2}\n"
    spec = read_spec(YamlSource(VEHICLE % 3 + layout, "a.yaml"))
    found = hardest_instant(spec)
    assert found.instant.eta == pytest.approx([1.5, 0.0, 0.0]) and found.instant.eta_dot == pytest.approx(
        [0.75, 0.0, 0.0]
    )
    assert (found.time, found.wheel) == (2.0, 1)
    assert found.instant.posture == pytest.approx([0.75 * 2.0**2 / 2, 0.0, 0.0])
    force = robot_at_instant(found.dynamics, found.instant)[1].values[:, 0]
    slope, weight = math.radians(3), 45 * 9.80665
    by_hand = [(45 + 4 * WHEEL / RADIUS**2) * 0.75, 0.0, weight * math.sin(slope), 0.02 * weight * math.cos(slope)]
    assert force == pytest.approx([*by_hand, sum(by_hand)], rel=1e-9)
    cycle = load_cycle(spec)
    assert sum(by_hand) * RADIUS / 4 == pytest.approx(np.abs(cycle.torque).max(), rel=1e-9)


def test_units_of_entries_are_those_of_rows_over_columns():
    ureg = registry()
    for (over, under), unit in _OF_ITS.items():
        found = ureg.Quantity(1.0, over) / ureg.Quantity(1.0, under)
        assert found.to("" if unit == "1" else unit).magnitude == pytest.approx(1.0, rel=1e-12), (over, under)
