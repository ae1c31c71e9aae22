"""An encoder and a holding brake for every candidate at once: of those that go with its motor one that does."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from drivesizer.catalog import EDGES, Catalog, lines
from drivesizer.catalog.view import OWN
from drivesizer.physics.braking import SLIPPING, Stop, held_by_brake, held_by_friction, stop
from drivesizer.physics.cycle_at_gearhead import AtGearhead
from drivesizer.physics.drive_train import drive_inertia
from drivesizer.physics.figures import Alike, Array, Figures, Mask, Range, Whole
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.winding import Parts
from drivesizer.results.check_columns import PROPOSAL, CheckColumn, Options, at_least, at_most, fits
from drivesizer.results.problem import Problem
from drivesizer.results.ratings import coil_voltage
from drivesizer.search.columns.candidates import FREE, LAST, Rows, figure_order, summed_share
from drivesizer.spec.robot import RobotSpec

# -- An encoder for every candidate at once: of those that meet the requirements one whose own limits are known to hold.
#
# Before all goes what is known of their speed and frequency at the candidate's highest speed: known to hold, then
# unknown, then failing; then what they add to the objective, their counts and their part numbers. Where a drive fails
# with the best, one that is easier to turn may do. Where neither counts nor a resolution, family or part are required,
# the encoder is a proposal and its figures are advice.


class EncoderOffers(NamedTuple):
    """Encoders of each motor, by counts and part number: rows are motors; where there are fewer, row -1 at the end."""

    row: Whole
    counts: Array  # lines per turn; NaN unknown
    fastest: Array  # rad/s that no known limit of theirs forbids; infinite where none is known
    known: Mask  # whether all of their limits are known
    worth: Array  # what each adds to the objective, less is better
    inertia: Array  # kg*m^2, as it counts: 0 where it is unknown
    last: Whole  # the one with the most counts, -1 where there is none
    least: float  # counts that are required; 0 where none are
    enough: Mask  # which have so many


def angle_per_edge(counts: Alike, reduction: Alike) -> Alike:
    """Angle of the load per edge of an encoder at the motor."""
    return 2 * np.pi / (EDGES * counts * reduction)


def offered_encoders(spec: RobotSpec, catalog: Catalog) -> EncoderOffers:
    """The encoders that fit each motor and that the spec allows."""
    choice, needed = spec.select.encoder, spec.needs.encoder_counts

    def offers() -> EncoderOffers:
        table, counted = catalog.encoders, lines(catalog.encoders)
        listed = np.zeros((len(catalog.motors), len(table)), bool)
        listed[catalog.motor_encoder.left, catalog.motor_encoder.right] = True
        row = _first_of_each(listed & table.named(choice.named), figure_order(table, counted))
        number = (row >= 0).sum(axis=1)
        last = np.where(number > 0, row[np.arange(len(row)), np.maximum(number - 1, 0)], -1)
        by_frequency = table["max_frequency"] * 2 * np.pi / counted
        known = ~np.isnan(table["max_speed"] + by_frequency)
        fastest = np.nan_to_num(np.fmin(table["max_speed"], by_frequency), nan=np.inf)
        inertia = np.nan_to_num(table["inertia"])
        worth = summed_share(spec, table.changed({"inertia": inertia}), catalog)
        worth += np.where(np.isnan(table["inertia"]), 2.0 * LAST, 0.0)  # left out of the drive where it is unknown
        least = float(max(needed or 0, choice.min_counts or 0))
        counts = np.append(counted, np.nan)[row]
        return EncoderOffers(
            row, counts, np.append(fastest, np.nan)[row], np.append(known, False)[row], np.append(worth, np.inf)[row],
            np.append(inertia, 0.0)[row], last, least, (counts >= least) & (row >= 0),
        )  # fmt: skip

    return catalog.once(("encoders", repr(choice), needed, repr(spec.select.objective)), offers)


def _first_of_each(fitting: Mask, order: Whole) -> Whole:
    """Rows of the parts that fit each motor, in an order of all or of each: where there are fewer, -1 at the end."""
    if not fitting.size:
        return np.full((len(fitting), 1), -1)
    order = np.broadcast_to(order, fitting.shape)
    in_order = np.take_along_axis(fitting, order, axis=1)
    number = fitting.sum(axis=1)
    place = np.argsort(~in_order, axis=1, kind="stable")[:, : max(int(number.max(initial=0)), 1)]
    there = np.arange(place.shape[1]) < number[:, None]
    return np.where(there, np.take_along_axis(order, place, axis=1), -1)


def encoders_for(
    spec: RobotSpec, offered: EncoderOffers, motor: Whole, speed: Array, reduction: Array, below: Array | float = np.inf
) -> tuple[Whole, Array]:
    """Row of each candidate's encoder, -1 where none is listed for its motor, and its inertia where one is easier to
    turn, else 0.

    Notes
    -----
    Where none has counts enough it is the one with the most, so that its check can say by how much it falls short.
    ``below``: inertia of the encoders that are left [kg*m^2].
    """
    fastest, worth, speed = offered.fastest[motor], offered.worth[motor], np.asarray(speed)[:, None]
    enough, finest, holds = offered.enough[motor], spec.needs.resolution_at_load, speed <= fastest
    if finest is not None:
        geared = reduction if spec.gear is None else reduction * spec.gear.ratio
        edge = angle_per_edge(offered.counts[motor], geared[:, None])
        enough &= edge <= finest
    good = np.where(enough, np.int8(1) + holds + (holds & offered.known[motor]), 0)
    if "margin" in spec.select.weights and spec.wants_encoder:
        with np.errstate(divide="ignore", invalid="ignore"):
            own = fastest / speed if finest is None else np.fmin(fastest / speed, finest / edge)
            own = np.fmin(own, offered.counts[motor] / offered.least if offered.least else np.inf)
        worth = 1.0 / np.maximum(own, 1e-9) + worth / LAST
    best, inertia = good.max(axis=1, initial=0), offered.inertia[motor]
    alike = (good == best[:, None]) & (inertia < np.reshape(below, (-1, 1)))
    place = np.where(alike, worth, np.inf).argmin(axis=1)
    own = inertia[np.arange(len(motor)), place]
    easier = (best > 0) & (alike & (inertia < own[:, None])).any(axis=1)
    return np.where(best > 0, offered.row[motor, place], offered.last[motor]), np.where(easier, own, 0.0)


def counts_check(spec: RobotSpec, catalog: Catalog, row: Whole) -> list[CheckColumn]:
    """The counts of some encoders against those required; no check where the spec requires no encoder.

    A motor without any listed encoder has an unknown one, for tables of what fits are partial: a reason to fail only
    where the spec requires counts, a family or a part.
    """
    choice = spec.select.encoder
    least = max(spec.needs.encoder_counts or 0, choice.min_counts or 0)
    if not (least or choice.named):
        return []
    counts = np.where(row >= 0, np.append(lines(catalog.encoders), np.nan)[row], 0.0)
    return [at_least("encoder_counts", float(least or 1), counts, by_choice=True)]


def line_frequency(demand: Demands, encoder: Figures) -> Array:
    """Lines of the encoder per second at the highest speed."""
    return np.where(demand.peak_speed == 0.0, 0.0, lines(encoder) * demand.peak_speed / (2 * np.pi))


def counting_limits(spec: RobotSpec, belt: Alike, demand: Demands, parts: Parts) -> list[CheckColumn]:
    """Limits of encoders: speed, frequency, their own and the controller's, and resolution."""
    encoder = parts.encoder
    speed: Options = {"needed": spec.margins.speed, **({} if spec.wants_encoder else PROPOSAL)}
    counted = line_frequency(demand, encoder)
    rates = encoder["max_frequency"], parts.controller["max_encoder_frequency"]
    rate, known = np.minimum(*rates), np.fmin(*rates)  # where one is unknown what needs more than the other fails
    rate = np.where(np.isnan(rate) & (counted * (1.0 + spec.margins.speed) > known), known, rate)
    checks = [
        at_most("encoder_speed", demand.peak_speed, encoder["max_speed"], **speed),
        at_most("encoder_frequency", counted, rate, **speed),
    ]
    need = spec.needs.resolution_at_load
    if need is not None:
        geared = belt if spec.gear is None else belt * spec.gear.ratio
        edge = angle_per_edge(lines(encoder), demand.total_ratio * geared)
        checks.append(at_most("encoder_resolution", edge, need))
    return checks


