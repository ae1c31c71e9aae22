"""The live page's server as a process: how it starts and ends, what it leaves behind, and two beside each other."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from live_server import LONG, Serving, serving, within

pytestmark = pytest.mark.slow


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Of a spec, and of all temporary files."""
    (tmp_path / "robot.yaml").write_text("name: small\n", encoding="utf-8")
    (tmp_path / "temporary").mkdir()
    monkeypatch.setenv("TMPDIR", str(tmp_path / "temporary"))
    return tmp_path


def alive(pid: int) -> bool:
    try:
        return "\nState:\tZ" not in Path(f"/proc/{pid}/status").read_text(encoding="utf-8")
    except OSError:
        return False


def streaming(server: Serving) -> socket.socket:
    """A request whose answer has begun and is computed for minutes."""
    body = json.dumps({"text": LONG}).encode()
    connection = server.connect()
    connection.sendall(server.head("POST", "/do/answer", {"Content-Length": str(len(body))}) + body)
    begun = b""
    while b'"spec"' not in begun:
        begun += connection.recv(10_000)
    return connection


@pytest.mark.parametrize(("sent", "status"), [(signal.SIGINT, 0), (signal.SIGTERM, -signal.SIGTERM)])
def test_it_ends_at_once_and_leaves_nothing(folder: Path, sent: signal.Signals, status: int) -> None:
    """Ctrl-C reaches all processes of a terminal; a service manager ends the first one."""
    with serving(folder / "robot.yaml", start_new_session=True) as server:
        connection, engines = streaming(server), server.processes()
        assert len(engines) == 2 and list((folder / "temporary").glob("drivesizer-*"))
        if sent is signal.SIGINT:
            os.killpg(server.process.pid, sent)
        else:
            server.process.send_signal(sent)
        out, err = server.process.communicate(timeout=30)  # s, of minutes that the answer takes
        with connection:
            rest = b"".join(iter(lambda: connection.recv(10_000), b""))
        assert b"drivesizer serve has been stopped" in rest
    assert (server.process.returncode, err) == (status, "") and server.token not in out
    assert within(30, lambda: not any(map(alive, engines)))
    assert not list((folder / "temporary").iterdir())


def test_engines_end_with_a_server_that_is_killed(folder: Path) -> None:
    with serving(folder / "robot.yaml") as server:
        engines = server.processes()
        with streaming(server):
            server.process.kill()
            assert within(30, lambda: not any(map(alive, engines)))
        assert server.process.communicate()[1] == ""
    assert within(30, lambda: not list((folder / "temporary").iterdir()))


@pytest.fixture
def server(folder: Path) -> Iterator[Serving]:
    with serving(folder / "robot.yaml") as found:
        yield found


def test_an_engine_that_is_killed_is_said_and_replaced(server: Serving) -> None:
    connection, engines = streaming(server), server.processes()
    for engine in engines:
        os.kill(engine, signal.SIGKILL)
    with connection:
        rest = b"".join(iter(lambda: connection.recv(10_000), b""))
    assert b"the engine ended in the middle of this and has been started afresh" in rest
    assert within(30, lambda: not {*engines} & {*server.processes()})  # the other one has ended too
    for job in ("answer", "loop"):
        assert "a: unknown key" in server.do(job, "a: 1\n")[-1]["lines"][0]
    assert within(30, lambda: len(server.processes()) == 2)


def test_a_port_in_use_is_one_line(server: Serving, folder: Path) -> None:
    command = [sys.executable, "-m", "drivesizer", "serve", str(folder / "robot.yaml"), "--no-browser"]
    run = subprocess.run([*command, "--port", str(server.port)], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout) == (2, "")
    assert run.stderr == (
        f"drivesizer: --port: {server.port} cannot be used (address already in use); expected another, or 0\n"
    )


