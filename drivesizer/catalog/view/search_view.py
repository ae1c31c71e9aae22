"""The catalogue as the search takes it: estimates put in, actuators split into their parts, direct drive added."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import tables
from drivesizer.catalog.estimates.estimate import UNRATED, estimates_of_catalog
from drivesizer.catalog.parts import DIRECT, EDGES, RELATIONS, singular
from drivesizer.catalog.tables import Catalog, Estimates, Pairs, Table, filled, with_pairs, with_rows
from drivesizer.errors import CatalogError, quoted
from drivesizer.physics.drive_train import ELECTRONICS

# -- Tables of parts with estimates where a figure is missing: at their middles, and at both ends of their bands.
#
# At the unfavourable end every estimated figure is where it makes most drives harder to pass: inertia, friction and
# thermal resistance high, time constants and efficiency low; at the favourable end the other way round. A drive is
# judged at both.


End = Literal["middle", "favourable", "unfavourable"]
MIDDLE: End = "middle"
ENDS: tuple[End, End] = ("favourable", "unfavourable")
_HARDER_WHEN_LOW = {  # of which kind of parts; "": of all. A brushless motor's temperature goes with its resistances
    "winding_time_constant": "", "motor_time_constant": "", "efficiency": "", "max_winding_temperature": "brushed",
    "pull_out_share": "", "start_speed": "", "nominal_torque": "", "nominal_current": "", "peak_torque": "",
    "peak_current": "",
}  # fmt: skip


_PRINTED = 0.02  # within which printed figures of one part agree


def completed(catalog: Catalog, end: End) -> dict[str, Any]:
    """The tables that have estimates, with these where a figure is missing."""
    return {section: _table(catalog.table(section), figures, end) for section, figures in catalog.estimates.items()}


def _table(table: Table[Any], figures: Mapping[str, Estimates], end: End) -> Table[Any]:
    columns = dict(table.columns)
    for name, found in figures.items():
        columns[name] = columns[name].copy()
        columns[name][found.rows] = found.value if end == MIDDLE else _at_band_end(table, found, name, end)
    if "no_load_current" in figures and table.section == "actuators":
        _keep_printed_points(table, columns, figures["no_load_current"].rows)
    return Table(table.section, columns, table.source, table.excluded)


def _keep_printed_points(table: Table[Any], columns: dict[str, NDArray[Any]], rows: NDArray[np.int64]) -> None:
    """Constant and efficiency of actuators that were worked out of no load and stall without the no-load current.

    With an estimated one they are others, so that its loss does not count twice: speed without load and torque at stall
    stay what is printed.
    """
    V, w_0, M_s, I_s, R, i, k_t, e = (
        table[name][rows]
        for name in ("nominal_voltage", "no_load_speed", "stall_torque", "stall_current", "resistance", "ratio",
                     "motor_torque_constant", "efficiency")
    )  # fmt: skip
    I_0 = columns["no_load_current"][rows]
    without = np.isclose(k_t * i * w_0, V, rtol=_PRINTED) & np.isclose(i * e * k_t * I_s, M_s, rtol=_PRINTED)
    constant = (V - I_0 * R) / (i * w_0)
    share = M_s / (i * constant * (I_s - I_0))
    some = without & (constant > 0.0) & (share > 0.0) & (share <= 1.0)
    for name, value in (("motor_torque_constant", constant), ("efficiency", share)):
        columns[name] = columns[name].copy()
        columns[name][rows[some]] = value[some]


def _at_band_end(table: Table[Any], found: Estimates, name: str, end: End) -> NDArray[np.float64]:
    kind = _HARDER_WHEN_LOW.get(name)
    harder_when_low = (table["kind"][found.rows] == kind) if kind else np.full(len(found.rows), kind is not None)
    if name == "max_winding_temperature":  # without a rating it goes with nothing
        harder_when_low |= found.fit == UNRATED
    return np.where(harder_when_low == (end == "unfavourable"), found.low, found.high)


# -- The catalogue as the search takes it: actuators split into their parts, clamping hubs paired, direct drive added.
#
# An actuator's row keeps the figures that its maker prints, at the output. For the search its motor, gearhead,
# encoder and controller become rows of their own. With the ratio i and the gear's efficiency e:
#
# .. math::
#
#     w_m = i w, \quad M_m = \frac{M}{i e}, \quad k_{t,m} = \frac{k_t}{i e}, \quad J_m = \frac{J}{i^2}
#
# Mass, price and size are the motor's, those of the other parts 0. The maker rates the actuator as a unit: the
# gearhead inside has the actuator's torques and no power limit of its own, and the controller inside supplies the
# current with which the actuator was measured; so does one inside a motor. Where no permissible speed is printed,
# the no-load speed at nominal voltage is used. Of an actuator whose ratio is unknown the motor is the one that its
# output feels, behind a gear of 1:1: torque, speed and heat need no ratio, only figures that are printed for the
# motor inside say nothing then.


CLAMPING_HUB = "clamping hub"  # mounting of a gearhead that takes motors of any maker
_BATTERY = {"min": 0.85, "max": 1.15}  # of the nominal voltage, at which machines work: IEC 60204-1, 4.3.3
_THINNEST_SHAFT = 0.5  # of the hub's bore: a bushing fills the rest

Columns = dict[str, NDArray[Any]]
_NAMES = ("part", "order_number", "also_called", "family", "manufacturer")
_MOTOR = (
    "kind", "nominal_voltage", "no_load_current", "nominal_current", "stall_current", "data_temperature",
    "rated_ambient", "resistance", "inductance",
    "pole_pairs", "thermal_resistance_winding", "thermal_resistance_housing", "winding_time_constant",
    "motor_time_constant", "max_winding_temperature", "ambient_min", "ambient_max", "diameter", "length", "mass",
    "price",
)  # fmt: skip
_GEARHEAD = ("reduction", "stages", "direction", "backlash", "max_radial_load", "max_axial_load")


_PRINTED_AS = {  # fields of an actuator that become others of the parts inside
    ("motor", "torque_constant"): "torque_constant", ("motor", "friction_torque"): "coulomb_friction",
    ("motor", "back_emf_constant"): "motor_back_emf_constant",
    ("gearhead", "continuous_torque"): "nominal_torque", ("gearhead", "intermittent_torque"): "peak_torque",
    ("gearhead", "continuous_input_speed"): "max_speed", ("gearhead", "intermittent_input_speed"): "max_speed",
    ("gearhead", "temperature_min"): "ambient_min", ("gearhead", "temperature_max"): "ambient_max",
    ("encoder", "counts_per_turn"): "steps_per_turn", ("controller", "continuous_current"): "nominal_current",
}  # fmt: skip


def printed_field(role: str, field: str) -> str:
    """The field of an actuator's row that gives a figure of a part inside."""
    return _PRINTED_AS.get((role, field), field)


