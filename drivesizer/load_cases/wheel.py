"""One driven wheel of a platform on its trajectory, as the load of a drive: computed, not recorded."""

from __future__ import annotations

from collections.abc import Iterable
from typing import ClassVar

from pydantic import PrivateAttr

from drivesizer.load_cases.computed import ComputedLoad
from drivesizer.loads.kinds import Load
from drivesizer.physics.load_cycle import LoadCycle

__all__ = ["WheelLoad", "machine_cases", "wheel_load"]


class WheelLoad(ComputedLoad):
    """The load cycle of a wheel, or of several with equal load cycles."""

    is_wheel: ClassVar[bool] = True

    _numbers: tuple[int, ...] = PrivateAttr(default=())
    _distance: float = PrivateAttr(default=0.0)
    _of: str = PrivateAttr(default="")
    _rolling: float = PrivateAttr(default=0.0)

    @property
    def alike(self) -> int:
        """Number of wheels with this load cycle."""
        return len(self._numbers)

    @property
    def numbers(self) -> tuple[int, ...]:
        """Numbers of these among the driven wheels, from 0."""
        return self._numbers

    @property
    def distance(self) -> float:
        """Distance that the platform travels in the cycle [m]."""
        return self._distance

    @property
    def of(self) -> str:
        """The load case of the platform that it belongs to."""
        return self._of

    @property
    def rolling_torque(self) -> float:
        """Torque of rolling on a level floor, in either direction [N*m]."""
        return self._rolling


def wheel_load(
    cycle: LoadCycle, wheels: int, numbers: Iterable[int], distance: float, of: str, rolling: float
) -> WheelLoad:
    """The load of one wheel, or of several alike."""
    made = WheelLoad.model_construct(kind="recorded", file=cycle.name, motors=wheels, smoothing=0.0, inertia=0.0)
    made._cycle, made._numbers, made._distance, made._of, made._rolling = cycle, tuple(numbers), distance, of, rolling
    return made


def machine_cases(cases: Iterable[tuple[str, Load]]) -> list[tuple[str, list[int]]]:
    """The load cases of the whole machine: the name of each, and the numbers of those of its wheels."""
    found: dict[tuple[str, int], list[int]] = {}  # two may have one name, unless they are wheels of one
    for number, (name, load) in enumerate(cases):
        key = (load.of, -1) if isinstance(load, WheelLoad) else (name, number)
        found.setdefault(key, []).append(number)
    return [(name, numbers) for (name, _), numbers in found.items()]