# -- A holding brake for every candidate at once: of those that go with its motor the smallest that holds the load.
#
# Smallest by what is summed in the objective of the spec, else by mass; then by torque and part number. A brake that
# a source lists with the motor goes before one that is sold apart, for any shaft: whether that can be mounted is not
# known. Where none is strong enough it is the strongest that is listed, so that its check can say by how much it
# falls short; a motor of which no list was found has none, and whether it holds is unknown. A load that holds itself
# needs none, nor one that the motor's friction holds where the spec counts it.


FLANGE = "flange"  # mounting of a brake for any shaft
_FEW = 1000.0  # stops up to which a gearhead's emergency torque counts


class OfferedBrakes(NamedTuple):
    """Brakes of each motor, the smallest first: rows are motors; where there are fewer, row -1 at the end."""

    row: Whole
    listed: Mask  # which brake a source lists with which motor: (motors, brakes)
    last: Whole  # the strongest, -1 where none is listed

    def goes(self, motor: Whole, brake: Whole) -> Mask:
        """Whether a source lists brakes with motors, by their rows; of none it does not."""
        return (brake >= 0) & np.pad(self.listed, ((0, 0), (0, 1)))[motor, brake]


def offered_brakes(spec: RobotSpec, catalog: Catalog) -> OfferedBrakes | None:
    """The brakes that go with each motor and that the spec allows; None where it wants none."""
    if not spec.wants_brake:
        return None
    table = catalog.brakes
    own, strong = table["family"] == OWN, ~np.isnan(table["static_torque"])
    listed = np.zeros((len(catalog.motors), len(table)), bool)
    listed[catalog.motor_brake.left, catalog.motor_brake.right] = True
    listed |= own
    allowed = own if spec.brake else table.named(spec.select.brake.named) & ~own
    apart = allowed & strong & (catalog.motors["inside"] == "")[:, None]
    if not spec.select.brake.named:
        apart &= table["mounting"] == FLANGE
    fitting = (listed & allowed & strong) | apart
    smallest = np.lexsort((table["part"], table["static_torque"], table["mass"], summed_share(spec, table, catalog)))
    row = _first_of_each(fitting, smallest[np.argsort(~listed[:, smallest], axis=1, kind="stable")])
    if not len(table):
        return OfferedBrakes(row, listed, np.full(len(listed), -1))
    nearest = fitting if spec.select.brake.named else fitting & listed
    strongest = np.where(nearest, table["static_torque"], -1.0).argmax(axis=1)
    return OfferedBrakes(row, listed, np.where(nearest.any(axis=1), strongest, -1))


