"""Machines of several axes: each sized with the drives that ride on it, all of them on one supply.

May import: everything up to sizing; not output.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from drivesizer.catalog import Catalog
from drivesizer.results.drive_set import Detail
from drivesizer.results.machine import MachineSizing, of_one_axis
from drivesizer.search.passing import Progress
from drivesizer.search.shortlist import load_parts
from drivesizer.search.uncertainty.options import Sampling, sampling_of
from drivesizer.sizing import size
from drivesizer.spec.drive import Ranking
from drivesizer.spec.machine import MachineSpec, machine_of
from drivesizer.spec.robot import RobotSpec

if TYPE_CHECKING:
    from drivesizer.joints.mass_columns import JointTorques
    from drivesizer.spec.robot_section import RobotSection


def size_machine(
    machine: MachineSpec,
    *,
    top: int = 5,
    objective: Ranking | None = None,
    pareto: tuple[str, ...] = (),
    progress: Progress | None = None,
    sampling: Callable[[RobotSpec], Sampling | None] = sampling_of,
    detail: Detail = "full",
    choices: int = 0,
    parts: Callable[[RobotSpec], Catalog] = load_parts,
    torques: Callable[[RobotSection, str, float], JointTorques] | None = None,
) -> MachineSizing:
    """Size all axes of a machine.

    Parameters
    ----------
    machine
        Its axes, and what they share.
    top, objective, pareto, progress
        As of ``size``, for every axis.
    sampling
        How drives of an axis are sampled for their tolerances.
    detail, choices
        As of ``size``; of several axes a headline is their drives, without choices.
    parts, torques
        Give the catalogues of an axis, and the torques of a robot's joints: several machines may share them.

    Returns
    -------
    MachineSizing
        Every axis with its best drives; where one has none, those that it would carry are still sized.

    Raises
    ------
    InputError
        As ``size`` does.
    """
    if not machine.is_several:
        (axis,) = machine.axes
        return of_one_axis(size(
            axis.spec, catalog=parts(axis.spec), top=top, objective=objective, pareto=pareto, progress=progress,
            sampling=sampling(axis.spec), detail=detail, choices=choices,
        ))  # fmt: skip
    from drivesizer.joints.mass_columns import joint_torques  # what one axis need not load
    from drivesizer.multi_axis.several import Options, sized

    detail = "drives" if detail == "headline" else detail
    return sized(machine, Options(top, objective, pareto, progress, sampling, detail, parts, torques or joint_torques))


def alone(machine: MachineSpec, axis: str) -> MachineSpec:
    """One axis of a machine as a machine of its own: with the drives that ride on it, which are sized for that."""
    if not machine.is_several:
        machine.axis(axis)
        return machine
    from drivesizer.multi_axis.several import laden

    return machine_of(laden(machine, axis))
