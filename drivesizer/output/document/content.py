"""Contents of a document: a sizing and its closed loop, each part that takes time computed once; and its words."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from drivesizer.catalog import Catalog
from drivesizer.load_cases.platform import WheelLoad, trajectory_of
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.output.parts import PartLine, machine_parts
from drivesizer.output.words import first_wheel, number_of, outcome
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.results.check import Status as CheckStatus
from drivesizer.results.check import gravest
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.sizing import SizingResult
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

if TYPE_CHECKING:
    from drivesizer.control.validation import Validation
    from drivesizer.output.report.figures.all_figures import Behaviour
    from drivesizer.output.report.figures.picture import Pictured
    from drivesizer.spec.machine import MachineSpec


@dataclass(frozen=True)
class OfDrives:
    """Records beside a drive that its sections need."""

    catalog: Catalog
    cases: tuple[str, ...] = ()  # names of the load cases; none where there is one without a name
    wheel: str = ""  # the worst wheel of a platform, such as ``wheel 1``; empty for other machines

    def of_machine(self, wheel: str, cases: str) -> str:
        """Words for a platform with wheels, for several load cases, or none."""
        return wheel if self.wheel else cases if self.cases else ""


@dataclass(frozen=True)
class OfLoop:
    """Records that sections of a closed loop need."""

    validation: Validation | None


class Reported(ABC):
    """Facts of a spec or of a machine's file for the head of a document."""

    @property
    @abstractmethod
    def contents(self) -> dict[str, Content]:
        """The content of each axis by its name."""

    @property
    @abstractmethod
    def given(self) -> RobotSpec | MachineSpec:
        """The spec, or the machine's file."""

    @property
    def name(self) -> str:
        """The machine's name."""
        return self.given.name

    @property
    def title_block(self) -> list[tuple[str, str]]:
        """Names and texts of the customer, project, author and revision, as far as they are given."""
        entries = self.given.report.model_dump(exclude_none=True)
        return [(name.replace("_", " ").capitalize(), str(text)) for name, text in entries.items()]

    @property
    def file(self) -> str:
        """The name of the file without its folder."""
        return self.given.file.replace("\\", "/").rsplit("/", 1)[-1]


@dataclass(frozen=True)
class Content(Reported):
    """A sizing and its closed loop."""

    result: SizingResult
    validation: Validation | None = None

    @property
    def contents(self) -> dict[str, Content]:
        """It alone."""
        return {self.name: self}

    @property
    def given(self) -> RobotSpec:
        """The spec."""
        return self.result.spec

    @property
    def words(self) -> str:
        """The machine in a line."""
        return machine_words(self.result.spec)

    @cached_property
    def of_drives(self) -> OfDrives:
        """Records that sections of a drive need."""
        cases = tuple(case.name for case in self.result.problem.cases if case.name)
        return OfDrives(self.result.catalog, cases, first_wheel(self.result.problem))

    @property
    def cases(self) -> tuple[str, ...]:
        """The names of the load cases; none where there is one without a name."""
        return self.of_drives.cases

    @property
    def wheel(self) -> str:
        """The worst wheel of a platform, such as ``wheel 1``; empty for other machines."""
        return self.of_drives.wheel

    @property
    def drive(self) -> DriveSet | None:
        """The drive that is reported: the best, else the most probable, else the closest rejected one."""
        return self.result.reported

    @property
    def status(self) -> CheckStatus:
        """The gravest of the reported drive's verdict and that of its closed loop; a fail without a drive."""
        own: list[CheckStatus] = [self.drive.status if self.drive and self.outcome != "missed" else "fail"]
        return gravest([*own, *([self.validation.status] if self.validation else [])])

    @property
    def outcome(self) -> str:
        """``found``, ``unsure`` where no drive reaches the required confidence, or ``missed``."""
        return outcome(self.result)

    @property
    def titles(self) -> dict[str, str]:
        """Titles of sections that depend on what was computed."""
        by_paper, proof = self.result.method == "paper", self.validation
        drives = {"found": "The selected drive", "unsure": "The most probable drive",
                  "missed": "The closest rejected drive"}  # fmt: skip
        return {
            "drive": drives[self.outcome], "derivation": "Derivation" if by_paper else "Requirements of the load",
            "loop": proof.loop.capitalize() if proof else "Closed loop",
            "physics": f"The same drive by {'physics' if by_paper else 'the paper'}",
        }  # fmt: skip

    @cached_property
    def behaviour(self) -> Behaviour | None:
        """Behaviour of the reported drive over the load cycles."""
        from drivesizer.output.report.figures.all_figures import Behaviour

        return Behaviour(self.result.problem, self.drive) if self.drive else None

    @cached_property
    def pictures(self) -> dict[str, Pictured]:
        """Every figure by name."""
        from drivesizer.output.report.figures.all_figures import report_pictures

        return report_pictures(self.result, self.validation, self.behaviour)

    @cached_property
    def cycles(self) -> list[tuple[str, LoadCycle]]:
        """The load cycle of each case by name."""
        return [(case.name, case.cycle) for case in self.result.problem.cases]

    @property
    def shaft(self) -> str:
        """Shaft at which the load is given."""
        return "wheel" if self.result.spec.load.kind == "wheeled_vehicle" else "load's shaft"

    @property
    def drives(self) -> str:
        """The drives of this kind in the machine, in words."""
        return all_drives(self.result.spec.load.motors)

    @cached_property
    def bought(self) -> list[PartLine]:
        """The parts list of the drive that is reported."""
        return machine_parts(self.drive, self.result.problem) if self.drive else []


