"""What others may send to the live page's server: refused, or harmless; and it lives on."""

from __future__ import annotations

import json
import re
import resource
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from live_server import Serving, reply, serving, within

from drivesizer.live.http import LARGEST
from drivesizer.live.requests import REQUESTS
from drivesizer.live.server import Page

POLICY = {"x-content-type-options": "nosniff", "referrer-policy": "no-referrer", "x-frame-options": "DENY",
          "cross-origin-opener-policy": "same-origin", "cross-origin-resource-policy": "same-origin"}  # fmt: skip


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serving]:
    """One for all tests here; whatever they sent, it says nothing but its address, and never a traceback."""
    folder = tmp_path_factory.mktemp("served")
    (folder / "robot.yaml").write_text("name: <b>x</b>\n", encoding="utf-8")
    (folder / "secret.yaml").write_text("password: 5\n", encoding="utf-8")
    with serving(folder / "robot.yaml", cwd=folder) as found:
        yield found
        assert found.get("/").status == 200
        found.process.terminate()
        out, err = found.process.communicate(timeout=60)
    assert err == "" and found.token not in out
    assert sorted(path.name for path in folder.iterdir()) == ["robot.yaml", "secret.yaml"]


def test_the_page_is_there_with_its_headers(server: Serving) -> None:
    for path in ("/", "/page/main.js", "/page/live.css", "/page/colours.css", "/page/style.css", "/starters.json"):
        found = server.get(path)
        assert found.status == 200 and found.body, path
        assert POLICY.items() <= found.headers.items() and found.headers["cache-control"] == "no-store"
        head = server.get(path, "HEAD")
        assert head.status == 200 and head.body == b""
        assert head.headers["content-length"] == found.headers["content-length"]
    assert server.get("/plotly.js", "HEAD").headers["cache-control"] == "private, max-age=86400"
    assert "'unsafe-inline'" not in re.sub("style-src-attr[^;]*", "", found.headers["content-security-policy"])


# -- whose request it is


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://127.0.0.1"},
        {"Origin": "https://{host}"},
        {"Origin": "http://{host}.evil.example"},
        {"Origin": None},
        {"Sec_Fetch_Site": "cross-site"},
        {"Sec_Fetch_Site": "same-site"},  # another port of this machine
        {"Content_Type": "text/plain"},
        {"Content_Type": "application/x-www-form-urlencoded"},
        {"Content_Type": "multipart/form-data; boundary=application/json"},
        {"Content_Type": "text/plain; application/json"},
        {"Content_Type": None},
    ],
)
@pytest.mark.parametrize("path", ["/save", "/do/answer", "/catalogue"])
def test_another_page_cannot_post(server: Serving, path: str, headers: dict[str, str | None]) -> None:
    own = {name: value and value.format(host=server.host) for name, value in headers.items()}
    found = server.post(path, {"text": "a: 1", "anyway": True}, **own)
    assert found.status in (403, 415) and found.headers["connection"] == "close"
    assert POLICY.items() <= found.headers.items() and "access-control-allow-origin" not in found.headers


def test_another_page_cannot_read(server: Serving) -> None:
    for site in ("cross-site", "same-site"):
        assert server.get("/spec", Sec_Fetch_Site=site).status == 403
        assert server.get("/page/main.js", Sec_Fetch_Site=site).status == 403
    assert server.get("/spec", Origin="http://evil.example").status == 403
    assert server.get("/save", "OPTIONS", Origin="http://evil.example").status == 403
    found = server.get("/save", "OPTIONS", Origin=f"http://{server.host}", Access_Control_Request_Method="POST")
    assert found.status == 405 and not any(name.startswith("access-control") for name in found.headers)


def test_a_name_that_leads_here_is_not_enough(server: Serving) -> None:
    """DNS rebinding: the browser believes that another host is here, and names it."""
    port = server.port
    for host in (f"evil.example:{port}", "127.0.0.1", f"127.0.0.1:{port + 1}", f"127.0.0.1.evil.example:{port}", "",
                 f"[::1]:{port}", f"[::ffff:127.0.0.1]:{port}", f"0.0.0.0:{port}", f"127.1:{port}",
                 f"2130706433:{port}", f"127.0.0.1:{port}@evil.example", f"evil.example/127.0.0.1:{port}"):  # fmt: skip
        found = server.get("/", Host=host)
        assert found.status in (400, 421), host
        assert POLICY.items() <= found.headers.items()
    assert server.get("/", Host=f"localhost:{port}").status == 200
    start = f"GET /{server.token}/ HTTP/1.1\r\n"
    assert server.raw(f"{start}\r\n".encode()).status == 400
    assert server.raw(f"{start}Host: {server.host}\r\nHost: evil.example\r\n\r\n".encode()).status == 400
    assert server.raw(f"{start.replace('1.1', '1.0')}\r\n".encode()).status == 421
    whole = f"GET http://{server.host}/{server.token}/ HTTP/1.1\r\nHost: {server.host}\r\nConnection: close\r\n\r\n"
    assert server.raw(whole.encode()).status == 404
    assert server.raw(whole.replace(f"http://{server.host}", "http://evil.example", 1).encode()).status == 404


