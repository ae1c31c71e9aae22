r"""Thermal figures, and masses of encoders and controllers, where no peer prints any: assumed, with wide bands.

Makers of actuators print no thermal figure. A body of mass m and mean density rho sheds heat over at least the area of
a cube of it; a winding is a share of its motor's mass. Bands are factors of 2 either
way, of a brushless winding's resistance 4. Masses of encoders and controllers are those of the 66 and 24 that ship with
one, from the 5th to the 95th percentile and somewhat beyond. Holding brakes: regressions over the static torque of 18
inertias, 6 masses and 82 powers of coils that makers of servo motors print, with bands from the 5th to the 95th
percentile, and wider of so few masses.

.. math:: R_{th2} = \frac{1}{h\,6\,(m/\rho)^{2/3}}, \quad C_w = c_w m, \quad C_h = c_h m

References
----------
.. [1] F. Incropera, D. DeWitt et al., *Fundamentals of Heat and Mass Transfer*, 6th ed., table 1.1: natural convection
   of gases 2 to 25 W/m^2 K.
.. [2] Medians of the motors that ship: R_th1 m^(2/3) 0.84 (brushed) and 0.22 (brushless), c_w 43 and 25 J/(kg K),
   c_h 390 and 500 J/(kg K); the motor is taken as 0.4 of an actuator's mass.
"""

from __future__ import annotations

from math import exp, inf, log
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog.estimates.fit import Fit
from drivesizer.catalog.estimates.laws import Law
from drivesizer.catalog.tables import Catalog, Estimates, Table
from drivesizer.physics.stepper.pull_out import PULL_OUT_SHARE
from drivesizer.physics.stepper.starting import START_BAND
from drivesizer.physics.thermal import continuous_current, rated_ambient, resistance_25, steady_winding_temperature

__all__ = [
    "ASSUMED",
    "CONVECTION",
    "DENSITY",
    "MOUNTED",
    "RULE",
    "assumed_mass",
    "estimates_by_rated_current",
    "peak_torque_estimates",
    "rule_of_thumb_bands",
]

CONVECTION = 10.0  # W/m^2 K
DENSITY = 2000.0  # kg/m^3, of an actuator whole
_MOTOR = 0.4  # of an actuator's mass
_HOTTEST = 453.15  # K, thermal class 180 (H) of IEC 60085
_R_TH = ("thermal_resistance_winding", "thermal_resistance_housing")
_TAU = ("winding_time_constant", "motor_time_constant")
_ANY_RATIO = "mechanical time constant of 47 brushed actuators, which no ratio changes"
_CONVECTION = "natural convection, 10 W/m^2 K over the case"
_WINDING, _HOUSING = "a winding like that of motors, 0.4 of the mass", "heat capacity per mass of motors"
_PULL_OUT = "7 printed curves of 5 steppers against their ideal two-phase model"
_STARTING = "an undamped rotor that just follows the field"
_BRAKES = "a holding brake of that torque, as of servo motors from 0.2 to 140 N m"
_ALL = (-inf, inf)


def _law(
    of: str, figure: str, factor: float, terms: dict[str, float], source: str, band: float = 2.0,
    section: str = "actuators",
) -> Fit:  # fmt: skip
    coefficients, ranges = (log(factor), *terms.values()), (_ALL,) * len(terms)
    ends = (-log(band), log(band))
    return Fit(Law(section, of, figure, tuple(terms)), coefficients, ends, ends, ranges, 0, 0, (), source)


