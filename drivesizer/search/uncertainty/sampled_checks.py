"""One drive against every limit, sample by sample: the column code of the search with samples as columns.

The search has many drives over one load cycle, here is one drive over many: the parts' figures times
their factors, the spec's figures as columns, the load cycle of each sample. Encoder and controller are those of the
nominal drive, since they are bought once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.belt_drive import BeltDrive
from drivesizer.catalog.tolerances.classes import Class
from drivesizer.catalog.view.own_brake import OWN
from drivesizer.catalog.view.stepper_view import STEPPER, has_steppers
from drivesizer.physics.back_emf import back_emf_constant
from drivesizer.physics.motor_demand import Demands, demands, friction
from drivesizer.physics.power_stage import with_stage_losses
from drivesizer.physics.stress import Heat, Parts, Stress, heat, housing_loss, stress
from drivesizer.physics.thermal import rated_ambient, resistance_25, steady_winding_temperature
from drivesizer.results.check_columns import CheckColumn, fits, worst_case
from drivesizer.search.columns.brakes import brake_limits, is_listed
from drivesizer.search.columns.limits import (
    electrical_limits,
    gearhead_limits,
    load_limits,
    motor_limits,
    moving_limits,
)
from drivesizer.search.columns.limits_over_time import Pair, least, waveform_limits
from drivesizer.search.columns.offers import unknown_where_doubtful
from drivesizer.search.columns.shaft_limits import loads_on_gearheads, loads_on_motors
from drivesizer.search.columns.stages import felt
from drivesizer.search.uncertainty.class_of_part import holding
from drivesizer.search.uncertainty.part_figures import WHOLE, PartFigures
from drivesizer.search.uncertainty.sampled_battery import Draw, Feeding, battery_limits
from drivesizer.search.uncertainty.sampled_cycle import AtSamples
from drivesizer.search.uncertainty.sampled_steppers import SampledStepper, stepper_checks, stepper_motor
from drivesizer.search.uncertainty.sampled_waveform import moments
from drivesizer.spec.mounting import loss_at_flange

__all__ = [
    "Block",
    "Loaded",
    "SetRows",
    "checks_of",
    "loaded",
    "motor_factors",
    "parts_of",
    "stepper_of",
    "with_dry_share",
    "with_losses",
]

Array = NDArray[np.float64]
Held = TypeVar("Held")
_HELD = 64  # parts, and limits of parts, that a block holds: some MB at most each


class SetRows(NamedTuple):
    """The parts of a drive, as rows of the catalogue's tables; -1 where there is none."""

    motor: int
    gearhead: int
    encoder: int
    controller: int
    belt: float
    brake: int = -1


class Block(NamedTuple):
    """Some of the samples, ready for any drive: a load case each."""

    size: int
    specs: tuple[Any, ...]  # with columns
    ats: tuple[Mapping[float, AtSamples], ...]  # by belt ratio
    feeds: tuple[tuple[Feeding, tuple[int, ...]], ...]  # batteries, each with the cases that draw from it
    factors: Mapping[Class, Array]  # of the catalogue's figures
    given: Mapping[tuple[str, str], str]  # the spec's own classes, before any other
    belts: Mapping[float, BeltDrive | None]  # by ratio, where they are out of the catalogues
    held: dict[tuple[Any, ...], Any]  # of parts that were looked at: many drives have the same

    def factors_of(self, catalog: Catalog, part: str, row: int) -> dict[str, Array]:
        """Factors of the figures of a part that are sampled, by figure."""
        held = self.once(lambda: holding(catalog, self.given, part, row), "classes", part, row)
        return {one.figure: self.factors[one] for one in held if one in self.factors}

    def once(self, make: Callable[[], Held], *name: Any) -> Held:
        """A figure made of some parts, the first time that its name is used; of the last ones it is held."""
        if name not in self.held:
            if len(self.held) >= _HELD:
                self.held.clear()
            self.held[name] = make()
        found: Held = self.held[name]
        return found


