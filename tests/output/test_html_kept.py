"""What the HTML report keeps between runs: it changes nothing but the time, whole, damaged or not to be kept."""

from __future__ import annotations

import zlib
from pathlib import Path

import pytest
from jinja2 import DictLoader, Environment

from drivesizer.output.report.html.templates import Compiled, packed

SCRIPT = "function plot(x) { return x + 1; }\n" * 40


def _rendered(source: str) -> str:
    page = Environment(loader=DictLoader({"page.html": source}), autoescape=True, bytecode_cache=Compiled())
    return page.get_template("page.html").render(name="<b>", value=3)


def _all_kept(folder: Path) -> list[Path]:
    return sorted(path for path in folder.iterdir() if path.is_file())


def test_whole_and_damaged_files_give_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DRIVESIZER_CACHE", str(tmp_path))
    wanted = zlib.compress(SCRIPT.encode(), 9), "&lt;b&gt; 4"
    for _ in range(2):
        assert (packed(SCRIPT), _rendered("{{ name }} {{ value + 1 }}")) == wanted
        assert [path.suffix for path in _all_kept(tmp_path)] == [".z", ".jinja"]
    for damage in (b"", b"not what it was", _all_kept(tmp_path)[0].read_bytes()[:-1]):
        for path in _all_kept(tmp_path):
            path.write_bytes(damage)
        assert (packed(SCRIPT), _rendered("{{ name }} {{ value + 1 }}")) == wanted


def test_a_folder_that_cannot_be_written_is_no_hindrance(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DRIVESIZER_CACHE", str(tmp_path / "file"))
    (tmp_path / "file").write_text("no folder", encoding="utf-8")
    assert zlib.decompress(packed(SCRIPT)).decode() == SCRIPT and _rendered("{{ value }}") == "3"
