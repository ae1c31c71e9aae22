"""The catalogue as the search takes it: estimates in, actuators split, direct drive; motors as they are mounted."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import tables
from drivesizer.catalog.estimates import MOUNTED, UNRATED, estimates, estimates_of_catalog
from drivesizer.catalog.laws import value
from drivesizer.catalog.parts import DIRECT, NAMES, RELATIONS, columns_of, singular
from drivesizer.catalog.tables import Catalog, Estimates, Pairs, Source, Table, filled, with_pairs, with_rows
from drivesizer.catalog.tolerances import usual_of_spur_gears
from drivesizer.errors import CatalogError, quoted
from drivesizer.files.arithmetic import code
from drivesizer.files.yaml_source import shipped_data
from drivesizer.physics.drive_train import DRY_SHARE, SERVO
from drivesizer.physics.figures import Figures
from drivesizer.physics.stepper import DETENT_SHARE, rotor_teeth, torque_at_current
from drivesizer.physics.thermal import rated_ambient
from drivesizer.physics.winding import housing_loss

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
    for name, band in figures.items():
        kind = _HARDER_WHEN_LOW.get(name)
        harder_when_low = (table["kind"][band.rows] == kind) if kind else np.full(len(band.rows), kind is not None)
        if name == "max_winding_temperature":  # without a rating it goes with nothing
            harder_when_low |= band.fit == UNRATED
        at_end = np.where(harder_when_low == (end == "unfavourable"), band.low, band.high)
        columns[name][band.rows] = band.value if end == MIDDLE else at_end
    return table.changed(columns)


# -- The catalogue as the search takes it: actuators split into their parts, clamping hubs paired, direct drive added.
#
# An actuator's row keeps the figures that its maker prints, at the output. For the search its motor, gearhead,
# encoder and controller become rows of their own, by the table ``inside.yaml``.


CLAMPING_HUB = "clamping hub"  # mounting of a gearhead that takes motors of any maker
_THINNEST_SHAFT = 0.5  # of the hub's bore: a bushing fills the rest
_INSIDE: dict[str, dict[str, Any]] = shipped_data("drivesizer.catalog", "inside.yaml")


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
            values[catalog.by_rule(name)] = np.nan
        return _viewed(replace(catalog, actuators=catalog.actuators.changed(columns)))
    with_estimates = replace(catalog, estimates=estimates_of_catalog(catalog))
    if not with_estimates.estimates:
        return _viewed(catalog)
    middle, *ends = (_viewed(replace(with_estimates, **completed(with_estimates, end))) for end in (MIDDLE, *ENDS))
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
    tables: dict[str, Any] = {
        section: _with_parts_inside(catalog.table(section), actuators, rows[section], figures)
        for section, figures in inside.items()
    }
    for name, right in RELATIONS.items():
        if right in inside:  # each actuator's motor with the part inside the same actuator
            of, others = rows[right], np.arange(len(rows[right])) + len(catalog.table(right))
            added: tuple[NDArray[Any], ...] = (of + len(catalog.motors), others, actuators.source[of])
            pairs = zip(getattr(catalog, name), added, strict=True)
            tables[name] = Pairs(*(np.concatenate([a, b.astype(np.int32)]) for a, b in pairs))
    return replace(catalog, **tables)


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
    valid = of_speed & (constant > 0.0)
    of_both = np.isnan(i) & np.isclose(table["torque_constant"] * stalled, M_s, rtol=_PRINTED)  # the ratio is unknown
    return table.changed({
        "motor_torque_constant": np.where(valid, constant, k_t),
        "torque_constant": np.where(of_both, M_s / (I_s - dry * I_0), table["torque_constant"]),
        "efficiency": np.where(valid & of_stall & (share > 0.0) & (share <= 1.0), share, e),
    })  # fmt: skip


def _with_parts_inside(
    table: Table[Any], units: Table[Any], of: NDArray[np.int64], columns: Mapping[str, Any]
) -> Table[Any]:
    """A table followed by the rows of the parts inside some actuators, or motors."""
    figures = {name: units[name] for name in NAMES} | {"inside": units["part"]} | dict(columns)
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
        origin = np.full(len(rows), source), motors.excluded[rows]
        return with_rows(catalog.table(section), columns, *origin)

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


# -- The catalogue with its motors as a spec mounts them: another thermal resistance from housing to ambient.
#
# Data sheets give the thermal resistance from housing to ambient, R_th2, of one mounting: on a plastic plate
# (maxon), alone in air, on a plate of aluminium (servo motors). In another it is R', and the housing's time constant
# changes with it, for its heat capacity stays. The continuous current that heat permits at the nominal speed, with
# the loss P of friction and iron at the housing, is
#
# .. math:: I' = I_N \sqrt{\frac{T_{max} - T_a - R' P}{T_{max} - T_a - R_{th2} P} \cdot
#           \frac{R_{th1} + R_{th2}}{R_{th1} + R'}}
#
# Checked by data sheets that print both: of 150 of 184 maxon DCX and EC-i motors the torque at rest with half R_th2
# (operating ranges of their pages) is that by the square root within 8 %, median 1 % more; 34 brushed ones gain less
# than 5 %, as their brushes set the rating. Faulhaber 3564 B (data sheet): 3.68, 2.50, 1.71 and 1.36 A at 22 000 rpm
# with R_th2 reduced by 55 %; three of the four windings within 1.5 % of what their own figures permit, one within 6
# %. Symbols: R_th thermal resistance [K/W], I current [A], P loss [W], T temperature [K]. Its band makes two
# catalogues, as that of an estimate does: the favourable and the unfavourable end.


Array = NDArray[np.float64]
Housing = Callable[[Array], Any]  # thermal resistance as mounted, of that as printed
_CHANGED = ("thermal_resistance_housing", "motor_time_constant", "nominal_current", "nominal_torque")


def with_mounting(catalog: Catalog, housings: tuple[Housing, Housing, Housing]) -> Catalog:
    """The catalogue with the thermal figures and ratings of its motors as they are mounted."""
    nominal, easy, hard = housings
    ends = catalog.ends or (catalog, catalog)
    middle = _with_housing(catalog, nominal, brushes=False)
    view = replace(
        middle, ends=(_with_housing(ends[0], easy, brushes=False), _with_housing(ends[1], hard, brushes=True))
    )
    return replace(view, estimates=_estimates(view))


def _with_housing(catalog: Catalog, housing: Housing, *, brushes: bool) -> Catalog:
    motors: Table[Any] = catalog.motors
    printed = motors["thermal_resistance_housing"]
    mounted = housing(printed)
    gain, of_one = rating_gain(motors, mounted), float(housing(np.ones(1))[0])
    unknown, gain = np.isnan(gain), np.where(np.isnan(gain), 1.0, gain)
    at_most = np.where(np.isnan(printed), np.inf, printed / mounted) if of_one < 1.0 else np.ones(len(motors))
    at_most = np.where(unknown & (of_one != 1.0), at_most, np.nan)
    if brushes:  # may set the rating, where heat would permit more
        gain = np.where(motors["kind"] == "brushed", np.minimum(gain, 1.0), gain)
    factors = {"motor_time_constant": mounted / printed, "nominal_current": gain, "nominal_torque": gain}
    columns = {name: motors[name] * factor for name, factor in factors.items()}
    columns |= {"thermal_resistance_housing": mounted, "mounted_gain": at_most}
    return replace(catalog, motors=motors.changed(columns), mounted=True)


def rating_gain(motor: Figures, mounted: Array) -> Array:
    """Continuous current of motors in another mounting, over their nominal one, as heat sets it."""
    winding, housing = motor["thermal_resistance_winding"], motor["thermal_resistance_housing"]
    speed = motor["nominal_speed"]
    dry, growing = housing_loss(motor, np.ones(len(speed)))
    loss = np.nan_to_num(dry * speed + growing * speed**2)
    rise = motor["max_winding_temperature"] - rated_ambient(motor)
    with np.errstate(invalid="ignore", divide="ignore"):
        left = np.maximum(rise - mounted * loss, 0.0) / (rise - housing * loss)
        left = np.where((rise > housing * loss), left, 1.0)  # else friction alone is more than what the figures permit
        gain: Array = np.sqrt(left * (winding + housing) / (winding + mounted))
    return gain


def _estimates(catalog: Catalog) -> dict[str, dict[str, Estimates]]:
    """The catalogue's estimates, those of the changed figures as they are mounted, where they have a band."""
    by_section = {section: dict(figures) for section, figures in catalog.estimates.items()}
    inside = catalog.motors["inside"]
    for name in _CHANGED:
        value, *ends = (view.motors[name] for view in (catalog, *catalog.ends))
        banded = ~np.isnan(value) & (ends[0] != ends[1])
        for section, rows in (("motors", np.flatnonzero(banded & (inside == ""))),
                              ("actuators", np.flatnonzero(banded & (inside != "")))):  # fmt: skip
            known = by_section.setdefault(section, {})
            known.pop(name, None)
            if len(rows):
                own = rows if section == "motors" else [catalog.actuators.rows[part] for part in inside[rows].tolist()]
                low, high = np.sort([end[rows] for end in ends], axis=0)
                known[name] = Estimates(np.array(own), value[rows], low, high, np.full(len(rows), MOUNTED))
    return by_section