def motor_factors(given: Mapping[str, Any]) -> dict[str, Any]:
    """Factors of a motor's figures; heat capacities are not sampled.

    Torque and voltage constant have one factor: both deviate with the magnets' flux. Their difference, by saturation
    and losses, belongs to the type and is no tolerance of the single motor.

    Parameters
    ----------
    given
        Factors by class, as far as they are sampled: columns or single ones.

    Returns
    -------
    dict
        Factor by the name of the figure in the catalogue [1].
    """
    friction, cooling, k = (given.get(name, 1.0) for name in ("friction", "thermal_resistance", "torque_constant"))
    return {
        "resistance": given.get("resistance", 1.0), "torque_constant": k, "back_emf_constant": k,
        "rotor_inertia": given.get("rotor_inertia", 1.0),
        "no_load_current": friction / k, "friction_torque": friction, "viscous_friction": friction,
        "thermal_resistance_winding": cooling, "thermal_resistance_housing": cooling,
        "winding_time_constant": cooling, "motor_time_constant": cooling,
    }  # fmt: skip


def with_dry_share(motor: Any, factors: Mapping[str, Any]) -> dict[str, Any]:
    """Friction of a motor whose dry share is sampled: at any speed, and per speed; nothing where it is not.

    Parameters
    ----------
    motor
        Figures by field name, without the factors.
    factors
        By class.

    Returns
    -------
    dict
        The two columns [N*m], [N*m*s/rad]; the share's factor and that of all friction in them.
    """
    if "dry_friction" not in factors:
        return {}
    coulomb, viscous = friction(motor, factors["dry_friction"])
    factor = factors.get("friction", 1.0)
    return {"friction_torque": coulomb * factor, "viscous_friction": viscous * factor}


def with_losses(efficiency: Any, factor: Any) -> Any:
    """Efficiency with losses per transmitted torque, 1/e - 1, times a factor; it stays within 0 to 1.

    Parameters
    ----------
    efficiency
        Nominal [1].
    factor
        Of the losses [1].

    Returns
    -------
    float or array
        Efficiency [1].
    """
    return 1.0 / (1.0 + (1.0 / efficiency - 1.0) * factor)


def _motor(catalog: Catalog, row: int, block: Block, factors: Mapping[str, Array]) -> PartFigures:
    """A motor's figures, each times its factor."""
    times = motor_factors(factors)
    bought, whole = PartFigures(catalog.motors, row, block.size, {}), np.ones(block.size)
    printed = bought.nominal
    changed = {
        name: printed(name) * factor * (whole if name in WHOLE else 1.0)
        for name, factor in times.items()
        if np.ndim(factor) or name in WHOLE
    }
    changed["back_emf_constant"] = back_emf_constant(bought) * times["back_emf_constant"]
    changed |= {name: x * whole for name, x in with_dry_share(bought, factors).items()}
    rated = catalog.estimate_of("motors", row, "max_winding_temperature") is not None  # by its nominal current
    if rated and catalog.motors["kind"][row] != "brushed":
        one, other = (changed.get(f"thermal_resistance_{name}", printed(f"thermal_resistance_{name}"))
                      for name in ("winding", "housing"))  # fmt: skip
        changed["max_winding_temperature"] = whole * steady_winding_temperature(
            rated_ambient(bought), resistance_25(bought), one, other, bought["nominal_current"]
        )
    return PartFigures(catalog.motors, row, block.size, changed)


def _gearhead(catalog: Catalog, row: int, block: Block) -> PartFigures:
    """A gearhead's figures, each times its factor."""
    printed = PartFigures(catalog.gearheads, row, block.size, {}).nominal
    changed, factors = {}, block.factors_of(catalog, "gearhead", row)
    if (losses := factors.get("efficiency")) is not None:
        changed["efficiency"] = with_losses(printed("efficiency"), losses)
        changed["no_load_torque"] = printed("no_load_torque") * losses
    if (peaks := factors.get("peak_torque")) is not None:
        changed["intermittent_torque"] = printed("intermittent_torque") * peaks
    if (gains := factors.get("inertia")) is not None:
        changed["inertia"] = printed("inertia") * gains
    return PartFigures(catalog.gearheads, row, block.size, changed)


def _controller(catalog: Catalog, row: int, block: Block) -> PartFigures:
    """A controller's figures, its losses times their factor."""
    bought = PartFigures(catalog.controllers, row, block.size, {})
    factor = block.factors_of(catalog, "controller", row).get("losses")
    if factor is None:
        return bought
    changed = with_stage_losses(bought, factor, assume=block.specs[0].select.estimates == "on")
    return PartFigures(catalog.controllers, row, block.size, changed)


