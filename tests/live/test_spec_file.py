"""The file of the live page: read as it is, saved whole, with its own line ends, and not over another's change."""

from __future__ import annotations

import os
import socket
from pathlib import Path
from typing import Any

import pytest

from drivesizer.live.server import content, saved

TEXT = "name: Wägelchen\nload: 5 kg\n"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "robot.yaml").write_bytes(TEXT.encode())
    return tmp_path / "robot.yaml"


def save(path: Path, text: str, mark: str | None = None, anyway: bool = False) -> dict[str, Any]:
    return saved(path, {"text": text, "mark": mark, "anyway": anyway})


def test_a_file_that_nobody_changed_is_replaced(path: Path) -> None:
    found = content(path)
    assert found["text"] == TEXT and "wrong" not in found
    done = save(path, "a: 1\n", found["mark"])
    assert done["kind"] == "saved" and path.read_bytes() == b"a: 1\n"
    assert content(path) == {"text": "a: 1\n", "mark": done["mark"]}
    assert [one.name for one in path.parent.iterdir()] == ["robot.yaml"]


def test_a_file_that_was_changed_is_left_to_the_user(path: Path) -> None:
    mark = content(path)["mark"]
    path.write_text("b: 2\n", encoding="utf-8")
    assert save(path, "a: 1\n", mark) == {
        "kind": "changed", "lines": ["robot.yaml has been changed by another program since it was read"]
    }  # fmt: skip
    assert save(path, "a: 1\n")["kind"] == "changed" and path.read_text(encoding="utf-8") == "b: 2\n"
    assert save(path, "a: 1\n", mark, anyway=True)["kind"] == "saved"
    path.unlink()
    assert content(path) == {"text": None, "mark": None}
    assert save(path, "c: 3\n", mark)["kind"] == "saved" and path.read_bytes() == b"c: 3\n"


@pytest.mark.parametrize("ends", ["\n", "\r\n"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_line_ends_and_byte_order_mark_stay(path: Path, ends: str, mark: str) -> None:
    path.write_bytes((mark + TEXT.replace("\n", ends)).encode())
    found = content(path)
    assert found["text"] == TEXT
    for text in ("a: 1\nb: é\n", "a: 1\r\nb: é\r\n"):  # as a file of another system is opened in the browser
        found = save(path, text, found["mark"])
        assert path.read_bytes() == f"{mark}a: 1{ends}b: é{ends}".encode()


def test_what_is_no_text_of_a_spec_is_not_read_and_not_lost(path: Path) -> None:
    """A damaged character, read as another, would be saved as that."""
    raw = "a: 1\nname: Wägelchen\n".encode("latin-1")
    path.write_bytes(raw)
    found = content(path)
    assert found["text"] is None and found["wrong"] == "2: the file is not UTF-8 text; save it as UTF-8"
    assert save(path, "a: 1\n")["kind"] == "changed" and path.read_bytes() == raw
    path.write_bytes(b"# x\n" * 2_500_000)
    assert content(path)["wrong"] == "the file is larger than 2 MB"
    assert save(path, "a: 1\n")["kind"] == "wrong" and path.stat().st_size == 10_000_000


@pytest.mark.skipif(os.name != "posix", reason="no such files")
def test_what_is_no_file_is_neither_waited_for_nor_replaced(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.yaml")
    (tmp_path / "folder.yaml").mkdir()
    (tmp_path / "loop.yaml").symlink_to(tmp_path / "loop.yaml")
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(tmp_path / "socket.yaml"))
        for path in (*tmp_path.iterdir(), Path("/dev/zero"), tmp_path / "folder.yaml" / "none" / "x.yaml"):
            found = content(path)
            assert found["text"] is None and (found.get("wrong") or path.name == "x.yaml"), path
            done = save(path, "a: 1\n", anyway=True)
            assert done["kind"] == "wrong" and len(done["lines"]) == 1, path


def test_a_link_stays_one_and_permissions_too(path: Path) -> None:
    link = path.with_name("link.yaml")
    link.symlink_to(path)
    path.chmod(0o640)
    assert save(link, "a: 1\n", content(link)["mark"])["kind"] == "saved"
    assert link.is_symlink() and path.read_bytes() == b"a: 1\n" and path.stat().st_mode & 0o777 == 0o640


def test_what_cannot_be_written_stays_whole(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mark = content(path)["mark"]
    monkeypatch.setattr("drivesizer.files.writing.os.access", lambda *_: False)
    assert save(path, "a: 1\n", mark)["lines"] == [f"{path}: cannot be written, it is protected against that"]
    monkeypatch.undo()

    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "chmod", full)
    assert save(path, "a: 1\n", mark)["lines"] == [f"{path}: cannot be written (no space left on device)"]
    assert path.read_bytes() == TEXT.encode() and len(list(path.parent.iterdir())) == 1
