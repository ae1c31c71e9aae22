"""Temperature of a winding in the long run, and its permitted current.

Convention: temperatures are absolute. Copper loss heats the winding; where a function takes a housing loss, that loss
(friction of a brushed motor, iron losses) enters at the housing and warms the winding through R_th2 alone.
Not here: how the temperature moves in time (see ``kernel.warming``); magnets that weaken with heat.
Symbols: T temperature [K], R resistance [ohm], R_th thermal resistance [K/W], I current [A], P loss [W], k_t torque
constant [N*m/A], I_0 no-load current [A], w speed of the motor [rad/s].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drivesizer.physics.figures import Array, Figures, Mask, once_per_part

Value = float | Array

COPPER = 0.0039  # 1/K, of the resistance at 25 degC [1]; the handbook's 0.00393 belongs to 20 degC
DATA_TEMPERATURE = 298.15  # K, at which most makers give resistance and nominal current: where a catalogue says nothing
_LEAST_PERMITTED = 353.15  # K, 80 degC: no data sheet permits a winding less; the least of the 690 that ship is 85 degC


@dataclass(frozen=True, slots=True, kw_only=True)
class TwoBodies:
    """A winding and a housing as bodies of heat: one motor's floats, or columns over motors.

    A figure that is not above zero and finite is unknown.
    """

    R_25: Value  # ohm, winding at 25 degC
    R_th1: Value  # K/W, winding to housing
    R_th2: Value  # K/W, housing to ambient
    tau_w: Value  # s, winding time constant, C_w R_th1
    tau_h: Value  # s, motor (housing) time constant, C_h R_th2

    @property
    def capacity_w(self) -> Value:
        """Heat capacity of the winding [J/K]."""
        return self.tau_w / self.R_th1

    @property
    def capacity_h(self) -> Value:
        """Heat capacity of the housing [J/K]."""
        return self.tau_h / self.R_th2

    def housing(self, ambient: Value, winding: Value, P_h: Value) -> Value:
        r"""Temperature of the housing in the long run by that of the winding and the loss at the housing [K].

        .. math:: T_h = T_a + R_{th2} \frac{(T_w - T_a) + R_{th1} P_h}{R_{th1} + R_{th2}}
        """
        return ambient + self.R_th2 / (self.R_th1 + self.R_th2) * (winding - ambient + self.R_th1 * P_h)

    @property
    def known(self) -> Mask:
        """Whether all figures of each motor are known."""
        figures = np.broadcast_arrays(self.R_25, self.R_th1, self.R_th2, self.tau_w, self.tau_h)
        return np.all([(x > 0.0) & (x < np.inf) for x in figures], axis=0)


def data_temperature(motor: Figures) -> Value:
    """Temperature at which a motor's figures hold [K]: its catalogue's, else 25 degC, the makers' usual rating."""
    stated = np.asarray(motor["data_temperature"], float)
    return np.where(np.isnan(stated), DATA_TEMPERATURE, stated)[()]


@once_per_part
def rated_ambient(motor: Figures) -> Value:
    """Ambient of the continuous nominal current [K]: the maker's, else that of the motor's other figures."""
    stated = np.asarray(motor["rated_ambient"], float)
    return np.where(np.isnan(stated), data_temperature(motor), stated)[()]


@once_per_part
def resistance_25(motor: Figures) -> Value:
    r"""Resistance of a motor's winding at 25 degC [ohm], :math:`R_d / (1 + \alpha (T_d - T_{25}))`.

    Parameters
    ----------
    motor
        Figures by field name, one motor's or columns: ``resistance`` as printed, at ``data_temperature``.

    Returns
    -------
    float or array
        Resistance [ohm].

    Examples
    --------
    >>> round(float(resistance_25({"resistance": 2.83, "data_temperature": 295.15})), 4)
    2.8635
    """
    return motor["resistance"] / (1.0 + COPPER * (data_temperature(motor) - DATA_TEMPERATURE))


