"""Probabilities in the JSON document; null where a figure is unknown or there is none."""

from __future__ import annotations

from typing import TYPE_CHECKING

from drivesizer.output.json.loops import number
from drivesizer.results.reliability import Driver, FigureSpread, LoopShare, Reliability, Spread, Uncertainty
from drivesizer.units import from_si

if TYPE_CHECKING:
    from drivesizer.output.json import schema

__all__ = ["reliability", "uncertainty"]


def reliability(found: Reliability | None) -> schema.Reliability | None:
    """Probabilities and quantiles of a sampled drive."""
    if found is None:
        return None
    return {
        "probability": number(found.passing),
        "none_fails": found.probability,
        "error_95": found.error,
        "weakest_check": found.weakest,
        "unknown": list(found.unknown),
        "smallest_margin": _margins(found.low, found.middle, found.high),
        "checks": [_spread(one) for one in found.checks],
        "figures": {one.name: _figure(one) for one in found.figures},
        "drivers": [_driver(one) for one in found.drivers],
        "closed_loop": _loop(found.loop),
        "closed_loop_refused": found.no_loop or None,
    }


def _margins(low: float, middle: float, high: float) -> schema.Margins:
    return {"p5": number(low), "p50": number(middle), "p95": number(high)}


def _spread(one: Spread) -> schema.Spread:
    return {
        "name": one.name,
        "passes": one.passes,
        "fails": one.fails,
        "weakest": one.weakest,
        "margin": _margins(one.low, one.middle, one.high),
    }


def _figure(one: FigureSpread) -> schema.SampledFigure:
    p5, p50, p95 = (
        number(float(from_si(x, one.unit, one.kind))) if x == x else None for x in (one.low, one.middle, one.high)
    )
    return {"p5": p5, "p50": p50, "p95": p95, "unit": one.unit}


def _driver(one: Driver) -> schema.Driver:
    return {
        "name": one.name,
        "share_of_variance": one.share,
        "rank_correlation": one.rank_correlation,
        "at_p5": {"value": one.low, "smallest_margin": number(one.low_margin)},
        "at_p95": {"value": one.high, "smallest_margin": number(one.high_margin)},
    }


def _loop(found: LoopShare | None) -> schema.LoopShare | None:
    if found is None:
        return None
    return {
        "samples": found.samples,
        "probability": number(found.passing),
        "none_fails": found.probability,
        "error_95": found.error,
        "weakest_check": found.weakest,
        "unknown": list(found.unknown),
    }


def uncertainty(found: Uncertainty | None) -> schema.Uncertainty | None:
    """Uncertain figures, and the sampling."""
    if found is None:
        return None
    return {
        "samples": found.samples,
        "seed": found.seed,
        "confidence": found.confidence,
        "sets_sampled": found.examined,
        "sets_that_reach_it": found.reached,
        "assumptions": [{"name": one.name, "tolerance": one.text, "source": one.source} for one in found.assumptions],
        "notes": list(found.notes),
    }
