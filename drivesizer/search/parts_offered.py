"""The parts out of which a spec's drive is chosen: its catalogues as the search takes them, or two parts by number."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import DIRECT, Catalog, load, singular
from drivesizer.catalog.view.stepper_view import STEPPER, view_for
from drivesizer.errors import InputError, UnknownCatalogError, nearest, quoted
from drivesizer.spec.robot import RobotSpec

__all__ = ["load_parts", "pair_of"]


def load_parts(spec: RobotSpec, catalog: Catalog | None = None) -> Catalog:
    """The catalogues that a spec names, or one that was loaded, for the search."""
    if catalog is None:
        try:
            catalog = load(spec.select.catalogs, beside=Path(spec.file).parent if spec.file else None)
        except UnknownCatalogError as error:
            raise InputError(f"{spec.where(('select', 'catalogs'))}: {error}") from None
    _offers_motors(spec, catalog)
    estimates = spec.select.estimates == "on"
    return view_for(catalog, spec.select.motor.kind, estimates, spec.control.phase_current)


def _offers_motors(spec: RobotSpec, catalog: Catalog) -> None:
    """Refuse catalogues without a motor of the kind that the spec selects: steppers, or anything else."""
    steppers = spec.select.motor.kind == STEPPER
    if steppers and not len(catalog.steppers):
        where = spec.where(("select", "catalogs"))
        named = ", ".join(spec.select.catalogs)
        raise InputError(f"{where}: {named} without steppers; expected e.g. stepperonline")
    if not steppers and len(catalog.steppers) and not len(catalog.motors) and not len(catalog.actuators):
        where = spec.where(("select", "catalogs"))
        raise InputError(f"{where}: only steppers are in them; expected select: {{motor: {{kind: {STEPPER}}}}}")


def pair_of(catalog: Catalog, motor: str, gearhead: str, volts: float) -> tuple[int, int]:
    """Rows of a motor and a gearhead."""
    row = _row(catalog, "motors", motor, catalog.motors.at_voltage(volts))
    box = str(catalog.motors["inside"][row])
    if box and gearhead in ("", box):
        return row, catalog.gearheads.rows[box]
    if not gearhead:
        raise InputError(f"--gearhead: motor {quoted(motor)} needs one; expected a part number, or {DIRECT} for none")
    other = _row(catalog, "gearheads", gearhead)
    whole = box or str(catalog.gearheads["inside"][other])
    if whole:
        raise InputError(f"--gearhead: {quoted(whole)} is an actuator, which has motor and gearhead inside")
    return row, other


def _row(catalog: Catalog, section: str, part: str, counts: NDArray[np.bool_] | None = None) -> int:
    table = catalog.table(section)
    rows = [row for row in table.called(part) if counts is None or counts[row]]
    if not rows:
        raise InputError(f"{singular(section)} {quoted(part)} is in no catalogue{nearest(part, table.rows)}")
    if len(rows) > 1:
        names = ", ".join(table["part"][rows].tolist())
        raise InputError(f"{singular(section)} {quoted(part)} is several parts; expected one of {names}")
    return rows[0]
