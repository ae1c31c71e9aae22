"""Figures with a tolerance in a spec: how each is written, and the section on confidence and samples."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from copy import deepcopy
from typing import Annotated, Any, NamedTuple

from pydantic import BeforeValidator, Field

from drivesizer.catalog.tolerances import CUT, NOT_OF_STEPPERS, OF_STEPPERS, Distribution, share
from drivesizer.errors import InputError, quoted
from drivesizer.files.fields import Section, Share, all_defaults
from drivesizer.files.yaml_source import Path_, YamlSource
from drivesizer.units import KINDS, from_si, kind_of_unit, noun, number, scale, show

__all__ = [
    "FEWEST", "MOST", "ControllerTolerances", "GearheadTolerances", "MotorTolerances", "Toleranced", "Tolerances",
    "has_tolerance", "split_tolerances", "tolerance",
]  # fmt: skip


# -- Reader of figures with a tolerance.
#
# ===================================  ==================================================================
# ``45 kg +- 3 kg``, ``45 kg ± 5 %``   any value between, uniform; per cent are of the figure
# ``0.02 in 0.015..0.03``              nominal value and ends, uniform
# ``uniform(40 kg, 50 kg)``            the same; its middle is the nominal value
# ``triangular(40 kg, 45 kg, 52 kg)``  least, most likely and largest value
# ``normal(24 V, 0.5 V)``              mean and standard deviation, cut off at 4 of them
# ===================================  ==================================================================
#
# ``+/-`` and ``±`` are the same as ``+-``. A number without a unit takes that of its neighbour. Where the figure
# itself is in per cent, so is its width: ``90 % +- 2 %`` is 88 to 92 %.


SHAPES = "normal(24 V, 0.5 V), uniform(23 V, 25 V) or triangular(23 V, 24 V, 26 V)"
_WIDTH = re.compile(r"(?P<nominal>.*?)\s*(?:\+\s?/?\s?[-−]|±)\s*(?P<width>.*)")
_ENDS = re.compile(r"(?P<nominal>.+)\s+in\s+(?P<low>.+?)\s*\.\.\s*(?P<high>.+)")
_SHAPE = re.compile(r"(?P<shape>[A-Za-z_]\w*)\s*\(\s*(?P<arguments>[-+.]?[0-9].*?)\s*\)")
_MARKS = ("+", "±", "..", "(")  # of which each of these forms has one
_NAMES = {
    "name",
    "file",
    "part",
    "trajectory",
    "chemistry",
    "profile",
    "family",
    "title",
    "note",
    "customer",
    "project",
    "author",
    "revision",
}


class Toleranced(NamedTuple):
    """A figure of the spec that carries a tolerance."""

    path: Path_  # in the file
    text: str  # as written there
    nominal: str  # the figure alone, as a text
    value: float  # nominal, SI
    distribution: Distribution  # SI
    kind: str
    unit: str  # a listed one, in which it is shown

    def shown(self, value: float) -> str:
        """A value with its unit, for output."""
        return show(value, self.unit, self.kind)

    def as_text(self, value: float) -> str:
        """A value as a spec has it."""
        if self.unit == "%":  # so that a slope reads it as a grade
            return f"{100.0 * value:.15g} %"
        return f"{value!r} {KINDS[self.kind].si}".removesuffix(" 1")

    def as_angle(self) -> Toleranced:
        """A slope that is written as a grade, by its angle."""
        low, high, peak = map(math.atan, self.distribution[1:])
        angle = self.distribution._replace(low=low, high=high, peak=peak)
        return self._replace(value=math.atan(self.value), distribution=angle, kind="angle", unit="deg")


class _Figure(NamedTuple):
    value: float  # in its own unit
    unit: str


def has_tolerance(text: str) -> bool:
    """Whether a text has the form of a figure with a tolerance."""
    bare = text.strip()
    if not any(mark in bare for mark in _MARKS):  # most texts
        return False
    return any(pattern.fullmatch(bare) for pattern in (_ENDS, _SHAPE)) or (
        bare[:1] in "+-.0123456789" and _WIDTH.fullmatch(bare) is not None
    )


def split_tolerances(source: YamlSource, without: YamlSource | None = None) -> tuple[Any, tuple[Toleranced, ...]]:
    """Split a spec's data into nominal values and the figures with tolerances."""
    places = [
        (path, text) for path, text in _texts(source.data, (), without.data if without else None) if has_tolerance(text)
    ]
    if not places:
        return source.data, ()
    data, found = deepcopy(source.data), []
    for path, text in places:
        if why := _refused(path, data):
            raise InputError(f"{source.where(path)}: {why}; expected it without a tolerance")
        try:
            one = tolerance(text, path)
        except InputError as error:
            raise InputError(f"{source.where(path)}: {error}") from None
        found.append(one)
        place = data
        for step in path[:-1]:
            place = place[step]
        place[path[-1]] = one.nominal
    return data, tuple(found)


