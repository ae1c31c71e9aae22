"""Limits of speed and acceleration along a path."""

from __future__ import annotations

from drivesizer.platform.planner import Limits

DRIVING = {"speed": 1.2, "acceleration": 0.8}

TURNING = {"turning_speed": 1.5, "turning_acceleration": 2.0}

BOTH = Limits(**DRIVING, **TURNING)