def resistance_at(R_25: Value, temperature: Value) -> Value:
    r"""Resistance of a winding, :math:`R_{25} (1 + \alpha (T - T_{25}))` [ohm].

    Parameters
    ----------
    R_25
        At 25 degC [ohm].
    temperature
        Of the winding, :math:`T` [K].

    Returns
    -------
    float or array
        Resistance [ohm].

    Examples
    --------
    >>> round(resistance_at(2.32, 398.15), 4)
    3.2248
    """
    return R_25 * (1.0 + COPPER * (temperature - DATA_TEMPERATURE))


def settled(ambient: Value, heating: Value, rest: Value = 0.0) -> Value:
    r"""Temperature of a winding whose copper loss grows with it, where that loss is carried off.

    .. math:: T_w = T_a + \frac{\vartheta (1 + \alpha (T_a - T_{25})) + \vartheta_0}{1 - \alpha \vartheta}

    Parameters
    ----------
    ambient
        Temperature around the motor, :math:`T_a` [K].
    heating
        Rise by copper loss, were the winding at 25 degC, :math:`\vartheta` [K].
    rest
        Rise by losses that do not depend on the winding's temperature, :math:`\vartheta_0` [K].

    Returns
    -------
    float or array
        :math:`T_w` [K]; infinite where the loss grows faster than the heat is carried off (thermal runaway),
        NaN where anything is unknown. All arguments may be arrays.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        growth = 1.0 - COPPER * np.asarray(heating)
        rise = np.divide(heating * (1.0 + COPPER * (ambient - DATA_TEMPERATURE)) + rest, growth)
        return (ambient + np.where(growth <= 0.0, np.inf + np.asarray(rest), rise))[()]


def two_bodies(motor: Figures) -> TwoBodies:
    """Winding and housing of a motor by the names of its catalogue figures: one motor's, or columns over motors."""
    return TwoBodies(
        R_25=resistance_25(motor),
        R_th1=motor["thermal_resistance_winding"],
        R_th2=motor["thermal_resistance_housing"],
        tau_w=motor["winding_time_constant"],
        tau_h=motor["motor_time_constant"],
    )


def steady_winding_temperature(
    ambient: Value, R_25: Value, R_th1: Value, R_th2: Value, I_rms: Value, P_h: Value = 0.0
) -> Value:
    r"""Mean temperature of a winding in the long run, its resistance growing with it.

    .. math:: T_w = T_a + \frac{(R_{th1} + R_{th2}) R_{25} I^2 (1 + \alpha (T_a - T_{25})) + R_{th2} P_h}
              {1 - \alpha (R_{th1} + R_{th2}) R_{25} I^2}

    Parameters
    ----------
    ambient
        Temperature around the motor, :math:`T_a` [K].
    R_25
        Resistance of the winding at 25 degC [ohm].
    R_th1
        Thermal resistance from winding to housing [K/W].
    R_th2
        Thermal resistance from housing to ambient [K/W].
    I_rms
        RMS current [A].
    P_h
        Mean loss at the housing [W].

    Returns
    -------
    float or array
        :math:`T_w` [K]; infinite at thermal runaway, NaN where a figure is unknown.

    Notes
    -----
    All arguments may be arrays. The mean of the copper loss is taken as that of mean resistance and mean square
    current: exact for a constant current, and never above the peak of any cycle.

    Examples
    --------
    >>> round(float(steady_winding_temperature(298.15, 2.32, 3.1, 14.0, 1.0)) - 298.15, 2)
    46.93

    References
    ----------
    .. [1] maxon academy, *Formulae Handbook*, 2nd ed., 2012, section "Thermal behavior"; the housing's loss added.
    """
    with np.errstate(invalid="ignore", over="ignore"):
        heating = (R_th1 + R_th2) * R_25 * I_rms * I_rms
        return settled(ambient, heating, R_th2 * np.asarray(P_h))


