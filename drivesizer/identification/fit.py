"""Output error: figures with which the drive's response is nearest to the log, their bands, what is not separated.

The start is a regression; ``scipy.optimize.least_squares`` goes on from there on speed and current as the model answers
the log's own input, each weighted by what was left of it. A figure whose band would say nothing is tied to another or
to what is known, and named. Bands are the widest of three: formal, by blocks of the log drawn anew, and by its parts,
the last two to first order (one step of Gauss and Newton with other weights), as residuals are coloured.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan, nan
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from drivesizer.identification.model import Figures, Record, noise_of, regression, response
from drivesizer.results.identification import Inseparable

Array = NDArray[np.float64]

BAND = 1.96  # standard deviations: 95 % of a normal spread
_BLOCKS, _DRAWN, _SEED, _PARTS = 24, 200, 1, 4
_STUDENT = 3.18 / 1.96  # of three degrees of freedom: four parts
_LAST = 3  # steps of Gauss and Newton behind a search, at most
_STEP = 3e-3  # of each figure, for slopes: a mode's change is met to a 1024th of a sample
_AHEAD = 10.0  # samples by which a delay is shifted, so that its step is one of samples
_DELAYS = (-3.0, 30.0)  # samples
_DELAYS_TRIED = (
    -1.0,
    -0.05,
    0.0,
    0.5,
    1.0,
    2.0,
    4.0,
)  # before 0: rows hold what follows
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

    def __init__(self, one: Record, start: Figures, known: Figures) -> None:
        self.one, self.known, self.values = one, known, dict(start)
        self.free: tuple[str, ...] = ()
        self.sigma = {name: noise_of(y, one.h) for name, y in one.outputs.items()}
        i = one.outputs.get("current", one.u if one.driven == "current" else np.zeros(1))
        push = self.values["k_t"] * float(np.sqrt((i**2).mean()))
        if one.driven == "voltage" and "current" not in one.outputs:
            push = self.values["k_t"] / self.values["R"] * float(np.sqrt((one.u**2).mean()))
        top = float(np.abs(one.outputs["speed"]).max()) or 1.0
        R = self.values["R"]
        self.size = {
            "R": R, "L": max(self.values["L"], 0.3 * R * one.h), "k_e": self.values["k_e"], "k_t": self.values["k_t"],
            "J": self.values["J"], "M_c": max(push, 1e-12), "b": max(push / top, 1e-15), "e": 1.0, "e_back": 1.0,
            "delay": 1.0,
        }  # fmt: skip

    def of(self, x: Array) -> Figures:
        """Figures of the model by those that are fitted; tied ones follow."""
        found = dict(self.values)
        for name, value in zip(self.free, x, strict=True):
            found[name] = value * self.size[name] - (_AHEAD if name == "delay" else 0.0)
        if "k_t" not in self.free and "k_e" in self.free and self.one.driven == "voltage" and self.ties_k_t:
            found["k_t"] = found["k_e"] * self.values["k_t"] / self.values["k_e"]
        if "e_back" not in self.free:
            found["e_back"] = found["e"]
        return found

    @property
    def ties_k_t(self) -> bool:
        """Whether the torque constant follows from the voltage per speed: where the current was measured."""
        return "current" in self.one.outputs

    def x(self) -> Array:
        """The fitted figures as they are now."""
        return np.array([(self.values[n] + (_AHEAD if n == "delay" else 0.0)) / self.size[n] for n in self.free])

    def bounds(self) -> tuple[Array, Array]:
        """Their limits."""
        ends = {"e": (0.05, 1.0), "e_back": (0.05, 1.0), "delay": tuple(_AHEAD + d for d in _DELAYS)}
        found = [ends.get(n, (0.0 if n in _ZERO else 1e-3, 1e3)) for n in self.free]
        return np.array([low for low, _ in found]), np.array([high for _, high in found])

    def rest(self, x: Array) -> Array:
        """Rest of each output that the model leaves, in standard deviations, one output behind another."""
        made = response(self.of(x), self.one)
        found = [(made[n] - y) / self.sigma[n] for n, y in self.one.outputs.items()]
        for part in found:
            part[self.one.lead] = 0.0
        return np.clip(np.concatenate(found), -1e6, 1e6)

    def with_delay(self, samples: float) -> float:
        """Sum of squares with another delay."""
        self.values["delay"] = samples
        return float((self.rest(self.x()) ** 2).sum())

    def slopes(self) -> Array:
        """Slopes of it by each fitted figure."""
        x, (_, high) = self.x(), self.bounds()
        first, found = self.rest(x), np.empty((0, 0))
        columns = []
        for k in range(len(x)):
            step = _STEP * max(abs(x[k]), 0.1)
            step = -step if x[k] + step > high[k] else step
            moved = x.copy()
            moved[k] += step
            columns.append((self.rest(moved) - first) / step)
        return np.array(columns).T if columns else found

    def spread(self) -> Array:
        """Three standard deviations of each fitted figure, a row of each kind."""
        outputs, n = len(self.one.outputs), len(self.one.u)
        return spreads(self.slopes().reshape(outputs, n, -1), self.rest(self.x()).reshape(outputs, n))

    def fit(self, most: int) -> None:
        """Go to the least squares."""
        x, (low, high) = self.x(), self.bounds()
        x = np.clip(x, low + 1e-6 * (1.0 + abs(low)), high - 1e-6 * abs(high))
        found = least_squares(self.rest, x, bounds=(low, high), diff_step=_STEP, x_scale="jac", max_nfev=most,
                              loss="soft_l1", f_scale=4.0, tr_solver="lsmr",
                              tr_options={"atol": 1e-12, "btol": 1e-12, "regularize": False})  # fmt: skip
        self.values = self.of(found.x)
        for _ in range(_LAST):
            x, J, r = self.x(), self.slopes(), self.rest(self.x())
            inverse = _covariance(J)
            further = np.clip(x - inverse @ (J.T @ r), low, high) if np.isfinite(inverse).all() else x
            if not (self.rest(further) ** 2).sum() < (r**2).sum():
                break
            self.values = self.of(further)

    def weigh(self) -> None:
        """Weight each output by what was left of it."""
        rest = self.rest(self.x()).reshape(len(self.one.outputs), -1)
        for name, part in zip(self.one.outputs, rest, strict=True):
            kept = part[~self.one.lead]
            self.sigma[name] *= max(float(np.sqrt((kept**2).mean())), 1e-3)


# figure | largest standard deviation, as share of its size, at which it counts as separated | reason | what is needed
_SEPARATED = {
    "e_back": (0.15, "gear loss by direction", "it enters lifting and lowering alike with dry friction",
               "a known load lifted and lowered, and a second load"),
    "k_t": (0.15, "torque constant apart from inertia and friction",
            "current per torque and torque itself are known as a product alone",
            "a measured torque at the output, or a known load lifted and lowered"),
    "e": (0.15, "gear loss", "it lies within the dry friction", "a known load lifted and lowered"),
    "L": (0.5, "inductance", "the current follows the voltage faster than the samples", "samples ten times as fast"),
    "b": (0.15, "viscous friction apart from dry friction", "the speed hardly changes",
          "moves at several steady speeds, the fastest five times the slowest"),
    "M_c": (0.15, "dry friction apart from viscous friction", "the direction or the speed never changes",
            "slow moves in both directions"),
    "R": (0.3, "resistance apart from the back-EMF", "the current is small against the voltage",
          "a move under load at low speed, or a stall of some hundred milliseconds"),
    "J": (0.5, "inertia", "the speed hardly changes", "a step, or ramps of the speed"),
    "k_e": (0.3, "back-EMF constant", "the speed hardly changes", "a move at half of the full speed or more"),
}  # fmt: skip
_FALLEN = {"b": 0.0, "L": 0.0}  # where such a figure is neither fitted nor known


def fitted(one: Record, known: Figures, free: Sequence[str]) -> Fit:
    """Fit what a record separates.

    Parameters
    ----------
    one
        The log on an even grid.
    known
        Figures of a data sheet or of conditions, SI; those that are not fitted have them.
    free
        What is to be fitted, of ``model.FIGURES``.

    Returns
    -------
    Fit
        With what could not be separated.
    """
    start = regression(one, known)
    problem = _Problem(one, start, known)
    problem.free = tuple(free)
    problem.values["delay"] = min(_DELAYS_TRIED, key=problem.with_delay)
    problem.fit(12)
    problem.weigh()
    tied: list[Inseparable] = []
    while (name := _inseparable(problem)) is not None:
        _, figures, reason, needs = _SEPARATED[name]
        tied.append(Inseparable(figures, reason, needs))
        problem.free = tuple(other for other in problem.free if other != name)
        if name in known or name in _FALLEN:
            problem.values[name] = known.get(name, _FALLEN.get(name, nan))
        elif name == "k_t" and one.driven == "voltage":
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
               response(problem.values, one))  # fmt: skip


def _condition(slopes: Array) -> float:
    size = np.sqrt((slopes**2).sum(axis=0))
    if not len(size) or not size.min() > 0.0:
        return float("inf")
    return float(np.linalg.cond(slopes / size))


def _covariance(slopes: Array) -> Array:
    """Covariance of fitted figures; infinite where a figure does not reach the outputs."""
    size = np.sqrt((slopes**2).sum(axis=0))
    reached = size > 1e-9 * (size.max() if len(size) else 1.0)
    found = np.full((len(size), len(size)), 0.0)
    found[~reached, ~reached] = np.inf
    scaled = slopes[:, reached] / size[reached]
    inner = np.linalg.pinv(scaled.T @ scaled, rcond=1e-14)
    found[np.ix_(reached, reached)] = inner / np.outer(size[reached], size[reached])
    return found


def _inseparable(problem: _Problem) -> str | None:
    """The first figure, of those whose widest band says nothing, that is to be tied."""
    spread, low = problem.spread().max(axis=0), problem.bounds()[0]
    size = dict(zip(problem.free, problem.x(), strict=True))
    order = [*_SEPARATED]
    if not (problem.ties_k_t and problem.one.driven == "voltage"):  # a load alone gives the torque constant then
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
    """Three standard deviations of each figure: formal, by blocks drawn anew, by parts.

    Parameters
    ----------
    J
        Slopes of what is left, by output, moment and figure.
    r
        What is left, by output and moment, in its own standard deviations.

    Returns
    -------
    array
        A row of each kind.
    """
    n = r.shape[1]
    blocks = np.array_split(np.arange(n), min(_BLOCKS, n))
    normal = np.array([np.einsum("oti,otj->ij", J[:, some], J[:, some]) for some in blocks])
    pull = np.array([np.einsum("oti,ot->i", J[:, some], r[:, some]) for some in blocks])
    scale = np.sqrt(np.maximum(np.diag(normal.sum(axis=0)), 1e-300))

    def moved(weight: Array) -> Array:
        A, g = np.einsum("b,bij->ij", weight, normal), weight @ pull
        return np.asarray(-np.linalg.lstsq(A / np.outer(scale, scale), g / scale, rcond=1e-12)[0] / scale)

    formal = np.sqrt(np.abs(np.diag(_covariance(J.reshape(-1, J.shape[2])))))
    random = np.random.default_rng(_SEED)
    many = len(blocks)
    draws = (random.integers(many, size=many) for _ in range(_DRAWN))
    drawn = np.array([moved(np.bincount(some, minlength=many).astype(float)) for some in draws])
    order = np.arange(len(blocks)) % _PARTS
    parts = np.array([moved((order == k).astype(float)) for k in range(_PARTS)])
    low, high = np.percentile(drawn, [2.5, 97.5], axis=0)
    by_parts = parts.std(axis=0, ddof=1) / np.sqrt(_PARTS) * _STUDENT
    return np.array([formal, (high - low) / 2.0 / BAND, by_parts])
