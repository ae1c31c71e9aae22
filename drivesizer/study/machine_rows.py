"""Rows of a machine's variants: sized as a whole, with the figures of one axis or of all."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache

from drivesizer.catalog import Catalog
from drivesizer.files.yaml_source import YamlSource
from drivesizer.joints.mass_columns import JointTorques, joint_torques
from drivesizer.multi_axis.sizing import size_machine
from drivesizer.results.machine import AxisSizing
from drivesizer.spec.drive import Ranking
from drivesizer.spec.machine import read_machine
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.robot_section import RobotSection
from drivesizer.study.columns import Best, Row, machine_row, variant_rows
from drivesizer.study.plan import Job

__all__ = ["machine_rows"]


def machine_rows(
    job: Job, source: YamlSource, objective: Ranking | None, head: Row, parts: Callable[[RobotSpec], Catalog]
) -> list[Row]:
    """The rows of a variant of a machine."""
    robot = json.dumps(source.data.get("robot"), ensure_ascii=False)

    def torques(section: RobotSection, file: str, gravity: float) -> JointTorques:
        return _torques(_Robot(robot, section), file, gravity)

    machine = read_machine(source)
    sizing = size_machine(machine, top=job.top, objective=objective, brief=True, parts=parts, torques=torques)
    if job.axis is not None:
        return variant_rows(head, _best(sizing.axis(job.axis), job.top))
    return [machine_row(head, job.members, sizing)]


def _best(axis: AxisSizing, top: int) -> Best:
    """The drives of an axis, sized in its machine."""
    result = axis.result
    sets = result.sets[:top]
    near = next(iter((*result.unsure, *result.misses)), None)
    return Best(sets, None if sets else near, result.counts, result.objective, axis.drives)


@dataclass(frozen=True, slots=True)
class _Robot:
    """A robot's section, known by its text."""

    text: str
    section: RobotSection = field(compare=False, repr=False)


@lru_cache(maxsize=4)
def _torques(robot: _Robot, file: str, gravity: float) -> JointTorques:
    """Torques of a robot's joints: of variants with the same section they are computed once in a process."""
    return joint_torques(robot.section, file, gravity)
