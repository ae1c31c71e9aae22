"""A drive in closed loop: gains designed, loops analysed, and the drive simulated along a profile, from cold and warm.

Gains are those of ``loop_design``, the simulation is that of ``engine``; ``checks`` judges the result. Assumptions are
kept with it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import Controller, one_row
from drivesizer.control.drive_train import DriveTrain, within_reach
from drivesizer.control.engine import CurrentLimit, Drive, MotorHeat, Simulation, Supply, Task, simulate
from drivesizer.control.loop_design import analyse, designed, edges_of
from drivesizer.control.validation import Cascade, Gains, Loops
from drivesizer.errors import InputError
from drivesizer.load_cases import load_cycle
from drivesizer.load_cases.platform import remaining_torque
from drivesizer.loads.course import Profile
from drivesizer.physics.cycle_at_gearhead import CycleAtBelt
from drivesizer.physics.thermal import two_bodies
from drivesizer.physics.winding import housing_loss
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.ratings import controller_current
from drivesizer.spec.mounting import loss_at_flange
from drivesizer.spec.robot import RobotSpec
from drivesizer.units import show

# -- Input of a simulation: drive train, designed controller, limits, heat and task of a drive.


FOLLOWS = 0.1  # of the top speed: a drive whose error exceeds it does not follow (our convention)
_DRAIN = 0.05  # s: slow for the current loop, short for a rest between two motions (our choice)
_WHOLE = 1e-9  # share of a cycle that is neglected


@dataclass(frozen=True, kw_only=True, eq=False)
class Prepared:
    """Input of a simulation, and the parts that it was made from."""

    spec: RobotSpec
    drive_set: DriveParts
    profile: Profile
    train: DriveTrain
    controller: Gains | Cascade
    usable_voltage: float  # V, NaN unknown
    drive: Drive  # as the engine takes it
    task: Task
    assumptions: tuple[str, ...]


def prepared(
    spec: RobotSpec, drive_set: DriveParts, profile: Profile, controller: Gains | Cascade | None = None
) -> Prepared:
    """A drive and its task as the engine takes them; an unknown limit is none there, and unknown in its check."""
    train, controller, said = designed(spec, drive_set, controller)
    within_reach(train, profile)
    _sampled(controller.velocity_period, profile)
    feed, figures = spec.feed_of(drive_set.controller, drive_set.brake), drive_set.controller or Controller()
    usable, stage = float(feed.usable), feed.stage
    heat, lacks = motor_heat(spec, drive_set)

    def limit(value: float) -> float:
        return math.inf if math.isnan(value) else float(value)

    drive = Drive(
        train=train,
        controller=controller,
        supply=Supply(
            voltage=spec.supply.lowest, resistance=spec.supply.resistance or 0.0, sets=spec.load.motors,
            max_duty=1.0 if math.isnan(usable) else float(stage.max_duty),
            voltage_drop=0.0 if math.isnan(usable) else float(stage.drop),
            loss=float(stage.loss), stage_resistance=float(stage.resistance), standby=float(stage.standby),
            leads=float(feed.leads),
        ),
        current=CurrentLimit(
            peak=limit(figures["peak_current"]),
            continuous=limit(controller_current(figures, spec.environment.ambient)),
            peak_time=limit(figures["peak_time"]),
        ),
        edges=edges_of(spec, drive_set),
        heat=heat,
        drain_time=_DRAIN if spec.control.at_rest == "drain" else math.inf,
    )  # fmt: skip
    if not drive.supply.voltage > drive.supply.voltage_drop:
        raise InputError(
            f"supply: {show(drive.supply.voltage, 'V', 'voltage')} is no more than the controller's own drop, "
            f"{show(drive.supply.voltage_drop, 'V', 'voltage')}; expected more"
        )
    left = remaining_torque(spec, profile, train.load)
    lasts = spec.mission.duration / profile.duration if spec.mission else 1.0
    task = Task(
        time=profile.time,
        speed=tuple((np.array(profile.speed) / train.radius).tolist()),
        load_time=tuple(left[:, 0].tolist()),
        load_torque=tuple(left[:, 1].tolist()),
        cycles=max(1, math.ceil(lasts - _WHOLE)),
    )
    return Prepared(
        spec=spec, drive_set=drive_set, profile=profile, train=train, controller=controller, usable_voltage=usable,
        drive=drive, task=task, assumptions=(*said, *lacks),
    )  # fmt: skip


def _sampled(period: float, profile: Profile) -> None:
    """Refuse a profile whose top speed lies between samples of the velocity loop, or that is too long to be counted."""
    if not profile.duration / period < 2.0**53:
        raise InputError(f"profile {profile.name}: {profile.duration:g} s is too long to be sampled every {period:g} s")
    time, speed = np.array(profile.time) - profile.time[0], np.array(profile.speed)
    near = np.unique(np.concatenate([np.floor(time / period + k) for k in (-1.0, 0.0, 1.0)])) * period
    seen = np.abs(np.interp(near[(near >= 0.0) & (near <= time[-1])], time, speed)).max(initial=0.0)
    if not seen >= (1.0 - FOLLOWS) * profile.top_speed:
        raise InputError(
            f"profile {profile.name}: its top speed lies between two samples of the controller, {period:g} s apart; "
            "expected a slower change"
        )


def motor_heat(spec: RobotSpec, drive_set: DriveParts) -> tuple[MotorHeat | None, list[str]]:
    """Winding and housing of a motor with their losses; that of the gearhead by the mean of the load cycle."""
    figures, bodies = drive_set.motor, two_bodies(drive_set.motor)
    if not (bodies.known and spec.plant.warming):
        return None, []
    coulomb, viscous = (float(x[0]) for x in housing_loss(figures, np.ones(1)))
    if spec.mounting and spec.mounting.gear_loss_share:
        cycle = CycleAtBelt(load_cycle(spec), drive_set.belt_efficiency).behind(drive_set.belt_ratio)
        gearhead = drive_set.gearhead
        coulomb += float(loss_at_flange(spec, cycle, one_row(gearhead))[0]) / gearhead.ratio
    lacks = math.isnan(coulomb) or math.isnan(viscous)
    of_torque, of_speed = (0.0 if math.isnan(loss) else loss for loss in (coulomb, viscous))
    found = MotorHeat(bodies=bodies, ambient=spec.environment.ambient, loss_torque=of_torque, loss_viscous=of_speed)
    left_out = "the motor's losses other than copper loss are unknown and left out of its heating"
    return found, [left_out] * lacks


# -- The simulation from cold, without limits, and in the periodic steady state.


_ROWS = 20_000  # most rows of a time series
LONGEST = 250_000_000  # steps of a simulation: some 40 s
_SHORTER = "expected a slower control.rate, one cycle of what repeats with a mission.duration, or a part with --profile"
_ROUNDS = 4  # of the search for the periodic temperatures
_NUDGE = 1.0  # K, difference of starts for a derivative
_FOUND = 0.05  # K, last step of the search for the fixed point
_HOTTEST = 2000.0  # K: beyond it the winding runs away


@dataclass(frozen=True, kw_only=True, eq=False)
class ClosedLoop(Prepared):
    """A simulation in closed loop, with its inputs."""

    loops: Loops
    out: Simulation  # from ambient temperature
    unlimited: Simulation  # the same without limits; ``out`` where that one does not end
    periodic: dict[str, float]  # highest temperatures in the periodic steady state [K]; empty: unknown
    steady_cycle: tuple[Simulation, ...] = ()  # one cycle in the periodic steady state, with and without limits
    steady_start: tuple[float, float] | None = None  # K, winding and housing at the start of that cycle
    slow: bool = False  # whether the current loop is simulated at the velocity loop's rate

    def figure(self, name: str) -> float:
        """A figure of the simulation, SI."""
        return float(self.out.figures[name][0])

    def required(self, name: str) -> float:
        """A peak without limits, or its time, SI: the larger of the simulation and of the periodic steady state."""
        return _largest((self.unlimited, *self.steady_cycle[1:]), name)

    def drawn(self, name: str) -> float:
        """A peak with limits, or its time, SI: the larger of the simulation and of the periodic steady state."""
        return _largest((self.out, *self.steady_cycle[:1]), name)


def _largest(runs: Sequence[Simulation], name: str) -> float:
    peak = name.removesuffix("_time")
    return float(max(runs, key=lambda one: one.figures[peak][0]).figures[name][0])


def run(spec: RobotSpec, drive_set: DriveParts, profile: Profile) -> ClosedLoop:
    """Design a controller for a drive, analyse its loops and simulate it along a profile for the mission's duration."""
    made = prepared(spec, drive_set, profile)
    drive, task, slow = made.drive, made.task, None
    loops = analyse(made.train, made.controller)
    out = simulate(drive, task, rows=_ROWS, most_steps=LONGEST)
    if "steps" in out.problems[0] and (slow := slower(drive)):
        rates = [show(1.0 / one.controller.current_period, "Hz", "frequency", 3) for one in (drive, slow)]  # type: ignore[union-attr]
        drive, out = slow, simulate(slow, task, rows=_ROWS, most_steps=LONGEST)
        said = (f"the motion is too long for the current loop's {rates[0]}: it is simulated at the velocity loop's "
                f"{rates[1]}, and checks of the largest values allow for what lies between its samples")  # fmt: skip
        made = replace(made, assumptions=(*made.assumptions, said))
    if out.problems[0]:
        cure = _SHORTER if "steps" in out.problems[0] else "expected other gains"
        raise InputError(f"profile {profile.name}: {out.problems[0]}; {cure}")
    (free,) = without_limits([(drive, task)], [out], loops)
    cycle = replace(task, cycles=1)
    rounds = 0 if spec.once else _ROUNDS  # from cold it is run once
    periodic, start, last = _periodic(drive, cycle, out if task.cycles == 1 else None, rounds)
    steady: tuple[Simulation, ...] = ()
    if last is not None and last is not out and not last.problems[0]:  # else it is the first one
        steady = last, *without_limits([(start, cycle)], [last], loops)
    begins = (start.heat.winding, start.heat.housing) if steady and start.heat else None
    return ClosedLoop(**vars(made), loops=loops, out=out, unlimited=free, periodic=periodic, steady_cycle=steady,
                      steady_start=begins, slow=slow is not None)  # fmt: skip


