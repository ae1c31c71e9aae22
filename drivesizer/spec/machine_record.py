"""A machine as data: named axes on one supply, each of them a spec of its own; a plain spec is a machine of one axis.

What reads machine.yaml is ``spec.machine``, which a machine of one axis need not load.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple, Protocol, TypeVar

from drivesizer.errors import InputError, nearest, quoted
from drivesizer.files.yaml_source import OfFile, YamlSource
from drivesizer.spec.battery import Battery, BrakeResistor, Consumer
from drivesizer.spec.platform import Budget
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.sections import Environment, Margins, Mission, Supply, TitleBlock

if TYPE_CHECKING:
    from drivesizer.spec.robot_section import RobotSection


class Carried(NamedTuple):
    """An axis whose drives ride on another one."""

    name: str
    distance: float | None  # m, from the carrying axis; None along a line


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisSpec:
    """An axis of a machine."""

    name: str
    spec: RobotSpec  # it alone, all shared sections in it
    carries: tuple[Carried, ...]
    start: float  # s, of its motion in the machine's cycle
    repeats: bool | None  # its motion, at once; None: where it is not at rest at both ends of it
    own_supply: bool  # whether it is not on the machine's
    is_joint: bool  # of the robot, whose description gives its load


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineSpec(OfFile):
    """A machine.yaml: named axes, and what they share."""

    name: str
    axes: tuple[AxisSpec, ...]  # in the order of the file
    order: tuple[str, ...]  # names, carried axes before those that carry them
    synchronised: bool
    cycle_time: float | None  # s
    whole: bool  # whether carried drives are chosen for the best sum
    few_kinds: float | None  # share of that sum that common drives may cost more; None: none are preferred
    supply: Supply
    environment: Environment
    margins: Margins
    mission: Mission | None
    battery: Battery | None
    equipment: tuple[Consumer, ...]
    budget: Budget | None
    brake_resistor: BrakeResistor | None
    report: TitleBlock
    robot: RobotSection | None  # whose joints are axes as well
    source: YamlSource
    changes: tuple[Callable[[RobotSpec], RobotSpec], ...] = ()  # that joints have yet to undergo

    def axis(self, name: str) -> AxisSpec:
        """The axis of a name."""
        return axis_of(self.axes, name)

    def carried(self, name: str) -> dict[str, float | None]:
        """All whose drives ride on an axis, on others that ride on it too, each with its distance from this one."""
        direct = {one.name: one.distance for one in self.axis(name).carries}
        found = dict(direct)
        for other, distance in direct.items():
            for further, beyond in self.carried(other).items():
                found.setdefault(further, None if distance is None else distance + (beyond or 0.0))
        return found

    def changed(self, change: Callable[[RobotSpec], RobotSpec]) -> MachineSpec:
        """The machine with the same change in the specs of all its axes."""
        axes = tuple(replace(axis, spec=axis.spec.changed(change)) for axis in self.axes)
        return replace(self, axes=axes, changes=(*self.changes, change))

    @property
    def is_several(self) -> bool:
        """Whether there is more than one axis, or a robot with joints."""
        return len(self.axes) > 1 or self.robot is not None


class _Named(Protocol):
    @property
    def name(self) -> str: ...


Axis = TypeVar("Axis", bound=_Named)


def axis_of(axes: Sequence[Axis], name: str) -> Axis:
    """The axis of a name, of a machine's spec or of its sizing."""
    found = next((axis for axis in axes if axis.name == name), None)
    if found is None:
        names = [axis.name for axis in axes]
        listed = f"{', '.join(names)}{nearest(name, names)}"
        raise InputError(f"--axis: there is no axis {quoted(name)}; expected {listed}")
    return found


def machine_of(spec: RobotSpec) -> MachineSpec:
    """A plain spec as a machine of one axis."""
    axis = AxisSpec(name=spec.name, spec=spec, carries=(), start=0.0, repeats=None, own_supply=False, is_joint=False)
    return MachineSpec(
        name=spec.name, axes=(axis,), order=(spec.name,), synchronised=True, cycle_time=None, whole=True,
        few_kinds=None, supply=spec.supply, environment=spec.environment, margins=spec.margins, mission=spec.mission,
        battery=spec.battery, equipment=tuple(spec.equipment), budget=spec.budget, brake_resistor=spec.brake_resistor,
        report=spec.report, robot=None, source=spec.source,
    )  # fmt: skip
