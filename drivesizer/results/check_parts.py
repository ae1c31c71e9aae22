"""The part of the machine that each check concerns, by which reports group them."""

from __future__ import annotations

from collections.abc import Sequence

from drivesizer.results.check import Check

__all__ = ["PARTS", "part_of", "sorted_by_part"]

_OF_PART = (  # part, and how the names of its checks begin
    (
        "Motor",
        ("motor_", "winding_", "hottest_", "speed_constant", "pull_out_", "start_", "step_", "lost_", "load_angle"),
    ),
    ("Gearhead", ("gearhead_", "backlash_", "largest_reduction")),
    ("Brake", ("brake_", "holding")),
    ("Belt", ("belt_",)),
    ("Screw", ("screw_",)),
    ("Encoder", ("encoder_",)),
    ("Controller", ("controller_",)),
    ("Supply", ("supply_", "bus_")),
    ("Brake resistor", ("resistor_", "chopper_")),
    ("Battery", ("battery_",)),
    ("Control loop", ("stability", "phase_margin", "tracking_error", "bandwidth")),
)
_MACHINE = "Machine"  # whatever concerns the drive as a whole, or the machine
PARTS = (*(part for part, _ in _OF_PART), _MACHINE)


def part_of(name: str) -> str:
    """The part that a check concerns.

    >>> part_of("winding_temperature"), part_of("backlash_at_load"), part_of("traction")
    ('Motor', 'Gearhead', 'Machine')
    """
    return next((part for part, begins in _OF_PART if name.startswith(begins)), _MACHINE)


def sorted_by_part(checks: Sequence[Check]) -> list[Check]:
    """Checks sorted by part; those of one part in the order given."""
    return sorted(checks, key=lambda check: PARTS.index(part_of(check.name)))
