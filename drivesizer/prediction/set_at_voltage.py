"""A set at the bench over samples: its parts within their tolerances, its steady points at a supply, its warming."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import isnan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import PARTS, RELATIONS, Catalog, Table, columns_of
from drivesizer.catalog.estimates import (
    SAME_FAMILY,
    Estimate,
    Fit,
    estimates,
    estimates_by_rule,
    estimates_of,
    family_limits,
    law_text,
)
from drivesizer.catalog.parts import NO_GEARHEAD
from drivesizer.catalog.query import PartRow
from drivesizer.catalog.tables import Pairs, empty
from drivesizer.catalog.tolerances import (
    Class,
    classes,
    deviations_at,
    lognormal,
    resistance_from_stall,
    usual_of_spur_gears,
)
from drivesizer.catalog.view import split_actuators
from drivesizer.kernel.warming import State, after
from drivesizer.physics.at_voltage import Winding, operating_point
from drivesizer.physics.drive_train import (
    ELECTRONICS,
    MotorAndGears,
    commutation,
    friction,
    motor_and_gears,
    usual_idle,
)
from drivesizer.physics.figures import Alike, Array, Mask, bisected
from drivesizer.physics.power_stage import Feed, power_stage, with_stage_losses
from drivesizer.physics.thermal import TwoBodies, resistance_at, steady_winding_temperature, two_bodies
from drivesizer.physics.winding import housing_loss
from drivesizer.results.drive_set import EstimatedFigure
from drivesizer.results.prediction import Conditions
from drivesizer.search.uncertainty.sampled_drive import gearhead_times, motor_times
from drivesizer.search.uncertainty.sampling import sobol
from drivesizer.search.uncertainty.uncertain_figures import holding

# -- The parts of a set over samples: figures times tolerances, estimated figures within their bands.
#
# One row is one machine; the first has every figure as printed, or at the middle of its band. An estimated figure is
# log-normal with the ends of its band as 5th and 95th percentile, and has no tolerance beside that; where a term of
# its law is estimated too, it follows what was drawn for that.


Figures = Mapping[str, NDArray[Any]]
_SEED = 1
_STAGE = {"max_duty": (0.9, 1.0), "voltage_drop": (0.0, 1.0)}  # [1], [V]: to those of maxon's EPOS4
_IDLE_LAW = (
    "assumed: of the continuous torque over the ratio 0.7 to 6 % a stage; 157 gearheads of Wittenstein print 2 to "
    "17 %, of 42 strain wave actuators the no-load current takes 6 to 23 %"
)
_NO_PAIRS = Pairs(*(np.zeros(0, np.int32) for _ in range(3)))


class SampledParts(NamedTuple):
    """Figures of motor, gearhead and controller by field name: columns, the first row nominal."""

    motor: Figures
    gearhead: Figures
    controller: Figures | None
    free: Array  # (samples + 1, 3): three more uniform figures, 0 to 1; the first row 0.5
    most: tuple[Array, Array]  # A, and N*m at the output, by a printed stall; infinite without one
    estimates: tuple[EstimatedFigure, ...]
    classes: tuple[Class, ...]


def sampled_parts(motor: PartRow, gearhead: PartRow | None, controller: PartRow | None, power: int) -> SampledParts:
    """The parts of a set over 2 to the power samples, and their nominal figures before them."""
    role = "actuator" if motor.section == "actuators" else "motor"
    sold = {role: motor} | ({"gearhead": gearhead} if gearhead else {})
    estimated = [(role, estimate) for role, hit in sold.items() for estimate in estimates_of(hit.table, hit.row)]
    stalled = estimates_by_rule(motor.catalog, motor.row, "resistance") if role == "actuator" else ()
    estimated = [(role, estimate) for estimate in stalled] + estimated  # before others, which follow from it
    limits = [(role, limit) for role, hit in sold.items() for limit in family_limits(hit.table, hit.row)]
    tolerances = [tolerance for tolerance in _classes(motor, gearhead, controller) if tolerance.factor is not None]
    cube = sobol(len(estimated) + len(tolerances) + 7, power, [(_SEED, 0)])
    cube = np.concatenate([np.full((1, cube.shape[1]), 0.5), cube])
    tables = {role: _repeated(hit, len(cube)) for role, hit in sold.items()}
    laws = {role: {estimate.fit for other, estimate in estimated if other == role} for role in sold}
    for (role, figure), share in zip(estimated, cube.T, strict=False):
        tables[role][figure.figure] = _within(figure, laws[role], sold[role], tables[role], share)
    for role, limit in limits:
        tables[role][limit.figure] = np.full(len(cube), limit.value)
    if "actuator" in tables:
        inside = _inside(motor.catalog, tables["actuator"], np.full(len(cube), motor.table.source[motor.row]))
        bought, gear = inside.motors.columns, inside.gearheads.columns
    else:
        none = {name: np.full(len(cube), getattr(NO_GEARHEAD, name)) for name in columns_of("gearheads")}
        bought, gear = tables["motor"], tables.get("gearhead", none)
    factors: dict[str, dict[str, Array]] = {part: {} for part in ("motor", "gearhead", "controller")}
    shares = {
        (tolerance.part, tolerance.figure): share
        for tolerance, share in zip(tolerances, cube.T[len(estimated) :], strict=False)
    }
    for tolerance in tolerances:
        assert tolerance.factor is not None
        factors[tolerance.part][tolerance.figure] = tolerance.factor.at(shares[tolerance.part, tolerance.figure])
    names = {estimate.figure for _, estimate in estimated}
    figures = [
        _estimate(role, sold[role].section, estimate.figure, estimate[1:4], law_text(estimate.fit))
        for role, estimate in estimated
    ]
    figures += [
        _estimate(role, sold[role].section, limit.figure, (limit.value,) * 3, f"{SAME_FAMILY}, {limit.members} alike")
        for role, limit in limits
    ]
    stage = None
    if controller is not None:  # what it does not print of its losses lies between assumed ends
        stage = _repeated(controller, len(cube))
        lacking = [name for name in _STAGE if np.isnan(controller[name])]
        for name, share in zip(lacking, cube.T[-7:], strict=False):
            (low, high), law = _STAGE[name], "assumed: from an ideal power stage to one of 0.9 and 1 V"
            stage[name] = low + (high - low) * share
            middle, wide = (low + high) / 2.0, 0.45 * (high - low)
            figures.append(_estimate("controller", "controllers", name, (middle, middle - wide, middle + wide), law))
        if "losses" in factors["controller"]:
            stage |= with_stage_losses(stage, factors["controller"]["losses"])
    bought = _varied(bought, motor_times(bought, factors["motor"]), names)
    most = np.full(len(cube), np.inf), np.full(len(cube), np.inf)
    if stalled:  # no more than at the printed stall, whose efficiency goes with the rest of the sample
        current, torque = motor["stall_current"], motor["stall_torque"]
        lifting = next(tolerance.factor for tolerance in classes() if tolerance.figure == "peak_torque")
        assert lifting is not None
        worse = shares.get(("gearhead", "efficiency"), cube[:, -5])
        most = current * (0.9 + 0.2 * cube[:, -4]), torque * lifting.at(1.0 - worse)
        driving = bought["torque_constant"] * most[0] - friction(bought)[0]
        if not isnan(motor["efficiency"]):
            at_stall = np.fmax(torque / (gear["ratio"] * driving), usual_of_spur_gears(gear["ratio"], gear["stages"]))
            gear = {**gear, "efficiency": np.minimum(at_stall, 1.0)}
    gear = _varied(gear, gearhead_times(gear, factors["gearhead"]), names)
    identified = role == "actuator" and not isnan(motor["coulomb_friction"])
    if (idle := _idle(bought, gear, cube[:, -5], identified)) is not None:
        gear = {**gear, "no_load_torque": idle}
        ends = (float(x) for x in np.quantile(idle[1:], (0.5, 0.05, 0.95)))
        figures.append(_estimate("gearhead", "gearheads", "no_load_torque", tuple(ends), _IDLE_LAW))  # type: ignore[arg-type]
    return SampledParts(bought, gear, stage, cube[:, -3:], most, tuple(figures), tuple(tolerances))


def _idle(motor: Figures, gear: Figures, share: Array, identified: bool) -> Array | None:
    """Torque at the input of a gear without load where it is not printed [N*m]; None where nothing says it.

    Inside an actuator what the printed no-load current has of dry friction counts first.
    """
    from scipy.special import ndtri

    low, usual, high = usual_idle(gear)
    if gear["ratio"][0] <= 1.0 or not isnan(gear["no_load_torque"][0]) or isnan(usual[0]):
        return None
    torque = lognormal(low, usual, high, ndtri(np.clip(share, 1e-6, 1.0 - 1e-6)))
    if motor["inside"][0]:
        if motor["kind"][0] == "brushed" or identified:
            return None  # what rubs is known, or an estimate of peers
        torque = np.maximum(torque - friction(motor)[0], 0.0)
    return torque


def _varied(bought: Figures, changed: Mapping[str, Any], estimated: set[str]) -> Figures:
    """Figures of a part, those that are not estimated as they deviate."""
    return dict(bought) | {name: values for name, values in changed.items() if name not in estimated}


def _estimate(role: str, section: str, figure: str, band: tuple[float, float, float], law: str) -> EstimatedFigure:
    """An estimated or assumed figure as it is printed: value, low and high."""
    column = columns_of(section)[figure]
    return EstimatedFigure(role, figure, *band, column.kind, column.unit, law)


def _within(estimate: Estimate, laws: set[Fit], hit: PartRow, columns: Figures, share: Array) -> Array:
    """Log-normal values of an estimated figure, by its law where terms of it were drawn before: errors go together.

    The laws are those of the part: another may be narrower where a term was drawn far from its middle.
    """
    from scipy.special import ndtri

    value, low, high = (np.full(len(share), x) for x in (estimate.value, estimate.low, estimate.high))
    row = np.full(len(share), hit.row)
    by_figure = estimates(Table(hit.section, columns, hit.table.source[row], hit.table.excluded[row]), laws)
    if estimate.figure in by_figure:  # else by a rule, of printed figures alone
        for into, column in zip((value, low, high), by_figure[estimate.figure][1:4], strict=True):
            into[by_figure[estimate.figure].rows] = column
    values = lognormal(low, value, high, ndtri(np.clip(share, 1e-6, 1.0 - 1e-6)))
    values[0] = estimate.value
    return np.asarray(np.minimum(values, 1.0 if estimate.figure == "efficiency" else np.inf))


def _repeated(hit: PartRow, count: int) -> dict[str, NDArray[Any]]:
    """Figures of a part, in as many rows."""
    return {name: np.full(count, hit.table[name][hit.row]) for name in hit.table.columns}


def _inside(catalog: Catalog, columns: Figures, source: NDArray[np.int32]) -> Catalog:
    """A catalogue of one actuator in many rows, split into motor and gearhead."""
    tables: dict[str, Any] = {section: empty(section) for section in PARTS}
    tables["actuators"] = Table("actuators", columns, source, np.zeros(len(source), bool))
    return split_actuators(catalog.with_tables(tables, dict.fromkeys(RELATIONS, _NO_PAIRS)))


def _classes(motor: PartRow, gearhead: PartRow | None, controller: PartRow | None) -> tuple[Class, ...]:
    """Tolerance classes of the figures of motor, gearhead and controller."""
    if motor.section == "actuators":
        catalog = _inside(motor.catalog, _repeated(motor, 1), motor.table.source[motor.row : motor.row + 1])
        own = holding(catalog, {}, "motor", 0) + holding(catalog, {}, "gearhead", 0)
    else:
        own = holding(motor.catalog, {}, "motor", motor.row)
        own += holding(gearhead.catalog, {}, "gearhead", gearhead.row) if gearhead else ()
    if controller is None or np.isnan([controller[name] for name in ("voltage_drop", "max_efficiency")]).all():
        return own  # the drop is assumed, with a band of its own
    return own + holding(controller.catalog, {}, "controller", controller.row)


# -- One set at a supply: figures of its motor and gear over samples, and its steady points.
#
# Torques with ``_out`` are at the output. A gear that drives has the efficiency e of its printed torque, one that is
# driven the same e; a gearhead's own friction without load counts where it is printed.
#
# Temperatures of winding and housing while the current follows from the winding's temperature: columns over samples.
#
# Each step is exact for a constant current (``kernel.warming``); one that changes with the winding's resistance is
# taken at the mean of the step's ends. Convention: temperatures are absolute.


_RUNAWAY = 3000.0  # K, beyond which a winding is taken to run away
_HALVINGS, _FINE = 60, 40  # of temperatures, and of a step of time
_FIRST, _GROWTH = 0.02, 0.15  # of the time to the limit at the first slope; of the time so far
_LONG = 40.0  # time constants of the housing
_STEPS = 400


class Heating(NamedTuple):
    """A motor as two bodies, and what heats them at a temperature of the winding."""

    bodies: TwoBodies  # columns
    ambient: float  # K
    sources: Callable[[Array], tuple[Array, Array]]  # winding [K] to current [A] and loss at the housing [W]

    @property
    def known(self) -> bool:
        """Whether temperatures can be computed."""
        current, loss = self.sources(np.full(np.shape(self.bodies.R_25), self.ambient))
        return bool(np.all(self.bodies.known) and not np.isnan(current + loss).any())


def over_time(heating: Heating, start: State, times: Array) -> tuple[Array, Array]:
    """Temperatures of winding and housing at times."""
    whole = np.ones(np.shape(heating.bodies.R_25))
    states = [(start.winding * whole, start.housing * whole)]
    for span in np.diff(times):
        states.append(_step(heating, states[-1], span))
    return tuple(np.where(np.array(x) < _RUNAWAY, x, np.inf) for x in zip(*states, strict=True))  # type: ignore[return-value]


def in_the_long_run(heating: Heating) -> tuple[Array, Array]:
    """Temperatures of winding and housing in the long run [K]; infinite where the winding runs away."""
    body, ambient = heating.bodies, heating.ambient
    low, high = (np.full(np.shape(body.R_25), x) for x in (ambient, _RUNAWAY))

    def cooler(winding: Array) -> Mask:
        warmth = steady_winding_temperature(ambient, body.R_25, body.R_th1, body.R_th2, *heating.sources(winding))
        return np.logical_not(warmth > winding)

    _, high = bisected(low, high, cooler, _HALVINGS)  # a fixed point, for losses of a voltage fall with temperature
    housing = body.housing(ambient, high, heating.sources(high)[1])
    return np.where(high < _RUNAWAY, high, np.inf), np.asarray(np.where(high < _RUNAWAY, housing, np.inf))


def time_to_limit(heating: Heating, start: State, limit: Alike) -> Array:
    """Time until the winding has its permitted temperature."""
    body, whole = heating.bodies, np.ones(np.shape(heating.bodies.R_25))
    state = start.winding * whole, start.housing * whole
    at_once = state[0] >= limit
    slope = (_step(heating, state, 1e-6 * body.tau_w)[0] - state[0]) / (1e-6 * body.tau_w)
    with np.errstate(divide="ignore", invalid="ignore"):
        quick = np.where(slope > 0.0, (limit - state[0]) / slope, body.tau_w)
    span = _FIRST * np.clip(quick, 1e-6 * body.tau_w, body.tau_w)
    time, before = np.zeros_like(span), (*state, np.zeros_like(span), span)
    reached = at_once
    for _ in range(_STEPS):
        after = _step(heating, state, span)
        now = ~reached & (after[0] >= limit)
        before = tuple(np.where(now, x, old) for x, old in zip((*state, time, span), before, strict=True))
        reached, state, time = reached | now, after, time + span
        if np.all(reached | (time > _LONG * body.tau_h)):
            break
        span = np.maximum(span, _GROWTH * time)
    w, h, begun, span = before
    _, last = bisected(np.zeros_like(span), span, lambda t: _step(heating, (w, h), t)[0] >= limit, _FINE)
    return np.where(at_once, 0.0, np.where(reached, begun + last, np.inf))


def _step(heating: Heating, state: tuple[Array, Array], span: Alike) -> tuple[Array, Array]:
    """Temperatures after a span, with the sources at the mean of the winding's temperature before and after."""
    sources, end = heating.sources(state[0]), state
    for _ in range(2):
        current, loss = sources
        end = after(heating.bodies, heating.ambient, State(*state), current**2, loss, span)
        end = tuple(np.minimum(np.nan_to_num(x, nan=_RUNAWAY), _RUNAWAY) for x in end)
        sources = heating.sources((state[0] + end[0]) / 2.0)
        if np.array_equal(sources, (current, loss)):  # as while it holds
            break
    return end


