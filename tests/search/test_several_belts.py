"""Belts that are looked at together, against each of them looked at alone: not a figure may differ."""

import numpy as np
from starters import starter

from drivesizer.machine.problem import problem
from drivesizer.search.columns.candidates import pairs
from drivesizer.search.columns.stages import examine

BELTS = (1.0, 1.37, 2.2)


def test_belts_together_are_what_each_is_alone(tmp_path, catalog):
    given = problem(starter("hoist", tmp_path), catalog)
    every = pairs(given)
    for staged, exact, sets in ((True, False, every), (False, True, every.on(slice(0, len(every.motor), 4001)))):
        together = list(examine(given, [(belt, sets) for belt in BELTS], staged=staged, exact=exact))
        alone = [one for belt in BELTS for one in examine(given, [(belt, sets)], staged=staged, exact=exact)]
        assert sum(len(one.rows) for one in alone) > len(BELTS)
        for one, other in zip(together, alone, strict=True):
            assert one.failed_by == other.failed_by
            for name in ("rows", "unknown", "margin", "encoder", "controller", "rejected", "bound"):
                np.testing.assert_array_equal(getattr(one, name), getattr(other, name), name)
            for name, column in one.figures.items():
                np.testing.assert_array_equal(column, other.figures[name], name)
            for check, same in zip(one.checks, other.checks, strict=True):
                for name in ("name", "demand", "limit", "passed", "failed", "time"):
                    np.testing.assert_array_equal(getattr(check, name), getattr(same, name), check.name)
