"""Sobol points that are kept: the same as those that are drawn, whatever becomes of the file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.stats import qmc

from drivesizer.search.uncertainty.sampling import sobol

SEEDS = [(7, 0), (7, 1)]


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("DRIVESIZER_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def drawn() -> np.ndarray:
    """By SciPy alone."""
    each = [qmc.Sobol(5, scramble=True, rng=np.random.default_rng([7, k])).random_base2(6) for k in (0, 1)]
    return np.concatenate(each)


def test_points_are_scipys_and_stay_so_when_they_are_kept(cache: Path) -> None:
    np.testing.assert_array_equal(sobol(5, 6, SEEDS), drawn())
    (kept,) = cache.iterdir()
    np.testing.assert_array_equal(sobol(5, 6, SEEDS), drawn())
    assert [kept] == list(cache.iterdir())
    assert len(sobol(5, 6, [(8, 0)])) == 64
    assert not np.array_equal(sobol(5, 6, [(8, 0)]), drawn()[:64])


@pytest.mark.parametrize("damage", [b"", b"nothing of the kind", None])
def test_a_damaged_file_is_drawn_anew(cache: Path, damage: bytes | None) -> None:
    sobol(5, 6, SEEDS)
    (kept,) = cache.iterdir()
    raw = bytearray(kept.read_bytes())
    raw[-1] ^= 1
    kept.write_bytes(bytes(raw) if damage is None else damage)
    np.testing.assert_array_equal(sobol(5, 6, SEEDS), drawn())
    assert kept.read_bytes() != raw
