"""Loads with the drives of other axes on them.

Along a line a carried mass adds to that of the load. About an axis it is a point at a distance, the housing's own
inertia about its centre left out:

.. math:: m' = m + m_c, \\qquad r' = (m r + m_c a) / m', \\qquad J' = J + m_c a^2
"""

from __future__ import annotations

from collections.abc import Iterable
from math import fsum

from drivesizer.errors import InputError
from drivesizer.loads.arm import Arm
from drivesizer.loads.kinds import Load
from drivesizer.loads.rotary_table import RotaryTable
from drivesizer.loads.wheeled_vehicle import WheeledVehicle

__all__ = ["carrying", "check_carrier"]

_ALONG = ("belt_axis", "rack_pinion", "hoist", "lead_screw", "ball_screw", "conveyor", "wheeled_vehicle")


def check_carrier(load: Load, distances: Iterable[float | None]) -> None:
    """Refuse a load that carries no drives, and a distance that its kind lacks or does not have."""
    turning = isinstance(load, Arm | RotaryTable)
    if not turning and load.kind not in _ALONG:
        raise InputError(f"a {load.kind} carries no drives; expected an axis with a mass, an arm or a rotary_table")
    for distance in distances:
        if turning and distance is None:
            raise InputError(f"a {load.kind} carries them at a distance; expected e.g. {{wrist: {{at: 300 mm}}}}")
        if not turning and distance is not None:
            raise InputError(f"a {load.kind} moves along a line; expected the name alone, without at")


def carrying(load: Load, masses: Iterable[tuple[float, float | None]]) -> Load:
    """A load with the drives of other axes on it."""
    found = [(mass, distance or 0.0) for mass, distance in masses if mass]
    if not found:
        return load
    total, moment, inertia = (fsum(mass * distance**power for mass, distance in found) for power in (0, 1, 2))
    if isinstance(load, Arm):
        mass = load.mass + total
        own = load.mass * load.length**2 if load.inertia is None else load.inertia
        length = (load.mass * load.length + moment) / mass
        return load.model_copy(update={"mass": mass, "length": length, "inertia": own + inertia})
    if isinstance(load, RotaryTable):
        mass = load.mass + total
        off_axis = (load.mass * load.eccentricity + moment) / mass
        return load.model_copy(update={"mass": mass, "eccentricity": off_axis, "inertia": load.inertia + inertia})
    key = "mass"
    assert isinstance(load, WheeledVehicle) or hasattr(load, key)
    return load.model_copy(update={key: getattr(load, key) + total})
