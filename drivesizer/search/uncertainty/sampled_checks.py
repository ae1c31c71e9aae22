"""One drive against every limit, sample by sample: the column code of the search with samples as columns.

The search has many drives over one load cycle, here is one drive over many: the parts' figures times
their factors (``sampled_parts``), the spec's figures as columns, the load cycle of each sample.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.parts import BeltDrive
from drivesizer.catalog.view.mounted import STEPPER, has_steppers
from drivesizer.physics.motor_demand import Demands, demands
from drivesizer.physics.winding import Heat, Parts, Stress, heat, housing_loss, stress
from drivesizer.results.check_columns import CheckColumn, fits, worst_case
from drivesizer.search.columns.brakes import brake_limits, is_listed
from drivesizer.search.columns.limits import (
    electrical_limits,
    gearhead_limits,
    load_limits,
    motor_limits,
    moving_limits,
)
from drivesizer.search.columns.limits_over_time import Pair, exact, least, waveform_limits
from drivesizer.search.columns.offers import unknown_where_doubtful
from drivesizer.search.columns.shaft_limits import loads_on_gearheads, loads_on_motors
from drivesizer.search.columns.stages import felt
from drivesizer.search.columns.steppers import Draw, PullOut
from drivesizer.search.uncertainty.sampled_battery import AtSamples, battery_limits
from drivesizer.search.uncertainty.sampled_parts import (
    Block,
    PartFigures,
    SetRows,
    parts_of,
    stepper_checks,
    with_dry_share,
)
from drivesizer.spec.mounting import loss_at_flange

__all__ = ["Loaded", "checks_of", "loaded", "pull_out_of"]

Array = NDArray[np.float64]
_ERROR = 1e-2  # of what a change within a segment does to the winding; the search has 0.1 %


def checks_of(catalog: Catalog, one: SetRows, block: Block) -> dict[str, CheckColumn]:
    """Every check that samples may change, by name: columns over the samples, the worst of all load cases."""
    parts, factors = parts_of(catalog, one, block)
    stepper, listed = has_steppers(catalog), is_listed(catalog, one.motor, one.brake)
    by_name: dict[str, list[tuple[int, CheckColumn]]] = {}
    draws = []
    for number, (spec, ats) in enumerate(zip(block.specs, block.ats, strict=True)):
        at, drive = ats[one.belt], block.belts[one.belt]
        if stepper:
            highest = float(catalog.steppers["supply_max"][catalog.motors[STEPPER][one.motor]])
            checks, draw = stepper_checks(spec, at, parts, pull_out_of(catalog, parts, factors), highest, listed)
        else:
            case = loaded(spec, at, parts, factors, energies=bool(block.feeds))
            checks, draw = _of_a_case(spec, at, parts, case, np.array([listed])), _drawn(spec, case)
        if one.controller >= 0 or not stepper:
            checks = [*checks, _controller_fits(spec, parts.controller, one)]
        own = block.once(partial(load_limits, spec, at, drive), "load limits", number, one.belt)
        of_gearhead = partial(_of_gearhead, spec, at, drive, parts.gearhead)
        geared = block.once(of_gearhead, "gearhead limits", number, one.gearhead, one.belt)
        on_shaft = loads_on_motors(spec, at, drive, parts.motor, parts.gearhead) if spec.shaft else []
        draws.append(draw)
        for check in (*checks, *own, *geared, *on_shaft):
            by_name.setdefault(check.name, []).append((number, check))
    for feeds, numbers in block.feeds:
        first, together = numbers[0], [draws[number] for number in numbers]
        for check in battery_limits(block.specs[first], feeds, block.ats[first][one.belt], together):
            by_name.setdefault(check.name, []).append((first, check))
    return {name: worst_case(same) for name, same in by_name.items()}


def _of_gearhead(spec: Any, at: AtSamples, drive: BeltDrive | None, gearhead: PartFigures) -> list[CheckColumn]:
    """Limits of a gearhead, those of its shaft among them."""
    return gearhead_limits(spec, at, gearhead) + loads_on_gearheads(spec, at, drive, gearhead)


def pull_out_of(catalog: Catalog, parts: Parts, factors: Mapping[str, Array]) -> PullOut:
    """The pull-out torque of a stepper over samples."""
    return PullOut(parts.motor, catalog.pull_outs, factors.get("pull_out", 1.0))


class Loaded(NamedTuple):
    """A drive over the samples of one load case."""

    required: Demands
    warmth: Heat
    peaks: Stress
    over_time: Pair  # bounds of what needs the waveform


def loaded(spec: Any, at: AtSamples, parts: Parts, factors: Mapping[str, Array], *, energies: bool) -> Loaded:
    """Demands, heat and waveform of a drive in one load case."""
    ambient, feed = spec.environment.ambient, spec.feed(parts.controller, parts.brake)
    required = demands(at, parts.motor, parts.gearhead, parts.encoder, felt(at, parts))
    at_flange = loss_at_flange(spec, at, parts.gearhead)
    warmth = heat(ambient, at, required, parts.motor, _losses(parts.motor, required, factors), at_flange)
    peaks = stress(ambient, at, required, parts.motor, feed.leads if spec.resists else 0.0)
    figures = exact(spec, at, required, warmth, peaks, parts, "all" if energies else "limits", error=_ERROR)
    return Loaded(required, warmth, peaks, least(figures, required, warmth, peaks))


def _of_a_case(spec: Any, at: AtSamples, parts: Parts, case: Loaded, listed: NDArray[np.bool_]) -> list[CheckColumn]:
    """The checks of one load case that hang on the motor."""
    required, warmth, peaks, over_time = case
    found = [c for c in moving_limits(spec, at, required, warmth, parts) if c.name != "winding_temperature"]
    if parts.brake is not None:  # friction that holds is printed
        bought = PartFigures(parts.motor.table, parts.motor.row, parts.motor.count, {})
        found += brake_limits(spec, at, parts._replace(motor=bought), required, listed)
    found += [*electrical_limits(spec, at, required, peaks, parts), *waveform_limits(spec, *over_time, parts)]
    return [*motor_limits(spec, parts.motor), *unknown_where_doubtful(found, required.complete)]


def _drawn(spec: Any, case: Loaded) -> Draw:
    """Energy and peak power of all drives of a load case together."""
    sets = spec.load.alike if case.required.complete.all() else np.nan  # lower bounds are not energies
    found = case.over_time[0].agreed(case.over_time[1])
    return Draw(found.drawn * sets, found.returned * sets, found.power * sets)


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
