"""Loops whose figures have closed forms."""

from __future__ import annotations

from math import asin, log, nan, pi

import numpy as np

from drivesizer.control.validation import Bode, Loop


def lag(name: str, gain: float, period: float, direction: str = "", turns: int = 0) -> Loop:
    """The loop L = g/(z - 1): a sampled integrator, whose closed loop has the one pole 1 - g.

    With θ = ωT: |L| = g/(2 sin(θ/2)), arg L = -90° - θ/2, so the crossover is at θ = 2 asin(g/2) with a phase margin of
    90° - θ/2; the gain margin, at the Nyquist frequency, is 2/g. |L/(1 + L)|² = g²/(1 + a² - 2 a cos θ), a = 1 - g, is
    a half where cos θ = (1 + a² - 2 g²)/(2 a). A step's answer is 1 - aⁿ.
    """
    a, nyquist = 1.0 - gain, 0.5 / period
    frequency = np.geomspace(1e-6 * nyquist, nyquist, 1500)
    theta = 2.0 * pi * frequency * period
    opened = gain / (np.exp(1j * theta) - 1.0)
    closed = gain / (np.exp(1j * theta) - a)
    stable, crossing = abs(a) < 1.0, 2.0 * asin(min(gain / 2.0, 1.0))
    level = (1.0 + a * a - 2.0 * gain * gain) / (2.0 * a)
    samples = 4 + round(log(1e-4) / log(abs(a))) if stable else 0
    return Loop(
        name=name,
        direction=direction,
        period=period,
        stable=stable,
        pole_radius=abs(a),
        poles=(complex(a),),
        gain_margin=2.0 / gain if stable else nan,
        gain_reduction=nan,
        phase_margin=pi / 2.0 - crossing / 2.0 if stable else nan,
        crossover=crossing / (2.0 * pi * period) if stable else nan,
        sensitivity=float(np.abs((np.exp(1j * theta) - 1.0) / (np.exp(1j * theta) - a)).max()),
        bandwidth=float(np.arccos(level)) / (2.0 * pi * period) if stable and abs(level) <= 1.0 else nan,
        rise_time=log(1.0 / 9.0) / log(abs(a)) * period if stable else nan,
        overshoot=max(-a, 0.0) if stable else nan,
        settling_time=np.ceil(log(0.02) / log(abs(a))) * period if stable else nan,
        step=1.0 - a ** np.arange(samples) if stable else np.empty(0),
        bode=Bode(
            frequency=frequency,
            open_magnitude=np.abs(opened),
            open_phase=-pi / 2.0 - theta / 2.0 + 2.0 * pi * turns,
            closed_magnitude=np.abs(closed),
            closed_phase=np.unwrap(np.angle(closed)),
        ),
    )


CASCADE = (lag("current", 0.3, 4e-5), lag("velocity", 0.07, 4e-4, "braking"), lag("position", 0.004, 1e-3, "driving"))
UNSTABLE = (CASCADE[0], lag("velocity", 2.6, 4e-4, "braking"))  # a pole at -1.6
