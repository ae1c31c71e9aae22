"""Heat and electrical stress of windings over a load cycle: losses, current, voltage, behind one belt or many."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.cycle_at_gearhead import DIRECTION, SPEED, AtGearhead, Peak
from drivesizer.physics.drive_train import nominal_friction
from drivesizer.physics.figures import Figures, once_per_part
from drivesizer.physics.load_cycle import Figure
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.thermal import rated_ambient, resistance_25, resistance_at, steady_winding

__all__ = [
    "AtGearheads", "Heat", "Parts", "Stress", "behind_one", "belts_of", "heat",
    "housing_loss", "on", "put", "replaced", "scales", "stress", "temperature_at_most", "volts_of",
]  # fmt: skip


# -- Heat and electrical stress of motors over a load cycle, on columns: losses, warm resistance, current, voltage.


Array = NDArray[np.float64]


class Parts(NamedTuple):
    """Figures of the candidates' parts by field name: columns, NaN where there is no such part."""

    motor: Any
    gearhead: Any
    encoder: Any
    controller: Any
    brake: Any = None  # None where no drive has one

    def on(self, rows: Any) -> Parts:
        """The parts of some of the candidates: by a mask, numbers or a slice."""
        return Parts(*(None if part is None else part.on(rows) for part in self))


Record = TypeVar("Record", bound=tuple[Any, ...])


def on(record: Record, rows: Any) -> Record:
    """A record of columns, records among them, at some of the candidates.

    Parameters
    ----------
    record
        Columns, and records of columns.
    rows
        A mask, numbers or a slice.

    Returns
    -------
    record
        Of the same type.
    """
    if isinstance(rows, np.ndarray) and rows.dtype == bool:  # numbers are quicker, column by column
        rows = np.flatnonzero(rows)
    if isinstance(rows, slice):
        return type(record)(*(on(x, rows) if isinstance(x, tuple) else x[rows] for x in record))
    taken: dict[int, Any] = {}  # columns that are one and the same stay so
    for x in record:
        if id(x) not in taken:
            taken[id(x)] = on(x, rows) if isinstance(x, tuple) else x.take(rows, axis=0)
    return type(record)(*(taken[id(x)] for x in record))


def put(column: NDArray[Any], rows: NDArray[Any], some: NDArray[Any]) -> NDArray[Any]:
    """A column with some of its rows replaced.

    Parameters
    ----------
    column
        Shape (rows, ...).
    rows
        Row numbers or a mask.
    some
        New values of these rows.

    Returns
    -------
    Array
        A copy of the column.

    >>> put(np.array([1, 2, 3]), np.array([True, False, True]), np.array([7, 8])).tolist()
    [7, 2, 8]
    """
    changed = column.copy()
    changed[rows] = some
    return changed


def replaced(record: Record, rows: NDArray[np.int64], some: Record) -> Record:
    """A record of columns with those of some candidates replaced.

    Parameters
    ----------
    record, some
        Of all candidates and of these.
    rows
        Which they are.

    Returns
    -------
    record
        Of the same type; columns that are one and the same in both stay so.
    """
    made: dict[tuple[int, int], Array] = {}
    for a, b in zip(record, some, strict=True):
        if (id(a), id(b)) not in made:
            made[id(a), id(b)] = put(a, rows, b)
    return type(record)(*(made[id(a), id(b)] for a, b in zip(record, some, strict=True)))


class Heat(NamedTuple):
    """Losses of a motor beside its copper, and its mean temperature in the long run."""

    friction: Array  # loss at the housing per speed of the gearhead's output [W s/rad]
    iron: Array  # and per square of it [W s^2/rad^2]
    mean: Array  # W, over the cycle
    winding: Array  # K, steady mean; infinite when it runs away


class Stress(NamedTuple):
    """Largest torque and current, and largest voltage while the winding is cold."""

    torque: Array  # N*m
    current: Peak  # A
    cold_voltage: Peak  # V, winding at the ambient's temperature