_LEADS = 0.03, 0.1, 0.35  # V at the nominal current: both of 0.3 to 1.5 m of copper at 3 to 6.5 A/mm^2
_LIMITED = 0.9  # of V/R: a printed stall current below this is a controller's
_HALF_STEP = np.pi / 6.0  # rad, electrical: farther away another phase carries most


class SetAtVoltage(NamedTuple):
    """Columns over samples; the first row is nominal."""

    motor: Figures
    drive: MotorAndGears[Array]  # motor and gear, seen at the motor
    voltage: Array  # V, that reaches the leads of the winding
    duty: Array  # share of the supply's voltage at full command
    leads: Array  # ohm, in series with the winding
    feed: Feed | None  # of the controller; None without one
    most_current: Array  # A, of the controller; infinite without one
    most_torque: Array  # N*m at the output, by a printed stall; infinite without one
    bodies: TwoBodies
    losses: tuple[Array, Array]  # at the housing, per speed and per square of it

    @property
    def coulomb(self) -> Array:
        """Dry friction of motor and gear without load, at the motor [N*m]."""
        return self.drive.coulomb + self.drive.idle

    def winding(self, temperature: Alike) -> Winding:
        """Electrical side with the winding at a temperature [K], leads included."""
        R = np.asarray(resistance_at(self.bodies.R_25, temperature) + self.leads)
        return Winding(R, self.motor["inductance"], self.drive.k_t, self.drive.k_e, commutation(self.motor))

    def stall_current(self, temperature: Alike) -> Array:
        """Current at standstill and full voltage [A]."""
        return np.asarray(np.minimum(self.voltage / self.winding(temperature).R, self.most_current))

    def source_power(self, source: float, resistance: float, current: Array) -> Array:
        """Power out of the source at full command [W], by ``physics.power_stage``: duty, losses, standby power."""
        at_bus = self.duty * current
        if self.feed is None:
            return source * at_bus
        stage, sagged = self.feed.stage, source - resistance * at_bus
        drop = source - self.voltage / self.duty
        return np.asarray(source * (at_bus + ((stage.loss - self.duty * drop) * current + stage.standby) / sagged))

    def motor_torque(self, torque_out: Alike) -> Array:
        """Torque at the motor that drives one at the output, dry friction included [N*m]; none needs no efficiency."""
        driving = 0.0 if np.all(torque_out == 0.0) else torque_out / (self.drive.ratio * self.drive.efficiency)
        return np.asarray(driving + self.coulomb)

    def running(self, torque_out: Alike, temperature: Alike) -> tuple[Array, Array]:
        """Speed of the motor [rad/s] and current [A] under a torque at the output; stalled where that is too much."""
        winding = self.winding(temperature)
        speed, current = operating_point(winding, self.voltage, self.motor_torque(torque_out), self.drive.viscous)
        stuck = (speed <= 0.0) | (current > self.most_current)
        return np.where(stuck, 0.0, speed), np.where(stuck, self.stall_current(temperature), current)


