"""Parts of one drive over samples, a stepper or another: figures of the catalogue times their factors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import Catalog
from drivesizer.catalog.parts import BeltDrive
from drivesizer.catalog.tables import Table
from drivesizer.catalog.tolerances import Class
from drivesizer.catalog.view.mounted import OWN, STEPPER, has_steppers
from drivesizer.physics.drive_train import back_emf_constant, friction
from drivesizer.physics.figures import Figures
from drivesizer.physics.motor_demand import demands
from drivesizer.physics.power_stage import with_stage_losses
from drivesizer.physics.stepper import amplitude, copper_loss, idle_loss
from drivesizer.physics.thermal import rated_ambient, resistance_25, steady_winding_temperature
from drivesizer.physics.winding import Parts
from drivesizer.results.check_columns import CheckColumn
from drivesizer.results.drive_set import DriveParts
from drivesizer.search.columns.brakes import brake_limits
from drivesizer.search.columns.limits import motor_limits, unpowered_limits
from drivesizer.search.columns.offers import unknown_where_doubtful
from drivesizer.search.columns.stages import felt
from drivesizer.search.columns.steppers import (
    Draw,
    Frictionless,
    PullOut,
    drawn,
    driver_limits,
    ends_of,
    supply_limits,
    torque_limits,
)
from drivesizer.search.uncertainty.sampled_battery import AtSamples, Feeding
from drivesizer.search.uncertainty.uncertain_figures import holding
from drivesizer.spec.mounting import controller_needed
from drivesizer.spec.robot import RobotSpec

__all__ = [
    "Block", "PartFigures", "SetRows", "deviating_drive", "gearhead_times", "motor_times", "parts_of",
    "stepper_checks", "stepper_figures", "with_dry_share",
]  # fmt: skip


# -- Figures of one part over samples: a column where it is sampled, else a single one.


Array = NDArray[np.float64]
WHOLE = ("ratio", "inertia", "no_load_current", "friction_torque", "viscous_friction")  # never as a single figure


class PartFigures:
    """The figures of a part over samples: a column where it is sampled, else a single one."""

    def __init__(self, table: Table[Any], row: int, count: int, changed: Mapping[str, NDArray[Any]]) -> None:
        self.table, self.row, self.count = table, row, count
        self.taken: dict[str, NDArray[Any]] = dict(changed)

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self.taken:
            self.taken[name] = self.nominal(name, self.count if name in WHOLE else 1)
        return self.taken[name]

    def nominal(self, name: str, count: int = 1) -> NDArray[Any]:
        """Figure as the catalogue prints it."""
        column: NDArray[Any] = self.table[name]
        if self.row < 0:
            return np.full(count, np.nan if column.dtype.kind == "f" else "")
        return np.full(count, column[self.row])


def stepper_checks(
    spec: Any, at: AtSamples, parts: Parts, pull_out: PullOut, highest: float, listed: bool
) -> tuple[list[CheckColumn], Draw]:
    """The checks of a stepper in one load case, and the energy that its drives draw."""
    required = demands(at, Frictionless(parts.motor), parts.gearhead, parts.encoder, felt(at, parts))
    found = torque_limits(spec, at, required, parts, pull_out)
    found += unpowered_limits(spec, at, required, None, parts)  # type: ignore[arg-type]  # of a stepper no heat is known
    if parts.brake is not None:
        found += brake_limits(spec, at, parts, required, np.array([listed]))
    draw = drawn(spec, at, required, parts)
    rated = parts.motor.nominal("nominal_current")  # a driver's limits are of what it is set to
    return [
        *unknown_where_doubtful(found, required.complete),
        *driver_limits(rated, parts.controller, controller_needed(spec, 0.0), spec.environment.ambient),
        *motor_limits(spec, parts.motor),
        *supply_limits(spec, draw, parts, np.array([highest])),
    ], Draw(*(x * spec.load.alike for x in draw))


def stepper_figures(spec: Any, at: AtSamples, parts: Parts, pull_out: PullOut) -> dict[str, Array]:
    """Figures of a stepper in one load case."""
    required = demands(at, Frictionless(parts.motor), parts.gearhead, parts.encoder, felt(at, parts))
    torque, speed = (np.abs(x).max(axis=(1, 2)) for x in ends_of(at, required))
    at_rest, at_speed = (
        pull_out.torque(w[:, None], spec.supply.lowest)[:, 0] for w in (np.zeros_like(speed), speed)
    )  # fmt: skip
    duration = np.atleast_2d(at.load_cycle.duration.T)
    heated = (idle_loss(at.speeds, spec.control.idle_current).T * duration).sum(axis=1) / duration.sum(axis=1)
    return {
        "motor_torque": np.where(required.complete, torque, np.nan),
        "pull_out_at_rest": at_rest, "pull_out_at_speed": at_speed,
        "power": drawn(spec, at, required, parts).peak * spec.load.motors,
        "joule_heat": copper_loss(parts.motor["nominal_current"], parts.motor["resistance"]) * heated,
        "peak_current": amplitude(parts.motor["nominal_current"]),
    }  # fmt: skip


# -- Parts of one drive over samples: figures of the catalogue times their factors, and what a block of samples holds.
#
# Encoder and controller are those of the nominal drive, since they are bought once.


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


def motor_times(motor: Figures, factors: Mapping[str, Any]) -> dict[str, Any]:
    """Figures of a motor times the factors of their classes; heat capacities are not sampled.

    Torque and voltage constant have one factor: both deviate with the magnets' flux. Their difference, by saturation
    and losses, belongs to the type and is no tolerance of the single motor.
    """
    rubs, cooling, k = (factors.get(name, 1.0) for name in ("friction", "thermal_resistance", "torque_constant"))
    times = {
        "resistance": factors.get("resistance", 1.0), "torque_constant": k,
        "rotor_inertia": factors.get("rotor_inertia", 1.0),
        "no_load_current": rubs / k, "friction_torque": rubs, "viscous_friction": rubs,
        "thermal_resistance_winding": cooling, "thermal_resistance_housing": cooling,
        "winding_time_constant": cooling, "motor_time_constant": cooling,
    }  # fmt: skip
    found = {name: motor[name] * factor for name, factor in times.items()}
    return found | {"back_emf_constant": back_emf_constant(motor) * k} | with_dry_share(motor, factors)


def with_dry_share(motor: Figures, factors: Mapping[str, Any]) -> dict[str, Any]:
    """Friction of a motor whose dry share is sampled: at any speed, and per speed; nothing where it is not."""
    if "dry_friction" not in factors:
        return {}
    coulomb, viscous = friction(motor, factors["dry_friction"])
    factor = factors.get("friction", 1.0)
    return {"friction_torque": coulomb * factor, "viscous_friction": viscous * factor}


def stepper_times(motor: Figures, factors: Mapping[str, Any]) -> dict[str, Any]:
    """Figures of a stepper times their factors, with the current that its driver really gives."""
    current = factors.get("phase_current", 1.0)
    times = {name: factors.get(name, 1.0) for name in ("resistance", "inductance", "rotor_inertia", "start_speed")}
    times |= {"nominal_current": current, "holding_torque": factors.get("holding_torque", 1.0) * current}
    return {name: motor[name] * factor for name, factor in times.items()}


def gearhead_times(gearhead: Figures, factors: Mapping[str, Any]) -> dict[str, Any]:
    """Figures of a gearhead times their factors: that of its losses is of losses per transmitted torque, 1/e - 1."""
    found = {}
    if (losses := factors.get("efficiency")) is not None:
        found["efficiency"] = 1.0 / (1.0 + (1.0 / gearhead["efficiency"] - 1.0) * losses)
        found["no_load_torque"] = gearhead["no_load_torque"] * losses
    for figure, name in (("peak_torque", "intermittent_torque"), ("inertia", "inertia")):
        if figure in factors:
            found[name] = gearhead[name] * factors[figure]
    return found


def _motor(catalog: Catalog, row: int, block: Block, factors: Mapping[str, Array]) -> PartFigures:
    """A motor's figures over samples."""
    bought = PartFigures(catalog.motors, row, block.size, {})
    if has_steppers(catalog):
        return PartFigures(catalog.motors, row, block.size, {
            **stepper_times(bought, factors), STEPPER: bought.nominal(STEPPER, block.size)
        })  # fmt: skip
    changed = motor_times(bought, factors)
    rated = catalog.estimate_of("motors", row, "max_winding_temperature") is not None  # by its nominal current
    if rated and catalog.motors["kind"][row] != "brushed":
        changed["max_winding_temperature"] = np.ones(block.size) * steady_winding_temperature(
            rated_ambient(bought), resistance_25(bought), changed["thermal_resistance_winding"],
            changed["thermal_resistance_housing"], bought["nominal_current"],
        )  # fmt: skip
    return PartFigures(catalog.motors, row, block.size, changed)


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
    size, factors = block.size, block.factors_of(catalog, "motor", one.motor)
    if has_steppers(catalog):
        factors |= block.factors_of(catalog, "controller", one.controller)
        motor = _motor(catalog, one.motor, block, factors)
    else:
        motor = block.once(lambda: _motor(catalog, one.motor, block, factors), "motor", one.motor)

    def geared() -> PartFigures:
        bought = PartFigures(catalog.gearheads, one.gearhead, size, {})
        changed = gearhead_times(bought, block.factors_of(catalog, "gearhead", one.gearhead))
        return PartFigures(catalog.gearheads, one.gearhead, size, changed)

    gearhead = block.once(geared, "gearhead", one.gearhead)
    encoder = block.once(lambda: PartFigures(catalog.encoders, one.encoder, size, {}), "encoder", one.encoder)
    controller = block.once(lambda: _controller(catalog, one.controller, block), "controller", one.controller)
    brake = _brake(catalog, one.brake, block) if block.specs[0].wants_brake else None
    return Parts(motor, gearhead, encoder, controller, brake), factors


# -- A drive with the figures of one sample.


def deviating_drive(one: DriveParts, spec: RobotSpec, factors: Mapping[str, Mapping[str, float]]) -> DriveParts:
    """A drive whose figures deviate from those of the catalogue, by part and figure; by 1 where a factor is missing."""

    def varied(part: Any, figures: Mapping[str, Any]) -> Any:
        return replace(part, **{name: float(x) for name, x in figures.items()})

    of_motor, controller = factors["motor"], one.controller
    times = stepper_times(one.motor, {**of_motor, **factors["controller"]}) if one.steps else motor_times(
        one.motor, of_motor
    )  # fmt: skip
    if controller and "losses" in factors["controller"]:
        assume = spec.select.estimates == "on"
        controller = varied(controller, with_stage_losses(controller, factors["controller"]["losses"], assume=assume))
    return replace(
        one, motor=varied(one.motor, times), controller=controller, belt_efficiency=spec.belt_efficiency,
        gearhead=varied(one.gearhead, gearhead_times(one.gearhead, factors["gearhead"])),
    )  # fmt: skip
