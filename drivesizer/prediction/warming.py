"""Temperatures of winding and housing while the current follows from the winding's temperature: columns over samples.

Each step is exact for a constant current (see ``heat_step``); a current that changes with the winding's resistance is
taken at the mean of the step's ends.
Convention: temperatures are absolute.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.physics.heat_step import drive, modes, weights
from drivesizer.physics.overload import State
from drivesizer.physics.thermal import TwoBodies, resistance_at

__all__ = ["Heating", "in_the_long_run", "over_time", "time_to_limit"]

Array = NDArray[np.float64]
_RUNAWAY = 3000.0  # K, beyond which a winding is taken to run away
_HALVINGS = 60
_FIRST, _GROWTH = 0.02, 0.15  # of the time to the limit at the first slope; of the time so far
_LONG = 40.0  # time constants of the housing
_STEPS = 400


class Heating(NamedTuple):
    """A motor as two bodies, and what heats them at a temperature of the winding."""

    bodies: TwoBodies  # columns
    ambient: float  # K
    sources: Callable[[Array], tuple[Array, Array]]  # winding [K] to current [A] and loss at the housing [W]

    @property
    def known(self) -> bool:
        """Whether temperatures can be computed."""
        current, loss = self.sources(np.full(np.shape(self.bodies.R_25), self.ambient))
        return bool(np.all(self.bodies.known) and not np.isnan(current + loss).any())


def over_time(heating: Heating, start: State, times: Array) -> tuple[Array, Array]:
    """Temperatures of winding and housing at times.

    Parameters
    ----------
    heating
        The motor and its losses.
    start
        Temperatures at the first time [K].
    times
        Ascending [s].

    Returns
    -------
    tuple of arrays
        Winding and housing [K], shape (times, samples); infinite after a runaway.
    """
    state = _at(heating, start)
    found = [state]
    for span in np.diff(times):
        state = _step(heating, state, span)
        found.append(state)
    return tuple(np.where(np.array(x) < _RUNAWAY, x, np.inf) for x in zip(*found, strict=True))  # type: ignore[return-value]


def in_the_long_run(heating: Heating) -> tuple[Array, Array]:
    """Temperatures of winding and housing in the long run [K]; infinite where the winding runs away.

    Parameters
    ----------
    heating
        The motor and its losses.

    Returns
    -------
    tuple of arrays
        Winding and housing [K], shape (samples,).
    """
    body, ambient = heating.bodies, heating.ambient
    low, high = (np.full(np.shape(body.R_25), x) for x in (ambient, _RUNAWAY))
    loss = np.zeros_like(low)
    for _ in range(_HALVINGS):  # a fixed point, for the losses of a voltage fall with temperature
        winding = (low + high) / 2.0
        current, loss = heating.sources(winding)
        copper = resistance_at(body.R_25, winding) * current**2
        warmer = ambient + (body.R_th1 + body.R_th2) * copper + body.R_th2 * loss > winding
        low, high = np.where(warmer, winding, low), np.where(warmer, high, winding)
    housing = body.housing(ambient, high, loss)
    return np.where(high < _RUNAWAY, high, np.inf), np.asarray(np.where(high < _RUNAWAY, housing, np.inf))


def time_to_limit(heating: Heating, start: State, limit: Any) -> Array:
    """Time until the winding has its permitted temperature.

    Parameters
    ----------
    heating
        The motor and its losses.
    start
        Temperatures at the start [K].
    limit
        Permitted temperature of the winding [K].

    Returns
    -------
    array
        Time [s], shape (samples,); infinite where it is never reached.
    """
    state, body = _at(heating, start), heating.bodies
    slope = (_step(heating, state, 1e-6 * body.tau_w)[0] - state[0]) / (1e-6 * body.tau_w)
    with np.errstate(divide="ignore", invalid="ignore"):
        quick = np.where(slope > 0.0, (limit - state[0]) / slope, body.tau_w)
    span = _FIRST * np.clip(quick, 1e-6 * body.tau_w, body.tau_w)
    time, before = np.zeros_like(span), (*state, np.zeros_like(span), span)
    reached = state[0] >= limit
    for _ in range(_STEPS):
        after = _step(heating, state, span)
        now = ~reached & (after[0] >= limit)
        before = tuple(np.where(now, x, old) for x, old in zip((*state, time, span), before, strict=True))  # type: ignore[assignment]
        reached, state, time = reached | now, after, time + span
        if np.all(reached | (time > _LONG * body.tau_h)):
            break
        span = np.maximum(span, _GROWTH * time)
    w, h, begun, span = before
    low, high = np.zeros_like(span), span
    for _ in range(_HALVINGS):
        middle = (low + high) / 2.0
        there = _step(heating, (w, h), middle)[0] >= limit
        low, high = np.where(there, low, middle), np.where(there, middle, high)
    at_once = _at(heating, start)[0] >= limit
    return np.where(at_once, 0.0, np.where(reached, begun + high, np.inf))


def _at(heating: Heating, start: State) -> tuple[Array, Array]:
    whole = np.ones(np.shape(heating.bodies.R_25))
    return start.winding * whole, start.housing * whole


def _step(heating: Heating, state: tuple[Array, Array], span: Any) -> tuple[Array, Array]:
    """Temperatures after a span, with the sources at the mean of the winding's temperature before and after."""
    after = _constant(heating, state, heating.sources(state[0]), span)
    return _constant(heating, state, heating.sources((state[0] + after[0]) / 2.0), span)


def _constant(
    heating: Heating, state: tuple[Array, Array], sources: tuple[Array, Array], span: Any
) -> tuple[Array, Array]:
    """Temperatures after a span at constant current and loss."""
    body, ambient = heating.bodies, heating.ambient
    square = sources[0] ** 2
    mode, constant = modes(body, square), drive(body, ambient, square, sources[1])
    w, h = (x - ambient for x in state)
    slopes = [a + b for a, b in zip(mode.slopes(w, h), constant, strict=True)]
    with np.errstate(over="ignore", invalid="ignore"):
        weight = weights(mode.fast, mode.slow, np.minimum(span, _LONG / np.abs(mode.slow)) * np.ones_like(mode.fast))
        pulls = mode.pulls(*slopes)
        moved = [x + weight.slope * a + weight.pull * b for x, a, b in zip(state, slopes, pulls, strict=True)]
    return tuple(np.minimum(np.nan_to_num(x, nan=_RUNAWAY, posinf=_RUNAWAY), _RUNAWAY) for x in moved)  # type: ignore[return-value]
