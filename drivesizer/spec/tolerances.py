"""Figures with a tolerance in a spec: how each is written, and the section on confidence and samples."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, TypeAlias

from pydantic import BeforeValidator, Field, create_model

from drivesizer.catalog.tolerances import CLASSES, CUT, NOT_OF_STEPPERS, OF_STEPPERS, Distribution, share
from drivesizer.errors import InputError, quoted
from drivesizer.files import fields
from drivesizer.files.yaml_source import Path_, YamlSource, changed, value_at
from drivesizer.units import KINDS, from_si, kind_of_unit, noun, number, scale, show

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
_NAMES = {  # fields that are texts
    "name", "file", "part", "trajectory", "chemistry", "profile", "family", "title", "note", "customer", "project",
    "author", "revision",
}  # fmt: skip


class Toleranced(NamedTuple):
    """A figure of the spec that carries a tolerance."""

    path: Path_  # in the file
    text: str  # as written there
    nominal: str  # the figure alone, as a text
    value: float  # nominal, SI
    distribution: Distribution  # SI
    kind: str
    unit: str  # a listed one, in which it is shown

    def with_unit(self, value: float) -> str:
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


def split_tolerances(source: YamlSource) -> tuple[Any, tuple[Toleranced, ...]]:
    """Split a spec's data into nominal values and the figures with tolerances."""
    data, toleranced = source.data, []
    for path, text in _texts(source.data, ()):
        if not has_tolerance(text):
            continue
        if why := _refused(path, data):
            raise InputError(f"{source.where(path)}: {why}; expected it without a tolerance")
        try:
            figure = tolerance(text, path)
        except InputError as error:
            raise InputError(f"{source.where(path)}: {error}") from None
        toleranced.append(figure)
        data = changed(data, path, figure.nominal)
    return data, tuple(toleranced)


def _refused(path: Path_, data: Any) -> str:
    """Reason for which a figure takes no tolerance; empty where it may have one."""
    section, *rest = (path[2:] if path[0] == "cases" else path) or ("",)
    if section == "load" and rest[:1] == ["screw"]:
        return "it chooses among screws of the catalogues"
    if section != "transmission" or len(rest) < 2:
        return ""
    if rest[1] == "pulleys":
        return "it chooses among pulleys of the catalogues"
    stage = value_at(data, path[: len(path) - len(rest) + 1])
    of_belt = rest[1] == "ratio" and isinstance(stage, dict) and stage.get("kind") == "belt"
    return "ratios of a belt are searched as they are" if of_belt or rest[1] == "ratios" else ""


def _texts(data: Any, path: Path_) -> Iterator[tuple[Path_, str]]:
    """Every text of a spec that may be a figure, with its place."""
    if isinstance(data, dict):
        for key, value in data.items():
            if key not in _NAMES and (path or key not in ("select", "tolerances")):
                yield from _texts(value, (*path, key))
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
    if match := _SHAPE.fullmatch(bare):
        shape, parts = match["shape"].casefold(), re.split(r"[,;]", match["arguments"])
        count = {"normal": 2, "uniform": 2, "triangular": 3}.get(shape)
        if count is None:
            raise InputError(f"{quoted(match['shape'])} is no distribution that is known here; expected {SHAPES}")
        if len(parts) != count:
            raise InputError(f"{quoted(bare)}: {shape} takes {count} figures; expected {SHAPES}")
    elif match := _ENDS.fullmatch(bare):
        shape, parts = "ends", [match[name] for name in ("nominal", "low", "high")]
    elif match := _WIDTH.fullmatch(bare):
        shape, parts = "width", [match["nominal"], match["width"]]
    else:
        raise InputError(
            f"{quoted(text)} is no figure with a tolerance; expected 45 kg +- 3 kg, 0.02 in 0.015..0.03, {SHAPES}"
        )
    figures = [_figure(part, bare) for part in parts]
    if shape in ("width", "normal"):
        nominal, distribution, kind, unit = _centred(figures[0], figures[1], bare, normal=shape == "normal")
    else:
        figures = _alike(figures)
        kind, unit = _kind(figures, bare)
        values = [_si(figure, kind) for figure in figures]
        if shape == "ends":
            middle, low, high = values
            if not low < high or not low <= middle <= high:
                apart = "the figure must lie between its ends" if low < high else (
                    "its ends must be apart, the lower one first"
                )  # fmt: skip
                raise InputError(f"{quoted(bare)}: {apart}; expected e.g. 0.02 in 0.015..0.03")
            nominal, distribution = figures[0], Distribution("uniform", low, high, (low + high) / 2.0)
        elif not values[0] < values[-1] or sorted(values) != values:
            raise InputError(f"{quoted(bare)}: its figures must rise; expected {SHAPES}")
        elif shape == "triangular":
            nominal, distribution = figures[1], Distribution("triangular", values[0], values[2], values[1])
        else:
            middle = sum(values) / 2.0
            nominal = _Figure(float(from_si(middle, unit, kind)), unit if unit != "1" else "")
            distribution = Distribution("uniform", values[0], values[1], middle)
    written = f"{nominal.value:.15g} {nominal.unit}".strip()
    return Toleranced(path, bare, written, _si(nominal, kind), distribution, kind, unit)


