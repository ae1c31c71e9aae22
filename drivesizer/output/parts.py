"""The parts of a drive in its machine, as the report shows them and as a list for ordering."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isnan, nan
from typing import Any

from drivesizer.catalog import Catalog
from drivesizer.machine.mass_budget import drive_rows
from drivesizer.output.part_line import PartLine, line_of, resistor_line
from drivesizer.results import ratings
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.mass import MassRow
from drivesizer.results.problem import Problem
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.transmission import GearStage
from drivesizer.units import show

__all__ = ["OWN_SUPPLY", "machine_parts", "parts_list"]

OWN_SUPPLY = "of its own supply"  # behind the voltage of a brake that is not that of the machine


def parts_list(found: DriveSet, catalog: Catalog, drives: int, belt: float | None = None) -> list[PartLine]:
    """The parts list of a machine: a line for each part of a drive."""
    masses = {row.name: _massed(row) for row in drive_rows(found, drives, catalog, belt)}
    lines = [line_of(role, part, catalog, drives, masses[role]) for role, part in found.parts.items()]
    lines = [replace(x, said=", ".join((x.said, *found.belt_running))) if x.role == "belt" else x for x in lines]
    if found.without_controller:
        lines = [replace(x, said=found.without_controller) if x.role == "controller" else x for x in lines]
    if found.motor.controller:
        lines = [replace(x, said=f"{found.motor.controller} inside") if x.role == "motor" else x for x in lines]
    if found.chosen_screw:
        lines = [replace(x, said=found.chosen_screw.running) if x.role == "screw" else x for x in lines]
    if _bare_belt(found):
        mass = masses.get("belt and pulleys", {})
        lines.insert(_behind_gearhead(found), PartLine(role="belt", said=_ratio(found), quantity=drives, **mass))
    if wanted := _wanted_brake(found):
        place = next((n for n, line in enumerate(lines) if line.role in ("encoder", "controller")), len(lines))
        lines.insert(place, PartLine(role="brake", said=wanted, quantity=drives))
    return lines


def machine_parts(found: DriveSet, problem: Problem) -> list[PartLine]:
    """The parts list of the machine of a sizing."""
    spec = problem.machine
    lines = parts_list(found, problem.catalog, spec.load.motors, spec.belt.mass if spec.belt else None)
    if found.brake and not isnan(found.brake.supply) and _has_own_supply(found, spec):
        lines = [replace(x, said=f"{x.said} {OWN_SUPPLY}") if x.role == "brake" else x for x in lines]
    if spec.gear is not None:
        lines.insert(_behind_belt(spec, lines), _gear_line(spec.gear, spec.load.motors))
    return [*lines, *_supply_lines(found, problem)]


def _has_own_supply(found: DriveSet, spec: RobotSpec) -> bool:
    """Whether the brake of a drive is not on the machine's supply."""
    given = spec.supply.brakes
    apart = any(check.note == ratings.OWN_SUPPLY for check in found.every_check)
    return apart if given is None else given != spec.supply.nominal


def _supply_lines(found: DriveSet, problem: Problem) -> Iterator[PartLine]:
    """Power supply and brake resistor: one each for the whole machine."""
    unit, catalog = problem.machine.supply.part, problem.catalog
    if unit is not None:
        part = catalog.power_supplies.record(catalog.power_supplies.rows[unit])
        yield line_of("power supply", part, catalog, 1, {"mass": part.mass})
    resistor = found.braking.resistor if found.braking else None
    if resistor is not None:
        yield resistor_line(resistor, catalog)


def _gear_line(gear: GearStage, drives: int) -> PartLine:
    """The line of a gear of fixed ratio, which the spec gives."""
    back = gear.fixed_gear().back_efficiency
    behind = ", self-locking" if back <= 0.0 else f", {100 * back:.4g} % driven back" if back != gear.efficiency else ""
    said = f"{gear.ratio:g} : 1, efficiency {100 * gear.efficiency:.4g} %{behind}"
    return PartLine(role=gear.kind, said=said, quantity=drives, mass=nan if gear.mass is None else gear.mass)


def _behind_belt(spec: RobotSpec, lines: Sequence[PartLine]) -> int:
    """The place of a gear in a parts list: behind gearhead and belt, or before the belt."""
    roles = ["gearhead"] if spec.gear_before_belt else ["gearhead", "belt", "driven pulley"]
    return 1 + max((n for n, line in enumerate(lines) if line.role in roles), default=0)


def _massed(row: MassRow) -> dict[str, Any]:
    """The mass of one part, with its band where it is estimated."""
    low, high = row.band or (nan, nan)
    return {"mass": row.each, "mass_low": low, "mass_high": high}


def _wanted_brake(found: DriveSet) -> str:
    """The brake that a drive must have to hold its load and that no catalogue lists, in words; else nothing."""
    checks = {check.name: check for check in found.own_checks}
    fits, holding = checks.get("brake_fits"), checks.get("holding")
    if found.brake is not None or fits is None or fits.status != "unknown" or holding is None:
        return ""
    torque = holding.demand * (1.0 + holding.needed)
    least = "" if isnan(torque) else f"; to hold {show(torque, 'mN*m', 'torque')} at the motor"
    return f"none is listed{least}"


def _bare_belt(found: DriveSet) -> bool:
    """Whether there is a belt of which no parts are known."""
    return not found.belt_drive and (found.belt_ratio != 1.0 or found.belt_efficiency != 1.0)


def _behind_gearhead(found: DriveSet) -> int:
    return 1 + next((n for n, role in enumerate(found.parts) if role == "gearhead"), 0)


def _ratio(found: DriveSet) -> str:
    return f"{found.belt_ratio:g} : 1, efficiency {100 * found.belt_efficiency:.4g} %"
