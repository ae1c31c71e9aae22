"""A platform on its way, at the terminal."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table
from rich.text import Text

from drivesizer import terminal_tables as tables
from drivesizer.driving import Driving
from drivesizer.results import DriveSet
from drivesizer.terminal_tables import MARK, STYLE
from drivesizer.units import show

__all__ = ["driven"]

_ASKED = (  # of a wheel: requirement, head
    ("nominal_speed", "speed"), ("maximum_torque_per_motor", "torque"), ("rms_torque_per_motor", "RMS"),
    ("maximum_power_per_motor", "power"), ("returned_power_per_motor", "back"),
)  # fmt: skip


def driven(found: Driving, chosen: DriveSet | None) -> None:
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
