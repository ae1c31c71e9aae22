"""One drive against every limit, sample by sample: the column code of the search with samples as columns.

The search has many drives over one load cycle, here is one drive over many: figures of its parts times factors, the
spec's figures as columns, the load cycle of each sample. Encoder and controller are those of the nominal drive, since
they are bought once.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from typing import Any, NamedTuple, TypeVar

import numpy as np

from drivesizer.catalog import Catalog
from drivesizer.catalog.parts import BeltDrive, Controller, Gearhead, Motor
from drivesizer.catalog.tables import Table
from drivesizer.catalog.tolerances import Class
from drivesizer.catalog.view import OWN, STEPPER, has_steppers
from drivesizer.files.yaml_source import Path_
from drivesizer.load_cases import load_cycle, platform
from drivesizer.loads.motions import Cam
from drivesizer.machine.battery import Feeding, columns_of, feeding
from drivesizer.machine.supply_power import Draw
from drivesizer.physics import thermal
from drivesizer.physics.at_voltage import Winding, operating_point
from drivesizer.physics.cycle_at_gearhead import ROUNDING, SPEED, AtGearhead, CycleAtBelt, Peak, bounded
from drivesizer.physics.drive_train import back_emf_constant, commutation, friction, motor_and_gears
from drivesizer.physics.figures import Alike, Array, Figures, Mask
from drivesizer.physics.load_cycle import LoadCycle
from drivesizer.physics.motor_demand import Demands, demands
from drivesizer.physics.power_stage import with_stage_losses
from drivesizer.physics.stepper import amplitude, copper_loss, idle_loss
from drivesizer.physics.winding import Parts, housing_loss, stress
from drivesizer.results.check_columns import CheckColumn, fits
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.problem import Problem
from drivesizer.search.columns import limits, steppers
from drivesizer.search.columns.brakes import brake_inertia, is_listed
from drivesizer.search.columns.candidates import Rows
from drivesizer.search.columns.limits_over_time import Bounds, InCase, exact, known_limits, least
from drivesizer.search.columns.shaft_limits import loads_on_gearheads, loads_on_motors
from drivesizer.search.columns.steppers import Frictionless, PullOut
from drivesizer.search.uncertainty.sampling import REPLICATES, first_of_each
from drivesizer.search.uncertainty.uncertain_figures import Assumption, applied, case_paths, enters_checks, holding
from drivesizer.spec.mounting import controller_needed, heat_of
from drivesizer.spec.robot import RobotSpec

Value = TypeVar("Value")
Part = TypeVar("Part", Motor, Gearhead, Controller)
_CELLS, _ROWS = 400_000, 16_384  # segments times samples of a block, and samples
_LONGEST = 2_000_000  # segments times samples, at most: of longer cycles there are fewer samples
_EACH, _LONGEST_EACH = 1024, 1_000_000  # cycles one by one, and their segments
_FEWEST = 32
_WHOLE = ("ratio", "inertia", "no_load_current", "friction_torque", "viscous_friction")  # never as a single figure
_MEMO_SIZE = 64  # parts, and limits of parts, that a block holds: some MB at most each
_ERROR = 1e-2  # of what a change within a segment does to the winding; the search has 0.1 %


# -- Load cycles of all samples: figures of load, motion and stages go through their laws as columns.
#
# What no column of numbers goes through is computed sample by sample: a platform on its path, a curve that is smoothed.


class _Case(NamedTuple):
    """One load case, or one wheel of a platform in it."""

    machine: int  # which of the load cases of the whole machine
    spec: RobotSpec  # as it is sized
    paths: dict[int, Path_]  # of the assumptions that count in it, by number
    cycle: LoadCycle  # of each sample, or one for all


class Prepared(NamedTuple):
    """The samples, which all drives have in common."""

    problem: Problem
    assumptions: tuple[Assumption, ...]
    values: Array  # (samples, assumptions); fewer than were drawn where load cycles are long
    cases: tuple[_Case, ...]

    @property
    def cells(self) -> int:
        """Segments times samples, of all load cases."""
        return sum(len(case.cycle.duration) * len(self.values) for case in self.cases)


def prepared(
    problem: Problem, assumptions: Sequence[Assumption], values: Array, *, all_samples: bool = False
) -> Prepared:
    """Samples of a machine, with their load cycles: fewer where these are long, unless ``all_samples``."""
    whole, counting, most = problem.machine, list[dict[int, Path_]](), len(values)
    for machine, numbers in enumerate(problem.machine_cases):
        paths = case_paths(whole, machine - 1 if machine else None)
        counting.append({k: path for k, path in paths.items() if k < len(assumptions)})
        case, shaping = problem.cases[numbers[0]], [path for path in counting[-1].values() if _shapes(path)]
        if shaping and not all_samples:
            few, longest = (_EACH, _LONGEST_EACH) if _one_by_one(case.spec, shaping) else (most, _LONGEST)
            most = min(most, few, longest // len(case.cycle.duration))
    if most < len(values) > _FEWEST:
        per_replicate = 2 ** int(np.log2(max(most, _FEWEST) // REPLICATES))
        values = values[first_of_each(REPLICATES * per_replicate, len(values))]
    cases: list[_Case] = []
    for machine, (paths, numbers) in enumerate(zip(counting, problem.machine_cases, strict=True)):
        columns = {path: values[:, k] - assumptions[k].nominal for k, path in paths.items() if _shapes(path)}
        specs = [problem.cases[number].spec for number in numbers]
        if isinstance(specs[0].load, platform.WheelLoad):
            of_machine = problem.machine.load_cases[machine][1]
            cases += [_Case(machine, spec, paths, cycle) for spec, cycle in _wheels(of_machine, specs, columns, values)]
        elif _one_by_one(specs[0], [*columns]):
            each_cycle = [
                load_cycle(applied(specs[0], differences)) for differences in _by_sample(columns, len(values))
            ]
            cases.append(_Case(machine, specs[0], paths, side_by_side(each_cycle)))
        else:
            cases.append(_Case(machine, specs[0], paths, load_cycle(applied(specs[0], columns), sampled=True)))
    return Prepared(problem, tuple(assumptions), values, tuple(cases))


def _shapes(path: Path_) -> bool:
    """Whether a figure makes the load cycle another."""
    return path[0] in ("load", "motion", "transmission", "platform") or path == ("environment", "gravity")


def _one_by_one(case: RobotSpec, paths: Sequence[Path_]) -> bool:
    """Whether some of the figures are such that no column goes through their law."""
    of_a_curve = isinstance(case.motion, Cam) and any(path[0] == "motion" for path in paths)
    return isinstance(case.load, platform.WheelLoad) or of_a_curve or ("load", "smoothing") in paths


def _by_sample(columns: Mapping[Path_, Array], samples: int) -> Iterator[dict[Path_, float]]:
    """Differences from nominal figures, by their place, sample by sample."""
    for row in range(samples):
        yield {path: float(column[row]) for path, column in columns.items() if column[row]}


def _wheels(
    machine: RobotSpec, specs: Sequence[RobotSpec], columns: Mapping[Path_, Array], values: Array
) -> Iterator[tuple[RobotSpec, LoadCycle]]:
    """Each driven wheel of a platform on its path, since deviations need not be the same for all, with its cycles."""
    nominal, wheel_cycles = platform.trajectory_of(machine), []
    planned = any(path[0] == "motion" or path[:2] == ("platform", "limits") for path in columns)
    for differences in _by_sample(columns, len(values)) if columns else [{}]:
        sample_spec = applied(machine, differences)
        trajectory = platform.trajectory_of(sample_spec) if planned else nominal
        assert trajectory is not None
        wheel_cycles.append(platform.cycles_of(sample_spec, platform.dynamics_of(sample_spec), trajectory))
    cycles = [side_by_side(several) for several in zip(*wheel_cycles, strict=True)]
    stages = {path: column for path, column in columns.items() if path[0] == "transmission"}
    for spec in specs:
        load = spec.load
        assert isinstance(load, platform.WheelLoad)
        for number in load.numbers:  # wheels that are alike at nominal figures
            alone = load.model_copy(update={"numbers": (number,)})
            moved_load = alone.model_copy(update={"cycle": cycles[number]})
            moved_spec = applied(spec.model_copy(update={"load": moved_load}), stages)
            yield spec.model_copy(update={"load": alone}), load_cycle(moved_spec, sampled=True)


def side_by_side(several: Sequence[LoadCycle]) -> LoadCycle:
    """Cycles as columns of one, the shorter ones filled up with segments that take no time."""
    longest, like = max(len(cycle.duration) for cycle in several), several[0]

    def column(name: str) -> Array:
        parts = []
        for cycle in several:
            values = getattr(cycle, name)
            last = np.zeros_like(values[-1:]) if name == "duration" else np.repeat(values[-1:, 1:], 2, axis=1)
            parts.append(np.concatenate([values, np.repeat(last, longest - len(values), axis=0)]))
        return np.ascontiguousarray(np.moveaxis(np.array(parts), 0, -1))

    own = []
    for n, own_limit in enumerate(like.own):
        demand, limit = (np.array([getattr(cycle.own[n], name) for cycle in several]) for name in ("demand", "limit"))
        own.append(own_limit._replace(demand=demand, limit=limit))
    inertia, radius, holding_torque = (
        np.array([getattr(c, name) for c in several]) for name in ("inertia", "radius", "holding_torque")
    )
    duration, speed, acceleration, torque = map(column, ("duration", "speed", "acceleration", "torque"))
    return LoadCycle(like.name, duration, speed, acceleration, torque, inertia, tuple(own), radius, holding_torque)


class AtSamples(AtGearhead):
    """The load cycles of samples at the gearhead's output, behind one belt; samples along the last axis.

    Peaks are those of each sample's own cycle, so that every end of every segment counts, not a few extreme ones.
    """

    def __init__(self, base: CycleAtBelt, ratio: float) -> None:
        super().__init__(base, ratio)
        self.active = np.flatnonzero(base.acts).tolist()
        segments = {k: np.flatnonzero(base.functions[k].any(axis=(1, 2))) for k in self.active}
        self.where = {k: (int(rows[0]), int(rows[-1]) + 1) for k, rows in segments.items()}  # where each is not 0

    def slope(self, c: Array) -> Array:
        """Half of the gradient of the mean square of c f(t), by each coefficient: shape (samples, 6)."""
        return ((c * self.scale)[:, None] @ np.moveaxis(self.base.moments, -1, 0))[:, 0] * self.scale

    def mean_with(self, c: Array, function: int) -> Array:
        """Mean over each sample's cycle of c f(t) times one of the functions; c of shape (samples, 6)."""
        return ((c * self.scale).T * self.base.moments[:, function]).sum(axis=0) * self.scale[function]

    def line(self, c: Array) -> Array:
        """The sum c f(t) at both ends of each segment, shape (segments, 2, samples); c of shape (samples, 6)."""
        functions = self.base.functions
        line = np.zeros((*functions.shape[1:3], max(len(c), functions.shape[-1])))
        term, columns = np.empty_like(line), np.ascontiguousarray(c.T)
        for k, (first, last) in self.where.items():
            line[first:last] += np.multiply(columns[k] * self.scale[k], functions[k, first:last], out=term[first:last])
        return line

    def peak(self, coefficients: Array, left_out: Mask | None = None) -> Peak:
        """Largest absolute value of c f(t) over each sample's cycle; the moments are not needed."""
        line = self.line(coefficients)
        magnitude = np.abs(line)
        if left_out is not None:
            for k in np.flatnonzero(left_out.any(axis=0)):
                f = self.base.functions[k]
                against = left_out[:, k] & (line * f < 0.0) & (np.abs(f) > ROUNDING * np.abs(f).max())
                magnitude = np.where(against, -np.inf, magnitude)
        value = magnitude.max(axis=(0, 1))
        return bounded(value, np.broadcast_to(np.nan, value.shape), left_out)

    @cached_property
    def speeds(self) -> Array:
        """Speed at the gearhead's output, at both ends of each segment [rad/s]: shape (segments, 2, samples)."""
        return self.base.functions[SPEED] * self.belt


