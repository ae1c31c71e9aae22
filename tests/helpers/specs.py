"""Specs with one setting changed, catalogues without some figures."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.catalog.tables import Table
from drivesizer.spec.robot import RobotSpec

__all__ = ["HEAT", "estimates_off", "poorer", "selecting", "without"]

HEAT = ("max_winding_temperature", "winding_time_constant", "motor_time_constant")


def selecting(spec: RobotSpec, **settings: Any) -> RobotSpec:
    """The spec with other settings of its selection."""
    return spec.model_copy(update={"select": spec.select.model_copy(update=settings)})


def estimates_off(spec: RobotSpec) -> RobotSpec:
    """The spec with figures that no data sheet gives unknown."""
    return selecting(spec, estimates="off")


def without(catalog: Catalog, role: str, part: str, *fields: str) -> Catalog:
    """A catalogue that does not know figures of a part."""
    table: Table[Any] = getattr(catalog, f"{role}s")
    columns = {field: table[field].copy() for field in fields}
    for column in columns.values():
        column[table.rows[part]] = np.nan
    return catalog.with_tables({f"{role}s": replace(table, columns={**table.columns, **columns})}, {})


def poorer(catalog: Catalog) -> Catalog:
    """The catalogue without heat and permissible speed of the paper's motor, its encoders without code wheels."""
    found = without(catalog, "motor", "118752", *HEAT, "max_speed")
    for encoder in ("225778", "225780"):
        found = without(found, "encoder", encoder, "inertia")
    return found