def _brake(catalog: Catalog, row: int, block: Block) -> PartFigures:
    """A brake's figures; of one that is the spec's own with its tolerances."""
    own, changed = block.specs[0].brake, dict[str, Array]()
    if own is not None and row >= 0 and catalog.brakes["family"][row] == OWN:
        changed = {name: x for name, x in own.figures.items() if np.ndim(x)}
    return PartFigures(catalog.brakes, row, block.size, changed)


def parts_of(catalog: Catalog, one: SetRows, block: Block) -> tuple[Parts, dict[str, Array]]:
    """The parts of a drive over samples, and the factors of its motor; of a stepper its driver's as well.

    Parameters
    ----------
    catalog, one, block
        As for ``checks_of``.

    Returns
    -------
    tuple
        Figures by field name, columns over the samples; factors by figure [1].
    """
    factors = block.factors_of(catalog, "motor", one.motor)
    if has_steppers(catalog):
        factors |= block.factors_of(catalog, "controller", one.controller)
        motor = stepper_motor(catalog, one.motor, block.size, factors)
    else:
        motor = block.once(lambda: _motor(catalog, one.motor, block, factors), "motor", one.motor)
    gearhead = block.once(lambda: _gearhead(catalog, one.gearhead, block), "gearhead", one.gearhead)
    encoder = block.once(lambda: PartFigures(catalog.encoders, one.encoder, block.size, {}), "encoder", one.encoder)
    controller = block.once(lambda: _controller(catalog, one.controller, block), "controller", one.controller)
    brake = _brake(catalog, one.brake, block) if block.specs[0].wants_brake else None
    return Parts(motor, gearhead, encoder, controller, brake), factors


def checks_of(catalog: Catalog, one: SetRows, block: Block) -> dict[str, CheckColumn]:
    """Every check that samples may change, by name: columns over the samples, the worst of all load cases.

    Parameters
    ----------
    catalog
        The parts.
    one
        Rows of the drive's parts.
    block
        The samples.

    Returns
    -------
    dict of CheckColumn
        By name: columns over the samples.
    """
    parts, factors = parts_of(catalog, one, block)
    listed = is_listed(catalog, one.motor, one.brake)
    stepper = stepper_of(catalog, one, parts, factors)
    by_name: dict[str, list[tuple[int, CheckColumn]]] = {}
    draws = []
    for number, (spec, ats) in enumerate(zip(block.specs, block.ats, strict=True)):
        at, drive = ats[one.belt], block.belts[one.belt]
        if stepper:
            checks, draw = stepper_checks(spec, at, stepper)
            checks += [_controller_fits(spec, parts.controller, one)] if one.controller >= 0 else []
        else:
            checks, draw = _of_a_case(spec, at, parts, one, factors, listed, energies=bool(block.feeds))
        own = block.once(partial(load_limits, spec, at, drive), "load limits", number, one.belt)
        of_gearhead = partial(_of_gearhead, spec, at, drive, parts.gearhead)
        geared = block.once(of_gearhead, "gearhead limits", number, one.gearhead, one.belt)
        on_motor = loads_on_motors(spec, at, drive, parts.motor, parts.gearhead) if spec.shaft else []
        checks = [*own, *checks, *geared, *on_motor]
        draws.append(draw)
        for check in checks:
            by_name.setdefault(check.name, []).append((number, check))
    for feeds, numbers in block.feeds:
        first = numbers[0]
        together = [draws[number] for number in numbers]
        for check in battery_limits(block.specs[first], feeds, block.ats[first][one.belt], together):
            by_name.setdefault(check.name, []).append((first, check))
    return {name: worst_case(same) for name, same in by_name.items()}


def _of_gearhead(spec: Any, at: AtSamples, drive: BeltDrive | None, gearhead: PartFigures) -> list[CheckColumn]:
    """Limits of a gearhead, those of its shaft among them."""
    return gearhead_limits(spec, at, gearhead) + loads_on_gearheads(spec, at, drive, gearhead)


