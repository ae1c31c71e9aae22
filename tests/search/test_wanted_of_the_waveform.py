"""An objective of the waveform has as much of it computed of every drive as it needs, and no energy for heat."""

from pathlib import Path

import pytest

import drivesizer
from drivesizer.kernel.evaluate import ENERGY
from drivesizer.machine.problem import problem
from drivesizer.search import ranking
from drivesizer.search.columns import limits_over_time
from drivesizer.search.columns.evaluation import figures_by_physics
from drivesizer.sizing import load_parts
from drivesizer.spec.robot import load_spec

ARM = Path(drivesizer.__file__).parent / "spec" / "starters" / "arm.yaml"


@pytest.fixture(scope="module")
def given():
    """All energy is taken back: no limit needs it."""
    spec = load_spec(ARM)
    spec = spec.model_copy(update={"supply": spec.supply.model_copy(update={"regeneration": 1.0})})
    return problem(spec, load_parts(spec))


@pytest.mark.parametrize(
    ("name", "energies"), [("joule_heat", False), ("winding_temperature", False), ("energy", True)]
)
def test_energy_is_computed_where_it_ranks(name, energies, given, monkeypatch):
    """A campaign's arm over all catalogues took a minute of processor time; two thirds of it were energies."""
    computed, own = [], limits_over_time.evaluate
    monkeypatch.setattr(limits_over_time, "evaluate", lambda *a: computed.append(a[2]) or own(*a))
    passing, _, _ = ranking.sifted(given.ranked_by(name))
    assert (ENERGY in computed) is energies
    few = slice(0, 20)
    again = figures_by_physics(given, passing.sets.on(few))[name]
    assert len(again) and passing.figures[name][few] == pytest.approx(again, rel=1e-12)
