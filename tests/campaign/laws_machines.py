"""Random machines: starters with other loads, motions, duty, supplies, transmissions, surroundings and catalogues.

The same number gives the same machine. Specs stay plain data, so that a law can write one in another way.
"""

from __future__ import annotations

import copy
import re
import shutil
import sys
import tempfile
from decimal import Decimal
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from drivesizer.catalog import Catalog, load

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "benchmarks"))
from estimates_study import STARTERS, scaled, varied  # noqa: E402

__all__ = [
    "WHOLE",
    "Plain",
    "backwards",
    "catalogue",
    "in_other_units",
    "machine",
    "robot",
    "scaled_by",
    "several_cases",
]

Plain = dict[str, Any]
CATALOGUES = (["robotis"], ["pololu"], ["gobilda"], ["pololu", "gobilda"], ["cubemars", "myactuator"], ["maxon"],
              ["faulhaber"], ["faulhaber", "gobilda"])  # fmt: skip
WHOLE = ["all"]
NEEDS: tuple[Plain, ...] = ({}, {}, {"diameter": "60 mm"}, {"mass": "2 kg"}, {"encoder_counts": 100},
                            {"inertia_ratio": 40}, {"hold_unpowered": True})  # fmt: skip
LOAD = {"mass", "belt_mass", "inertia", "friction_torque", "friction_force", "force", "preload_torque", "rated_torque"}
OTHER = {  # unit -> another of the same kind, and how many of it one is
    "kg": ("g", 1000), "g": ("kg", "1e-3"), "m": ("mm", 1000), "mm": ("m", "1e-3"), "cm": ("mm", 10),
    "m/s": ("mm/s", 1000),
    "mm/s": ("m/s", "1e-3"), "s": ("ms", 1000), "ms": ("s", "1e-3"), "kg*cm^2": ("kg*m^2", "1e-4"),
    "kg*m^2": ("kg*cm^2", 10000),
    "g*cm^2": ("kg*m^2", "1e-7"), "N*m": ("mN*m", 1000), "mN*m": ("N*m", "1e-3"), "N": ("kN", "1e-3"),
    "rpm": ("krpm", "1e-3"),
    "V": ("mV", 1000), "A": ("mA", 1000), "W": ("kW", "1e-3"), "m/s^2": ("mm/s^2", 1000), "m/s^3": ("mm/s^3", 1000),
    "mF": ("F", "1e-3"), "%": ("", "1e-2"),
}  # fmt: skip


@cache
def _starter(kind: str) -> str:
    return (STARTERS / f"{kind}.yaml").read_text(encoding="utf-8")


@cache
def catalogue(*names: str) -> Catalog:
    """Shipped catalogues in that order."""
    return load(names)


@cache
def backwards(*names: str) -> Catalog:
    """Shipped catalogues with the tables of each section, and the rows of each table, in the opposite order."""
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / f"{name}.yaml" for name in names]
        for path in paths:
            path.write_text(_backwards((ROOT / "catalogs" / path.name).read_text(encoding="utf-8")), encoding="utf-8")
        return load(map(str, paths))


def _backwards(text: str) -> str:
    head, *sections = re.split(r"^(?=[a-z_]+:)", text, flags=re.M)
    return head + "".join(map(_tables_backwards, sections))


def _tables_backwards(section: str) -> str:
    head, *tables = re.split(r"^(?=- )", section, flags=re.M)
    rows = re.compile(r"(?<=^  rows:\n)(?:  - \[.*\n(?:    .*\n)*)+", re.M)
    row = re.compile(r"^  - \[.*\n(?:    .*\n)*", re.M)
    return head + "".join(rows.sub(lambda all_: "".join(row.findall(all_[0])[::-1]), table) for table in tables[::-1])


def machine(number: int, folder: Path) -> Plain:
    """The spec of that number; a recorded cycle of its own lies in the folder."""
    rng = np.random.default_rng([number, 7])
    kinds = sorted(p.name[:-5] for p in STARTERS.iterdir() if p.name.endswith(".yaml") and "platform" not in p.name)
    kind = kinds[rng.integers(len(kinds))]
    data = varied(yaml.safe_load(_starter(kind)), rng, folder / f"cycle{number}.csv")
    data["select"] = {
        "catalogs": WHOLE if number % 10 == 9 else CATALOGUES[rng.integers(len(CATALOGUES))],
        "objective": ("mass", "energy")[rng.integers(2)],
    }
    if rng.random() < 0.4 and "screw" not in kind:
        data["transmission"] = [
            {"kind": "gearhead"},
            {"kind": "belt", "ratio": float(rng.choice([0.8, 1.5, 2.5])), "efficiency": 0.95},
        ]
    data["environment"] = {"ambient": f"{rng.integers(5, 45)} degC"}
    data["margins"] = {"torque": f"{rng.integers(0, 20)} %", "speed": f"{rng.integers(0, 10)} %"}
    if rng.random() < 0.5:
        data["supply"] = data.get("supply", {}) | {"current": f"{rng.choice([5, 20, 80])} A"}
    if needs := NEEDS[rng.integers(len(NEEDS))]:
        data["needs"] = dict(needs)
    return data


def robot(number: int, folder: Path) -> Plain:
    """A robot of that number: the example's arm with another payload, other speeds and catalogues."""
    rng = np.random.default_rng([number, 11])
    text = (ROOT / "examples" / "six_joint_arm.yaml").read_text(encoding="utf-8")
    shutil.copy(ROOT / "examples" / "six_joint_arm.urdf", folder)
    data: Plain = yaml.safe_load(text)
    data["robot"]["payload"]["mass"] = f"{rng.uniform(0.1, 4.0):.3g} kg"
    data["robot"]["limits"]["all"] = {"acceleration": f"{rng.uniform(2.0, 12.0):.3g} rad/s^2"}
    data["select"] |= {"catalogs": (WHOLE, ["maxon"], ["cubemars", "myactuator", "robotis"])[rng.integers(3)]}
    return data


def scaled_by(data: Plain, section: str, keys: set[str], factor: float) -> Plain:
    """A copy in which the quantities under some keys of a section are multiplied."""
    other = copy.deepcopy(data)
    if section in other:
        other[section] = scaled(other[section], dict.fromkeys(keys, factor))
    return other


def several_cases(data: Plain, cases: list[Plain]) -> Plain:
    """A copy with further load cases."""
    return copy.deepcopy(data) | {"cases": copy.deepcopy([*data.get("cases", ()), *cases])}


def in_other_units(value: Any) -> Any:
    """The same quantities in other units, exact in decimals."""
    if isinstance(value, dict):
        return {key: in_other_units(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [in_other_units(inner) for inner in value]
    found = re.fullmatch(r"(-?[\d.]+(?:e-?\d+)?) (.+)", value) if isinstance(value, str) else None
    if not found or found[2] not in OTHER:
        return value
    unit, factor = OTHER[found[2]]
    figure = Decimal(found[1]) * Decimal(factor)
    return f"{figure} {unit}" if unit else float(figure)