def with_current_limit(catalog: Catalog, current: float) -> Catalog:
    """The catalogue with controllers that are set to a current of the motor [A], where they could give more."""

    def limited(view: Catalog) -> Catalog:
        peak = np.minimum(view.controllers["peak_current"], current)
        return replace(view, controllers=view.controllers.changed({"peak_current": peak}))

    estimated = {section: dict(figures) for section, figures in catalog.estimates.items()}
    own = estimated.get("controllers", {})
    if (banded := own.get("peak_current")) is not None:
        sides = (np.minimum(getattr(banded, side), current) for side in ("value", "low", "high"))
        own["peak_current"] = banded._replace(**dict(zip(("value", "low", "high"), sides, strict=True)))
    return replace(limited(catalog), ends=tuple(map(limited, catalog.ends)), estimates=estimated)


# -- A holding brake with figures of the spec's own, as a part beside those of the catalogues.


OWN = "of the spec"  # family of that brake


def with_own_brake(catalog: Catalog, figures: Mapping[str, float | str]) -> Catalog:
    """The catalogue with a brake of these figures; what is not given is estimated."""
    columns = filled("brakes", {"part": "brake", "family": OWN, **figures}, 1)
    source, offered = np.array([len(catalog.sources)], np.int32), np.zeros(1, bool)
    by_figure = estimates(Table("brakes", columns, source, offered)) if catalog.ends else {}
    views = []
    for view, place in zip((catalog, *catalog.ends), ("value", "low", "high"), strict=False):
        own = columns | {name: getattr(estimate, place) for name, estimate in by_figure.items()}
        brakes = with_rows(view.brakes, own, source, offered)
        sources = (*view.sources, Source("section brake of the spec", "quoted"))
        views.append(replace(view, brakes=brakes, sources=sources))
    if not by_figure:
        return views[0]
    together = dict(catalog.estimates.get("brakes", {}))
    for name, estimate in by_figure.items():  # of a row behind those of the catalogue
        sides: tuple[Any, ...] = estimate._replace(rows=estimate.rows + len(catalog.brakes))
        if name in together:
            sides = tuple(np.concatenate(pair) for pair in zip(together[name], sides, strict=True))
        together[name] = Estimates(*sides)
    return replace(views[0], estimates={**catalog.estimates, "brakes": together}, ends=tuple(views[1:]))