def search_view(catalog: Catalog, estimates: bool = True) -> Catalog:
    """The catalogue as the search takes it: actuators split, clamping hubs paired, direct drive added."""
    if catalog.ends:
        return catalog
    if not estimates:
        columns = dict(catalog.actuators.columns)  # without figures that are a rule of thumb
        for name in ("nominal_torque", "nominal_current"):
            columns[name] = columns[name].copy()
            columns[name][catalog.by_rule("actuators", name)] = np.nan
        return _viewed(replace(catalog, actuators=replace(catalog.actuators, columns=columns)))
    found = replace(catalog, estimates=estimates_of_catalog(catalog))
    if not found.estimates:
        return _viewed(catalog)
    middle, *ends = (_viewed(replace(found, **completed(found, end))) for end in (MIDDLE, *ENDS))
    return replace(middle, ends=tuple(ends))


def _viewed(catalog: Catalog) -> Catalog:
    return with_direct_drive(with_clamping_hubs(_with_controllers_inside(split_actuators(catalog))))


def split_actuators(catalog: Catalog) -> Catalog:
    """The catalogue with a row for each motor, gearhead, encoder and controller that is inside an actuator.

    A catalogue without actuators, or whose actuators are split already, is returned unchanged.
    """
    actuators = catalog.actuators
    if not len(actuators) or (catalog.motors["inside"] != "").any():
        return catalog
    for section in ("motors", "gearheads", "encoders", "controllers"):
        twice = sorted(set(actuators["part"].tolist()) & set(catalog.table(section)["part"].tolist()))
        if twice:
            raise CatalogError(f"part {quoted(twice[0])} is an actuator and a {singular(section)} as well; rename one")
    inside = {"motors": _motor(actuators), "gearheads": _gearhead(actuators), "encoders": _encoder(actuators),
              "controllers": _controller(actuators)}  # fmt: skip
    having = {
        "encoders": np.flatnonzero(~np.isnan(actuators["steps_per_turn"])),
        "controllers": np.flatnonzero(actuators["controller"] != ""),
    }
    rows = {section: having.get(section, np.arange(len(actuators))) for section in inside}
    made: dict[str, Any] = {
        section: _with_parts_inside(catalog.table(section), actuators, rows[section], figures)
        for section, figures in inside.items()
    }
    for name, right in RELATIONS.items():
        if right in inside:  # each actuator's motor with the part inside the same actuator
            of, others = rows[right], np.arange(len(rows[right])) + len(catalog.table(right))
            added: tuple[NDArray[Any], ...] = (of + len(catalog.motors), others, actuators.source[of])
            pairs = zip(getattr(catalog, name), added, strict=True)
            made[name] = Pairs(*(np.concatenate([a, b.astype(np.int32)]) for a, b in pairs))
    return replace(catalog, **made)


