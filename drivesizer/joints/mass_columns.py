"""Torques of all joints, linear in the masses that ride on the links, and each joint's load at its drive's shaft."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import NamedTuple

import numpy as np

from drivesizer.errors import FieldError, InputError, nearest, quoted
from drivesizer.files.sheets import columns, path_from_spec
from drivesizer.joints.inverse_dynamics import Array, Attached, JointMotion, Torques, force_torques, torques_of
from drivesizer.joints.trajectory import Field, check_link, fixed_positions, joint_of, motion_of, static_poses, unit_of
from drivesizer.loads.recorded import ComputedLoad
from drivesizer.loads.springs import BalanceMass, spring_force, unfit_springs
from drivesizer.physics.load_cycle import Cuts, LoadCycle, middle
from drivesizer.spec.description import Joint, Robot, read_description, rotation
from drivesizer.spec.robot_section import DrivePlace, RobotSection

# -- Places of drives and payload on the links, and who carries whom.


def drive_places(section: RobotSection, robot: Robot, joints: Sequence[str]) -> dict[str, Attached]:
    """Points of links at which the drives of joints hang; those on the base hang on none and are left out."""
    for name in section.drives:
        if name not in joints:
            wrong = f"{quoted(name)} is no joint that moves{nearest(name, joints)}; expected {', '.join(joints)[:200]}"
            raise FieldError(("robot", "drives", name), wrong)
    places: dict[str, Attached] = {}
    pairs = {
        mechanism.joints[1]: mechanism.joints[0] for mechanism in section.couplings
    }  # whose drives sit side by side
    on_frame = {name for mechanism in section.couplings if mechanism.kind == "corexy" for name in mechanism.joints}
    for name in joints:
        place, joint = section.drives.get(name, DrivePlace()), robot.joints[name]
        if place.on == "base" or name in on_frame:
            continue
        if name in pairs and name not in section.drives:
            joint = robot.joints[pairs[name]]
        if place.link is not None:
            check_link(robot, place.link, ("robot", "drives", name, "link"))
        at = np.zeros(3) if place.link else joint.place + joint.turn @ joint.anchor  # its axis, in the frame before it
        places[name] = Attached(place.link or joint.parent, at if place.at is None else np.array(place.at))
    return places


def payload_place(section: RobotSection, robot: Robot, joints: Sequence[str]) -> Attached | None:
    """Point at which the payload hangs; None without any."""
    payload, field = section.payload, ("robot", "payload")
    if payload is None:
        return None
    link = payload.link
    if link is None:
        parents = {joint.parent for joint in robot.joints.values()}
        last = [name for name in robot.links if name not in parents]
        if len(last) != 1:
            raise FieldError(field, f"{len(last)} links are last ones; expected link, one of {', '.join(last)[:200]}")
        link = last[0]
    check_link(robot, link, (*field, "link"))
    if not any(joint.name in joints for joint in robot.chain(link)):
        raise FieldError((*field, "link"), f"nothing moves link {quoted(link)}; expected one behind a joint that moves")
    return Attached(link, np.array(payload.at))


def carried_by(robot: Robot, drives: Mapping[str, Attached], joints: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """Joints whose drives ride beyond each joint; a drive on a link that it moves rides beyond its own."""
    under = {name: {joint.name for joint in robot.chain(point.link)} for name, point in drives.items()}
    return {joint: tuple(name for name in joints if joint in under.get(name, ())) for joint in joints}


def outermost_first(carried: Mapping[str, tuple[str, ...]]) -> tuple[str, ...]:
    """Joints in an order in which each comes behind those whose drives it carries.

    Examples
    --------
    >>> outermost_first({"shoulder": ("elbow",), "elbow": ()})
    ('elbow', 'shoulder')
    """
    try:
        others = {joint: [other for other in on_it if other != joint] for joint, on_it in carried.items()}
        return tuple(TopologicalSorter(others).static_order())
    except CycleError as error:
        round_ = ", ".join(error.args[1])
        raise FieldError(("robot", "drives"), f"joints carry each other's drives in a circle: {round_}") from None


# -- Drives mounted before other joints, their belts passing over the axes of those: coupled angles.
#
# The pulleys over the passed axes turn freely, 1:1, so that the shaft of drive k keeps its angle against its own
# link, whatever the joints between do. With parallel axes, s = 1 or -1 by their direction:
#
# .. math:: \theta_k = q_k + \sum_{j\,passed} s_{jk} q_j, \quad \theta = C q, \quad T = C^{-T} \tau,
#           \quad J_k = d_k^T M d_k
#
# d_k is column k of the inverse of C: the joints' motion when drive k turns alone. So a passed joint's own drive has
# less to do than its joint: the belt carries part of its torque.
#
# Of a differential wrist (kind: differential) and of a CoreXY gantry both drives move both joints, q_1 when they turn
# alike and q_2 against one another, by i:
#
# .. math:: \theta_1 = q_1 + i q_2, \quad \theta_2 = q_1 - i q_2, \quad T_{1,2} = (\tau_1 \pm \tau_2 / i) / 2
#
# Source: M. W. Spong, S. Hutchinson, M. Vidyasagar, Robot Modeling and Control, Wiley, 2006, section 7.4, planar
# elbow manipulator with remotely driven link.


_PARALLEL = 1e-6  # rad


def check_couplings(section: RobotSection, robot: Robot, joints: Sequence[str]) -> None:
    """Refuse couplings of joints that do not move, that are coupled already, or of the other kind."""
    seen = set[str]()
    for number, mechanism in enumerate(section.couplings):
        field: Field = ("robot", "couplings", number, "joints")
        for name in mechanism.joints:
            joint = joint_of(robot, name, field)
            if name not in joints or name in seen:
                reason = "is coupled twice" if name in seen else "does not move"
                raise FieldError(field, f"{quoted(name)} {reason}; expected two joints of the trajectory, each once")
            if joint.turns != (mechanism.kind == "differential"):
                verb, kinds = ("turns", "slide") if joint.turns else ("slides", "turn")
                raise FieldError(field, f"{quoted(name)} {verb}; the joints of kind: {mechanism.kind} {kinds}")
            if section.drives.get(name, DrivePlace()).belt_passes:
                raise FieldError(
                    field, f"the belt of {quoted(name)} passes other joints; expected that or the coupling"
                )
            seen.add(name)


def coupling(section: RobotSection, robot: Robot, fixed: Mapping[str, float], joints: Sequence[str]) -> Array:
    """Angles of drives per angle of joints."""
    matrix = np.eye(len(joints))

    def axis(joint: Joint) -> Array:
        """In the frame of the root, the joints that move at their references."""
        return robot.frame(joint.parent, fixed)[1] @ joint.turn @ joint.axis

    for row, name in enumerate(joints):
        place, joint = section.drives.get(name, DrivePlace()), robot.joints[name]
        field = ("robot", "drives", name, "belt_passes")
        if not place.belt_passes:
            continue
        before = {other.name for other in robot.chain(place.link)} if place.link else set()
        passed = [other for other in robot.chain(joint.parent) if other.name in joints and other.name not in before]
        if not passed:
            raise FieldError(field, f"no joint moves between the drive of {quoted(name)} and its joint; leave it out")
        for other in passed:
            along = float(axis(joint) @ axis(other))
            if not (joint.turns and other.turns) or 1.0 - abs(along) > _PARALLEL**2 / 2.0 + 1e-15:
                words = f"the belt of {quoted(name)} passes joint {quoted(other.name)}"
                raise FieldError(field, f"{words}; expected one about a parallel axis")
            matrix[row, joints.index(other.name)] = 1.0 if along > 0.0 else -1.0
    for mechanism in section.couplings:
        pair = [joints.index(name) for name in mechanism.joints]
        matrix[np.ix_(pair, pair)] = [[1.0, mechanism.ratio], [1.0, -mechanism.ratio]]
    return matrix


# -- Torques of joints beside those of masses: springs, weight that is taken off links, forces on links.
#
# .. math:: \tau_j = c_j (q_j - q_{0,j}) + F_j(q_j) - \sum J^T F
#
# c and q₀ are stiffness and rest of a spring of the description, F_j of the section's own springs (``loads.springs``),
# whose travel counts from the start of the trajectory. Weight that a description takes off a link (MJCF: gravcomp) is a
# force m c g upward at its centre of mass; the joint whose drive is said to carry it (actuatorgravcomp) still has it.
# Forces on links have the directions of the world, whatever the link's own. Those of a file hold between its rows along
# straight lines; pieces of the motion are cut there.


_SAME = 1e-9  # of the trajectory's time
Rows = tuple[Array, Array]  # time [s] and force [N], shape (rows, 3)


def check_joint_springs(section: RobotSection, robot: Robot, joints: Sequence[str]) -> None:
    """Refuse springs of joints that do not move, and of a kind that a joint has not."""
    for name, springs in section.springs.items():
        field = ("robot", "springs", name)
        joint = joint_of(robot, name, field)
        if name not in joints:
            raise FieldError(field, f"{quoted(name)} does not move; leave its springs out")
        if any(isinstance(spring, BalanceMass) for spring in springs):
            raise FieldError(field, "a counterweight of a joint is mass of its link; expected it in the description")
        for fault in unfit_springs(springs, turns=joint.turns, levels=False):
            raise FieldError(field, fault.removeprefix("springs: "))


def forces_in_files(section: RobotSection, spec_file: str, total: float) -> dict[int, Rows]:
    """Forces on links over time, of those that a file has, by their number."""
    forces = {}
    for number, force in enumerate(section.forces):
        if force.file is not None:
            path = path_from_spec(spec_file, force.file, ("robot", "forces", number, "file"), "a CSV file", "foot.csv")
            form = {"time": "time", "x": "force", "y": "force", "z": "force"}
            rows = columns(Path(path), form)
            time = rows["time"]
            if time[0] > _SAME * total or time[-1] < total * (1.0 - _SAME):
                text = f"time from {time[0]:g} to {time[-1]:g} s; expected all of the trajectory, 0 to {total:g} s"
                raise InputError(f"{path}: {text}")
            forces[number] = (time, np.stack([rows[axis] for axis in "xyz"], axis=1))
    return forces


def cut_at(motion: JointMotion, times: Array) -> JointMotion:
    """The motion with its pieces cut at some times, at which something else changes."""
    edges = np.concatenate([[0.0], np.cumsum(motion.duration)])
    near = np.abs(times[:, None] - edges[None]).min(axis=1) <= _SAME * edges[-1] if len(times) else times
    inside = np.unique(times[(near == 0) & (times > 0.0) & (times < edges[-1])])
    if not len(inside):
        return motion
    all_edges = np.union1d(edges, inside)
    owner = np.searchsorted(edges, (all_edges[:-1] + all_edges[1:]) / 2.0) - 1
    lasting, position, speed = motion.duration[:, None], motion.position, motion.speed
    cut = Cuts(owner, *((at[:, None] - edges[owner, None]) / lasting[owner] for at in (all_edges[:-1], all_edges[1:])))
    gap = np.diff(position, axis=1) - lasting[:, None] * middle(speed)[:, None]  # beside the speed's straight lines
    straight = cut.travel(lasting, speed) + gap[owner] * np.stack(cut[1:], axis=1)
    lines = (cut.line(column) for column in (speed, motion.acceleration))
    return JointMotion(motion.joints, np.diff(all_edges), position[owner, :1] + straight, *lines)


def spring_torques(section: RobotSection, robot: Robot, motion: JointMotion, start: Array, *, moving: bool) -> Array:
    """Torques that the springs of joints take, shape (segments * 2, joints)."""
    torques = np.zeros(motion.position.shape)
    for column, name in enumerate(motion.joints):
        joint, at = robot.joints[name], motion.position[:, :, column]
        torques[:, :, column] = joint.stiffness * (at - joint.slack)
        way = np.sign(motion.speed[:, :, column].mean(axis=1, keepdims=True)) * moving
        for spring in section.springs.get(name, ()):
            try:
                torques[:, :, column] += spring_force(spring, at - start[column], way)
            except FieldError as error:
                raise FieldError(("robot", "springs", name), str(error)) from None
    return torques.reshape(-1, len(motion.joints))


def link_torques(
    section: RobotSection, robot: Robot, fixed: Mapping[str, float], motion: JointMotion, gravity: Array, turn: Array,
    files: Mapping[int, Rows],
) -> Array:  # fmt: skip
    """Torques against weight that is taken off links and against forces on them, shape (segments * 2, joints).

    Gravity is in the frame of the root, and ``turn`` leads from it to the world; forces of files count in a motion.
    """
    position, time = motion.position.reshape(-1, len(motion.joints)), motion.time.ravel()
    torques = np.zeros(position.shape)
    lighter = [link for link in robot.links.values() if link.gravcomp * link.mass] if section.gravcomp == "keep" else []
    if lighter:
        up = np.array([-link.gravcomp * link.mass * gravity for link in lighter])
        lifts = np.broadcast_to(up, (len(position), *up.shape))
        points = [Attached(link.name, link.centre) for link in lighter]
        relieved = [not robot.joints[name].gravity_on_drive for name in motion.joints]
        torques += force_torques(robot, fixed, points, motion.joints, position, lifts) * relieved
    acting = [(n, force) for n, force in enumerate(section.forces) if force.force is not None or n in files]
    if acting:
        values = np.empty((len(position), len(acting), 3))
        for column, (number, force) in enumerate(acting):
            values[:, column] = force.force if force.force is not None else np.stack(
                [np.interp(time, files[number][0], values_) for values_ in files[number][1].T], axis=1
            )  # fmt: skip
        points = [Attached(force.link, np.array(force.at)) for _, force in acting]
        torques += force_torques(robot, fixed, points, motion.joints, position, values @ turn)
    return torques


# -- Load cycle of one joint at the shaft that its drive turns, and the load that has it.
#
# .. math:: T = r \, (\tau + d \dot q + f \, \mathrm{sgn} \, \dot q), \quad \omega = \dot q / r, \quad J = r^2 M_{jj}
#
# d and f damping and Coulomb friction of the joint, M the mass matrix (``coupling``: of a drive whose belt passes
# other joints). A joint that turns has r = 1; one that slides r = p / 2π with p the travel per turn of the shaft.
#
# The inertia is the largest over the trajectory of what resists this joint when it moves alone; the torque is that
# of all joints moving together, so that the part of it which is inertia times acceleration varies with the pose.


class JointLoad(ComputedLoad):
    """The load cycle of a joint of a robot description."""

    joint: str
    case: str = ""  # load case of the robot that it belongs to: empty for the trajectory with its own payload


def radius_of(joint: Joint, travel_per_turn: float | None) -> float:
    """Travel of a joint per angle of the shaft that its drive turns: 1, or m/rad of one that slides."""
    field = ("robot", "drives", joint.name)
    if joint.turns:
        if travel_per_turn is not None:
            raise FieldError((*field, "travel_per_turn"), f"joint {quoted(joint.name)} turns; leave it out")
        return 1.0
    if travel_per_turn is None:
        raise FieldError(
            field, f"joint {quoted(joint.name)} slides; expected travel_per_turn of its screw or pulley, e.g. 10 mm"
        )
    return travel_per_turn / (2.0 * math.pi)


# -- Torques of all joints as functions of the masses that ride on the links: exactly linear.
#
# .. math:: \tau_i(t) = \tau_i^0(t) + \sum_k m_k \, c_{ik}(t)
#
# The drive of joint k is a point mass on the link before it, on the joint's axis, unless the section says elsewhere;
# one on the base is carried by no joint and has no column. Only joints between a mass and the base have other than 0
# there. What a drive adds by its own inertia about its centre, and the gyroscopic torques of its rotor, are left
# out; the rotor's inertia by the ratio squared is of the joint's own search. Armature in the description is of the
# drive that is to be replaced, and left out. Payloads are columns as well, so that load cases with another one cost
# nothing.


_GRAVITY = 9.80665  # m/s^2
_PAYLOAD = ""  # its name among those of the points


class JointsCase(NamedTuple):
    """A load case of the robot: a motion with a payload, and the columns of its torques."""

    name: str  # empty for the trajectory with its own payload
    payload: float  # kg
    motion: JointMotion
    torques: Torques  # shape (sets, segments * 2, joints)


@dataclass(frozen=True, slots=True)
class JointTorques:
    """Torques of the joints of a description over their load cases, as columns; loads for any masses of the drives."""

    section: RobotSection
    robot: Robot
    joints: tuple[str, ...]  # those that move, in the order of the description
    fixed_joints: Mapping[str, float]  # rad or m, of joints that do not
    points: tuple[str, ...]  # of the columns behind the description's own: drives by joint, then the payload, ""
    holding: Mapping[str, tuple[str, float]]  # of a drive that its link's mass is said to hold: the link and that mass
    cases: tuple[JointsCase, ...]  # the trajectory first
    carried: Mapping[str, tuple[str, ...]]  # by joint, those whose drives ride beyond it and so count in its load
    coupling: Array  # angles of drives per angle of joints, shape (drives, joints)
    order: tuple[str, ...]  # joints, each behind those that it carries
    notes: tuple[str, ...]  # of what was assumed

    def load(self, joint: str, masses: Mapping[str, float], case: int = 0) -> JointLoad:
        """Load of one joint with drives of given masses."""
        case_, column = self.cases[case], self.joints.index(joint)
        motion, place = case_.motion, self.section.drives.get(joint, DrivePlace())
        unknown = sorted(set(masses) - set(self.joints))
        if unknown:
            raise ValueError(f"no joint of the robot moves: {', '.join(unknown)}")
        beyond = dict(masses) | self.beyond_links(masses)
        carried = [case_.payload if name == _PAYLOAD else beyond.get(name, 0.0) for name in self.points]
        weights = np.array([1.0, *carried])
        torque, static, inertia = (weights @ values[:, :, column] for values in case_.torques)
        resisting, coulomb = self._friction(motion, column)
        radius, motors = radius_of(self.robot.joints[joint], place.travel_per_turn), place.motors
        speed, acceleration = motion.speed @ self.coupling[column], motion.acceleration @ self.coupling[column]
        cycle = LoadCycle(
            f"joint {joint}", motion.duration, speed / radius, acceleration / radius,
            (torque.reshape(-1, 2) + resisting) / motors * radius, float(inertia.max()) / motors * radius**2,
            radius=radius, holding_torque=float(np.abs(static.reshape(-1, 2) / motors).max()) * radius,
        ).split()  # fmt: skip
        if coulomb:
            cycle = replace(cycle, torque=cycle.torque + coulomb / motors * radius * cycle.direction).split()
        return JointLoad.with_cycle(cycle, motors, joint=joint, case=case_.name)

    def beyond_links(self, masses: Mapping[str, float]) -> dict[str, float]:
        """Mass by which drives are heavier than the links that are said to hold them [kg]."""
        link_masses = {name: mass for name, (_, mass) in self.holding.items() if name in masses}
        return {name: max(masses[name] - mass, 0.0) for name, mass in link_masses.items()}

    def _friction(self, motion: JointMotion, column: int) -> tuple[Array, float]:
        """Friction of joints at the drive of one: by their speeds, and Coulomb's against its own speed.

        A belt that passes other joints brings in part of theirs, by the direction of each over a segment.
        """
        joints = [self.robot.joints[name] for name in self.joints]
        if self.section.friction == "leave":
            return np.zeros(motion.speed.shape[:2]), 0.0
        share = np.linalg.inv(self.coupling)[:, column]
        resisting = motion.speed @ (share * [joint.damping for joint in joints])
        alone = np.count_nonzero(share) == np.count_nonzero(self.coupling[column]) == 1
        if alone:
            return resisting, joints[column].friction
        direction = np.sign(motion.speed.mean(axis=1, keepdims=True))
        return resisting + direction @ (share * [joint.friction for joint in joints]), 0.0


def joint_torques(section: RobotSection, spec_file: str, gravity: float = _GRAVITY) -> JointTorques:
    """Torques of the joints of a section, over all its load cases."""
    field = ("robot", "description")
    robot = read_description(path_from_spec(spec_file, section.description, field, "a URDF or MJCF file", "arm.urdf"))
    motion = motion_of(section, robot, spec_file)
    names = tuple(name for name in robot.joints if name in motion.joints)  # in the order of the description
    at = [motion.joints.index(name) for name in names]
    columns = (c[:, :, at] for c in (motion.position, motion.speed, motion.acceleration))
    motion = JointMotion(names, motion.duration, *columns)
    fixed = fixed_positions(section, robot, motion.joints)
    check_couplings(section, robot, motion.joints)
    drives = drive_places(section, robot, motion.joints)
    payload = payload_place(section, robot, motion.joints)
    points = drives if payload is None else {**drives, _PAYLOAD: payload}
    for joint in motion.joints:
        radius_of(robot.joints[joint], section.drives.get(joint, DrivePlace()).travel_per_turn)
    carried = carried_by(robot, drives, motion.joints)
    holding = dict[str, tuple[str, float]]()
    if section.masses == "with_drives":
        riding = {name: drives[name].link for on_it in carried.values() for name in on_it}
        holding = {name: (link, robot.links[link].mass) for name, link in riding.items()}
        carried = dict.fromkeys(carried, ())
    order, coupled = outermost_first(carried), coupling(section, robot, fixed, motion.joints)
    turn = rotation(np.array([section.mounting.roll, section.mounting.pitch, section.mounting.yaw]))
    down, start = turn.T[:, 2] * -gravity, motion.position[0, 0]
    check_joint_springs(section, robot, names)
    for number, force in enumerate(section.forces):
        check_link(robot, force.link, ("robot", "forces", number, "link"))
    files = forces_in_files(section, spec_file, float(motion.duration.sum()))
    motion = cut_at(motion, np.concatenate([np.empty(0), *(time for time, _ in files.values())]))
    directions = np.asarray(np.linalg.inv(coupled), dtype=np.float64)

    def torques(motion: JointMotion, files: Mapping[int, Rows] = files) -> Torques:
        """At both ends of each segment; one state where a segment starts as the one before ends."""
        states = [c.reshape(-1, len(names)) for c in (motion.position, motion.speed, motion.acceleration)]
        new = np.concatenate([[True], np.any([(c[1:] != c[:-1]).any(axis=1) for c in states], axis=0)])
        position, speed, acceleration = (c[new] for c in states)
        of_joints = torques_of(
            robot, fixed, list(points.values()), names, (position, speed, acceleration), down, directions
        )
        of_joints = Torques(*(values[:, np.cumsum(new) - 1] for values in of_joints))
        on_links = link_torques(section, robot, fixed, motion, down, turn, files)
        for column, moving in ((of_joints.torque, True), (of_joints.static, False)):
            column[0] += (on_links + spring_torques(section, robot, motion, start, moving=moving)) @ directions
        return of_joints

    along, own = torques(motion), section.payload.mass if section.payload else 0.0
    cases = [
        JointsCase("", own, motion, along)
    ]  # the trajectory, the same with other payloads, and poses that are held
    cases += [JointsCase(case.name, case.mass, motion, along) for case in section.payloads]
    for name, mass, pose in static_poses(section, robot, motion):
        cases.append(JointsCase(name, own if mass is None else mass, pose, torques(pose, {})))
    for column, name in enumerate(names):
        if not along.inertia[0, :, column].max() > 0.0 and not own:
            where = f"{robot.file}:{robot.joints[name].line}: joint {quoted(name)}"
            raise InputError(f"{where} moves no mass; expected <inertial> of its links, or a payload")
    notes = (*robot.notes, *_notes(section, robot, motion, fixed))
    return JointTorques(
        section, robot, motion.joints, fixed, tuple(points), holding, tuple(cases), carried, coupled, order, notes
    )


def _notes(section: RobotSection, robot: Robot, motion: JointMotion, fixed: Mapping[str, float]) -> Iterator[str]:
    """Sentences on what was assumed."""
    if fixed:
        places = ", ".join(f"{name} at {value:.4g} {unit_of(robot.joints[name])}" for name, value in fixed.items())
        yield f"joints that the trajectory does not move are held: {places}"
    if section.masses == "with_drives":
        yield "the links' masses hold their drives (robot.masses): none is added, but what it is heavier than its link"
    elif "masses" not in section.model_fields_set and drive_places(section, robot, motion.joints):
        yield (
            "each drive's mass is added to the link that it rides on; where the description's masses hold the drives "
            "already, as those of most robots on sale do, they count twice: robot: {masses: with_drives}"
        )
    own = [robot.joints[name] for name in motion.joints]
    if any(joint.armature for joint in own):
        yield "the armature in the description is of the drives that are to be replaced, and is left out"
    if any(joint.friction or joint.damping for joint in own):
        words = "is kept as that of their bearings" if section.friction == "keep" else "is left out"
        yield f"the friction of joints in the description {words}"
    if sprung := [joint.name for joint in own if joint.stiffness]:
        yield f"springs of the description act beside the drives of {', '.join(sprung)}"
    if lighter := [link.name for link in robot.links.values() if link.gravcomp * link.mass]:
        words = (
            "is carried beside the drives, as by counterweights; where a controller alone does that: "
            "robot: {gravcomp: leave}" if section.gravcomp == "keep" else "is carried by the drives"
        )  # fmt: skip
        yield f"the weight that the description takes off {', '.join(lighter)} (gravcomp) {words}"
    if any(force.file for force in section.forces) and section.holds:
        yield "forces of files act along the trajectory, not in poses that are held"
    if not motion.returns:
        yield "the trajectory ends elsewhere than it starts, and the cycle repeats from its start"
