r"""Torques of joints by MuJoCo's recursive Newton-Euler algorithm, that of its ``mj_inverse``.

.. math:: \tau = M(q) \, \ddot q + c(q, \dot q) + g(q)

Nothing else acts in the model: no contacts, limits, losses, springs or rotors, so that the torques are linear in the
masses. Forces on links add -J^T F of each (``force_torques``). The model is made of the description's record, with
joints that are held as parts of their links; bodies without mass are allowed, for the algorithm divides by none. Point
masses are columns in closed form, of 1 kg each, by the Jacobian J of their point, with g the acceleration of free fall:

.. math:: c = J^T (J \ddot q + \dot J \dot q - g), \qquad c_{static} = -J^T g, \qquad M_{jj} = |J_j|^2

Source: R. Featherstone, Rigid Body Dynamics Algorithms, Springer, 2008, table 5.1; MuJoCo, documentation, chapter
Computation, inverse dynamics.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, quoted
from drivesizer.physics.load_cycle import end_times
from drivesizer.spec.description import Robot, placed
from drivesizer.units import RANGES

# -- Record of joints over time: segments with both ends of each, as a load cycle has them.


Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class JointMotion:
    """Positions, speeds and accelerations of joints over one cycle."""

    joints: tuple[str, ...]
    duration: Array  # s, of each segment, shape (segments,)
    position: Array  # rad or m, at both ends, shape (segments, 2, joints)
    speed: Array  # rad/s or m/s
    acceleration: Array  # rad/s^2 or m/s^2

    @property
    def time(self) -> Array:
        """Time at both ends of each segment [s], shape (segments, 2)."""
        return end_times(self.duration)

    @property
    def returns(self) -> bool:
        """Whether all joints end where they start."""
        first, last = self.position[0, 0], self.position[-1, 1]
        return bool((np.abs(last - first) <= 1e-6 * (1.0 + np.abs(first))).all())


_OLDEST = (3, 3, 1)  # MuJoCo; before, the rate of a Jacobian (mj_jacDot) was wrong
_MOST_LINKS, _MOST_LENGTH = 500, 1e4  # m
_AT_ONCE = 2000  # states, of which the Jacobians of all points are kept
_INDEFINITE = -1e-9  # of the largest principal moment: less is what rounding makes of 0


class Attached(NamedTuple):
    """A point of a link at which a mass hangs."""

    link: str
    at: Array  # m, in the frame of the link, shape (3,)


class Torques(NamedTuple):
    """Of each set of masses, the description's first and then 1 kg at each point; shape (sets, states, joints)."""

    torque: Array  # N*m or N
    static: Array  # the same at rest: of weight alone
    inertia: Array  # kg*m^2 or kg, of each direction alone: of single joints the diagonal of the mass matrix


def torques_of(
    robot: Robot, fixed: Mapping[str, float], points: Sequence[Attached], joints: Sequence[str],
    states: tuple[Array, Array, Array], gravity: Array, directions: Array | None = None,
) -> Torques:  # fmt: skip
    """Torques of joints in several states."""
    mujoco = _mujoco()
    _refuse_unknown_masses(robot, fixed)
    model, principal = _model(mujoco, robot, fixed, points)
    model.opt.gravity[:], model.body_mass[:], model.body_inertia[:] = gravity, 0.0, 0.0  # points have none
    for number, (link, moments) in enumerate(zip(robot.links.values(), principal, strict=True)):
        body = model.body(f"link{number}").id
        model.body_mass[body], model.body_inertia[body] = link.mass, moments
    model.body_subtreemass[:] = model.body_mass
    for body in range(model.nbody - 1, 0, -1):  # only where moments are taken about hangs on it
        model.body_subtreemass[model.body_parentid[body]] += model.body_subtreemass[body]
    place = np.argsort([model.joint(name).id for name in joints])  # the model has its joints in an order of its own
    position, speed, acceleration = (np.ascontiguousarray(state[:, place]) for state in states)
    along = (np.eye(len(joints)) if directions is None else directions)[place]
    bodies = [model.body(f"point{number}").id for number in range(len(points))]
    parts = [
        _part(mujoco, model, bodies, (position[rows], speed[rows], acceleration[rows]), along)
        for rows in (slice(first, first + _AT_ONCE) for first in range(0, len(position), _AT_ONCE))
    ]
    return Torques(*(np.concatenate(columns, axis=1) for columns in zip(*parts, strict=True)))


