"""Content of a report: the result, the behaviour of the reported drive over the cycles, and its figures."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from drivesizer.control.validation import Validation
from drivesizer.output.part_line import PartLine
from drivesizer.output.parts import machine_parts
from drivesizer.output.report.figures.all_figures import STILL, Drawing, report_drawings
from drivesizer.output.report.figures.layout import once
from drivesizer.output.report.figures.set_behaviour import Behaviour
from drivesizer.output.report.lines.machine import first_wheel
from drivesizer.output.report.lines.reliability import outcome
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.results.check import Status, gravest
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import SizingResult

__all__ = ["Content"]


@dataclass(frozen=True)
class Content:
    """A sizing and its closed loop; each part that takes time is computed once, when it is used."""

    result: SizingResult
    validation: Validation | None = None
    both: bool = False  # whether there is to be a page beside a PDF, with figures that it shows alike

    @property
    def drive(self) -> DriveSet | None:
        """The drive that is reported: the best, else the most probable, else the closest rejected one."""
        return self.result.shown

    @property
    def status(self) -> Status:
        """The gravest of the reported drive's verdict and that of its closed loop; a fail without a drive."""
        return gravest(
            [self.drive.status if self.drive else "fail", *([self.validation.status] if self.validation else [])]
        )

    @property
    def outcome(self) -> str:
        """``found``, ``unsure`` where no drive reaches the required confidence, or ``missed``."""
        return outcome(self.result)

    @cached_property
    def behaviour(self) -> Behaviour | None:
        """Behaviour of the reported drive over the load cycles."""
        return Behaviour(self.result.problem, self.drive) if self.drive else None

    @cached_property
    def drawings(self) -> dict[str, Drawing]:
        """Every figure by name."""
        every = report_drawings(self.result, self.validation, self.behaviour)
        return every | {name: once(every[name]) for name in STILL if self.both and name in every}

    @cached_property
    def cycles(self) -> list[tuple[str, LoadCycle]]:
        """The load cycle of each case by name."""
        return [(case.name, case.cycle) for case in self.result.problem.cases]

    @cached_property
    def wheel(self) -> str:
        """The worst wheel of a platform, such as ``wheel 1``; empty for other machines."""
        return first_wheel(self.result.problem)

    @property
    def cases(self) -> list[str]:
        """The names of the load cases; none where there is one without a name."""
        return [case.name for case in self.result.problem.cases if case.name]

    @property
    def shaft(self) -> str:
        """Shaft at which the load is given."""
        return "wheel" if self.result.spec.load.kind == "wheeled_vehicle" else "load's shaft"

    @property
    def title_block(self) -> list[tuple[str, str]]:
        """Names and texts of the customer, project, author and revision, as far as the spec gives them."""
        given = self.result.spec.report.model_dump(exclude_none=True)
        return [(name.replace("_", " ").capitalize(), str(text)) for name, text in given.items()]

    @property
    def motors(self) -> int:
        """Number of drives of this kind in the machine."""
        return self.result.spec.load.motors

    @cached_property
    def bought(self) -> list[PartLine]:
        """The parts list of the best drive; a rejected one is not bought."""
        return machine_parts(self.result.sets[0], self.result.problem) if self.result.sets else []
