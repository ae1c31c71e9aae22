"""A machine that was sized, on its supply."""

from __future__ import annotations

from collections.abc import Sequence

from drivesizer.catalog import Catalog
from drivesizer.multi_axis.common_supply import AxisPower, common_supply
from drivesizer.results.machine import AxisSizing
from drivesizer.results.machine_power import MachinePower
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.several_axes.machine import MachineSpec

__all__ = ["machine_power"]


def machine_power(machine: MachineSpec, axes: Sequence[AxisSizing]) -> MachinePower | None:
    """Power of the best drives of all axes on the machine's supply.

    Parameters
    ----------
    machine
        What the axes share.
    axes
        Their sizings.

    Returns
    -------
    MachinePower or None
        None of a single axis, whose own record has it, and where an axis on the supply has no drive.

    Raises
    ------
    InputError
        As of ``common_supply``.
    """
    on_it = [one for one in axes if not machine.axis(one.name).own_supply]
    if len(axes) == 1 or not on_it or any(one.best is None for one in on_it):
        return None
    found = [
        AxisPower(one.name, one.result.problem, one.best, machine.axis(one.name).start) for one in on_it if one.best
    ]
    return common_supply(
        _shared(machine, on_it[0].spec),
        _catalog(machine, on_it),
        found,
        synchronised=machine.synchronised,
        cycle_time=machine.cycle_time,
    )


def _shared(machine: MachineSpec, first: RobotSpec) -> RobotSpec:
    """Sections that all axes share, with surroundings, margins and mission of the first."""
    return first.alone(
        supply=machine.supply,
        battery=machine.battery,
        equipment=list(machine.equipment),
        brake_resistor=machine.brake_resistor,
        budget=None,
    )


def _catalog(machine: MachineSpec, axes: Sequence[AxisSizing]) -> Catalog:
    """The catalogues of the axis that lists power supply and battery, or brake resistors; else those of the first."""
    every = [one.result.problem.catalog for one in axes]
    battery = machine.battery.part if machine.battery else None

    def listed(catalog: Catalog) -> int:
        named = machine.supply.part in catalog.power_supplies.rows, battery in catalog.batteries.rows
        return 2 * sum(named) + (len(catalog.brake_resistors) > 0)

    return max(every, key=listed)