def _mujoco() -> Any:
    try:
        import mujoco
    except ImportError:
        raise InputError('robot: joints need MuJoCo; pip install "drivesizer[robot]"') from None
    if tuple(int(part) for part in re.findall(r"\d+", mujoco.__version__)[:3]) < _OLDEST:
        oldest = ".".join(str(part) for part in _OLDEST)
        fault = f"joints need MuJoCo {oldest}, found {mujoco.__version__}"
        raise InputError(f'robot: {fault}; pip install --upgrade "drivesizer[robot]"')
    return mujoco


def _refuse_unknown_masses(robot: Robot, fixed: Mapping[str, float]) -> None:
    """Refuse links that move and whose mass is unknown or none."""
    if len(robot.links) > _MOST_LINKS:
        raise InputError(f"{robot.file}: {len(robot.links)} links; expected at most {_MOST_LINKS}")
    for link in robot.links.values():
        where = f"{robot.file}:{link.line}: link {quoted(link.name)}"
        moves = any(joint.moves and joint.name not in fixed for joint in robot.chain(link.name))
        if link.lacking and moves:
            raise InputError(f"{where} {link.lacking}")
        _possible(where, link.mass, "kg", RANGES["mass"][1])
        _possible(where, link.centre, "m", _MOST_LENGTH)
        _possible(where, link.inertia, "kg*m^2", RANGES["inertia"][1])
        principal = np.linalg.eigvalsh(link.inertia)
        if moves and principal[0] < _INDEFINITE * abs(principal).max():
            raise InputError(f"{where} has an inertia of {principal[0]:.3g} kg*m^2 about an axis; expected 0 or more")
    for joint in robot.joints.values():
        for place in (joint.place, joint.anchor, 0.0 if joint.turns else joint.reference):
            _possible(f"{robot.file}:{joint.line}: joint {quoted(joint.name)}", place, "m", _MOST_LENGTH)


def _possible(where: str, figures: float | Array, unit: str, most: float) -> None:
    """Refuse figures that no machine has."""
    largest = float(np.abs(figures).max())
    if not largest <= most:
        raise InputError(f"{where} has {largest:.3g} {unit}; no robot has more than {most:g} {unit}")


# --- the model


def _model(
    mujoco: Any, robot: Robot, fixed: Mapping[str, float], points: Sequence[Attached]
) -> tuple[Any, list[Array]]:
    """Compiled model, and the principal moments of inertia of each link.

    Links are named by their number: their own names may be those that MuJoCo keeps for itself.
    """
    spec, above = mujoco.MjSpec(), robot.above
    bodies: dict[str, Any] = {}
    numbers, principal = {name: number for number, name in enumerate(robot.links)}, [np.zeros(3)] * len(robot.links)
    for name in robot.outwards():
        joint, link = above.get(name), robot.links[name]
        body = (bodies[joint.parent] if joint else spec.worldbody).add_body(name=f"link{numbers[name]}")
        if joint is not None:
            body.pos, turn = placed(joint, fixed.get(joint.name, joint.reference))
            body.quat = _quaternion(mujoco, turn)
        principal[numbers[name]], axes = np.linalg.eigh(link.inertia)
        axes[:, 0] *= np.sign(np.linalg.det(axes))  # a right-handed rotation
        _weigh(body, link.centre, _quaternion(mujoco, axes))
        if joint is not None and joint.moves and joint.name not in fixed:
            kind = mujoco.mjtJoint.mjJNT_HINGE if joint.turns else mujoco.mjtJoint.mjJNT_SLIDE
            body.add_joint(name=joint.name, type=kind, axis=joint.axis, pos=joint.anchor, ref=joint.reference)
        bodies[name] = body
    for number, point in enumerate(points):
        body = bodies[point.link].add_body(name=f"point{number}")
        body.pos = point.at
        _weigh(body, np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
    spec.compiler.degree = False
    return spec.compile(), principal


def _weigh(body: Any, centre: Array, axes: Array) -> None:
    """A mass and inertia of 1, so that the model compiles; the true ones are written into it later."""
    body.mass, body.inertia, body.ipos, body.iquat, body.explicitinertial = 1.0, np.ones(3), centre, axes, True


def _quaternion(mujoco: Any, turn: Array) -> Array:
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(turn).ravel())
    return quaternion