def usual_leads(parts: SampledParts) -> Array:
    """Resistance of leads that nobody names [ohm]; none beside one by a printed stall, which has them in it."""
    nominal = parts.motor["nominal_current"][0]
    if isnan(nominal) or resistance_from_stall() in parts.classes:
        return np.zeros(len(parts.free))
    share = (parts.free[:, 1] + parts.free[:, 2] + 0.5) % 1.0  # uniform, and of either of the two independent
    return np.asarray(lognormal(*_LEADS, deviations_at(share)) / nominal)


def set_at_voltage(parts: SampledParts, conditions: Conditions) -> SetAtVoltage:
    """A set at a supply."""
    motor, controller, whole = parts.motor, parts.controller, np.ones(len(parts.motor["part"]))
    duty, voltage, feed = whole, conditions.voltage * whole, None
    higher = max(conditions.voltage / motor["nominal_voltage"][0], 1.0)  # than that of the printed stall
    if controller is not None:
        stage = power_stage(controller, conditions.voltage)
        duty, feed = controller["max_duty"], Feed(stage, conditions.voltage, np.nan_to_num(conditions.resistance), 1)
        voltage, most = feed.usable, np.asarray(controller["peak_current"], float)
    else:  # of one inside an actuator its stall's current, where the winding would take more
        stall, of_winding = motor["stall_current"][0], motor["nominal_voltage"][0] / motor["resistance"][0]
        limited = motor["commutation"][0] == ELECTRONICS and stall < _LIMITED * of_winding
        most = np.minimum(stall if limited else np.inf, parts.most[0] * higher)
    drive = motor_and_gears(motor, parts.gearhead)._replace(k_e=motor["back_emf_constant"])
    leads = usual_leads(parts) if isnan(conditions.resistance) else duty**2 * conditions.resistance
    losses = housing_loss(motor, whole)
    return SetAtVoltage(
        motor, drive, voltage, duty, leads, feed, most, parts.most[1] * higher, two_bodies(motor), losses
    )