def steady_winding(motor: Figures, ambient: Value, I_rms: Value, P_h: Value = 0.0) -> Value:
    """The same of motors by the names of their catalogue figures [K].

    Parameters
    ----------
    motor
        Figures by field name, one motor's or columns.
    ambient, I_rms, P_h
        As for ``steady_winding_temperature``.

    Returns
    -------
    float or array
        As ``steady_winding_temperature``.
    """
    R_th = motor["thermal_resistance_winding"], motor["thermal_resistance_housing"]
    return steady_winding_temperature(ambient, resistance_25(motor), *R_th, I_rms, P_h)


def current_derating(ambient: Value, T_max: Value, rated: Value = DATA_TEMPERATURE) -> Value:
    r"""Share of the nominal current that remains in another ambient than that of the rating.

    .. math:: \sqrt{(T_{max} - T_a) / (T_{max} - T_d)}

    Parameters
    ----------
    ambient
        Temperature around the motor, :math:`T_a` [K].
    T_max
        Permitted winding temperature [K]; NaN unknown.
    rated
        Ambient in which the nominal current holds, :math:`T_d` [K] (see ``rated_ambient``).

    Returns
    -------
    float or array
        The share [1]. Where the permitted temperature is unknown: 1 up to the ambient of the rating, below which it is
        the least that the share can be, and NaN above. All arguments may be arrays.
    """
    span = np.asarray(T_max - rated)
    rise, span = np.broadcast_arrays(np.maximum(T_max - ambient, 0.0), span)
    share = np.divide(rise, span, out=np.full(span.shape, np.nan), where=span > 0.0)
    return np.where(np.isnan(span) & (ambient <= np.asarray(rated)), 1.0, np.sqrt(share))[()]


def derating_at_most(ambient: Value, T_max: Value, rated: Value = DATA_TEMPERATURE) -> Value:
    r"""Share of the nominal current that remains at most in another ambient, whatever winding is permitted.

    Parameters
    ----------
    ambient, T_max, rated
        As for ``current_derating``.

    Returns
    -------
    float or array
        The share [1]. Where the permitted temperature is unknown: 1 from the ambient of the rating on; below it that of
        a winding which is permitted 80 degC, since the share grows as the permitted temperature falls; infinite where
        the rating itself is as hot as that. All arguments may be arrays.

    Examples
    --------
    Rated at 40 degC, used at 25: at most the root of (80 - 25) / (80 - 40).

    >>> round(float(derating_at_most(298.15, float("nan"), 313.15)), 4)
    1.1726
    """
    share = np.asarray(current_derating(ambient, T_max, rated))
    unknown, rated = np.isnan(np.asarray(T_max)), np.asarray(rated)
    if not unknown.any():
        return share[()]
    colder = np.maximum(rated - ambient, 0.0) / np.maximum(_LEAST_PERMITTED - rated, 1e-300)
    return np.where(unknown, np.sqrt(1.0 + colder), share)[()]


def continuous_current(
    R_25: Value, R_th1: Value, R_th2: Value, T_max: Value, ambient: Value, P_h: Value = 0.0
) -> Value:
    r"""Current that brings the winding to its permitted temperature in the long run.

    .. math:: I = \sqrt{\frac{T_{max} - T_a - R_{th2} P_h}{R_{25} (1 + \alpha (T_{max} - T_{25})) (R_{th1} + R_{th2})}}

    Parameters
    ----------
    R_25
        Resistance of the winding at 25 degC [ohm].
    R_th1
        Thermal resistance from winding to housing [K/W].
    R_th2
        Thermal resistance from housing to ambient [K/W].
    T_max
        Permitted winding temperature [K].
    ambient
        Temperature around the motor, :math:`T_a` [K].
    P_h
        Loss at the housing, a brushed motor's k_t I_0 w [W].

    Returns
    -------
    float or array
        :math:`I` [A], RMS; 0 where ambient and housing loss alone reach the permitted temperature, NaN where a figure
        is unknown.

    Notes
    -----
    The inverse of ``steady_winding_temperature``; all arguments may be arrays.

    Examples
    --------
    >>> round(float(continuous_current(2.32, 3.1, 14.0, 373.15, 298.15)), 3)
    1.21

    References
    ----------
    .. [1] maxon academy, *Formulae Handbook*, 2nd ed., 2012, section "Thermal behavior".
    """
    rise = T_max - ambient - R_th2 * P_h  # K, left to the copper
    hot = R_25 * (1.0 + COPPER * (T_max - DATA_TEMPERATURE))  # ohm
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.sqrt(np.divide(np.maximum(rise, 0.0), hot * (R_th1 + R_th2)))


