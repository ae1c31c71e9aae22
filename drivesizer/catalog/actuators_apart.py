r"""Actuators taken apart: the motor and gearhead inside, and what else is, as rows of their own for the search.

The actuator's row keeps what its maker prints, at the output. Inside, with the ratio i and the gear's efficiency e:

.. math::

    w_m = i w, \quad M_m = \frac{M}{i e}, \quad k_{t,m} = \frac{k_t}{i e}, \quad J_m = \frac{J}{i^2}

What is in the box is in its mass, price and size, so the gear's own are nothing. The maker rates the whole: the gear
inside has the actuator's torques and no power limit of its own, and the controller inside gives what the actuator was
measured with. Where no permissible speed is printed, the speed without load at nominal voltage is one at which it runs.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import EDGES, RELATIONS, columns_of, one_of
from drivesizer.catalog.tables import Catalog, Pairs, Table
from drivesizer.errors import CatalogError, quoted
from drivesizer.physics.back_emf import ELECTRONICS

__all__ = ["taken_apart"]

Columns = dict[str, NDArray[Any]]
_NAMES = ("part", "family", "manufacturer")
_MOTOR = (
    "kind", "nominal_voltage", "no_load_current", "nominal_current", "stall_current", "data_temperature",
    "rated_ambient", "resistance", "inductance",
    "pole_pairs", "thermal_resistance_winding", "thermal_resistance_housing", "winding_time_constant",
    "motor_time_constant", "max_winding_temperature", "ambient_min", "ambient_max", "diameter", "length", "mass",
    "price",
)  # fmt: skip
_GEARHEAD = ("reduction", "ratio", "stages", "direction", "efficiency", "backlash", "max_radial_load", "max_axial_load")


class _Inside(NamedTuple):
    """Rows of the actuators that have such a part, and its columns."""

    of: NDArray[np.int64]
    columns: Mapping[str, Any]


def taken_apart(catalog: Catalog) -> Catalog:
    """The catalogue with a row for each motor, gearhead, encoder and controller that is inside an actuator.

    A catalogue that has been taken apart, or has no actuators, comes back as it is.

    Raises
    ------
    CatalogError
        When an actuator has the part number of a motor, gearhead, encoder or controller.
    """
    whole = catalog.actuators
    if not len(whole) or (catalog.motors["inside"] != "").any():
        return catalog
    for section in ("motors", "gearheads", "encoders", "controllers"):
        twice = sorted(set(whole["part"].tolist()) & set(catalog.table(section)["part"].tolist()))
        if twice:
            raise CatalogError(f"part {quoted(twice[0])} is an actuator and a {one_of(section)} as well; rename one")
    inside = {"motors": _motor(whole), "gearheads": _gearhead(whole), "encoders": _encoder(whole),
              "controllers": _controller(whole)}  # fmt: skip
    tables: dict[str, Any] = {name: _with(catalog.table(name), whole, rows) for name, rows in inside.items()}
    first = len(catalog.motors)
    pairs: dict[str, Any] = {
        name: _paired(getattr(catalog, name), whole, inside[right].of, first, len(catalog.table(right)))
        for name, right in RELATIONS.items()
        if right in inside
    }  # fmt: skip
    return catalog.with_tables(tables, pairs)


def _with(table: Table[Any], whole: Table[Any], inside: _Inside) -> Table[Any]:
    """A table, and the rows of the parts inside behind its own."""
    columns: Columns = {}
    of = inside.of
    given = dict(inside.columns) | {name: whole[name] for name in _NAMES} | {"inside": whole["part"]}
    for name, column in columns_of(table.section).items():
        unknown: Any = "" if column.kind == "text" else np.nan
        values: NDArray[Any] = np.broadcast_to(given.get(name, unknown), (len(whole),))[of]
        columns[name] = np.concatenate([table[name], values])
    source = np.concatenate([table.source, whole.source[of]])
    return Table(table.section, columns, source, np.concatenate([table.excluded, whole.excluded[of]]))


def _paired(pairs: Pairs, whole: Table[Any], of: NDArray[np.int64], motors: int, others: int) -> Pairs:
    """The pairs, and each actuator's motor with its own part."""
    added: tuple[NDArray[Any], ...] = (of + motors, np.arange(len(of)) + others, whole.source[of])
    return Pairs(*(np.concatenate([a, b.astype(np.int32)]) for a, b in zip(pairs, added, strict=True)))


