"""A set at the bench, at the terminal."""

from __future__ import annotations

from drivesizer.output.document.bench import prediction_blocks
from drivesizer.output.terminal import render
from drivesizer.output.terminal.tables import console, heading
from drivesizer.results.prediction import Prediction

__all__ = ["predicted"]


def predicted(found: Prediction) -> None:
    """Print a prediction."""
    out = console()
    heading(out, found.label, "")
    render.blocks(out, prediction_blocks(found))
