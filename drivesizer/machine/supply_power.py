"""Power that a machine's drives draw from their supply and regenerate over a cycle, and where its energy goes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf, isfinite, isnan, nan
from typing import NamedTuple

import numpy as np

from drivesizer.catalog.parts import one_row
from drivesizer.kernel.evaluate import pieces
from drivesizer.kernel.records import Drive
from drivesizer.load_cases.of_machine import distance_of
from drivesizer.machine.set_cycle import SetCycle, driven, turned
from drivesizer.physics.braking import burning, burnt_energy, largest_mean, largest_pulse, most_stored
from drivesizer.physics.cycle_at_gearhead import (
    ACCELERATION,
    BRAKING,
    DIRECTION,
    DRIVING,
    SPEED,
    AtGearhead,
    CycleAtBelt,
)
from drivesizer.physics.drive_train import friction
from drivesizer.physics.figures import Alike, Array, Figures, Whole
from drivesizer.physics.load_cycle import integral
from drivesizer.physics.motor_demand import Demands, mean_gear_loss
from drivesizer.physics.power_stage import Feed, bus_voltage, of_the_source
from drivesizer.physics.stepper import copper_loss, electrical_energy, idle_loss
from drivesizer.results.drive_set import DriveParts
from drivesizer.results.problem import LoadCase
from drivesizer.spec.robot import RobotSpec

# -- Power that the drives of a machine draw from their supply and regenerate over one cycle: columns over time.
#
# Current and voltage of the drive model are straight lines within a segment; each segment is cut into pieces, and of
# every piece the energy is exact (``kernel``). Summed up they are the energies of the drive's own record. Of wheels
# with different loads each counts in the supply's resistance as if all were like it: no less than they lose
# together.


_MOST = 4096  # pieces of a cycle
_FINEST = 16  # pieces of a segment
_NO_TIME = 1e-12  # of the cycle: two ends so near are one


class Draw(NamedTuple):
    """Energy out of the source and returned over a cycle [J], and peak power [W]: columns over drives or samples."""

    drawn: Alike
    returned: Alike
    peak: Alike


class DrivePower(NamedTuple):
    """Electrical power of all drives together, piece by piece; unknown where the drive's demand is."""

    duration: Array  # s
    drawn: Array  # W, mean of what is drawn of the source: losses of controllers and supply included
    bus_drawn: Array  # W, of these at the input of the controllers: known where no current of the source gives them
    returned: Array  # W, mean of regenerated power, at the input of the controllers
    peak: Array  # W, largest out of the source at one moment
    returned_peak: Array  # W
    motor_drawn: Array  # W, of these the motors'
    motor_returned: Array  # W
    resisted: Array  # W, heat of the supply's resistance
    most: Array  # W, largest and least net power at the input of the controllers: below 0 what is regenerated
    least: Array  # W
    distance: float  # m that a vehicle goes in the cycle, there and back; unknown of what does not travel

    @property
    def total(self) -> float:
        """Length of the cycle [s]."""
        return float(self.duration.sum())

    def mean(self, column: Array) -> float:
        """Mean of one of the columns over the cycle."""
        return float(self.duration @ column) / self.total

    def times(self, factor: float) -> DrivePower:
        """All powers times a factor; NaN makes them unknown."""
        return self._replace(**{name: factor * getattr(self, name) for name in _POWERS})

    def slipping(self, slip: float) -> DrivePower:
        """The same where wheels slip: for a travel they turn by 1 / (1 - slip) more, at the same torque.

        Losses of the current stay the same: what is drawn is no more than that, and no more is regenerated.
        """
        names = ("drawn", "bus_drawn", "peak", "motor_drawn", "most")
        return self._replace(**{name: getattr(self, name) / (1.0 - slip) for name in names})

    def at(self, duration: Array, pieces: Whole) -> DrivePower:
        """Some of its pieces in an order, with other durations [s]."""
        return self._replace(duration=duration, **{name: getattr(self, name)[pieces] for name in _POWERS})


_POWERS = tuple(name for name in DrivePower._fields if name not in ("duration", "distance"))


