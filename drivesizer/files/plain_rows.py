"""Rows of plain numbers as bytes: a sign, digits, a point, a power of ten, commas between; nothing else.

Digits make a whole number below 2^53, and powers of ten up to 10^22 are numbers of the processor: so product and
quotient of both are rounded once, to what ``float`` makes of the text.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__: list[str] = []  # compiled into ``csv_numbers``

Array = NDArray[np.float64]
Text = NDArray[np.int8]

PLUS, COMMA, MINUS, POINT, ZERO, NINE, UPPER_E, LOWER_E = 43, 44, 45, 46, 48, 57, 69, 101
SPACE, END, RETURN = 32, 10, 13
LARGEST = 1 << 53
TENS = 22  # power of ten up to which it is exact


def digits(text: Text, place: int, whole: int) -> tuple[int, int]:
    """Digits from a place on: the whole number that they continue, and the place behind them."""
    while place < len(text) and ZERO <= text[place] <= NINE and whole < LARGEST:
        whole = 10 * whole + (text[place] - ZERO)
        place += 1
    return whole, place


def exponent(text: Text, place: int) -> tuple[int, int]:
    """The power of ten behind a number, if any, and the place behind that; a place of -1 where it is none."""
    if place >= len(text) or (text[place] != LOWER_E and text[place] != UPPER_E):
        return 0, place
    place += 1
    negative = place < len(text) and text[place] == MINUS
    if negative or (place < len(text) and text[place] == PLUS):
        place += 1
    found, end = digits(text, place, 0)
    return (-found if negative else found), (end if end > place else -1)


def number(text: Text, place: int, tens: Array) -> tuple[float, int]:
    """The number at a place, and the place behind it; -1 where it is none that is plain."""
    negative = text[place] == MINUS
    if negative or text[place] == PLUS:
        place += 1
    whole, end = digits(text, place, 0)
    count, power = end - place, 0
    if end < len(text) and text[end] == POINT:
        whole, last = digits(text, end + 1, whole)
        power = end + 1 - last
        count, end = count - power, last
    more, end = exponent(text, end)
    power += more
    if count == 0 or end < 0 or whole >= LARGEST or abs(power) > TENS:
        return 0.0, -1
    value = whole / tens[-power] if power < 0 else whole * tens[power]
    return (-value if negative else value), end


def behind_spaces(text: Text, place: int) -> int:
    """The place behind spaces."""
    while place < len(text) and text[place] == SPACE:
        place += 1
    return place


def behind_row(text: Text, place: int) -> int:
    """The place behind the end of a row; -1 where it does not end there."""
    if place < len(text) and text[place] == RETURN:
        place += 1
    if place == len(text):
        return place
    return place + 1 if text[place] == END else -1


def read_rows(text: Text, tens: Array, values: Array) -> int:
    """Rows of a text as columns; their number, -1 where anything is not plain."""
    place, row, last = 0, 0, len(values) - 1
    while place < len(text):
        for column in range(last + 1):
            place = behind_spaces(text, place)
            if place >= len(text) or row >= values.shape[1]:
                return -1
            values[column, row], place = number(text, place, tens)
            if place < 0:
                return -1
            place = behind_spaces(text, place)
            if column < last:
                if place >= len(text) or text[place] != COMMA:
                    return -1
                place += 1
        place = behind_row(text, place)
        if place < 0:
            return -1
        row += 1
    return row