ASSUMED: tuple[Fit, ...] = (
    _law("", _R_TH[1], DENSITY ** (2 / 3) / (6.0 * CONVECTION), {"mass": -2 / 3}, _CONVECTION),
    _law("brushed", _R_TH[0], 0.84 * _MOTOR ** (-2 / 3), {"mass": -2 / 3}, _WINDING),
    _law("brushless", _R_TH[0], 0.22 * _MOTOR ** (-2 / 3), {"mass": -2 / 3}, _WINDING, 4.0),
    _law("brushed", "winding_time_constant", 43.0 * _MOTOR, {_R_TH[0]: 1.0, "mass": 1.0}, _WINDING),
    _law("brushless", "winding_time_constant", 25.0 * _MOTOR, {_R_TH[0]: 1.0, "mass": 1.0}, _WINDING),
    _law("brushed", "motor_time_constant", 390.0, {_R_TH[1]: 1.0, "mass": 1.0}, _HOUSING),
    _law("brushless", "motor_time_constant", 500.0, {_R_TH[1]: 1.0, "mass": 1.0}, _HOUSING),
    _law("brushed", "output_inertia", 0.011, {"output_constant": 1.0}, _ANY_RATIO, 4.0),
    _law("", "mass", 0.02, {}, "a motor encoder, 8 to 50 g", 2.5, "encoders"),
    _law("", "mass", 0.045, {}, "a controller from bare module to housed, 7 to 290 g", 6.5, "controllers"),
    _law("", "pull_out_share", PULL_OUT_SHARE[0], {}, _PULL_OUT, PULL_OUT_SHARE[1], "steppers"),
    _law("", "rotor_inertia", 1.56e-5, {"holding_torque": 1.09}, "110 steppers of 0.1 to 3 N*m", 1.5, "steppers"),
    _law("", "mass", 0.605, {"holding_torque": 0.73}, "67 steppers of 0.1 to 9 N*m", 1.4, "steppers"),
    _law(
        "",
        "start_speed",
        4.0,
        {"holding_torque": 0.5, "rotor_inertia": -0.5, "full_steps": -0.5},
        _STARTING,
        START_BAND,
        "steppers",
    ),
    _law("", "inertia", 4.1e-6, {"static_torque": 1.08}, _BRAKES, 6.0, "brakes"),
    _law("", "mass", 0.2, {"static_torque": 0.68}, _BRAKES, 2.5, "brakes"),
    _law("", "power", 8.8, {"static_torque": 0.285}, _BRAKES, 1.6, "brakes"),
    Fit(
        Law("", "", "max_winding_temperature", ()),
        (),
        (0.0, 0.0),
        (0.0, 0.0),
        (),
        0,
        0,
        (),
        "no rating is printed: from the lowest that makers of motors print to thermal class 180 (H)",
    ),
    Fit(
        Law("", "", "nominal_torque", ()),
        (),
        (0.0, 0.0),
        (0.0, 0.0),
        (),
        0,
        0,
        (),
        "a rule of thumb and no maker's limit: from there to the stall",
    ),
    Fit(
        Law("", "", "peak_torque", ("nominal_torque", "stall_torque")),
        (),
        (0.0, 0.0),
        (0.0, 0.0),
        (),
        0,
        0,
        (),
        "not printed: a peak from what is continuous to a printed stall, what is continuous up to the peak",
    ),
    Fit(
        Law("", "", "thermal_resistance_housing", ("thermal_resistance_housing",)),
        (),
        (0.0, 0.0),
        (0.0, 0.0),
        (),
        0,
        0,
        (),
        "the mounting of the spec",
    ),
    Fit(
        Law("", "", "max_winding_temperature", ("nominal_current", "resistance", *_R_TH)),
        (),
        (0.0, 0.0),
        (0.0, 0.0),
        (),
        0,
        0,
        (),
        "what the nominal current brings about",
    ),
)
_RATED = -1  # the last of all laws: that of ``estimates_by_rated_current``
MOUNTED = -2  # and the one before it: that of ``catalog.view.mounted``
_UP_TO_STALL = -3  # that of ``peak_torque_estimates``
RULE = -4  # that of ``of_catalog``
UNRATED = -5  # that of a permitted temperature without any rating
_LEAST = {"brushed": 358.15, "brushless": 373.15}  # K: 85 and 100 degC, of 326 and 356 motors that print one
_STALL = {"nominal_torque": "stall_torque", "nominal_current": "stall_current"}
_LEAST_SHARE = 0.2  # of its stall torque that an actuator is rated for, for a moment: makers of servos advise as much
_MOST = 10.0  # times its continuous torque, for a moment; of the 201 that print both 192 have 1.3 to 5, 196 up to 10


