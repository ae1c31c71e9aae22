"""Inputs as careless people write them: specs, catalogues, import maps, each changed by chance, from a seed.

Whatever comes out of them is a result or one line; anything else is a fault. ``python tests/helpers/fuzzing.py 10000``
tries as many of each kind and prints what is none, with the seed that makes it again.
"""

from __future__ import annotations

import contextlib
import copy
import io
import json
import random
import sys
import tempfile
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from math import isinf
from pathlib import Path
from typing import Any

import yaml

from drivesizer.catalog.exchange.exporting import as_document
from drivesizer.catalog.exchange.import_map import plan
from drivesizer.catalog.exchange.importing import import_table
from drivesizer.catalog.laws.check import check
from drivesizer.catalog.lookup import find
from drivesizer.catalog.query import every, open_all
from drivesizer.errors import DrivesizerError
from drivesizer.output.json import documents as json_documents
from drivesizer.output.terminal import part as terminal_part
from drivesizer.output.terminal import sizing as terminal
from drivesizer.simulate import validate
from drivesizer.sizing import size
from drivesizer.spec.robot import load_spec

STARTERS = Path(__file__).resolve().parents[2] / "drivesizer" / "spec" / "starters"

CATALOGUE = """\
catalog: 1
manufacturer: Anymaker
sources: {s: {document: data sheet, confidence: quoted, url: "https://example.org", date: "2024-05"}}
motors:
- family: M 25
  source: s
  common: {kind: brushed, diameter: 25 mm}
  columns: [part, nominal_voltage (V), no_load_speed (rpm), no_load_current (mA), nominal_speed (rpm), nominal_torque (mN*m), nominal_current (A), stall_torque (mN*m), stall_current (A), resistance (ohm), inductance (mH), torque_constant (mN*m/A), speed_constant (rpm/V), rotor_inertia (g*cm^2), thermal_resistance_housing (K/W), thermal_resistance_winding (K/W), winding_time_constant (s), motor_time_constant (s), max_winding_temperature (degC), max_speed (rpm), mass (g), price (EUR)]
  rows:
  - [m1, 24, 9500, 37, 8400, 28, 1.2, 240, 10, 2.4, 0.24, 24, 398, 11, 14, 3, 12, 610, 155, 14000, 130, 100]
  - [m2, 24, 5000, 120, 4600, 400, 9, 6000, 130, 0.18, 0.08, 45, 212, 900, 3, 1, 30, 1500, 155, 9000, 1100, 400]
gearheads:
- family: G 26
  source: s
  common: {kind: planetary}
  columns: [part, reduction, ratio, stages, continuous_torque (N*m), intermittent_torque (N*m), efficiency (%), mass (g), inertia (g*cm^2), continuous_input_speed (rpm), intermittent_input_speed (rpm), backlash (deg)]
  rows:
  - [g1, "5:1", 5, 1, 8, 12, 90, 60, 0.5, 8000, 9000, 0.7]
  - [g2, "27:1", 3249/121, 2, 30, 50, 80, 77, 0.5, 8000, 12000, 0.9]
encoders:
- family: E 1
  source: s
  columns: [part, counts_per_turn, channels, max_frequency (kHz), max_speed (rpm), mass (g)]
  rows: [[e1, 500, 3, 200, 20000, 20]]
controllers:
- family: C 1
  source: s
  common: {drives: brushed, buses: CANopen}
  columns: [part, supply_min (V), supply_max (V), continuous_current (A), peak_current (A), peak_time (s), pwm_frequency (kHz), max_duty (%)]
  rows: [[c1, 10, 50, 5, 15, 10, 50, 90], [c2, 10, 60, 50, 100, 3, 50, 90]]
compatibility:
  motor_gearhead: [{motors: [M 25], gearheads: [G 26, direct], source: s}]
  motor_encoder: [{motors: [M 25], encoders: [E 1], source: s}]
"""  # noqa: E501