def slower(drive: Drive) -> Drive | None:
    r"""A drive with its current loop at the velocity loop's rate, for motions of hours.

    A current loop runs ten times as often as the loop around it, and a simulation costs by its periods. The winding
    under the gains of the magnitude optimum is a lag :math:`T = L / k_p`; what that is after a velocity period
    :math:`h`, :math:`1 - b` with :math:`b = 1 - e^{-h/T}`, follows from the winding held over such a period,
    :math:`i' = a i + (1 - a) u / R` with :math:`a = e^{-hR/L}`, by the PI that cancels its pole:

    .. math:: k_p = \frac{a\,b\,R}{1 - a}, \quad k_i h = b R

    It answers at once, as the lag includes the delay. All else is unchanged: the outer loops with their delays,
    counts, friction, backlash, limits, heat. The current between two samples of the velocity loop is left out.
    """
    c, m = drive.controller, drive.train
    if not isinstance(c, Cascade) or c.current_steps == 1 or not c.current_kp > 0.0:
        return None
    h, R = c.velocity_period, m.resistance
    decay, share = math.exp(-h * R / m.inductance), -math.expm1(-h * c.current_kp / m.inductance)
    kp, ki = decay * share * R / (1.0 - decay), share * R / h
    return replace(drive, controller=replace(c, current_kp=kp, current_ki=ki, current_period=h), prompt=True)