def test_without_the_token_nothing_is_here(server: Serving) -> None:
    whole = server.token
    for token in ("", "x", whole[:-1], whole[:8], whole.swapcase(), f"{whole}x", f"{whole}/..", f"x/../{whole}",
                  f"./{whole}", f"/{whole}", "%00", f"{whole}%2f..", "*"):  # fmt: skip
        for path in ("/", "/spec", "/page/main.js", "/nothing"):
            found = server.get(path, token=token)
            assert found.status == 404, (token, path)
            assert b"<b>x" not in found.body and whole.encode() not in found.body
    assert server.get("", token="").status == 404


@pytest.mark.parametrize(
    "name",
    ["..%2f..%2fguard.py", "../guard.py", "..", ".", "%2e%2e/guard.py", "..%5c..%5cguard.py", "main.js%00.css", "%00",
     "main.js/", "main.js/..", "index.html.bak", "__init__.py", "C:%5cx", "%2fetc%2fpasswd", "..%252fguard.py", "",
     "%ff", "main%2ejs%2f", "secret.yaml", "a" * 5000],
)  # fmt: skip
def test_no_name_leads_out_of_the_page(server: Serving, name: str) -> None:
    for path in (f"/page/{name}", f"/{name}", f"/page//{name}"):
        found = server.get(path)
        assert found.status == 404 or (name in (".", "") and path == f"/{name}"), path
        assert b"password" not in found.body and b"import" not in found.body


# -- how much


def test_a_body_is_bounded_whatever_length_it_claims(server: Serving) -> None:
    size = "100000000"
    assert server.raw(server.head("POST", "/save", {"Content-Length": size})).status == 413
    assert server.raw(server.head("POST", "/catalogue", {"Content-Length": size})).status == 413
    for wrong in ("-1", "1e3", "0x10", "1, 2", "²", "\xd9\xa3", "9" * 5000):
        found = server.raw(server.head("POST", "/save", {"Content-Length": wrong}))
        assert found.status in (400, 413), wrong
    chunk = b"fffff\r\n" + b"a" * 0xFFFFF + b"\r\n"
    with server.connect() as connection:
        connection.sendall(server.head("POST", "/save", {"Transfer-Encoding": "chunked"}))
        sent = 0
        try:
            for _ in range(100):
                connection.sendall(chunk)
                sent += len(chunk)
        except OSError:
            pass
        assert sent < 100 * len(chunk) or reply(connection).status == 413
    assert _memory(server) < 400e6
    assert LARGEST < 5e6


def _memory(server: Serving) -> float:
    """Resident bytes of the server."""
    pages = int(Path(f"/proc/{server.process.pid}/statm").read_text(encoding="ascii").split()[1])
    return pages * resource.getpagesize()


def test_many_at_once_are_answered_or_closed(server: Serving) -> None:
    """300 connections that say nothing keep nobody waiting, the oldest of them are closed; then 200 that are gone."""
    before = _descriptors(server)
    silent = [server.connect() for _ in range(300)]
    begun = time.monotonic()
    found = server.get("/page/main.js")
    assert found.status == 200 and time.monotonic() - begun < 8.0  # s, before any of them has said nothing for ten
    assert silent[0].recv(1) == b""
    with suppress(TimeoutError):  # the youngest may still speak
        silent[-1].settimeout(0.1)
        assert silent[-1].recv(1)
    silent[-1].settimeout(30.0)
    silent[-1].sendall(server.head("GET", "/page/main.js"))
    assert reply(silent[-1]).body == found.body
    for one in silent:
        one.close()
    for _ in range(200):
        server.connect().close()
    assert within(20.0, lambda: _descriptors(server) < before + 50)  # its engines may have started since
    assert within(20.0, lambda: server.get("/").status == 200)  # those that wait to be accepted come first
    assert _memory(server) < 400e6


def _descriptors(server: Serving) -> int:
    return len(list(Path(f"/proc/{server.process.pid}/fd").iterdir()))


