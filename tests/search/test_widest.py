"""The drive of the largest smallest margin, found with few waveforms."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from drivesizer.search import in_order


def evaluation(margins, rows, computed):
    """Two checks of some drives: one by the waveform, one not."""
    computed += list(rows)
    checks = [
        SimpleNamespace(name=name, tightness=np.array([margins[name][row] for row in rows]))
        for name in ("supply_voltage", "gearhead_peak_torque")
    ]
    return SimpleNamespace(checks=checks)


@pytest.mark.parametrize("seed", range(20))
def test_it_is_that_of_all_waveforms_and_few_are_computed(seed):
    rng, count = np.random.default_rng(seed), 24
    names = ("supply_voltage", "gearhead_peak_torque")
    margins = {name: np.round(rng.uniform(-0.2, 0.8, count), 1 if seed % 2 else 6) for name in names}
    margins["supply_voltage"] += 0.4  # the waveform decides of some
    alike, computed, bounds = rng.permutation(count), [], []
    found = in_order._widest(
        alike, lambda rows: evaluation(margins, rows, computed), lambda rows: evaluation(margins, rows, bounds)
    )
    every = np.minimum(*margins.values())[alike]
    assert np.argsort(-found, kind="stable")[0] == np.argsort(-every, kind="stable")[0]
    assert found.max() == pytest.approx(every.max())
    assert len(computed) < count / 2
