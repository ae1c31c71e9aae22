"""Processes of the engine: the newest request of a tab first, none without an end, and what ends is started afresh."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from drivesizer.live import worker as module
from drivesizer.live.worker import Worker

pytestmark = pytest.mark.slow

SMALL = "a: 1\n"  # no spec: said at once
LONG = """\
name: long
supply: {nominal: 24 V, current: 20 A}
load: {kind: wheeled_vehicle, mass: 45 kg, driven_wheels: 4, wheel_diameter: 152 mm, rolling_resistance: 0.02,
  inertia: 0.004 kg*m^2}
motion: {speed: 1.5 m/s, acceleration_time: 2 s, cruise_time: 20 s, rest_time: 5 s}
select: {motor: {family: [RE 25, RE 30]}, gearhead: {family: [GP 26 A, GP 32 C]}}
tolerances: {confidence: 95 %, samples: 1000000}
"""  # minutes


@pytest.fixture(scope="module", autouse=True)
def temporary(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Of this module alone: other tests and programs have folders of workers in the machine's."""
    found = tmp_path_factory.mktemp("temporary")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tempfile, "tempdir", str(found))
        yield found


@pytest.fixture(scope="module")
def worker() -> Iterator[Worker]:
    found = Worker("robot.yaml", None, 30.0, {})
    yield found
    found.close()
    assert not found.thread.is_alive() and not found.process.is_alive()
    assert not Path(found.folder.name).exists()


async def pieces(worker: Worker, text: str, tab: str = "", job: str = "answer", **more: Any) -> list[dict[str, Any]]:
    return [json.loads(line) async for line in worker.answer(tab, job, {"text": text, **more})]


def answered(worker: Worker) -> list[str]:
    """Kinds of the pieces of a small request: it works."""
    return [piece["kind"] for piece in asyncio.run(pieces(worker, SMALL))]


def test_it_answers_one_after_another(worker: Worker) -> None:
    async def several() -> list[Any]:
        return await asyncio.gather(*(pieces(worker, f"a{n}: 1\n", str(n % 2) * (n % 3)) for n in range(12)))

    found = asyncio.run(several())
    for n, one in enumerate(found):  # each its own, or none where the tab had a newer request
        assert one[0].get("text", f"a{n}: 1\n") == f"a{n}: 1\n"
        assert one == [{"kind": "superseded"}] or f"a{n}: unknown key" in one[-1]["lines"][0]
    assert [one[0]["kind"] for one in found].count("superseded") == 12 - (4 + 4)
    assert worker.newest == {} and worker.serving is None


def test_what_takes_too_long_is_ended_and_the_next_answer_is_right(
    worker: Worker, monkeypatch: pytest.MonkeyPatch
) -> None:
    before, folder = worker.process.pid, worker.folder.name
    monkeypatch.setattr(worker, "longest", 1.5)
    found = asyncio.run(pieces(worker, LONG))
    assert "ranking" not in [piece["kind"] for piece in found]
    assert found[-1]["lines"] == ["it took longer than 1.5 s and was stopped"]
    monkeypatch.undo()
    assert answered(worker) == ["spec", "wrong"]
    assert worker.process.pid != before and not Path(folder).exists()


def test_a_process_that_was_killed_is_replaced(worker: Worker) -> None:
    """Between two requests nobody notices; in the middle of one it is said, and the next one is answered."""
    assert worker.process.pid
    os.kill(worker.process.pid, signal.SIGKILL)
    worker.process.join(5)
    assert answered(worker) == ["spec", "wrong"]

    async def killed() -> list[Any]:
        found = []
        async for line in worker.answer("tab", "answer", {"text": LONG}):
            found.append(json.loads(line))
            if len(found) == 1:
                os.kill(worker.process.pid or 0, signal.SIGKILL)
        return found

    found = asyncio.run(killed())
    assert found[-1] == {"kind": "wrong", "lines": [module._AFRESH]} and len(found) == 2
    assert answered(worker) == ["spec", "wrong"]


def test_who_leaves_or_asks_anew_stops_his_own_request_alone(worker: Worker, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also one that looks at nothing: its process ends after a time of grace. Another tab waits and is answered."""
    monkeypatch.setattr(module, "_GRACE", 0.5)

    async def newer() -> tuple[Any, Any, Any]:
        first = asyncio.create_task(pieces(worker, LONG, "one"))
        while worker.serving is None:  # until it is under way
            await asyncio.sleep(0.01)
        other = asyncio.create_task(pieces(worker, "other: 1\n", "two"))
        await asyncio.sleep(0.01)
        return await pieces(worker, SMALL, "one"), await other, await first

    second, other, first = asyncio.run(newer())
    assert "a: unknown key" in second[-1]["lines"][0] and "other: unknown key" in other[-1]["lines"][0]
    assert "ranking" not in [piece["kind"] for piece in first]

    async def gone() -> None:
        answer = worker.answer("one", "answer", {"text": LONG})
        await anext(answer)
        await answer.aclose()

    asyncio.run(gone())
    assert answered(worker) == ["spec", "wrong"] and worker.newest == {}


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
