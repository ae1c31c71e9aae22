"""Robot descriptions, URDF and MJCF, to one record of links and joints: strict, without meshes or a simulator."""

from __future__ import annotations

from pathlib import Path

from drivesizer.errors import InputError
from drivesizer.spec.description.mjcf import mjcf_of
from drivesizer.spec.description.record import Robot
from drivesizer.spec.description.urdf import urdf_of
from drivesizer.spec.description.xml_tree import read_tree

__all__ = ["read_description"]


def read_description(path: Path) -> Robot:
    """Links and joints of a file, URDF or MJCF by its root element."""
    root = read_tree(path)
    if root.tag == "mujoco":
        return mjcf_of(root, path)
    if root.tag == "robot":
        return urdf_of(root, path)
    raise InputError(f"{path}:{root.line}: <{root.tag[:40]}> is no robot; expected <robot> of URDF or <mujoco> of MJCF")
