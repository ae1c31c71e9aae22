"""The figure of all drives to choose from: what it shows is theirs, and diamonds are the front, by all pairs."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from drivesizer.output.report.html.candidate_plots import choices_plot
from drivesizer.output.report.html.plots import movable
from drivesizer.results.sizing import Choice


def drives(count: int, seed: int) -> list[Choice]:
    rng = np.random.default_rng(seed)
    parts: Any = SimpleNamespace(label="<b>motor</b> + gearhead", currency="EUR")
    made = []
    for _ in range(count):
        mass, price, energy = rng.integers(1, 6, 3).tolist()
        figures = {"mass": 0.1 * mass, "price": 100.0 * price, "energy": float(energy), "margin": 0.2}
        made.append(Choice(parts=parts, figures=figures))
    return made


def test_the_front_is_that_of_all_pairs() -> None:
    for seed in range(20):
        found = drives(40, seed)
        rows = np.array([[one.figures[name] for name in ("mass", "price", "energy")] for one in found])
        beaten = [any((other <= row).all() and (other < row).any() for other in rows) for row in rows]
        picture = choices_plot(SimpleNamespace(drives=tuple(found)))  # type: ignore[arg-type]
        assert picture is not None
        assert picture.trace["marker"]["symbol"] == ["circle" if one else "diamond" for one in beaten]


def test_drives_without_a_price_are_left_out_and_names_are_shown_letter_by_letter() -> None:
    found = drives(5, 2)
    found[3].figures["price"] = float("nan")
    picture = choices_plot(SimpleNamespace(drives=tuple(found)))  # type: ignore[arg-type]
    assert picture is not None
    (trace,) = movable(picture)["data"]
    assert len(trace["x"]) == 4 and all("&lt;b&gt;" in said[1] for said in trace["customdata"])
    assert np.allclose(trace["x"], [1e3 * one.figures["mass"] for n, one in enumerate(found) if n != 3])
    assert choices_plot(None) is None
    assert choices_plot(SimpleNamespace(drives=tuple(found[3:4]))) is None  # type: ignore[arg-type]
