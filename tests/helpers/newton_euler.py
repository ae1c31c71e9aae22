"""Newton-Euler inverse dynamics of a chain, written out as in a textbook, and random chains as data and as URDF.

Iterations of J. J. Craig, Introduction to Robotics, 3rd edition, Pearson, 2005, section 6.5, equations (6.45)-(6.53),
for links whose frames are those of URDF: joint i turns about, or slides along, an axis in the frame of link i.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation


def cross(a: Any, b: Any) -> Any:
    """Vector product; that of NumPy is slow for single vectors."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


@dataclass
class Part:
    """A joint and the link that it moves, as raw figures."""

    slides: bool
    place: Any
    rpy: Any
    axis: Any
    mass: float
    centre: Any
    inertia: Any  # about the centre of mass, along the link's axes
    points: list[tuple[float, Any]] = field(default_factory=list)  # masses that hang on the link, and where


def torques(parts: list[Part], q: Any, v: Any, a: Any, gravity: Any) -> Any:
    """Torque or force of each joint, the chain on a fixed base; gravity in the base's frame."""
    turns, places = [], []
    w, dw, acc = np.zeros(3), np.zeros(3), -np.asarray(gravity, float)
    forces, moments = [], []
    for part, x, xd, xdd in zip(parts, q, v, a, strict=True):
        z = np.asarray(part.axis) / np.linalg.norm(part.axis)
        turn, place = Rotation.from_euler("xyz", part.rpy).as_matrix(), np.asarray(part.place, float)
        before = cross(dw, place) + cross(w, cross(w, place)) + acc  # (6.47) of the joint's fixed frame
        if part.slides:
            place = place + turn @ z * x
            before = before + cross(dw, turn @ z * x) + cross(w, cross(w, turn @ z * x))
            w, dw = turn.T @ w, turn.T @ dw
            acc = turn.T @ before + 2.0 * cross(w, z * xd) + z * xdd  # (6.48)
        else:
            turn = turn @ Rotation.from_rotvec(z * x).as_matrix()
            acc = turn.T @ before
            dw = turn.T @ dw + cross(turn.T @ w, z * xd) + z * xdd  # (6.46)
            w = turn.T @ w + z * xd  # (6.45)
        bodies = [(part.mass, np.asarray(part.centre), np.asarray(part.inertia))]
        bodies += [(mass, np.asarray(at), np.zeros((3, 3))) for mass, at in part.points]
        force, moment = np.zeros(3), np.zeros(3)
        for mass, at, inertia in bodies:
            f = mass * (acc + cross(dw, at) + cross(w, cross(w, at)))  # (6.48), (6.49)
            force, moment = force + f, moment + inertia @ dw + cross(w, inertia @ w) + cross(at, f)  # (6.50)
        turns.append(turn)
        places.append(place)
        forces.append(force)
        moments.append(moment)
    found = np.zeros(len(parts))
    f, n = np.zeros(3), np.zeros(3)
    for i in range(len(parts) - 1, -1, -1):
        if i + 1 < len(parts):
            carried = turns[i + 1] @ f
            n = turns[i + 1] @ n + cross(places[i + 1], carried) + moments[i]  # (6.52)
            f = carried + forces[i]  # (6.51)
        else:
            f, n = forces[i], moments[i]
        z = np.asarray(parts[i].axis) / np.linalg.norm(parts[i].axis)
        found[i] = float((f if parts[i].slides else n) @ z)  # (6.53)
    return found


def energy(parts: list[Part], q: Any, v: Any, gravity: Any) -> float:
    """Kinetic and potential energy, from positions and speeds of each body."""
    turn, place, w, u = np.eye(3), np.zeros(3), np.zeros(3), np.zeros(3)  # in the base's frame
    total = 0.0
    for part, x, xd in zip(parts, q, v, strict=True):
        z = np.asarray(part.axis) / np.linalg.norm(part.axis)
        step = turn @ np.asarray(part.place)
        turn = turn @ Rotation.from_euler("xyz", part.rpy).as_matrix()
        along = turn @ z
        if part.slides:
            step = step + along * x
        u = u + cross(w, step) + (along * xd if part.slides else 0.0)
        place = place + step
        if not part.slides:
            turn, w = turn @ Rotation.from_rotvec(z * x).as_matrix(), w + along * xd
        for mass, at in [(part.mass, part.centre), *part.points]:
            arm = turn @ np.asarray(at)
            speed = u + cross(w, arm)
            total += mass * (float(speed @ speed) / 2.0 - float(np.asarray(gravity) @ (place + arm)))
        total += float(w @ turn @ np.asarray(part.inertia) @ turn.T @ w) / 2.0
    return total


def random_chain(rng: Any, count: int, *, sliding: bool = True) -> list[Part]:
    """A chain of links with any axes, offsets and inertias."""
    made = []
    for _ in range(count):
        spread = rng.normal(size=(3, 3))
        made.append(
            Part(
                sliding and bool(rng.random() < 0.3),
                rng.normal(size=3) * 0.3,
                rng.uniform(-3, 3, 3),
                rng.normal(size=3),
                float(rng.uniform(0.2, 8.0)),
                rng.normal(size=3) * 0.2,
                0.05 * (np.trace(spread @ spread.T) * np.eye(3) - spread @ spread.T),
            )
        )
    return made


def urdf(parts: list[Part], path: Path, extra: str = "") -> Path:
    """The chain as a file: links l0 (the base) to ln, joints j1 to jn."""
    said = ['<robot name="chain">', '<link name="l0"/>']
    for number, part in enumerate(parts, 1):
        inertia = np.asarray(part.inertia)
        entries = " ".join(
            f'i{a}{b}="{float(inertia[i, j])!r}"' for i, a in enumerate("xyz") for j, b in enumerate("xyz") if j >= i
        )
        kind = "prismatic" if part.slides else "revolute"
        said.append(
            f'<link name="l{number}"><inertial><origin xyz="{_text(part.centre)}"/><mass value="{part.mass!r}"/>'
            f"<inertia {entries}/></inertial></link>"
            f'<joint name="j{number}" type="{kind}"><parent link="l{number - 1}"/>'
            f'<child link="l{number}"/><origin xyz="{_text(part.place)}" rpy="{_text(part.rpy)}"/>'
            f'<axis xyz="{_text(part.axis)}"/><limit lower="-10" upper="10" velocity="50" effort="1"/></joint>'
        )
    path.write_text("\n".join([*said, extra, "</robot>"]), encoding="utf-8")
    return path


def _text(values: Any) -> str:
    return " ".join(repr(float(value)) for value in np.asarray(values))