def is_listed(catalog: Catalog, motor: int, brake: int) -> bool:
    """Whether a source lists a brake with a motor, or the spec has it as its own."""
    pairs = catalog.motor_brake
    listed = bool(np.any((pairs.left == motor) & (pairs.right == brake)))
    return brake >= 0 and (listed or catalog.brakes["family"][brake] == OWN)


def own_figure(brake: Figures, name: str) -> Alike:
    """A figure of brakes that is 0 where there is none; NaN unknown."""
    return np.where(brake["part"] == "", 0.0, brake[name])


def brake_inertia(parts: Parts, belt: Alike) -> Alike:
    """Inertia of brakes at the motor's shaft [kg*m^2]; 0 where there is none, NaN unknown."""
    brake = parts.brake
    return 0.0 if brake is None else own_figure(brake, "inertia") / _turns(brake, parts.gearhead["ratio"] * belt) ** 2


def _turns(brake: Figures, total: Alike) -> Alike:
    """Turns of the motor for one of the brake's shaft."""
    return np.where(brake["shaft"] == "load", total, 1.0)


def brakes_for(
    problem: Problem, offered: OfferedBrakes, cycles: Sequence[AtGearhead], parts: Parts, preset: Whole | None = None
) -> Whole:
    """Row of each candidate's brake, -1 where it has none."""
    spec, catalog = problem.spec, problem.catalog
    option, row = offered.row[parts.motor.rows], np.full(len(parts.motor.rows), -1)
    if option.size and len(catalog.brakes):  # figures of candidates are columns (rows, 1), of brakes (rows, brakes)
        own = zip(("motors", "gearheads", "encoders"), parts[:3], strict=True)
        motor, gearhead, encoder = (Rows(catalog.table(name), part.rows[:, None]) for name, part in own)
        belts = [cycle.base.behind(np.asarray(cycle.belt)[..., None]) for cycle in cycles]
        checks = _of_options(problem, belts, Parts(motor, gearhead, encoder, None, Rows(catalog.brakes, option)))
        passing, failing, margin = option >= 0, option < 0, np.full(option.shape, np.inf)
        for check in checks:
            passing, failing = passing & check.passed, failing | check.failed
            margin = np.minimum(margin, check.tightness)
        worth = -margin if spec.select.objective == "margin" else np.zeros(option.shape)
        row = offered.last[parts.motor.rows]
        for good in (~failing, passing):  # the second is better than the first
            place = np.where(good, worth, np.inf).argmin(axis=1)  # of equals the first
            row = np.where(good.any(axis=1), option[np.arange(len(option)), place], row)
    if not spec.names_brake:  # none where every load case holds itself, or friction that counts holds it
        if spec.needs.holding_friction == "ignored":
            needless: Mask | bool = all(cycle.base.scalars.holding_torque == 0.0 for cycle in cycles)
        else:
            cases = zip(problem.cases, cycles, strict=True)
            needless = np.logical_and.reduce(
                [_by_friction(case.spec, cycle, parts.motor, parts.gearhead) for case, cycle in cases]
            )
        row = np.where(needless, -1, row)
    return row if preset is None else np.where(preset == FREE, row, preset)


