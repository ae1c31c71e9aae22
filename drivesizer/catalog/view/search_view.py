"""The catalogue as the search takes it: estimates put in, actuators split into their parts, direct drive added."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import tables
from drivesizer.catalog.estimates.estimate import UNRATED, estimates_of_catalog
from drivesizer.catalog.expressions import value
from drivesizer.catalog.parts import DIRECT, RELATIONS, columns_of, singular
from drivesizer.catalog.tables import Catalog, Estimates, Pairs, Table, filled, with_pairs, with_rows
from drivesizer.catalog.tolerances import usual_of_spur_gears
from drivesizer.errors import CatalogError, quoted
from drivesizer.files.arithmetic import code
from drivesizer.files.yaml_source import shipped_data
from drivesizer.physics.drive_train import DRY_SHARE, SERVO

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


def completed(catalog: Catalog, end: End) -> dict[str, Any]:
    """The tables that have estimates, with these where a figure is missing."""
    return {section: _table(catalog.table(section), figures, end) for section, figures in catalog.estimates.items()}


def _table(table: Table[Any], figures: Mapping[str, Estimates], end: End) -> Table[Any]:
    columns = {name: table[name].copy() for name in figures}
    for name, found in figures.items():
        kind = _HARDER_WHEN_LOW.get(name)
        harder_when_low = (table["kind"][found.rows] == kind) if kind else np.full(len(found.rows), kind is not None)
        if name == "max_winding_temperature":  # without a rating it goes with nothing
            harder_when_low |= found.fit == UNRATED
        at_end = np.where(harder_when_low == (end == "unfavourable"), found.low, found.high)
        columns[name][found.rows] = found.value if end == MIDDLE else at_end
    return table.changed(columns)


# -- The catalogue as the search takes it: actuators split into their parts, clamping hubs paired, direct drive added.
#
# An actuator's row keeps the figures that its maker prints, at the output. For the search its motor, gearhead,
# encoder and controller become rows of their own, by the table ``inside.yaml``.


CLAMPING_HUB = "clamping hub"  # mounting of a gearhead that takes motors of any maker
_THINNEST_SHAFT = 0.5  # of the hub's bore: a bushing fills the rest
_NAMES = ("part", "order_number", "also_called", "family", "manufacturer")
_INSIDE: dict[str, dict[str, Any]] = shipped_data("drivesizer.catalog.view", "inside.yaml")


def printed_field(role: str, field: str) -> str:
    """The field of an actuator's row that gives a figure of a part inside: its own, or the first in its expression."""
    columns, expression = columns_of("actuators"), str(_INSIDE.get(f"{role}s", {}).get(field, field))
    named = [name for name in code(expression).co_names if name in columns and columns[name].kind != "text"]
    return field if field in named or not named else named[0]


def _part_inside(units: Table[Any], part: str) -> dict[str, Any]:
    """The columns of a part inside units: actuators, or motors with a controller."""
    names: dict[str, Any] = {}
    if units.section == "actuators":
        for name, expression in _INSIDE["names"].items():
            names[name] = value(expression, units, **names)
    return {column: value(str(expression), units, **names) for column, expression in _INSIDE[part].items()}


def search_view(catalog: Catalog, estimates: bool = True) -> Catalog:
    """The catalogue as the search takes it: actuators split, clamping hubs paired, direct drive added."""
    if catalog.ends:
        return catalog
    if not estimates:
        columns = {name: catalog.actuators[name].copy() for name in ("nominal_torque", "nominal_current")}
        for name, values in columns.items():  # without figures that are a rule of thumb
            values[catalog.by_rule("actuators", name)] = np.nan
        return _viewed(replace(catalog, actuators=catalog.actuators.changed(columns)))
    found = replace(catalog, estimates=estimates_of_catalog(catalog))
    if not found.estimates:
        return _viewed(catalog)
    middle, *ends = (_viewed(replace(found, **completed(found, end))) for end in (MIDDLE, *ENDS))
    return replace(middle, ends=tuple(ends))


def _viewed(catalog: Catalog) -> Catalog:
    return with_direct_drive(with_clamping_hubs(_with_amplifiers(_with_controllers_inside(split_actuators(catalog)))))


def split_actuators(catalog: Catalog) -> Catalog:
    """The catalogue with a row for each motor, gearhead, encoder and controller that is inside an actuator.

    A catalogue without actuators, or whose actuators are split already, is returned unchanged.
    """
    if not len(catalog.actuators) or (catalog.motors["inside"] != "").any():
        return catalog
    actuators = _on_printed_points(catalog.actuators)
    for section in ("motors", "gearheads", "encoders", "controllers"):
        twice = sorted(set(actuators["part"].tolist()) & set(catalog.table(section)["part"].tolist()))
        if twice:
            raise CatalogError(f"part {quoted(twice[0])} is an actuator and a {singular(section)} as well; rename one")
    inside = {part: _part_inside(actuators, part) for part in ("motors", "gearheads", "encoders", "controllers")}
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


_PRINTED = 0.02  # within which printed figures of one part agree


