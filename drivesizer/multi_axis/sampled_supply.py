"""Limits of a machine's common supply over samples of all uncertain figures: probability that none is exceeded.

Each sample is the whole machine: load cycles, drives and their courses of power are computed anew and summed up as at
nominal figures, with the drives and the brake resistor that were chosen there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.errors import FieldError
from drivesizer.multi_axis.common_supply import AxisPower, common_supply
from drivesizer.multi_axis.uncertain_axes import uncertain_machine
from drivesizer.results.check import Check
from drivesizer.results.check_columns import at_least
from drivesizer.results.check_kinds import CHECKS
from drivesizer.results.machine_power import MachinePower
from drivesizer.results.reliability import FigureSpread, Reliability
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.search.uncertainty.probabilities import Over, over_samples, quantiles, reduced
from drivesizer.search.uncertainty.sampling import sample
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.several_axes.machine import MachineSpec

__all__ = ["with_samples"]

_MOST = 256  # samples, each of which takes as long as the nominal machine
_CYCLE = "machine_cycle"
_FIGURES = {
    "supply_peak": ("Power out of the supply, largest", "power", "W", "peak"),
    "supply_mean": ("Power out of the supply, mean", "power", "W", "mean"),
    "energy_left": ("Regenerated energy per cycle that no axis draws", "energy", "J", "energy_left"),
}
_NOMINAL = (
    "carried masses, brake resistor, power supply, the paths of platforms and the voltage that the current of all axes "
    "takes of a motor are those of nominal figures"
)


def with_samples(
    machine: MachineSpec,
    shared: RobotSpec,
    catalog: Catalog,
    axes: Sequence[AxisPower],
    power: MachinePower,
    how: Sampling,
) -> MachinePower:
    """The power of a machine with the probability that no limit of its supply is exceeded."""
    one = uncertain_machine(machine, _as_chosen(shared, power), axes)
    drawn = sample(one.given, min(how.samples, _MOST), how.seed)
    found = [_sample_checks(machine, catalog, *one.at(values)) for values in drawn.values]
    names = dict.fromkeys([check.name for check in power.checks] + [name for checks, _ in found for name in checks])
    every: dict[str, Over] = {name: over_samples([checks.get(name) for checks, _ in found]) for name in names}
    titles = {name: _title(name) for name in names}
    spreads = tuple(_spread(name, [figures[name] for _, figures in found]) for name in _FIGURES)
    reliability = replace(reduced(every, titles).reliability, figures=spreads)
    said = f"over tolerances: {drawn.size} samples of the machine; drives of all axes deviate alike; {_NOMINAL}"
    checks = (*power.checks, *_required(how.confidence, reliability))
    return replace(power, reliability=reliability, checks=checks, assumptions=(*power.assumptions, said))


def _as_chosen(shared: RobotSpec, power: MachinePower) -> RobotSpec:
    """The shared sections with the brake resistor that was chosen; without one where none is needed."""
    section, chosen = shared.brake_resistor, power.braking.resistor if power.braking else None
    if section is None or section.resistance is not None:
        return shared
    if chosen is not None:
        section = section.model_copy(update={"family": None, "part": [chosen.part]})
        section._may_be_none = False
    elif any(check.name == "resistor_available" for check in power.checks):
        return shared
    kept = section if chosen is not None else None
    return shared.changed(lambda spec: spec.model_copy(update={"brake_resistor": kept}))


def _sample_checks(
    machine: MachineSpec, catalog: Catalog, shared: RobotSpec, axes: Sequence[AxisPower]
) -> tuple[dict[str, Check], dict[str, float]]:
    """Checks and figures of a sample by name; a motion that is longer than the machine's cycle fails."""
    try:
        power = common_supply(shared, catalog, axes, synchronised=machine.synchronised, cycle_time=machine.cycle_time)
    except FieldError:
        late = at_least(_CYCLE, 1.0, 0.0).at((), "budget")
        return {_CYCLE: late}, dict.fromkeys(_FIGURES, float("nan"))
    checks = {check.name: check for check in power.checks if not check.advice}
    return checks, {name: getattr(power, field) for name, (*_, field) in _FIGURES.items()}


def _title(name: str) -> str:
    return CHECKS["budget"][name].title


def _spread(name: str, values: Sequence[float]) -> FigureSpread:
    title, kind, unit, _ = _FIGURES[name]
    low, middle, high = quantiles(np.array(values))
    return FigureSpread(name=name, title=title, kind=kind, unit=unit, low=low, middle=middle, high=high)


def _required(confidence: float | None, found: Reliability) -> tuple[Check, ...]:
    """The check of a required confidence; its margin is none of the load."""
    if confidence is None:
        return ()
    return (at_least("supply_confidence", confidence, found.probability, by_choice=True).at((), "budget"),)