def _of_options(problem: Problem, cycles: Sequence[AtGearhead], parts: Parts) -> list[CheckColumn]:
    """Whether brakes hold and stop the load, in every load case."""
    checks, brake, gearhead = list[CheckColumn](), parts.brake, parts.gearhead
    assert brake is not None
    for case, cycle in zip(problem.cases, cycles, strict=True):
        spec = case.spec
        if spec.needs.hold_unpowered:
            checks.append(_holding(spec, cycle, parts.motor, gearhead, brake))
        if spec.needs.emergency_stops:
            inertia = drive_inertia(parts.motor, gearhead, parts.encoder, brake_inertia(parts, cycle.belt))
            checks += _stop_limits(spec, cycle, gearhead, brake, inertia)
        checks.append(coil_voltage(brake, spec.supply))
    return checks


def _holding(spec: RobotSpec, cycle: AtGearhead, motor: Figures, gearhead: Figures, brake: Figures) -> CheckColumn:
    """Torque at rest that reaches the brake, through belt and gearhead or at the load's shaft, against its own."""
    at_load = cycle.holding_torque * cycle.belt / spec.belt_efficiency
    behind = held_by_brake(cycle.holding_torque, gearhead["ratio"], gearhead["efficiency"])
    reaches = np.where(brake["shaft"] == "load", at_load, behind)
    if spec.needs.holding_friction == "ignored":
        return at_most("holding", reaches, brake["static_torque"], needed=spec.needs.holding_factor - 1.0)
    alone = _by_friction(spec, cycle, motor, gearhead) & (brake["part"] == "")
    rubbed = np.where(brake["shaft"] == "load", 0.0, held_by_friction(motor))
    holds = np.where(alone, 0.0, brake["static_torque"]) + rubbed
    return at_most("holding", reaches, holds, needed=spec.needs.holding_factor - 1.0, note=_COUNTED)


_COUNTED = "with the motor's printed friction and detent torque"


def _by_friction(spec: RobotSpec, cycle: AtGearhead, motor: Figures, gearhead: Figures) -> Mask:
    """Whether the motor's friction is to be counted and holds the load alone, with the safety factor."""
    behind = held_by_brake(cycle.holding_torque, gearhead["ratio"], gearhead["efficiency"])
    counted = spec.needs.hold_unpowered and spec.needs.holding_friction == "counted"
    return counted & np.asarray(held_by_friction(motor) >= spec.needs.holding_factor * behind)


