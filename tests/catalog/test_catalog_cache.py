"""Compiled catalogues: whatever happens to the cache folder, the right figures come out."""

from __future__ import annotations

import hashlib
import io
import json
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drivesizer.catalog import PARTS, CacheWarning, Catalog, columns_of, load
from drivesizer.catalog.tables import recall
from drivesizer.errors import InputError

TEXT = Path(__file__).with_name("catalog_cache.yaml").read_text(encoding="utf-8")


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("DRIVESIZER_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


@pytest.fixture
def acme(tmp_path: Path) -> Path:
    path = tmp_path / "acme.yaml"
    path.write_text(TEXT, encoding="utf-8")
    return path


def essence(catalog: Catalog) -> Any:
    """Everything in a catalogue, comparable (the text of NaN equals itself)."""
    tables = [
        (section, {name: repr(catalog.table(section)[name].tolist()) for name in columns_of(section)},
         catalog.table(section).source.tolist(), catalog.table(section).excluded.tolist())
        for section in PARTS
    ]  # fmt: skip
    pairs = [[column.tolist() for column in p] for p in (catalog.motor_gearhead, catalog.motor_encoder)]
    return tables, pairs, catalog.sources, catalog.notes, catalog.tolerances, dict(catalog.digests)


def compiled(cache: Path) -> Path:
    """The one compiled file in the folder; nothing else is left there."""
    files = list(cache.iterdir())
    assert len(files) == 1, files
    assert files[0].suffix == ".catalog"
    return files[0]


def test_the_second_load_comes_from_the_cache_and_is_the_same(
    cache: Path, acme: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cold = load([str(acme)])
    monkeypatch.setattr("drivesizer.catalog.catalog_file.parse", lambda *_: pytest.fail("the file was read again"))
    warm = load([str(acme)])
    assert essence(warm) == essence(cold)
    assert {warm.motors[name].dtype.kind for name in ("part", "family", "bearing")} == {"U"}
    assert warm.motors["part"].tolist() == ["M1", "M2"]
    assert warm.motors["bearing"].tolist() == ["kugelgelagert ø", ""]
    assert warm.confidence("motors", 1)["nominal_voltage"] == "derived"
    assert compiled(cache).name.startswith("acme-")


def _sealed(body: bytes) -> bytes:
    """A body with the digest that an intact file has."""
    return hashlib.blake2b(body, digest_size=32).digest() + body


def _flipped(raw: bytes, place: float) -> bytes:
    at = int(place * (len(raw) - 1))
    return raw[:at] + bytes([raw[at] ^ 0x01]) + raw[at + 1 :]


def _other_layout(raw: bytes) -> bytes:
    buffer = io.BytesIO()
    np.savez(buffer, motors=np.arange(3.0))
    return _sealed(buffer.getvalue())


def _other_texts(raw: bytes) -> bytes:
    """The right arrays, but texts of another make."""
    with np.load(io.BytesIO(raw[32:])) as arrays:
        content = {name: arrays[name] for name in arrays.files}
    content["texts"] = np.frombuffer(json.dumps(["of another version"]).encode(), np.uint8)
    buffer = io.BytesIO()
    np.savez(buffer, **content)
    return _sealed(buffer.getvalue())


DAMAGE: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda raw: b"",
    "digest alone": lambda raw: raw[:32],
    "half of the digest": lambda raw: raw[:16],
    "cut in the middle": lambda raw: raw[: len(raw) // 2],
    "last byte missing": lambda raw: raw[:-1],
    "one byte more": lambda raw: raw + b"\0",
    "bit in the digest": lambda raw: _flipped(raw, 0.0),
    "bit in the figures": lambda raw: _flipped(raw, 0.4),
    "last bit": lambda raw: _flipped(raw, 1.0),
    "text": lambda raw: b"this is not a catalogue\n" * 50,
    "zeros": lambda raw: bytes(len(raw)),
    "sealed nothing": lambda raw: _sealed(b""),
    "sealed text": lambda raw: _sealed(b"this is not a catalogue"),
    "sealed array": lambda raw: _sealed(raw[:0] + b"\x93NUMPY\x01\x00"),
    "sealed half": lambda raw: _sealed(raw[32 : len(raw) // 2]),
    "other layout": _other_layout,
    "other texts": _other_texts,
}


@pytest.mark.parametrize("damage", DAMAGE.values(), ids=DAMAGE)
def test_a_damaged_file_is_made_again(cache: Path, acme: Path, damage: Callable[[bytes], bytes]) -> None:
    expected = essence(load([str(acme)]))
    path = compiled(cache)
    intact = path.read_bytes()
    path.write_bytes(damage(intact))
    assert recall(path) is None
    assert essence(load([str(acme)])) == expected
    assert compiled(cache).read_bytes() == intact


class _Trap:
    """Creates a file when unpickled."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> Any:
        return Path.touch, (self.path,)


@pytest.mark.parametrize("wrapped", [True, False], ids=["object array", "bare pickle"])
def test_nothing_in_a_compiled_file_is_unpickled(cache: Path, acme: Path, tmp_path: Path, wrapped: bool) -> None:
    load([str(acme)])
    trap, path = tmp_path / "sprung", compiled(cache)
    buffer = io.BytesIO()
    if wrapped:
        np.savez(buffer, texts=np.array([_Trap(trap)], dtype=object))
    else:
        pickle.dump(_Trap(trap), buffer)
    path.write_bytes(_sealed(buffer.getvalue()))
    assert load([str(acme)]).motors["part"].tolist() == ["M1", "M2"]
    assert not trap.exists()


def test_a_changed_catalogue_is_compiled_again_and_the_old_one_goes(cache: Path, acme: Path) -> None:
    load([str(acme)])
    before = compiled(cache)
    acme.write_text(TEXT.replace("480]", "481]"), encoding="utf-8")
    assert load([str(acme)]).motors["mass"][0] == pytest.approx(0.481)
    assert compiled(cache) != before


def test_where_nothing_can_be_kept_the_program_goes_on_and_says_so(acme: Path, cache: Path) -> None:
    expected = essence(load([str(acme)]))
    compiled(cache).unlink()
    cache.rmdir()
    cache.write_text("a file where the folder should be")
    with pytest.warns(CacheWarning, match="is not kept in"):
        assert essence(load([str(acme)])) == expected


def test_a_full_disk_leaves_no_half_file(acme: Path, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("drivesizer.files.cache.os.replace", full)
    with pytest.warns(CacheWarning, match="no space left"):
        load([str(acme)])
    assert list(cache.iterdir()) == []


KILLED = """
import os, signal, sys
from drivesizer.catalog import load
import drivesizer.files.cache as cache
cache.Path.replace = lambda *_: os.kill(os.getpid(), signal.SIGKILL)
load([sys.argv[1]])
"""


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no such signal here")
def test_a_process_killed_while_it_compiles_leaves_nothing_that_is_used(cache: Path, acme: Path) -> None:
    killed = subprocess.run([sys.executable, "-c", KILLED, str(acme)], env=os.environ, timeout=60)
    assert killed.returncode == -signal.SIGKILL
    (half,) = cache.iterdir()
    assert half.name.startswith(".compiling-")
    assert load([str(acme)]).motors["part"].tolist() == ["M1", "M2"]
    assert half.exists()  # another process may still be writing it
    os.utime(half, (0, 0))
    acme.write_text(acme.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    load([str(acme)])
    assert not half.exists()


# --- files that mean harm --------------------------------------------------------------------------------------------


def test_what_has_no_size_and_no_end_is_refused(cache: Path, tmp_path: Path) -> None:
    endless = tmp_path / "zero.yaml"
    endless.symlink_to("/dev/zero")
    with pytest.raises(InputError, match="larger than 16 MB"):
        load([str(endless)])
