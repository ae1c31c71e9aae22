"""Mass of a body of an MJCF file: its inertial, or its solids by mass or density; of a mesh it stays unknown."""

from __future__ import annotations

import numpy as np

from drivesizer.errors import InputError, quoted
from drivesizer.spec.description.mjcf_classes import Settings, frame_of
from drivesizer.spec.description.solids import Body, shape_of, together
from drivesizer.spec.description.xml_tree import Node, figure, figures

__all__ = ["mass_of"]

_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "ellipsoid": 3, "box": 3}
_FLAT = ("plane", "hfield")  # without volume
_WATER = 1000.0  # kg/m^3, the density of MJCF where none is given
_NONE = Body(0.0, np.zeros(3), np.zeros((3, 3)))


def mass_of(node: Node, settings: Settings, childclass: str) -> tuple[Body, str]:
    """Mass of one body without those that hang on it."""
    inertial = node.first("inertial")
    if settings.from_geoms != "true" and inertial is not None:
        return _inertial(inertial, settings), ""
    if settings.from_geoms == "false":
        return _NONE, ""
    solids: list[Body] = []
    for geom in node.all("geom"):
        whole = settings.whole(geom, childclass)
        if _weightless(whole, settings):
            continue
        kind = whole.attributes.get("type", "mesh" if "mesh" in whole.attributes else "sphere")
        if kind not in _SIZES or "mesh" in whole.attributes:
            return _NONE, f"has a {kind} of unknown mass on line {geom.line}; expected <inertial>"
        solids.append(_solid(whole, kind, settings))
    return together(solids) if solids else _NONE, ""


def _weightless(geom: Node, settings: Settings) -> bool:
    """Whether a geom adds no mass, whatever its size."""
    path, given = settings.path, geom.attributes
    if given.get("type", "sphere") in _FLAT:
        return True
    return figure(geom, "mass", path, 1.0) == 0.0 or ("mass" not in given and figure(geom, "density", path, 1.0) == 0.0)


def _inertial(node: Node, settings: Settings) -> Body:
    """Figures of the element as written."""
    path, where = settings.path, f"{settings.path}:{node.line}: <inertial>"
    mass, (centre, turn) = figure(node, "mass", path), frame_of(node, settings)
    if "pos" not in node.attributes:
        raise InputError(f"{where} has no pos")
    if not mass >= 0.0:
        raise InputError(f"{where}: a mass of {mass:g} kg is none; expected 0 or more")
    full, principal = figures(node, "fullinertia", path), figures(node, "diaginertia", path)
    if (len(full), len(principal)) not in ((6, 0), (0, 3)):
        raise InputError(f"{where}: expected diaginertia of 3 numbers, or fullinertia of 6")
    if len(full):
        xx, yy, zz, xy, xz, yz = full
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    else:
        inertia = turn @ np.diag(principal) @ turn.T
    if inertia.diagonal().min() < 0.0:
        raise InputError(f"{where}: an inertia below 0 is none")
    return Body(mass, centre, inertia)


def _solid(geom: Node, kind: str, settings: Settings) -> Body:
    """A geom by its size and mass, or density."""
    path, where = settings.path, f"{settings.path}:{geom.line}: <geom>"
    if geom.attributes.get("shellinertia", "false") != "false":
        raise InputError(f"{where} shellinertia is not read; expected solids")
    size = figures(geom, "size", path).tolist()
    centre, turn = frame_of(geom, settings)
    if "fromto" in geom.attributes:
        if kind not in ("capsule", "cylinder"):
            raise InputError(f"{where} fromto of a {kind} is not read; expected pos and size")
        centre, turn, half = _between(geom, settings)
        size = [*size[:1], half]
    size = size[: _SIZES[kind]]
    if len(size) != _SIZES[kind] or not min(size) > 0.0:
        found = quoted(geom.attributes.get("size", ""))
        raise InputError(f"{where} size: {found}; expected {_SIZES[kind]} numbers above 0 of a {kind}")
    volume, radii = shape_of(kind, size)
    mass = figure(geom, "mass", path, figure(geom, "density", path, _WATER) * volume)
    if not mass >= 0.0:
        raise InputError(f"{where}: a mass of {mass:g} kg is none; expected 0 or more")
    return Body(mass, centre, mass * turn @ np.diag(radii) @ turn.T)


def _between(geom: Node, settings: Settings) -> tuple[np.ndarray, np.ndarray, float]:
    """Middle, turn and half the length of a geom between two points."""
    ends = figures(geom, "fromto", settings.path)
    where = f"{settings.path}:{geom.line}: <geom> fromto: {quoted(geom.attributes['fromto'])}"
    if len(ends) != 6:
        raise InputError(f"{where}; expected 6 numbers")
    along = ends[:3] - ends[3:]
    length = float(np.linalg.norm(along))
    if not length > 0.0:
        raise InputError(f"{where} has no length")
    direction = " ".join(repr(float(x)) for x in along)
    turned = frame_of(Node("geom", geom.line, {"zaxis": direction}), settings)[1]
    return (ends[:3] + ends[3:]) / 2.0, turned, length / 2.0
