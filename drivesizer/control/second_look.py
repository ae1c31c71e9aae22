"""The loops once more by python-control: poles, margins and step responses beside those of ``loop_analysis``.

Loaded on request alone: importing python-control takes longer than all else that ``drivesizer validate`` does.
"""

from __future__ import annotations

from math import isclose, isfinite, isnan, radians
from typing import Any, NamedTuple

import control
import numpy as np

from drivesizer.control.loop_analysis import opened_loops
from drivesizer.control.loop_records import Loop
from drivesizer.control.sampled import System

__all__ = ["AGREED", "Compared", "compared"]

AGREED = 1e-4  # relative: python-control interpolates between the points of a response


class Compared(NamedTuple):
    """A figure of a loop, found by two programs."""

    loop: Loop
    figure: str  # attribute of the loop
    ours: float
    theirs: float

    @property
    def agrees(self) -> bool:
        """Whether they are the same figure, or both say that there is none."""
        if isnan(self.ours) or isnan(self.theirs):
            return isnan(self.ours) and isnan(self.theirs)
        return isclose(self.ours, self.theirs, rel_tol=AGREED, abs_tol=AGREED)


def compared(train: Any, controller: Any, loops: tuple[Loop, ...]) -> tuple[Compared, ...]:
    """Figures of loops beside those that python-control finds for the same open loops.

    Parameters
    ----------
    train, controller
        As :func:`drivesizer.control.loop_analysis.analyse` takes them.
    loops
        What it has found.

    Returns
    -------
    tuple of Compared
        Largest pole, margins [rad, factor] and overshoot [share] of each loop; an unstable one has its pole alone.
    """
    return tuple(row for loop in loops for row in _of(loop, opened_loops(train, controller)[loop.name]))


def _of(loop: Loop, directions: dict[str, System]) -> list[Compared]:
    """Rows of a loop: its margins are the least of both directions of power, all else is of its own."""
    own = directions[loop.direction]
    closed = _closed(own)
    rows = [Compared(loop, "pole_radius", loop.pole_radius, float(max(abs(control.poles(closed)), default=0.0)))]
    if not loop.stable:
        return rows
    found = [control.stability_margins(_fed(one, loop), returnall=True) for one in directions.values()]
    gains = [float(g) for one in found for g in one[0] if g > 1.0]
    phases = [abs(radians(float(p))) for one in found for p in one[1]]
    return [
        *rows,
        Compared(loop, "gain_margin", loop.gain_margin, min(filter(isfinite, gains), default=np.nan)),
        Compared(loop, "phase_margin", loop.phase_margin, min(phases, default=np.nan)),
        Compared(loop, "overshoot", loop.overshoot, _overshoot(closed, len(loop.step))),
    ]


def _fed(opened: System, loop: Loop) -> Any:
    """Frequency response from the error to what is fed back, between whose points python-control interpolates: its
    polynomials are ill-conditioned for slow loops."""
    fed = control.ss(*opened)[len(opened.C) - 1, 0]
    return control.frequency_response(fed, 2.0 * np.pi * loop.bode.frequency[:-1])


def _closed(opened: System) -> Any:
    """From the reference to the first output, with the last one fed back."""
    whole = control.ss(*opened)
    back = np.zeros((1, len(opened.C)))
    back[0, -1] = 1.0
    return control.feedback(whole, control.ss([], [], [], back, opened.dt))[0, 0]


def _overshoot(closed: Any, samples: int) -> float:
    """Share of a step by which its response exceeds the final value; NaN where there is none."""
    final = float(np.real(closed.dcgain()))
    if not samples or not isfinite(final) or abs(final) <= 1e-9:
        return np.nan
    time = np.arange(samples) * closed.dt
    return max(float(np.max(control.step_response(closed, time).outputs) / final) - 1.0, 0.0)
