"""The catalogue as a search for steppers takes it: its steppers in the place of the motors.

A stepper goes with direct drive, and with the clamping hubs that hold its shaft; neither encoders nor brakes are listed
for it. Its column ``stepper`` is the row of the steppers' table, to which the printed pull-out curves belong.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.estimates.estimate import estimates as estimates_of
from drivesizer.catalog.estimates.of_catalog import estimates_kept
from drivesizer.catalog.parts import DIRECT, columns_of
from drivesizer.catalog.tables import Catalog, Estimates, Pairs, Table, unique_pairs
from drivesizer.catalog.view.completing import ENDS, MIDDLE, completed
from drivesizer.catalog.view.search_view import search_view, with_clamping_hubs, with_direct_drive
from drivesizer.physics.stepper.pull_out import rotor_teeth

__all__ = ["STEPPER", "has_steppers", "stepper_view", "view_for"]

STEPPER = "stepper"  # kind of such a motor, and the column with its row in the steppers' table
_NONE = np.zeros(0, np.int32)
_NO_PAIRS = Pairs(_NONE, _NONE, _NONE)
_NAMES = {"phase_current": "nominal_current", "full_steps": "pole_pairs"}  # as the motors' table has them
_ALIKE = (
    "part", "family", "manufacturer", "resistance", "inductance", "rotor_inertia", "holding_torque", "detent_torque",
    "start_speed", "pull_out_share", "max_radial_load", "max_axial_load", "ambient_min", "ambient_max",
    "shaft_diameter", "diameter", "length", "mass", "price",
)  # fmt: skip


def has_steppers(catalog: Catalog) -> bool:
    """Whether the catalogue is one that ``stepper_view`` made."""
    return STEPPER in catalog.motors.columns


def view_for(catalog: Catalog, kind: str | None, estimates: bool = True, phase_current: float | None = None) -> Catalog:
    """The catalogue as a search for a kind of motor takes it."""
    return stepper_view(catalog, estimates, phase_current) if kind == STEPPER else search_view(catalog, estimates)


def stepper_view(catalog: Catalog, estimates: bool = True, phase_current: float | None = None) -> Catalog:
    """The catalogue with its steppers as motors, with clamping hubs and direct drive."""
    if has_steppers(catalog):
        return catalog
    if not estimates:
        return _viewed(catalog, phase_current)
    own = estimates_of(catalog.steppers)
    if "pull_out_share" in own:  # a printed curve needs none
        own["pull_out_share"] = _without_rows(own["pull_out_share"], catalog.pull_outs.stepper)
    found = replace(catalog, estimates={**estimates_kept(catalog), "steppers": own})
    middle, *ends = (_viewed(found.with_tables(completed(found, end), {}), phase_current) for end in (MIDDLE, *ENDS))
    return replace(middle, ends=tuple(ends))


def _without_rows(one: Estimates, rows: NDArray[np.int32]) -> Estimates:
    keep = ~np.isin(one.rows, rows)
    return Estimates(one.rows[keep], one.value[keep], one.low[keep], one.high[keep], one.fit[keep])


def _viewed(catalog: Catalog, phase_current: float | None) -> Catalog:
    steppers, curves = catalog.steppers, catalog.pull_outs
    less = np.ones(len(steppers))
    if phase_current is not None:
        less = np.minimum(phase_current / steppers["phase_current"], 1.0)
    alone = dict.fromkeys(("motor_gearhead", "motor_encoder", "motor_brake"), _NO_PAIRS)
    moved = replace(
        catalog.with_tables({"motors": _as_motors(steppers, phase_current, less)}, alone),
        pull_outs=curves._replace(torque=curves.torque * less[curves.stepper]),
        estimates=_renamed(catalog.estimates),
        notes=tuple(
            note._replace(section="motors", fields=tuple(_NAMES.get(name, name) for name in note.fields))
            for note in catalog.notes
            if note.section == "steppers"
        )
        + tuple(note for note in catalog.notes if note.section not in ("motors", "steppers")),
    )
    fitted = with_direct_drive(with_clamping_hubs(moved))
    none, hubs = fitted.gearheads.rows[DIRECT], fitted.motor_gearhead
    every = np.arange(len(steppers))
    direct: tuple[NDArray[Any], ...] = (every, np.full(len(every), none), steppers.source)
    pairs = unique_pairs(*(np.concatenate([a, b]) for a, b in zip(hubs, direct, strict=True)))
    return fitted.with_tables({}, {"motor_gearhead": pairs})


def _as_motors(steppers: Table[Any], phase_current: float | None, less: NDArray[np.float64]) -> Table[Any]:
    """The steppers as a table of motors; what a stepper has not is unknown."""
    count = len(steppers)
    figures: dict[str, Any] = {name: steppers[name] for name in _ALIKE}
    figures |= {
        "kind": STEPPER, "commutation": steppers["wiring"], "phases": 2.0,
        "nominal_current": steppers["phase_current"] if phase_current is None else phase_current,
        "holding_torque": steppers["holding_torque"] * less, "start_speed": steppers["start_speed"] * np.sqrt(less),
        "pole_pairs": rotor_teeth(steppers["full_steps"]),
    }  # fmt: skip
    columns: dict[str, NDArray[Any]] = {}
    for name, column in columns_of("motors").items():
        unknown: Any = "" if column.kind == "text" else np.nan
        columns[name] = np.array(np.broadcast_to(figures.get(name, unknown), (count,)))
    columns[STEPPER] = np.arange(count)
    return Table("motors", columns, steppers.source, steppers.excluded)


def _renamed(estimates: Mapping[str, Mapping[str, Estimates]]) -> dict[str, Mapping[str, Estimates]]:
    """Estimates with those of the steppers as those of the motors."""
    return {name: one for name, one in estimates.items() if name not in ("motors", "actuators", "steppers")} | {
        "motors": {_NAMES.get(name, name): one for name, one in estimates.get("steppers", {}).items()}
    }
