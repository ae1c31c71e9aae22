"""The load cases of a machine as they are sized; those of a platform are split into its wheels."""

from __future__ import annotations

from collections.abc import Iterable

from drivesizer.spec.robot import RobotSpec

__all__ = ["load_cases"]


def load_cases(spec: RobotSpec) -> tuple[tuple[int, str, RobotSpec], ...]:
    """The load cases of a machine as they are sized: one for each driven wheel where its motion is a trajectory."""
    every = enumerate(spec.load_cases)
    return tuple((number, *found) for number, (name, case) in every for found in _split(name, case))


def _split(name: str, case: RobotSpec) -> Iterable[tuple[str, RobotSpec]]:
    if case.platform is None:
        return ((name, case),)
    from drivesizer.load_cases.platform_wheels import wheels

    return wheels(name, case)