# --- the torques


def _part(
    mujoco: Any, model: Any, bodies: Sequence[int], states: tuple[Array, Array, Array], directions: Array
) -> Torques:
    """Some states, joints in the order of the model: own masses one by one, then all points at once."""
    position, speed, acceleration = states
    count, joints = position.shape
    torque, static, inertia = (np.zeros((count, joints)) for _ in range(3))
    jacobian, rate = (np.zeros((count, len(bodies), 3, joints)) for _ in range(2))
    data, gravity, units = mujoco.MjData(model), model.opt.gravity.copy(), np.ascontiguousarray(directions.T)
    result = np.zeros(joints)
    for row in range(count):
        data.qpos[:], data.qvel[:], data.qacc[:] = position[row], speed[row], acceleration[row]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        mujoco.mj_rne(model, data, 1, torque[row])
        for number, body in enumerate(bodies):
            mujoco.mj_jac(model, data, jacobian[row, number], None, data.xpos[body], body)
            mujoco.mj_jacDot(model, data, rate[row, number], None, data.xpos[body], body)
        data.qvel[:], data.qacc[:] = 0.0, 0.0
        mujoco.mj_comVel(model, data)
        mujoco.mj_rne(model, data, 1, static[row])
        model.opt.gravity[:] = 0.0
        for column, unit in enumerate(units):  # torque of one direction's acceleration alone, at rest
            data.qacc[:] = unit
            mujoco.mj_rne(model, data, 1, result)
            inertia[row, column] = result @ unit
        model.opt.gravity[:] = gravity
    along = jacobian @ directions  # of each point, shape (states, points, 3, directions)
    pull = np.einsum("spxj,sj->spx", jacobian, acceleration) + np.einsum("spxj,sj->spx", rate, speed) - gravity
    columns = (
        np.einsum("spxd,spx->psd", along, pull),
        np.einsum("spxd,x->psd", along, -gravity),
        np.einsum("spxd,spxd->psd", along, along),
    )
    own = (torque @ directions, static @ directions, inertia)
    return Torques(*(np.concatenate([own_row[None], many]) for own_row, many in zip(own, columns, strict=True)))


# --- forces on links


def force_torques(
    robot: Robot, fixed: Mapping[str, float], points: Sequence[Attached], joints: Sequence[str], position: Array,
    forces: Array,
) -> Array:  # fmt: skip
    """Torques that joints need against forces at points of links, shape (states, joints): minus J^T F of each.

    The forces are in the frame of the root, shape (states, points, 3).
    """
    mujoco = _mujoco()
    model, _ = _model(mujoco, robot, fixed, points)
    data, jacobian = mujoco.MjData(model), np.zeros((3, len(joints)))
    order = np.array([model.joint(name).id for name in joints], dtype=np.int64)
    bodies = [model.body(f"point{number}").id for number in range(len(points))]
    torques = np.zeros(position.shape)
    for row, at in enumerate(position):
        data.qpos[order] = at
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        for number, body in enumerate(bodies):
            mujoco.mj_jac(model, data, jacobian, None, data.xpos[body], body)
            torques[row] -= forces[row, number] @ jacobian[:, order]
    return torques