TABLE = """\
Order no.,Name,Voltage,Speed,Current,R,Mass
,,V,rpm,mA,ohm,g
1001,M 16,12,8000,20,5.5,40
1002,M 16,24,8100,10,22,40
"""
MAP = """\
manufacturer: Anymaker
source: {name: sheet, document: data sheet, confidence: quoted, date: "2024-05"}
unknown: ["-", n/a]
common: {kind: brushed, diameter: 16 mm}
columns: {Order no.: part, Name: family, Voltage: nominal_voltage, Speed: no_load_speed, Current: no_load_current,
          R: resistance, Mass: mass}
"""

ODD: tuple[Any, ...] = (
    0, -1, 1, 3, 1e300, 5e-324, 1e18, 1e-30, None, True, [], {}, [1], {"a": 1}, "", "~", "x", "0 m", "1e-7 s", "1e9 s",
    "1e300 kg", "5 kg", "-3 rpm", "100 %", "+- 10 %", "24 V +- 5 %", "\u202ex", "a\x1b[31mb", "\x85",
    "1:1", "direct", "mass", "none", "nan", "inf", "9" * 400, "x" * 3000, "0.5 deg", "5e5 rpm", "1e5 N*m", "1e-9 W",
)  # fmt: skip
FACTORS = (0.0, -1.0, 1e-9, 1e-6, 1e-3, 0.1, 0.5, 0.99, 1.01, 2.0, 10.0, 1e3, 1e6, 1e9, 1e30)


