"""One driven wheel of a platform on its trajectory, as the load of a motor set: computed where others are recorded."""

from __future__ import annotations

from collections.abc import Iterable

from pydantic import PrivateAttr

from drivesizer.loads.kinds import Load
from drivesizer.loads.recorded import Recorded
from drivesizer.physics.load_cycle import LoadCycle

__all__ = ["WheelLoad", "machine_cases", "wheel_load"]


class WheelLoad(Recorded):
    """What is asked of a wheel, or of several alike."""

    _cycle: LoadCycle = PrivateAttr()
    _numbers: tuple[int, ...] = PrivateAttr(default=())
    _way: float = PrivateAttr(default=0.0)
    _of: str = PrivateAttr(default="")
    _rolling: float = PrivateAttr(default=0.0)

    @property
    def cycle(self) -> LoadCycle:
        """What its shaft is asked for."""
        return self._cycle

    @property
    def alike(self) -> int:
        """How many of the platform's wheels are asked for this."""
        return len(self._numbers)

    @property
    def numbers(self) -> tuple[int, ...]:
        """Which of the driven wheels those are, from 0."""
        return self._numbers

    @property
    def way(self) -> float:
        """How far the platform goes in the cycle [m]."""
        return self._way

    @property
    def of(self) -> str:
        """The load case of the platform that it belongs to."""
        return self._of

    @property
    def rolling_torque(self) -> float:
        """That the wheel itself takes to roll on, on a level floor, either way [N*m]."""
        return self._rolling

    @property
    def shaft_inertia(self) -> float:
        """Of all that one motor set moves, at the wheel's shaft [kg*m^2]."""
        return self._cycle.inertia


def wheel_load(cycle: LoadCycle, wheels: int, numbers: Iterable[int], way: float, of: str, rolling: float) -> WheelLoad:
    """The load of one wheel, or of several alike.

    Parameters
    ----------
    cycle
        What its shaft is asked for.
    wheels
        Driven wheels of the platform.
    numbers
        Which of them are asked for this, from 0.
    way, of
        How far the platform goes in the cycle [m], and the load case that this is.
    rolling
        Torque that the wheel itself takes to roll on, on a level floor [N*m].
    """
    made = WheelLoad.model_construct(kind="recorded", file=cycle.name, motors=wheels, smoothing=0.0, inertia=0.0)
    made._cycle, made._numbers, made._way, made._of, made._rolling = cycle, tuple(numbers), way, of, rolling
    return made


def machine_cases(cases: Iterable[tuple[str, Load]]) -> list[tuple[str, list[int]]]:
    """The load cases of the whole machine: the name of each, and the numbers of those of its wheels.

    Parameters
    ----------
    cases
        Name and load of every load case.
    """
    found: dict[tuple[str, int], list[int]] = {}  # two may have one name, unless they are wheels of one
    for number, (name, load) in enumerate(cases):
        key = (load.of, -1) if isinstance(load, WheelLoad) else (name, number)
        found.setdefault(key, []).append(number)
    return [(name, numbers) for (name, _), numbers in found.items()]