def simulated(made: Sequence[tuple[Drive, Task]]) -> list[Simulation]:
    """Each drive on its task, without time series; those with the same task side by side."""
    found: dict[int, Simulation] = {}
    for n, (_, task) in enumerate(made):
        if n not in found:
            places = [k for k, (_, other) in enumerate(made) if other == task]
            together = simulate([made[k][0] for k in places], task, rows=0, most_steps=LONGEST)
            for place, k in enumerate(places):
                figures = {name: column[place : place + 1] for name, column in together.figures.items()}
                found[k] = Simulation(figures=figures, problems=(together.problems[place],), series=None)
    return [found[n] for n in range(len(made))]


def without_limits(made: Sequence[tuple[Drive, Task]], found: Sequence[Simulation], loops: Loops) -> list[Simulation]:
    """Drives that met a limit of voltage or current without any, the winding warming; as they are where that fails."""
    stable, free = all(loop.stable for loop in loops.all), [*found]
    met = [out.figures["time_at_voltage_limit"][0] + out.figures["time_at_current_limit"][0] for out in found]
    places = [n for n, out in enumerate(found) if stable and met[n] and not out.problems[0]]
    unlimited = [
        (replace(drive, supply=replace(drive.supply, voltage=math.inf, resistance=0.0), current=CurrentLimit()), task)
        for drive, task in (made[n] for n in places)
    ]
    for n, out in zip(places, simulated(unlimited), strict=True):
        free[n] = found[n] if out.problems[0] else out
    return free


def as_warm(drive: Drive, start: Sequence[float] | NDArray[np.float64]) -> Drive:
    """A drive with other temperatures at the start."""
    if drive.heat is None:
        return drive
    return replace(drive, heat=replace(drive.heat, winding=float(start[0]), housing=float(start[1])))


def _periodic(
    drive: Drive, task: Task, out: Simulation | None, rounds: int
) -> tuple[dict[str, float], Drive, Simulation | None]:
    """Highest temperatures in the periodic steady state [K], the drive at the start of its cycle, its simulation.

    The two temperatures at the end of a cycle are nearly affine in those at its start: the fixed point is found by
    Newton's method, with the slopes of the simulation, which hold while the winding's resistance changes no current,
    else with differences of 1 K.
    """
    if drive.heat is None:
        return {}, drive, None

    def after(begin: Any) -> tuple[Simulation, Any]:
        found = simulate(as_warm(drive, begin), task, rows=0, most_steps=LONGEST)
        return found, np.array([found.figures["winding"][0], found.figures["housing"][0]])

    start = np.array([drive.heat.ambient, drive.heat.ambient])
    last, end = after(start) if out is None else (out, np.array([out.figures[n][0] for n in ("winding", "housing")]))
    for _ in range(rounds):
        slopes = last.slopes[0]
        if slopes is None or last.figures["time_at_voltage_limit"][0]:
            slopes = np.column_stack([(after(start + _NUDGE * unit)[1] - end) / _NUDGE for unit in np.eye(2)])
        step = np.linalg.solve(np.eye(2) - slopes, end - start)
        if np.abs(step).max() < _FOUND:
            break
        start = start + step
        if not np.isfinite(start).all() or start.max() > _HOTTEST or np.abs(np.linalg.eigvals(slopes)).max() >= 1.0:
            return {"winding": math.inf, "housing": math.inf}, drive, None  # it runs away
        last, end = after(start)
    highest = {name: float(last.figures[f"{name}_highest"][0]) for name in ("winding", "housing")}
    return highest, as_warm(drive, start), last
