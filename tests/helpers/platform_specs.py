"""Sections of a platform's spec."""

from __future__ import annotations

from drivesizer.loads.wheeled_vehicle import WheeledVehicle
from drivesizer.spec.platform import Platform

SIZE = {"length": "707 mm", "width": "350 mm", "height": "184 mm"}  # of the paper

DIAGONAL = {"kind": "mecanum", "wheelbase": "477.06 mm", "track": "269.9 mm"}


def section(**given):
    return Platform.model_validate({"layout": DIAGONAL, "size": SIZE} | given)


def vehicle(**given):
    figures = {
        "kind": "wheeled_vehicle", "mass": "45 kg", "driven_wheels": 4, "wheel_diameter": "152.4 mm",
        "rolling_resistance": 0.02, "inertia": "32 kg*cm^2",
    }  # fmt: skip
    return WheeledVehicle.model_validate(figures | given)


DOOR = {"name": "door", "width": "400 mm"}