def brake_limits(spec: RobotSpec, cycle: AtGearhead, parts: Parts, demand: Demands, listed: Mask) -> list[CheckColumn]:
    """Limits of brakes, and of gearheads that pass on what brakes hold."""
    brake, motor, gearhead, needs = parts.brake, parts.motor, parts.gearhead, spec.needs
    assert brake is not None
    there = brake["part"] != ""
    rubs = needs.holding_friction == "counted" and ~there & _by_friction(spec, cycle, motor, gearhead)
    idle = ~there & np.asarray(cycle.holding_torque == 0.0) | rubs
    checks = [fits("brake_fits", listed | idle, listed | idle)]
    if needs.hold_unpowered:
        checks.append(_holding(spec, cycle, motor, gearhead, brake))
        passed_on = (there | rubs) & (brake["shaft"] == "")
        carried = np.where(passed_on, gearhead["intermittent_torque"], np.inf)
        torque = cycle.holding_torque / spec.belt_efficiency
        checks.append(at_most("gearhead_holding", torque, carried, needed=spec.margins.torque))
    fastest = np.where(np.isnan(brake["max_speed"]), np.inf, brake["max_speed"])
    turning = demand.peak_speed / _turns(brake, demand.total_ratio * cycle.belt)
    checks.append(coil_voltage(brake, spec.supply))
    checks.append(at_most("brake_speed", turning, fastest, needed=spec.margins.speed))
    if needs.emergency_stops:
        inertia = demand.coefficients[:, _ACCELERATION] / demand.total_ratio
        inertia = np.where(demand.left_out[:, _ACCELERATION], np.nan, inertia)
        checks += _stop_limits(spec, cycle, gearhead, brake, inertia)
    return checks


_ACCELERATION = 3


def stops(spec: RobotSpec, cycle: AtGearhead, gearhead: Figures, brake: Figures, inertia: Alike) -> tuple[Stop, Stop]:
    """An emergency stop from the highest speed, as the weight pulls most: with a strong brake and with a weak one."""
    total = gearhead["ratio"] * cycle.belt
    shaft = _turns(brake, total)
    whole = (inertia + cycle.load_cycle.inertia / total**2) * shaft**2
    weight = cycle.holding_torque * cycle.belt / spec.belt_efficiency / total * shaft
    speed = cycle.peak_speed * gearhead["ratio"] / shaft
    slips = (np.where(np.isnan(brake["dynamic_torque"]), share * brake["static_torque"], brake["dynamic_torque"])
             for share in reversed(SLIPPING))  # fmt: skip
    strong, weak = (stop(whole, speed, torque, weight, brake["engage_time"]) for torque in slips)
    return strong, weak


def _stop_limits(
    spec: RobotSpec, cycle: AtGearhead, gearhead: Figures, brake: Figures, inertia: Alike
) -> list[CheckColumn]:
    """Energy and number of emergency stops, and what the gearhead passes on in one."""
    number = float(spec.needs.emergency_stops or 0)
    energy = Range(*(emergency_stop.energy for emergency_stop in stops(spec, cycle, gearhead, brake, inertia)))
    with np.errstate(divide="ignore", invalid="ignore"):
        permitted = (np.fmin(brake["total_energy"] / E, brake["emergency_stops"]) for E in reversed(energy))
    return [
        at_most("brake_stop_energy", energy, brake["energy_per_stop"]),
        at_most("brake_stops", number, Range(*permitted)),
        _through_gearhead(spec, cycle, gearhead, brake, inertia),
    ]


def _through_gearhead(
    spec: RobotSpec, cycle: AtGearhead, gearhead: Figures, brake: Figures, inertia: Alike
) -> CheckColumn:
    """Largest torque of a stop at the gearhead's output, with a brake at the motor that slips as hard as it holds."""
    i = gearhead["ratio"]
    load = cycle.load_cycle.inertia / (i * cycle.belt) ** 2
    weight = cycle.holding_torque / spec.belt_efficiency / i
    strongest = np.fmax(brake["static_torque"], brake["dynamic_torque"])
    slowing = np.maximum(strongest - weight, 0.0) / (inertia + load)
    torque = i * (weight + load * slowing)
    few = float(spec.needs.emergency_stops or 0) <= _FEW
    emergency = np.where(np.isnan(gearhead["emergency_torque"]) | (not few), gearhead["intermittent_torque"],
                         gearhead["emergency_torque"])  # fmt: skip
    free = (brake["part"] == "") | (brake["shaft"] != "") | np.isposinf(gearhead["intermittent_torque"])
    return at_most("gearhead_stop_torque", torque, np.where(free, np.inf, emergency), needed=spec.margins.torque)
