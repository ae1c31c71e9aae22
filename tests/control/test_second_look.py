"""Loops analysed by this program and by python-control: they agree, and a figure that does not is seen."""

from __future__ import annotations

from dataclasses import replace

import pytest
from linear_machines import machine, servo, shafts
from textbook_machine import on_slope

from drivesizer.control.loop_analysis import analyse
from drivesizer.control.second_look import AGREED, compared


@shafts
def test_every_loop_of_a_cascade_agrees(spec, catalog, shaft):
    _, train = on_slope(spec, catalog, 3.0)
    cascade, train = servo(train, shaft), machine(train, shaft)
    loops = analyse(train, cascade).all
    rows = compared(train, cascade, loops)
    assert {row.loop.name for row in rows} == {loop.name for loop in loops} and len(loops) >= 2
    assert all(row.agrees for row in rows), [row for row in rows if not row.agrees]


def test_a_figure_that_differs_is_seen(spec, catalog):
    _, train = on_slope(spec, catalog, 3.0)
    cascade = servo(train, False)
    off = tuple(
        replace(loop, phase_margin=loop.phase_margin * (1.0 + 10.0 * AGREED)) for loop in analyse(train, cascade).all
    )
    differ = [row.figure for row in compared(train, cascade, off) if not row.agrees]
    assert differ == ["phase_margin"] * len(off)


@pytest.mark.parametrize("more", [["--json"], ["--all"]])
def test_it_is_of_one_drive_at_the_terminal(run, example, more):
    status, out, err = run("validate", str(example), "--second-look", *more)
    assert (status, out, err.count("\n")) == (2, "", 1) and "--second-look" in err
