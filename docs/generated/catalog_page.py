"""What ships, counted; laws against its figures; columns of catalogues as tables: unit of data sheets, remark."""

from __future__ import annotations

from collections import Counter
from functools import cache

import numpy as np

from drivesizer import catalog
from drivesizer.catalog.parts import DIRECT, PARTS, columns_of, printed
from drivesizer.physics.drive_train import back_emf_constant, commutation

__all__ = ["actuators", "columns", "combinations", "makers", "permitted", "shipped", "with_overlap", "without_overlap"]

_PAIRS = "listed combinations of motor and gearhead"
_NAMED = 8  # makers by name in a line of what ships


def makers() -> str:
    """Number of makers whose parts ship: a file each."""
    return str(len(catalog.shipped()))


def actuators() -> str:
    """Number of actuators and gearmotors that ship."""
    return f"{_counts()['actuators'].total():,}"


def combinations() -> str:
    """Number of listed combinations of motor and gearhead."""
    return f"{_counts()[_PAIRS].total():,}"


def permitted() -> str:
    """Number of motors that print a permissible and a no-load speed."""
    motors = (catalog.load([name]).motors for name in catalog.shipped())
    return str(sum(np.isfinite(one["max_speed"] * one["no_load_speed"]).sum() for one in motors))


def with_overlap(share: float = 1.0) -> str:
    """Of maxon's brushless motors those whose nominal speed the law of commutation meets within 1 %."""
    motor = catalog.load(["maxon"]).motors.columns
    V, I, R = (motor[name] for name in ("nominal_voltage", "nominal_current", "resistance"))
    X = commutation(motor)
    off = (V - R * I) / (back_emf_constant(motor) + share * X * I) / motor["nominal_speed"] - 1
    known = np.isfinite(off) & (X > 0)
    return f"{(np.abs(off[known]) < 0.01).sum()} of {known.sum()}"


def without_overlap() -> str:
    """The same without what commutation takes of the voltage."""
    return with_overlap(0.0)


def shipped() -> str:
    """A line for each kind of part: how many, and of whom."""
    return "\n".join(["| | parts | of |", "|---|---|---|", *(_line(*row) for row in _counts().items())])


@cache
def _counts() -> dict[str, Counter[str]]:
    counts: dict[str, Counter[str]] = {section.replace("_", " "): Counter() for section in PARTS} | {_PAIRS: Counter()}
    for name in catalog.shipped():
        one = catalog.load([name])
        for section, of in zip(PARTS, counts.values(), strict=False):
            of.update(one.table(section)["manufacturer"][one.table(section)["part"] != DIRECT].tolist())
        made = one.motor_gearhead
        geared = one.gearheads["part"][made.right] != DIRECT
        counts[_PAIRS].update(one.motors["manufacturer"][made.left[geared]].tolist())
    return counts


def _line(kind: str, counts: Counter[str]) -> str:
    ranked = sorted(counts.items(), key=lambda one: (-one[1], one[0]))
    named = ", ".join(f"{maker} {count:,}" for maker, count in ranked[:_NAMED])
    further = f" and {len(ranked) - _NAMED} more" if len(ranked) > _NAMED else ""
    return f"| {kind} | {counts.total():,} | {named}{further} |"


def columns() -> str:
    """A table for each section: column with its unit, and what its name does not say; a line for all others."""
    every = {name for name in printed("motors") if all(name in printed(section) for section in PARTS)}
    common = ", ".join(f"`{name}`{_unit('motors', name)}" for name in printed("motors") if name in every)
    head = (
        f"All parts have {common}; `price` is that of 1 to 4 pieces, `foreign_price` in `currency` where it is not EUR."
    )
    return "\n\n".join([head, *(_section(section, every) for section in PARTS)])


def _section(section: str, every: set[str]) -> str:
    own = {name: column.remark for name, column in printed(section).items() if name not in every}
    rows = [f"| `{name}`{_unit(section, name)} | {remark} |" for name, remark in own.items() if remark]
    bare = ", ".join(f"`{name}`{_unit(section, name)}" for name, remark in own.items() if not remark)
    further = [f"Named as what they are: {bare}.", ""] if bare else []
    return "\n".join([f"### {section}", "", *further, "| column | what it is |", "|---|---|", *rows])


def _unit(section: str, name: str) -> str:
    column = columns_of(section)[name]
    return "" if column.kind == "text" or column.unit in ("", "1") else f" ({column.unit})"
