"""WPILib's binary data log, version 1.0: numeric entries over time.

After a header ``WPILOG``, version and a text, records follow one another: a byte says how many bytes entry, size and
time [us] have; entry 0 starts and ends others. All numbers have their least byte first. A record that reaches beyond
the file is the end of a log that was cut off.
"""

from __future__ import annotations

import struct
from collections import defaultdict
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from drivesizer.errors import InputError

Array = NDArray[np.float64]

SIGNATURE = b"WPILOG"
_MOST_ENTRIES = 10_000
_MOST_RECORDS = 5_000_000
_NUMBERS = {"double": "<d", "float": "<f", "int64": "<q", "boolean": "<?"}


def entries(raw: bytes, path: Path) -> dict[str, tuple[Array, Array]]:
    """Times [s] and values of each numeric entry by its name.

    Parameters
    ----------
    raw
        The file's bytes.
    path
        Its name, for messages.

    Returns
    -------
    dict
        Entries with two values or more, times as they were written.

    Raises
    ------
    InputError
        When the file is none of version 1.0, or has more entries than a robot.
    """
    if len(raw) < 12 or raw[6:8] != b"\x00\x01":
        raise InputError(f"{path}: is no data log of version 1.0")
    at = 12 + int.from_bytes(raw[8:12], "little")
    names: dict[int, tuple[str, str]] = {}
    found: dict[str, tuple[list[float], list[float]]] = defaultdict(lambda: ([], []))
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
                times, values = found[name]
                times.append(moment / 1e6)
                values.append(float(struct.unpack(_NUMBERS[form], raw[start:at])[0]))
    return {name: (np.array(t), np.array(y)) for name, (t, y) in found.items() if len(t) > 1}


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