def assumed_mass(section: str) -> tuple[float, float, float]:
    """Mass of an encoder or controller of which nothing is known: value, 5th and 95th percentile [kg].

    >>> [round(mass, 3) for mass in assumed_mass("encoders")]
    [0.02, 0.008, 0.05]
    """
    own = next(fit for fit in ASSUMED if (fit.law.section, fit.law.figure) == (section, "mass"))
    value = exp(own.coefficients[0])
    low, high = own.band
    return value, value * exp(low), value * exp(high)


def estimates_by_rated_current(table: Table[Any], found: dict[str, Estimates]) -> dict[str, Estimates]:
    """Estimates in accord with the printed nominal current.

    At that current no winding is hotter in the long run than is permitted, or than the best thermal class is where no
    permitted temperature is printed: estimated thermal resistances are no larger. What such a winding then reaches the
    maker permits, by the part's own rating and that of no other part. A brushed motor, of which brushes or gears may
    set the rating, permits anything from there to the best class.
    """
    if "max_winding_temperature" not in table.columns:
        return found
    unstated, rating = np.isnan(table["max_winding_temperature"]), _rated_current(table)
    winding, housing = (_filled(table, found, name) for name in _R_TH)
    share = np.fmin(1.0, _largest_resistance(table, rating) / (winding + housing))
    limited = {name: _scaled(found[name], share) for name in _R_TH if name in found}
    times = {name: _scaled(found[name], share[:1].repeat(3, 0)) for name in _TAU if name in found}
    found = found | limited | times
    one, other = (_filled(table, found, name) for name in _R_TH)
    warm = np.asarray(steady_winding_temperature(rated_ambient(table), resistance_25(table), one, other, rating))
    rows = np.flatnonzero(unstated & (warm < _HOTTEST + 0.1).all(axis=0))
    value, low, high = warm[:, rows]
    brushed = table["kind"][rows] == "brushed"
    least = np.fmax(table["ambient_max"][rows], _LEAST["brushed"])  # it runs in that ambient
    low = np.where(brushed, np.fmax(high, least), low)
    high = np.where(brushed, np.fmax(_HOTTEST + 0.1, low), high)
    value = np.where(brushed, (low + high) / 2.0, value)
    rated = Estimates(rows, value, low, high, np.full(len(rows), _RATED))
    rest = np.setdiff1d(np.flatnonzero(unstated & np.isnan(rating)), rows)
    both: list[NDArray[Any]] = [np.concatenate(columns) for columns in zip(rated, _unrated(table, rest), strict=True)]
    order = np.argsort(both[0])
    every = Estimates(*(column[order] for column in both))
    return found | {"max_winding_temperature": every} if len(order) else found


def _rated_current(table: Table[Any]) -> NDArray[np.float64]:
    """The nominal current; where none is printed that of the nominal torque [A]."""
    k_t = _output_constant(table) if table.section == "actuators" else table["torque_constant"]
    by_torque = table["nominal_torque"] / k_t + np.nan_to_num(table["no_load_current"])
    return np.where(np.isnan(table["nominal_current"]), by_torque, table["nominal_current"])


def _output_constant(table: Table[Any]) -> NDArray[np.float64]:
    """Torque at the output of actuators per ampere, the losses of the gear included."""
    inner = table["ratio"] * table["efficiency"] * table["motor_torque_constant"]
    return np.asarray(np.where(np.isnan(inner), table["torque_constant"], inner))


