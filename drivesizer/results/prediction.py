"""A set at the bench as it is predicted: figures with bands, temperatures over time, the line of speed over torque."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from drivesizer.physics.figures import Alike, Array
from drivesizer.results.drive_set import EstimatedFigure

HOTTEST = 573.15  # K: enamel of class 240 has charred, so that a temperature above says no more than this


class Conditions(NamedTuple):
    """Conditions at the bench; SI, torques and inertia at the output."""

    voltage: float  # of the supply
    ambient: float
    load: float  # torque against which it runs
    hold: float  # torque that it holds at rest
    inertia: float  # of what is mounted at the output
    duration: float  # s, of running and of holding
    warm: float  # temperature of winding and housing at a warm start; NaN unknown
    resistance: float  # of supply and leads; NaN: usual leads, with a band


class Band(NamedTuple):
    """Percentiles of a figure over the samples; its nominal value is their median.

    Figures [SI], or arrays over an axis; infinite: not within any time; NaN: unknown.
    """

    nominal: Alike
    p5: Alike
    p50: Alike
    p95: Alike


class Predicted(NamedTuple):
    """One predicted figure."""

    name: str
    group: str  # free, stall, load, step, start, swing, coast, hold, work; start and swing of a machine
    title: str
    kind: str
    unit: str  # of the trade
    band: Band  # SI
    never: float  # share of the samples in which it is not reached; NaN unknown
    over: float  # of a temperature of the winding: share of the samples in which it is above its limit; NaN unknown
    missing: tuple[str, ...]  # figures that no data sheet gives, where it is unknown


class WarmingCourse(NamedTuple):
    """Temperatures over time."""

    name: str
    title: str
    time: Array  # s
    winding: Band  # K, hottest phase
    housing: Band  # K


class Movement(NamedTuple):
    """Movement of a machine over time, one of its drives: at full voltage from rest, or let go with terminals open."""

    name: str  # start or swing
    axis: str  # linear or rotary
    time: Array  # s
    position: Band  # m or rad, from where the motion starts
    speed: Band  # m/s or rad/s, of the load
    current: Band  # A, of the motor


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Prediction:
    """A motor with its gearhead, or an actuator, at the bench."""

    parts: dict[str, str]  # part number by role: motor or actuator, gearhead, controller
    label: str
    digests: dict[str, str]  # of the catalogues
    conditions: Conditions
    figures: tuple[Predicted, ...]
    torque: Array  # N*m, at the output: of the line
    speed: Band  # rad/s, at the output
    courses: tuple[WarmingCourse, ...]  # none where a thermal figure is unknown
    movements: tuple[Movement, ...]  # none without a machine
    limit: float  # K, that the winding may have; NaN unknown
    estimates: tuple[EstimatedFigure, ...]
    tolerances: tuple[tuple[str, str, str], ...]  # name, tolerance, source
    assumptions: tuple[str, ...]
    warnings: tuple[str, ...]
    samples: int

    def figure(self, name: str) -> Predicted:
        """A figure by its name."""
        return next(figure for figure in self.figures if figure.name == name)