def _centred(nominal: _Figure, width: _Figure, text: str, *, normal: bool) -> tuple[_Figure, Distribution, str, str]:
    """A figure and how far it may be off either way, or its standard deviation."""
    if not width.value > 0.0:
        what, example = ("standard deviation", "normal(24 V, 0.5 V)") if normal else ("width", "e.g. 45 kg +- 3 kg")
        raise InputError(f"{quoted(text)}: a {what} must be above 0; expected {example}")
    if width.unit == "%" and nominal.unit != "%":
        width = _Figure(abs(nominal.value) * width.value / 100.0, nominal.unit)
    nominal, width = _alike([nominal, width])
    kind, unit = _kind([nominal, width], text)
    # a difference of two temperatures: degrees without their zero
    half = width.value * scale(width.unit, kind)[0] if kind == "temperature" else _si(width, kind)
    if not half > 0.0:
        raise InputError(f"{quoted(text)}: per cent of a figure that is 0 are nothing; expected e.g. 0 deg +- 1 deg")
    middle, reach = _si(nominal, kind), CUT * half if normal else half
    shape: Literal["normal", "uniform"] = "normal" if normal else "uniform"
    return nominal, Distribution(shape, middle - reach, middle + reach, middle), kind, unit


def _figure(text: str, whole: str) -> _Figure:
    """A number and its unit."""
    try:
        return _Figure(*number(text.strip()))
    except InputError as error:
        raise InputError(f"{quoted(whole)}: {error}; expected e.g. 45 kg +- 3 kg") from None


def _alike(figures: list[_Figure]) -> list[_Figure]:
    """Figures of which those without a unit take that of the next one that has one."""
    unit = next((figure.unit for figure in figures if figure.unit), "")
    return [figure if figure.unit else _Figure(figure.value, unit) for figure in figures]


def _kind(figures: list[_Figure], text: str) -> tuple[str, str]:
    """The kind of quantity that all figures are, and the first one's unit as it is listed."""
    first = figures[0].unit
    if first in ("", "%"):
        odd = next((figure.unit for figure in figures if figure.unit not in ("", "%")), None)
        if odd:
            raise InputError(f"{quoted(text)}: {quoted(odd)} is not the unit of a plain number")
        return "dimensionless", first or "1"
    kind = kind_of_unit(first)
    if kind is None:
        raise InputError(f"{quoted(text)}: {quoted(first)} is no unit that is known here")
    for figure in figures[1:]:
        try:
            scale(figure.unit, kind)
        except InputError as error:
            raise InputError(f"{quoted(text)}: {error}; expected {noun(kind)}, e.g. {KINDS[kind].example}") from None
    return kind, next(listed for listed in KINDS[kind].units if scale(listed, kind) == scale(first, kind))


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


def _section(part: str, doc: str) -> type[fields.Section]:
    """Section on the figures of a part that ``tolerances.txt`` declares."""
    own: dict[str, Any] = {entry.figure: (Factor | None, fields.optional(entry.help or None, "+- 7 %"))
           for entry in CLASSES.values() if entry.part == part}  # fmt: skip
    return create_model(f"{part.title()}Tolerances", __base__=fields.Section, __doc__=doc, **own)


if TYPE_CHECKING:
    MotorTolerances: TypeAlias = fields.Section
    GearheadTolerances: TypeAlias = fields.Section
    ControllerTolerances: TypeAlias = fields.Section
else:
    MotorTolerances = _section(
        "motor",
        "Of a motor's figures, as shares of what is printed: +- 7 %, -10 %..30 %, 0.5..1.1 times, none; else by class.",
    )
    GearheadTolerances = _section("gearhead", "Of a gearhead's figures; the default class where not given.")
    ControllerTolerances = _section("controller", "Of a controller's figures; the default class where not given.")


class Tolerances(fields.Section):
    """Required confidence, and its sampling."""

    confidence: fields.Share | None = fields.optional("probability that no check fails, at least")
    samples: Annotated[int, Field(ge=FEWEST, le=MOST)] = fields.default(8192, "of each drive")
    loop_samples: Annotated[int, Field(ge=0, le=10_000)] = fields.default(
        64, "of the best drives in closed loop, where a confidence is required; 0 for none"
    )
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] = fields.default(1, "the same seed, the same figures")
    motor: MotorTolerances = fields.all_defaults()
    gearhead: GearheadTolerances = fields.all_defaults()
    controller: ControllerTolerances = fields.all_defaults()

    @property
    def classes(self) -> dict[tuple[str, str], str]:
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
        for part, figure in self.classes:
            if (part, figure) in OF_STEPPERS and not steps:
                return f"tolerances.{part}.{figure}: it is of steppers; expected select: {{motor: {{kind: stepper}}}}"
            if (part, figure) in NOT_OF_STEPPERS and steps:
                return f"tolerances.{part}.{figure}: no check of a stepper depends on it; leave it out"
        return ""