def drive_power(
    spec: RobotSpec, drive_set: DriveParts, base: CycleAtBelt | None = None, *, merged: bool = False
) -> DrivePower:
    """Power over one cycle in periodic steady state; unknown where the winding's temperature is."""
    feed = spec.feed_of(drive_set.controller, drive_set.brake)
    if drive_set.steps:
        return _stepper_power(spec, one_row(drive_set.motor), *turned(spec, drive_set, base), feed)[0]
    drive, cycle, demand, _ = driven(spec, drive_set, base)
    return _of_a_servo(spec, drive, cycle, demand, feed, merged)


def _of_a_servo(
    spec: RobotSpec, drive: Drive, cycle: AtGearhead, demand: Demands, feed: Feed, merged: bool
) -> DrivePower:
    """The same by the kernel."""
    _, energy = pieces(drive, cycle.load_cycle, _FINEST, _MOST, merged=merged)
    t, standby = energy.duration, feed.stage.standby
    bus_drawn, heat = energy.drawn / t + standby, energy.source_heat / t
    power = DrivePower(
        duration=t,
        drawn=bus_drawn + heat,
        bus_drawn=bus_drawn,
        returned=energy.returned / t,
        peak=of_the_source(np.maximum(energy.most, 0.0) + standby, feed),
        returned_peak=np.maximum(-energy.least, 0.0),
        motor_drawn=energy.motor_drawn / t,
        motor_returned=energy.motor_returned / t,
        resisted=heat,
        most=energy.most + standby,
        least=energy.least + standby,
        distance=distance_of(spec, cycle.load_cycle),
    )
    return power.times(spec.load.alike if demand.complete.all() else nan)  # an incomplete demand is only a lower bound


def _stepper_power(
    spec: RobotSpec, motor: Figures, cycle: AtGearhead, demand: Demands, feed: Feed
) -> tuple[DrivePower, Array]:
    """The same of steppers: torque times speed and the loss of their rated current, which flows at any time [W]."""
    speed = np.asarray(cycle.load_cycle.speed * cycle.belt * demand.total_ratio[0])
    rated = copper_loss(motor["nominal_current"][0], motor["resistance"][0])
    loss = np.asarray(rated * idle_loss(speed, spec.control.idle_current))  # in each segment
    torque, piece = cycle.line(demand.coefficients[0])[:, None], np.ones(1)  # every piece a motor of its own
    drawn, returned, most, least = electrical_energy(piece, torque, speed[:, None], loss + feed.stage.standby)
    own_drawn, own_returned, _, _ = electrical_energy(piece, torque, speed[:, None], loss)
    power = DrivePower(
        duration=cycle.load_cycle.duration,
        drawn=drawn,
        bus_drawn=drawn,
        returned=returned,
        peak=np.maximum(most, 0.0),
        returned_peak=np.maximum(-least, 0.0),
        motor_drawn=own_drawn,
        motor_returned=own_returned,
        resisted=np.zeros_like(drawn),
        most=most,
        least=least,
        distance=distance_of(spec, cycle.load_cycle),
    )
    return power.times(spec.load.alike if demand.complete.all() else nan), loss


def power_of_cases(
    cases: Sequence[LoadCase], drive_set: DriveParts, cycles: Sequence[CycleAtBelt] = (), *, merged: bool = False
) -> DrivePower:
    """Power of the drives of load cases that act at the same time, as the wheels of a platform do; or over cycles."""
    pairs = zip(cases, cycles or [case.at_belt for case in cases], strict=True)
    return together([drive_power(case.spec, drive_set, base, merged=merged) for case, base in pairs])


def together(powers: Sequence[DrivePower]) -> DrivePower:
    """Power that the wheels of one platform draw at the same time: their sum, cut where any of them is.

    Largest powers are summed piece by piece, whether they fall together or not.
    """
    if len(powers) == 1:
        return powers[0]
    cut = side_by_side(powers)
    summed = {name: np.sum([getattr(p, name) for p in cut], axis=0) for name in _POWERS}
    return DrivePower(duration=cut[0].duration, distance=powers[0].distance, **summed)