def _unrated(table: Table[Any], rows: NDArray[np.int64]) -> Estimates:
    """The permitted winding temperature of parts that print neither it nor a rating, nor what follows from one."""
    known = np.isin(table["kind"][rows], tuple(_LEAST))
    rows = rows[known]
    low = np.array([_LEAST[kind] for kind in table["kind"][rows].tolist()], float)
    high = np.full(len(rows), _HOTTEST)
    return Estimates(rows, np.sqrt(low * high), low, high, np.full(len(rows), UNRATED))


def peak_torque_estimates(table: Table[Any], found: dict[str, Estimates]) -> dict[str, Estimates]:
    """Estimates with ratings that actuators do not print: peaks from the continuous figure to that at stall.

    A peak current is at least that of a printed peak torque; a continuous torque is a tenth to all of the peak.

    Where no stall is printed either nothing bounds it: the middle is that of a band up to ten times the continuous one.
    """
    if table.section != "actuators":
        return found
    more = dict[str, Estimates]()

    def between(name: str, low: NDArray[np.float64], usual: NDArray[np.float64], high: NDArray[np.float64]) -> None:
        rows = np.flatnonzero(np.isnan(table[name]) & (low < usual))
        if len(rows):
            middle, law = np.sqrt(low * usual)[rows], np.full(len(rows), _UP_TO_STALL)
            more[name] = Estimates(rows, middle, low[rows], high[rows], law)

    at_peak = table["peak_torque"] / _output_constant(table) + np.nan_to_num(table["no_load_current"])
    least = {"peak_torque": table["nominal_torque"], "peak_current": np.fmax(_rated_current(table), at_peak)}
    for name, lasting in least.items():
        stall = table[name.replace("peak", "stall")]
        low = np.where(np.isnan(lasting), _LEAST_SHARE * stall, lasting)
        unprinted = np.isnan(stall)
        between(name, low, np.where(unprinted, _MOST * lasting, stall), np.where(unprinted, inf, stall))
    short = np.where(np.isnan(table["peak_torque"]), table["stall_torque"], table["peak_torque"])
    between("nominal_torque", short / _MOST, short, short)
    return found | more


def rule_of_thumb_bands(catalog: Catalog) -> dict[str, Estimates]:
    """Figures of actuators that are a rule of thumb, with a band from there to the stall."""
    table, found = catalog.actuators, dict[str, Estimates]()
    for name, stall in _STALL.items():
        rows = catalog.by_rule("actuators", name)
        value = table[name][rows]
        high = np.where(np.isnan(table[stall][rows]), inf, table[stall][rows])
        wide = high > value  # written so that NaN fails too
        if wide.any():
            law = np.full(int(wide.sum()), RULE)
            found[name] = Estimates(rows[wide], value[wide], value[wide], high[wide], law)
    return found


def _largest_resistance(table: Table[Any], rating: NDArray[np.float64]) -> NDArray[np.float64]:
    """Thermal resistance with which a rated current brings the winding to what is permitted [K/W]."""
    one, printed = np.ones(len(table)), table["max_winding_temperature"]
    hottest = np.where(np.isnan(printed), _HOTTEST, printed)
    current = continuous_current(np.asarray(resistance_25(table)), one, 0.0 * one, hottest, rated_ambient(table))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(current / rating) ** 2


def _filled(table: Table[Any], found: dict[str, Estimates], name: str) -> NDArray[np.float64]:
    """Value, low and high of every part, shape (3, parts): printed ones are all three alike."""
    columns = np.tile(table[name], (3, 1))
    if name in found:
        columns[:, found[name].rows] = found[name].value, found[name].low, found[name].high
    return columns


def _scaled(found: Estimates, share: NDArray[np.float64]) -> Estimates:
    value, low, high = np.array([found.value, found.low, found.high]) * share[:, found.rows]
    low = np.minimum(low, high)  # what is cut at one end need not be cut alike at the other or in the middle
    return found._replace(value=np.clip(value, low, high), low=low, high=high)
