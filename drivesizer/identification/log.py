"""Logs of drives as people have them, to one record: columns in SI by quantity, and where moves begin.

Tables by the heads of ``figures.txt``; JSON of WPILib SysId and of pendulum rigs (BAM); WPILib's binary data logs.
Where a head says no unit that of the SI is taken, with a remark: a speed that is off by 2 pi is found by its figures.
"""

from __future__ import annotations

import json
import struct
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import pairwise
from math import nan
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError, quoted
from drivesizer.files.sheets import as_text, decimal_sign, plain_head, split_head, tables_of, unit_of
from drivesizer.files.text import read_bytes
from drivesizer.identification import declared
from drivesizer.units import KINDS, kind_of_unit, scale

Array = NDArray[np.float64]

# -- WPILib's binary data log, version 1.0: numeric entries over time.
#
# After a header ``WPILOG``, version and a text, records follow one another: a byte says how many bytes entry, size and
# time [us] have; entry 0 starts and ends others. All numbers have their least byte first. A record that reaches beyond
# the file is the end of a log that was cut off.

SIGNATURE = b"WPILOG"
_MOST_ENTRIES = 10_000
_MOST_RECORDS = 5_000_000
_NUMBERS = {"double": "<d", "float": "<f", "int64": "<q", "boolean": "<?"}


def entries(raw: bytes, path: Path) -> dict[str, tuple[Array, Array]]:
    """Times [s] and values of each numeric entry by its name."""
    if len(raw) < 12 or raw[6:8] != b"\x00\x01":
        raise InputError(f"{path}: is no data log of version 1.0")
    at = 12 + int.from_bytes(raw[8:12], "little")
    names: dict[int, tuple[str, str]] = {}
    series: dict[str, tuple[list[float], list[float]]] = defaultdict(lambda: ([], []))
    for _ in range(_MOST_RECORDS):
        if at >= len(raw):
            break
        lengths = raw[at]
        wide = (lengths & 3) + 1, (lengths >> 2 & 3) + 1, (lengths >> 4 & 7) + 1
        ends = at + 1, at + 1 + wide[0], at + 1 + wide[0] + wide[1], at + 1 + sum(wide)
        entry, size, moment = (int.from_bytes(raw[a:b], "little") for a, b in pairwise(ends))
        start, at = ends[3], ends[3] + size
        if at > len(raw):
            break
        if entry == 0:
            _control(raw[start:at], names)
            if len(names) > _MOST_ENTRIES:
                raise InputError(f"{path}: more than {_MOST_ENTRIES} entries; expected the log of a robot")
        elif entry in names:
            name, form = names[entry]
            if form in _NUMBERS and size == struct.calcsize(_NUMBERS[form]):
                times, values = series[name]
                times.append(moment / 1e6)
                values.append(float(struct.unpack(_NUMBERS[form], raw[start:at])[0]))
    return {name: (np.array(t), np.array(y)) for name, (t, y) in series.items() if len(t) > 1}


def _control(body: bytes, names: dict[int, tuple[str, str]]) -> None:
    """Start or end of an entry."""
    if len(body) < 5:
        return
    entry = int.from_bytes(body[1:5], "little")
    if body[0] == 1:
        names.pop(entry, None)
    elif body[0] == 0:
        texts, at = [], 5
        for _ in range(2):
            size = int.from_bytes(body[at : at + 4], "little")
            texts.append(body[at + 4 : at + 4 + size].decode("utf-8", "replace")[:200])
            at += 4 + size
        names[entry] = texts[0], texts[1]


LARGEST = 64_000_000  # bytes
_MOST = 1_000_000  # rows
_FEWEST = 20  # rows
_ABOVE = 60  # rows among which the heads are
_GRAVITY = 9.80665  # m/s^2
_GAP = 10.0  # times the usual interval, from which on a move has ended
_UNMOVED = 1e-9  # share by which a column changes that says nothing


class Log(NamedTuple):
    """A log: columns in SI by quantity, moves one behind another."""

    name: str
    columns: dict[str, Array]  # time among them, unless the rows are steady points
    heads: dict[str, str]  # quantity -> as the file has it
    starts: tuple[int, ...]  # rows at which moves begin
    remarks: tuple[str, ...]
    inertia: float = nan  # kg*m^2 of what is known to be mounted at the output
    weight: Array | None = None  # N*m at the output against forward motion, where the rig's load is known

    @property
    def steady(self) -> bool:
        """Whether the rows are points at rest or at constant speed, not moments."""
        return "time" not in self.columns

    @property
    def moves(self) -> list[slice]:
        """The rows of each move."""
        ends = (*self.starts[1:], len(next(iter(self.columns.values()))))
        return [slice(first, end) for first, end in zip(self.starts, ends, strict=True)]

    def rows(self, rows: NDArray[np.bool_]) -> Log:
        """The log with some of its rows."""
        return self._replace(
            columns={name: column[rows] for name, column in self.columns.items()},
            starts=tuple(sorted({int(rows[:k].sum()) for k in self.starts})),
            weight=None if self.weight is None else self.weight[rows],
        )