def side_by_side(powers: Sequence[DrivePower]) -> list[DrivePower]:
    """Powers over cycles of the same length, all in the same pieces: cut where any of them is."""
    if len(powers) == 1:
        return list(powers)
    ends = [np.concatenate([[0.0], np.cumsum(p.duration)]) for p in powers]
    edges = np.unique(np.concatenate(ends))
    edges = edges[np.concatenate([[True], np.diff(edges) > _NO_TIME * edges[-1]])]
    middle, duration = (edges[1:] + edges[:-1]) / 2, np.diff(edges)
    place = [np.clip(np.searchsorted(e, middle) - 1, 0, len(e) - 2) for e in ends]
    return [p.at(duration, rows) for p, rows in zip(powers, place, strict=True)]


# -- Flow of the energy of a cycle: from the supply through winding, motor, gearhead and belt to the load, and back.
#
# .. math:: E_{drawn} = E_{load} + E_{belt} + E_{gearhead} + E_{friction} + E_{copper} + E_{rotor}
#         + E_{controller} + E_{brake} + E_{supply} + E_{returned}
#
# Each is the integral of a product of straight lines, exact; those at the motor's shaft are a coefficient of the
# drive model times a moment of its functions (see ``physics``). Where the makers' k_e and k_t differ, so do the
# electrical and the mechanical power of the winding: the difference is counted with the motor's friction and iron,
# as a loss whichever direction the power flows (see ``kernel.cycle``).


class EnergyFlow(NamedTuple):
    """Energies over one cycle, of all drives [J]; NaN is unknown."""

    drawn: float  # out of the source
    supply: float  # heat of the supply's resistance
    controller: float  # losses of the power stage, and standby power
    copper: float
    friction: float  # of the motor, iron losses included, and what its two constants differ by
    gearhead: float
    belt: float
    load: float  # work on it, below 0 where it gives more than it takes
    rotor: float  # what turns with the motor holds more of at the end than at the start
    returned: float  # to the supply, at the input of the controllers
    stored: float  # what the supply keeps of that
    brake: float = 0.0  # that keeps it released

    @property
    def known(self) -> bool:
        """Whether all of it is."""
        return all(map(isfinite, self))

    @property
    def net(self) -> float:
        """Net energy from the supply over the cycle [J]."""
        return self.drawn - self.stored

    @property
    def burnt(self) -> float:
        """Regenerated energy that is not stored [J]."""
        return self.returned - self.stored


def energy_flow(set_cycle: SetCycle) -> EnergyFlow:
    """The energies of one drive's cycle, times the number of drives."""
    spec, at, demand, total = set_cycle.spec, set_cycle.cycle, set_cycle.demands, set_cycle.cycle.load_cycle.total
    stepper = bool(set_cycle.motor["kind"][0] == "stepper")
    if stepper:
        power, loss = _stepper_power(spec, set_cycle.motor, at, demand, set_cycle.feed)
        copper, coulomb, unlike = float(loss @ at.load_cycle.duration) / total, 0.0, 0.0  # of friction: in its pull-out
    else:
        power = _of_a_servo(spec, set_cycle.drive, at, demand, set_cycle.feed, False)
        copper, coulomb = float(set_cycle.figures.copper[0]), float(friction(set_cycle.motor)[0][0])
        unlike = float(set_cycle.figures.unlike[0]) / total
    lost = power.bus_drawn - power.motor_drawn - (power.returned - power.motor_returned)  # 0 where no stage loses any
    drawn, resisted, returned, controller = (
        power.mean(x) / spec.load.alike for x in (power.drawn, power.resisted, power.returned, lost)
    )
    c, i = demand.coefficients[0], float(demand.total_ratio[0])
    work = integral(at.load_cycle.duration, at.load_cycle.torque, at.load_cycle.speed) / total
    known = bool(demand.complete.all()) if stepper else set_cycle.known
    sets = spec.load.motors * total
    own = sets if known else nan
    return EnergyFlow(
        drawn=own * drawn,
        supply=own * resisted,
        controller=own * (controller - set_cycle.released),
        copper=own * copper,
        friction=own * (coulomb * at.moment(DIRECTION, SPEED) * i + c[SPEED] * i * at.moment(SPEED, SPEED) + unlike),
        gearhead=sets * float(mean_gear_loss(at, set_cycle.gearhead)[0]),
        belt=sets * (at.moment(DRIVING, SPEED) + at.moment(BRAKING, SPEED) - work),
        load=sets * work,
        rotor=own * c[ACCELERATION] * i * at.moment(ACCELERATION, SPEED),
        returned=own * returned,
        stored=own * returned * spec.supply.regeneration,
        brake=own * set_cycle.released,
    )


