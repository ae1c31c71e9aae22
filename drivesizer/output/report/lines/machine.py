"""The machine in words: its kind, its wheels and its path."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from drivesizer.control.validation import Validation
from drivesizer.load_cases.platform_wheels import trajectory_of
from drivesizer.load_cases.wheel import WheelLoad
from drivesizer.loads.kinds import Load
from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.results.problem import Problem
from drivesizer.spec.platform import Platform
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

__all__ = ["driven_over", "first_wheel", "machine_words"]


def first_wheel(problem: Problem) -> str:
    """The first load case where it is that of a wheel on a trajectory, such as ``wheel 1``; else empty."""
    return problem.cases[0].name if isinstance(problem.spec.load, WheelLoad) else ""


def driven_over(v: Validation) -> str:
    """The reference of a closed loop in words: the profile, or the cycle of a wheel."""
    wheel = isinstance(v.spec.load, WheelLoad) and v.profile == v.spec.load.file
    return f"the cycle of {v.profile}" if wheel else v.over


def machine_words(spec: RobotSpec) -> str:
    """The machine in a line: a platform with its wheels and its path, else the kind of load with mass or inertia."""
    load, platform = spec.load, spec.platform
    mass = _burden(load) + _carried(spec)
    if platform is None or not isinstance(load, WheeledVehicle):
        kind = load.kind.replace("_", " ").capitalize()
        return ", ".join(filter(None, (kind, mass, _count_text(load.motors, "drive"))))
    wheels = " and ".join(_wheels(platform))
    diameter = show(load.wheel_diameter, "mm", "length")
    return "; ".join([f"Platform of {mass} on {wheels}, wheel diameter {diameter}", *_size(platform), *_path(spec)])


def _burden(load: Load) -> str:
    """Mass that is moved, else the inertia of what turns without one; empty where a load has neither.

    >>> from types import SimpleNamespace
    >>> _burden(SimpleNamespace(mass=45.0, inertia=0.0)), _burden(SimpleNamespace(mass=0.0, inertia=0.08))
    ('45 kg', '0.08 kg·m²')
    """
    figures = ((getattr(load, name, None), name, unit) for name, unit in (("mass", "kg"), ("inertia", "kg*m^2")))
    return next((show(value, unit, kind) for value, kind, unit in figures if value), "")


def _carried(spec: RobotSpec) -> str:
    """The largest payload that the motion adds to the mass, in words."""
    motion = spec.motion if spec.carries else None
    payloads = [getattr(motion, name, None) for name in ("payload", "payload_back")]
    payloads += [piece.payload for piece in getattr(motion, "segments", ())]
    most = max(filter(None, payloads), default=0.0)
    return f" and a payload of up to {show(most, 'kg', 'mass')}" if most else ""


def _wheels(platform: Platform) -> Iterator[str]:
    """``4 driven mecanum wheels``, and what rolls along."""
    for (kind, driven), count in Counter((place.kind, place.driven) for place in platform.places).items():
        yield _count_text(count, f"{'driven' if driven else 'free'} {kind} wheel")
    if platform.casters:
        yield _count_text(len(platform.casters), "caster")


def _count_text(count: int, name: str) -> str:
    return f"{count} {name}" + ("" if count == 1 else "s")


def _size(platform: Platform) -> Iterator[str]:
    if platform.size:
        sides = (platform.size.length, platform.size.width, platform.size.height)
        length, width, height = (show(x, "mm", "length").removesuffix(" mm") for x in sides)
        yield f"{length} × {width} × {height} mm"


def _path(spec: RobotSpec) -> Iterator[str]:
    path = trajectory_of(spec)
    if path is not None:
        yield f"path of {show(path.length, 'm', 'length')} in {show(path.total, 's', 'time')}"