# -- Samples in blocks, ready for any drive with any of some belt ratios.


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
    specs: tuple[RobotSpec, ...]  # with columns
    ats: tuple[Mapping[float, AtSamples], ...]  # by belt ratio
    feeds: tuple[tuple[Feeding, tuple[int, ...]], ...]  # batteries, each with the cases that draw from it
    factors: Mapping[Class, Array]  # of the catalogue's figures
    spec_classes: Mapping[tuple[str, str], str]  # the spec's own classes, before any other
    belts: Mapping[float, BeltDrive | None]  # by ratio, where they are out of the catalogues
    memo: dict[Hashable, Alike]  # of parts that were looked at: many drives have the same

    def factors_of(self, catalog: Catalog, part: str, row: int) -> dict[str, Array]:
        """Factors of the figures of a part that are sampled, by figure."""
        own = self.once(lambda: holding(catalog, self.spec_classes, part, row), "classes", part, row)
        return {tolerance.figure: self.factors[tolerance] for tolerance in own if tolerance in self.factors}

    def once(self, make: Callable[[], Value], *name: Hashable) -> Value:
        """A figure made of some parts, the first time that its name is used; of the last ones it stays."""
        if name not in self.memo:
            if len(self.memo) >= _MEMO_SIZE:
                self.memo.clear()
            self.memo[name] = make()
        return self.memo[name]