def _on_printed_points(table: Table[Any]) -> Table[Any]:
    """Actuators whose constant and efficiency were worked out of no load and stall, with friction counted once.

    The catalogue's hold without friction or with all of it dry. With the no-load current as it is known by now, printed
    or estimated, and its dry share they are others: speed without load and torque at stall stay what is printed. Spur
    gears of less than the usual efficiency lose no more than that: the printed stall is a limit then.
    """
    V, w_0, M_s, I_s, R, I_0, i, k_t, e, coulomb, viscous = (
        table[name]
        for name in ("nominal_voltage", "no_load_speed", "stall_torque", "stall_current", "resistance",
                     "no_load_current", "ratio", "motor_torque_constant", "efficiency", "coulomb_friction",
                     "viscous_friction")
    )  # fmt: skip
    brushed, stalled = table["kind"] == "brushed", I_s - I_0
    dry = np.where(brushed, DRY_SHARE[SERVO], DRY_SHARE["brushless"])
    rubs = (coulomb + viscous * w_0) / i  # at the motor
    with np.errstate(invalid="ignore"):
        identified = (V + np.sqrt(V**2 - 4.0 * i * w_0 * R * rubs)) / (2.0 * i * w_0)
    constant = np.where(np.isnan(I_0), identified, (V - I_0 * R) / (i * w_0))
    share = M_s / (i * constant * (I_s - np.nan_to_num(dry * I_0)))
    share = np.where(table["gearing"] == "spur", np.fmax(share, usual_of_spur_gears(i, table["stages"])), share)
    of_speed = np.isclose(k_t * i * w_0, V, rtol=_PRINTED) | np.isclose(k_t * i * w_0, V * stalled / I_s, rtol=_PRINTED)
    of_stall = np.isclose(i * e * k_t * I_s, M_s, rtol=_PRINTED) | np.isclose(i * e * k_t * stalled, M_s, rtol=_PRINTED)
    moved = of_speed & (constant > 0.0)
    of_both = np.isnan(i) & np.isclose(table["torque_constant"] * stalled, M_s, rtol=_PRINTED)  # the ratio is unknown
    return table.changed({
        "motor_torque_constant": np.where(moved, constant, k_t),
        "torque_constant": np.where(of_both, M_s / (I_s - dry * I_0), table["torque_constant"]),
        "efficiency": np.where(moved & of_stall & (share > 0.0) & (share <= 1.0), share, e),
    })  # fmt: skip


def _with_parts_inside(
    table: Table[Any], units: Table[Any], of: NDArray[np.int64], columns: Mapping[str, Any]
) -> Table[Any]:
    """A table followed by the rows of the parts inside some actuators, or motors."""
    figures = {name: units[name] for name in _NAMES} | {"inside": units["part"]} | dict(columns)
    inside = {name: values[of] for name, values in filled(table.section, figures, len(units)).items()}
    return with_rows(table, inside, units.source[of], units.excluded[of])


def _with_controllers_inside(catalog: Catalog) -> Catalog:
    """The catalogue with a row for each controller inside a motor, which supplies what the motor was measured with."""
    motors = catalog.motors
    of = np.flatnonzero((motors["controller"] != "") & (motors["inside"] == ""))
    if not len(of):
        return catalog
    names = [f"{name} in {part}" for name, part in zip(motors["controller"][of], motors["part"][of], strict=True)]
    part = motors["part"].astype(object)
    part[of] = names
    figures = _part_inside(motors, "controllers_of_motors") | {"inside": motors["part"], "part": part.astype(str)}
    return replace(catalog, controllers=_with_parts_inside(catalog.controllers, motors, of, figures))


ASSUMED = "assumed"  # family of what makers sell to their servo motors for the mains
_MAINS = 200.0  # V of direct voltage, from which on a brushless motor is one of these
_SOLD = tables.Source("assumed: makers sell an amplifier and an encoder to each of their servo motors", "derived")


def amplifier_of(part: Any) -> Any:
    """Name of the amplifier that is assumed of a motor."""
    return np.char.add("amplifier for ", part)


def _with_amplifiers(catalog: Catalog) -> Catalog:
    """The catalogue with an amplifier, and an encoder where none is listed, for each servo motor for the mains."""
    motors, known = catalog.motors, catalog.controllers["family"] == ASSUMED
    alone = (motors["inside"] == "") & (motors["controller"] == "") & (motors["kind"] == "brushless")
    of = np.flatnonzero(alone & (motors["nominal_voltage"] >= _MAINS) & ~np.isnan(motors["peak_torque"]))
    if not len(of) or known.any():
        return catalog
    shared = {"family": ASSUMED, "order_number": "", "also_called": "", "inside": ""}
    source = len(catalog.sources)

    def sold(section: str, part: Any, rows: NDArray[np.int64], kind: str) -> Table[Any]:
        figures = {"manufacturer": motors["manufacturer"], **_part_inside(motors, kind), **shared, "part": part}
        columns = {name: values[rows] for name, values in filled(section, figures, len(motors)).items()}
        found = np.full(len(rows), source), motors.excluded[rows]
        return with_rows(catalog.table(section), columns, *found)

    without = np.setdiff1d(of, catalog.motor_encoder.left)
    new = np.arange(len(without)) + len(catalog.encoders)
    encoders = sold("encoders", np.char.add("encoder in ", motors["part"]), without, "encoders_of_servos")
    return replace(
        catalog,
        controllers=sold("controllers", amplifier_of(motors["part"]), of, "amplifiers"),
        encoders=encoders,
        motor_encoder=with_pairs(catalog.motor_encoder, without, new, np.full(len(new), source)),
        sources=(*catalog.sources, _SOLD),
    )


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