QUANTITIES = "time supply voltage duty current speed load_speed reference error position torque winding housing power"
# quantity | kinds of its unit | heads, the most usual first; of several columns that mean one the first is taken
_QUANTITIES = {
    name: (kinds.split(), [word.strip() for word in words.split(";")]) for name, kinds, words in declared("quantities")
}


def read_log(path: Path, named: Mapping[str, str] = MappingProxyType({}), content: bytes | None = None) -> Log:
    """Read a log."""
    raw = read_bytes(path, LARGEST) if content is None else content
    if not raw.strip(b" \r\n\t\0"):
        raise InputError(f"{path}: is empty; expected a header and rows of time, voltage, current, speed")
    if raw.startswith(SIGNATURE):
        return _checked(_data_log(raw, path), path)
    if path.suffix == ".json" or raw.lstrip()[:1] == b"{":
        return _checked(_json(raw, path), path)
    return _checked(_table(raw, path, named), path)


def _checked(log: Log, path: Path) -> Log:
    """A log whose numbers are finite, whose time rises, and in which something changes."""
    count = len(next(iter(log.columns.values())))
    if count < _FEWEST and not log.steady:
        raise InputError(f"{path}: {count} rows; expected at least {_FEWEST}")
    if count > _MOST:
        raise InputError(f"{path}: {count} rows; expected at most {_MOST}: log less often, or a part of it")
    lost = np.zeros(count, bool)
    for name, column in log.columns.items():
        bad = ~np.isfinite(column)
        if bad.mean() > 0.2:
            raise InputError(
                f"{path}: {log.heads[name]}: {int(bad.sum())} of {count} rows are no numbers; expected figures"
            )
        lost |= bad
    remarks = list(log.remarks)
    if lost.any():
        remarks.append(f"{int(lost.sum())} of {count} rows with a cell that is no number are left out")
        log = log.rows(~lost)
    if not log.steady:
        apart = np.diff(log.columns["time"])
        inner = np.ones(len(apart), bool)
        inner[[k - 1 for k in log.starts if 0 < k <= len(apart)]] = False
        if not (apart[inner] > 0.0).mean() > 0.9:
            raise InputError(f"{path}: {log.heads['time']}: does not rise; expected the time of each row")
        if not (apart[inner] > 0.0).all():  # a row written twice
            rows = np.append(True, (apart > 0.0) | ~inner)
            remarks.append(f"{int((~rows).sum())} rows with the time of the row before are left out")
            log = log.rows(rows)
            apart = np.diff(log.columns["time"])
        gaps = np.flatnonzero((apart > _GAP * float(np.median(apart[apart > 0.0]))) | (apart <= 0.0)) + 1
        log = log._replace(starts=tuple(sorted({*log.starts, *gaps.tolist()})))
    changing = [n for n, c in log.columns.items() if n != "time" and np.ptp(c) > _UNMOVED * (np.abs(c).max() or 1.0)]
    if not changing:
        raise InputError(f"{path}: nothing changes in {', '.join(log.heads.values())}; expected a move")
    return log._replace(remarks=tuple(remarks))


# -- Tables.


def _table(raw: bytes, path: Path, named: Mapping[str, str]) -> Log:
    table = max(tables_of(raw, path), key=lambda table: len(table.rows))
    rows = [(line, cells) for line, cells in table.rows if any(cells)]
    rows = [(line, cells) for line, cells in rows if not cells[0].startswith("#")]
    named_heads = set(named.values())
    heads_at = [(place, cells) for place, (_, cells) in enumerate(rows[:_ABOVE]) if named_heads <= set(cells)]
    if named_heads and not heads_at:
        widest = max((cells for _, cells in rows[:_ABOVE]), key=len, default=[])
        raise InputError(
            f"{path}: no row has the heads {quoted(', '.join(named_heads))}; found {quoted(', '.join(widest), 200)}"
        )
    header = next(((place, at) for place, cells in heads_at if len(at := _meant(cells, named)) >= 2), None)
    if header is None:
        raise InputError(f"{path}: no header was found; expected e.g. time (s),voltage (V),current (A),speed (rpm)")
    place, at = header
    heads = rows[place][1]
    below = rows[place + 1][1] if place + 1 < len(rows) else []
    own = [unit_of(cell.replace("rad.s", "rad/s").replace("Deg C", "degC")) for cell in below]
    has_units = any(own) and not any(
        not unit and cell.lstrip("+-")[:1].isdigit() for cell, unit in zip(below, own, strict=True)
    )
    numbers = rows[place + 1 + has_units :]
    decimal = decimal_sign([cell for _, row in numbers[:500] for cell in row], table.separator)
    columns, remarks = dict[str, Array](), list[str]()
    for name, k in at.items():
        unit = split_head(heads[k])[1] or (own[k] if has_units and k < len(own) else "")
        factor, offset = _factor(name, unit, heads[k], remarks)
        cells = [_number(row[k] if k < len(row) else "", decimal) for _, row in numbers]
        columns[name] = np.array(cells, float) * factor + offset
    return Log(path.name, columns, {name: heads[k] for name, k in at.items()}, (0,), tuple(remarks))


