"""Expressions over the figures of a part by name, as tables of laws have them: of one part or of columns.

>>> figures = {"nominal_voltage": 12.0, "stall_current": 85.0, "resistance": float("nan")}
>>> round(float(solved("stall_current * resistance = nominal_voltage", figures, "resistance")), 4)
0.1412
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from drivesizer.files.arithmetic import code, own_value
from drivesizer.files.yaml_source import shipped_data
from drivesizer.physics import thermal

Numbers = NDArray[np.float64]


def _sizes() -> dict[str, Any]:
    return shipped_data("drivesizer.catalog", "laws.yaml")["sizes"]


def _nearest(values: Numbers, series: Sequence[float]) -> Numbers:
    """The nearest by ratio of the sizes that are made; unknown for an unknown value."""
    sizes = np.array(series, float)
    nearest = sizes[np.abs(np.log(values[:, None] / sizes)).argmin(axis=1)]
    return np.where(np.isnan(values), np.nan, nearest)


def _pitch_of_profile(profile: NDArray[np.str_], pitch: Numbers) -> Numbers:
    pitches = np.full(len(pitch), np.nan)
    for name, series in _sizes()["pitches"].items():
        pitches = np.where(profile == name, _nearest(pitch * 1e3, series) / 1e3, pitches)
    return pitches


def _leading_number(texts: NDArray[np.str_]) -> Numbers:
    """The number in front of ``:1``; unknown where a reduction is written otherwise."""
    bare = [text.removesuffix(":1") for text in texts.tolist()]
    return np.array([float(digits) if re.fullmatch(r"[0-9]+(\.[0-9]*)?", digits) else np.nan for digits in bare], float)


def _groups(*columns: NDArray[Any]) -> NDArray[np.intp]:
    """Number of the group in which parts agree; an unknown figure agrees with an unknown one."""
    group: NDArray[np.intp] = np.zeros(len(columns[0]), np.intp)
    for column in columns:
        numbers = np.unique(column, return_inverse=True)[1]
        group = np.unique(group * (len(group) + 1) + numbers, return_inverse=True)[1]
    return group


def _across_offers(values: Numbers, offered: NDArray[np.bool_], how: Callable[[Numbers], Any]) -> float:
    """Median, least or greatest of some offered parts that have the figure."""
    figures = values[offered & ~np.isnan(values)]
    return float(how(figures)) if len(figures) else np.nan


def _median(values: Numbers, excluded: NDArray[np.bool_], *alike: NDArray[Any]) -> Numbers:
    """The median over the parts that agree in some columns; unknown where one of these is."""
    group = _groups(*alike)
    medians = [_across_offers(values, (group == k) & ~excluded, np.median) for k in range(group.max(initial=-1) + 1)]
    known = np.all([~np.isnan(column) for column in alike if column.dtype.kind == "f"], axis=0)
    return np.where(known, np.array(medians, float)[group], np.nan)


def _of_a_stage_less(how: Callable[[Numbers], Any]) -> Callable[..., Numbers]:
    """The least or greatest figure of the same gearhead with the next lower number of stages."""

    def values(figure: Numbers, excluded: NDArray[np.bool_], stages: Numbers, *alike: NDArray[Any]) -> Numbers:
        group, bounds = _groups(*alike), np.full(len(figure), np.nan)
        for k in range(group.max(initial=-1) + 1):
            for less, more in pairwise(np.unique(stages[(group == k) & ~np.isnan(stages)])):
                lesser = _across_offers(figure, (group == k) & (stages == less) & ~excluded, how)
                bounds[(group == k) & (stages == more)] = lesser
        return bounds

    return values


def _known(printed: Any, otherwise: Any) -> Any:
    return np.where(np.isnan(printed), otherwise, printed)


def _parabola(x: Numbers, at_0: Numbers, at_half: Numbers, at_1: Numbers) -> Numbers:
    """Figure at a share of the permissible speed by those at 0, half and all of it; unknown beyond."""
    curve = at_0 * (1 - x) * (1 - 2 * x) + at_half * 4 * x * (1 - x) + at_1 * x * (2 * x - 1)
    return np.where(x <= 1, curve, np.nan)


_FUNCTIONS: dict[str, Any] = {
    "unknown": np.isnan, "known": _known, "nan": np.nan, "infinite": np.inf,
    "smaller": np.minimum, "larger": np.maximum, "abs": np.abs,
    "choose": np.where, "pi": np.pi, "median": _median, "parabola": _parabola, "leading_number": _leading_number,
    "least_of_a_stage_less": _of_a_stage_less(np.min), "greatest_of_a_stage_less": _of_a_stage_less(np.max),
    "pitch_of_profile": _pitch_of_profile, "nearest_full_steps": lambda steps: _nearest(steps, _sizes()["full_steps"]),
    "whole": np.round, "nominal_current_by_heat": thermal.nominal_current,
    "continuous_current_by_heat": thermal.continuous_current,
}  # fmt: skip
# figures that no column has, each with the column that stands for it
FURTHER: dict[str, tuple[Callable[[Any], Any], str]] = {
    "k_e": (lambda m: _known(m["back_emf_constant"], m["torque_constant"]), "torque_constant"),
    "motor_k_e": (lambda m: _known(m["motor_back_emf_constant"], m["motor_torque_constant"]), "motor_torque_constant"),
    "resistance_25": (thermal.resistance_25, "resistance"),
    "ambient_of_rating": (thermal.rated_ambient, ""),
}  # fmt: skip


def value(expression: str, figures: Any, **instead: Any) -> Any:
    """The value of an expression over figures by name, some of them replaced."""
    namespace = dict[str, Any](instead)
    for name in code(expression).co_names:
        if name in FURTHER and name not in namespace:
            of = _Replaced(figures, instead) if instead else figures
            namespace[name] = FURTHER[name][0](of)
        elif name == "excluded":
            namespace[name] = figures.excluded
        elif name not in namespace:
            namespace[name] = _FUNCTIONS[name] if name in _FUNCTIONS else figures[name]
    with np.errstate(all="ignore"):
        return own_value(expression, namespace)


class _Replaced:
    """Figures of which some are others."""

    def __init__(self, figures: Any, instead: Mapping[str, Any]) -> None:
        self.figures, self.instead = figures, instead

    def __getitem__(self, name: str) -> Any:
        return self.instead.get(name, self.figures[name])


def solved(equation: str, figures: Any, unknown: str) -> Numbers:
    """The figure that fulfils an equation in which it is linear."""
    left, right = equation.partition(" where ")[0].split(" = ")
    if left == unknown:
        return np.asarray(value(right, figures))
    at_0, at_1 = (value(f"({left}) - ({right})", figures, **{unknown: at}) for at in (0.0, 1.0))
    with np.errstate(all="ignore"):
        return np.asarray(at_0 / (at_0 - at_1))