def housing_loss(motor: Figures, ratio: Array) -> tuple[Array, Array]:
    r"""Losses of friction and iron at the housing, per speed of the gearhead's output and per square of it.

    Brushed: the friction, :math:`(M_c + b w) |w|`. Brushless: friction and iron together, a loss P_N that with the
    copper's warms the winding to its permitted temperature at the catalogue's nominal point in the ambient of that
    rating; not below 0. Over the speed it goes as the friction does:

    .. math:: P = P_N \frac{(M_c + b w) w}{(M_c + b w_N) w_N}

    With unknown friction it goes as the square of the speed. Where a figure of that point is unknown: the friction.

    Parameters
    ----------
    motor
        Figures of the motors by field name: columns.
    ratio
        Of the gearhead [1]: a column.

    Returns
    -------
    tuple of arrays
        Loss per speed [W*s/rad] and per square of it [W*s^2/rad^2].
    """
    rubs, lost, coulomb, viscous, left, w_N = _nominal_loss(motor)
    scale = np.where(rubs, 1.0, lost)
    rubbing, growing = scale * coulomb * ratio, scale * viscous * ratio**2
    if (shapeless := ~rubs & ~np.isfinite(lost)).any():
        rubbing = np.where(shapeless, 0.0, rubbing)
        growing = np.where(shapeless, np.maximum(left, 0.0) * (ratio / w_N) ** 2, growing)
    return rubbing, growing


@once_per_part
def _nominal_loss(motor: Figures) -> tuple[Any, ...]:
    """Of each motor: whether only friction counts, loss per loss by friction, friction, loss [W] and speed of it."""
    brushed = motor["kind"] == "brushed"
    rise = motor["max_winding_temperature"] - rated_ambient(motor)
    R_th2 = motor["thermal_resistance_housing"]
    hot = resistance_at(resistance_25(motor), motor["max_winding_temperature"])
    copper = hot * motor["nominal_current"] ** 2
    left = (rise - (motor["thermal_resistance_winding"] + R_th2) * copper) / R_th2
    coulomb, viscous = nominal_friction(motor)
    w_N = motor["nominal_speed"]
    with np.errstate(divide="ignore", invalid="ignore"):
        lost = np.maximum(left, 0.0) / ((coulomb + viscous * w_N) * w_N)  # per loss by friction
    return brushed | np.isnan(left + w_N), lost, coulomb, viscous, left, w_N


def heat(
    ambient: Figure,
    cycle: AtGearhead,
    demands: Demands,
    motor: Figures,
    losses: tuple[Array, Array] | None = None,
    from_gearhead: Array | float = 0.0,
) -> Heat:
    """Losses at the housing, and mean temperature of the winding in the long run.

    Parameters
    ----------
    ambient
        Temperature around the motors [K].
    cycle
        The load cycle at the gearhead's output.
    demands
        Required torque and current of each candidate.
    motor
        Figures of the motors by field name: columns.
    losses
        What ``housing_loss`` gives, where it is at hand.
    from_gearhead
        Loss of the gearhead that heats the housing, per speed of its output [W*s/rad].

    Returns
    -------
    Heat
        Columns over candidates.
    """
    rubbing, iron = losses or housing_loss(motor, demands.total_ratio)
    if not cycle.acts[SPEED]:  # no friction at rest
        rubbing, iron = np.zeros_like(rubbing), np.zeros_like(iron)
    elif np.any(from_gearhead):  # NaN too
        rubbing = rubbing + from_gearhead
    moments = cycle.moments
    mean = rubbing * moments[DIRECTION, SPEED] + iron * moments[SPEED, SPEED]
    least = np.where(demands.complete, mean, np.nan_to_num(mean))  # of an unknown friction
    winding = steady_winding(motor, ambient, demands.rms_current, least)
    return Heat(rubbing, iron, mean, np.asarray(winding))