# -- The catalogue as a search for steppers takes it: its steppers in the place of the motors.
#
# A stepper goes with direct drive, and with the clamping hubs that hold its shaft; neither encoders nor brakes are
# listed for it. Its column ``stepper`` is the row of the steppers' table, to which the printed pull-out curves
# belong.


STEPPER = "stepper"  # kind of such a motor, and the column with its row in the steppers' table
_NONE = np.zeros(0, np.int32)
_NO_PAIRS = Pairs(_NONE, _NONE, _NONE)
_AS_MOTOR = {"phase_current": "nominal_current", "full_steps": "pole_pairs"}  # as the motors' table has them
_ALIKE = [name for name in columns_of("steppers") if name in columns_of("motors")
          and name not in ("foreign_price", "currency")]  # fmt: skip


def has_steppers(catalog: Catalog) -> bool:
    """Whether the catalogue is one with steppers as motors."""
    return STEPPER in catalog.motors.columns


def view_for(catalog: Catalog, kind: str | None, estimated: bool = True, phase_current: float | None = None) -> Catalog:
    """The catalogue as a search for a kind of motor takes it: of steppers these as motors, with clamping hubs."""
    if kind != STEPPER:
        return search_view(catalog, estimated)
    if has_steppers(catalog):
        return catalog
    if not estimated:
        return _with_steppers(catalog, phase_current)
    own = estimates(catalog.steppers)
    if share := own.get("pull_out_share"):  # a printed curve needs none
        keep = ~np.isin(share.rows, catalog.pull_outs.stepper)
        columns: tuple[Any, ...] = tuple(column[keep] for column in share)
        own["pull_out_share"] = Estimates(*columns)
    with_estimates = replace(catalog, estimates={**estimates_of_catalog(catalog), "steppers": own})
    middle, *ends = (
        _with_steppers(replace(with_estimates, **completed(with_estimates, end)), phase_current)
        for end in (MIDDLE, *ENDS)
    )
    return replace(middle, ends=tuple(ends))


