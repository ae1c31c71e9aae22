"""Output error: figures with which the drive's response is nearest to the log, their bands, what is not separated.

The start is a regression; ``scipy.optimize.least_squares`` goes on from there on speed and current as the model answers
the log's own input, each weighted by what was left of it. A figure whose band would say nothing is tied to another or
to what is known, and named. Bands are the widest of three: formal, by blocks of the log drawn anew, and by its parts,
the last two to first order (one step of Gauss and Newton with other weights), as residuals are coloured.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import isnan, nan, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, lsq_linear

import drivesizer.control.engine.layout as at
from drivesizer.control.drive_train import DriveTrain, columns, discretised
from drivesizer.control.engine.layout import PARAMETERS, STATE
from drivesizer.control.engine.start import mechanical, tally
from drivesizer.files.machine_code import machine_code
from drivesizer.identification import declared
from drivesizer.identification.kernel import KERNEL
from drivesizer.identification.log import Log
from drivesizer.kernel.heat import added, bodies_of, law_of, spread
from drivesizer.physics.drive_train import through_gears
from drivesizer.physics.motion_curves import local_parabola
from drivesizer.physics.thermal import COPPER, resistance_at
from drivesizer.results.identification import IdentifiedFigure, Inseparable, Trace

Array = NDArray[np.float64]
Figures = dict[str, float]

# -- The drive of every closed loop under a log's own voltage or current: response by figures, a start by regression.
#
# A current that is the input is a winding of 1 ohm without back-EMF whose current follows at once. Without a known
# rotor all inertia counts at the motor; a load that is known to be weight or was measured goes through the gears with
# their losses. Symbols as in ``control.drive_train``.

FIGURES = ("R", "L", "k_e", "k_t", "J", "M_c", "b", "e", "e_back", "delay")
_QUICK = 1e-3  # electrical time constant in samples, where there is none to speak of
_LEAST = 1e-6  # of a sample, that a part of it is
_SMOOTHED = 9.0  # samples around each of which a parabola is fitted
_FEW = 10  # samples of a known direction, with fewer than which all count
_CERTAIN = 4.0  # times the noise of the speed, above which its direction is known
_FASTEST = 5.0  # per cent of the top speed: below it the direction of friction is unknown


@dataclass(frozen=True, slots=True, kw_only=True)
class TwoWayTrain(DriveTrain):
    """A drive train whose gears lose another share where the load drives the motor."""

    back_efficiency: float

    @property
    def shares(self) -> tuple[float, float]:
        """Torque at the motor per torque at the driven shaft, driving and braking."""
        return through_gears(self.ratio, self.efficiency)[0], through_gears(self.ratio, self.back_efficiency)[1]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Record:
    """A log on an even grid, as the model takes it."""

    h: float  # s between samples
    driven: str  # voltage or current
    u: Array  # V or A, held from each sample to the next
    load: Array  # N*m at the output of the gears, against forward motion; as many and the end's
    outputs: Mapping[str, Array]  # current, speed: as measured
    start: Array  # rad/s where a stretch starts, else NaN
    ratio: float = 1.0  # of the gears
    rotor: float = nan  # kg*m^2 at the motor that is known to lie before the gears
    warm: Array | None = None  # share by which the winding's resistance is above that at 25 degC, where that is logged

    @property
    def loaded(self) -> bool:
        """Whether a load at the output is known."""
        return bool(np.any(self.load != 0.0))

    @property
    def lead(self) -> NDArray[np.bool_]:
        """Whether a sample follows a start so closely that it says little."""
        return np.asarray(~np.isnan(self.start), bool)


def train_of(x: Figures, record: Record) -> TwoWayTrain:
    """The drive train of some figures; of a current that is the input a winding that follows at once."""
    of_current = record.driven == "current"
    R = 1.0 if of_current else x["R"]
    rotor = x["J"] if isnan(record.rotor) else min(record.rotor, x["J"])
    return TwoWayTrain(
        resistance=R, inductance=max(0.0 if of_current else x["L"], _QUICK * record.h * R),
        torque_constant=x["k_t"], back_emf_constant=0.0 if of_current else x["k_e"], viscous=x["b"], friction=x["M_c"],
        motor_inertia=rotor, load_inertia=(x["J"] - rotor) * record.ratio**2, gear_ratio=record.ratio,
        gear_efficiency=x["e"], back_efficiency=x["e_back"],
    )  # fmt: skip


def response(x: Figures, record: Record) -> dict[str, Array]:
    """Current, speed and angle at each sample; each voltage begins so late, within a sample too."""
    train, out = train_of(x, record), np.zeros((len(record.u), 3))
    whole = int(np.floor(x["delay"]))
    share = min(max(x["delay"] - whole, _LEAST), 1.0 - _LEAST)
    parts = record.h * np.array([share, 1.0 - share])
    M = discretised(columns([train, train]), np.full((2, 1), train.resistance), parts)
    named = mechanical(train) | {
        "R25": train.resistance, "K_T": train.torque_constant, "K_E": train.back_emf_constant, "B_M": train.viscous,
        "G_0": 1.0, "G_D": 1.0, "G_B": 1.0, "V_0": 1.0, "DUTY": 1.0,
    }  # fmt: skip
    p = np.tile([float(named.get(name, 0.0)) for name in PARAMETERS], (2, 1))
    p[:, at.H] = parts
    s, z, stamp = np.zeros(len(STATE)), np.zeros(16), np.full((2, *M.shape[2:4]), nan)
    s[at.RES] = train.resistance
    place, last = np.arange(len(record.u)) - whole, len(record.u) - 1
    signal = record.u if record.warm is None else record.u - x["R"] * record.warm * record.outputs["current"]
    u = np.column_stack([signal[np.clip(place - n, 0, last)] for n in (1, 0)])
    wrong = machine_code(KERNEL)(p, s, tally(), M, M[:, 0].copy(), stamp, z, u, record.load, record.start, out)
    if wrong:
        out[:] = 1e30
    return {"current": out[:, 0], "speed": out[:, 1], "angle": out[:, 2]}


def noise_of(values: Array, h: float) -> float:
    """Standard deviation of what is no parabola over nine samples, with that of the steps that a column is read in."""
    time = h * np.arange(len(values), dtype=float)
    rest = values - local_parabola(time, values, _SMOOTHED * h)[0]
    spread = 1.4826 * float(np.median(np.abs(rest - np.median(rest))))
    steps = np.diff(np.unique(values))
    step = float(np.min(steps)) if len(steps) else 0.0
    return max(1.3 * spread, step / sqrt(12.0), 1e-4 * float(np.ptp(values)), 1e-12)


# -- A start by weighted regression, of signals smoothed alike.


def regression(record: Record, known: Figures) -> Figures:
    """Figures by linear regression on smoothed signals and their slopes; what has no column is as known.

    The voltage is R i + k_e w + L i' where the current was measured; the current, or a voltage alone, is in proportion
    to inertia, friction, speed and, where one is known, load.
    """
    h, n = record.h, len(record.u)
    time, window = h * np.arange(n, dtype=float), _SMOOTHED * h
    w, dw = local_parabola(time, record.outputs["speed"], window)
    u = local_parabola(time, np.append(record.u[0], (record.u[1:] + record.u[:-1]) / 2.0), window)[0]
    x = {"R": known.get("R", 1.0), "L": known.get("L", 0.0), "e": known.get("e", 1.0), "delay": 0.0,
         "k_e": known.get("k_e", 1.0), "k_t": known.get("k_t", 1.0)}  # fmt: skip
    x["e_back"] = x["e"]
    fast = np.abs(w) > max(_CERTAIN * noise_of(record.outputs["speed"], h) / 3.0, _FASTEST / 100.0 * np.abs(w).max())
    fast &= ~record.lead
    if fast.sum() < _FEW:
        fast = ~record.lead
    driving, braking = through_gears(record.ratio, x["e"])
    load = record.load[:-1] * np.where(record.load[:-1] * w > 0.0, driving, braking)
    push = u  # voltage or current that moves it
    if record.driven == "voltage" and "current" in record.outputs:
        push, slope = local_parabola(time, record.outputs["current"], window)
        warm = 1.0 if record.warm is None else 1.0 + record.warm
        x["R"], x["k_e"], x["L"] = _positive(np.column_stack([push * warm, w, slope]), u)
        x["k_t"] = known.get("k_t", x["k_e"])
    table = np.column_stack([dw, np.sign(w), w, *([load] if record.loaded else [])])[fast]
    a, s, b, *per_torque = _positive(table, push[fast])
    of_voltage = record.driven == "voltage" and "current" not in record.outputs
    if per_torque and per_torque[0] > 0.0 and "k_t" not in known:
        x["k_t"] = (x["R"] if of_voltage else 1.0) / per_torque[0]
    scale = x["k_t"] / x["R"] if of_voltage else x["k_t"]
    if of_voltage:
        x["k_e"], b = max(b, 1e-9), 0.0
        x["L"] = max(x["L"], x["R"] * h)  # to go on from: at 0 a delay would do for it
    least = 1e-4 * float(np.abs(push).max()) / (float(np.abs(dw).max()) or 1.0)
    return x | {"J": max(a, least, 1e-15) * scale, "M_c": s * scale, "b": b * scale}


def _positive(table: Array, right: Array) -> Array:
    """Non-negative least squares with columns of one size."""
    size = np.sqrt((table**2).mean(axis=0)) + 1e-300
    solution = lsq_linear(table / size, right, bounds=(0.0, np.inf))
    return np.asarray(solution.x / size)


BAND = 1.96  # standard deviations: 95 % of a normal spread
_BLOCKS, _DRAWN, _SEED, _PARTS = 24, 200, 1, 4
_STUDENT = 3.18 / 1.96  # of three degrees of freedom: four parts
_LAST = 3  # steps of Gauss and Newton behind a search, at most
_STEP = 3e-3  # of each figure, for slopes: a mode's change is met to a 1024th of a sample
_AHEAD = 10.0  # samples by which a delay is shifted, so that its step is one of samples
_DELAYS = (-3.0, 30.0)  # samples
_DELAYS_TRIED = (-1.0, -0.05, *np.arange(0.1, 2.5, 0.25).tolist(), 3.0, 4.0)  # before 0: rows hold what follows
_LAGS_TRIED = (0.1, 0.3, 0.6, 1.2)  # electrical time constants in samples: smoothed signals make one too long
_STARTS = 3
_ZERO = ("L", "M_c", "b")  # figures that may be none


class Fit(NamedTuple):
    """The result: figures of the model, and of those that are fitted three standard deviations each."""

    values: Figures
    free: tuple[str, ...]
    spread: dict[str, Array]  # formal, bootstrap, parts; of each figure in its own unit
    condition: float
    inseparable: tuple[Inseparable, ...]
    modelled: dict[str, Array]


class _Problem:
    """A record with what is fitted of it, in figures of about 1."""

    def __init__(self, record: Record, start: Figures, known: Figures) -> None:
        self.record, self.known, self.values = record, known, dict(start)
        self.free: tuple[str, ...] = ()
        self.sigma = {name: noise_of(y, record.h) for name, y in record.outputs.items()}
        i = record.outputs.get("current", record.u if record.driven == "current" else np.zeros(1))
        push = self.values["k_t"] * float(np.sqrt((i**2).mean()))
        if record.driven == "voltage" and "current" not in record.outputs:
            push = self.values["k_t"] / self.values["R"] * float(np.sqrt((record.u**2).mean()))
        top = float(np.abs(record.outputs["speed"]).max()) or 1.0
        R = self.values["R"]
        self.size = {
            "R": R, "L": max(self.values["L"], 0.3 * R * record.h), "k_e": self.values["k_e"],
            "k_t": self.values["k_t"], "J": self.values["J"], "M_c": max(push, 1e-12), "b": max(push / top, 1e-15),
            "e": 1.0, "e_back": 1.0, "delay": 1.0,
        }  # fmt: skip

    def of(self, x: Array) -> Figures:
        """Figures of the model by those that are fitted; tied ones follow."""
        figures = dict(self.values)
        for name, value in zip(self.free, x, strict=True):
            figures[name] = value * self.size[name] - (_AHEAD if name == "delay" else 0.0)
        if "k_t" not in self.free and "k_e" in self.free and self.record.driven == "voltage" and self.ties_k_t:
            figures["k_t"] = figures["k_e"] * self.values["k_t"] / self.values["k_e"]
        if "e_back" not in self.free:
            figures["e_back"] = figures["e"]
        return figures

    @property
    def ties_k_t(self) -> bool:
        """Whether the torque constant follows from the voltage per speed: where the current was measured."""
        return "current" in self.record.outputs

    def x(self) -> Array:
        """The fitted figures as they are now."""
        return np.array([(self.values[n] + (_AHEAD if n == "delay" else 0.0)) / self.size[n] for n in self.free])

    def bounds(self) -> tuple[Array, Array]:
        """Their limits."""
        ends = {"e": (0.05, 1.0), "e_back": (0.05, 1.0), "delay": tuple(_AHEAD + d for d in _DELAYS)}
        limits = [ends.get(n, (0.0 if n in _ZERO else 1e-3, 1e3)) for n in self.free]
        return np.array([low for low, _ in limits]), np.array([high for _, high in limits])

    def rest(self, x: Array) -> Array:
        """Rest of each output that the model leaves, in standard deviations, one output behind another."""
        model = response(self.of(x), self.record)
        rests = [(model[n] - y) / self.sigma[n] for n, y in self.record.outputs.items()]
        for part in rests:
            part[self.record.lead] = 0.0
        return np.clip(np.concatenate(rests), -1e6, 1e6)

    def left(self, others: Figures) -> float:
        """Sum of squares with some figures in place of those it has."""
        self.values |= others
        return float((self.rest(self.x()) ** 2).sum())

    def slopes(self) -> Array:
        """Slopes of it by each fitted figure."""
        x, (_, high) = self.x(), self.bounds()
        first, empty = self.rest(x), np.empty((0, 0))
        columns = []
        for k in range(len(x)):
            step = _STEP * max(abs(x[k]), 0.1)
            step = -step if x[k] + step > high[k] else step
            ahead = x.copy()
            ahead[k] += step
            columns.append((self.rest(ahead) - first) / step)
        return np.array(columns).T if columns else empty

    def spread(self) -> Array:
        """Three standard deviations of each fitted figure, a row of each kind."""
        outputs, n = len(self.record.outputs), len(self.record.u)
        return spreads(self.slopes().reshape(outputs, n, -1), self.rest(self.x()).reshape(outputs, n))

    def fit(self, most: int) -> None:
        """Go to the least squares."""
        x, (low, high) = self.x(), self.bounds()
        x = np.clip(x, low + 1e-6 * (1.0 + abs(low)), high - 1e-6 * abs(high))
        solution = least_squares(self.rest, x, bounds=(low, high), diff_step=_STEP, x_scale="jac", max_nfev=most,
                              loss="soft_l1", f_scale=4.0, tr_solver="lsmr",
                              tr_options={"atol": 1e-12, "btol": 1e-12, "regularize": False})  # fmt: skip
        self.values = self.of(solution.x)
        for _ in range(_LAST):
            x, J, r = self.x(), self.slopes(), self.rest(self.x())
            inverse = _covariance(J)
            further = np.clip(x - inverse @ (J.T @ r), low, high) if np.isfinite(inverse).all() else x
            if not (self.rest(further) ** 2).sum() < (r**2).sum():
                break
            self.values = self.of(further)

    def weigh(self) -> None:
        """Weight each output by what was left of it."""
        rest = self.rest(self.x()).reshape(len(self.record.outputs), -1)
        for name, part in zip(self.record.outputs, rest, strict=True):
            after_lead = part[~self.record.lead]
            self.sigma[name] *= max(float(np.sqrt((after_lead**2).mean())), 1e-3)


_SEPARATED = {name: (float(share), words) for name, share, *words in declared("separated")}
_FALLEN = {"b": 0.0, "L": 0.0}  # where such a figure is neither fitted nor known


def fitted(record: Record, known: Figures, free: Sequence[str]) -> Fit:
    """Fit what a record separates."""
    start = regression(record, known)
    problem = _Problem(record, start, known)
    problem.free = tuple(free)
    lags = [start["L"], *(share * start["R"] * record.h for share in _LAGS_TRIED)] if "L" in free else [start["L"]]
    # of each time constant the best delay, and of what comes of the best of these the nearest
    starts = [min((problem.left({"delay": late, "L": L}), late, L) for late in _DELAYS_TRIED) for L in lags]
    ends = []
    for _, late, L in sorted(starts)[:_STARTS]:
        problem.values = start | {"delay": late, "L": L}
        problem.fit(12)
        ends.append((problem.left({}), problem.values))
    problem.values = min(ends, key=lambda end: end[0])[1]
    problem.weigh()
    tied: list[Inseparable] = []
    while (name := _inseparable(problem)) is not None:
        tied.append(Inseparable(*_SEPARATED[name][1]))
        problem.free = tuple(other for other in problem.free if other != name)
        if name in known or name in _FALLEN:
            problem.values[name] = known.get(name, _FALLEN.get(name, nan))
        elif name == "k_t" and record.driven == "voltage":
            problem.values["k_t"] = problem.values["k_e"]
        elif name in ("e", "e_back"):
            problem.values[name] = problem.values["e"] if name == "e_back" else 1.0
        problem.fit(12)
        problem.weigh()
    problem.fit(40)
    problem.weigh()
    slopes, three = problem.slopes(), problem.spread()
    spread = {name: three[:, k] * problem.size[name] for k, name in enumerate(problem.free)}
    return Fit(problem.values, problem.free, spread, _condition(slopes), tuple(tied),
               response(problem.values, record))  # fmt: skip


def _condition(slopes: Array) -> float:
    size = np.sqrt((slopes**2).sum(axis=0))
    if not len(size) or not size.min() > 0.0:
        return float("inf")
    return float(np.linalg.cond(slopes / size))


def _covariance(slopes: Array) -> Array:
    """Covariance of fitted figures; infinite where a figure does not reach the outputs."""
    size = np.sqrt((slopes**2).sum(axis=0))
    reached = size > 1e-9 * (size.max() if len(size) else 1.0)
    covariance = np.full((len(size), len(size)), 0.0)
    covariance[~reached, ~reached] = np.inf
    scaled = slopes[:, reached] / size[reached]
    inner = np.linalg.pinv(scaled.T @ scaled, rcond=1e-14)
    covariance[np.ix_(reached, reached)] = inner / np.outer(size[reached], size[reached])
    return covariance


def _inseparable(problem: _Problem) -> str | None:
    """The first figure, of those whose widest band says nothing, that is to be tied."""
    spread, low = problem.spread().max(axis=0), problem.bounds()[0]
    size = dict(zip(problem.free, problem.x(), strict=True))
    order = [*_SEPARATED]
    if not (problem.ties_k_t and problem.record.driven == "voltage"):  # a load alone gives the torque constant then
        order.remove("k_t")
        order.insert(order.index("e") + 1, "k_t")
    for name in order:
        if name in problem.free:
            at = 1.0 if name in (*_ZERO, "e", "e_back") else max(size[name], 1e-9)
            place = problem.free.index(name)
            at_end = name not in _ZERO and size[name] < 1.05 * low[place]
            if at_end or isnan(spread[place]) or spread[place] > _SEPARATED[name][0] * at:
                return name
    return None


def spreads(J: Array, r: Array) -> Array:
    """Three standard deviations of each figure: formal, by blocks drawn anew, by parts."""
    n = r.shape[1]
    blocks = np.array_split(np.arange(n), min(_BLOCKS, n))
    normal = np.array([np.einsum("oti,otj->ij", J[:, block], J[:, block]) for block in blocks])
    pull = np.array([np.einsum("oti,ot->i", J[:, block], r[:, block]) for block in blocks])
    scale = np.sqrt(np.maximum(np.diag(normal.sum(axis=0)), 1e-300))

    def correction(weight: Array) -> Array:
        A, g = np.einsum("b,bij->ij", weight, normal), weight @ pull
        return np.asarray(-np.linalg.lstsq(A / np.outer(scale, scale), g / scale, rcond=1e-12)[0] / scale)

    formal = np.sqrt(np.abs(np.diag(_covariance(J.reshape(-1, J.shape[2])))))
    random = np.random.default_rng(_SEED)
    many = len(blocks)
    draws = (random.integers(many, size=many) for _ in range(_DRAWN))
    samples = np.array([correction(np.bincount(draw, minlength=many).astype(float)) for draw in draws])
    order = np.arange(len(blocks)) % _PARTS
    parts = np.array([correction((order == k).astype(float)) for k in range(_PARTS)])
    low, high = np.percentile(samples, [2.5, 97.5], axis=0)
    by_parts = parts.std(axis=0, ddof=1) / np.sqrt(_PARTS) * _STUDENT
    return np.array([formal, (high - low) / 2.0 / BAND, by_parts])


def of_points(table: Array, right: Array) -> tuple[Array, Array]:
    """Figures by linear regression of steady points, and three standard deviations of each."""
    figures, *_ = np.linalg.lstsq(table, right, rcond=None)
    left = table @ figures - right
    size = float(left.std()) or 1.0
    return np.asarray(figures, float), spreads((table / size)[None], (left / size)[None])


def widest(three: Array) -> list[str]:
    """The kind of band that is the widest, of each figure."""
    return [("formal", "bootstrap", "subsets")[k] for k in three.argmax(axis=0).tolist()]


# -- Winding and housing out of logged temperatures: thermal resistances and time constants by output error.
#
# The two bodies are those of ``kernel.heat``, warmed by copper loss at the logged current; what heats them besides is
# in the log's housing alone. Less than two time constants of the housing give lower bounds of what lies behind it.


_SPANS = 300  # of constant mean square current
_LEAST_RISE = 3.0  # K, below which temperatures say nothing
_SIGMA = 0.3  # K, of a sensor
_LONG = 2.0  # time constants of the housing
BOUND = "lower bound"
_UNCERTAIN = 0.5  # of a figure, standard deviation above which it is none
_NEEDS = "temperatures of winding and housing over two time constants of the housing, while it warms and cools"


class Heat(NamedTuple):
    """Figures out of temperatures."""

    figures: tuple[IdentifiedFigure, ...] = ()
    inseparable: tuple[Inseparable, ...] = ()
    time: Array = np.zeros(0)
    traces: tuple[Trace, ...] = ()


def heated(log: Log, current: Array | None, R_25: float) -> Heat:
    """Fit the two bodies to a log's temperatures."""
    names = [name for name in ("winding", "housing") if name in log.columns]
    rises = [name for name in names if float(np.ptp(log.columns[name])) > _LEAST_RISE]
    if "winding" not in rises or log.steady:
        return Heat()
    if current is None or not R_25 > 0.0:
        lacks = "current" if current is None else "resistance"
        return Heat(inseparable=(Inseparable("thermal figures", f"the {lacks} is unknown", f"the motor's {lacks}"),))
    time = log.columns["time"] - log.columns["time"][0]
    edges = np.unique(np.linspace(0, len(time) - 1, min(_SPANS, len(time) - 1) + 1).astype(int))
    spans = np.diff(time[edges])
    square = np.array([float((current[a:b] ** 2).mean()) for a, b in pairwise(edges)])
    measured = np.array([log.columns[name][edges] for name in rises])
    ambient = float(min(column[0] for column in measured))
    start = [float(log.columns[name][0]) - ambient for name in names]
    start = [start[0], start[1] if "housing" in rises else start[0]]
    places = [("winding", "housing").index(name) for name in rises]

    def course(x: Array) -> Array:
        R_th1, tau_w, R_th2, tau_h = np.exp(x).tolist()
        b = bodies_of(float(resistance_at(R_25, ambient)), COPPER * R_25, R_th1, R_th2, tau_w / R_th1, tau_h / R_th2)
        w, h = start
        temperatures = [(w, h)]
        for dt, I2 in zip(spans.tolist(), square.tolist(), strict=True):
            law = law_of(b, I2, 0.0)
            more_w, more_h, _ = added(law, spread(law, dt), dt, w, h)
            w, h = min(max(w + more_w, -300.0), 3000.0), min(max(h + more_h, -300.0), 3000.0)
            temperatures.append((w, h))
        return np.array(temperatures).T[places] + ambient

    def rest(x: Array) -> Array:
        return np.asarray((course(x) - measured).ravel() / _SIGMA)

    total = float(time[-1])
    least, most = np.log([1e-3, 1e-2, 1e-3, 1.0]), np.log([1e3, 1e5, 1e4, 1e7])
    tries = [np.clip(np.log([2.0, total / a, 6.0, total * c]), least + 0.01, most - 0.01)
             for a in (20.0, 4.0) for c in (0.5, 3.0)]  # fmt: skip
    best = min((least_squares(rest, x, bounds=(least, most), x_scale=1.0, max_nfev=60) for x in tries),
               key=lambda result: float(result.cost))  # fmt: skip
    r = best.fun.reshape(len(rises), -1)
    size = max(float(np.sqrt((r**2).mean())), 1.0)
    three = spreads(best.jac.reshape(len(rises), r.shape[1], 4) / size, r / size)
    first = _SIGMA / float(np.ptp(measured, axis=1).min())  # of the readings that it all starts from
    values, sigma = np.exp(best.x), np.hypot(three.max(axis=0), first)
    figures, open_ones, kinds = [], [], widest(three)
    for k, (name, title, kind, unit) in enumerate(declared("heat")):
        bound = k >= 2 and (total < _LONG * values[3] or sigma[k] > _UNCERTAIN)
        if k < 2 and sigma[k] > _UNCERTAIN:
            open_ones.append(title)
            continue
        grows, value = float(np.exp(BAND * min(sigma[k], 5.0))), float(values[k])
        low, high = value / grows, np.inf if bound else value * grows
        open_ones += [title] if bound else []
        basis = BOUND if bound else kinds[k]
        figures.append(IdentifiedFigure(name, title, kind, unit, low if bound else value, low, high, basis))
    tied = (Inseparable(", ".join(open_ones), f"the log lasts {total:.3g} s", _NEEDS),) if open_ones else ()
    model = course(best.x)
    traces = tuple(Trace(name, "temperature", "degC", measured[k], model[k]) for k, name in enumerate(rises))
    return Heat(tuple(figures), tied, time[edges], traces)