def _number(cell: str, decimal: str) -> float:
    try:
        return float(cell.replace(",", ".") if decimal == "," else cell) if "_" not in cell else nan
    except ValueError:
        return nan


def _meant(cells: Sequence[str], named: Mapping[str, str]) -> dict[str, int]:
    """Place of each quantity among heads: as it is named, else by word, where its unit fits."""
    heads = [plain_head(split_head(cell)[0].replace("_", " ")) for cell in cells]
    units = [split_head(cell)[1] for cell in cells]
    places = {name: list(cells).index(head) for name, head in named.items()}
    for name, (kinds, words) in _QUANTITIES.items():
        if name in places:
            continue
        free = [k for k in range(len(cells)) if k not in places.values()]
        fits = [k for k in free if not units[k] or any(_scaled(units[k], kind) for kind in kinds)]
        place = next((k for word in words for k in fits if heads[k] == word), None)
        if place is not None and not (name in ("load_speed", "reference") and not units[place]):
            places[name] = place
    return places


def _scaled(unit: str, kind: str) -> tuple[float, float] | None:
    try:
        return scale(unit, kind)
    except InputError:
        return (2.0 * np.pi, 0.0) if kind == "rotary_speed" and unit == "Hz" else None


def _factor(name: str, unit: str, head: str, remarks: list[str]) -> tuple[float, float]:
    """Factor and offset to SI; without a unit that of the SI, but degrees Celsius."""
    kinds = _QUANTITIES[name][0]
    for kind in kinds if unit else ():
        if (scale := _scaled(unit, kind)) is not None:
            return scale
    if unit and kind_of_unit(unit) is not None:
        raise InputError(
            f"{head}: {quoted(unit)} is no unit of {kinds[0].replace('_', ' ')}; expected e.g. {KINDS[kinds[0]].si}"
        )
    if name in ("winding", "housing"):
        return 1.0, 273.15
    if name != "duty":
        remarks.append(f"{head} has no unit: {KINDS[kinds[0]].si} is taken")
    return 1.0, 0.0


# -- JSON: SysId, pendulum rigs.

_SYSID = ("slow-forward", "slow-backward", "fast-forward", "fast-backward")
_TURNS = {"Rotations": 2.0 * np.pi, "Radians": 1.0, "Degrees": np.pi / 180.0}
_XL330_FULL = 885.0  # of its duty register


@contextmanager
def in_its_form(path: Path, what: str) -> Iterator[None]:
    """Refuse what does not read as the program wrote it whose file this seems to be."""
    try:
        yield
    except InputError:
        raise
    except (TypeError, ValueError, KeyError, AttributeError, OverflowError) as error:
        raise InputError(f"{path}: {' '.join(str(error).split())[:80]}; expected {what}") from None


def _json(raw: bytes, path: Path) -> Log:
    text = as_text(raw, path)
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: is not JSON ({error})") from None
    with in_its_form(path, "a log in the form of its program"):
        if isinstance(data, dict) and any(name in data for name in _SYSID):
            return _sysid(data, path)
        if isinstance(data, dict) and isinstance(data.get("entries"), list) and "mass" in data:
            return _pendulum(data, path)
        if isinstance(data, list) and data and isinstance(data[0], dict):
            return _table(raw, path, {})
    raise InputError(f"{path}: expected tests slow-forward ... of SysId, or mass, length and entries of a pendulum rig")


