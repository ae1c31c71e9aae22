"""The chart of braille dots: known dots, ticks, labels, and that every line fits."""

from __future__ import annotations

import pytest

from drivesizer.output.terminal.tables import Axis, Series, chart, dots, ticks

X, Y = Axis("torque", "mN·m", 7.0), Axis("speed", "rpm", 11.0)
WIDTH = 4 + 8  # margin "10 ", the axis and the narrowest field: 16 x 12 dots on 8 x 3 cells


def plain(*series: Series, x: Axis = X, y: Axis = Y, width: int = WIDTH, height: int = 3) -> list[str]:
    return [line.plain.rstrip() for line in chart(series, x, y, width, height)]


def field(*series: Series, x: Axis = X, y: Axis = Y) -> list[str]:
    """The cells beside the upright axis, from the top."""
    return [line[4:] for line in plain(*series, x=x, y=y)[1:4]]


def test_known_dots_of_a_cell():
    end = Axis("", "", 15.0)  # a dot each
    corner = Series("", [0, 1, 1, 0, 0], [0, 0, 3, 3, 0])
    upright, level = Series("", [0, 0], [0, 11]), Series("", [0, 15], [11, 11])
    assert field(corner, x=end) == ["", "", "⣿"]
    assert field(upright, x=end) == ["⡇", "⡇", "⡇"]
    assert field(level, x=end) == ["⠉" * 8, "", ""]
    assert field(upright, level, x=end) == ["⡏" + "⠉" * 7, "⡇", "⡇"]


def test_what_lies_outside_is_cut_off_where_the_axes_end():
    size, reach = (16, 16), (15.0, 15.0)
    assert dots(Series("", [-5, 1e9], [3, 3]), reach, size) == [(n, 3) for n in range(16)]
    assert dots(Series("", [0, 30], [0, 30]), reach, size) == [(n, n) for n in range(16)]
    assert dots(Series("", [0, 15], [16, 16]), reach, size) == []
    assert dots(Series("", [20, 40], [0, 15]), reach, size) == []
    assert dots(Series("", [-9, 3], [3, -9]), reach, size) == []


@pytest.mark.parametrize(
    "end", [n * 10.0**power for n in (1, 1.01, 1.99, 2, 4.99, 5, 7.3, 9.99) for power in (-6, 0, 9)]
)
def test_ticks_are_round_even_and_within_the_axis(end):
    for count in (1, 3, 5, 10):
        found = ticks(end, count)
        assert 2 <= len(found) <= max(count, 3) + 1
        assert found[0] == 0.0
        assert found[-1] <= end * (1 + 1e-9) < found[-1] + found[1] * (1 + 1e-6)
        assert f"{found[1]:e}"[0] in "125"


def test_ticks_stand_where_the_figures_are():
    lines = plain(x=Axis("torque", "mN·m", 100.0), y=Axis("speed", "rpm", 8000.0), width=60, height=9)
    assert lines[0] == "speed [rpm]"
    marked = {line.split()[0]: n for n, line in enumerate(lines[1:10]) if "┤" in line}
    assert marked == {"8000": 0, "6000": 2, "4000": 4, "2000": 6, "0": 8}
    axis, figures = lines[10], lines[11]
    assert axis.index("└") == lines[1].index("┤")
    assert [n - 6 for n, c in enumerate(axis) if c == "┬"] == [0, 27, 53]  # 54 cells: 0, 50 and 100
    assert figures.split() == ["0", "50", "100"]
    assert figures.index("50") in (32, 33)
    assert lines[12].endswith("torque [mN·m]")
    assert len(lines[12]) == 60


@pytest.mark.parametrize("width", [24, 40, 80, 140])
@pytest.mark.parametrize("end", [0.001, 7.0, 123456.0])
def test_no_line_is_wider_than_asked_for(width, end):
    long = Series("a name that says much about what is drawn here, and then more, and more", [0, end], [0, end])
    lines = plain(long, x=Axis("torque", "N·m", end), y=Axis("speed", "rpm", end), width=width, height=12)
    assert max(map(len, lines)) <= width
    assert " ".join(" ".join(lines[16:]).split()) == f"⠒⠒ {long.name}"
