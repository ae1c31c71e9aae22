"""What a platform did along its path, as rows of text that a terminal or a report prints."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from drivesizer.platform.deviation import Extreme, extremes
from drivesizer.platform.dynamics import dynamics
from drivesizer.platform.following import Followed, follow
from drivesizer.platform.following_control import speed_loop
from drivesizer.platform.following_example import (
    CASES,
    FLOOR,
    MEASURED,
    OFF,
    Case,
    assumptions,
    paper_robot,
    paper_route,
    run,
)
from drivesizer.platform.misjudged import EXACT, Misjudged
from drivesizer.units import show

__all__ = ["Table", "assumed", "beside_the_paper", "largest", "one_at_a_time"]


class Table(NamedTuple):
    """Heads, rows and what is to be said below them."""

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str


def largest(f: Followed) -> Table:
    """Largest deviations, slip and torque of a run, and how long a wheel stood at its limit.

    Parameters
    ----------
    f
        The run.
    """
    rows = [
        (e.title, show(e.value, e.unit, e.kind, 3), show(e.time, "s", "time", 3), show(e.way, "m", "length", 3))
        for e in extremes(f)
    ]
    most = int(f.limited.argmax())
    lifted = int((f.load <= 0.0).any(axis=1).sum())
    words = f"torque at its limit: {show(f.limited[most], '%', 'dimensionless', 3)} of the time"
    words += f", wheel {most + 1}" * bool(f.limited[most] > 0.0)
    words += f"; {lifted} wheels lift off at times" * bool(lifted)
    return Table(("largest", "value", "at time", "at way"), tuple(rows), words)


def beside_the_paper() -> Table:
    """The paper's two measured errors, and what the simulated path gives in every way to drive it."""
    heads = ("robot model", "speed loops", "poses", "what it knows", "position", "heading", "at limit")
    rows: list[tuple[str, ...]] = [
        (name, "–", "–", "real robot, measured", show(at, "m", "length", 3), show(off, "deg", "angle", 3), "–")
        for name, (at, off) in MEASURED.items()
    ]
    rows += [_row(case) for case in CASES]
    note = (
        "The first two rows are measured by the paper, on a path that it does not give. All others are simulated, on a "
        "path and with figures that are assumed: sizes compare, not digits. Torque that is fed forward takes away what "
        "plain proportional speed loops lag by; loops with an integral find it by themselves. What slip and misjudged "
        "wheels add is the same in both models until poses are fed back."
    )
    return Table(heads, tuple(rows), note)


def _row(case: Case) -> tuple[str, ...]:
    f = run(case)
    by = {e.title: e for e in extremes(f)}
    knows = "all" if case.exact else "not its errors"
    told = (case.model, "PI" if case.integral else "P", "fed back" if case.poses else "open loop", knows)
    position, heading = (show(abs(by[name].value), *_unit(by[name]), 3) for name in ("position", "heading"))
    return *told, position, heading, show(float(f.limited.max()), "%", "dimensionless", 3)


def _unit(e: Extreme) -> tuple[str, str]:
    return e.unit, e.kind


_ONE: tuple[tuple[str, Misjudged], ...] = (
    ("none: slip and controllers alone", EXACT),
    ("all radii 1 % larger", Misjudged(radius=0.01)),
    ("one radius 0.1 % larger", Misjudged(radius=(0.001, 0.0, 0.0, 0.0))),
    ("wheels 1 % farther out", Misjudged(lever=0.01)),
    ("mass and inertia 10 % more", Misjudged(mass=0.1, inertia=0.1)),
    ("payload of 5 kg in front", Misjudged(payload=OFF.payload)),
    ("rolling resistance 0.005 more", Misjudged(rolling_resistance=0.005)),
    ("one motor 5 % weak", Misjudged(motor=(0.0, -0.05, 0.0, 0.0))),
)


def one_at_a_time() -> Table:
    """What each misjudged figure alone comes to on the simulated path, driven by the dynamic model without poses."""
    d = dynamics(paper_robot())
    rows = []
    for name, off in _ONE:
        cells = [name]
        for integral in (True, False):
            speeds = speed_loop(d, limit=8.0, integral=integral)
            f = follow(paper_route(), d.platform, misjudged=off, contact=FLOOR, speeds=speeds)
            by = {e.title: replace(e, value=abs(e.value)) for e in extremes(f)}
            cells += [show(by[n].value, *_unit(by[n]), 3) for n in ("position", "heading")]
        rows.append(tuple(cells))
    heads = ("misjudged", "position, PI", "heading, PI", "position, P", "heading, P")
    note = (
        "Laws: radii larger by e enlarge way and turns by e; one of four larger by e turns it by e/(4 l) over "
        "the way ahead, l = l1 + l2; wheels farther out by e make turns smaller by e/(1 + e)."
    )
    return Table(heads, tuple(rows), note)


def assumed() -> Table:
    """What the simulated path rests on beside the paper's figures."""
    note = "The paper's: 45 kg, radius 76.2 mm, L 274.06 mm, α 29.5°, rollers at 45°."
    return Table(("assumed", "figure"), assumptions(), note)