def stepper_of(catalog: Catalog, one: SetRows, parts: Parts, factors: Mapping[str, Array]) -> SampledStepper | None:
    """A stepper over samples, with what its checks take beside its parts.

    Parameters
    ----------
    catalog, one
        As for ``checks_of``.
    parts, factors
        Of ``parts_of``.

    Returns
    -------
    SampledStepper or None
        None of other motors.
    """
    if not has_steppers(catalog):
        return None
    highest = catalog.steppers["supply_max"][catalog.motors[STEPPER][one.motor]]
    listed = is_listed(catalog, one.motor, one.brake)
    return SampledStepper(parts, factors.get("pull_out", 1.0), catalog.pull_outs, float(highest), listed)


class Loaded(NamedTuple):
    """A drive over the samples of one load case."""

    required: Demands
    warmth: Heat
    peaks: Stress
    over_time: Pair  # bounds of what needs the waveform


def loaded(spec: Any, at: AtSamples, parts: Parts, factors: Mapping[str, Array], *, energies: bool) -> Loaded:
    """Demands, heat and waveform of a drive in one load case.

    Parameters
    ----------
    spec, at
        The load case with columns, and its load cycles.
    parts, factors
        Of ``parts_of``.
    energies
        Compute power and energy, whatever the checks need.

    Returns
    -------
    Loaded
        Columns over the samples.
    """
    required = demands(at, parts.motor, parts.gearhead, parts.encoder, felt(at, parts))
    at.keep(required.coefficients)
    losses = _losses(parts.motor, required, factors)
    at_flange = loss_at_flange(spec, at, parts.gearhead)
    warmth = heat(spec.environment.ambient, at, required, parts.motor, losses, at_flange)
    feed = spec.feed(parts.controller, parts.brake)
    peaks = stress(spec.environment.ambient, at, required, parts.motor, feed.leads if spec.resists else 0.0)
    figures = moments(spec, at, required, warmth, peaks, parts, feed, energies=energies)
    return Loaded(required, warmth, peaks, least(figures, required, warmth, peaks))


def _of_a_case(
    spec: Any,
    at: AtSamples,
    parts: Parts,
    one: SetRows,
    factors: Mapping[str, Array],
    listed: bool,
    *,
    energies: bool,
) -> tuple[list[CheckColumn], Draw]:
    """The checks of one load case, and the energy that its drives draw."""
    required, warmth, peaks, found = loaded(spec, at, parts, factors, energies=energies)
    moving = [c for c in moving_limits(spec, at, required, warmth, parts) if c.name != "winding_temperature"]
    if parts.brake is not None:
        bought = PartFigures(
            parts.motor.table, parts.motor.row, parts.motor.count, {}
        )  # friction that holds is printed
        moving += brake_limits(spec, at, parts._replace(motor=bought), required, np.array([listed]))
    electrical = [*moving, *electrical_limits(spec, at, required, peaks, parts), *waveform_limits(spec, *found, parts)]
    sets = spec.load.alike if required.complete.all() else np.nan  # lower bounds are not energies
    drawn = found[0].agreed(found[1])
    return [
        *motor_limits(spec, parts.motor),
        *unknown_where_doubtful(electrical, required.complete),
        _controller_fits(spec, parts.controller, one),
    ], Draw(drawn.drawn * sets, drawn.returned * sets, drawn.power * sets)


def _losses(motor: PartFigures, required: Demands, factors: Mapping[str, Array]) -> tuple[Array, Array]:
    """Losses at the housing; in the iron of a brushless motor by its printed figures, times the factor of friction."""
    if motor.nominal("kind")[0] == "brushed":
        return housing_loss(motor, required.total_ratio)
    printed = PartFigures(motor.table, motor.row, motor.count, {})
    shares = with_dry_share(printed, {"dry_friction": factors["dry_friction"]} if "dry_friction" in factors else {})
    lost = housing_loss(PartFigures(motor.table, motor.row, motor.count, shares), required.total_ratio)
    return lost[0] * factors.get("friction", 1.0), lost[1] * factors.get("friction", 1.0)


def _controller_fits(spec: Any, controller: Any, one: SetRows) -> CheckColumn:
    """Whether the chosen controller permits the supply's voltages."""
    lowest, highest = np.asarray(spec.supply.lowest), np.asarray(spec.supply.highest)
    good = (controller["supply_min"] <= lowest) & (controller["supply_max"] >= highest) & (one.controller >= 0)
    known = one.controller < 0 or ~np.isnan(controller["supply_min"] + controller["supply_max"])
    return fits("controller_available", good, known)
