r"""A trajectory of a platform as load cycles, one for each driven wheel.

Torques are those of ``dynamics`` without the wheels' own rotors, which the drive model adds. Resistances turn round
with each wheel and roller, so pieces are cut where one does; within a piece they have the sign of the motion in it.

Two limits are the load's own:

- traction: what the floor must transmit, see ``grip``, against μ N; N is what the wheel carries at that moment,
  acceleration and slope included.
- wheel_unloading: what N is below the wheel's load on a level floor at rest, against that load or the share of it that
  may be taken off. Past it the platform tips.

The inertia of a cycle is torque over acceleration where all wheels act together: of the motions that turn the wheels
alike in torque and acceleration (eigenvectors of the inertia in the wheels' space), the largest in which the wheel
turns. Straight ahead on N equal wheels it is :math:`J_w + m r^2 / N`, as of a vehicle.
"""

from __future__ import annotations

from math import nan

import numpy as np

from drivesizer.errors import InputError
from drivesizer.physics.load_cycle import LoadCycle, OwnLimit
from drivesizer.platform.contact_loads import LEVEL, Ground, centre_acceleration, contact_loads
from drivesizer.platform.dynamics import Dynamics, wheel_torques
from drivesizer.platform.grip import floor_forces
from drivesizer.platform.kinematics import map_columns
from drivesizer.platform.matrix_equation import Array
from drivesizer.platform.motion import Motion, allowed, blocks, largest, seen
from drivesizer.platform.trajectory import Trajectory

__all__ = ["contact_forces", "effective_inertia", "wheel_cycles", "wheel_loads"]

_ROUNDING = 1e-9  # of the largest speed or torque of all wheels: below it there is none
_NOTHING = 1e-9  # of the largest inertia: below it the wheels make no motion
_TAKES_PART = 1e-3  # of the wheel that turns most


def wheel_cycles(
    d: Dynamics,
    trajectory: Trajectory,
    ground: Ground = LEVEL,
    *,
    friction: float | None = None,
    least_load: float = 0.0,
    sliding: float = 0.02,
) -> tuple[LoadCycle, ...]:
    """The load cycle of each driven wheel, in the order of the wheels.

    Parameters
    ----------
    d
        The platform.
    trajectory
        Its motion; one that is repeated starts and ends at rest.
    ground
        The floor; where its slope is a column, at both ends of each piece, shape (n, 2).
    friction
        Coefficient μ between wheel and floor [1]; without it the limit of traction is unknown.
    least_load
        Share of its load on a level floor at rest that each wheel must keep [1].
    sliding
        How far the trajectory may be off what the wheels allow, as a share of its largest speed; the wheels follow
        what they can of it. Sampled tracks need some.

    Returns
    -------
    tuple of LoadCycle
        One for each driven wheel.

    Raises
    ------
    InputError
        When the wheels do not allow the motion, or a figure cannot be computed with.
    """
    if friction is not None and not 0.0 < friction < np.inf:  # written so that NaN fails too
        raise InputError(f"friction: must be a number above 0, got {friction!r}")
    if not 0.0 <= least_load < 1.0:
        raise InputError(f"least_load: must lie between 0 and 1, got {least_load!r}")
    k, top = d.kinematics, largest(trajectory)
    allowed(k, trajectory, sliding)
    parts = [seen(d, *part, top) for part in blocks(trajectory, ground)]
    duration = np.concatenate([m.duration for m in parts])
    columns = np.concatenate([_columns(d, m) for m in parts], axis=2)
    torque, speed = _snapped(columns[0]), _snapped(columns[1])
    level = contact_loads(d.platform, ground=Ground(gravity=ground.gravity))
    time, inertia, made = _time(duration), effective_inertia(d), []
    for i, place in enumerate(k.driven):
        gain, load, force = columns[2:, i]
        own = (_grip(time, force, load, friction), _unloading(time, float(level[place]), load, least_load))
        name, radius = f"wheel {place + 1}", k.wheels[place].radius
        cycle = LoadCycle(name, duration, speed[i], gain, torque[i], float(inertia[i]), own, radius)
        made.append(cycle.split())
    return tuple(made)