@pytest.mark.slow
def test_who_is_slow_is_not_waited_for(server: Serving) -> None:
    """Heads and bodies that come byte by byte, and connections that say nothing: ten seconds, all at once."""
    begun = time.monotonic()
    silent, head, body = (server.connect() for _ in range(3))
    head.sendall(b"GET / HTTP/1.1\r\nHost: ")
    body.sendall(server.head("POST", "/save", {"Content-Length": "100"}) + b"{")

    def trickle() -> None:
        try:
            while time.monotonic() - begun < 20:
                head.sendall(b"x")
                body.sendall(b" ")
                time.sleep(0.3)
        except OSError:
            pass

    writing = threading.Thread(target=trickle)
    writing.start()
    for one in (silent, head):  # closed, or reset; a time-out is none of both
        with suppress(ConnectionResetError):
            assert one.recv(100) == b""
    assert reply(body).status == 408
    writing.join()
    for one in (silent, head, body):
        one.close()


def test_what_needs_an_extra_that_is_not_there_is_not_offered(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    page = Page(tmp_path / "robot.yaml", "", None)  # type: ignore[arg-type]
    for found in (None, "there"):
        monkeypatch.setattr("drivesizer.live.server.find_spec", lambda _, found=found: found)
        exports = json.loads(page._file("/starters.json").content)["exports"]  # type: ignore[arg-type]
        assert ("fmu" in exports) == (found is not None) and "mjcf" in exports


# -- what jobs are given


ANY = st.recursive(
    st.none() | st.booleans() | st.integers(-3, 10**20) | st.floats() | st.text(max_size=5) | st.just("a"),
    lambda below: st.lists(below, max_size=3) | st.dictionaries(st.sampled_from("ab"), below, max_size=2),
    max_leaves=6,
)
STEPS = st.lists(st.sampled_from(["a", "b", "c", "x y"]) | st.integers(0, 3), min_size=1, max_size=3)
WORD = st.sampled_from(["", "mass", "mass < 5 g", "mass >", "(", "4741"]) | st.text(max_size=4)
TEXTS = st.sampled_from(["a: {b: 1}\nc: [1, 2]\n", "a:\n- b: 1\n", "", "a: [", "- 1", "5"])
NAMES = st.sampled_from(["pololu", "/etc/passwd", "x", "../x.yaml", "/dev/zero"])
RIGHT = {
    "text": TEXTS, "path": STEPS, "values": st.lists(st.text(max_size=3) | st.integers(), max_size=2),
    "edits": st.lists(st.tuples(STEPS, ANY, st.none() | st.booleans()), max_size=2),
    "sets": st.just([["RE 25", "GP 26"]]), "motor": st.just("RE 25"), "gearhead": st.just("GP 26 A"),
    "form": st.sampled_from(["csv", "mjcf", "exe"]), "tab": WORD, "slider": WORD, "axis": st.sampled_from(["", "a"]),
    "section": st.sampled_from(["motors", "encoders"]), "catalogues": st.lists(NAMES, max_size=2), "catalogue": NAMES,
    "options": st.dictionaries(st.sampled_from(["kind", "part"]), WORD, max_size=1), "sort": WORD,
    "where": st.lists(WORD, max_size=2), "piece": WORD, "part": WORD | st.just(["pololu", "motors", "4741"]),
    "parts": st.just([["pololu", "4741"], ["x", "y"]]), "family": st.booleans(), "add": st.booleans(),
    "excluded": st.booleans(), "start": st.integers(0, 10**9), "name": st.just("x.yaml"),
    "content": st.just("YTogMQ=="), "anyway": st.booleans(),
}  # fmt: skip


def mostly(right: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    return st.integers(0, 15).flatmap(lambda one: right if one else ANY)


BODY = st.fixed_dictionaries({name: mostly(right) for name, right in RIGHT.items()})
NONE = ["check", "own catalogues", "run"]


@settings(max_examples=80)
@given(job=st.sampled_from([*REQUESTS, *NONE]), body=BODY)
def test_whatever_a_request_holds_there_is_an_answer(server: Serving, job: str, body: dict[str, Any]) -> None:
    """Pieces that are JSON, or a refusal; what goes to the terminal is looked at when the server ends."""
    found = server.post(f"/do/{job}".replace(" ", "%20"), body)
    if job in REQUESTS:
        assert found.status in (200, 400)
    else:
        assert found.status == 404
    assert all(isinstance(piece["kind"], str) for piece in found.pieces), found.pieces
    assert not any("a fault of drivesizer" in line for piece in found.pieces for line in piece.get("lines", ()))
    taken = server.post("/catalogue", body)
    assert taken.status in (200, 400) and "\n" not in taken.body.decode().strip()
