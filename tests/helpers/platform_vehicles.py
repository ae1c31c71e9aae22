"""Vehicles whose masses and wheels are not symmetrical."""

from __future__ import annotations

from dataclasses import replace

from platforms import WHEEL, mecanum

LOPSIDED = replace(mecanum(inertia=0.02, rotor_inertia=0.03), x=0.11, y=-0.07)

VEHICLE = f"""
name: x
load: {{kind: wheeled_vehicle, mass: 45 kg, driven_wheels: 4, wheel_diameter: 152.4 mm, rolling_resistance: 0.02,
  inertia: {WHEEL!r} kg*m^2, slope: %s deg}}
motion: {{speed: 1.5 m/s, acceleration_time: 2 s, cruise_time: 3 s, rest_time: 1 s}}
supply: {{nominal: 24 V}}
"""
