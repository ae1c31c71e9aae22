"""Machines as load cycles: one file per kind of load, each a function that returns a ``LoadCycle``."""

from drivesizer.loads.wheeled_vehicle import wheeled_vehicle

__all__ = ["wheeled_vehicle"]
