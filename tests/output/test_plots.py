"""Plots of reports and pages: curves of one part, all drives to choose from, stretches of a record."""

from __future__ import annotations

import json
from math import pi, sqrt
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from drivesizer.catalog import load
from drivesizer.catalog.query import PartRow, all_parts, find, open_catalogs
from drivesizer.machine.part_curves import gear_efficiency, line, nominal_voltage_curves
from drivesizer.output.report.figures import parts
from drivesizer.output.report.figures.picture import on_paper
from drivesizer.output.report.figures.style import Window, across, strip, within
from drivesizer.output.report.html.candidate_plots import choices_plot
from drivesizer.output.report.html.plots import movable
from drivesizer.results.sizing import Choice

# -- one part


V, R, K, I_0 = 24.0, 2.0, 0.024, 0.05
IDEAL = {"kind": "brushed", "nominal_voltage": f"{V} V", "resistance": f"{R} ohm", "torque_constant": f"{K} N*m/A",
         "no_load_current": f"{I_0} A"}  # fmt: skip


def own(tmp_path: Path, section: str, **figures: str) -> PartRow:
    rows = ", ".join(f"{name}: {text}" for name, text in figures.items())
    (tmp_path / "own.yaml").write_text(
        "catalog: 1\nmanufacturer: Anymaker\nsources:\n  sheet: {document: a sheet, confidence: quoted}\n"
        f"{section}:\n- family: F 1\n  source: sheet\n  common: {{{rows}}}\n  columns: [part]\n  rows: [[P1]]\n"
    )
    return find(open_catalogs([str(tmp_path / "own.yaml")]), "P1")[0]


def part_plots(hit: PartRow) -> dict[str, Any]:
    """Curves of a part as the page has them; paper can draw each, with plain figures at its axes."""
    plots = parts.part_plots(hit)
    assert not [name for name, plot in plots.items() if b"math" in on_paper(plot)("typeset")]
    return {name: movable(plot) for name, plot in plots.items()}


def trace(plot: Any, begins: str) -> tuple[Any, Any]:
    """The points of a line by the start of its name."""
    (one,) = [one for one in plot["data"] if one["name"].startswith(begins)]
    return np.array(one["x"], float), np.array(one["y"], float)


# -- motors


def test_the_best_efficiency_is_that_of_the_two_currents(tmp_path):
    """eta = (1 - sqrt(I_0/I_A))^2 at M = k_t (sqrt(I_0 I_A) - I_0), of any motor with constant R and k."""
    hit, stall = own(tmp_path, "motors", **IDEAL), V / R
    best = K * (sqrt(I_0 * stall) - I_0)
    speed, current, efficiency = nominal_voltage_curves(hit, np.array([0.0, best, line(hit).torque]))
    assert efficiency[1] == pytest.approx((1.0 - sqrt(I_0 / stall)) ** 2)
    assert current == pytest.approx([I_0, sqrt(I_0 * stall), stall])
    assert speed[[0, 2]] == pytest.approx([(V - R * I_0) / K, 0.0]) and efficiency[[0, 2]] == pytest.approx([0.0, 0.0])
    assert (
        nominal_voltage_curves(hit, np.array([best * 1.1]))[2]
        < efficiency[1]
        > nominal_voltage_curves(hit, best * 0.9)[2]
    )


def test_the_best_efficiency_is_the_printed_one():
    """maxon prints it in whole percents, of figures of three digits: 646 windings."""
    off = []
    for hit in all_parts({"maxon": load(["maxon"])}, ["motors"]):
        found = nominal_voltage_curves(hit, np.linspace(0.0, line(hit).torque, 400))[2] - hit["max_efficiency"]
        off += [np.nanmax(found)] if not np.isnan(found).all() else []
    assert len(off) > 600
    assert abs(np.median(off)) < 0.005 and np.quantile(np.abs(off), 0.95) < 0.015


def test_what_is_unknown_or_contradicts_itself_is_not_drawn(tmp_path):
    assert part_plots(own(tmp_path, "motors", kind="brushed")) == {}
    figures = IDEAL | {"no_load_speed": "9500 rpm", "stall_torque": "288 mN*m"}
    assert "efficiency (%)" in json.dumps(part_plots(own(tmp_path, "motors", **figures)))
    more = part_plots(own(tmp_path, "motors", **figures | {"torque_constant": "0.2 N*m/A"}))["speed-torque"]
    assert "efficiency (%)" not in json.dumps(more) and more["title"].startswith("Speed, current over")
    inside = part_plots(own(tmp_path, "motors", **figures, commutation="integrated electronics"))["speed-torque"]
    assert inside["title"] == "Speed over torque at nominal voltage"  # the printed line is its controller's
    alone = part_plots(own(tmp_path, "motors", **{**figures, "no_load_current": "~"}))["speed-torque"]
    assert "current (A)" not in json.dumps(alone)


# -- gearheads