def stress(ambient: Figure, cycle: AtGearhead, demands: Demands, motor: Figures, leads: Any = 0.0) -> Stress:
    """Largest current of candidates, and largest voltage while the winding is cold; warm: see ``limits_over_time``.

    Parameters
    ----------
    ambient
        Temperature around the motors [K].
    cycle
        The load cycle at the gearhead's output.
    demands
        Required torque and current of each candidate.
    motor
        Figures of the motors by field name: columns.
    leads
        Resistance that takes of the voltage before the winding (``power_stage.Feed.leads``) [ohm].

    Returns
    -------
    Stress
        Columns over candidates.
    """
    k_t = motor["torque_constant"]
    cold = resistance_at(resistance_25(motor), ambient)
    torque = cycle.peak(demands.coefficients, demands.left_out)
    volts = cycle.peak(volts_of(demands, k_t, np.asarray(cold)), demands.left_out)
    if np.any(leads):
        more = cycle.peak(volts_of(demands, k_t, np.asarray(cold + leads)), demands.left_out)
        larger = more.value > volts.value
        volts = Peak(np.where(larger, more.value, volts.value), np.where(larger, more.time, volts.time))
    return Stress(torque.value, Peak(torque.value / k_t, torque.time), volts)


def temperature_at_most(ambient: Figure, cycle: AtGearhead, heat: Heat, stress: Stress, motor: Figures) -> Array:
    """Temperature that no winding exceeds: in the long run at the largest current and loss all the time [K].

    Parameters
    ----------
    ambient
        Temperature around the motors [K].
    cycle
        The load cycle at the gearhead's output.
    heat, stress
        Losses and largest current of each candidate.
    motor
        Figures of the motors by field name: columns.

    Returns
    -------
    array
        Temperature of each candidate [K]; infinite at thermal runaway, NaN where a figure is unknown.
    """
    fast = cycle.peak_speed
    loss = heat.friction * fast + heat.iron * fast**2
    return np.asarray(steady_winding(motor, ambient, stress.current.value, loss))


def volts_of(demands: Demands, k_t: Array, resistance: Array) -> Array:
    r"""Coefficients of the motor's voltage from the six functions, :math:`V = R I + k_e K w`.

    Parameters
    ----------
    demands
        Required torque and current of each candidate.
    k_t
        Torque constants [N*m/A].
    resistance
        Of the windings [ohm].

    Returns
    -------
    array
        Coefficients, shape (candidates, 6).
    """
    c = demands.coefficients * (resistance / k_t)[:, None]
    c[:, SPEED] += demands.back_emf * demands.total_ratio
    return c


# -- A load cycle behind several belts at once: candidates in the order of their belts, each with its own belt.
#
# What hangs on the belt is computed belt by belt, from the same rows as for that belt alone, so that not a bit of it
# differs; whatever else there is to compute is then done for all belts in one go. So are bounds, which may round
# otherwise: behind a belt of ratio 1, the others' scales of the functions being in the coefficients.


_FIGURES = ("belt", "rms_torque", "peak_torque", "held", "peak_speed", "mean_speed", "sustained_speed", "mean_power",
            "peak_power", "load_torque", "load_speed")  # fmt: skip


class AtGearheads(AtGearhead):
    """A load cycle at the gearheads' outputs, behind the belts of candidates."""

    def __init__(self, ats: Sequence[AtGearhead], which: NDArray[np.int64]) -> None:
        """``which``: the number of each candidate's belt, never falling."""
        self.ats, self.which, self.base = ats, which, ats[0].base

    def __getattr__(self, name: str) -> Any:
        """A figure of each candidate's belt, made a column on first use."""
        if name == "moments":
            return _Moments(self)
        if name not in _FIGURES:
            raise AttributeError(name)
        column = np.array([getattr(at, name) for at in self.ats])[self.which]
        setattr(self, name, column)
        return column

    def slope(self, c: Array) -> Array:
        """Half of the gradient of the mean square of c f(t), by each coefficient."""
        found: Array = behind_each(self, lambda at, some: at.slope(some), c)
        return found

    def turned(self, exponent: float) -> Array:
        """Mean over the cycle of the output torque to an exponent, times speed there, of each candidate."""
        found: Array = np.array([at.turned(exponent) for at in self.ats])[self.which]
        return found

    @cached_property
    def parts(self) -> list[tuple[AtGearhead, slice]]:
        """The belts that have candidates, and the rows of these."""
        ends = np.searchsorted(self.which, np.arange(len(self.ats) + 1)).tolist()
        return [(at, slice(a, b)) for at, a, b in zip(self.ats, ends[:-1], ends[1:], strict=True) if b > a]

    def on(self, rows: Any) -> AtGearhead:
        """Of some of the candidates, in their order."""
        which = self.which[rows]
        if len(which) and which[0] != which[-1]:
            return AtGearheads(self.ats, which)
        return self.ats[which[0] if len(which) else 0]

    def peak(self, coefficients: Array, left_out: NDArray[np.bool_] | None = None) -> Peak:
        """Largest absolute value of what is linear in the functions."""
        found: Peak = behind_each(self, lambda at, *columns: at.peak(*columns), coefficients, left_out)
        return found


