"""Joints of a robot description as axes of its machine, their loads linear in the masses of the drives on them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from drivesizer.errors import FieldError, InputError, nearest, quoted
from drivesizer.files.frozen import dataclass
from drivesizer.joints.mass_columns import JointTorques, joint_torques
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.robot_section import RobotSection
from drivesizer.spec.several_axes.machine import MachineSpec
from drivesizer.spec.several_axes.machine_file import in_order, joint_axis

__all__ = ["Joints", "TorquesOf", "with_joints"]

TorquesOf = Callable[[RobotSection, str, float], JointTorques]
_ROUNDING = 1e-9  # of the largest torque


@dataclass(frozen=True, slots=True)
class Joints:
    """Torques of the joints of a machine; none where it has no robot."""

    torques: JointTorques | None

    @property
    def notes(self) -> tuple[str, ...]:
        """Assumptions on the joints, as sentences."""
        return self.torques.notes if self.torques else ()

    def has(self, axis: str) -> bool:
        """Whether an axis is a joint."""
        return self.torques is not None and axis in self.torques.joints

    def laden(self, spec: RobotSpec, joint: str, masses: Mapping[str, float]) -> RobotSpec:
        """The spec of a joint with drives of these masses on it, payloads and poses as load cases.

        Parameters
        ----------
        spec
            Of the axis, its load not yet computed.
        joint
            Its name.
        masses
            Of the drives that it carries, by joint [kg].

        Returns
        -------
        RobotSpec
            With the load of every load case.
        """
        assert self.torques is not None
        loads = [self.torques.load(joint, masses, case) for case in range(len(self.torques.cases))]
        made = spec.changed(lambda one: one.model_copy(update={"load": loads[0]}))
        further = ((case.name, load) for case, load in zip(self.torques.cases[1:], loads[1:], strict=True))
        return made.with_cases((name, made.alone(load=load)) for name, load in further)

    def rises(self, joint: str, masses: Mapping[str, float]) -> bool:
        """Whether more mass of the drives on a joint nowhere lessens its torque.

        Parameters
        ----------
        joint
            Its name.
        masses
            Of the drives that it carries, by joint [kg].

        Returns
        -------
        bool
            Of all load cases.
        """
        assert self.torques is not None
        for case in range(len(self.torques.cases)):
            own = self.torques.load(joint, masses, case).cycle
            for other in masses:
                more = self.torques.load(joint, {**masses, other: masses[other] + 1.0}, case).cycle
                if len(more.duration) != len(own.duration):  # cut elsewhere: it changes sign at another time
                    return False
                against = (more.torque - own.torque) * np.sign(own.torque)
                if (against < -_ROUNDING * np.abs(own.torque).max()).any():
                    return False
        return True


def with_joints(machine: MachineSpec, torques_of: TorquesOf = joint_torques) -> tuple[MachineSpec, Joints]:
    """A machine with the joints of its robot among its axes.

    Parameters
    ----------
    machine
        As it was read.
    torques_of
        Computes the torques of a robot's joints, or has them already.

    Returns
    -------
    tuple
        The machine, its joints in the order of the description before all others, and their torques.

    Raises
    ------
    InputError
        When the description, the trajectory or an axis is wrong: one line with file and line.
    """
    if machine.robot is None:
        return machine, Joints(None)
    try:
        torques = torques_of(machine.robot, machine.file, machine.environment.gravity)
    except FieldError as error:
        raise InputError(f"{machine.where(error.field)}: {error}") from None
    lost = next((axis.name for axis in machine.axes if axis.is_joint and axis.name not in torques.joints), None)
    if lost is not None:
        text = (
            f"no joint {quoted(lost)} moves{nearest(lost, torques.joints)}; expected one that does, or load and motion"
        )
        raise InputError(f"{machine.where(('axes', lost))}: {text}")
    joints = tuple(joint_axis(machine, name, torques.carried[name]) for name in torques.joints)
    others = tuple(axis for axis in machine.axes if not axis.is_joint)
    return in_order(replace(machine, axes=(*joints, *others))), Joints(torques)
