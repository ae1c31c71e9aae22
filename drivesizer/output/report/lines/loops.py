"""Gains and loops of a controller as the report's tables print them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from drivesizer.control.loop_records import Loop
from drivesizer.output.gain_table import GainRow
from drivesizer.output.loop_table import cell, loop_figures, loop_name
from drivesizer.units import label, show

__all__ = ["gain", "linear"]


def gain(row: GainRow) -> str:
    """A gain in SI; a period in ms."""
    return show(row.value, "ms", "time") if row.unit == "s" else f"{row.value:.4g} {label(row.unit)}"


def linear(loops: Sequence[Loop]) -> dict[str, Any]:
    """What linear theory says of the loops, as a table with a row each."""
    found = [loop_figures(loop) for loop in loops]
    return {
        "heads": [figure.title for figure in found[0]] if found else [],
        "rows": [
            {"name": loop_name(loop), "stable": loop.stable, "cells": [cell(figure) for figure in row]}
            for loop, row in zip(loops, found, strict=True)
        ],
        "directed": any(loop.direction for loop in loops),
        "unstable": any(not loop.stable for loop in loops),
    }