def _with_parts_inside(
    table: Table[Any], units: Table[Any], of: NDArray[np.int64], columns: Mapping[str, Any]
) -> Table[Any]:
    """A table followed by the rows of the parts inside some actuators, or motors."""
    figures = {name: units[name] for name in _NAMES} | {"inside": units["part"]} | dict(columns)
    inside = {name: values[of] for name, values in filled(table.section, figures, len(units)).items()}
    return with_rows(table, inside, units.source[of], units.excluded[of])


def _motor(actuators: Table[Any]) -> Columns:
    i, e, loaded = _ratio(actuators), _efficiency(actuators), _loaded_efficiency(actuators)
    own = actuators["motor_torque_constant"] * _inner(actuators)
    k_t = np.where(np.isnan(own), actuators["torque_constant"] / (i * e), own)
    figures: Columns = {name: actuators[name] for name in _MOTOR}
    figures |= {name: i * actuators[name] for name in ("no_load_speed", "nominal_speed")}
    figures |= {name: actuators[name] / (i * loaded) for name in ("nominal_torque", "stall_torque")}
    figures["max_speed"] = i * _top_speed(actuators)
    figures["torque_constant"] = k_t
    figures["back_emf_constant"] = actuators["motor_back_emf_constant"] * _inner(actuators)
    figures["friction_torque"] = actuators["coulomb_friction"] / i
    figures["viscous_friction"] = actuators["viscous_friction"] / i**2
    figures["max_voltage"] = np.where(actuators["controller"] == "", actuators["supply_max"], np.nan)
    figures["commutation"] = np.where(actuators["controller"] != "", ELECTRONICS, "")
    inertia = actuators["rotor_inertia"] * _inner(actuators)
    figures["rotor_inertia"] = np.where(np.isnan(inertia), actuators["output_inertia"] / i**2, inertia)
    return figures


def _ratio(actuators: Table[Any]) -> NDArray[np.float64]:
    """Ratio of the gear inside; 1 where it is unknown, with all figures as the output feels them."""
    return np.where(np.isnan(actuators["ratio"]), 1.0, actuators["ratio"])


def _inner(actuators: Table[Any]) -> NDArray[np.float64]:
    """1 where figures of the motor inside can be used; NaN where no ratio brings them to the output."""
    return np.where(np.isnan(actuators["ratio"]), np.nan, 1.0)


def _efficiency(actuators: Table[Any]) -> NDArray[np.float64]:
    """Efficiency of the gear inside as the row has it, else by the friction that grows with the load."""
    e = actuators["efficiency"]
    return np.where(np.isnan(e), 1.0 / (1.0 + actuators["load_friction"]), e)


def _loaded_efficiency(actuators: Table[Any]) -> NDArray[np.float64]:
    """The same without Coulomb friction: it is the motor's here."""
    e, stall = _efficiency(actuators), actuators["stall_torque"]
    coulomb = actuators["coulomb_friction"] / np.where(np.isnan(stall), actuators["nominal_torque"], stall)
    known = ~np.isnan(coulomb + actuators["viscous_friction"] + actuators["efficiency"])
    counted = known & np.isnan(actuators["no_load_current"])
    return np.where(counted, 1.0 / np.maximum(1.0 / e - coulomb, 1.0), e)


def _top_speed(actuators: Table[Any]) -> NDArray[np.float64]:
    """The permissible speed of the output."""
    return np.where(np.isnan(actuators["max_speed"]), actuators["no_load_speed"], actuators["max_speed"])