def _refused(path: Path_, data: Any) -> str:
    """Reason for which a figure takes no tolerance; empty where it may have one."""
    section, *rest = (path[2:] if path[0] == "cases" else path) or ("",)
    if section == "load" and rest[:1] == ["screw"]:
        return "it chooses among screws of the catalogues"
    if section != "transmission" or len(rest) < 2:
        return ""
    if rest[1] == "pulleys":
        return "it chooses among pulleys of the catalogues"
    stage = data
    for step in path[: len(path) - len(rest) + 1]:
        stage = stage[step]
    of_belt = rest[1] == "ratio" and isinstance(stage, dict) and stage.get("kind") == "belt"
    return "ratios of a belt are searched as they are" if of_belt or rest[1] == "ratios" else ""


def _texts(data: Any, path: Path_, without: Any = None) -> Iterator[tuple[Path_, str]]:
    """Every text of a spec that may be a figure, with its place; what is the same in ``without`` is left out."""
    if isinstance(data, dict):
        others = without if isinstance(without, dict) else {}
        for key, value in data.items():
            if key not in _NAMES and (path or key not in ("select", "tolerances")) and value is not others.get(key):
                yield from _texts(value, (*path, key), others.get(key))
    elif isinstance(data, list):
        for number_, value in enumerate(data):
            yield from _texts(value, (*path, number_))
    elif isinstance(data, str):
        yield path, data


def tolerance(text: str, path: Path_ = ()) -> Toleranced:
    """A figure with its tolerance, in SI.

    Examples
    --------
    >>> found = tolerance("45 kg +- 5 %")
    >>> found.nominal, found.distribution.low, found.distribution.high
    ('45 kg', 42.75, 47.25)
    """
    bare = text.strip()
    for pattern, read in ((_SHAPE, _distribution), (_ENDS, _range_ends), (_WIDTH, _plus_minus)):
        match = pattern.fullmatch(bare)
        if match:
            nominal, distribution, kind, unit = read(match, bare)
            return Toleranced(path, bare, *_nominal(nominal, kind), distribution, kind, unit)
    raise InputError(
        f"{quoted(text)} is no figure with a tolerance; expected 45 kg +- 3 kg, 0.02 in 0.015..0.03, {SHAPES}"
    )


def _nominal(figure: _Figure, kind: str) -> tuple[str, float]:
    """The nominal figure as a text, and in SI."""
    return f"{figure.value:.15g} {figure.unit}".strip(), _si(figure, kind)


_Read = tuple[_Figure, Distribution, str, str]


def _plus_minus(match: re.Match[str], text: str) -> _Read:
    """A nominal value and how far it may be off, either way."""
    nominal, width = _figure(match["nominal"], text), _figure(match["width"], text)
    if not width.value > 0.0:
        raise InputError(f"{quoted(text)}: a width must be above 0; expected e.g. 45 kg +- 3 kg")
    nominal, middle, half, kind, unit = _centred(nominal, width, text)
    return nominal, Distribution("uniform", middle - half, middle + half, middle), kind, unit


def _centred(nominal: _Figure, width: _Figure, text: str) -> tuple[_Figure, float, float, str, str]:
    """A figure and a width about it: both in SI, their kind and unit."""
    if width.unit == "%" and nominal.unit != "%":
        width = _Figure(abs(nominal.value) * width.value / 100.0, nominal.unit)
    nominal, width = _alike([nominal, width])
    kind, unit = _kind([nominal, width], text)
    # a difference of two temperatures: degrees without their zero
    half = width.value * scale(width.unit, kind)[0] if kind == "temperature" else _si(width, kind)
    if not half > 0.0:
        raise InputError(f"{quoted(text)}: per cent of a figure that is 0 are nothing; expected e.g. 0 deg +- 1 deg")
    return nominal, _si(nominal, kind), half, kind, unit