class _Moments:
    """Means of products of two functions over the cycle, behind the belts of candidates: columns."""

    def __init__(self, cycle: AtGearheads) -> None:
        self.cycle = cycle

    def __getitem__(self, pair: tuple[int, int]) -> Array:
        found: Array = np.array([at.moments[pair] for at in self.cycle.ats])[self.cycle.which]
        return found


def behind_each(at: AtGearhead, compute: Callable[..., Any], *columns: Any) -> Any:
    """A function of candidates behind one belt, applied to those behind any number of them.

    Parameters
    ----------
    at
        The load cycle behind their belts.
    compute
        Function of the load cycle behind one belt and columns over its candidates: columns, or records of columns.
    columns
        Over all candidates: arrays, records of them, or parts.

    Returns
    -------
    array or record of arrays
        Columns over all candidates.
    """
    if not isinstance(at, AtGearheads):
        return compute(at, *columns)
    return put_together([compute(one, *(_some(column, rows) for column in columns)) for one, rows in at.parts])


def belts_of(at: AtGearhead, count: int) -> list[slice]:
    """Candidates, of so many, that are behind the same belt.

    Parameters
    ----------
    at
        The load cycle behind their belts.
    count
        Number of candidates.

    Returns
    -------
    list of slice
        One for each belt that has any; at least one.
    """
    return [rows for _, rows in at.parts] if isinstance(at, AtGearheads) else [slice(0, count)]


def scales(at: AtGearhead, count: int) -> Array:
    """Factors by which belts scale the functions of the cycle.

    Parameters
    ----------
    at
        The load cycle behind the candidates' belts.
    count
        Number of candidates.

    Returns
    -------
    array
        Shape (candidates, 6) [1].
    """
    if isinstance(at, AtGearheads):
        found: Array = np.stack([one.scale for one in at.ats])[at.which]
        return found
    return np.broadcast_to(at.scale, (count, len(at.scale)))


def behind_one(at: AtGearhead, demand: Demands) -> tuple[AtGearhead, Demands]:
    """Candidates behind any belts as such behind one of ratio 1: what is computed of them may round otherwise.

    Parameters
    ----------
    at
        The load cycle behind their belts.
    demand
        Columns over candidates, of ``demands``.

    Returns
    -------
    tuple
        The load cycle behind that belt, and the columns by its functions.
    """
    if _is_of_one(at):
        return at, demand
    scaled, ratio = demand.coefficients * scales(at, len(demand.total_ratio)), demand.total_ratio * at.belt
    return at.base.behind(1.0), demand._replace(coefficients=scaled, total_ratio=ratio)


def _is_of_one(at: AtGearhead) -> bool:
    return not isinstance(at, AtGearheads) and bool(at.belt == 1.0)


def _some(column: Any, rows: slice) -> Any:
    """A column, record or parts of some candidates."""
    if column is None:
        return None
    if hasattr(column, "on"):
        return column.on(rows)
    return on(column, rows) if isinstance(column, tuple) else column[rows]


def put_together(found: Sequence[Any]) -> Any:
    """Columns, or records of columns, one after the other."""
    first = found[0]
    if len(found) == 1:
        return first
    if not isinstance(first, tuple):
        return np.concatenate(found)
    if all(one[0] is one[-1] for one in found) and not hasattr(first, "_fields"):
        return (put_together([one[0] for one in found]),) * len(first)  # a pair of bounds that are the same
    merged = [put_together(same) for same in zip(*found, strict=True)]
    return type(first)(*merged) if hasattr(first, "_fields") else tuple(merged)