def _motor(whole: Table[Any]) -> _Inside:
    i, e = whole["ratio"], whole["efficiency"]
    k_t = np.where(
        np.isnan(whole["motor_torque_constant"]), whole["torque_constant"] / (i * e), whole["motor_torque_constant"]
    )
    figures: Columns = {name: whole[name] for name in _MOTOR}
    figures |= {name: i * whole[name] for name in ("no_load_speed", "nominal_speed")}
    figures |= {name: whole[name] / (i * e) for name in ("nominal_torque", "stall_torque")}
    figures["max_speed"] = i * _top_speed(whole)
    figures["torque_constant"] = k_t
    figures["back_emf_constant"] = whole["motor_back_emf_constant"]
    figures["commutation"] = np.where(whole["controller"] != "", ELECTRONICS, "")
    figures["rotor_inertia"] = np.where(
        np.isnan(whole["rotor_inertia"]), whole["output_inertia"] / i**2, whole["rotor_inertia"]
    )
    return _Inside(np.arange(len(whole)), figures)


def _top_speed(whole: Table[Any]) -> NDArray[np.float64]:
    """The permissible speed of the output."""
    return np.where(np.isnan(whole["max_speed"]), whole["no_load_speed"], whole["max_speed"])


def _gearhead(whole: Table[Any]) -> _Inside:
    speed = whole["ratio"] * _top_speed(whole)
    # One that is screwed into its motor needs no room, no money and no inertia of its own.
    own = dict.fromkeys(("inertia", "diameter", "length", "mass", "price"), 0.0)
    free = dict.fromkeys(("continuous_power", "intermittent_power"), np.inf)
    figures: dict[str, Any] = {name: whole[name] for name in _GEARHEAD}
    return _Inside(np.arange(len(whole)), figures | own | free | {
        "kind": whole["gearing"],
        "continuous_torque": whole["nominal_torque"],
        "intermittent_torque": np.fmax(whole["peak_torque"], whole["nominal_torque"]),
        "continuous_input_speed": speed,
        "intermittent_input_speed": speed,
        "temperature_min": whole["ambient_min"],
        "temperature_max": whole["ambient_max"],
    })  # fmt: skip


def _encoder(whole: Table[Any]) -> _Inside:
    """Its encoder, as one at the motor: lines of four edges, whose fastest is the actuator's own speed."""
    free = dict.fromkeys(("max_frequency", "max_speed", "max_mechanical_speed"), np.inf)
    own = dict.fromkeys(("inertia", "diameter", "length", "added_length", "mass", "price"), 0.0)
    figures: dict[str, Any] = {
        "counts_per_turn": whole["steps_per_turn"] / (EDGES * whole["ratio"]),
        "kind": "integrated",
    }
    return _Inside(np.flatnonzero(~np.isnan(whole["steps_per_turn"])), figures | free | own)


def _controller(whole: Table[Any]) -> _Inside:
    free = dict.fromkeys(("max_encoder_frequency", "max_speed_sine", "max_speed_block"), np.inf)
    figures: dict[str, Any] = {name: whole[name] for name in ("buses", "supply_min", "supply_max", "peak_current")}
    figures |= {"drives": whole["kind"], "continuous_current": whole["nominal_current"]}
    figures |= {"max_duty": 1.0, "voltage_drop": 0.0, "mass": 0.0, "price": 0.0}
    return _Inside(np.flatnonzero(whole["controller"] != ""), figures | free)
