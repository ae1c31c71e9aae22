"""Warnings about a loop in words, each with the figure that would be right.

.. [1] K. J. Åström, T. Hägglund, *PID Controllers: Theory, Design, and Tuning*, 2nd ed., ISA 1995, ch. 4: margins.
.. [2] G. Ellis, *Control System Design Guide*, 4th ed., Elsevier 2012, ch. 16: resonance and the loop's bandwidth.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from drivesizer.control.cascade import LEAST_PHASE_MARGIN
from drivesizer.control.loop_records import Loop, Loops
from drivesizer.loads.course import Profile
from drivesizer.physics.counted_speed import COUNT_SHARE, speed_quantum
from drivesizer.units import show

__all__ = ["loop_warnings", "resolution_warning", "resonance_warning", "shortest_ramp"]

RESONANCE_SHARE = 0.2  # a bandwidth above a fifth of the resonance is near it [2]
_RISE = math.log(9.0) / (2.0 * math.pi)  # bandwidth times rise time (10-90 %) of a first-order lag, 0.35


def _hertz(figure: float) -> str:
    return show(figure, "Hz", "frequency", 3)


def loop_warnings(loops: Iterable[Loop], profile: Profile | None = None) -> list[str]:
    """Warnings about loops that are unstable, ring, or are slower than a profile requires."""
    ramp = shortest_ramp(profile) if profile else math.nan
    said = []
    for loop in loops:
        where = f"the {loop.name} loop" + (f", {loop.direction}," if loop.direction else "")
        if not loop.stable:
            said.append(f"{where} is unstable with these gains: largest pole {loop.pole_radius:.4g}, stable inside 1")
        elif loop.phase_margin < LEAST_PHASE_MARGIN:
            margin, least = (f"{math.degrees(figure):.3g}°" for figure in (loop.phase_margin, LEAST_PHASE_MARGIN))
            said.append(f"{where} rings: phase margin {margin}, expected {least} at least")
        if loop.stable and loop.bandwidth < _RISE / ramp:
            said.append(
                f"the {loop.name} loop is slower than the profile: bandwidth {_hertz(loop.bandwidth)}, and the "
                f"shortest ramp, {show(ramp, 's', 'time', 3)}, needs {_hertz(_RISE / ramp)}"
            )
    return said


def shortest_ramp(profile: Profile) -> float:
    """Shortest time in which a profile goes from one constant or extreme speed to the next [s]; NaN: none.

    Successive straight pieces in one direction are one ramp, so that the rounded ramp of an S-curve counts whole.
    """
    ramps: list[float] = []
    sign = 0.0
    for t0, t1, v0, v1 in profile.pieces():
        before, sign = sign, math.copysign(1.0, v1 - v0) if v1 != v0 else 0.0
        if sign and sign == before:
            ramps[-1] += t1 - t0
        elif sign:
            ramps.append(t1 - t0)
    return min(ramps, default=math.nan)


def resonance_warning(loops: Loops, stiffness: float) -> list[str]:
    """Warning where the bandwidth that the gains have on a stiff shaft reaches the resonance [2]."""
    wanted, most = loops.rigid_bandwidth, RESONANCE_SHARE * loops.resonance
    if not wanted > most:
        return []
    inside = "within" if wanted >= loops.anti_resonance else "near"
    stiffer = stiffness * (wanted / most) ** 2  # a frequency goes with the root of the stiffness
    return [
        f"the load swings against the motor {inside} the bandwidth of {_hertz(wanted)} that the velocity loop has with "
        f"a stiff shaft: anti-resonance at {_hertz(loops.anti_resonance)}, resonance at {_hertz(loops.resonance)}; "
        f"expected a bandwidth below a fifth of that, {_hertz(most)}, or a stiffness above {stiffer:.3g} N·m/rad"
    ]


def resolution_warning(lines: float, time: float, kp: float, peak: float, kind: str = "current") -> list[str]:
    """Warning where one encoder count is answered with much of the controller's range."""
    quantum = speed_quantum(lines, time)
    if not quantum * kp > COUNT_SHARE * peak:  # unknown too
        return []
    answer, most = (show(figure, "A" if kind == "current" else "V", kind, 3) for figure in (quantum * kp, peak))
    return [
        f"one encoder count over {show(time, 'ms', 'time', 3)} is {show(quantum, 'rpm', 'rotary_speed', 3)}, answered "
        f"with {answer} of {most}: expected {COUNT_SHARE:.0%} at most, by more encoder lines, less gain, or counts "
        "over a longer time"
    ]
