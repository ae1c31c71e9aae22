"""Power that the drives of a machine draw from their supply and regenerate over one cycle: columns over time.

Current and voltage of the drive model are straight lines within a segment; each segment is cut into pieces, and of
every piece the energy is exact (``kernel``). Summed up they are the energies of the drive's own record. Of wheels
with different loads each counts in the supply's resistance as if all were like it: no less than they lose together.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.parts import one_row
from drivesizer.kernel.evaluate import number_of_pieces, pieces
from drivesizer.kernel.records import Drive
from drivesizer.load_cases.trip import distance_of
from drivesizer.machine.set_cycle import SetCycle, driven, turned
from drivesizer.physics.cycle_at_gearhead import SPEED, AtGearhead
from drivesizer.physics.figures import Figures
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.power_stage import Feed, of_the_source
from drivesizer.physics.stepper.drawn import copper_loss, electrical_energy, idle_loss
from drivesizer.physics.waveform import Wave, largest_power
from drivesizer.results.drive_set import DriveParts
from drivesizer.spec.robot import RobotSpec

__all__ = ["DrivePower", "drive_power", "power_of", "side_by_side", "stepper_loss", "together"]

Array = NDArray[np.float64]
_MOST = 4096  # pieces of a cycle
_FINEST = 16  # pieces of a segment
_NO_TIME = 1e-12  # of the cycle: two ends so near are one


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
        columns = {n: factor * getattr(self, n) for n in self._fields if n not in ("duration", "distance")}
        return self._replace(**columns)

    def slipping(self, slip: float) -> DrivePower:
        """The same where wheels slip: for a travel they turn by 1 / (1 - slip) more, at the same torque.

        Losses of the current stay the same: what is drawn is no more than that, and no more is regenerated.
        """
        more = {name: getattr(self, name) / (1.0 - slip) for name in _DRAWN}
        return self._replace(**more)

    def at(self, duration: Array, pieces: Any) -> DrivePower:
        """Some of its pieces in an order, with other durations [s]."""
        columns = {name: getattr(self, name)[pieces] for name in self._fields if name not in ("duration", "distance")}
        return self._replace(duration=duration, **columns)


_DRAWN = ("drawn", "bus_drawn", "peak", "motor_drawn", "most")


def drive_power(spec: RobotSpec, drive_set: DriveParts, base: Any = None, *, merged: bool = False) -> DrivePower:
    """Power over one cycle in periodic steady state; unknown where the winding's temperature is."""
    if drive_set.steps:
        feed = spec.feed_of(drive_set.controller, drive_set.brake)
        return _stepper_power(spec, one_row(drive_set.motor), *turned(spec, drive_set, base), feed)
    drive, cycle, demand, _ = driven(spec, drive_set, base)
    return _of_a_servo(spec, drive, cycle, demand, spec.feed_of(drive_set.controller, drive_set.brake), merged)


def power_of(found: SetCycle) -> DrivePower:
    """The same of a drive whose cycle is at hand."""
    if found.motor["kind"][0] == "stepper":
        return _stepper_power(found.spec, found.motor, found.cycle, found.demands, found.feed)
    return _of_a_servo(found.spec, found.drive, found.cycle, found.demands, found.feed, False)


def _of_a_servo(
    spec: RobotSpec, drive: Drive, cycle: AtGearhead, demand: Demands, feed: Feed, merged: bool
) -> DrivePower:
    """The same by the kernel."""
    sets = spec.load.alike if demand.complete.all() else np.nan  # an incomplete demand is only a lower bound
    count = number_of_pieces(drive, cycle.load_cycle)
    cuts = 0 if merged and count > _MOST else max(1, min(_FINEST, _MOST // count))
    _, found = pieces(drive, cycle.load_cycle, cuts)
    t, standby = found.duration, feed.stage.standby
    bus_drawn, heat = found.drawn / t + standby, found.source_heat / t
    return DrivePower(
        duration=t,
        drawn=sets * (bus_drawn + heat),
        bus_drawn=sets * bus_drawn,
        returned=sets * found.returned / t,
        peak=sets * of_the_source(np.maximum(found.most, 0.0) + standby, feed),
        returned_peak=sets * np.maximum(-found.least, 0.0),
        motor_drawn=sets * found.motor_drawn / t,
        motor_returned=sets * found.motor_returned / t,
        resisted=sets * heat,
        most=sets * (found.most + standby),
        least=sets * (found.least + standby),
        distance=distance_of(spec, cycle.load_cycle),
    )


def stepper_loss(spec: RobotSpec, motor: Figures, speed: Array) -> Array:
    """Loss of a stepper's windings by the speeds at both ends of segments [W]."""
    return np.asarray(copper_loss(*(motor[x][0] for x in ("nominal_current", "resistance")))
                      * idle_loss(speed, spec.control.idle_current))  # fmt: skip


def _stepper_power(spec: RobotSpec, motor: Figures, cycle: AtGearhead, demand: Demands, feed: Feed) -> DrivePower:
    """The same of steppers: torque times speed and the loss of their rated current, which flows at any time."""
    functions, duration, standby = cycle.functions, cycle.load_cycle.duration, float(feed.stage.standby)
    torque = functions @ demand.coefficients[0]
    speed = functions[:, :, SPEED] * demand.total_ratio[0]
    loss = stepper_loss(spec, motor, speed)
    piece, torque, speed = np.ones(1), torque[:, None], speed[:, None]  # every piece a motor of its own
    drawn, returned, peak = electrical_energy(piece, torque, speed, loss + standby)
    own_drawn, own_returned, _ = electrical_energy(piece, torque, speed, loss)
    back = electrical_energy(piece, -torque, speed, -loss - standby)[2]
    turning = Wave(piece, torque, speed)  # its power is a product of two lines too
    net = (largest_power(x)[0] for x in (turning, turning._replace(voltage=-speed)))
    sets = spec.load.alike if demand.complete.all() else np.nan
    return DrivePower(
        duration=duration,
        drawn=sets * drawn,
        bus_drawn=sets * drawn,
        returned=sets * returned,
        peak=sets * peak,
        returned_peak=sets * back,
        motor_drawn=sets * own_drawn,
        motor_returned=sets * own_returned,
        resisted=np.zeros_like(drawn),
        most=sets * (next(net) + loss + standby),
        least=sets * (loss + standby - next(net)),
        distance=distance_of(spec, cycle.load_cycle),
    )


def together(powers: Sequence[DrivePower]) -> DrivePower:
    """Power that the wheels of one platform draw at the same time: their sum, cut where any of them is.

    Largest powers are summed piece by piece, whether they fall together or not.
    """
    if len(powers) == 1:
        return powers[0]
    cut = side_by_side(powers)
    summed = {
        name: np.sum([getattr(p, name) for p in cut], axis=0)
        for name in DrivePower._fields
        if name not in ("duration", "distance")
    }
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
    return [p.at(duration, some) for p, some in zip(powers, place, strict=True)]
