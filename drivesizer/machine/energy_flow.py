r"""Flow of the energy of a cycle: from the supply through winding, motor, gearhead and belt to the load, and back.

.. math:: E_{drawn} = E_{load} + E_{belt} + E_{gearhead} + E_{friction} + E_{copper} + E_{rotor}
        + E_{controller} + E_{brake} + E_{supply} + E_{returned}

Each is the integral of a product of straight lines, exact; those at the motor's shaft are a coefficient of the drive
model times a moment of its functions (see ``physics``). Where the makers' k_e and k_t differ, so do the electrical and
the mechanical power of the winding: the difference is counted with the motor's friction and iron, as a loss whichever
direction the power flows (see ``waveform.balanced``).
"""

from __future__ import annotations

from math import isfinite
from typing import NamedTuple

import numpy as np

from drivesizer.machine.set_cycle import SetCycle
from drivesizer.machine.supply_power import power_of, stepper_loss
from drivesizer.physics.cycle_at_gearhead import ACCELERATION, BRAKING, DIRECTION, DRIVING, SPEED
from drivesizer.physics.drive_train import friction
from drivesizer.physics.load_cycle import integral
from drivesizer.physics.motor_demand import mean_gear_loss

__all__ = ["EnergyFlow", "energy_flow"]


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


def energy_flow(found: SetCycle) -> EnergyFlow:
    """The energies of one drive's cycle, times the number of drives."""
    stepper, power = bool(found.motor["kind"][0] == "stepper"), power_of(found)
    lost = power.bus_drawn - power.motor_drawn - (power.returned - power.motor_returned)  # 0 where no stage loses any
    drawn, resisted, returned, controller = (
        power.mean(x) / found.spec.load.alike for x in (power.drawn, power.resisted, power.returned, lost)
    )
    means = _mechanical_power(found, stepper) | {
        "drawn": drawn,
        "supply": resisted,
        "controller": controller - found.released,
        "brake": found.released,
        "returned": returned,
        "stored": returned * found.spec.supply.regeneration,
        "copper": _stepper_copper(found) if stepper else float(found.figures.copper[0]),
    }
    sets = found.spec.load.motors * found.cycle.load_cycle.total
    known = bool(found.demands.complete.all()) if stepper else found.known
    unknown = set() if known else set(means) - _OF_THE_LOAD
    return EnergyFlow(**{name: np.nan if name in unknown else sets * value for name, value in means.items()})


_OF_THE_LOAD = {"gearhead", "belt", "load"}


def _stepper_copper(found: SetCycle) -> float:
    """Mean heat of a stepper's windings [W]."""
    cycle, speed = found.cycle.load_cycle, found.cycle.functions[:, :, SPEED] * found.demands.total_ratio[0]
    return float((stepper_loss(found.spec, found.motor, speed) * cycle.duration).sum() / cycle.total)


def _mechanical_power(found: SetCycle, stepper: bool) -> dict[str, float]:
    """Mechanical power, means over the cycle [W]."""
    cycle, moments = found.cycle.load_cycle, found.cycle.moments
    c, i = found.demands.coefficients[0], float(found.demands.total_ratio[0])
    (coulomb,), _ = ((0.0,), 0.0) if stepper else friction(found.motor)  # a stepper's is in its pull-out torque
    driving, braking = moments[DRIVING, SPEED], moments[BRAKING, SPEED]  # at the gearhead's output
    turned = moments[DIRECTION, SPEED] * i  # rad/s, of the motor, absolute
    work = integral(cycle.duration, cycle.torque, cycle.speed) / cycle.total
    return {
        "friction": float(coulomb * turned + c[SPEED] * i * moments[SPEED, SPEED])
        + (0.0 if stepper else float(found.figures.unlike[0]) / cycle.total),
        "gearhead": float(mean_gear_loss(found.cycle, found.gearhead)[0]),
        "belt": float(driving + braking - work),
        "load": work,
        "rotor": float(c[ACCELERATION] * i * moments[ACCELERATION, SPEED]),
    }
