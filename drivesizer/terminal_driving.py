"""A platform on its way, at the terminal."""

from __future__ import annotations

from collections.abc import Mapping

from rich.console import Console
from rich.table import Table
from rich.text import Text

from drivesizer import terminal_tables as tables
from drivesizer.driving import Driving
from drivesizer.following_runs import ASSUMED
from drivesizer.platform.deviation import extremes
from drivesizer.platform.following import Followed
from drivesizer.results import DriveSet
from drivesizer.terminal_tables import MARK, STYLE
from drivesizer.units import show

__all__ = ["driven"]

_ASKED = (  # of a wheel: requirement, head
    ("nominal_speed", "speed"), ("maximum_torque_per_motor", "torque"), ("rms_torque_per_motor", "RMS"),
    ("maximum_power_per_motor", "power"), ("returned_power_per_motor", "back"),
)  # fmt: skip


def driven(found: Driving, chosen: DriveSet | None, runs: Mapping[str, Followed]) -> None:
    """Print what each wheel is asked for, and the checks of a set on the way; without a set the former alone."""
    console = tables.console()
    way = found.trajectory
    length, time = show(way.length, "m", "length"), show(way.total, "s", "time")
    tables.heading(console, f"{found.spec.name}: {length} in {time}", *_status(chosen))
    console.print(_wheels(found))
    if chosen:
        console.print(Text(chosen.label))
        console.print(tables.checks(chosen.checks, "The set on this way"))
        _machine(console, chosen)
    if runs:
        console.print(_followed(runs))
        for said in ASSUMED:
            console.print(Text(said, style="dim"))


def _followed(runs: Mapping[str, Followed]) -> Table:
    """Largest deviations of each run, and how long a wheel stood at its torque limit."""
    found = {name: extremes(run) for name, run in runs.items()}
    table = tables.bare(
        ("", "left"), *((name, "right") for name in runs), title="How it follows: largest along the way"
    )
    for row in zip(*found.values(), strict=True):
        table.add_row(row[0].title, *(show(one.value, one.unit, one.kind, 3) for one in row))
    limited = (show(float(run.limited.max()), "%", "dimensionless", 3) for run in runs.values())
    table.add_row("Time of a wheel at its torque limit", *limited)
    return table


def _status(chosen: DriveSet | None) -> tuple[str, str]:
    return (MARK[chosen.status], STYLE[chosen.status]) if chosen else ("no set", "")


def _machine(console: Console, chosen: DriveSet) -> None:
    if chosen.budget:
        console.print(tables.checks(chosen.budget, "The machine on this way"))


def _wheels(found: Driving) -> Table:
    heads = [(head, "right") for _, head in _ASKED]
    table = tables.bare(("wheel", "right"), *heads, ("friction needed", "right"), title="What the wheels are asked for")
    for wheel in found.wheels:
        asked = {r.name: r.text for r in wheel.asked}
        table.add_row(str(wheel.number), *(asked[name] for name, _ in _ASKED), _friction(wheel.grip, found))
    return table


def _friction(grip: object, found: Driving) -> str:
    """Coefficient at the worst moment, where the wheel's load is known."""
    demand, limit = getattr(grip, "demand", float("nan")), getattr(grip, "limit", float("nan"))
    mu = getattr(found.spec.load, "friction_coefficient", None)
    return show(demand / limit * mu, "1", "dimensionless") if mu and limit == limit else "unknown"
