"""An encoder for every candidate at once: of those that meet the requirements one whose own limits are known to hold.

Encoders come in the order of their counts, then of their part numbers. Before that order goes what is known of their
speed and frequency at the candidate's highest speed: known to hold, then unknown, then failing. Where neither counts
nor a resolution, family or part are required, the encoder is a proposal and its figures are advice.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.catalog import EDGES, Catalog, Encoder, Table, lines
from drivesizer.physics.figures import Figures
from drivesizer.physics.motor_demand import Demands
from drivesizer.physics.stress import Parts
from drivesizer.results.check_columns import PROPOSAL, CheckColumn, at_least, at_most
from drivesizer.search.columns.controllers import figure_order, selected
from drivesizer.spec.robot import RobotSpec
from drivesizer.spec.select import EncoderChoice

__all__ = [
    "EncoderOffers", "angle_per_edge", "counting_limits", "counts_check", "encoders_for", "line_frequency",
    "offered_encoders",
]  # fmt: skip

Array = NDArray[np.float64]


class EncoderOffers(NamedTuple):
    """Encoders of each motor, by counts and part number: rows are motors; where there are fewer, row -1 at the end."""

    row: NDArray[np.int64]
    counts: Array  # lines per turn; NaN unknown
    fastest: Array  # rad/s that no known limit of theirs forbids; infinite where none is known
    known: NDArray[np.bool_]  # whether all of their limits are known
    last: NDArray[np.int64]  # the one with the most counts, -1 where there is none
    least: float  # counts that are required; 0 where none are


def angle_per_edge(counts: Any, reduction: Any) -> Any:
    """Angle of the load per edge of an encoder at the motor."""
    return 2 * np.pi / (EDGES * counts * reduction)


def offered_encoders(spec: RobotSpec, catalog: Catalog) -> EncoderOffers:
    """The encoders that fit each motor and that the spec allows."""
    choice, needed = spec.select.encoder, spec.needs.encoder_counts
    key = "encoders", repr(choice), needed
    offered: EncoderOffers = catalog.once(
        key, lambda: _encoder_offers(catalog, choice, float(max(needed or 0, choice.min_counts or 0)))
    )
    return offered


def _encoder_offers(catalog: Catalog, choice: EncoderChoice, least: float) -> EncoderOffers:
    table = catalog.encoders
    counted = lines(table)
    listed = np.zeros((len(catalog.motors), len(table)), bool)
    listed[catalog.motor_encoder.left, catalog.motor_encoder.right] = True
    order = figure_order(table, counted)
    fitting = (listed & selected(table, choice))[:, order]
    number = fitting.sum(axis=1)
    place = np.argsort(~fitting, axis=1, kind="stable")[:, : max(int(number.max(initial=0)), 1)]
    there = np.arange(place.shape[1]) < number[:, None]
    row = np.where(there, order[place], -1) if len(order) else np.full((len(listed), 1), -1)
    fastest, known = _fastest(table, counted)
    end = np.where(number > 0, row[np.arange(len(row)), np.maximum(number - 1, 0)], -1)
    return EncoderOffers(
        row, np.append(counted, np.nan)[row], np.append(fastest, np.nan)[row], np.append(known, False)[row], end,
        least,
    )  # fmt: skip


def _fastest(table: Table[Encoder], counted: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Highest speed that neither an encoder's own limit nor its frequency forbids, and whether both are known."""
    by_frequency = table["max_frequency"] * 2 * np.pi / counted
    lowest = np.fmin(table["max_speed"], by_frequency)
    return np.where(np.isnan(lowest), np.inf, lowest), ~np.isnan(table["max_speed"] + by_frequency)


def encoders_for(
    spec: RobotSpec, offered: EncoderOffers, motor: NDArray[np.int64], speed: Array, reduction: Array
) -> NDArray[np.int64]:
    """Row of each candidate's encoder, -1 where none is listed for its motor.

    Notes
    -----
    Where none has counts enough it is the one with the most, so that its check can say by how much it falls short.
    """
    there = (offered.counts >= offered.least) & (offered.row >= 0)
    finest, geared = spec.needs.resolution_at_load, reduction if spec.gear is None else reduction * spec.gear.ratio
    best, place = np.zeros(len(motor), np.int8), np.zeros(len(motor), np.int64)
    for k in reversed(np.flatnonzero(there.any(axis=0)).tolist()):  # one as good goes before those behind it
        enough = there[:, k].take(motor)
        if finest is not None:
            enough &= angle_per_edge(offered.counts[:, k].take(motor), geared) <= finest
        holds = enough & (speed <= offered.fastest[:, k].take(motor))
        good = enough.astype(np.int8) + holds + (holds & offered.known[:, k].take(motor))
        better = enough & (good >= best)
        np.copyto(best, good, where=better)
        np.copyto(place, k, where=better)
    return np.where(best > 0, offered.row[motor, place], offered.last[motor])


def counts_check(spec: RobotSpec, catalog: Catalog, row: NDArray[np.int64]) -> list[CheckColumn]:
    """The counts of some encoders against those required; no check where the spec requires no encoder.

    A motor without any listed encoder has an unknown one, for tables of what fits are partial: a reason to fail only
    where the spec requires counts, a family or a part.
    """
    choice = spec.select.encoder
    least = max(spec.needs.encoder_counts or 0, choice.min_counts or 0)
    if not (least or choice.named):
        return []
    counts = np.where(row >= 0, np.append(lines(catalog.encoders), np.nan)[row], 0.0)
    return [at_least("encoder_counts", float(least or 1), counts, by_choice=True)]


def line_frequency(demand: Demands, encoder: Figures) -> Array:
    """Lines of the encoder per second at the highest speed."""
    return np.where(demand.peak_speed == 0.0, 0.0, lines(encoder) * demand.peak_speed / (2 * np.pi))


def counting_limits(spec: RobotSpec, belt: Any, demand: Demands, parts: Parts) -> list[CheckColumn]:
    """Limits of encoders: speed, frequency, their own and the controller's, and resolution."""
    encoder = parts.encoder
    speed: dict[str, Any] = {"needed": spec.margins.speed} | ({} if spec.wants_encoder else PROPOSAL)
    counted = line_frequency(demand, encoder)
    rates = encoder["max_frequency"], parts.controller["max_encoder_frequency"]
    rate = _lower(*rates, counted * (1.0 + spec.margins.speed))
    found = [
        at_most("encoder_speed", demand.peak_speed, encoder["max_speed"], **speed),
        at_most("encoder_frequency", counted, rate, **speed),
    ]
    need = spec.needs.resolution_at_load
    if need is not None:
        geared = belt if spec.gear is None else belt * spec.gear.ratio
        edge = angle_per_edge(lines(encoder), demand.total_ratio * geared)
        found.append(at_most("encoder_resolution", edge, need))
    return found


def _lower(one: Array, other: Array, needed: Array) -> Array:
    """The lower of two limits; where one is unknown, the other for what needs more than that: a certain failure."""
    both, known = np.minimum(one, other), np.fmin(one, other)
    return np.where(np.isnan(both) & (needed > known), known, both)
