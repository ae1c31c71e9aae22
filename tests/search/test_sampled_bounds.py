"""Bounds over samples: between them are the figures, and what they say of checks is what the figures say."""

from __future__ import annotations

import numpy as np
import pytest
from starters import STARTERS

from drivesizer.catalog import Catalog
from drivesizer.machine.problem import problem
from drivesizer.search.search import search
from drivesizer.search.uncertainty import run as looked_at
from drivesizer.search.uncertainty.options import Sampling
from drivesizer.search.uncertainty.prepare import Prepared
from drivesizer.search.uncertainty.probabilities import Subject, blocks_of
from drivesizer.search.uncertainty.run import MostFirst, sample_drives, subject
from drivesizer.search.uncertainty.sampled_checks import loaded, moving_checks
from drivesizer.search.uncertainty.sampled_parts import parts_of
from drivesizer.search.uncertainty.sampled_waveform import sampled_bounds
from drivesizer.sizing import load_parts
from drivesizer.spec.robot import load_spec

pytestmark = pytest.mark.usefixtures("no_further_searches")

KINDS = "arm", "ball_screw", "hoist", "wheeled_vehicle"
Sampled = tuple[Prepared, Catalog, list[Subject]]


@pytest.fixture(scope="module", params=KINDS)
def sampled(request: pytest.FixtureRequest) -> Sampled:
    """The best drives of a starter and some that are rejected, over a few samples."""
    spec = load_spec(STARTERS / f"{request.param}.yaml")
    catalog = load_parts(spec)
    given = problem(spec, catalog)
    found = search(given, top=6, objective="mass", misses=3).evaluation
    some = [subject(found, row) for row in range(len(found.candidates.motor))]
    ready = sample_drives(given, dict(enumerate(some)), Sampling(128, 1, None), brief=True).ready
    return ready, catalog, some


def test_figures_are_between_their_bounds(sampled: Sampled) -> None:
    """A law; of windings that pass."""
    ready, catalog, some = sampled
    (block,) = blocks_of(ready, catalog, some)
    for one in some:
        parts, factors = parts_of(catalog, one.rows, block)
        for case in moving_checks(catalog, one.rows, block):
            both = sampled_bounds(case.spec, case.at, case.required, case.warmth, case.peaks, case.parts)
            assert both is not None
            low, high = both
            (least, most) = loaded(case.spec, case.at, parts, factors, energies=True).over_time
            passes = most.winding <= case.parts.motor["max_winding_temperature"]
            for name in ("winding", "voltage", "power", "above", "stored"):
                assert not (getattr(low.found, name) > getattr(least, name)).any(), name
                assert not (passes & (getattr(high.found, name) < getattr(most, name))).any(), name
            taken = np.asarray(case.spec.supply.regeneration) * least.returned
            drawn = (least.drawn - taken) * case.spec.load.alike
            assert not (low.draw.drawn > drawn).any() and not (passes & (high.draw.drawn < drawn)).any()
            assert (~passes | (low.draw.drawn < high.draw.drawn)).all()


def test_what_bounds_say_of_samples_is_what_the_figures_say(sampled: Sampled) -> None:
    ready, catalog, some = sampled
    (block,) = blocks_of(ready, catalog, some)
    failed, shares = looked_at.failing(ready, catalog, some), []
    for one, fails, found in zip(some, failed, looked_at.passing(ready, catalog, some), strict=True):
        certainly, opened = looked_at._known(catalog, one, block)
        np.testing.assert_array_equal(certainly[~opened], fails[~opened])
        passes = int(np.count_nonzero(~fails))
        assert found.least <= passes <= found.most
        assert looked_at.counted(ready, catalog, one, found) == passes
        shares.append(opened.mean())
    assert np.mean(shares) < 0.4  # else they would be of no use


def test_by_two_processes_the_same_is_known(sampled: Sampled) -> None:
    ready, catalog, some = sampled
    if ready.spec.load.kind == "hoist":
        one, two = (looked_at.passing(ready, catalog, some, n) for n in (1, 2))
        assert repr(one) == repr(two)


@pytest.mark.parametrize("confidence", [0.2, 0.6, 0.9, 1.0])
def test_drives_are_divided_as_by_their_counts(sampled: Sampled, confidence: float) -> None:
    ready, catalog, some = sampled
    subjects = dict(enumerate(some))
    found = sample_drives(ready.problem, subjects, Sampling(128, 1, confidence), brief=True)
    share = {row: 1.0 - fails.mean() for row, fails in enumerate(looked_at.failing(found.ready, catalog, some))}
    assert found.good == [row for row in subjects if share[row] >= confidence]
    assert [*found.bad] == sorted((row for row in subjects if row not in found.good), key=lambda row: -share[row])


def test_those_that_pass_most_come_first_and_only_as_many_are_counted_as_that_takes() -> None:
    counts, asked = {3: 10, 5: 40, 7: 40, 8: 25, 9: 1}, list[int]()

    def count(row: int) -> int:
        asked.append(row)
        return counts[row]

    first = MostFirst({3: 12, 5: 50, 7: 45, 8: 30, 9: 20}, count)
    assert len(first) == 5 and not asked
    assert first[0] == 5 and first[:2] == [5, 7] and sorted(asked) == [5, 7]
    assert first[-1] == 9 and [*first] == [5, 7, 8, 3, 9] and sorted(asked) == [3, 5, 7, 8, 9]
    assert first[3:1:-1] == [3, 8] and first[7:] == []
    with pytest.raises(IndexError):
        first[5]
    assert [*MostFirst({}, count)] == []
