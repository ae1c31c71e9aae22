"""Current and voltage of the motor over the cycle, with the limits that they must not pass."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

import numpy as np

from drivesizer.machine.set_cycle import SetCycle, waveform
from drivesizer.output.report.figures.field_panels import TOGETHER
from drivesizer.output.report.figures.load_and_loop import Row, Trace, over_time, stretches
from drivesizer.output.report.figures.style import Form
from drivesizer.output.report.figures.wheels import MOST_WHEELS, each_over_time

__all__ = ["Limits", "current_and_voltage"]

Limits = Sequence[tuple[str, float]]  # name and figure [SI]


def current_and_voltage(
    cases: Sequence[tuple[str, SetCycle]], currents: Limits, voltages: Limits, form: Form = "svg"
) -> bytes:
    """Current and voltage of each moment by the drive model, with the winding as warm as it then is."""
    cases = cases[:MOST_WHEELS]
    traces, cycles = [], []
    for name, found in cases:
        ends, cycle = waveform(found), found.cycle.load_cycle
        columns = {"current": ends.current[0].ravel(), "voltage": ends.voltage[0].ravel()}
        time = np.cumsum(ends.duration)
        traces.append(Trace(name, np.stack([time - ends.duration, time], axis=1).ravel(), columns))
        cycles.append((name, cycle))
    rows = (Row("current", "current", "A", _known(currents)), Row("voltage", "voltage", "V", _known(voltages)))
    draw = each_over_time if len(cases) > TOGETHER else over_time
    return draw(traces, rows, stretches(cycles), form)


def _known(limits: Limits) -> tuple[tuple[str, float], ...]:
    return tuple((name, value) for name, value in limits if isfinite(value))