def blocks(samples: Prepared, catalog: Catalog, belts: Sequence[float]) -> Iterator[Block]:
    """The samples in blocks, ready for drives with any of some belt ratios."""
    longest = max(len(case.cycle.duration) for case in samples.cases)
    size = int(np.clip(_CELLS // longest, 64, _ROWS))
    for first in range(0, len(samples.values), size):
        rows = np.arange(first, min(first + size, len(samples.values)))
        specs, ats = [], []
        for case in samples.cases:  # with columns in place of the figures that enter checks
            columns = {k: path for k, path in case.paths.items() if enters_checks(path)}
            differences = {
                path: samples.values[rows, k] - samples.assumptions[k].nominal for k, path in columns.items()
            }
            spec = applied(case.spec, differences)
            base = CycleAtBelt(case.cycle.on(rows), spec.belt_efficiency)
            specs.append(spec)
            ats.append({belt: AtSamples(base, belt) for belt in belts})
        feeds = []
        for machine in sorted(
            {case.machine for case in samples.cases}
        ):  # all cases that draw from one battery together
            numbers = tuple(n for n, case in enumerate(samples.cases) if case.machine == machine)
            if (rated := samples.cases[numbers[0]].spec.battery) is not None:
                feeds.append((feeding(specs[numbers[0]], rated, catalog), numbers))
        factors = {
            assumption.catalogue: np.ascontiguousarray(samples.values[rows, k])
            for k, assumption in enumerate(samples.assumptions) if assumption.catalogue
        }  # fmt: skip
        known = {belt: samples.problem.belt_drive(belt) for belt in belts}
        yield Block(
            len(rows),
            tuple(specs),
            tuple(ats),
            tuple(feeds),
            factors,
            samples.problem.spec.tolerances.classes,
            known,
            {},
        )


# -- Figures of parts times the factors of their tolerances, of samples as of one drive.


def motor_times(motor: Figures, factors: Mapping[str, Alike]) -> dict[str, Alike]:
    """Figures of a motor times the factors of their classes; heat capacities are not sampled.

    Torque and voltage constant have one factor: both deviate with the magnets' flux. Their difference, by saturation
    and losses, belongs to the type and is no tolerance of the single motor.
    """
    rubs, cooling, k = (factors.get(name, 1.0) for name in ("friction", "thermal_resistance", "torque_constant"))
    times = {
        "resistance": factors.get("resistance", 1.0), "torque_constant": k,
        "rotor_inertia": factors.get("rotor_inertia", 1.0), "inductance": factors.get("commutation", 1.0),
        "no_load_current": rubs / k, "friction_torque": rubs, "viscous_friction": rubs,
        "thermal_resistance_winding": cooling, "thermal_resistance_housing": cooling,
        "winding_time_constant": cooling, "motor_time_constant": cooling,
    }  # fmt: skip
    figures = {name: motor[name] * factor for name, factor in times.items()}
    return figures | {"back_emf_constant": back_emf_constant(motor) * k} | with_dry_share(motor, factors)


def with_dry_share(motor: Figures, factors: Mapping[str, Alike]) -> dict[str, Alike]:
    """Friction of a motor whose dry share is sampled: at any speed, and per speed; nothing where it is not."""
    if "dry_friction" not in factors:
        return {}
    coulomb, viscous = friction(motor, factors["dry_friction"])
    factor = factors.get("friction", 1.0)
    return {"friction_torque": coulomb * factor, "viscous_friction": viscous * factor}


def stepper_times(motor: Figures, factors: Mapping[str, Alike]) -> dict[str, Alike]:
    """Figures of a stepper times their factors, with the current that its driver really gives."""
    current = factors.get("phase_current", 1.0)
    times = {name: factors.get(name, 1.0) for name in ("resistance", "inductance", "rotor_inertia", "start_speed")}
    times |= {"nominal_current": current, "holding_torque": factors.get("holding_torque", 1.0) * current}
    return {name: motor[name] * factor for name, factor in times.items()}


def gearhead_times(gearhead: Figures, factors: Mapping[str, Alike]) -> dict[str, Alike]:
    """Figures of a gearhead times their factors: that of its losses is of losses per transmitted torque, 1/e - 1."""
    figures = {}
    if (losses := factors.get("efficiency")) is not None:
        figures["efficiency"] = 1.0 / (1.0 + (1.0 / gearhead["efficiency"] - 1.0) * losses)
        figures["no_load_torque"] = gearhead["no_load_torque"] * losses
    if "inertia" in factors:
        figures["inertia"] = gearhead["inertia"] * factors["inertia"]
    return figures


def _sampled(table: Table[Any], row: int, count: int, changed: Mapping[str, Array] | None = None) -> Rows:
    """Figures of a part over samples: a column where it is sampled, else a single one."""
    part = Rows(table, np.array([row]))
    part.columns |= {name: np.repeat(part[name], count) for name in _WHOLE if name in table.columns} | {
        **(changed or {})
    }
    return part


class _Drive(NamedTuple):
    """A drive over samples."""

    parts: Parts
    printed: Rows  # its motor as the catalogue has it: friction that holds is that
    factors: Mapping[str, Array]  # of its motor's figures; of a stepper its driver's as well
    pull_out: PullOut | None  # of a stepper
    highest: Array  # V, that the maker of a stepper permits; NaN none
    listed: Mask  # whether its brake goes with its motor


def _drive(catalog: Catalog, rows: SetRows, block: Block) -> _Drive:
    """A drive with the figures of its parts, each times its factor."""
    size, steps, spec = block.size, has_steppers(catalog), block.specs[0]
    printed, factors = _sampled(catalog.motors, rows.motor, size), block.factors_of(catalog, "motor", rows.motor)
    if steps:
        factors |= block.factors_of(catalog, "controller", rows.controller)

    def motor() -> Rows:
        if steps:
            own = {**stepper_times(printed, factors), STEPPER: np.repeat(printed[STEPPER], size)}
            return _sampled(catalog.motors, rows.motor, size, own)
        changed = motor_times(printed, factors)
        rated = catalog.estimate_of("motors", rows.motor, "max_winding_temperature") is not None  # by nominal current
        if rated and printed["kind"][0] != "brushed":
            changed["max_winding_temperature"] = np.ones(size) * thermal.steady_winding_temperature(
                thermal.rated_ambient(printed), thermal.resistance_25(printed), changed["thermal_resistance_winding"],
                changed["thermal_resistance_housing"], printed["nominal_current"],
            )  # fmt: skip
        return _sampled(catalog.motors, rows.motor, size, changed)

    def gearhead() -> Rows:
        bought = _sampled(catalog.gearheads, rows.gearhead, size)
        times = block.factors_of(catalog, "gearhead", rows.gearhead)
        changed = gearhead_times(bought, times)
        if "peak_torque" in times:
            changed["intermittent_torque"] = bought["intermittent_torque"] * times["peak_torque"]
        return _sampled(catalog.gearheads, rows.gearhead, size, changed)

    def controller() -> Rows:
        bought = _sampled(catalog.controllers, rows.controller, size)
        if (factor := block.factors_of(catalog, "controller", rows.controller).get("losses")) is not None:
            bought.columns |= with_stage_losses(bought, factor, assume=spec.select.estimates == "on")
        return bought

    brake, own = None, dict[str, Array]()
    if spec.wants_brake:  # one that is the spec's own has its tolerances
        if spec.brake is not None and rows.brake >= 0 and catalog.brakes["family"][rows.brake] == OWN:
            own = {name: x for name, x in spec.brake.figures.items() if np.ndim(x)}
        brake = _sampled(catalog.brakes, rows.brake, size, own)
    parts = Parts(
        motor() if steps else block.once(motor, "motor", rows.motor),
        block.once(gearhead, "gearhead", rows.gearhead),
        block.once(lambda: _sampled(catalog.encoders, rows.encoder, size), "encoder", rows.encoder),
        block.once(controller, "controller", rows.controller),
        brake,
    )
    pull_out = PullOut(parts.motor, catalog.pull_outs, factors.get("pull_out", 1.0)) if steps else None
    highest = catalog.steppers["supply_max"][catalog.motors[STEPPER][[rows.motor]]] if steps else np.full(1, np.nan)
    listed = np.array([is_listed(catalog, rows.motor, rows.brake)])
    return _Drive(parts, printed, factors, pull_out, highest, listed)


def deviating_drive(drive: DriveParts, spec: RobotSpec, factors: Mapping[Class, float]) -> DriveParts:
    """A drive whose figures deviate from those of the catalogue by the factors of their classes."""
    of_motor, of_gearhead, of_controller = (
        {tolerance.figure: factor for tolerance, factor in factors.items() if tolerance.part == part}
        for part in ("motor", "gearhead", "controller")
    )

    def varied(part: Part, figures: Mapping[str, Alike]) -> Part:
        return replace(part, **{name: float(x) for name, x in figures.items()})

    times = stepper_times(drive.motor, of_motor | of_controller) if drive.steps else motor_times(drive.motor, of_motor)
    controller = drive.controller
    if controller and "losses" in of_controller:
        assume = spec.select.estimates == "on"
        controller = varied(controller, with_stage_losses(controller, of_controller["losses"], assume=assume))
    return replace(
        drive, motor=varied(drive.motor, times), controller=controller, belt_efficiency=spec.belt_efficiency,
        gearhead=varied(drive.gearhead, gearhead_times(drive.gearhead, of_gearhead)),
    )  # fmt: skip


# -- Every check of a drive over samples.


def checks_of(catalog: Catalog, rows: SetRows, block: Block) -> dict[str, CheckColumn]:
    """Every check that samples may change, by name: columns over the samples, the worst of all load cases."""
    sampled_drive = _drive(catalog, rows, block)
    motor, gearhead = sampled_drive.parts.motor, sampled_drive.parts.gearhead
    by_case, draws = list[list[CheckColumn]](), list[Draw]()

    def geared(spec: RobotSpec, at: AtSamples, drive: BeltDrive | None) -> list[CheckColumn]:
        return limits.gearhead_limits(spec, at, gearhead) + loads_on_gearheads(spec, at, drive, gearhead)

    for number, (spec, ats) in enumerate(zip(block.specs, block.ats, strict=True)):
        at, drive = ats[rows.belt], block.belts[rows.belt]
        of_case = _servo_checks if sampled_drive.pull_out is None else _stepper_checks
        checks, draw = of_case(spec, at, sampled_drive, bool(block.feeds))
        checks += limits.motor_limits(spec, motor)
        if rows.controller >= 0 or sampled_drive.pull_out is None:
            checks.append(_controller_fits(spec, sampled_drive.parts.controller, rows))
        checks += block.once(partial(limits.load_limits, spec, at, drive), "load limits", number, rows.belt)
        names = "gearhead limits", number, rows.gearhead, rows.belt
        checks += block.once(partial(geared, spec, at, drive), *names)
        if spec.shaft:
            checks += loads_on_motors(spec, at, drive, motor, gearhead)
        by_case.append(checks)
        draws.append(draw)
    for feeds, numbers in block.feeds:
        first, battery_draws = numbers[0], [draws[number] for number in numbers]
        by_case[first] += columns_of(block.specs[first], feeds, block.ats[first][rows.belt].load_cycle, battery_draws)
    return {check.name: check for check in limits.worst_of_all(by_case)}


def _controller_fits(spec: RobotSpec, controller: Figures, rows: SetRows) -> CheckColumn:
    """Whether the chosen controller permits the supply's voltages."""
    lowest, highest = np.asarray(spec.supply.lowest), np.asarray(spec.supply.highest)
    good = (controller["supply_min"] <= lowest) & (controller["supply_max"] >= highest) & (rows.controller >= 0)
    known = rows.controller < 0 or ~np.isnan(controller["supply_min"] + controller["supply_max"])
    return fits("controller_available", good, known)


def _loaded(spec: RobotSpec, at: AtSamples, drive: _Drive, *, energies: bool) -> tuple[InCase, Bounds]:
    """Demands and heat of a drive over the samples of a load case, and bounds of what needs the waveform."""
    parts, ambient = drive.parts, spec.environment.ambient
    required = demands(at, parts.motor, parts.gearhead, parts.encoder, brake_inertia(parts, at.belt))
    brushed = drive.printed["kind"][0] == "brushed"
    motor, factor = parts.motor, 1.0 if brushed else drive.factors.get("friction", 1.0)
    if not brushed:  # in the iron by the printed figures, times the factor of friction
        shared = {name: x for name, x in drive.factors.items() if name == "dry_friction"}
        motor = _sampled(drive.printed.table, int(drive.printed.rows[0]), 1, with_dry_share(drive.printed, shared))
    rubbing, iron = housing_loss(motor, required.total_ratio)
    losses = rubbing * factor, iron * factor
    warmth = heat_of(spec, at, required, parts.motor, parts.gearhead, losses)
    leads = spec.feed(parts.controller, parts.brake).leads if spec.resists else 0.0
    peaks = stress(ambient, at, required, parts.motor, leads)
    case = InCase(spec, at, required, warmth, peaks)
    return case, least(exact(case, parts, "all" if energies else "limits", _ERROR, (1.0, 1.0)), case)


def _servo_checks(spec: RobotSpec, at: AtSamples, drive: _Drive, energies: bool) -> tuple[list[CheckColumn], Draw]:
    """The checks of one load case that hang on a motor with a controller, and the energy that its drives draw."""
    parts, (case, over_time) = drive.parts, _loaded(spec, at, drive, energies=energies)
    required = case.demand
    moving = limits.moving_limits(spec, at, required, case.heating, parts, drive.listed, drive.printed)
    checks = [
        *(check for check in moving if check.name != "winding_temperature"),  # that of the mean
        *limits.electrical_limits(spec, at, required, case.stresses, parts),
        *known_limits(case, over_time, parts),
    ]
    sets = spec.load.alike if required.complete.all() else np.nan  # lower bounds are not energies
    draw = over_time[0].agreed(over_time[1])
    return checks, Draw(draw.drawn * sets, draw.returned * sets, draw.power * sets)


def _stepper_demands(at: AtSamples, parts: Parts) -> Demands:
    """Demands at a stepper's shaft: its own friction is in its pull-out torque."""
    return demands(at, Frictionless(parts.motor), parts.gearhead, parts.encoder, brake_inertia(parts, at.belt))


def _stepper_checks(spec: RobotSpec, at: AtSamples, drive: _Drive, _: bool) -> tuple[list[CheckColumn], Draw]:
    """The same of a stepper."""
    parts = drive.parts
    assert drive.pull_out is not None
    required = _stepper_demands(at, parts)
    draw, rated = steppers.draw_of(spec, at, required, parts), drive.printed["nominal_current"]
    needed, ambient = controller_needed(spec, 0.0), spec.environment.ambient
    return [
        *limits.moving_limits(spec, at, required, None, parts, drive.listed, parts.motor),
        *steppers.torque_limits(spec, at, required, parts, drive.pull_out),
        *steppers.driver_limits(rated, parts.controller, needed, ambient),  # of what the driver is set to
        *steppers.supply_limits(spec, draw, parts, drive.highest),
    ], Draw(*(x * spec.load.alike for x in draw))


# -- Figures of a drive over the same samples, in each sample of its worst load case.


_LEAST = ("free_speed", "stall_torque", "pull_out_at_rest", "pull_out_at_speed")  # the worst load case has the smallest


def figure_columns(catalog: Catalog, rows: SetRows, block: Block) -> dict[str, Array]:
    """Figures of a drive, sample by sample: current, voltage, power, heat, temperature, free speed, stall torque."""
    drive, figures = _drive(catalog, rows, block), dict[str, Array]()
    for spec, ats in zip(block.specs, block.ats, strict=True):
        of_case = _servo_figures if drive.pull_out is None else _stepper_figures
        for name, column in of_case(spec, ats[rows.belt], drive).items():
            values = np.array(np.broadcast_to(column, block.size))
            worse = np.minimum if name in _LEAST else np.maximum
            figures[name] = worse(figures[name], values) if name in figures else values
    return figures


@np.errstate(divide="ignore", invalid="ignore")
def _servo_figures(spec: RobotSpec, at: AtSamples, drive: _Drive) -> dict[str, Alike]:
    """Figures that the load cycle makes, unknown where only a least demand is known; and those at the supply alone."""
    case, (low, high) = _loaded(spec, at, drive, energies=True)
    known, over_time = case.demand.complete, low.agreed(high)
    figures = {
        "rms_current": case.demand.rms_current, "peak_current": case.stresses.current.value,
        "voltage": over_time.voltage, "power": over_time.power * spec.load.motors,
        "joule_heat": np.where(np.isnan(over_time.winding), np.nan, over_time.copper),  # bounds of it are not kept
        "winding_temperature": over_time.winding,
    }  # fmt: skip
    columns = {name: np.where(known, column, np.nan) for name, column in figures.items()}
    motor, gearhead = drive.parts.motor, drive.parts.gearhead
    feed = spec.feed(drive.parts.controller, drive.parts.brake)._replace(voltage=spec.supply.nominal)
    cold = thermal.resistance_at(thermal.resistance_25(motor), spec.environment.ambient)  # winding at the ambient
    cold = cold + (feed.leads if spec.resists else 0.0)
    own = motor_and_gears(motor, gearhead)
    winding, rubs = Winding(cold, np.nan, own.k_t, own.k_e, commutation(motor)), own.coulomb + own.idle
    speed, _ = operating_point(winding, feed.usable, rubs, own.viscous)
    stalled = np.fmin(feed.usable / cold, drive.parts.controller["peak_current"])
    ratio = own.ratio * at.belt
    stall_torque = np.maximum(own.k_t * stalled - rubs, 0.0) * ratio * own.efficiency * spec.belt_efficiency
    columns["free_speed"] = np.maximum(speed, 0.0) / ratio
    columns["stall_torque"] = np.where(np.isnan(feed.usable), np.nan, stall_torque)
    return columns


def _stepper_figures(spec: RobotSpec, at: AtSamples, drive: _Drive) -> dict[str, Alike]:
    """Figures of a stepper in one load case."""
    parts, pull_out = drive.parts, drive.pull_out
    assert pull_out is not None
    required = _stepper_demands(at, parts)
    torque, speed = (np.abs(x).max(axis=(1, 2)) for x in steppers.ends_of(at, required))
    at_rest, at_speed = (
        pull_out.torque(w[:, None], spec.supply.lowest)[:, 0] for w in (np.zeros_like(speed), speed)
    )  # fmt: skip
    duration = np.atleast_2d(at.load_cycle.duration.T)
    heated = (idle_loss(at.speeds, spec.control.idle_current).T * duration).sum(axis=1) / duration.sum(axis=1)
    return {
        "motor_torque": np.where(required.complete, torque, np.nan),
        "pull_out_at_rest": at_rest, "pull_out_at_speed": at_speed,
        "power": steppers.draw_of(spec, at, required, parts).peak * spec.load.motors,
        "joule_heat": copper_loss(parts.motor["nominal_current"], parts.motor["resistance"]) * heated,
        "peak_current": amplitude(parts.motor["nominal_current"]),
    }  # fmt: skip
