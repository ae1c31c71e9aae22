"""Parts of a drive in a few words, for a parts list."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from drivesizer.catalog import Belt, Pulley, columns_of
from drivesizer.results.drive_set import section_of
from drivesizer.units import show

__all__ = ["SAID"]


def _figures_of(*names: str) -> Callable[[Any], str]:
    def said(part: Any) -> str:
        columns = columns_of(section_of(part))
        return ", ".join(show(getattr(part, name), columns[name].unit, columns[name].kind) for name in names)

    return said


def _toothed(part: Belt | Pulley) -> str:
    return f"{part.profile} {show(part.pitch, 'mm', 'length')}, {part.teeth:.0f} teeth"


def _pulley(part: Pulley) -> str:
    return _toothed(part) + (f", bore {part.bore}" if part.bore else "")


_MOTOR = _figures_of("assigned_power", "nominal_voltage")
_STEPPER = _figures_of("holding_torque", "nominal_current")
SAID: dict[str, Callable[[Any], str]] = {
    "motor": lambda part: (_STEPPER if part.kind == "stepper" else _MOTOR)(part),
    "gearhead": lambda part: f"{part.reduction}, exactly {part.ratio:.5g}".removeprefix(", "),
    "driving pulley": _pulley,
    "belt": lambda part: f"{_toothed(part)}, {show(part.width, 'mm', 'length')} wide",
    "driven pulley": _pulley,
    "screw": lambda part: f"{part.kind} screw",
    "brake": _figures_of("static_torque", "supply"),
    "encoder": lambda part: part.resolution,
    "controller": lambda part: part.buses.replace(";", ","),
    "actuator": _figures_of("nominal_voltage", "nominal_torque"),
    "power supply": _figures_of("nominal_voltage", "continuous_current"),
    "brake resistor": _figures_of("resistance", "power"),
}
"""What a part is, by its role."""
