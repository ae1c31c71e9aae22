"""The machine as a report prints it: what it is, and what it weighs, has room for and stands on with a set in it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from math import isnan
from typing import Any

from drivesizer.control.validation import Validation
from drivesizer.load_cases.platform_wheels import trajectory_of
from drivesizer.load_cases.wheel import WheelLoad
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.output.report.lines.sets import figure_row
from drivesizer.results.drive_set import DriveSet
from drivesizer.results.problem import Problem
from drivesizer.spec.platform import Platform
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

__all__ = ["driven_over", "first_wheel", "machine_rows", "machine_words", "mass_notes"]

_OF_MASSES = ("mass_known", "mass_left")  # figures that stand below the masses that they sum


def machine_rows(best: DriveSet) -> dict[str, Any]:
    """What a machine weighs, part by part, and the figures of it that have no limit; no rows where there are none."""
    sums = {f.name: figure_row(f) for f in best.machine if f.name in _OF_MASSES}
    return {
        "masses": [
            {
                "name": row.name,
                "number": f"{row.number} ×" if row.number > 1 else "",
                "each": show(row.each, "kg", "mass") if row.number > 1 else "",
                "all": show(row.total, "kg", "mass"),
            }
            for row in best.masses
        ],
        "mass_sums": list(sums.values()),
        "mass_lacks": ", ".join(mass_notes(best)),
        "machine": [figure_row(f) for f in best.machine if f.name not in sums],
    }


def mass_notes(best: DriveSet) -> tuple[str, ...]:
    """What the sum of the masses is without."""
    return tuple(dict.fromkeys(row.name for row in best.masses if isnan(row.each)))


def first_wheel(problem: Problem) -> str:
    """The load case that stands first where it is that of a wheel on a trajectory, such as ``wheel 1``; else empty."""
    return problem.cases[0].name if isinstance(problem.spec.load, WheelLoad) else ""


def driven_over(v: Validation) -> str:
    """What a closed loop was driven over, in words: the profile, or the cycle of a wheel."""
    wheel = isinstance(v.spec.load, WheelLoad) and v.profile == v.spec.load.file
    return f"the cycle of {v.profile}" if wheel else v.over


def machine_words(spec: RobotSpec) -> str:
    """What the machine is, in a line: a platform with its wheels and its way, else the kind of load with its mass."""
    load, platform = spec.load, spec.platform
    mass = show(load.mass, "kg", "mass") if hasattr(load, "mass") else ""
    if platform is None or not isinstance(load, WheeledVehicle):
        kind = load.kind.replace("_", " ").capitalize()
        sets = "1 motor set" if load.motors == 1 else f"{load.motors} motor sets"
        return ", ".join(filter(None, (kind, mass, sets)))
    stands = " and ".join(_wheels(platform))
    diameter = show(load.wheel_diameter, "mm", "length")
    said = [f"Platform of {mass} on {stands}, wheel diameter {diameter}", *_size(platform), *_way(spec)]
    return "; ".join(said)


def _wheels(platform: Platform) -> Iterator[str]:
    """``4 driven mecanum wheels``, and what rolls along."""
    for (kind, driven), count in Counter((place.kind, place.driven) for place in platform.places).items():
        yield _counted(count, f"{'driven' if driven else 'free'} {kind} wheel")
    if platform.casters:
        yield _counted(len(platform.casters), "caster")


def _counted(count: int, name: str) -> str:
    return f"{count} {name}" + ("" if count == 1 else "s")


def _size(platform: Platform) -> Iterator[str]:
    if platform.size:
        sides = (platform.size.length, platform.size.width, platform.size.height)
        length, width, height = (show(x, "mm", "length").removesuffix(" mm") for x in sides)
        yield f"{length} × {width} × {height} mm"


def _way(spec: RobotSpec) -> Iterator[str]:
    way = trajectory_of(spec)
    if way is not None:
        yield f"its way is {show(way.length, 'm', 'length')} in {show(way.total, 's', 'time')}"
