"""The parts of a set as the report lists them: role, maker and family, part number, and what each is."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from drivesizer.catalog import Belt, Pulley, columns_of
from drivesizer.results import DriveSet, made_by, section_of
from drivesizer.units import show

__all__ = ["parts"]


def parts(found: DriveSet) -> list[dict[str, str]]:
    """A row for each part, and one for a belt of which only the ratio is known."""
    rows = [_row(role, part, found) for role, part in found.parts.items()]
    if not found.belt_drive and (found.belt_ratio != 1.0 or found.belt_efficiency != 1.0):
        said = f"{found.belt_ratio:g} : 1, efficiency {100 * found.belt_efficiency:.4g} %"
        place = 1 + next((n for n, row in enumerate(rows) if row["role"] == "Gearhead"), 0)
        rows.insert(place, {"role": "Belt", "family": "", "part": "", "said": said})
    return rows


def _row(role: str, part: Any, found: DriveSet) -> dict[str, str]:
    if part is None:
        return {"role": role.capitalize(), "family": "unknown", "part": "", "said": ""}
    said = [_SAID[role](part), *(found.belt_running if role == "belt" else ())]
    return {"role": role.capitalize(), "family": made_by(part), "part": part.part, "said": ", ".join(said)}


def _figures_of(*names: str) -> Callable[[Any], str]:
    def said(part: Any) -> str:
        columns = columns_of(section_of(part))
        return ", ".join(show(getattr(part, name), columns[name].unit, columns[name].kind) for name in names)

    return said


def _toothed(part: Belt | Pulley) -> str:
    return f"{part.profile} {show(part.pitch, 'mm', 'length')}, {part.teeth:.0f} teeth"


def _pulley(part: Pulley) -> str:
    return _toothed(part) + (f", bore {part.bore}" if part.bore else "")


_SAID: dict[str, Callable[[Any], str]] = {
    "motor": _figures_of("assigned_power", "nominal_voltage"),
    "gearhead": lambda part: f"{part.reduction}, exactly {part.ratio:.5g}".removeprefix(", "),
    "driving pulley": _pulley,
    "belt": lambda part: f"{_toothed(part)}, {show(part.width, 'mm', 'length')} wide",
    "driven pulley": _pulley,
    "encoder": lambda part: part.resolution,
    "controller": lambda part: part.buses.replace(";", ","),
    "actuator": _figures_of("nominal_voltage", "nominal_torque"),
}
