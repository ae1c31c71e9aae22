"""Parts as a spec has them: motors as they are mounted, steppers in their place, a brake of its own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.estimates.estimate import MOUNTED, estimates, estimates_of_catalog
from drivesizer.catalog.parts import DIRECT
from drivesizer.catalog.tables import Catalog, Estimates, Pairs, Source, Table, filled, with_pairs, with_rows
from drivesizer.catalog.view import search_view
from drivesizer.physics.figures import Figures
from drivesizer.physics.stepper import DETENT_SHARE, rotor_teeth, torque_at_current
from drivesizer.physics.thermal import rated_ambient
from drivesizer.physics.winding import housing_loss

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
    found = replace(
        middle, ends=(_with_housing(ends[0], easy, brushes=False), _with_housing(ends[1], hard, brushes=True))
    )
    return replace(found, estimates=_estimates(found))


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
    one, two = motor["thermal_resistance_winding"], motor["thermal_resistance_housing"]
    speed = motor["nominal_speed"]
    dry, growing = housing_loss(motor, np.ones(len(speed)))
    loss = np.nan_to_num(dry * speed + growing * speed**2)
    rise = motor["max_winding_temperature"] - rated_ambient(motor)
    with np.errstate(invalid="ignore", divide="ignore"):
        left = np.maximum(rise - mounted * loss, 0.0) / (rise - two * loss)
        left = np.where((rise > two * loss), left, 1.0)  # else friction alone is more than what the figures permit
        gain: Array = np.sqrt(left * (one + two) / (one + mounted))
    return gain


def _estimates(catalog: Catalog) -> dict[str, dict[str, Estimates]]:
    """The catalogue's estimates, those of the changed figures as they are mounted, where they have a band."""
    found = {section: dict(figures) for section, figures in catalog.estimates.items()}
    inside = catalog.motors["inside"]
    for name in _CHANGED:
        value, *ends = (each.motors[name] for each in (catalog, *catalog.ends))
        banded = ~np.isnan(value) & (ends[0] != ends[1])
        for section, rows in (("motors", np.flatnonzero(banded & (inside == ""))),
                              ("actuators", np.flatnonzero(banded & (inside != "")))):  # fmt: skip
            known = found.setdefault(section, {})
            known.pop(name, None)
            if len(rows):
                own = rows if section == "motors" else [catalog.actuators.rows[part] for part in inside[rows].tolist()]
                low, high = np.sort([end[rows] for end in ends], axis=0)
                known[name] = Estimates(np.array(own), value[rows], low, high, np.full(len(rows), MOUNTED))
    return found


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
    found = estimates(Table("brakes", columns, source, offered)) if catalog.ends else {}
    made = []
    for view, place in zip((catalog, *catalog.ends), ("value", "low", "high"), strict=False):
        own = columns | {name: getattr(each, place) for name, each in found.items()}
        brakes = with_rows(view.brakes, own, source, offered)
        sources = (*view.sources, Source("section brake of the spec", "quoted"))
        made.append(replace(view, brakes=brakes, sources=sources))
    if not found:
        return made[0]
    together = dict(catalog.estimates.get("brakes", {}))
    for name, each in found.items():  # of a row behind those of the catalogue
        sides: tuple[Any, ...] = each._replace(rows=each.rows + len(catalog.brakes))
        if name in together:
            sides = tuple(np.concatenate(pair) for pair in zip(together[name], sides, strict=True))
        together[name] = Estimates(*sides)
    return replace(made[0], estimates={**catalog.estimates, "brakes": together}, ends=tuple(made[1:]))


# -- The catalogue as a search for steppers takes it: its steppers in the place of the motors.
#
# A stepper goes with direct drive, and with the clamping hubs that hold its shaft; neither encoders nor brakes are
# listed for it. Its column ``stepper`` is the row of the steppers' table, to which the printed pull-out curves
# belong.


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
    """Whether the catalogue is one with steppers as motors."""
    return STEPPER in catalog.motors.columns


def view_for(catalog: Catalog, kind: str | None, estimated: bool = True, phase_current: float | None = None) -> Catalog:
    """The catalogue as a search for a kind of motor takes it: of steppers these as motors, with clamping hubs."""
    if kind != STEPPER:
        return search_view.search_view(catalog, estimated)
    if has_steppers(catalog):
        return catalog
    if not estimated:
        return _viewed(catalog, phase_current)
    own = estimates(catalog.steppers)
    if share := own.get("pull_out_share"):  # a printed curve needs none
        keep = ~np.isin(share.rows, catalog.pull_outs.stepper)
        kept: tuple[Any, ...] = tuple(column[keep] for column in share)
        own["pull_out_share"] = Estimates(*kept)
    found = replace(catalog, estimates={**estimates_of_catalog(catalog), "steppers": own})
    middle, *ends = (
        _viewed(replace(found, **search_view.completed(found, end)), phase_current)
        for end in (search_view.MIDDLE, *search_view.ENDS)
    )
    return replace(middle, ends=tuple(ends))


def _viewed(catalog: Catalog, phase_current: float | None) -> Catalog:
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
    others = {s: one for s, one in catalog.estimates.items() if s not in ("motors", "actuators", "steppers")}
    own = {_NAMES.get(name, name): one for name, one in catalog.estimates.get("steppers", {}).items()}
    noted = [note._replace(section="motors", fields=tuple(_NAMES.get(name, name) for name in note.fields))
             for note in catalog.notes if note.section == "steppers"]  # fmt: skip
    moved = replace(
        catalog,
        motors=Table("motors", columns, steppers.source, steppers.excluded),
        motor_gearhead=_NO_PAIRS, motor_encoder=_NO_PAIRS, motor_brake=_NO_PAIRS,
        pull_outs=curves,
        estimates=others | {"motors": own},
        notes=(*noted, *(note for note in catalog.notes if note.section not in ("motors", "steppers"))),
    )  # fmt: skip
    fitted = search_view.with_direct_drive(search_view.with_clamping_hubs(moved))
    direct = np.full(count, fitted.gearheads.rows[DIRECT])
    return replace(fitted, motor_gearhead=with_pairs(fitted.motor_gearhead, np.arange(count), direct, steppers.source))