# -- words


def all_drives(number: int) -> str:
    """All drives of a machine in words."""
    return "the one drive" if number == 1 else f"all {number} drives"


def driven_over(v: Validation) -> str:
    """The reference of a closed loop in words: the profile, or the cycle of a wheel."""
    wheel = isinstance(v.spec.load, WheelLoad) and v.profile == v.spec.load.file
    return f"the cycle of {v.profile}" if wheel else v.over


def machine_words(spec: RobotSpec) -> str:
    """The machine in a line: a platform with its wheels and its path, else the kind of load with mass or inertia."""
    load, platform = spec.load, spec.platform
    figures = ((getattr(load, name, None), name, unit) for name, unit in (("mass", "kg"), ("inertia", "kg*m^2")))
    mass = next((show(value, unit, kind) for value, kind, unit in figures if value), "")
    motion = spec.motion if spec.carries else None
    payloads = [getattr(motion, name, None) for name in ("payload", "payload_back")]
    payloads += [piece.payload for piece in getattr(motion, "segments", ())]
    most = max(filter(None, payloads), default=0.0)
    mass += f" and a payload of up to {show(most, 'kg', 'mass')}" if most else ""
    if platform is None or not isinstance(load, WheeledVehicle):
        kind = load.kind.replace("_", " ").capitalize()
        return ", ".join(filter(None, (kind, mass, number_of(load.motors, "drive"))))
    wheels = [number_of(count, f"{'driven' if driven else 'free'} {kind} wheel") for (kind, driven),
              count in Counter((place.kind, place.driven) for place in platform.places).items()]  # fmt: skip
    wheels += [number_of(len(platform.casters), "caster")] if platform.casters else []
    diameter = show(load.wheel_diameter, "mm", "length")
    return "; ".join(
        [f"Platform of {mass} on {' and '.join(wheels)}, wheel diameter {diameter}", *_size_and_path(spec)]
    )


def _size_and_path(spec: RobotSpec) -> Iterator[str]:
    size, path = spec.platform.size if spec.platform else None, trajectory_of(spec)
    if size:
        sides = (show(x, "mm", "length").removesuffix(" mm") for x in (size.length, size.width, size.height))
        yield f"{' × '.join(sides)} mm"
    if path is not None:
        yield f"path of {show(path.length, 'm', 'length')} in {show(path.total, 's', 'time')}"
