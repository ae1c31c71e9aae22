"""How warm a winding gets.

Convention: temperatures are absolute. Copper loss alone heats here; friction and iron losses at the housing do not.
Symbols: T temperature [K], R resistance [ohm], R_th thermal resistance [K/W], I current [A].
"""

from __future__ import annotations

import math

__all__ = ["COPPER", "DATA_TEMPERATURE", "current_derating", "steady_winding_temperature"]

COPPER = 0.0039  # 1/K, of the resistance at 25 degC [1]; the handbook's 0.00393 belongs to 20 degC
DATA_TEMPERATURE = 298.15  # K, at which datasheets give resistance and nominal current


def steady_winding_temperature(ambient: float, R_25: float, R_th: float, I_rms: float) -> float:
    r"""Mean temperature of a winding in the long run, its resistance growing with it.

    .. math:: T_w = T_a + R_{th} R_{25} I^2 \frac{1 + \alpha (T_a - T_{25})}{1 - \alpha R_{th} R_{25} I^2}

    Parameters
    ----------
    ambient
        Temperature around the motor, :math:`T_a` [K].
    R_25
        Resistance of the winding at 25 degC [ohm].
    R_th
        Thermal resistance from winding to ambient, :math:`R_{th1} + R_{th2}` [K/W].
    I_rms
        RMS current [A].

    Returns
    -------
    float
        :math:`T_w` [K]; infinite where the loss grows faster than the heat is carried off (thermal runaway),
        NaN where a figure is unknown.

    Examples
    --------
    >>> round(steady_winding_temperature(298.15, 2.32, 17.1, 1.0) - 298.15, 2)
    46.93

    References
    ----------
    .. [1] maxon academy, *Formulae Handbook*, 2nd ed., 2012, section "Thermal behavior".
    """
    heating = R_th * R_25 * I_rms * I_rms  # K, were the winding at 25 degC
    growth = 1.0 - COPPER * heating
    if growth <= 0.0:
        return math.inf
    return ambient + heating * (1.0 + COPPER * (ambient - DATA_TEMPERATURE)) / growth


def current_derating(ambient: float, T_max: float) -> float:
    r"""Share of the nominal current that remains in another ambient than the datasheet's 25 degC.

    .. math:: \sqrt{(T_{max} - T_a) / (T_{max} - T_{25})}

    Parameters
    ----------
    ambient
        Temperature around the motor, :math:`T_a` [K].
    T_max
        Permitted winding temperature [K]; NaN unknown.

    Returns
    -------
    float
        The share [1]; where the permitted temperature is unknown, 1 at 25 degC and NaN elsewhere.
    """
    if math.isnan(T_max):
        return 1.0 if ambient == DATA_TEMPERATURE else math.nan
    if not T_max > DATA_TEMPERATURE:
        return math.nan
    return math.sqrt(max(T_max - ambient, 0.0) / (T_max - DATA_TEMPERATURE))
