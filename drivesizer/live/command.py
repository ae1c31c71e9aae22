"""``drivesizer serve``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drivesizer.commands.common import DEFAULT, Spec, whole_option
from drivesizer.commands.ends import STOPPED
from drivesizer.errors import InputError, reason_of

if TYPE_CHECKING:
    import socket


_LOCAL = "127.0.0.1"


def serve(
    spec: Spec = DEFAULT,
    port: Annotated[int, whole_option("--port", 8000, 0, 65535, meaning="Port; 0 takes a free one.")] = 0,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Whether to open the page.")] = True,
) -> None:
    """Open a page on this machine where the drive follows the figures as they change."""
    import os
    import secrets
    import socket

    from drivesizer.files.cache import digest_of, folder

    _end_on_ctrl_c()
    if os.path.isdir(spec):  # noqa: PTH112 - of a name that is too long pathlib raises
        raise InputError(f"{spec}: is a folder; expected a spec, for example {spec / DEFAULT}")
    # With its protocol named: only then are answers sent without waiting for acknowledgements, 40 ms each.
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP) as listening:
        if os.name == "posix":  # a port that was in use a moment ago is free; elsewhere this would share one in use
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        kept = folder() / f"serve-{digest_of(os.fsencode(spec.absolute()))}.json"
        before, token = _address_before(kept)
        wanted = port or before
        try:
            listening.bind((_LOCAL, wanted))
        except OSError as error:
            if port:
                reason = reason_of(error)
                raise InputError(f"--port: {port} cannot be used ({reason}); expected another, or 0") from None
            listening.bind((_LOCAL, 0))  # as another page of this spec is served
        listening.listen(128)
        port = listening.getsockname()[1]
        if port != before:
            token = secrets.token_urlsafe(24)
        if port == wanted or not before:
            _keep_address(kept, port, token)
        typer.echo(f"{spec}: http://{_LOCAL}:{port}/{token}/\nstop with Ctrl-C")
        _run(spec, token, port, listening, browser=browser)


def _address_before(path: Path) -> tuple[int, str]:
    """Port and token by which the page of a spec was served before, so that its tab goes on; 0 where unknown."""
    import json

    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        own = path.stat().st_mode & 0o077 == 0  # as this user alone can read it
        return (int(found["port"]), str(found["token"])) if own else (0, "")
    except (OSError, ValueError, TypeError, KeyError):
        return 0, ""


def _keep_address(path: Path, port: int, token: str) -> None:
    """Keep port and token where this user alone can read them."""
    import json
    import os
    from contextlib import suppress

    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.unlink(missing_ok=True)
        with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
            json.dump({"port": port, "token": token}, file)


def _run(spec: Path, token: str, port: int, listening: socket.socket, *, browser: bool) -> None:
    import secrets

    from drivesizer.commands.setup import starter
    from drivesizer.live.server import application, engines
    from drivesizer.live.server import serve as served

    own: dict[str, bytes] = {}  # catalogues of the user, in memory alone
    workers = engines(spec.absolute(), own)
    try:
        app = application(spec.absolute(), token, port, starter("wheeled_vehicle"), workers, own)
        if browser:  # others see with what it is started: an address that leads there once
            app.once = f"/{secrets.token_urlsafe(24)}/"
            _opened(f"http://{_LOCAL}:{port}{app.once}")
        served(app, app.headers, listening, workers.values())
    finally:
        for worker in workers.values():
            worker.close()


def _end_on_ctrl_c() -> None:
    """Let Ctrl-C end this process at once until it serves, and with it what it has started: a library that is being
    loaded may swallow an exception."""
    import os
    import signal

    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, lambda *_: os._exit(STOPPED))


def _opened(address: str) -> None:
    """Open the page; the browser waits until the server answers, for it listens already."""
    import threading
    import webbrowser

    threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
