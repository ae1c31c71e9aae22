"""The machine with the drive: budgets, masses, a platform's figures, battery, regenerated energy."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from math import isinf, isnan, radians
from typing import TYPE_CHECKING

from drivesizer.load_cases.platform import Driving
from drivesizer.machine.platform_budget import PermittedSpeeds
from drivesizer.output import platform
from drivesizer.output.document import records as doc
from drivesizer.output.document.content import Content, OfDrives
from drivesizer.output.document.rows import check_table, consumers_table, figures_table, masses_table
from drivesizer.physics.load_cycle import OwnLimit
from drivesizer.platform.robot_figures import Numbers
from drivesizer.results.drive_set import DriveSet

if TYPE_CHECKING:
    from drivesizer.control.path_following import Followed

# -- budgets and masses


_OF_MASSES = ("mass_known", "mass_left")  # figures that belong below the masses that they sum


def machine(of: OfDrives, drive: DriveSet) -> Iterator[doc.Block]:
    """Budgets and masses of the machine."""
    if not drive.budget:
        return
    cases = "; each in its worst load case" if of.cases else ""
    yield check_table(f"The machine's budgets, which more than the choice of the motor decides{cases}", drive.budget,
                      "budget", grouped=True)  # fmt: skip
    others = [f for f in drive.machine if f.name not in _OF_MASSES]
    figures = [figures_table("Figures of the machine without a limit", others, "machine")] if others else []
    if drive.masses:
        yield doc.Pair([*mass_blocks(drive)], figures)
    else:
        yield from figures


def mass_blocks(drive: DriveSet) -> Iterator[doc.Block]:
    """The masses of the machine one by one, their sum, and what it lacks."""
    yield masses_table(drive.masses, [f for f in drive.machine if f.name in _OF_MASSES])
    lacks = ", ".join(dict.fromkeys(mass.name for mass in drive.masses if isnan(mass.each)))
    if lacks:
        yield doc.Words(f"Not known and not in the sum: {lacks}.", "note")


# -- battery, and what the drives regenerate


def battery_picture(content: Content) -> Iterator[doc.Block]:
    """Consumers and charge of the battery as a figure."""
    budget = content.drive.energy if content.drive else None
    if budget is None:
        return
    lacks = " Unknown consumers are not counted." if any(isnan(consumer.mean) for consumer in budget.consumers) else ""
    yield doc.picture("battery", battery=budget.battery, lacks=lacks)


def battery(_: OfDrives, drive: DriveSet) -> Iterator[doc.Block]:
    """Consumers and figures of the battery."""
    budget = drive.energy
    if budget is None:
        return
    yield doc.Pair(
        [consumers_table(budget)], [figures_table(f"The battery: {budget.battery}", budget.figures, "battery")]
    )
    if budget.assumptions:
        yield doc.Bullets("Assumptions of the energy budget:", list(budget.assumptions))


def braking(_: OfDrives, drive: DriveSet) -> Iterator[doc.Block]:
    """Energy that is regenerated, stored and burnt."""
    budget = drive.braking
    if budget is None or not any(figure.value for figure in budget.figures):
        return
    if budget.name:
        yield doc.Words(f"Brake resistor: {budget.name}. Its checks are among the machine's budgets.")
    yield figures_table("What is regenerated, stored and burnt", budget.figures, "braking")
    if budget.assumptions:
        yield doc.Bullets("Assumptions:", list(budget.assumptions))


# -- a platform: its speed by direction, and how it follows its path


def permitted(content: Content) -> Iterator[doc.Block]:
    """Speeds that the drives permit, by direction."""
    permitted_speeds = content.behaviour.permitted if content.behaviour else None
    if permitted_speeds is None:
        return
    with_motors = platform.failed_motors_text(permitted_speeds) if permitted_speeds.failed else "with all motors"
    yield doc.picture("permitted", motors=with_motors)
    yield from permitted_blocks(permitted_speeds)


def permitted_blocks(permitted_speeds: PermittedSpeeds) -> Iterator[doc.Block]:
    """Speeds of a quarter turn, and what limits them."""
    with_motors = platform.failed_motors_text(permitted_speeds) if permitted_speeds.failed else "with all motors"
    heads = [
        platform.failed_motors_text(permitted_speeds),
        *(f"without {failed}" for failed in permitted_speeds.speed if failed),
    ]
    columns = [*(doc.Column(re.sub(r"\W+", "_", head), head, "number") for head in heads),
               doc.Column("note", f"limited, {with_motors}, by", "small", media="paper")]  # fmt: skip
    rows = []
    for degrees in range(0, 91, 15):
        here = list(permitted_speeds.at(degrees).values())
        speeds = [doc.Quantity(v, "m/s", "speed", 3, own="–" if isnan(v) else "any" if isinf(v) else "")
                  for v, _ in here]  # fmt: skip
        if not isnan(here[0][0]):
            cells = dict[str, doc.Cell](zip((c.key for c in columns), [*speeds, here[0][1]], strict=True))
            rows.append(doc.Row({"title": f"{degrees} °", **cells}, name=str(degrees)))
    yield doc.table("permitted", platform.SPEEDS, rows, more=columns)
    yield doc.Bullets("In these speeds:", [*platform.speed_remarks(permitted_speeds)])


def followed(content: Content) -> Iterator[doc.Block]:
    """Deviations from the path, simulated and measured."""
    does = content.behaviour
    if does is None or does.path is None:
        return
    if not does.followed:
        yield doc.Words(f"Not simulated: {does.not_followed}", "alarm")
        return
    plain = "; of the runs those with P loops, poses not fed back" if len(does.followed) > 4 else ""
    yield doc.picture("followed", runs=plain)
    yield from followed_blocks(does.path, content.drive, does.followed)


def followed_blocks(path: Driving, drive: DriveSet | None, runs: Mapping[str, Followed]) -> Iterator[doc.Block]:
    """Largest deviations of each run, below those that were measured."""
    from drivesizer.control.path_following import assumed, extremes

    keys = ("position", "heading", "slip", "torque of a wheel", "use of the floor's grip")
    head = "model, speed loops, poses, what the model knows" if len(runs) > 4 else "run"
    columns = [doc.Column(key, key, "number", media="all" if len(runs) < 5 or key in keys[:2] else "paper")
               for key in keys]  # fmt: skip
    columns.append(doc.Column("limited", "at the torque limit", "number"))
    measured = path.spec.platform.following.measured if path.spec.platform else ()
    rows = [doc.Row({"title": f"{row.name}, measured", "position": doc.Quantity(row.position, "m", "length", 3),
                     "heading": doc.Quantity(row.heading, "deg", "angle", 3)}, name=_slug(f"{row.name} measured"))
            for row in measured]  # fmt: skip
    for name, run in runs.items():
        deviations = {deviation.title: deviation for deviation in extremes(run)}
        cells: dict[str, doc.Cell] = {
            key: doc.Quantity(abs(deviations[key].value), deviations[key].unit, deviations[key].kind, 3) for key in keys
        }
        limited = doc.Quantity(float(run.limited.max()), "%", "dimensionless", 3)
        rows.append(doc.Row({"title": name, **cells, "limited": limited}, name=_slug(name)))
    yield doc.table("followed", platform.FOLLOWING, rows, heads={"title": head}, more=columns)
    yield doc.Bullets("In this simulation:", [*assumed(path, drive)])


# -- The platform's kinematics and dynamics in numbers, equations (21)-(59) beside them.


def kinematics_and_dynamics(content: Content) -> Iterator[doc.Block]:
    """Kinematics and dynamics of a platform in numbers."""
    spec = content.result.spec
    if not spec.platform:
        return
    numbers = platform.platform_numbers(spec, content.drive)
    yield doc.Words(doc.sentence("symbols"))
    yield doc.Heading("Kinematics")
    yield numbers_table(numbers.wheels)
    kinematics, dynamics = numbers.matrices[:4], numbers.matrices[4:]
    yield from _pairs([*kinematics[:3:2], *kinematics[1::2]])
    yield numbers_table(numbers.mobility)
    yield doc.Heading("Dynamics")
    yield doc.Words(f"{numbers.rotors} C̄ and C_q are at a turning speed of 1 rad/s, with which they grow.")
    yield from _pairs([table for pair in zip(dynamics[::2], dynamics[1::2], strict=True) for table in pair])
    yield doc.Heading("Forces and torques")
    yield doc.Words(
        f"{numbers.moment} Rolling resistance is that of wheels, rollers and casters, which the paper leaves out."
    )
    yield from map(numbers_table, numbers.at_instant)


def _pairs(tables: list[Numbers]) -> Iterator[doc.Block]:
    """Tables beside each other, two by two."""
    for left, right in zip(tables[::2], tables[1::2], strict=True):
        yield doc.Pair([numbers_table(left)], [numbers_table(right)])


_SI = {"deg": ("rad", radians(1.0)), "mm": ("m", 1e-3)}


def numbers_table(numbers: Numbers) -> doc.Table:
    """A matrix or a table of the platform, each unit once."""
    layout, rows = platform.printed(numbers), []
    keys = [_slug(head) or f"n{n}" for n, head in enumerate(numbers.columns)]
    equation = str(next(iter(numbers.equations), ""))
    for name, texts, values, units in zip(
        numbers.rows, layout.cells, numbers.values.tolist(), numbers.units, strict=True
    ):
        cells: dict[str, doc.Cell] = {"title": name, "symbol": numbers.symbol, "equation": equation}
        for key, text, value, unit in zip(keys, texts, values, units, strict=True):
            si, factor = _SI.get(unit, (unit, 1.0))
            cells[key] = doc.Quantity(value * factor, unit if unit in _SI else si, _KIND.get(unit, "plain"), own=text)
        rows.append(doc.Row(cells, name=_slug(f"{numbers.name} {name}")))
    named = ", ".join(f"({number})" for number in numbers.equations)
    caption = f"{numbers.meaning} {named}: {platform.formula(numbers)}" if named else numbers.meaning
    caption += f", in {layout.unit}" if layout.unit else ""
    columns = [doc.Column(key, head, "number") for key, head in zip(keys, layout.heads, strict=True)]
    return doc.table("numbers", caption, rows, more=columns)


def _slug(name: str) -> str:
    return re.sub(r"\W+", "_", name.replace("θ", "theta"))


_KIND = {"deg": "angle", "mm": "length"}


# -- a platform on its path: its wheels, a drive there, its speeds and how it follows


def driving_blocks(
    driving: Driving, drive: DriveSet | None, runs: Mapping[str, Followed], speeds: PermittedSpeeds | None
) -> Iterator[doc.Block]:
    """Requirements at each wheel, checks of a drive on the path, its speeds by direction, the runs that follow it."""
    rows = []
    for wheel in driving.wheels:
        cells: dict[str, doc.Cell] = {"wheel": doc.Quantity(wheel.number), "friction": _friction(wheel.grip, driving)}
        cells |= {r.name: doc.Quantity(float(r.value), r.unit, r.kind) for r in wheel.requirements}
        rows.append(doc.Row(cells, name=f"wheel_{wheel.number}"))
    yield doc.table("wheels", "Requirements at the wheels", rows)
    if drive:
        yield doc.Words(drive.label)
        yield check_table("The drive on this path", drive.checks)
        if drive.budget:
            yield check_table("The machine on this path", drive.budget)
    if speeds:
        yield from permitted_blocks(speeds)
    if runs:
        yield from followed_blocks(driving, drive, runs)


def _friction(grip: OwnLimit | None, driving: Driving) -> doc.Cell:
    """Coefficient at the worst moment, where the wheel's load is known."""
    mu = getattr(driving.spec.load, "friction_coefficient", None)
    if grip is None or not mu or isnan(grip.limit):
        return "unknown"
    return doc.Quantity(grip.demand / grip.limit * mu, "1", "dimensionless") if grip.limit > 0.0 else "lifts off"
