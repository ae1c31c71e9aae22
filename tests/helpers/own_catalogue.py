"""A catalogue as a user drops it on the live page: a strong, light motor that drives its load without a gearhead."""

from __future__ import annotations

from pathlib import Path

__all__ = ["CONTRADICTORY", "HOSTILE", "RIGHT"]

RIGHT = Path(__file__).with_name("own_catalogue.yaml").read_text(encoding="utf-8")
"""No-load speed (24 V - 0.3 ohm 0.1 A)/(80 mN*m/A) = 2861 rpm."""
CONTRADICTORY = RIGHT.replace("2860 rpm", "5000 rpm").replace("0.3 ohm", "0.3 ohm, stall_torque: 1 N*m")
HOSTILE = RIGHT.replace("OWN 40", '"<img src=x onerror=alert(1)>"').replace("Anymaker", '"<b>Any</b>"')
