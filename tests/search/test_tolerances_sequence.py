"""Sobol points that are kept: the same as those that are drawn, whatever becomes of the file."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import qmc

from drivesizer.search.uncertainty import sampling
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


def test_a_folder_that_cannot_be_written_changes_nothing(cache: Path) -> None:
    cache.write_text("a file where the folder should be")
    np.testing.assert_array_equal(sobol(5, 6, SEEDS), drawn())


def test_files_do_not_grow_beyond_a_number(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sampling, "_PLACES", 3)
    for seed in range(12):
        sobol(2, 3, [(seed,)])
    assert 1 <= len(list(cache.iterdir())) <= 3
    monkeypatch.setattr(sampling, "_LARGEST", 100)
    before = {path.name for path in cache.iterdir()}
    sobol(2, 3, [(99,)])
    assert {path.name for path in cache.iterdir()} == before


def test_kept_points_need_no_statistics(cache: Path) -> None:
    """What loads slowly is loaded where points are drawn, and not again."""
    draw = "import sys; from drivesizer.search.uncertainty.sampling import sobol; sobol(3, 5, [(1,)]); "
    code = draw + "print('scipy.stats' in sys.modules)"
    for loads in ("True", "False"):
        run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        assert run.stdout.strip() == loads
