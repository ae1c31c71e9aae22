"""Content of a machine's report: its sizing, the content and closed loop of each axis, its parts, its figures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

from drivesizer.control.validation import Validation
from drivesizer.output.part_line import PartLine
from drivesizer.output.part_totals import Total
from drivesizer.output.parts_of_axes import SharedLine, machine_parts_of_axes, parts_by_axis, totals_of_axes
from drivesizer.output.report.figures.all_figures import Drawing
from drivesizer.output.report.figures.axes_power import axes_power
from drivesizer.output.report.figures.field import torque_speed_panels
from drivesizer.output.report.figures.field_panels import Panel, panels
from drivesizer.output.report.sections.content import Content
from drivesizer.results.check import Status, gravest
from drivesizer.results.machine import AxisSizing, MachineSizing

__all__ = ["AxisContent", "MachineContent"]


_FIELDS = 6  # of axes in one figure, which leaves room for a heading on its page


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisContent:
    """An axis, with what a report of it alone would print."""

    key: str  # before the names of its figures and tables, which every axis has
    sizing: AxisSizing
    content: Content
    lines: list[PartLine]  # parts that are bought
    own_supply: bool  # whether what it regenerates is its own affair

    @property
    def name(self) -> str:
        """Name in the file."""
        return self.sizing.name

    @property
    def status(self) -> Status:
        """Verdict of its drive; a fail without one."""
        return self.sizing.best.status if self.sizing.best else "fail"


@dataclass(frozen=True)
class MachineContent:
    """A sizing of a machine; each part that takes time is computed once, when it is used."""

    sizing: MachineSizing
    proofs: Mapping[str, Validation] = field(default_factory=dict)  # closed loops, by the name of the axis

    @property
    def status(self) -> Status:
        """The gravest of the machine's verdict and those of all closed loops."""
        return gravest([self.sizing.status, *(proof.status for proof in self.proofs.values())])

    @cached_property
    def axes(self) -> list[AxisContent]:
        """Every axis, in the order of the file."""
        lines = parts_by_axis(self.sizing)
        alone = [  # without the front, which served the choice
            Content(replace(one.result, front=(), pareto=()), self.proofs.get(one.name)) for one in self.sizing.axes
        ]
        return [
            AxisContent(key=f"axis{number}-", sizing=one, content=content, lines=lines[one.name], own_supply=own)
            for number, (one, content, own) in enumerate(
                zip(self.sizing.axes, alone, self._own_supplies, strict=True), 1
            )
        ]

    @property
    def _own_supplies(self) -> list[bool]:
        axes = self.sizing.machine.axes
        return [len(axes) == 1 or axis.own_supply for axis in axes]

    @cached_property
    def bought(self) -> list[SharedLine]:
        """The parts list of all axes."""
        return machine_parts_of_axes(self.sizing)

    @cached_property
    def totals(self) -> list[Total]:
        """Mass and price of all parts."""
        return totals_of_axes(self.bought)

    @property
    def drives(self) -> int:
        """Drives of all axes that have one."""
        return sum(one.drives for one in self.sizing.axes if one.best)

    @property
    def title_block(self) -> list[tuple[str, str]]:
        """Rows of the title block, as of a spec of one axis."""
        given = self.sizing.machine.report.model_dump(exclude_none=True)
        return [(name.replace("_", " ").capitalize(), str(text)) for name, text in given.items()]

    @cached_property
    def catalogs(self) -> dict[str, str]:
        """Digests of the catalogues of all axes, by name."""
        return {name: digest for one in self.axes for name, digest in one.content.result.catalog.digests.items()}

    @property
    def method(self) -> str:
        """Methods that ranked."""
        return ", ".join(dict.fromkeys(one.content.result.method for one in self.axes))

    @property
    def file(self) -> str:
        """The name of the machine's file without its folder."""
        return self.sizing.machine.file.replace("\\", "/").rsplit("/", 1)[-1]

    @cached_property
    def loads(self) -> dict[str, Drawing]:
        """Figures with the field of every axis, as many on each as a page has room for."""
        fields = [*self._fields()]
        parts = [fields[n : n + _FIELDS] for n in range(0, len(fields), _FIELDS)]
        return {f"loads{n}": partial(torque_speed_panels, part) for n, part in enumerate(parts, 1)}

    def _fields(self) -> Iterator[Panel]:
        """The field of each axis' drive with its first load case, under the name of the axis."""
        for one in self.axes:
            drive, result = one.content.drive, one.content.result
            found = panels(result.problem, drive, result.requirements) if drive else []
            for panel in found[:1]:
                number, _, field = panel.cases[0]
                yield replace(panel, cases=((number, one.name, field),), points=())

    @cached_property
    def supply(self) -> dict[str, Drawing]:
        """The power of all axes over time, where it is known of any."""
        power = self.sizing.power
        known = power is not None and len(power.unknown) < len(power.axes)
        return {"power": partial(axes_power, power)} if power is not None and known else {}

    @cached_property
    def drawings(self) -> dict[str, Drawing]:
        """Every figure by name: those of all axes, then those of each."""
        own = {f"{one.key}{name}": draw for one in self.axes for name, draw in one.content.drawings.items()}
        return self.loads | self.supply | own