# -- Energy to and from the bus of a machine over one of its load cases, all drives together.
#
# What one drive regenerates while another draws is not burnt. Symbols: E energy [J], P power [W], U voltage [V].


class Burnt(NamedTuple):
    """Load of a brake resistor in periodic steady state; NaN is unknown."""

    energy: float  # J per cycle
    peak: float  # W, largest regenerated power while the bus is full
    mean: float  # W, over the worst window
    pulse: float  # J, of the largest uninterrupted braking


@dataclass(frozen=True)
class Regenerated:
    """Energies to and from a bus over a load case, piece by piece; unknown where the drive's demand is."""

    case: str  # name of the load case
    spec: RobotSpec  # the machine in it, with its supply
    power: DrivePower

    @cached_property
    def drawn(self) -> Array:
        """Energy from the bus in each piece [J]."""
        return self.power.bus_drawn * self.power.duration

    @cached_property
    def returned(self) -> Array:
        """Energy to the bus in each piece, without what the supply stores [J]."""
        return (1.0 - self.spec.supply.regeneration) * self.power.returned * self.power.duration

    @property
    def mean_drawn(self) -> float:
        """Mean power out of the source [W]."""
        return self.power.mean(self.power.drawn)

    @cached_property
    def energy(self) -> float:
        """Regenerated energy per cycle that the supply does not store [J]."""
        return float(self.returned.sum())

    @cached_property
    def known(self) -> bool:
        """Whether the energies are."""
        return not isnan(float(self.returned.sum() + self.drawn.sum()))

    @cached_property
    def stored(self) -> float:
        """Largest energy that is regenerated and not drawn again [J]; infinite where more with every cycle."""
        if not self.known:
            return nan
        if self.energy > float(self.drawn.sum()):
            return inf
        return most_stored(np.stack([-self.drawn, self.returned], axis=1).ravel())

    def highest_voltage(self, more: float = 0.0) -> float:
        """Highest voltage of the bus without a brake resistor [V]; NaN where its capacitance is unknown.

        ``more`` is capacitance beside that of the supply [F].
        """
        supply = self.spec.supply
        if self.stored == 0.0:
            return supply.highest
        return float(bus_voltage(supply.highest, self.stored, (supply.capacitance or nan) + more))

    def burnt(self, capacity: float, window: float, continuous: float = 0.0) -> Burnt:
        """Load of a brake resistor beside a bus that stores so much."""
        if not self.known:
            return Burnt(nan, nan, nan, nan)
        steady = 0.0 if isnan(continuous) else continuous
        energy, highest = burnt_energy(self.drawn, self.returned, capacity), self.power.returned_peak
        highest = (1.0 - self.spec.supply.regeneration) * highest
        course = burning(self.power.duration, self.returned, highest, energy, steady)
        mean, pulse = largest_mean(*course[:2], window), largest_pulse(*course[:2], steady)
        return Burnt(float(energy.sum()), course.peak, mean, pulse)

    def longest_above(self, power: float) -> float:
        """Longest uninterrupted time in which the power out of the source exceeds one [s], by whole pieces."""
        if not self.known:
            return nan
        duration = self.power.duration
        return largest_pulse(duration, np.where(self.power.peak > power, duration, 0.0))


class AxisOnBus(NamedTuple):
    """The drives of an axis with their power in a load case."""

    name: str  # empty of a machine that has no other
    spec: RobotSpec  # in the load case
    drive_set: DriveParts
    power: DrivePower