def _range_ends(match: re.Match[str], text: str) -> _Read:
    """A nominal value and both ends."""
    figures = _alike([_figure(match[name], text) for name in ("nominal", "low", "high")])
    kind, unit = _kind(figures, text)
    middle, low, high = (_si(figure, kind) for figure in figures)
    if not low < high:
        raise InputError(
            f"{quoted(text)}: its ends must be apart, the lower one first; expected e.g. 0.02 in 0.015..0.03"
        )
    if not low <= middle <= high:
        raise InputError(f"{quoted(text)}: the figure must lie between its ends; expected e.g. 0.02 in 0.015..0.03")
    return figures[0], Distribution("uniform", low, high, (low + high) / 2.0), kind, unit


def _distribution(match: re.Match[str], text: str) -> _Read:
    """A distribution by name."""
    shape = match["shape"].casefold()
    count = {"normal": 2, "uniform": 2, "triangular": 3}.get(shape)
    if count is None:
        raise InputError(f"{quoted(match['shape'])} is no distribution that is known here; expected {SHAPES}")
    parts = re.split(r"[,;]", match["arguments"])
    if len(parts) != count:
        raise InputError(f"{quoted(text)}: {shape} takes {count} figures; expected {SHAPES}")
    figures = [_figure(part, text) for part in parts]
    if shape == "normal":
        return _normal(figures, text)
    figures = _alike(figures)
    kind, unit = _kind(figures, text)
    values = [_si(figure, kind) for figure in figures]
    if not values[0] < values[-1] or sorted(values) != values:
        raise InputError(f"{quoted(text)}: its figures must rise; expected {SHAPES}")
    if shape == "triangular":
        return figures[1], Distribution("triangular", values[0], values[2], values[1]), kind, unit
    middle = sum(values) / 2.0
    return _Figure(float(from_si(middle, unit, kind)), unit if unit != "1" else ""), Distribution(
        "uniform", values[0], values[1], middle
    ), kind, unit  # fmt: skip


def _normal(figures: list[_Figure], text: str) -> _Read:
    """A mean and a standard deviation, which is a width."""
    mean, deviation = figures
    if not deviation.value > 0.0:
        raise InputError(f"{quoted(text)}: a standard deviation must be above 0; expected normal(24 V, 0.5 V)")
    nominal, middle, one, kind, unit = _centred(mean, deviation, text)
    return nominal, Distribution("normal", middle - CUT * one, middle + CUT * one, middle), kind, unit


def _figure(text: str, whole: str) -> _Figure:
    """A number and its unit."""
    try:
        return _Figure(*number(text.strip()))
    except InputError as error:
        raise InputError(f"{quoted(whole)}: {error}; expected e.g. 45 kg +- 3 kg") from None


def _alike(figures: list[_Figure]) -> list[_Figure]:
    """Figures of which those without a unit take that of the next one that has one."""
    units = [figure.unit for figure in figures if figure.unit]
    if not units:
        return figures
    return [figure if figure.unit else _Figure(figure.value, units[0]) for figure in figures]


def _kind(figures: list[_Figure], text: str) -> tuple[str, str]:
    """The kind of quantity that all figures are, and the first one's unit as it is listed."""
    if not figures[0].unit or figures[0].unit == "%":
        odd = next((figure.unit for figure in figures if figure.unit not in ("", "%")), None)
        if odd:
            raise InputError(f"{quoted(text)}: {quoted(odd)} is not the unit of a plain number")
        return "dimensionless", "%" if figures[0].unit else "1"
    kind = kind_of_unit(figures[0].unit)
    if kind is None:
        raise InputError(f"{quoted(text)}: {quoted(figures[0].unit)} is no unit that is known here")
    for figure in figures[1:]:
        try:
            scale(figure.unit, kind)
        except InputError as error:
            raise InputError(f"{quoted(text)}: {error}; expected {noun(kind)}, e.g. {KINDS[kind].example}") from None
    return kind, _listed(figures[0].unit, kind)


