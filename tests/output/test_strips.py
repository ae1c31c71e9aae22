"""Stretches of a record beside each other: nothing moves, nothing is lost, the ticks tell the true times."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from drivesizer.output.report.figures.style import Window, across, strip, within

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