def hold_current(drive_set: SetAtVoltage, parts: SampledParts, torque_out: float) -> Array:
    r"""Current that holds a torque at rest.

    Friction carries any part between :math:`M e / i - M_f` (it helps) and :math:`M / (i e) + M_f` (it has just been
    overcome): uniform between the two over the samples, M/i in the first row.
    """
    if torque_out == 0.0:
        return np.zeros_like(drive_set.coulomb)
    helped = np.maximum(torque_out * drive_set.drive.efficiency / drive_set.drive.ratio - drive_set.coulomb, 0.0)
    torque = helped + parts.free[:, 0] * (drive_set.motor_torque(torque_out) - helped)
    torque[0] = np.where(np.isnan(torque[0]), np.nan, torque_out / drive_set.drive.ratio[0])
    return np.asarray(torque / drive_set.drive.k_t)


def hottest_phase(drive_set: SetAtVoltage, parts: SampledParts) -> TwoBodies:
    """Bodies of heat with the phase that carries most as the winding: more of the loss than of the mass.

    A brushless motor at rest heats its phases unequally: by the rotor's angle the hottest has 1.5 to 2 times the mean
    loss (three sinusoidal currents). Of what is above the mean its neighbours lead away any part, which varies over
    the samples: in a measured RI50 the same spot warmed at 1, 0.8 and 0.6 of a rate with the rotor at three angles.
    """
    if drive_set.motor["kind"][0] != "brushless":
        return drive_set.bodies
    alone = 2.0 * np.cos(_HALF_STEP * parts.free[:, 1]) ** 2
    more = 1.0 + (alone - 1.0) * parts.free[:, 2]
    return replace(drive_set.bodies, R_th1=drive_set.bodies.R_th1 * more)