def _with_steppers(catalog: Catalog, phase_current: float | None) -> Catalog:
    steppers, curves, count = catalog.steppers, catalog.pull_outs, len(catalog.steppers)
    less = np.ones(count)
    if phase_current is not None:
        less = np.minimum(phase_current / steppers["phase_current"], 1.0)
        detent, most = steppers["detent_torque"], np.fmax(steppers["holding_torque"], 0.0)
        rotor = np.where(np.isnan(detent), DETENT_SHARE * most, detent)[curves.stepper]
        curves = curves._replace(torque=np.asarray(torque_at_current(curves.torque, less[curves.stepper], rotor)))
    figures: dict[str, Any] = {name: steppers[name] for name in _ALIKE}
    figures |= {
        "kind": STEPPER, "commutation": steppers["wiring"], "phases": 2.0,
        "nominal_current": steppers["phase_current"] if phase_current is None else phase_current,
        "holding_torque": steppers["holding_torque"] * less, "start_speed": steppers["start_speed"] * np.sqrt(less),
        "pole_pairs": rotor_teeth(steppers["full_steps"]),
    }  # fmt: skip
    columns = filled("motors", figures, count) | {STEPPER: np.arange(count)}
    others = {
        s: by_figure for s, by_figure in catalog.estimates.items() if s not in ("motors", "actuators", "steppers")
    }
    own = {_AS_MOTOR.get(name, name): estimate for name, estimate in catalog.estimates.get("steppers", {}).items()}
    noted = [note._replace(section="motors", fields=tuple(_AS_MOTOR.get(name, name) for name in note.fields))
             for note in catalog.notes if note.section == "steppers"]  # fmt: skip
    view = replace(
        catalog,
        motors=Table("motors", columns, steppers.source, steppers.excluded),
        motor_gearhead=_NO_PAIRS, motor_encoder=_NO_PAIRS, motor_brake=_NO_PAIRS,
        pull_outs=curves,
        estimates=others | {"motors": own},
        notes=(*noted, *(note for note in catalog.notes if note.section not in ("motors", "steppers"))),
    )  # fmt: skip
    fitted = with_direct_drive(with_clamping_hubs(view))
    direct = np.full(count, fitted.gearheads.rows[DIRECT])
    return replace(fitted, motor_gearhead=with_pairs(fitted.motor_gearhead, np.arange(count), direct, steppers.source))
