"""Speed profiles: what the load is asked to do over one cycle, as breakpoints with straight lines between.

A profile comes from the spec's motion or from a recorded CSV file. Speeds may be negative (the machine reverses).
Symbols: t time [s], v speed of the load [m/s].
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from drivesizer.errors import InputError, quoted
from drivesizer.motions import Trapezoid
from drivesizer.spec import RobotSpec
from drivesizer.textfile import read_text
from drivesizer.units import KINDS, scale

__all__ = ["Profile", "from_csv", "profile", "profile_of", "trapezoid"]

_COLUMNS = ("time", "speed")  # header of a file; also the kinds of quantity
_EXAMPLE = "0.5,1.2"
_MOST_ROWS = 1_000_000


@dataclass(frozen=True, slots=True)
class Profile:
    """Speed over time, piecewise linear."""

    name: str
    time: tuple[float, ...]  # s, strictly rising
    speed: tuple[float, ...]  # m/s, or rad/s of a load that turns
    acceleration: tuple[float, ...] | None = None  # where it is continuous; else that of each straight piece

    @property
    def duration(self) -> float:
        """From the first breakpoint to the last [s]."""
        return self.time[-1] - self.time[0]

    @property
    def top_speed(self) -> float:
        """Largest speed in either direction [m/s]."""
        return max(abs(v) for v in self.speed)

    @property
    def distance(self) -> float:
        """Way along the profile, there minus back [m]."""
        return sum((t1 - t0) * (v0 + v1) / 2 for t0, t1, v0, v1 in self.pieces())

    def pieces(self) -> Iterator[tuple[float, float, float, float]]:
        """The straight pieces: start and end [s], speeds there [m/s]."""
        return zip(self.time, self.time[1:], self.speed, self.speed[1:], strict=False)


def trapezoid(motion: Trapezoid) -> Profile:
    """The spec's motion: accelerate, cruise, decelerate, rest.

    Parameters
    ----------
    motion
        Speed [m/s] and times [s]; the deceleration takes as long as the acceleration.

    Examples
    --------
    >>> trapezoid(Trapezoid(speed="1.5 m/s", acceleration_time="2 s", cruise_time="3 s", rest_time="1 s")).time
    (0.0, 2.0, 5.0, 7.0, 8.0)
    """
    legs = (
        (motion.acceleration_time, motion.speed),
        (motion.cruise_time, motion.speed),
        (motion.acceleration_time, 0.0),
        (motion.rest_time, 0.0),
    )
    points = [(0.0, 0.0)]
    for duration, speed in legs:
        end = points[-1][0] + duration
        if end > points[-1][0]:  # a leg without length leaves no breakpoint
            points.append((end, speed))
    if points[-1][1] != 0.0:  # the deceleration vanished beside the cruise
        raise InputError(f"motion.acceleration_time: {motion.acceleration_time:g} s is too short beside cruise_time")
    return Profile("trapezoid", tuple(t for t, _ in points), tuple(v for _, v in points))


def profile_of(spec: RobotSpec) -> Profile:
    """The spec's motion as a profile."""
    assert isinstance(spec.motion, Trapezoid)
    return trapezoid(spec.motion)


def profile(spec: RobotSpec, name_or_file: str) -> Profile:
    """The profile that a name or a file stands for.

    Parameters
    ----------
    spec
        The robot, whose motion ``trapezoid`` is.
    name_or_file
        ``trapezoid``, or a file that ends in ``.csv``.

    Raises
    ------
    InputError
        When it is neither, or the file is wrong.
    """
    if name_or_file == "trapezoid":
        return profile_of(spec)
    if name_or_file.lower().endswith(".csv"):
        return from_csv(Path(name_or_file))
    raise InputError(f"profile {quoted(name_or_file)} is not known; expected trapezoid or a file that ends in .csv")


def from_csv(path: str | Path) -> Profile:
    """A recorded profile.

    Parameters
    ----------
    path
        A CSV file in UTF-8: the header ``time,speed``, a row of units such as ``s,m/s``, then the numbers.

    Raises
    ------
    InputError
        One line that says where, what was found and what is expected.
    """
    path = Path(path)
    rows = _rows(path)
    header = next(rows, None)
    found = tuple(cell.strip().lower() for cell in header[1]) if header else ()
    if found != _COLUMNS:
        shown = quoted(",".join(header[1])) if header else "nothing"
        raise InputError(f"{path}:1: header: {shown}; expected {','.join(_COLUMNS)}")
    factors = _factors(path, next(rows, None))
    time: list[float] = []
    speed: list[float] = []
    for line, cells in rows:
        if len(cells) != len(_COLUMNS):
            raise InputError(f"{path}:{line}: row: {_miscount(cells)}; expected a time and a speed, e.g. {_EXAMPLE}")
        values = [
            _number(path, line, *cell) * f for cell, f in zip(zip(_COLUMNS, cells, strict=True), factors, strict=True)
        ]
        if time and not values[0] > time[-1]:
            raise InputError(
                f"{path}:{line}: time: {quoted(cells[0])} is not after the row before; expected rising times"
            )
        if len(time) == _MOST_ROWS:
            raise InputError(f"{path}:{line}: row: more than {_MOST_ROWS} rows; expected a thinned recording")
        time.append(values[0])
        speed.append(values[1])
    if len(time) < 2:
        raise InputError(f"{path}: rows: {len(time)} found; expected at least 2 below the units, e.g. {_EXAMPLE}")
    return Profile(str(path), tuple(time), tuple(speed))


def _rows(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Line number and cells of each row; blank lines at the end are left out."""
    reader = csv.reader(read_text(path).splitlines(), strict=True)
    blank = 0
    try:
        for cells in reader:
            if not cells:
                blank = blank or reader.line_num
                continue
            if blank:
                raise InputError(f"{path}:{blank}: row: a blank line; expected rows without gaps, e.g. {_EXAMPLE}")
            yield reader.line_num, cells
    except csv.Error as error:
        raise InputError(f"{path}:{reader.line_num}: row: {error}; expected e.g. {_EXAMPLE}") from None


def _factors(path: Path, row: tuple[int, list[str]] | None) -> list[float]:
    """What brings the columns to SI, from the row of units."""
    example = ",".join(KINDS[kind].si for kind in _COLUMNS)
    line, cells = row or (2, [])
    if len(cells) != len(_COLUMNS):
        raise InputError(f"{path}:{line}: units: {quoted(','.join(cells))}; expected a unit per column, e.g. {example}")
    factors = []
    for kind, cell in zip(_COLUMNS, cells, strict=True):
        try:
            factors.append(scale(cell.strip(), kind)[0])
        except InputError as error:
            raise InputError(
                f"{path}:{line}: {kind}: {error}; the second row holds the units, e.g. {example}"
            ) from None
    return factors


def _number(path: Path, line: int, column: str, cell: str) -> float:
    try:
        value = float(cell) if cell.isascii() and "_" not in cell else math.nan
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{path}:{line}: {column}: {quoted(cell)} is not a finite number; expected e.g. 1.25")
    return value


def _miscount(cells: list[str]) -> str:
    text = quoted(",".join(cells))
    if len(cells) > len(_COLUMNS) or (len(cells) == 1 and ";" in cells[0]):
        return f"{text} has {len(cells)} columns; a decimal comma or a semicolon does not separate numbers here"
    return f"{text} has {len(cells)} of {len(_COLUMNS)} columns"
