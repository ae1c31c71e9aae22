"""The parts of a set over samples: figures times tolerances, estimated figures within their bands.

One row is one machine; the first has every figure as printed, or at the middle of its band. An estimated figure is
log-normal with the ends of its band as 5th and 95th percentile, and has no tolerance beside that; where a term of its
law is estimated too, it follows what was drawn for that.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import PARTS, RELATIONS, Catalog, Table, columns_of
from drivesizer.catalog.estimates import Estimate, estimates_of
from drivesizer.catalog.estimates.estimate import estimates, law_text
from drivesizer.catalog.estimates.family_limits import SAME_FAMILY, FamilyLimit, family_limits
from drivesizer.catalog.estimates.fit import Fit
from drivesizer.catalog.parts import NO_GEARHEAD
from drivesizer.catalog.query import Hit
from drivesizer.catalog.tables import Pairs, empty
from drivesizer.catalog.tolerances.classes import Class
from drivesizer.catalog.tolerances.distributions import lognormal
from drivesizer.catalog.view.search_view import split_actuators
from drivesizer.physics.drive_train import back_emf_constant
from drivesizer.physics.power_stage import with_stage_losses
from drivesizer.results.estimated import EstimatedFigure
from drivesizer.search.uncertainty.class_of_part import holding
from drivesizer.search.uncertainty.sampled_parts import motor_factors, with_dry_share, with_losses
from drivesizer.search.uncertainty.sobol_sequence import sobol

__all__ = ["Figures", "SampledParts", "sampled_parts"]

Array = NDArray[np.float64]
Figures = Mapping[str, NDArray[Any]]
_SEED = 1
_STAGE = {"max_duty": (0.9, 1.0), "voltage_drop": (0.0, 1.0)}  # [1], [V]: to those of maxon's EPOS4
_NO_PAIRS = Pairs(*(np.zeros(0, np.int32) for _ in range(3)))


class SampledParts(NamedTuple):
    """Figures of motor, gearhead and controller by field name: columns, the first row nominal."""

    motor: Figures
    gearhead: Figures
    controller: Figures | None
    free: Array  # (samples + 1, 3): three more uniform figures, 0 to 1; the first row 0.5
    estimates: tuple[EstimatedFigure, ...]
    classes: tuple[Class, ...]


def sampled_parts(motor: Hit, gearhead: Hit | None, controller: Hit | None, power: int) -> SampledParts:
    """The parts of a set over 2 to the power samples, and their nominal figures before them."""
    sold = {"actuator" if motor.section == "actuators" else "motor": motor} | (
        {"gearhead": gearhead} if gearhead else {}
    )
    estimated = [(role, hit.section, one) for role, hit in sold.items() for one in estimates_of(hit.table, hit.row)]
    drawn = [one for one in _classes(motor, gearhead, controller) if one.factor is not None]
    cube = sobol(len(estimated) + len(drawn) + 5, power, [(_SEED, 0)])
    cube = np.concatenate([np.full((1, cube.shape[1]), 0.5), cube])
    limits = [(role, hit.section, one) for role, hit in sold.items() for one in family_limits(hit.table, hit.row)]
    tables = {role: _rows(hit, len(cube)) for role, hit in sold.items()}
    laws = {role: {one.fit for other, _, one in estimated if other == role} for role in sold}
    for (role, _, figure), share in zip(estimated, cube.T, strict=False):
        tables[role][figure.figure] = _within(figure, laws[role], sold[role], tables[role], share)
    for role, _, limit in limits:
        tables[role][limit.figure] = np.full(len(cube), limit.value)
    bought, gear = _split(motor, tables)
    factors: dict[str, dict[str, Array]] = {part: {} for part in ("motor", "gearhead", "controller")}
    for one, share in zip(drawn, cube.T[len(estimated) :], strict=False):
        factors[one.part][one.figure] = _factor(one, share)
    names = {one.figure for _, _, one in estimated}
    return SampledParts(
        _motor(bought, factors["motor"], names),
        _gearhead(gear, factors["gearhead"], names),
        None if controller is None else _controller(controller, cube, factors["controller"]),
        cube[:, -3:],
        (
            *(_estimated(*one) for one in estimated),
            *(_alike(*one) for one in limits),
            *(_printed_stage(name) for name in (_assumed(controller, cube) if controller else ())),
        ),
        tuple(drawn),
    )


def _estimated(role: str, section: str, one: Estimate) -> EstimatedFigure:
    """An estimated figure as it is printed."""
    column, law = columns_of(section)[one.figure], law_text(one.fit)
    return EstimatedFigure(role, one.figure, one.value, one.low, one.high, column.kind, column.unit, law)


def _alike(role: str, section: str, one: FamilyLimit) -> EstimatedFigure:
    """A limit that all others of the family have."""
    column, law = columns_of(section)[one.figure], f"{SAME_FAMILY}, {one.members} alike"
    return EstimatedFigure(role, one.figure, one.value, one.value, one.value, column.kind, column.unit, law)


def _assumed(controller: Hit, shares: Array) -> dict[str, Array]:
    """Voltage drop of a controller that does not print it: columns between the assumed ends."""
    lacking = [name for name in _STAGE if np.isnan(controller[name])]
    return {name: low + (high - low) * share for name, share in zip(lacking, shares.T, strict=False)
            for low, high in (_STAGE[name],)}  # fmt: skip


def _printed_stage(name: str) -> EstimatedFigure:
    """The same as it is printed."""
    (low, high), column = _STAGE[name], columns_of("controllers")[name]
    middle, wide = (low + high) / 2.0, 0.45 * (high - low)
    law = "assumed: from an ideal power stage to one of 0.9 and 1 V"
    return EstimatedFigure("controller", name, middle, middle - wide, middle + wide, column.kind, column.unit, law)


def _within(one: Estimate, laws: set[Fit], hit: Hit, columns: Figures, share: Array) -> Array:
    """Log-normal values of an estimated figure, by its law where terms of it were drawn before: errors go together.

    The laws are those of the part: another may be narrower where a term was drawn far from its middle.
    """
    from scipy.special import ndtri

    value, low, high = (np.full(len(share), x) for x in (one.value, one.low, one.high))
    row = np.full(len(share), hit.row)
    drawn = estimates(Table(hit.section, columns, hit.table.source[row], hit.table.excluded[row]), laws)[one.figure]
    for into, found in ((value, drawn.value), (low, drawn.low), (high, drawn.high)):
        into[drawn.rows] = found
    values = lognormal(low, value, high, ndtri(np.clip(share, 1e-6, 1.0 - 1e-6)))
    values[0] = one.value
    return np.asarray(np.minimum(values, 1.0 if one.figure == "efficiency" else np.inf))


def _factor(one: Class, share: Array) -> Array:
    """Factors of a printed figure; 1 in the nominal row."""
    assert one.factor is not None
    found = one.factor.at(share)
    found[0] = 1.0
    return found


def _rows(hit: Hit, count: int) -> dict[str, NDArray[Any]]:
    """Figures of a part, in as many rows."""
    return {name: np.full(count, hit.table[name][hit.row]) for name in hit.table.columns}


def _split(motor: Hit, tables: Mapping[str, Figures]) -> tuple[Figures, Figures]:
    """Motor and gearhead; of an actuator those inside it."""
    if motor.section == "actuators":
        inside = _inside(
            motor.catalog, tables["actuator"], np.full(len(tables["actuator"]["part"]), motor.table.source[motor.row])
        )
        return inside.motors.columns, inside.gearheads.columns
    bought = tables["motor"]
    none = {name: np.full(len(bought["part"]), getattr(NO_GEARHEAD, name)) for name in columns_of("gearheads")}
    return bought, tables.get("gearhead", none)


def _inside(catalog: Catalog, columns: Figures, source: NDArray[np.int32]) -> Catalog:
    """A catalogue of one actuator in many rows, split."""
    tables: dict[str, Any] = {section: empty(section) for section in PARTS}
    tables["actuators"] = Table("actuators", columns, source, np.zeros(len(source), bool))
    return split_actuators(catalog.with_tables(tables, dict.fromkeys(RELATIONS, _NO_PAIRS)))


def _classes(motor: Hit, gearhead: Hit | None, controller: Hit | None) -> tuple[Class, ...]:
    """Tolerance classes of the figures of motor, gearhead and controller."""
    own = _rotating_inertia(motor, gearhead)
    if controller is None or np.isnan([controller[name] for name in ("voltage_drop", "max_efficiency")]).all():
        return own  # the drop is assumed, with a band of its own
    return own + holding(controller.catalog, {}, "controller", controller.row)


def _rotating_inertia(motor: Hit, gearhead: Hit | None) -> tuple[Class, ...]:
    if motor.section == "actuators":
        one = _inside(motor.catalog, _rows(motor, 1), motor.table.source[motor.row : motor.row + 1])
        return holding(one, {}, "motor", 0) + holding(one, {}, "gearhead", 0)
    own = holding(motor.catalog, {}, "motor", motor.row)
    return own + (holding(gearhead.catalog, {}, "gearhead", gearhead.row) if gearhead else ())


def _motor(bought: Figures, factors: Mapping[str, Array], estimated: set[str]) -> Figures:
    """A motor's figures, each times its factor."""
    times = motor_factors(factors)
    k_e = back_emf_constant(bought) * times["back_emf_constant"]
    changed = {name: bought[name] * factor for name, factor in times.items() if name not in estimated}
    return dict(bought) | changed | {"back_emf_constant": k_e} | with_dry_share(bought, factors)


def _controller(controller: Hit, cube: Array, factors: Mapping[str, Array]) -> Figures:
    """A controller's figures, its losses times their factor; what it does not print of them within assumed ends."""
    bought = _rows(controller, len(cube)) | _assumed(controller, cube[:, -5:-3])
    return bought | with_stage_losses(bought, factors["losses"]) if "losses" in factors else bought


def _gearhead(gear: Figures, factors: Mapping[str, Array], estimated: set[str]) -> Figures:
    """A gearhead's figures, each times its factor."""
    losses, inertia = factors.get("efficiency", 1.0), factors.get("inertia", 1.0)
    changed = {"no_load_torque": gear["no_load_torque"] * losses, "inertia": gear["inertia"] * inertia}
    changed["efficiency"] = with_losses(gear["efficiency"], losses)
    return dict(gear) | {name: values for name, values in changed.items() if name not in estimated}