def test_a_gearhead_has_its_printed_efficiency_at_its_rated_torque():
    """Wittenstein NPT 045, 25:1: 95 % at full load, 0.39 N*m to turn it without load."""
    (hit,) = find(open_catalogs(["wittenstein"]), "NPT 045 MF/MA 25:1")
    rated, idle, ratio = 350.0, 0.39, 25.0
    found = gear_efficiency(hit, np.array([1e-6, rated / 2, rated]))
    assert found[2] == pytest.approx(0.95) and found[0] < 1e-6
    lost = rated / ratio / 0.95 - rated / ratio - idle  # of torque at the input beside the idle one, at rated load
    half = rated / 2 / ratio
    assert found[1] == pytest.approx(half / (half + lost / 2 + idle))
    assert part_plots(hit)["efficiency"]["data"][0]["y"][-1] > 95.0  # at the intermittent torque


# -- steppers and batteries


def test_a_printed_pull_out_curve_is_drawn_as_it_is():
    catalog = load(["stepperonline"])
    printed = catalog.pull_outs
    hit = PartRow("stepperonline", catalog, "steppers", int(printed.stepper[0]))
    own = printed.on((printed.stepper == printed.stepper[0]) & (printed.curve == printed.curve[0]))
    plot = part_plots(hit)["pull-out"]
    assert plot["title"].startswith("Pull-out torque as printed")
    assert plot["data"][0]["x"] == pytest.approx((own.speed * 30 / pi).tolist(), rel=1e-5)
    assert len({len(own.torque), len(plot["data"][0]["y"])}) == 1


def test_an_estimated_one_has_its_band_and_never_more_than_the_model():
    hit = next(all_parts(open_catalogs(["oukeda"]), ["steppers"]))
    plot = part_plots(hit)["pull-out"]
    assert "estimated" in plot["title"]
    _, torque = trace(plot, "24 V supply")
    _, band = trace(plot, "5 to 95 % at 24 V")
    low, high = band[: len(torque)], band[len(torque) :][::-1]
    assert low == pytest.approx(torque / 1.5, rel=1e-4) and (high >= torque).all()
    assert high.max() == pytest.approx(hit["holding_torque"] * 1e3, rel=1e-4)


def test_run_times_are_the_printed_ones_else_those_of_the_rule():
    (hit,) = find(open_catalogs(["yuasa"]), "NP4-12")  # as Yuasa prints it: 0.2 A for 20 h ... 3.75 A for half an hour
    assert trace(part_plots(hit)["discharge-current"], "down to 10.2 V")[0][[0, -1]].tolist() == [0.2, 3.75]
    (cell,) = find(open_catalogs(["samsung"]), "Samsung 25R")  # 2.5 A*h at any current
    current, time = trace(part_plots(cell)["discharge"], "rated charge")
    assert current * time == pytest.approx(np.full(len(current), 2.5), rel=1e-4) and current[-1] == 20.0


# -- all drives to choose from


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


# -- stretches of a record


TWO = (Window("first", 0.0, 2.5), Window("last", 241.5, 244.0))


def test_two_stretches_stand_beside_each_other_with_a_gap():
    shown = strip(TWO)
    assert shown.starts[1] == pytest.approx(2.5 + 0.035 * 5.0) and shown.end == pytest.approx(shown.starts[1] + 2.5)
    assert shown.place(1, np.array([241.5, 244.0])).tolist() == pytest.approx([shown.starts[1], shown.end])


def test_a_stretch_begins_and_ends_on_the_line_between_its_samples():
    time, values = np.array([0.0, 1.0, 3.0, 240.0, 250.0]), np.array([0.0, 4.0, 0.0, 0.0, 10.0])
    t, v = within(time, values, Window("", 0.0, 2.5))
    assert t.tolist() == [0.0, 1.0, 2.5] and v.tolist() == pytest.approx([0.0, 4.0, 1.0])
    t, v = within(time, values, Window("", 241.5, 244.0))
    assert t.tolist() == [241.5, 244.0] and v.tolist() == pytest.approx([1.5, 4.0])


def test_a_jump_stays_a_jump_and_one_at_the_edge_belongs_to_what_follows():
    time, values = np.array([0.0, 2.0, 2.0, 5.0]), np.array([3.0, 3.0, 1.0, 1.0])
    t, v = within(time, values, Window("", 0.0, 3.0))
    assert t.tolist() == [0.0, 2.0, 2.0, 3.0] and v.tolist() == [3.0, 3.0, 1.0, 1.0]
    t, v = within(time, values, Window("", 0.0, 2.0))
    assert t.tolist() == [0.0, 2.0] and v.tolist() == [3.0, 3.0]


def test_ticks_stand_where_their_times_are():
    axes, shown = Figure().subplots(), strip(TWO)
    across(axes, shown, titled=True)
    told = {text.get_text(): place for place, text in zip(axes.get_xticks(), axes.get_xticklabels(), strict=True)}
    assert told["242"] == pytest.approx(shown.starts[1] + 0.5) and told["1"] == pytest.approx(1.0)
    assert not any(2.5 < place < shown.starts[1] for place in told.values())
    assert {text.get_text() for text in axes.texts} == {"first", "last"}
    assert axes.get_xlim() == (0.0, shown.end)
    (gap,) = axes.patches
    assert (gap.get_x(), gap.get_width()) == pytest.approx((2.5, shown.starts[1] - 2.5))
