"""What the parts of a drive weigh or cost together, of encoder and controller what is known."""

from __future__ import annotations

import math

from drivesizer.results.drive_set import DriveParts

ASSUMED = {"encoder": 0.020, "controller": 0.045}  # kg, where no catalogue lists one


def together(one: DriveParts, figure: str = "mass", *, estimates: bool = True) -> float:
    """Sum over motor, gearhead, brake, encoder and controller; without estimates of those that are listed."""
    turning = [one.motor, one.gearhead, *([one.brake] if one.brake else [])]
    found = sum(getattr(part, figure) for part in turning)
    for role, mass in ASSUMED.items():
        part = getattr(one, role)
        own = getattr(part, figure) if part else mass if figure == "mass" and estimates else math.nan
        found += 0.0 if math.isnan(own) else own
    return float(found)