def leaves(data: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Paths of all fields, groups among them."""
    if path:
        yield path
    for key, value in data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ():
        yield from leaves(value, (*path, key))


def changed(data: Any, chance: random.Random) -> Any:
    """Data with one to three fields changed: another value, another power of ten, taken away, given twice, misspelt."""
    data = copy.deepcopy(data)
    for _ in range(chance.choice((1, 1, 1, 2, 3))):
        *above, last = chance.choice(list(leaves(data)))
        owner = data
        for step in above:
            owner = owner[step]
        draw = chance.random()
        if draw < 0.55:
            owner[last] = scaled(owner[last], chance)
        elif draw < 0.8:
            owner[last] = copy.deepcopy(chance.choice(ODD))
        elif draw < 0.9:
            del owner[last]
        elif isinstance(owner, list):
            owner.append(copy.deepcopy(owner[last]))
        else:
            owner[f"{last}{chance.choice(('s', '_', chr(0x85), 'x' * 200))}"] = owner[last]
        if not data:
            break
    return data


def scaled(value: Any, chance: random.Random) -> Any:
    """A figure, with its unit where it has one, times some factor; what is none becomes something odd."""
    factor = chance.choice(FACTORS)
    if isinstance(value, int | float) and not isinstance(value, bool):
        return value * factor
    digits, _, unit = str(value).partition(" ")
    try:
        return f"{float(digits) * factor:g} {unit}"
    except ValueError:
        return copy.deepcopy(chance.choice(ODD))


def damaged(text: str, chance: random.Random) -> str:
    """A text with a piece cut out, doubled, or replaced by characters that mean something."""
    at, size = chance.randrange(len(text)), chance.choice((1, 1, 2, 8, 200))
    put = chance.choice(
        ("", "", "'", '"', "[", "{", "}", "]", ":", "- ", "\t", "\x85", "\u2028", "|", "#", "&a ", "*a", "!!x ")
    )
    return text[:at] + put + text[at + size :]


def as_yaml(data: Any, chance: random.Random) -> str:
    text = yaml.safe_dump(data, sort_keys=False, allow_unicode=True)
    return damaged(text, chance) if chance.random() < 0.15 else text


# --- what is done with an input: each raises DrivesizerError, or is done ----------------------------------------------


def spec_once(folder: Path, chance: random.Random) -> None:
    """A starter or example, sized with a small catalogue; some of them in closed loop too."""
    data = yaml.safe_load(chance.choice(sorted(STARTERS.glob("*.yaml"))).read_text(encoding="utf-8"))
    data["select"] = {"catalogs": ["own.yaml"], **({"objective": "mass"} if chance.random() < 0.5 else {})}
    if chance.random() < 0.3:
        data["method"] = chance.choice(("paper", "physics"))
    _write(folder, CATALOGUE, as_yaml(changed(data, chance), chance))
    _sized(folder, loop=chance.random() < 0.04)


def catalogue_once(folder: Path, chance: random.Random) -> None:
    """A catalogue with some figures changed: loaded, checked, shown, exported, sized with."""
    spec = yaml.safe_load((STARTERS / "flywheel.yaml").read_text(encoding="utf-8"))
    spec["select"] = {"catalogs": ["own.yaml"]}
    _write(folder, as_yaml(changed(yaml.safe_load(CATALOGUE), chance), chance), as_yaml(spec, random.Random(1)))
    shelf = open_all([str(folder / "own.yaml")])
    for shelved in shelf.values():
        check(shelved)
    hits = list(every(shelf))
    json_documents.as_text(as_document(shelf, hits, sources=True))
    if hits:
        for hit in find(shelf, chance.choice(hits).part):
            terminal_part.page(hit, sources=True)
    _sized(folder, loop=False)


def table_once(folder: Path, chance: random.Random) -> None:
    """A table that is taken over, its map changed or the table itself."""
    mapping, table = changed(yaml.safe_load(MAP), chance), TABLE
    if chance.random() < 0.4:
        table = damaged(table, chance)
    (folder / "map.yaml").write_text(as_yaml(mapping, chance), encoding="utf-8", errors="replace")
    import_table(table, folder / "parts.csv", plan("motors", folder / "map.yaml", {}), folder / "new.yaml")


def _write(folder: Path, catalogue: str, spec: str) -> None:
    (folder / "own.yaml").write_text(catalogue, encoding="utf-8", errors="replace")
    (folder / "robot.yaml").write_text(spec, encoding="utf-8", errors="replace")
    (folder / "cycle.csv").write_text("time,speed,torque\ns,rpm,N*m\n0,0,0\n1,100,0.1\n2,100,0.1\n3,0,0\n")


def _sized(folder: Path, *, loop: bool) -> None:
    result = size(load_spec(folder / "robot.yaml"), top=2)
    terminal.sizing(result)
    json_documents.as_text(json_documents.sizing(result))
    json.dumps([result.warnings, result.assumptions])
    for found in result.sets:
        for one in found.every_check:
            assert one.status != "pass" or not isinf(one.margin), one
    if loop and result.sets:
        proof = validate(result.spec, result.sets[0])
        terminal.validation(proof)
        json_documents.as_text(json_documents.validation(proof))


KINDS: dict[str, Callable[[Path, random.Random], None]] = {
    "spec": spec_once, "catalogue": catalogue_once, "table": table_once
}  # fmt: skip


def fault_of(kind: str, seed: int, folder: Path) -> str:
    """What went wrong with an input, empty where it came to a result or to one line."""
    try:
        with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            KINDS[kind](folder, random.Random(f"{kind} {seed}"))
    except DrivesizerError as error:
        said = " ".join(str(error).split())
        return "" if said and len(said) < 2000 else f"a message of {len(said)} characters"
    except Exception as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        return f"{Path(where.filename).name}:{where.lineno} {where.name} {type(error).__name__}: {error}"[:200]
    return ""


def main(count: int, first: int, kinds: list[str]) -> None:
    counted: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as name:
        for kind in kinds:
            for seed in range(first, first + count):
                if fault := fault_of(kind, seed, Path(name)):
                    key = f"{kind}: {fault.partition(': ')[0]}"
                    counted[key] += 1
                    if counted[key] == 1:
                        print(f"{kind} {seed}: {fault}", flush=True)
    print(counted)


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0, sys.argv[3:] or list(KINDS))
