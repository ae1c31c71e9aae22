"""A drive by its log: figures with bands, those it cannot separate, and the log beside a sizing."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import nan
from typing import NamedTuple

from drivesizer.physics.figures import Array
from drivesizer.results.check import Status


class IdentifiedFigure(NamedTuple):
    """A figure out of a log, with its band of 95 %."""

    name: str
    title: str
    kind: str
    unit: str  # of the trade
    value: float  # SI
    low: float  # SI
    high: float  # SI; infinite: the log gives a lower bound alone
    basis: str  # which of the bands is the widest: formal, bootstrap, subsets; or where else the figure is from
    printed: float = nan  # on the data sheet [SI]
    deviation: float = nan  # from it, in standard deviations of band and tolerance together


class Inseparable(NamedTuple):
    """Figures that a log does not separate, and what would."""

    figures: str
    reason: str
    needs: str


class LogFinding(NamedTuple):
    """Finding of a check of the log; a factor that would mend it."""

    name: str
    text: str
    factor: float = nan  # times the column
    severe: bool = False


class Trace(NamedTuple):
    """A quantity over time as it was measured, and as the model has it."""

    name: str
    kind: str
    unit: str
    measured: Array  # SI
    modelled: Array  # SI


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Identification:
    """A drive as its log has it."""

    log: str  # name of the file
    label: str = ""  # of the motor that it is held against; empty without one
    columns: dict[str, str] = field(default_factory=dict)  # quantity -> head in the file
    samples: int
    duration: float = nan  # s
    driven: str = "none"  # by which column the model is driven: voltage, current, or none of a table of steady points
    figures: tuple[IdentifiedFigure, ...]
    inseparable: tuple[Inseparable, ...]
    findings: tuple[LogFinding, ...]
    condition: float = nan  # of the scaled Jacobian of what is fitted
    time: Array  # s, of the traces
    traces: tuple[Trace, ...]
    remarks: tuple[str, ...] = ()

    def figure(self, name: str) -> IdentifiedFigure:
        """A figure by its name."""
        for figure in self.figures:
            if figure.name == name:
                return figure
        raise KeyError(name)


class Compared(NamedTuple):
    """A check of the sizing with its demand as promised and as measured."""

    name: str
    title: str
    kind: str
    unit: str
    promised: float  # SI
    measured: float  # SI; NaN: the log does not have it
    limit: float  # SI
    margin: float  # promised
    left: float  # measured
    status: Status  # by the measured demand


class Explanation(NamedTuple):
    """A figure of the spec that would explain the difference of the torques."""

    field: str
    entered: str
    explains: str  # a value with its unit, as a spec has it
    share: float  # of the squared difference that it takes away


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Comparison:
    """A machine's log beside its sizing."""

    log: str
    label: str
    over: str  # name of the profile
    checks: tuple[Compared, ...]
    explanations: tuple[Explanation, ...]  # the best first
    difference: float  # N*m at the motor: RMS of what the log needs more or less than the model
    torque: float  # N*m at the motor: RMS of what it needs
    findings: tuple[LogFinding, ...]
    remarks: tuple[str, ...]
    time: Array
    traces: tuple[Trace, ...]  # motor torque, measured and as the spec has it
