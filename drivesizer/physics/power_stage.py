r"""Losses between supply and motor: the power stage of a controller, and the resistance of the supply.

.. math::

    P_{in} &= V I + V_l |I| + R_b I^2 \\
    V_s &= V_0 - n R_s I_s, \qquad V_s I_s = P_{in} + P_0 \\
    V + r I &\le D (V_0 - V_d), \qquad r = R_b + n R_s D \left(D + \frac{V_l - D V_d}{V_0}\right)

The last line is the first two at full duty without standby power, the loss beyond the voltage drop taken at the voltage
without load: what resistances take of the voltage is straight in the current, as is what the winding takes.

Symbols: V, I voltage and current of the motor; V_d voltage drop and D largest duty of the stage, V_l its loss per
ampere [V], R_b its resistance, P_0 its standby power; V_0 supply voltage without load, V_s and I_s (of one drive) under
load, R_s resistance of source and cables, n number of drives; C capacitance of the bus.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from drivesizer.physics.battery import current_of_power
from drivesizer.physics.figures import Alike, Figure, Figures, Range

# V per ampere, of a controller of which nothing is printed: makers print a drop of 0.5 V (Technosoft iPOS) to 1 V
# (maxon EPOS2, EPOS4, ESCON) at the rated current, or 98 % at 48 to 50 V, which is 1 V; a bridge was measured at 1.1 V
ASSUMED_LOSS = 1.0
ASSUMED_BAND = 0.5, 1.1  # of it, 5 to 95 %
# the largest duty of a controller that prints none, at least: of 31 for brushless motors 28 print more
_LEAST_DUTY = 0.9
STAGE_FIGURES = ("inside", "max_duty", "voltage_drop", "max_efficiency", "supply_max", "standby_current")
_FASTEST_CHOPPING = 100e3  # Hz, of controllers for small motors: assumed
_RIPPLE = 0.1  # of the supply's voltage, at most: assumed


class PowerStage(NamedTuple):
    """Of one controller, or a column of them."""

    max_duty: Alike  # 1; NaN unknown
    drop: Alike  # V, of the voltage that reaches the motor; NaN unknown
    loss: Alike  # V: of power per ampere
    resistance: Alike  # ohm
    standby: Alike  # W
    assumed: Alike  # whether the loss is

    @property
    def least_loss(self) -> Alike:
        """Loss per ampere that leaves most of what is returned [V]: the lower end of the band where it is assumed."""
        return np.where(self.assumed, ASSUMED_BAND[0] * self.loss, self.loss)


class Feed(NamedTuple):
    """A power stage, and the supply that feeds it with others alike."""

    stage: PowerStage
    voltage: Alike  # V, without load
    resistance: Alike  # ohm, of source and cables; 0: none
    drives: int

    @property
    def usable(self) -> Alike:
        """Voltage that the stage can apply without current [V]; NaN where a figure of it is unknown."""
        return usable_voltage(self.voltage, self.stage.max_duty, self.stage.drop)

    @property
    def applied(self) -> float:
        """The usable voltage of one stage [V]; all of the supply's where a figure of the stage is unknown."""
        return float(self.voltage if np.isnan(self.usable) else self.usable)

    @property
    def usable_range(self) -> Range:
        """Ends of the usable voltage where a figure is not printed [V]: with a drop of the band, without a duty all."""
        ends = []
        for drop, duty in ((ASSUMED_BAND[1], _LEAST_DUTY), (ASSUMED_BAND[0], np.nan)):
            drops = np.where(np.isnan(self.stage.drop), drop, self.stage.drop)
            duties = np.where(np.isnan(self.stage.max_duty), duty, self.stage.max_duty)
            ends.append(usable_voltage(self.voltage, duties, drops))
        most: Alike = np.where(np.isnan(ends[1]), self.voltage, ends[1])
        return Range(ends[0], most[()])

    @property
    def leads(self) -> Alike:
        """Resistance that takes of the motor's voltage as the winding's does, at full duty [ohm]."""
        if not np.any(self.resistance):
            return self.stage.resistance
        duty, drop = (np.where(np.isnan(x), y, x) for x, y in ((self.stage.max_duty, 1.0), (self.stage.drop, 0.0)))
        per_ampere = duty + (self.stage.loss - duty * drop) / self.voltage
        return self.stage.resistance + self.drives * self.resistance * duty * per_ampere

    def broadcast(self, count: int) -> Feed:
        """The same with columns of so many rows."""
        shape = (count,)
        stage = PowerStage(*(np.broadcast_to(x, shape) for x in self.stage))
        return Feed(stage, np.broadcast_to(self.voltage, shape), np.broadcast_to(self.resistance, shape), self.drives)

    def on(self, rows: Any) -> Feed:
        """Some of its rows, of columns."""
        stage = PowerStage(*(x[rows] for x in self.stage))
        return Feed(stage, self.voltage[rows], self.resistance[rows], self.drives)

    def lost(self, current: Figure) -> Alike:
        """Power lost in the stage at a current of the motor [W], without standby power."""
        return self.stage.loss * np.abs(current) + self.stage.resistance * current**2