def _gearhead(actuators: Table[Any]) -> dict[str, Any]:
    speed = _ratio(actuators) * _top_speed(actuators)
    # Size, mass, price and inertia are counted with the motor.
    own = dict.fromkeys(("inertia", "diameter", "length", "mass", "price"), 0.0)
    free = dict.fromkeys(("continuous_power", "intermittent_power"), np.inf)
    figures: dict[str, Any] = {name: actuators[name] for name in _GEARHEAD}
    return (
        figures
        | own
        | free
        | {
            "ratio": _ratio(actuators),
            "kind": actuators["gearing"],
            "efficiency": _loaded_efficiency(actuators),
            "continuous_torque": actuators["nominal_torque"],
            "intermittent_torque": np.maximum(actuators["peak_torque"], np.nan_to_num(actuators["nominal_torque"])),
            "continuous_input_speed": speed,
            "intermittent_input_speed": speed,
            "temperature_min": actuators["ambient_min"],
            "temperature_max": actuators["ambient_max"],
        }
    )


def _encoder(actuators: Table[Any]) -> dict[str, Any]:
    """The encoder as one at the motor shaft, with four edges per line and no limit of speed of its own."""
    free = dict.fromkeys(("max_frequency", "max_speed", "max_mechanical_speed"), np.inf)
    own = dict.fromkeys(("inertia", "diameter", "length", "added_length", "mass", "price"), 0.0)
    figures: dict[str, Any] = {
        "counts_per_turn": actuators["steps_per_turn"] / (EDGES * _ratio(actuators)),
        "kind": "integrated",
    }
    return figures | free | own


def _controller(actuators: Table[Any]) -> dict[str, Any]:
    figures = {name: actuators[name] for name in ("buses", "peak_current", "standby_current")}
    figures |= {"drives": actuators["kind"], "continuous_current": actuators["nominal_current"]}
    return _UNIT | figures | _supply(actuators)


# A unit is rated as one: its peak torque lasts as long as its winding permits, its figures hold the controller's losses
_UNIT: dict[str, Any] = dict.fromkeys(
    ("max_encoder_frequency", "max_speed_sine", "max_speed_block", "peak_time"), np.inf
) | {"max_duty": 1.0, "voltage_drop": 0.0, "mass": 0.0, "price": 0.0}  # fmt: skip


def _supply(table: Table[Any]) -> Columns:
    """Range of the supply of units; where none is printed that of a battery of their nominal voltage."""
    found = {f"supply_{end}": share * table["nominal_voltage"] for end, share in _BATTERY.items()}
    if table.section == "actuators":  # of motors it is no figure
        found = {name: np.where(np.isnan(table[name]), usual, table[name]) for name, usual in found.items()}
    return found


def _with_controllers_inside(catalog: Catalog) -> Catalog:
    """The catalogue with a row for each controller inside a motor, which supplies what the motor was measured with."""
    motors = catalog.motors
    of = np.flatnonzero((motors["controller"] != "") & (motors["inside"] == ""))
    if not len(of):
        return catalog
    names = [f"{name} in {part}" for name, part in zip(motors["controller"][of], motors["part"][of], strict=True)]
    part = motors["part"].astype(object)
    part[of] = names
    figures: dict[str, Any] = {"drives": motors["kind"], "peak_current": motors["stall_current"],
                               "family": motors["controller"], "buses": "", "inside": motors["part"]}  # fmt: skip
    figures |= _UNIT | _supply(motors) | {"part": part.astype(str)}
    return replace(catalog, controllers=_with_parts_inside(catalog.controllers, motors, of, figures))


def with_clamping_hubs(catalog: Catalog) -> Catalog:
    """The catalogue with a pair for each motor whose shaft fits a gearhead's clamping hub.

    A bushing makes up for a thinner shaft, an adapter plate joins the flanges; the pair's source is the gearhead's.
    A motor whose shaft is unknown is not paired.
    """
    motors, gearheads = catalog.motors, catalog.gearheads
    hubs = np.flatnonzero(gearheads["mounting"] == CLAMPING_HUB)
    single = np.flatnonzero((motors["inside"] == "") & ~np.isnan(motors["shaft_diameter"]))
    bore, shaft = gearheads["max_motor_shaft"][hubs], motors["shaft_diameter"][single, None]
    fits = np.nonzero((shaft <= bore) & (shaft >= _THINNEST_SHAFT * bore))
    if not len(fits[0]):
        return catalog
    left, right = single[fits[0]], hubs[fits[1]]
    pairs = with_pairs(catalog.motor_gearhead, left, right, gearheads.source[right])
    return replace(catalog, motor_gearhead=pairs)


def with_direct_drive(catalog: Catalog) -> Catalog:
    """The catalogue with direct drive among its gearheads."""
    if DIRECT in catalog.gearheads.rows:
        return catalog
    table = tables.with_no_gearhead(catalog.gearheads, len(catalog.sources))
    return replace(catalog, gearheads=table, sources=(*catalog.sources, tables.NO_GEARHEAD_SOURCE))
