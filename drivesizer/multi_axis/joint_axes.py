"""Joints of a robot description as axes of its machine, their loads linear in the masses of the drives on them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from math import fsum

import numpy as np

from drivesizer.errors import FieldError, InputError, nearest, quoted
from drivesizer.joints.mass_columns import JointTorques, joint_torques
from drivesizer.results.drive_set import DriveSet
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.robot_section import DrivePlace, RobotSection
from drivesizer.spec.several_axes.machine import MachineSpec
from drivesizer.spec.several_axes.machine_file import joint_axis, sizing_order
from drivesizer.units import show

__all__ = ["Joints", "TorquesOf", "with_joints"]

TorquesOf = Callable[[RobotSection, str, float], JointTorques]
_ROUNDING = 1e-9  # of the largest torque
_WORTH_SAYING = 0.005  # of it


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

    def moves_its_drive(self, axis: str) -> bool:
        """Whether an axis is a joint whose drive is on a link that it moves."""
        return self.torques is not None and axis in self.torques.carried.get(axis, ())

    def laden(self, spec: RobotSpec, joint: str, masses: Mapping[str, float]) -> RobotSpec:
        """The spec of a joint with drives of these masses on it, payloads and poses as load cases."""
        assert self.torques is not None
        loads = [self.torques.load(joint, masses, case) for case in range(len(self.torques.cases))]
        made = spec.changed(lambda one: one.model_copy(update={"load": loads[0]}))
        further = ((case.name, load) for case, load in zip(self.torques.cases[1:], loads[1:], strict=True))
        return made.with_cases((name, made.alone(load=load)) for name, load in further)

    def notes_on(self, drives: Mapping[str, tuple[DriveSet, float]]) -> Iterator[str]:
        """Sentences on what the chosen drives of joints mean to the robot."""
        for joint in self.torques.joints if self.torques else ():
            yield from self._heavier(joint, drives)
            yield from self._spun(joint, drives)

    def _heavier(self, joint: str, drives: Mapping[str, tuple[DriveSet, float]]) -> Iterator[str]:
        """A drive heavier than the link whose mass is said to hold it."""
        assert self.torques is not None
        robot, section = self.torques.robot, self.torques.section
        place, mass = section.drives.get(joint, DrivePlace()), drives[joint][1] if joint in drives else 0.0
        link = robot.links[place.link or robot.joints[joint].parent]
        carried = place.on != "base" and any(one.name in self.torques.joints for one in robot.chain(link.name))
        if section.masses == "with_drives" and carried and mass > link.mass:
            found = f"{show(mass, 'kg', 'mass')}, is heavier than its link {link.name}, {show(link.mass, 'kg', 'mass')}"
            yield f"the drive of {joint}, {found}, which is said to hold it (robot.masses)"

    def _spun(self, joint: str, drives: Mapping[str, tuple[DriveSet, float]]) -> Iterator[str]:
        """The most that rotors of drives beyond a joint add to its torque."""
        assert self.torques is not None
        quickest = np.abs(self.torques.cases[0].motion.acceleration).max(axis=(0, 1))
        spun = fsum(
            drives[one][0].total_ratio * drives[one][0].motor.rotor_inertia * quickest[n]
            for n, one in enumerate(self.torques.joints)
            if one in drives and self._moves(joint, one)
        )
        largest = float(np.abs(self.torques.load(joint, {}).cycle.torque).max())
        if self.torques.robot.joints[joint].turns and spun > _WORTH_SAYING * largest:
            share = show(spun / largest, "%", "dimensionless", 2)
            yield (
                f"{joint}: rotors of drives beyond it add {show(spun, 'N*m', 'torque', 2)} at most, were their "
                f"axes parallel to its own ({share} of its peak torque), which is left out"
            )

    def _moves(self, joint: str, other: str) -> bool:
        """Whether a joint moves the link before another one."""
        assert self.torques is not None
        robot = self.torques.robot
        return any(one.name == joint for one in robot.chain(robot.joints[other].parent))

    def rises(self, joint: str, masses: Mapping[str, float]) -> bool:
        """Whether more mass of the drives on a joint nowhere lessens its torque."""
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
    """A machine with the joints of its robot among its axes."""
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
    others_on = {name: [one for one in torques.carried[name] if one != name] for name in torques.joints}
    joints = tuple(joint_axis(machine, name, others_on[name]) for name in torques.joints)
    others = tuple(axis for axis in machine.axes if not axis.is_joint)
    return sizing_order(replace(machine, axes=(*joints, *others))), Joints(torques)