def _sysid(data: Mapping[str, Any], path: Path) -> Log:
    """Rows of time, voltage, position and speed of up to four tests; older ones of a drivetrain have two sides."""
    tests = [np.array(data[name], float) for name in _SYSID if data.get(name)]
    tests = [test for test in tests if test.ndim == 2 and len(test) > 1]
    if not tests or {test.shape[1] for test in tests} - {4, 9, 10}:
        raise InputError(f"{path}: expected rows of time, voltage, position, speed in {', '.join(_SYSID)}")
    wide = tests[0].shape[1] > 4
    rows = np.concatenate([test[:, [0, 1, 3, 5]] if wide else test for test in tests])
    unit = str(data.get("units", "Radians"))
    factor = _TURNS.get(unit, 1.0)
    remarks = [] if unit in _TURNS else [f"units {quoted(unit)}: taken as radians"]
    if unit not in _TURNS and (turn := float(data.get("unitsPerRotation", 0.0))):
        factor, remarks = 2.0 * np.pi / turn, [f"{quoted(unit)}: {turn:g} a turn"]
    columns = {"time": rows[:, 0], "voltage": rows[:, 1], "position": factor * rows[:, 2], "speed": factor * rows[:, 3]}
    starts = tuple(np.cumsum([0, *(len(test) for test in tests[:-1])]).tolist())
    return Log(path.name, columns, dict.fromkeys(columns, "SysId"), starts, tuple(remarks))


def _pendulum(data: Mapping[str, Any], path: Path) -> Log:
    """A known mass on an arm: weight by the angle from hanging, inertia; voltage by duty where that is logged."""
    rows = [entry for entry in data["entries"] if isinstance(entry, dict)]

    def column(name: str) -> Array:
        return np.array([float(entry.get(name, nan)) for entry in rows])

    mass, length, arm = (float(data.get(name, 0.0)) for name in ("mass", "length", "arm_mass"))
    if not (0.0 < mass < 1e6 and 0.0 < length < 1e4):
        raise InputError(f"{path}: mass {mass:g}, length {length:g}; expected kg and m above 0")
    angle, supply = column("position"), column("input_volts")
    columns = {"time": column("timestamp"), "position": angle, "speed": column("speed")}
    remarks = ["the load is the rig's: weight and inertia by its mass and length"]
    if str(data.get("motor", "")).startswith("xl"):
        duty = column("load")
        duty = np.where(duty > 32767.0, duty - 65536.0, duty) / _XL330_FULL
        columns["voltage"] = duty * supply
        remarks.append(f"voltage: duty register over {_XL330_FULL:g} times the supply")
    if "current" in rows[0]:
        columns["current"] = column("current") / 1000.0
    if "temp" in rows[0]:
        columns["winding"] = column("temp") + 273.15
    on = np.array([bool(entry.get("torque_enable", True)) for entry in rows])
    weight = (mass + arm / 2.0) * length * _GRAVITY * np.sin(angle)
    starts = (0, *(np.flatnonzero(np.diff(on.astype(int)) != 0) + 1).tolist())
    remarks += ["stretches with the torque off are left out"] * (not on.all())
    inertia = (mass + arm / 3.0) * length**2
    heads = {name: name for name in columns}
    return Log(path.name, columns, heads, starts, tuple(remarks), inertia, weight).rows(on)


# -- Binary data logs.


def _data_log(raw: bytes, path: Path) -> Log:
    """Numeric entries by the ends of their names, at the moments of the voltage; a state splits tests."""
    numeric = entries(raw, path)
    signals: dict[str, tuple[Array, Array]] = {}
    for name, words in {"voltage": ("voltage", "volts"), "speed": ("velocity", "speed"), "position": ("position",),
                        "current": ("current", "amps"), "supply": ("batteryvoltage",)}.items():  # fmt: skip
        for title, series in numeric.items():
            last = title.rsplit("/", 1)[-1].lower().replace("-", "").replace("_", "")
            if (
                len(series[0]) >= _FEWEST
                and name not in signals
                and any(last.startswith(w) or last.endswith(w) for w in words)
            ):
                signals[name] = series
    if "voltage" not in signals or not {"speed", "position"} & set(signals):
        names = ", ".join(list(numeric)[:8]) or "none"
        raise InputError(f"{path}: entries {quoted(names)}; expected voltage, and velocity or position")
    time = np.unique(signals["voltage"][0])
    first = max(series[0][0] for series in signals.values())
    last = min(series[0][-1] for series in signals.values())
    time = time[(time >= first) & (time <= last)]
    if len(time) < _FEWEST:
        raise InputError(f"{path}: {len(time)} moments at which all of {', '.join(signals)} are logged; expected more")
    columns = {"time": time}
    for name, (t, y) in signals.items():
        stepwise = name in ("voltage", "supply")
        order = np.argsort(t, kind="stable")
        t, y = t[order], y[order]
        columns[name] = (
            y[np.clip(np.searchsorted(t, time, "right") - 1, 0, None)] if stepwise else np.interp(time, t, y)
        )
        columns[name] = columns[name] * (2.0 * np.pi if name in ("speed", "position") else 1.0)
    remarks = ("velocity and position are taken in rotations",)
    return Log(path.name, columns, {name: name for name in columns}, (0,), remarks)