def _listed(unit: str, kind: str) -> str:
    """A unit as it is listed for its kind: the one with the same factor."""
    wanted = scale(unit, kind)
    return next(listed for listed in KINDS[kind].units if scale(listed, kind) == wanted)


def _si(figure: _Figure, kind: str) -> float:
    factor, offset = scale(figure.unit or "1", kind)
    return figure.value * factor + offset


# -- Section ``tolerances`` of a spec: required confidence, samples, and tolerances of catalogue figures.


FEWEST, MOST = 64, 1_000_000  # samples of a drive


def _readable(text: object) -> object:
    if isinstance(text, str):
        share(text)  # an InputError is a ValueError
    return text


Factor = Annotated[str, BeforeValidator(_readable)]
_FACTOR = "+- 7 %, -10 %..30 %, normal(5 %) or none"


class MotorTolerances(Section):
    """Of a motor's figures, as shares of what the catalogue prints; the default class where not given."""

    resistance: Factor | None = Field(default=None, description=_FACTOR)
    torque_constant: Factor | None = Field(default=None, description=_FACTOR)
    friction: Factor | None = Field(default=None, description=f"of friction and iron loss: {_FACTOR}")
    dry_friction: Factor | None = Field(
        default=None, description=f"of the dry share of a brushless motor's no-load torque: {_FACTOR}"
    )
    rotor_inertia: Factor | None = Field(default=None, description=_FACTOR)
    thermal_resistance: Factor | None = Field(default=None, description=f"of both: {_FACTOR}")
    pull_out: Factor | None = Field(default=None, description=f"of a stepper's pull-out torque at any speed: {_FACTOR}")
    holding_torque: Factor | None = Field(default=None, description=f"of a stepper without a printed curve: {_FACTOR}")
    inductance: Factor | None = Field(default=None, description=f"of a stepper without a printed curve: {_FACTOR}")
    start_speed: Factor | None = Field(default=None, description=f"of a stepper without a ramp: {_FACTOR}")


class GearheadTolerances(Section):
    """Of a gearhead's figures; the default class where not given."""

    peak_torque: Factor | None = Field(
        default=None, description=f"of an actuator's peak torque that is its stall torque: {_FACTOR}"
    )
    efficiency: Factor | None = Field(default=None, description=f"of its losses: {_FACTOR}")
    inertia: Factor | None = Field(default=None, description=_FACTOR)


class ControllerTolerances(Section):
    """Of a controller's figures; the default class where not given."""

    losses: Factor | None = Field(default=None, description=f"per ampere: {_FACTOR}")
    phase_current: Factor | None = Field(default=None, description=f"of what a stepper's driver sets: {_FACTOR}")


class Tolerances(Section):
    """Required confidence, and its sampling."""

    confidence: Share | None = Field(default=None, description="probability that no check fails, at least")
    samples: Annotated[int, Field(ge=FEWEST, le=MOST)] = Field(default=8192, description="of each drive")
    loop_samples: Annotated[int, Field(ge=0, le=10_000)] = Field(
        default=64, description="of the best drives in closed loop, where a confidence is required; 0 for none"
    )
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] = Field(default=1, description="the same seed, the same figures")
    motor: MotorTolerances = all_defaults()
    gearhead: GearheadTolerances = all_defaults()
    controller: ControllerTolerances = all_defaults()

    @property
    def given(self) -> dict[tuple[str, str], str]:
        """Tolerances in place of the default classes, by part and figure."""
        parts = {"motor": self.motor, "gearhead": self.gearhead, "controller": self.controller}
        return {
            (part, figure): text
            for part, section in parts.items()
            for figure in type(section).model_fields
            if (text := getattr(section, figure)) is not None
        }

    def foreign(self, *, steps: bool) -> str:
        """The first tolerance of a figure that motors of this kind have not, as in a message; empty without one."""
        for part, figure in self.given:
            if (part, figure) in OF_STEPPERS and not steps:
                return f"tolerances.{part}.{figure}: it is of steppers; expected select: {{motor: {{kind: stepper}}}}"
            if (part, figure) in NOT_OF_STEPPERS and steps:
                return f"tolerances.{part}.{figure}: no check of a stepper depends on it; leave it out"
        return ""