def nominal_current(
    R_25: Value, R_th1: Value, R_th2: Value, T_max: Value, k_t: Value, I_0: Value, w_N: Value,
    rated: Value = DATA_TEMPERATURE,
) -> Value:  # fmt: skip
    r"""Nominal current of a brushed motor, from its thermal data.

    .. math:: I_N = \sqrt{\frac{T_{max} - T_d - k_t I_0 \omega_N R_{th2}}
              {R_{25} (1 + \alpha (T_{max} - T_{25}))(R_{th1} + R_{th2})}}

    Parameters
    ----------
    R_25
        Resistance of the winding at 25 degC [ohm].
    R_th1
        Thermal resistance from winding to housing [K/W].
    R_th2
        Thermal resistance from housing to ambient [K/W].
    T_max
        Permitted winding temperature [K].
    k_t
        Torque constant [N*m/A].
    I_0
        No-load current [A].
    w_N
        Nominal speed, :math:`\omega_N` [rad/s].
    rated
        Ambient of the rating, :math:`T_d` [K].

    Returns
    -------
    float or array
        :math:`I_N` [A]; 0 and NaN as in ``continuous_current``.

    Notes
    -----
    Against the nominal current that the shop prints for 302 brushed maxon motors: median error -0.6 %, median absolute
    error 0.9 %; one motor in ten is off by 13 % and more, where the brushes and not the heat set the rating.

    Examples
    --------
    >>> round(float(nominal_current(2.32, 3.1, 14.0, 373.15, 23.4e-3, 36.9e-3, 890.0)), 3)
    1.12
    """
    return continuous_current(R_25, R_th1, R_th2, T_max, rated, k_t * I_0 * w_N)


def continuous_torque(k_t: Value, I_0: Value, current: Value) -> Value:
    r"""Torque at a brushed motor's shaft that a continuous current leaves after friction.

    .. math:: M = \max(k_t (I - I_0), 0)

    Parameters
    ----------
    k_t
        Torque constant, magnets at the temperature of the datasheet [N*m/A].
    I_0
        No-load current [A].
    current
        Continuous current at the speed in question [A].

    Returns
    -------
    float or array
        :math:`M` [N*m]; 0 where the current does not overcome friction.

    Examples
    --------
    >>> round(float(continuous_torque(23.4e-3, 36.9e-3, 1.2)), 4)
    0.0272
    """
    return np.maximum(k_t * (current - I_0), 0.0)


def with_plate(housing: Value, plate: Value) -> Value:
    r"""Thermal resistance of a housing and a plate beside it, both to ambient, :math:`1 / (1/R_{th2} + 1/R_p)` [K/W].

    Parameters
    ----------
    housing
        Of the housing to ambient [K/W].
    plate
        From the flange through the plate to ambient [K/W].

    Returns
    -------
    float or array
        [K/W]

    Examples
    --------
    ServoTube 3804 (installation guide): 0.87 K/W alone, 0.61 with a plate of 25 x 25 x 2.5 cm, thus of 2.04 K/W:

    >>> round(with_plate(0.87, 2.04), 2)
    0.61
    """
    return 1.0 / (1.0 / housing + 1.0 / plate)
