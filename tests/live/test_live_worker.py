"""Processes of the engine: the newest request of a tab first, none without an end, one for others, and afresh."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from live_server import LONG, within

from drivesizer.live import worker as module
from drivesizer.live.worker import Engines

pytestmark = pytest.mark.slow

SMALL = "a: 1\n"  # no spec: said at once


@pytest.fixture(scope="module", autouse=True)
def temporary(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Of this module alone: other tests and programs have folders of engines in the machine's."""
    found = tmp_path_factory.mktemp("temporary")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tempfile, "tempdir", str(found))
        yield found


@pytest.fixture(scope="module")
def engines(temporary: Path) -> Iterator[Engines]:
    found = Engines("robot.yaml", None)
    yield found
    found.close()
    assert not found.busy and not any(one.process.is_alive() for one in found.free)
    assert not list(temporary.iterdir())


def pieces(engines: Engines, text: str, tab: str = "", **more: Any) -> list[dict[str, Any]]:
    kind = "answer" if tab else ""
    return [json.loads(line) for line in engines.answer("answer", {"text": text}, tab=tab, kind=kind, **more)]


def answered(engines: Engines) -> list[str]:
    """Kinds of the pieces of a small request: it works."""
    return [piece["kind"] for piece in pieces(engines, SMALL)]


def test_many_at_once_have_each_its_own_answer(engines: Engines) -> None:
    """Or none where the tab had a newer request; no more processes than may be, and of one tab no more than two."""
    tabs = [str(n % 2) * (n % 3 > 0) for n in range(12)]
    with ThreadPoolExecutor(12) as threads:
        found = list(threads.map(lambda n: pieces(engines, f"a{n}: 1\n", tabs[n]), range(12)))
    for n, one in enumerate(found):
        if tabs[n] and one[-1]["kind"] != "wrong":
            assert one[-1]["kind"] == "superseded" or one[0]["text"] == f"a{n}: 1\n"
        else:
            assert f"a{n}: unknown key" in one[-1]["lines"][0], one
    assert not engines.busy and len(engines.free) <= engines.most


def test_what_takes_too_long_is_ended_and_the_next_answer_is_right(
    engines: Engines, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = {one.process.pid: one.folder.name for one in engines.free}
    monkeypatch.setattr(module, "_QUICK", 1.5)
    found = pieces(engines, LONG)
    assert "ranking" not in [piece["kind"] for piece in found]
    assert found[-1]["lines"] == ["it took longer than 1.5 s and was stopped"]
    monkeypatch.undo()
    assert answered(engines) == ["spec", "wrong"]
    (ended,) = before.keys() - {one.process.pid for one in engines.free}
    assert not Path(before[ended]).exists()


def test_a_process_that_was_killed_is_replaced(engines: Engines) -> None:
    """Between two requests nobody notices; in the middle of one it is said, and the next one is answered."""
    for one in engines.free:
        os.kill(one.process.pid or 0, signal.SIGKILL)
        one.process.join(5)
    assert answered(engines) == ["spec", "wrong"]
    found = []
    for line in engines.answer("answer", {"text": LONG}):
        found.append(json.loads(line))
        if len(found) == 1:
            os.kill(engines.busy[0].process.pid or 0, signal.SIGKILL)
    assert found[-1] == {"kind": "wrong", "lines": [module._AFRESH]} and len(found) == 2
    assert answered(engines) == ["spec", "wrong"]


def test_who_leaves_or_asks_anew_stops_his_own_request_alone(engines: Engines, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also one that looks at nothing: its process ends after a time of grace. Other tabs do not wait for it."""
    monkeypatch.setattr(module, "_GRACE", 0.5)
    first: list[Any] = []
    thread = threading.Thread(target=lambda: first.extend(pieces(engines, LONG, "one")))
    thread.start()
    assert within(30.0, lambda: any(one.tab == "one" for one in engines.busy))
    other = pieces(engines, "other: 1\n", "two")
    assert thread.is_alive() and "other: unknown key" in other[-1]["lines"][0]
    assert "a: unknown key" in pieces(engines, SMALL, "one")[-1]["lines"][0]
    thread.join(30.0)
    assert "ranking" not in [piece["kind"] for piece in first]
    answer = engines.answer("answer", {"text": LONG}, tab="one", kind="answer")
    next(answer)
    answer.close()
    assert answered(engines) == ["spec", "wrong"] and not engines.busy


def test_long_jobs_leave_a_process_for_short_ones(engines: Engines) -> None:
    left = threading.Event()
    for n in range(engines.most):
        arguments = {"tab": str(n), "slow": True, "has_reader": lambda: not left.is_set()}
        threading.Thread(target=pieces, args=(engines, LONG), kwargs=arguments, daemon=True).start()
    assert within(30.0, lambda: len(engines.busy) == engines.most - 1 and engines.waiting == 1)
    assert answered(engines) == ["spec", "wrong"]
    left.set()
    assert within(30.0, lambda: not engines.busy and not engines.waiting)


def test_memory_is_bounded() -> None:
    """A spec that needs more is said to, and the process goes on; in one of its own, for a limit is for good."""
    code = f"""
import json, resource
from drivesizer.live import engine
from drivesizer.live.engine import EngineMemory
held = EngineMemory("robot.yaml")
small = {{"text": "a: 1"}}
list(engine.done(held, "answer", small))
engine._MEMORY = 400 << 20
engine._limit_memory()
print(json.dumps([list(engine.done(held, "answer", one))[-1] for one in ({{"text": {LONG!r}}}, small)]))
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    large, small = json.loads(run.stdout)
    assert large["lines"] == ["more memory is needed than there is"] and small["kind"] == "wrong"
    assert run.stderr == ""
