"""Figures of a set: what is drawn is what was computed, or what closed forms say; told apart without colour."""

from dataclasses import replace
from itertools import combinations
from math import nan, sqrt
from xml.etree import ElementTree

import by_hand
import numpy as np
import pytest
from starters import starter
from synthetic_validation import labels

from drivesizer.machine.set_cycle import set_cycle
from drivesizer.machine.supply_power import EnergyFlow
from drivesizer.output.report.figures import choice, cycle, field
from drivesizer.output.report.figures.all_figures import report_drawings
from drivesizer.output.report.figures.picture import barred, scatter
from drivesizer.physics.thermal import resistance_25, resistance_at
from drivesizer.results.check import Check
from drivesizer.results.sizing import SizingResult
from drivesizer.sizing import size

pytestmark = pytest.mark.usefixtures("no_further_searches")


def hot(found):
    """Resistance of the winding at its mean temperature."""
    return float(resistance_at(resistance_25(found.motor), found.winding)[0])


@pytest.fixture(scope="module")
def hoist(tmp_path_factory, catalog) -> SizingResult:
    return size(
        starter("hoist", tmp_path_factory.mktemp("hoist")), catalog=catalog, top=2, pareto=("mass", "price", "energy")
    )


def hatches(axes) -> list[str | None]:
    return [patch.get_hatch() for patch in axes.patches]


# -- margins


def check(title: str, **more) -> Check:
    given = {"name": "x", "method": "physics", "demand": 1.0, "limit": 2.0, "kind": "current", "unit": "A",
             "margin": 1.0, "status": "pass"}  # fmt: skip
    return Check(title=title, **(given | more))


CHECKS = (
    check("half", margin=1.0),
    check("four fifths, a quarter asked for", margin=0.25, needed=0.2),
    check("too much", margin=-0.5, status="fail"),
    check("unknown", margin=nan, limit=nan, status="unknown"),
    check("a condition", margin=nan, demand=nan, limit=nan),
    check("not met", margin=nan, demand=nan, limit=nan, status="fail"),
)


def test_bars_are_the_used_share_of_each_limit_and_status_needs_no_colour(canvas):
    (axes,) = canvas(barred, choice.margins(CHECKS)).axes
    bars = {axes.get_yticklabels()[round(bar.get_y() + bar.get_height() / 2)].get_text(): bar for bar in axes.patches}
    widths = [bars[c.title].get_width() for c in CHECKS]
    assert widths == pytest.approx([50.0, 80.0, 125.0, 125.0, 0.0, 125.0])
    looks = {c.status: bars[c.title].get_hatch() for c in CHECKS}
    assert looks["pass"] is None and len(set(looks.values())) == 3
    (needed,) = [line for line in axes.lines if len(set(line.get_xdata())) == 1 and line.get_xdata()[0] < 99.0]
    assert needed.get_xdata()[0] == pytest.approx(100.0 / 1.2)
    assert {text.get_text() for text in axes.texts} == {"+100 %", "+25 %", "−50 %", "unknown", "pass", "fail"}
    assert "used share of the limit (%)" in labels(barred(choice.margins(CHECKS)))


# -- energy

FLOW = EnergyFlow(drawn=100.0, supply=2.0, controller=3.0, copper=15.0, friction=10.0, gearhead=15.0, belt=5.0,
                  load=30.0, rotor=0.0, returned=20.0, stored=12.0)  # fmt: skip


def test_bars_of_energy_go_down_from_what_is_drawn_to_nothing(canvas):
    (axes,) = canvas(barred, cycle.energy_bars(FLOW)).axes
    whole, *parts = axes.patches
    assert (whole.get_x(), whole.get_width()) == (0.0, 100.0)
    left = 100.0
    for bar, value in zip(parts, (2.0, 3.0, 15.0, 10.0, 15.0, 5.0, 30.0, 12.0, 8.0), strict=True):
        ends = sorted([bar.get_x(), bar.get_x() + bar.get_width()])
        assert ends == pytest.approx([left - value, left])
        left -= value
    assert left == pytest.approx(0.0)
    assert len({*hatches(axes)}) == 3
    said = labels(barred(cycle.energy_bars(FLOW)))
    assert {"energy of a cycle (J)", "2 J, 2 %", "work on the load", "regenerated, kept by the supply"} <= said


# -- efficiency


