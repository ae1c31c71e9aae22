"""A motor at a constant voltage against its data sheet, and against SciPy's integrator."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drivesizer.physics.at_voltage import Winding, coast_down_time, operating_point, step_peak_current, step_time

# maxon DCX 22 S, graphite brushes, 12 V (DCX22S01EBKL598), as the shop prints it
R, L, K_T, J, I_0 = 3.69, 0.231e-3, 18.4e-3, 5.55e-7, 19.6e-3
DRY = K_T * I_0


@pytest.mark.parametrize("inductance", [L, 30 * L, 400 * L])
@pytest.mark.parametrize("viscous", [0.0, 2e-7])
def test_step_is_that_of_the_differential_equations(inductance, viscous):
    """Also of a winding so slow that the speed overshoots."""
    dry = 40 * DRY
    winding = Winding(R, inductance, K_T, 1.07 * K_T)

    def slopes(_, x):
        return [(12.0 - R * x[0] - 1.07 * K_T * x[1]) / inductance, (K_T * x[0] - dry - viscous * x[1]) / J]

    starts = -inductance / R * np.log(1.0 - dry * R / (K_T * 12.0))
    span = 8 * J * R / K_T**2 + 3 * inductance / R
    found = solve_ivp(slopes, (0, span), [dry / K_T, 0], rtol=1e-9, atol=1e-12, dense_output=True, max_step=span / 500)
    t = np.linspace(0, span, 200_001)
    current, speed = found.sol(t)
    final, _ = operating_point(winding, 12.0, dry, viscous)
    for share in (0.3, 0.63, 0.95):
        expected = starts + t[np.argmax(speed >= share * final)]
        assert step_time(winding, 12.0, dry, viscous, J, share) == pytest.approx(expected, rel=1e-3, abs=2 * t[1])
    peak = step_peak_current(winding, 12.0, dry, J)
    assert peak == pytest.approx(current.max(), rel=1e-6 if viscous == 0.0 else 2e-2)


def test_step_at_a_limit_of_current_and_coasting_against_an_integrator():
    winding, dry, viscous = Winding(R, np.nan, K_T, K_T), 3 * DRY, 3e-7

    def driven(_, w):
        return (K_T * np.minimum((12.0 - K_T * w) / R, 1.3) - dry - viscous * w) / J

    t = np.linspace(0, 0.1, 100_001)
    speed = solve_ivp(driven, (0, 0.1), [0], rtol=1e-9, atol=1e-9, max_step=1e-4, dense_output=True).sol(t)[0]
    final, _ = operating_point(winding, 12.0, dry, viscous)
    for share in (0.2, 0.95):
        expected = t[np.argmax(speed >= share * final)]
        assert step_time(winding, 12.0, dry, viscous, J, share, 1.3) == pytest.approx(expected, abs=2e-6)
    coast = solve_ivp(lambda _, w: -(dry + viscous * w) / J, (0, 5), [600], rtol=1e-10, atol=1e-10,
                      events=lambda _, w: w[0] - 1e-9)  # fmt: skip
    assert coast_down_time(J, dry, viscous, 600.0) == pytest.approx(coast.t_events[0][0], rel=1e-8)


def test_edges():
    winding = Winding(R, L, K_T, K_T)
    assert np.isinf(step_time(winding, 12.0, 1.0, 0.0, J, 0.63))  # friction holds it
    assert np.isinf(step_time(winding, 12.0, DRY, 0.0, J, 0.63, limit=I_0 / 2))
    assert np.isnan(step_time(winding, 12.0, np.nan, 0.0, J, 0.63))
    assert np.isinf(coast_down_time(J, 0.0, 1e-7, 600.0))
    assert coast_down_time(J, 0.0, 1e-7, 600.0, 300.0) == pytest.approx(J / 1e-7 * np.log(2.0))
    assert coast_down_time(J, 1e-3, 0.0, 600.0, 300.0) == pytest.approx(J * 300.0 / 1e-3)
