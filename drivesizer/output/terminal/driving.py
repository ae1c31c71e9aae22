"""A platform on its path, at the terminal."""

from __future__ import annotations

import math
from collections.abc import Mapping

from rich.console import Console
from rich.table import Table
from rich.text import Text

from drivesizer.control.path_following.following import Followed, extremes
from drivesizer.control.path_following.runs import assumed
from drivesizer.load_cases.platform import Driving
from drivesizer.machine.platform_budget import PermittedSpeeds
from drivesizer.output.platform import FOLLOWING, SPEEDS, speed_heads, speed_remarks, speed_rows, speed_text
from drivesizer.output.terminal import tables as tables
from drivesizer.output.terminal.tables import MARK, STYLE
from drivesizer.physics.load_cycle import OwnLimit
from drivesizer.results.drive_set import DriveSet
from drivesizer.units import show

__all__ = ["driven"]

_OF_A_WHEEL = (  # requirement, head of its column
    ("nominal_speed", "speed"), ("maximum_torque_per_motor", "torque"), ("rms_torque_per_motor", "RMS"),
    ("maximum_power_per_motor", "power"), ("returned_power_per_motor", "returned"),
)  # fmt: skip


_BESIDE = 4  # runs side by side


def driven(
    found: Driving, chosen: DriveSet | None, runs: Mapping[str, Followed], speeds: PermittedSpeeds | None = None
) -> None:
    """Print the requirements at each wheel, the checks of a drive on the path, its speeds."""
    console = tables.console()
    path = found.trajectory
    length, time = show(path.length, "m", "length"), show(path.total, "s", "time")
    tables.heading(console, f"{found.spec.name}: {length} in {time}", *_status(chosen))
    console.print(_wheels(found))
    if chosen:
        console.print(Text(chosen.label))
        console.print(tables.checks(chosen.checks, "The drive on this path"))
        _machine(console, chosen)
    if speeds:
        console.print(Text(SPEEDS, style="bold"))
        console.print(_permitted(speeds))
        for remark in speed_remarks(speeds):
            console.print(Text(remark, style="dim"))
    if runs:
        console.print(_compared(runs, found) if len(runs) > _BESIDE else _followed(runs))
        for assumption in assumed(found, chosen):
            console.print(Text(assumption, style="dim"))


def _permitted(speeds: PermittedSpeeds) -> Table:
    """Speeds of a quarter turn."""
    table = tables.bare(*((head, "right") for head in speed_heads(speeds)))
    for degrees, _, found in speed_rows(speeds):
        table.add_row(degrees, *map(speed_text, found))
    return table


def _followed(runs: Mapping[str, Followed]) -> Table:
    """Largest deviations of each run, and the share of time that a wheel is at its torque limit."""
    found = {name: extremes(run) for name, run in runs.items()}
    table = tables.bare(("", "left"), *((name, "right") for name in runs), title=FOLLOWING)
    for row in zip(*found.values(), strict=True):
        table.add_row(row[0].title, *(show(one.value, one.unit, one.kind, 3) for one in row))
    limited = (show(float(run.limited.max()), "%", "dimensionless", 3) for run in runs.values())
    table.add_row("Time of a wheel at its torque limit", *limited)
    return table


def _compared(runs: Mapping[str, Followed], found: Driving) -> Table:
    """A row for each run, below those that were measured."""
    heads = [(head, "left") for head in ("model", "loops", "poses", "model knows")]
    figures = [(head, "right") for head in ("position", "heading", "at limit")]
    table = tables.bare(*heads, *figures, title=FOLLOWING)
    for one in found.spec.platform.following.measured if found.spec.platform else ():
        table.add_row(one.name, "measured", "", "", *_errors(one.position, one.heading), "")
    for name, run in runs.items():
        by = {one.title: abs(one.value) for one in extremes(run)}
        limited = show(float(run.limited.max()), "%", "dimensionless", 3)
        table.add_row(*name.split(", "), *_errors(by["position"], by["heading"]), limited)
    return table


def _errors(position: float, heading: float) -> tuple[str, str]:
    return show(position, "m", "length", 3), show(heading, "deg", "angle", 3)


def _status(chosen: DriveSet | None) -> tuple[str, str]:
    return (MARK[chosen.status], STYLE[chosen.status]) if chosen else ("no drive", "")


def _machine(console: Console, chosen: DriveSet) -> None:
    if chosen.budget:
        console.print(tables.checks(chosen.budget, "The machine on this path"))


def _wheels(found: Driving) -> Table:
    heads = [(head, "right") for _, head in _OF_A_WHEEL]
    table = tables.bare(("wheel", "right"), *heads, ("friction needed", "right"), title="Requirements at the wheels")
    for wheel in found.wheels:
        required = {r.name: r.text for r in wheel.requirements}
        table.add_row(str(wheel.number), *(required[name] for name, _ in _OF_A_WHEEL), _friction(wheel.grip, found))
    return table


def _friction(grip: OwnLimit | None, found: Driving) -> str:
    """Coefficient at the worst moment, where the wheel's load is known."""
    mu = getattr(found.spec.load, "friction_coefficient", None)
    if grip is None or not mu or math.isnan(grip.limit):
        return "unknown"
    if grip.limit <= 0.0:
        return "lifts off"
    return show(grip.demand / grip.limit * mu, "1", "dimensionless")