def test_lines_of_efficiency_lie_where_the_efficiency_is(canvas, result):
    found = set_cycle(result.spec, result.sets[0])
    cases = [("", found)]
    (axes,) = canvas(field.efficiency_map, cases, 18.9).axes
    motor, head = result.sets[0].motor, result.sets[0].gearhead
    R, k, i, e = hot(found), motor.torque_constant, head.ratio, head.efficiency
    dry, per_speed = by_hand.friction(motor)
    seen = 0
    for lines in axes.collections:
        levels = getattr(lines, "levels", ())
        if not len(levels) or lines.get_facecolor().size or levels[0] == 18.9:
            continue
        for level, path in zip(levels, lines.get_paths(), strict=True):
            for torque, rpm in path.vertices[:: max(len(path.vertices) // 7, 1)]:
                speed, power = rpm * np.pi / 30.0, torque * rpm * np.pi / 30.0
                I = ((torque / (i * e) if torque > 0.0 else torque * e / i) + dry + per_speed * i * speed) / k
                electrical = I * (R * I + k * i * speed)
                share = power / electrical if torque > 0.0 else electrical / power
                assert 100.0 * share == pytest.approx(level, abs=1.2), (torque, rpm)
                seen += 1
    assert seen > 30
    assert {"torque at the gearhead's output (N·m)", "speed there (rpm)", "load cycle", "18.9 V, winding warm",
            "drives", "brakes", "60 %"} <= labels(field.efficiency_map(cases, 18.9))  # fmt: skip


def test_the_cycle_stands_in_the_map_with_its_torques_and_speeds(canvas, result):
    """By hand: 1.5 m/s on a wheel of 152.4 mm through a belt of 1.1 : 1, and the beside check's largest torque."""
    best = result.sets[0]
    shown = field.efficiency_field([("", set_cycle(result.spec, best))], 18.9)
    ((_, torque, speed),) = shown.traces
    assert speed.max() == pytest.approx(1.5 / 0.0762 * 1.1)
    told = {c.name: c.demand for c in best.beside}
    assert np.abs(torque).max() == pytest.approx(told["gearhead_intermittent_torque"])
    assert torque.min() < 0.0 and shown.torque[0] < torque.min() and shown.torque[-1] > torque.max()


def test_the_best_of_the_map_is_no_better_than_the_handbook_allows(result):
    """(1 - sqrt(I_0 / I_s))^2 times the gearhead's, at the usable voltage; the map comes near where it reaches."""
    found = set_cycle(result.spec, result.sets[0])
    shown = field.efficiency_field([("", found)], 18.9)
    motor, share = result.sets[0].motor, shown.field.efficiency[:, shown.torque > 0.0]
    limit = (1.0 - sqrt(motor.no_load_current * hot(found) / 18.9)) ** 2
    best = np.nanmax(np.where(shown.field.voltage[:, shown.torque > 0.0] <= 18.9, share, 0.0))
    assert 0.97 * limit < best / result.sets[0].gearhead.efficiency <= limit * (1.0 + 1e-9)


# -- front


@pytest.mark.parametrize("seed", range(2))
def test_names_of_a_front_cover_neither_each_other_nor_a_mark(canvas, seed):
    random = np.random.default_rng(seed)
    x, y = np.sort(random.gamma(1.5, 100.0, 40)), np.sort(random.gamma(1.5, 60.0, 40))[::-1]
    numbers = [str(n) for n in range(1, 41)]
    names = [f"EC-i 40 48{n}669 + GP 32 HP 14:1" for n in range(40)]
    texts = [(f"{number}  {name}"[:34], number) for number, name in zip(numbers, names, strict=True)]
    heads = [("mass", "g"), ("price", "EUR")]
    figure = canvas(scatter, choice.front([*zip(x.tolist(), y.tolist(), strict=True)], texts, heads, numbers))
    axes = figure.axes[0]
    figure.canvas.draw()
    boxes = [text.get_window_extent() for text in axes.texts]
    assert len(boxes) >= 10 and any("+" in text.get_text() for text in axes.texts)
    frame = axes.get_window_extent().padded(1.0)
    for box in boxes:
        assert frame.x0 <= box.x0 and box.x1 <= frame.x1 and frame.y0 <= box.y0 and box.y1 <= frame.y1
    for one, other in combinations(boxes, 2):
        assert not one.padded(-0.6).overlaps(other.padded(-0.6))
    for point in axes.transData.transform(np.column_stack([x, y])):
        assert not any(box.padded(-0.6).contains(*point) for box in boxes)


# -- all of them


def test_every_figure_of_a_set_has_a_name_units_and_the_same_bytes(hoist, result):
    made = report_drawings(hoist, None)
    assert " ".join(made) == "sketch profile cycle front margins field efficiency demand heat energy"
    for name, draw in made.items():
        svg = draw("svg")
        assert ElementTree.fromstring(svg).tag.endswith("svg") and draw("svg") == svg, name
        typeset = draw("typeset")
        assert b"<text" in typeset and (len(typeset) < len(svg) or name == "sketch"), name  # whose texts are letters
    assert made["profile"]("png").startswith(b"\x89PNG")
    best = result.sets[0]
    unknown = replace(best, motor=replace(best.motor, winding_time_constant=nan, motor_time_constant=nan))
    assert "heat" not in report_drawings(replace(result, sets=(unknown,)), None)


def test_figures_that_hang_on_an_unknown_one_are_left_out(result):
    bare = replace(result.sets[0], gearhead=replace(result.sets[0].gearhead, inertia=nan))
    made = report_drawings(replace(result, sets=(bare,)), None)
    assert {"efficiency", "demand", "energy", "heat"}.isdisjoint(made) and {"margins", "field", "cycle"} <= set(made)
