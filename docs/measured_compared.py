"""Measured points beside the program's prediction with its band, and beside that of a plain data-sheet model."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cache
from math import nan
from pathlib import Path
from typing import NamedTuple

import numpy as np
from measured_data import CELSIUS
from numpy.typing import NDArray

from drivesizer.catalog.query import PartRow, find, open_catalogs
from drivesizer.prediction.predict import completed, predict
from drivesizer.prediction.set_at_voltage import SampledParts, SetAtVoltage, sampled_parts, set_at_voltage
from drivesizer.results.prediction import Band, Conditions

__all__ = ["OWN_PARTS", "ROOM", "Axis", "Comparison", "against", "banded", "part", "predicted", "sampled"]

Array = NDArray[np.float64]

OWN_PARTS = str(Path(__file__).resolve().parent / "measured_parts.yaml")
ROOM = 25.0 + CELSIUS  # K, at which data sheets give the winding
_BENCH = Conditions(nan, ROOM, nan, nan, 0.0, 3600.0, nan, 0.0)
_POWER = 9  # of two: samples, as of ``predict``


class Axis(NamedTuple):
    """How a figure shows a quantity."""

    name: str
    unit: str
    factor: float = 1.0  # of the SI value


class Comparison(NamedTuple):
    """One quantity of one drive: measured points, and what was predicted of them; columns in SI."""

    key: str  # of the text about it
    x: Array
    along: Axis
    y: Array  # measured
    shown: Axis
    low: Array  # 5 % of the samples are below
    nominal: Array
    high: Array  # 5 % are above
    plain: Array  # of a plain data-sheet model; NaN where no sheet has the figure
    least: float = 0.0  # measured values up to here count for the coverage only
    slack: float = 0.0  # by which the instrument itself is off, either way

    @property
    def inside(self) -> NDArray[np.bool_]:
        """Whether each point is within the band."""
        return (self.low - self.slack <= self.y) & (self.y <= self.high + self.slack)

    def errors(self, of: Array) -> Array:
        """Relative errors of a prediction [1]: predicted over measured, less 1."""
        counted = self.y > self.least
        return np.asarray(of[counted] / self.y[counted] - 1.0)

    @property
    def width(self) -> float:
        """Median width of the band over the nominal prediction [1]."""
        counted = self.y > self.least
        return float(np.median((self.high - self.low)[counted] / self.nominal[counted]))


@cache
def part(catalogue: str, name: str) -> PartRow:
    """A part of a catalogue."""
    return find(open_catalogs([catalogue]), name)[0]


def predicted(
    motor: PartRow, figure: str, conditions: Iterable[dict[str, float]], drive: PartRow | None = None
) -> list[Band]:
    """A figure of ``predict`` under one set of conditions after the other."""
    at = (completed(_BENCH._replace(**given), motor, None) for given in conditions)
    return [predict(motor, None, drive, one, warming=False).figure(figure).band for one in at]


def sampled(motor: PartRow, voltage: float, drive: PartRow | None = None) -> tuple[SetAtVoltage, SampledParts]:
    """A motor over the samples of ``predict``, at a supply [V]; the first sample is nominal."""
    parts = sampled_parts(motor, None, drive, _POWER)
    return set_at_voltage(parts, completed(_BENCH._replace(voltage=voltage), motor, None)), parts


def banded(over: Callable[..., Array], *columns: Array) -> list[Band]:
    """Bands of a formula over samples, at one point after the other.

    Parameters
    ----------
    over
        From the values of a point to samples, the first nominal.
    columns
        Values of the points.
    """
    found = (over(*values) for values in zip(*columns, strict=True))
    ends = [np.quantile(x[1:], (0.05, 0.5, 0.95), method="inverted_cdf") for x in found]
    return [Band(p50, p5, p50, p95) for p5, p50, p95 in ends]


def against(
    key: str, x: Array, along: Axis, y: Array, shown: Axis, bands: Sequence[Band], plain: Array | float,
    least: float = 0.0, slack: float = 0.0,
) -> Comparison:  # fmt: skip
    """A comparison of points in the order of x."""
    order = np.argsort(x, kind="stable")
    ends = (np.array([getattr(one, name) for one in bands], float) for name in ("p5", "nominal", "p95"))
    low, nominal, high = (values[order] for values in ends)
    plain = np.broadcast_to(np.asarray(plain, float), np.shape(y))
    return Comparison(key, x[order], along, y[order], shown, low, nominal, high, plain[order], least, slack)