def _columns(d: Dynamics, m: Motion) -> Array:
    """Torque, speed, acceleration, load and force on the floor of each driven wheel; shape (5, n driven, n, 2)."""
    E, ends = d.kinematics.E[list(d.kinematics.driven)], (m.eta, m.eta_dot)
    torque = wheel_torques(d, *ends, theta=m.facing, ground=m.ground, towards=m.towards, rotors=False)
    speed, gain = (map_columns(E, c) for c in ends)
    load = wheel_loads(d, m)[list(d.kinematics.driven)]
    return np.stack([torque, speed, gain, load, contact_forces(d, m)])


def _time(duration: Array) -> Array:
    """At both ends of each piece, from the start [s]; shape (n, 2)."""
    end = np.cumsum(duration)
    return np.stack([end - duration, end], axis=1)


def _snapped(values: Array) -> Array:
    """Columns without what rounding leaves where there is nothing."""
    values[np.abs(values) <= _ROUNDING * np.abs(values).max(initial=0.0)] = 0.0
    return values


# --- what the floor sees ----------------------------------------------------------------------------------------------


def wheel_loads(d: Dynamics, m: Motion) -> Array:
    """Loads of wheels, then casters [N], below 0 where one would lift off; shape (wheels and casters, n, 2).

    Parameters
    ----------
    d
        The platform.
    m
        Its motion, see ``motion``.

    Returns
    -------
    array
        Loads [N], shape (wheels and casters, n, 2).
    """
    return contact_loads(d.platform, m.facing, m.ground, accelerated=centre_acceleration(d.platform, m.eta, m.eta_dot))


def contact_forces(d: Dynamics, m: Motion) -> Array:
    """Size of the force between each driven wheel and the floor [N], shape (n driven, n, 2); see ``grip``.

    Parameters
    ----------
    d, m
        The platform and its motion, see ``motion``.

    Returns
    -------
    array
        Forces [N], shape (n driven, n, 2).
    """
    forces = floor_forces(d, m.eta, m.eta_dot, theta=m.facing, ground=m.ground, towards=m.towards)
    return np.asarray(np.hypot(*forces)[list(d.kinematics.driven)])


def effective_inertia(d: Dynamics) -> Array:
    """Torque over acceleration of each driven wheel where all act together, without their rotors [kg*m^2]; shape (n,).

    Parameters
    ----------
    d
        The platform.
    """
    k, driven = d.kinematics, list(d.kinematics.driven)
    E = k.E[driven]
    M = d.M - E.T @ (np.array([k.wheels[i].rotor_inertia for i in driven])[:, None] * E)
    values, modes = np.linalg.eigh(k.K_plus.T @ M @ k.K_plus)
    modes = modes[:, values > _NOTHING * values[-1]]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = (d.distribution @ M @ k.K_plus @ modes) / modes
    turns = np.abs(modes) > _TAKES_PART * np.abs(modes).max(axis=0)
    most: Array = np.where(turns, ratio, -np.inf).max(axis=1)
    return np.asarray(np.where(most > 0.0, most, nan))


def _grip(time: Array, force: Array, load: Array, friction: float | None) -> OwnLimit:
    """The force on the floor where it is largest beside what the wheel carries."""
    carried = np.maximum(load, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        worst = int(np.nan_to_num(force / carried, nan=0.0, posinf=np.inf).argmax())
    limit = nan if friction is None else friction * float(carried.reshape(-1)[worst])
    demand = float(force.reshape(-1)[worst])
    return OwnLimit("traction", demand, limit, float(time.reshape(-1)[worst]))


def _unloading(time: Array, before: float, load: Array, share: float) -> OwnLimit:
    """Largest decrease of a wheel's load."""
    worst = int(load.argmin())
    taken, at = before - float(load.reshape(-1)[worst]), float(time.reshape(-1)[worst])
    return OwnLimit("wheel_unloading", taken, (1.0 - share) * before, at)