def test_a_server_that_starts_again_has_the_address_of_its_tab(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Port and token are kept where this user alone can read them; an address that others could read is none."""
    monkeypatch.setenv("DRIVESIZER_CACHE", str(folder / "cache"))
    with serving(folder / "robot.yaml") as first:
        pass
    with serving(folder / "robot.yaml") as again, serving(folder / "robot.yaml") as beside:
        assert again.printed == first.printed
        assert beside.token != first.token and beside.port != first.port
    (kept,) = (folder / "cache").glob("serve-*.json")
    assert kept.stat().st_mode & 0o777 == 0o600
    kept.chmod(0o644)
    with serving(folder / "robot.yaml", "--port", str(first.port)) as other:
        assert (other.port, other.token == first.token) == (first.port, False)


def test_the_browser_is_started_with_a_file_of_this_user_alone(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Other users see the command lines of processes: the address is in a file of mode 0600, which goes at the end."""
    browser = folder / "browser.sh"
    browser.write_text(f'#!/bin/sh\necho "$1" > {folder}/seen.part; mv {folder}/seen.part {folder}/seen\n', "utf-8")
    browser.chmod(0o755)
    monkeypatch.setenv("BROWSER", f"{browser} %s")
    monkeypatch.setenv("DRIVESIZER_CACHE", str(folder / "cache"))
    command = [sys.executable, "-m", "drivesizer", "serve", str(folder / "robot.yaml")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout
        address = process.stdout.readline().split(": ", 1)[1].strip()
        assert within(60, (folder / "seen").exists)
        seen = (folder / "seen").read_text(encoding="utf-8").strip()
        page = Path(seen.removeprefix("file://"))
        assert seen.startswith("file:///") and page.stat().st_mode & 0o777 == 0o600
        assert address in page.read_text(encoding="utf-8") and address.split("/")[3] not in seen
        port, token = int(address.split(":")[2].split("/")[0]), address.split("/")[3]
        server = Serving(process, port, token, "")
        led = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate", "Sec-Fetch-Dest": "document"}
        assert server.raw(server.head("GET", "/", led)).status == 200
        assert server.raw(server.head("GET", "/spec", led)).status == 403
        process.terminate()
        assert process.wait(30) == -signal.SIGTERM and not page.exists()


def test_tabs_and_servers_do_not_disturb_each_other(server: Serving, folder: Path) -> None:
    """A browser that goes away, a newer request of its tab, another tab; and a server of the same file."""
    with serving(folder / "robot.yaml") as other:
        assert other.token != server.token
        assert server.get("/spec", token=other.token).status == 404
        mark = json.loads(server.get("/spec").body)["mark"]
        with streaming(server):
            pass  # and gone
        assert "a: unknown key" in server.do("answer", "a: 1\n", tab="one")[-1]["lines"][0]
        with streaming(server):
            assert "b: unknown key" in other.do("answer", "b: 1\n", tab="one")[-1]["lines"][0]
            assert "c: unknown key" in server.do("loop", "c: 1\n", tab="two")[-1]["lines"][0]
        saved = {"text": "name: of one\n", "mark": mark}
        assert [json.loads(one.post("/save", saved).body)["kind"] for one in (server, other)] == ["saved", "changed"]
    assert (folder / "robot.yaml").read_text(encoding="utf-8") == "name: of one\n"


def test_files_are_read_that_were_named_at_the_start_alone(folder: Path) -> None:
    """Not those that a saved text names, nor after an engine has been started afresh."""
    head, *_, select, _ = LONG.splitlines()
    spec = f"{head}\nsupply: {{nominal: 24 V, current: 20 A}}\nload: {{kind: recorded, file: FILE}}\n{select}\n"
    (folder / "robot.yaml").write_text(spec.replace("FILE", "mine.csv"), encoding="utf-8")
    rows = "time,speed,torque\ns,rpm,N*m\n0,0,1\n1,10,1\n2,0,1\n"
    for name in ("mine.csv", "other.csv"):
        (folder / name).write_text(rows, encoding="utf-8")
    (folder / "link.csv").symlink_to(folder / "other.csv")
    with serving(folder / "robot.yaml") as server:

        def said(name: str, field: str = "FILE", text: str = spec) -> str:
            found = server.do("document", text.replace(field, json.dumps(name)))
            return found[0]["kind"] if found[0]["kind"] == "file" else " ".join(found[0]["lines"])

        away = ["other.csv", "link.csv", "../x.csv", "/etc/passwd", "/dev/zero", "//host/share/x.csv", "no.csv",
                r"\\host\share\x.csv", str(folder / "other.csv")]  # fmt: skip
        for name in away:
            assert "is not read here" in said(name), name
        catalogue = spec.replace("FILE", "mine.csv").replace("select: {", "select: {catalogs: [FILE], ")
        for name in ("/etc/passwd.yaml", "../mine.yaml", "robot.yaml", "no.yaml", "//host/share/x.yml"):
            assert "is not read here" in said(name, text=catalogue), name
        assert said("mine.csv") == "file"
        mark = json.loads(server.get("/spec").body)["mark"]
        text = spec.replace("FILE", "other.csv")
        assert json.loads(server.post("/save", {"text": text, "mark": mark}).body)["kind"] == "saved"
        engines = server.processes()
        for engine in engines:
            os.kill(engine, signal.SIGKILL)
        assert within(30, lambda: not any(map(alive, engines)))
        within(20, lambda: "afresh" not in said("mine.csv"))  # said once, where it ended while it was waited for
        assert "is not read here" in said("other.csv") and said("mine.csv") == "file"
        (folder / "mine.csv").write_text(rows.replace("10,1", "1e9,1"), encoding="utf-8")
        assert "mine.csv" in said("mine.csv")  # as it is now, not as it was