def power_stage(controller: Figures, voltage: Figure, own_stage: object = None, *, assume: bool = True) -> PowerStage:
    r"""The stage of controllers by what is printed of them, given or assumed.

    The loss per ampere is the larger of the voltage drop and of what the greatest efficiency leaves at the highest
    voltage, :math:`(1/\eta - 1) D V_{max}`. Figures of an actuator are those at the terminals of the controller inside:
    its stage loses nothing beside them.

    Parameters
    ----------
    controller
        Figures by field name: columns, NaN unknown.
    voltage
        Of the supply, for a standby current [V].
    own_stage
        ``voltage_drop`` [V], ``resistance`` [ohm] and ``standby`` [W] in place of the controllers' own; None where not.
    assume
        Whether an unknown loss is ``ASSUMED_LOSS``; else it is left out.

    Returns
    -------
    PowerStage
        Columns.
    """
    inside, duty, drop = controller["inside"] != "", controller["max_duty"], controller["voltage_drop"]
    full = np.where(np.isnan(duty), 1.0, duty) * controller["supply_max"]
    loss = np.fmax(drop, (1.0 / controller["max_efficiency"] - 1.0) * full)
    own, ohm, watt = (getattr(own_stage, name, None) for name in ("voltage_drop", "resistance", "standby"))
    if own is not None:
        drop, loss = (np.where(inside, x, own) for x in (drop, loss))
    unknown = np.isnan(loss)
    standby = controller["standby_current"] * voltage if watt is None else np.full(np.shape(loss), watt)
    return PowerStage(
        max_duty=duty,
        drop=drop,
        loss=np.where(unknown, np.where(inside | (not assume), 0.0, ASSUMED_LOSS), loss),
        resistance=np.where(inside, 0.0, 0.0 if ohm is None else ohm),
        standby=np.where(np.isnan(standby), 0.0, standby),
        assumed=unknown & np.logical_not(inside) & assume,
    )


def with_stage_losses(controller: Figures, factor: Figure, *, assume: bool = True) -> dict[str, Any]:
    """Voltage drop and greatest efficiency of controllers whose losses per ampere are so many times the nominal ones.

    Parameters
    ----------
    controller
        Figures by field name: columns, NaN unknown.
    factor
        Of the losses [1].
    assume
        As ``power_stage`` takes it: what is assumed is expressed as an efficiency.

    Returns
    -------
    dict
        The two figures.
    """
    drop, best, duty = (controller[name] for name in ("voltage_drop", "max_efficiency", "max_duty"))
    full = np.where(np.isnan(duty), 1.0, duty) * controller["supply_max"]
    bare = np.isnan(drop) & np.isnan(best) & assume & (controller["inside"] == "")
    lost = np.where(bare, ASSUMED_LOSS / full, 1.0 / best - 1.0)
    return {"voltage_drop": drop * factor, "max_efficiency": 1.0 / (1.0 + lost * factor)}


def of_the_source(power: Figure, feed: Feed) -> Alike:
    """Power out of the source for a power at the input of each stage, per drive [W].

    Parameters
    ----------
    power
        At the input of each stage, standby power included [W]; below 0 returned, which is counted there.
    feed
        The stages and their supply.

    Returns
    -------
    float or array
        What the resistance of the supply turns to heat included; infinite where no current gives that power.
    """
    if not np.any(feed.resistance):
        return power
    current = current_of_power(np.maximum(power, 0.0) * feed.drives, feed.voltage, feed.resistance)
    out = np.where(np.isnan(current) & ~np.isnan(power), np.inf, feed.voltage * current / feed.drives)
    return np.where(np.asarray(power) > 0.0, out, power)


# --- voltages of the supply


def usable_voltage(lowest: float, max_duty: Figure, voltage_drop: Figure) -> Alike:
    """Voltage that a controller can apply at the lowest supply voltage [V]: duty times supply less its voltage drop.

    Parameters
    ----------
    lowest
        Lowest supply voltage [V].
    max_duty
        Largest duty cycle of the controller [1].
    voltage_drop
        Of its power stage [V].

    Returns
    -------
    float or array
        Voltage [V].

    Examples
    --------
    >>> round(float(usable_voltage(24.0, 0.9, 1.0)), 1)
    20.7
    """
    return np.maximum(max_duty * (lowest - voltage_drop), 0.0)


def bus_voltage(highest: Figure, stored: Figure, capacitance: Figure) -> Alike:
    r"""Voltage of the bus after returned energy is stored in its capacitance, :math:`\sqrt{V^2 + 2 E / C}`.

    Parameters
    ----------
    highest
        Voltage before, the supply's highest [V].
    stored
        Energy that stays on the bus [J].
    capacitance
        Of the bus [F].

    Returns
    -------
    float or array
        Voltage [V].

    Examples
    --------
    >>> round(float(bus_voltage(24.0, 1.0, 0.01)), 3)
    27.857
    """
    return np.sqrt(highest**2 + 2.0 * stored / capacitance)


def least_capacitance(current: Figure, voltage: Figure) -> Alike:
    r"""Least capacitance of a power stage's own bus capacitor [F].

    .. math:: C \ge I D (1 - D) / (f s V) = I / (4 f s V) \text{ at half duty}

    Parameters
    ----------
    current
        Continuous current that the stage chops, I [A].
    voltage
        Of the supply, V [V].

    Returns
    -------
    float or array
        Capacitance [F].

    Notes
    -----
    A stage holds the ripple within a share s at a chopping frequency f. That no stage chops faster than 100 kHz with
    more ripple than a tenth is an assumption.

    References
    ----------
    .. [1] STMicroelectronics, data sheet A6902D, equation (14), without the capacitor's resistance.
    """
    return current / (4.0 * _FASTEST_CHOPPING * _RIPPLE * voltage)
