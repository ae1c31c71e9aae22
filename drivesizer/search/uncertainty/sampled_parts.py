"""Parts of one drive over samples: figures of the catalogue times their factors, and what a block of samples holds.

Encoder and controller are those of the nominal drive, since they are bought once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.belt_drive import BeltDrive
from drivesizer.catalog.tolerances.classes import Class
from drivesizer.catalog.view.own_brake import OWN
from drivesizer.catalog.view.stepper_view import has_steppers
from drivesizer.physics.drive_train import back_emf_constant, friction
from drivesizer.physics.power_stage import with_stage_losses
from drivesizer.physics.stress import Parts
from drivesizer.physics.thermal import rated_ambient, resistance_25, steady_winding_temperature
from drivesizer.search.uncertainty.class_of_part import holding
from drivesizer.search.uncertainty.part_figures import WHOLE, PartFigures
from drivesizer.search.uncertainty.sampled_battery import Feeding
from drivesizer.search.uncertainty.sampled_cycle import AtSamples
from drivesizer.search.uncertainty.sampled_steppers import stepper_motor

__all__ = ["Block", "SetRows", "motor_factors", "parts_of", "with_dry_share", "with_losses"]

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
    """Friction of a motor whose dry share is sampled: at any speed, and per speed; nothing where it is not."""
    if "dry_friction" not in factors:
        return {}
    coulomb, viscous = friction(motor, factors["dry_friction"])
    factor = factors.get("friction", 1.0)
    return {"friction_torque": coulomb * factor, "viscous_friction": viscous * factor}


def with_losses(efficiency: Any, factor: Any) -> Any:
    """Efficiency with losses per transmitted torque, 1/e - 1, times a factor; it stays within 0 to 1."""
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
    """The parts of a drive over samples, and the factors of its motor; of a stepper its driver's as well."""
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
