"""A check that is open among many points, and decided among few, has no value at which it turns."""

import numpy as np
import pytest

from drivesizer.search import open_checks


@pytest.mark.parametrize("finer", [True, False])
def test_a_check_that_turns_among_the_coarse_steps_alone_is_left_out(finer, monkeypatch):
    def along(problem, one, figures, steps, names):
        coarse = len(steps[0]) == 13
        return {"bus_voltage": [np.arange(13) < 10 if coarse else np.full(len(steps[0]), finer)]}

    monkeypatch.setattr(open_checks, "_rows_of", lambda one: (0, 0, -1))
    monkeypatch.setattr(open_checks, "estimated_figures", lambda *rows: [("motors", "mass")])
    monkeypatch.setattr(open_checks, "_along", along)
    assert open_checks.turns(None, None, {"bus_voltage"}) == {}
