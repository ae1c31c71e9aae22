"""Figures of one drive over samples: current, voltage, power, heat, temperature, free speed and stall torque.

They are those of the same samples as the checks, in each sample of its worst load case.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.view.stepper_view import has_steppers
from drivesizer.physics.at_voltage import Winding, operating_point
from drivesizer.physics.drive_train import friction, gear_loss
from drivesizer.physics.stress import Parts
from drivesizer.physics.thermal import resistance_25, resistance_at
from drivesizer.results.reliability import FigureSpread
from drivesizer.search.uncertainty.prepare import Prepared, blocks
from drivesizer.search.uncertainty.probabilities import quantiles
from drivesizer.search.uncertainty.sampled_checks import Loaded, loaded, stepper_of
from drivesizer.search.uncertainty.sampled_parts import Block, SetRows, parts_of
from drivesizer.search.uncertainty.sampled_steppers import stepper_figures

__all__ = ["figure_columns", "figure_spreads"]

Array = NDArray[np.float64]
_FIGURES = {
    "rms_current": ("Motor current, RMS", "current", "A"),
    "peak_current": ("Motor current, peak", "current", "A"),
    "voltage": ("Motor voltage, peak", "voltage", "V"),
    "power": ("Supply power, peak, all drives", "power", "W"),
    "joule_heat": ("Heat of the winding, mean", "power", "W"),
    "winding_temperature": ("Winding temperature, peak", "temperature", "degC"),
    "free_speed": ("Free speed at the load's shaft", "rotary_speed", "rpm"),
    "stall_torque": ("Stall torque at the load's shaft", "torque", "N*m"),
}
_OF_STEPPERS = {
    "motor_torque": ("Motor torque, peak", "torque", "N*m"),
    "pull_out_at_rest": ("Pull-out torque at low speed", "torque", "N*m"),
    "pull_out_at_speed": ("Pull-out torque at the highest speed", "torque", "N*m"),
    "power": _FIGURES["power"],
    "joule_heat": ("Heat of both windings", "power", "W"),
    "peak_current": ("Amplitude of the phase current", "current", "A"),
}
_LEAST = ("free_speed", "stall_torque", "pull_out_at_rest", "pull_out_at_speed")  # the worst load case has the smallest


def figure_spreads(given: Prepared, catalog: Catalog, one: SetRows) -> tuple[FigureSpread, ...]:
    """Percentiles of the figures of a drive."""
    each = [figure_columns(catalog, one, block) for block in blocks(given, catalog, [one.belt])]
    found = []
    for name, (title, kind, unit) in (_OF_STEPPERS if has_steppers(catalog) else _FIGURES).items():
        low, middle, high = quantiles(np.concatenate([columns[name] for columns in each]))
        found.append(FigureSpread(name=name, title=title, kind=kind, unit=unit, low=low, middle=middle, high=high))
    return tuple(found)


def figure_columns(catalog: Catalog, one: SetRows, block: Block) -> dict[str, Array]:
    """Figures of a drive, sample by sample."""
    parts, factors = parts_of(catalog, one, block)
    stepper = stepper_of(catalog, one, parts, factors)
    found: dict[str, Array] = {}
    for spec, ats in zip(block.specs, block.ats, strict=True):
        if stepper:
            figures = stepper_figures(spec, ats[one.belt], stepper)
        else:
            case = loaded(spec, ats[one.belt], parts, factors, energies=True)
            with np.errstate(divide="ignore", invalid="ignore"):
                figures = _demanded(spec, case) | _at_full_voltage(spec, parts, one.belt)
        for name, column in figures.items():
            values = np.array(np.broadcast_to(column, block.size))
            worse = np.minimum if name in _LEAST else np.maximum
            found[name] = worse(found[name], values) if name in found else values
    return found


def _demanded(spec: Any, case: Loaded) -> dict[str, Any]:
    """Figures that the load cycle makes; unknown where only a least demand is known."""
    known, (low, high) = case.required.complete, case.over_time
    over_time = low.agreed(high)
    copper = np.where(np.isnan(over_time.winding), np.nan, over_time.copper)  # bounds of it are not kept
    figures = {
        "rms_current": case.required.rms_current, "peak_current": case.peaks.current.value,
        "voltage": over_time.voltage, "power": over_time.power * spec.load.motors,
        "joule_heat": copper, "winding_temperature": over_time.winding,
    }  # fmt: skip
    return {name: np.where(known, column, np.nan) for name, column in figures.items()}


def _at_full_voltage(spec: Any, parts: Parts, belt: float) -> dict[str, Any]:
    """Free speed [rad/s] and stall torque [N*m] of one drive at the nominal supply, winding at the ambient."""
    motor, gearhead, feed = parts.motor, parts.gearhead, spec.feed(parts.controller, parts.brake)
    feed = feed._replace(voltage=spec.supply.nominal)
    cold = resistance_at(resistance_25(motor), spec.environment.ambient) + (feed.leads if spec.resists else 0.0)
    k_t, (dry, viscous), (efficiency, idle) = motor["torque_constant"], friction(motor), gear_loss(gearhead)
    winding = Winding(cold, np.nan, k_t, motor["back_emf_constant"])
    speed, _ = operating_point(winding, feed.usable, dry + idle, viscous)
    stalled = np.fmin(feed.usable / cold, parts.controller["peak_current"])
    ratio = gearhead["ratio"] * belt
    held = np.maximum(k_t * stalled - dry - idle, 0.0) * ratio * efficiency * spec.belt_efficiency
    return {"free_speed": np.maximum(speed, 0.0) / ratio, "stall_torque": np.where(np.isnan(feed.usable), np.nan, held)}
